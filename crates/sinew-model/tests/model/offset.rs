//! The offset estimate: what motion, model errors and bad samples do to it.
//!
//! Motions are analytic and torques come from inverse dynamics, so that motor positions
//! `theta = q + tau_el/K + delta_e` are exact and independent of a simulator.

use sinew_model::StepError;
use sinew_model::arm::{Arm, ArmWorkspace};
use sinew_model::offset::{
    Comparison, OffsetConfig, OffsetConfigError, OffsetObserver, Sample, TorqueSource,
    VelocityFilter,
};
use sinew_model::robot::{Robot, RobotFile};
use sinew_model::transmission::{Friction, Transmission};

const N: usize = 4;
const PITCH: usize = 1;
const MRAD: f64 = 1e-3;

/// The arm we ship, without friction: the paper's first panels have none.
fn robot() -> Robot {
    let file = RobotFile::parse(
        include_str!("../../robots/biorob-like/robot.toml"),
        "robot.toml",
    )
    .unwrap();
    let mut robot = file
        .build(include_str!("../../robots/biorob-like/biorob-like.urdf"))
        .unwrap();
    for t in robot.transmissions.iter_mut().flatten() {
        t.joint_friction = Friction::default();
        t.motor_friction = Friction::default();
    }
    robot
}

/// Minimum jerk from 0 to 1 over `duration`, with two derivatives.
fn minimum_jerk(t: f64, duration: f64) -> (f64, f64, f64) {
    let s = (t / duration).clamp(0.0, 1.0);
    (
        s * s * s * (10.0 - 15.0 * s + 6.0 * s * s),
        30.0 * s * s * (1.0 - s) * (1.0 - s) / duration,
        60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / (duration * duration),
    )
}

/// The paper's staircase: shoulder pitch 0 to 90° in four steps, one every 3 s.
fn staircase(t: f64) -> ([f64; N], [f64; N], [f64; N]) {
    let (mut q, mut dq, mut ddq) = ([0.0; N], [0.0; N], [0.0; N]);
    let step = std::f64::consts::FRAC_PI_2 / 4.0;
    for k in 0..4 {
        let (x, v, a) = minimum_jerk(t - 1.0 - 3.0 * f64::from(k), 1.2);
        q[PITCH] += step * x;
        dq[PITCH] += step * v;
        ddq[PITCH] += step * a;
    }
    (q, dq, ddq)
}

const STAIRCASE_S: f64 = 14.0;

struct Truth<'a> {
    robot: &'a Robot,
    ws: ArmWorkspace,
    delta_e: [f64; N],
}

struct State {
    q: [f64; N],
    dq: [f64; N],
    theta: [f64; N],
    tau_el: [f64; N],
}

impl<'a> Truth<'a> {
    fn new(robot: &'a Robot, delta_e: [f64; N]) -> Self {
        Self {
            robot,
            ws: ArmWorkspace::new(&robot.arm),
            delta_e,
        }
    }

    fn at(&mut self, t: f64) -> State {
        let (q, dq, ddq) = staircase(t);
        let tau_el: [f64; N] = self
            .robot
            .arm
            .inverse_dynamics(&mut self.ws, &q, &dq, &ddq)
            .unwrap()
            .try_into()
            .unwrap();
        let mut theta = q;
        for i in 0..N {
            let k = self.robot.transmissions[i]
                .as_ref()
                .unwrap()
                .stiffness_nm_per_rad;
            theta[i] += tau_el[i] / k + self.delta_e[i];
        }
        State {
            q,
            dq,
            theta,
            tau_el,
        }
    }

    /// Motor torque, eq. (2) without friction; the second derivative numerically.
    fn motor_torque(&mut self, t: f64) -> [f64; N] {
        let h = 1e-4;
        let (before, now, after) = (self.at(t - h), self.at(t), self.at(t + h));
        let mut tau = now.tau_el;
        for i in 0..N {
            let inertia = self.robot.transmissions[i]
                .as_ref()
                .unwrap()
                .motor_inertia_kg_m2
                .unwrap();
            tau[i] += inertia * (after.theta[i] - 2.0 * now.theta[i] + before.theta[i]) / (h * h);
        }
        tau
    }
}

/// Largest and final error of the shoulder pitch over the staircase, mrad, and all errors.
fn run(
    truth_robot: &Robot,
    arm: &Arm,
    transmissions: &[Option<Transmission>],
    config: OffsetConfig,
    delta_e: f64,
) -> (f64, f64, Vec<f64>) {
    let mut offsets = [0.0; N];
    offsets[PITCH] = delta_e;
    let mut truth = Truth::new(truth_robot, offsets);
    let mut observer = OffsetObserver::new(arm, transmissions, config).unwrap();
    let dt = 1e-3;
    let mut errors = Vec::new();
    for k in 0..(STAIRCASE_S / dt) as usize {
        let t = k as f64 * dt;
        let s = truth.at(t);
        let tau_m = match config.source {
            TorqueSource::Motor => truth.motor_torque(t),
            _ => [0.0; N],
        };
        let sample = Sample {
            q: &s.q,
            theta_measured: &s.theta,
            dq: Some(&s.dq),
            tau_el: Some(&s.tau_el),
            tau_m: Some(&tau_m),
            tau_ext: None,
        };
        observer.step(dt, &sample).unwrap();
        errors.push((observer.delta_e()[PITCH] - delta_e) / MRAD);
    }
    let peak = errors.iter().fold(0.0f64, |m, e| m.max(e.abs()));
    (peak, *errors.last().unwrap(), errors)
}

fn config(comparison: Comparison, velocity: VelocityFilter) -> OffsetConfig {
    OffsetConfig {
        comparison,
        velocity,
        ..Default::default()
    }
}

#[test]
fn matched_comparison_cancels_motion() {
    let robot = robot();
    let delta_e = 10.0 * MRAD;
    let of = |c| run(&robot, &robot.arm, &robot.transmissions, c, delta_e);
    let (matched, _, _) = of(config(Comparison::Matched, VelocityFilter::Recorded));
    let (paper, rest, _) = of(config(Comparison::Paper, VelocityFilter::Recorded));
    println!(
        "peak error: matched {matched:.5} mrad, paper {paper:.2} mrad, at rest {rest:.4} mrad"
    );
    assert!(matched < 1e-3, "{matched}");
    // The paper's lags by 1/K_I = 50 ms while the torque moves by up to 3.6 N·m · 1.9/1.2 s /4.
    assert!(paper > 0.5, "{paper}");
    assert!(rest.abs() < 0.1, "{rest}");
    // From positions alone the filter adds the curvature of the dynamics over its 2/ω.
    let (encoders, _, _) = of(OffsetConfig::default());
    println!("from positions alone, filter at 40 rad/s: {encoders:.3} mrad");
    assert!(encoders < 0.3, "{encoders}");
}

#[test]
fn model_error_bias_matches_closed_form() {
    let robot = robot();
    let reference = OffsetConfig::default();
    // Straight out at 90°: 0.55·0.12 + 0.3·(0.31 + 0.13) + 0.25·(0.62 + 0.07) kg·m.
    let g: f64 = 9.81 * (0.55 * 0.12 + 0.3 * 0.44 + 0.25 * 0.69);
    assert!((g - 3.635).abs() < 1e-3);
    let k = 40.0;

    let mut stiffer = robot.transmissions.clone();
    for t in stiffer.iter_mut().flatten() {
        t.stiffness_nm_per_rad *= 1.2;
    }
    let (_, error, _) = run(&robot, &robot.arm, &stiffer, reference, 0.0);
    assert!(
        (error - g / k * (1.0 - 1.0 / 1.2) / MRAD).abs() < 0.01,
        "{error}"
    );
    assert!((error - 15.1).abs() < 0.1, "{error}");

    let lighter = robot.arm.with_scaled_masses(0.9).unwrap();
    let (_, error, _) = run(&robot, &lighter, &robot.transmissions, reference, 0.0);
    assert!((error - 0.1 * g / k / MRAD).abs() < 0.01, "{error}");
    assert!((error - 9.1).abs() < 0.1, "{error}");

    // The difference of two estimates is unaffected, too.
    for (arm, transmissions) in [(&robot.arm, &stiffer), (&lighter, &robot.transmissions)] {
        let (_, _, small) = run(&robot, arm, transmissions, reference, 10.0 * MRAD);
        let (_, _, large) = run(&robot, arm, transmissions, reference, 15.0 * MRAD);
        // `errors` are against the offset given, so like errors mean an exact difference.
        let worst = small
            .iter()
            .zip(&large)
            .fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
        assert!(worst < 0.04, "{worst}");
    }
}

#[test]
fn all_torque_sources_estimate_offset() {
    let robot = robot();
    for source in [
        TorqueSource::Observer,
        TorqueSource::TorqueSensor,
        TorqueSource::Motor,
    ] {
        for comparison in [Comparison::Matched, Comparison::Paper] {
            let config = OffsetConfig {
                source,
                comparison,
                ..Default::default()
            };
            let (_, error, _) = run(
                &robot,
                &robot.arm,
                &robot.transmissions,
                config,
                10.0 * MRAD,
            );
            assert!(
                error.abs() < 0.01,
                "{source:?} {comparison:?}: {error} mrad"
            );
        }
    }
}

#[test]
fn measured_torque_is_compared_unfiltered() {
    let robot = robot();
    for comparison in [Comparison::Paper, Comparison::Matched] {
        let config = OffsetConfig {
            source: TorqueSource::TorqueSensor,
            comparison,
            ..OffsetConfig::default()
        };
        let offset = 10.0 * MRAD;
        let (peak, _, _) = run(&robot, &robot.arm, &robot.transmissions, config, offset);
        // Eq. (5) is exact at every sample: what is left is rounding, of a radian in 1e-15.
        assert!(peak < 1e-9, "{comparison:?}: {peak} mrad");
        let observer = OffsetObserver::new(&robot.arm, &robot.transmissions, config).unwrap();
        assert_eq!(
            observer.settling_time_s() == 0.0,
            comparison == Comparison::Paper
        );
    }
}

#[test]
fn rejected_sample_keeps_observer_state() {
    let robot = robot();
    let mut truth = Truth::new(&robot, [5.0 * MRAD; N]);
    let mut observer =
        OffsetObserver::new(&robot.arm, &robot.transmissions, OffsetConfig::default()).unwrap();
    let feed = |observer: &mut OffsetObserver, truth: &mut Truth<'_>, k: u32, dt: f64| {
        let s = truth.at(1.0 + f64::from(k) * 1e-3);
        observer.step(
            dt,
            &Sample {
                q: &s.q,
                theta_measured: &s.theta,
                ..Default::default()
            },
        )
    };
    for k in 0..500 {
        feed(&mut observer, &mut truth, k, 1e-3).unwrap();
    }
    let mut untouched = observer.clone();
    let good = truth.at(1.5);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e200] {
        let mut x = [0.1; N];
        x[2] = bad;
        let samples = [
            Sample {
                q: &x,
                theta_measured: &good.theta,
                ..Default::default()
            },
            Sample {
                q: &good.q,
                theta_measured: &x,
                ..Default::default()
            },
            Sample {
                q: &good.q,
                theta_measured: &good.theta,
                tau_ext: Some(&x),
                ..Default::default()
            },
        ];
        for sample in samples {
            assert_eq!(observer.step(1e-3, &sample), Err(StepError::NotFinite));
        }
    }
    let sample = Sample {
        q: &good.q,
        theta_measured: &good.theta,
        ..Default::default()
    };
    for dt in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(observer.step(dt, &sample), Err(StepError::TimeStep));
    }
    let short = Sample {
        q: &good.q[..2],
        ..sample
    };
    assert_eq!(observer.step(1e-3, &short), Err(StepError::Length));
    // One frame is skipped: both continue with the same step and bitwise identical results.
    feed(&mut observer, &mut truth, 501, 2e-3).unwrap();
    feed(&mut untouched, &mut truth, 501, 2e-3).unwrap();
    assert_eq!(observer.delta_e(), untouched.delta_e());
    assert_eq!(observer.tau_el(), untouched.tau_el());
}

#[test]
fn rigid_joint_needs_no_motor_and_has_no_offset() {
    let robot = robot();
    let mut transmissions = robot.transmissions.clone();
    transmissions[0] = None;
    let mut truth = Truth::new(&robot, [5.0 * MRAD; N]);
    let mut observer =
        OffsetObserver::new(&robot.arm, &transmissions, OffsetConfig::default()).unwrap();
    for k in 0..2000 {
        let mut s = truth.at(f64::from(k) * 1e-3);
        s.theta[0] = f64::NAN;
        let sample = Sample {
            q: &s.q,
            theta_measured: &s.theta,
            ..Default::default()
        };
        observer.step(1e-3, &sample).unwrap();
    }
    assert!(observer.delta_e()[0].is_nan());
    for i in 1..N {
        // 2 s in: the first step of the staircase is under way; the filter's curvature shows.
        assert!(
            (observer.delta_e()[i] - 5.0 * MRAD).abs() < 0.3 * MRAD,
            "{i}"
        );
    }
}

#[test]
fn start_in_motion_settles_in_documented_time() {
    let robot = robot();
    let mut truth = Truth::new(&robot, [0.0; N]);
    let mut observer =
        OffsetObserver::new(&robot.arm, &robot.transmissions, OffsetConfig::default()).unwrap();
    // Start in the middle of the second step, at full speed.
    let mut worst_before = 0.0f64;
    for k in 0..4000 {
        let s = truth.at(4.6 + f64::from(k) * 1e-3);
        let sample = Sample {
            q: &s.q,
            theta_measured: &s.theta,
            ..Default::default()
        };
        observer.step(1e-3, &sample).unwrap();
        let error = observer.delta_e()[PITCH].abs() / MRAD;
        if observer.is_settled() {
            // A thousandth of the start's error and the filter's curvature (0.3 mrad).
            assert!(error < 1e-3 * worst_before + 0.3, "{k}: {error}");
        } else {
            worst_before = worst_before.max(error);
        }
    }
    assert!(
        worst_before > 1.0,
        "the start was not in motion: {worst_before}"
    );
}

#[test]
fn invalid_settings_return_error() {
    let robot = robot();
    let new = |transmissions: &[Option<Transmission>], config| {
        OffsetObserver::new(&robot.arm, transmissions, config).unwrap_err()
    };
    let all = &robot.transmissions;
    let default = OffsetConfig::default();
    for gain_per_s in [0.0, -3.0, f64::NAN, f64::INFINITY] {
        let config = OffsetConfig {
            gain_per_s,
            ..default
        };
        assert!(new(all, config).to_string().contains("1/s"));
    }
    for cutoff_rad_per_s in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let velocity = VelocityFilter::StateVariable { cutoff_rad_per_s };
        assert!(
            new(
                all,
                OffsetConfig {
                    velocity,
                    ..default
                }
            )
            .to_string()
            .contains("rad/s")
        );
    }
    for stiffness in [0.0, -40.0, f64::NAN, f64::INFINITY] {
        let mut bad = all.clone();
        bad[2].as_mut().unwrap().stiffness_nm_per_rad = stiffness;
        assert!(matches!(
            new(&bad, default),
            OffsetConfigError::Stiffness { joint: 2, .. }
        ));
    }
    assert!(matches!(
        new(&all[..3], default),
        OffsetConfigError::Length {
            expected: 4,
            found: 3
        }
    ));
    let motor = OffsetConfig {
        source: TorqueSource::Motor,
        ..default
    };
    let mut bare = all.clone();
    bare[3].as_mut().unwrap().motor_inertia_kg_m2 = None;
    assert!(matches!(
        new(&bare, motor),
        OffsetConfigError::MotorInertia { joint: 3 }
    ));
    let recorded = OffsetConfig {
        velocity: VelocityFilter::Recorded,
        ..motor
    };
    assert_eq!(new(all, recorded), OffsetConfigError::MotorVelocity);
}
