//! Friction with pre-sliding.

/// True friction of one joint or drive.
///
/// `tau_friction = (F_c + μ |tau_el|) z + F_v dq`; the pre-sliding state `z` in −1…1 follows the
/// travel `x` as `dz/dx = (1 − z sign(dx)) / x_s` (Dahl). Below `F_c` the joint moves by about `x_s` and stops; during
/// sliding, `z` is the sign of the speed.
///
/// Dahl's model is used instead of the sign of the speed, because it is defined at rest and needs no event search, and
/// instead of a stop operator, because it also dissipates energy in pre-sliding.
///
/// # Source
/// P. Dahl, *A Solid Friction Model*, Aerospace Corporation TOR-0158(3107-18)-1, 1968.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Friction {
    /// Coulomb friction torque `F_c`, N·m.
    pub coulomb_nm: f64,
    /// Load-dependent friction coefficient `μ`.
    pub torque_fraction: f64,
    /// Viscous friction coefficient `F_v`, N·m·s/rad.
    pub viscous_nm_s_per_rad: f64,
    /// Presliding distance `x_s`, rad.
    pub presliding_rad: f64,
}

impl Friction {
    /// Returns `z` after a travel of `dx` in one direction.
    ///
    /// The law's exact solution, so that the stiff pre-sliding spring puts no limit on the step
    /// and `z` cannot leave −1…1.
    #[inline]
    pub fn presliding(&self, z: f64, dx: f64) -> f64 {
        if dx == 0.0 || self.presliding_rad == 0.0 {
            return z;
        }
        let sign = if dx > 0.0 { 1.0 } else { -1.0 };
        sign + (z - sign) * libm::exp(-dx.abs() / self.presliding_rad)
    }

    /// Friction torque, N·m, positive when it brakes positive motion.
    #[inline]
    pub fn torque(&self, z: f64, dq: f64, tau_el: f64) -> f64 {
        (self.coulomb_nm + self.torque_fraction * tau_el.abs()) * z + self.viscous_nm_s_per_rad * dq
    }

    /// Whether `z` matters.
    #[inline]
    pub fn is_dry(&self) -> bool {
        self.coulomb_nm > 0.0 || self.torque_fraction > 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const F: Friction = Friction {
        coulomb_nm: 0.1,
        torque_fraction: 0.0,
        viscous_nm_s_per_rad: 0.0,
        presliding_rad: 1e-3,
    };

    #[test]
    fn presliding_is_independent_of_step() {
        let whole = F.presliding(-0.3, 2e-3);
        let mut z = -0.3;
        for _ in 0..100 {
            z = F.presliding(z, 2e-5);
        }
        assert!((z - whole).abs() < 1e-13, "{z} against {whole}");
    }

    #[test]
    fn presliding_saturates_with_sign_of_motion() {
        assert!((F.presliding(-1.0, 1.0) - 1.0).abs() < 1e-15);
        assert_eq!(F.presliding(0.4, 0.0), 0.4);
        assert!(F.presliding(1.0, -1e9) >= -1.0);
    }
}
