//! Analysis of a creep test without a creep law, except for a straight line: standard measurements,
//! moduli, slope, saturation, recovery.

use super::artefacts::median;
use super::curve::Curve;
use super::error::{CreepError, Unusable};
use super::fit::fit;
use super::law::Law;
use super::options::FitOptions;
use super::record::{Artefact, Prepared, Stage, StrainZero};
use super::span::Span;
use serde::{Deserialize, Serialize};
use sinew_model::Bounded;

/// Measurement times required by ISO 899-1, s: 1, 3, 6, 12, 30 min, 1, 2, 5, 10, 20, 50 … h.
pub const ISO_READINGS_S: [f64; 15] = [
    60.0, 180.0, 360.0, 720.0, 1.8e3, 3.6e3, 7.2e3, 1.8e4, 3.6e4, 7.2e4, 1.8e5, 3.6e5, 7.2e5,
    1.8e6, 3.6e6,
];
/// Conversion factor from 1/s to %/h, the unit of the paper's slopes.
pub const PERCENT_PER_H: f64 = 360_000.0;
/// Start of the straight line in the paper, s: 20 min.
pub const SLOPE_FROM_S: f64 = 1200.0;

/// Options of an analysis.
#[derive(Debug, Clone, PartialEq)]
pub struct AnalyzeOptions {
    /// Start of the straight line, s after the load.
    pub slope_from_s: f64,
    /// Confidence level of the intervals.
    pub level: f64,
    /// Seed of the draws.
    pub seed: u64,
}

impl Default for AnalyzeOptions {
    fn default() -> Self {
        Self {
            slope_from_s: SLOPE_FROM_S,
            level: 0.95,
            seed: 1,
        }
    }
}

/// Measurement at a standard time of ISO 899-1.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct IsoMeasurement {
    /// Time under the full load, s.
    pub time_s: f64,
    /// Strain relative to the zero, m/m.
    pub strain_ratio: f64,
    /// Tensile creep modulus F/(A ε), Pa; `None` without a cross-section.
    pub modulus_pa: Option<f64>,
}

/// Reason why a record has no slope.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum NoSlope {
    /// Too few measurements after the start of the straight line.
    TooFewReadings {
        /// Number of such measurements.
        readings: usize,
        /// Start of the straight line, s after the load.
        from_s: f64,
        /// Minimum number of measurements.
        needed: usize,
    },
    /// Failed fit of the straight line.
    NotFitted {
        /// Reason of the failure.
        reason: CreepError,
    },
}

/// Recovery after a decrease of the load.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Recovery {
    /// Load before the decrease, N.
    pub force_before_n: f64,
    /// Load after the decrease, N.
    pub force_after_n: f64,
    /// Strain at the end of the stage with the higher load, m/m.
    pub before_strain_ratio: f64,
    /// Strain recovered immediately with the load, m/m.
    pub immediate_strain_ratio: f64,
    /// Strain recovered later, within the record, m/m.
    pub delayed_strain_ratio: f64,
    /// Strain at the end of the stage, m/m: the residual strain if the load is removed.
    pub residual_strain_ratio: f64,
    /// Duration of the stage, s.
    pub duration_s: f64,
}

/// Analysis of one specimen's record.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Analysis {
    /// Name of the specimen.
    pub name: String,
    /// Group of repeats of the specimen.
    pub group: Option<String>,
    /// Load of the first stage, N.
    pub force_n: Option<f64>,
    /// Preload before the first stage, N.
    pub preload_n: Option<f64>,
    /// Stress of the first stage, Pa.
    pub stress_pa: Option<f64>,
    /// Temperature of the record, °C.
    pub temperature_c: Option<Span>,
    /// Relative humidity or moisture as recorded, %.
    pub humidity_percent: Option<Span>,
    /// Duration of the first stage, s.
    pub duration_s: f64,
    /// Reference of the strain zero.
    pub zero: StrainZero,
    /// Measurements at the standard times of ISO 899-1 within the first stage.
    pub readings: Vec<IsoMeasurement>,
    /// Strain at the end of the first stage, m/m.
    pub end_strain_ratio: f64,
    /// Strain increase from one minute (or the first measurement after it) to the end, m/m.
    pub creep_strain_ratio: f64,
    /// Slope `m_E` of the paper: straight line from [`AnalyzeOptions::slope_from_s`] on, 1/s; its
    /// interval accounts for the correlation of neighbouring residuals.
    pub slope_per_s: Option<Bounded>,
    /// Reason why there is no slope.
    pub no_slope: Option<NoSlope>,
    /// Time after which less than 5 % of the recorded creep remains, s.
    pub saturation_s: Option<f64>,
    /// Whether, at this slope, another such duration would add less than 10 % of the creep so far.
    pub saturated: Option<bool>,
    /// Recoveries after decreases of the load.
    pub recovery: Vec<Recovery>,
    /// Artefacts found in the record.
    pub artefacts: Vec<Artefact>,
}

/// Analyses a prepared specimen.
///
/// # Errors
/// Returns [`CreepError::Specimen`] if the first stage is missing or contains no measurement.
pub fn analyze(prepared: &Prepared, options: &AnalyzeOptions) -> Result<Analysis, CreepError> {
    let invalid = |reason: Unusable| CreepError::Specimen {
        specimen: prepared.name.clone(),
        reason,
    };
    let first = *prepared
        .stages
        .first()
        .ok_or_else(|| invalid(Unusable::NoStage))?;
    let stage = Part::of(&prepared.curve, &first);
    if stage.time_s.is_empty() {
        return Err(invalid(Unusable::NoReading));
    }
    let duration_s = first.end_s - first.start_s;
    let readings: Vec<IsoMeasurement> = ISO_READINGS_S
        .iter()
        .filter(|t| **t <= duration_s * (1.0 + 1e-9))
        .filter_map(|&t| {
            let strain = stage.at(t)?;
            Some(IsoMeasurement {
                time_s: t,
                strain_ratio: strain,
                modulus_pa: prepared
                    .stress_pa
                    .filter(|_| strain > 0.0)
                    .map(|s| s / strain),
            })
        })
        .collect();
    let end = stage.end();
    let start = stage
        .at(60.0_f64.min(duration_s))
        .unwrap_or(stage.strain[0]);
    let creep = end - start;
    let (slope_percent_per_h, no_slope) = match slope(&stage, options) {
        Ok(slope) => (Some(slope), None),
        Err(reason) => (None, Some(reason)),
    };
    let saturation_s = (creep > 0.0)
        .then(|| {
            let goal = end - 0.05 * creep;
            // Last measurement below the goal, because noise crosses it more than once.
            let after = stage.strain.iter().rposition(|e| *e < goal)? + 1;
            stage.time_s.get(after).copied()
        })
        .flatten();
    let saturated = slope_percent_per_h
        .filter(|_| creep > 0.0)
        .map(|s| s.value * duration_s / 3600.0 < 0.1 * 100.0 * creep);
    let recovery = prepared
        .stages
        .windows(2)
        .filter(|pair| pair[1].force_n < 0.95 * pair[0].force_n)
        .filter_map(|pair| {
            let (before, after) = (
                Part::of(&prepared.curve, &pair[0]),
                Part::of(&prepared.curve, &pair[1]),
            );
            if before.strain.is_empty() || after.strain.is_empty() {
                return None;
            }
            let (high, low) = (before.end(), after.strain[0]);
            Some(Recovery {
                force_before_n: pair[0].force_n,
                force_after_n: pair[1].force_n,
                before_strain_ratio: high,
                immediate_strain_ratio: high - low,
                delayed_strain_ratio: low - after.end(),
                residual_strain_ratio: after.end(),
                duration_s: pair[1].end_s - pair[1].start_s,
            })
        })
        .collect();
    Ok(Analysis {
        name: prepared.name.clone(),
        group: prepared.group.clone(),
        force_n: prepared.force_n,
        preload_n: prepared.preload_n,
        stress_pa: prepared.stress_pa,
        temperature_c: prepared.temperature_c,
        humidity_percent: prepared.humidity_percent,
        duration_s,
        zero: prepared.zero,
        readings,
        end_strain_ratio: end,
        creep_strain_ratio: creep,
        slope_per_s: slope_percent_per_h.map(|s| Bounded {
            value: s.value / PERCENT_PER_H,
            low: s.low / PERCENT_PER_H,
            high: s.high / PERCENT_PER_H,
        }),
        no_slope,
        saturation_s,
        saturated,
        recovery,
        artefacts: prepared.artefacts.clone(),
    })
}

/// Measurements of a stage; time counts from its start.
struct Part {
    time_s: Vec<f64>,
    strain: Vec<f64>,
}

impl Part {
    fn of(curve: &Curve, stage: &Stage) -> Part {
        let from = curve.time_s.partition_point(|t| *t < stage.start_s - 1e-9);
        let to = curve.time_s.partition_point(|t| *t <= stage.end_s + 1e-9);
        Part {
            time_s: curve.time_s[from..to]
                .iter()
                .map(|t| t - stage.start_s)
                .collect(),
            strain: curve.strain[from..to].to_vec(),
        }
    }

    /// Strain at a time: mean of the measurements within 3 % of it, otherwise interpolated over the
    /// logarithm of time.
    fn at(&self, t: f64) -> Option<f64> {
        let near: Vec<f64> = self
            .time_s
            .iter()
            .zip(&self.strain)
            .filter(|(time, _)| (*time - t).abs() <= 0.03 * t)
            .map(|(_, e)| *e)
            .collect();
        if near.len() >= 2 {
            return Some(near.iter().sum::<f64>() / near.len() as f64);
        }
        let after = self.time_s.partition_point(|time| *time < t);
        let (t1, e1) = (*self.time_s.get(after)?, self.strain[after]);
        if after == 0 {
            return (t1 == t).then_some(e1);
        }
        let (t0, e0) = (self.time_s[after - 1], self.strain[after - 1]);
        let share = if t0 > 0.0 {
            (t / t0).ln() / (t1 / t0).ln()
        } else {
            (t - t0) / (t1 - t0)
        };
        Some(e0 + share * (e1 - e0))
    }

    /// Strain at the end: median of the last measurements, at most 2 % of them.
    fn end(&self) -> f64 {
        let count = (self.strain.len() / 50).clamp(1, 21);
        median(&self.strain[self.strain.len() - count..])
    }
}

/// Slope of the late measurements, %/h.
fn slope(stage: &Part, options: &AnalyzeOptions) -> Result<Bounded, NoSlope> {
    /// Minimum number of measurements for a slope with an interval.
    const MIN_MEASUREMENTS: usize = 8;
    let from = stage.time_s.partition_point(|t| *t < options.slope_from_s);
    let late = &stage.time_s[from..];
    if late.len() < MIN_MEASUREMENTS {
        return Err(NoSlope::TooFewReadings {
            readings: late.len(),
            from_s: options.slope_from_s,
            needed: MIN_MEASUREMENTS,
        });
    }
    let curve = Curve::constant_load(
        "",
        late.iter().map(|t| t - late[0]).collect(),
        stage.strain[from..].to_vec(),
    );
    let options = FitOptions {
        level: options.level,
        seed: options.seed,
        ..FitOptions::default()
    };
    let fit = fit(Law::Line, &[curve], &options).map_err(|reason| NoSlope::NotFitted { reason })?;
    // The terms of a law precede its strain zeros.
    let s = &fit.parameters[0];
    Ok(Bounded {
        value: s.value,
        low: s.low,
        high: s.high,
    })
}
