use super::*;
use crate::offset::fixtures::{random, turntables};

/// Robots of a fleet, and how many fleets.
const ROBOTS: usize = 8;
const FLEETS: usize = 25;
/// How alike stiffness and friction are; of everything else robots have nothing in common.
const OWN: f64 = 0.2;

fn normal(seed: &mut u64) -> f64 {
    // Twelve even numbers of variance 1/3 sum to a variance of 4.
    (0..12).map(|_| random(seed)).sum::<f64>() / 2.0
}

fn own_ratio(kind: Kind) -> f64 {
    match kind {
        Kind::Stiffness | Kind::Friction => OWN,
        _ => 1.0,
    }
}

/// Of each entry what robots of a fleet have in common, in tolerances.
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

/// What a robot learns of itself: each of `rows` measures two entries together, with an error of a fifth.
fn learned(fresh: &Belief, kinds: &[(usize, Kind)], truth: &[f64], seed: &mut u64) -> Belief {
    const NOISE: f64 = 0.2;
    let (d, m) = (fresh.mean.len(), kinds.len());
    let mut belief = fresh.clone();
    for row in 0..2 * m {
        let pair = [row % m, (row * 7 + 3) % m];
        let mut h = alloc::vec![0.0; d];
        let mut value = NOISE * normal(seed);
        for (i, sign) in pair.into_iter().zip([1.0, -0.5]) {
            let k = kinds[i].0;
            h[k] += sign / fresh.entry(k).deviation;
            value += sign * (truth[i] + fresh.mean[k] / fresh.entry(k).deviation);
        }
        let gain = times(&belief.covariance, &h);
        let spread = NOISE * NOISE + cholesky::dot(&gain, &h);
        let off = value - cholesky::dot(&h, &belief.mean);
        for i in 0..d {
            belief.mean[i] += gain[i] * off / spread;
            for k in 0..d {
                belief.covariance[i * d + k] -= gain[i] * gain[k] / spread;
            }
        }
    }
    belief
}

#[test]
fn a_further_robot_is_where_its_type_says_and_nothing_is_believed_that_differs() {
    let prior = turntables(2, 0.05).prior;
    let fresh = prior.belief(Payload::Unknown, UNKNOWN_OFFSET_RAD);
    let d = fresh.mean.len();
    let kinds: Vec<(usize, Kind)> = (0..d)
        .filter(|k| fresh.entry(*k).deviation > FIXED)
        .filter_map(|k| Some((k, prior.parameter(k)?.kind?)))
        .collect();
    let mut seed = 11;
    let [mut inside, mut count] = [0, 0];
    let [mut alike, mut apart] = [0.0, 0.0];
    let mut width = 0.0;
    for _ in 0..FLEETS {
        let common = type_of(&kinds, &mut seed);
        let parts: Vec<[Belief; 2]> = (0..ROBOTS)
            .map(|_| {
                let truth = robot_of(&kinds, &common, &mut seed);
                [fresh.clone(), learned(&fresh, &kinds, &truth, &mut seed)]
            })
            .collect();
        let (belief, found) = learn_type(&prior, &parts).unwrap();
        let ratio = |kind| found.iter().find(|a| a.kind == kind).unwrap().ratio;
        alike += ratio(Kind::Stiffness) / FLEETS as f64;
        apart += ratio(Kind::Encoders) / FLEETS as f64;
        let further = robot_of(&kinds, &common, &mut seed);
        for ((k, kind), truth) in kinds.iter().zip(&further) {
            if own_ratio(*kind) < 1.0 {
                let [now, before] = [belief.entry(*k), fresh.entry(*k)];
                let off = before.mean + truth * before.deviation - now.mean;
                inside += usize::from(off.abs() < 1.96 * now.deviation);
                count += 1;
                width += now.deviation / before.deviation;
            }
        }
    }
    width /= count as f64;
    // Of 300 and more a share strays by 1.3 % as a standard deviation.
    let share = inside as f64 / count as f64;
    assert!(
        count >= 200 && (0.90..=0.985).contains(&share),
        "{share} of {count}"
    );
    assert!((width - OWN).abs() < 0.1, "{width}");
    assert!((alike - OWN).abs() < 0.06, "{alike}");
    assert!(apart > 0.85, "{apart}");
}

#[test]
fn robots_that_learned_nothing_leave_a_further_one_its_tolerances() {
    let prior = turntables(2, 0.05).prior;
    let fresh = prior.belief(Payload::Unknown, UNKNOWN_OFFSET_RAD);
    let parts = alloc::vec![[fresh.clone(), fresh.clone()]; 4];
    let (belief, _) = learn_type(&prior, &parts).unwrap();
    for k in 0..fresh.mean.len() {
        let [now, before] = [belief.entry(k), fresh.entry(k)];
        assert!((now.mean - before.mean).abs() < 1e-9 * before.deviation);
        assert!((now.deviation / before.deviation - 1.0).abs() < 1e-6, "{k}");
    }
}
