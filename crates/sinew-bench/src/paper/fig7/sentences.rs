//! Statements on the runs with an added offset and a relaxed rope.

use super::super::sentence::{Sentence, Unit, below, near};
use super::super::staircase::{LENGTH_S, MOVE_S, REST_WINDOW_S, STEPS, rest_end_s};
use super::super::trial::{Trial, difference, mean, peak, std};
use super::plant::MOTOR_NOISE_RAD;
use super::{ADDED_RAD, RELAXED_M, RETENSION_ERROR_M, Runs};

/// One step of a 13-bit encoder, mrad.
pub(super) const ENCODER_STEP_MRAD: f64 = 0.77;

/// Values at the four rests after the first move, rad.
pub(super) fn rests(trial: &Trial, curve: &[f64]) -> [f64; STEPS] {
    std::array::from_fn(|k| trial.at_rest(curve, k + 1))
}

/// Largest deviation from a value over the rests, mrad.
fn worst_mrad(rests: &[f64; STEPS], from_rad: f64) -> f64 {
    let apart = rests.iter().map(|v| (v - from_rad).abs());
    1e3 * apart.fold(0.0, f64::max)
}

pub(super) fn sentences(
    trial: &Trial,
    paper: &Runs,
    matched: &Runs,
    radius_m: f64,
) -> Vec<Sentence> {
    let against_first = |curve: &[f64]| rests(trial, &difference(curve, &paper.first));
    let added = against_first(&paper.added);
    let grown = against_first(&paper.relaxed);
    let back = against_first(&paper.again);
    let in_motion = difference(&matched.added, &matched.first);
    let in_motion: Vec<f64> = trial
        .between(&in_motion, rest_end_s(0) + MOVE_S, LENGTH_S)
        .iter()
        .map(|v| v - ADDED_RAD)
        .collect();
    let at_start = |curve: &[f64]| trial.at_rest(curve, 0);
    vec![
        near(
            "On the robot the difference of two runs shows the added 0.01 rad.",
            "mean over the four rests",
            1e3 * mean(&added),
            1e3 * ADDED_RAD,
            0.1,
            Unit::Rad,
        )
        .of_paper(),
        relaxed(&grown, radius_m),
        below(
            "Re-tensioning restores the first estimate.",
            "largest deviation from the first run over the four rests; one step of the joint encoder and the position error of the tensioner",
            worst_mrad(&back, 0.0),
            ENCODER_STEP_MRAD + 1e3 * RETENSION_ERROR_M / radius_m,
            Unit::Rad,
        )
        .of_paper(),
        absolute(&rests(trial, &paper.added), &added),
        noise(trial, &paper.first),
        start(at_start(&paper.relaxed), at_start(&paper.added), radius_m),
        below(
            "The difference shows the added offset at every rest.",
            "largest deviation from 10 mrad over the four rests; one step of the joint encoder",
            worst_mrad(&added, ADDED_RAD),
            ENCODER_STEP_MRAD,
            Unit::Rad,
        ),
        below(
            "In the matched comparison the difference shows the offset during motion too.",
            "largest deviation from 10 mrad from the end of the first move on; two steps of the joint encoder",
            1e3 * peak(&in_motion),
            2.0 * ENCODER_STEP_MRAD,
            Unit::Rad,
        ),
        near(
            "Relaxing the rope raises the estimate by its length over the pulley radius.",
            "mean over the four rests; analytic: 0.5 mm over the pulley radius",
            1e3 * mean(&grown),
            1e3 * RELAXED_M / radius_m,
            0.1,
            Unit::Rad,
        ),
    ]
}

/// Estimate with the added offset, and its difference from the first run.
fn absolute(estimate: &[f64; STEPS], difference: &[f64; STEPS]) -> Sentence {
    let off = worst_mrad(estimate, ADDED_RAD);
    let apart = worst_mrad(difference, ADDED_RAD);
    Sentence::added(
        "On the robot the absolute value is no longer correct; the difference is.",
        format!("over the four rests the estimate deviates from the added 10 mrad by at least 1 mrad, and the difference of the runs by at most one step of the joint encoder, {ENCODER_STEP_MRAD} mrad (found: {apart:.2} mrad)"),
        off,
        Unit::Rad,
        off >= 1.0 && apart <= ENCODER_STEP_MRAD,
    )
    .of_paper()
}

/// Scatter of the estimate before the first move: without noise of the sensors it is zero.
fn noise(trial: &Trial, curve: &[f64]) -> Sentence {
    let end = rest_end_s(0);
    let scatter = 1e3 * std(trial.between(curve, end - REST_WINDOW_S, end));
    let least = 0.5e3 * MOTOR_NOISE_RAD;
    Sentence::added(
        "The noise of the estimate grows on the robot.",
        format!("standard deviation before the first move at least {least} mrad, half of the assumed noise of the motor position; with the perfect sensors of fig6 it is zero"),
        scatter,
        Unit::Rad,
        scatter >= least,
    )
    .of_paper()
}

/// Estimates before the first move: a relaxed rope shifts the arm, an offset added to a motor position of zero does not
/// exist.
fn start(relaxed_rad: f64, added_rad: f64, radius_m: f64) -> Sentence {
    let half = 0.5e3 * RELAXED_M / radius_m;
    let added = 1e3 * added_rad.abs();
    Sentence::added(
        "After the rope is relaxed the offset does not start from zero.",
        format!("before the first move the estimate is at least {half:.0} mrad, half of 0.5 mm over the pulley radius; with an offset added to the recording it is within a step of the joint encoder of zero (found: {added:.2} mrad)"),
        1e3 * relaxed_rad,
        Unit::Rad,
        1e3 * relaxed_rad >= half && added <= ENCODER_STEP_MRAD,
    )
    .of_paper()
}

/// The effect of the relaxed rope exceeds the variation between runs.
fn relaxed(grown: &[f64; STEPS], radius_m: f64) -> Sentence {
    let least = 1e3 * grown.iter().copied().fold(f64::INFINITY, f64::min);
    let half = 0.5e3 * RELAXED_M / radius_m;
    Sentence::added(
        "Relaxing the rope by about 0.5 mm at the tensioner is detected.",
        format!("smallest rise over the first run at the four rests is at least {half:.0} mrad, half of 0.5 mm over the pulley radius"),
        least,
        Unit::Rad,
        least >= half,
    )
    .of_paper()
}
