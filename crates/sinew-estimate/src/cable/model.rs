//! The cable model as a linear Gaussian regression, given its shape and scales.

use super::blocks::{CableBlock, Shape};
use super::regression::{Lower, Posterior};
use serde::{Deserialize, Serialize};
use sinew_model::cholesky::dot;

/// Prior of the position and direction map, per direction: standard deviation, rad, and length, rad.
///
/// Eccentricity of pulleys, winding and encoder errors of cable-driven instruments repeat with 2 to 4 mrad over 0.1 rad.
const MAP: [f64; 2] = [3e-3, 0.12];
/// Prior of the map that both directions have in common: standard deviation, rad, and length, rad.
const COMMON_MAP: [f64; 2] = [8e-3, 0.5];
/// Standard deviation of the map of one session, rad, at the length of [`MAP`].
const SESSION_MAP_RAD: f64 = 3.5e-3;
/// Standard deviation of the offset of one session that is not an elongation, rad: seating of the rope on its pulleys.
const SESSION_OFFSET_RAD: f64 = 2.5e-3;
/// Standard deviation of the friction in one session, relative to that of the baseline.
const SESSION_FRICTION_RATIO: f64 = 0.15;
/// Standard deviation of the correlated residual, rad.
pub(super) const NOISE_RAD: f64 = 1.5e-3;
/// Correlation time of the residual, s.
const NOISE_S: f64 = 0.3;
/// Standard deviation of the independent residual of a block, rad.
const WHITE_NOISE_RAD: f64 = 0.5e-3;
/// Standard deviation of the encoder zero that the baseline defines as offset zero, rad: any.
const ZERO_RAD: f64 = 10.0;
/// Standard deviation of the ratio between motor and joint, relative: tolerance of drum and pulley diameters.
const RATIO: f64 = 0.05;
/// Distance of the nodes of a map relative to its length: a squared exponential process is then interpolated with an
/// error below 1 % of its standard deviation.
const NODE_DISTANCE: f64 = 0.6;
/// Variance relative to one that is added to the covariance of the nodes, so that its factor exists after rounding.
const NODE_JITTER: f64 = 1e-6;

/// Number of parameters before those of the maps.
const SCALARS: usize = 7;
/// Index of the compliance among them.
pub(super) const COMPLIANCE: usize = 2;
/// Standard deviation of the compliance at high torque, relative to nominal: nominal values of cables in bends are known
/// to a factor of 1.5.
pub(super) const COMPLIANCE_RATIO: f64 = 0.5;

/// Prior of the physical parameters of a joint, from robot.toml.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CablePrior {
    /// Compliance at high torque, rad/(N·m): inverse of the nominal stiffness.
    pub compliance_rad_per_nm: f64,
    /// Friction of the drive, N·m at the joint.
    pub drive_friction_nm: f64,
}

impl CablePrior {
    /// Prior mean of the friction state's amplitude at zero torque, rad: friction spread evenly along the path winds up
    /// half of it, and half of that lies between joint and the centre of the compliance.
    pub(super) fn amplitude_rad(self) -> f64 {
        0.25 * self.compliance_rad_per_nm * self.drive_friction_nm
    }

    /// Means and standard deviations of the scalar parameters: zero, ratio, compliance, toe, amplitude, its increase with
    /// the torque, and the compliance for changes of the torque within a recording.
    fn scalars(self) -> [[f64; 2]; SCALARS] {
        let c = self.compliance_rad_per_nm;
        let amplitude = self.amplitude_rad();
        [
            [0.0, ZERO_RAD],
            [0.0, RATIO],
            [c, COMPLIANCE_RATIO * c],
            [0.4 * c, 0.8 * c],
            [amplitude, 0.75 * amplitude],
            [0.1, 0.15],
            [c, c],
        ]
    }

    /// Grid of the shapes.
    pub(super) fn shapes(self) -> Vec<Shape> {
        /// Torques of the toe relative to the friction of the drive.
        const TOES: [f64; 3] = [0.15, 0.3, 0.6];
        /// Widths relative to the prior mean of the amplitude: geometric from 1 to 2.8.
        const WIDTHS: [f64; 4] = [1.0, 1.4, 2.0, 2.8];
        let widths = WIDTHS.map(|w| w * self.amplitude_rad());
        let pairs = TOES.iter().flat_map(|toe| widths.map(|w| (*toe, w)));
        let shapes = pairs.map(|(toe, width_rad)| Shape {
            toe_nm: toe * self.drive_friction_nm,
            width_rad,
        });
        shapes.collect()
    }
}

/// Nodes of a map, whose values are transformed to independent ones.
#[derive(Debug, Clone, PartialEq)]
struct Nodes {
    at: Vec<f64>,
    length_rad: f64,
    factor: Option<Lower>,
}

impl Nodes {
    /// Nodes for a range of joint positions and one length beyond.
    fn new([low, high]: [f64; 2], length_rad: f64) -> Self {
        let step = NODE_DISTANCE * length_rad;
        let count = ((high - low + 2.0 * length_rad) / step).ceil() as usize + 1;
        let middle = 0.5 * (low + high) - 0.5 * step * (count as f64 - 1.0);
        let at: Vec<f64> = (0..count).map(|i| middle + step * i as f64).collect();
        let mut covariance: Vec<f64> = (at.iter())
            .flat_map(|a| at.iter().map(move |b| kernel(a - b, length_rad)))
            .collect();
        for i in 0..count {
            covariance[i * count + i] += NODE_JITTER;
        }
        let factor = Lower::of(&covariance, count);
        Self {
            at,
            length_rad,
            factor,
        }
    }

    /// Values at a position of the functions that belong to independent standard normal weights.
    fn basis(&self, q_rad: f64) -> Vec<f64> {
        let values = self.at.iter().map(|a| kernel(q_rad - a, self.length_rad));
        let values: Vec<f64> = values.collect();
        match &self.factor {
            Some(factor) => factor.whiten(&values),
            None => values,
        }
    }
}

/// Squared exponential covariance function of unit variance.
fn kernel(distance_rad: f64, length_rad: f64) -> f64 {
    (-0.5 * (distance_rad / length_rad).powi(2)).exp()
}

/// Scales that the baseline determines by their evidence.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Scales {
    /// Scale of the map of all sessions.
    pub(super) map: f64,
    /// Scale of the map of one session and of the noise.
    pub(super) noise: f64,
}

/// The model of one joint.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Model {
    pub(super) prior: CablePrior,
    pub(super) scales: Scales,
    /// Whether torques within a recording act with a coefficient of their own, because one load does not determine the
    /// compliance.
    pub(super) is_split: bool,
    centre_rad: f64,
    common: Nodes,
    directed: Nodes,
}

/// A recording as measurements of the regression.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Equations {
    /// Columns of `Φ` for the standardised parameters, rad.
    pub(super) columns: Vec<Vec<f64>>,
    /// Covariance of the errors and of the recording's own parameters, row-major, rad².
    pub(super) covariance: Vec<f64>,
    /// Measured minus expected values, rad.
    pub(super) y: Vec<f64>,
}

impl Model {
    /// Model for joint positions in a range.
    pub(super) fn new(
        prior: CablePrior,
        scales: Scales,
        is_split: bool,
        range_rad: [f64; 2],
    ) -> Self {
        Self {
            prior,
            scales,
            is_split,
            centre_rad: 0.5 * (range_rad[0] + range_rad[1]),
            common: Nodes::new(range_rad, COMMON_MAP[1]),
            directed: Nodes::new(range_rad, MAP[1]),
        }
    }

    /// Number of standardised parameters.
    pub(super) fn parameters(&self) -> usize {
        SCALARS + self.common.at.len() + 2 * self.directed.at.len()
    }

    /// Measurements of a recording.
    pub(super) fn equations(&self, blocks: &[CableBlock]) -> Equations {
        let scalars = self.prior.scalars();
        let mut columns = vec![Vec::with_capacity(blocks.len()); self.parameters()];
        let mut y = Vec::with_capacity(blocks.len());
        let mean = |of: &dyn Fn(&CableBlock) -> f64| {
            blocks.iter().map(of).sum::<f64>() / blocks.len() as f64
        };
        let means = [mean(&|b| b.torque_nm), mean(&|b| b.toe_nm)];
        for block in blocks {
            let [torque, toe, rest] = match self.is_split {
                true => [means[0], means[1], block.torque_nm - means[0]],
                false => [block.torque_nm, block.toe_nm, 0.0],
            };
            let features = [
                1.0,
                block.q_rad - self.centre_rad,
                torque,
                toe,
                block.z,
                block.torque_z_nm,
                rest,
            ];
            let expected: f64 = features.iter().zip(&scalars).map(|(x, s)| x * s[0]).sum();
            y.push(block.y_rad - expected);
            let [up, down] = directions(block);
            let map = self.scales.map;
            let directed = self.directed.basis(block.q_rad);
            let scaled = (features.iter().zip(&scalars)).map(|(x, s)| x * s[1]);
            let common = self.common.basis(block.q_rad).into_iter();
            let scaled = scaled.chain(common.map(|x| map * COMMON_MAP[0] * x));
            let scaled = scaled.chain(directed.iter().map(|x| map * MAP[0] * up * x));
            let scaled = scaled.chain(directed.iter().map(|x| map * MAP[0] * down * x));
            for (column, value) in columns.iter_mut().zip(scaled) {
                column.push(value);
            }
        }
        Equations {
            columns,
            covariance: self.covariance(blocks),
            y,
        }
    }

    /// Covariance of the residuals of a recording, and of its own offset, map and friction, rad².
    fn covariance(&self, blocks: &[CableBlock]) -> Vec<f64> {
        let noise = self.scales.noise.powi(2);
        let friction = (SESSION_FRICTION_RATIO * self.prior.amplitude_rad()).powi(2);
        let mut out = Vec::with_capacity(blocks.len().pow(2));
        for (i, a) in blocks.iter().enumerate() {
            let [a_up, a_down] = directions(a);
            for (k, b) in blocks.iter().enumerate() {
                let [b_up, b_down] = directions(b);
                let correlated = (-(a.time_s - b.time_s).abs() / NOISE_S).exp();
                let same = kernel(a.q_rad - b.q_rad, MAP[1]) * (a_up * b_up + a_down * b_down);
                let white = if i == k { WHITE_NOISE_RAD.powi(2) } else { 0.0 };
                let residual = NOISE_RAD.powi(2) * correlated + white;
                let map = SESSION_MAP_RAD.powi(2) * same;
                out.push(
                    noise * (residual + map) + SESSION_OFFSET_RAD.powi(2) + friction * a.z * b.z,
                );
            }
        }
        out
    }
}

/// Weights of the maps of both directions: the friction state blends one into the other.
fn directions(block: &CableBlock) -> [f64; 2] {
    [0.5 * (1.0 + block.z), 0.5 * (1.0 - block.z)]
}

impl Equations {
    /// Predictive distribution of the measurements given the posterior of a baseline: residuals, rad, and covariance,
    /// row-major, rad².
    pub(super) fn predict(self, posterior: &Posterior) -> (Vec<f64>, Vec<f64>) {
        let n = self.y.len();
        let mut residuals = self.y;
        for (column, mean) in self.columns.iter().zip(&posterior.mean) {
            for (residual, x) in residuals.iter_mut().zip(column) {
                *residual -= mean * x;
            }
        }
        let parameters = self.columns.len();
        let rows: Vec<Vec<f64>> = (0..n)
            .map(|i| self.columns.iter().map(|c| c[i]).collect())
            .collect();
        let spread: Vec<Vec<f64>> = (rows.iter())
            .map(|row| {
                let s = posterior.covariance.chunks_exact(parameters);
                s.map(|s| dot(s, row)).collect()
            })
            .collect();
        let mut covariance = self.covariance;
        for (i, spread) in spread.iter().enumerate() {
            for (k, row) in rows.iter().enumerate() {
                covariance[i * n + k] += dot(spread, row);
            }
        }
        (residuals, covariance)
    }
}
