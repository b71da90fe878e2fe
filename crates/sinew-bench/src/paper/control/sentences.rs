//! Assessed statements on stretched ropes.

use super::super::row::{Knowledge, RobotCase, Row};
use super::super::sentence::{Sentence, Unit, below, near};
use super::super::staircase::STEPS;
use super::super::trial::{difference, peak};
use super::cases::{OFFSET_RAD, STIFFNESS_ERROR};
use super::climb::{Climb, false_torque_nm};

const JOINTS: [&str; 2] = ["shoulder", "elbow"];

/// Returns the paper's statements on position and torque errors due to elongation.
pub(in super::super) fn elongation_errors(
    blind: &Climb,
    stiffness_nm_per_rad: [f64; 2],
) -> [Sentence; 2] {
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
            "Elongation causes an error of the joint position.",
            format!("with ropes 10 mrad longer shoulder and elbow each stop at least {half} mrad from the desired position at 90°"),
            short,
            Unit::Rad,
            short >= half,
        )
        .of_paper(),
        Sentence::added(
            "Elongation causes an error of the sensed torque.",
            "the shoulder's false torque; shoulder and elbow each sense a false torque of at least half of K delta_e, at rest at 90°",
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
    out.extend(elongation_errors(blind, stiffness_nm_per_rad));
    for (slot, (joint, k)) in JOINTS.into_iter().zip(stiffness_nm_per_rad).enumerate() {
        out.push(near(
            format!("A rope 10 mrad longer makes the {joint} stop 10 mrad short at 90°."),
            "analytic: (1 + g'(1/K + 1/K_P)) e = −delta_e, and g' = 0 where the arm is level",
            1e3 * blind.at_rest(&blind.error_rad[slot], STEPS),
            -1e3 * OFFSET_RAD,
            0.02,
            Unit::Rad,
        ));
        out.push(near(
            format!("The {joint} senses a false contact of −K delta_e."),
            &format!("{k} N·m/rad · 10 mrad; at rest at 90°"),
            blind.at_rest(&blind.tau_ext_nm[slot], STEPS),
            false_torque_nm(k),
            0.02,
            Unit::Nm,
        ));
    }
    out.push(below(
        "With theta_set = q_d + x(tau_d) + delta_e the joints reach the desired position",
        "largest mean error over five rests and both joints, as in Fig. 6; the remainder is the oscillation after a move",
        1e3 * peak(&positions),
        0.1,
        Unit::Rad,
    ));
    out.push(below(
        "as they do with new ropes.",
        "largest difference from new ropes; analytic: zero",
        1e3 * peak(&as_new),
        1e-3,
        Unit::Rad,
    ));
    out.push(below(
        "With the corrected torque there is no false contact.",
        "largest mean external torque over five rests and both joints",
        peak(&torques),
        0.001,
        Unit::Nm,
    ));
    out
}

/// Returns the statements on the table.
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
    let (Some(new), Some(blind), Some(corrected), Some(dynamic), Some(estimate)) = (
        row(NewRopes, Nothing),
        row(Stretched, Nothing),
        row(Stretched, True),
        row(Stretched, TrueAndDynamics),
        row(Stretched, Estimate),
    ) else {
        return out;
    };
    position(&mut out, new, blind, corrected, dynamic, estimate);
    contacts(&mut out, new, blind, estimate);
    for robot in [Softer, Stiffer] {
        let deflection_mrad = 1e3 * deflection_rad / robot.stiffness_factor();
        let (Some(offset), Some(both)) = (row(robot, Estimate), row(robot, EstimateAndStiffness))
        else {
            continue;
        };
        let (robot, left) = (robot.name(), STIFFNESS_ERROR * deflection_mrad);
        out.push(Sentence::added(
            format!("{robot}: correcting the offset alone is not enough; with the stiffness estimated jointly it is."),
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
            format!("{}: model error and elongation compensate each other; correcting the offset alone reveals the model error.", robot.name()),
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
            format!("{}: the false contact remains when the offset is corrected; a threshold that includes the tolerances gives no alarm.", robot.name()),
            format!("false alarm for at most 2 % of the contact-free time with tolerances (offset corrected without them: {:.1} %, uncorrected: {:.1} %)", after.false_percent(), before.false_percent()),
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
    corrected: &Row,
    dynamic: &Row,
    estimate: &Row,
) {
    for (slot, joint) in ["shoulder pitch", "elbow"].into_iter().enumerate() {
        out.push(Sentence::added(
            format!("During work, correction with the estimate restores the {joint} position at rest to that with new ropes."),
            format!(
                "RMS at rest within 0.5 mrad of new ropes' {:.2} mrad (joint friction, encoders); uncorrected {:.2} mrad, true offset {:.2} mrad",
                new.rest_mrad(slot), blind.rest_mrad(slot), corrected.rest_mrad(slot)
            ),
            estimate.rest_mrad(slot),
            Unit::Rad,
            (estimate.rest_mrad(slot) - new.rest_mrad(slot)).abs() <= 0.5,
        ));
    }
    out.push(Sentence::added(
        "During motion, inertia deflects the springs by more than the elongation; only the dynamic set-point reduces this error.",
        format!(
            "RMS over the whole session with the dynamic set-point at most half of that with the static one ({:.1} mrad; new ropes {:.1}, uncorrected {:.1}), shoulder pitch",
            corrected.overall_mrad(0), new.overall_mrad(0), blind.overall_mrad(0)
        ),
        dynamic.overall_mrad(0),
        Unit::Rad,
        dynamic.overall_mrad(0) <= 0.5 * corrected.overall_mrad(0),
    ));
}

fn contacts(out: &mut Vec<Sentence>, new: &Row, blind: &Row, estimate: &Row) {
    out.push(Sentence::added(
        "Elongation degrades collision detection: thresholds for new ropes cause alarms without a contact.",
        format!(
            "false alarm for at least 20 % of the contact-free time (new ropes: {:.2} %)",
            new.false_percent()
        ),
        blind.false_percent(),
        Unit::ShareOfFreeTime,
        blind.false_percent() >= 20.0,
    ));
    out.push(Sentence::added(
        "Corrected with the estimate, they cause no more false alarms than with new ropes,",
        "share of false alarms in the contact-free time exceeds that with new ropes by at most 0.5 percentage points",
        estimate.false_percent(),
        Unit::ShareOfFreeTime,
        estimate.false_percent() <= new.false_percent() + 0.5,
    ));
    out.push(Sentence::added(
        "and miss no more contacts.",
        format!(
            "share of missed contacts exceeds that with new ropes by at most 3 percentage points ({:.1} % of {}); uncorrected {:.1} %",
            new.missed_percent(),
            new.contacts.contacts,
            blind.missed_percent()
        ),
        estimate.missed_percent(),
        Unit::ShareOfContacts,
        estimate.missed_percent() <= new.missed_percent() + 3.0,
    ));
    out.push(Sentence::added(
        "Their alarms are not delayed.",
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
            "Uncorrected, the threshold has to be raised until there are no false alarms,",
            format!(
                "to at least twice the corrected one's {:.2} N·m at the shoulder, for at most 0.5 % false alarm",
                estimate.joints[0].threshold_nm
            ),
            quiet.threshold_factor,
            Unit::TimesTheThreshold,
            quiet.threshold_factor >= 2.0,
        ));
        out.push(Sentence::added(
            "which misses contacts.",
            format!(
                "it then misses at least 1.5 times as many contacts as after correction ({:.1} %)",
                estimate.missed_percent()
            ),
            missed_percent,
            Unit::ShareOfContacts,
            missed_percent >= 1.5 * estimate.missed_percent(),
        ));
    }
}
