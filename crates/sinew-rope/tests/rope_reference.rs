//! Independent implementation of the creep law as differential equations, integrated by Dormand and Prince's
//! 5(4) pair at a tolerance far below that of the tests; ropes for the tests.

use sinew_rope::law::{DELAY_TIMES_S, Parameters, Polymer, RopeLoad, State};

/// Parameters of Liros DC000-0301, as in the catalogue.
pub(crate) fn sk99() -> Parameters {
    Parameters {
        polymer: Polymer::Hmpe,
        breaking_load_n: 4450.0,
        elastic_k: 45.0,
        toe_percent: 0.20,
        toe_load_ratio: 0.03,
        bedding_percent: 0.42,
        bedding_load_ratio: 0.020,
        bedding_time_s: 240.0,
        jamming: 3.0,
        bedding_energy_j_per_mol: 40e3,
        pass_gain: 0.9,
        pass_exponent: 1.2,
        delayed_percent: 1.4,
        delayed_energy_j_per_mol: 90e3,
        delayed_per_k: 0.0,
        flow_rate_per_s: 1e-13,
        flow_energy_j_per_mol: 145e3,
        flow_stress_mpa: 92.0,
        breaking_stress_mpa: 2990.0,
        retraction_percent: 0.24,
        retraction_time_s: 240.0,
        retraction_load_ratio: 0.15,
        expansion_per_k: -12e-6,
        friction: 0.05,
        bend_life_passes: 2e4,
        bend_ratio_exponent: 3.0,
        bend_load_exponent: 3.0,
        pass_pressure_exponent: 0.5,
    }
}

/// Parameters of the aramid cord.
pub(crate) fn aramid() -> Parameters {
    Parameters {
        polymer: Polymer::Aramid,
        breaking_load_n: 2500.0,
        elastic_k: 30.0,
        toe_percent: 0.30,
        bedding_percent: 0.70,
        bedding_load_ratio: 0.025,
        bedding_time_s: 135.0,
        jamming: 2.0,
        bedding_energy_j_per_mol: 0.0,
        delayed_percent: 1.0,
        delayed_energy_j_per_mol: 0.0,
        delayed_per_k: 0.012,
        flow_rate_per_s: 0.0,
        retraction_percent: 0.0,
        expansion_per_k: -3e-6,
        ..sk99()
    }
}

type Y = [f64; 8];

/// `dy/dt` for b, v₁…v₅, f, s, straight from the equations.
fn rate(p: &Parameters, guides: f64, load: RopeLoad, y: &Y) -> Y {
    const R: f64 = 8.31446261815324;
    const T_REF: f64 = 296.15;
    let lambda = load.tension_n / p.breaking_load_n;
    let theta = load.temperature_k;
    let a = |e: f64| (e / R * (1.0 / T_REF - 1.0 / theta)).exp();
    let gain = if guides > 0.0 {
        p.pass_gain * guides.powf(p.pass_exponent)
    } else {
        0.0
    };
    let b_full = p.bedding_percent * (1.0 + gain);
    let b_inf = b_full * (1.0 - (-lambda / p.bedding_load_ratio).exp());
    let mut out = [0.0; 8];
    out[0] = a(p.bedding_energy_j_per_mol) / p.bedding_time_s
        * (b_inf - y[0]).max(0.0)
        * (-p.jamming * y[0] / b_full).exp();
    let j = p.delayed_percent * (1.0 + p.delayed_per_k * (theta - T_REF));
    for i in 0..5 {
        out[1 + i] = a(p.delayed_energy_j_per_mol) * (j * lambda - y[1 + i]) / DELAY_TIMES_S[i];
    }
    out[6] = 100.0
        * p.flow_rate_per_s
        * a(p.flow_energy_j_per_mol)
        * (lambda * p.breaking_stress_mpa / p.flow_stress_mpa).sinh();
    let g = ((theta - 308.15) / 25.0).clamp(0.0, 1.0);
    out[7] = (p.retraction_percent * g * (-lambda / p.retraction_load_ratio).exp() - y[7])
        / p.retraction_time_s;
    out
}

/// Segment of a programme: from a load to a load within a duration.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Piece {
    pub(crate) from: RopeLoad,
    pub(crate) to: RopeLoad,
    pub(crate) duration_s: f64,
}

impl Piece {
    fn at(&self, t: f64) -> RopeLoad {
        let x = t / self.duration_s;
        let mix = |a: f64, b: f64| a + (b - a) * x;
        RopeLoad {
            tension_n: mix(self.from.tension_n, self.to.tension_n),
            temperature_k: mix(self.from.temperature_k, self.to.temperature_k),
        }
    }
}

/// Integrates a piece at an absolute tolerance of 1e-12 % per step.
pub(crate) fn integrate(p: &Parameters, guides: f64, state: &mut State, piece: &Piece) {
    const TOLERANCE: f64 = 1e-12;
    let mut y: Y = [
        state.bedding_percent,
        state.delayed_percent[0],
        state.delayed_percent[1],
        state.delayed_percent[2],
        state.delayed_percent[3],
        state.delayed_percent[4],
        state.flow_percent,
        state.retraction_percent,
    ];
    let mut t = 0.0;
    let mut h = (piece.duration_s * 1e-3).min(0.1);
    let add = |y: &Y, h: f64, terms: &[(f64, &Y)]| -> Y {
        let mut out = *y;
        for (w, k) in terms {
            for i in 0..8 {
                out[i] += h * w * k[i];
            }
        }
        out
    };
    // What is left below this is rounding of the sum of steps.
    while piece.duration_s - t > 1e-13 * piece.duration_s {
        h = h.min(piece.duration_s - t);
        let f = |c: f64, y: &Y| rate(p, guides, piece.at(t + c * h), y);
        let k1 = f(0.0, &y);
        let k2 = f(0.2, &add(&y, h, &[(0.2, &k1)]));
        let k3 = f(0.3, &add(&y, h, &[(3.0 / 40.0, &k1), (9.0 / 40.0, &k2)]));
        let k4 = f(
            0.8,
            &add(
                &y,
                h,
                &[(44.0 / 45.0, &k1), (-56.0 / 15.0, &k2), (32.0 / 9.0, &k3)],
            ),
        );
        let k5 = f(
            8.0 / 9.0,
            &add(
                &y,
                h,
                &[
                    (19372.0 / 6561.0, &k1),
                    (-25360.0 / 2187.0, &k2),
                    (64448.0 / 6561.0, &k3),
                    (-212.0 / 729.0, &k4),
                ],
            ),
        );
        let k6 = f(
            1.0,
            &add(
                &y,
                h,
                &[
                    (9017.0 / 3168.0, &k1),
                    (-355.0 / 33.0, &k2),
                    (46732.0 / 5247.0, &k3),
                    (49.0 / 176.0, &k4),
                    (-5103.0 / 18656.0, &k5),
                ],
            ),
        );
        let next = add(
            &y,
            h,
            &[
                (35.0 / 384.0, &k1),
                (500.0 / 1113.0, &k3),
                (125.0 / 192.0, &k4),
                (-2187.0 / 6784.0, &k5),
                (11.0 / 84.0, &k6),
            ],
        );
        let k7 = f(1.0, &next);
        let difference = add(
            &[0.0; 8],
            h,
            &[
                (71.0 / 57600.0, &k1),
                (-71.0 / 16695.0, &k3),
                (71.0 / 1920.0, &k4),
                (-17253.0 / 339200.0, &k5),
                (22.0 / 525.0, &k6),
                (-1.0 / 40.0, &k7),
            ],
        );
        let error = difference.iter().fold(0.0f64, |m, e| m.max(e.abs()));
        if error <= TOLERANCE {
            t += h;
            y = next;
        } else {
            assert!(h > 1e-12, "the reference integrator got stuck at {t} s");
        }
        h *= (0.9 * (TOLERANCE / error.max(1e-30)).powf(0.2)).clamp(0.2, 4.0);
    }
    state.bedding_percent = y[0];
    state.delayed_percent.copy_from_slice(&y[1..6]);
    state.flow_percent = y[6];
    state.retraction_percent = y[7];
}

/// Largest difference in any part of the strain, %.
pub(crate) fn distance(a: &State, b: &State) -> f64 {
    let parts = |s: &State| {
        let d = s.delayed_percent;
        [
            s.bedding_percent,
            d[0],
            d[1],
            d[2],
            d[3],
            d[4],
            s.flow_percent,
            s.retraction_percent,
        ]
    };
    parts(a)
        .iter()
        .zip(parts(b))
        .fold(0.0f64, |m, (x, y)| m.max((x - y).abs()))
}
