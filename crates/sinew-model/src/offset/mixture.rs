//! The average over changes that may or may not have happened.

use super::block::copy;
use super::error::MapError;
use crate::cholesky::{self, dot};
use alloc::vec::Vec;
use core::ops::Range;

/// Prior of a change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PriorOdds {
    /// Standard deviation of its size.
    pub(crate) std: f64,
    /// PriorOdds that it happened.
    pub(crate) odds: f64,
    /// Relation between occurrences: whether one change makes others more probable.
    pub(crate) occurrence: Occurrence,
}

/// How changes happen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Occurrence {
    /// Each for itself.
    Apart,
    /// A common cause makes several occur: the odds are those that any occurs, with equal probability for every number
    /// of changes, and for every set of a given number.
    Together,
    /// All or none: they are the components of one.
    AsOne,
}

impl PriorOdds {
    /// Logarithm of the prior odds of a set of `count` changes out of `n` against none.
    pub(crate) fn ln_prior(&self, count: usize, n: usize) -> f64 {
        match self.occurrence {
            _ if count == 0 => return 0.0,
            Occurrence::Apart => return count as f64 * libm::log(self.odds),
            Occurrence::AsOne => return libm::log(self.odds),
            Occurrence::Together => {}
        }
        // ln of n over count.
        let sets = (0..count).map(|k| libm::log((n - k) as f64 / (k + 1) as f64));
        libm::log(self.odds / n as f64) - sets.sum::<f64>()
    }
}

/// Stiffness loss between two recordings, relative; an assumed value.
pub(crate) const LOST_STIFFNESS: PriorOdds = PriorOdds {
    std: 0.1,
    odds: 0.3,
    occurrence: Occurrence::Apart,
};

/// Rope creep within a recording, rad/s; an assumed value. The rate may reach this value in the first minutes after
/// tensioning, and a tenth of it hours later.
pub(crate) const CREEP: PriorOdds = PriorOdds {
    std: 2e-3 / 60.0,
    odds: 0.1,
    occurrence: Occurrence::Together,
};

/// Maximum number of changes for which all subsets are weighted; above it, only the subsets with none, one, two and
/// all changes.
const ALL_SETS: usize = 10;

/// Averages an estimate with free changes `c ~ N(0, s²)` over the sets of changes that may have occurred, each set
/// weighed by its evidence. Returns the probability of each change.
///
/// An estimate without a change is biased and overconfident if the change occurred; one with all changes free has a
/// larger variance than necessary. From the estimate `x, P` with all free, and `c, C` of the changes in it, the
/// estimate without those in `E` is the one on condition that `c_E = 0`:
///
/// ```text
/// ln evidence = −½ c_Eᵀ C_EE⁻¹ c_E − ½ ln |C_EE| + |E| ln s + |S| ln odds,    S: the others
/// c | E       = c − C_·E C_EE⁻¹ c_E,     C | E = C − C_·E C_EE⁻¹ C_E·
/// ```
///
/// (density of a Gaussian at zero, posterior over prior: the Savage-Dickey ratio). With mean `m` and covariance `V` of
/// that mixture, `x → x + P_·c C⁻¹ (m − c)` and `P → P + P_·c C⁻¹ (V − C) C⁻¹ P_c·`.
///
/// * `columns`: of the changes in `state`; `covariance`: row-major.
///
/// # Errors
/// Returns [`MapError::Prior`] if a covariance is not positive definite.
///
/// # Source
/// J. Dickey, *The weighted likelihood ratio*, Annals of Mathematical Statistics 42, 1971.
pub(crate) fn average(
    columns: &[usize],
    odds: PriorOdds,
    state: &mut [f64],
    covariance: &mut [f64],
) -> Result<Vec<f64>, MapError> {
    let (n, total) = (columns.len(), state.len());
    let change: Vec<f64> = columns.iter().map(|&c| state[c]).collect();
    let own: Vec<f64> = (columns.iter())
        .flat_map(|&i| columns.iter().map(move |&k| (i, k)))
        .map(|(i, k)| covariance[i * total + k])
        .collect();
    let mut mixture = Mixture::new(n, 0);
    mixture.weigh(&change, &own, odds);
    let shared: Vec<f64> = (covariance.chunks_exact(total))
        .flat_map(|row| columns.iter().map(|&c| row[c]))
        .collect();
    apply((&change, &own), &shared, &mixture, state, covariance)?;
    Ok(mixture.probability)
}

/// Makes of a state estimated with changes `c`, `C` open, which share the covariance `P_·c` with it (a row per
/// entry), that of the mixture over them: the last two equations of [`average`].
///
/// # Errors
/// Returns [`MapError::Prior`] where `C` is no covariance.
pub(crate) fn apply(
    (change, own): (&[f64], &[f64]),
    shared: &[f64],
    mixture: &Mixture,
    state: &mut [f64],
    covariance: &mut [f64],
) -> Result<(), MapError> {
    let (n, total) = (change.len(), state.len());
    if n == 0 {
        return Ok(());
    }
    // P_·c C⁻¹, a row per entry of the state.
    let inverse = cholesky::inverse(own, n).map_err(MapError::Prior)?;
    let mut moves = Vec::with_capacity(total * n);
    for row in shared.chunks_exact(n) {
        moves.extend(inverse.chunks_exact(n).map(|line| dot(row, line)));
    }
    let further: Vec<f64> = (mixture.mean.iter().zip(change))
        .map(|(m, c)| m - c)
        .collect();
    let values = mixture.values;
    let spread = mixture.spread.chunks_exact(values.max(1)).take(n);
    let spread = spread.flat_map(|row| row.iter().take(n));
    let wider: Vec<f64> = spread.zip(own).map(|(v, c)| v - c).collect();
    for (i, x) in state.iter_mut().enumerate() {
        let own: &[f64] = &moves[i * n..(i + 1) * n];
        *x += dot(own, &further);
        let half: Vec<f64> = wider.chunks_exact(n).map(|row| dot(row, own)).collect();
        let row = &mut covariance[i * total..(i + 1) * total];
        for (p, other) in row.iter_mut().zip(moves.chunks_exact(n)) {
            *p += dot(&half, other);
        }
    }
    Ok(())
}

/// Changes and correlated values, averaged over all sets of changes that may have occurred.
///
/// # Realtime
/// Allocates when it is made only. O(n m²) a set for `n` changes among `m` values; 2ⁿ sets up to ten changes, of more `n²/2`.
#[derive(Debug, Clone)]
pub(crate) struct Mixture {
    changes: usize,
    values: usize,
    /// Sets of changes that may have occurred, one bit per change.
    sets: Vec<u128>,
    /// Probability of each change.
    pub(crate) probability: Vec<f64>,
    /// Mean per value, the changes first.
    pub(crate) mean: Vec<f64>,
    /// Covariance of the mixture, row-major.
    pub(crate) spread: Vec<f64>,
    /// Sums over the sets weighed so far.
    sums: Sums,
    /// Conditional mean, given that only the changes of a set occurred.
    conditional: Vec<f64>,
    covariance: Vec<f64>,
    row: Vec<f64>,
}

/// Weighted sums over sets, relative to the most probable of them.
#[derive(Debug, Clone)]
struct Sums {
    /// Logarithm of the largest evidence.
    most: f64,
    all: f64,
    probability: Vec<f64>,
    mean: Vec<f64>,
    spread: Vec<f64>,
}

impl Mixture {
    /// Allocates a mixture for `changes` changes and `more` values that depend on them.
    pub(crate) fn new(changes: usize, more: usize) -> Self {
        let values = changes + more;
        let vector = alloc::vec![0.0; values];
        let matrix = alloc::vec![0.0; values * values];
        Self {
            changes,
            values,
            sets: sets(changes).collect(),
            probability: alloc::vec![0.0; changes],
            mean: vector.clone(),
            spread: matrix.clone(),
            sums: Sums {
                most: f64::NEG_INFINITY,
                all: 0.0,
                probability: alloc::vec![0.0; changes],
                mean: vector.clone(),
                spread: matrix.clone(),
            },
            conditional: vector.clone(),
            covariance: matrix,
            row: vector,
        }
    }

    /// Sets that are weighed.
    pub(crate) fn sets(&self) -> usize {
        self.sets.len()
    }

    /// Weighs all sets; `values` with `covariance` are those with all changes open, the changes
    /// first.
    pub(crate) fn weigh(&mut self, values: &[f64], covariance: &[f64], odds: PriorOdds) {
        self.begin();
        self.weigh_some(0..self.sets(), (values, covariance), odds);
        self.finish();
    }

    /// Starts a new weighting of subsets; the previous result remains valid until [`Mixture::finish`].
    pub(crate) fn begin(&mut self) {
        let sums = &mut self.sums;
        (sums.most, sums.all) = (f64::NEG_INFINITY, 0.0);
        for of in [&mut sums.probability, &mut sums.mean, &mut sums.spread] {
            of.fill(0.0);
        }
    }

    /// Weighs some of the sets.
    pub(crate) fn weigh_some(
        &mut self,
        some: Range<usize>,
        (values, covariance): (&[f64], &[f64]),
        odds: PriorOdds,
    ) {
        let n = self.values.max(1);
        let all_of_them = bit(self.changes).wrapping_sub(1);
        let is_one = odds.occurrence == Occurrence::AsOne;
        for k in some {
            let Some(&set) = self.sets.get(k) else {
                return;
            };
            if is_one && set != 0 && set != all_of_them {
                continue;
            }
            copy(&mut self.conditional, values);
            copy(&mut self.covariance, covariance);
            let mut evidence = odds.ln_prior(set.count_ones() as usize, self.changes);
            for i in (0..self.changes).filter(|&i| !happened(set, i)) {
                evidence += self.remove(i, odds.std);
            }
            // Weights are relative to the largest so far.
            let weight = self.sums.weight(evidence);
            for (i, probability) in self.sums.probability.iter_mut().enumerate() {
                *probability += if happened(set, i) { weight } else { 0.0 };
            }
            for (mean, x) in self.sums.mean.iter_mut().zip(&self.conditional) {
                *mean += weight * x;
            }
            let rows = self.sums.spread.chunks_exact_mut(n);
            let own = self.covariance.chunks_exact(n).zip(&self.conditional);
            for (row, (line, x)) in rows.zip(own) {
                for ((sum, p), y) in row.iter_mut().zip(line).zip(&self.conditional) {
                    *sum += weight * (p + x * y);
                }
            }
        }
    }

    /// Computes the result of the sets weighed since [`Mixture::begin`].
    pub(crate) fn finish(&mut self) {
        let (n, sums) = (self.values.max(1), &self.sums);
        for (to, from) in [
            (&mut self.probability, &sums.probability),
            (&mut self.mean, &sums.mean),
            (&mut self.spread, &sums.spread),
        ] {
            for (to, sum) in to.iter_mut().zip(from) {
                *to = sum / sums.all;
            }
        }
        let rows = self.spread.chunks_exact_mut(n);
        for (row, x) in rows.zip(&self.mean) {
            for (sum, y) in row.iter_mut().zip(&self.mean) {
                *sum -= x * y;
            }
        }
    }

    /// Conditions the others on value `i` being zero; returns the logarithm of its evidence.
    fn remove(&mut self, i: usize, std: f64) -> f64 {
        let n = self.values.max(1);
        let line = self.covariance.get(i * n..(i + 1) * n).unwrap_or_default();
        copy(&mut self.row, line);
        let (Some(&pivot), Some(&conditional)) = (self.row.get(i), self.conditional.get(i)) else {
            return 0.0;
        };
        let step = conditional / pivot;
        for (x, own) in self.conditional.iter_mut().zip(&self.row) {
            *x -= own * step;
        }
        for (line, own) in self.covariance.chunks_exact_mut(n).zip(&self.row) {
            let factor = own / pivot;
            for (p, other) in line.iter_mut().zip(&self.row) {
                *p -= factor * other;
            }
        }
        -0.5 * conditional * step - 0.5 * libm::log(pivot / (std * std))
    }
}

impl Sums {
    /// Weight of a set of this evidence. Where none was larger, the others lose.
    fn weight(&mut self, evidence: f64) -> f64 {
        if evidence > self.most {
            let less = libm::exp(self.most - evidence);
            self.all *= less;
            let sums = self.probability.iter_mut().chain(&mut self.mean);
            for sum in sums.chain(&mut self.spread) {
                *sum *= less;
            }
            self.most = evidence;
        }
        let weight = libm::exp(evidence - self.most);
        self.all += weight;
        weight
    }
}

/// Sets of changes that may have happened, a bit each.
pub(crate) fn sets(n: usize) -> impl Iterator<Item = u128> {
    let many = n > ALL_SETS;
    let (range, pairs) = if many { (0, n) } else { (bit(n), 0) };
    let ends = if many {
        [0, bit(n).wrapping_sub(1)]
    } else {
        [0; 2]
    };
    let some = (0..pairs).flat_map(|i| (0..=i).map(move |k| bit(i) | bit(k)));
    let ends = ends.into_iter().take(if many { 2 } else { 0 });
    (0..range).chain(some).chain(ends)
}

fn bit(i: usize) -> u128 {
    1_u128.checked_shl(i as u32).unwrap_or(0)
}

/// Whether change `i` is in a set.
pub(crate) fn happened(set: u128, i: usize) -> bool {
    set & bit(i) != 0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::fixtures::random;

    const D: usize = 7;
    const ODDS: PriorOdds = PriorOdds {
        std: 0.4,
        odds: 0.1,
        occurrence: Occurrence::Apart,
    };

    fn positive_definite(seed: &mut u64, least: f64) -> Vec<f64> {
        let a: Vec<f64> = (0..D * D).map(|_| random(seed)).collect();
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

    /// Each set has its own prior covariance: the mixture is exact for linear data.
    #[test]
    fn average_equals_mixture_of_single_posteriors() {
        const ENTRIES: [usize; 3] = [1, 4, 5];
        const TOTAL: usize = D + ENTRIES.len();
        for first in [3, 17, 40] {
            let mut seed = first;
            let before = positive_definite(&mut seed, 0.3);
            let data = positive_definite(&mut seed, 0.1).map_all(|x| 4.0 * x);
            let start: Vec<f64> = (0..D).map(|_| random(&mut seed)).collect();
            let pull: Vec<f64> = (0..D).map(|_| 5.0 * random(&mut seed)).collect();
            // Posterior, and logarithm of the evidence but for what all share.
            let posterior = |set: u128| {
                let mut prior = before.clone();
                let all = ENTRIES.iter().enumerate();
                let own = all.filter(|(i, _)| happened(set, *i));
                let who: Vec<usize> = own.map(|(_, k)| *k).collect();
                for &k in &who {
                    prior[k * D + k] += ODDS.std * ODDS.std;
                }
                let information = sum(&cholesky::inverse(&prior, D).unwrap(), &data);
                let covariance = cholesky::inverse(&information, D).unwrap();
                let step = times(&covariance, &pull);
                let evidence = 0.5 * dot(&pull, &step)
                    - 0.5 * (log_determinant(&prior) + log_determinant(&information))
                    + who.len() as f64 * ODDS.odds.ln();
                (sum(&start, &step), covariance, evidence)
            };
            let sets: Vec<u128> = sets(ENTRIES.len()).collect();
            assert_eq!(sets.len(), 8);
            let each: Vec<_> = sets.iter().map(|set| posterior(*set)).collect();
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

            // With all changes free, the state is extended by the changes.
            let place = |k: usize| if k < D { k } else { ENTRIES[k - D] };
            let own = cholesky::inverse(&before, D).unwrap();
            let mut information = alloc::vec![0.0; TOTAL * TOTAL];
            for i in 0..TOTAL {
                for k in 0..TOTAL {
                    let believed = match (i < D, k < D) {
                        (true, true) => own[i * D + k],
                        _ if i == k => ODDS.std.powi(-2),
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
                let own = sets.iter().zip(&each).filter(|(set, _)| happened(**set, i));
                let expected: f64 = own.map(|(_, (.., e))| weight(*e)).sum();
                assert!((found - expected).abs() < 1e-9, "{found} {expected}");
                assert!(expected > 0.01, "{expected}: the case says nothing");
            }
        }
    }

    /// Directions without data keep their prior.
    #[test]
    fn without_data_odds_are_unchanged() {
        for n in [1, ALL_SETS + 2] {
            let mut p = alloc::vec![0.0; n * n];
            for i in 0..n {
                p[i * n + i] = ODDS.std * ODDS.std;
            }
            let mut x = alloc::vec![0.0; n];
            let columns: Vec<usize> = (0..n).collect();
            let probability = average(&columns, ODDS, &mut x, &mut p).unwrap();
            // Where there are many: none, sets of one and two, and all.
            let (one, two, last) = (0.1, 0.01 * (n - 1) as f64, 0.1_f64.powi(n as i32));
            let last = if n > 1 { last } else { 0.0 };
            let all = 1.0 + n as f64 * (one + 0.5 * two) + last;
            assert!((probability[0] - (one + two + last) / all).abs() < 1e-12);
            let expected = probability[0] * ODDS.std * ODDS.std;
            assert!((p[0] - expected).abs() < 1e-12, "{} {expected}", p[0]);
        }
    }

    /// For changes with a common cause every number is equally probable, and every set of a given number.
    #[test]
    fn without_data_joint_odds_are_unchanged() {
        let together = PriorOdds {
            occurrence: Occurrence::Together,
            ..ODDS
        };
        let n = 4;
        let mut p = alloc::vec![0.0; n * n];
        for i in 0..n {
            p[i * n + i] = ODDS.std * ODDS.std;
        }
        let columns: Vec<usize> = (0..n).collect();
        let mut x = alloc::vec![0.0; n];
        let probability = average(&columns, together, &mut x, &mut p).unwrap();
        // One to four of four, 0.1/4 each: a joint is in k/4 of the sets of k.
        let expected = 0.1 / 4.0 * (0.25 + 0.5 + 0.75 + 1.0) / 1.1;
        for found in probability {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }

    /// The components of one change occur all or none, and support each other.
    #[test]
    fn components_of_one_change_occur_together() {
        let occurrence = Occurrence::AsOne;
        let odds = PriorOdds { occurrence, ..ODDS };
        let n = 3;
        let columns: Vec<usize> = (0..n).collect();
        let of = |size: f64, std: f64| {
            let mut p = alloc::vec![0.0; n * n];
            for i in 0..n {
                p[i * n + i] = std * std;
            }
            let mut x = alloc::vec![size; n];
            let each = average(&columns, odds, &mut x, &mut p).unwrap();
            assert!(each.iter().all(|p| *p == each[0]), "{each:?}");
            each[0]
        };
        // Uninformative data leave odds of 0.1 to 1.
        assert!((of(0.0, ODDS.std) - 0.1 / 1.1).abs() < 1e-12);
        // N(0; x, C) over N(0; 0, S), three times.
        let (size, std): (f64, f64) = (0.2, 0.1);
        let each = libm::log(std / ODDS.std) + 0.5 * (size / std).powi(2);
        let expected = 0.1 * libm::exp(3.0 * each);
        let found = of(size, std);
        assert!(
            (found / (1.0 - found) / expected - 1.0).abs() < 1e-9,
            "{found}"
        );
    }

    /// Weak evidence for every change is strong evidence in total.
    #[test]
    fn joint_changes_support_each_other() {
        let n = 4;
        let of = |together: bool, shown: usize| {
            let occurrence = match together {
                true => Occurrence::Together,
                false => Occurrence::Apart,
            };
            let odds = PriorOdds { occurrence, ..ODDS };
            let mut p = alloc::vec![0.0; n * n];
            for i in 0..n {
                p[i * n + i] = 0.01;
            }
            let mut x: Vec<f64> = (0..n).map(|i| if i < shown { 0.25 } else { 0.0 }).collect();
            let columns: Vec<usize> = (0..n).collect();
            average(&columns, odds, &mut x, &mut p).unwrap()[0]
        };
        assert!(of(false, 1) < 0.5 && of(true, 1) < 0.5);
        assert!(
            of(false, 4) < 0.5 && of(true, 4) > 0.9,
            "{} {}",
            of(false, 4),
            of(true, 4)
        );
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
