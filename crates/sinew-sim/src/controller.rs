//! The robot's own controller, which knows the description, and of the truth what it is told.

use super::error::SimulateError;
use super::scenario::{Scenario, SetPointKind};
use rand_chacha::ChaCha8Rng;
use sinew_model::StepError;
use sinew_model::correction::{JointCorrection, SetPoint};
use sinew_model::robot::Robot;
use sinew_model::tendons::Routings;

/// Feed-forward and PD on the motor, with the elastic deflection compensated:
///
/// ```text
/// theta_d = q_d + x(tau_d) + delta_e,     tau_d = g(q_d), or M ddq_d + C dq_d + g + friction
/// tau_m   = tau_d (+ I_m ddq_d) + K_P (theta_d − theta) + K_D (dtheta_d − dtheta)
/// ```
///
/// With tendons that cross several joints all of this is in the coordinate of each tendon, `f = B tau_d` in the place of `tau_d`
/// and `rho ddq_d` in that of `ddq_d`.
///
/// Held for one control period. Motor angle and speed are taken as the drive has them: before
/// the noise of the recording, behind the stretch of the rope, which it can't see and corrects
/// only as far as the scenario lets it know.
///
/// # Source
/// P. Tomei, *A simple PD controller for robots with elastic joints*, IEEE TAC 36, 1991.
#[derive(Debug, Clone)]
pub(crate) struct Controller {
    set_point: SetPoint,
    routings: Option<Routings>,
    kind: SetPointKind,
    motor_inertia: Vec<f64>,
    kp: Vec<f64>,
    kd: Vec<f64>,
    period_s: f64,
    theta_d_before: Vec<f64>,
    started: bool,
}

impl Controller {
    pub(crate) fn new(
        robot: &Robot,
        routings: Option<Routings>,
        motor_inertia: &[f64],
        scenario: &Scenario,
        known: &[JointCorrection],
        rng: &mut ChaCha8Rng,
    ) -> Result<Self, SimulateError> {
        let n = robot.arm.dof();
        let names = robot.arm.joint_names();
        let gains = &scenario.controller;
        let stiffness = |t: &Option<_>| {
            t.as_ref()
                .map_or(0.0, |t: &sinew_model::transmission::Transmission| {
                    t.stiffness_nm_per_rad
                })
        };
        let default_kp: Vec<f64> = robot
            .transmissions
            .iter()
            .map(|t| 1.25 * stiffness(t))
            .collect();
        let kp = gains.stiffness_nm_per_rad.sample(names, &default_kp, rng);
        let default_kd: Vec<f64> = kp
            .iter()
            .zip(motor_inertia)
            .map(|(kp, inertia)| 2.2 * (kp * inertia).sqrt())
            .collect();
        let kd = gains.damping_nm_s_per_rad.sample(names, &default_kd, rng);
        Ok(Self {
            set_point: SetPoint::new(&robot.arm, &robot.transmissions, known)?,
            routings,
            kind: scenario.correction.set_point,
            motor_inertia: motor_inertia.to_vec(),
            kp,
            kd,
            period_s: 1.0 / scenario.control_rate_hz,
            theta_d_before: vec![0.0; n],
            started: false,
        })
    }

    /// What is known of joint `i` from now on.
    pub(crate) fn know(&mut self, i: usize, known: &JointCorrection) -> Result<(), SimulateError> {
        Ok(self.set_point.set(i, known)?)
    }

    /// Motor torque for the next period; `wanted` holds `q_d`, `dq_d`, `ddq_d`.
    pub(crate) fn step(
        &mut self,
        wanted: [&[f64]; 3],
        theta: &[f64],
        dtheta: &[f64],
        tau_m: &mut [f64],
    ) -> Result<(), StepError> {
        let [q_d, dq_d, ddq_d] = wanted;
        let dynamic = self.kind == SetPointKind::Dynamic;
        if dynamic {
            self.set_point.follow(q_d, dq_d, ddq_d, None)?;
        } else {
            self.set_point.hold(q_d, None)?;
        }
        for i in 0..q_d.len() {
            let mut theta_d = self.set_point.theta_set()[i];
            if let Some(routings) = &self.routings {
                theta_d *= routings.drive_ratio(i);
            }
            // A correction that changes moves the set-point, it is no speed to follow.
            let moving = theta_d - self.set_point.correction().delta_e(i).unwrap_or(0.0);
            let dtheta_d = if self.started {
                (moving - self.theta_d_before[i]) / self.period_s
            } else {
                0.0
            };
            self.theta_d_before[i] = moving;
            let mut feed_forward = self.set_point.tendon_torque()[i];
            if dynamic {
                let acceleration = match &self.routings {
                    Some(routings) => routings.path(i, ddq_d),
                    None => ddq_d[i],
                };
                feed_forward += self.motor_inertia[i] * acceleration;
            }
            tau_m[i] = feed_forward
                + self.kp[i] * (theta_d - theta[i])
                + self.kd[i] * (dtheta_d - dtheta[i]);
        }
        self.started = true;
        Ok(())
    }
}
