//! State of a section of rope, and the components of its strain.

/// Retardation times of the delayed elasticity at `T_ref`, s: one per decade, from the settling time of a grip to one
/// day. Five equal steps make a straight line over log time.
pub const DELAY_TIMES_S: [f64; 5] = [1e1, 1e2, 1e3, 1e4, 1e5];

/// Internal state of one section of rope. All zero is a new rope that was never loaded.
///
/// Plain numbers that can be stored to continue later.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct State {
    /// Bedding-in `b`, %, at least 0; never falls.
    pub bedding_percent: f64,
    /// Delayed elasticity `v_i`, %, one per [`DELAY_TIMES_S`].
    pub delayed_percent: [f64; 5],
    /// Fibre flow `f`, %, at least 0; never falls.
    pub flow_percent: f64,
    /// Recoverable heat retraction `s`, %, positive if the rope is shorter.
    pub retraction_percent: f64,
    /// Permanent heat retraction, %; at least 0, never decreasing.
    pub retraction_kept_percent: f64,
    /// Sum of passes over pulleys, each over the number it would survive (Palmgren–Miner); the
    /// rope is spent at 1. Never falls.
    pub bending_damage: f64,
}

impl State {
    /// Permanent (irreversible) elongation after unloading at `T_ref`, %; permanent heat retraction is not
    /// subtracted.
    #[must_use]
    pub fn irreversible_percent(&self) -> f64 {
        self.bedding_percent + self.flow_percent
    }

    /// Whether every number is one that a rope can have.
    #[must_use]
    pub fn is_possible(&self) -> bool {
        let d = &self.delayed_percent;
        let parts = [
            self.bedding_percent,
            self.flow_percent,
            self.retraction_percent,
            self.retraction_kept_percent,
            self.bending_damage,
            d[0],
            d[1],
            d[2],
            d[3],
            d[4],
        ];
        // A NaN fails the comparison, an infinity the sum.
        parts.iter().all(|v| *v >= 0.0) && parts.iter().sum::<f64>() < f64::INFINITY
    }
}

/// Strain and its components, % of the unloaded, new rope.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Strain {
    /// At once under tension: `100 λ/k + e_t (1 − exp(−λ/λ_t))`.
    pub elastic_percent: f64,
    /// Bedding-in `b`, %.
    pub bedding_percent: f64,
    /// Delayed elasticity `Σ v_i`, %.
    pub delayed_percent: f64,
    /// Fibre flow `f`.
    pub flow_percent: f64,
    /// Heat retraction `s`, positive when the rope is shorter.
    pub retraction_percent: f64,
    /// Thermal expansion `100 α_θ (θ − T_ref)`.
    pub thermal_percent: f64,
}

impl Strain {
    /// Total strain `ε`, %.
    #[must_use]
    pub fn total_percent(&self) -> f64 {
        self.elastic_percent + self.bedding_percent + self.delayed_percent + self.flow_percent
            - self.retraction_percent
            + self.thermal_percent
    }

    /// Permanent strain after unloading: `b + f`, %.
    #[must_use]
    pub fn irreversible_percent(&self) -> f64 {
        self.bedding_percent + self.flow_percent
    }
}
