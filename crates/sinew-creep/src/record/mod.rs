//! Preparation of a specimen's columns as a curve: zero, preload, ramp, stages, artefacts.

use crate::test_file::{Specimen, TestQuantity};

mod artefacts;
mod interpolated;
mod load;

use super::artefacts::{MIN_STAGE_CHANGE, median};
use super::curve::{Curve, StepWindow, Tension};
use super::error::{CreepError, Unusable};
use super::span::Span;
pub use artefacts::Artefact;
use artefacts::{clean, remove_artefacts};
use interpolated::{Digits, interpolated};
use load::Load;

/// Properties that a file may lack.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PrepareOptions {
    /// Gauge length, m; required for an elongation if the file has none.
    pub gauge_length_m: Option<f64>,
    /// Cross-section, m²; without it there is no creep modulus.
    pub area_m2: Option<f64>,
    /// Temperature, °C, of files that do not record it.
    pub temperature_c: Option<f64>,
    /// Whether steps (grip slips) and outliers are kept.
    pub keep_artefacts: bool,
}

/// Reference of the strain zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum StrainZero {
    /// Mean of measurements before the load.
    BeforeLoad {
        /// Number of those measurements.
        readings: usize,
    },
    /// Recorded value, without a measurement before the load.
    AsRecorded,
}

/// Part of the record under one load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stage {
    /// First measurement at the load, s since the load started.
    pub start_s: f64,
    /// Last measurement, s since the load started.
    pub end_s: f64,
    /// Mean load, N; NaN if not recorded.
    pub force_n: f64,
    /// Duration of the load change before, s.
    pub ramp_s: f64,
}

/// Specimen prepared for the analysis.
#[derive(Debug, Clone, PartialEq)]
pub struct Prepared {
    /// Name of the specimen.
    pub name: String,
    /// Group of repeats of the specimen.
    pub group: Option<String>,
    /// All measurements under load and after it; strain counts from the zero.
    pub curve: Curve,
    /// Load of the first stage, N.
    pub force_n: Option<f64>,
    /// Load before the first stage, N.
    pub preload_n: Option<f64>,
    /// Stress of the first stage, Pa.
    pub stress_pa: Option<f64>,
    /// Time of the record at which the load starts, s.
    pub load_start_s: f64,
    /// Stages from the first under load.
    pub stages: Vec<Stage>,
    /// Reference of the strain zero.
    pub zero: StrainZero,
    /// Temperature of the record, °C.
    pub temperature_c: Option<Span>,
    /// Relative humidity or moisture, %.
    pub humidity_percent: Option<Span>,
    /// Artefacts found in the record.
    pub artefacts: Vec<Artefact>,
}

/// Minimum negative strain, beyond measurement errors, m/m.
const MIN_SHORTENING: f64 = 1e-5;
/// Minimum number of measurements of a creep test.
const MIN_MEASUREMENTS: usize = 5;

/// Prepares a specimen.
///
/// # Errors
/// Returns [`CreepError::Specimen`] with the reason: too few measurements, no gauge length, a
/// strain or force in another unit, or swapped force and elongation.
pub fn prepare(specimen: &Specimen, options: &PrepareOptions) -> Result<Prepared, CreepError> {
    let invalid = |reason: Unusable| CreepError::Specimen {
        specimen: specimen.name.clone(),
        reason,
    };
    let mut artefacts = Vec::new();
    let (raw_time, raw_strain, raw_force) = columns(specimen, options)?;
    let kept = clean(&raw_time, &raw_strain, raw_force.as_deref(), &mut artefacts);
    if kept.len() < MIN_MEASUREMENTS {
        return Err(invalid(Unusable::TooFewReadings {
            readings: kept.len(),
            needed: MIN_MEASUREMENTS,
        }));
    }
    let mut time: Vec<f64> = kept.iter().map(|&i| raw_time[i]).collect();
    let mut strain: Vec<f64> = kept.iter().map(|&i| raw_strain[i]).collect();
    let force: Option<Vec<f64>> = raw_force
        .as_ref()
        .map(|force| kept.iter().map(|&i| force[i]).collect());
    let lines = interpolated(&time, &strain, digits(specimen, options));
    let at_once = separate_loads(&mut time, force.as_deref());
    let repeated = time.windows(2).filter(|pair| pair[0] == pair[1]).count();
    if repeated > 0 {
        artefacts.push(Artefact::DuplicateTimestamps { readings: repeated });
    }
    let most = strain.iter().fold(0.0_f64, |m, e| m.max(e.abs()));
    // No fibre, rope or plastic elongates by its own length; wood and metals far less.
    if most > 2.0 {
        return Err(invalid(Unusable::StrainTooLarge { strain_ratio: most }));
    }
    if most > 0.5 {
        artefacts.push(Artefact::ImplausibleStrain { strain_ratio: most });
    }
    let span = time[time.len() - 1] - time[0];
    if span < 60.0 {
        artefacts.push(Artefact::ImplausibleTime { duration_s: span });
    }
    let load = Load::read(
        &time,
        &strain,
        force.as_deref(),
        &specimen.name,
        &mut artefacts,
    )?;
    let at_zero = load.first;
    let zero = if load.before > 0 {
        let before = &strain[load.before_from..load.before_from + load.before];
        let zero = before.iter().sum::<f64>() / before.len() as f64;
        strain.iter_mut().for_each(|e| *e -= zero);
        StrainZero::BeforeLoad {
            readings: load.before,
        }
    } else {
        StrainZero::AsRecorded
    };
    let start = load.start_s;
    // The time of these steps is recorded.
    let is_recorded = |window: &StepWindow| at_once.iter().any(|&i| time[i] - start == window.to_s);
    let windows = load.windows.iter().filter(|w| !is_recorded(w)).copied();
    let mut curve = Curve {
        name: specimen.name.clone(),
        time_s: time[at_zero..].iter().map(|t| t - start).collect(),
        strain: strain[at_zero..].to_vec(),
        count: vec![1.0; time.len() - at_zero],
        steps: load.steps.clone(),
        windows: windows.collect(),
        temperature_c: None,
        tension: load.reference_n.map(|reference| {
            let preload_n = load.preload_n.unwrap_or(0.0);
            Tension {
                preload_n,
                per_step_n: reference - preload_n,
                preloaded_s: (start - time[load.before_from]).max(0.0),
            }
        }),
        zero_count: load.before as f64,
    };
    let lines = &lines[at_zero..];
    let count = lines.iter().filter(|line| **line).count();
    let recorded = lines.len() - count;
    if count > 0 {
        artefacts.push(Artefact::Interpolated {
            readings: count,
            recorded,
            kept: options.keep_artefacts,
        });
        if !options.keep_artefacts {
            curve.select(|i| !lines[i]);
        }
    }
    artefacts.extend(remove_artefacts(
        &mut curve,
        &load.stages,
        options.keep_artefacts,
        start,
    ));
    // Measurements during a change of the load belong to no stage.
    let in_stage = |t: f64| {
        load.stages
            .iter()
            .any(|s| t >= s.start_s - 1e-9 && t <= s.end_s + 1e-9)
    };
    let are_in_stage: Vec<bool> = curve.time_s.iter().map(|t| in_stage(*t)).collect();
    curve.select(|i| are_in_stage[i]);
    let first_end = load
        .stages
        .first()
        .map_or(f64::INFINITY, |s| s.end_s + 1e-9);
    let under_load = curve.time_s.partition_point(|t| *t <= first_end);
    if let Some(&last) = curve.strain[..under_load].last()
        && last < -MIN_SHORTENING
        && median(&curve.strain[..under_load]) < -MIN_SHORTENING
    {
        artefacts.push(Artefact::Shortens { strain_ratio: last });
    }
    let temperature_c = range(specimen, TestQuantity::Temperature)
        .or_else(|| options.temperature_c.map(Span::point));
    curve.temperature_c = temperature_c.map(|t| t.mean);
    let area = specimen
        .constant(TestQuantity::Area)
        .or(options.area_m2)
        .filter(|area| *area > 0.0);
    let force_n = load.reference_n;
    let stress_pa = force_n
        .zip(area)
        .map(|(force, area)| force / area)
        .or_else(|| specimen.constant(TestQuantity::Stress));
    Ok(Prepared {
        name: specimen.name.clone(),
        group: None,
        curve,
        force_n,
        preload_n: load.preload_n,
        stress_pa,
        load_start_s: start,
        stages: load.stages,
        zero,
        temperature_c,
        humidity_percent: range(specimen, TestQuantity::Humidity),
        artefacts,
    })
}

/// Separates measurements at one time stamp under different loads: the first one under the new load follows the
/// last one under the old load after a moment, in the order of the file. Returns the indices of the former.
fn separate_loads(time: &mut [f64], force: Option<&[f64]>) -> Vec<usize> {
    /// Moment as a share of the interval to the next time stamp: a numerical tolerance, far below any ramp.
    const MOMENT_SHARE: f64 = 1e-6;
    /// Minimum moment, s: ten times the tolerance of the ends of a stage.
    const MIN_MOMENT_S: f64 = 1e-8;
    let Some(force) = force else {
        return Vec::new();
    };
    let largest = force.iter().fold(0.0_f64, |most, f| most.max(f.abs()));
    let stamps = time.to_vec();
    let mut at_once = Vec::new();
    for i in 1..time.len() {
        time[i] = time[i].max(time[i - 1]);
        let change = (force[i] - force[i - 1]).abs();
        if stamps[i] > stamps[i - 1] || change <= MIN_STAGE_CHANGE * largest {
            continue;
        }
        let next = stamps[i..].partition_point(|t| *t <= stamps[i]);
        let interval_s = stamps.get(i + next).map_or(0.0, |t| t - stamps[i]);
        // A large time, such as a date, is stored with fewer digits.
        let stored_s = 4.0 * f64::EPSILON * time[i].abs();
        time[i] += (MOMENT_SHARE * interval_s).max(MIN_MOMENT_S).max(stored_s);
        at_once.push(i);
    }
    at_once
}

type Columns = (Vec<f64>, Vec<f64>, Option<Vec<f64>>);

fn columns(specimen: &Specimen, options: &PrepareOptions) -> Result<Columns, CreepError> {
    let invalid = |reason: Unusable| CreepError::Specimen {
        specimen: specimen.name.clone(),
        reason,
    };
    let time = specimen
        .column(TestQuantity::Time)
        .ok_or_else(|| invalid(Unusable::NoTime))?
        .to_vec();
    let strain = if let Some(strain) = specimen.column(TestQuantity::Strain) {
        strain.to_vec()
    } else if let Some(elongation) = specimen.column(TestQuantity::Elongation) {
        let length =
            gauge_length_m(specimen, options).ok_or_else(|| invalid(Unusable::NoGaugeLength))?;
        if length <= 0.0 || length.is_nan() {
            return Err(invalid(Unusable::GaugeLength { length_m: length }));
        }
        elongation.iter().map(|e| e / length).collect()
    } else {
        return Err(invalid(Unusable::NoStrain));
    };
    Ok((
        time,
        strain,
        specimen.column(TestQuantity::Force).map(<[f64]>::to_vec),
    ))
}

/// Last digits of the times and strains of a file.
fn digits(specimen: &Specimen, options: &PrepareOptions) -> Digits {
    let strain_ratio = if specimen.column(TestQuantity::Strain).is_some() {
        specimen.last_digit(TestQuantity::Strain)
    } else {
        let length_m = gauge_length_m(specimen, options).unwrap_or(f64::INFINITY);
        specimen.last_digit(TestQuantity::Elongation) / length_m
    };
    Digits {
        time_s: specimen.last_digit(TestQuantity::Time),
        strain_ratio,
    }
}

/// Gauge length as specified, else of the file, m.
fn gauge_length_m(specimen: &Specimen, options: &PrepareOptions) -> Option<f64> {
    options
        .gauge_length_m
        .or_else(|| specimen.constant(TestQuantity::GaugeLength))
}

fn range(specimen: &Specimen, quantity: TestQuantity) -> Option<Span> {
    let values: Vec<f64> = specimen
        .column(quantity)?
        .iter()
        .copied()
        .filter(|v| v.is_finite())
        .collect();
    Span::of(&values)
}
