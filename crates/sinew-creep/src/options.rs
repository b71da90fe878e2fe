//! How to fit.

use super::rope_base::RopeBase;

/// Which parameters curves have in common.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Share {
    /// All but the strain at time 0: one material, repeated tests.
    #[default]
    All,
    /// The shape only; every specimen has its own amplitudes.
    Shape,
}

/// What is assumed of the readings' errors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum NoiseKind {
    /// Independent plus slow errors, their share and memory fitted.
    #[default]
    Correlated,
    /// Independent.
    White,
}

/// How an interval is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum IntervalKind {
    /// Quantiles of draws from what the readings leave open (flat within the searched ranges).
    #[default]
    Draws,
    /// Profile likelihood: all else fitted anew at every value, F-distributed.
    Profile,
    /// Parametric bootstrap: readings made anew with the fitted noise, slow part included,
    /// and fitted again; bias-corrected quantiles.
    Bootstrap,
}

/// How to fit.
#[derive(Debug, Clone, PartialEq)]
pub struct FitOptions {
    /// What specimens have in common.
    pub share: Share,
    /// What is assumed of the readings' errors.
    pub noise: NoiseKind,
    /// Level of the intervals, such as 0.95.
    pub level: f64,
    /// Whether draws for intervals and forecasts are made; the search alone is much faster.
    pub intervals: bool,
    /// How the intervals of the parameters are made; forecasts always rest on draws.
    pub kind: IntervalKind,
    /// Seed of the draws; the same seed gives the same numbers.
    pub seed: u64,
    /// The rope that [`Law::Rope`](super::Law::Rope) starts from.
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
