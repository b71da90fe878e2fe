//! Changes of stiffness in words.

use super::answer::{AbsoluteJoint, SinceBefore, Step};
use super::said::Z95;
use super::watch::Watched;
use sinew_model::Gaussian;
use sinew_model::offset::{ChangeKind, JointParameter, MapEstimate, Prior};

/// A change of stiffness since before the recording is an event from so many standard deviations on.
const SURE: f64 = 4.0;
/// A change of stiffness that is no likelier than this isn't worth a word: 0.23 is believed before the
/// data is seen.
const LIKELY: f64 = 0.3;
/// From here on it is said to have changed.
const SURELY: f64 = 0.95;

/// Stiffness gained, %, and half its 95 % interval, where the compliance over nominal rose by
/// `softer` to `after`: `K/K_before − 1 = −softer/(1 + after)`.
pub(super) fn gained_percent(after: f64, softening: Gaussian) -> [f64; 2] {
    let (softer, unsure) = (softening.mean, softening.deviation);
    let (before, after) = (1.0 + after - softer, 1.0 + after);
    [
        -100.0 * softer / after,
        100.0 * Z95 * unsure * before / (after * after),
    ]
}

/// The same for a change within a recording.
pub(super) fn change_percent(
    prior: &Prior,
    map: &MapEstimate,
    joint: usize,
    softer: Gaussian,
) -> [f64; 2] {
    let place = prior.place(joint, JointParameter::Compliance);
    gained_percent(map.belief(prior).entry(place).mean, softer)
}

/// Whether a change of stiffness came with a slip.
pub(super) fn with_slip(map: &MapEstimate, k: usize) -> bool {
    let change = map.changes[k];
    map.changes.iter().any(|c| {
        matches!((c.kind, change.kind), (ChangeKind::Offset(a), ChangeKind::Compliance(b)) if a == b)
            && c.at_s == change.at_s
    })
}

/// A change of stiffness alone; `None` for one since before `first_s` that isn't sure.
pub(super) fn alone(
    prior: &Prior,
    map: &MapEstimate,
    (k, joint): (usize, usize),
    first_s: f64,
) -> Option<Step> {
    let softening = map.change(prior, k);
    let softer = softening.mean;
    let before = map.changes[k].at_s <= first_s;
    if before && softer.abs() < SURE * softening.deviation {
        return None;
    }
    let kind = match (softer > 0.0, before) {
        (true, true) => "softer since before",
        (false, true) => "stiffer since before",
        (true, false) => "strand failure",
        (false, false) => "stiffer",
    };
    let posterior = map.posterior(&map.changes[k]);
    Some(Step {
        time_s: posterior.map_or(map.changes[k].at_s.max(0.0), |p| p.time_s),
        between_s: posterior.map(|p| [p.interval_s.low, p.interval_s.high]),
        probability: posterior.map(|p| p.probability),
        size_mrad: 0.0,
        interval_95_mrad: 0.0,
        stiffness_change_percent: Some(change_percent(prior, map, joint, softening)),
        kind: kind.into(),
        cause: String::new(),
        cause_said: String::new(),
    })
}

/// Whether a joint's stiffness has changed since before the recording: sought by its first stretch.
pub(super) fn since(prior: &Prior, watched: &Watched, joint: usize) -> Option<SinceBefore> {
    let (_, map) = watched.stretches.first()?;
    let since = (*map.stiffness_changes.get(joint)?)?;
    let place = prior.place(joint, JointParameter::Compliance);
    let mean = map.belief(prior).entry(place).mean;
    // The mean is over both; after a change the compliance is this.
    let after = mean + (1.0 - since.probability) * since.softening.mean;
    Some(SinceBefore {
        probability: since.probability,
        change_percent: gained_percent(after, since.softening),
    })
}

/// Warnings about stiffness that has, or may have, changed before the recording began.
pub(super) fn suspected(joints: &[AbsoluteJoint]) -> Vec<String> {
    let mut out = Vec::new();
    for joint in joints {
        let Some(since) = joint
            .stiffness_since_before
            .filter(|s| s.probability > LIKELY)
        else {
            continue;
        };
        let [change, unsure] = since.change_percent;
        out.push(format!(
            "{}: stiffness {} {:.1} ± {unsure:.1} % {} than what was known before this recording (probability {:.2}){}",
            joint.name,
            if since.probability > SURELY { "is" } else { "may be" },
            change.abs(),
            if change < 0.0 { "lower" } else { "higher" },
            since.probability,
            if change < 0.0 { "; strands may have failed" } else { "" },
        ));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_loss_is_of_the_stiffness_there_was() {
        // 20 % softer than nominal, then 8 % of that lost.
        let (before, after) = (1.25, 1.25 / 0.92);
        let change =
            |softer: f64| gained_percent(before + softer - 1.0, Gaussian::new(softer, 0.01));
        let [change_percent, interval] = change(after - before);
        assert!((change_percent + 8.0).abs() < 1e-12, "{change_percent}");
        let [more, _] = change(after - before + 1e-6);
        let slope = (change_percent - more) / 1e-6;
        assert!((interval - Z95 * 0.01 * slope).abs() < 1e-4, "{interval}");
    }
}
