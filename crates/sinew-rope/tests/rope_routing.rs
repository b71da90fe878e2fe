//! Routing: sections, pass counts and the capstan equation.

use crate::rope_reference::sk99;
use proptest::prelude::*;
use sinew_rope::law::routing::{
    Pulley, RoutingError, capstan, far_share, portions, tension_share, touched,
};
use sinew_rope::law::{Law, damage};
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
fn entry_and_exit_line_count_half_a_pass_each() {
    let pulleys = [pulley(0.1, PI), pulley(0.3, PI), pulley(0.7, PI)];
    let passes = |point_m, stroke_m| -> f64 {
        let each = pulleys.iter();
        each.map(|p| p.passes(point_m, stroke_m)).sum()
    };
    // Contact: 25.1 mm. Within a stroke of 0.1 m a point at 0.25 m crosses both lines of the second pulley, within one
    // of 0.5 m those of the third, too. Once it is past the first, that one never comes back.
    for (stroke_m, count) in [(0.01, 0.0), (0.1, 1.0), (0.5, 2.0)] {
        assert_eq!(passes(0.25, stroke_m), count, "{stroke_m}");
    }
    // A short stroke carries a point over the entry line, or over the exit line; in between it stays bent.
    for (point_m, count) in [
        (0.285, 0.0),
        (0.295, 0.5),
        (0.31, 0.5),
        (0.32, 0.5),
        (0.326, 0.0),
    ] {
        assert_eq!(passes(point_m, 0.01), count, "{point_m}");
    }
    // Resting rope on a pulley was bent once.
    assert_eq!((passes(0.31, 0.0), passes(0.29, 0.0)), (0.5, 0.0));
}

#[test]
fn cost_of_a_pass_falls_with_radius_and_rises_with_wrap() {
    let with = |exponent: f64| {
        let mut parameters = sk99();
        parameters.pass_pressure_exponent = exponent;
        Law::new(parameters).expect("a rope")
    };
    let cost = |exponent: f64, radius_mm: f64, wrap_rad: f64, tension_n: f64| {
        let guide = Pulley {
            radius_m: 1e-3 * radius_mm,
            ..pulley(0.1, wrap_rad)
        };
        damage::pass_cost(&with(exponent), &guide, Some(1.5e-3), tension_n)
    };
    // λ d/D by hand: 100/4450 · 1.5/16 = 0.0021067.
    let expected = (0.002_106_742 / 0.0021f64).powf(0.5) * (1.0 - (-PI / 0.1875).exp());
    assert!((cost(0.5, 8.0, PI, 100.0) - expected).abs() < 1e-6);
    // 20° on the paper's bench: 1 − exp(−8 mm · 0.349/1.5 mm) = 0.845.
    assert!((cost(0.0, 8.0, 20f64.to_radians(), 100.0) - 0.8446).abs() < 1e-4);
    let radii = [0.8, 2.0, 4.0, 8.0, 15.0, 30.0];
    for exponent in [0.1, 0.25, 0.5, 1.0] {
        let costs = radii.map(|r| cost(exponent, r, PI, 100.0));
        assert!(
            costs.windows(2).all(|w| w[1] < w[0]),
            "{exponent} {costs:?}"
        );
        // Without saturation: each radius in its power.
        let power = costs[0] / costs[5];
        assert!((power / (30f64 / 0.8).powf(exponent) - 1.0).abs() < 1e-12);
    }
    let free = radii.map(|r| cost(0.0, r, PI, 100.0));
    assert!(free.iter().all(|c| *c == free[0]));
    // A rope bends no tighter than to its own diameter.
    assert_eq!(cost(1.0, 0.0, 1.0, 100.0), cost(1.0, 0.75, 1.0, 100.0));
    assert!(cost(0.5, 8.0, 1e-3, 100.0) < 0.01 && cost(0.5, 8.0, 0.0, 100.0) == 0.0);
    assert!(cost(0.5, 8.0, 1.0, 50.0) < cost(0.5, 8.0, 1.0, 100.0));
    // Without a diameter the pressure is that of the bench.
    let unknown = damage::pass_cost(&with(1.0), &pulley(0.1, PI), None, 900.0);
    assert!((unknown - 1.0).abs() < 1e-6, "{unknown}");
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
        let over: f64 = found.iter().map(|p| p.length_m * p.guides as f64).sum();
        let contacts: f64 = pulleys
            .iter()
            .map(|p| p.at_m + p.contact_m() - (p.at_m - stroke).max(0.0))
            .sum();
        prop_assert!((over - contacts).abs() < 1e-12, "{over} {contacts}");
        // Half a pass for every line within the strand.
        let lines: f64 = pulleys
            .iter()
            .map(|p| {
                let (entry, exit) = (p.at_m, p.at_m + p.contact_m());
                let crossed = |line: f64| line - (line - stroke).max(0.0);
                // Rope that never leaves the pulley was bent onto it.
                let stays = (exit - stroke).max(0.0) - entry;
                0.5 * (crossed(entry) + crossed(exit) + stays.max(0.0))
            })
            .sum();
        let passes: f64 = found.iter().map(|p| p.length_m * p.passes).sum();
        prop_assert!((passes - lines).abs() < 1e-12, "{passes} {lines}");
        let coarse = touched(1.0, stroke, &pulleys).expect("it fits");
        let again: f64 = coarse.iter().map(|p| p.length_m * p.guides as f64).sum();
        prop_assert!(coarse.len() <= found.len() && (again - contacts).abs() < 1e-12);
    }
}
