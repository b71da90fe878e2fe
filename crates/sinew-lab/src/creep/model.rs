//! Several curves under one law: the columns of the linear problem for given shapes.

use super::curve::Curve;
use super::law::{Law, Shape};
use super::linear::{self, Solution};
use super::noise::{Filter, Noise, SHARE_MAX};

/// Gas constant, J/(mol K), exact since 2019.
const GAS: f64 = 8.314_462_618_153_24;
/// Reference of the temperature shift, K: 23 °C, the standard atmosphere of ISO 291.
pub const REFERENCE_K: f64 = 296.15;
/// 0 °C in K.
const ZERO_C_K: f64 = 273.15;

/// Which parameters curves have in common.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Share {
    /// All but the strain at time 0: one material, repeated tests.
    #[default]
    All,
    /// The shape only; every specimen has its own amplitudes.
    Shape,
}

/// What is assumed of the readings' errors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum NoiseKind {
    /// Independent plus slow errors, their share and memory fitted.
    #[default]
    Correlated,
    /// Independent.
    White,
}

/// A law on curves.
#[derive(Debug, Clone)]
pub(super) struct Model {
    pub(super) law: Law,
    pub(super) curves: Vec<Curve>,
    /// Law's shapes, then the load exponent and activation energy where fitted.
    pub(super) shapes: Vec<Shape>,
    law_shapes: usize,
    exponent: Option<usize>,
    activation: Option<usize>,
    pub(super) noise: NoiseKind,
    pub(super) memory: Shape,
    /// Curves with coefficients in common.
    pub(super) blocks: Vec<Block>,
    /// Strain is divided by this, so that residuals are of order one.
    pub(super) scale: f64,
    pub(super) readings: usize,
}

/// Curves with coefficients in common: the terms, the elastic step where a load falls, and an ε₀
/// per curve.
#[derive(Debug, Clone)]
pub(super) struct Block {
    pub(super) members: Vec<usize>,
    pub(super) elastic: bool,
    pub(super) positive: Vec<bool>,
    pub(super) readings: usize,
}

/// Solution at one place of the nonlinear parameters.
pub(super) struct Point {
    pub(super) noise: Noise,
    pub(super) solutions: Vec<Solution>,
    pub(super) squares: f64,
    pub(super) log_det_noise: f64,
    /// ln |XᵀK⁻¹X| − ln |XᵀX|.
    pub(super) log_det_information: f64,
    /// Whitened residuals.
    pub(super) residuals: Vec<f64>,
}

impl Model {
    pub(super) fn new(law: Law, curves: Vec<Curve>, share: Share, noise: NoiseKind) -> Self {
        let since = |curve: &Curve| -> (f64, f64) {
            let start = curve.steps.first().map_or(0.0, |step| step.0);
            let first = curve
                .time_s
                .iter()
                .map(|t| t - start)
                .find(|t| *t > 0.0)
                .unwrap_or(1.0);
            let last = curve.time_s.last().map_or(1.0, |t| t - start);
            (first, last.max(first))
        };
        let short = curves
            .iter()
            .map(|c| since(c).0)
            .fold(f64::INFINITY, f64::min);
        let long = curves.iter().map(|c| since(c).1).fold(0.0, f64::max);
        let mut shapes = law.shapes(short.max(1e-6 * long), long);
        let law_shapes = shapes.len();
        let mut add = |wanted: bool, name, unit, lower, upper| {
            wanted.then(|| {
                shapes.push(Shape {
                    name,
                    unit,
                    logarithmic: false,
                    lower,
                    upper,
                });
                shapes.len() - 1
            })
        };
        let levels = |curves: &[Curve]| -> f64 {
            let loads = || {
                curves
                    .iter()
                    .flat_map(|c| c.steps.iter().map(|s| s.1))
                    .filter(|l| *l > 0.05)
            };
            loads().fold(0.0, f64::max) / loads().fold(f64::INFINITY, f64::min)
        };
        // One block: a second load or temperature says what one can't.
        let joint = share == Share::All;
        let exponent = add(joint && levels(&curves) > 1.1, "p", "", 0.3, 3.0);
        let warm = curves.iter().filter_map(|c| c.temperature_c);
        let span = warm.clone().fold(f64::NEG_INFINITY, f64::max)
            - warm.clone().fold(f64::INFINITY, f64::min);
        let activation = add(
            warm.count() == curves.len() && span > 3.0,
            "E",
            "kJ/mol",
            -100.0,
            400.0,
        );
        let mut gaps: Vec<f64> = curves
            .iter()
            .flat_map(|c| c.time_s.windows(2).map(|w| w[1] - w[0]))
            .filter(|gap| *gap > 0.0)
            .collect();
        gaps.sort_by(f64::total_cmp);
        let gap = gaps.get(gaps.len() / 2).copied().unwrap_or(1.0);
        let memory = Shape {
            name: "tau_c",
            unit: "s",
            logarithmic: true,
            lower: gap.min(0.3 * long),
            upper: long,
        };
        let of = |members: Vec<usize>| {
            let elastic = members.iter().any(|&m| curves[m].unloads())
                || (members.len() > 1 && exponent.is_some());
            let mut positive: Vec<bool> = law.terms().iter().map(|t| t.positive).collect();
            if elastic {
                positive.push(true);
            }
            positive.resize(positive.len() + members.len(), false);
            Block {
                elastic,
                positive,
                readings: members.iter().map(|&m| curves[m].time_s.len()).sum(),
                members,
            }
        };
        let blocks = match share {
            Share::All => vec![of((0..curves.len()).collect())],
            Share::Shape => (0..curves.len()).map(|m| of(vec![m])).collect(),
        };
        let scale = curves
            .iter()
            .map(|c| {
                let most = c.strain.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                let least = c.strain.iter().copied().fold(f64::INFINITY, f64::min);
                most - least
            })
            .fold(f64::MIN_POSITIVE, f64::max);
        let readings = curves.iter().map(|c| c.time_s.len()).sum();
        Self {
            law,
            curves,
            shapes,
            law_shapes,
            exponent,
            activation,
            noise,
            memory,
            blocks,
            scale,
            readings,
        }
    }

    /// Nonlinear parameters: shapes, then share and memory of the noise.
    pub(super) fn dimension(&self) -> usize {
        self.shapes.len() + if self.noise == NoiseKind::White { 0 } else { 2 }
    }

    /// Coefficients that enter linearly.
    pub(super) fn coefficients(&self) -> usize {
        self.blocks.iter().map(|b| b.positive.len()).sum()
    }

    pub(super) fn values(&self, x: &[f64]) -> Vec<f64> {
        self.shapes
            .iter()
            .zip(x)
            .map(|(s, x)| s.value(*x))
            .collect()
    }

    pub(super) fn noise_at(&self, x: &[f64]) -> Noise {
        match self.noise {
            NoiseKind::White => Noise::WHITE,
            NoiseKind::Correlated => Noise {
                share: x[self.shapes.len()] * SHARE_MAX,
                memory_s: self.memory.value(x[self.shapes.len() + 1]),
            },
        }
    }

    /// One row of a curve's columns: terms, elastic step; without the ε₀.
    pub(super) fn row(&self, values: &[f64], curve: &Curve, t: f64, out: &mut [f64]) {
        let terms = self.law.terms().len();
        out.fill(0.0);
        let mut response = [0.0; 4];
        let response = &mut response[..terms];
        let shift = match (self.activation, curve.temperature_c) {
            (Some(index), Some(celsius)) => {
                (values[index] * 1e3 / GAS * (1.0 / REFERENCE_K - 1.0 / (celsius + ZERO_C_K))).exp()
            }
            _ => 1.0,
        };
        let power = self.exponent.map_or(1.0, |index| values[index]);
        let level = |load: f64| {
            if power == 1.0 {
                load
            } else {
                load.signum() * load.abs().powf(power)
            }
        };
        let mut before = 0.0;
        for &(start, load) in &curve.steps {
            if start > t {
                break;
            }
            let now = level(load);
            self.law
                .respond(&values[..self.law_shapes], (t - start) * shift, response);
            for (out, r) in out.iter_mut().zip(response.iter()) {
                *out += (now - before) * r;
            }
            if out.len() > terms {
                out[terms] += now - before;
            }
            before = now;
        }
    }

    fn columns(&self, block: &Block, values: &[f64]) -> Vec<f64> {
        let (n, p) = (block.readings, block.positive.len());
        let shared = p - block.members.len();
        let mut columns = vec![0.0; n * p];
        let mut row = [0.0; 8];
        let mut at = 0;
        for (place, &member) in block.members.iter().enumerate() {
            let curve = &self.curves[member];
            for &t in &curve.time_s {
                self.row(values, curve, t, &mut row[..shared]);
                for j in 0..shared {
                    columns[j * n + at] = row[j];
                }
                columns[(shared + place) * n + at] = 1.0;
                at += 1;
            }
        }
        columns
    }

    /// Solves the linear problem at a place of the nonlinear parameters.
    pub(super) fn solve(&self, x: &[f64], information: bool) -> Point {
        let values = self.values(x);
        let noise = self.noise_at(x);
        let mut point = Point {
            noise,
            solutions: Vec::with_capacity(self.blocks.len()),
            squares: 0.0,
            log_det_noise: 0.0,
            log_det_information: 0.0,
            residuals: Vec::with_capacity(self.readings),
        };
        let mut filter = Filter::default();
        for block in &self.blocks {
            let (n, p) = (block.readings, block.positive.len());
            let mut columns = self.columns(block, &values);
            if information {
                point.log_det_information -= linear::log_det(&mut columns.clone(), n, p);
            }
            let mut y: Vec<f64> = Vec::with_capacity(n);
            for &member in &block.members {
                y.extend(self.curves[member].strain.iter().map(|e| e / self.scale));
            }
            let mut at = 0;
            for &member in &block.members {
                let curve = &self.curves[member];
                let end = at + curve.time_s.len();
                filter.prepare(&curve.time_s, &curve.count, noise);
                point.log_det_noise += filter.log_det;
                filter.whiten(&mut y[at..end]);
                for j in 0..p {
                    filter.whiten(&mut columns[j * n + at..j * n + end]);
                }
                at = end;
            }
            let (whitened, target) = (columns.clone(), y.clone());
            let solution = linear::solve(&mut columns, &mut y, &block.positive);
            for i in 0..n {
                let fitted: f64 = (0..p).map(|j| whitened[j * n + i] * solution.beta[j]).sum();
                point.residuals.push(target[i] - fitted);
            }
            point.squares += solution.squares;
            point.log_det_information += solution.log_det;
            point.solutions.push(solution);
        }
        point
    }

    /// Residuals whose squares have their minimum where the likelihood has its maximum:
    /// `r̃ |K|^{1/2n}`, since `n ln(r̃ᵀr̃) + ln |K| = n ln(r̃ᵀr̃ |K|^{1/n})`.
    pub(super) fn likelihood_residuals(&self, x: &[f64]) -> Vec<f64> {
        let point = self.solve(x, false);
        let factor = (0.5 * point.log_det_noise / self.readings as f64).exp();
        point.residuals.iter().map(|r| r * factor).collect()
    }

    /// Logarithm of the likelihood with the coefficients and the size of the noise integrated
    /// out (restricted likelihood), flat in the places of the nonlinear parameters.
    pub(super) fn log_restricted(&self, x: &[f64]) -> f64 {
        if x.iter().any(|x| !(0.0..=1.0).contains(x)) {
            return f64::NEG_INFINITY;
        }
        let point = self.solve(x, true);
        let free = self.readings.saturating_sub(self.coefficients()).max(1) as f64;
        let value = -0.5
            * (point.log_det_noise
                + point.log_det_information
                + free * point.squares.max(f64::MIN_POSITIVE).ln());
        if value.is_nan() {
            f64::NEG_INFINITY
        } else {
            value
        }
    }
}
