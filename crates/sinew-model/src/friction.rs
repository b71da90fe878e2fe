//! Friction of joints and drives.

/// Coulomb and viscous friction, `tau_friction = coulomb · sat(dq/dq_s) + viscous · dq`.
///
/// `sat` rises linearly to ±1 at the speed `dq_s` = [`Friction::SMOOTHING_RAD_PER_S`], because a
/// sign function of a measured speed would chatter between ±coulomb in every pause.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Friction {
    /// Coulomb friction, N·m (N), at least 0.
    pub coulomb_nm: f64,
    /// Viscous friction, N·m·s/rad (N·s/m), at least 0.
    pub viscous_nm_s_per_rad: f64,
}

impl Friction {
    /// Speed at which Coulomb friction is fully there, rad/s: well above the speed noise of a
    /// filtered 13-bit encoder (about 0.005 rad/s), well below working speeds.
    pub const SMOOTHING_RAD_PER_S: f64 = 0.02;

    /// Default Coulomb friction of a joint over its stiffness, rad: that of the BioRob-like arm, an
    /// assumed value with a standard deviation of 100 %.
    pub const DEFAULT_JOINT_RAD: f64 = 2e-3;
    /// Default Coulomb friction of a drive over the stiffness, seen from the joint, rad.
    pub const DEFAULT_DRIVE_RAD: f64 = 1e-2;

    /// Returns the specified friction, or the default if none is specified: Coulomb friction proportional
    /// to the stiffness, and 0.6 times it as viscous friction at 1 rad/s.
    #[must_use]
    pub fn or_default(self, stiffness_nm_per_rad: f64, over_stiffness_rad: f64) -> Self {
        const VISCOUS_S_PER_RAD: f64 = 0.6;
        if self.is_specified() {
            return self;
        }
        let coulomb_nm = over_stiffness_rad * stiffness_nm_per_rad;
        Self {
            coulomb_nm,
            viscous_nm_s_per_rad: VISCOUS_S_PER_RAD * coulomb_nm,
        }
    }

    /// Whether friction is specified: no joint is without friction, so that zero means unspecified.
    pub fn is_specified(&self) -> bool {
        self.coulomb_nm > 0.0 || self.viscous_nm_s_per_rad > 0.0
    }

    /// Friction torque at speed `dq`, N·m, positive when it brakes positive motion.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    #[inline]
    pub fn torque(&self, dq: f64) -> f64 {
        self.coulomb_nm * (dq / Self::SMOOTHING_RAD_PER_S).clamp(-1.0, 1.0)
            + self.viscous_nm_s_per_rad * dq
    }
}
