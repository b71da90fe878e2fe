//! What a rope endures: its own values, else those of its class of fibres.

use super::draws::name_hash;
use super::{CatalogueError, CatalogueRope};
use crate::law::Polymer;
use crate::law::endurance::{Endurance, EnduranceKey};
use crate::law::entry::{FibreClass, Value};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use serde::{Deserialize, Serialize};

/// How a rope's ends are held.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Ends {
    /// Not stated: taken to be as strong as the rope.
    #[default]
    NotStated,
    /// Spliced.
    Spliced,
    /// Knotted.
    Knotted,
}

impl Ends {
    /// Share of the rope's strength that an end keeps.
    pub(crate) fn share(self, e: &Endurance) -> f64 {
        match self {
            Ends::NotStated => 1.0,
            Ends::Spliced => e.splice_share,
            Ends::Knotted => e.knot_share,
        }
    }
}

impl CatalogueRope {
    /// What this rope endures, with the sources of each value: its own, else its fibre's.
    ///
    /// # Errors
    /// [`CatalogueError::File`]; a test keeps that from happening.
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

/// With every value as it stands, and in each draw.
pub(crate) struct Endurances {
    pub(crate) nominal: Endurance,
    pub(crate) drawn: Vec<Endurance>,
}

impl Endurances {
    /// Another stream of numbers than the law's, so that its draws stay the same.
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
    fn every_shipped_rope_has_every_value_with_a_source() {
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
    fn a_ropes_own_value_comes_before_its_fibres() {
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
