//! Stiffness lost between two recordings.

use crate::pendulum::{PLAIN, Truth, blocks, pendulum, prior};
use sinew_model::Gaussian;
use sinew_model::offset::{
    Belief, FeatureConfig, MapEstimator, Payload, SearchScope, TENSIONED_OFFSET_RAD,
    UNKNOWN_OFFSET_RAD, beliefs,
};

const SCOPE: SearchScope = SearchScope {
    offsets: true,
    payload: false,
    creep: true,
    continues: false,
    onset: None,
};

/// What a recording right after tensioning leaves for the next.
fn learned(estimator: &MapEstimator) -> Belief {
    learned_of(estimator, PLAIN)
}

/// The same of a rope as it is.
fn learned_of(estimator: &MapEstimator, truth: Truth) -> Belief {
    let prior = estimator.prior();
    let tensioned = Truth {
        offset_rad: 0.0,
        ..truth
    };
    let calm = blocks(&pendulum("").unwrap().arm, tensioned);
    let start = prior.belief(Payload::Empty, TENSIONED_OFFSET_RAD);
    let map = estimator.solve(&start, &[], Payload::Empty, &calm).unwrap();
    let mut belief = map.belief(prior);
    beliefs::age(prior, &mut belief);
    prior.open_offsets(&mut belief, UNKNOWN_OFFSET_RAD);
    belief
}

#[test]
fn the_more_is_lost_the_likelier() {
    let robot = pendulum("").unwrap();
    let estimator = MapEstimator::new(prior(&robot), &FeatureConfig::default());
    let belief = learned(&estimator);
    let mut last = 0.0;
    for loss in [0.0, 0.003, 0.005, 0.006, 0.08] {
        let truth = Truth {
            compliance: (1.0 + PLAIN.compliance) / (1.0 - loss) - 1.0,
            ..PLAIN
        };
        let blocks = blocks(&robot.arm, truth);
        let map = estimator
            .search(&belief, &blocks, Payload::Empty, SCOPE)
            .unwrap();
        let Gaussian {
            mean: offset,
            deviation,
        } = map.offset(estimator.prior(), 0);
        let since = map.stiffness_changes[0].unwrap();
        println!("{loss}: {offset:.5} ± {deviation:.5}, {since:?}");
        assert!(
            (offset - truth.offset_rad).abs() < 2.0 * deviation,
            "{offset}"
        );
        assert!(since.probability >= last, "{since:?}");
        last = since.probability;
        let lost = truth.compliance - PLAIN.compliance;
        assert!(since.probability < 0.5 || (since.softening.mean / lost - 1.0).abs() < 0.2);
        if loss == 0.0 {
            assert!(since.probability < 0.1, "{since:?}");
        }
    }
    assert!(last > 0.9, "{last}");
}

/// A strand takes its share of the stiffness that there is, whatever that is over `robot.toml`'s: the loss is sought about
/// none, and what the baseline found of the stiffness is no part of it.
#[test]
fn a_share_that_is_lost_is_found_alike_whatever_the_stiffness_was() {
    let robot = pendulum("").unwrap();
    let estimator = MapEstimator::new(prior(&robot), &FeatureConfig::default());
    for before in [-0.12, 0.0, 0.12] {
        let truth = Truth {
            compliance: before,
            ..PLAIN
        };
        let belief = learned_of(&estimator, truth);
        for loss in [0.0, 0.08] {
            let after = (1.0 + before) / (1.0 - loss) - 1.0;
            let softer = Truth {
                compliance: after,
                ..truth
            };
            let blocks = blocks(&robot.arm, softer);
            let map = estimator
                .search(&belief, &blocks, Payload::Empty, SCOPE)
                .unwrap();
            let since = map.stiffness_changes[0].unwrap();
            let share = since.softening.scaled(1.0 / (1.0 + after));
            let probability = since.probability;
            println!("{before} {loss}: {probability:?}, {share:?}");
            match loss > 0.0 {
                true => assert!(probability > 0.9, "{before}: {probability}"),
                false => assert!(probability < 0.1, "{before}: {probability}"),
            }
            if loss > 0.0 {
                let wrong = (share.mean - loss).abs();
                assert!(wrong < 2.0 * share.deviation, "{before}: {share:?}");
                assert!(wrong < 0.1 * loss, "{before}: {share:?}");
            }
        }
    }
}

/// Where nothing was known of a stiffness, nothing can have been lost.
#[test]
fn without_a_baseline_the_tolerance_says_it_already() {
    let robot = pendulum("").unwrap();
    let estimator = MapEstimator::new(prior(&robot), &FeatureConfig::default());
    let start = estimator.prior().belief(Payload::Empty, UNKNOWN_OFFSET_RAD);
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
