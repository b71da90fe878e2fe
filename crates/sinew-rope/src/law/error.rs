//! Errors of the rope creep law.

/// Error of a step of the creep law. Cheap to copy; the state is unchanged whenever one is returned.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LoadError {
    /// Tension is NaN or infinite.
    #[error("the tension is NaN or infinite")]
    TensionNotFinite,
    /// Tension below zero.
    #[error("a tension of {tension_n} N: must be at least 0")]
    NegativeTension {
        /// Tension found, N.
        tension_n: f64,
    },
    /// Tension above the breaking load.
    #[error("a tension of {tension_n:.0} N exceeds the breaking load of {breaking_load_n:.0} N")]
    Broken {
        /// Tension found, N.
        tension_n: f64,
        /// Breaking load, N.
        breaking_load_n: f64,
    },
    /// Temperature outside −100 to 200 °C.
    #[error("a temperature of {temperature_k} K: must be 173.15 K to 473.15 K (−100 to 200 °C)")]
    Temperature {
        /// Temperature found, K.
        temperature_k: f64,
    },
    /// A duration that is negative, NaN or beyond 300 years.
    #[error("a duration of {duration_s} s: must be between 0 and 1e10 s (300 years)")]
    Duration {
        /// Duration found, s.
        duration_s: f64,
    },
    /// Invalid number of passes, pulley diameter or rope diameter.
    #[error("a bend over a pulley needs diameters above 0 and a number of passes of at least 0")]
    Bend,
    /// State with a NaN, or with bedding-in or damage below 0.
    #[error("invalid rope state: a value is NaN, or bedding-in or damage is below 0")]
    State,
}

/// Parameter outside its valid range.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{name} = {value}: must be {must}")]
pub struct ParameterError {
    /// Name with its unit, as in the catalogue.
    pub name: &'static str,
    /// Value of the parameter.
    pub value: f64,
    /// Valid range of the parameter.
    pub must: &'static str,
}
