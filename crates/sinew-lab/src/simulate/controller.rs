//! The robot's own controller, which knows the description and not the truth.

use super::scenario::Controller as Gains;
use rand_chacha::ChaCha8Rng;
use sinew_model::StepError;
use sinew_model::arm::{Arm, ArmWorkspace};
use sinew_model::transmission::Transmission;

/// Gravity feed-forward and PD on the motor, with the elastic deflection compensated:
///
/// ```text
/// theta_d = q_d + g(q_d)/K
/// tau_m   = g(q_d) + K_P (theta_d − theta) + K_D (dtheta_d − dtheta)
/// ```
///
/// Held for one control period. Motor angle and speed are taken as the drive has them: before
/// the noise of the recording, behind the stretch of the rope, which it can't see.
///
/// # Source
/// P. Tomei, *A simple PD controller for robots with elastic joints*, IEEE TAC 36, 1991.
#[derive(Debug, Clone)]
pub(crate) struct Controller {
    arm: Arm,
    ws: ArmWorkspace,
    stiffness: Vec<f64>,
    kp: Vec<f64>,
    kd: Vec<f64>,
    period_s: f64,
    rest: Vec<f64>,
    theta_d_before: Vec<f64>,
    started: bool,
}

impl Controller {
    pub(crate) fn new(
        arm: &Arm,
        transmissions: &[&Transmission],
        motor_inertia: &[f64],
        gains: &Gains,
        period_s: f64,
        rng: &mut ChaCha8Rng,
    ) -> Self {
        let n = arm.dof();
        let names = arm.joint_names();
        let stiffness: Vec<f64> = transmissions
            .iter()
            .map(|t| t.stiffness_nm_per_rad)
            .collect();
        let default_kp: Vec<f64> = stiffness.iter().map(|k| 1.25 * k).collect();
        let kp = gains.stiffness_nm_per_rad.sample(names, &default_kp, rng);
        let default_kd: Vec<f64> = kp
            .iter()
            .zip(motor_inertia)
            .map(|(kp, inertia)| 2.2 * (kp * inertia).sqrt())
            .collect();
        let kd = gains.damping_nm_s_per_rad.sample(names, &default_kd, rng);
        Self {
            ws: ArmWorkspace::new(arm),
            arm: arm.clone(),
            stiffness,
            kp,
            kd,
            period_s,
            rest: vec![0.0; n],
            theta_d_before: vec![0.0; n],
            started: false,
        }
    }

    /// Motor torque for the next period.
    pub(crate) fn step(
        &mut self,
        q_d: &[f64],
        theta: &[f64],
        dtheta: &[f64],
        tau_m: &mut [f64],
    ) -> Result<(), StepError> {
        let g = self.arm.momentum(&mut self.ws, q_d, &self.rest)?.g;
        for i in 0..q_d.len() {
            let theta_d = q_d[i] + g[i] / self.stiffness[i];
            let dtheta_d = if self.started {
                (theta_d - self.theta_d_before[i]) / self.period_s
            } else {
                0.0
            };
            self.theta_d_before[i] = theta_d;
            tau_m[i] =
                g[i] + self.kp[i] * (theta_d - theta[i]) + self.kd[i] * (dtheta_d - dtheta[i]);
        }
        self.started = true;
        Ok(())
    }
}
