//! Routing: sections, pass counts and the capstan equation.

use proptest::prelude::*;
use sinew_rope::law::damage;
use sinew_rope::law::routing::{
    Pulley, RopeSection, RoutingError, capstan, far_share, portions, tension_share,
};
use std::f64::consts::PI;

fn pulley(at_m: f64, wrap_rad: f64) -> Pulley {
    Pulley {
        at_m,
        radius_m: 0.008,
        wrap_rad,
        friction: None,
    }
}

#[test]
fn capstan_efficiencies_are_the_reported_ones() {
    // 180° over a bearing pulley keeps 89 % with μ = 0.037, over a carabiner 60 % with 0.16.
    assert!((capstan(1.0, -0.037, PI) - 0.89).abs() < 0.005);
    assert!((capstan(1.0, -0.16, PI) - 0.605).abs() < 0.005);
}

#[test]
fn tension_falls_along_a_rope_that_is_pulled_in() {
    let pulleys = [pulley(0.1, 1.0), pulley(0.3, 2.0)];
    let at = |point, towards| tension_share(&pulleys, 0.1, point, 0.0, towards);
    assert_eq!(at(0.05, true), 1.0);
    assert!((at(0.2, true) - (-0.1f64).exp()).abs() < 1e-15);
    // Half-way through the second wrap.
    assert!((at(0.3 + 0.008, true) - (-0.2f64).exp()).abs() < 1e-12);
    assert!((at(0.5, true) - (-0.3f64).exp()).abs() < 1e-15);
    assert!((at(0.5, false) - 0.3f64.exp()).abs() < 1e-15);
    assert_eq!(far_share(&pulleys, 0.1, true), at(0.5, true));
    // The drive pays out: the same rope point passes the first pulley.
    assert!(tension_share(&pulleys, 0.1, 0.05, 0.1, true) < 1.0);
    // A pulley's own friction goes before the rope's.
    let own = [Pulley {
        friction: Some(0.0),
        ..pulley(0.1, 1.0)
    }];
    assert_eq!(far_share(&own, 0.1, true), 1.0);
}

#[test]
fn edge_without_length_takes_full_friction_at_its_point() {
    let edge = [Pulley {
        radius_m: 0.0,
        ..pulley(0.1, 1.0)
    }];
    assert_eq!(tension_share(&edge, 0.1, 0.099, 0.0, true), 1.0);
    let behind = tension_share(&edge, 0.1, 0.101, 0.0, true);
    assert!((behind - (-0.1f64).exp()).abs() < 1e-15);
}

#[test]
fn bending_counts_only_passing_pulleys_by_curvature() {
    let pulleys = [pulley(0.1, PI), pulley(0.3, PI), pulley(0.7, PI)];
    let portion = RopeSection {
        length_m: 0.02,
        middle_m: 0.25,
        guides: 0,
    };
    // Within a stroke of 0.1 m the second one alone comes over it; within one of 0.5 m the third, too. Once it is past
    // the first, that one never comes back.
    for (stroke_m, count) in [(0.01, 0.0), (0.1, 1.0), (0.5, 2.0)] {
        assert_eq!(damage::passes(&portion, &pulleys, stroke_m, None), count);
    }
    // 16 mm at a rope of 1 mm, wrapped half round: bent like a pulley of a larger diameter by what a short contact spares.
    let bend_m = 0.016 / (1.0 - (-0.008 * PI / 1e-3f64).exp());
    assert!((damage::bend_diameter_m(&pulleys[0], 1e-3) - bend_m).abs() < 1e-15);
    let weight = damage::pass_weight(&pulleys[0], 1e-3);
    let expected = (damage::REFERENCE_DIAMETER_RATIO * 1e-3 / bend_m).min(1.0);
    assert!((weight - expected).abs() < 1e-15);
    let passes = damage::passes(&portion, &pulleys, 0.5, Some(1e-3));
    assert!((passes - 2.0 * expected).abs() < 1e-14);
}

#[test]
fn invalid_routing_is_error() {
    assert_eq!(portions(0.0, 0.1, &[]), Err(RoutingError::Strand));
    assert_eq!(portions(1.0, f64::NAN, &[]), Err(RoutingError::Strand));
    let odd = [pulley(0.1, -1.0)];
    assert_eq!(
        portions(1.0, 0.1, &odd),
        Err(RoutingError::Pulley { pulley: 1 })
    );
    let far = [pulley(0.2, 1.0), pulley(1.0, 1.0)];
    assert!(matches!(
        portions(1.0, 0.1, &far),
        Err(RoutingError::Beyond { pulley: 2, .. })
    ));
}

proptest! {
    #![proptest_config(ProptestConfig {
        failure_persistence: None,
        rng_seed: proptest::test_runner::RngSeed::Fixed(2018),
        ..ProptestConfig::with_cases(300)
    })]

    /// Sections fill the strand, and passed length sums to the contact of each pulley.
    #[test]
    fn portions_fill_the_strand(
        places in prop::collection::vec((0.0..0.9f64, 0.0..4.0f64), 0..6),
        stroke in 0.0..0.3f64,
    ) {
        let pulleys: Vec<Pulley> = places.iter().map(|&(at, wrap)| pulley(at, wrap)).collect();
        let found = portions(1.0, stroke, &pulleys).expect("it fits");
        let length: f64 = found.iter().map(|p| p.length_m).sum();
        prop_assert!((length - 1.0).abs() < 1e-12);
        let passed: f64 = found.iter().map(|p| p.length_m * p.guides as f64).sum();
        let touched: f64 = pulleys
            .iter()
            .map(|p| p.at_m + p.contact_m() - (p.at_m - stroke).max(0.0))
            .sum();
        prop_assert!((passed - touched).abs() < 1e-12, "{passed} {touched}");
    }
}
