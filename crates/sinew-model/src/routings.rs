//! Routings of all tendons of a robot, as the matrices that the estimate and the observer need.
//!
//! See [`crate::tendons::Coupling::paired`] for the equations.

use crate::routing::moved_by_others;
use crate::transmission::Transmission;
use alloc::vec::Vec;

/// Routings of all tendons of a robot as matrices, each in the coordinate of the joint that its tendon is paired with; joints with a tendon of their own
/// have a row of the identity.
///
/// ```text
/// y_i = drive_ratio_i theta_motor − Σ_j rho_ij q_j,   tau_el_j = Σ_i rho_ij f_i,   f = B tau_el,   tau_motor_i = drive_ratio_i f_i
/// ```
///
/// # Realtime
/// No method but the constructor allocates, locks or panics.
#[derive(Debug, Clone, PartialEq)]
pub struct Routings {
    n: usize,
    /// `rho`, row-major `n × n`.
    moment_arms: Vec<f64>,
    /// `B`, row-major `n × n`.
    torque_shares: Vec<f64>,
    /// Stiffness in the coordinate of every joint, N·m/rad; 0 of a rigid one.
    stiffness: Vec<f64>,
    /// `drive_ratio`; 1 of a joint with a motor of its own.
    drive_ratios: Vec<f64>,
    /// Tendons with joints other than their own that they cross.
    crossings: Vec<(usize, usize)>,
}

impl Routings {
    /// Collects the routings of a robot; `None` where every joint has a tendon of its own. Allocates.
    ///
    /// * `transmissions`: one entry per joint, `None` for a rigid one.
    pub fn of(transmissions: &[Option<Transmission>]) -> Option<Self> {
        let routing = |t: &Option<Transmission>| t.as_ref().is_some_and(|t| t.routing.is_some());
        if !transmissions.iter().any(routing) {
            return None;
        }
        let n = transmissions.len();
        let mut routes = Self {
            n,
            moment_arms: alloc::vec![0.0; n * n],
            torque_shares: alloc::vec![0.0; n * n],
            stiffness: alloc::vec![0.0; n],
            drive_ratios: alloc::vec![1.0; n],
            crossings: Vec::new(),
        };
        for (i, transmission) in transmissions.iter().enumerate() {
            let row = i * n..(i + 1) * n;
            let (arms, shares) = (
                &mut routes.moment_arms[row.clone()],
                &mut routes.torque_shares[row],
            );
            arms[i] = 1.0;
            shares[i] = 1.0;
            let Some(transmission) = transmission else {
                continue;
            };
            routes.stiffness[i] = transmission.stiffness_nm_per_rad;
            let whole = transmission.routing.as_ref().filter(|routing| {
                routing.moment_arms.len() == n && routing.torque_shares.len() == n
            });
            if let Some(routing) = whole {
                arms.copy_from_slice(&routing.moment_arms);
                shares.copy_from_slice(&routing.torque_shares);
                routes.drive_ratios[i] = routing.drive_ratio;
            }
            let others = (0..n).filter(|j| *j != i && arms[*j] != 0.0);
            routes.crossings.extend(others.map(|j| (i, j)));
        }
        Some(routes)
    }

    /// Tendons, each with a joint other than its own that it crosses.
    pub(crate) fn crossings(&self) -> &[(usize, usize)] {
        &self.crossings
    }

    /// Moment arms of tendon `i`, `rho_i`, length `n`; empty where there is no such tendon.
    #[inline]
    pub fn moment_arms(&self, i: usize) -> &[f64] {
        let n = self.n;
        self.moment_arms.get(i * n..(i + 1) * n).unwrap_or_default()
    }

    /// Row `i` of `B`.
    #[inline]
    pub(crate) fn torque_shares(&self, i: usize) -> &[f64] {
        let n = self.n;
        self.torque_shares
            .get(i * n..(i + 1) * n)
            .unwrap_or_default()
    }

    /// Moment arm of tendon `i` at joint `j`, `rho_ij`; 0 where there is none.
    #[inline]
    pub fn moment_arm(&self, i: usize, j: usize) -> f64 {
        self.moment_arms(i).get(j).copied().unwrap_or(0.0)
    }

    /// Position in the coordinate of tendon `i` over that at the shaft of its motor; 1 where there is no such tendon.
    #[inline]
    pub fn drive_ratio(&self, i: usize) -> f64 {
        self.drive_ratios.get(i).copied().unwrap_or(1.0)
    }

    /// Path of tendon `i` by joint positions, velocities or accelerations, `Σ_j rho_ij x_j`.
    #[inline]
    pub fn path(&self, i: usize, x: &[f64]) -> f64 {
        let arms = self.moment_arms(i).iter().zip(x);
        arms.fold(0.0, |sum, (arm, x)| sum + arm * x)
    }

    /// Adds the torque `f` of tendon `i` to the elastic torques of the joints, N·m.
    #[inline]
    pub fn add_torque(&self, i: usize, f: f64, tau_el: &mut [f64]) {
        for (to, arm) in tau_el.iter_mut().zip(self.moment_arms(i)) {
            *to += arm * f;
        }
    }

    /// By how much the coordinate of tendon `i` moves with the joints beyond `q_i`, `Σ_j rho_ij q_j − q_i`, rad.
    #[inline]
    pub(crate) fn moved_by_others(&self, i: usize, q: impl Iterator<Item = f64>) -> f64 {
        moved_by_others(self.moment_arms(i), i, q)
    }

    /// Elastic torque of joint `j` over its stiffness, rad, by the nominal stiffnesses: `Σ_i rho_ij K_i y_i / K_j`.
    ///
    /// * `y`: extensions in the coordinates of the tendons, `n`, rad.
    #[inline]
    pub(crate) fn joint_deflection(&self, j: usize, y: impl Iterator<Item = f64>) -> f64 {
        let rows = self.moment_arms.chunks_exact(self.n.max(1));
        let torque = rows
            .zip(&self.stiffness)
            .zip(y)
            .fold(0.0, |sum, ((row, stiffness), y)| {
                sum + row.get(j).copied().unwrap_or(0.0) * stiffness * y
            });
        match self.stiffness.get(j) {
            Some(stiffness) if *stiffness > 0.0 => torque / stiffness,
            _ => 0.0,
        }
    }

    /// Torque of tendon `i` that carries elastic torques of the joints, `Σ_j B_ij tau_j`, N·m.
    #[inline]
    pub fn torque_of(&self, i: usize, x: impl Iterator<Item = f64>) -> f64 {
        let shares = self.torque_shares(i).iter().zip(x);
        shares.fold(0.0, |sum, (share, x)| sum + share * x)
    }
}
