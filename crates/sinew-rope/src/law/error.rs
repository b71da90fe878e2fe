//! What the rope law refuses.

/// Why a step was refused. Cheap to copy; the state is unchanged whenever one is returned.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LoadError {
    /// Tension is NaN or infinite.
    #[error("the tension is not a number")]
    TensionNotFinite,
    /// A rope can't push.
    #[error("a tension of {tension_n} N: a rope carries none below 0")]
    NegativeTension {
        /// Tension found, N.
        tension_n: f64,
    },
    /// Above its breaking load the rope is gone.
    #[error("a tension of {tension_n:.0} N breaks a rope of {breaking_load_n:.0} N breaking load")]
    Broken {
        /// Tension found, N.
        tension_n: f64,
        /// Breaking load, N.
        breaking_load_n: f64,
    },
    /// Temperature outside what any of these fibres is a fibre at.
    #[error(
        "a temperature of {temperature_k} K: the law takes 173.15 K to 473.15 K (−100 to 200 °C)"
    )]
    Temperature {
        /// Temperature found, K.
        temperature_k: f64,
    },
    /// A duration that is negative, NaN or beyond 300 years.
    #[error("a duration of {duration_s} s: it must lie between 0 and 1e10 s (300 years)")]
    Duration {
        /// Duration found, s.
        duration_s: f64,
    },
    /// Number of passes, pulley or rope size that can't be.
    #[error("a bend over a pulley needs diameters above 0 and a number of passes of at least 0")]
    Bend,
    /// The state holds a NaN, or a bedding-in or damage below 0.
    #[error("the rope state is not one the law can have reached")]
    State,
}

/// Why parameters make no rope.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{name} = {value}: must be {must}")]
pub struct ParameterError {
    /// Name with its unit, as in the catalogue.
    pub name: &'static str,
    /// Value found.
    pub value: f64,
    /// What it must be.
    pub must: &'static str,
}
