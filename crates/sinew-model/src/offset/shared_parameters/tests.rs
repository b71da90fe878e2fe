use super::*;
use crate::offset::fixtures::{random, turntables};

/// Robots of a fleet, and how many fleets.
const ROBOTS: usize = 8;
const FLEETS: usize = 25;
/// Ratio of individual to total deviation in stiffness and friction; all other parameters are
/// uncorrelated between robots.
const INDIVIDUAL_RATIO: f64 = 0.2;

fn normal(seed: &mut u64) -> f64 {
    // Twelve even numbers of variance 1/3 sum to a variance of 4.
    (0..12).map(|_| random(seed)).sum::<f64>() / 2.0
}

fn own_ratio(kind: Kind) -> f64 {
    match kind {
        Kind::Stiffness | Kind::Friction => INDIVIDUAL_RATIO,
        _ => 1.0,
    }
}

/// Draws the deviation of each entry that all robots of a fleet share, in tolerances.
fn type_of(kinds: &[(usize, Kind)], seed: &mut u64) -> Vec<f64> {
    let shared = |kind| libm::sqrt(1.0 - own_ratio(kind).powi(2));
    kinds
        .iter()
        .map(|(_, kind)| shared(*kind) * normal(seed))
        .collect()
}

fn robot_of(kinds: &[(usize, Kind)], common: &[f64], seed: &mut u64) -> Vec<f64> {
    let own = kinds.iter().zip(common);
    own.map(|((_, kind), mu)| mu + own_ratio(*kind) * normal(seed))
        .collect()
}

/// Returns a robot's posterior: each of `rows` measures two entries together, with an error of 0.2
/// tolerances.
fn learned(
    fresh: &StateEstimate,
    kinds: &[(usize, Kind)],
    truth: &[f64],
    seed: &mut u64,
) -> StateEstimate {
    const NOISE: f64 = 0.2;
    let (d, m) = (fresh.mean.len(), kinds.len());
    let mut state_estimate = fresh.clone();
    for row in 0..2 * m {
        let pair = [row % m, (row * 7 + 3) % m];
        let mut h = alloc::vec![0.0; d];
        let mut value = NOISE * normal(seed);
        for (i, sign) in pair.into_iter().zip([1.0, -0.5]) {
            let k = kinds[i].0;
            h[k] += sign / fresh.entry(k).std;
            value += sign * (truth[i] + fresh.mean[k] / fresh.entry(k).std);
        }
        let gain = times(&state_estimate.covariance, &h);
        let spread = NOISE * NOISE + cholesky::dot(&gain, &h);
        let off = value - cholesky::dot(&h, &state_estimate.mean);
        for i in 0..d {
            state_estimate.mean[i] += gain[i] * off / spread;
            for k in 0..d {
                state_estimate.covariance[i * d + k] -= gain[i] * gain[k] / spread;
            }
        }
    }
    state_estimate
}

#[test]
fn new_robot_prior_covers_truth_of_its_type() {
    let prior = turntables(2, 0.05).prior;
    let fresh = prior.state_estimate(Payload::Unknown, UNKNOWN_OFFSET_RAD);
    let d = fresh.mean.len();
    let kinds: Vec<(usize, Kind)> = (0..d)
        .filter(|k| fresh.entry(*k).std > FIXED_STD)
        .filter_map(|k| Some((k, prior.parameter(k)?.kind?)))
        .collect();
    let mut seed = 11;
    let [mut inside, mut count] = [0, 0];
    let [mut alike, mut apart] = [0.0, 0.0];
    let mut width = 0.0;
    for _ in 0..FLEETS {
        let common = type_of(&kinds, &mut seed);
        let parts: Vec<[StateEstimate; 2]> = (0..ROBOTS)
            .map(|_| {
                let truth = robot_of(&kinds, &common, &mut seed);
                [fresh.clone(), learned(&fresh, &kinds, &truth, &mut seed)]
            })
            .collect();
        let (state_estimate, found) = learn_type(&prior, &parts).unwrap();
        let ratio = |kind| found.iter().find(|a| a.kind == kind).unwrap().ratio;
        alike += ratio(Kind::Stiffness) / FLEETS as f64;
        apart += ratio(Kind::Encoders) / FLEETS as f64;
        let further = robot_of(&kinds, &common, &mut seed);
        for ((k, kind), truth) in kinds.iter().zip(&further) {
            if own_ratio(*kind) < 1.0 {
                let [now, before] = [state_estimate.entry(*k), fresh.entry(*k)];
                let off = before.mean + truth * before.std - now.mean;
                inside += usize::from(off.abs() < 1.96 * now.std);
                count += 1;
                width += now.std / before.std;
            }
        }
    }
    width /= count as f64;
    // With more than 300 entries, the standard deviation of a share is 1.3 %.
    let share = inside as f64 / count as f64;
    assert!(
        count >= 200 && (0.90..=0.985).contains(&share),
        "{share} of {count}"
    );
    assert!((width - INDIVIDUAL_RATIO).abs() < 0.1, "{width}");
    assert!((alike - INDIVIDUAL_RATIO).abs() < 0.06, "{alike}");
    assert!(apart > 0.85, "{apart}");
}

#[test]
fn uninformative_robots_leave_tolerances_unchanged() {
    let prior = turntables(2, 0.05).prior;
    let fresh = prior.state_estimate(Payload::Unknown, UNKNOWN_OFFSET_RAD);
    let parts = alloc::vec![[fresh.clone(), fresh.clone()]; 4];
    let (state_estimate, _) = learn_type(&prior, &parts).unwrap();
    for k in 0..fresh.mean.len() {
        let [now, before] = [state_estimate.entry(k), fresh.entry(k)];
        assert!((now.mean - before.mean).abs() < 1e-9 * before.std);
        assert!((now.std / before.std - 1.0).abs() < 1e-6, "{k}");
    }
}
