//! Stiffness lost between two recordings.

use crate::pendulum::{PLAIN, Truth, blocks, pendulum, prior};
use sinew_model::Gaussian;
use sinew_model::offset::{
    FeatureConfig, MapEstimator, Payload, SearchScope, StateEstimate, TENSIONED_OFFSET_RAD,
    UNKNOWN_OFFSET_RAD, state_estimates,
};

const SCOPE: SearchScope = SearchScope {
    offsets: true,
    payload: false,
    creep: true,
    continues: false,
    onset: None,
};

/// Returns the posterior of a recording directly after tensioning.
fn learned(estimator: &MapEstimator) -> StateEstimate {
    learned_of(estimator, PLAIN)
}

/// The same of a rope as it is.
fn learned_of(estimator: &MapEstimator, truth: Truth) -> StateEstimate {
    let prior = estimator.prior();
    let tensioned = Truth {
        offset_rad: 0.0,
        ..truth
    };
    let calm = blocks(&pendulum("").unwrap().arm, tensioned);
    let start = prior.state_estimate(Payload::Empty, TENSIONED_OFFSET_RAD);
    let map = estimator.solve(&start, &[], Payload::Empty, &calm).unwrap();
    let mut state_estimate = map.state_estimate(prior);
    state_estimates::age(prior, &mut state_estimate);
    prior.reset_offsets(&mut state_estimate, UNKNOWN_OFFSET_RAD);
    state_estimate
}

#[test]
fn stiffness_loss_probability_increases_with_loss() {
    let robot = pendulum("").unwrap();
    let estimator = MapEstimator::new(prior(&robot), &FeatureConfig::default());
    let state_estimate = learned(&estimator);
    let mut last = 0.0;
    for loss in [0.0, 0.003, 0.005, 0.006, 0.08] {
        let truth = Truth {
            compliance: (1.0 + PLAIN.compliance) / (1.0 - loss) - 1.0,
            ..PLAIN
        };
        let blocks = blocks(&robot.arm, truth);
        let map = estimator
            .search(&state_estimate, &blocks, Payload::Empty, SCOPE)
            .unwrap();
        let Gaussian { mean: offset, std } = map.offset(estimator.prior(), 0);
        let since = map.stiffness_changes[0].unwrap();
        println!("{loss}: {offset:.5} ± {std:.5}, {since:?}");
        assert!((offset - truth.offset_rad).abs() < 2.0 * std, "{offset}");
        assert!(since.probability >= last, "{since:?}");
        last = since.probability;
        let lost = truth.compliance - PLAIN.compliance;
        assert!(
            since.probability < 0.5 || (since.compliance_increase.mean / lost - 1.0).abs() < 0.2
        );
        if loss == 0.0 {
            assert!(since.probability < 0.1, "{since:?}");
        }
    }
    assert!(last > 0.9, "{last}");
}

/// A strand failure reduces the actual stiffness by a share, independent of its ratio to `robot.toml`: the prior of the loss
/// has zero mean and is independent of the stiffness from the baseline.
#[test]
fn stiffness_loss_share_independent_of_stiffness() {
    let robot = pendulum("").unwrap();
    let estimator = MapEstimator::new(prior(&robot), &FeatureConfig::default());
    for before in [-0.12, 0.0, 0.12] {
        let truth = Truth {
            compliance: before,
            ..PLAIN
        };
        let state_estimate = learned_of(&estimator, truth);
        for loss in [0.0, 0.08] {
            let after = (1.0 + before) / (1.0 - loss) - 1.0;
            let softer = Truth {
                compliance: after,
                ..truth
            };
            let blocks = blocks(&robot.arm, softer);
            let map = estimator
                .search(&state_estimate, &blocks, Payload::Empty, SCOPE)
                .unwrap();
            let since = map.stiffness_changes[0].unwrap();
            let share = since.compliance_increase.scaled(1.0 / (1.0 + after));
            let probability = since.probability;
            println!("{before} {loss}: {probability:?}, {share:?}");
            match loss > 0.0 {
                true => assert!(probability > 0.9, "{before}: {probability}"),
                false => assert!(probability < 0.1, "{before}: {probability}"),
            }
            if loss > 0.0 {
                let wrong = (share.mean - loss).abs();
                assert!(wrong < 2.0 * share.std, "{before}: {share:?}");
                assert!(wrong < 0.1 * loss, "{before}: {share:?}");
            }
        }
    }
}

/// Without prior information on the stiffness, no loss is identifiable.
#[test]
fn stiffness_loss_without_baseline_is_not_reported() {
    let robot = pendulum("").unwrap();
    let estimator = MapEstimator::new(prior(&robot), &FeatureConfig::default());
    let start = estimator
        .prior()
        .state_estimate(Payload::Empty, UNKNOWN_OFFSET_RAD);
    let calm = blocks(&robot.arm, PLAIN);
    let searched = estimator
        .search(&start, &calm, Payload::Empty, SCOPE)
        .unwrap();
    let solved = estimator.solve(&start, &[], Payload::Empty, &calm).unwrap();
    assert_eq!(searched.stiffness_changes, [None]);
    assert_eq!(
        searched.offset(estimator.prior(), 0),
        solved.offset(estimator.prior(), 0)
    );
}
