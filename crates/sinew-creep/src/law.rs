//! Creep laws of laboratories: strain after one load step, linear in all parameters but one or two.
//!
//! Every law gives functions of the time `t` since a step; the strain of a record is
//! `ε(t) = ε₀ + Σ_k [f(F_k) − f(F_{k−1})] (J₀ + Σ_j c_j φ_j((t − t_k) a_T))`
//! (Boltzmann's superposition; `f(F) = (F/F_ref)^p`, `a_T` the temperature's shift of time).

/// Reference time of amplitudes, s: one hour.
pub const REFERENCE_S: f64 = 3600.0;

/// Creep law of a fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Law {
    /// `b ln(1 + t/τ)`: every decade of time adds the same strain.
    LogTime,
    /// `m (t/1 h)^n`: Findley's power law.
    Findley,
    /// `ε̇ t + c (1 − exp(−t/τ))`: Maxwell and Kelvin elements in series; flow without end.
    Burgers,
    /// `Σ c_i (1 − exp(−t/τ_i))`, two elements: delayed elasticity that saturates.
    KelvinVoigt,
    /// `c (1 − exp(−(t/τ)^β))`: a continuous spectrum that saturates.
    Stretched,
    /// `s t`: a straight line, as the paper's `m_E`.
    Line,
    /// [`sinew_rope::law`]: bedding-in, delayed elasticity, flow and thermal strain of a rope,
    /// under the tensions and temperatures of the record. Needs a catalogue rope
    /// ([`super::RopeBase`]) for its breaking load and for parameters that are not identifiable
    /// from the record.
    Rope,
}

/// Nonlinear parameter, searched on a logarithmic or linear scale.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    /// Symbol of the parameter.
    pub name: &'static str,
    /// Unit of the parameter.
    pub unit: &'static str,
    /// Whether the search uses its logarithm.
    pub logarithmic: bool,
    /// Lower bound of the search.
    pub lower: f64,
    /// Upper bound of the search.
    pub upper: f64,
}

impl Shape {
    /// Creates a shape searched by its value.
    pub(super) fn linear(name: &'static str, unit: &'static str, lower: f64, upper: f64) -> Self {
        Self {
            name,
            unit,
            logarithmic: false,
            lower,
            upper,
        }
    }

    /// Creates a shape searched by its logarithm.
    pub(super) fn logarithmic(
        name: &'static str,
        unit: &'static str,
        lower: f64,
        upper: f64,
    ) -> Self {
        Self {
            logarithmic: true,
            ..Self::linear(name, unit, lower, upper)
        }
    }

    /// Value at a coordinate between 0 and 1.
    pub fn value(&self, unit: f64) -> f64 {
        let value = if self.logarithmic {
            (self.lower.ln() + unit * (self.upper / self.lower).ln()).exp()
        } else {
            self.lower + unit * (self.upper - self.lower)
        };
        value.clamp(self.lower, self.upper)
    }

    /// Coordinate of a value, within 0 and 1.
    pub fn coordinate(&self, value: f64) -> f64 {
        let unit = if self.logarithmic {
            (value / self.lower).ln() / (self.upper / self.lower).ln()
        } else {
            (value - self.lower) / (self.upper - self.lower)
        };
        unit.clamp(0.0, 1.0)
    }
}

/// Symbol, unit and sign of a linear coefficient.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Term {
    /// Symbol of the coefficient.
    pub name: &'static str,
    /// Unit of the coefficient.
    pub unit: &'static str,
    /// Factor from strain as a ratio to that unit.
    pub factor: f64,
    /// Whether it must not be negative: a rope under load does not shorten by creep.
    pub positive: bool,
    /// Whether the parameter is the reciprocal of the coefficient.
    pub inverse: bool,
}

impl Law {
    /// Laws that need only the record, in the order of the tables.
    pub const ALL: [Law; 5] = [
        Law::LogTime,
        Law::Findley,
        Law::Burgers,
        Law::KelvinVoigt,
        Law::Stretched,
    ];

    /// Name in options and tables.
    pub fn name(self) -> &'static str {
        match self {
            Law::LogTime => "log-time",
            Law::Findley => "findley",
            Law::Burgers => "burgers",
            Law::KelvinVoigt => "kelvin-voigt",
            Law::Stretched => "stretched",
            Law::Line => "line",
            Law::Rope => "rope",
        }
    }

    /// Equation of the law.
    pub fn equation(self) -> &'static str {
        match self {
            Law::LogTime => "ε₀ + b ln(1 + t/τ)",
            Law::Findley => "ε₀ + m (t/1 h)^n",
            Law::Burgers => "ε₀ + s t + c (1 − exp(−t/τ))",
            Law::KelvinVoigt => "ε₀ + c₁ (1 − exp(−t/τ₁)) + c₂ (1 − exp(−t/τ₂))",
            Law::Stretched => "ε₀ + c (1 − exp(−(t/τ)^β))",
            Law::Line => "ε₀ + s t",
            Law::Rope => "ε₀ + ε_el + b + Σ v_i + f − s",
        }
    }

    /// Shape parameters (those of [`Law::Rope`] depend on the records) with bounds that a record
    /// between `short_s` and `long_s` can determine.
    pub fn shapes(self, short_s: f64, long_s: f64) -> Vec<Shape> {
        let time = |name, lower, upper| Shape::logarithmic(name, "s", lower, upper);
        let number = |name, lower, upper| Shape::linear(name, "", lower, upper);
        match self {
            // Below a tenth of the first time τ only shifts ε₀, above the record it is a line.
            Law::LogTime => vec![time("tau", 0.1 * short_s, 10.0 * long_s)],
            Law::Findley => vec![number("n", 0.01, 1.0)],
            Law::Burgers => vec![time("tau", 0.3 * short_s, 3.0 * long_s)],
            Law::KelvinVoigt => vec![
                time("tau_1", 0.3 * short_s, long_s),
                // τ₂ as a multiple of τ₁, so that the two are distinguishable.
                Shape::logarithmic("tau_2/tau_1", "", 3.0, 1000.0),
            ],
            Law::Stretched => vec![
                time("tau", 0.3 * short_s, 1000.0 * long_s),
                number("beta", 0.05, 1.0),
            ],
            Law::Line | Law::Rope => Vec::new(),
        }
    }

    /// Coefficients of a step of the reference load.
    pub fn terms(self) -> Vec<Term> {
        let term = |(name, unit): &(&'static str, &'static str)| Term {
            name,
            unit,
            factor: 100.0,
            // Only a straight line may decrease.
            positive: self != Law::Line,
            inverse: false,
        };
        let named: &[_] = match self {
            Law::LogTime => &[("b", "%")],
            Law::Findley => &[("m", "%")],
            Law::Burgers => &[("s", "%/h"), ("c", "%")],
            Law::KelvinVoigt => &[("c_1", "%"), ("c_2", "%")],
            Law::Stretched => &[("c", "%")],
            Law::Line => &[("s", "%/h")],
            Law::Rope => &[],
        };
        named.iter().map(term).collect()
    }

    /// Functions `φ_j(t)` of the terms; zero before the step.
    pub fn respond(self, shape: &[f64], t: f64, out: &mut [f64]) {
        if t <= 0.0 {
            out.fill(0.0);
            return;
        }
        match self {
            Law::LogTime => out[0] = (t / shape[0]).ln_1p(),
            Law::Findley => out[0] = (t / REFERENCE_S).powf(shape[0]),
            Law::Burgers => {
                out[0] = t / REFERENCE_S;
                out[1] = -(-t / shape[0]).exp_m1();
            }
            Law::KelvinVoigt => {
                out[0] = -(-t / shape[0]).exp_m1();
                out[1] = -(-t / (shape[0] * shape[1])).exp_m1();
            }
            Law::Stretched => out[0] = -(-(t / shape[0]).powf(shape[1])).exp_m1(),
            Law::Line => out[0] = t / REFERENCE_S,
            Law::Rope => {}
        }
    }
}

/// Error of an unknown law name.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("unknown law '{name}'; available: {}, rope", Law::ALL.map(Law::name).join(", "))]
pub struct UnknownLaw {
    name: String,
}

impl std::str::FromStr for Law {
    type Err = UnknownLaw;

    fn from_str(text: &str) -> Result<Self, UnknownLaw> {
        Law::ALL
            .into_iter()
            .chain([Law::Rope])
            .find(|law| law.name() == text)
            .ok_or_else(|| UnknownLaw {
                name: text.to_owned(),
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinate_inverts_value_within_bounds() {
        for logarithmic in [false, true] {
            let shape = Shape {
                name: "tau",
                unit: "s",
                logarithmic,
                lower: 0.5,
                upper: 40.0,
            };
            for k in 0..=10 {
                let unit = 0.1 * f64::from(k);
                let back = shape.coordinate(shape.value(unit));
                assert!((back - unit).abs() < 1e-14, "{unit} {back}");
            }
            let bounds = [0.1, 0.5, 40.0, 1e3].map(|value| shape.coordinate(value));
            assert_eq!(bounds, [0.0, 0.0, 1.0, 1.0]);
        }
    }
}
