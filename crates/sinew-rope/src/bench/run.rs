//! A rope on the bench with the spread of its parameters.

use super::{Bench, simulate};
use crate::CatalogueRope;
use crate::draws::{Draws, bounded};
use crate::law::{Law, routing};
use crate::limits::check_temperature;
use crate::predict::PredictError;
use serde::{Deserialize, Serialize};
use sinew_files::JsonDocument;
use sinew_model::Bounded;

/// Simulated elongation of one rope on the test bench.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BenchRun {
    /// Name of the bench.
    pub bench: String,
    /// Name of the rope in the catalogue.
    pub rope: String,
    /// Length of each strand, m.
    pub strand_m: f64,
    /// Rope unrolled and taken up, m.
    pub stroke_m: f64,
    /// Mean power of friction at the guides while the motor moves, in the phase of the largest force, W, with the 95 %
    /// interval of the draws.
    pub friction_power_w: Bounded,
    /// Power of friction above which the rope may be warmer than 35 °C at its guides, W: at that temperature heat
    /// retraction begins. Assumes a heat loss of 0.05 W/K, the low end of a range of 0.05 to 0.5 W/K.
    pub warm_above_w: f64,
    /// Readings in order.
    pub readings: Vec<BenchReading>,
}

/// The bench at one time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BenchReading {
    /// Time since the start of the programme, s.
    pub time_s: f64,
    /// Force on the carriage, N.
    pub force_n: f64,
    /// Displacement of the carriage, m.
    pub elongation_m: f64,
    /// Mean strain of the two strands, m/m, with the 95 % interval of the draws.
    pub strain_ratio: Bounded,
    /// Permanent (irreversible) part of the strain, m/m.
    pub irreversible_strain_ratio: f64,
}

impl BenchRun {
    /// Whether friction may heat the rope at its guides above 35 °C: the upper end of the power exceeds the limit.
    #[must_use]
    pub fn may_be_warm(&self) -> bool {
        self.friction_power_w.high > self.warm_above_w
    }
}

/// Lowest heat loss of rope and guides to the room that is assumed, W/K; not measured.
const MIN_HEAT_LOSS_W_PER_K: f64 = 0.05;
/// Temperature at which heat retraction begins, °C.
const WARM_C: f64 = 35.0;

/// Largest mean power of friction over the phases in which the motor moves, W.
fn friction_power_w(law: &Law, bench: &Bench) -> f64 {
    let moving = bench.phases.iter().filter(|phase| phase.moving);
    let force_n = moving.map(|phase| phase.force_n).fold(0.0, f64::max);
    let log_ratio = bench.log_ratio(law.parameters().friction);
    routing::friction_work_j(force_n, bench.stroke_m, log_ratio) / bench.period_s
}

impl JsonDocument for BenchRun {
    const SCHEMA: &'static str = "sinew/bench/2";
}

/// Simulates a rope and draws of its parameters in a bench's programme, with `readings` results.
///
/// # Errors
/// Returns [`PredictError`] if the law is incomplete, or the tension exceeds the strength.
pub fn run(
    rope: &CatalogueRope,
    bench: &Bench,
    readings: u32,
    draws: usize,
    seed: u64,
) -> Result<BenchRun, PredictError> {
    let temperatures = bench.phases.iter().map(|phase| phase.temperature_c);
    let temperature_c = temperatures.fold(f64::NEG_INFINITY, f64::max);
    check_temperature(rope, temperature_c)?;
    let draws = Draws::new(rope, draws, seed)?;
    let every_s = bench.duration_s() / f64::from(readings);
    let rope_m = rope.diameter_m();
    let run = |law: &Law| simulate(law, bench, rope_m, every_s);
    let nominal = run(&draws.nominal).map_err(|error| PredictError::Load {
        rope: rope.entry.name.clone(),
        error,
    })?;
    let (power_w, powers_w) = draws.map(|law| friction_power_w(law, bench));
    let drawn: Vec<_> = draws.laws.iter().filter_map(|law| run(law).ok()).collect();
    let reading = |i: usize| {
        let all: Vec<f64> = drawn.iter().map(|d| d.strain_percent[i]).collect();
        BenchReading {
            time_s: nominal.time_s[i],
            force_n: nominal.force_n[i],
            elongation_m: 1e-3 * nominal.elongation_mm[i],
            strain_ratio: bounded(nominal.strain_percent[i], &all).scaled(0.01),
            irreversible_strain_ratio: 0.01 * nominal.irreversible_percent[i],
        }
    };
    Ok(BenchRun {
        bench: bench.name.clone(),
        rope: rope.entry.name.clone(),
        strand_m: bench.strand_m,
        stroke_m: bench.stroke_m,
        friction_power_w: bounded(power_w, &powers_w),
        warm_above_w: MIN_HEAT_LOSS_W_PER_K * (WARM_C - temperature_c).max(0.0),
        readings: (0..nominal.time_s.len()).map(reading).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Catalogue;
    use crate::bench::routings::paper;

    /// 12.3268 J a cycle of 10 s at 365° a strand and μ 0.05; 2.0925 J at 60°. Above 0.05 W/K × 12 K it may be warm.
    #[test]
    fn large_wraps_may_heat_the_rope() {
        let catalogue = Catalogue::shipped().expect("shipped");
        let rope = catalogue.find("liros-dc000-0301").expect("there");
        let of = |name| run(rope, &paper(name).expect("a case"), 2, 100, 1).expect("a run");
        let (a, b, c) = (of("A"), of("B"), of("C"));
        assert_eq!(a.friction_power_w.high, 0.0);
        assert!((b.friction_power_w.value - 0.209_25).abs() < 5e-6);
        assert!((c.friction_power_w.value - 1.232_68).abs() < 5e-6);
        assert!((c.warm_above_w - 0.6).abs() < 1e-12);
        assert_eq!([a, b, c].map(|run| run.may_be_warm()), [false, false, true]);
    }
}
