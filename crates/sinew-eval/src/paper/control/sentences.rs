//! What is said of stretched ropes, judged.

use super::super::Sentence;
use super::super::sentence::{below, near};
use super::super::staircase::STEPS;
use super::super::trial::{difference, peak};
use super::cases::{OFFSET_RAD, Row, STIFFNESS_ERROR};
use super::climb::{Climb, false_torque_nm};

/// Closed forms on the paper's motion.
pub(super) fn climbing([new, blind, corrected]: &[Climb; 3]) -> Vec<Sentence> {
    let rests = |c: &Climb, values: &[Vec<f64>; 2]| -> Vec<f64> {
        (0..=STEPS)
            .flat_map(|k| values.iter().map(move |v| c.at_rest(v, k)))
            .collect()
    };
    let positions = rests(corrected, &corrected.error_mrad);
    let as_new = difference(&positions, &rests(new, &new.error_mrad));
    let torques = rests(corrected, &corrected.tau_ext_nm);
    let mut out = Vec::new();
    for (slot, (joint, k)) in [("shoulder", 40.0), ("elbow", 20.0)]
        .into_iter()
        .enumerate()
    {
        out.push(near(
            format!("Elongation spoils the position: a rope 10 mrad longer leaves the {joint} 10 mrad short at 90°."),
            "by hand: (1 + g'(1/K + 1/K_P)) e = −delta_e, and g' = 0 where the arm is level",
            blind.at_rest(&blind.error_mrad[slot], STEPS),
            -1e3 * OFFSET_RAD,
            0.02,
            "mrad",
        ));
        out.push(near(
            format!(
                "It spoils the torque: the {joint} feels a contact of −K delta_e that isn't there."
            ),
            &format!("{k} N·m/rad · 10 mrad; at rest at 90°"),
            blind.at_rest(&blind.tau_ext_nm[slot], STEPS),
            false_torque_nm(k),
            0.02,
            "N·m",
        ));
    }
    out.push(below(
        "With theta_set = q_d + x(tau_d) + delta_e the joints reach the wanted position",
        "largest mean error over five rests and both joints, as in Fig. 6; what remains is the swing after a move",
        peak(&positions),
        0.1,
        "mrad",
    ));
    out.push(below(
        "as they do with new ropes.",
        "largest difference from new ropes; by hand: none at all",
        peak(&as_new),
        1e-3,
        "mrad",
    ));
    out.push(below(
        "With the corrected torque nothing seems to touch.",
        "largest mean external torque over five rests and both joints",
        peak(&torques),
        0.001,
        "N·m",
    ));
    out
}

/// What the table says.
pub(super) fn working(rows: &[Row]) -> Vec<Sentence> {
    let row = |robot: &str, knows: &str| rows.iter().find(|r| r.robot == robot && r.knows == knows);
    let mut out = Vec::new();
    let described = "stretched";
    let (Some(new), Some(blind), Some(known), Some(dynamic), Some(estimate)) = (
        row("new ropes", "nothing"),
        row(described, "nothing"),
        row(described, "true"),
        row(described, "dynamic"),
        row(described, "estimate"),
    ) else {
        return out;
    };
    position(&mut out, new, blind, known, dynamic, estimate);
    contacts(&mut out, new, blind, estimate);
    for (robot, deflection_mrad) in [("K −20 %", 3635.0 / 32.0), ("K +20 %", 3635.0 / 48.0)] {
        let (Some(offset), Some(both)) = (row(robot, "estimate"), row(robot, "+ stiffness")) else {
            continue;
        };
        let left = STIFFNESS_ERROR * deflection_mrad;
        out.push(Sentence {
            text: format!("{robot}: correcting the offset alone is not enough; with the stiffness estimated along it is."),
            criterion: format!(
                "rest error of the shoulder with both at most new ropes' {:.1} plus {left:.1} mrad ({:.0} % of the spring's largest deflection), and at most half of that with the offset alone ({:.1} mrad)",
                new.rest_mrad[0], 100.0 * STIFFNESS_ERROR, offset.rest_mrad[0]
            ),
            value: both.rest_mrad[0],
            unit: "mrad".into(),
            holds: both.rest_mrad[0] <= new.rest_mrad[0] + left
                && both.rest_mrad[0] <= 0.5 * offset.rest_mrad[0],
        });
    }
    for robot in ["K +20 %", "M −10 %"] {
        let (Some(before), Some(after)) = (row(robot, "nothing"), row(robot, "estimate")) else {
            continue;
        };
        out.push(Sentence {
            text: format!("{robot}: the wrong model and the stretch hide each other; correcting the offset alone uncovers the model's error."),
            criterion: format!(
                "rest error of the shoulder larger with the offset corrected than without ({:.1} mrad)",
                before.rest_mrad[0]
            ),
            value: after.rest_mrad[0],
            unit: "mrad".into(),
            holds: after.rest_mrad[0] > before.rest_mrad[0],
        });
    }
    for robot in ["M −10 %", "M +10 %"] {
        let (Some(before), Some(after), Some(told)) = (
            row(robot, "nothing"),
            row(robot, "estimate"),
            row(robot, "+ tolerance"),
        ) else {
            continue;
        };
        out.push(Sentence {
            text: format!("{robot}: the false contact stays when the offset is corrected; a threshold told of the tolerances stays quiet."),
            criterion: format!("false alarm at most 2 % of the free time with tolerances (offset corrected without them: {:.1} %, uncorrected: {:.1} %)", after.contacts.false_percent(), before.contacts.false_percent()),
            value: told.contacts.false_percent(),
            unit: "% of the free time".into(),
            holds: told.contacts.false_percent() <= 2.0,
        });
    }
    out
}

fn position(
    out: &mut Vec<Sentence>,
    new: &Row,
    blind: &Row,
    known: &Row,
    dynamic: &Row,
    estimate: &Row,
) {
    for (slot, joint) in ["shoulder pitch", "elbow"].into_iter().enumerate() {
        out.push(Sentence {
            text: format!("At work, correcting with the estimate brings the {joint} at rest back to where it is with new ropes."),
            criterion: format!(
                "RMS at rest within 0.5 mrad of new ropes' {:.2} mrad (joint friction, encoders); uncorrected {:.2} mrad, true offset {:.2} mrad",
                new.rest_mrad[slot], blind.rest_mrad[slot], known.rest_mrad[slot]
            ),
            value: estimate.rest_mrad[slot],
            unit: "mrad".into(),
            holds: (estimate.rest_mrad[slot] - new.rest_mrad[slot]).abs() <= 0.5,
        });
    }
    out.push(Sentence {
        text: "While moving, inertia bends the springs more than the rope has stretched: there only the dynamic set-point helps.".into(),
        criterion: format!(
            "RMS over the whole session with the dynamic set-point at most half of that with the static one ({:.1} mrad; new ropes {:.1}, uncorrected {:.1}), shoulder pitch",
            known.motion_mrad[0], new.motion_mrad[0], blind.motion_mrad[0]
        ),
        value: dynamic.motion_mrad[0],
        unit: "mrad".into(),
        holds: dynamic.motion_mrad[0] <= 0.5 * known.motion_mrad[0],
    });
}

fn contacts(out: &mut Vec<Sentence>, new: &Row, blind: &Row, estimate: &Row) {
    out.push(Sentence {
        text:
            "It spoils collision detection: thresholds that fit new ropes alarm without a contact."
                .into(),
        criterion: format!(
            "false alarm for at least 20 % of the time without contact (new ropes: {:.2} %)",
            new.contacts.false_percent()
        ),
        value: blind.contacts.false_percent(),
        unit: "% of the free time".into(),
        holds: blind.contacts.false_percent() >= 20.0,
    });
    out.push(Sentence {
        text: "Corrected with the estimate, they are as quiet as with new ropes,".into(),
        criterion: "false alarm at most 0.5 % of the free time more than with new ropes".into(),
        value: estimate.contacts.false_percent(),
        unit: "% of the free time".into(),
        holds: estimate.contacts.false_percent() <= new.contacts.false_percent() + 0.5,
    });
    out.push(Sentence {
        text: "and miss no more contacts.".into(),
        criterion: format!(
            "missed at most 3 % of the contacts more than with new ropes ({:.1} % of {}); uncorrected {:.1} %",
            new.contacts.missed_percent(),
            new.contacts.contacts,
            blind.contacts.missed_percent()
        ),
        value: estimate.contacts.missed_percent(),
        unit: "% of the contacts".into(),
        holds: estimate.contacts.missed_percent() <= new.contacts.missed_percent() + 3.0,
    });
    out.push(Sentence {
        text: "Their alarms come no later.".into(),
        criterion: format!(
            "median delay within 10 ms of new ropes' {:.0} ms",
            new.contacts.delay_median_ms()
        ),
        value: estimate.contacts.delay_median_ms(),
        unit: "ms".into(),
        holds: (estimate.contacts.delay_median_ms() - new.contacts.delay_median_ms()).abs() <= 10.0,
    });
    let quiet = blind.sensitivities.iter().find(|(factor, score)| {
        *factor > 1.0 && score.false_percent() <= estimate.contacts.false_percent().max(0.5)
    });
    if let Some((factor, score)) = quiet {
        out.push(Sentence {
            text: "Uncorrected, the threshold has to be opened until it is quiet,".into(),
            criterion: format!(
                "to at least twice the corrected one's {:.2} N·m at the shoulder, for at most 0.5 % false alarm",
                estimate.threshold_nm[0]
            ),
            value: *factor,
            unit: "times the threshold".into(),
            holds: *factor >= 2.0,
        });
        out.push(Sentence {
            text: "which costs contacts.".into(),
            criterion: format!(
                "it then misses at least half again as many as corrected ({:.1} %)",
                estimate.contacts.missed_percent()
            ),
            value: score.missed_percent(),
            unit: "% of the contacts".into(),
            holds: score.missed_percent() >= 1.5 * estimate.contacts.missed_percent(),
        });
    }
}
