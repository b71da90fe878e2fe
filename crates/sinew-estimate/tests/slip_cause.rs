//! Discrimination between slips of the rope and of an encoder by the samples around the event.

use crate::support;

use sinew_estimate::jumps::Jumps;
use sinew_estimate::session;
use sinew_estimate::session::{Recorder, SessionEstimate, SessionOptions, TendonChangeKind};
use sinew_estimate::{Cause, UnknownCause};
use sinew_model::offset::FeatureConfig;
use sinew_model::robot::Robot;
use sinew_model::{Gaussian, Z95};
use sinew_sim::{Scenario, Simulation};
use support::{biorob_like, repository, seeds};

const PITCH: usize = 1;
const ELBOW: usize = 2;
/// Acceleration per deflection, 1/s². The arm follows 1.4 · 500 / 250² = 1 % of a slip within a sample of 250 Hz.
const QUICKNESS: f64 = 500.0;

/// Steps of one oscillating joint, measured by a 13-bit encoder and a finer one at the motor, with
/// `motor` and `joint` added over time.
fn swing(rate_hz: f64, motor: impl Fn(f64) -> f64, joint: impl Fn(f64) -> f64) -> Jumps {
    let mut jumps = Jumps::new(1);
    let step = std::f64::consts::TAU / 8192.0;
    for k in 0..(60.0 * rate_hz) as u32 {
        let t = f64::from(k) / rate_hz;
        let q = 0.8 * (1.3 * t).sin();
        let theta = q + 0.05 * (1.3 * t).cos() + motor(t);
        let read = ((q + joint(t)) / step).round() * step;
        jumps.push(t, &[(theta / 6e-5).round() * 6e-5], &[read]);
    }
    jumps
}

/// Slip of 5 mrad from 30.1 s on, with a rise time of `rise_s`.
fn slip(rise_s: f64) -> impl Fn(f64) -> f64 {
    move |t: f64| 5e-3 * ((t - 30.1) / rise_s).clamp(0.0, 1.0)
}

#[test]
fn samples_identify_slipped_encoder() {
    let none = |_: f64| 0.0;
    let at = |jumps: &Jumps| jumps.cause(0, 30.6, Gaussian::new(5e-3, 0.3e-3 / Z95), QUICKNESS);
    assert_eq!(at(&swing(250.0, slip(1e-6), none)), Cause::MotorEncoder);
    assert_eq!(
        at(&swing(250.0, none, |t| -slip(1e-6)(t))),
        Cause::JointEncoder
    );
    // The arm rests for ten minutes, which does not reduce the sampling rate.
    let mut rested = swing(250.0, slip(1e-6), none);
    (0..500).for_each(|k| rested.push(660.0 + f64::from(k) / 250.0, &[0.0], &[0.0]));
    assert_eq!(at(&rested), Cause::MotorEncoder);
    // A step of the opposite sign would decrease the offset and does not explain the change.
    assert_eq!(at(&swing(250.0, none, slip(1e-6))), Cause::Rope);
    // Motor and joint share a rope's slip and take a tenth of a second.
    let motor = |t: f64| 0.4 * slip(0.1)(t);
    let joint = |t: f64| -0.6 * slip(0.1)(t);
    assert_eq!(at(&swing(250.0, motor, joint)), Cause::Rope);
    assert_eq!(
        at(&swing(250.0, slip(1e-6), |t| -slip(1e-6)(t))),
        Cause::Unknown(UnknownCause::Both)
    );
}

#[test]
fn ambiguous_cause_is_reported_as_unknown() {
    let none = |_: f64| 0.0;
    let jumps = swing(250.0, slip(1e-6), none);
    let cause = |size: f64, quickness: f64| {
        jumps.cause(0, 30.6, Gaussian::new(size, 0.3e-3 / Z95), quickness)
    };
    // Half a milliradian is less than a step of the joint's encoder.
    assert_eq!(
        cause(0.5e-3, QUICKNESS),
        Cause::Unknown(UnknownCause::Noise)
    );
    // 1.4 · 5000 / 250² = 0.11, 1.4 · 20000 / 250² = 0.45 of a slip.
    assert_eq!(cause(5e-3, 5e3), Cause::MotorEncoder);
    assert_eq!(cause(5e-3, 2e4), Cause::Unknown(UnknownCause::Rate));
    assert_eq!(cause(5e-3, f64::NAN), Cause::Unknown(UnknownCause::Rate));
    assert_eq!(
        jumps.cause(7, 30.6, Gaussian::new(5e-3, 0.3e-3 / Z95), QUICKNESS),
        Cause::Unknown(UnknownCause::Missing)
    );
    let slow = swing(25.0, slip(1e-6), none);
    assert_eq!(
        slow.cause(0, 30.6, Gaussian::new(5e-3, 0.3e-3 / Z95), QUICKNESS),
        Cause::Unknown(UnknownCause::Rate)
    );
    // A gap of 40 ms at the slip.
    let mut holed = Jumps::new(1);
    for k in 0..15_000_u32 {
        let t = f64::from(k) / 250.0;
        if !(30.08..30.12).contains(&t) {
            holed.push(t, &[slip(1e-6)(t)], &[0.0]);
        }
    }
    assert_eq!(
        holed.cause(0, 30.6, Gaussian::new(5e-3, 0.3e-3 / Z95), QUICKNESS),
        Cause::Unknown(UnknownCause::Missing)
    );
    // Elsewhere in the same recording the cause is identified.
    assert_eq!(
        holed.cause(0, 50.0, Gaussian::new(5e-3, 0.3e-3 / Z95), QUICKNESS),
        Cause::Rope
    );
}

/// Estimate of sessions A and C of the examples' work session with two slips of `kind`; every `every`th
/// frame is recorded.
fn estimate_session(robot: &Robot, seed: u64, kind: &str, every: usize) -> SessionEstimate {
    let place = repository().join("examples/scenarios");
    let text = std::fs::read_to_string(place.join("work-session.toml")).unwrap();
    let (before, slips) = text.split_at(text.find("at_s = 130.0").unwrap() - 60);
    let slips = slips.replace("\"physical\"", &format!("\"{kind}\""));
    assert_eq!(slips.matches(kind).count(), 2);
    let text = format!("{before}{slips}");
    let mut scenario = Scenario::from_toml(&text, "work-session.toml").unwrap();
    scenario.seed = seed;
    let mut simulation = Simulation::new(robot, &scenario).unwrap();
    let recorder = || Recorder::new(robot, &FeatureConfig::default(), 0.5);
    let (mut first, mut last) = (recorder(), recorder());
    let mut k = 0;
    while let Some(frame) = simulation.next_frame().unwrap() {
        let t = f64::from(k) / 250.0;
        if (k as usize).is_multiple_of(every) {
            if t < 60.0 {
                first.push(frame, t);
            } else if t >= 120.0 {
                last.push(frame, t);
            }
        }
        k += 1;
    }
    let (baseline, _) =
        session::learn_recorded(robot, &first.finish(), "A", &session::Learning::default())
            .unwrap();
    let with = Some((&baseline, "baseline"));
    session::estimate_recorded(robot, &last.finish(), "C", with, &SessionOptions::default())
        .unwrap()
        .0
}

#[test]
fn simulated_slips_have_correct_cause() {
    let robot = biorob_like();
    for (kind, expected) in [
        ("physical", Cause::Rope),
        ("motor-encoder", Cause::MotorEncoder),
        ("joint-encoder", Cause::JointEncoder),
    ] {
        let (mut found, mut right, mut open) = (0, 0, 0);
        for seed in 0..seeds(1) {
            let result = estimate_session(&robot, 70 + seed, kind, 1);
            for (joint, at_s) in [(PITCH, 130.0), (ELBOW, 150.0)] {
                let steps = result.joints[joint].changes.iter();
                for step in steps
                    .filter(|s| (s.time_s - at_s).abs() < 2.5 && s.kind == TendonChangeKind::Slip)
                {
                    println!(
                        "{kind} seed {seed}: {:+.2} ± {:.2} mrad at {:.1} s: {:?}",
                        1e3 * step.size_rad.unwrap().mean,
                        1e3 * step.size_rad.unwrap().half_width_95(),
                        step.time_s,
                        step.cause.unwrap()
                    );
                    found += 1;
                    right += usize::from(step.cause == Some(expected));
                    open += usize::from(matches!(step.cause, Some(Cause::Unknown(_))));
                }
            }
        }
        println!("{kind}: {found} found, {right} called right, {open} can't be told");
        assert!(found > 0);
        assert_eq!(right + open, found, "{kind}: wrong ones");
        assert!(2 * right > found, "{kind}: {right} of {found}");
    }
    // At 25 Hz a motion of the arm is indistinguishable from an encoder step.
    let result = estimate_session(&robot, 70, "motor-encoder", 10);
    for joint in &result.joints {
        for step in joint
            .changes
            .iter()
            .filter(|s| s.kind == TendonChangeKind::Slip)
        {
            assert!(matches!(step.cause, Some(Cause::Unknown(_))), "{step:?}");
        }
    }
}
