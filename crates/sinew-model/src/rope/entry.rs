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
//! material = "HMPE"                       # HMPE, aramid, LCP or other
//! plait = "12-plaited"                    # optional
//! [sources]                               # keys are our own
//! table1 = "Kirchhoff and von Stryk, IROS 2018, Table I"
//! hand = "tuned by hand to the text of the paper"
//! [published]                             # what is missing is left out, never invented
//! diameter_mm = { value = 1.50, origin = "published", source = "table1" }
//! [law]
//! toe_percent = { value = 0.20, factor = 1.5, origin = "starting-guess", source = "hand" }
//! jamming = { value = 2.9, plus_minus = 0.4, origin = "fitted", source = "bench", date = "2026-11-21" }
//! [correlation]                           # optional: of the errors of fitted values
//! parameters = ["bedding_percent", "jamming"]
//! matrix = [[1.0, -0.4], [-0.4, 1.0]]
//! ```
//!
//! `factor = f`: with 95 % probability between `value/f` and `value·f`. `plus_minus = d`: between
//! `value − d` and `value + d`. Neither: how well the value is known is not stated, and it is taken
//! as it stands.

use super::{Parameter, Parameters, Polymer};
use alloc::borrow::ToOwned;
use alloc::collections::BTreeMap;
use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;
use core::fmt::Write as _;
use serde::Deserialize;
use toml::Spanned;

/// Where a value comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
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
    /// Name as the catalogue writes it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Origin::Measured => "measured",
            Origin::Published => "published",
            Origin::Fitted => "fitted",
            Origin::StartingGuess => "starting-guess",
        }
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
    /// Key of [`Entry::sources`].
    pub source: String,
    /// Day of a fit, as written.
    pub date: Option<String>,
}

impl Value {
    /// Value at `z` standard deviations of the normal distribution that the interval belongs to,
    /// on a log scale for a factor.
    #[must_use]
    pub fn at(&self, z: f64) -> f64 {
        /// 97.5 % quantile of the normal distribution.
        const Z_95: f64 = 1.959_963_984_540_054;
        match self.uncertainty {
            Uncertainty::NotStated => self.value,
            Uncertainty::Factor(f) => self.value * libm::exp(libm::log(f) * z / Z_95),
            Uncertainty::PlusMinus(d) => self.value + d * z / Z_95,
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

/// A rope of the catalogue.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
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
    /// Parameters of the law that are known.
    pub law: BTreeMap<Parameter, Value>,
    /// Correlations of their errors, where a fit stated them.
    pub correlation: Option<Correlation>,
}

/// Why an entry was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EntryError {
    /// Not TOML, an unknown key, a missing one, or a value of the wrong type.
    #[error("{file}: {message}")]
    Toml {
        /// Name of the file.
        file: String,
        /// What the parser says, with line and column.
        message: String,
    },
    /// A value that can't be.
    #[error("{file}, line {line}: {key} = {value}: {why}")]
    Value {
        /// Name of the file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Full key.
        key: String,
        /// What was found.
        value: String,
        /// What it must be.
        why: String,
    },
}

impl Entry {
    /// Parses a catalogue entry; `file` is its name for messages.
    ///
    /// # Errors
    /// [`EntryError`] with file, line, key and value.
    pub fn parse(text: &str, file: &str) -> Result<Self, EntryError> {
        let raw: RawEntry = toml::from_str(text).map_err(|e| EntryError::Toml {
            file: file.to_string(),
            message: e.to_string().trim_end().to_string(),
        })?;
        Check {
            file,
            text,
            sources: &raw.sources,
        }
        .entry(&raw)
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
        ] {
            if let Some(value) = value {
                let _ = writeln!(out, "{key} = {}", inline(value));
            }
        }
        out.push_str("\n[law]\n");
        for (parameter, value) in &self.law {
            let _ = writeln!(out, "{} = {}", parameter.name(), inline(value));
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

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawEntry {
    name: Spanned<String>,
    manufacturer: String,
    product: String,
    fibre: String,
    material: Spanned<String>,
    plait: Option<String>,
    note: Option<String>,
    #[serde(default)]
    sources: BTreeMap<String, String>,
    #[serde(default)]
    published: RawPublished,
    #[serde(default)]
    law: BTreeMap<Spanned<String>, Spanned<RawValue>>,
    correlation: Option<Spanned<RawCorrelation>>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawPublished {
    diameter_mm: Option<Spanned<RawValue>>,
    breaking_load_n: Option<Spanned<RawValue>>,
    weight_g_per_m: Option<Spanned<RawValue>>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawValue {
    value: f64,
    factor: Option<f64>,
    plus_minus: Option<f64>,
    origin: Origin,
    source: String,
    date: Option<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawCorrelation {
    parameters: Vec<String>,
    matrix: Vec<Vec<f64>>,
}

/// Checks values and says where they stand.
struct Check<'a> {
    file: &'a str,
    text: &'a str,
    sources: &'a BTreeMap<String, String>,
}

impl Check<'_> {
    fn wrong<T>(
        &self,
        byte: usize,
        key: &str,
        value: impl ToString,
        why: impl Into<String>,
    ) -> Result<T, EntryError> {
        let before = self.text.bytes().take(byte);
        Err(EntryError::Value {
            file: self.file.to_string(),
            line: 1 + before.filter(|&b| b == b'\n').count(),
            key: key.to_string(),
            value: value.to_string(),
            why: why.into(),
        })
    }

    fn entry(&self, raw: &RawEntry) -> Result<Entry, EntryError> {
        let name = raw.name.as_ref();
        let good = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
        if name.is_empty() || !name.chars().all(good) {
            let at = raw.name.span().start;
            return self.wrong(at, "name", name, "must be lower case letters, digits and -");
        }
        let material = match raw.material.as_ref().to_lowercase().as_str() {
            "hmpe" => Polymer::Hmpe,
            "aramid" => Polymer::Aramid,
            "lcp" => Polymer::Lcp,
            "other" => Polymer::Other,
            found => {
                let at = raw.material.span().start;
                return self.wrong(at, "material", found, "must be HMPE, aramid, LCP or other");
            }
        };
        let published = |key: &str, value: &Option<Spanned<RawValue>>| {
            let read = |v| self.value(&format!("published.{key}"), v, f64::MIN_POSITIVE, 1e12);
            value.as_ref().map(read).transpose()
        };
        let mut law = BTreeMap::new();
        for (key, value) in &raw.law {
            let Some(parameter) = parameter(key.as_ref()) else {
                let known: Vec<&str> = Parameter::ALL.iter().map(|p| p.name()).collect();
                return self.wrong(
                    key.span().start,
                    &format!("law.{}", key.as_ref()),
                    value.as_ref().value,
                    format!("the law has no such parameter; it has {}", known.join(", ")),
                );
            };
            let (low, high) = parameter.range();
            let value = self.value(&format!("law.{}", parameter.name()), value, low, high)?;
            law.insert(parameter, value);
        }
        let correlation = match &raw.correlation {
            None => None,
            Some(raw) => Some(self.correlation(raw, &law)?),
        };
        Ok(Entry {
            name: name.clone(),
            manufacturer: raw.manufacturer.clone(),
            product: raw.product.clone(),
            fibre: raw.fibre.clone(),
            material,
            plait: raw.plait.clone(),
            note: raw.note.clone(),
            sources: raw.sources.clone(),
            diameter_mm: published("diameter_mm", &raw.published.diameter_mm)?,
            breaking_load_n: published("breaking_load_n", &raw.published.breaking_load_n)?,
            weight_g_per_m: published("weight_g_per_m", &raw.published.weight_g_per_m)?,
            law,
            correlation,
        })
    }

    fn value(
        &self,
        key: &str,
        raw: &Spanned<RawValue>,
        low: f64,
        high: f64,
    ) -> Result<Value, EntryError> {
        let at = raw.span().start;
        let raw = raw.as_ref();
        if !(low..=high).contains(&raw.value) {
            let why = if low == f64::MIN_POSITIVE {
                "must be above 0".to_owned()
            } else {
                format!("must be {low} to {high}")
            };
            return self.wrong(at, key, raw.value, why);
        }
        let uncertainty = match (raw.factor, raw.plus_minus) {
            (None, None) => Uncertainty::NotStated,
            (Some(f), None) if f > 1.0 && f < 1e6 => Uncertainty::Factor(f),
            (None, Some(d)) if d > 0.0 && d < 1e12 => Uncertainty::PlusMinus(d),
            (Some(f), None) => {
                return self.wrong(at, &format!("{key}.factor"), f, "must be above 1");
            }
            (None, Some(d)) => {
                return self.wrong(at, &format!("{key}.plus_minus"), d, "must be above 0");
            }
            (Some(f), Some(_)) => {
                let why = "give factor or plus_minus, not both";
                return self.wrong(at, &format!("{key}.factor"), f, why);
            }
        };
        if !self.sources.contains_key(&raw.source) {
            let why = "is not a key of [sources]; add it there";
            return self.wrong(at, &format!("{key}.source"), &raw.source, why);
        }
        if raw.origin == Origin::Fitted && raw.date.is_none() {
            let why = "a fitted value needs the date of its fit";
            return self.wrong(at, &format!("{key}.date"), "(missing)", why);
        }
        Ok(Value {
            value: raw.value,
            uncertainty,
            origin: raw.origin,
            source: raw.source.clone(),
            date: raw.date.clone(),
        })
    }

    fn correlation(
        &self,
        raw: &Spanned<RawCorrelation>,
        law: &BTreeMap<Parameter, Value>,
    ) -> Result<Correlation, EntryError> {
        let at = raw.span().start;
        let raw = raw.as_ref();
        let mut parameters = Vec::new();
        for name in &raw.parameters {
            let known = parameter(name).filter(|p| law.contains_key(p));
            let Some(p) = known.filter(|p| !parameters.contains(p)) else {
                let why = "must name parameters of [law], each once";
                return self.wrong(at, "correlation.parameters", name, why);
            };
            parameters.push(p);
        }
        let n = parameters.len();
        let m = &raw.matrix;
        let square = m.len() == n && m.iter().all(|row| row.len() == n);
        let symmetric = square
            && (0..n).all(|i| {
                (m[i][i] - 1.0).abs() < 1e-9 && (0..i).all(|j| (m[i][j] - m[j][i]).abs() < 1e-9)
            });
        if !symmetric {
            let why = format!("must be {n} by {n}, symmetric, with ones on the diagonal");
            return self.wrong(at, "correlation.matrix", format!("{m:?}"), why);
        }
        let Some(cholesky) = cholesky(m) else {
            let why = "no errors can be correlated so: it is not positive definite";
            return self.wrong(at, "correlation.matrix", format!("{m:?}"), why);
        };
        Ok(Correlation {
            parameters,
            matrix: m.clone(),
            cholesky,
        })
    }
}

fn parameter(name: &str) -> Option<Parameter> {
    Parameter::ALL.iter().copied().find(|p| p.name() == name)
}

fn cholesky(m: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
    let n = m.len();
    let mut l = alloc::vec![alloc::vec![0.0; n]; n];
    for i in 0..n {
        for j in 0..=i {
            let sum: f64 = (0..j).map(|k| l[i][k] * l[j][k]).sum();
            let rest = m[i][j] - sum;
            if i == j {
                // A matrix rounded to some digits may miss 0 by as much.
                if rest.is_nan() || rest <= -1e-6 {
                    return None;
                }
                l[i][i] = libm::sqrt(rest.max(1e-12));
            } else {
                l[i][j] = rest / l[j][j];
            }
        }
    }
    Some(l)
}
