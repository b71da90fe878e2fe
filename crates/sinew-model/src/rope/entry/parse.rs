//! From catalogue text to an entry, with the place of what is wrong.

use super::{Correlation, Entry, EntryError, Origin, Uncertainty, Value};
use crate::rope::{Parameter, Polymer};
use alloc::borrow::ToOwned;
use alloc::collections::BTreeMap;
use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;
use serde::Deserialize;
use toml::Spanned;

pub(super) fn entry(text: &str, file: &str) -> Result<Entry, EntryError> {
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
        let Some(correlation) = Correlation::new(parameters, m.clone()) else {
            let why = "no errors can be correlated so: it is not positive definite";
            return self.wrong(at, "correlation.matrix", format!("{m:?}"), why);
        };
        Ok(correlation)
    }
}

fn parameter(name: &str) -> Option<Parameter> {
    Parameter::ALL.iter().copied().find(|p| p.name() == name)
}
