//! Analytic values of the creep law, its limits and its errors.

use super::law;
use crate::rope_reference::{aramid, sk99};
use sinew_rope::law::endurance::Endurance;
use sinew_rope::law::validity::LimitViolation;
use sinew_rope::law::{Law, LoadError, Parameter, RopeLoad, State, bedding, damage, ramp};

#[test]
fn entire_exponential_integral_matches_table() {
    // Ein(x) = E1(x) + ln x + γ; E1 from Abramowitz and Stegun, table 5.1.
    const GAMMA: f64 = 0.577_215_664_901_532_9;
    for (x, e1) in [
        (0.5f64, 0.559_773_594_776_16),
        (1.0, 0.219_383_934_395_520),
        (2.0, 0.048_900_510_708_061),
        (5.0, 0.001_148_295_591_275_3),
        (10.0, 4.156_968_929_685_324e-6),
    ] {
        let expected = e1 + x.ln() + GAMMA;
        assert!((bedding::ein(x) - expected).abs() < 1e-13, "{x}");
    }
    // Both branches meet.
    assert!((bedding::ein(2.0 - 1e-12) - bedding::ein(2.0 + 1e-12)).abs() < 1e-11);
    assert_eq!(bedding::ein(0.0), 0.0);
}

#[test]
fn without_jamming_bedding_in_is_an_exponential() {
    let mut p = sk99();
    p.jamming = 0.0;
    let law = law(p);
    let load = RopeLoad::at_reference(60.0);
    let mut state = State::default();
    law.hold(&mut state, load, 500.0).expect("load");
    let target = 0.42 * (1.0 - (-60.0 / 4450.0 / 0.020f64).exp());
    let expected = target * (1.0 - (-500.0f64 / 240.0).exp());
    assert!((state.bedding_percent - expected).abs() < 1e-14);
}

#[test]
fn delayed_elasticity_is_five_exponentials() {
    let law = law(sk99());
    let mut state = State::default();
    law.hold(&mut state, RopeLoad::at_reference(445.0), 5000.0)
        .expect("load");
    for (v, tau) in state
        .delayed_percent
        .iter()
        .zip([1e1, 1e2, 1e3, 1e4, 1e5f64])
    {
        let expected = 1.4 * 0.1 * (1.0 - (-5000.0 / tau).exp());
        assert!((v - expected).abs() < 1e-15, "{tau}: {v} {expected}");
    }
}

#[test]
fn thermal_expansion_alone() {
    let law = law(sk99());
    let state = State::default();
    let strain = law
        .strain(&state, RopeLoad::celsius(0.0, -27.0))
        .expect("load");
    assert!((strain.total_percent() - 100.0 * 12e-6 * 50.0).abs() < 1e-15);
    let strain = law
        .strain(&state, RopeLoad::at_reference(0.0))
        .expect("load");
    assert_eq!(strain.total_percent(), 0.0);
}

/// The toe gives the highest compliance at zero tension.
#[test]
fn compliance_is_the_slope_of_the_strain_with_its_toe() {
    let law = law(sk99());
    let state = State::default();
    for tension_n in [0.0, 10.0, 60.0, 133.5, 890.0] {
        let load = RopeLoad::at_reference(tension_n);
        let found = law.compliance_percent_per_n(load).expect("load");
        // 100/k + e_t/λ_t exp(−λ/λ_t), per N.
        let lambda = tension_n / 4450.0;
        let expected = (100.0 / 45.0 + 0.20 / 0.03 * (-lambda / 0.03f64).exp()) / 4450.0;
        assert!((found / expected - 1.0).abs() < 1e-12, "{tension_n} N");
        let strain = |n: f64| {
            let load = RopeLoad::at_reference(n);
            law.strain(&state, load).expect("load").elastic_percent
        };
        let slope = (strain(tension_n + 0.02) - strain(tension_n)) / 0.02;
        assert!(
            (slope / found - 1.0).abs() < 1e-4,
            "{tension_n} N: {slope} {found}"
        );
    }
}

#[test]
fn heat_retraction_starts_at_35_degrees_and_is_full_at_60() {
    let law = law(sk99());
    let settled = |celsius: f64, tension_n: f64| {
        let mut s = State::default();
        law.hold(&mut s, RopeLoad::celsius(tension_n, celsius), 1e5)
            .expect("load");
        s.retraction_percent
    };
    assert_eq!(settled(34.9, 0.0), 0.0);
    assert!((settled(47.5, 0.0) - 0.12).abs() < 1e-12);
    assert!((settled(60.0, 0.0) - 0.24).abs() < 1e-12);
    assert!((settled(80.0, 0.0) - 0.24).abs() < 1e-12);
    let held = 0.24 * (-0.1f64 / 0.15).exp();
    assert!((settled(60.0, 445.0) - held).abs() < 1e-12);
}

/// The recovered share of a heat retraction is not published: it lies between 0 and 1, and repeated heating
/// does not add to the permanent part.
#[test]
fn cooling_recovers_specified_share_of_retraction() {
    for back in [0.0, 0.3, 1.0] {
        let law = law(sk99()).giving_back(back);
        let mut s = State::default();
        let at = |s: &mut State, celsius: f64| {
            law.hold(s, RopeLoad::celsius(0.0, celsius), 1e5)
                .expect("load");
            law.strain(s, RopeLoad::at_reference(0.0))
                .expect("load")
                .retraction_percent
        };
        for _ in 0..2 {
            assert!((at(&mut s, 60.0) - 0.24).abs() < 1e-12);
            assert!((at(&mut s, 23.0) - (1.0 - back) * 0.24).abs() < 1e-12);
        }
        // Pulled harder, it gives back the same share.
        let mut pulled = State::default();
        at(&mut pulled, 60.0);
        let load = RopeLoad::celsius(445.0, 60.0);
        law.hold(&mut pulled, load, 1e5).expect("load");
        let held = 0.24 * (-0.1f64 / 0.15).exp();
        let expected = back * held + (1.0 - back) * 0.24;
        let found = pulled.retraction_percent + pulled.retraction_kept_percent;
        assert!(
            (found - expected).abs() < 1e-12,
            "{back}: {found} {expected}"
        );
        // A ramp ends where many short holds end.
        let (hot, cold) = (RopeLoad::celsius(60.0, 58.0), RopeLoad::celsius(60.0, 30.0));
        let mut ramped = State::default();
        let mut stepped = State::default();
        for (from, to) in [(cold, hot), (hot, cold)] {
            ramp(&law, &mut ramped, from, to, 600.0).expect("load");
            for k in 0..60_000 {
                let x = (f64::from(k) + 0.5) / 60_000.0;
                let kelvin = from.temperature_k + (to.temperature_k - from.temperature_k) * x;
                let load = RopeLoad {
                    tension_n: 60.0,
                    temperature_k: kelvin,
                };
                law.hold(&mut stepped, load, 0.01).expect("load");
            }
            for (a, b) in [
                (ramped.retraction_percent, stepped.retraction_percent),
                (
                    ramped.retraction_kept_percent,
                    stepped.retraction_kept_percent,
                ),
            ] {
                assert!((a - b).abs() < 1e-8, "{back}: {a} {b}");
            }
        }
    }
}

#[test]
fn fibre_flow_is_eyrings() {
    let law = law(sk99());
    let rates = law.rates(RopeLoad::celsius(1335.0, 43.0)).expect("load");
    let speed = (145e3 / 8.31446261815324 * (1.0 / 296.15 - 1.0 / 316.15f64)).exp();
    let expected = 100.0 * 1e-13 * speed * (0.3 * 2990.0 / 92.0f64).sinh();
    assert!((rates.flow_percent_per_s / expected - 1.0).abs() < 1e-13);
    // At the load of a creep test the flow of the fibre is negligible: less than 1e-6 %
    // within 85 min.
    let mut state = State::default();
    law.hold(&mut state, RopeLoad::at_reference(60.0), 5100.0)
        .expect("load");
    assert!(state.flow_percent < 1e-6 && state.flow_percent > 0.0);
}

#[test]
fn guiding_pulleys_widen_the_bedding_in() {
    let bare = law(sk99());
    assert_eq!(bare.passed_by(0.0).bedding_percent(), 0.42);
    assert!((bare.passed_by(1.0).bedding_percent() - 0.42 * 1.9).abs() < 1e-15);
    let three = 0.42 * (1.0 + 0.9 * 3f64.powf(1.2));
    assert!((bare.passed_by(3.0).bedding_percent() - three).abs() < 1e-15);
}

#[test]
fn invalid_load_is_error_and_state_unchanged() {
    let law = law(sk99());
    let mut state = State::default();
    law.hold(&mut state, RopeLoad::at_reference(200.0), 1e4)
        .expect("load");
    let before = state;
    let good = RopeLoad::at_reference(100.0);
    let cases: [(RopeLoad, f64, LoadError); 7] = [
        (
            RopeLoad::at_reference(f64::NAN),
            1.0,
            LoadError::TensionNotFinite,
        ),
        (
            RopeLoad::at_reference(f64::INFINITY),
            1.0,
            LoadError::TensionNotFinite,
        ),
        (
            RopeLoad::at_reference(-1.0),
            1.0,
            LoadError::NegativeTension { tension_n: -1.0 },
        ),
        (
            RopeLoad::at_reference(4451.0),
            1.0,
            LoadError::Broken {
                tension_n: 4451.0,
                breaking_load_n: 4450.0,
            },
        ),
        (
            RopeLoad {
                tension_n: 1.0,
                temperature_k: 20.0,
            },
            1.0,
            LoadError::Temperature {
                temperature_k: 20.0,
            },
        ),
        (good, -1.0, LoadError::Duration { duration_s: -1.0 }),
        (good, 1e11, LoadError::Duration { duration_s: 1e11 }),
    ];
    for (load, duration_s, error) in cases {
        assert_eq!(law.hold(&mut state, load, duration_s), Err(error));
        assert_eq!(ramp(&law, &mut state, good, load, duration_s), Err(error));
        assert_eq!(state, before);
    }
    assert!(matches!(
        law.hold(&mut state, good, f64::NAN),
        Err(LoadError::Duration { .. })
    ));
    let hot = RopeLoad {
        tension_n: 1.0,
        temperature_k: f64::NAN,
    };
    assert!(matches!(
        law.hold(&mut state, hot, 1.0),
        Err(LoadError::Temperature { .. })
    ));
    assert_eq!(state, before);
    let mut broken = State {
        bedding_percent: f64::NAN,
        ..before
    };
    assert_eq!(law.hold(&mut broken, good, 1.0), Err(LoadError::State));
    assert_eq!(
        damage::bend(&law, &mut state, 100.0, 0.0, 0.0015, 1.0),
        Err(LoadError::Bend)
    );
    assert_eq!(
        damage::bend(&law, &mut state, 100.0, 0.03, 0.0015, -1.0),
        Err(LoadError::Bend)
    );
    assert_eq!(state, before);
}

#[test]
fn parameter_out_of_range_error_names_parameter() {
    for &parameter in Parameter::ALL {
        let (low, high) = parameter.range();
        for value in [low - 1.0, 2.0 * high + 1.0, f64::NAN] {
            let mut p = sk99();
            p.set(parameter, value);
            let error = Law::new(p).expect_err(parameter.name());
            assert_eq!(error.name, parameter.name());
        }
    }
}

#[test]
fn validity_limits_are_reported() {
    let law = law(sk99());
    assert!(LimitViolation::of(&law, RopeLoad::at_reference(60.0)).is_inside());
    assert!(LimitViolation::of(&law, RopeLoad::at_reference(0.0)).is_inside());
    assert!(LimitViolation::of(&law, RopeLoad::at_reference(44.0)).low_load);
    assert!(LimitViolation::of(&law, RopeLoad::at_reference(1781.0)).high_load);
    assert!(LimitViolation::of(&law, RopeLoad::celsius(60.0, 66.0)).hot);
    let cord = Law::new(aramid()).expect("parameters of a rope");
    assert!(LimitViolation::of(&cord, RopeLoad::celsius(60.0, 90.0)).is_inside());
    let both = LimitViolation::of(&law, RopeLoad::celsius(44.0, 70.0));
    assert_eq!(both.sentences().count(), 2);
}

/// For a fibre without creep rupture: at its strength a rope lasts one minute, the duration of a breaking
/// test, and ten times as long per tenth of the strength less.
#[test]
fn static_fatigue_loses_strength_share_per_decade() {
    let law = law(sk99());
    let endurance = Endurance {
        rupture_percent: f64::INFINITY,
        static_fatigue_share: 0.1,
        ..Endurance::default()
    };
    let breaks_n = law.parameters().breaking_load_n;
    let holds_s = |share: f64, termination_share: f64| {
        let load = RopeLoad::at_reference(share * breaks_n);
        1.0 / endurance
            .damage_per_s(&law, load, termination_share)
            .expect("load")
    };
    for termination_share in [1.0, 0.8, 0.5] {
        for (tenths, minutes) in [(1.0, 10.0), (3.0, 1e3), (5.0, 1e5)] {
            let found_s = holds_s(termination_share * (1.0 - 0.1 * tenths), termination_share);
            assert!((found_s / (60.0 * minutes) - 1.0).abs() < 1e-9, "{found_s}");
        }
        // Beyond its strength the rope breaks immediately.
        assert_eq!(holds_s(1.01 * termination_share, termination_share), 0.0);
    }
}

#[test]
fn bends_add_up() {
    let law = law(sk99());
    let mut state = State::default();
    let survived = damage::passes_survived(&law, 445.0, 0.030, 0.0015).expect("bend");
    assert!((survived - 2e4).abs() < 1e-6, "the reference bend");
    for _ in 0..10 {
        damage::bend(&law, &mut state, 445.0, 0.030, 0.0015, 1000.0).expect("bend");
    }
    assert!((state.bending_damage - 0.5).abs() < 1e-12);
    assert!((damage::strength_left(&state) - 0.75).abs() < 1e-12);
    // A power law: as many times fewer at twice the load as more at half of it.
    let passes = |n: f64| damage::passes_survived(&law, n, 0.030, 0.0015).expect("bend");
    let (heavy, light) = (passes(890.0), passes(222.5));
    assert!(heavy < survived && (heavy * light / (survived * survived) - 1.0).abs() < 1e-12);
    let fewer = 2.0_f64.powf(law.parameters().bend_load_exponent);
    assert!((survived / heavy / fewer - 1.0).abs() < 1e-12);
    let tighter = damage::passes_survived(&law, 445.0, 0.015, 0.0015).expect("bend");
    assert!((tighter - 2e4 / 8.0).abs() < 1e-6);
}

/// Reference for small steps: `dc/dx = (1 − c) e^(−u c)`, by Runge–Kutta steps.
#[test]
fn small_steps_match_differential_equation() {
    for u in [0.3_f64, 3.0, 30.0, 300.0] {
        let p = 1.99e-3 / (1.0 + u);
        let slope = |c: f64| (1.0 - c) * (-u * c).exp();
        let steps = 64;
        let h = p / f64::from(steps);
        let mut c = 0.0;
        for _ in 0..steps {
            let k1 = slope(c);
            let k2 = slope(c + 0.5 * h * k1);
            let k3 = slope(c + 0.5 * h * k2);
            let k4 = slope(c + h * k3);
            c += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
        }
        let found = bedding::closed_fraction(u, p);
        // 64 sums, each rounded to 1e-16 of c, and some more in `slope`.
        assert!((found / c - 1.0).abs() < 3e-14, "{u}: {found} {c}");
    }
}
