//! Changes of stiffness in words.

use super::answer::Step;
use super::blocks::Recorded;
use super::said::Z95;
use super::watch::Watched;
use sinew_model::offset::{MapEstimate, Prior, What};
use sinew_model::robot::Robot;

/// A change of stiffness since before the recording is stated from so many standard deviations on,
/// and suspected from 95 % on: it is opened on suspicion, at every joint.
const SURE: f64 = 4.0;
/// A change of stiffness that is no surer than this isn't worth a word: a tenth is what is believed
/// before the data is seen.
const LIKELY: f64 = 0.3;

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
        let likely = map.stiffness_changed.iter().enumerate();
        for (joint, probability) in likely.filter(|(_, p)| **p > LIKELY) {
            let name = &robot.joint_names()[joint];
            out.push(format!(
                "{name}: stiffness may have changed since what was known before this recording (probability {probability:.2}): the interval holds both"
            ));
        }
        for (k, change) in map.changes.iter().enumerate() {
            let What::Compliance(joint) = change.what else {
                continue;
            };
            let [softer, unsure] = map.change(prior, k);
            if change.at_s > first_s || softer.abs() < Z95 * unsure {
                continue;
            }
            let (name, words) = (&robot.joint_names()[joint], ["lower", "higher"]);
            out.push(format!(
                "{name}: stiffness {} {:.1} ± {:.1} % {} than what was known before this recording{}",
                if softer.abs() < SURE * unsure { "seems" } else { "is" },
                100.0 * softer.abs(),
                100.0 * Z95 * unsure,
                words[usize::from(softer < 0.0)],
                if softer > 0.0 { "; strands may have failed" } else { "" },
            ));
        }
    }
    out
}
