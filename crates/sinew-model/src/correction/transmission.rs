//! Motor position and elastic torque without the offset.

use super::error::CorrectionError;
use super::spring::Spring;
use crate::error::is_input;
use crate::routings::Routings;
use crate::transmission::Transmission;
use crate::{Gaussian, StepError};
use alloc::vec::Vec;

/// Correction of a transmission relative to its description, with its uncertainty.
///
/// The default is a transmission as described: no offset, no uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointCorrection {
    /// Offset `delta_e`, rad.
    pub delta_e_rad: Gaussian,
    /// Stiffness over the description's.
    pub stiffness_factor: Gaussian,
    /// Stiffening `c`, 1/rad².
    pub cubic_per_rad2: f64,
}

impl Default for JointCorrection {
    fn default() -> Self {
        Self {
            delta_e_rad: Gaussian::new(0.0, 0.0),
            stiffness_factor: Gaussian::new(1.0, 0.0),
            cubic_per_rad2: 0.0,
        }
    }
}

impl JointCorrection {
    /// Creates a correction of the offset only; all other values are those of the description.
    pub fn offset(delta_e_rad: Gaussian) -> Self {
        Self {
            delta_e_rad,
            ..Self::default()
        }
    }
}

/// One elastic joint, ready for a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Corrected {
    pub(super) spring: Spring,
    pub(super) delta_e: f64,
    pub(super) delta_e_std: f64,
    pub(super) stiffness_std: f64,
    /// Stiffness of the description, N·m/rad: factors refer to it.
    described_nm_per_rad: f64,
}

impl Corrected {
    fn new(
        joint: usize,
        described_nm_per_rad: f64,
        c: &JointCorrection,
    ) -> Result<Self, CorrectionError> {
        let (offset, factor) = (c.delta_e_rad, c.stiffness_factor);
        if !(offset.mean.abs() <= 1e6) {
            return Err(CorrectionError::Offset {
                joint,
                delta_e: offset.mean,
            });
        }
        for (what, value) in [
            ("standard deviation of the offset", offset.std),
            ("standard deviation of the stiffness factor", factor.std),
        ] {
            if !(0.0..=1e6).contains(&value) {
                return Err(CorrectionError::Tolerance {
                    what,
                    joint,
                    value,
                    must: "between 0 and 1e6",
                });
            }
        }
        let spring = Spring::new(described_nm_per_rad * factor.mean, c.cubic_per_rad2)
            .map_err(|e| e.of_joint(joint))?;
        Ok(Self {
            spring,
            delta_e: offset.mean,
            delta_e_std: offset.std,
            stiffness_std: factor.std / factor.mean,
            described_nm_per_rad,
        })
    }
}

/// Motor positions and elastic torques of an arm, corrected for the elongation of its ropes.
///
/// A tendon with a [`Routing`](crate::tendons::Routing) is corrected in the coordinate of the joint that it is paired with: its offset, stiffness
/// and stiffening are of that coordinate. Positions of its motor are those of the motor's encoder.
///
/// ```text
/// x_i = drive_ratio_i theta_i − delta_e_i − Σ_j rho_ij q_j,   f_i = K_i x_i (1 + c_i x_i²),   tau_el_j = Σ_i rho_ij f_i
/// ```
///
/// # Realtime
/// Everything is allocated at construction.
#[derive(Debug, Clone, PartialEq)]
pub struct Correction {
    joints: Vec<Option<Corrected>>,
    /// Routings of tendons that cross several joints.
    routes: Option<Routings>,
}

impl Correction {
    /// One transmission and one correction per joint; `None` for rigid joints, whose correction
    /// must be the default.
    ///
    /// # Errors
    /// Returns a [`CorrectionError`], naming the joint and the value.
    pub fn new(
        transmissions: &[Option<Transmission>],
        corrections: &[JointCorrection],
    ) -> Result<Self, CorrectionError> {
        if transmissions.len() != corrections.len() {
            return Err(CorrectionError::Length {
                expected: transmissions.len(),
                found: corrections.len(),
            });
        }
        let expected = transmissions.len();
        let routings = transmissions.iter().enumerate();
        for (axis, routing) in
            routings.filter_map(|(i, t)| Some((i, t.as_ref()?.routing.as_ref()?)))
        {
            if routing.pull.is_some() {
                return Err(CorrectionError::JointEquations { axis });
            }
            for row in [&routing.moment_arms, &routing.torque_shares] {
                if row.len() != expected {
                    return Err(CorrectionError::Length {
                        expected,
                        found: row.len(),
                    });
                }
            }
        }
        let mut joints = Vec::with_capacity(transmissions.len());
        for (joint, (t, c)) in transmissions.iter().zip(corrections).enumerate() {
            joints.push(match t {
                Some(t) => Some(Corrected::new(joint, t.stiffness_nm_per_rad, c)?),
                None if *c == JointCorrection::default() => None,
                None => return Err(CorrectionError::Rigid { joint }),
            });
        }
        Ok(Self {
            joints,
            routes: Routings::of(transmissions),
        })
    }

    /// Transmissions as described: no offset anywhere.
    ///
    /// # Errors
    /// Returns [`CorrectionError::Stiffness`].
    pub fn none(transmissions: &[Option<Transmission>]) -> Result<Self, CorrectionError> {
        Self::new(
            transmissions,
            &alloc::vec![JointCorrection::default(); transmissions.len()],
        )
    }

    /// Changes the correction of one joint: an offset is tracked over months.
    ///
    /// # Errors
    /// Returns a [`CorrectionError`] for an invalid value; nothing is then changed.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn set(
        &mut self,
        joint: usize,
        correction: &JointCorrection,
    ) -> Result<(), CorrectionError> {
        match self.joints.get_mut(joint) {
            Some(Some(slot)) => {
                *slot = Corrected::new(joint, slot.described_nm_per_rad, correction)?;
                Ok(())
            }
            _ => Err(CorrectionError::Rigid { joint }),
        }
    }

    /// Number of joints.
    pub fn dof(&self) -> usize {
        self.joints.len()
    }

    /// The spring of a joint's tendon, stiffness factor included; `None` for a rigid joint.
    pub fn spring(&self, joint: usize) -> Option<&Spring> {
        self.joints.get(joint)?.as_ref().map(|j| &j.spring)
    }

    /// The offset of a joint's tendon, rad; `None` for a rigid joint.
    pub fn delta_e(&self, joint: usize) -> Option<f64> {
        self.joints.get(joint)?.as_ref().map(|j| j.delta_e)
    }

    pub(super) fn joints(&self) -> &[Option<Corrected>] {
        &self.joints
    }

    pub(super) fn routes(&self) -> Option<&Routings> {
        self.routes.as_ref()
    }

    /// Motor position without the offset, `theta = theta_measured − delta_e`; with a routing, `theta_measured − delta_e
    /// / drive_ratio`.
    ///
    /// * `theta_measured`: `n`, rad. `theta`: `n`, written, rad; a rigid joint's is copied.
    ///
    /// # Errors
    /// Returns [`StepError::Length`], [`StepError::NotFinite`] (an elastic joint's position); nothing is
    /// then written.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. O(n).
    ///
    /// # Source
    /// Kirchhoff, von Stryk, IROS 2018, eq. (4).
    pub fn motor_position(
        &self,
        theta_measured: &[f64],
        theta: &mut [f64],
    ) -> Result<(), StepError> {
        self.check(theta_measured, theta.len())?;
        if let Some(routes) = &self.routes {
            let rows = self.joints.iter().zip(theta_measured).zip(theta);
            for (i, ((joint, measured), theta)) in rows.enumerate() {
                let delta_e = joint.as_ref().map_or(0.0, |j| j.delta_e);
                *theta = measured - delta_e / routes.drive_ratio(i);
            }
            return Ok(());
        }
        for ((joint, measured), theta) in self.joints.iter().zip(theta_measured).zip(theta) {
            *theta = measured - joint.as_ref().map_or(0.0, |j| j.delta_e);
        }
        Ok(())
    }

    /// Computes the actual torque of the springs, `tau_el = K x (1 + c x²)`, `x = theta_measured − delta_e − q`; with a
    /// routing that of all tendons at the joint, `Σ_i rho_ij f_i`.
    ///
    /// * `theta_measured`, `q`: `n`, rad. `tau_el`: `n`, written, N·m; NaN for a rigid joint, whose torque is not
    ///   determined by positions.
    ///
    /// # Errors
    /// Returns the errors of [`Correction::motor_position`].
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. O(n), with routings O(n²).
    ///
    /// # Source
    /// Kirchhoff, von Stryk, IROS 2018, eq. (3) and (4).
    pub fn elastic_torque(
        &self,
        theta_measured: &[f64],
        q: &[f64],
        tau_el: &mut [f64],
    ) -> Result<(), StepError> {
        self.check(theta_measured, tau_el.len())?;
        self.check(q, tau_el.len())?;
        if let Some(routes) = &self.routes {
            self.joint_torques(routes, theta_measured, q, tau_el);
            return Ok(());
        }
        let rows = self.joints.iter().zip(theta_measured).zip(q).zip(tau_el);
        for (((joint, measured), q), tau_el) in rows {
            *tau_el = match joint {
                Some(j) => j.spring.torque(measured - j.delta_e - q),
                None => f64::NAN,
            };
        }
        Ok(())
    }

    /// Sums the torques of all tendons at every joint.
    fn joint_torques(
        &self,
        routes: &Routings,
        theta_measured: &[f64],
        q: &[f64],
        tau_el: &mut [f64],
    ) {
        tau_el.fill(0.0);
        let tendons = self.joints.iter().zip(theta_measured).enumerate();
        for (i, (joint, measured)) in tendons {
            let Some(joint) = joint else { continue };
            let x = routes.drive_ratio(i) * measured - joint.delta_e - routes.path(i, q);
            routes.add_torque(i, joint.spring.torque(x), tau_el);
        }
        for (to, joint) in tau_el.iter_mut().zip(&self.joints) {
            if joint.is_none() {
                *to = f64::NAN;
            }
        }
    }

    fn check(&self, positions: &[f64], written: usize) -> Result<(), StepError> {
        if positions.len() != self.joints.len() || written != self.joints.len() {
            return Err(StepError::Length);
        }
        let bad = |(joint, x): (&Option<Corrected>, &f64)| joint.is_some() && !is_input(*x);
        if self.joints.iter().zip(positions).any(bad) {
            return Err(StepError::NotFinite);
        }
        Ok(())
    }
}
