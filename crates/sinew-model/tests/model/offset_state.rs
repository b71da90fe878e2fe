//! The state of the absolute estimate: a pendulum whose every number is known in closed form.

use crate::pendulum::{G, K, LENGTH_M, MASS_KG, PLAIN, Truth, blocks, pendulum, prior};
use sinew_model::Gaussian;
use sinew_model::offset::{
    Belief, Block, Executor, FeatureConfig, FeatureObserver, JointParameter, MapError,
    MapEstimator, Payload, Prior, SearchScope, Sequential, TENSIONED_OFFSET_RAD, Termination,
    UNKNOWN_OFFSET_RAD, beliefs,
};
use sinew_model::robot::Robot;
use sinew_model::transmission::Friction;

const JOINT_PARAMETERS: usize = JointParameter::Zero as usize + 1;

#[test]
fn offset_and_stiffness_are_told_apart_by_a_swing_and_not_by_a_stand() {
    let robot = pendulum("").unwrap();
    let estimator = MapEstimator::new(prior(&robot), &FeatureConfig::default());
    let start = estimator.prior().belief(Payload::Empty, UNKNOWN_OFFSET_RAD);
    let map = estimator
        .solve(&start, &[], Payload::Empty, &blocks(&robot.arm, PLAIN))
        .unwrap();
    let Gaussian {
        mean: offset,
        deviation,
    } = map.offset(estimator.prior(), 0);
    assert!(
        (offset - 0.01).abs() < 2.0 * deviation,
        "{offset} ± {deviation}"
    );
    assert!(deviation < 1.5e-3, "{deviation}");
    // The schedule is ten steps long; the last one hardly moved the state.
    let end = map.convergence;
    assert_eq!(
        (end.termination, end.iterations),
        (Termination::SmallStep, 10)
    );
    assert!(end.last_step < 0.1 && end.cost > 0.0, "{end:?}");
    let belief = map.belief(estimator.prior());
    let place = estimator.prior().place(0, JointParameter::Compliance);
    let Gaussian {
        mean: compliance,
        deviation: unsure,
    } = belief.entry(place);
    // Mass and stiffness are one in a single pendulum's statics: only their ratio is sure.
    assert!(
        (compliance - 0.1).abs() < 2.0 * unsure,
        "{compliance} ± {unsure}"
    );

    // Standing, the offset is the whole of the compliance's and mass's uncertainty:
    // 0.12 and 0.065 of the deflection, and what friction holds.
    let stand = Truth {
        swing_rad: [0.0, 1.2],
        ..PLAIN
    };
    let map = estimator
        .solve(&start, &[], Payload::Empty, &blocks(&robot.arm, stand))
        .unwrap();
    let deviation = map.offset(estimator.prior(), 0).deviation;
    let deflection = MASS_KG * G * LENGTH_M * 1.2_f64.sin() / K;
    assert!(deviation > 0.12 * deflection, "{deviation} of {deflection}");
}

#[test]
fn a_stiffening_spring_is_followed_however_far_it_is_stretched() {
    let mut robot = pendulum("").unwrap();
    // All but offset and stiffening is known.
    let known = &mut robot.tolerances;
    (known.stiffness, known.mass, known.first_moment) = (1e-6, 1e-6, 1e-6);
    (known.first_moment_across, known.encoder_rad) = (1e-6, 1e-9);
    (known.viscoelastic, known.gear) = (1e-9, 1e-9);
    known.stiffening_per_rad2 = Gaussian::new(15.0, 10.0);
    let estimator = MapEstimator::new(prior(&robot), &FeatureConfig::default());
    let start = estimator.prior().belief(Payload::Empty, UNKNOWN_OFFSET_RAD);
    let truth = Truth {
        compliance: 0.0,
        cubic_per_rad2: 30.0,
        swing_rad: [1.2, 0.9],
        ..PLAIN
    };
    let map = estimator
        .solve(&start, &[], Payload::Empty, &blocks(&robot.arm, truth))
        .unwrap();
    // At 4.2° of deflection the spring is 16 % stiffer than its first term says; the series of its
    // inverse, cut after the cubic, is 3 c² d⁵ = 5.8 mrad off.
    let offset = map.offset(estimator.prior(), 0).mean;
    assert!((offset - 0.01).abs() < 2e-5, "{offset}");
    let place = estimator.prior().place(0, JointParameter::Stiffening);
    let cubic = map.belief(estimator.prior()).entry(place).mean;
    assert!((cubic - 30.0).abs() < 0.2, "{cubic}");
}

#[test]
fn a_dead_zone_is_seen_where_the_robot_file_says_that_two_ropes_pull() {
    let tendon = "[joints.swing.tendon]\nlength_mm = 500.0\njoint_pulley_radius_mm = 20.0\n";
    let pair = pendulum(&format!("{tendon}antagonistic = true\n")).unwrap();
    let single = pendulum(tendon).unwrap();
    let slack = Truth {
        slack_rad: 0.004,
        ..PLAIN
    };
    let solve = |robot: &Robot, truth: Truth| {
        let estimator = MapEstimator::new(prior(robot), &FeatureConfig::default());
        let start = estimator.prior().belief(Payload::Empty, UNKNOWN_OFFSET_RAD);
        let map = estimator
            .solve(&start, &[], Payload::Empty, &blocks(&robot.arm, truth))
            .unwrap();
        let belief = map.belief(estimator.prior());
        let place = |p| estimator.prior().place(0, p);
        (
            belief.entry(place(JointParameter::Slack)),
            belief.entry(place(JointParameter::Offset)),
        )
    };
    let (found, known) = solve(&pair, slack);
    let (slack_rad, deviation) = (found.mean, found.deviation);
    let (offset, unsure) = (known.mean, known.deviation);
    assert!(
        (slack_rad - 0.004).abs() < 5e-4 + 2.0 * deviation,
        "{slack_rad} ± {deviation}"
    );
    assert!(slack_rad > 5.0 * deviation);
    assert!((offset - 0.01).abs() < 3.0 * unsure, "{offset} ± {unsure}");
    let (found, _) = solve(&pair, PLAIN);
    let (none, deviation) = (found.mean, found.deviation);
    assert!(none.abs() < 3.0 * deviation + 2e-4, "{none} ± {deviation}");
    let (fixed, _) = solve(&single, slack);
    assert!(fixed.mean.abs() < 1e-6);
    // Near zero torque a pair's offset is unknown by what the slack may be.
    let hanging = Truth {
        swing_rad: [0.0, 0.0],
        ..slack
    };
    let near_zero = solve(&pair, hanging).1.deviation;
    assert!(near_zero > 0.2e-3, "{near_zero}");
}

#[test]
fn a_step_is_found_with_its_time_and_size() {
    let robot = pendulum("").unwrap();
    let estimator = MapEstimator::new(prior(&robot), &FeatureConfig::default());
    let start = estimator.prior().belief(Payload::Empty, UNKNOWN_OFFSET_RAD);
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
        let Gaussian {
            mean: size,
            deviation,
        } = map.change(estimator.prior(), 0);
        assert!(
            (size - step_rad).abs() < 3.0 * deviation + 1e-4,
            "{size} ± {deviation}"
        );
        // The low-pass spreads a step over a third of a second.
        assert!(
            (map.changes[0].at_s - 30.0).abs() < 1.0,
            "{:?}",
            map.changes
        );
    }
}

/// A contact says nothing about what the sensors do.
#[test]
fn noise_is_that_of_the_blocks_that_count() {
    const NOISE_RAD: f64 = 1e-3;
    const PUSHED_RAD: f64 = 0.03;
    let robot = pendulum("").unwrap();
    let estimator = MapEstimator::new(prior(&robot), &FeatureConfig::default());
    let start = estimator.prior().belief(Payload::Empty, UNKNOWN_OFFSET_RAD);
    // Every fifth stretch of two seconds pushed, or none.
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
fn whoever_does_what_the_answer_is_the_same_to_the_last_bit() {
    let robot = pendulum("").unwrap();
    let estimator = MapEstimator::new(prior(&robot), &FeatureConfig::default());
    let start = estimator
        .prior()
        .belief(Payload::Unknown, UNKNOWN_OFFSET_RAD);
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
fn beliefs_are_put_together_once_and_age_towards_the_prior() {
    let robot = pendulum("").unwrap();
    let estimator = MapEstimator::new(prior(&robot), &FeatureConfig::default());
    let prior = estimator.prior();
    let common = prior.belief(Payload::Empty, TENSIONED_OFFSET_RAD);
    let learn = |truth: Truth| {
        let tensioned = Truth {
            offset_rad: 0.0,
            ..truth
        };
        estimator
            .solve(&common, &[], Payload::Empty, &blocks(&robot.arm, tensioned))
            .unwrap()
            .belief(prior)
    };
    let a = learn(PLAIN);
    let b = learn(Truth {
        swing_rad: [0.9, -0.4],
        ..PLAIN
    });
    let place = prior.place(0, JointParameter::Compliance);
    // What one learned, put together with what the other did not, is what the one learned.
    let same = beliefs::merge(prior, &common, &a, &common).unwrap();
    let Gaussian { mean, deviation } = same.entry(place);
    let Gaussian {
        mean: expected,
        deviation: expected_deviation,
    } = a.entry(place);
    assert!((mean - expected).abs() < 1e-6 && (deviation - expected_deviation).abs() < 1e-6);
    // Two that learned are surer than either, in any order.
    let ab = beliefs::merge(prior, &common, &a, &b).unwrap();
    let ba = beliefs::merge(prior, &common, &b, &a).unwrap();
    let Gaussian { mean, deviation } = ab.entry(place);
    assert!(deviation <= expected_deviation.min(b.entry(place).deviation) + 1e-12);
    assert!((mean - ba.entry(place).mean).abs() < 1e-9);
    assert!(matches!(
        beliefs::merge(
            prior,
            &common,
            &a,
            &Belief {
                mean: vec![],
                ..b.clone()
            }
        ),
        Err(MapError::Dimension { found: 0, .. })
    ));

    // Both know less of the stiffness than they started with: as much as they know, and no more.
    let d = prior.dimension();
    for looser in [1.2, 1.9, 9.0] {
        let lost = [-0.06, -0.02].map(|change| {
            let mut of = a.clone();
            of.mean[place] += change;
            of.covariance[place * (d + 1)] *= looser;
            of
        });
        let both = beliefs::merge(prior, &a, &lost[0], &lost[1]).unwrap();
        let Gaussian { mean, deviation } = both.entry(place);
        let Gaussian {
            mean: before,
            deviation: each,
        } = lost[0].entry(place);
        assert!((deviation - each).abs() < 1e-9 * each, "{deviation} {each}");
        let expected = before + 0.02;
        assert!((mean - expected).abs() < 1e-9, "{mean} {expected}");
    }

    let mut aged = a.clone();
    for _ in 0..20_000 {
        let before = aged.entry(place).deviation;
        beliefs::age(prior, &mut aged);
        assert!(aged.entry(place).deviation >= before);
    }
    let oldest = aged.entry(place).deviation;
    assert!(
        (oldest - common.entry(place).deviation).abs() < 1e-9,
        "{oldest}"
    );
}

#[test]
fn every_entry_of_the_state_has_a_name() {
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
    let stuck = prior
        .describe(prior.place(0, JointParameter::Stuck))
        .unwrap();
    assert!(stuck.name.starts_with("friction at the start"));
}

#[test]
fn tolerances_come_from_the_robot_file() {
    let robot =
        pendulum("[tolerances]\nstiffness_percent = 5.0\npayload_reach_mm = 20.0\n").unwrap();
    assert_eq!(robot.tolerances.stiffness, 0.05);
    assert_eq!(robot.tolerances.payload_reach_m, 0.02);
    let prior = prior(&robot);
    let belief = prior.belief(Payload::Unknown, 0.03);
    let place = prior.place(0, JointParameter::Compliance);
    assert!((belief.entry(place).deviation - 0.05).abs() < 1e-12);
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

/// A joint of which no friction is stated isn't believed to be without.
#[test]
fn friction_nobody_stated_is_a_guess_that_may_be_wrong_by_all_of_itself() {
    let entry = |more: &str, parameter| {
        let robot = pendulum(more).unwrap();
        let mut transmissions = robot.transmissions.clone();
        if more.is_empty() {
            transmissions[0].as_mut().unwrap().joint_friction = Friction::default();
        }
        let at = [0.0, 0.0, -LENGTH_M];
        let prior = Prior::new(&robot.arm, &transmissions, 0, at, robot.tolerances);
        let belief = prior.belief(Payload::Empty, UNKNOWN_OFFSET_RAD);
        belief.entry(prior.place(0, parameter))
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
        for (found, expected) in [found.mean, found.deviation].into_iter().zip(expected) {
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
    let start = estimator.prior().belief(Payload::Empty, UNKNOWN_OFFSET_RAD);
    assert_eq!(
        estimator.solve(&start, &[], Payload::Empty, &[]),
        Err(MapError::NoData)
    );
}

/// How far a push of the arm during some blocks moves the offset, and its deviation; both in deviations of the calm run.
fn moved_by_push(calm: &[Block], pushed: core::ops::Range<usize>, pushed_rad: f64) -> [f64; 2] {
    let robot = pendulum("").unwrap();
    let estimator = MapEstimator::new(prior(&robot), &FeatureConfig::default());
    let start = estimator.prior().belief(Payload::Empty, UNKNOWN_OFFSET_RAD);
    let offset = |pushed_rad: f64| {
        let mut blocks = calm.to_vec();
        for block in &mut blocks[pushed.clone()] {
            block.y[0] += pushed_rad;
        }
        let map = estimator.solve(&start, &[], Payload::Empty, &blocks);
        map.unwrap().offset(estimator.prior(), 0)
    };
    let Gaussian {
        mean: calm,
        deviation,
    } = offset(0.0);
    let Gaussian {
        mean: found,
        deviation: left,
    } = offset(pushed_rad);
    let error = calm - PLAIN.offset_rad;
    assert!(error.abs() < 2.0 * deviation, "{calm} ± {deviation}");
    [(found - calm).abs() / deviation, left / deviation]
}

#[test]
fn a_push_is_left_out_in_the_end_even_where_nothing_was_known() {
    let calm = blocks(&pendulum("").unwrap().arm, PLAIN);
    for first in [0, 3, 8, 15, 25, 60, 150] {
        for (length, moved_most) in [(3, 0.05), (6, 0.1), (12, 0.2), (25, 0.5)] {
            for pushed_mrad in [-200.0, -50.0, -20.0, 20.0, 50.0, 200.0] {
                let [moved, deviation] =
                    moved_by_push(&calm, first..first + length, 1e-3 * pushed_mrad);
                let said = format!(
                    "{length} blocks from {first} pushed by {pushed_mrad} mrad: {moved:.3}, {deviation:.3}"
                );
                println!("{said}");
                // A wider answer may be further off.
                assert!(moved < moved_most * deviation, "{said}");
                assert!(deviation < 5.0, "{said}");
            }
        }
    }
}

#[test]
fn from_one_recording_to_the_next_friction_is_believed_less_than_the_rest() {
    let robot = pendulum("").unwrap();
    let prior = prior(&robot);
    let fresh = prior.belief(Payload::Unknown, UNKNOWN_OFFSET_RAD);
    let d = prior.dimension();
    let mut known = fresh.clone();
    for x in &mut known.covariance {
        *x *= 0.04;
    }
    let learned = known.clone();
    beliefs::age(&prior, &mut known);
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
        (JointParameter::Stuck, 0.0),
        (JointParameter::Zero, 0.0),
    ] {
        let expected: f64 = share * share;
        assert!((grown(parameter) - expected).abs() < 1e-12, "{parameter:?}");
    }
    // Never less sure than the data sheet.
    let mut unknown = fresh.clone();
    beliefs::age(&prior, &mut unknown);
    assert_eq!(unknown.covariance, fresh.covariance);
}

#[test]
fn a_joint_that_only_shakes_has_unknown_friction() {
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

/// At rest `Φ z = g`: what is described, and a kilogram at the end of the rod, over the stiffness.
#[test]
fn what_a_payload_would_turn_a_joint_by_is_told_beforehand() {
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
