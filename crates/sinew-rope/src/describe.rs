//! Ropes of the catalogue as results: what is published, what is known of the law.

use super::{Catalogue, CatalogueRope};
use crate::law::entry::{Origin, Uncertainty, Value};
use crate::law::holds::Holds;
use serde::{Deserialize, Serialize};
use sinew_files::JsonDocument;
use std::collections::BTreeMap;

/// A value of the catalogue with its origin.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CatalogueValue {
    /// Value, in the unit of its key.
    pub value: f64,
    /// With 95 % probability between value/factor and value·factor, where stated so.
    pub factor: Option<f64>,
    /// With 95 % probability within so much of the value, where stated so.
    pub plus_minus: Option<f64>,
    /// Where it comes from.
    pub origin: Origin,
    /// Key of the rope's sources.
    pub source: String,
    /// Day of a fit.
    pub date: Option<String>,
}

impl CatalogueValue {
    /// A value in another unit: `unit` of the new one make one of the catalogue's.
    fn scaled(v: &Value, unit: f64) -> Self {
        let (factor, plus_minus) = match v.uncertainty {
            Uncertainty::NotStated => (None, None),
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

/// A rope in short.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RopeSummary {
    /// Name.
    pub name: String,
    /// Who makes it.
    pub manufacturer: String,
    /// What they call it.
    pub product: String,
    /// Load-bearing fibre.
    pub fibre: String,
    /// What the fibre is made of.
    pub material: String,
    /// How it is plaited.
    pub plait: Option<String>,
    /// Diameter, m, where it is published.
    pub diameter_m: Option<f64>,
    /// Breaking load, N, where it is published.
    pub breaking_load_n: Option<f64>,
    /// Weight, kg/m, where it is published.
    pub weight_kg_per_m: Option<f64>,
    /// Parameters of the law that are starting guesses.
    pub starting_guesses: usize,
    /// Parameters of the law.
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
    const SCHEMA: &'static str = "sinew/rope-list/1";
}

/// Everything known about a rope.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RopeDescription {
    /// The rope in short.
    #[serde(flatten)]
    pub summary: RopeSummary,
    /// Remarks.
    pub note: Option<String>,
    /// What is published.
    pub published: Published,
    /// Data behind the values of the law; beyond it predictions widen.
    pub holds: Holds,
    /// Parameters of the law by their names in the catalogue, which end in their units.
    pub law: BTreeMap<String, CatalogueValue>,
    /// What breaks the rope, its own values or its fibre's, by their names, which end in their units.
    pub endurance: BTreeMap<String, CatalogueValue>,
    /// Sources of the endurance by their keys.
    pub endurance_sources: BTreeMap<String, String>,
    /// Sources by their keys.
    pub sources: BTreeMap<String, String>,
}

impl JsonDocument for RopeDescription {
    const SCHEMA: &'static str = "sinew/rope-show/1";
}

/// What a maker publishes, with origin and uncertainty.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Published {
    /// Diameter, m.
    pub diameter_m: Option<CatalogueValue>,
    /// Breaking load, N.
    pub breaking_load_n: Option<CatalogueValue>,
    /// Weight, kg/m.
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
            starting_guesses: e.guesses(),
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
        RopeDescription {
            summary: self.summary(),
            note: e.note.clone(),
            published: Published {
                diameter_m: value(&e.diameter_mm, 1e-3),
                breaking_load_n: value(&e.breaking_load_n, 1.0),
                weight_kg_per_m: value(&e.weight_g_per_m, 1e-3),
            },
            holds: self.holds(),
            law: e
                .law
                .iter()
                .map(|(p, v)| (p.name().to_owned(), CatalogueValue::scaled(v, 1.0)))
                .collect(),
            endurance: endurance
                .iter()
                .map(|(k, v)| (k.name().to_owned(), CatalogueValue::scaled(v, 1.0)))
                .collect(),
            endurance_sources,
            sources: e.sources.clone(),
        }
    }
}
