//! Sentences about the estimate of a session.

use crate::format::{newtons, plus_minus};
use crate::units::of_joint;
use sinew_estimate::session::{
    LimitState, MotorTorque, OnlineTrajectory, ReferenceMeasurement, ReferenceOffset, Remedy,
    SessionEstimate, TendonChange, TendonChangeKind, TendonEstimate, UnobservableCombination,
    Verdict,
};
use sinew_estimate::{Cause, UnknownCause};
use sinew_figure::{Headline, Level, probability as format_probability, rounded, with_interval};
use sinew_files::names;
use sinew_model::offset::ForceEstimate;
use sinew_model::transmission::AnchorKind;
use sinew_model::{Gaussian, Interval95};

/// Formats a verdict, as tables show it.
pub fn verdict(verdict: Verdict) -> String {
    verdict.name().replace('-', " ")
}

/// Names the kind of a change.
pub(crate) fn change_kind(kind: TendonChangeKind) -> &'static str {
    match kind {
        TendonChangeKind::Slip => "slip",
        TendonChangeKind::TransmissionLost => "transmission loss",
        TendonChangeKind::StrandFailure => "strand failure",
        TendonChangeKind::SlipOrStrandFailure => "slip or strand failure",
        TendonChangeKind::Stiffer | TendonChangeKind::StiffnessIncrease => "stiffness increase",
        TendonChangeKind::Retensioned => "re-tensioned",
        TendonChangeKind::StiffnessLoss => "stiffness loss",
    }
}

/// States what the offsets refer to.
pub(crate) fn reference(session: &SessionEstimate) -> String {
    match &session.baseline {
        Some(baseline) => format!("offsets relative to the baseline {baseline}"),
        None => match session.zero_std_rad {
            Some(std) => format!(
                "offsets since the encoders were zeroed, whose zero is known to ± {} mrad (no baseline)",
                rounded(1e3 * Gaussian::new(0.0, std).half_width_95(), 2)
            ),
            None => "offsets relative to the encoder zero (no baseline)".into(),
        },
    }
}

/// Level of a result: alarm for a strand failure or an exceeded limit, watch for a change.
fn level(joint: &TendonEstimate) -> Level {
    let failures = [
        TendonChangeKind::TransmissionLost,
        TendonChangeKind::StrandFailure,
        TendonChangeKind::SlipOrStrandFailure,
    ];
    let failed = |c: &TendonChange| failures.contains(&c.kind);
    if passed_mm(joint).is_some() || joint.changes.iter().any(failed) {
        return Level::Alarm;
    }
    match joint.verdict {
        Verdict::Elongated | Verdict::Shortened | Verdict::OffsetDetected => Level::Watch,
        _ if !joint.changes.is_empty() => Level::Watch,
        Verdict::NoChangeDetected | Verdict::NoneDetected => Level::Good,
        Verdict::Inconclusive => Level::Open,
        Verdict::TransmissionLost => Level::Alarm,
    }
}

/// Formats the elongation limit that a tendon exceeds, in mm; `None` if it exceeds none.
pub(crate) fn passed_mm(joint: &TendonEstimate) -> Option<String> {
    let passed = joint.retension.filter(|r| r.state == LimitState::Passed)?;
    Some(rounded(1e3 * passed.elongation_m, 2))
}

fn limit_exceeded(joint: &TendonEstimate) -> Option<String> {
    let mm = passed_mm(joint)?;
    Some(format!(
        "elongation exceeds the limit of {mm} mm; re-tension"
    ))
}

/// States the result of a tendon in one sentence.
pub(crate) fn headline(joint: &TendonEstimate) -> Headline {
    let (name, unit) = (&joint.name, of_joint(joint.slides).offset);
    let size = |x: Gaussian| with_interval(1e3 * x.mean.abs(), 1e3 * x.std);
    let size = match joint.elongation_m {
        Some(m) => format!("{} mm", size(m)),
        None => format!("{} {unit} at the joint", size(joint.offset_rad)),
    };
    let slip = |c: &TendonChange| {
        let (kind, mrad) = (change_kind(c.kind), plus_minus(c.size_rad?, 1e3));
        Some(format!("; {kind} of {mrad} {unit} at {:.1} s", c.time_s))
    };
    let slip: String = joint.changes.iter().filter_map(slip).collect();
    let limit = limit_exceeded(joint).map_or(String::new(), |limit| format!("; {limit}")) + &slip;
    let text = match joint.verdict {
        Verdict::Elongated => format!("{name}: elongated by {size}{limit}"),
        Verdict::Shortened => format!("{name}: shortened by {size}{slip}"),
        Verdict::NoChangeDetected => format!("{name}: no change detected ({size}){slip}"),
        Verdict::OffsetDetected => {
            format!("{name}: offset detected, {size} from the encoder zero{limit}")
        }
        Verdict::NoneDetected => {
            format!("{name}: no offset from the encoder zero detected ({size}){slip}")
        }
        Verdict::TransmissionLost => {
            format!("{name}: transmission lost; the tendon transmits no torque")
        }
        Verdict::Inconclusive => match at_least(joint) {
            Some(least) => {
                format!("{name}: inconclusive; strand slack, elongation at least {least}{slip}")
            }
            None => format!("{name}: inconclusive ({size}){slip}"),
        },
    };
    Headline::new(level(joint), text)
}

/// Lists events, limits, contacts, payload and the amount of data used, one sentence each.
pub fn session_sentences(session: &SessionEstimate) -> Vec<String> {
    let mut out: Vec<String> = session.joints.iter().flat_map(of_tendon).collect();
    out.extend(session.joints.iter().filter_map(of_slack_strand));
    out.extend(session.unobservable.iter().map(of_unobservable));
    out.extend(session.unobservable.iter().flat_map(of_unattributed));
    out.extend(session.payload_changes.iter().map(|change| {
        format!(
            "payload change of {} kg {}",
            plus_minus(change.change_kg, 1.0),
            when(change.time_s, change.interval_s, change.probability)
        )
    }));
    let changes = session.joints.iter().flat_map(|j| &j.changes);
    let mut probabilities = (changes.map(|c| c.probability))
        .chain(session.payload_changes.iter().map(|c| c.probability));
    if probabilities.any(|p| p.is_some()) {
        out.push("probabilities combine this recording with an assumed event rate".into());
    }
    // One that was not specified is a warning.
    let specified = session.external_force.as_ref().filter(|f| f.is_specified);
    out.extend(specified.map(of_specified_force));
    out.push(format!(
        "payload {} kg{}; {} poses{}{}, {:.0} % of the time rejected as contact or disturbance",
        plus_minus(session.payload_kg, 1.0),
        if session.payload_changes.is_empty() {
            ""
        } else {
            " at the end"
        },
        session.poses,
        match session.motor_torque {
            MotorTorque::FromCurrent => ", motor current used",
            MotorTorque::Measured => ", motor torque used",
            MotorTorque::Unused => "",
        },
        if session.tension_used {
            ", tension used"
        } else {
            ""
        },
        100.0 * session.rejected_share,
    ));
    out
}

/// Formats the lower bound of the elongation of a slack strand, with its unit; `None` if it was taut or the bound is not positive.
pub(crate) fn at_least(joint: &TendonEstimate) -> Option<String> {
    let (least, unit) = match (joint.lower_bound_m, joint.lower_bound_rad) {
        (Some(m), _) => (m, "mm"),
        (None, Some(rad)) => (rad, of_joint(joint.slides).offset),
        (None, None) => return None,
    };
    (least > 0.0).then(|| format!("{} {unit}", rounded(1e3 * least, 2)))
}

/// Formats a linear combination of elongations with its weights, the largest of which is 1.
pub(crate) fn combination<'a>(weights: impl Iterator<Item = (&'a str, f64)>) -> String {
    let (names, weights): (Vec<&str>, Vec<f64>) = weights.unzip();
    let size = |a: f64, b: &f64| if b.abs() > a.abs() { *b } else { a };
    let largest = weights.iter().fold(0.0, size);
    let ratios: Vec<String> = (weights.iter())
        .map(|weight| match weight / largest {
            1.0 => "1".to_owned(),
            ratio => rounded(ratio, 2),
        })
        .collect();
    // Equal signs elongate both strands without joint motion: they are antagonists.
    let kind = match weights[..] {
        [a, b] if a * b > 0.0 => "the common tension",
        _ if weights.len() == 1 => "the elongation",
        _ => "a combination",
    };
    let named = match &names[..] {
        [first @ .., last] if !first.is_empty() => format!("{} and {last}", first.join(", ")),
        _ => names.join(", "),
    };
    match weights.len() {
        1 => format!("{kind} of {named}"),
        _ => format!("{kind} of {named} ({})", ratios.join(" : ")),
    }
}

/// States for how long a strand was slack, and the lower bound of its elongation.
fn of_slack_strand(joint: &TendonEstimate) -> Option<String> {
    let share = joint.slack_share?;
    let bound = match at_least(joint) {
        Some(least) => format!("elongation at least {least}"),
        None => "elongation not determinable".into(),
    };
    Some(format!(
        "{}: strand slack for {} % of the recording; {bound}",
        joint.name,
        rounded((100.0 * share).max(1.0), 2)
    ))
}

/// Lists changes that cannot be attributed to one of several tendons.
fn of_unattributed(unobservable: &UnobservableCombination) -> Vec<String> {
    let names: Vec<&str> = unobservable
        .tendons
        .iter()
        .map(|t| t.name.as_str())
        .collect();
    let changes = unobservable.changes.iter();
    changes
        .map(|change| {
            format!(
                "change of one of {} {}; tendon not identifiable from this recording",
                names.join(", "),
                when(change.time_s, change.interval_s, change.probability)
            )
        })
        .collect()
}

/// States a combination of elongations that is not observable, its interval, and the signal that determines it.
fn of_unobservable(unobservable: &UnobservableCombination) -> String {
    let tendons = unobservable.tendons.iter();
    let combination = combination(tendons.map(|t| (t.name.as_str(), t.weight)));
    let (std, unit) = match unobservable.std_m {
        Some(m) => (m, "mm"),
        None => (unobservable.std_rad, "mrad"),
    };
    let half = Gaussian::new(0.0, 1e3 * std).half_width_95();
    let remedy = remedy(
        unobservable.remedies.contains(&Remedy::MotorTorque),
        unobservable.remedies.contains(&Remedy::TensionSensors),
    );
    format!(
        "not determined: {combination}, ± {} {unit}{remedy}",
        rounded(half, 2)
    )
}

/// Names the signals that would determine an unobservable combination, as the end of a sentence.
pub(crate) fn remedy(motor_torque: bool, tension_sensors: bool) -> String {
    let record = match (motor_torque, tension_sensors) {
        (true, true) => "the torque of every motor or their tensions",
        (true, false) => "the torque of every motor",
        (false, true) => "their tensions",
        (false, false) => return String::new(),
    };
    format!("; record {record} to determine it")
}

/// States the estimate of an external force that was specified.
fn of_specified_force(force: &ForceEstimate) -> String {
    format!(
        "external force (specified, updated by the data): {} N along x, y and z of the base",
        newtons(force.force_n)
    )
}

/// States the external force of the online estimate.
pub(crate) fn external_force(force: &ForceEstimate) -> String {
    let what = match force.is_specified {
        true => "External force (specified)".into(),
        false => format!(
            "Constant external force (probability {})",
            format_probability(force.probability)
        ),
    };
    format!(
        "{what}: {} N along x, y and z of the base",
        newtons(force.force_n)
    )
}

/// Lists the time intervals in which the online estimate was provisional.
pub fn provisional_intervals(online: &OnlineTrajectory) -> String {
    let spans = online.provisional_intervals.iter().map(|d| {
        let [from, to] = [d.from_s, d.to_s].map(|s| rounded(s, 3));
        format!("{from} to {to} s")
    });
    let spans: Vec<String> = spans.collect();
    match (&spans[..], online.provisional) {
        ([], _) => "The online estimate was never provisional".into(),
        (_, true) => format!(
            "The online estimate was provisional from {}, which includes the end: use the estimate above",
            spans.join(", ")
        ),
        (_, false) => format!(
            "The online estimate was provisional from {}",
            spans.join(", ")
        ),
    }
}

/// States at which joints the online and the offline estimate are inconsistent.
pub(crate) fn online_inconsistent(joints: &[String]) -> String {
    format!(
        "{}: the online estimate is inconsistent with the estimate above, which uses the whole recording; use the estimate above",
        names::list(joints)
    )
}

/// Lists limit, changes, reference contacts and slack of a tendon.
fn of_tendon(joint: &TendonEstimate) -> Vec<String> {
    let mut out = Vec::from_iter(limit_exceeded(joint));
    let unit = of_joint(joint.slides).offset;
    out.extend(joint.changes.iter().map(|c| of_change(c, unit)));
    out.extend(joint.anchored.iter().map(|a| of_contacts(a, unit)));
    out.extend(joint.slack_rad.map(|slack| of_slack(slack, unit)));
    let out = out.into_iter();
    out.map(|text| format!("{}: {text}", joint.name)).collect()
}

/// States the slack of an antagonistic pair, or its upper bound if zero is not excluded.
pub(crate) fn of_slack(slack: Gaussian, unit: &str) -> String {
    let at_most = slack.mean + slack.half_width_95();
    if slack.mean > slack.half_width_95() {
        format!(
            "slack of {} {unit} to either side: the position is undetermined by this amount near zero torque; tension the pair of ropes",
            plus_minus(slack, 1e3)
        )
    } else if at_most > 0.0 {
        let most = rounded(1e3 * at_most, 2);
        format!(
            "no slack of the pair of ropes detected; up to {most} {unit} to either side not excluded"
        )
    } else {
        "no slack of the pair of ropes detected".into()
    }
}

/// States the kind, size, time and cause of a change.
pub(crate) fn of_change(change: &TendonChange, unit: &str) -> String {
    let stiffness = match change.stiffness_change_ratio {
        Some(ratio) => format!("stiffness change {} %", plus_minus(ratio, 100.0)),
        None => "no stiffness loss detected".into(),
    };
    let when = when(change.time_s, change.interval_s, change.probability);
    let kind = change_kind(change.kind);
    match (change.kind, change.size_rad) {
        // It has no time in this recording.
        (TendonChangeKind::StiffnessLoss | TendonChangeKind::StiffnessIncrease, _) => {
            format!("{kind} before this recording: {stiffness}")
        }
        (TendonChangeKind::TransmissionLost, _) => {
            let since = match change.interval_s {
                Some(_) => when,
                None => {
                    let probability = change.probability.map_or(String::new(), |p| {
                        format!(" (probability {})", format_probability(p))
                    });
                    format!("before this recording{probability}")
                }
            };
            format!(
                "{kind} {since}: the motion of the link shows no torque of the tendon, and motor and joint move independently; tendon torn or off its pulley, or its motor side detached; stop the robot and inspect the tendon"
            )
        }
        (_, None) => format!("{kind} {when} without slip; {stiffness}"),
        (_, Some(size)) => {
            let by = format!("of {} {unit} {when}", plus_minus(size, 1e3));
            match (change.kind, change.cause) {
                (TendonChangeKind::StrandFailure, _) => {
                    format!("strand failure with slip {by}; {stiffness}; replace the rope")
                }
                (TendonChangeKind::SlipOrStrandFailure, _) => {
                    format!(
                        "slip or strand failure {by}; type ambiguous; {stiffness}; inspect the rope"
                    )
                }
                (TendonChangeKind::Retensioned, _) => format!(
                    "re-tensioned: change {by} removes most of the offset; record a new baseline"
                ),
                (TendonChangeKind::Stiffer, _) => {
                    format!("{kind} with an offset change {by}; {stiffness}")
                }
                (_, Some(cause)) => slipped(cause, &by, &stiffness),
                (_, None) => format!("{kind} {by}; {stiffness}"),
            }
        }
    }
}

/// Lists the reference contacts of a joint and the resulting correction of its offset.
fn of_contacts(anchored: &ReferenceOffset, unit: &str) -> String {
    let what = |r: &ReferenceMeasurement| {
        let kind = match r.kind {
            AnchorKind::Stop => "stop contact",
            AnchorKind::JointMark => "joint index mark",
            AnchorKind::MotorMark => "motor index mark",
        };
        format!("{kind} at {:.1} s", r.time_s)
    };
    let contacts: Vec<String> = anchored.readings.iter().map(what).collect();
    let since = match anchored.since_baseline {
        true => "relative to the baseline contact",
        false => "relative to its specified position",
    };
    let shown = |x: Gaussian| plus_minus(x, 1e3);
    let push = anchored.by_push_rad.map_or(String::new(), |push| {
        format!("; offset by stop contact alone {} {unit}", shown(push))
    });
    format!(
        "{}: encoder error of {} {unit} {since}, offset corrected; offset by motion alone {} {unit}{push}",
        contacts.join(", "),
        shown(anchored.correction_rad),
        shown(anchored.by_motion_rad)
    )
}

/// States a slip with its cause and the evidence for it.
fn slipped(cause: Cause, by: &str, stiffness: &str) -> String {
    let encoder = |side: &str| {
        format!(
            "{side} encoder slip {by}: its signal stepped between two samples, the rope did not slip; inspect the encoder coupling"
        )
    };
    let ambiguous = |reason: &str| {
        format!("slip {by}; cause ambiguous (rope or encoder): {reason}; inspect both")
    };
    match cause {
        Cause::MotorEncoder => encoder("motor"),
        Cause::JointEncoder => encoder("joint"),
        Cause::Rope => format!(
            "rope slip {by}; {stiffness}; motor or joint moved and no encoder signal stepped; inspect clamp and rope"
        ),
        Cause::Unknown(UnknownCause::Missing) => ambiguous("samples are missing around it"),
        Cause::Unknown(UnknownCause::Noise) => ambiguous("it is below the encoder noise"),
        Cause::Unknown(UnknownCause::Rate) => ambiguous("the sampling rate is too low"),
        Cause::Unknown(UnknownCause::Both) => ambiguous("both encoder signals stepped"),
    }
}

/// Formats the time of a change with its 95 % interval and its probability.
fn when(time_s: f64, interval_s: Option<Interval95>, probability: Option<f64>) -> String {
    let (Some(Interval95 { low, high }), Some(probability)) = (interval_s, probability) else {
        return format!("at {time_s:.1} s");
    };
    format!(
        "at {time_s:.1} s ({low:.1} to {high:.1} s; probability {})",
        format_probability(probability)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn specified_force_is_reported_as_estimated() {
        let force = ForceEstimate {
            is_specified: true,
            probability: 1.0,
            force_n: [0.0, -0.12, 4.9].map(|mean| Gaussian::new(mean, 0.2)),
        };
        assert_eq!(
            of_specified_force(&force),
            "external force (specified, updated by the data): 0.00 ± 0.39, −0.12 ± 0.39, 4.90 ± 0.39 N along x, y and z of the base"
        );
    }

    #[test]
    fn change_states_time_size_and_probability() {
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
                "rope slip of 5.12 ± 0.41 mrad at 34.2 s (33.9 to 34.6 s; probability 0.95); no stiffness loss detected; motor or joint moved and no encoder signal stepped; inspect clamp and rope",
            ),
            (
                of_kind(TendonChangeKind::StrandFailure),
                "strand failure with slip of 5.12 ± 0.41 mrad at 34.2 s (33.9 to 34.6 s; probability 0.95); stiffness change −4.0 ± 1.5 %; replace the rope",
            ),
            (
                of_kind(TendonChangeKind::StiffnessLoss),
                "stiffness loss before this recording: stiffness change −4.0 ± 1.5 %",
            ),
            (
                TendonChange {
                    size_rad: None,
                    probability: Some(0.99999),
                    ..of_kind(TendonChangeKind::StrandFailure)
                },
                "strand failure at 34.2 s (33.9 to 34.6 s; probability > 0.999) without slip; stiffness change −4.0 ± 1.5 %",
            ),
        ];
        for (change, text) in cases {
            assert_eq!(of_change(&change, "mrad"), text);
        }
        assert_eq!(when(3.04, None, None), "at 3.0 s");
    }

    #[test]
    fn slack_including_zero_is_not_reported_as_slack() {
        let of = |mrad: f64, std: f64| of_slack(Gaussian::new(1e-3 * mrad, 1e-3 * std), "mm");
        assert!(of(5.0, 1.0).starts_with("slack of 5.0 ± 2.0 mm to either side"));
        assert_eq!(
            of(-0.8, 1.7),
            "no slack of the pair of ropes detected; up to 2.5 mm to either side not excluded"
        );
        assert_eq!(of(-3.0, 1.0), "no slack of the pair of ropes detected");
    }
}
