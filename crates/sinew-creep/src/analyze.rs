//! What a creep test says without any law but a straight line: readings, moduli, slope,
//! saturation, recovery.

use super::CreepError;
use super::curve::Curve;
use super::fit::{FitOptions, fit};
use super::law::Law;
use super::record::{Prepared, Stage};
use super::scan::median;

/// A time of [`ISO_READINGS_S`] as the standard writes it: `3 min`, `50 h`.
pub fn reading_time(time_s: f64) -> String {
    if time_s < 3600.0 {
        format!("{:.0} min", time_s / 60.0)
    } else {
        format!("{:.0} h", time_s / 3600.0)
    }
}

/// Readings ISO 899-1 asks for, s: 1, 3, 6, 12, 30 min, 1, 2, 5, 10, 20, 50 … h.
pub const ISO_READINGS_S: [f64; 15] = [
    60.0,
    180.0,
    360.0,
    720.0,
    1800.0,
    3600.0,
    7200.0,
    18_000.0,
    36_000.0,
    72_000.0,
    180_000.0,
    360_000.0,
    720_000.0,
    1_800_000.0,
    3_600_000.0,
];
/// Where the paper begins its straight line: 20 min.
pub const SLOPE_FROM_S: f64 = 1200.0;

/// How to analyse.
#[derive(Debug, Clone, PartialEq)]
pub struct AnalyzeOptions {
    /// Start of the straight line, s after the load.
    pub slope_from_s: f64,
    /// Level of the intervals.
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

/// One reading of ISO 899-1.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Reading {
    /// Time under the whole load, s.
    pub time_s: f64,
    /// Strain from the zero, %.
    pub strain_percent: f64,
    /// Tensile creep modulus F/(A ε), MPa; `None` without a cross-section.
    pub modulus_mpa: Option<f64>,
}

/// A value with its interval.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Interval {
    /// Value.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// After the load fell.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Recovery {
    /// Load before and after, N.
    pub force_before_n: f64,
    /// Load after, N.
    pub force_after_n: f64,
    /// Strain at the end under the higher load, %.
    pub strain_before_percent: f64,
    /// Strain that went with the load, %.
    pub at_once_percent: f64,
    /// Strain that went later, within the record, %.
    pub delayed_percent: f64,
    /// Strain at the end of the stage, %: what is left, residual where the load is gone.
    pub residual_percent: f64,
    /// Length of the stage, s.
    pub duration_s: f64,
}

/// What one specimen's record says.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Analysis {
    /// Specimen.
    pub name: String,
    /// Load of the first stage, N.
    pub force_n: Option<f64>,
    /// Load before, N.
    pub preload_n: Option<f64>,
    /// Stress of the first stage, MPa.
    pub stress_mpa: Option<f64>,
    /// Mean temperature, °C.
    pub temperature_c: Option<f64>,
    /// Mean humidity, %.
    pub humidity_percent: Option<f64>,
    /// Mean, lowest and highest humidity or moisture, %.
    pub humidity_range_percent: Option<(f64, f64, f64)>,
    /// Length of the first stage, s.
    pub duration_s: f64,
    /// What was taken for strain zero.
    pub zero: String,
    /// Readings at the times of ISO 899-1 that the first stage reaches.
    pub readings: Vec<Reading>,
    /// Strain at the end of the first stage, %.
    pub end_percent: f64,
    /// Rise from one minute (or the first reading after it) to the end, %.
    pub creep_percent: f64,
    /// The paper's `m_E`: slope of a straight line from [`AnalyzeOptions::slope_from_s`] on,
    /// %/h; with an interval that knows that neighbouring residuals are alike.
    pub slope_percent_per_h: Option<Interval>,
    /// Why there is no slope.
    pub no_slope: Option<String>,
    /// Time after which less than a twentieth of the creep is still to come within the record, s.
    pub saturation_s: Option<f64>,
    /// Whether, at the slope found, another such duration would add less than a tenth of the
    /// creep so far.
    pub saturated: Option<bool>,
    /// Falls of the load.
    pub recovery: Vec<Recovery>,
    /// Oddities.
    pub faults: Vec<super::record::Fault>,
}

/// Analyses a prepared specimen.
///
/// # Errors
/// [`CreepError::Specimen`] when the first stage holds no reading.
pub fn analyze(prepared: &Prepared, options: &AnalyzeOptions) -> Result<Analysis, CreepError> {
    let refuse = |reason: &str| CreepError::Specimen {
        specimen: prepared.name.clone(),
        reason: reason.to_owned(),
    };
    let first = *prepared
        .stages
        .first()
        .ok_or_else(|| refuse("no stage under load"))?;
    let stage = Part::of(&prepared.curve, &first);
    if stage.time_s.is_empty() {
        return Err(refuse("no reading under load"));
    }
    let stress_mpa = prepared.stress_pa.map(|s| s * 1e-6);
    let duration_s = first.end_s - first.start_s;
    let readings: Vec<Reading> = ISO_READINGS_S
        .iter()
        .filter(|t| **t <= duration_s * (1.0 + 1e-9))
        .filter_map(|&t| {
            let strain = stage.at(t)?;
            Some(Reading {
                time_s: t,
                strain_percent: 100.0 * strain,
                modulus_mpa: stress_mpa.filter(|_| strain > 0.0).map(|s| s / strain),
            })
        })
        .collect();
    let end = stage.end();
    let start = stage
        .at(60.0_f64.min(duration_s))
        .unwrap_or(stage.strain[0]);
    let creep = end - start;
    let (slope, no_slope) = match slope(&stage, options) {
        Ok(interval) => (Some(interval), None),
        Err(reason) => (None, Some(reason)),
    };
    let saturation_s = (creep > 0.0)
        .then(|| {
            let goal = end - 0.05 * creep;
            // The last reading below the goal: noise crosses it more than once.
            let after = stage.strain.iter().rposition(|e| *e < goal)? + 1;
            stage.time_s.get(after).copied()
        })
        .flatten();
    let saturated = slope
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
                strain_before_percent: 100.0 * high,
                at_once_percent: 100.0 * (high - low),
                delayed_percent: 100.0 * (low - after.end()),
                residual_percent: 100.0 * after.end(),
                duration_s: pair[1].end_s - pair[1].start_s,
            })
        })
        .collect();
    Ok(Analysis {
        name: prepared.name.clone(),
        force_n: prepared.force_n,
        preload_n: prepared.preload_n,
        stress_mpa,
        temperature_c: prepared.temperature_c.map(|t| t.0),
        humidity_percent: prepared.humidity_percent.map(|h| h.0),
        humidity_range_percent: prepared.humidity_percent,
        duration_s,
        zero: prepared.zero.clone(),
        readings,
        end_percent: 100.0 * end,
        creep_percent: 100.0 * creep,
        slope_percent_per_h: slope,
        no_slope,
        saturation_s,
        saturated,
        recovery,
        faults: prepared.faults.clone(),
    })
}

/// Readings of a stage; time counts from its start.
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

    /// Strain at a time: mean of the readings within 3 % of it, else between its neighbours on a
    /// logarithmic scale of time.
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

    /// Strain at the end: median of the last readings, at most a fiftieth of them.
    fn end(&self) -> f64 {
        let count = (self.strain.len() / 50).clamp(1, 21);
        median(&self.strain[self.strain.len() - count..])
    }
}

fn slope(stage: &Part, options: &AnalyzeOptions) -> Result<Interval, String> {
    let from = stage.time_s.partition_point(|t| *t < options.slope_from_s);
    let late = &stage.time_s[from..];
    if late.len() < 8 {
        return Err(format!(
            "{} readings after {:.0} min; a slope with an interval needs 8",
            late.len(),
            options.slope_from_s / 60.0
        ));
    }
    let curve = Curve::constant_load(
        "",
        late.iter().map(|t| t - late[0]).collect(),
        stage.strain[from..].to_vec(),
    );
    let fit = fit(
        Law::Line,
        &[curve],
        &FitOptions {
            level: options.level,
            seed: options.seed,
            ..FitOptions::default()
        },
    )
    .map_err(|error| error.to_string())?;
    fit.parameter("s")
        .map(|s| Interval {
            value: s.value,
            low: s.low,
            high: s.high,
        })
        .ok_or_else(|| "no slope".to_owned())
}

/// Mean and scatter of repeats.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Scatter {
    /// Group.
    pub group: String,
    /// Specimens.
    pub specimens: usize,
    /// Mean strain at the end, %.
    pub end_percent: f64,
    /// Standard deviation between specimens, %; `None` for one.
    pub end_deviation_percent: Option<f64>,
    /// Mean slope, %/h.
    pub slope_percent_per_h: Option<f64>,
    /// Standard deviation of the slope between specimens, %/h.
    pub slope_deviation: Option<f64>,
    /// Specimens whose end stands more than 3.5 robust deviations apart from their group.
    pub apart: Vec<String>,
}

/// Scatter of the specimens of each group, in the order of their first appearance.
pub fn scatter(analyses: &[(String, &Analysis)]) -> Vec<Scatter> {
    /// Iglewicz and Hoaglin, How to Detect and Handle Outliers, 1993.
    const APART: f64 = 3.5;
    let mut groups: Vec<(&str, Vec<&Analysis>)> = Vec::new();
    for (group, analysis) in analyses {
        match groups.iter_mut().find(|(name, _)| name == group) {
            Some((_, members)) => members.push(analysis),
            None => groups.push((group, vec![analysis])),
        }
    }
    let moments = |values: &[f64]| {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let deviation = (values.len() > 1)
            .then(|| (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt());
        (mean, deviation)
    };
    groups
        .into_iter()
        .map(|(group, members)| {
            let ends: Vec<f64> = members.iter().map(|a| a.end_percent).collect();
            let slopes: Vec<f64> = members
                .iter()
                .filter_map(|a| a.slope_percent_per_h.map(|s| s.value))
                .collect();
            let (end_percent, end_deviation_percent) = moments(&ends);
            let centre = median(&ends);
            let distance: Vec<f64> = ends.iter().map(|e| (e - centre).abs()).collect();
            let robust = 1.482_6 * median(&distance);
            Scatter {
                group: group.to_owned(),
                specimens: members.len(),
                end_percent,
                end_deviation_percent,
                slope_percent_per_h: (!slopes.is_empty()).then(|| moments(&slopes).0),
                slope_deviation: moments(&slopes).1.filter(|_| !slopes.is_empty()),
                apart: members
                    .iter()
                    .zip(&distance)
                    .filter(|(_, d)| members.len() >= 5 && robust > 0.0 && **d > APART * robust)
                    .map(|(a, _)| a.name.clone())
                    .collect(),
            }
        })
        .collect()
}
