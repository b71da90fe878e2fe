//! Which part of an offset's error a session shares with all others since the same baseline.

use super::belief::Belief;
use super::effects::JointParameter as P;
use super::error::MapError;
use super::prior::Prior;
use crate::cholesky::{Factor, dot};
use alloc::vec::Vec;

/// Parts of an offset's error that other sessions have too, as standard deviations, rad.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SharedError {
    /// What comes with the baseline: the same in every session since then.
    pub baseline_rad: f64,
    /// What zero and stiffness do with temperature: proportional to its change since then.
    pub drift_rad: f64,
}

impl SharedError {
    /// The same of an offset of that standard deviation, rad: no part exceeds the whole.
    #[must_use]
    pub fn at_most(self, deviation_rad: f64) -> Self {
        Self {
            baseline_rad: self.baseline_rad.min(deviation_rad),
            drift_rad: self.drift_rad.min(deviation_rad),
        }
    }
}

/// The parts of each joint's offset error that come with the baseline; 0 for rigid joints.
///
/// A session starts from the mean `x₀` and the covariance `P₀` that a baseline left, offsets and payload opened and
/// all aged by a day. Given its recording it knows `x̂` with covariance `P`. The estimate is linear, so
///
/// ```text
/// x̂ − x = P P₀⁻¹ (x₀ − x) + own noise
/// ```
///
/// What the baseline got wrong, `x₀ − x` with its covariance `C`, is the same in every session that starts from it. With
/// `r = P₀⁻¹ P e`, `e` the joint's offset, the shared variance is `rᵀ C r`. What is opened or aged anew in each
/// session is its own. What zero and stiffness do with temperature, `α_T` and `c_K`, enters by a multiple of the change
/// of temperature: it is told apart, for sessions at other temperatures share it otherwise.
///
/// In a chain each session starts from what the one before knew. Of two estimates of which one rests on the other, the
/// errors have the covariance of the one that knows more (as a Kalman filter's): the part they share is the smaller.
///
/// * `baseline`: as it was saved. `before`, `after`: what the session began with and ended with.
/// * `continues`: whether the session goes on with the baseline's last recording, offsets and payload included.
///
/// # Errors
/// [`MapError`] when a belief is of another robot, or no covariance.
pub fn shared_errors(
    prior: &Prior,
    baseline: &Belief,
    before: &Belief,
    after: &Belief,
    continues: bool,
) -> Result<Vec<SharedError>, MapError> {
    let d = prior.dimension();
    for belief in [baseline, before, after] {
        belief.check_dimension(d)?;
    }
    // Scaled to unit diagonal: the parameters' units span fifteen orders of magnitude.
    let mut scale = Vec::with_capacity(d);
    for i in 0..d {
        let own = before.covariance[i * d + i];
        if !(own > 0.0 && own.is_finite()) {
            return Err(MapError::Prior(i));
        }
        scale.push(1.0 / libm::sqrt(own));
    }
    let mut scaled = before.covariance.clone();
    for (row, s) in scaled.chunks_exact_mut(d.max(1)).zip(&scale) {
        for (x, other) in row.iter_mut().zip(&scale) {
            *x *= s * other;
        }
    }
    let factor = Factor::of(&scaled, d).map_err(MapError::Prior)?;
    let of = parts(prior, continues);
    let of_joint = |joint: usize| {
        let offset = prior.place(joint, P::Offset);
        let row = &after.covariance[offset * d..(offset + 1) * d];
        let mut r: Vec<f64> = row.iter().zip(&scale).map(|(p, s)| p * s).collect();
        factor.solve(&mut r);
        r.iter_mut().zip(&scale).for_each(|(r, s)| *r *= s);
        // An average over what may have changed is wider than a linear estimate: no part exceeds the whole.
        let most = row[offset].max(0.0);
        let part = |which: Of| {
            let own = r
                .iter()
                .zip(&of)
                .map(|(r, of)| if *of == which { *r } else { 0.0 });
            let own: Vec<f64> = own.collect();
            let lines = baseline.covariance.chunks_exact(d.max(1));
            let variance: f64 = (own.iter().zip(lines))
                .filter(|(r, _)| **r != 0.0)
                .map(|(x, line)| x * dot(line, &own))
                .sum();
            libm::sqrt(variance.clamp(0.0, most))
        };
        SharedError {
            baseline_rad: part(Of::Baseline),
            drift_rad: part(Of::Temperature),
        }
    };
    let joints = (0..prior.joints()).map(|i| match prior.is_elastic(i) {
        true => of_joint(i),
        false => SharedError::default(),
    });
    Ok(joints.collect())
}

/// Whose an entry of the state is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Of {
    /// Every session's, as the baseline left it.
    Baseline,
    /// The same, and counts by the change of temperature.
    Temperature,
    /// One session's.
    Session,
}

/// Whose every entry of the state is.
fn parts(prior: &Prior, continues: bool) -> Vec<Of> {
    let opened = if continues { Of::Baseline } else { Of::Session };
    let mut out = alloc::vec![Of::Baseline; prior.dimension()];
    for i in 0..prior.joints() {
        for p in [P::Drift, P::Thermal] {
            out[prior.place(i, p)] = Of::Temperature;
        }
        for p in [P::Offset, P::Slack, P::Stuck] {
            out[prior.place(i, p)] = opened;
        }
    }
    out[prior.payload_place()..].fill(opened);
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cholesky;
    use crate::offset::belief::{Payload, UNKNOWN_OFFSET_RAD};
    use crate::offset::beliefs;
    use crate::offset::fixtures::{random, turntable};

    /// What readings `y = a x + noise` of a deviation leave of a belief, and `I − K A` of that, by information form.
    fn reading(belief: &Belief, rows: &[Vec<f64>], noise: &[f64]) -> (Belief, Vec<f64>) {
        let d = belief.mean.len();
        let before = cholesky::inverse(&belief.covariance, d).unwrap();
        let mut information = before.clone();
        for (row, s) in rows.iter().zip(noise) {
            for i in 0..d {
                for k in 0..d {
                    information[i * d + k] += row[i] * row[k] / (s * s);
                }
            }
        }
        let covariance = cholesky::inverse(&information, d).unwrap();
        // I − K A with K = P Aᵀ R⁻¹.
        let mut left = alloc::vec![0.0; d * d];
        for i in 0..d {
            left[i * d + i] = 1.0;
            for (row, s) in rows.iter().zip(noise) {
                let gain = dot(&covariance[i * d..(i + 1) * d], row) / (s * s);
                for k in 0..d {
                    left[i * d + k] -= gain * row[k];
                }
            }
        }
        let after = Belief {
            covariance,
            ..belief.clone()
        };
        (after, left)
    }

    #[test]
    fn it_is_what_the_estimators_gain_leaves_of_the_baselines_error() {
        let prior = turntable().prior;
        let d = prior.dimension();
        let mut seed = 5;
        let mut readings = |belief: &Belief, n: usize| {
            let mut rows = Vec::new();
            for _ in 0..n {
                // In units of what is believed, so that every entry counts.
                let row = (0..d).map(|k| random(&mut seed) / belief.entry(k).deviation);
                rows.push(row.collect::<Vec<f64>>());
            }
            let noise: Vec<f64> = (0..n).map(|_| 0.6 + 0.3 * random(&mut seed)).collect();
            reading(belief, &rows, &noise)
        };
        let fresh = prior.belief(Payload::Unknown, UNKNOWN_OFFSET_RAD);
        let (baseline, _) = readings(&fresh, 40);
        let mut before = baseline.clone();
        beliefs::age(&prior, &mut before);
        prior.open_offsets(&mut before, UNKNOWN_OFFSET_RAD);
        prior.open_payload(&mut before, Payload::Unknown);
        for n in [1, 12, 200] {
            let (after, left) = readings(&before, n);
            let found = shared_errors(&prior, &baseline, &before, &after, false).unwrap()[0];
            let offset = prior.place(0, P::Offset);
            let own = &left[offset * d..(offset + 1) * d];
            let opened = [P::Offset, P::Slack, P::Stuck].map(|p| prior.place(0, p));
            let warm = [P::Drift, P::Thermal].map(|p| prior.place(0, p));
            let is_opened = |k: usize| opened.contains(&k) || k >= prior.payload_place();
            let deviation = |which: &dyn Fn(usize) -> bool| {
                let mut variance = 0.0;
                for i in (0..d).filter(|&i| which(i)) {
                    for k in (0..d).filter(|&k| which(k)) {
                        variance += own[i] * baseline.covariance[i * d + k] * own[k];
                    }
                }
                libm::sqrt(variance)
            };
            // Rounding of inverses of matrices whose entries are known to a part in 1e4.
            let close = |found: f64, expected: f64| {
                assert!(
                    (found / expected - 1.0).abs() < 1e-6,
                    "{n}: {found} {expected}"
                );
            };
            let baseline_rad = deviation(&|k| !is_opened(k) && !warm.contains(&k));
            close(found.baseline_rad, baseline_rad);
            close(found.drift_rad, deviation(&|k| warm.contains(&k)));
            assert!(found.baseline_rad < after.entry(offset).deviation);
        }
    }

    #[test]
    fn a_session_that_taught_nothing_shares_nothing_one_that_goes_on_shares_all() {
        let prior = turntable().prior;
        let fresh = prior.belief(Payload::Unknown, UNKNOWN_OFFSET_RAD);
        let apart = shared_errors(&prior, &fresh, &fresh, &fresh, false).unwrap()[0];
        assert_eq!(apart.baseline_rad, 0.0);
        let goes_on = shared_errors(&prior, &fresh, &fresh, &fresh, true).unwrap()[0];
        assert!((goes_on.baseline_rad / UNKNOWN_OFFSET_RAD - 1.0).abs() < 1e-12);
    }
}
