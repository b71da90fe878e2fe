//! Catalogue ropes as results: published values and parameters of the creep law.

use super::{Catalogue, CatalogueRope};
use crate::law::entry::{DEFAULT_SOURCE, Origin, Uncertainty, Value};
use crate::law::tested_range::TestedRange;
use serde::{Deserialize, Serialize};
use sinew_files::JsonDocument;
use std::collections::BTreeMap;

/// A value of the catalogue with its origin.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CatalogueValue {
    /// Value, in the unit of its key.
    pub value: f64,
    /// Factor of the 95 % interval, from value/factor to value·factor, where specified.
    pub factor: Option<f64>,
    /// Half-width of the 95 % interval, in the unit of the value, where specified.
    pub plus_minus: Option<f64>,
    /// Origin of the value.
    pub origin: Origin,
    /// Key of the value's source in the rope's sources.
    pub source: String,
    /// Date of the fit, for fitted values.
    pub date: Option<String>,
}

impl CatalogueValue {
    /// Converts a value to another unit: `unit` of the new one make one of the catalogue's.
    fn scaled(v: &Value, unit: f64) -> Self {
        let (factor, plus_minus) = match v.uncertainty {
            Uncertainty::NotSpecified => (None, None),
            Uncertainty::Factor(f) => (Some(f), None),
            Uncertainty::PlusMinus(d) => (None, Some(unit * d)),
        };
        Self {
            value: unit * v.value,
            factor,
            plus_minus,
            origin: v.origin,
            source: v.source.clone(),
            date: v.date.clone(),
        }
    }
}

/// Summary of a catalogue rope.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RopeSummary {
    /// Name of the rope.
    pub name: String,
    /// Manufacturer of the rope.
    pub manufacturer: String,
    /// Product name of the manufacturer.
    pub product: String,
    /// Name of the load-bearing fibre.
    pub fibre: String,
    /// Material of the fibre.
    pub material: String,
    /// Construction of the braid.
    pub plait: Option<String>,
    /// Published diameter, m.
    pub diameter_m: Option<f64>,
    /// Published breaking load, N.
    pub breaking_load_n: Option<f64>,
    /// Published weight per length, kg/m.
    pub weight_kg_per_m: Option<f64>,
    /// Number of creep law parameters that are assumed, not measured.
    pub assumed_parameters: usize,
    /// Number of parameters of the creep law.
    pub parameters: usize,
    /// File it came from; `None`: ships with the program.
    pub file: Option<String>,
}

/// All ropes of a catalogue.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RopeList {
    /// Ropes in the catalogue's order.
    pub ropes: Vec<RopeSummary>,
}

impl JsonDocument for RopeList {
    const SCHEMA: &'static str = "sinew/rope-list/2";
}

/// Everything known about a rope.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RopeDescription {
    /// The rope in short.
    #[serde(flatten)]
    pub summary: RopeSummary,
    /// Remarks of the catalogue entry.
    pub note: Option<String>,
    /// Published values of the rope.
    pub published: Published,
    /// Tested range of the rope; intervals are wider outside this range.
    pub tested_range: TestedRange,
    /// Parameters of the law by their names in the catalogue, which end in their units.
    pub law: BTreeMap<String, CatalogueValue>,
    /// Endurance values of the rope or its fibre class by name; the names end in their units.
    pub endurance: BTreeMap<String, CatalogueValue>,
    /// Sources of the endurance by their keys.
    pub endurance_sources: BTreeMap<String, String>,
    /// Sources by their keys.
    pub sources: BTreeMap<String, String>,
}

impl JsonDocument for RopeDescription {
    const SCHEMA: &'static str = "sinew/rope-show/2";
}

/// Published values of a rope, with origin and uncertainty.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Published {
    /// Diameter of the rope, m.
    pub diameter_m: Option<CatalogueValue>,
    /// Breaking load, N.
    pub breaking_load_n: Option<CatalogueValue>,
    /// Weight per length, kg/m.
    pub weight_kg_per_m: Option<CatalogueValue>,
}

impl Catalogue {
    /// All ropes in short.
    pub fn list(&self) -> RopeList {
        RopeList {
            ropes: self.ropes().iter().map(CatalogueRope::summary).collect(),
        }
    }
}

impl CatalogueRope {
    /// The rope in short.
    pub fn summary(&self) -> RopeSummary {
        let e = &self.entry;
        let value = |v: &Option<Value>, unit: f64| v.as_ref().map(|v| unit * v.value);
        RopeSummary {
            name: e.name.clone(),
            manufacturer: e.manufacturer.clone(),
            product: e.product.clone(),
            fibre: e.fibre.clone(),
            material: e.material.name().to_owned(),
            plait: e.plait.clone(),
            diameter_m: value(&e.diameter_mm, 1e-3),
            breaking_load_n: value(&e.breaking_load_n, 1.0),
            weight_kg_per_m: value(&e.weight_g_per_m, 1e-3),
            assumed_parameters: e.assumed(),
            parameters: e.law.len(),
            file: self.file.as_ref().map(|f| f.display().to_string()),
        }
    }

    /// Everything known about the rope.
    pub fn describe(&self) -> RopeDescription {
        let e = &self.entry;
        let value =
            |v: &Option<Value>, unit: f64| v.as_ref().map(|v| CatalogueValue::scaled(v, unit));
        // The fibres' files ship with the program; a test reads each of them.
        let class = self.endurance().ok();
        let (endurance, endurance_sources) =
            class.map_or_else(Default::default, |c| (c.endurance, c.sources));
        let law = e.law_with_defaults();
        let mut sources = e.sources.clone();
        if law.len() > e.law.len() {
            let [key, text] = DEFAULT_SOURCE;
            sources.entry(key.into()).or_insert_with(|| text.into());
        }
        RopeDescription {
            summary: self.summary(),
            note: e.note.clone(),
            published: Published {
                diameter_m: value(&e.diameter_mm, 1e-3),
                breaking_load_n: value(&e.breaking_load_n, 1.0),
                weight_kg_per_m: value(&e.weight_g_per_m, 1e-3),
            },
            tested_range: self.tested_range(),
            law: law
                .iter()
                .map(|(p, v)| (p.name().to_owned(), CatalogueValue::scaled(v, 1.0)))
                .collect(),
            endurance: endurance
                .iter()
                .map(|(k, v)| (k.name().to_owned(), CatalogueValue::scaled(v, 1.0)))
                .collect(),
            endurance_sources,
            sources,
        }
    }
}
