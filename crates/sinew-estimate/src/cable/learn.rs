//! Baseline of a cable: posterior of its parameters from recordings directly after tensioning.

use super::blocks::{Shape, blocks};
use super::model::{COMPLIANCE, COMPLIANCE_RATIO, CablePrior, Model, NOISE_RAD, Scales};
use super::regression::{Information, Posterior};
use super::samples::CableSample;
use serde::{Deserialize, Serialize};
use sinew_log::{MotorRatio, RatioSums};
use sinew_model::Gaussian;

/// Scales of the grid: half an order of magnitude in steps of a factor of 1.5.
const SCALES: [f64; 4] = [1.0, 1.5, 2.2, 3.2];
/// Minimum number of reversals of the friction state in a recording: fewer show one direction only.
pub(crate) const MIN_REVERSALS: usize = 2;
/// Minimum ratio of two loads that determine a compliance.
pub(super) const MIN_LOAD_RATIO: f64 = 2.0;

/// Number of reversals in samples after which all friction along the path has reversed, for the narrowest width of the grid.
pub(crate) fn reversals(prior: CablePrior, samples: &[CableSample]) -> usize {
    let load = CableLoad::of(samples, prior.amplitude_rad());
    load.map_or(0, |load| load.reversals)
}

/// Ratio of the motor of a joint if it is constant and not near one: a wrong unit, gear ratio or sign.
pub(crate) fn motor_ratio(joint: &str, samples: &[CableSample]) -> Option<MotorRatio> {
    let mut sums = RatioSums::default();
    for sample in samples {
        sums.push(sample.q_rad, sample.theta_rad);
    }
    sums.implausible(joint, f64::INFINITY)
}

/// Load and motion of one recording.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CableLoad {
    /// Mean torque of the tendon at the joint, N·m.
    pub torque_nm: f64,
    /// Range of the joint's position, rad.
    pub range_rad: [f64; 2],
    /// Number of reversals after which the motor moved on until all friction along the path had reversed.
    pub reversals: usize,
}

impl CableLoad {
    /// Load and motion of samples; `None` without samples.
    pub(super) fn of(samples: &[CableSample], width_rad: f64) -> Option<Self> {
        let count = samples.len() as f64;
        samples.first()?;
        let torque = samples.iter().map(|s| s.torque_nm).sum::<f64>() / count;
        let positions = samples.iter().map(|s| s.q_rad);
        let low = positions.clone().fold(f64::INFINITY, f64::min);
        let high = positions.fold(f64::NEG_INFINITY, f64::max);
        let shape = Shape {
            toe_nm: 1.0,
            width_rad,
        };
        let mut side = 0.0_f64;
        let mut reversals = 0;
        for block in blocks(samples, shape) {
            // At the limit for the whole block.
            if block.z.abs() == 1.0 && block.z != side {
                reversals += usize::from(side != 0.0);
                side = block.z;
            }
        }
        Some(Self {
            torque_nm: torque,
            range_rad: [low, high],
            reversals,
        })
    }
}

/// Part of a baseline: parameters of a joint whose tendon has friction along its path.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CableBaseline {
    /// Name of the joint.
    pub joint: String,
    /// Prior from robot.toml with which the posterior was estimated.
    pub prior: CablePrior,
    /// Torque at which the toe has decayed to 1/e, N·m.
    pub toe_nm: f64,
    /// Motor travel that winds up half the friction along the path, rad.
    pub width_rad: f64,
    /// Scale of the position and direction map, relative to its prior.
    pub map_scale: f64,
    /// Scale of the residual and of the map of one session, relative to their priors.
    pub noise_scale: f64,
    /// Loads and motions of the recordings.
    pub loads: Vec<CableLoad>,
    /// Posterior mean of the standardised parameters.
    pub mean: Vec<f64>,
    /// Lower triangle of their covariance, row by row.
    pub covariance_lower: Vec<f64>,
}

impl CableBaseline {
    /// Estimates the parameters of a joint from the samples of each recording.
    ///
    /// Returns `None` if no recording contains a motion of twice the width in one direction.
    pub fn learn(joint: &str, prior: CablePrior, recordings: &[&[CableSample]]) -> Option<Self> {
        let shapes = prior.shapes();
        let scales = SCALES.iter();
        let scales = scales.flat_map(|map| SCALES.map(|noise| Scales { map: *map, noise }));
        let scales: Vec<Scales> = scales.collect();
        let narrow = shapes.first()?.width_rad;
        let loads = recordings.iter().map(|s| CableLoad::of(s, narrow));
        let loads = loads.collect::<Option<Vec<CableLoad>>>()?;
        let is_split = !has_two_loads(&loads);
        // Evidences are comparable for the same blocks only: those that are known for each width.
        let shapes: Vec<Shape> = (shapes.into_iter())
            .filter(|shape| recordings.iter().all(|s| state_from_s(s, *shape).is_some()))
            .collect();
        let from_s = |samples: &[CableSample]| {
            let of_shapes = shapes.iter();
            let of_shapes = of_shapes.filter_map(|shape| state_from_s(samples, *shape));
            of_shapes.fold(f64::NEG_INFINITY, f64::max)
        };
        let starts_s: Vec<f64> = recordings.iter().map(|s| from_s(s)).collect();
        let fit = |shape: Shape, scales: Scales| -> Option<Information> {
            let model = Model::new(prior, scales, is_split, range(&loads));
            let mut information = Information::new(model.parameters());
            for (samples, from_s) in recordings.iter().zip(&starts_s) {
                let mut blocks = blocks(samples, shape);
                blocks.retain(|block| block.time_s >= *from_s);
                let measured = model.equations(&blocks);
                information.add(&measured.columns, &measured.covariance, &measured.y)?;
            }
            Some(information)
        };
        // One coordinate at a time: shapes with the scales before, then scales with the shape before.
        let mut best = (*shapes.first()?, *scales.first()?, f64::NEG_INFINITY);
        loop {
            let before = best.2;
            for shape in &shapes {
                let found = fit(*shape, best.1)?.ln_evidence()?;
                if found > best.2 {
                    best = (*shape, best.1, found);
                }
            }
            for scales in &scales {
                let found = fit(best.0, *scales)?.ln_evidence()?;
                if found > best.2 {
                    best = (best.0, *scales, found);
                }
            }
            // The evidence increases in every turn, on a finite grid.
            if !(best.2 > before) {
                break;
            }
        }
        let (shape, scales, _) = best;
        let posterior = fit(shape, scales)?.posterior()?;
        let n = posterior.mean.len();
        let rows = posterior.covariance.chunks_exact(n).enumerate();
        let lower = rows.flat_map(|(i, row)| row[..=i].to_vec()).collect();
        Some(Self {
            joint: joint.to_owned(),
            prior,
            toe_nm: shape.toe_nm,
            width_rad: shape.width_rad,
            map_scale: scales.map,
            noise_scale: scales.noise,
            loads,
            mean: posterior.mean,
            covariance_lower: lower,
        })
    }

    /// All numbers of the posterior, which are finite in a valid file.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = f64> + '_ {
        let posterior = self.mean.iter().chain(&self.covariance_lower);
        let loads = self.loads.iter();
        let loads = loads.flat_map(|l| [l.torque_nm, l.range_rad[0], l.range_rad[1]]);
        let shape = [
            self.toe_nm,
            self.width_rad,
            self.map_scale,
            self.noise_scale,
        ];
        posterior.copied().chain(loads).chain(shape)
    }

    /// Compliance relative to nominal, minus one.
    pub fn compliance_change(&self) -> Gaussian {
        let at = COMPLIANCE;
        let mean = self.mean.get(at).copied().unwrap_or(0.0);
        let diagonal = at * (at + 3) / 2;
        let variance = self.covariance_lower.get(diagonal).copied().unwrap_or(1.0);
        Gaussian::new(mean, variance.sqrt()).scaled(COMPLIANCE_RATIO)
    }

    /// Standard deviation of the residual of a block, rad.
    pub fn noise_rad(&self) -> f64 {
        self.noise_scale * NOISE_RAD
    }

    /// Lowest and highest load, N·m.
    pub fn loads_nm(&self) -> [f64; 2] {
        let loads = self.loads.iter().map(|l| l.torque_nm);
        [
            loads.clone().fold(f64::INFINITY, f64::min),
            loads.fold(f64::NEG_INFINITY, f64::max),
        ]
    }

    /// Range of the joint's position in all recordings, rad.
    pub fn range_rad(&self) -> [f64; 2] {
        range(&self.loads)
    }

    /// Whether the recordings determine the compliance: two loads of the same direction whose ratio is at least two, or
    /// loads in both directions.
    pub fn has_two_loads(&self) -> bool {
        has_two_loads(&self.loads)
    }

    /// Model and posterior; `None` if the numbers do not belong together.
    pub(super) fn model(&self) -> Option<(Model, Shape, Posterior)> {
        let scales = Scales {
            map: self.map_scale,
            noise: self.noise_scale,
        };
        let model = Model::new(self.prior, scales, !self.has_two_loads(), self.range_rad());
        let n = model.parameters();
        if self.mean.len() != n || self.covariance_lower.len() != n * (n + 1) / 2 {
            return None;
        }
        let mut covariance = vec![0.0; n * n];
        let mut entries = self.covariance_lower.iter();
        for i in 0..n {
            for (k, value) in (0..=i).zip(entries.by_ref()) {
                covariance[i * n + k] = *value;
                covariance[k * n + i] = *value;
            }
        }
        let shape = Shape {
            toe_nm: self.toe_nm,
            width_rad: self.width_rad,
        };
        let mean = self.mean.clone();
        Some((model, shape, Posterior { mean, covariance }))
    }
}

/// Time of the first block with a known state, s.
fn state_from_s(samples: &[CableSample], shape: Shape) -> Option<f64> {
    Some(blocks(samples, shape).first()?.time_s)
}

fn has_two_loads(loads: &[CableLoad]) -> bool {
    let torques = loads.iter().map(|l| l.torque_nm);
    let least = torques.clone().map(f64::abs).fold(f64::INFINITY, f64::min);
    let most = torques.clone().map(f64::abs).fold(0.0, f64::max);
    let is_mixed = torques.clone().any(|t| t > 0.0) && torques.clone().any(|t| t < 0.0);
    is_mixed || most >= MIN_LOAD_RATIO * least
}

fn range(loads: &[CableLoad]) -> [f64; 2] {
    let ranges = loads.iter().map(|l| l.range_rad);
    ranges.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], r| {
        [low.min(r[0]), high.max(r[1])]
    })
}
