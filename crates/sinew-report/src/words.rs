//! Words of the paper's estimate: what was lost, refused, and what a number rests on.

use sinew_estimate::replay::{
    Basis, Estimate, JointEstimate, JointRefusal, LossReason, Origin, Quantity,
};
use sinew_figure::{interval_cells, with_interval};
use sinew_model::Gaussian;

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

/// A quantity with its unit, and what it rests on.
pub(crate) fn basis_row(estimate: &Estimate, basis: &Basis) -> [String; 2] {
    let quantity = match basis.quantity {
        Quantity::Positions => "motor and joint positions, rad",
        Quantity::ElasticTorque => "elastic torque, N·m",
        Quantity::Transmission => "stiffness, N·m/rad; friction; tendon geometry, mm",
        Quantity::ExternalTorque => "external torque, N·m",
        Quantity::Offset => "offset, mrad; elongation, mm; strain, %",
    };
    let file = &estimate.robot.file;
    let rests_on = match (basis.rests_on, basis.quantity) {
        (Origin::Measured, Quantity::ElasticTorque) => {
            "measured by the joint torque sensors, in the recording".into()
        }
        (Origin::Measured, _) => "measured, in the recording".into(),
        (Origin::Observed, _) => format!(
            "computed by the momentum observer from the positions and the masses of {}; not measured",
            estimate.robot.urdf
        ),
        (Origin::MotorTorque, _) => format!(
            "computed from the recorded motor torque, motor inertia and friction of {file}"
        ),
        (Origin::Stated, _) => format!("as stated in {file}; not fitted to this recording"),
        (Origin::TakenAsKnown, _) => "as recorded, taken as known".into(),
        (Origin::Estimated, _) => "the estimate; its standard error covers the scatter within this recording, not an error of stiffness, masses or payload: differences between recordings of like motion are surer than absolute values".into(),
    };
    [quantity.into(), rests_on]
}
