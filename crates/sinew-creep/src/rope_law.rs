//! Rope law ([`sinew_rope::law`]) as a law of creep fits.
//!
//! For given times, exponents and energies the strain of a record is linear in `1/k`, `e_t`, `B`,
//! `J`, `A₀` and `S`: bedding-in, delayed elasticity, flow and retraction do not interact, and each
//! is proportional to its own amplitude. One walk through the record's tensions at unit amplitudes
//! therefore gives every column of the linear problem, exactly (every segment is solved in closed
//! form), and only the rest is searched.

use sinew_model::Z95;
use sinew_rope::law::entry::{Uncertainty, Value};
use sinew_rope::law::{CELSIUS_ZERO_K, Law as RopeLaw, Parameter, Parameters};

use super::curve::Curve;
use super::error::{CreepError, Unusable};
use super::law::{Shape, Term};
use super::rope_base::{FixedParameter, NotIdentifiableReason, RopeBase};
use super::rope_walk::{PARTS, TEMPERATURE_C, Walk};

/// Selection of the parameters that a set of records determines.
#[derive(Debug, Clone)]
pub(super) struct RopePlan {
    base: Parameters,
    pub(super) shapes: Vec<Parameter>,
    pub(super) terms: Vec<Parameter>,
    pub(super) fixed: Vec<FixedParameter>,
    /// Parameters of [`Self::fixed`] whose base value has an interval.
    pub(super) held: Vec<(Parameter, Value)>,
}

/// Minimum temperature of heat retraction, °C.
const MIN_RETRACTION_C: f64 = 35.0;

/// Variation of loads and temperatures in the records.
struct Design {
    /// Number of distinct loads under which a rope beds in: higher than all earlier loads of the
    /// same specimen.
    loaded: usize,
    /// Number of changes of elastic strain with measurements on both sides.
    jumps: usize,
    temperatures: usize,
    warm: bool,
    warm_loads: usize,
    /// Maximum flow at the base's upper end of `A₀`, over the range of the strain.
    flow_share: f64,
}

impl Design {
    fn of(curves: &[Curve], base: &RopeBase) -> Self {
        let mbl = base.parameters.breaking_load_n;
        let mut loaded = Vec::new();
        let mut elastic = Vec::new();
        let mut warm_loads = Vec::new();
        let mut temperatures = Vec::new();
        let largest = curves.iter().flat_map(tensions).fold(0.0, f64::max);
        for curve in curves {
            let celsius = curve.temperature_c.unwrap_or(TEMPERATURE_C);
            add(&mut temperatures, celsius, 3.0);
            let mut own = Vec::new();
            if curve.zero_count > 0.0 {
                let preload = curve.tension.map_or(0.0, |t| t.preload_n);
                add(&mut own, preload, 0.05 * largest);
            }
            let mut highest = 0.0_f64;
            for tension in held_tensions(curve) {
                add(&mut own, tension, 0.05 * largest);
                if tension > 0.05 * largest {
                    // Below the largest earlier load nothing beds in, and nothing recovers.
                    if tension > highest + 0.1 * largest {
                        add(&mut loaded, tension, 0.1 * largest);
                    }
                    if celsius > MIN_RETRACTION_C {
                        add(&mut warm_loads, tension, 0.1 * largest);
                    }
                }
                highest = highest.max(tension);
            }
            if own.len() > 1 {
                own.iter()
                    .for_each(|t| add(&mut elastic, *t, 0.05 * largest));
            }
        }
        Self {
            loaded: loaded.len(),
            jumps: elastic.len().saturating_sub(1),
            temperatures: temperatures.len(),
            warm: temperatures.iter().any(|c| *c > MIN_RETRACTION_C),
            warm_loads: warm_loads.len(),
            flow_share: curves
                .iter()
                .map(|curve| flow_share(curve, base, mbl))
                .fold(0.0, f64::max),
        }
    }
}

/// Adds a value that is not close to any other.
fn add(values: &mut Vec<f64>, value: f64, apart: f64) {
    if values.iter().all(|v| (v - value).abs() > apart) {
        values.push(value);
    }
}

fn tensions(curve: &Curve) -> impl Iterator<Item = f64> + '_ {
    let steps = curve.steps.iter();
    steps.filter_map(|step| curve.tension.map(|t| t.at(step.1)))
}

/// Tensions with at least three measurements.
fn held_tensions(curve: &Curve) -> Vec<f64> {
    let ends = curve
        .steps
        .iter()
        .skip(1)
        .map(|s| s.0)
        .chain([f64::INFINITY]);
    curve
        .steps
        .iter()
        .zip(ends)
        .filter(|(step, end)| {
            let inside = |t: &&f64| **t >= step.0 && **t < *end;
            curve.time_s.iter().filter(inside).count() >= 3
        })
        .filter_map(|(step, _)| curve.tension.map(|t| t.at(step.1)))
        .collect()
}

/// Flow at the base's upper end of `A₀`, over the range of the record's strain.
fn flow_share(curve: &Curve, base: &RopeBase, mbl: f64) -> f64 {
    let rate = base
        .entry
        .law
        .get(&Parameter::FlowRate)
        .map_or(0.0, |value| value.at(Z95));
    let p = &base.parameters;
    let celsius = curve.temperature_c.unwrap_or(TEMPERATURE_C);
    let heat = p.flow_energy_j_per_mol / sinew_rope::law::GAS_CONSTANT
        * (1.0 / sinew_rope::law::REFERENCE_K - 1.0 / (celsius + CELSIUS_ZERO_K));
    let most = tensions(curve).fold(0.0, f64::max) / mbl;
    let stress = most * p.breaking_stress_mpa / p.flow_stress_mpa;
    let last = curve.time_s.last().copied().unwrap_or(0.0);
    let range = curve.strain.iter().copied().fold(0.0_f64, f64::max);
    rate * heat.exp() * stress.sinh() * last / range.max(1e-12)
}

impl RopePlan {
    pub(super) fn new(curves: &[Curve], base: &RopeBase) -> Result<Self, CreepError> {
        for curve in curves {
            check(curve, &base.parameters)?;
        }
        let design = Design::of(curves, base);
        let mut plan = Self {
            base: base.parameters,
            shapes: vec![Parameter::BeddingTime, Parameter::Jamming],
            terms: vec![Parameter::Bedding, Parameter::Delayed],
            fixed: Vec::new(),
            held: Vec::new(),
        };
        plan.decide(&design, base);
        Ok(plan)
    }

    /// Selects the free parameters by the variation of the records.
    fn decide(&mut self, design: &Design, base: &RopeBase) {
        use Parameter as P;
        let fixed_at_zero = |parameter: P| {
            base.entry.law.get(&parameter).is_some_and(|value| {
                value.value == 0.0 && value.uncertainty == Uncertainty::NotSpecified
            })
        };
        use NotIdentifiableReason as Why;
        let retraction = if fixed_at_zero(P::Retraction) {
            Some(Why::NoRetraction)
        } else {
            (!design.warm).then_some(Why::NoneWarm)
        };
        let unless = |determined: bool, reason: Why| (!determined).then_some(reason);
        let temperatures = design.temperatures;
        let flows = !fixed_at_zero(P::FlowRate) && design.flow_share >= 0.01;
        let three_warm = unless(temperatures > 2, Why::FewerThanThreeTemperatures);
        let warmer = unless(temperatures > 1, Why::OneTemperature);
        let parameters = [
            (P::ElasticK, unless(design.jumps > 0, Why::NoChangeOfLoad)),
            (P::Toe, unless(design.jumps > 1, Why::FewerThanThreeLoads)),
            (
                P::ToeLoadRatio,
                unless(design.jumps > 3, Why::FewerThanFiveLoads),
            ),
            (P::BeddingLoadRatio, unless(design.loaded > 1, Why::OneLoad)),
            (P::BeddingEnergy, warmer),
            (P::DelayedEnergy, warmer),
            (P::DelayedPerK, three_warm),
            (P::FlowRate, unless(flows, Why::TooLittleFlow)),
            (P::Retraction, retraction),
            (P::RetractionTime, retraction),
            (
                P::RetractionLoadRatio,
                retraction.or(unless(design.warm_loads > 1, Why::OneLoad)),
            ),
            (P::FlowEnergy, Some(Why::WithRateOfFlow)),
            (P::FlowStress, Some(Why::WithRateOfFlow)),
        ];
        let linear = [P::ElasticK, P::Toe, P::FlowRate, P::Retraction];
        for (parameter, reason) in parameters {
            match reason {
                None if linear.contains(&parameter) => self.terms.push(parameter),
                None => self.shapes.push(parameter),
                Some(reason) => {
                    self.fixed.push(FixedParameter {
                        name: parameter.name().to_owned(),
                        value: self.base.get(parameter),
                        reason,
                    });
                    let entry = base.entry.law.get(&parameter);
                    let open = entry.filter(|v| v.uncertainty != Uncertainty::NotSpecified);
                    self.held.extend(open.map(|v| (parameter, v.clone())));
                }
            }
        }
    }

    pub(super) fn bounds(&self, short_s: f64, long_s: f64) -> Vec<Shape> {
        self.shapes
            .iter()
            .map(|&parameter| {
                let (logarithmic, lower, upper) = match parameter {
                    // Times shorter than the measurement interval or longer than the record are
                    // indistinguishable.
                    Parameter::BeddingTime => (true, (0.3 * short_s).max(0.1), 10.0 * long_s),
                    Parameter::Jamming => (false, 0.0, 15.0),
                    Parameter::BeddingLoadRatio => (true, 0.002, 0.3),
                    Parameter::ToeLoadRatio => (true, 0.003, 0.3),
                    Parameter::RetractionTime => (true, 1.0, 1e5),
                    Parameter::RetractionLoadRatio => (true, 0.01, 2.0),
                    Parameter::DelayedPerK => (false, -0.05, 0.05),
                    _ => (false, 0.0, 200e3),
                };
                Shape {
                    logarithmic,
                    ..Shape::linear(parameter.name(), unit(parameter), lower, upper)
                }
            })
            .collect()
    }

    pub(super) fn terms(&self) -> Vec<Term> {
        let term = |&parameter: &Parameter| Term {
            name: parameter.name(),
            unit: unit(parameter),
            factor: 1.0,
            positive: true,
            inverse: parameter == Parameter::ElasticK,
        };
        self.terms.iter().map(term).collect()
    }

    /// Base values of the free shapes, as a start of the search.
    pub(super) fn base_values(&self) -> Vec<f64> {
        self.shapes.iter().map(|p| self.base.get(*p)).collect()
    }

    /// Rows of the terms' columns at increasing times, row by row, and the strain of the fixed
    /// amplitudes, with the fixed parameters at deviations `held_z` from the base rope's values.
    ///
    /// Strain in m/m counts from the state under the preload, before the first step.
    pub(super) fn rows(
        &self,
        values: &[f64],
        held_z: &[f64],
        curve: &Curve,
        steps: &[(f64, f64)],
        times: &[f64],
    ) -> (Vec<f64>, Vec<f64>) {
        let mut p = self.base;
        for ((parameter, value), z) in self.held.iter().zip(held_z) {
            let (low, high) = parameter.range();
            p.set(*parameter, value.at(*z).clamp(low, high));
        }
        for (parameter, value) in self.shapes.iter().zip(values) {
            p.set(*parameter, *value);
        }
        for &parameter in &self.terms {
            p.set(parameter, 1.0);
        }
        let width = self.terms.len();
        let mut rows = vec![0.0; times.len() * width];
        let mut offset = vec![0.0; times.len()];
        let Ok(law) = RopeLaw::new(p) else {
            return (rows, offset);
        };
        let mut walk = Walk::new(&law, curve, steps);
        let zero = walk.parts();
        let start = steps.first().map_or(0.0, |s| s.0);
        for (i, &t) in times.iter().enumerate() {
            let now = if t < start {
                Walk::waiting(&law, curve, steps, t).parts()
            } else {
                walk.go_to(t);
                walk.parts()
            };
            for ((parameter, now), zero) in PARTS.iter().zip(now).zip(zero) {
                match self.terms.iter().position(|q| q == parameter) {
                    Some(j) => rows[i * width + j] = now - zero,
                    None => offset[i] += now - zero,
                }
            }
        }
        (rows, offset)
    }
}

/// Checks that a record has tensions below the breaking load.
fn check(curve: &Curve, p: &Parameters) -> Result<(), CreepError> {
    let invalid = |reason: Unusable| {
        Err(CreepError::Specimen {
            specimen: curve.name.clone(),
            reason,
        })
    };
    if curve.tension.is_none() {
        return invalid(Unusable::NoTension);
    }
    let most = tensions(curve).fold(0.0, f64::max);
    if most >= p.breaking_load_n {
        return invalid(Unusable::Breaks {
            tension_n: most,
            breaking_load_n: p.breaking_load_n,
        });
    }
    let temperature_c = curve.temperature_c.unwrap_or(TEMPERATURE_C);
    if !(-100.0..=200.0).contains(&temperature_c) {
        return invalid(Unusable::Temperature { temperature_c });
    }
    Ok(())
}

fn unit(parameter: Parameter) -> &'static str {
    let name = parameter.name();
    [
        ("_j_per_mol", "J/mol"),
        ("_percent", "%"),
        ("_per_s", "1/s"),
        ("_per_k", "1/K"),
        ("_mpa", "MPa"),
        ("_s", "s"),
        ("_n", "N"),
    ]
    .into_iter()
    .find_map(|(end, unit)| name.ends_with(end).then_some(unit))
    .unwrap_or("")
}
