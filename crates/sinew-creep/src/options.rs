//! Options of a fit.

use super::rope_base::RopeBase;

/// Parameters that curves have in common.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Share {
    /// All but the strain at time 0: one material, repeated tests.
    #[default]
    All,
    /// Shape only; every specimen has its own amplitudes.
    Shape,
}

/// Error model of the measurements.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum NoiseKind {
    /// Independent plus slow errors, with fitted share and correlation time.
    #[default]
    Correlated,
    /// Independent errors only.
    White,
}

/// Method of an interval.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum IntervalKind {
    /// Quantiles of posterior draws (flat prior within the searched ranges).
    #[default]
    Draws,
    /// Profile likelihood: all other parameters fitted again at every value, F-distributed.
    Profile,
    /// Parametric bootstrap: measurements simulated with the fitted noise, including the slow part,
    /// and fitted again; bias-corrected quantiles.
    Bootstrap,
}

/// Options of a fit.
#[derive(Debug, Clone, PartialEq)]
pub struct FitOptions {
    /// Parameters that specimens have in common.
    pub share: Share,
    /// Error model of the measurements.
    pub noise: NoiseKind,
    /// Confidence level of the intervals, such as 0.95.
    pub level: f64,
    /// Whether draws for intervals and forecasts are computed; the search alone is much faster.
    pub intervals: bool,
    /// Method of the parameters' intervals; forecasts are always based on draws.
    pub kind: IntervalKind,
    /// Seed of the draws; the same seed gives the same numbers.
    pub seed: u64,
    /// Base rope of [`Law::Rope`](super::Law::Rope).
    pub rope: Option<std::sync::Arc<RopeBase>>,
}

impl Default for FitOptions {
    fn default() -> Self {
        Self {
            share: Share::All,
            noise: NoiseKind::Correlated,
            level: 0.95,
            intervals: true,
            kind: IntervalKind::Draws,
            seed: 1,
            rope: None,
        }
    }
}
