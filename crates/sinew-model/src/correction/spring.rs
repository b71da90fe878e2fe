//! The spring of a transmission and its inverse.

use super::error::CorrectionError;

/// A spring that may stiffen: `tau_el = K x (1 + c x²)`, `x = theta − q`.
///
/// Its inverse is in closed form. With `A = 2/√(3|c|)` and `t = tau_el/K`:
///
/// ```text
/// c > 0   x = A sinh(asinh(3t/A)/3)      one solution for every torque
/// c = 0   x = t
/// c < 0   x = A sin(asin(3t/A)/3)        up to |x| = A/2, where the slope is 0; |t| ≤ A/3
/// ```
///
/// A softening spring (`c < 0`) is valid only up to its maximum torque: beyond it, and beyond the
/// corresponding deflection, the formula does not describe a rope.
///
/// # Source
/// `4 sinh³u + 3 sinh u = sinh 3u`, `3 sin u − 4 sin³u = sin 3u`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spring {
    stiffness_nm_per_rad: f64,
    cubic_per_rad2: f64,
}

impl Spring {
    /// A spring of stiffness `K`, N·m/rad (N/m), and stiffening `c`, 1/rad² (1/m²).
    ///
    /// # Errors
    /// Returns [`CorrectionError::Stiffness`] unless `K` is finite and above 0 (between 1e-9 and 1e12),
    /// [`CorrectionError::Cubic`] unless `|c|` is at most 1e6. The error contains joint 0, which the caller replaces
    /// by the actual joint.
    pub fn new(stiffness_nm_per_rad: f64, cubic_per_rad2: f64) -> Result<Self, CorrectionError> {
        // Far beyond any rope in any unit, far from where quotients and cubes overflow.
        if !(1e-9..=1e12).contains(&stiffness_nm_per_rad) {
            return Err(CorrectionError::Stiffness {
                joint: 0,
                stiffness_nm_per_rad,
            });
        }
        if !(cubic_per_rad2.abs() <= 1e6) {
            return Err(CorrectionError::Cubic {
                joint: 0,
                cubic_per_rad2,
            });
        }
        Ok(Self {
            stiffness_nm_per_rad,
            cubic_per_rad2,
        })
    }

    /// Stiffness `K`, N·m/rad.
    pub fn stiffness_nm_per_rad(&self) -> f64 {
        self.stiffness_nm_per_rad
    }

    /// Stiffening coefficient `c`, 1/rad².
    pub fn cubic_per_rad2(&self) -> f64 {
        self.cubic_per_rad2
    }

    /// `tau_el` at the deflection `x`, N·m.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    #[inline]
    pub fn torque(&self, x: f64) -> f64 {
        self.stiffness_nm_per_rad * x * (1.0 + self.cubic_per_rad2 * x * x)
    }

    /// `∂tau_el/∂x` at the deflection `x`, N·m/rad: the torque per rad of offset there.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    #[inline]
    pub fn slope(&self, x: f64) -> f64 {
        self.stiffness_nm_per_rad * (1.0 + 3.0 * self.cubic_per_rad2 * x * x)
    }

    /// Returns the deflection at the torque `tau_el`, rad; `None` if the torque exceeds the maximum
    /// of a softening spring, or is NaN or infinite.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn deflection(&self, tau_el: f64) -> Option<f64> {
        let t = tau_el / self.stiffness_nm_per_rad;
        if !t.is_finite() {
            return None;
        }
        let c = self.cubic_per_rad2;
        if c == 0.0 {
            return Some(t);
        }
        let a = 2.0 / libm::sqrt(3.0 * c.abs());
        let s = 3.0 * t / a;
        let x = if c > 0.0 {
            a * libm::sinh(libm::asinh(s) / 3.0)
        } else if s.abs() <= 1.0 {
            a * libm::sin(libm::asin(s) / 3.0)
        } else {
            return None;
        };
        Some(x)
    }
}
