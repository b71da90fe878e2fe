//! Tendons in the coordinates of the estimate, each related to a joint.
//!
//! The estimate has arrays of axes: an axis is a joint, a tendon with its motor, or both. In a group of as many loops as joints, with
//! constant moment arms and without passive springs, tendon `i` is paired with a joint `i` that it crosses. With
//! `a_i = |R_ii|`, `y_i = x_i / a_i` and `delta'_i = delta_i / a_i` in rad of that joint,
//!
//! ```text
//! theta_i = drive_ratio_i · theta_motor,   drive_ratio_i = s_i / a_i,   rho_ij = R_ij / a_i,   K_i = k_i a_i²
//! y_i = theta_i − Σ_j rho_ij q_j,   y_i = delta'_i + B_i· tau_el / K_i,   B = rho⁻ᵀ
//! tau_motor = drive_ratio_i · B_i· tau_el
//! ```
//!
//! For a joint with one tendon, `rho` and `B` are 1, which is `theta − q = delta_e + tau_el / K`.
//!
//! Every other group has an equation per joint, `Σ_i rho_ij f_i = tau_el_j`. Its tendons are assigned to the axes of
//! joints that they cross while these suffice, then to axes after those of all joints; `a_i = |R_ij|` of the main joint
//! `j`: that of the tendon's name, otherwise the one with the largest moment arm at `q = 0`.

use super::analysis::{Equations, Group};
use super::coupling::Coupling;
use super::state::CouplingState;
use crate::friction::Friction;
use crate::moment_arm::TendonKind;
use crate::routing::{Pull, PulledJoint, Routing};
use alloc::string::String;
use alloc::vec::Vec;

/// Tendon on its axis.
#[derive(Debug, Clone, PartialEq)]
pub struct PairedTendon {
    /// Index of the tendon.
    pub tendon: usize,
    /// `a_i`, units of the tendon's own coordinate per rad of the joint; above 0.
    pub units_per_rad: f64,
    /// Routing in the coordinate of the joint; the friction of pulled joints is 0.
    pub routing: Routing,
}

/// Reason why tendons cannot be paired with joints.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PairingError {
    /// A tendon has no motor, or several.
    #[error("tendon '{tendon}' has {motors} motors: a tendon that is estimated has one")]
    Motors {
        /// Name of the tendon.
        tendon: String,
        /// Number of its motors.
        motors: usize,
    },
    /// A motor drives several tendons.
    #[error(
        "motor '{motor}' drives tendons '{first}' and '{second}': a motor that is estimated drives one"
    )]
    SharedMotor {
        /// Name of the motor.
        motor: String,
        /// Name of the first tendon.
        first: String,
        /// Name of the second tendon.
        second: String,
    },
    /// The moment arms of a tendon vanish at `q = 0`.
    #[error(
        "tendon '{tendon}' has no moment arm at the zero position of any joint: move the zero of the joint to where the tendon pulls it"
    )]
    NoMomentArm {
        /// Name of the tendon.
        tendon: String,
    },
}

impl PairingError {
    /// Name of the tendon at fault.
    pub fn tendon(&self) -> Option<&str> {
        match self {
            Self::Motors { tendon, .. }
            | Self::SharedMotor { second: tendon, .. }
            | Self::NoMomentArm { tendon } => Some(tendon),
        }
    }
}

impl Coupling {
    /// Puts every tendon on an axis: that of the joint of its name where the tendon crosses that, otherwise in the order of the
    /// tendons. As many entries as axes, at least one per joint; `None` for a joint without a tendon on its axis.
    ///
    /// # Errors
    /// Returns a [`PairingError`] where a tendon has no motor or several, or a motor drives two tendons of which one has its own equation.
    pub fn paired(&self) -> Result<Vec<Option<PairedTendon>>, PairingError> {
        let mut paired = alloc::vec![None; self.joints.len()];
        let mut state = CouplingState::new(self);
        let at_zero = |length: usize| alloc::vec![0.0; length];
        let (n, m) = (self.joints.len(), self.motor_names().len());
        let evaluated = self.evaluate(
            &mut state,
            &at_zero(m),
            &at_zero(n),
            &at_zero(self.tendons.len()),
        );
        debug_assert!(evaluated.is_ok());
        let mut driven: Vec<Option<usize>> = alloc::vec![None; m];
        let mut without_joint = Vec::new();
        for group in self.groups() {
            let shares = self.torque_shares(&state, &group);
            let of_joint = self.pairing(&state, &group);
            for &tendon in group.tendons() {
                let motor = self.only_motor(tendon)?;
                if let (Some(first), true) = (driven[motor].replace(tendon), shares.is_some()) {
                    return Err(PairingError::SharedMotor {
                        motor: self.motor_names()[motor].clone(),
                        first: self.tendons[first].name.clone(),
                        second: self.tendons[tendon].name.clone(),
                    });
                }
                let axis = of_joint.iter().find(|(_, own)| *own == tendon);
                let joint = match (axis, &shares) {
                    (Some((joint, _)), Some(_)) => *joint,
                    _ => self.main_joint(&state, &group, tendon)?,
                };
                let arms = &state.moment_arms()[tendon * n..(tendon + 1) * n];
                let units_per_rad = arms[joint].abs();
                let torque_shares = shares.as_ref().map(|shares| {
                    let row = group.tendons().iter().position(|i| *i == tendon);
                    let width = group.joints().len();
                    let own = shares.chunks_exact(width).nth(row.unwrap_or_default());
                    let mut torque_shares = alloc::vec![0.0; n];
                    for (j, share) in group.joints().iter().zip(own.unwrap_or_default()) {
                        torque_shares[*j] = share * units_per_rad;
                    }
                    torque_shares
                });
                let pull = shares.is_none().then(|| self.pull(tendon, units_per_rad));
                let routed = PairedTendon {
                    tendon,
                    units_per_rad,
                    routing: Routing {
                        tendon: self.tendons[tendon].name.clone(),
                        joint,
                        motor: self.motor_names()[motor].clone(),
                        drive_ratio: self.drums()[tendon * m + motor] / units_per_rad,
                        moment_arms: arms.iter().map(|r| r / units_per_rad).collect(),
                        torque_shares: torque_shares.unwrap_or_default(),
                        pull,
                    },
                };
                match axis {
                    Some((joint, _)) => paired[*joint] = Some(routed),
                    None => without_joint.push(Some(routed)),
                }
            }
        }
        paired.extend(without_joint);
        Ok(paired)
    }

    /// Returns the pull of a tendon in a coordinate of `units_per_rad` units per rad.
    fn pull(&self, i: usize, units_per_rad: f64) -> Pull {
        let tendon = &self.tendons[i];
        let elastic = tendon
            .arms
            .iter()
            .filter(|(j, _)| !self.joints[*j].is_rigid);
        let metres = tendon.coordinate.metres_per_unit();
        Pull {
            kind: tendon.kind,
            pretension_nm: match tendon.kind {
                TendonKind::Loop => 0.0,
                TendonKind::Strand => tendon.pretension.unwrap_or(0.0) * units_per_rad,
            },
            metres_per_rad: metres.map(|metres| metres * units_per_rad),
            joints: elastic
                .map(|(joint, arm)| PulledJoint {
                    joint: *joint,
                    arm: arm.over(units_per_rad),
                    friction: Friction::default(),
                    spring: self.joints[*joint].spring,
                })
                .collect(),
        }
    }

    /// Joint whose rad are the coordinate of a tendon: that of its name, otherwise the one with the largest moment arm.
    fn main_joint(
        &self,
        state: &CouplingState,
        group: &Group,
        tendon: usize,
    ) -> Result<usize, PairingError> {
        let n = self.joints.len();
        let arm = |j: usize| state.moment_arms()[tendon * n + j].abs();
        let crossed = || group.joints().iter().copied().filter(|j| arm(*j) > 0.0);
        let named = crossed().find(|j| self.joints[*j].name == self.tendons[tendon].name);
        let largest = || crossed().max_by(|a, b| arm(*a).total_cmp(&arm(*b)));
        named
            .or_else(largest)
            .ok_or_else(|| PairingError::NoMomentArm {
                tendon: self.tendons[tendon].name.clone(),
            })
    }

    /// Returns `R⁻ᵀ` of a group with an equation per tendon, indexed by its tendons and joints; `None` for a group with
    /// an equation per joint.
    fn torque_shares(&self, state: &CouplingState, group: &Group) -> Option<Vec<f64>> {
        if matches!(group.equations(), Equations::Joint(_)) {
            return None;
        }
        let n = group.joints().len();
        let mut shares = alloc::vec![0.0; n * n];
        for j in 0..n {
            let mut torque = alloc::vec![0.0; n];
            torque[j] = 1.0;
            let tension = self.tension_from_torque(state, group, &torque).ok()?;
            for (i, f) in tension.into_iter().enumerate() {
                shares[i * n + j] = f;
            }
        }
        Some(shares)
    }

    /// Joints of a group with the tendon that each is paired with: a maximum matching of the nonzero moment arms.
    fn pairing(&self, state: &CouplingState, group: &Group) -> Vec<(usize, usize)> {
        let n = self.joints.len();
        let crosses = |i: usize, j: usize| state.moment_arms()[i * n + j] != 0.0;
        let mut of_joint: Vec<Option<usize>> = alloc::vec![None; n];
        for &i in group.tendons() {
            let named = |j: &&usize| self.joints[**j].name == self.tendons[i].name;
            if let Some(&j) = group
                .joints()
                .iter()
                .find(named)
                .filter(|j| crosses(i, **j))
            {
                of_joint[j] = Some(i);
            }
        }
        for &i in group.tendons() {
            if !of_joint.contains(&Some(i)) {
                let mut visited = alloc::vec![false; n];
                augment(i, group.joints(), &crosses, &mut of_joint, &mut visited);
            }
        }
        let joints = group.joints().iter();
        joints.filter_map(|j| Some((*j, of_joint[*j]?))).collect()
    }

    fn only_motor(&self, tendon: usize) -> Result<usize, PairingError> {
        let m = self.motor_names().len();
        let drums = self.drums()[tendon * m..(tendon + 1) * m].iter();
        let own: Vec<usize> = (drums.enumerate())
            .filter(|(_, s)| **s != 0.0)
            .map(|(k, _)| k)
            .collect();
        match own[..] {
            [motor] => Ok(motor),
            _ => Err(PairingError::Motors {
                tendon: self.tendons[tendon].name.clone(),
                motors: own.len(),
            }),
        }
    }
}

/// Finds a joint for a tendon, for which others may have to take another one: an augmenting path (Kuhn 1955).
fn augment(
    tendon: usize,
    joints: &[usize],
    crosses: &impl Fn(usize, usize) -> bool,
    of_joint: &mut [Option<usize>],
    visited: &mut [bool],
) -> bool {
    for &j in joints {
        if !crosses(tendon, j) || core::mem::replace(&mut visited[j], true) {
            continue;
        }
        let is_free = match of_joint[j] {
            None => true,
            Some(other) => augment(other, joints, crosses, of_joint, visited),
        };
        if is_free {
            of_joint[j] = Some(tendon);
            return true;
        }
    }
    false
}
