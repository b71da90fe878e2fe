//! Creep law of the rope against a reference integrator, with other step sizes, and at its limits.

mod values;

use crate::rope_reference::{Piece, aramid, distance, integrate, sk99};
use proptest::prelude::*;
use sinew_rope::law::{Law, Parameters, RopeLoad, State, bedding, ramp};

/// Maximum difference of the law from the reference, % strain.
const AGAINST_REFERENCE_PERCENT: f64 = 1e-6;
/// Exact steps differ by rounding only: some thousand operations of 1e-16 on strains below 10 %.
const ROUNDING_PERCENT: f64 = 1e-12;

fn cases(cases: u32) -> ProptestConfig {
    ProptestConfig {
        failure_persistence: None,
        rng_seed: proptest::test_runner::RngSeed::Fixed(2018),
        ..ProptestConfig::with_cases(cases)
    }
}

fn law(parameters: Parameters) -> Law {
    Law::new(parameters).expect("parameters of a rope")
}

fn a_load(ratio_max: f64) -> impl Strategy<Value = RopeLoad> {
    // A quarter of the loads is slack: unloading is where laws go wrong.
    (
        prop_oneof![1 => Just(0.0), 3 => 0.0..ratio_max],
        -20.0..80.0f64,
    )
        .prop_map(|(ratio, celsius)| RopeLoad::celsius(ratio * 4450.0, celsius))
}

fn a_duration() -> impl Strategy<Value = f64> {
    (0.0..3.3f64).prop_map(|x| 10f64.powf(x))
}

fn a_programme(pieces: usize) -> impl Strategy<Value = Vec<Piece>> {
    let piece = (a_load(0.6), a_load(0.6), a_duration(), any::<bool>()).prop_map(
        |(from, to, duration_s, constant)| Piece {
            from,
            to: if constant { from } else { to },
            duration_s,
        },
    );
    prop::collection::vec(piece, 1..=pieces)
}

fn run(law: &Law, state: &mut State, piece: &Piece) {
    ramp(law, state, piece.from, piece.to, piece.duration_s).expect("a possible load");
}

proptest! {
    #![proptest_config(cases(48))]

    /// Random tension and temperature programmes, constant and linear pieces mixed.
    #[test]
    fn agrees_with_the_reference(
        programme in a_programme(6),
        guides in 0..4u8,
        cord in any::<bool>(),
    ) {
        let mut p = if cord { aramid() } else { sk99() };
        p.breaking_load_n = 4450.0;
        let law = law(p).passed_by(f64::from(guides));
        let (mut ours, mut theirs) = (State::default(), State::default());
        for piece in &programme {
            run(&law, &mut ours, piece);
            integrate(&p, f64::from(guides), &mut theirs, piece);
            let d = distance(&ours, &theirs);
            prop_assert!(d < AGAINST_REFERENCE_PERCENT, "{d} % after {piece:?}");
        }
    }
}

proptest! {
    #![proptest_config(cases(256))]

    /// The result does not depend on the number of steps.
    #[test]
    fn cutting_a_hold_changes_nothing(
        first in a_load(0.9),
        load in a_load(0.9),
        duration_s in (0.0..8.0f64).prop_map(|x| 10f64.powf(x)),
        cuts in prop::collection::vec(0.0..1.0f64, 1..30),
    ) {
        let law = law(sk99());
        let mut whole = State::default();
        law.hold(&mut whole, first, 100.0).expect("load");
        let mut cut = whole;
        law.hold(&mut whole, load, duration_s).expect("load");
        let sum: f64 = cuts.iter().sum::<f64>().max(1e-3);
        for c in &cuts {
            law.hold(&mut cut, load, duration_s * c / sum).expect("load");
        }
        if cuts.iter().sum::<f64>() < 1e-3 {
            return Ok(());
        }
        let d = distance(&whole, &cut);
        // Flow can be large at 90 % of the breaking load and 80 °C: its rounding is relative.
        prop_assert!(d < ROUNDING_PERCENT * (1.0 + whole.flow_percent), "{d}");
    }

    #[test]
    fn cutting_a_ramp_changes_nothing_beyond_its_tolerance(
        from in a_load(0.6),
        to in a_load(0.6),
        before in a_load(0.6),
        duration_s in a_duration(),
        at in 0.01..0.99f64,
    ) {
        let law = law(sk99());
        let mut whole = State::default();
        law.hold(&mut whole, before, 300.0).expect("load");
        let mut cut = whole;
        ramp(&law, &mut whole, from, to, duration_s).expect("load");
        let mix = |a: f64, b: f64| a + (b - a) * at;
        let middle = RopeLoad {
            tension_n: mix(from.tension_n, to.tension_n),
            temperature_k: mix(from.temperature_k, to.temperature_k),
        };
        ramp(&law, &mut cut, from, middle, at * duration_s).expect("load");
        ramp(&law, &mut cut, middle, to, (1.0 - at) * duration_s).expect("load");
        let d = distance(&whole, &cut);
        prop_assert!(d < 3.0 * sinew_rope::law::RAMP_TOLERANCE_PERCENT, "{d}");
    }

    /// Bedding-in and flow never decrease, and every element stays within its bounds.
    #[test]
    fn permanent_strain_never_decreases(programme in a_programme(12), guides in 0..4u8) {
        let law = law(sk99()).passed_by(f64::from(guides));
        let mut state = State::default();
        for piece in &programme {
            let before = state;
            run(&law, &mut state, piece);
            prop_assert!(state.bedding_percent >= before.bedding_percent);
            prop_assert!(state.flow_percent >= before.flow_percent);
            prop_assert!(state.bedding_percent <= law.bedding_percent());
            prop_assert!(state.is_possible());
        }
    }

    /// Unloaded at the reference temperature, strain falls towards b + f and never below.
    #[test]
    fn recovery_ends_at_the_irreversible_part(programme in a_programme(6)) {
        let law = law(sk99());
        let mut state = State::default();
        for piece in &programme {
            run(&law, &mut state, piece);
        }
        state.retraction_percent = 0.0;
        let floor = state.irreversible_percent();
        let slack = RopeLoad::at_reference(0.0);
        let mut last = f64::INFINITY;
        for _ in 0..40 {
            law.hold(&mut state, slack, 5e4).expect("load");
            let strain = law.strain(&state, slack).expect("load");
            let total = strain.total_percent();
            prop_assert!(total <= last && total >= floor);
            prop_assert_eq!(strain.irreversible_percent(), floor);
            last = total;
        }
        // 20 of the slowest times later next to nothing delayed is left.
        prop_assert!(last - floor < 1e-7 * (1.0 + floor), "{}", last - floor);
    }

    /// Strain increases with tension.
    #[test]
    fn strain_increases_with_tension(a in 0.0..0.6f64, b in 0.0..0.6f64, t in a_duration()) {
        let law = law(sk99());
        let strain = |ratio: f64| {
            let load = RopeLoad::at_reference(ratio * 4450.0);
            let mut s = State::default();
            law.hold(&mut s, load, t).expect("load");
            law.strain(&s, load).expect("load").total_percent()
        };
        let (low, high) = (a.min(b), a.max(b));
        prop_assert!(strain(low) <= strain(high) + ROUNDING_PERCENT);
    }

    /// Bedding-in in closed form against fine Runge–Kutta steps of `dz/ds = exp(u e^(−z))`.
    #[test]
    fn bedding_in_is_its_differential_equation(u in 0.0..6.0f64, p_log in -6.0..3.0f64) {
        let p = 10f64.powf(p_log);
        let s = p * (-u).exp();
        let f = |z: f64| (u * (-z).exp()).exp();
        let (mut z, n) = (0.0, 20_000);
        // Steps even in s^(1/2): the start is the fast part.
        let at = |i: i32| s * (f64::from(i) / f64::from(n)).powi(2);
        for i in 0..n {
            let h = at(i + 1) - at(i);
            let k1 = f(z);
            let k2 = f(z + 0.5 * h * k1);
            let k3 = f(z + 0.5 * h * k2);
            let k4 = f(z + h * k3);
            z += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
        }
        let expected = -(-z).exp_m1();
        let found = bedding::closed_fraction(u, p);
        prop_assert!((found - expected).abs() < 1e-10, "u {u} p {p}: {found} {expected}");
    }
}
