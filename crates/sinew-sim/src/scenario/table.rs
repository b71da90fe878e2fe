//! A TOML table read key by key, so that every refusal names file, line, key, value and unit.

use super::super::SimulateError;
use super::draw::{Draw, PerJoint};
use std::cell::RefCell;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// What a number may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bound {
    /// Any finite number.
    Any,
    /// Above 0.
    Positive,
    /// At least 0.
    NotNegative,
    /// Between two ends, which count as inside.
    Within(f64, f64),
}

impl Bound {
    /// Whether the bound allows a value.
    pub fn allows(self, v: f64) -> bool {
        self.refuses(v).is_none()
    }

    fn refuses(self, v: f64) -> Option<String> {
        let good = match self {
            Self::Any => true,
            Self::Positive => v > 0.0,
            Self::NotNegative => v >= 0.0,
            Self::Within(lo, hi) => (lo..=hi).contains(&v),
        };
        if v.is_finite() && good {
            return None;
        }
        Some(match self {
            Self::Any => "a finite number".into(),
            Self::Positive => "a finite number above 0".into(),
            Self::NotNegative => "a finite number of at least 0".into(),
            Self::Within(lo, hi) => format!("between {lo} and {hi}"),
        })
    }
}

/// The unit a key's name ends in, for messages.
fn unit_of(key: &str) -> &'static str {
    const UNITS: [(&str, &str); 16] = [
        ("_nm_per_rad", "N·m/rad"),
        ("_nm_s_per_rad", "N·m·s/rad"),
        ("_per_rad2", "1/rad²"),
        ("_rad_per_k", "rad/K"),
        ("_rad_per_s", "rad/s"),
        ("_per_rad", "1/rad"),
        ("_per_k", "1/K"),
        ("_rad", "rad"),
        ("_kg", "kg"),
        ("_nm", "N·m"),
        ("_hz", "Hz"),
        ("_ns", "ns"),
        ("_n", "N"),
        ("_m", "m"),
        ("_s", "s"),
        ("_c", "°C"),
    ];
    // `pose_rad.elbow` has its unit before the joint's name, `offsets[0].rad` no word before it.
    key.rsplit('.')
        .find_map(|part| {
            UNITS
                .iter()
                .find(|(suffix, _)| part.ends_with(suffix) || part == &suffix[1..])
        })
        .map_or("", |(_, unit)| unit)
}

/// The file the sections belong to.
pub(crate) struct Doc<'d> {
    pub file: &'d str,
    pub text: &'d str,
}

impl Doc<'_> {
    fn line(&self, byte: usize) -> usize {
        1 + self.text.bytes().take(byte).filter(|&b| b == b'\n').count()
    }

    fn value_error(&self, key: String, value: &Spanned<DeValue<'_>>, must: &str) -> SimulateError {
        let span = value.span();
        let written = self.text.get(span.clone()).unwrap_or("?");
        let mut short: String = written.split_whitespace().collect::<Vec<_>>().join(" ");
        if short.chars().count() > 60 {
            short = short.chars().take(60).collect::<String>() + "…";
        }
        let unit = unit_of(&key);
        if !unit.is_empty() {
            short = format!("{short} ({unit})");
        }
        SimulateError::Value {
            file: self.file.into(),
            line: self.line(span.start),
            key,
            value: short,
            why: format!("must be {must}"),
        }
    }
}

/// One table of the file; remembers which keys were asked for, and refuses the others.
pub(crate) struct Section<'d> {
    doc: &'d Doc<'d>,
    path: String,
    table: &'d DeTable<'d>,
    start: usize,
    asked: RefCell<Vec<&'static str>>,
}

impl<'d> Section<'d> {
    pub(crate) fn root(doc: &'d Doc<'d>, table: &'d DeTable<'d>) -> Self {
        Self {
            doc,
            path: String::new(),
            table,
            start: 0,
            asked: RefCell::default(),
        }
    }

    fn child(&self, path: String, value: &'d Spanned<DeValue<'d>>) -> Result<Self, SimulateError> {
        let table = value
            .get_ref()
            .as_table()
            .ok_or_else(|| self.doc.value_error(path.clone(), value, "a table"))?;
        Ok(Self {
            doc: self.doc,
            path,
            table,
            start: value.span().start,
            asked: RefCell::default(),
        })
    }

    fn full(&self, key: &str) -> String {
        if self.path.is_empty() {
            key.into()
        } else {
            format!("{}.{key}", self.path)
        }
    }

    /// How the section is called in a message.
    fn title(&self) -> String {
        if self.path.is_empty() {
            "the scenario".into()
        } else {
            format!("[{}]", self.path)
        }
    }

    pub(crate) fn line(&self) -> usize {
        self.doc.line(self.start)
    }

    fn get(&self, key: &'static str) -> Option<&'d Spanned<DeValue<'d>>> {
        self.asked.borrow_mut().push(key);
        self.table
            .iter()
            .find(|(k, _)| k.get_ref().as_ref() == key)
            .map(|(_, v)| v)
    }

    pub(crate) fn has(&self, key: &'static str) -> bool {
        self.get(key).is_some()
    }

    pub(crate) fn refuse(&self, key: &'static str, must: &str) -> SimulateError {
        match self.get(key) {
            Some(value) => self.doc.value_error(self.full(key), value, must),
            None => self.missing(key, must),
        }
    }

    pub(crate) fn missing(&self, key: &'static str, why: &str) -> SimulateError {
        SimulateError::Missing {
            file: self.doc.file.into(),
            line: self.line(),
            section: self.title(),
            key: key.into(),
            why: why.into(),
        }
    }

    fn float(
        &self,
        key: &str,
        value: &Spanned<DeValue<'_>>,
        bound: Bound,
    ) -> Result<f64, SimulateError> {
        let parsed = match value.get_ref() {
            DeValue::Float(f) => f.as_str().replace('_', "").parse::<f64>().ok(),
            DeValue::Integer(i) if i.radix() == 10 => i.as_str().replace('_', "").parse().ok(),
            _ => None,
        };
        let Some(v) = parsed else {
            return Err(self.doc.value_error(key.into(), value, "a number"));
        };
        match bound.refuses(v) {
            None => Ok(v),
            Some(must) => Err(self.doc.value_error(key.into(), value, &must)),
        }
    }

    pub(crate) fn number(
        &self,
        key: &'static str,
        bound: Bound,
    ) -> Result<Option<f64>, SimulateError> {
        self.get(key)
            .map(|v| self.float(&self.full(key), v, bound))
            .transpose()
    }

    pub(crate) fn need(
        &self,
        key: &'static str,
        bound: Bound,
        why: &str,
    ) -> Result<f64, SimulateError> {
        self.number(key, bound)?
            .ok_or_else(|| self.missing(key, why))
    }

    /// A whole number from 0 on.
    pub(crate) fn count(&self, key: &'static str) -> Result<Option<u64>, SimulateError> {
        let Some(value) = self.get(key) else {
            return Ok(None);
        };
        let parsed = value.get_ref().as_integer().and_then(|i| {
            let text = i.as_str().replace('_', "");
            u64::from_str_radix(&text, i.radix()).ok()
        });
        parsed.map(Some).ok_or_else(|| {
            self.doc
                .value_error(self.full(key), value, "a whole number of at least 0")
        })
    }

    pub(crate) fn flag(&self, key: &'static str) -> Result<Option<bool>, SimulateError> {
        self.get(key)
            .map(|v| {
                v.get_ref()
                    .as_bool()
                    .ok_or_else(|| self.doc.value_error(self.full(key), v, "true or false"))
            })
            .transpose()
    }

    pub(crate) fn text(&self, key: &'static str) -> Result<Option<String>, SimulateError> {
        self.get(key)
            .map(|v| {
                v.get_ref()
                    .as_str()
                    .map(str::to_owned)
                    .ok_or_else(|| self.doc.value_error(self.full(key), v, "text in quotes"))
            })
            .transpose()
    }

    /// `[x, y, z]`.
    pub(crate) fn vec3(&self, key: &'static str) -> Result<Option<[f64; 3]>, SimulateError> {
        let Some(value) = self.get(key) else {
            return Ok(None);
        };
        let full = self.full(key);
        let array = value.get_ref().as_array().filter(|a| a.len() == 3);
        let Some(array) = array else {
            return Err(self.doc.value_error(full, value, "three numbers [x, y, z]"));
        };
        let mut out = [0.0; 3];
        for (out, v) in out.iter_mut().zip(array.iter()) {
            *out = self.float(&full, v, Bound::Any)?;
        }
        Ok(Some(out))
    }

    /// `[[time, value], …]` with times that rise.
    pub(crate) fn pairs(
        &self,
        key: &'static str,
        bound: Bound,
    ) -> Result<Option<Vec<(f64, f64)>>, SimulateError> {
        let Some(value) = self.get(key) else {
            return Ok(None);
        };
        let full = self.full(key);
        let must = "a list of pairs [time, value]";
        let Some(array) = value.get_ref().as_array().filter(|a| !a.is_empty()) else {
            return Err(self.doc.value_error(full, value, must));
        };
        let mut out: Vec<(f64, f64)> = Vec::with_capacity(array.len());
        for entry in array.iter() {
            let Some(pair) = entry.get_ref().as_array().filter(|p| p.len() == 2) else {
                return Err(self.doc.value_error(full, entry, must));
            };
            let (Some(time), Some(v)) = (pair.first(), pair.get(1)) else {
                return Err(self.doc.value_error(full, entry, must));
            };
            let t = self.float(&full, time, Bound::NotNegative)?;
            if out.last().is_some_and(|&(before, _)| t <= before) {
                let must = "later than the pair before it";
                return Err(self.doc.value_error(full, entry, must));
            }
            out.push((t, self.float(&full, v, bound)?));
        }
        Ok(Some(out))
    }

    /// A number, `{ min, max }` (uniform) or `{ mean, std }` (normal).
    pub(crate) fn draw(
        &self,
        key: &'static str,
        bound: Bound,
    ) -> Result<Option<Draw>, SimulateError> {
        self.get(key)
            .map(|v| self.draw_of(self.full(key), v, bound))
            .transpose()
    }

    fn draw_of(
        &self,
        key: String,
        value: &'d Spanned<DeValue<'d>>,
        bound: Bound,
    ) -> Result<Draw, SimulateError> {
        if value.get_ref().as_table().is_none() {
            return Ok(Draw::Fixed(self.float(&key, value, bound)?));
        }
        let section = self.child(key.clone(), value)?;
        let draw = if section.has("std") {
            let mean = section.number("mean", bound)?.unwrap_or(0.0);
            let std = section.need("std", Bound::NotNegative, "the standard deviation")?;
            Draw::Normal { mean, std, bound }
        } else {
            let why = "a drawn value is { min = …, max = … } or { mean = …, std = … }";
            let min = section.need("min", bound, why)?;
            let max = section.need("max", bound, why)?;
            if max < min {
                return Err(section.refuse("max", "at least min"));
            }
            Draw::Uniform { min, max }
        };
        section.finish()?;
        Ok(draw)
    }

    /// One draw for all joints, or `{ joint = draw, … }`.
    pub(crate) fn per_joint(
        &self,
        key: &'static str,
        bound: Bound,
    ) -> Result<Option<PerJoint>, SimulateError> {
        let Some(value) = self.get(key) else {
            return Ok(None);
        };
        let full = self.full(key);
        let is_draw = |t: &DeTable<'_>| {
            t.iter()
                .any(|(k, _)| matches!(k.get_ref().as_ref(), "min" | "max" | "mean" | "std"))
        };
        match value.get_ref().as_table() {
            Some(table) if !is_draw(table) => {
                let mut by_joint = Vec::new();
                for (joint, v) in table.iter() {
                    let name = joint.get_ref().to_string();
                    let draw = self.draw_of(format!("{full}.{name}"), v, bound)?;
                    by_joint.push((name, self.doc.line(joint.span().start), draw));
                }
                Ok(Some(PerJoint {
                    all: None,
                    by_joint,
                }))
            }
            _ => Ok(Some(PerJoint {
                all: Some(self.draw_of(full, value, bound)?),
                by_joint: Vec::new(),
            })),
        }
    }

    /// A sub-table.
    pub(crate) fn section(&self, key: &'static str) -> Result<Option<Section<'d>>, SimulateError> {
        self.get(key)
            .map(|v| self.child(self.full(key), v))
            .transpose()
    }

    /// A list of sub-tables.
    pub(crate) fn sections(&self, key: &'static str) -> Result<Vec<Section<'d>>, SimulateError> {
        let Some(value) = self.get(key) else {
            return Ok(Vec::new());
        };
        let full = self.full(key);
        let Some(array) = value.get_ref().as_array() else {
            let must = "a list of tables ([[…]])";
            return Err(self.doc.value_error(full, value, must));
        };
        array
            .iter()
            .enumerate()
            .map(|(i, v)| self.child(format!("{full}[{i}]"), v))
            .collect()
    }

    /// Refuses what nobody asked for.
    pub(crate) fn finish(&self) -> Result<(), SimulateError> {
        let asked = self.asked.borrow();
        for (key, _) in self.table.iter() {
            if !asked.contains(&key.get_ref().as_ref()) {
                let mut known: Vec<&str> = asked.clone();
                known.sort_unstable();
                known.dedup();
                return Err(SimulateError::UnknownKey {
                    file: self.doc.file.into(),
                    line: self.doc.line(key.span().start),
                    key: key.get_ref().to_string(),
                    section: self.title(),
                    known: known.join(", "),
                });
            }
        }
        Ok(())
    }
}
