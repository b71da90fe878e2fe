//! The state of the absolute estimate: a pendulum whose every number is known in closed form.

use crate::pendulum::{G, K, LENGTH_M, MASS_KG, PLAIN, Truth, blocks, pendulum, prior};
use sinew_model::Gaussian;
use sinew_model::offset::{
    Block, Executor, FeatureConfig, FeatureObserver, JointParameter, MapError, MapEstimator,
    Payload, Prior, SearchScope, Sequential, StateEstimate, TENSIONED_OFFSET_RAD, Termination,
    UNKNOWN_OFFSET_RAD, state_estimates,
};
use sinew_model::robot::Robot;
use sinew_model::transmission::Friction;

const JOINT_PARAMETERS: usize = JointParameter::Zero as usize + 1;

#[test]
fn offset_and_stiffness_separable_only_in_motion() {
    let robot = pendulum("").unwrap();
    let estimator = MapEstimator::new(prior(&robot), &FeatureConfig::default());
    let start = estimator
        .prior()
        .state_estimate(Payload::Empty, UNKNOWN_OFFSET_RAD);
    let map = estimator
        .solve(&start, &[], Payload::Empty, &blocks(&robot.arm, PLAIN))
        .unwrap();
    let Gaussian { mean: offset, std } = map.offset(estimator.prior(), 0);
    assert!((offset - 0.01).abs() < 2.0 * std, "{offset} ± {std}");
    assert!(std < 1.5e-3, "{std}");
    // The schedule is ten steps long; the last one hardly moved the state.
    let end = map.convergence;
    assert_eq!(
        (end.termination, end.iterations),
        (Termination::SmallStep, 10)
    );
    assert!(end.last_step < 0.1 && end.cost > 0.0, "{end:?}");
    let state_estimate = map.state_estimate(estimator.prior());
    let place = estimator.prior().place(0, JointParameter::Compliance);
    let Gaussian {
        mean: compliance,
        std: unsure,
    } = state_estimate.entry(place);
    // Mass and stiffness are not separable in a single pendulum's statics: only their ratio is determined.
    assert!(
        (compliance - 0.1).abs() < 2.0 * unsure,
        "{compliance} ± {unsure}"
    );

    // At rest, the offset has the whole uncertainty of compliance and mass, 0.12 and 0.065 of the deflection, and of
    // the stiction.
    let stand = Truth {
        swing_rad: [0.0, 1.2],
        ..PLAIN
    };
    let map = estimator
        .solve(&start, &[], Payload::Empty, &blocks(&robot.arm, stand))
        .unwrap();
    let std = map.offset(estimator.prior(), 0).std;
    let deflection = MASS_KG * G * LENGTH_M * 1.2_f64.sin() / K;
    assert!(std > 0.12 * deflection, "{std} of {deflection}");
}

#[test]
fn stiffening_spring_accurate_at_large_deflection() {
    let mut robot = pendulum("").unwrap();
    // All parameters except offset and stiffening have narrow priors.
    let known = &mut robot.tolerances;
    (known.stiffness, known.mass, known.first_moment) = (1e-6, 1e-6, 1e-6);
    (known.first_moment_across, known.encoder_rad) = (1e-6, 1e-9);
    (known.viscoelastic, known.gear) = (1e-9, 1e-9);
    known.stiffening_per_rad2 = Gaussian::new(15.0, 10.0);
    let estimator = MapEstimator::new(prior(&robot), &FeatureConfig::default());
    let start = estimator
        .prior()
        .state_estimate(Payload::Empty, UNKNOWN_OFFSET_RAD);
    let truth = Truth {
        compliance: 0.0,
        cubic_per_rad2: 30.0,
        swing_rad: [1.2, 0.9],
        ..PLAIN
    };
    let map = estimator
        .solve(&start, &[], Payload::Empty, &blocks(&robot.arm, truth))
        .unwrap();
    // At 4.2° of deflection the spring is 16 % stiffer than its first term; the series of its inverse, truncated after
    // the cubic term, has an error of 3 c² d⁵ = 5.8 mrad.
    let offset = map.offset(estimator.prior(), 0).mean;
    assert!((offset - 0.01).abs() < 2e-5, "{offset}");
    let place = estimator.prior().place(0, JointParameter::Stiffening);
    let cubic = map.state_estimate(estimator.prior()).entry(place).mean;
    assert!((cubic - 30.0).abs() < 0.2, "{cubic}");
}

#[test]
fn slack_estimated_for_antagonistic_ropes() {
    let tendon = "[joints.swing.tendon]\nlength_mm = 500.0\njoint_pulley_radius_mm = 20.0\n";
    let pair = pendulum(&format!("{tendon}antagonistic = true\n")).unwrap();
    let single = pendulum(tendon).unwrap();
    let slack = Truth {
        slack_rad: 0.004,
        ..PLAIN
    };
    let solve = |robot: &Robot, truth: Truth| {
        let estimator = MapEstimator::new(prior(robot), &FeatureConfig::default());
        let start = estimator
            .prior()
            .state_estimate(Payload::Empty, UNKNOWN_OFFSET_RAD);
        let map = estimator
            .solve(&start, &[], Payload::Empty, &blocks(&robot.arm, truth))
            .unwrap();
        let state_estimate = map.state_estimate(estimator.prior());
        let place = |p| estimator.prior().place(0, p);
        (
            state_estimate.entry(place(JointParameter::Slack)),
            state_estimate.entry(place(JointParameter::Offset)),
        )
    };
    let (found, known) = solve(&pair, slack);
    let (slack_rad, std) = (found.mean, found.std);
    let (offset, unsure) = (known.mean, known.std);
    assert!(
        (slack_rad - 0.004).abs() < 5e-4 + 2.0 * std,
        "{slack_rad} ± {std}"
    );
    assert!(slack_rad > 5.0 * std);
    assert!((offset - 0.01).abs() < 3.0 * unsure, "{offset} ± {unsure}");
    let (found, _) = solve(&pair, PLAIN);
    let (none, std) = (found.mean, found.std);
    assert!(none.abs() < 3.0 * std + 2e-4, "{none} ± {std}");
    let (fixed, _) = solve(&single, slack);
    assert!(fixed.mean.abs() < 1e-6);
    // Near zero torque a pair's offset is unknown by what the slack may be.
    let hanging = Truth {
        swing_rad: [0.0, 0.0],
        ..slack
    };
    let near_zero = solve(&pair, hanging).1.std;
    assert!(near_zero > 0.2e-3, "{near_zero}");
}

#[test]
fn step_is_found_with_time_and_size() {
    let robot = pendulum("").unwrap();
    let estimator = MapEstimator::new(prior(&robot), &FeatureConfig::default());
    let start = estimator
        .prior()
        .state_estimate(Payload::Empty, UNKNOWN_OFFSET_RAD);
    let scope = SearchScope {
        offsets: true,
        payload: true,
        creep: true,
        continues: false,
        onset: None,
    };
    for step_rad in [0.0, 0.003, -0.005] {
        let truth = Truth { step_rad, ..PLAIN };
        let map = estimator
            .search(&start, &blocks(&robot.arm, truth), Payload::Empty, scope)
            .unwrap();
        if step_rad == 0.0 {
            assert!(map.changes.is_empty(), "{:?}", map.changes);
            continue;
        }
        assert_eq!(map.changes.len(), 1, "{:?}", map.changes);
        let Gaussian { mean: size, std } = map.change(estimator.prior(), 0);
        assert!((size - step_rad).abs() < 3.0 * std + 1e-4, "{size} ± {std}");
        // The low-pass spreads a step over a third of a second.
        assert!(
            (map.changes[0].at_s - 30.0).abs() < 1.0,
            "{:?}",
            map.changes
        );
    }
}

/// A contact provides no information on the sensor noise.
#[test]
fn noise_is_that_of_the_blocks_that_count() {
    const NOISE_RAD: f64 = 1e-3;
    const PUSHED_RAD: f64 = 0.03;
    let robot = pendulum("").unwrap();
    let estimator = MapEstimator::new(prior(&robot), &FeatureConfig::default());
    let start = estimator
        .prior()
        .state_estimate(Payload::Empty, UNKNOWN_OFFSET_RAD);
    // Every fifth segment of two seconds contains a push, or none.
    let solved = |pushed: bool| {
        let mut blocks = blocks(&robot.arm, PLAIN);
        // A sum of twelve even ones is nearly normal with a variance of one; the same at every call.
        let mut seed = 7_u64;
        let mut even = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 11) as f64 / (1_u64 << 53) as f64
        };
        for (b, block) in blocks.iter_mut().enumerate() {
            let normal = (0..12).map(|_| even()).sum::<f64>() - 6.0;
            block.y[0] += NOISE_RAD * normal;
            if pushed && b / 10 % 5 == 4 {
                block.y[0] += PUSHED_RAD;
            }
            let y = block.y[0];
            (block.y_square[0], block.y_cube[0]) = (y * y, y * y * y);
        }
        let map = estimator.solve(&start, &[], Payload::Empty, &blocks);
        map.unwrap()
    };
    let (calm, pushed) = (solved(false), solved(true));
    let [calm_rad, pushed_rad] = [calm.noise_rad[0], pushed.noise_rad[0]];
    println!("{calm_rad} {pushed_rad}");
    assert!((calm_rad / NOISE_RAD - 1.0).abs() < 0.15, "{calm_rad}");
    // A fifth less of them, whose median is good to a twentieth; that of all is 1.38 times as large.
    assert!((pushed_rad / calm_rad - 1.0).abs() < 0.15, "{pushed_rad}");
    let left_out = pushed.weights.iter().filter(|w| **w < 0.5).count() as f64;
    assert!((left_out / pushed.weights.len() as f64 - 0.2).abs() < 0.03);
}

/// A second thread, which begins first.
#[derive(Debug)]
struct TwoThreads;

impl Executor for TwoThreads {
    fn join(&self, one: &mut (dyn FnMut() + Send), other: &mut (dyn FnMut() + Send)) {
        std::thread::scope(|scope| {
            scope.spawn(other);
            one();
        });
    }
}

/// The other thing first.
#[derive(Debug)]
struct OtherFirst;

impl Executor for OtherFirst {
    fn join(&self, one: &mut (dyn FnMut() + Send), other: &mut (dyn FnMut() + Send)) {
        other();
        one();
    }
}

#[test]
fn result_is_bitwise_identical_with_every_executor() {
    let robot = pendulum("").unwrap();
    let estimator = MapEstimator::new(prior(&robot), &FeatureConfig::default());
    let start = estimator
        .prior()
        .state_estimate(Payload::Unknown, UNKNOWN_OFFSET_RAD);
    let scope = SearchScope {
        offsets: true,
        payload: true,
        creep: true,
        continues: false,
        onset: None,
    };
    let truth = Truth {
        step_rad: 0.003,
        ..PLAIN
    };
    let blocks = blocks(&robot.arm, truth);
    let answers = [
        &Sequential as &'static dyn Executor,
        &TwoThreads,
        &OtherFirst,
    ]
    .map(|executor| {
        let estimator = estimator.clone().with_executor(executor);
        let map = estimator.search(&start, &blocks, Payload::Unknown, scope);
        let map = map.unwrap();
        assert!(!map.changes.is_empty());
        assert_eq!(map.weights.len(), blocks.len());
        // Every digit, and NaN as itself.
        format!("{map:?}")
    });
    assert!(answers.iter().all(|a| *a == answers[0]));
}

#[test]
fn posteriors_merge_once_and_age_towards_prior() {
    let robot = pendulum("").unwrap();
    let estimator = MapEstimator::new(prior(&robot), &FeatureConfig::default());
    let prior = estimator.prior();
    let common = prior.state_estimate(Payload::Empty, TENSIONED_OFFSET_RAD);
    let learn = |truth: Truth| {
        let tensioned = Truth {
            offset_rad: 0.0,
            ..truth
        };
        estimator
            .solve(&common, &[], Payload::Empty, &blocks(&robot.arm, tensioned))
            .unwrap()
            .state_estimate(prior)
    };
    let a = learn(PLAIN);
    let b = learn(Truth {
        swing_rad: [0.9, -0.4],
        ..PLAIN
    });
    let place = prior.place(0, JointParameter::Compliance);
    // What one learned, put together with what the other did not, is what the one learned.
    let same = state_estimates::merge(prior, &common, &a, &common).unwrap();
    let Gaussian { mean, std } = same.entry(place);
    let Gaussian {
        mean: expected,
        std: expected_std,
    } = a.entry(place);
    assert!((mean - expected).abs() < 1e-6 && (std - expected_std).abs() < 1e-6);
    // Two informative posteriors give a narrower one than either, in any order.
    let ab = state_estimates::merge(prior, &common, &a, &b).unwrap();
    let ba = state_estimates::merge(prior, &common, &b, &a).unwrap();
    let Gaussian { mean, std } = ab.entry(place);
    assert!(std <= expected_std.min(b.entry(place).std) + 1e-12);
    assert!((mean - ba.entry(place).mean).abs() < 1e-9);
    assert!(matches!(
        state_estimates::merge(
            prior,
            &common,
            &a,
            &StateEstimate {
                mean: vec![],
                ..b.clone()
            }
        ),
        Err(MapError::Dimension { found: 0, .. })
    ));

    // Both have wider posteriors of the stiffness than the prior: the result has the same information as they have.
    let d = prior.dimension();
    for looser in [1.2, 1.9, 9.0] {
        let lost = [-0.06, -0.02].map(|change| {
            let mut of = a.clone();
            of.mean[place] += change;
            of.covariance[place * (d + 1)] *= looser;
            of
        });
        let both = state_estimates::merge(prior, &a, &lost[0], &lost[1]).unwrap();
        let Gaussian { mean, std } = both.entry(place);
        let Gaussian {
            mean: before,
            std: each,
        } = lost[0].entry(place);
        assert!((std - each).abs() < 1e-9 * each, "{std} {each}");
        let expected = before + 0.02;
        assert!((mean - expected).abs() < 1e-9, "{mean} {expected}");
    }

    let mut aged = a.clone();
    for _ in 0..20_000 {
        let before = aged.entry(place).std;
        state_estimates::age(prior, &mut aged);
        assert!(aged.entry(place).std >= before);
    }
    let oldest = aged.entry(place).std;
    assert!((oldest - common.entry(place).std).abs() < 1e-9, "{oldest}");
}

#[test]
fn state_entries_have_names() {
    let robot = pendulum("").unwrap();
    let prior = prior(&robot);
    for k in 0..prior.dimension() {
        assert!(!prior.describe(k).unwrap().name.is_empty());
    }
    assert_eq!(prior.describe(prior.dimension()), None);
    assert_eq!(prior.dimension(), JOINT_PARAMETERS + 10 + 4);
    let offset = prior
        .describe(prior.place(0, JointParameter::Offset))
        .unwrap();
    assert_eq!((offset.name, offset.unit), ("offset", "rad"));
    let initial_friction = prior
        .describe(prior.place(0, JointParameter::InitialFriction))
        .unwrap();
    assert!(initial_friction.name.starts_with("friction at the start"));
}

#[test]
fn tolerances_come_from_the_robot_file() {
    let robot =
        pendulum("[tolerances]\nstiffness_percent = 5.0\npayload_reach_mm = 20.0\n").unwrap();
    assert_eq!(robot.tolerances.stiffness, 0.05);
    assert_eq!(robot.tolerances.payload_reach_m, 0.02);
    let prior = prior(&robot);
    let state_estimate = prior.state_estimate(Payload::Unknown, 0.03);
    let place = prior.place(0, JointParameter::Compliance);
    assert!((state_estimate.entry(place).std - 0.05).abs() < 1e-12);
    for (text, said) in [
        (
            "[tolerances]\nstiffness = 5.0\n",
            "tolerances: unknown key 'stiffness'",
        ),
        (
            "[tolerances]\nmass_percent = -1.0\n",
            "tolerances.mass_percent = -1",
        ),
        (
            "[tolerances]\nmass_percent = nan\n",
            "tolerances.mass_percent = nan",
        ),
    ] {
        let error = pendulum(text).unwrap_err().to_string();
        assert!(error.contains(said), "{error}");
        assert!(error.contains("line"), "{error}");
    }
}

/// A joint without specified friction is not assumed to be frictionless.
#[test]
fn unspecified_friction_has_default_with_100_percent_std() {
    let entry = |more: &str, parameter| {
        let robot = pendulum(more).unwrap();
        let mut transmissions = robot.transmissions.clone();
        if more.is_empty() {
            transmissions[0].as_mut().unwrap().joint_friction = Friction::default();
        }
        let at = [0.0, 0.0, -LENGTH_M];
        let prior = Prior::new(&robot.arm, &transmissions, 0, at, robot.tolerances);
        let state_estimate = prior.state_estimate(Payload::Empty, UNKNOWN_OFFSET_RAD);
        state_estimate.entry(prior.place(0, parameter))
    };
    let stated = "motor_friction = { coulomb_nm = 0.06, viscous_nm_s_per_rad = 0.02 }\n";
    // Two thousandths of the stiffness at rest, 0.6 of that at a rad per second, a hundredth for the drive.
    let guess = 2e-3 * K;
    for (more, parameter, expected) in [
        ("", JointParameter::Coulomb, [guess, guess]),
        ("", JointParameter::Viscous, [0.6 * guess; 2]),
        ("", JointParameter::MotorCoulomb, [5.0 * guess; 2]),
        ("", JointParameter::MotorViscous, [3.0 * guess; 2]),
        (stated, JointParameter::Coulomb, [0.01, 0.005]),
        (stated, JointParameter::MotorCoulomb, [0.06, 0.03]),
        (stated, JointParameter::MotorViscous, [0.02, 0.01]),
    ] {
        let found = entry(more, parameter);
        for (found, expected) in [found.mean, found.std].into_iter().zip(expected) {
            assert!(
                (found - expected).abs() < 1e-12,
                "{parameter:?}: {found} {expected}"
            );
        }
    }
}

#[test]
fn without_blocks_there_is_no_estimate() {
    let robot = pendulum("").unwrap();
    let estimator = MapEstimator::new(prior(&robot), &FeatureConfig::default());
    let start = estimator
        .prior()
        .state_estimate(Payload::Empty, UNKNOWN_OFFSET_RAD);
    assert_eq!(
        estimator.solve(&start, &[], Payload::Empty, &[]),
        Err(MapError::NoData)
    );
}

/// Returns the shift of the offset by a push of the arm during some blocks, and the change of its standard deviation;
/// both in standard deviations of the run without push.
fn moved_by_push(calm: &[Block], pushed: core::ops::Range<usize>, pushed_rad: f64) -> [f64; 2] {
    let robot = pendulum("").unwrap();
    let estimator = MapEstimator::new(prior(&robot), &FeatureConfig::default());
    let start = estimator
        .prior()
        .state_estimate(Payload::Empty, UNKNOWN_OFFSET_RAD);
    let offset = |pushed_rad: f64| {
        let mut blocks = calm.to_vec();
        for block in &mut blocks[pushed.clone()] {
            block.y[0] += pushed_rad;
        }
        let map = estimator.solve(&start, &[], Payload::Empty, &blocks);
        map.unwrap().offset(estimator.prior(), 0)
    };
    let Gaussian { mean: calm, std } = offset(0.0);
    let Gaussian {
        mean: found,
        std: left,
    } = offset(pushed_rad);
    let error = calm - PLAIN.offset_rad;
    assert!(error.abs() < 2.0 * std, "{calm} ± {std}");
    [(found - calm).abs() / std, left / std]
}

#[test]
fn push_is_rejected_without_prior_information() {
    let calm = blocks(&pendulum("").unwrap().arm, PLAIN);
    for first in [0, 3, 8, 15, 25, 60, 150] {
        for (length, moved_most) in [(3, 0.05), (6, 0.1), (12, 0.2), (25, 0.5)] {
            for pushed_mrad in [-200.0, -50.0, -20.0, 20.0, 50.0, 200.0] {
                let [moved, std] = moved_by_push(&calm, first..first + length, 1e-3 * pushed_mrad);
                let said = format!(
                    "{length} blocks from {first} pushed by {pushed_mrad} mrad: {moved:.3}, {std:.3}"
                );
                println!("{said}");
                // A wider answer may be further off.
                assert!(moved < moved_most * std, "{said}");
                assert!(std < 5.0, "{said}");
            }
        }
    }
}

#[test]
fn ageing_widens_friction_more_than_other_parameters() {
    let robot = pendulum("").unwrap();
    let prior = prior(&robot);
    let fresh = prior.state_estimate(Payload::Unknown, UNKNOWN_OFFSET_RAD);
    let d = prior.dimension();
    let mut known = fresh.clone();
    for x in &mut known.covariance {
        *x *= 0.04;
    }
    let learned = known.clone();
    state_estimates::age(&prior, &mut known);
    let grown = |p: JointParameter| {
        let k = prior.place(0, p) * (d + 1);
        (known.covariance[k] - learned.covariance[k]) / fresh.covariance[k]
    };
    for (parameter, share) in [
        (JointParameter::Coulomb, 0.1),
        (JointParameter::LoadFriction, 0.1),
        (JointParameter::MotorCoulomb, 0.1),
        (JointParameter::Compliance, 0.01),
        (JointParameter::Stiffening, 0.01),
        (JointParameter::Viscoelastic, 0.01),
        (JointParameter::Offset, 0.0),
        (JointParameter::InitialFriction, 0.0),
        (JointParameter::Zero, 0.0),
    ] {
        let expected: f64 = share * share;
        assert!((grown(parameter) - expected).abs() < 1e-12, "{parameter:?}");
    }
    // The result is at least as narrow as the data sheet.
    let mut unknown = fresh.clone();
    state_estimates::age(&prior, &mut unknown);
    assert_eq!(unknown.covariance, fresh.covariance);
}

#[test]
fn vibrating_joint_has_unknown_friction() {
    let robot = pendulum("").unwrap();
    let unknown = |travel_rad: f64| {
        let mut features = FeatureObserver::new(&robot.arm, FeatureConfig::default());
        let mut last = 1.0;
        for k in 0..2500 {
            let t = f64::from(k) * 0.004;
            let q = 0.4 + 0.5 * travel_rad * (4.0 * t).sin();
            if features.step(0.004, &[q], &[q + 0.05], &[f64::NAN], f64::NAN) == Ok(true) {
                last = features.block().z_unknown[0];
            }
        }
        last
    };
    // Quantisation makes a standing joint seem to move by a step of its encoder, 0.8 mrad, or two.
    assert!(unknown(0.0) > 0.999, "{}", unknown(0.0));
    let shaken = unknown(2e-3);
    assert!((shaken - 0.9).abs() < 0.02, "{shaken}");
    assert!(unknown(0.03) < 1e-6, "{}", unknown(0.03));
}

/// On a ramp every filter is exact at any step, so that a rate that changes on the way leaves no trace.
#[test]
fn features_follow_a_rate_that_changes() {
    const SPEED: f64 = 0.03;
    let robot = pendulum("").unwrap();
    let mut features = FeatureObserver::new(&robot.arm, FeatureConfig::default());
    let (mut t, mut last, mut checked) = (0.0, 0.0, 0);
    // Regressors every 12 ms, or as near as samples come.
    for (dt, step) in [(0.004, 0.012), (0.010, 0.010), (0.001, 0.012)] {
        let since = t;
        for _ in 0..(8.0 / dt) as usize {
            t += dt;
            let q = SPEED * t;
            if features.step(dt, &[q], &[q + 0.05], &[f64::NAN], f64::NAN) != Ok(true) {
                continue;
            }
            let block = features.block();
            let length = block.time_s - last;
            last = block.time_s;
            assert!((block.y[0] - 0.05).abs() < 1e-9, "{dt}: {}", block.y[0]);
            // The first block, and one that began before the rate changed, have no length of their own.
            if t < since + 3.0 {
                continue;
            }
            checked += 1;
            // What the start, at rest, leaves of the lag dies with exp(-3 t).
            let left = SPEED * (-3.0 * (t - 1.0)).exp();
            let off = (block.dq[0] - SPEED).abs();
            assert!(off < left + 1e-9, "{dt}, {t}: {off} {left}");
            // The low-pass is a third of a second behind, the mean over a block half of it.
            let behind = SPEED * (1.0 / 3.0 + 0.5 * (length - step));
            let off = (block.q[0] - block.turned[0] - behind).abs();
            assert!(off < left + 1e-9, "{dt}, {t}: {off} {left}");
        }
    }
    assert!(checked > 60, "{checked}");
}

/// At rest `Φ z = g`: the described torque, and that of 1 kg at the end of the rod, divided by the stiffness.
#[test]
fn payload_deflection_matches_statics() {
    let robot = pendulum("").unwrap();
    let stand = Truth {
        swing_rad: [0.0, 1.2],
        ..PLAIN
    };
    let blocks = blocks(&robot.arm, stand);
    // Where the bob is, in the frame whose z is the joint's axis.
    let at = robot.arm.body(0).unwrap().com;
    let prior = Prior::new(&robot.arm, &robot.transmissions, 0, at, robot.tolerances);
    let told = prior.described_deflections_rad(&blocks, 0);
    let [own, kilogram, along @ ..] = *told.last().unwrap();
    let g = robot.arm.gravity()[2].abs();
    let per_kg = g * LENGTH_M * 1.2_f64.sin() / K;
    assert!((own / (MASS_KG * per_kg) - 1.0).abs() < 1e-6, "{own}");
    assert!((kilogram / per_kg - 1.0).abs() < 1e-6, "{kilogram}");
    // A moment along the rod turns it as a kilogram a metre further out would.
    let metre = g * 1.2_f64.sin() / K;
    let rod: f64 = (along.iter().zip(at))
        .map(|(turn, along)| turn * along / LENGTH_M)
        .sum();
    assert!((rod / metre - 1.0).abs() < 1e-6, "{along:?}");
}
