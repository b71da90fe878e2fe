//! Simulated controller of the robot, which uses the description and the specified correction.

use super::error::SimulateError;
use super::paths::{Least, Paths};
use super::sampled::Names;
use super::scenario::{CoContraction, Scenario, SetPointKind};
use super::set_point::PulledSetPoint;
use rand_chacha::ChaCha8Rng;
use sinew_model::StepError;
use sinew_model::correction::{JointCorrection, SetPoint};
use sinew_model::robot::Robot;

/// Feed-forward and PD on the motor, with the elastic deflection compensated:
///
/// ```text
/// theta_d = q_d + x(tau_d) + delta_e,     tau_d = g(q_d), or M ddq_d + C dq_d + g + friction
/// tau_m   = tau_d (+ I_m ddq_d) + K_P (theta_d − theta) + K_D (dtheta_d − dtheta)
/// ```
///
/// With tendons that cross several joints all of this is in the coordinate of each tendon, `f = B tau_d` in the place of `tau_d`
/// and `rho ddq_d` in that of `ddq_d`. Unidirectional strands have the set-points of [`PulledSetPoint`], with the
/// co-contraction that the
/// scenario specifies.
///
/// The output is held for one control period. Motor angle and speed are those of the drive: without the noise of the
/// recording, and with the elongation of the rope, which the drive cannot observe and corrects only as specified in
/// the scenario.
///
/// # Source
/// P. Tomei, *A simple PD controller for robots with elastic joints*, IEEE TAC 36, 1991.
#[derive(Debug, Clone)]
pub(crate) struct Controller {
    set_points: SetPoints,
    paths: Option<Paths>,
    co_contraction: Option<CoContraction>,
    kind: SetPointKind,
    motor_inertia: Vec<f64>,
    kp: Vec<f64>,
    kd: Vec<f64>,
    period_s: f64,
    theta_d_before: Vec<f64>,
    started: bool,
}

/// Source of the set-points.
#[derive(Debug, Clone)]
enum SetPoints {
    /// Every tendon has an equation of its own.
    Paired(Box<SetPoint>),
    /// A group has an equation per joint.
    Pulled(Box<PulledSetPoint>),
}

impl Controller {
    pub(crate) fn new(
        robot: &Robot,
        names: &Names,
        paths: Option<Paths>,
        motor_inertia: &[f64],
        scenario: &Scenario,
        corrections: &[JointCorrection],
        rng: &mut ChaCha8Rng,
    ) -> Result<Self, SimulateError> {
        let gains = &scenario.controller;
        let stiffness = |t: &Option<_>| {
            t.as_ref()
                .map_or(0.0, |t: &sinew_model::transmission::Transmission| {
                    t.stiffness_nm_per_rad
                })
        };
        let mut default_kp: Vec<f64> = robot
            .transmissions
            .iter()
            .map(|t| 1.25 * stiffness(t))
            .collect();
        for (i, first, ratio) in paths.iter().flat_map(Paths::followers) {
            default_kp[*first] += ratio * ratio * default_kp[*i];
        }
        let motors = &names.motors;
        let kp = gains.stiffness_nm_per_rad.sample(motors, &default_kp, rng);
        let default_kd: Vec<f64> = kp
            .iter()
            .zip(motor_inertia)
            .map(|(kp, inertia)| 2.2 * (kp * inertia).sqrt())
            .collect();
        let kd = gains.damping_nm_s_per_rad.sample(motors, &default_kd, rng);
        let set_points = match &paths {
            Some(paths) if paths.has_pulls() => {
                SetPoints::Pulled(Box::new(PulledSetPoint::new(robot, paths, corrections)?))
            }
            _ => {
                let paired = SetPoint::new(&robot.arm, &robot.transmissions, corrections)?;
                SetPoints::Paired(Box::new(paired))
            }
        };
        Ok(Self {
            set_points,
            paths,
            co_contraction: scenario.co_contraction,
            kind: scenario.correction.set_point,
            motor_inertia: motor_inertia.to_vec(),
            kp,
            kd,
            period_s: 1.0 / scenario.control_rate_hz,
            theta_d_before: vec![0.0; robot.axes()],
            started: false,
        })
    }

    /// Sets the correction of the tendon on axis `i` from the present sample on.
    pub(crate) fn set_correction(
        &mut self,
        i: usize,
        correction: &JointCorrection,
    ) -> Result<(), SimulateError> {
        match &mut self.set_points {
            SetPoints::Paired(paired) => paired.set(i, correction)?,
            SetPoints::Pulled(pulled) => pulled.set(i, correction)?,
        }
        Ok(())
    }

    /// Tension that strands keep at `t`, s.
    pub(crate) fn least(&self, t: f64) -> Least {
        let required = self.co_contraction.as_ref();
        required.map_or(Least::Pretension, |required| Least::Tension(required.at(t)))
    }

    /// Motor torque for the next period from `t`, s, by axis; `wanted` holds `q_d`, `dq_d`, `ddq_d`. Of a motor with several tendons
    /// that on the axis of the first counts.
    pub(crate) fn step(
        &mut self,
        t: f64,
        wanted: [&[f64]; 3],
        theta: &[f64],
        dtheta: &[f64],
        tau_m: &mut [f64],
    ) -> Result<(), StepError> {
        let [q_d, dq_d, ddq_d] = wanted;
        let dynamic = self.kind == SetPointKind::Dynamic;
        let least = self.least(t);
        match &mut self.set_points {
            SetPoints::Paired(paired) if dynamic => {
                paired.follow(q_d, dq_d, ddq_d, None)?;
            }
            SetPoints::Paired(paired) => {
                paired.hold(q_d, None)?;
            }
            SetPoints::Pulled(pulled) => {
                pulled.solve(q_d, dynamic.then_some([dq_d, ddq_d]), least)?;
            }
        }
        for i in 0..tau_m.len() {
            // Motor set-point in the coordinate of the tendon, its part due to the specified offset, and the motor
            // load.
            let (theta_d, delta_e, mut feed_forward) = match &self.set_points {
                SetPoints::Paired(paired) => {
                    let mut theta_d = paired.theta_set()[i];
                    if let Some(paths) = &self.paths {
                        theta_d *= paths.routings.drive_ratio(i);
                    }
                    let delta_e = paired.correction().delta_e(i).unwrap_or(0.0);
                    (theta_d, delta_e, paired.tendon_torque()[i])
                }
                SetPoints::Pulled(pulled) => (pulled.theta(i), pulled.delta(i), pulled.load(i)),
            };
            // A changing correction shifts the set-point; it does not add a velocity.
            let moving = theta_d - delta_e;
            let dtheta_d = if self.started {
                (moving - self.theta_d_before[i]) / self.period_s
            } else {
                0.0
            };
            self.theta_d_before[i] = moving;
            if dynamic {
                let acceleration = match &self.paths {
                    Some(paths) => paths.routings.path(i, ddq_d),
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
