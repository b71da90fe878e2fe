//! Endurance of a catalogue rope: its own values, otherwise those of its fibre class.

use super::catalogue::name_hash;
use super::{CatalogueError, CatalogueRope};
use crate::law::Polymer;
use crate::law::endurance::{Endurance, EnduranceKey};
use crate::law::entry::{FibreClass, Value};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use serde::{Deserialize, Serialize};

/// Termination of a rope.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum RopeTermination {
    /// Termination not specified; assumed as strong as the rope.
    #[default]
    NotSpecified,
    /// Spliced rope end.
    Spliced,
    /// Knotted rope end.
    Knotted,
}

impl RopeTermination {
    /// Share of the rope's strength that a termination retains.
    pub(crate) fn share(self, e: &Endurance) -> f64 {
        match self {
            RopeTermination::NotSpecified => 1.0,
            RopeTermination::Spliced => e.splice_share,
            RopeTermination::Knotted => e.knot_share,
        }
    }
}

impl CatalogueRope {
    /// Endurance values of this rope with their sources: its own, otherwise those of its fibre class.
    ///
    /// # Errors
    /// Returns [`CatalogueError::File`] if a shipped file is invalid, which a test excludes.
    pub fn endurance(&self) -> Result<FibreClass, CatalogueError> {
        let (file, text) = match self.entry.material {
            Polymer::Hmpe => ("hmpe.toml", include_str!("../fibres/hmpe.toml")),
            Polymer::Aramid => ("aramid.toml", include_str!("../fibres/aramid.toml")),
            Polymer::Lcp => ("lcp.toml", include_str!("../fibres/lcp.toml")),
            Polymer::Steel => ("steel.toml", include_str!("../fibres/steel.toml")),
            Polymer::Tungsten => ("tungsten.toml", include_str!("../fibres/tungsten.toml")),
            _ => ("other.toml", include_str!("../fibres/other.toml")),
        };
        let mut out = FibreClass::parse(text, file)?;
        for (key, value) in &self.entry.endurance {
            let source = format!("rope: {}", value.source);
            let text = self.entry.sources.get(&value.source).cloned();
            out.sources.insert(source.clone(), text.unwrap_or_default());
            let own = Value {
                source,
                ..value.clone()
            };
            out.endurance.insert(*key, own);
        }
        Ok(out)
    }
}

/// Endurance at the nominal values and in each draw.
pub(crate) struct Endurances {
    pub(crate) nominal: Endurance,
    pub(crate) drawn: Vec<Endurance>,
}

impl Endurances {
    /// Draws the endurance values from a random stream other than that of the creep law, whose draws are therefore
    /// unchanged.
    pub(crate) fn new(
        rope: &CatalogueRope,
        count: usize,
        seed: u64,
    ) -> Result<Self, CatalogueError> {
        const STREAM: u64 = 2;
        let values = rope.endurance()?.endurance;
        let at = |z: &mut dyn FnMut(EnduranceKey) -> f64| {
            let mut out = Endurance::default();
            for (key, value) in &values {
                out.set(*key, value.at(z(*key)));
            }
            out
        };
        let mut rng = ChaCha8Rng::seed_from_u64(seed ^ name_hash(&rope.entry.name));
        rng.set_stream(STREAM);
        Ok(Self {
            nominal: at(&mut |_| 0.0),
            drawn: (0..count)
                .map(|_| at(&mut |_| StandardNormal.sample(&mut rng)))
                .collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Catalogue;

    #[test]
    fn shipped_ropes_endurance_values_have_sources() {
        for rope in Catalogue::shipped().expect("shipped").ropes() {
            let class = rope.endurance().expect("readable");
            for key in EnduranceKey::ALL {
                let source = class
                    .endurance
                    .get(key)
                    .map(|v| class.sources[&v.source].len());
                assert!(source.is_some_and(|l| l > 20), "{}", key.name());
            }
        }
    }

    #[test]
    fn rope_endurance_value_overrides_fibre_class() {
        let mut rope = Catalogue::shipped().expect("shipped").ropes()[0].clone();
        let text = rope.entry.to_toml()
            + "\n[endurance]\nknot_share = { value = 0.6, origin = \"measured\", source = \"table1\" }\n";
        rope.entry = crate::law::entry::CatalogueEntry::parse(&text, "own").expect("parses");
        let found = Endurances::new(&rope, 3, 1).expect("readable");
        assert_eq!(found.nominal.knot_share, 0.6);
        assert_eq!(found.nominal.rupture_percent, 10.0);
        assert!(rope.entry.to_toml().contains("[endurance]\nknot_share"));
        let text = text.replace("0.6", "1.6");
        let error = crate::law::entry::CatalogueEntry::parse(&text, "own.toml");
        assert!(
            error
                .expect_err("above 1")
                .to_string()
                .contains("knot_share")
        );
    }
}
