//! Temperature effect on an offset, by rope, frame and routing.
//!
//! `SINEW_SEEDS=24 cargo test --release -p sinew-estimate --test all thermal:: -- --nocapture` measures it.

use crate::support;

use sinew_estimate::session::{self, SessionEstimate, Warning};
use sinew_estimate::thermal;
use sinew_model::robot::Robot;
use sinew_rope::Catalogue;
use sinew_sim::protocol::plan_named;
use sinew_sim::scenario::{Bound, Draw};
use support::{seeds, sessions, watching};

/// Thermal expansion of aluminium, 1/K.
const FRAME_PER_K: f64 = 23e-6;

/// Robot on a frame of this thermal expansion, or of an unspecified one.
fn on_a_frame(robot: &Robot, expansion_per_k: Option<f64>) -> Robot {
    let mut robot = robot.clone();
    robot.tolerances.drift_rad_per_k = None;
    for transmission in robot.transmissions.iter_mut().flatten() {
        let tendon = transmission.tendon.as_mut().expect("a tendon");
        tendon.frame_expansion_per_k = expansion_per_k;
    }
    thermal::expect(&mut robot, &Catalogue::shipped().expect("shipped"));
    robot
}

/// True drift: fibres of −12e-6/K on aluminium of 23e-6/K give −35e-6/K times L/r, which is 14, 16, 28 and 53.
fn true_drift_rad_per_k(robot: &Robot, joint: usize) -> f64 {
    let tendon = robot.transmissions[joint]
        .as_ref()
        .and_then(|t| t.tendon.as_ref());
    let tendon = tendon.expect("a tendon");
    -35e-6 * tendon.length_m / tendon.joint_pulley_radius_m
}

#[test]
fn drift_on_aluminium_frame_is_covered() {
    let mut plan = plan_named("S8").unwrap();
    let drift = |i| Draw::Normal {
        mean: true_drift_rad_per_k(&plan.robot, i),
        std: 0.05e-3,
        bound: Bound::Any,
    };
    let names = plan.robot.joint_names().iter().enumerate();
    let by_joint = names.map(|(i, name)| (name.clone(), 0, drift(i))).collect();
    plan.scenario.temperature.zero_drift_rad_per_k.by_joint = by_joint;
    let options = watching(&plan);
    let robots = [
        on_a_frame(&plan.robot, Some(FRAME_PER_K)),
        on_a_frame(&plan.robot, None),
        plan.robot.clone(),
    ];
    let (mut hits, mut count) = ([0; 3], 0);
    let mut squares = [0.0; 3];
    for seed in 0..seeds(3) {
        let ([a, b], truth) = sessions(&plan, 860 + seed);
        for (k, robot) in robots.iter().enumerate() {
            let learning = session::Learning::default();
            let (baseline, _) = session::learn_recorded(robot, &a, "A", &learning).unwrap();
            let with = Some((&baseline, "A"));
            let result = session::estimate_recorded(robot, &b, "B", with, &options);
            let result: SessionEstimate = result.unwrap().0;
            for (joint, truth) in result.joints.iter().zip(&truth) {
                let off = (1e3 * joint.offset_rad.mean - truth).abs();
                hits[k] += usize::from(off <= 1e3 * joint.offset_rad.half_width_95());
                squares[k] += off * off;
            }
            let named = |w: &Warning| matches!(w, Warning::ThermalEffect { frame_is_specified, .. } if !frame_is_specified);
            // Without a specified frame, a warning is raised.
            assert_eq!(
                result.warnings.iter().any(named),
                k == 1,
                "{k} {:?}",
                result.warnings
            );
        }
        count += truth.len();
    }
    let rms = squares.map(|s| (s / count as f64).sqrt());
    println!(
        "inside {hits:?} of {count}, RMS {rms:?} mrad: frame stated, not stated, 0 ± 0.1 mrad/K"
    );
    let least = (0.86 * count as f64) as usize;
    assert!(hits[0] >= least && hits[1] >= least, "{hits:?} of {count}");
    // The estimate with the prior of 0 ± 0.1 mrad/K is overconfident.
    assert!(hits[2] < least, "{hits:?} of {count}");
    assert!(rms[0] < 0.5 * rms[2], "{rms:?} mrad");
}

#[test]
fn drift_is_rope_minus_frame_expansion() {
    let plan = plan_named("S8").unwrap();
    let drift = |frame| {
        let robot = on_a_frame(&plan.robot, frame);
        let elbow = robot.transmissions[2].as_ref().unwrap().temperature_effect;
        elbow.expect("the rope is in the catalogue")
    };
    let known = drift(Some(FRAME_PER_K));
    assert!((known.drift_rad_per_k.mean + 0.98e-3).abs() < 1e-9);
    // Contributions: ± 3e-6/K of the rope, 10 % of the frame, and 0.1 mrad/K of all other effects.
    let spread = 28.0 * (3e-6_f64 / 1.96).hypot(2.3e-6);
    let std = spread.hypot(0.1e-3);
    assert!((known.drift_rad_per_k.std / std - 1.0).abs() < 1e-4);
    // 0.24 % less the part that 60 of 4450 N prevent, times L/r: 2.5 mrad/K from 35 to 60 °C.
    assert!((known.retraction_rad.mean / 25.0 - 2.46e-3).abs() < 0.01e-3);
    let unknown = drift(None).drift_rad_per_k;
    assert!(unknown.mean == 0.0 && (0.6e-3..0.8e-3).contains(&unknown.std));
    // Two antagonistic ropes shorten equally; a specified drift is used.
    let mut pair = plan.robot.clone();
    for transmission in pair.transmissions.iter_mut().flatten() {
        transmission.tendon.as_mut().unwrap().antagonistic = true;
    }
    let pair = on_a_frame(&pair, Some(FRAME_PER_K));
    assert!(
        pair.transmissions
            .iter()
            .flatten()
            .all(|t| t.temperature_effect.is_none())
    );
    let mut stated = plan.robot.clone();
    thermal::expect(&mut stated, &Catalogue::shipped().expect("shipped"));
    assert!(
        stated
            .transmissions
            .iter()
            .flatten()
            .all(|t| t.temperature_effect.is_none())
    );
}

// From 25 °C to 45 °C an HMPE rope retracts in addition to its drift per kelvin; the interval covers it.
#[test]
fn heat_retraction_between_sessions_is_covered() {
    let mut plan = plan_named("S5").unwrap();
    let robot = on_a_frame(&plan.robot, Some(FRAME_PER_K));
    plan.robot = robot;
    let ([mut a, mut b], truth) = sessions(&plan, 870);
    let at = |recorded: &mut session::Recorded, c: f64| {
        for block in &mut recorded.blocks {
            block.temperature_c = c;
        }
    };
    at(&mut a, 25.0);
    at(&mut b, 45.0);
    let full = |i: usize| {
        let temperature_effect = plan.robot.transmissions[i]
            .as_ref()
            .unwrap()
            .temperature_effect;
        temperature_effect.unwrap().retraction_rad.mean
    };
    // Temperature effect on the motor position, by the rope model: expansion, and 10/25 of the retraction.
    let reads = |i: usize| 20.0 * true_drift_rad_per_k(&plan.robot, i) - 0.4 * full(i);
    for block in &mut b.blocks {
        for i in 0..block.y.len() {
            let (s, y, y2) = (reads(i), block.y[i], block.y_square[i]);
            block.y[i] += s;
            block.y_slow[i] += s;
            block.y_square[i] += s * (2.0 * y + s);
            block.y_cube[i] += s * (3.0 * y2 + s * (3.0 * y + s));
        }
    }
    let learning = session::Learning::default();
    let (baseline, _) = session::learn_recorded(&plan.robot, &a, "A", &learning).unwrap();
    let with = Some((&baseline, "A"));
    let result = session::estimate_recorded(&plan.robot, &b, "B", with, &watching(&plan));
    for (joint, truth) in result.unwrap().0.joints.iter().zip(&truth) {
        let off = (1e3 * joint.offset_rad.mean - truth).abs();
        let half = 1e3 * joint.offset_rad.half_width_95();
        println!("{}: off {off:.2} ± {half:.2} mrad", joint.name);
        assert!(off < half, "{}: off {off} ± {half} mrad", joint.name);
    }
}
