//! Simulation of a rope on the test bench.
//!
//! The carriage is pulled with `F = T₁ + T₂`; the joint pulley turns freely, so both strands load it equally.
//! While one strand runs towards the drive, friction reduces its tension at every guiding pulley and
//! increases that of the other strand. Each section of a strand goes through the sinusoid with its own
//! tension; the carriage moves by the mean elongation of the two strands, averaged through the cycle.

use super::{Bench, Phase};
use crate::duty::{Duty, Stretch};
use crate::history::History;
use crate::law::routing::{self, Pulley, RopeSection};
use crate::law::{Law, LoadError, RopeLoad, State, damage};

/// Wrap angle of a pass that costs 1 with every [`Mechanism::wrap_exponent`], rad: 60°.
const REFERENCE_WRAP_RAD: f64 = std::f64::consts::FRAC_PI_3;
/// Tension of a pass that costs 1 with every [`Mechanism::tension_exponent`], N: half the force of the paper.
const REFERENCE_TENSION_N: f64 = 100.0;

/// Resolution of the tension along a strand through a cycle.
#[derive(Debug, Clone, Copy)]
struct Grid {
    /// Steps of a half period: the tension of a section changes as it crosses a pulley.
    steps: usize,
    /// Longest part of a section that pulleys touch, share of the stroke.
    part: f64,
}

/// Four times as fine a grid changes the paper's B, C and D by at most 2e-4 % strain, of the 1e-2 % between them.
const GRID: Grid = Grid {
    steps: 6,
    part: 0.25,
};

/// Tension through the cycle that drives the bedding-in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Driver {
    /// Each instant of the cycle, as in the law: bedding-in advances whenever its target lies above it.
    Cycle,
    /// Mean tension of the cycle.
    Mean,
    /// Root mean square of the tension.
    Rms,
    /// Highest tension of the cycle.
    Peak,
}

/// Assumptions on the bedding-in over pulleys that no published measurement decides.
///
/// Cost of a pass: `c = (φ/60°)^p (T/100 N)^m ((λ d/D)/0.0021)^n`, with the wrap `φ`, the mean tension `T` at mid-wrap
/// and [`damage::pressure_cost`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mechanism {
    /// `p`; 0: the cost does not depend on the wrap. `None`: [`damage::bend_share`], as in the law.
    pub wrap_exponent: Option<f64>,
    /// `m`; 0: the cost does not depend on the local tension.
    pub tension_exponent: f64,
    /// Tension that drives the bedding-in.
    pub driver: Driver,
}

impl Mechanism {
    /// Mechanism of the creep law: the same cost for every full bend, driven through the cycle.
    pub const OF_LAW: Self = Self {
        wrap_exponent: None,
        tension_exponent: 0.0,
        driver: Driver::Cycle,
    };
}

/// Simulated time series of a rope on the test bench.
#[derive(Debug, Clone, PartialEq)]
pub struct Simulated {
    /// Times since the start of the programme, s.
    pub time_s: Vec<f64>,
    /// Force on the carriage, N.
    pub force_n: Vec<f64>,
    /// Displacement of the carriage, mm.
    pub elongation_mm: Vec<f64>,
    /// Mean strain of the two strands, %.
    pub strain_percent: Vec<f64>,
    /// Share of that which unloading would not bring back, %.
    pub irreversible_percent: Vec<f64>,
}

/// Simulates a rope of diameter `rope_m`, m, in a bench's programme, with results every `interval_s`.
///
/// A reading is the strain averaged through the cycle at the tensions that friction causes. Delayed elasticity follows
/// the mean tension of the cycle.
///
/// # Errors
/// [`LoadError`], such as a tension above the breaking load.
pub fn simulate(
    law: &Law,
    bench: &Bench,
    rope_m: Option<f64>,
    interval_s: f64,
) -> Result<Simulated, LoadError> {
    simulate_as(law, bench, rope_m, Mechanism::OF_LAW, interval_s)
}

/// Simulates as [`simulate`], with other assumptions on the bedding-in.
///
/// # Errors
/// [`LoadError`], such as a tension above the breaking load.
pub fn simulate_as(
    law: &Law,
    bench: &Bench,
    rope_m: Option<f64>,
    mechanism: Mechanism,
    interval_s: f64,
) -> Result<Simulated, LoadError> {
    simulate_on(GRID, law, bench, rope_m, mechanism, interval_s)
}

fn simulate_on(
    grid: Grid,
    law: &Law,
    bench: &Bench,
    rope_m: Option<f64>,
    mechanism: Mechanism,
    interval_s: f64,
) -> Result<Simulated, LoadError> {
    let interval_s = interval_s.max(1e-3 * bench.duration_s());
    let mut times = vec![];
    let mut start_s = 0.0;
    for (i, phase) in bench.phases.iter().enumerate() {
        let n = (phase.duration_s / interval_s).ceil().max(1.0) as usize;
        // The start of a phase is read too: what happens at once is the point of changing force.
        for k in 0..=n {
            times.push((i, (k as f64 * interval_s).min(phase.duration_s), start_s));
        }
        start_s += phase.duration_s;
    }
    let mut out = Simulated {
        time_s: times.iter().map(|(_, t, start)| start + t).collect(),
        force_n: times
            .iter()
            .map(|(i, ..)| bench.phases[*i].force_n)
            .collect(),
        elongation_mm: Vec::new(),
        strain_percent: vec![0.0; times.len()],
        irreversible_percent: vec![0.0; times.len()],
    };
    // Equal strands go through the same cycle, half a period apart.
    let are_equal = bench.strands[0] == bench.strands[1];
    let strands = if are_equal { 1 } else { 2 };
    for which in 0..strands {
        let costs = costs(law, bench, which, rope_m, mechanism);
        let pulleys = passing(bench, which);
        for section in sections(bench, which, grid) {
            let passes =
                |(p, cost): (&Pulley, &f64)| cost * p.passes(section.middle_m, bench.stroke_m);
            let law = law.passed_by(pulleys.iter().zip(&costs).map(passes).sum());
            let weight = section.length_m / bench.strand_m / strands as f64;
            let (mut state, mut delayed) = (State::default(), State::default());
            let mut at = 0;
            for (i, phase) in bench.phases.iter().enumerate() {
                let cycle = Cycle::of(&law, bench, which, &section, phase, grid.steps)?;
                let duty = cycle.driving(mechanism.driver);
                let mut history = History::new(&law, &duty, state);
                let mut last_s = 0.0;
                while let Some((_, t, _)) = times.get(at).filter(|(j, ..)| *j == i) {
                    state = history.at(*t)?;
                    law.hold(&mut delayed, cycle.mean, t - last_s)?;
                    let read = State {
                        delayed_percent: delayed.delayed_percent,
                        ..state
                    };
                    let mut strain = law.strain(&read, cycle.mean)?;
                    strain.elastic_percent = cycle.elastic_percent;
                    out.strain_percent[at] += weight * strain.total_percent();
                    out.irreversible_percent[at] += weight * strain.irreversible_percent();
                    at += 1;
                    last_s = *t;
                }
            }
        }
    }
    let mm_per_percent = 10.0 * bench.strand_m;
    out.elongation_mm = out
        .strain_percent
        .iter()
        .map(|v| mm_per_percent * v)
        .collect();
    Ok(out)
}

/// Pulleys of a strand as the rope sees them: positions count from the drive with the rope in the middle of its stroke,
/// half a stroke from either end.
fn passing(bench: &Bench, which: usize) -> Vec<Pulley> {
    let shifted = |p: &Pulley| Pulley {
        at_m: p.at_m + 0.5 * bench.stroke_m,
        ..*p
    };
    bench.strands[which].pulleys.iter().map(shifted).collect()
}

/// Sections of the rope that is in a strand in the middle of the stroke; those that pulleys touch in parts of at most
/// `grid.part` of the stroke.
fn sections(bench: &Bench, which: usize, grid: Grid) -> Vec<RopeSection> {
    let whole = || {
        vec![RopeSection {
            length_m: bench.strand_m,
            middle_m: 0.5 * bench.strand_m,
            guides: 0,
            passes: 0.0,
        }]
    };
    let longest_m = bench.strand_m + 0.5 * bench.stroke_m;
    let all = routing::portions(longest_m, bench.stroke_m, &passing(bench, which));
    let parts = |section: RopeSection| {
        let from_m = section.middle_m - 0.5 * section.length_m;
        let within_m = section.length_m.min(bench.strand_m - from_m).max(0.0);
        let count = match section.guides {
            _ if within_m == 0.0 => 0.0,
            0 => 1.0,
            _ => (within_m / (grid.part * bench.stroke_m)).ceil().max(1.0),
        };
        let length_m = within_m / count;
        (0..count as usize).map(move |k| RopeSection {
            length_m,
            middle_m: from_m + (k as f64 + 0.5) * length_m,
            ..section
        })
    };
    let all = all.unwrap_or_else(|_| whole());
    all.into_iter().flat_map(parts).collect()
}

/// Cost of a pass over each pulley of a strand, at the mean force of the programme.
fn costs(
    law: &Law,
    bench: &Bench,
    which: usize,
    rope_m: Option<f64>,
    mechanism: Mechanism,
) -> Vec<f64> {
    let work = bench.phases.iter().map(|p| p.force_n * p.duration_s);
    let force_n = work.sum::<f64>() / bench.duration_s();
    let cost = |p: &Pulley| {
        let middle_m = p.at_m + 0.5 * p.contact_m();
        let ends =
            [false, true].map(|towards| tension_n(law, bench, which, middle_m, force_n, towards));
        let local_n = 0.5 * (ends[0] + ends[1]);
        let wrap = match mechanism.wrap_exponent {
            Some(exponent) => libm::pow(p.wrap_rad / REFERENCE_WRAP_RAD, exponent),
            None => damage::bend_share(p.wrap_rad),
        };
        wrap * libm::pow(local_n / REFERENCE_TENSION_N, mechanism.tension_exponent)
            * damage::pressure_cost(law, p, rope_m, 0.5 * force_n)
    };
    bench.strands[which].pulleys.iter().map(cost).collect()
}

/// Tension at `at_m` from the drive while the strand runs towards it or away.
fn tension_n(
    law: &Law,
    bench: &Bench,
    which: usize,
    at_m: f64,
    force_n: f64,
    towards: bool,
) -> f64 {
    let mu = law.parameters().friction;
    let [pulled_n, paid_out_n] = routing::drive_tensions(force_n, bench.log_ratio(mu));
    let at_drive_n = if towards { pulled_n } else { paid_out_n };
    at_drive_n * routing::tension_share(&bench.strands[which].pulleys, mu, at_m, 0.0, towards)
}

/// One sinusoid of a section in a phase.
struct Cycle {
    duty: Duty,
    /// Mean load of the cycle.
    mean: RopeLoad,
    /// Elastic strain averaged through the cycle, %.
    elastic_percent: f64,
}

impl Cycle {
    fn of(
        law: &Law,
        bench: &Bench,
        which: usize,
        section: &RopeSection,
        phase: &Phase,
        steps: usize,
    ) -> Result<Self, LoadError> {
        let load = |tension_n: f64| RopeLoad::celsius(tension_n, phase.temperature_c);
        let mut stretches = Vec::with_capacity(2 * steps);
        if phase.moving && bench.log_ratio(law.parameters().friction) > 0.0 {
            // First half: this strand pays out, away from the drive; second half: it comes back.
            for towards in [false, true] {
                for k in 0..steps {
                    let x = (k as f64 + 0.5) / steps as f64;
                    let turn = if towards { 1.0 - x } else { x };
                    let out_m = -0.5 * bench.stroke_m * (std::f64::consts::PI * turn).cos();
                    let at_m = section.middle_m + out_m;
                    let n = tension_n(law, bench, which, at_m, phase.force_n, towards);
                    let duration_s = 0.5 * bench.period_s / steps as f64;
                    stretches.push(Stretch::hold(load(n), duration_s));
                }
            }
        } else {
            let hold = Stretch::hold(load(0.5 * phase.force_n), bench.period_s);
            stretches.push(hold);
        }
        let mut elastic_percent = 0.0;
        for s in &stretches {
            let strain = law.strain(&State::default(), s.from)?;
            elastic_percent += s.duration_s / bench.period_s * strain.elastic_percent;
        }
        let duty = Duty {
            about: String::new(),
            stretches,
            repeat: true,
        };
        Ok(Self {
            mean: load(duty.summary().tension_mean_n),
            elastic_percent,
            duty,
        })
    }

    /// Duty that drives the bedding-in.
    fn driving(&self, driver: Driver) -> Duty {
        let summary = || self.duty.summary();
        let tension_n = match driver {
            Driver::Cycle => return self.duty.clone(),
            Driver::Mean => self.mean.tension_n,
            Driver::Peak => summary().tension_max_n,
            Driver::Rms => {
                let stretches = self.duty.stretches.iter();
                let squares = stretches.map(|s| s.duration_s * s.from.tension_n * s.from.tension_n);
                libm::sqrt(squares.sum::<f64>() / summary().duration_s)
            }
        };
        let load = RopeLoad {
            tension_n,
            ..self.mean
        };
        Duty {
            stretches: vec![Stretch::hold(load, summary().duration_s)],
            ..self.duty.clone()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::routings::{Geometry, paper};
    use crate::bench::{Strand, routings};
    use crate::law::Parameter;
    use crate::{Catalogue, Draws};

    /// Diameter of the rope of the paper's bending tests, m.
    const ROPE_M: Option<f64> = Some(1.5e-3);

    fn law() -> Law {
        let catalogue = Catalogue::shipped().expect("shipped");
        let rope = catalogue.find("liros-dc000-0301").expect("there");
        Draws::new(rope, 0, 1).expect("complete").nominal
    }

    fn with(law: &Law, parameter: Parameter, value: f64) -> Law {
        let mut parameters = *law.parameters();
        parameters.set(parameter, value);
        Law::new(parameters).expect("a rope")
    }

    fn end(found: &Simulated) -> f64 {
        found.strain_percent.last().copied().expect("readings")
    }

    #[test]
    fn without_pulleys_the_bench_is_a_creep_test_at_half_the_force() {
        let law = law();
        let bench = paper("A").expect("a case");
        let found = simulate(&law, &bench, ROPE_M, 600.0).expect("load");
        let load = RopeLoad::at_reference(100.0);
        for (t, e) in found.time_s.iter().zip(&found.strain_percent) {
            let mut state = State::default();
            law.hold(&mut state, load, *t).expect("load");
            let expected = law.strain(&state, load).expect("load").total_percent();
            assert!((e - expected).abs() < 1e-9, "{t}: {e} {expected}");
        }
        assert_eq!(found.time_s.last(), Some(&14_400.0));
    }

    /// Without friction a guided strand is a creep test at half the force with its passes.
    #[test]
    fn without_friction_pulleys_add_only_their_passes() {
        let law = with(&law(), Parameter::Friction, 0.0);
        let load = RopeLoad::at_reference(100.0);
        let held = |passes: f64| {
            let (law, mut state) = (law.passed_by(passes), State::default());
            law.hold(&mut state, load, 14_400.0).expect("load");
            law.strain(&state, load).expect("load").total_percent()
        };
        for name in ["B", "C", "D"] {
            let bench = paper(name).expect("a case");
            let pulleys = &bench.strands[0].pulleys;
            let portions = routing::portions(0.6, 0.1, pulleys).expect("it fits");
            let expected: f64 = portions
                .iter()
                .map(|p| {
                    let passes = damage::passes(&law, p, pulleys, 0.1, ROPE_M, 100.0);
                    p.length_m / 0.6 * held(passes)
                })
                .sum();
            let found = end(&simulate(&law, &bench, ROPE_M, 3600.0).expect("load"));
            assert!((found - expected).abs() < 1e-9, "{name} {found} {expected}");
        }
    }

    /// Reference values: `python3 -c "from math import *; x = 0.05 * radians(60);
    /// print(100/cosh(x), 100*(1-tanh(x)), 100*(1+tanh(x)), 40*tanh(x), 100*(1-tanh(x/2)), 100/cosh(x/2))"`.
    #[test]
    fn tensions_match_capstan_closed_form() {
        // Wrap of a strand (degrees), μ; far end, drive low and high, work of a cycle (J); one strand guided: the bare
        // strand low and high, mean at mid-wrap.
        for (wrap_deg, friction, expected) in [
            (
                60.0,
                0.05,
                [
                    99.8631, 94.7688, 105.2312, 2.0925, 97.3826, 102.6174, 99.9657,
                ],
            ),
            (
                270.0,
                0.05,
                [
                    97.2870, 76.8646, 123.1354, 9.2542, 88.2732, 111.7268, 99.3100,
                ],
            ),
            (
                365.0,
                0.05,
                [
                    95.1331, 69.1830, 130.8170, 12.3268, 84.2072, 115.7928, 98.7451,
                ],
            ),
            (
                270.0,
                0.10,
                [
                    89.8389, 56.0800, 143.9200, 17.5680, 76.8646, 123.1354, 97.2870,
                ],
            ),
            (
                365.0,
                0.10,
                [
                    82.6536, 43.7116, 156.2884, 22.5154, 69.1830, 130.8170, 95.1331,
                ],
            ),
        ] {
            let pulley = |deg: f64, at_m: f64| Pulley {
                at_m,
                radius_m: 0.008,
                wrap_rad: f64::to_radians(deg),
                friction: None,
            };
            let law = with(&law(), Parameter::Friction, friction);
            let guided = Strand {
                pulleys: [0.1, 0.3, 0.5]
                    .map(|at_m| pulley(wrap_deg / 3.0, at_m))
                    .to_vec(),
            };
            let both = Bench {
                strands: [guided.clone(), guided.clone()],
                ..paper("A").expect("a case")
            };
            let one = Bench {
                strands: [guided, Strand::default()],
                ..both.clone()
            };
            let ends = |bench: &Bench, which, at_m| {
                [false, true].map(|towards| tension_n(&law, bench, which, at_m, 200.0, towards))
            };
            let x = friction * f64::to_radians(wrap_deg);
            let far = ends(&both, 0, 0.6);
            let drive = ends(&both, 0, 0.0);
            let bare = ends(&one, 1, 0.3);
            let mid = ends(&one, 0, 0.3 + 0.5 * guided_contact(&one));
            // With one strand guided the mean at both ends is half the force.
            for at_m in [0.0, 0.6] {
                let ends = ends(&one, 0, at_m);
                assert!((ends[0] + ends[1] - 200.0).abs() < 1e-10, "{ends:?}");
            }
            assert!((far[0] - far[1]).abs() < 1e-10, "{far:?}");
            let found = [
                far[0],
                drive[0],
                drive[1],
                routing::friction_work_j(200.0, 0.1, both.log_ratio(friction)),
                // The bare strand is pulled while the guided one is paid out.
                bare[0].min(bare[1]),
                bare[0].max(bare[1]),
                0.5 * (mid[0] + mid[1]),
            ];
            for (found, expected) in found.into_iter().zip(expected) {
                assert!(
                    (found - expected).abs() < 5.1e-5,
                    "{wrap_deg} {found} {expected}"
                );
            }
            let rms = (0.5 * (drive[0].powi(2) + drive[1].powi(2))).sqrt();
            assert!((rms - 100.0 * (1.0 + x.tanh().powi(2)).sqrt()).abs() < 1e-10);
        }
    }

    fn guided_contact(bench: &Bench) -> f64 {
        bench.strands[0].pulleys[1].contact_m()
    }

    /// Work of the drive in a cycle equals the heat at the guides, integrated along every wrap, and at the joint pulley.
    #[test]
    fn work_of_the_drive_equals_heat_of_the_guides() {
        let law = law();
        let mut bench = Geometry {
            is_on_both_strands: false,
            joint_friction: 0.03,
            ..Geometry::AS_READ
        }
        .bench("C")
        .expect("a case");
        // Unlike strands, one pulley with its own friction.
        bench.strands[1].pulleys = paper("D").expect("a case").strands[0].pulleys.clone();
        bench.strands[1].pulleys[1].friction = Some(0.15);
        let mu = law.parameters().friction;
        let mut heat_j = 0.0;
        for towards in [false, true] {
            let at = |which, at_m, t| tension_n(&law, &bench, which, at_m, 200.0, t);
            for (which, towards) in [(0, towards), (1, !towards)] {
                for p in &bench.strands[which].pulleys {
                    const PARTS: u32 = 2000;
                    let mu = p.friction.unwrap_or(mu);
                    for k in 0..PARTS {
                        let x = (f64::from(k) + 0.5) / f64::from(PARTS);
                        let tension = at(which, p.at_m + x * p.contact_m(), towards);
                        heat_j += mu * tension * p.wrap_rad / f64::from(PARTS) * bench.stroke_m;
                    }
                }
            }
            let joint = at(0, 0.6, towards) - at(1, 0.6, !towards);
            heat_j += joint.abs() * bench.stroke_m;
        }
        let work_j = routing::friction_work_j(200.0, bench.stroke_m, bench.log_ratio(mu));
        assert!((heat_j / work_j - 1.0).abs() < 1e-6, "{heat_j} {work_j}");
    }

    #[test]
    fn tensions_of_both_strands_sum_to_the_force_and_swap() {
        let law = law();
        let bench = Geometry {
            is_on_both_strands: false,
            joint_friction: 0.02,
            ..Geometry::AS_READ
        }
        .bench("C")
        .expect("a case");
        for towards in [false, true] {
            let one = tension_n(&law, &bench, 0, 0.0, 200.0, towards);
            let two = tension_n(&law, &bench, 1, 0.0, 200.0, !towards);
            assert!((one + two - 200.0).abs() < 1e-12, "{one} {two}");
        }
        let mut swapped = bench.clone();
        swapped.strands.swap(0, 1);
        let [a, b] =
            [&bench, &swapped].map(|b| end(&simulate(&law, b, ROPE_M, 3600.0).expect("load")));
        assert!((a - b).abs() < 1e-12, "{a} {b}");
        // Equal strands are simulated once; with a difference that has no effect, twice.
        let mut both = paper("C").expect("a case");
        let once = end(&simulate(&law, &both, ROPE_M, 3600.0).expect("load"));
        both.strands[1].pulleys[0].friction = Some(law.parameters().friction);
        let twice = end(&simulate(&law, &both, ROPE_M, 3600.0).expect("load"));
        assert!((once - twice).abs() < 1e-12, "{once} {twice}");
    }

    /// Strains after four hours of (B), (C) and (D), %, both strands guided, by friction: first `benches/peers/bending.py`,
    /// then an independent prototype with its own grid, rounded to 0.001 %.
    #[test]
    fn four_hours_match_independent_implementations() {
        const FRICTION: [f64; 4] = [0.02, 0.05, 0.10, 0.20];
        let cases = [
            (
                0.0,
                0.0,
                Driver::Cycle,
                [
                    [0.6914, 0.7023, 0.6789],
                    [0.6942, 0.7067, 0.6863],
                    [0.6982, 0.6894, 0.6845],
                    [0.7031, 0.6094, 0.6461],
                ],
                [
                    [0.691, 0.703, 0.681],
                    [0.694, 0.708, 0.688],
                    [0.698, 0.690, 0.686],
                    [0.703, 0.610, 0.648],
                ],
            ),
            (
                0.0,
                1.0,
                Driver::Cycle,
                [
                    [0.6914, 0.7017, 0.6786],
                    [0.6941, 0.7033, 0.6846],
                    [0.6978, 0.6771, 0.6779],
                    [0.7016, 0.5768, 0.6244],
                ],
                [
                    [0.691, 0.703, 0.681],
                    [0.694, 0.704, 0.687],
                    [0.698, 0.678, 0.680],
                    [0.702, 0.578, 0.626],
                ],
            ),
            (
                0.0,
                0.0,
                Driver::Mean,
                [
                    [0.6896, 0.6899, 0.6694],
                    [0.6892, 0.6775, 0.6635],
                    [0.6880, 0.6378, 0.6436],
                    [0.6830, 0.5266, 0.5797],
                ],
                [
                    [0.689, 0.691, 0.671],
                    [0.689, 0.678, 0.665],
                    [0.688, 0.639, 0.645],
                    [0.683, 0.527, 0.581],
                ],
            ),
            (
                1.0,
                0.0,
                Driver::Cycle,
                [
                    [0.6161, 0.8009, 0.7218],
                    [0.6183, 0.8085, 0.7306],
                    [0.6215, 0.7932, 0.7303],
                    [0.6250, 0.7104, 0.6927],
                ],
                [
                    [0.616, 0.803, 0.725],
                    [0.618, 0.811, 0.733],
                    [0.621, 0.796, 0.733],
                    [0.625, 0.713, 0.695],
                ],
            ),
        ];
        let (mut second, mut prototype) = (0.0f64, 0.0f64);
        for (wrap_exponent, tension_exponent, driver, here, there) in cases {
            let mechanism = Mechanism {
                wrap_exponent: Some(wrap_exponent),
                tension_exponent,
                driver,
            };
            for ((friction, here), there) in FRICTION.into_iter().zip(here).zip(there) {
                let law = with(&law(), Parameter::Friction, friction);
                for (i, name) in ["B", "C", "D"].into_iter().enumerate() {
                    let bench = paper(name).expect("a case");
                    let found = simulate_as(&law, &bench, ROPE_M, mechanism, 3600.0);
                    let found = end(&found.expect("load"));
                    println!(
                        "{name} μ {friction} {mechanism:?}: {found:.4} {} {}",
                        here[i], there[i]
                    );
                    second = second.max((found - here[i]).abs());
                    prototype = prototype.max((found - there[i]).abs());
                }
            }
        }
        // The second implementation integrates the rate averaged through the cycle.
        assert!(second < 2e-4, "{second}");
        // Differences of the prototype by its sections; (B), (C) and (D) differ by 0.01 to 0.1 %.
        assert!(prototype < 4e-3, "{prototype}");
    }

    /// Strains after four hours over three guides of 90° on one strand, by the radius of the guides (mm), against the
    /// prototype; with every exponent above 0 they fall with the radius.
    #[test]
    fn strain_falls_with_radius_of_guides() {
        const RADII_MM: [f64; 6] = [0.8, 2.0, 4.0, 8.0, 15.0, 30.0];
        let strains = |exponent: f64| {
            let law = with(&law(), Parameter::PassPressureExponent, exponent);
            RADII_MM.map(|radius_mm| {
                let mut geometry = Geometry::AS_READ;
                geometry.wraps_deg[0] = [90.0; 3];
                geometry.is_on_both_strands = false;
                let mut bench = geometry.bench("B").expect("a case");
                for pulley in &mut bench.strands[0].pulleys {
                    pulley.radius_m = 1e-3 * radius_mm;
                }
                end(&simulate(&law, &bench, ROPE_M, 3600.0).expect("load"))
            })
        };
        for (exponent, expected) in [
            (1.0, [0.989, 0.775, 0.689, 0.641, 0.615, 0.598]),
            (0.5, [0.739, 0.689, 0.661, 0.641, 0.626, 0.615]),
        ] {
            let found = strains(exponent);
            println!("n {exponent}: {found:.4?}");
            for (found, expected) in found.into_iter().zip(expected) {
                assert!(
                    (found - expected).abs() < 2e-3,
                    "{exponent}: {found} {expected}"
                );
            }
        }
        for exponent in [0.1, 0.25, 0.5, 1.0] {
            let found = strains(exponent);
            assert!(
                found.windows(2).all(|w| w[1] < w[0]),
                "{exponent} {found:?}"
            );
        }
        let found = strains(0.0);
        println!("n 0: {found:.4?}");
        assert!(found.iter().all(|e| (e - 0.641).abs() < 3e-3), "{found:?}");
    }

    /// A finer grid of time and of the strand changes less than the routings differ.
    #[test]
    fn grid_of_time_and_strand_is_fine_enough() {
        let law = with(&law(), Parameter::Friction, 0.1);
        let fine = Grid {
            steps: 4 * GRID.steps,
            part: 0.25 * GRID.part,
        };
        for name in ["B", "C", "D"] {
            let bench = paper(name).expect("a case");
            let [coarse, fine] = [GRID, fine].map(|grid| {
                let found = simulate_on(grid, &law, &bench, ROPE_M, Mechanism::OF_LAW, 3600.0);
                end(&found.expect("load"))
            });
            println!("{name}: {coarse:.5} %, four times as fine {fine:.5} %");
            assert!((coarse - fine).abs() < 5e-4, "{name}: {coarse} {fine}");
        }
    }

    #[test]
    fn less_force_gives_back_only_what_is_elastic() {
        let law = law();
        let found = simulate(&law, &paper("E").expect("a case"), ROPE_M, 60.0).expect("load");
        let change = found
            .force_n
            .iter()
            .position(|f| *f == 120.0)
            .expect("it changes");
        let (before, after) = (
            found.strain_percent[change - 1],
            found.strain_percent[change],
        );
        assert!(after < before, "it drops at once");
        let last = found.strain_percent.last().expect("readings");
        assert!(*last < after, "and goes on");
        let stays = found.irreversible_percent.last().expect("readings");
        assert!(last > stays && *stays > 0.1);
        let rising = found
            .irreversible_percent
            .windows(2)
            .all(|w| w[1] >= w[0] - 1e-12);
        assert!(rising, "what is irreversible never comes back");
        assert_eq!(routings::FORCE_N, 200.0);
    }
}
