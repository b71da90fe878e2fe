//! Merging of several baselines, of one robot or of robots of one type.
//!
//! Both use the information form ([`state_estimates::merge`], [`shared_parameters::pool_bodies`]), so that the common prior
//! counts once and the order has no effect.
//!
//! | | recordings of one robot | robots of one type |
//! |---|---|---|
//! | masses, first moments, inertias of the links | merged | merged, up to the scatter between robots |
//! | stiffness, stiffening, friction, encoders, gear, motor torque | merged | independent per robot: prior of robot.toml |
//! | offsets, encoder zero, slack, payload | specific to a recording: discarded | discarded |
//!
//! The stiffness of a rope depends on its termination and the error of an encoder on its mounting, so
//! parameters with a data-sheet tolerance are independent for each robot. Links are made from the
//! same drawing, and errors of the robot description are errors of that drawing.

use super::file::Baseline;
use crate::error::SessionError;
use crate::estimator::{SessionOptions, estimator};
use crate::nuisance::NuisanceChange;
use sinew_files::JsonDocument;
use sinew_model::offset::shared_parameters::{self, SharedParameters};
use sinew_model::offset::{
    MapError, Payload, Prior, StateEstimate, UNKNOWN_OFFSET_RAD, state_estimates,
};
use sinew_model::robot::Robot;

/// Options of the merging of baselines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MergeOptions {
    /// Whether the recordings are of several robots of one type.
    pub fleet: bool,
    /// Relative standard deviation of the mass difference between two robots of a type; that of
    /// first moments and inertias is in proportion to their tolerances.
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

/// Summary of merged baselines: prior and posterior of the parameters.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MergeSummary {
    /// Name of the robot.
    pub robot: String,
    /// Names of all recordings that the result is based on.
    pub recordings: Vec<String>,
    /// Reference temperature of offsets and stiffness, °C; `None` if unknown.
    pub temperature_c: Option<f64>,
    /// Prior and posterior of each nuisance parameter.
    pub nuisance: Vec<NuisanceChange>,
}

impl JsonDocument for MergeSummary {
    const SCHEMA: &'static str = "sinew/baseline-merge/2";
}

/// Merges `parts` (baselines with the names of their files), which have the common prior `common`; `None` is the
/// prior from the tolerances in robot.toml, as in `sinew baseline`.
///
/// The result is a prior for `sinew baseline --start`. Its offsets are unknown, and the
/// encoder zero is unknown too unless robot.toml specifies it.
///
/// # Errors
/// Returns [`SessionError::Baseline`] if a file belongs to another robot or stiffness, if there are fewer than two
/// files, if one is not based on `common`, if a recording would count twice, or if only some files have a temperature;
/// and [`SessionError::Map`] if the posteriors cannot be merged.
pub fn merge(
    robot: &Robot,
    parts: &[(&Baseline, &str)],
    common: Option<(&Baseline, &str)>,
    options: &MergeOptions,
) -> Result<(Baseline, MergeSummary), SessionError> {
    let estimator = estimator(robot, &SessionOptions::default());
    let prior = estimator.prior();
    let Posteriors {
        recordings,
        start,
        parts: posteriors,
    } = Posteriors::of(robot, prior, parts, common, options.fleet)?;
    let failed = |error| map_error(parts, error);
    let (state_estimate, noise) = if options.fleet {
        let scatter = (options.scatter / robot.tolerances.mass.max(1e-9)).min(1.0);
        let mut state_estimate =
            shared_parameters::pool_bodies(prior, &posteriors, scatter).map_err(failed)?;
        state_estimate.temperature_c = f64::NAN;
        (state_estimate, Default::default())
    } else {
        let mut merged = start.clone();
        prior.reset_offsets(&mut merged, UNKNOWN_OFFSET_RAD);
        prior.reset_zero(&mut merged);
        prior.reset_payload(&mut merged, Payload::Unknown);
        for [before, after] in &posteriors {
            merged = state_estimates::merge(prior, before, &merged, after).map_err(failed)?;
        }
        let rad = parts.iter().map(|(b, _)| &b.noise_rad[..]);
        let nm = parts.iter().map(|(b, _)| &b.motor_noise_nm[..]);
        (merged, [root_mean_square(rad), root_mean_square(nm)])
    };
    Ok(summarise(
        robot,
        prior,
        parts,
        recordings,
        [&start, &state_estimate],
        noise,
    ))
}

/// Estimates the prior of a further robot of a type from `parts`, baselines of robots of that type with the names of
/// their files.
///
/// Masses, stiffness, friction, encoders and drives are pooled in proportion to their estimated correlation between
/// robots. The result is a prior for `sinew baseline --start`. Its offsets are unknown, and the encoder zero is unknown
/// too unless robot.toml specifies it.
///
/// # Errors
/// As [`merge`].
pub fn pool(
    robot: &Robot,
    parts: &[(&Baseline, &str)],
) -> Result<(Baseline, MergeSummary, Vec<SharedParameters>), SessionError> {
    let estimator = estimator(robot, &SessionOptions::default());
    let prior = estimator.prior();
    let Posteriors {
        recordings,
        start,
        parts: posteriors,
    } = Posteriors::of(robot, prior, parts, None, true)?;
    let (mut state_estimate, shared) = shared_parameters::learn_type(prior, &posteriors)
        .map_err(|error| map_error(parts, error))?;
    state_estimate.temperature_c = start.temperature_c;
    let ends = [&start, &state_estimate];
    let (baseline, summary) = summarise(robot, prior, parts, recordings, ends, Default::default());
    Ok((baseline, summary, shared))
}

fn map_error(parts: &[(&Baseline, &str)], error: MapError) -> SessionError {
    SessionError::Map {
        file: parts.first().map_or("", |(_, file)| file).into(),
        error,
    }
}

/// Creates the baseline file of the posterior `state_estimate`, and the summary of its change from the prior `start`.
fn summarise(
    robot: &Robot,
    prior: &Prior,
    parts: &[(&Baseline, &str)],
    recordings: Vec<String>,
    [start, state_estimate]: [&StateEstimate; 2],
    noise: [Vec<f64>; 2],
) -> (Baseline, MergeSummary) {
    let end_time_ns = parts.iter().map(|(b, _)| b.end_time_ns).max().unwrap_or(0);
    // A prior for `--start`, without model error: that of a recording belongs to its robot and its offsets.
    let baseline = Baseline::new(
        robot,
        recordings.clone(),
        end_time_ns,
        state_estimate,
        noise,
    );
    let summary = MergeSummary {
        robot: robot.name.clone(),
        recordings,
        temperature_c: baseline.temperature_c,
        nuisance: nuisance(prior, robot, start, state_estimate),
    };
    (baseline, summary)
}

/// Priors and posteriors of several baselines with a common prior, at one reference temperature.
struct Posteriors {
    /// Names of all recordings that they are based on.
    recordings: Vec<String>,
    start: StateEstimate,
    /// Prior and posterior of each baseline.
    parts: Vec<[StateEstimate; 2]>,
}

impl Posteriors {
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
            None => prior.state_estimate(Payload::Unknown, UNKNOWN_OFFSET_RAD),
            Some((baseline, file)) => {
                // The variances of a prior grow in the time until the next recording.
                let mut state_estimate = baseline.state_estimate(robot, prior, file)?;
                state_estimates::age(prior, &mut state_estimate);
                state_estimate
            }
        };
        let mut posteriors = Vec::new();
        for (baseline, file) in parts {
            let mut after = baseline.state_estimate(robot, prior, file)?;
            let mut before = start.clone();
            if common.is_none() {
                // The prior of robot.toml refers to the temperature of the recording itself.
                before.temperature_c = after.temperature_c;
            }
            state_estimates::refer_to(prior, &mut before, reference_c);
            state_estimates::refer_to(prior, &mut after, reference_c);
            posteriors.push([before, after]);
        }
        if common.is_none() {
            start.temperature_c = reference_c;
        }
        Ok(Self {
            recordings,
            start,
            parts: posteriors,
        })
    }
}

/// Root mean square of the noise per joint; the length is that of the shortest list.
fn root_mean_square<'a>(noise: impl Iterator<Item = &'a [f64]> + Clone) -> Vec<f64> {
    let joints = noise.clone().map(<[f64]>::len).min().unwrap_or(0);
    let parts = noise.clone().count().max(1) as f64;
    (0..joints)
        .map(|i| (noise.clone().map(|n| n[i] * n[i]).sum::<f64>() / parts).sqrt())
        .collect()
}

/// Returns the names of all recordings that the result is based on.
///
/// # Errors
/// Returns [`SessionError::Baseline`] for fewer than two files, a file that is not based on the common one, or a
/// recording that would count twice.
fn check_recordings(
    parts: &[(&Baseline, &str)],
    common: Option<(&Baseline, &str)>,
    fleet: bool,
) -> Result<Vec<String>, SessionError> {
    let wrong = |file: &str, reason: String| SessionError::Baseline {
        file: file.into(),
        reason,
    };
    if parts.len() < 2 {
        let file = parts.first().map_or("merge", |(_, file)| file);
        return Err(wrong(
            file,
            "is a single file; merging requires at least two files".into(),
        ));
    }
    if let (true, Some((_, file))) = (fleet, common) {
        return Err(wrong(
            file,
            "conflicts with --fleet: the only common prior of several robots is robot.toml; leave --common out".into(),
        ));
    }
    let shared = common.map_or_else(Vec::new, |(c, _)| c.based_on());
    let mut seen: Vec<(String, &str)> = Vec::new();
    for (part, file) in parts {
        let whole = part.based_on();
        let rest = whole.strip_prefix(&shared[..]).filter(|r| !r.is_empty());
        let Some(rest) = rest else {
            return Err(wrong(
                file,
                format!(
                    "does not continue {}: it is based on {}, the common file on {}",
                    common.map_or("", |(_, file)| file),
                    whole.join(", "),
                    shared.join(", ")
                ),
            ));
        };
        if common.is_none() && rest.len() > 1 {
            return Err(wrong(
                file,
                format!(
                    "is based on {} recordings; specify the common prior with --common",
                    rest.len()
                ),
            ));
        }
        for name in rest {
            // Robots of a type may be recorded under the same name.
            if let (false, Some((_, other))) = (fleet, seen.iter().find(|(n, _)| n == name)) {
                return Err(wrong(
                    file,
                    format!("is based on {name}, as is {other}; it would count twice"),
                ));
            }
            seen.push((name.clone(), file));
        }
    }
    Ok(shared
        .into_iter()
        .chain(seen.into_iter().map(|(name, _)| name))
        .collect())
}

/// Returns the reference temperature of the result, °C: that of the common file, otherwise that of the last recording;
/// NaN if unknown.
///
/// # Errors
/// Returns [`SessionError::Baseline`] if only some files have a temperature.
fn reference(
    parts: &[(&Baseline, &str)],
    common: Option<(&Baseline, &str)>,
) -> Result<f64, SessionError> {
    let with = parts.iter().find(|(b, _)| b.temperature_c.is_some());
    let without = parts.iter().find(|(b, _)| b.temperature_c.is_none());
    if let (Some((_, with)), Some((_, without))) = (with, without) {
        return Err(SessionError::Baseline {
            file: (*without).into(),
            reason: format!(
                "was estimated without a temperature, {with} with one; their stiffness cannot be merged"
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

/// Prior and posterior of each parameter except offsets and payload.
fn nuisance(
    prior: &Prior,
    robot: &Robot,
    before: &StateEstimate,
    after: &StateEstimate,
) -> Vec<NuisanceChange> {
    /// Maximum standard deviation of a fixed parameter, which is not estimated.
    const MAX_FIXED_STD: f64 = 1e-8;
    (0..prior.payload_place())
        .filter_map(|k| {
            let entry = prior.describe(k)?;
            entry.joint?;
            let (prior_, posterior) = (before.entry(k), after.entry(k));
            if prior.parameter(k)?.kind.is_none() || prior_.std < MAX_FIXED_STD {
                return None;
            }
            Some(NuisanceChange::new(&entry, robot, [prior_, posterior]))
        })
        .collect()
}
