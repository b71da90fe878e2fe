//! Uncorrected (paper) estimate: sentences and tables.

use crate::format::{MRAD_PER_PERCENT, name_head, or_nan};
use crate::units::{in_units_of, name_in_table, of_heads, of_joint};
use sinew_estimate::replay::{Difference, Estimate, JointError, JointEstimate, Loss, LossReason};
use sinew_figure::{Columns, Table, rounded, with_interval};

/// Minimum size of a change to be reported as detected, in standard errors.
const MIN_CHANGE_ERRORS: f64 = 2.0;
/// Minimum size of a change to be reported as detected, mrad.
///
/// Upper end of the quantisation error of 12 to 14 bit encoders after filtering with matched comparison. The standard
/// error does not contain it, because it is identical in every frame of a pose.
const MIN_CHANGE_MRAD: f64 = 0.3;
/// Largest ordinary error of stiffness or masses, %; an offset that such an error explains is no evidence of elongation.
const MAX_ORDINARY_ERROR_PERCENT: f64 = 10.0;

/// States the uncorrected offset of a joint, or its change relative to the reference recording.
pub fn headline(estimate: &Estimate, joint: &JointEstimate) -> String {
    let result = match (
        joint.reason,
        &joint.difference,
        &estimate.settings.reference,
    ) {
        (Some(reason), ..) => format!("no estimate; {}", joint_error(reason)),
        (None, Some(d), Some(reference)) => difference(d, reference, of_joint(joint.slides).offset),
        _ => uncorrected(joint),
    };
    format!("{}: {result}", joint.name)
}

/// Formats the size of an elongation in mm, and whether it is one of an elongated or shortened tendon.
fn elongation(elongation_m: Option<f64>) -> Option<(String, bool)> {
    let mm = elongation_m.map(|m| 1e3 * m).filter(|mm| mm.is_finite())?;
    Some((rounded(mm.abs(), 2), mm >= 0.0))
}

/// States the uncorrected offset of a joint. It is no verdict: errors of stiffness, masses, payload and contact bias it.
fn uncorrected(joint: &JointEstimate) -> String {
    let value = 1e3 * or_nan(joint.offset_rad);
    if !value.is_finite() {
        return "no estimate".into();
    }
    let error = 1e3 * or_nan(joint.standard_error_rad);
    let equivalent = match elongation(joint.elongation_m) {
        Some((mm, true)) => format!("equivalent to an elongation of {mm} mm"),
        Some((mm, false)) => format!("equivalent to a shortening of {mm} mm"),
        None => "no tendon in robot.toml, elongation not available".into(),
    };
    let interval = match error.is_finite() && error > 0.0 {
        true => " (95 %, scatter only)",
        false => " (recording too short for an interval)",
    };
    let (offset, unit) = (with_interval(value, error), of_joint(joint.slides).offset);
    format!("uncorrected offset {offset} {unit}{interval}; {equivalent}")
}

/// States the change of a joint relative to the reference recording.
fn difference(d: &Difference, reference: &str, unit: &str) -> String {
    let (value, error) = (1e3 * d.difference_rad, 1e3 * or_nan(d.standard_error_rad));
    if !value.is_finite() {
        return "no estimate".into();
    }
    let level = match error.is_finite() && error > 0.0 {
        true => ", 95 %",
        false => "; recording too short for an interval",
    };
    let change = format!("change {} {unit}{level}", with_interval(value, error));
    if error.is_finite() && value.abs() < min_change_mrad(error) {
        return format!("no change detected ({change})");
    }
    match elongation(d.elongation_m) {
        Some((mm, true)) => format!("elongated by {mm} mm relative to {reference} ({change})"),
        Some((mm, false)) => format!("shortened by {mm} mm relative to {reference} ({change})"),
        None => format!(
            "motor position shifted by {} {unit} relative to {reference} ({change}); no tendon in robot.toml, elongation not available",
            rounded(value, 3)
        ),
    }
}

/// Smallest change that is reported as detected, mrad.
fn min_change_mrad(standard_error_mrad: f64) -> f64 {
    (MIN_CHANGE_ERRORS * standard_error_mrad).max(MIN_CHANGE_MRAD)
}

/// States the stiffness or mass error that would explain a detected offset; `None` if none is detected.
pub(crate) fn equivalent_error(joint: &JointEstimate) -> Option<String> {
    if joint.reason.is_some() {
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
    // Only a detected offset needs an explanation.
    if !percent.is_finite() || value.abs() < min_change_mrad(1e3 * or_nan(error_rad)) {
        return None;
    }
    let name = &joint.name;
    let wrong = match percent > 1000.0 {
        true => "> 1000".to_string(),
        false => rounded(percent, 2),
    };
    Some(match percent < MAX_ORDINARY_ERROR_PERCENT {
        true => format!(
            "{name}: a stiffness or mass error of {wrong} % explains the same {what}; it is evidence of elongation only if both are known more accurately"
        ),
        false => format!(
            "{name}: without elongation, a stiffness or mass error of {wrong} % would be needed to explain this {what}"
        ),
    })
}

/// Tabulates the uncorrected estimate of all joints.
///
/// * `elongation`: heading and cell of the elongation column.
pub(crate) fn offsets(
    estimate: &Estimate,
    (head, elongation): (&str, fn(&JointEstimate) -> String),
) -> Table {
    let heads = of_heads(estimate.joints.iter().map(|j| j.slides));
    let mrad = |rad: Option<f64>, digits| rounded(1e3 * or_nan(rad), digits);
    let per_percent = |j: &JointEstimate| {
        let per_error_rad = or_nan(j.offset_per_stiffness_error_rad);
        rounded(MRAD_PER_PERCENT * per_error_rad, 2)
    };
    let table = Columns::of(&estimate.joints)
        .words(name_head(&estimate.robot), |j| {
            name_in_table(&j.name, j.slides, heads)
        })
        .column("offset\n(mrad)", |j| mrad(j.offset_rad, 4))
        .column("std. error\n(mrad)", |j| mrad(j.standard_error_rad, 2))
        .column("scatter\n(mrad)", |j| mrad(j.scatter_rad, 2))
        .column(head, |j| elongation(j))
        .column("strain\n(%)", |j| {
            rounded(100.0 * or_nan(j.strain_ratio), 3)
        })
        .column("used\n(%)", |j| format!("{:.1}", 100.0 * j.usable_share))
        .column("1 % of K\n(mrad)", |j| per_percent(j));
    in_units_of(table.table(), heads)
}

/// Tabulates the change of all joints relative to the reference recording; no rows without one.
pub(crate) fn differences(estimate: &Estimate) -> Table {
    let heads = of_heads(estimate.joints.iter().map(|j| j.slides));
    let joints = estimate.joints.iter();
    let changed = joints.filter_map(|j| Some((j, j.difference.as_ref()?)));
    let table = Columns::of(changed)
        .words(name_head(&estimate.robot), |(j, _)| {
            name_in_table(&j.name, j.slides, heads)
        })
        .column("reference\n(mrad)", |(_, d)| {
            rounded(1e3 * d.reference_rad, 4)
        })
        .column("change ± 95 %\n(mrad)", |(_, d)| {
            with_interval(1e3 * d.difference_rad, 1e3 * or_nan(d.standard_error_rad))
        })
        .column("change\n(mm)", |(_, d)| {
            rounded(1e3 * or_nan(d.elongation_m), 3)
        })
        .column("1 % of K\n(mrad)", |(_, d)| {
            rounded(MRAD_PER_PERCENT * d.offset_per_stiffness_error_rad, 2)
        });
    in_units_of(table.table(), heads)
}

/// Lists the excluded frames with their reason: of single joints, then of all joints.
pub(crate) fn losses(e: &Estimate) -> Vec<String> {
    let frames = |loss: &Loss| match loss.frames {
        1 => "1 frame".to_string(),
        n => format!("{n} frames"),
    };
    let own = e.joints.iter().flat_map(|joint| {
        let own = joint.losses.iter().filter(|l| !e.losses.contains(l));
        own.map(move |loss| {
            let (frames, percent, reason) =
                (frames(loss), 100.0 * loss.share, loss_reason(loss.reason));
            format!(
                "excluded: {frames} ({percent:.1} %) of {}, {reason}",
                joint.name
            )
        })
    });
    let of_all = e.losses.iter();
    let of_all = of_all.map(|l| format!("excluded: {}, {}", frames(l), loss_reason(l.reason)));
    own.chain(of_all).collect()
}

/// Names the reason for which frames were excluded.
pub fn loss_reason(reason: LossReason) -> &'static str {
    match reason {
        LossReason::Settling => "filter settling after the start, a gap or missing samples",
        LossReason::JointPosition => "joint position missing or not finite",
        LossReason::JointVelocity => "joint velocity missing or not finite",
        LossReason::MotorPosition => "motor position missing or not finite",
        LossReason::Torque => "measured torque missing or not finite",
        LossReason::ExternalTorque => "external torque missing or not finite",
        LossReason::Range => "value out of range",
        LossReason::Duplicate => "duplicate time stamp",
        LossReason::Late => "too late to be reordered",
        LossReason::Undecodable => "message not decodable",
        LossReason::WithoutTime => "row without time stamp",
    }
}

/// States why no joint was estimated; `None` if at least one was.
pub fn nothing_estimated(estimate: &Estimate) -> Option<String> {
    let reason = |j: &JointEstimate| Some(format!("{}: {}", j.name, joint_error(j.reason?)));
    let all: Option<Vec<String>> = estimate.joints.iter().map(reason).collect();
    let path = &estimate.recording.path;
    all.map(|all| {
        format!(
            "{path}: no joint could be estimated ({}); check the channels with sinew log info",
            all.join("; ")
        )
    })
}

/// States why a joint has no estimate.
pub fn joint_error(error: JointError) -> String {
    match error {
        JointError::Rigid => "rigid in robot.toml".into(),
        JointError::NoJointPosition => "joint position not recorded".into(),
        JointError::NoMotorPosition => "motor position not recorded".into(),
        JointError::NoJointTorque => "joint torque not recorded".into(),
        JointError::NoMotorTorque => "motor torque not recorded".into(),
        JointError::NoMotorInertia => "motor_inertia_kg_m2 missing in robot.toml".into(),
        JointError::JointEquations => "coupled with other tendons at a joint".into(),
        JointError::FrictionAlongPath => "friction along the path of its tendon".into(),
        JointError::NoUsableFrame(None) => "no usable frame".into(),
        JointError::NoUsableFrame(Some(main)) => {
            format!("no usable frame: {}", loss_reason(main))
        }
    }
}
