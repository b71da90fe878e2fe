//! A block's work in slices: the answers of a step, one block later, and never more slices than said.

use sinew_model::Gaussian;
use sinew_model::arm::urdf;
use sinew_model::offset::{
    Block, ExternalForce, FeatureConfig, FeatureObserver, ForceEstimate, MapEstimator, Payload,
    Prior, RecursiveOffsets, UNKNOWN_OFFSET_RAD,
};
use sinew_model::tolerances::Tolerances;
use sinew_model::transmission::Transmission;

/// Joints of the arm.
const N: usize = 4;
/// Blocks: the challenger goes over the first, and over those of a slip.
const BLOCKS: usize = 420;

/// A filter, and blocks of an arm that moves, is leant on and then slips.
fn arm_at_work() -> (RecursiveOffsets, Vec<Block>) {
    let text = include_str!("../reference/models/serial4.urdf");
    let arm = urdf::parse(text, &urdf::UrdfOptions::default())
        .unwrap()
        .arm;
    let mut spring = Transmission::spring(40.0);
    spring.motor_inertia_kg_m2 = Some(0.1);
    let transmissions = vec![Some(spring); N];
    let prior = Prior::new(&arm, &transmissions, N - 1, [0.0; 3], Tolerances::default());
    let start = prior.belief(Payload::Unknown, UNKNOWN_OFFSET_RAD);
    let config = FeatureConfig::default();
    let estimator =
        MapEstimator::new(prior, &config).with_external_force(&arm, ExternalForce::possible(2.0));
    let filter = RecursiveOffsets::new(estimator, start).expect("a prior");
    let mut features = FeatureObserver::new(&arm, config);
    let mut blocks = Vec::new();
    let mut k = 0_u32;
    while blocks.len() < BLOCKS {
        let t = 5e-3 * f64::from(k);
        k += 1;
        let of = |i: usize| 1.0 + 0.3 * i as f64;
        let q: Vec<f64> = (0..N).map(|i| 0.5 * (of(i) * t).sin()).collect();
        // Leant on from 30 s to 33 s, slipped from 40 s on.
        let moved = match blocks.len() {
            150..165 => 0.1,
            200.. => 0.03,
            _ => 0.0,
        };
        let theta: Vec<f64> = (q.iter().enumerate())
            .map(|(i, q)| q + 0.005 + moved + 1e-4 * (7.0 * of(i) * t).sin())
            .collect();
        if features.step(5e-3, &q, &theta, &[f64::NAN; N], 20.0) == Ok(true) {
            blocks.push(features.block().clone());
        }
    }
    (filter, blocks)
}

/// All that a filter says.
fn told(filter: &RecursiveOffsets) -> (Vec<Gaussian>, bool, Vec<f64>, Option<ForceEstimate>) {
    (
        (0..N).map(|i| filter.offset(i)).collect(),
        filter.is_provisional(),
        (0..N).map(|i| filter.stiffness_changed(i)).collect(),
        filter.external_force(),
    )
}

#[test]
fn slices_give_the_answers_of_a_step_a_block_later_to_the_last_bit() {
    let (mut whole, blocks) = arm_at_work();
    let mut sliced = whole.clone();
    let most = whole.slices_per_block();
    /// Samples of a block, at 1 kHz.
    const SAMPLES: usize = 200;
    let per_sample = most.div_ceil(SAMPLES);
    let (mut before, mut used, mut in_doubt) = (told(&whole), 0, [0; 2]);
    for (b, block) in blocks.iter().enumerate() {
        assert_eq!(sliced.begin(block), Ok(true), "block {b}");
        let mut slices = 0;
        while sliced.is_busy() {
            // Until the last slice, what is told is the answer from before, whole.
            assert_eq!(told(&sliced), before, "block {b}, slice {slices}");
            let done = sliced.advance(1);
            assert_eq!(done, 1);
            slices += done;
        }
        assert!(slices <= most, "block {b}: {slices} of {most}");
        used = used.max(slices);
        assert_eq!(sliced.advance(per_sample), 0, "nothing is left");
        whole.step(block).unwrap();
        before = told(&whole);
        assert_eq!(told(&sliced), before, "block {b}");
        in_doubt[usize::from(before.1)] += 1;
    }
    let (one, other) = (whole.belief().unwrap(), sliced.belief().unwrap());
    assert_eq!((one.mean, one.covariance), (other.mean, other.covariance));
    assert_eq!(whole.noise(), sliced.noise());
    // All kinds of work were seen, so the bound is no idle one: it is nearly reached.
    println!("{used} slices at most, {most} said; {in_doubt:?} blocks sure, in doubt");
    assert!(in_doubt.iter().all(|n| *n > 40), "{in_doubt:?}");
    assert!(2 * used > most, "{used} of {most}");
}

#[test]
fn what_is_saved_between_slices_loses_nothing() {
    let (mut whole, blocks) = arm_at_work();
    let mut sliced = whole.clone();
    for (b, block) in blocks.iter().take(140).enumerate() {
        whole.step(block).unwrap();
        assert_eq!(sliced.begin(block), Ok(true));
        sliced.advance(b % 50);
        // The saved belief is that of all blocks taken, and saving it changes nothing.
        if b % 20 == 0 {
            let (one, other) = (whole.belief().unwrap(), sliced.belief().unwrap());
            assert_eq!((one.mean, one.covariance), (other.mean, other.covariance));
        }
        // A copy goes on where it was.
        sliced = sliced.clone();
        sliced.advance(usize::MAX);
        assert_eq!(told(&sliced), told(&whole), "block {b}");
    }
}

#[test]
fn a_block_that_comes_too_early_is_left_out_and_changes_nothing() {
    let (mut filter, blocks) = arm_at_work();
    assert_eq!(filter.begin(&blocks[0]), Ok(true));
    filter.advance(3);
    let mut other = filter.clone();
    assert_eq!(filter.begin(&blocks[1]), Ok(false));
    for filter in [&mut filter, &mut other] {
        filter.finish();
    }
    assert_eq!(told(&filter), told(&other));
    // A step takes it, and what was left of the one before.
    assert_eq!(filter.begin(&blocks[1]), Ok(true));
    filter.step(&blocks[2]).unwrap();
    other.step(&blocks[1]).unwrap();
    other.step(&blocks[2]).unwrap();
    assert_eq!(told(&filter), told(&other));
}
