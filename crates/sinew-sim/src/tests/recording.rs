//! Whole recordings.

use super::{biorob_like, pendulum};
use crate::scenario::{
    Contact, Draw, Encoder, FrictionSpec, Motion, Offset, OffsetKind, PerJoint, RandomContacts,
    Record, Scenario, Shape,
};
use crate::{Simulation, injected};
use sinew_log::Frame;
use std::f64::consts::FRAC_PI_2;

fn all(scenario: &Scenario) -> Vec<Frame> {
    let mut simulation = Simulation::new(&biorob_like(), scenario).expect("a scenario");
    let mut frames = Vec::new();
    while let Some(frame) = simulation.next_frame().expect("steps") {
        frames.push(frame.clone());
    }
    frames
}

fn busy() -> Scenario {
    Scenario {
        duration_s: Some(6.0),
        sample_rate_hz: 250.0,
        motion: Motion::Random {
            range_rad: PerJoint::default(),
            move_s: Draw::Uniform { min: 0.9, max: 1.6 },
            pause_s: Draw::Uniform { min: 0.5, max: 1.2 },
        },
        encoder: Encoder {
            joint_bits: Some(13),
            motor_noise_rad: 2e-4,
            once_per_turn_rad: PerJoint::fixed(3e-4),
            ..Encoder::default()
        },
        random_contacts: Some(RandomContacts {
            fraction: 0.3,
            link: "tool".into(),
            line: 0,
            point_m: [0.0; 3],
            force_n: Draw::Uniform {
                min: 2.0,
                max: 15.0,
            },
            duration_s: Draw::Uniform { min: 0.5, max: 1.0 },
            rise_s: 0.05,
            from_to_s: (0.0, f64::INFINITY),
        }),
        record: Record {
            dq: true,
            tau_el: true,
            tau_m: true,
            tau_ext: true,
            temperature: true,
            tension: false,
        },
        ..Scenario::default()
    }
}

/// Bits of everything in a frame.
fn bits(frame: &Frame) -> Vec<u64> {
    let parts = [
        &frame.q,
        &frame.theta,
        &frame.dq,
        &frame.tau_el,
        &frame.tau_m,
        &frame.tau_ext,
    ];
    parts
        .iter()
        .flat_map(|p| p.iter().map(|x| x.to_bits()))
        .collect()
}

#[test]
fn runs_with_same_seed_are_bitwise_identical() {
    let (a, b) = (all(&busy()), all(&busy()));
    assert_eq!(a.len(), 1500);
    assert!(
        a.iter()
            .zip(&b)
            .all(|(a, b)| a.time_ns == b.time_ns && bits(a) == bits(b))
    );
    let other = all(&Scenario { seed: 2, ..busy() });
    assert!(a.iter().zip(&other).any(|(a, b)| bits(a) != bits(b)));
    assert!(
        a.iter()
            .all(|f| bits(f).iter().all(|&x| f64::from_bits(x).is_finite()))
    );
}

#[test]
fn sensors_do_not_affect_motion() {
    // The true velocity has no noise: it shows the motion independent of the encoders.
    let plain = all(&Scenario {
        encoder: Encoder::default(),
        ..busy()
    });
    let noisy = all(&busy());
    assert!(
        plain
            .iter()
            .zip(&noisy)
            .all(|(a, b)| a.dq == b.dq && a.tau_el == b.tau_el)
    );
    assert!(plain.iter().zip(&noisy).any(|(a, b)| a.q != b.q));
}

#[test]
fn random_motion_stays_within_80_percent_of_limits() {
    let frames = all(&Scenario {
        random_contacts: None,
        duration_s: Some(40.0),
        ..busy()
    });
    let robot = biorob_like();
    let mut widest = [0.0f64; 4];
    for frame in &frames {
        for (i, limit) in robot.limits.iter().enumerate() {
            // Elastic sag and overshoot of a joint may add a few hundredths of a radian.
            let margin = 0.1 * (limit.upper - limit.lower) - 0.05;
            assert!(frame.q[i] > limit.lower + margin && frame.q[i] < limit.upper - margin);
            widest[i] = widest[i].max((frame.q[i] - frames[0].q[i]).abs());
        }
    }
    assert!(widest.iter().all(|w| *w > 0.3), "{widest:?}");
}

fn holding(kind: OffsetKind) -> Scenario {
    Scenario {
        duration_s: Some(12.0),
        sample_rate_hz: 100.0,
        settle_s: 1.0,
        motion: Motion::Hold {
            pose_rad: PerJoint::one("shoulder_pitch", FRAC_PI_2),
        },
        joint_friction: FrictionSpec::none(),
        motor_friction: FrictionSpec::none(),
        offsets: vec![Offset {
            later_s: Draw::Fixed(0.0),
            joint: "shoulder_pitch".into(),
            line: 0,
            kind,
            size_rad: Draw::Fixed(0.01),
            shape: Shape::Step { at_s: 1.0 },
        }],
        ..Scenario::default()
    }
}

#[test]
fn arm_without_model_error_reaches_set_point() {
    let frames = all(&holding(OffsetKind::Physical));
    // Before the offset comes: exactly compensated, so only rounding moves it.
    let (first, before) = (&frames[0], &frames[99]);
    assert!((first.q[1] - FRAC_PI_2).abs() < 1e-9 && (before.q[1] - FRAC_PI_2).abs() < 1e-9);
    // (0.55·0.12 + 0.3·0.44 + 0.25·0.69) kg·m · 9.81 / 40 N·m/rad
    let sag = 0.3705 * 9.81 / 40.0;
    assert!((before.theta[1] - before.q[1] - sag).abs() < 1e-9);
}

#[test]
fn offset_physical_acts_injected_does_not() {
    let physical = all(&holding(OffsetKind::Physical));
    let injection = all(&holding(OffsetKind::Injected));
    let (p, i) = (&physical[1199], &injection[1199]);
    // Injected: only the recorded motor position moves.
    assert!((i.q[1] - FRAC_PI_2).abs() < 1e-9);
    assert!((i.theta[1] - injection[99].theta[1] - 0.01).abs() < 1e-9);
    // Physical: the motor holds its place, so the joint sags by nearly the whole offset.
    assert!(p.q[1] < FRAC_PI_2 - 0.009, "q = {}", p.q[1]);
    // Either way theta − q − g/K is the offset; gravity at the sagged pose differs by
    // 1 − cos(0.01) = 5e-5 of 91 mrad.
    let sag = 0.3705 * 9.81 / 40.0;
    for f in [p, i] {
        assert!(
            (f.theta[1] - f.q[1] - sag - 0.01).abs() < 1e-5,
            "{}",
            f.theta[1] - f.q[1] - sag
        );
    }
}

#[test]
fn injected_offset_needs_larger_motor_position() {
    assert_eq!(injected(0.5, 0.01), 0.51);
    assert_eq!(injected(0.009, 0.01), 0.009);
    assert_eq!(injected(-0.5, 0.01), -0.5);
}

#[test]
fn contact_changes_elastic_torque_temporarily() {
    let mut scenario = holding(OffsetKind::Injected);
    scenario.offsets.clear();
    scenario.contacts = vec![Contact {
        start_s: 1.0,
        duration_s: 7.0,
        link: "tool".into(),
        line: 0,
        point_m: [0.0; 3],
        force_n: [0.0, 0.0, 5.0],
        rise_s: 0.1,
    }];
    scenario.record.tau_ext = true;
    scenario.record.tau_el = true;
    let frames = all(&scenario);
    // The tool is at 0.72 m, slightly less when the arm is deflected.
    let lifted = &frames[790];
    assert!(
        lifted.tau_ext[1] > 3.3 && lifted.tau_ext[1] < 3.6,
        "{}",
        lifted.tau_ext[1]
    );
    // Then gravity is carried by spring and contact together, at every joint.
    let arm = biorob_like().arm;
    let mut ws = sinew_model::arm::ArmWorkspace::new(&arm);
    let g = arm
        .momentum(&mut ws, &lifted.q, &[0.0; 4])
        .expect("finite")
        .g;
    for i in 0..4 {
        // Ringing has had seven seconds to fade.
        let left = lifted.tau_el[i] + lifted.tau_ext[i] - g[i];
        assert!(left.abs() < 1e-3, "joint {i}: {left} N·m");
    }
    assert_eq!(frames[820].tau_ext[1], 0.0);
}

#[test]
fn encoder_13_bit_quantises_to_step() {
    let step = std::f64::consts::TAU / 8192.0;
    for frame in all(&Scenario {
        duration_s: Some(0.5),
        ..busy()
    }) {
        for q in &frame.q {
            assert!((q / step - (q / step).round()).abs() < 1e-9);
        }
    }
}

#[test]
fn stiff_controller_coarse_step_error_suggests_fix() {
    let scenario = Scenario {
        integration_step_s: 1e-3,
        controller: crate::scenario::Controller {
            stiffness_nm_per_rad: PerJoint::fixed(1e6),
            damping_nm_s_per_rad: PerJoint::fixed(0.0),
        },
        motion: Motion::Hold {
            pose_rad: PerJoint::fixed(0.3),
        },
        offsets: vec![Offset {
            later_s: Draw::Fixed(0.0),
            joint: "swing".into(),
            line: 0,
            kind: OffsetKind::Physical,
            size_rad: Draw::Fixed(0.1),
            shape: Shape::Step { at_s: 0.5 },
        }],
        ..Scenario::default()
    };
    let mut simulation = Simulation::new(&pendulum(), &scenario).expect("a scenario");
    let mut end = Ok(());
    loop {
        match simulation.next_frame() {
            Ok(Some(_)) => {}
            Ok(None) => break,
            Err(e) => {
                end = Err(e.to_string());
                break;
            }
        }
    }
    let message = end.expect_err("it must diverge");
    assert!(
        message.contains("integration_step_s") && message.contains(" s ("),
        "{message}"
    );
}
