//! Elongation of a cable in a session, and a step within it.

use super::blocks::blocks;
use super::learn::{CableBaseline, CableLoad, MIN_REVERSALS};
use super::regression::Lower;
use super::samples::CableSample;
use serde::{Deserialize, Serialize};
use sinew_model::cholesky::dot;
use sinew_model::offset::UNKNOWN_OFFSET_RAD;
use sinew_model::{Gaussian, Interval95};

/// Prior standard deviation of the size of a step, rad.
const STEP_RAD: f64 = 10e-3;
/// Logarithm of the likelihood ratio at which a step is reported. By Ville's inequality chance reaches it with a probability
/// of at most `e⁻⁸` for one onset, hence in at most 3 of 100 recordings with the 100 onsets of 20 s.
const ALARM: f64 = 8.0;
/// Prior odds of a step in a recording: as rare as a wrong statement of the user. Engineering estimate.
const STEP_ODDS: f64 = 1.0 / 20.0;
/// Load beyond the learned ones that is still covered, relative to the nearest of them.
const LOAD_MARGIN: f64 = 0.1;
/// Joint position beyond the learned range that is still covered, rad: half the length of the map.
const RANGE_MARGIN_RAD: f64 = 0.06;

/// Reason why the elongation of a tendon with friction along its path is inconclusive.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum CableLimit {
    /// No baseline with this joint.
    NoBaseline,
    /// Baseline with loads whose ratio is below two, which do not determine the compliance, and another load.
    OneLoad {
        /// Lowest and highest load of the baseline, N·m.
        learned_nm: [f64; 2],
        /// Load of the recording, N·m.
        load_nm: f64,
    },
    /// Load outside those of the baseline.
    Load {
        /// Lowest and highest load of the baseline, N·m.
        learned_nm: [f64; 2],
        /// Load of the recording, N·m.
        load_nm: f64,
    },
    /// Joint positions outside those of the baseline.
    Range {
        /// Lowest and highest position in the baseline, rad.
        learned_rad: [f64; 2],
        /// Lowest and highest position in the recording, rad.
        range_rad: [f64; 2],
    },
    /// Too few reversals to separate friction and elongation.
    Reversals {
        /// Number of reversals in the recording.
        reversals: usize,
    },
}

/// Step of the offset within a recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CableStep {
    /// Most probable time of the step since the start of the recording, s.
    pub time_s: f64,
    /// 95 % interval of that time, s.
    pub interval_s: Interval95,
    /// Time at which the likelihood ratio exceeded its limit, s: when a monitor would have reported the step.
    pub detected_s: f64,
    /// Size of the step, rad.
    pub size_rad: Gaussian,
    /// Posterior probability, 0 to 1.
    pub probability: f64,
}

/// Offset by one block alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CableTrace {
    /// Middle of the block since the start of the recording, s.
    pub time_s: f64,
    /// Measured minus expected deflection, rad.
    pub residual_rad: f64,
}

/// Result of a session of one joint.
#[derive(Debug, Clone, PartialEq)]
pub struct CableEstimate {
    /// Offset since the baseline at the end of the recording, rad.
    pub offset_rad: Gaussian,
    /// Part of its error from the baseline, which other sessions have too: standard deviation, rad.
    pub shared_std_rad: f64,
    /// Offset by each block alone, rad; empty where the friction along the path is unknown.
    pub trace: Vec<CableTrace>,
    /// Step within the recording; `None` if none was detected.
    pub step: Option<CableStep>,
    /// Reasons why the offset is inconclusive.
    pub limits: Vec<CableLimit>,
    /// Load and motion of the recording.
    pub load: CableLoad,
}

impl CableBaseline {
    /// Estimates the offset since the baseline from the samples of a recording.
    ///
    /// Returns `None` if the recording has no samples, or if the numbers of the baseline do not belong together.
    pub fn estimate(&self, samples: &[CableSample]) -> Option<CableEstimate> {
        let (model, shape, posterior) = self.model()?;
        let blocks = blocks(samples, shape);
        let n = blocks.len();
        let load = CableLoad::of(samples, self.width_rad)?;
        let equations = model.equations(&blocks);
        let own = equations.covariance.clone();
        let (residuals, covariance) = equations.predict(&posterior);
        let factor = Lower::of(&covariance, n)?;
        let times = Vec::from_iter(blocks.iter().map(|b| b.time_s));
        let whitened = Whitened {
            residual: factor.whiten(&residuals),
            offset: factor.whiten(&vec![1.0; n]),
            factor,
        };
        let step = whitened.step(&times);
        let column = step.map(|(_, at)| whitened.onset(at));
        let (offset_rad, _) = whitened.offset(column.as_deref());
        let trace = times.iter().zip(&residuals);
        let from_baseline = covariance.iter().zip(&own).map(|(whole, own)| whole - own);
        Some(CableEstimate {
            offset_rad,
            shared_std_rad: whitened.std_by(&Vec::from_iter(from_baseline)),
            trace: trace
                .map(|(time_s, residual_rad)| CableTrace {
                    time_s: *time_s,
                    residual_rad: *residual_rad,
                })
                .collect(),
            step: step.map(|(step, _)| step),
            limits: self.limits(load),
            load,
        })
    }

    /// Conditions of a recording that the baseline does not cover.
    fn limits(&self, load: CableLoad) -> Vec<CableLimit> {
        let mut out = Vec::new();
        let (learned_nm, load_nm) = (self.loads_nm(), load.torque_nm);
        let [low, high] = learned_nm;
        let is_outside =
            load_nm < low - LOAD_MARGIN * low.abs() || load_nm > high + LOAD_MARGIN * high.abs();
        match self.has_two_loads() {
            _ if !is_outside => {}
            true => out.push(CableLimit::Load {
                learned_nm,
                load_nm,
            }),
            false => out.push(CableLimit::OneLoad {
                learned_nm,
                load_nm,
            }),
        }
        let learned_rad = self.range_rad();
        if load.range_rad[0] < learned_rad[0] - RANGE_MARGIN_RAD
            || load.range_rad[1] > learned_rad[1] + RANGE_MARGIN_RAD
        {
            out.push(CableLimit::Range {
                learned_rad,
                range_rad: load.range_rad,
            });
        }
        if load.reversals < MIN_REVERSALS {
            out.push(CableLimit::Reversals {
                reversals: load.reversals,
            });
        }
        out
    }
}

/// Residuals and the column of the offset, whose errors are independent with variance one.
struct Whitened {
    residual: Vec<f64>,
    offset: Vec<f64>,
    factor: Lower,
}

impl Whitened {
    /// Column of a step whose onset is before block `at`.
    fn onset(&self, at: usize) -> Vec<f64> {
        let n = self.residual.len();
        let step = (0..n).map(|i| if i < at { 0.0 } else { 1.0 });
        self.factor.whiten(&Vec::from_iter(step))
    }

    /// Posterior of the offset at the end, and of the size of the step with this column.
    fn offset(&self, step: Option<&[f64]>) -> (Gaussian, Gaussian) {
        let (offset, residual) = (&self.offset, &self.residual);
        let a = dot(offset, offset) + UNKNOWN_OFFSET_RAD.powi(-2);
        let b = dot(offset, residual);
        let Some(step) = step else {
            return (Gaussian::new(b / a, a.powf(-0.5)), Gaussian::default());
        };
        // Normal equations of offset and step.
        let c = dot(step, step) + STEP_RAD.powi(-2);
        let d = dot(offset, step);
        let f = dot(step, residual);
        let determinant = a * c - d * d;
        let before_rad = (c * b - d * f) / determinant;
        let size_rad = (a * f - d * b) / determinant;
        let variance = (a + c - 2.0 * d) / determinant;
        (
            Gaussian::new(before_rad + size_rad, variance.sqrt()),
            Gaussian::new(size_rad, (a / determinant).sqrt()),
        )
    }

    /// Standard deviation of the offset by the part of the residuals' covariance that `covariance` contains, rad.
    fn std_by(&self, covariance: &[f64]) -> f64 {
        let information = dot(&self.offset, &self.offset) + UNKNOWN_OFFSET_RAD.powi(-2);
        let weights = self.factor.unwhiten(&self.offset);
        let rows = covariance.chunks_exact(weights.len().max(1));
        let rows = rows.zip(&weights);
        let variance: f64 = rows.map(|(row, weight)| weight * dot(row, &weights)).sum();
        variance.max(0.0).sqrt() / information
    }

    /// Sequential likelihood ratio of a step of unknown onset and size; returns the step with the block of its onset.
    ///
    /// Whitened residuals are innovations: each depends on the blocks up to its own only. The offset before the step is
    /// a parameter of both hypotheses.
    fn step(&self, times: &[f64]) -> Option<(CableStep, usize)> {
        let n = times.len();
        let mut detected = n;
        let mut at_end = Vec::with_capacity(n);
        for at in 1..n {
            let column = self.onset(at);
            let mut sums = Sums::default();
            for i in 0..n {
                sums.add(self.offset[i], column[i], self.residual[i]);
                if i >= at && sums.ln_ratio() > ALARM {
                    detected = detected.min(i);
                }
            }
            at_end.push(sums.ln_ratio());
        }
        let detected_s = *times.get(detected)?;
        let most = at_end.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let best = at_end.iter().position(|ln_ratio| *ln_ratio == most)?;
        let weights: Vec<f64> = at_end.iter().map(|l| (l - most).exp()).collect();
        let total: f64 = weights.iter().sum();
        let onset_s = |k: usize| 0.5 * (times[k] + times[k + 1]);
        let quantile = |share: f64| {
            let mut sum = 0.0;
            let at = weights.iter().position(|weight| {
                sum += weight / total;
                sum >= share
            });
            at.map_or(detected_s, onset_s)
        };
        // Ratio of the mean over all onsets, at which the logarithm may be large.
        let ln_odds = STEP_ODDS.ln() + most + (total / weights.len() as f64).ln();
        let column = self.onset(best + 1);
        let step = CableStep {
            time_s: onset_s(best),
            interval_s: Interval95 {
                low: quantile(0.025),
                high: quantile(0.975),
            },
            detected_s,
            size_rad: self.offset(Some(&column)).1,
            probability: 1.0 / (1.0 + (-ln_odds).exp()),
        };
        Some((step, best + 1))
    }
}

/// Running sums of the normal equations of offset and step.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    offset: f64,
    offset_residual: f64,
    offset_step: f64,
    step: f64,
    step_residual: f64,
}

impl Sums {
    fn add(&mut self, offset: f64, step: f64, residual: f64) {
        self.offset += offset * offset;
        self.offset_residual += offset * residual;
        self.offset_step += offset * step;
        self.step += step * step;
        self.step_residual += step * residual;
    }

    /// Logarithm of the likelihood ratio of a step with the prior `N(0, STEP_RAD²)` to none.
    fn ln_ratio(&self) -> f64 {
        let offset = self.offset + UNKNOWN_OFFSET_RAD.powi(-2);
        let information = self.step - self.offset_step.powi(2) / offset;
        let shift = self.step_residual - self.offset_step * self.offset_residual / offset;
        let gain = STEP_RAD.powi(2);
        // Rounding may make the information of a step without blocks negative.
        let scale = 1.0 + gain * information.max(0.0);
        0.5 * (gain * shift * shift / scale - scale.ln())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Innovations of variance one, with a step by `size_rad` before block `at`; the column of the offset is 1/noise.
    fn whitened(n: usize, noise_rad: f64, (at, size_rad): (usize, f64)) -> Whitened {
        let mut covariance = vec![0.0; n * n];
        for i in 0..n {
            covariance[i * n + i] = noise_rad * noise_rad;
        }
        let factor = Lower::of(&covariance, n).expect("diagonal");
        // Deterministic noise of one standard deviation.
        let residual = (0..n).map(|i| {
            let noise = if i % 2 == 0 { noise_rad } else { -noise_rad };
            noise + if i < at { 0.0 } else { size_rad }
        });
        let residual = Vec::from_iter(residual);
        Whitened {
            residual: factor.whiten(&residual),
            offset: factor.whiten(&vec![1.0; n]),
            factor,
        }
    }

    // Means of both parts, by the normal equations of independent measurements; the priors are wide.
    #[test]
    fn step_of_ten_noises_has_its_time_and_size() {
        let times: Vec<f64> = (0..40).map(f64::from).collect();
        let found = whitened(40, 1e-3, (20, 10e-3)).step(&times);
        let (step, at) = found.expect("a step");
        assert_eq!((at, step.time_s), (20, 19.5));
        assert!((step.size_rad.mean - 10e-3).abs() < 0.1e-3, "{step:?}");
        let std = 1e-3 * (2.0_f64 / 20.0).sqrt();
        assert!((step.size_rad.std / std - 1.0).abs() < 0.02, "{step:?}");
        assert!(step.detected_s <= 21.0 && step.probability > 0.99);
        assert!(step.interval_s.low <= 19.5 && step.interval_s.high >= 19.5);
        assert!(whitened(40, 1e-3, (40, 0.0)).step(&times).is_none());
        assert!(whitened(40, 1e-3, (20, 0.5e-3)).step(&times).is_none());
    }

    #[test]
    fn no_blocks_keep_prior_of_offset() {
        let nothing = whitened(0, 1.0, (0, 0.0));
        assert!(nothing.step(&[]).is_none());
        assert_eq!(nothing.offset(None).0.std, UNKNOWN_OFFSET_RAD);
        assert_eq!(nothing.std_by(&[]), 0.0);
    }
}
