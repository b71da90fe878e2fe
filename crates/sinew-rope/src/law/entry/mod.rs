//! Catalogue entry of a rope: published values and parameters of the creep law, each with its origin and
//! uncertainty.
//!
//! No file is opened here: the caller reads the text and passes it in.
//!
//! ```toml
//! name = "liros-dc000-0301"
//! manufacturer = "Liros"
//! product = "DC000-0301"
//! fibre = "Dyneema SK99"
//! material = "HMPE"                       # HMPE, aramid, LCP, steel, tungsten or other
//! plait = "12-plaited"                    # optional
//! [sources]                               # keys are our own
//! table1 = "Kirchhoff and von Stryk, IROS 2018, Table I"
//! hand = "tuned by hand to the text of the paper"
//! [published]                             # what is missing is left out, never invented
//! diameter_mm = { value = 1.50, origin = "published", source = "table1" }
//! discard_strain_percent = { value = 1.5, origin = "published", source = "sheet" } # when to replace it
//! [law]
//! toe_percent = { value = 0.20, factor = 1.5, origin = "assumed", source = "hand" }
//! jamming = { value = 2.9, plus_minus = 0.4, origin = "fitted", source = "bench", date = "2026-11-21" }
//! [correlation]                           # optional: of the errors of fitted values
//! parameters = ["bedding_percent", "jamming"]
//! matrix = [[1.0, -0.4], [-0.4, 1.0]]
//! [tested_range]                          # optional: the data behind the values
//! load_share = [0.01, 0.05]               # tension over breaking load
//! temperature_c = [23.0, 60.0]
//! duration_s = 5100.0                     # of the longest test
//! [endurance]                             # optional: what breaks it; else its fibre's values
//! knot_share = { value = 0.5, factor = 1.2, origin = "measured", source = "bench" }
//! ```
//!
//! `factor = f`: with 95 % probability between `value/f` and `value·f`. `plus_minus = d`: between `value − d`
//! and `value + d`. With neither, the uncertainty is not specified, and the value is used as it is.

mod parse;

use super::endurance::EnduranceKey;
use super::tested_range::TestedRange;
use super::{Parameter, Parameters, Polymer};
use core::fmt::Write as _;
use sinew_files::Located;
use sinew_model::QUANTILE_975;
use sinew_model::cholesky;
use std::collections::BTreeMap;

/// Origin of a catalogue value.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize,
)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Origin {
    /// Measured, with a source.
    Measured,
    /// Stated in a publication or data sheet, not checked.
    Published,
    /// Fitted to data by the user, with the data and the date.
    Fitted,
    /// Assumed without measurement; `starting-guess` in older files.
    #[serde(alias = "starting-guess")]
    Assumed,
}

impl Origin {
    /// Names in catalogue files.
    const NAMES: [(&'static str, Origin); 4] = [
        ("measured", Origin::Measured),
        ("published", Origin::Published),
        ("fitted", Origin::Fitted),
        ("assumed", Origin::Assumed),
    ];

    /// Name of [`Origin::Assumed`] in older catalogue files.
    const OLDER_ASSUMED: &str = "starting-guess";

    /// Name in catalogue files.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize].0
    }
}

/// Uncertainty of a value, as a 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Uncertainty {
    /// Uncertainty not specified.
    NotSpecified,
    /// Interval from value/f to value·f, with f above 1.
    Factor(f64),
    /// Interval from value − d to value + d, with d above 0.
    PlusMinus(f64),
}

/// Catalogue value with uncertainty, origin and source.
#[derive(Debug, Clone, PartialEq)]
pub struct Value {
    /// Value in the unit of its name.
    pub value: f64,
    /// Uncertainty as a 95 % interval.
    pub uncertainty: Uncertainty,
    /// Origin of the value.
    pub origin: Origin,
    /// Key of [`CatalogueEntry::sources`].
    pub source: String,
    /// Date of the fit, as written.
    pub date: Option<String>,
}

impl Value {
    /// Value at `z` standard deviations of the normal distribution that the interval belongs to,
    /// on a log scale for a factor.
    #[must_use]
    pub fn at(&self, z: f64) -> f64 {
        match self.uncertainty {
            Uncertainty::NotSpecified => self.value,
            Uncertainty::Factor(f) => self.value * libm::exp(libm::log(f) * z / QUANTILE_975),
            Uncertainty::PlusMinus(d) => self.value + d * z / QUANTILE_975,
        }
    }
}

/// Correlation of the errors of some parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Correlation {
    /// Correlated parameters, in the order of the matrix.
    pub parameters: Vec<Parameter>,
    /// Correlation matrix: symmetric, with ones on the diagonal.
    pub matrix: Vec<Vec<f64>>,
    /// Lower triangle of its Cholesky factor.
    pub cholesky: Vec<Vec<f64>>,
}

impl Correlation {
    /// Correlations of the errors of `parameters`, in their order.
    ///
    /// `None` where the matrix is not square of their number or no errors can be correlated so
    /// (not positive definite).
    #[must_use]
    pub fn new(parameters: Vec<Parameter>, matrix: Vec<Vec<f64>>) -> Option<Self> {
        let n = parameters.len();
        if matrix.len() != n || matrix.iter().any(|row| row.len() != n) {
            return None;
        }
        let flat: Vec<f64> = matrix.iter().flatten().copied().collect();
        let mut factor = vec![0.0; n * n];
        // A matrix rounded to some digits may miss 0 by as much.
        let pivot = |left: f64| (left > -1e-6).then(|| libm::sqrt(left.max(1e-12)));
        cholesky::factorise_singular(&flat, &mut factor, n, pivot).ok()?;
        let cholesky = factor.chunks(n.max(1)).map(<[f64]>::to_vec).collect();
        Some(Self {
            parameters,
            matrix,
            cholesky,
        })
    }
}

/// A rope of the catalogue.
#[derive(Debug, Clone, PartialEq)]
pub struct CatalogueEntry {
    /// Name to call it by: lower case, digits and hyphens.
    pub name: String,
    /// Manufacturer of the rope.
    pub manufacturer: String,
    /// Product name of the manufacturer.
    pub product: String,
    /// Name of the load-bearing fibre.
    pub fibre: String,
    /// Material of the fibre.
    pub material: Polymer,
    /// Construction of the braid, if known.
    pub plait: Option<String>,
    /// Remarks on the rope.
    pub note: Option<String>,
    /// Sources by their keys.
    pub sources: BTreeMap<String, String>,
    /// Published diameter, mm.
    pub diameter_mm: Option<Value>,
    /// Published breaking load, N.
    pub breaking_load_n: Option<Value>,
    /// Published weight per length, g/m.
    pub weight_g_per_m: Option<Value>,
    /// Manufacturer's discard strain: strain in use, since new, at which the rope is to be replaced, %.
    pub discard_strain_percent: Option<Value>,
    /// Parameters of the law that are known.
    pub law: BTreeMap<Parameter, Value>,
    /// Correlations of the errors of fitted values.
    pub correlation: Option<Correlation>,
    /// Tested range of the rope, if specified.
    pub tested_range: Option<TestedRange>,
    /// Endurance values specified for this rope; the others are those of its fibre class ([`FibreClass`]).
    pub endurance: BTreeMap<EnduranceKey, Value>,
}

/// Endurance values of a class of fibres.
#[derive(Debug, Clone, PartialEq)]
pub struct FibreClass {
    /// Sources by their keys.
    pub sources: BTreeMap<String, String>,
    /// Values by their names.
    pub endurance: BTreeMap<EnduranceKey, Value>,
}

impl FibreClass {
    /// Parses `[sources]` and `[endurance]`; `file` is its name for messages.
    ///
    /// # Errors
    /// Returns [`Located`] with file, line, key and value.
    pub fn parse(text: &str, file: &str) -> Result<Self, Located> {
        parse::fibre(text, file)
    }
}

impl CatalogueEntry {
    /// Parses a catalogue entry; `file` is its name for messages.
    ///
    /// # Errors
    /// Returns [`Located`] with file, line, key and value.
    pub fn parse(text: &str, file: &str) -> Result<Self, Located> {
        parse::entry(text, file)
    }

    /// Nominal parameters of the creep law.
    ///
    /// # Errors
    /// Names of the parameters that are missing.
    pub fn parameters(&self) -> Result<Parameters, Vec<&'static str>> {
        self.parameters_at(|_| 0.0)
    }

    /// The law's parameters at `z(parameter)` standard deviations from their values, kept within
    /// the range each parameter may take. An entry without `pass_pressure_exponent` has 0.5 ± 0.5 (95 %), assumed.
    ///
    /// # Errors
    /// Names of the parameters that are missing.
    pub fn parameters_at(
        &self,
        z: impl Fn(Parameter) -> f64,
    ) -> Result<Parameters, Vec<&'static str>> {
        let mut out = Parameters::zero(self.material);
        let mut missing = Vec::new();
        for &parameter in Parameter::ALL {
            let at = |v: &Value| v.at(z(parameter));
            let stated = self.law.get(&parameter).map(at);
            let Some(value) = stated.or_else(|| default(parameter).as_ref().map(at)) else {
                missing.push(parameter.name());
                continue;
            };
            let (low, high) = parameter.range();
            out.set(parameter, value.clamp(low, high));
        }
        if missing.is_empty() {
            Ok(out)
        } else {
            Err(missing)
        }
    }

    /// Values of the creep law, including those of parameters that have a default and are not stated
    /// ([`DEFAULT_SOURCE`]); none for an entry without a law.
    #[must_use]
    pub fn law_with_defaults(&self) -> BTreeMap<Parameter, Value> {
        let mut out = self.law.clone();
        if !out.is_empty() {
            for &parameter in Parameter::ALL {
                if let (false, Some(value)) = (out.contains_key(&parameter), default(parameter)) {
                    out.insert(parameter, value);
                }
            }
        }
        out
    }

    /// Manufacturer's discard strain since new, m/m.
    #[must_use]
    pub fn discard_strain(&self) -> Option<f64> {
        let percent = self.discard_strain_percent.as_ref()?;
        Some(0.01 * percent.value)
    }

    /// Number of creep law parameters that are assumed.
    #[must_use]
    pub fn assumed(&self) -> usize {
        let is_assumed = |v: &&Value| v.origin == Origin::Assumed;
        self.law.values().filter(is_assumed).count()
    }

    /// Catalogue text of the entry; parsing it gives the same entry.
    #[must_use]
    pub fn to_toml(&self) -> String {
        let mut out = String::new();
        let mut line = |key: &str, value: &str| {
            let _ = writeln!(out, "{key} = {}", quoted(value));
        };
        line("name", &self.name);
        line("manufacturer", &self.manufacturer);
        line("product", &self.product);
        line("fibre", &self.fibre);
        line("material", self.material.name());
        if let Some(plait) = &self.plait {
            line("plait", plait);
        }
        if let Some(note) = &self.note {
            line("note", note);
        }
        out.push_str("\n[sources]\n");
        for (key, source) in &self.sources {
            let _ = writeln!(out, "{} = {}", quoted(key), quoted(source));
        }
        out.push_str("\n[published]\n");
        for (key, value) in [
            ("diameter_mm", &self.diameter_mm),
            ("breaking_load_n", &self.breaking_load_n),
            ("weight_g_per_m", &self.weight_g_per_m),
            ("discard_strain_percent", &self.discard_strain_percent),
        ] {
            if let Some(value) = value {
                let _ = writeln!(out, "{key} = {}", inline(value));
            }
        }
        if let Some(tested_range) = &self.tested_range {
            let [low, high] = tested_range.load_share;
            let [cold, hot] = tested_range.temperature_c;
            let _ = writeln!(
                out,
                "\n[tested_range]\nload_share = [{low:?}, {high:?}]\ntemperature_c = [{cold:?}, {hot:?}]\nduration_s = {:?}",
                tested_range.duration_s
            );
        }
        out.push_str("\n[law]\n");
        for (parameter, value) in &self.law {
            let _ = writeln!(out, "{} = {}", parameter.name(), inline(value));
        }
        if !self.endurance.is_empty() {
            out.push_str("\n[endurance]\n");
        }
        for (key, value) in &self.endurance {
            let _ = writeln!(out, "{} = {}", key.name(), inline(value));
        }
        if let Some(correlation) = &self.correlation {
            let names: Vec<String> = correlation
                .parameters
                .iter()
                .map(|p| quoted(p.name()))
                .collect();
            let rows: Vec<String> = correlation
                .matrix
                .iter()
                .map(|row| {
                    let cells: Vec<String> = row.iter().map(|v| format!("{v:?}")).collect();
                    format!("[{}]", cells.join(", "))
                })
                .collect();
            let _ = write!(
                out,
                "\n[correlation]\nparameters = [{}]\nmatrix = [{}]\n",
                names.join(", "),
                rows.join(", ")
            );
        }
        out
    }
}

/// Key and text of the source of default values.
pub const DEFAULT_SOURCE: [&str; 2] = [
    "default",
    "assumed: no elongation of a fibre rope against D/d is published",
];

/// Value of a parameter that has a default.
fn default(parameter: Parameter) -> Option<Value> {
    (parameter == Parameter::PassPressureExponent).then(|| Value {
        value: 0.5,
        uncertainty: Uncertainty::PlusMinus(0.5),
        origin: Origin::Assumed,
        source: DEFAULT_SOURCE[0].into(),
        date: None,
    })
}

/// A TOML basic string.
fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            c if c.is_control() => {
                let _ = write!(out, "\\u{:04X}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

fn inline(value: &Value) -> String {
    let mut out = format!("{{ value = {:?}", value.value);
    let _ = match value.uncertainty {
        Uncertainty::NotSpecified => Ok(()),
        Uncertainty::Factor(f) => write!(out, ", factor = {f:?}"),
        Uncertainty::PlusMinus(d) => write!(out, ", plus_minus = {d:?}"),
    };
    let _ = write!(
        out,
        ", origin = \"{}\", source = {}",
        value.origin.name(),
        quoted(&value.source)
    );
    if let Some(date) = &value.date {
        let _ = write!(out, ", date = {}", quoted(date));
    }
    out + " }"
}
