//! The paper's motion with a longer rope, and its closed-form solution.

use super::super::PaperError;
use super::super::staircase::{LENGTH_S, REST_WINDOW_S, controller, motion, rest_end_s};
use super::super::trial::mean;
use super::cases::{DETECTOR_DEVIATION_RAD, OFFSET_RAD, STRETCHED, stretch};
use sinew_model::robot::Robot;
use sinew_sim::control::run_with_detectors;
use sinew_sim::scenario::{
    Contact, Correction, FrictionSpec, PerJoint, Scenario, SetPointKind, SpecifiedOffset,
};

/// Time that the arm remains at 90° after the motion, s.
const AFTER_S: f64 = 2.5;
/// Length of a run, s.
pub(super) const RUN_S: f64 = LENGTH_S + AFTER_S;
/// Contact during the final rest: start and duration, s, and force, N.
pub(super) const TOUCH_S: (f64, f64) = (LENGTH_S + 0.5, 0.5);
pub(super) const TOUCH_N: f64 = 0.5;

/// Signals of one run: both joints over time and at rest.
#[derive(Debug, Clone)]
pub(super) struct Climb {
    pub(super) name: &'static str,
    pub(super) time_s: Vec<f64>,
    /// `q − q_d`, rad; first the shoulder, then the elbow.
    pub(super) error_rad: [Vec<f64>; 2],
    /// Estimated external torque, N·m.
    pub(super) tau_ext_nm: [Vec<f64>; 2],
    /// Detection threshold of each joint, N·m.
    pub(super) threshold_nm: [Vec<f64>; 2],
}

impl Climb {
    /// Mean over the end of rest `k` (0 is the one before the first move).
    pub(super) fn at_rest(&self, values: &[f64], k: usize) -> f64 {
        let end = rest_end_s(k);
        let window = self.time_s.iter().zip(values);
        let picked: Vec<f64> = window
            .filter(|(t, _)| **t >= end - REST_WINDOW_S && **t < end)
            .map(|(_, v)| *v)
            .collect();
        mean(&picked)
    }
}

/// Simulates the motion with new ropes, and with stretched ropes before and after correction.
pub(super) fn climbs(robot: &Robot, joints: [usize; 2]) -> Result<[Climb; 3], PaperError> {
    let one = |name, stretched: bool, offset| climb(robot, joints, name, stretched, offset);
    Ok([
        one("new ropes", false, SpecifiedOffset::Nothing)?,
        one(
            "10 mrad longer, uncorrected",
            true,
            SpecifiedOffset::Nothing,
        )?,
        one("10 mrad longer, corrected", true, SpecifiedOffset::True)?,
    ])
}

fn climb(
    robot: &Robot,
    joints: [usize; 2],
    name: &'static str,
    stretched: bool,
    offset: SpecifiedOffset,
) -> Result<Climb, PaperError> {
    let mut frictionless = robot.clone();
    for t in frictionless.transmissions.iter_mut().flatten() {
        t.joint_friction = Default::default();
    }
    let scenario = Scenario {
        name: "climb".into(),
        duration_s: Some(RUN_S),
        controller: controller(robot.joint_names()),
        motion: motion(STRETCHED[0]),
        joint_friction: FrictionSpec::none(),
        motor_friction: FrictionSpec::none(),
        offsets: STRETCHED
            .iter()
            .filter(|_| stretched)
            .map(|joint| stretch(joint))
            .collect(),
        correction: Correction {
            offset,
            offset_std_rad: PerJoint::fixed(DETECTOR_DEVIATION_RAD),
            // Without it the arm oscillates undamped after each move.
            set_point: SetPointKind::Dynamic,
            ..Correction::default()
        },
        contacts: vec![Contact {
            start_s: TOUCH_S.0,
            duration_s: TOUCH_S.1,
            link: "forearm".into(),
            line: 0,
            point_m: [0.0, 0.0, -0.31],
            force_n: [0.0, 0.0, TOUCH_N],
            rise_s: 0.05,
        }],
        ..Scenario::default()
    };
    let mut out = Climb {
        name,
        time_s: Vec::new(),
        error_rad: Default::default(),
        tau_ext_nm: Default::default(),
        threshold_nm: Default::default(),
    };
    // Noise as with the sensors of the second row, about: the threshold shall be a working one.
    const NOISE_NM: f64 = 0.02;
    let noise = vec![NOISE_NM; robot.arm.dof()];
    run_with_detectors(
        &frictionless,
        &scenario,
        &noise,
        &[],
        &mut |truth, sample| {
            out.time_s.push(truth.time_s);
            for (slot, &i) in joints.iter().enumerate() {
                out.error_rad[slot].push(truth.q[i] - truth.q_d[i]);
                out.tau_ext_nm[slot].push(sample.tau_ext[i]);
                out.threshold_nm[slot].push(sample.threshold[i]);
            }
        },
    )?;
    Ok(out)
}

/// False torque of an uncorrected offset, `−K delta_e`, N·m.
pub(super) fn false_torque_nm(stiffness_nm_per_rad: f64) -> f64 {
    -stiffness_nm_per_rad * OFFSET_RAD
}
