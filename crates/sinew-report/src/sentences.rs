//! An estimate in words.

use super::shown::{MRAD_PER_PERCENT, or_nan};
use super::units::Moves;
use super::words::joint_refusal;
use sinew_estimate::replay::{Difference, Estimate, JointEstimate};
use sinew_figure::{rounded, with_interval};

/// Beyond this many standard errors a change is called seen; closer, it is said not to be.
const SEEN_ERRORS: f64 = 2.0;
/// What quantised encoders leave even in a good estimate, mrad: the upper end of what a 12–14 bit
/// encoder reaches with filter and matched comparison. The standard error can't see it, because
/// it is the same in every frame of a pose.
const ENCODER_MRAD: f64 = 0.3;
/// An error of stiffness or masses below this many percent is ordinary, so an offset that such an
/// error would show as well is no proof of stretch.
const ORDINARY_ERROR_PERCENT: f64 = 10.0;

/// One joint in one sentence: what is read, or how much longer its tendon is than in the reference.
pub fn headline(estimate: &Estimate, joint: &JointEstimate) -> String {
    let name = &joint.name;
    if let Some(why) = joint.refused {
        return format!("{name}: no estimate; {}", joint_refusal(why));
    }
    match (&joint.difference, &estimate.settings.reference) {
        (Some(d), Some(reference)) => difference(name, d, reference, joint.units().offset),
        _ => reading(name, joint),
    }
}

/// What the paper's equation reads: no verdict, for it knows nothing of an error in stiffness, masses,
/// payload or contact.
fn reading(name: &str, joint: &JointEstimate) -> String {
    let value = 1e3 * or_nan(joint.offset_rad);
    if !value.is_finite() {
        return format!("{name}: no estimate");
    }
    let error = 1e3 * or_nan(joint.standard_error_rad);
    let as_stretch = match joint
        .elongation_m
        .map(|m| 1e3 * m)
        .filter(|mm| mm.is_finite())
    {
        Some(mm) => format!(
            "what a tendon {} mm {} would show",
            rounded(mm.abs(), 2),
            if mm < 0.0 { "shorter" } else { "longer" }
        ),
        None => "robot.toml has no tendon there, so no elongation".into(),
    };
    let unknown = match error.is_finite() && error > 0.0 {
        true => " (95 %, scatter alone)",
        false => " (the recording is too short for a ±)",
    };
    format!(
        "{name}: the equation reads {} {}{unknown}; {as_stretch}",
        with_interval(value, error),
        joint.units().offset
    )
}

/// What changed since a reference.
fn difference(name: &str, d: &Difference, reference: &str, unit: &str) -> String {
    let (value, error) = (1e3 * d.difference_rad, 1e3 * or_nan(d.standard_error_rad));
    if !value.is_finite() {
        return format!("{name}: no estimate");
    }
    let mut change = format!("change {} {unit}", with_interval(value, error));
    change.push_str(match error.is_finite() && error > 0.0 {
        true => ", 95 %",
        false => "; the recording is too short for a ±",
    });
    if error.is_finite() && value.abs() < seen(error) {
        return format!("{name}: no stretch seen ({change})");
    }
    match d.elongation_m.map(|m| 1e3 * m).filter(|mm| mm.is_finite()) {
        Some(mm) => {
            let word = if mm < 0.0 { "shorter" } else { "longer" };
            let mm = rounded(mm.abs(), 2);
            format!("{name}: the tendon is {mm} mm {word} than in {reference} ({change})")
        }
        None => format!(
            "{name}: the motor stands {} {unit} further than in {reference} ({change}); robot.toml has no tendon there, so no elongation",
            rounded(value, 3)
        ),
    }
}

/// From here on a change is called seen, mrad.
fn seen(standard_error_mrad: f64) -> f64 {
    (SEEN_ERRORS * standard_error_mrad).max(ENCODER_MRAD)
}

/// How large an error of stiffness or masses would look the same, where that is worth a word.
pub(super) fn doubt(joint: &JointEstimate) -> Option<String> {
    if joint.refused.is_some() {
        return None;
    }
    let (value, per_percent, what) = match &joint.difference {
        Some(d) => (
            1e3 * d.difference_rad,
            MRAD_PER_PERCENT * d.offset_per_stiffness_error_rad,
            "difference",
        ),
        None => (
            1e3 * or_nan(joint.offset_rad),
            MRAD_PER_PERCENT * or_nan(joint.offset_per_stiffness_error_rad),
            "offset",
        ),
    };
    let error = match &joint.difference {
        Some(d) => 1e3 * or_nan(d.standard_error_rad),
        None => 1e3 * or_nan(joint.standard_error_rad),
    };
    let percent = (value / per_percent).abs();
    // What isn't seen needs no doubt.
    if !percent.is_finite() || value.abs() < seen(error) {
        return None;
    }
    Some(if percent < ORDINARY_ERROR_PERCENT {
        format!(
            "{}: a stiffness or masses wrong by {} % would show the same {what}. Call it stretch only if you know them better than that.",
            joint.name,
            rounded(percent, 2)
        )
    } else {
        format!(
            "{}: without any stretch, stiffness or masses would have to be wrong by {} % to show this {what}.",
            joint.name,
            if percent > 1000.0 {
                "over 1000".to_string()
            } else {
                rounded(percent, 2)
            }
        )
    })
}
