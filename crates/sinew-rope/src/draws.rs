//! Seeded draws of a rope: parameters and endurance from their specified intervals, and the model error of the creep
//! law outside the tested range. Predictions, selections, plans and trends use the same draws.

use super::catalogue::name_hash;
use super::endurance::Endurances;
use super::{CatalogueError, CatalogueRope};
use crate::law::endurance::Endurance;
use crate::law::entry::CatalogueEntry;
use crate::law::tested_range::{Extrapolation, ModelError, TestedRange};
use crate::law::{Law, Parameter};
use rand::{RngExt as _, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use sinew_model::Bounded;
use sinew_model::statistics::quantile;

/// Default number of draws: ten of 400 lie below the 2.5 % quantile.
pub const DRAWS_DEFAULT: usize = 400;

/// Nominal share of a heat retraction that is recovered on cooling. No value is published, so each posterior draw
/// takes a share from the uniform distribution on [0, 1].
const RETRACTION_RETURN: f64 = 0.5;
/// Random stream of the recovered share.
const RETURN_STREAM: u64 = 3;
/// Random stream of the exponent of the bending pressure.
const PRESSURE_STREAM: u64 = 4;
/// Random stream of the model error outside the tested range.
const ERROR_STREAM: u64 = 1;

/// `value` with the 95 % interval of `draws` around it; NaN draws are ignored.
pub fn bounded(value: f64, draws: &[f64]) -> Bounded {
    let mut sorted: Vec<f64> = draws.iter().copied().filter(|v| !v.is_nan()).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let at = |share| match sorted.as_slice() {
        [] => value,
        sorted => quantile(sorted, share),
    };
    Bounded {
        value,
        low: at(0.025),
        high: at(0.975),
    }
}

/// Draws of a rope, and the rope at its catalogue values.
#[derive(Debug, Clone, PartialEq)]
pub struct Draws {
    /// Law with every parameter at its catalogue value.
    pub nominal: Law,
    /// Laws with parameters drawn from their intervals.
    pub laws: Vec<Law>,
    /// Endurance of the rope at its catalogue values.
    pub(crate) endurance: Endurance,
    /// Endurance in each draw.
    endurances: Vec<Endurance>,
    /// Standard normal number of the model error in each draw.
    errors_z: Vec<f64>,
    tested_range: TestedRange,
}

/// One draw of a rope under a duty.
#[derive(Debug, Clone, Copy)]
pub struct Draw<'a> {
    /// Creep law of the draw.
    pub law: &'a Law,
    /// Model error of the law outside the tested range of the rope.
    pub error: ModelError,
    /// Endurance of the draw.
    pub(crate) endurance: &'a Endurance,
}

impl Draws {
    /// Draws `count` laws of a rope. Parameters are independent except for the correlations of the entry. The
    /// same seed gives the same draws; the streams of different ropes differ.
    ///
    /// # Errors
    /// Returns [`CatalogueError::NoLaw`] with the missing parameters.
    pub fn new(rope: &CatalogueRope, count: usize, seed: u64) -> Result<Self, CatalogueError> {
        let entry = &rope.entry;
        let law = |z: &dyn Fn(Parameter) -> f64| {
            let parameters = entry
                .parameters_at(z)
                .map_err(|missing| CatalogueError::NoLaw {
                    name: entry.name.clone(),
                    missing: missing.join(", "),
                })?;
            Law::new(parameters).map_err(|e| CatalogueError::NoLaw {
                name: entry.name.clone(),
                missing: e.to_string(),
            })
        };
        let mut rng = ChaCha8Rng::seed_from_u64(seed ^ name_hash(&entry.name));
        let nominal = law(&|_| 0.0)?.giving_back(RETRACTION_RETURN);
        // Another stream than the parameters', so that these stay the same draws.
        let mut returns = rng.clone();
        returns.set_stream(RETURN_STREAM);
        let mut pressures = rng.clone();
        pressures.set_stream(PRESSURE_STREAM);
        let laws = (0..count)
            .map(|_| {
                let z = standard_errors(entry, &mut rng, &mut pressures);
                let law = law(&|p| z[Parameter::ALL.iter().position(|q| *q == p).unwrap_or(0)])?;
                Ok(law.giving_back(returns.random()))
            })
            .collect::<Result<_, CatalogueError>>()?;
        let mut errors = ChaCha8Rng::seed_from_u64(seed ^ name_hash(&entry.name));
        errors.set_stream(ERROR_STREAM);
        let errors = std::iter::repeat_with(|| StandardNormal.sample(&mut errors));
        let endurances = Endurances::new(rope, count, seed)?;
        Ok(Self {
            nominal,
            laws,
            endurance: endurances.nominal,
            endurances: endurances.drawn,
            errors_z: errors.take(count).collect(),
            tested_range: rope.tested_range(),
        })
    }

    /// Extrapolation distance of a duty from the tested range of the rope: mean and largest tension, N, lowest and
    /// highest temperature, °C. The low end of the loads is the mean tension, because a short time without tension is
    /// no extrapolation.
    #[must_use]
    pub fn extrapolation(&self, tension_n: [f64; 2], temperature_c: [f64; 2]) -> Extrapolation {
        let share = tension_n.map(|n| self.nominal.load_ratio(n));
        self.tested_range.extrapolation(share, temperature_c)
    }

    /// Draw `i` under a duty at an extrapolation distance from the tested range; `None` beyond the last.
    #[must_use]
    pub fn draw(&self, i: usize, extrapolation: Extrapolation) -> Option<Draw<'_>> {
        Some(Draw {
            law: self.laws.get(i)?,
            endurance: self.endurances.get(i)?,
            error: ModelError {
                tested_range: self.tested_range,
                extrapolation,
                error_z: *self.errors_z.get(i)?,
            },
        })
    }

    /// Draws under a duty at an extrapolation distance from the tested range.
    pub fn each(&self, extrapolation: Extrapolation) -> impl Iterator<Item = Draw<'_>> {
        (0..self.laws.len()).filter_map(move |i| self.draw(i, extrapolation))
    }

    /// Applies a function to every law: nominal first, then each draw.
    pub fn map<T>(&self, f: impl Fn(&Law) -> T) -> (T, Vec<T>) {
        (f(&self.nominal), self.laws.iter().map(f).collect())
    }
}

/// One standard normal value per parameter, with the correlations of the entry.
fn standard_errors(
    entry: &CatalogueEntry,
    rng: &mut ChaCha8Rng,
    pressures: &mut ChaCha8Rng,
) -> Vec<f64> {
    let all = Parameter::ALL;
    let sample = |p: &Parameter| -> f64 {
        match p {
            Parameter::PassPressureExponent => StandardNormal.sample(&mut *pressures),
            _ => StandardNormal.sample(&mut *rng),
        }
    };
    let mut z: Vec<f64> = all.iter().map(sample).collect();
    if let Some(correlation) = &entry.correlation {
        let place = |p: &Parameter| all.iter().position(|q| q == p).unwrap_or(0);
        let independent: Vec<f64> = correlation.parameters.iter().map(|p| z[place(p)]).collect();
        for (p, row) in correlation.parameters.iter().zip(&correlation.cholesky) {
            z[place(p)] = row.iter().zip(&independent).map(|(a, b)| a * b).sum();
        }
    }
    z
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Catalogue;

    #[test]
    fn intervals_of_the_draws_are_those_of_the_catalogue() {
        let catalogue = Catalogue::shipped().expect("shipped");
        let rope = catalogue.find("liros-dc000-0301").expect("there");
        let draws = Draws::new(rope, 4000, 1).expect("complete");
        let of = |p: Parameter| {
            let values: Vec<f64> = draws.laws.iter().map(|l| l.parameters().get(p)).collect();
            bounded(draws.nominal.parameters().get(p), &values)
        };
        // Quantiles of 4000 normal draws scatter by 5 % of a standard deviation.
        let bedding = of(Parameter::Bedding);
        assert_eq!(bedding.value, 0.42);
        assert!(
            (bedding.high / (0.42 * 1.5) - 1.0).abs() < 0.04,
            "{bedding:?}"
        );
        assert!(
            (bedding.low / (0.42 / 1.5) - 1.0).abs() < 0.04,
            "{bedding:?}"
        );
        let jamming = of(Parameter::Jamming);
        assert!((jamming.high - 4.0).abs() < 0.1, "{jamming:?}");
        let load = of(Parameter::BreakingLoad);
        assert_eq!(
            (load.low, load.high),
            (4450.0, 4450.0),
            "not stated: as it stands"
        );
        assert_eq!(draws, Draws::new(rope, 4000, 1).expect("complete"));
        assert_ne!(draws, Draws::new(rope, 4000, 2).expect("complete"));
    }

    #[test]
    fn correlated_errors_come_out_correlated() {
        let mut rope = Catalogue::shipped().expect("shipped").ropes()[0].clone();
        let text = rope.entry.to_toml()
            + "\n[correlation]\nparameters = [\"bedding_percent\", \"jamming\"]\n\
               matrix = [[1.0, -0.8], [-0.8, 1.0]]\n";
        rope.entry = CatalogueEntry::parse(&text, "test").expect("parses");
        let draws = Draws::new(&rope, 4000, 3).expect("complete");
        let pairs: Vec<(f64, f64)> = draws
            .laws
            .iter()
            .map(|l| (l.parameters().bedding_percent.ln(), l.parameters().jamming))
            .collect();
        let n = pairs.len() as f64;
        let mean = |f: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(f).sum::<f64>() / n;
        let (mx, my) = (mean(&|p| p.0), mean(&|p| p.1));
        let (sx, sy) = (mean(&|p| (p.0 - mx).powi(2)), mean(&|p| (p.1 - my).powi(2)));
        let r = mean(&|p| (p.0 - mx) * (p.1 - my)) / (sx * sy).sqrt();
        // Standard error of a correlation of −0.8 from 4000 pairs: 0.006.
        assert!((r + 0.8).abs() < 0.025, "{r}");
    }
}
