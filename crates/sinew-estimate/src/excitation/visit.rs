//! Synthetic recording of the nominal robot at proposed poses.

use crate::session::{Recorded, Recorder};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use sinew_log::Frame;
use sinew_model::StepError;
use sinew_model::arm::ArmWorkspace;
use sinew_model::offset::FeatureConfig;
use sinew_model::robot::Robot;

/// Frames per second of a synthetic recording; the features need no higher rate.
const RATE_HZ: f64 = 250.0;
/// Stroke over which joint friction builds up, rad.
const PRESLIDING_RAD: f64 = 1e-3;
/// Rest before the first move during which the filters settle, s.
const FIRST_REST_S: f64 = 3.0;

/// Properties of the position sensors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensors {
    /// Resolution of the joint encoder, bits per revolution.
    pub joint_bits: u32,
    /// Standard deviation of the white noise of the motor position, rad.
    pub motor_noise_rad: f64,
}

impl Default for Sensors {
    fn default() -> Self {
        Self {
            joint_bits: 13,
            motor_noise_rad: 2e-4,
        }
    }
}

/// Visit of poses in order, with the durations of moves and rests.
#[derive(Debug, Clone, PartialEq)]
pub struct Visit {
    /// Joint positions of each pose, length `n`, rad (m); the recording starts at the first pose.
    pub poses: Vec<Vec<f64>>,
    /// Duration of the move to each pose, s; 0 for the first.
    pub move_s: Vec<f64>,
    /// Duration of the rest at each pose, s.
    pub pause_s: f64,
}

impl Visit {
    /// Plans minimum-jerk moves with every joint below half of its speed limit.
    ///
    /// The maximum speed of such a move is 15/8 of its mean.
    pub fn new(robot: &Robot, poses: Vec<Vec<f64>>, pause_s: f64) -> Self {
        const MAX_SPEED_SHARE: f64 = 0.5;
        const PEAK_TO_MEAN: f64 = 15.0 / 8.0;
        // Minimum duration of a move that does not excite vibrations of the arm, s.
        const MIN_MOVE_S: f64 = 1.0;
        let mut move_s = vec![0.0];
        for pair in poses.windows(2) {
            let longest = robot
                .limits
                .iter()
                .zip(pair[0].iter().zip(&pair[1]))
                .filter(|(limit, _)| limit.velocity.is_finite() && limit.velocity > 0.0)
                .map(|(limit, (from, to))| {
                    PEAK_TO_MEAN * (to - from).abs() / (MAX_SPEED_SHARE * limit.velocity)
                })
                .fold(MIN_MOVE_S, f64::max);
            // Whole hundredths are easier to write down.
            move_s.push((100.0 * longest).ceil() / 100.0);
        }
        Self {
            poses,
            move_s,
            pause_s,
        }
    }

    /// Returns the duration of the recording, s.
    pub fn duration_s(&self) -> f64 {
        FIRST_REST_S + self.move_s.iter().sum::<f64>() + self.pause_s * self.poses.len() as f64
    }

    /// Simulates the recording of the visit with the nominal robot, as blocks:
    ///
    /// ```text
    /// theta = q + tau_el/K,   tau_el = M ddq + C dq + g + F_c z + F_v dq
    /// ```
    ///
    /// with the friction state `z` of Dahl's law, a quantised `q` and a noisy `theta`.
    ///
    /// # Errors
    /// Returns [`StepError`] if the model of the arm cannot be evaluated.
    pub fn record(
        &self,
        robot: &Robot,
        sensors: Sensors,
        seed: u64,
    ) -> Result<Recorded, StepError> {
        let n = robot.arm.dof();
        let mut ws = ArmWorkspace::new(&robot.arm);
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut recorder = Recorder::new(robot, &FeatureConfig::default(), 1.0);
        let mut frame = Frame::new(n);
        let step_rad = std::f64::consts::TAU / f64::from(sensors.joint_bits).exp2();
        let mut z = vec![0.0; n];
        let (mut q, mut dq, mut ddq) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        let mut before = self.poses.first().cloned().unwrap_or_default();
        let mut tau_el = vec![0.0; n];
        let duration_s = self.duration_s();
        let frames = (duration_s * RATE_HZ) as u64;
        for k in 0..frames {
            let t = k as f64 / RATE_HZ;
            self.at(t, &mut q, &mut dq, &mut ddq);
            let tau = robot.arm.inverse_dynamics(&mut ws, &q, &dq, &ddq)?;
            frame.time_ns = (t * 1e9).round() as i64;
            for i in 0..n {
                frame.q[i] = (q[i] / step_rad).round() * step_rad;
                frame.theta[i] = frame.q[i];
                let travel = q[i] - before[i];
                if travel != 0.0 {
                    let sign = travel.signum();
                    z[i] = sign + (z[i] - sign) * libm::exp(-travel.abs() / PRESLIDING_RAD);
                }
                let Some(transmission) = &robot.transmissions[i] else {
                    continue;
                };
                let friction = transmission.joint_friction;
                tau_el[i] =
                    tau[i] + friction.coulomb_nm * z[i] + friction.viscous_nm_s_per_rad * dq[i];
            }
            for (i, transmission) in robot.transmissions.iter().enumerate() {
                let Some(transmission) = transmission else {
                    continue;
                };
                let routing = transmission.routing.as_ref();
                let torque = routing.map_or(tau_el[i], |routing| routing.torque(&tau_el));
                let noise: f64 = StandardNormal.sample(&mut rng);
                let theta = q[i]
                    + torque / transmission.stiffness_nm_per_rad
                    + sensors.motor_noise_rad * noise;
                frame.theta[i] = routing.map_or(theta, |routing| routing.at_motor(i, theta, &q));
            }
            before.copy_from_slice(&q);
            recorder.push(&frame, t);
        }
        let mut recorded = recorder.finish();
        recorded.duration_s = duration_s;
        Ok(recorded)
    }

    /// Computes position, velocity and acceleration at time `t`, s.
    fn at(&self, t: f64, q: &mut [f64], dq: &mut [f64], ddq: &mut [f64]) {
        dq.fill(0.0);
        ddq.fill(0.0);
        let mut start_s = FIRST_REST_S + self.pause_s;
        let mut from = match self.poses.first() {
            Some(first) => first,
            None => return,
        };
        q.copy_from_slice(from);
        for (to, move_s) in self.poses.iter().zip(&self.move_s).skip(1) {
            if t < start_s {
                return;
            }
            let s = ((t - start_s) / move_s).min(1.0);
            let (s2, s3) = (s * s, s * s * s);
            let share = s3 * (10.0 - 15.0 * s + 6.0 * s2);
            let rate = 30.0 * s2 * (1.0 - s) * (1.0 - s) / move_s;
            let curvature = 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / (move_s * move_s);
            for i in 0..q.len() {
                let way = to[i] - from[i];
                q[i] = from[i] + way * share;
                dq[i] = way * rate;
                ddq[i] = way * curvature;
            }
            start_s += move_s + self.pause_s;
            from = to;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn visit_derivatives_match_central_differences() {
        let visit = Visit {
            poses: vec![vec![0.0], vec![1.0], vec![-0.5]],
            move_s: vec![0.0, 1.2, 1.5],
            pause_s: 0.5,
        };
        let at = |t: f64| {
            let (mut q, mut dq, mut ddq) = ([0.0], [0.0], [0.0]);
            visit.at(t, &mut q, &mut dq, &mut ddq);
            (q[0], dq[0], ddq[0])
        };
        assert_eq!(at(3.0), (0.0, 0.0, 0.0));
        assert_eq!(at(4.9).0, 1.0);
        assert_eq!(at(60.0), (-0.5, 0.0, 0.0));
        // Central differences: h² times a third or fourth derivative of at most 360.
        let h = 1e-4;
        for t in [3.7, 4.1, 4.6, 5.5, 6.0] {
            let (_, dq, ddq) = at(t);
            assert!(((at(t + h).0 - at(t - h).0) / (2.0 * h) - dq).abs() < 1e-5);
            assert!(((at(t + h).1 - at(t - h).1) / (2.0 * h) - ddq).abs() < 1e-4);
        }
    }
}
