//! Sentences on stretched ropes, judged.

use super::super::row::{Knowledge, RobotCase, Row};
use super::super::sentence::{Sentence, Unit, below, near};
use super::super::staircase::STEPS;
use super::super::trial::{difference, peak};
use super::cases::{OFFSET_RAD, STIFFNESS_ERROR};
use super::climb::{Climb, false_torque_nm};

const JOINTS: [&str; 2] = ["shoulder", "elbow"];

/// What the paper says that elongation spoils.
pub(in super::super) fn spoiled(blind: &Climb, stiffness_nm_per_rad: [f64; 2]) -> [Sentence; 2] {
    let least = |values: &[Vec<f64>; 2]| -> Vec<f64> {
        values
            .iter()
            .map(|v| blind.at_rest(v, STEPS).abs())
            .collect()
    };
    let short = 1e3
        * least(&blind.error_rad)
            .into_iter()
            .fold(f64::INFINITY, f64::min);
    let torques = least(&blind.tau_ext_nm);
    let share = torques
        .iter()
        .zip(stiffness_nm_per_rad)
        .map(|(nm, k)| nm / false_torque_nm(k).abs())
        .fold(f64::INFINITY, f64::min);
    let half = 0.5e3 * OFFSET_RAD;
    [
        Sentence::added(
            "Elongation spoils the position of the joint.",
            format!("with ropes 10 mrad longer shoulder and elbow each stop at least {half} mrad beside the wanted position at 90°"),
            short,
            Unit::Rad,
            short >= half,
        )
        .of_paper(),
        Sentence::added(
            "Elongation spoils the torque that the robot feels.",
            "the shoulder's false torque; shoulder and elbow each feel at least half of K delta_e that isn't there, at rest at 90°",
            torques[0],
            Unit::Nm,
            share >= 0.5,
        )
        .of_paper(),
    ]
}

/// Closed forms on the paper's motion.
pub(super) fn climbing(
    [new, blind, corrected]: &[Climb; 3],
    stiffness_nm_per_rad: [f64; 2],
) -> Vec<Sentence> {
    let rests = |c: &Climb, values: &[Vec<f64>; 2]| -> Vec<f64> {
        (0..=STEPS)
            .flat_map(|k| values.iter().map(move |v| c.at_rest(v, k)))
            .collect()
    };
    let positions = rests(corrected, &corrected.error_rad);
    let as_new = difference(&positions, &rests(new, &new.error_rad));
    let torques = rests(corrected, &corrected.tau_ext_nm);
    let mut out = Vec::new();
    out.extend(spoiled(blind, stiffness_nm_per_rad));
    for (slot, (joint, k)) in JOINTS.into_iter().zip(stiffness_nm_per_rad).enumerate() {
        out.push(near(
            format!("A rope 10 mrad longer leaves the {joint} 10 mrad short at 90°."),
            "by hand: (1 + g'(1/K + 1/K_P)) e = −delta_e, and g' = 0 where the arm is level",
            1e3 * blind.at_rest(&blind.error_rad[slot], STEPS),
            -1e3 * OFFSET_RAD,
            0.02,
            Unit::Rad,
        ));
        out.push(near(
            format!("The {joint} feels a contact of −K delta_e that isn't there."),
            &format!("{k} N·m/rad · 10 mrad; at rest at 90°"),
            blind.at_rest(&blind.tau_ext_nm[slot], STEPS),
            false_torque_nm(k),
            0.02,
            Unit::Nm,
        ));
    }
    out.push(below(
        "With theta_set = q_d + x(tau_d) + delta_e the joints reach the wanted position",
        "largest mean error over five rests and both joints, as in Fig. 6; what remains is the swing after a move",
        1e3 * peak(&positions),
        0.1,
        Unit::Rad,
    ));
    out.push(below(
        "as they do with new ropes.",
        "largest difference from new ropes; by hand: none at all",
        1e3 * peak(&as_new),
        1e-3,
        Unit::Rad,
    ));
    out.push(below(
        "With the corrected torque nothing seems to touch.",
        "largest mean external torque over five rests and both joints",
        peak(&torques),
        0.001,
        Unit::Nm,
    ));
    out
}

/// What the table says.
pub(super) fn working(rows: &[Row], deflection_rad: f64) -> Vec<Sentence> {
    use Knowledge::{
        Estimate, EstimateAndStiffness, EstimateAndTolerances, Nothing, True, TrueAndDynamics,
    };
    use RobotCase::{Heavier, Lighter, NewRopes, Softer, Stiffer, Stretched};
    let row = |robot: RobotCase, knowledge: Knowledge| {
        let is = |r: &&Row| r.robot == robot && r.knowledge == knowledge;
        rows.iter().find(is)
    };
    let mut out = Vec::new();
    let (Some(new), Some(blind), Some(known), Some(dynamic), Some(estimate)) = (
        row(NewRopes, Nothing),
        row(Stretched, Nothing),
        row(Stretched, True),
        row(Stretched, TrueAndDynamics),
        row(Stretched, Estimate),
    ) else {
        return out;
    };
    position(&mut out, new, blind, known, dynamic, estimate);
    contacts(&mut out, new, blind, estimate);
    for robot in [Softer, Stiffer] {
        let deflection_mrad = 1e3 * deflection_rad / robot.stiffness_factor();
        let (Some(offset), Some(both)) = (row(robot, Estimate), row(robot, EstimateAndStiffness))
        else {
            continue;
        };
        let (robot, left) = (robot.name(), STIFFNESS_ERROR * deflection_mrad);
        out.push(Sentence::added(
            format!("{robot}: correcting the offset alone is not enough; with the stiffness estimated along it is."),
            format!(
                "rest error of the shoulder with both at most new ropes' {:.1} plus {left:.1} mrad ({:.0} % of the spring's largest deflection), and at most half of that with the offset alone ({:.1} mrad)",
                new.rest_mrad(0), 100.0 * STIFFNESS_ERROR, offset.rest_mrad(0)
            ),
            both.rest_mrad(0),
            Unit::Rad,
            both.rest_mrad(0) <= new.rest_mrad(0) + left
                && both.rest_mrad(0) <= 0.5 * offset.rest_mrad(0),
        ));
    }
    for robot in [Stiffer, Lighter] {
        let (Some(before), Some(after)) = (row(robot, Nothing), row(robot, Estimate)) else {
            continue;
        };
        out.push(Sentence::added(
            format!("{}: the wrong model and the stretch hide each other; correcting the offset alone uncovers the model's error.", robot.name()),
            format!(
                "rest error of the shoulder larger with the offset corrected than without ({:.1} mrad)",
                before.rest_mrad(0)
            ),
            after.rest_mrad(0),
            Unit::Rad,
            after.rest_mrad(0) > before.rest_mrad(0),
        ));
    }
    for robot in [Lighter, Heavier] {
        let (Some(before), Some(after), Some(tolerant)) = (
            row(robot, Nothing),
            row(robot, Estimate),
            row(robot, EstimateAndTolerances),
        ) else {
            continue;
        };
        out.push(Sentence::added(
            format!("{}: the false contact stays when the offset is corrected; a threshold told of the tolerances stays quiet.", robot.name()),
            format!("false alarm at most 2 % of the free time with tolerances (offset corrected without them: {:.1} %, uncorrected: {:.1} %)", after.false_percent(), before.false_percent()),
            tolerant.false_percent(),
            Unit::ShareOfFreeTime,
            tolerant.false_percent() <= 2.0,
        ));
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
        out.push(Sentence::added(
            format!("At work, correcting with the estimate brings the {joint} at rest back to where it is with new ropes."),
            format!(
                "RMS at rest within 0.5 mrad of new ropes' {:.2} mrad (joint friction, encoders); uncorrected {:.2} mrad, true offset {:.2} mrad",
                new.rest_mrad(slot), blind.rest_mrad(slot), known.rest_mrad(slot)
            ),
            estimate.rest_mrad(slot),
            Unit::Rad,
            (estimate.rest_mrad(slot) - new.rest_mrad(slot)).abs() <= 0.5,
        ));
    }
    out.push(Sentence::added(
        "While moving, inertia bends the springs more than the rope has stretched: there only the dynamic set-point helps.",
        format!(
            "RMS over the whole session with the dynamic set-point at most half of that with the static one ({:.1} mrad; new ropes {:.1}, uncorrected {:.1}), shoulder pitch",
            known.overall_mrad(0), new.overall_mrad(0), blind.overall_mrad(0)
        ),
        dynamic.overall_mrad(0),
        Unit::Rad,
        dynamic.overall_mrad(0) <= 0.5 * known.overall_mrad(0),
    ));
}

fn contacts(out: &mut Vec<Sentence>, new: &Row, blind: &Row, estimate: &Row) {
    out.push(Sentence::added(
        "It spoils collision detection: thresholds that fit new ropes alarm without a contact.",
        format!(
            "false alarm for at least 20 % of the time without contact (new ropes: {:.2} %)",
            new.false_percent()
        ),
        blind.false_percent(),
        Unit::ShareOfFreeTime,
        blind.false_percent() >= 20.0,
    ));
    out.push(Sentence::added(
        "Corrected with the estimate, they are as quiet as with new ropes,",
        "false alarm at most 0.5 % of the free time more than with new ropes",
        estimate.false_percent(),
        Unit::ShareOfFreeTime,
        estimate.false_percent() <= new.false_percent() + 0.5,
    ));
    out.push(Sentence::added(
        "and miss no more contacts.",
        format!(
            "missed at most 3 % of the contacts more than with new ropes ({:.1} % of {}); uncorrected {:.1} %",
            new.missed_percent(),
            new.contacts.contacts,
            blind.missed_percent()
        ),
        estimate.missed_percent(),
        Unit::ShareOfContacts,
        estimate.missed_percent() <= new.missed_percent() + 3.0,
    ));
    out.push(Sentence::added(
        "Their alarms come no later.",
        format!(
            "median delay within 10 ms of new ropes' {:.0} ms",
            new.delay_median_ms()
        ),
        estimate.delay_median_ms(),
        Unit::S,
        (estimate.delay_median_ms() - new.delay_median_ms()).abs() <= 10.0,
    ));
    let quiet = blind.sensitivities.iter().find(|s| {
        let false_percent = 100.0 * s.contacts.false_share();
        s.threshold_factor > 1.0 && false_percent <= estimate.false_percent().max(0.5)
    });
    if let Some(quiet) = quiet {
        let missed_percent = 100.0 * quiet.contacts.missed_share();
        out.push(Sentence::added(
            "Uncorrected, the threshold has to be opened until it is quiet,",
            format!(
                "to at least twice the corrected one's {:.2} N·m at the shoulder, for at most 0.5 % false alarm",
                estimate.joints[0].threshold_nm
            ),
            quiet.threshold_factor,
            Unit::TimesTheThreshold,
            quiet.threshold_factor >= 2.0,
        ));
        out.push(Sentence::added(
            "which costs contacts.",
            format!(
                "it then misses at least half again as many as corrected ({:.1} %)",
                estimate.missed_percent()
            ),
            missed_percent,
            Unit::ShareOfContacts,
            missed_percent >= 1.5 * estimate.missed_percent(),
        ));
    }
}
