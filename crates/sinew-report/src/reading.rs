//! The paper's reading: a sentence a joint, and its tables.

use crate::units::{in_units_of, name_in_table, of_heads, of_joint};
use crate::words::{MRAD_PER_PERCENT, joint_refusal, loss_reason, or_nan};
use sinew_estimate::replay::{Difference, Estimate, JointEstimate, Loss};
use sinew_figure::{Columns, Table, rounded, with_interval};

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
    let said = match (
        joint.refused,
        &joint.difference,
        &estimate.settings.reference,
    ) {
        (Some(why), ..) => format!("no estimate; {}", joint_refusal(why)),
        (None, Some(d), Some(reference)) => difference(d, reference, of_joint(joint.slides).offset),
        _ => reading(joint),
    };
    format!("{}: {said}", joint.name)
}

/// An elongation in mm, and which way it went.
fn stretch(elongation_m: Option<f64>) -> Option<(String, &'static str)> {
    let mm = elongation_m.map(|m| 1e3 * m).filter(|mm| mm.is_finite())?;
    let word = if mm < 0.0 { "shorter" } else { "longer" };
    Some((rounded(mm.abs(), 2), word))
}

/// What the paper's equation reads: no verdict, for it knows nothing of an error in stiffness, masses,
/// payload or contact.
fn reading(joint: &JointEstimate) -> String {
    let value = 1e3 * or_nan(joint.offset_rad);
    if !value.is_finite() {
        return "no estimate".into();
    }
    let error = 1e3 * or_nan(joint.standard_error_rad);
    let as_stretch = match stretch(joint.elongation_m) {
        Some((mm, word)) => format!("what a tendon {mm} mm {word} would show"),
        None => "robot.toml has no tendon there, so no elongation".into(),
    };
    let unknown = match error.is_finite() && error > 0.0 {
        true => " (95 %, scatter alone)",
        false => " (the recording is too short for a ±)",
    };
    let (read, unit) = (with_interval(value, error), of_joint(joint.slides).offset);
    format!("the equation reads {read} {unit}{unknown}; {as_stretch}")
}

/// What changed since a reference.
fn difference(d: &Difference, reference: &str, unit: &str) -> String {
    let (value, error) = (1e3 * d.difference_rad, 1e3 * or_nan(d.standard_error_rad));
    if !value.is_finite() {
        return "no estimate".into();
    }
    let how_sure = match error.is_finite() && error > 0.0 {
        true => ", 95 %",
        false => "; the recording is too short for a ±",
    };
    let change = format!("change {} {unit}{how_sure}", with_interval(value, error));
    if error.is_finite() && value.abs() < seen(error) {
        return format!("no stretch seen ({change})");
    }
    match stretch(d.elongation_m) {
        Some((mm, word)) => format!("the tendon is {mm} mm {word} than in {reference} ({change})"),
        None => format!(
            "the motor stands {} {unit} further than in {reference} ({change}); robot.toml has no tendon there, so no elongation",
            rounded(value, 3)
        ),
    }
}

/// From here on a change is called seen, mrad.
fn seen(standard_error_mrad: f64) -> f64 {
    (SEEN_ERRORS * standard_error_mrad).max(ENCODER_MRAD)
}

/// How large an error of stiffness or masses would look the same, where that is worth a word.
pub(crate) fn doubt(joint: &JointEstimate) -> Option<String> {
    if joint.refused.is_some() {
        return None;
    }
    let (value_rad, error_rad, per_error_rad, what) = match &joint.difference {
        Some(d) => (
            d.difference_rad,
            d.standard_error_rad,
            d.offset_per_stiffness_error_rad,
            "difference",
        ),
        None => (
            or_nan(joint.offset_rad),
            joint.standard_error_rad,
            or_nan(joint.offset_per_stiffness_error_rad),
            "offset",
        ),
    };
    let value = 1e3 * value_rad;
    let percent = (value / (MRAD_PER_PERCENT * per_error_rad)).abs();
    // What isn't seen needs no doubt.
    if !percent.is_finite() || value.abs() < seen(1e3 * or_nan(error_rad)) {
        return None;
    }
    let name = &joint.name;
    let wrong = match percent > 1000.0 {
        true => "over 1000".to_string(),
        false => rounded(percent, 2),
    };
    Some(match percent < ORDINARY_ERROR_PERCENT {
        true => format!(
            "{name}: a stiffness or masses wrong by {wrong} % would show the same {what}. Call it stretch only if you know them better than that."
        ),
        false => format!(
            "{name}: without any stretch, stiffness or masses would have to be wrong by {wrong} % to show this {what}."
        ),
    })
}

/// Every joint's reading; a stretch is worded by its column's head and cell.
pub(crate) fn readings(
    estimate: &Estimate,
    (head, stretch): (&str, fn(&JointEstimate) -> String),
) -> Table {
    let heads = of_heads(estimate.joints.iter().map(|j| j.slides));
    let mrad = |rad: Option<f64>, digits| rounded(1e3 * or_nan(rad), digits);
    let per_percent = |j: &JointEstimate| {
        let per_error_rad = or_nan(j.offset_per_stiffness_error_rad);
        rounded(MRAD_PER_PERCENT * per_error_rad, 2)
    };
    let table = Columns::of(&estimate.joints)
        .words("joint", |j| name_in_table(&j.name, j.slides, heads))
        .column("reading\nmrad", |j| mrad(j.offset_rad, 4))
        .column("error\nmrad", |j| mrad(j.standard_error_rad, 2))
        .column("scatter\nmrad", |j| mrad(j.scatter_rad, 2))
        .column(head, |j| stretch(j))
        .column("strain\n%", |j| rounded(100.0 * or_nan(j.strain_ratio), 3))
        .column("used\n%", |j| format!("{:.1}", 100.0 * j.usable_share))
        .column("1 % of K\nmrad", |j| per_percent(j));
    in_units_of(table.table(), heads)
}

/// What changed since the reference; no rows without one.
pub(crate) fn differences(estimate: &Estimate) -> Table {
    let heads = of_heads(estimate.joints.iter().map(|j| j.slides));
    let joints = estimate.joints.iter();
    let changed = joints.filter_map(|j| Some((j, j.difference.as_ref()?)));
    let table = Columns::of(changed)
        .words("joint", |(j, _)| name_in_table(&j.name, j.slides, heads))
        .column("reference\nmrad", |(_, d)| {
            rounded(1e3 * d.reference_rad, 4)
        })
        .column("change\n± 95 %, mrad", |(_, d)| {
            with_interval(1e3 * d.difference_rad, 1e3 * or_nan(d.standard_error_rad))
        })
        .column("change\nmm", |(_, d)| {
            rounded(1e3 * or_nan(d.elongation_m), 3)
        })
        .column("1 % of K\nmrad", |(_, d)| {
            rounded(MRAD_PER_PERCENT * d.offset_per_stiffness_error_rad, 2)
        });
    in_units_of(table.table(), heads)
}

/// What was not used, joint by joint; what every joint lost stands at the end, once.
pub(crate) fn losses(e: &Estimate) -> Vec<String> {
    let frames = |loss: &Loss| match loss.frames {
        1 => "1 frame".to_string(),
        n => format!("{n} frames"),
    };
    let own = e.joints.iter().flat_map(|joint| {
        let own = joint.losses.iter().filter(|l| !e.losses.contains(l));
        own.map(move |loss| {
            let (frames, percent, why) =
                (frames(loss), 100.0 * loss.share, loss_reason(loss.reason));
            format!(
                "not used: {frames} ({percent:.1} %) of {}, {why}",
                joint.name
            )
        })
    });
    let of_all = e.losses.iter();
    let of_all = of_all.map(|l| format!("not used: {}, {}", frames(l), loss_reason(l.reason)));
    own.chain(of_all).collect()
}
