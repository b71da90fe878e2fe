//! Motor positions at which strands hold the joints at their set-points.

use super::paths::{Least, Paths};
use sinew_model::StepError;
use sinew_model::arm::{Arm, ArmWorkspace};
use sinew_model::correction::{CorrectionError, JointCorrection, Spring};
use sinew_model::robot::Robot;
use sinew_model::transmission::Friction;

/// Motor set-points of a robot with a group of tendons that has one equation per joint.
///
/// ```text
/// tau_d = g(q_d) + k_s (q_d − q_rest), in motion + M ddq_d + C dq_d + tau_friction
/// f     torques of the tendons that hold tau_d, see Paths::distribute
/// theta_set_i = l_i(q_d) + x_i + delta_i,   K x (1 + c x²) = f_i − f0_i
/// ```
///
/// The position of a motor with several tendons minimises `Σ K (theta − theta_set)²` over the taut tendons. Delta, K
/// and c are those specified for the controller; everything else is as described. Positions are in the coordinates of
/// the tendons.
#[derive(Debug, Clone)]
pub(crate) struct PulledSetPoint {
    arm: Arm,
    ws: ArmWorkspace,
    paths: Paths,
    tendons: Vec<Option<SpecifiedTendon>>,
    friction: Vec<Friction>,
    rest: Vec<f64>,
    tau: Vec<f64>,
    torque: Vec<f64>,
    theta: Vec<f64>,
}

/// Specified parameters of a tendon.
#[derive(Debug, Clone, Copy)]
struct SpecifiedTendon {
    described_nm_per_rad: f64,
    spring: Spring,
    delta_rad: f64,
}

impl PulledSetPoint {
    /// * `corrections`: one entry per axis.
    pub(crate) fn new(
        robot: &Robot,
        paths: &Paths,
        corrections: &[JointCorrection],
    ) -> Result<Self, CorrectionError> {
        let (dof, axes) = (robot.arm.dof(), robot.axes());
        let own = |j: usize| robot.transmissions[j].as_ref().map(|t| t.joint_friction);
        let friction = |j: usize| match paths.joint(j) {
            Some(joint) => joint.friction,
            None => own(j).unwrap_or_default(),
        };
        let transmissions = robot.transmissions.iter().zip(corrections).enumerate();
        let tendons = transmissions.map(|(i, (transmission, correction))| {
            let Some(transmission) = transmission else {
                return Ok(None);
            };
            SpecifiedTendon::new(i, transmission.stiffness_nm_per_rad, correction).map(Some)
        });
        Ok(Self {
            ws: ArmWorkspace::new(&robot.arm),
            arm: robot.arm.clone(),
            paths: paths.clone(),
            tendons: tendons.collect::<Result<_, _>>()?,
            friction: (0..dof).map(friction).collect(),
            rest: vec![0.0; dof],
            tau: vec![0.0; dof],
            torque: vec![0.0; axes],
            theta: vec![0.0; axes],
        })
    }

    /// Sets the specified correction of the tendon on an axis.
    pub(crate) fn set(
        &mut self,
        i: usize,
        correction: &JointCorrection,
    ) -> Result<(), CorrectionError> {
        if let Some(Some(tendon)) = self.tendons.get_mut(i) {
            *tendon = SpecifiedTendon::new(i, tendon.described_nm_per_rad, correction)?;
        }
        Ok(())
    }

    /// Returns the specified offset of the tendon on an axis, rad; for a motor with several tendons the mean by which
    /// its position shifts.
    pub(crate) fn delta(&self, i: usize) -> f64 {
        let (first, ratio) = self.paths.motor_axis(i);
        let own = |i: usize| self.tendons[i].map_or(0.0, |tendon| tendon.delta_rad);
        ratio * self.paths.of_motor(first, &self.torque, own)
    }

    /// Torque of a tendon for the latest set-point, in its coordinate, N·m; for a motor with several tendons, its
    /// total torque on the axis of the first.
    pub(crate) fn load(&self, i: usize) -> f64 {
        let followers = self.paths.followers().iter();
        let own = followers.filter(|(_, first, _)| *first == i);
        own.fold(self.torque[i], |sum, (axis, _, ratio)| {
            sum + ratio * self.torque[*axis]
        })
    }

    /// The latest set-point, by axis, rad of the tendons' coordinates.
    pub(crate) fn theta(&self, i: usize) -> f64 {
        self.theta[i]
    }

    /// Set-point for a wanted position, velocity and acceleration of the joints, each of `dof` entries; without the last two that for
    /// standing still.
    pub(crate) fn solve(
        &mut self,
        q_d: &[f64],
        motion: Option<[&[f64]; 2]>,
        least: Least,
    ) -> Result<(), StepError> {
        match motion {
            None => {
                let terms = self.arm.momentum(&mut self.ws, q_d, &self.rest)?;
                self.tau.copy_from_slice(terms.g);
            }
            Some([dq_d, ddq_d]) => {
                let tau = self.arm.inverse_dynamics(&mut self.ws, q_d, dq_d, ddq_d)?;
                self.tau.copy_from_slice(tau);
                for ((tau, friction), dq) in self.tau.iter_mut().zip(&self.friction).zip(dq_d) {
                    *tau += friction.torque(*dq);
                }
            }
        }
        for (j, (tau, q)) in self.tau.iter_mut().zip(q_d).enumerate() {
            *tau += self.paths.spring_torque(j, *q);
        }
        self.paths
            .distribute(q_d, &self.tau, least, &mut self.torque);
        let mut theta = std::mem::take(&mut self.theta);
        for (i, theta) in theta.iter_mut().enumerate() {
            *theta = match self.tendons[i] {
                None => 0.0,
                Some(tendon) => {
                    let held = self.torque[i] - self.paths.pretension_nm(i);
                    let x = tendon.spring.deflection(held);
                    let x = x.ok_or(StepError::Spring { joint: i })?;
                    self.paths.shortening(i, q_d) + x + tendon.delta_rad
                }
            };
        }
        self.paths.join(&self.torque, &mut theta);
        self.theta = theta;
        Ok(())
    }
}

impl SpecifiedTendon {
    fn new(
        axis: usize,
        described_nm_per_rad: f64,
        correction: &JointCorrection,
    ) -> Result<Self, CorrectionError> {
        let delta_rad = correction.delta_e_rad.mean;
        if !(delta_rad.abs() <= 1e6) {
            return Err(CorrectionError::Offset {
                joint: axis,
                delta_e: delta_rad,
            });
        }
        Ok(Self {
            described_nm_per_rad,
            spring: Spring::new(
                described_nm_per_rad * correction.stiffness_factor.mean,
                correction.cubic_per_rad2,
            )?,
            delta_rad,
        })
    }
}
