//! Positions and velocities from encoders.

/// Second-order state-variable filter: a smoothed signal and its exact derivative.
///
/// `ẍ = ω² (u − x) − 2 ω ẋ`, critically damped, unit gain at standstill, delay `2/ω`. The
/// derivative is that of the filtered signal, with no differencing of encoder steps: a finite
/// difference of a 12–14 bit joint encoder ruins the estimate (4–8 mrad), this keeps it at
/// 0.05–0.3 mrad with `ω` of 30–60 rad/s.
///
/// Solved exactly over a step for an input that is linear between samples, so any step and any
/// `ω` are stable:
///
/// ```text
/// m  = (u₁ − u₀)/Δt,  x_p(t) = u(t) − 2m/ω,  E = exp(−ω Δt)
/// x₁ = x_p(Δt) + E [(1 + ωΔt) e + Δt f],     e = x₀ − x_p(0)
/// ẋ₁ = m       + E [(1 − ωΔt) f − ω²Δt e],   f = ẋ₀ − m
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StateVariableFilter {
    input: f64,
    x: f64,
    dx: f64,
}

impl StateVariableFilter {
    /// Starts at rest at `u`.
    pub fn settled_at(u: f64) -> Self {
        Self {
            input: u,
            x: u,
            dx: 0.0,
        }
    }

    /// `exp(−ω Δt)`, shared by all joints of a step.
    #[inline]
    pub fn decay(omega_rad_per_s: f64, dt_s: f64) -> f64 {
        libm::exp(-omega_rad_per_s * dt_s)
    }

    /// One step of `dt_s` to the sample `u`, with `decay` from [`StateVariableFilter::decay`].
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    #[inline]
    pub fn step(&mut self, omega_rad_per_s: f64, dt_s: f64, decay: f64, u: f64) {
        let w = omega_rad_per_s;
        let slope = (u - self.input) / dt_s;
        let lag = 2.0 * slope / w;
        let e = self.x - (self.input - lag);
        let f = self.dx - slope;
        let wt = w * dt_s;
        self.x = u - lag + decay * ((1.0 + wt) * e + dt_s * f);
        self.dx = slope + decay * ((1.0 - wt) * f - w * wt * e);
        self.input = u;
    }

    /// Smoothed signal.
    pub fn value(&self) -> f64 {
        self.x
    }

    /// Its derivative, per second.
    pub fn rate(&self) -> f64 {
        self.dx
    }
}
