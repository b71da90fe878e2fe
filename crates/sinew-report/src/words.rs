//! Words of the paper's estimate: what was lost, refused, and what a number rests on.

use sinew_estimate::replay::{Estimate, JointEstimate, JointRefusal, LossReason};
use sinew_figure::{interval_cells, with_interval};
use sinew_model::Gaussian;

/// What isn't known is shown as the tables show NaN.
pub(crate) fn or_nan(x: Option<f64>) -> f64 {
    x.unwrap_or(f64::NAN)
}

/// From rad per relative error to mrad per percent.
pub(crate) const MRAD_PER_PERCENT: f64 = 1e3 * 0.01;

/// `12.34 ± 0.42` with half a 95 % interval, in a unit of which `factor` make one of SI.
pub(crate) fn plus_minus(value: Gaussian, factor: f64) -> String {
    with_interval(factor * value.mean, factor * value.deviation)
}

/// The same in two cells of a table; dashes where there is none.
pub(crate) fn plus_minus_cells(value: Option<Gaussian>, factor: f64) -> [String; 2] {
    let Gaussian { mean, deviation } = value.unwrap_or(Gaussian::new(f64::NAN, f64::NAN));
    interval_cells(factor * mean, factor * deviation)
}

/// A force along three axes, in N.
pub(crate) fn newtons(force_n: [Gaussian; 3]) -> String {
    force_n.map(|f| plus_minus(f, 1.0)).join(", ")
}

/// Why frames gave no estimate.
pub fn loss_reason(reason: LossReason) -> &'static str {
    match reason {
        LossReason::Settling => "settling after the start, a gap or missing samples",
        LossReason::JointPosition => "a joint position missing or not finite",
        LossReason::JointVelocity => "a joint velocity missing or not finite",
        LossReason::MotorPosition => "motor position missing or not finite",
        LossReason::Torque => "measured torque missing or not finite",
        LossReason::ExternalTorque => "external torque missing or not finite",
        LossReason::Range => "a value too large to be one",
        LossReason::Duplicate => "dropped: time stamp seen before",
        LossReason::Late => "dropped: came too late to be sorted in",
        LossReason::Undecodable => "dropped: could not be decoded",
        LossReason::WithoutTime => "dropped: a row without a time",
    }
}

/// Why not one joint was estimated, where that is so.
pub fn nothing_estimated(estimate: &Estimate) -> Option<String> {
    let why = |j: &JointEstimate| Some(format!("{}: {}", j.name, joint_refusal(j.refused?)));
    let all: Option<Vec<String>> = estimate.joints.iter().map(why).collect();
    let path = &estimate.recording.path;
    all.map(|all| {
        format!(
            "{path}: nothing could be estimated. {}; see sinew log info",
            all.join("; ")
        )
    })
}

/// Why a joint got no estimate.
pub fn joint_refusal(refusal: JointRefusal) -> String {
    match refusal {
        JointRefusal::Rigid => "rigid in robot.toml: it has no elastic transmission".into(),
        JointRefusal::NoJointPosition => "its position is not recorded".into(),
        JointRefusal::NoMotorPosition => "its motor position is not recorded".into(),
        JointRefusal::NoJointTorque => "its joint torque is not recorded".into(),
        JointRefusal::NoMotorTorque => "its motor torque is not recorded".into(),
        JointRefusal::NoMotorInertia => "motor_inertia_kg_m2 is missing in robot.toml".into(),
        JointRefusal::NoUsableFrame(None) => "no frame could be used".into(),
        JointRefusal::NoUsableFrame(Some(main)) => {
            format!("no frame could be used: {}", loss_reason(main))
        }
    }
}
