//! Changes of stiffness in words.

use super::answer::{SinceBefore, Step};
use super::blocks::Recorded;
use super::said::Z95;
use super::watch::Watched;
use sinew_model::offset::{Change, MapEstimate, Prior, What};
use sinew_model::robot::Robot;

/// A change of stiffness since before the recording is stated from so many standard deviations on,
/// and suspected from 95 % on: it is opened on suspicion, at every joint.
const SURE: f64 = 4.0;
/// A change of stiffness that is no surer than this isn't worth a word: a tenth is what is believed
/// before the data is seen.
const LIKELY: f64 = 0.3;
/// From here on it is said to have changed.
const SURELY: f64 = 0.95;
/// What a joint's stiffness is that has become softer, or stiffer.
const WORDS: [&str; 2] = ["lower", "higher"];

/// Whether a change of stiffness came with a slip.
pub(super) fn with_slip(map: &MapEstimate, k: usize) -> bool {
    let change = map.changes[k];
    map.changes.iter().any(|c| {
        matches!((c.what, change.what), (What::Offset(a), What::Compliance(b)) if a == b)
            && c.at_s == change.at_s
    })
}

/// A change of stiffness alone; `None` for one since before `first_s` that isn't sure.
pub(super) fn alone(prior: &Prior, map: &MapEstimate, k: usize, first_s: f64) -> Option<Step> {
    let [softer, unsure] = map.change(prior, k);
    let before = map.changes[k].at_s <= first_s;
    if before && softer.abs() < SURE * unsure {
        return None;
    }
    let kind = match (softer > 0.0, before) {
        (true, true) => "softer since before",
        (false, true) => "stiffer since before",
        (true, false) => "strand failure",
        (false, false) => "stiffer",
    };
    Some(Step {
        time_s: map.changes[k].at_s.max(0.0),
        size_mrad: 0.0,
        interval_95_mrad: 0.0,
        stiffness_change_percent: Some([-100.0 * softer, 100.0 * Z95 * unsure]),
        kind: kind.into(),
        cause: String::new(),
        cause_said: String::new(),
    })
}

/// The change of a joint's stiffness since before the recording, where it was opened.
fn opened(map: &MapEstimate, joint: usize, first_s: f64) -> Option<usize> {
    let is_it = |c: &Change| c.what == What::Compliance(joint) && c.at_s <= first_s;
    map.changes.iter().position(is_it)
}

/// Whether a change of stiffness since before is worth its own words.
fn is_shown(prior: &Prior, map: &MapEstimate, k: usize) -> bool {
    let [softer, unsure] = map.change(prior, k);
    softer.abs() >= Z95 * unsure
}

/// Warnings about stiffness that seems to have changed before the recording began.
pub(super) fn suspected(
    prior: &Prior,
    robot: &Robot,
    recorded: &Recorded,
    watched: &Watched,
) -> Vec<String> {
    let mut out = Vec::new();
    for (from, map) in &watched.stretches {
        let first_s = recorded.blocks.get(*from).map_or(0.0, |b| b.time_s);
        for (joint, since) in map.stiffness_since.iter().enumerate() {
            let Some(since) = since.filter(|s| s.probability > LIKELY) else {
                continue;
            };
            if opened(map, joint, first_s).is_some_and(|k| is_shown(prior, map, k)) {
                continue;
            }
            let verb = if since.probability > SURELY {
                "is"
            } else {
                "may be"
            };
            out.push(format!(
                "{}: stiffness {verb} about {:.1} % {} than what was known before this recording (probability {:.2}); the interval allows for either",
                robot.joint_names()[joint],
                100.0 * since.softer.abs(),
                WORDS[usize::from(since.softer < 0.0)],
                since.probability,
            ));
        }
        for (k, change) in map.changes.iter().enumerate() {
            let What::Compliance(joint) = change.what else {
                continue;
            };
            if change.at_s > first_s || !is_shown(prior, map, k) {
                continue;
            }
            let [softer, unsure] = map.change(prior, k);
            let name = &robot.joint_names()[joint];
            out.push(format!(
                "{name}: stiffness {} {:.1} ± {:.1} % {} than what was known before this recording{}",
                if softer.abs() < SURE * unsure { "seems" } else { "is" },
                100.0 * softer.abs(),
                100.0 * Z95 * unsure,
                WORDS[usize::from(softer < 0.0)],
                if softer > 0.0 { "; strands may have failed" } else { "" },
            ));
        }
    }
    out
}

/// What is believed of a joint's stiffness since before the recording: by the first of its stretches.
pub(super) fn since(watched: &Watched, joint: usize) -> Option<SinceBefore> {
    let (_, map) = watched.stretches.first()?;
    let since = (*map.stiffness_since.get(joint)?)?;
    Some(SinceBefore {
        probability: since.probability,
        change_percent: -100.0 * since.softer,
    })
}
