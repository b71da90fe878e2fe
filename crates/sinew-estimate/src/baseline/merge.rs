//! What several recordings learned, put together: of one robot, or of robots of one type.
//!
//! Both in information form ([`beliefs::merge`], [`alike::pool_bodies`]), so that what all started
//! from counts once and order doesn't matter.
//!
//! | | recordings of one robot | robots of one type |
//! |---|---|---|
//! | masses, first moments, inertias of the links | together | together, up to what differs between two |
//! | stiffness, stiffening, friction, encoders, gear, motor torque | together | each robot's own: as robot.toml says |
//! | offsets, the encoders' zero, slack, what the gripper holds | of a recording: forgotten | forgotten |
//!
//! A rope's stiffness depends on how it was made fast, an encoder's error on how it was glued:
//! what a data sheet gives a tolerance for is drawn anew for every robot. Links are cut from the
//! same drawing, and it is the drawing that the robots' description gets wrong.

use super::file::Baseline;
use crate::error::SessionError;
use crate::estimator::{SessionOptions, estimator};
use crate::nuisance::NuisanceChange;
use sinew_files::JsonDocument;
use sinew_model::offset::alike::{self, Alike};
use sinew_model::offset::{Belief, MapError, Payload, Prior, UNKNOWN_OFFSET_RAD, beliefs};
use sinew_model::robot::Robot;

/// How beliefs are put together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MergeOptions {
    /// The recordings are of several robots of one type.
    pub fleet: bool,
    /// How far the masses of two robots of a type may differ, relative, one standard deviation;
    /// first moments and inertias in proportion to their tolerances.
    pub scatter: f64,
}

impl Default for MergeOptions {
    fn default() -> Self {
        Self {
            fleet: false,
            scatter: 0.01,
        }
    }
}

/// What became surer.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MergeSummary {
    /// The robot.
    pub robot: String,
    /// All recordings it rests on.
    pub recordings: Vec<String>,
    /// Temperature that offsets and stiffness refer to, °C.
    pub temperature_c: Option<f64>,
    /// Everything that is estimated along: believed at the start, and now.
    pub nuisance: Vec<NuisanceChange>,
}

impl JsonDocument for MergeSummary {
    const SCHEMA: &'static str = "sinew/baseline-merge/1";
}

/// Puts together what `parts` (baselines with their files' names) learned from `common`, the file
/// they all started from; `None`: from the tolerances of robot.toml, as `sinew baseline` does.
///
/// The result is a start for `sinew baseline --start`; its offsets are unknown, and so is the
/// encoders' zero where robot.toml doesn't say that it is known.
///
/// # Errors
/// [`SessionError::Baseline`]: a file of another robot or stiffness, fewer than two files, one that
/// didn't start from `common`, a recording that would count twice, temperatures some have and some
/// don't.
pub fn merge(
    robot: &Robot,
    parts: &[(&Baseline, &str)],
    common: Option<(&Baseline, &str)>,
    options: &MergeOptions,
) -> Result<(Baseline, MergeSummary), SessionError> {
    let estimator = estimator(robot, &SessionOptions::default());
    let prior = estimator.prior();
    let Learned {
        recordings,
        start,
        parts: learned,
    } = Learned::of(robot, prior, parts, common, options.fleet)?;
    let refused = |error| refused(parts, error);
    let (belief, noise) = if options.fleet {
        let alike = (options.scatter / robot.tolerances.mass.max(1e-9)).min(1.0);
        let mut belief = alike::pool_bodies(prior, &learned, alike).map_err(refused)?;
        belief.temperature_c = f64::NAN;
        (belief, Default::default())
    } else {
        let mut together = start.clone();
        prior.open_offsets(&mut together, UNKNOWN_OFFSET_RAD);
        prior.open_zero(&mut together);
        prior.open_payload(&mut together, Payload::Unknown);
        for [before, after] in &learned {
            together = beliefs::merge(prior, before, &together, after).map_err(refused)?;
        }
        let rad = parts.iter().map(|(b, _)| &b.noise_rad[..]);
        let nm = parts.iter().map(|(b, _)| &b.motor_noise_nm[..]);
        (together, [middle(rad), middle(nm)])
    };
    Ok(put_together(
        robot,
        prior,
        parts,
        recordings,
        [&start, &belief],
        noise,
    ))
}

/// What a further robot of a type starts from, by what `parts`, baselines of robots of the type with their files' names,
/// have learned: masses, stiffness, friction, encoders and drives, each as far as robots are found to be alike in it.
///
/// The result is a start for `sinew baseline --start`; its offsets are unknown, and so is the encoders' zero where
/// robot.toml doesn't say that it is known.
///
/// # Errors
/// As [`merge`].
pub fn pool(
    robot: &Robot,
    parts: &[(&Baseline, &str)],
) -> Result<(Baseline, MergeSummary, Vec<Alike>), SessionError> {
    let estimator = estimator(robot, &SessionOptions::default());
    let prior = estimator.prior();
    let Learned {
        recordings,
        start,
        parts: learned,
    } = Learned::of(robot, prior, parts, None, true)?;
    let (mut belief, alike) =
        alike::learn_type(prior, &learned).map_err(|error| refused(parts, error))?;
    belief.temperature_c = start.temperature_c;
    let ends = [&start, &belief];
    let (baseline, summary) =
        put_together(robot, prior, parts, recordings, ends, Default::default());
    Ok((baseline, summary, alike))
}

fn refused(parts: &[(&Baseline, &str)], error: MapError) -> SessionError {
    SessionError::Map {
        file: parts.first().map_or("", |(_, file)| file).into(),
        error,
    }
}

/// The file of what is believed, and what became surer from the start.
fn put_together(
    robot: &Robot,
    prior: &Prior,
    parts: &[(&Baseline, &str)],
    recordings: Vec<String>,
    [start, belief]: [&Belief; 2],
    noise: [Vec<f64>; 2],
) -> (Baseline, MergeSummary) {
    let end_time_ns = parts.iter().map(|(b, _)| b.end_time_ns).max().unwrap_or(0);
    let baseline = Baseline::new(robot, recordings.clone(), end_time_ns, belief, noise);
    let summary = MergeSummary {
        robot: robot.name.clone(),
        recordings,
        temperature_c: baseline.temperature_c,
        nuisance: nuisance(prior, robot, start, belief),
    };
    (baseline, summary)
}

/// What each of several baselines learned from their common start, at one temperature.
struct Learned {
    /// All they rest on.
    recordings: Vec<String>,
    start: Belief,
    /// Of each what it believed before and after.
    parts: Vec<[Belief; 2]>,
}

impl Learned {
    fn of(
        robot: &Robot,
        prior: &Prior,
        parts: &[(&Baseline, &str)],
        common: Option<(&Baseline, &str)>,
        fleet: bool,
    ) -> Result<Self, SessionError> {
        let recordings = check_recordings(parts, common, fleet)?;
        let reference_c = reference(parts, common)?;
        let mut start = match common {
            None => prior.belief(Payload::Unknown, UNKNOWN_OFFSET_RAD),
            Some((baseline, file)) => {
                // Whoever goes on from a baseline after a pause believes it a little less.
                let mut belief = baseline.belief(robot, prior, file)?;
                beliefs::age(prior, &mut belief);
                belief
            }
        };
        let mut learned = Vec::new();
        for (baseline, file) in parts {
            let mut after = baseline.belief(robot, prior, file)?;
            let mut before = start.clone();
            if common.is_none() {
                // What robot.toml says is about the recording's own temperature.
                before.temperature_c = after.temperature_c;
            }
            beliefs::refer_to(prior, &mut before, reference_c);
            beliefs::refer_to(prior, &mut after, reference_c);
            learned.push([before, after]);
        }
        if common.is_none() {
            start.temperature_c = reference_c;
        }
        Ok(Self {
            recordings,
            start,
            parts: learned,
        })
    }
}

/// Root mean square, joint by joint; as long as the shortest.
fn middle<'a>(noise: impl Iterator<Item = &'a [f64]> + Clone) -> Vec<f64> {
    let joints = noise.clone().map(<[f64]>::len).min().unwrap_or(0);
    let parts = noise.clone().count().max(1) as f64;
    (0..joints)
        .map(|i| (noise.clone().map(|n| n[i] * n[i]).sum::<f64>() / parts).sqrt())
        .collect()
}

/// All recordings the result rests on: every file must go on from the common one, and none may
/// count twice.
fn check_recordings(
    parts: &[(&Baseline, &str)],
    common: Option<(&Baseline, &str)>,
    fleet: bool,
) -> Result<Vec<String>, SessionError> {
    let wrong = |file: &str, why: String| SessionError::Baseline {
        file: file.into(),
        why,
    };
    if parts.len() < 2 {
        let file = parts.first().map_or("merge", |(_, file)| file);
        return Err(wrong(
            file,
            "is alone; merging needs two files or more".into(),
        ));
    }
    if let (true, Some((_, file))) = (fleet, common) {
        return Err(wrong(
            file,
            "robots of a type have no common start but robot.toml; leave --common out".into(),
        ));
    }
    let known = common.map_or_else(Vec::new, |(c, _)| c.rests_on());
    let mut seen: Vec<(String, &str)> = Vec::new();
    for (part, file) in parts {
        let whole = part.rests_on();
        let rest = whole.strip_prefix(&known[..]).filter(|r| !r.is_empty());
        let Some(rest) = rest else {
            return Err(wrong(
                file,
                format!(
                    "does not go on from {}: it rests on {}, that on {}",
                    common.map_or("", |(_, file)| file),
                    whole.join(", "),
                    known.join(", ")
                ),
            ));
        };
        if common.is_none() && rest.len() > 1 {
            return Err(wrong(
                file,
                format!(
                    "rests on {} recordings; name the file all of them started from with --common",
                    rest.len()
                ),
            ));
        }
        for name in rest {
            // Robots of a type may be recorded under the same name.
            if let (false, Some((_, other))) = (fleet, seen.iter().find(|(n, _)| n == name)) {
                return Err(wrong(
                    file,
                    format!("rests on {name} as {other} does; it would count twice"),
                ));
            }
            seen.push((name.clone(), file));
        }
    }
    Ok(known
        .into_iter()
        .chain(seen.into_iter().map(|(name, _)| name))
        .collect())
}

/// The temperature the result refers to: the common file's, else the last recording's.
fn reference(
    parts: &[(&Baseline, &str)],
    common: Option<(&Baseline, &str)>,
) -> Result<f64, SessionError> {
    let with = parts.iter().find(|(b, _)| b.temperature_c.is_some());
    let without = parts.iter().find(|(b, _)| b.temperature_c.is_none());
    if let (Some((_, with)), Some((_, without))) = (with, without) {
        return Err(SessionError::Baseline {
            file: (*without).into(),
            why: format!(
                "was learned without a temperature, {with} with one; stiffness can't be put together then"
            ),
        });
    }
    let last = parts.iter().map(|(b, _)| *b).max_by(|a, b| {
        let end = a.end_time_ns.cmp(&b.end_time_ns);
        end.then_with(|| {
            a.temperature_c
                .partial_cmp(&b.temperature_c)
                .unwrap_or(std::cmp::Ordering::Equal)
        })
    });
    let common = common.and_then(|(c, _)| c.temperature_c);
    Ok(common
        .or(last.and_then(|b| b.temperature_c))
        .unwrap_or(f64::NAN))
}

/// Everything but offsets and payload, before and after.
fn nuisance(prior: &Prior, robot: &Robot, before: &Belief, after: &Belief) -> Vec<NuisanceChange> {
    /// What is held fixed isn't estimated.
    const FIXED: f64 = 1e-8;
    (0..prior.payload_place())
        .filter_map(|k| {
            let entry = prior.describe(k)?;
            entry.joint?;
            let (prior_, posterior) = (before.entry(k), after.entry(k));
            if prior.parameter(k)?.kind.is_none() || prior_.deviation < FIXED {
                return None;
            }
            Some(NuisanceChange::new(&entry, robot, [prior_, posterior]))
        })
        .collect()
}
