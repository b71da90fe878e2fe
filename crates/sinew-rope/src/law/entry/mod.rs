//! A rope of the catalogue: what is published about it and the parameters of its law, each value
//! with where it comes from and how well it is known.
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
//! toe_percent = { value = 0.20, factor = 1.5, origin = "starting-guess", source = "hand" }
//! jamming = { value = 2.9, plus_minus = 0.4, origin = "fitted", source = "bench", date = "2026-11-21" }
//! [correlation]                           # optional: of the errors of fitted values
//! parameters = ["bedding_percent", "jamming"]
//! matrix = [[1.0, -0.4], [-0.4, 1.0]]
//! [holds]                                 # optional: the data behind the values
//! load_share = [0.01, 0.05]               # tension over breaking load
//! temperature_c = [23.0, 60.0]
//! duration_s = 5100.0                     # of the longest test
//! [endurance]                             # optional: what breaks it; else its fibre's values
//! knot_share = { value = 0.5, factor = 1.2, origin = "measured", source = "bench" }
//! ```
//!
//! `factor = f`: with 95 % probability between `value/f` and `value·f`. `plus_minus = d`: between
//! `value − d` and `value + d`. Neither: how well the value is known is not stated, and it is taken
//! as it stands.

mod parse;

use super::endurance::EnduranceKey;
use super::holds::Holds;
use super::{Parameter, Parameters, Polymer};
use core::fmt::Write as _;
use sinew_files::Located;
use sinew_model::QUANTILE_975;
use sinew_model::cholesky;
use std::collections::BTreeMap;

/// Where a value comes from.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize,
)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Origin {
    /// Measured by somebody, with a source.
    Measured,
    /// Stated in a publication or data sheet, not checked.
    Published,
    /// Fitted to data by the user, with the data and the date.
    Fitted,
    /// A starting guess: somebody's judgement.
    StartingGuess,
}

impl Origin {
    /// Names as the catalogue writes them.
    const NAMES: [(&'static str, Origin); 4] = [
        ("measured", Origin::Measured),
        ("published", Origin::Published),
        ("fitted", Origin::Fitted),
        ("starting-guess", Origin::StartingGuess),
    ];

    /// Name as the catalogue writes it.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize].0
    }
}

/// How well a value is known, as a 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Uncertainty {
    /// Nobody says.
    NotStated,
    /// Between value/f and value·f; f above 1.
    Factor(f64),
    /// Between value − d and value + d; d above 0.
    PlusMinus(f64),
}

/// A value with its origin.
#[derive(Debug, Clone, PartialEq)]
pub struct Value {
    /// In the unit of its name.
    pub value: f64,
    /// 95 % interval.
    pub uncertainty: Uncertainty,
    /// Where it comes from.
    pub origin: Origin,
    /// Key of [`CatalogueEntry::sources`].
    pub source: String,
    /// Day of a fit, as written.
    pub date: Option<String>,
}

impl Value {
    /// Value at `z` standard deviations of the normal distribution that the interval belongs to,
    /// on a log scale for a factor.
    #[must_use]
    pub fn at(&self, z: f64) -> f64 {
        match self.uncertainty {
            Uncertainty::NotStated => self.value,
            Uncertainty::Factor(f) => self.value * libm::exp(libm::log(f) * z / QUANTILE_975),
            Uncertainty::PlusMinus(d) => self.value + d * z / QUANTILE_975,
        }
    }
}

/// Correlation of the errors of some parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Correlation {
    /// Which parameters, in the order of the matrix.
    pub parameters: Vec<Parameter>,
    /// Symmetric, ones on the diagonal.
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
    /// Who makes it.
    pub manufacturer: String,
    /// What they call it.
    pub product: String,
    /// The load-bearing fibre.
    pub fibre: String,
    /// What the fibre is made of.
    pub material: Polymer,
    /// How it is plaited, where it is known.
    pub plait: Option<String>,
    /// Remarks.
    pub note: Option<String>,
    /// Sources by their keys.
    pub sources: BTreeMap<String, String>,
    /// Diameter, mm, where it is published.
    pub diameter_mm: Option<Value>,
    /// Breaking load, N, where it is published.
    pub breaking_load_n: Option<Value>,
    /// Weight, g/m, where it is published.
    pub weight_g_per_m: Option<Value>,
    /// Strain in use, since it was new, at which its maker says to replace it, %.
    pub discard_strain_percent: Option<Value>,
    /// Parameters of the law that are known.
    pub law: BTreeMap<Parameter, Value>,
    /// Correlations of their errors, where a fit stated them.
    pub correlation: Option<Correlation>,
    /// Data behind the values, where it is stated.
    pub holds: Option<Holds>,
    /// What the rope endures, where it is stated; the rest is its fibre's ([`FibreClass`]).
    pub endurance: BTreeMap<EnduranceKey, Value>,
}

/// What ropes of a class of fibres endure.
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
    /// With file, line, key and value.
    pub fn parse(text: &str, file: &str) -> Result<Self, Located> {
        parse::fibre(text, file)
    }
}

impl CatalogueEntry {
    /// Parses a catalogue entry; `file` is its name for messages.
    ///
    /// # Errors
    /// With file, line, key and value.
    pub fn parse(text: &str, file: &str) -> Result<Self, Located> {
        parse::entry(text, file)
    }

    /// The law's parameters as they stand.
    ///
    /// # Errors
    /// Names of the parameters that are missing.
    pub fn parameters(&self) -> Result<Parameters, Vec<&'static str>> {
        self.parameters_at(|_| 0.0)
    }

    /// The law's parameters at `z(parameter)` standard deviations from their values, kept within
    /// the range each parameter may take.
    ///
    /// # Errors
    /// Names of the parameters that are missing.
    pub fn parameters_at(
        &self,
        z: impl Fn(Parameter) -> f64,
    ) -> Result<Parameters, Vec<&'static str>> {
        let missing: Vec<&'static str> = Parameter::ALL
            .iter()
            .filter(|p| !self.law.contains_key(p))
            .map(|p| p.name())
            .collect();
        if !missing.is_empty() {
            return Err(missing);
        }
        let mut out = Parameters::zero(self.material);
        for (&parameter, value) in &self.law {
            let (low, high) = parameter.range();
            out.set(parameter, value.at(z(parameter)).clamp(low, high));
        }
        Ok(out)
    }

    /// Strain since it was new at which its maker says to replace it, as a fraction.
    #[must_use]
    pub fn discard_strain(&self) -> Option<f64> {
        let percent = self.discard_strain_percent.as_ref()?;
        Some(0.01 * percent.value)
    }

    /// Share of the law's parameters that are starting guesses: what an interval rests on.
    #[must_use]
    pub fn guesses(&self) -> usize {
        let guess = |v: &&Value| v.origin == Origin::StartingGuess;
        self.law.values().filter(guess).count()
    }

    /// The entry as catalogue text; parsing it gives the same entry.
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
        if let Some(holds) = &self.holds {
            let [low, high] = holds.load_share;
            let [cold, hot] = holds.temperature_c;
            let _ = writeln!(
                out,
                "\n[holds]\nload_share = [{low:?}, {high:?}]\ntemperature_c = [{cold:?}, {hot:?}]\nduration_s = {:?}",
                holds.duration_s
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
        Uncertainty::NotStated => Ok(()),
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
