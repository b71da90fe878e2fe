//! A rope on the bench with the spread of its parameters.

use super::{Bench, simulate};
use crate::CatalogueRope;
use crate::draws::{Draws, bounded};
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
    check_temperature(rope, temperatures.fold(f64::NEG_INFINITY, f64::max))?;
    let draws = Draws::new(rope, draws, seed)?;
    let every_s = bench.duration_s() / f64::from(readings);
    let nominal = simulate(&draws.nominal, bench, every_s).map_err(|error| PredictError::Load {
        rope: rope.entry.name.clone(),
        error,
    })?;
    let drawn: Vec<_> = draws
        .laws
        .iter()
        .filter_map(|law| simulate(law, bench, every_s).ok())
        .collect();
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
        readings: (0..nominal.time_s.len()).map(reading).collect(),
    })
}
