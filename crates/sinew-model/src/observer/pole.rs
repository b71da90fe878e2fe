//! First-order lag `ẏ = k (u − y)`, solved exactly over a step.

/// Weights of one step of a first-order lag whose input is linear between samples.
///
/// With `x = k Δt`, `a = exp(−x)`:
/// `y₁ = a y₀ + w₀ u₀ + w₁ u₁`, `w₀ = (1−a)/x − a`, `w₁ = 1 − (1−a)/x`, `w₀ + w₁ = 1 − a`.
///
/// All three weights lie between 0 and 1 for every `k > 0` and `Δt > 0`: stable at any gain and
/// step. For an input that is linear between samples the step is exact; otherwise the
/// error is that of the straight line, `O(Δt² ü)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExactPole {
    /// `exp(−k Δt)`: remaining share of the old output.
    pub a: f64,
    /// Weight of the input at the start of the step.
    pub w0: f64,
    /// Weight of the input at the end of the step.
    pub w1: f64,
}

impl ExactPole {
    /// Weights for a gain in 1/s and a step in s, both above 0.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    #[inline]
    pub fn new(gain_per_s: f64, dt_s: f64) -> Self {
        let x = gain_per_s * dt_s;
        let fall = libm::expm1(-x);
        let a = 1.0 + fall;
        // (1 − exp(−x))/x, without cancellation for small x; 1 in the limit.
        let mean = if x > 1e-12 { -fall / x } else { 1.0 };
        Self {
            a,
            w0: (mean - a).max(0.0),
            w1: (1.0 - mean).max(0.0),
        }
    }

    /// One step from output `y0` with the input going from `u0` to `u1`.
    #[inline]
    pub fn step(&self, y0: f64, u0: f64, u1: f64) -> f64 {
        self.a * y0 + self.w0 * u0 + self.w1 * u1
    }
}

/// First-order low-pass filter with its state, which delays `theta − q` by the same amount as the observed torque.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FirstOrder {
    input: f64,
    output: f64,
}

impl FirstOrder {
    /// Starts settled at `u`.
    pub fn settled_at(u: f64) -> Self {
        Self {
            input: u,
            output: u,
        }
    }

    /// Advances the filter by one step and returns the output.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    #[inline]
    pub fn step(&mut self, pole: &ExactPole, u: f64) -> f64 {
        self.output = pole.step(self.output, self.input, u);
        self.input = u;
        self.output
    }

    /// Latest output of the filter.
    pub fn output(&self) -> f64 {
        self.output
    }
}
