//! Analytic values of the paper's motion on a robot, from its arm and stiffness alone, without the simulation.

use super::PaperError;
use super::staircase::{GAIN_PER_S, LENGTH_S, TO_RAD};
use sinew_model::arm::ArmWorkspace;
use sinew_model::robot::Robot;

/// One joint of a robot; the others stay at 0.
pub(super) struct Analytic<'a> {
    robot: &'a Robot,
    joint: usize,
    /// Stiffness of that joint, N·m/rad.
    pub(super) stiffness_nm_per_rad: f64,
}

impl<'a> Analytic<'a> {
    /// Returns an error for a rigid joint, which has no offset.
    pub(super) fn new(robot: &'a Robot, joint: usize) -> Result<Self, PaperError> {
        let stiffness_nm_per_rad = robot.transmissions[joint]
            .as_ref()
            .map(|t| t.stiffness_nm_per_rad)
            .ok_or_else(|| PaperError::Rigid {
                robot: robot.name.clone(),
                joint: robot.joint_names()[joint].clone(),
            })?;
        Ok(Self {
            robot,
            joint,
            stiffness_nm_per_rad,
        })
    }

    fn pose(&self, value: f64) -> Vec<f64> {
        let mut q = vec![0.0; self.robot.arm.dof()];
        q[self.joint] = value;
        q
    }

    /// Returns the gravity torque of the arm at an angle, N·m.
    pub(super) fn gravity_nm(&self, angle_rad: f64) -> Result<f64, PaperError> {
        let arm = &self.robot.arm;
        let mut ws = ArmWorkspace::new(arm);
        let (q, still) = (self.pose(angle_rad), self.pose(0.0));
        Ok(arm.bias_torque(&mut ws, &q, &still)?[self.joint])
    }

    /// Returns the same at the end of the motion.
    pub(super) fn last_gravity_nm(&self) -> Result<f64, PaperError> {
        self.gravity_nm(TO_RAD)
    }

    /// Torque of a force at a link's origin on the joint, N·m, at a pose of the whole arm.
    pub(super) fn torque_of_force_nm(
        &self,
        q: &[f64],
        link: &str,
        force_n: [f64; 3],
    ) -> Result<f64, PaperError> {
        let mut ws = ArmWorkspace::new(&self.robot.arm);
        let mut tau = self.pose(0.0);
        let arm = &self.robot.arm;
        arm.add_point_force(&mut ws, q, link, [0.0; 3], force_n, &mut tau)?;
        Ok(tau[self.joint])
    }

    /// Error due to the lag of the observed torque, `(tau − LP[tau])/K`, rad, from a torque every `dt_s`.
    pub(super) fn lag_error_rad(&self, tau_nm: &[f64], dt_s: f64) -> Vec<f64> {
        let keep = (-GAIN_PER_S * dt_s).exp();
        let mut state: Option<(f64, f64)> = None;
        tau_nm
            .iter()
            .map(|&tau| {
                let (before, low) = state.unwrap_or((tau, tau));
                // The pole's answer to a straight line, to second order of the step.
                let low = keep * low + (1.0 - keep) * 0.5 * (before + tau);
                state = Some((tau, low));
                (tau - low) / self.stiffness_nm_per_rad
            })
            .collect()
    }

    /// Returns the mean lag error over the whole motion, rad: the torque gained, over `K_I K T`.
    pub(super) fn mean_lag_error_rad(&self) -> Result<f64, PaperError> {
        let gained = self.last_gravity_nm()? - self.gravity_nm(0.0)?;
        Ok(gained / (GAIN_PER_S * self.stiffness_nm_per_rad * LENGTH_S))
    }
}
