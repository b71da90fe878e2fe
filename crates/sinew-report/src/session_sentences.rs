//! What happened in a recording, in sentences.

use crate::units::Moves;
use crate::words::{newtons, plus_minus};
use sinew_estimate::session::{
    AnchorReading, AnchoredOffset, LimitState, MotorTorque, SessionEstimate, TendonChange,
    TendonChangeKind, TendonEstimate,
};
use sinew_estimate::{Cause, UnknownCause};
use sinew_figure::rounded;
use sinew_model::offset::ForceEstimate;
use sinew_model::transmission::AnchorKind;
use sinew_model::{Gaussian, Interval95};

/// What happened, a sentence each.
pub fn session_sentences(session: &SessionEstimate) -> Vec<String> {
    let mut out: Vec<String> = session.joints.iter().flat_map(of_joint).collect();
    out.extend(session.payload_changes.iter().map(|change| {
        format!(
            "payload changed by {} kg {}",
            plus_minus(change.change_kg, 1.0),
            when(change.time_s, change.interval_s, change.probability)
        )
    }));
    let changes = session.joints.iter().flat_map(|j| &j.changes);
    let mut stated = (changes.map(|c| c.probability))
        .chain(session.payload_changes.iter().map(|c| c.probability));
    if stated.any(|p| p.is_some()) {
        out.push(
            "the probabilities count this recording and a guess at how often such changes happen"
                .into(),
        );
    }
    // One that nobody stated is a warning.
    let stated = session.external_force.as_ref().filter(|f| f.is_stated);
    out.extend(stated.map(of_stated_force));
    out.push(format!(
        "payload {} kg{}; {:.0} % of the time left out as contact or disturbance; {} poses{}",
        plus_minus(session.payload_kg, 1.0),
        if session.payload_changes.is_empty() {
            ""
        } else {
            " at the end"
        },
        100.0 * session.left_out_share,
        session.poses,
        match session.motor_torque {
            MotorTorque::FromCurrent => "; motor current used",
            MotorTorque::Measured => "; motor torque used",
            MotorTorque::Unused => "",
        }
    ));
    out
}

/// What the recording made of a force that was stated: whoever stated another one sees it here.
fn of_stated_force(force: &ForceEstimate) -> String {
    format!(
        "force from outside, as stated and as the recording shows it: {} N along x, y and z of the base",
        newtons(force.force_n)
    )
}

/// What happened to a tendon.
fn of_joint(joint: &TendonEstimate) -> Vec<String> {
    let mut out = Vec::new();
    let passed = joint.retension.filter(|r| r.state == LimitState::Passed);
    out.extend(passed.map(|limit| {
        format!(
            "beyond its limit of {} mm: tension it again",
            rounded(1e3 * limit.elongation_m, 2)
        )
    }));
    let unit = joint.units().offset;
    out.extend(joint.changes.iter().map(|c| of_change(c, unit)));
    out.extend(joint.anchored.iter().map(|a| of_anchors(a, unit)));
    out.extend(joint.slack_rad.map(|slack| of_play(slack, unit)));
    let named = out
        .into_iter()
        .map(|text| format!("{}: {text}", joint.name));
    named.collect()
}

/// The play of a pair of ropes. One that may be none is no play that was seen.
fn of_play(slack: Gaussian, unit: &str) -> String {
    let at_most = slack.mean + slack.half_width_95();
    if slack.mean > slack.half_width_95() {
        format!(
            "play of {} {unit} to either side: the pair of ropes is slack, and near zero torque the position is unknown by that",
            plus_minus(slack, 1e3)
        )
    } else if at_most > 0.0 {
        let most = rounded(1e3 * at_most, 2);
        format!(
            "no play of the pair of ropes is seen; up to {most} {unit} to either side could not be told"
        )
    } else {
        "no play of the pair of ropes is seen".into()
    }
}

fn of_change(change: &TendonChange, unit: &str) -> String {
    let stiffness = match change.stiffness_change_ratio {
        Some(ratio) => format!("stiffness {} %", plus_minus(ratio, 100.0)),
        None => "no loss of stiffness seen".into(),
    };
    let when = when(change.time_s, change.interval_s, change.probability);
    let kind = change_kind(change.kind);
    match (change.kind, change.size_rad) {
        // It has no time in this recording.
        (TendonChangeKind::SofterSinceBefore | TendonChangeKind::StifferSinceBefore, _) => {
            format!("{kind}: {stiffness}")
        }
        (_, None) => format!("{kind} {when} without a slip: {stiffness}"),
        (_, Some(size)) => {
            let by = format!("by {} {unit} {when}", plus_minus(size, 1e3));
            match (change.kind, change.cause) {
                (TendonChangeKind::StrandFailure, _) => {
                    format!("a strand has failed and let the rope go {by}; {stiffness}")
                }
                (TendonChangeKind::SlipOrStrandFailure, _) => format!(
                    "the rope slipped or a strand failed {by}; which of the two can't be told; {stiffness}"
                ),
                (TendonChangeKind::Retensioned, _) => format!(
                    "it was tensioned again {by}: most of the offset is gone; make a new baseline"
                ),
                (_, Some(cause)) => slipped(cause, &by, &stiffness),
                (_, None) => format!("{kind} {by}; {stiffness}"),
            }
        }
    }
}

/// What was touched, and what that did to the offset.
fn of_anchors(anchored: &AnchoredOffset, unit: &str) -> String {
    let what = |r: &AnchorReading| {
        let kind = match r.kind {
            AnchorKind::Stop => "pushed against its stop",
            AnchorKind::JointMark => "passed its mark",
            AnchorKind::MotorMark => "its motor passed its mark",
        };
        format!("{kind} at {:.1} s", r.time_s)
    };
    let touched: Vec<String> = anchored.readings.iter().map(what).collect();
    let since = match anchored.since_baseline {
        true => "since the baseline touched it",
        false => "against where it is said to be",
    };
    let shown = |x: Gaussian| plus_minus(x, 1e3);
    let push = anchored.by_push_rad.map_or(String::new(), |push| {
        format!("; the push alone shows {} {unit}", shown(push))
    });
    format!(
        "{}: its encoders are off by {} {unit} {since}, which the offset is corrected for; by motion alone it was {} {unit}{push}",
        touched.join(", "),
        shown(anchored.correction_rad),
        shown(anchored.by_motion_rad)
    )
}

/// What slipped, by how much, and how that is known.
fn slipped(cause: Cause, by: &str, stiffness: &str) -> String {
    let encoder = |side: &str| {
        format!(
            "the {side} encoder slipped {by}, not the rope: its reading jumped between two samples"
        )
    };
    let open = |why: &str| format!("rope or encoder slipped {by}; which can't be told: {why}");
    match cause {
        Cause::MotorEncoder => encoder("motor"),
        Cause::JointEncoder => encoder("joint"),
        Cause::Rope => format!(
            "the rope slipped {by}; {stiffness}. Motor or joint moved, and no reading jumped"
        ),
        Cause::Unknown(UnknownCause::Missing) => open("samples are missing around it"),
        Cause::Unknown(UnknownCause::Noise) => open("it is too small for the encoders' noise"),
        Cause::Unknown(UnknownCause::Rate) => open("the recording's rate is too low"),
        Cause::Unknown(UnknownCause::Both) => open("both readings jumped"),
    }
}

/// A kind of change in a word or two.
pub(crate) fn change_kind(kind: TendonChangeKind) -> &'static str {
    match kind {
        TendonChangeKind::Slip => "slip",
        TendonChangeKind::StrandFailure => "strand failure",
        TendonChangeKind::SlipOrStrandFailure => "slip or strand failure",
        TendonChangeKind::Stiffer => "stiffer",
        TendonChangeKind::Retensioned => "re-tensioned",
        TendonChangeKind::SofterSinceBefore => "softer since before",
        TendonChangeKind::StifferSinceBefore => "stiffer since before",
    }
}

/// When a change happened, and how sure it is.
fn when(time_s: f64, interval_s: Option<Interval95>, probability: Option<f64>) -> String {
    const SURE: f64 = 0.999;
    let (Some(Interval95 { low, high }), Some(probability)) = (interval_s, probability) else {
        return format!("at {time_s:.1} s");
    };
    let sure = if probability > SURE {
        format!("> {SURE}")
    } else {
        format!("{probability:.2}")
    };
    format!("at {time_s:.1} s ({low:.1} to {high:.1} s; probability {sure})")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stated_force_is_told_as_it_was_found() {
        let force = ForceEstimate {
            is_stated: true,
            probability: 1.0,
            force_n: [0.0, -0.12, 4.9].map(|mean| Gaussian::new(mean, 0.2)),
        };
        assert_eq!(
            of_stated_force(&force),
            "force from outside, as stated and as the recording shows it: 0.00 ± 0.39, −0.12 ± 0.39, 4.90 ± 0.39 N along x, y and z of the base"
        );
    }

    #[test]
    fn what_happened_is_said_with_its_moment_size_and_how_sure_it_is() {
        let slip = TendonChange {
            kind: TendonChangeKind::Slip,
            time_s: 34.2,
            interval_s: Some(Interval95::new(33.9, 34.6)),
            probability: Some(0.95),
            size_rad: Some(Gaussian::new(5.125e-3, 0.41e-3 / 1.96)),
            stiffness_change_ratio: None,
            cause: Some(Cause::Rope),
        };
        let lost = Gaussian::new(-0.04, 0.015 / 1.96);
        let of_kind = |kind| TendonChange {
            kind,
            stiffness_change_ratio: Some(lost),
            ..slip.clone()
        };
        let cases = [
            (
                slip.clone(),
                "the rope slipped by 5.12 ± 0.41 mrad at 34.2 s (33.9 to 34.6 s; probability 0.95); no loss of stiffness seen. Motor or joint moved, and no reading jumped",
            ),
            (
                of_kind(TendonChangeKind::StrandFailure),
                "a strand has failed and let the rope go by 5.12 ± 0.41 mrad at 34.2 s (33.9 to 34.6 s; probability 0.95); stiffness −4.0 ± 1.5 %",
            ),
            (
                of_kind(TendonChangeKind::SofterSinceBefore),
                "softer since before: stiffness −4.0 ± 1.5 %",
            ),
            (
                TendonChange {
                    size_rad: None,
                    probability: Some(0.99999),
                    ..of_kind(TendonChangeKind::StrandFailure)
                },
                "strand failure at 34.2 s (33.9 to 34.6 s; probability > 0.999) without a slip: stiffness −4.0 ± 1.5 %",
            ),
        ];
        for (change, text) in cases {
            assert_eq!(of_change(&change, "mrad"), text);
        }
        assert_eq!(when(3.04, None, None), "at 3.0 s");
    }

    #[test]
    fn a_play_that_may_be_none_is_not_called_slack() {
        let of =
            |mrad: f64, deviation: f64| of_play(Gaussian::new(1e-3 * mrad, 1e-3 * deviation), "mm");
        assert!(
            of(5.0, 1.0)
                .starts_with("play of 5.0 ± 2.0 mm to either side: the pair of ropes is slack")
        );
        assert_eq!(
            of(-0.8, 1.7),
            "no play of the pair of ropes is seen; up to 2.5 mm to either side could not be told"
        );
        assert_eq!(of(-3.0, 1.0), "no play of the pair of ropes is seen");
    }
}
