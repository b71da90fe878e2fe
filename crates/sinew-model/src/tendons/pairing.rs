//! Tendons in the coordinate of the joint that each is paired with, in which the estimate reads them.
//!
//! In a group of as many loops as joints, with constant moment arms, tendon `i` is paired with a joint `i` that it crosses. With
//! `a_i = |R_ii|`, `y_i = x_i / a_i` and `delta'_i = delta_i / a_i` in rad of that joint,
//!
//! ```text
//! theta_i = drive_ratio_i · theta_motor,   drive_ratio_i = s_i / a_i,   rho_ij = R_ij / a_i,   K_i = k_i a_i²
//! y_i = theta_i − Σ_j rho_ij q_j,   y_i = delta'_i + B_i· tau_el / K_i,   B = rho⁻ᵀ
//! tau_motor = drive_ratio_i · B_i· tau_el
//! ```
//!
//! For a joint with a tendon of its own, `rho` and `B` are 1, which is `theta − q = delta_e + tau_el / K`.

use super::analysis::{Equations, Group, JointEquationsReason};
use super::coupling::Coupling;
use super::state::CouplingState;
use crate::routing::Routing;
use alloc::string::String;
use alloc::vec::Vec;

/// Tendon with the joint it is paired with.
#[derive(Debug, Clone, PartialEq)]
pub struct PairedTendon {
    /// Index of the tendon.
    pub tendon: usize,
    /// `a_i`, units of the tendon's own coordinate per rad of the joint; above 0.
    pub units_per_rad: f64,
    /// Routing in the coordinate of the joint.
    pub routing: Routing,
}

/// Reason why tendons cannot be paired with joints.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PairingError {
    /// The group needs one equation per joint.
    #[error(
        "tendons {tendons} cannot be estimated yet: {why}. A group is estimated that has as many loops as joints, with constant moment arms"
    )]
    JointEquations {
        /// Names of the group's tendons, separated by commas.
        tendons: String,
        /// Reason in words.
        why: String,
    },
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
    /// A joint of the group has a passive spring.
    #[error(
        "joint '{joint}' has a passive spring, which is not estimated together with tendons yet"
    )]
    Spring {
        /// Name of the joint.
        joint: String,
    },
}

impl Coupling {
    /// Pairs every tendon with a joint: one of the same name where it crosses that, otherwise in the order of the tendons.
    /// `None` for a rigid joint.
    ///
    /// # Errors
    /// [`PairingError`] where a group is none of as many loops as joints with constant moment arms and one motor each.
    pub fn paired(&self) -> Result<Vec<Option<PairedTendon>>, PairingError> {
        let mut paired = alloc::vec![None; self.joints.len()];
        let mut state = CouplingState::new(self);
        let at_zero = |length: usize| alloc::vec![0.0; length];
        let (n, m) = (self.joints.len(), self.motor_names().len());
        // Constant moment arms are the same everywhere.
        let evaluated = self.evaluate(
            &mut state,
            &at_zero(m),
            &at_zero(n),
            &at_zero(self.tendons.len()),
        );
        debug_assert!(evaluated.is_ok());
        let mut driven: Vec<Option<usize>> = alloc::vec![None; m];
        for group in self.groups() {
            if let Equations::Joint(reason) = group.equations() {
                return Err(self.needs_joint_equations(&group, reason));
            }
            if let Some(j) = (group.joints().iter()).find(|j| self.joints[**j].spring.is_some()) {
                let joint = self.joints[*j].name.clone();
                return Err(PairingError::Spring { joint });
            }
            let unpairable = || self.needs_joint_equations(&group, JointEquationsReason::NotSquare);
            let shares = self.torque_shares(&state, &group).ok_or_else(unpairable)?;
            let of_joint = self.pairing(&state, &group).ok_or_else(unpairable)?;
            for (j, tendon) in of_joint {
                let motor = self.only_motor(tendon)?;
                if let Some(first) = driven[motor].replace(tendon) {
                    return Err(PairingError::SharedMotor {
                        motor: self.motor_names()[motor].clone(),
                        first: self.tendons[first].name.clone(),
                        second: self.tendons[tendon].name.clone(),
                    });
                }
                let arms = &state.moment_arms()[tendon * n..(tendon + 1) * n];
                let units_per_rad = arms[j].abs();
                let row = group.tendons().iter().position(|i| *i == tendon);
                let mut torque_shares = alloc::vec![0.0; n];
                let width = group.joints().len();
                let own = shares.chunks_exact(width).nth(row.unwrap_or_default());
                for (j, share) in group.joints().iter().zip(own.unwrap_or_default()) {
                    torque_shares[*j] = share * units_per_rad;
                }
                paired[j] = Some(PairedTendon {
                    tendon,
                    units_per_rad,
                    routing: Routing {
                        tendon: self.tendons[tendon].name.clone(),
                        motor: self.motor_names()[motor].clone(),
                        drive_ratio: self.drums()[tendon * m + motor] / units_per_rad,
                        moment_arms: arms.iter().map(|r| r / units_per_rad).collect(),
                        torque_shares,
                    },
                });
            }
        }
        Ok(paired)
    }

    /// `R⁻ᵀ` of a group, its tendons by its joints; `None` where it has no full rank.
    fn torque_shares(&self, state: &CouplingState, group: &Group) -> Option<Vec<f64>> {
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

    /// Joints of a group with the tendon that each is paired with: a perfect matching of the nonzero moment arms.
    fn pairing(&self, state: &CouplingState, group: &Group) -> Option<Vec<(usize, usize)>> {
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
                augment(i, group.joints(), &crosses, &mut of_joint, &mut visited).then_some(())?;
            }
        }
        let joints = group.joints().iter();
        joints.map(|j| Some((*j, of_joint[*j]?))).collect()
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

    fn needs_joint_equations(&self, group: &Group, reason: JointEquationsReason) -> PairingError {
        let name = |i: usize| self.tendons[i].name.as_str();
        let names: Vec<String> = (group.tendons().iter())
            .map(|i| alloc::format!("'{}'", name(*i)))
            .collect();
        PairingError::JointEquations {
            tendons: names.join(", "),
            why: match reason {
                JointEquationsReason::NotSquare => alloc::format!(
                    "{} tendons drive {} joints",
                    group.tendons().len(),
                    group.joints().len()
                ),
                JointEquationsReason::Strand(i) => {
                    alloc::format!("'{}' is a strand, which only pulls", name(i))
                }
                JointEquationsReason::VariableMomentArm(i) => {
                    alloc::format!("a moment arm of '{}' varies with the position", name(i))
                }
                JointEquationsReason::IllConditioned(condition) => alloc::format!(
                    "their moment arms are nearly dependent, condition number {condition:.0}"
                ),
            },
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
