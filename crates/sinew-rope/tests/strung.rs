//! Ropes at constant length against analytic solutions, with a quarter of the step, and at their limits.

use crate::rope_reference::sk99;
use proptest::prelude::*;
use sinew_rope::law::strung::{Piece, RELAXATION_TOLERANCE, Strand, StrandAssembly};
use sinew_rope::law::{Law, LoadError, Parameters, REFERENCE_K, RopeLoad, State};

const DAY_S: f64 = 86_400.0;
const YEAR_S: f64 = 31_557_600.0;
const L: f64 = 0.7;
const R: f64 = 0.02;

fn law(parameters: Parameters) -> Law {
    Law::new(parameters).expect("parameters of a rope")
}

/// Linear elastic rope without creep.
fn spring() -> Parameters {
    Parameters {
        toe_percent: 0.0,
        bedding_percent: 0.0,
        delayed_percent: 0.0,
        flow_rate_per_s: 0.0,
        retraction_percent: 0.0,
        ..sk99()
    }
}

fn strung(strands: Vec<Strand>, tension_n: f64) -> StrandAssembly {
    StrandAssembly::new(strands, tension_n, REFERENCE_K, 0.0).expect("a load")
}

fn one(parameters: Parameters, tension_n: f64) -> StrandAssembly {
    strung(
        vec![Strand::straight(law(parameters), L, State::default())],
        tension_n,
    )
}

/// Tensions after each step of a relaxation.
fn left(strung: &mut StrandAssembly, duration_s: f64) -> Vec<f64> {
    let mut all = vec![strung.tension_n()];
    let seen = |_: f64, s: &StrandAssembly| all.push(s.tension_n());
    strung
        .leave(duration_s, None, RELAXATION_TOLERANCE, seen)
        .expect("a load");
    all
}

fn close(found: f64, expected: f64) {
    assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
}

#[test]
fn without_creep_nothing_moves() {
    let mut s = one(spring(), 300.0);
    assert!(
        left(&mut s, YEAR_S)
            .iter()
            .all(|n| (n / 300.0 - 1.0).abs() < 1e-12)
    );
}

/// Spring and dashpot in series, with a series compliance: `C λ̇ = −K sinh(a λ)`, so `tanh(a λ/2)` falls
/// exponentially at the rate `K a/C`.
#[test]
fn maxwell_element_matches_analytic_relaxation() {
    let p = Parameters {
        flow_rate_per_s: 1e-9,
        ..spring()
    };
    let give = 2e-5;
    let mut strand = Strand::straight(law(p), L, State::default());
    strand.series_compliance_m_per_n = give;
    let mut s = strung(vec![strand], 900.0);
    s.leave(DAY_S, None, RELAXATION_TOLERANCE, |_, _| {})
        .expect("a load");
    let a = p.breaking_stress_mpa / p.flow_stress_mpa;
    let c = 0.01 * L * 100.0 / p.elastic_k + give * p.breaking_load_n;
    let k = 0.01 * L * 100.0 * p.flow_rate_per_s;
    let half = (0.5 * a * 900.0 / p.breaking_load_n).tanh() * (-k * a * DAY_S / c).exp();
    let expected = 2.0 / a * half.atanh() * p.breaking_load_n;
    assert!(expected < 800.0, "{expected}");
    close(s.tension_n(), expected);
}

/// Final state of the Kelvin elements: `T (100/k + 5 J) = T₀ 100/k`.
#[test]
fn kelvin_elements_reach_analytic_equilibrium() {
    let p = Parameters {
        delayed_percent: 1.4,
        ..spring()
    };
    let mut s = one(p, 300.0);
    left(&mut s, 100.0 * YEAR_S);
    let elastic = 100.0 / p.elastic_k;
    close(s.tension_n(), 300.0 * elastic / (elastic + 5.0 * 1.4));
    // One of the five alone, early on: the others are a thousandth of it or slower.
    let mut early = one(p, 300.0);
    left(&mut early, 0.01);
    let rate: f64 = 1.4
        * [1e1, 1e2, 1e3, 1e4, 1e5]
            .map(|tau: f64| 1.0 / tau)
            .iter()
            .sum::<f64>();
    let fallen = 300.0 * rate * 0.01 / elastic;
    assert!(((300.0 - early.tension_n()) / fallen - 1.0).abs() < 1e-3);
}

/// Two ropes of springs and linear dashpots on a joint with a torque: their mean tension falls exponentially;
/// the joint rotates by `k e t/2`, twice as fast once the partner is slack.
#[test]
fn loaded_joint_rotates_and_partner_becomes_slack() {
    let p = Parameters {
        flow_rate_per_s: 1e-7,
        flow_stress_mpa: 1e6,
        ..spring()
    };
    let extra = 40.0;
    let strand = Strand::straight(law(p), L, State::default());
    let first = Strand {
        extra_n: extra,
        ..strand.clone()
    };
    let mut s = strung(vec![first, strand], 80.0);
    let a = p.breaking_stress_mpa / p.flow_stress_mpa / p.breaking_load_n;
    let k = L * p.flow_rate_per_s * a;
    let c = L / p.elastic_k / p.breaking_load_n;
    let slack_s = c / k * (2.0 * 100.0 / extra).ln();
    let half_s = 0.5 * slack_s;
    s.leave(half_s, None, RELAXATION_TOLERANCE, |_, _| {})
        .expect("a load");
    close(s.tension_n() + 0.5 * extra, 100.0 * (-k * half_s / c).exp());
    close(s.sag_m() / R, 0.5 * k * extra * half_s / R);
    s.leave(1.5 * slack_s, None, RELAXATION_TOLERANCE, |_, _| {})
        .expect("a load");
    assert_eq!(s.tension_n(), 0.0);
    close(s.sag_m(), 0.5 * k * extra * slack_s + k * extra * slack_s);
}

/// Bedding-in, flow and a delayed elasticity of more than twice the elastic one, which diverged with constant
/// tension per step.
#[test]
fn tension_never_rises_and_is_independent_of_step() {
    for tension_n in [60.0, 150.0, 300.0, 600.0, 1500.0] {
        for celsius in [-10.0, 23.0, 34.0] {
            let tied = || {
                let strand = Strand::straight(law(sk99()), L, State::default());
                StrandAssembly::new(vec![strand], tension_n, celsius + 273.15, 60.0)
                    .expect("a load")
            };
            let mut s = tied();
            let all = left(&mut s, YEAR_S);
            let falls = |w: &[f64]| w[1] <= w[0] * (1.0 + 1e-12);
            assert!(all.windows(2).all(falls), "{tension_n} N, {celsius} °C");
            // The error of a step goes with its fifth power: half the step.
            let mut finer = tied();
            finer
                .leave(YEAR_S, None, RELAXATION_TOLERANCE / 32.0, |_, _| {})
                .expect("a load");
            let off = s.tension_n() / finer.tension_n() - 1.0;
            assert!(off.abs() < 1e-6, "{tension_n} N, {celsius} °C: {off}");
            assert!(all.len() < 1000, "{} steps", all.len());
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Any rope, any series compliance, with and without a second rope at the joint.
    #[test]
    fn new_rope_loses_tension_independent_of_step(
        scale in proptest::array::uniform8(0.5_f64..2.0),
        share in 0.01_f64..0.25,
        celsius in -10.0_f64..34.0,
        give in 0.0_f64..1e-4,
        partner in proptest::option::of(0.0_f64..1.5),
    ) {
        let base = sk99();
        let p = Parameters {
            elastic_k: scale[0] * base.elastic_k,
            toe_percent: scale[1] * base.toe_percent,
            bedding_percent: scale[2] * base.bedding_percent,
            bedding_load_ratio: scale[3] * base.bedding_load_ratio,
            bedding_time_s: scale[4] * base.bedding_time_s,
            jamming: scale[5] * base.jamming,
            delayed_percent: scale[6] * base.delayed_percent,
            flow_rate_per_s: scale[7].powi(3) * base.flow_rate_per_s,
            ..base
        };
        let tension_n = share * p.breaking_load_n;
        let tied = || {
            let mut strand = Strand::straight(law(p), L, State::default());
            strand.series_compliance_m_per_n = give;
            let loaded = partner.map(|torque| Strand { extra_n: torque * tension_n, ..strand.clone() });
            let strands = loaded.into_iter().chain([strand]).collect();
            StrandAssembly::new(strands, tension_n, celsius + 273.15, 60.0).expect("a load")
        };
        let mut s = tied();
        let all = left(&mut s, YEAR_S);
        for w in all.windows(2) {
            prop_assert!(w[1] <= w[0] * (1.0 + 1e-12), "{} N after {} N", w[1], w[0]);
        }
        let mut finer = tied();
        finer.leave(YEAR_S, None, RELAXATION_TOLERANCE / 32.0, |_, _| {}).expect("a load");
        // Of the tension it began with: a partner that is all but slack has no share of its own.
        let off = (s.tension_n() - finer.tension_n()) / tension_n;
        prop_assert!(off.abs() < 1e-6, "{off}");
    }
}

/// Two pieces of one rope equal one; after a higher tension a rope regains tension.
#[test]
fn pieces_add_up_and_recovery_pulls() {
    let whole = Piece {
        law: law(sk99()),
        length_m: L,
        state: State::default(),
    };
    let cut = [0.3, 0.7].map(|share| Piece {
        length_m: share * L,
        ..whole
    });
    let of = |pieces: &[Piece]| {
        let strand = Strand {
            pieces: pieces.to_vec(),
            series_compliance_m_per_n: 1e-5,
            extra_n: 0.0,
        };
        let mut s = StrandAssembly::new(vec![strand], 300.0, REFERENCE_K, 60.0).expect("a load");
        s.leave(DAY_S, None, RELAXATION_TOLERANCE, |_, _| {})
            .expect("a load");
        s.tension_n()
    };
    close(of(&cut), of(&[whole]));
    let mut pulled = whole;
    let hard = RopeLoad::at_reference(600.0);
    pulled
        .law
        .hold(&mut pulled.state, hard, DAY_S)
        .expect("a load");
    assert!(of(&[pulled]) > 300.0);
}

#[test]
fn time_of_reaching_a_tension_is_found() {
    let strand = Strand::straight(law(sk99()), L, State::default());
    let mut s =
        StrandAssembly::new(vec![strand.clone()], 300.0, REFERENCE_K, 60.0).expect("a load");
    let at = s
        .leave(YEAR_S, Some(240.0), RELAXATION_TOLERANCE, |_, _| {})
        .expect("a load");
    close(s.tension_n(), 240.0);
    let mut again = StrandAssembly::new(vec![strand], 300.0, REFERENCE_K, 60.0).expect("a load");
    again
        .leave(at, None, RELAXATION_TOLERANCE, |_, _| {})
        .expect("a load");
    close(again.tension_n(), 240.0);
    let broken = Strand::straight(law(sk99()), L, State::default());
    let broken = StrandAssembly::new(vec![broken], 5000.0, REFERENCE_K, 60.0);
    assert!(matches!(broken, Err(LoadError::Broken { .. })));
}
