//! Several curves under one law: columns of the linear problem for given shapes.

mod evaluate;
mod records;

use crate::curve::Curve;
use crate::error::CreepError;
use crate::law::{Law, Shape, Term};
use crate::linear::Solution;
use crate::noise::{Clock, Noise, SHARE_MAX};
use crate::options::{FitOptions, NoiseKind, Share};
use crate::rope_law::RopePlan;
use crate::span::extremes;
use std::borrow::Cow;

use records::{add_zero, levels, span, temperatures_differ, typical_gap};

/// Reference of the temperature shift, K: 23 °C, the standard atmosphere of ISO 291.
pub const REFERENCE_K: f64 = 296.15;

/// Creep law applied to curves.
#[derive(Debug, Clone)]
pub(crate) struct Model {
    pub(crate) law: Law,
    pub(crate) curves: Vec<Curve>,
    /// Shapes of the law, then the load exponent and activation energy if fitted.
    pub(crate) shapes: Vec<Shape>,
    pub(crate) terms: Vec<Term>,
    /// Data of the rope law.
    pub(crate) rope: Option<RopePlan>,
    /// Deviations of the rope law's fixed parameters from the base rope's values, in standard
    /// deviations.
    pub(crate) held_z: Vec<f64>,
    pub(crate) law_shapes: usize,
    pub(crate) exponent: Option<usize>,
    pub(crate) activation: Option<usize>,
    /// Steps whose time is searched: the last shapes, in this order.
    pub(crate) moments: Vec<Moment>,
    pub(crate) noise: NoiseKind,
    pub(crate) memory: Shape,
    pub(crate) clock: Clock,
    /// Clock values at the measurements of every curve.
    pub(crate) clocks: Vec<Vec<f64>>,
    /// Curves with common coefficients.
    pub(crate) blocks: Vec<Block>,
    /// Divisor of the strain, so that residuals are of order one.
    pub(crate) scale: f64,
    pub(crate) readings: usize,
}

/// Step whose time between two measurements is searched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Moment {
    pub(crate) curve: usize,
    pub(crate) step: usize,
    /// Index of the shape.
    pub(crate) shape: usize,
}

/// Curves with common coefficients: the terms, the elastic step if a load decreases, and an ε₀ per
/// curve.
#[derive(Debug, Clone)]
pub(crate) struct Block {
    pub(crate) members: Vec<usize>,
    pub(crate) elastic: bool,
    pub(crate) positive: Vec<bool>,
    pub(crate) readings: usize,
}

/// Coefficient that is fixed at a value.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Fixed {
    pub(crate) block: usize,
    pub(crate) column: usize,
    pub(crate) value: f64,
}

/// Solution at one point of the nonlinear parameters.
pub(crate) struct Point {
    pub(crate) noise: Noise,
    pub(crate) solutions: Vec<Solution>,
    pub(crate) squares: f64,
    pub(crate) log_det_noise: f64,
    /// ln |XᵀK⁻¹X| − ln |XᵀX|.
    pub(crate) log_det_information: f64,
    /// Whitened residuals of the measurements.
    pub(crate) residuals: Vec<f64>,
}

/// Steps whose time affects the fit, each with its shape.
fn moments(curves: &[Curve], shapes: &mut Vec<Shape>) -> Vec<Moment> {
    /// Minimum shift of the measurements by a step time, in standard deviations: half of one widens
    /// no interval by an eighth.
    const MIN_SHIFT_STDS: f64 = 0.5;
    let mut moments = Vec::new();
    for (curve, record) in curves.iter().enumerate() {
        for window in record
            .windows
            .iter()
            .filter(|w| record.moved_by(w) > MIN_SHIFT_STDS)
        {
            moments.push(Moment {
                curve,
                step: window.step,
                shape: shapes.len(),
            });
            // At the previous measurement the step would count for that one.
            let (from_s, to_s) = (window.from_s.next_up(), window.to_s);
            shapes.push(Shape::linear("step_s", "s", from_s, to_s));
        }
    }
    moments
}

impl Model {
    pub(crate) fn new(
        law: Law,
        mut curves: Vec<Curve>,
        options: &FitOptions,
    ) -> Result<Self, CreepError> {
        let (short, long) = span(&curves);
        let short = short.max(1e-6 * long);
        let rope = match (law, &options.rope) {
            (Law::Rope, Some(base)) => Some(RopePlan::new(&curves, base)?),
            (Law::Rope, None) => return Err(CreepError::NoRope),
            _ => None,
        };
        let (mut shapes, terms) = match &rope {
            Some(plan) => (plan.bounds(short, long), plan.terms()),
            None => (law.shapes(short, long), law.terms()),
        };
        if rope.is_some() {
            curves.iter_mut().for_each(add_zero);
        }
        let law_shapes = shapes.len();
        let joint = options.share == Share::All && rope.is_none();
        let exponent = (joint && levels(&curves) > 1.1).then(|| {
            shapes.push(Shape::linear("p", "", 0.3, 3.0));
            shapes.len() - 1
        });
        let activation = (rope.is_none() && temperatures_differ(&curves)).then(|| {
            shapes.push(Shape::linear("E", "kJ/mol", -100.0, 400.0));
            shapes.len() - 1
        });
        let moments = match law {
            // A straight line is fitted to a late part of a record.
            Law::Line => Vec::new(),
            _ => moments(&curves, &mut shapes),
        };
        let clock = Clock::of(law, long);
        let clocks = curves
            .iter()
            .map(|c| c.time_s.iter().map(|t| clock.at(c, *t)).collect())
            .collect();
        let memory = match clock {
            Clock::Logarithm { unit_s } => {
                Shape::logarithmic("tau_c", "", 0.1, (long / unit_s).ln_1p())
            }
            Clock::Seconds => {
                let least = typical_gap(&curves).min(0.3 * long);
                Shape::logarithmic("tau_c", "s", least, long)
            }
        };
        let of = |members: Vec<usize>| {
            let unloads = members.iter().any(|&m| curves[m].unloads());
            let elastic = rope.is_none() && (unloads || (members.len() > 1 && exponent.is_some()));
            let mut positive: Vec<bool> = terms.iter().map(|t| t.positive).collect();
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
        let blocks = match options.share {
            Share::All => vec![of((0..curves.len()).collect())],
            Share::Shape => (0..curves.len()).map(|m| of(vec![m])).collect(),
        };
        let range = |c: &Curve| {
            let (least, most) = extremes(&c.strain);
            most - least
        };
        let scale = curves.iter().map(range).fold(f64::MIN_POSITIVE, f64::max);
        let readings = curves.iter().map(|c| c.time_s.len()).sum();
        Ok(Self {
            law,
            curves,
            shapes,
            terms,
            held_z: vec![0.0; rope.as_ref().map_or(0, |plan| plan.held.len())],
            rope,
            law_shapes,
            exponent,
            activation,
            moments,
            noise: options.noise,
            memory,
            clock,
            clocks,
            blocks,
            scale,
            readings,
        })
    }

    /// Number of nonlinear parameters: shapes, then share and correlation time of the noise.
    pub(crate) fn dimension(&self) -> usize {
        self.shapes.len() + if self.noise == NoiseKind::White { 0 } else { 2 }
    }

    /// Number of linear coefficients.
    pub(crate) fn coefficients(&self) -> usize {
        self.blocks.iter().map(|b| b.positive.len()).sum()
    }

    /// Degrees of freedom: measurements minus the numbers of the law.
    pub(crate) fn freedom(&self) -> f64 {
        let fitted = self.coefficients() + self.shapes.len();
        self.readings.saturating_sub(fitted).max(1) as f64
    }

    /// Values of the shapes, then the deviation of each fixed parameter from the base rope's value,
    /// in standard deviations.
    pub(crate) fn values(&self, x: &[f64]) -> Vec<f64> {
        self.values_held(x, &self.held_z)
    }

    /// Values with the fixed parameters at deviations `held_z`.
    pub(crate) fn values_held(&self, x: &[f64], held_z: &[f64]) -> Vec<f64> {
        let shapes = self.shapes.iter().zip(x).map(|(s, x)| s.value(*x));
        shapes.chain(held_z.iter().copied()).collect()
    }

    /// Load steps of a curve, with fitted times if the values contain them. `member` is the curve
    /// with index `index`, or its continuation.
    pub(crate) fn steps<'a>(
        &self,
        values: &[f64],
        index: usize,
        member: &'a Curve,
    ) -> Cow<'a, [(f64, f64)]> {
        let mut steps = Cow::Borrowed(&member.steps[..]);
        let own = self.moments.iter().filter(|m| m.curve == index);
        for moment in own.filter(|m| member.windows.iter().any(|w| w.step == m.step)) {
            steps.to_mut()[moment.step].0 = values[moment.shape];
        }
        steps
    }

    /// Number of shapes that are numbers of the law; the others are step times.
    pub(crate) fn law_numbers(&self) -> usize {
        self.shapes.len() - self.moments.len()
    }

    /// Converts a coefficient to the unit of its parameter.
    pub(crate) fn number(&self, column: usize, beta: f64) -> f64 {
        let number = beta * self.scale;
        match self.terms.get(column) {
            // A coefficient of zero corresponds to a rigid rope.
            Some(term) if term.inverse => 1.0 / number.max(1e-9),
            Some(term) => number * term.factor,
            None => 100.0 * number,
        }
    }

    pub(crate) fn noise_at(&self, x: &[f64]) -> Noise {
        match self.noise {
            NoiseKind::White => Noise::WHITE,
            NoiseKind::Correlated => Noise {
                share: x[self.shapes.len()] * SHARE_MAX,
                memory: self.memory.value(x[self.shapes.len() + 1]),
            },
        }
    }
}
