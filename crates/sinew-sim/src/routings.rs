//! Tendons that cross several joints, as plant, controller and recording need them.

use sinew_model::transmission::Transmission;

/// Routings of a robot's tendons, each in the coordinate of the joint that it is paired with. A tendon `i` with the torque `f_i`
/// there, a motor at `theta_i` and joints at `q` has
///
/// ```text
/// x_i = theta_i − Σ_j rho_ij q_j − delta_e_i,   tau_el_j = Σ_i rho_ij f_i,   f = B tau_el,   B = rho⁻ᵀ
/// theta_i = drive_ratio_i · theta_motor,        tau_motor = drive_ratio_i · f_i
/// ```
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Routings {
    /// `rho`, row-major `n × n`.
    moment_arms: Vec<f64>,
    /// `B`, row-major `n × n`.
    torque_shares: Vec<f64>,
    drive_ratios: Vec<f64>,
}

impl Routings {
    /// Routings of a robot; `None` where every joint has a tendon of its own.
    pub(crate) fn of(transmissions: &[&Transmission]) -> Option<Self> {
        if transmissions.iter().all(|t| t.routing.is_none()) {
            return None;
        }
        let n = transmissions.len();
        let mut routings = Self {
            moment_arms: Vec::with_capacity(n * n),
            torque_shares: Vec::with_capacity(n * n),
            drive_ratios: Vec::with_capacity(n),
        };
        for (i, transmission) in transmissions.iter().enumerate() {
            let own: Vec<f64> = (0..n).map(|j| f64::from(u8::from(i == j))).collect();
            let routing = transmission.routing.as_ref();
            let (arms, shares, ratio) = routing.map_or((&own, &own, 1.0), |routing| {
                (
                    &routing.moment_arms,
                    &routing.torque_shares,
                    routing.drive_ratio,
                )
            });
            routings.moment_arms.extend(arms);
            routings.torque_shares.extend(shares);
            routings.drive_ratios.push(ratio);
        }
        Some(routings)
    }

    fn row(matrix: &[f64], i: usize, n: usize) -> &[f64] {
        &matrix[i * n..(i + 1) * n]
    }

    /// Row `i` of `rho`.
    pub(crate) fn moment_arms(&self, i: usize) -> &[f64] {
        Self::row(&self.moment_arms, i, self.drive_ratios.len())
    }

    /// `Σ_j rho_ij x_j` of joint positions, velocities or accelerations.
    #[inline]
    pub(crate) fn of_joints(&self, i: usize, x: &[f64]) -> f64 {
        let arms = self.moment_arms(i).iter();
        arms.zip(x).map(|(arm, x)| arm * x).sum()
    }

    /// Adds the torque `f` of tendon `i` to those of the joints, N·m.
    #[inline]
    pub(crate) fn add_torque(&self, i: usize, f: f64, tau_el: &mut [f64]) {
        for (to, arm) in tau_el.iter_mut().zip(self.moment_arms(i)) {
            *to += arm * f;
        }
    }

    /// `f_i = Σ_j B_ij tau_el_j`, N·m.
    pub(crate) fn tendon_torque(&self, i: usize, tau_el: &[f64]) -> f64 {
        let shares = Self::row(&self.torque_shares, i, self.drive_ratios.len()).iter();
        shares.zip(tau_el).map(|(share, tau)| share * tau).sum()
    }

    /// Position in the coordinate of tendon `i` over that at the motor's shaft.
    #[inline]
    pub(crate) fn drive_ratio(&self, i: usize) -> f64 {
        self.drive_ratios[i]
    }
}
