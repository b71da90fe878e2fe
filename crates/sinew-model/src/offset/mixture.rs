//! The average over changes that may or may not have happened.

use super::map::MapError;
use crate::cholesky;
use alloc::vec::Vec;

/// What a change is believed to be before the data is seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Odds {
    /// Standard deviation of its size.
    pub(super) deviation: f64,
    /// Odds that it happened.
    pub(super) odds: f64,
}

/// Up to so many changes, all sets of them are weighed; of more, sets of one and two, and all of them.
const ALL_SETS: usize = 10;

/// Averages an estimate in which changes `c ~ N(0, s²)` are open over which of them happened, each
/// set weighed by its evidence. Returns the probability of each change.
///
/// An estimate that leaves a change out is off, and too sure, where it happened; one that opens
/// all of them knows less than it could. From the estimate `x, P` with all open, and `c, C` of the
/// changes in it, the estimate without those in `E` is the one on condition that `c_E = 0`:
///
/// ```text
/// ln evidence = −½ c_Eᵀ C_EE⁻¹ c_E − ½ ln |C_EE| + |E| ln s + |S| ln odds,    S: the others
/// c | E       = c − C_·E C_EE⁻¹ c_E,     C | E = C − C_·E C_EE⁻¹ C_E·
/// ```
///
/// (what a Gaussian says of zero against what it said before, Savage and Dickey's ratio). With mean `m` and
/// covariance `V` of that mixture, `x → x + P_·c C⁻¹ (m − c)` and
/// `P → P + P_·c C⁻¹ (V − C) C⁻¹ P_c·`.
///
/// * `columns`: of the changes in `state`; `covariance`: row-major.
///
/// # Errors
/// [`MapError::Prior`] where a covariance is none.
///
/// # Source
/// J. Dickey, *The weighted likelihood ratio*, Annals of Mathematical Statistics 42, 1971.
pub(super) fn average(
    columns: &[usize],
    odds: Odds,
    state: &mut [f64],
    covariance: &mut [f64],
) -> Result<Vec<f64>, MapError> {
    let (n, total) = (columns.len(), state.len());
    let change: Vec<f64> = columns.iter().map(|&c| state[c]).collect();
    let own: Vec<f64> = (columns.iter())
        .flat_map(|&i| columns.iter().map(move |&k| (i, k)))
        .map(|(i, k)| covariance[i * total + k])
        .collect();
    let Mixture {
        probability,
        mean,
        spread,
    } = mixture(&change, &own, odds)?;

    // P_·c C⁻¹, a row per entry of the state.
    let inverse = cholesky::inverse(&own, n).map_err(MapError::Prior)?;
    let mut moves = Vec::with_capacity(total * n);
    for row in covariance.chunks_exact(total) {
        for line in inverse.chunks_exact(n) {
            moves.push(columns.iter().zip(line).map(|(&c, q)| row[c] * q).sum());
        }
    }
    let further: Vec<f64> = mean.iter().zip(&change).map(|(m, c)| m - c).collect();
    let wider: Vec<f64> = spread.iter().zip(&own).map(|(v, c)| v - c).collect();
    for (i, x) in state.iter_mut().enumerate() {
        let own: &[f64] = &moves[i * n..(i + 1) * n];
        *x += dot(own, &further);
        let half: Vec<f64> = wider.chunks_exact(n).map(|row| dot(row, own)).collect();
        let row = &mut covariance[i * total..(i + 1) * total];
        for (p, other) in row.iter_mut().zip(moves.chunks_exact(n)) {
            *p += dot(&half, other);
        }
    }
    Ok(probability)
}

/// Probability, mean and covariance of changes over all sets of those that happened.
struct Mixture {
    probability: Vec<f64>,
    mean: Vec<f64>,
    spread: Vec<f64>,
}

fn mixture(change: &[f64], covariance: &[f64], odds: Odds) -> Result<Mixture, MapError> {
    let n = change.len();
    let mut each = Vec::new();
    for set in sets(n) {
        each.push(Conditioned::new(&set, change, covariance, odds)?);
    }
    let most = each.iter().map(|c| c.evidence).fold(f64::MIN, f64::max);
    let weight = |c: &Conditioned| libm::exp(c.evidence - most);
    let all: f64 = each.iter().map(weight).sum();
    let mut out = Mixture {
        probability: alloc::vec![0.0; n],
        mean: alloc::vec![0.0; n],
        spread: alloc::vec![0.0; n * n],
    };
    for c in &each {
        let weight = weight(c) / all;
        for i in 0..n {
            out.probability[i] += if c.set[i] { weight } else { 0.0 };
            out.mean[i] += weight * c.mean[i];
            for k in 0..n {
                out.spread[i * n + k] += weight * (c.covariance[i * n + k] + c.mean[i] * c.mean[k]);
            }
        }
    }
    for i in 0..n {
        for k in 0..n {
            out.spread[i * n + k] -= out.mean[i] * out.mean[k];
        }
    }
    Ok(out)
}

/// Sets of changes that may have happened.
fn sets(n: usize) -> Vec<Vec<bool>> {
    if n <= ALL_SETS {
        let all = 0..1_usize << n;
        return all
            .map(|set| (0..n).map(|i| set >> i & 1 == 1).collect())
            .collect();
    }
    let pairs = (0..n).flat_map(|i| (0..=i).map(move |k| (i, k)));
    let some = pairs.map(|(i, k)| (0..n).map(|j| j == i || j == k).collect());
    core::iter::once(alloc::vec![false; n])
        .chain(some)
        .collect()
}

/// Changes on condition that only those of a set happened.
struct Conditioned {
    set: Vec<bool>,
    evidence: f64,
    mean: Vec<f64>,
    covariance: Vec<f64>,
}

impl Conditioned {
    fn new(set: &[bool], change: &[f64], covariance: &[f64], odds: Odds) -> Result<Self, MapError> {
        let n = change.len();
        let out: Vec<usize> = (0..n).filter(|&i| !set[i]).collect();
        let m = out.len();
        let pick = |i: usize, k: usize| covariance[i * n + k];
        let mut own = Vec::with_capacity(m * m);
        for &i in &out {
            own.extend(out.iter().map(|&k| pick(i, k)));
        }
        let mut l = alloc::vec![0.0; m * m];
        cholesky::factorise(&own, &mut l, m).map_err(MapError::Prior)?;
        let solved = |mut b: Vec<f64>| {
            cholesky::solve(&l, m, &mut b);
            b
        };
        let left: Vec<f64> = out.iter().map(|&i| change[i]).collect();
        let pulled = solved(left.clone());
        // Relative to what was believed, so that nothing depends on units.
        let narrower = |i: usize| libm::log(l[i * m + i] / odds.deviation);
        let evidence = -0.5 * dot(&left, &pulled) - (0..m).map(narrower).sum::<f64>()
            + (n - m) as f64 * libm::log(odds.odds);
        let (mut mean, mut conditioned) = (change.to_vec(), covariance.to_vec());
        for i in 0..n {
            let shared: Vec<f64> = out.iter().map(|&k| pick(i, k)).collect();
            mean[i] -= dot(&shared, &pulled);
            let gain = solved(shared);
            for k in 0..n {
                let other = out.iter().map(|&e| pick(k, e));
                conditioned[i * n + k] -= gain.iter().zip(other).map(|(g, o)| g * o).sum::<f64>();
            }
        }
        Ok(Self {
            set: set.to_vec(),
            evidence,
            mean,
            covariance: conditioned,
        })
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cholesky;

    const D: usize = 7;
    const ODDS: Odds = Odds {
        deviation: 0.4,
        odds: 0.1,
    };

    /// Numbers without a pattern in −1…1.
    fn noise(seed: &mut u64) -> f64 {
        *seed = seed
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (*seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn positive_definite(seed: &mut u64, least: f64) -> Vec<f64> {
        let a: Vec<f64> = (0..D * D).map(|_| noise(seed)).collect();
        let mut out = alloc::vec![0.0; D * D];
        for i in 0..D {
            for k in 0..D {
                out[i * D + k] = (0..D).map(|j| a[i * D + j] * a[k * D + j]).sum();
            }
            out[i * D + i] += least;
        }
        out
    }

    fn times(a: &[f64], x: &[f64]) -> Vec<f64> {
        a.chunks_exact(D).map(|row| dot(row, x)).collect()
    }

    fn sum(a: &[f64], b: &[f64]) -> Vec<f64> {
        a.iter().zip(b).map(|(a, b)| a + b).collect()
    }

    fn log_determinant(a: &[f64]) -> f64 {
        let mut l = alloc::vec![0.0; D * D];
        cholesky::factorise(a, &mut l, D).unwrap();
        (0..D).map(|i| 2.0 * l[i * D + i].ln()).sum()
    }

    /// Every set by a prior covariance of its own: the mixture is exact where the data is linear.
    #[test]
    fn the_average_is_that_of_posteriors_computed_one_by_one() {
        const ENTRIES: [usize; 3] = [1, 4, 5];
        const TOTAL: usize = D + ENTRIES.len();
        for first in [3, 17, 40] {
            let mut seed = first;
            let before = positive_definite(&mut seed, 0.3);
            let data = positive_definite(&mut seed, 0.1).map_all(|x| 4.0 * x);
            let start: Vec<f64> = (0..D).map(|_| noise(&mut seed)).collect();
            let pull: Vec<f64> = (0..D).map(|_| 5.0 * noise(&mut seed)).collect();
            // Posterior, and logarithm of the evidence but for what all share.
            let posterior = |set: &Vec<bool>| {
                let mut prior = before.clone();
                let happened = ENTRIES.iter().zip(set).filter(|(_, happened)| **happened);
                let who: Vec<usize> = happened.map(|(k, _)| *k).collect();
                for &k in &who {
                    prior[k * D + k] += ODDS.deviation * ODDS.deviation;
                }
                let information = sum(&cholesky::inverse(&prior, D).unwrap(), &data);
                let covariance = cholesky::inverse(&information, D).unwrap();
                let step = times(&covariance, &pull);
                let evidence = 0.5 * dot(&pull, &step)
                    - 0.5 * (log_determinant(&prior) + log_determinant(&information))
                    + who.len() as f64 * ODDS.odds.ln();
                (sum(&start, &step), covariance, evidence)
            };
            let sets = sets(ENTRIES.len());
            assert_eq!(sets.len(), 8);
            let each: Vec<_> = sets.iter().map(posterior).collect();
            let total: f64 = each.iter().map(|(.., e)| (e - each[0].2).exp()).sum();
            let weight = |e: f64| (e - each[0].2).exp() / total;
            let mut mean = alloc::vec![0.0; D];
            for (x, _, e) in &each {
                mean = sum(&mean, &x.map_all(|x| weight(*e) * x));
            }
            let mut spread = alloc::vec![0.0; D * D];
            for (x, p, e) in &each {
                for i in 0..D {
                    for k in 0..D {
                        let apart = (x[i] - mean[i]) * (x[k] - mean[k]);
                        spread[i * D + k] += weight(*e) * (p[i * D + k] + apart);
                    }
                }
            }

            // All open: the state goes on with the changes.
            let place = |k: usize| if k < D { k } else { ENTRIES[k - D] };
            let own = cholesky::inverse(&before, D).unwrap();
            let mut information = alloc::vec![0.0; TOTAL * TOTAL];
            for i in 0..TOTAL {
                for k in 0..TOTAL {
                    let believed = match (i < D, k < D) {
                        (true, true) => own[i * D + k],
                        _ if i == k => ODDS.deviation.powi(-2),
                        _ => 0.0,
                    };
                    information[i * TOTAL + k] = data[place(i) * D + place(k)] + believed;
                }
            }
            let mut p = cholesky::inverse(&information, TOTAL).unwrap();
            let pulled: Vec<f64> = (0..TOTAL).map(|k| pull[place(k)]).collect();
            let mut x: Vec<f64> = p.chunks_exact(TOTAL).map(|row| dot(row, &pulled)).collect();
            for (x, m) in x.iter_mut().zip(&start) {
                *x += m;
            }
            let probability = average(&[D, D + 1, D + 2], ODDS, &mut x, &mut p).unwrap();
            // What an entry is and what it changed by, together.
            let all = |i: usize| (0..TOTAL).filter(move |&k| place(k) == i);
            for i in 0..D {
                let found: f64 = all(i).map(|k| x[k]).sum();
                assert!((found - mean[i]).abs() < 1e-9, "{found} {}", mean[i]);
                for k in 0..D {
                    let entry = all(i).flat_map(|a| all(k).map(move |b| (a, b)));
                    let found: f64 = entry.map(|(a, b)| p[a * TOTAL + b]).sum();
                    let expected = spread[i * D + k];
                    assert!((found - expected).abs() < 1e-9, "{found} {expected}");
                }
            }
            for (i, found) in probability.iter().enumerate() {
                let own = sets.iter().zip(&each).filter(|(set, _)| set[i]);
                let expected: f64 = own.map(|(_, (.., e))| weight(*e)).sum();
                assert!((found - expected).abs() < 1e-9, "{found} {expected}");
                assert!(expected > 0.01, "{expected}: the case says nothing");
            }
        }
    }

    /// What data can't tell stays as it was believed.
    #[test]
    fn without_data_the_odds_stay_what_they_were() {
        for n in [1, ALL_SETS + 2] {
            let mut p = alloc::vec![0.0; n * n];
            for i in 0..n {
                p[i * n + i] = ODDS.deviation * ODDS.deviation;
            }
            let mut x = alloc::vec![0.0; n];
            let columns: Vec<usize> = (0..n).collect();
            let probability = average(&columns, ODDS, &mut x, &mut p).unwrap();
            // Where there are many: none, sets of one and two, and all.
            let (one, two, last) = (0.1, 0.01 * (n - 1) as f64, 0.1_f64.powi(n as i32));
            let last = if n > 1 { last } else { 0.0 };
            let all = 1.0 + n as f64 * (one + 0.5 * two) + last;
            assert!((probability[0] - (one + two + last) / all).abs() < 1e-12);
            let expected = probability[0] * ODDS.deviation * ODDS.deviation;
            assert!((p[0] - expected).abs() < 1e-12, "{} {expected}", p[0]);
        }
    }

    trait MapAll {
        fn map_all(&self, f: impl Fn(f64) -> f64) -> Vec<f64>;
    }

    impl MapAll for Vec<f64> {
        fn map_all(&self, f: impl Fn(f64) -> f64) -> Vec<f64> {
            self.iter().map(|x| f(*x)).collect()
        }
    }
}
