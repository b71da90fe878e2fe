//! Common error of all sessions since one baseline.

use super::component::{BASELINE, Component, EXCESS, entry};
use super::prior::{Noise, Prior};
use super::record::Record;

/// Maximum ratio of standard deviations for a session to belong to an existing level.
const MAX_LEVEL_STD_RATIO: f64 = 1.6;
/// Minimum standard deviation of a common error, rad.
const MIN_COMMON_STD_RAD: f64 = 1e-12;
/// Standard deviation of a temperature that was not recorded, K.
const UNKNOWN_TEMPERATURE_STD_K: f64 = 5.0;

/// Common part of a session's error, as far as the session reports it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SharedPart {
    /// Variance of the common part, rad².
    pub variance: f64,
    /// Whether the session reported it; otherwise the whole reported error, of which the observed
    /// scatter is independent.
    pub stated: bool,
}

/// Part of the sessions' errors that comes with their baseline, at up to two levels:
///
/// ```text
/// e_s = W(v_s) + own error,    Cov[e_s, e_t] = min(v_s, v_t)
/// ```
///
/// A less accurate session has the error of the more accurate one plus an additional one, as in a
/// chain of estimates of which each is based on the previous one. Two states represent it: `W` of
/// the more accurate level, and the addition of the less accurate one. No number of sessions
/// averages them out.
///
/// After a step change a strand may have failed. The error of the estimated stiffness loss is
/// common to all sessions since then: the increase of their reported error. The second state
/// contains it, and every session since then observes it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BaselineError {
    /// More accurate level and less accurate level.
    pub levels: [Option<SharedPart>; 2],
    /// Common part of the last session.
    pub last: Option<SharedPart>,
    /// State of the additional error after a step change.
    pub misread: BaselineShift,
}

/// Presence of an additional common error in the sessions after a step change.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BaselineShift {
    /// No additional error reported.
    #[default]
    No,
    /// Step change after the last session; the next session decides.
    Awaited,
    /// Additional error present.
    Yes,
    /// Additional error present, and a further step change after the last session.
    AwaitedAgain,
}

/// Observation of the common error by a record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Shares {
    /// Coefficient of each of the two states.
    pub(super) h: [f64; 2],
    /// Common part of the record itself.
    pub(super) part: SharedPart,
    /// Common part of its level.
    level: SharedPart,
}

impl SharedPart {
    /// Common part of a record with an offset.
    pub(super) fn of(prior: &Prior, record: &Record) -> Option<Self> {
        let offset = record.offset_rad?;
        let least = MIN_COMMON_STD_RAD * MIN_COMMON_STD_RAD;
        let Some(shared) = record.shared else {
            let all = offset.std * offset.std;
            let blur = match record.temperature_c {
                Some(_) => 0.0,
                None => UNKNOWN_TEMPERATURE_STD_K * prior.temperature_std_rad_per_k,
            };
            return Some(Self {
                variance: (all + blur * blur).max(least),
                stated: false,
            });
        };
        Some(Self {
            variance: (shared.baseline_rad * shared.baseline_rad).max(least),
            stated: true,
        })
    }

    /// Variance under the noise of a filter. If only the whole error is reported, the part that
    /// does not scatter is common.
    fn variance_of(self, noise: &Noise) -> f64 {
        if self.stated {
            return self.variance;
        }
        let scatter = noise.white_scale * noise.white_scale;
        (1.0 - scatter).max(0.0) * self.variance
    }
}

impl Shares {
    /// Variance of the record beyond its level, counted as independent, rad².
    pub(super) fn beyond(&self, noise: &Noise) -> f64 {
        (self.part.variance_of(noise) - self.level.variance_of(noise)).max(0.0)
    }
}

impl BaselineError {
    /// Whether all values are valid.
    pub(super) fn is_possible(&self) -> bool {
        let parts = self.levels.iter().chain([&self.last]).flatten();
        let finite = parts
            .clone()
            .all(|l| l.variance > 0.0 && l.variance.is_finite());
        finite && (self.levels[1].is_none() || self.levels[0].is_some())
    }

    /// Registers a step change.
    pub(super) fn jumped(&mut self) {
        self.misread = match self.misread {
            BaselineShift::No | BaselineShift::Awaited => BaselineShift::Awaited,
            BaselineShift::Yes | BaselineShift::AwaitedAgain => BaselineShift::AwaitedAgain,
        };
    }

    /// Handles the first session after a step change: the increase of its reported error is new and
    /// permanent.
    fn after_step(&mut self, part: SharedPart, prior: &Prior, components: &mut [Component]) {
        let again = match self.misread {
            BaselineShift::Awaited => false,
            BaselineShift::AwaitedAgain => true,
            BaselineShift::No | BaselineShift::Yes => return,
        };
        let before = self.last.unwrap_or(part);
        let more = part.variance - before.variance;
        self.misread = match again || more > 0.0 {
            true => BaselineShift::Yes,
            false => BaselineShift::No,
        };
        let [Some(better), poorer] = self.levels else {
            return;
        };
        if !(more > 0.0) {
            return;
        }
        for c in components {
            if let Some(noise) = noise_of(prior, c) {
                let more = part.variance_of(noise) - before.variance_of(noise);
                c.open(EXCESS, more.max(0.0));
            }
        }
        let level = poorer.unwrap_or(better);
        self.levels[1] = Some(SharedPart {
            variance: level.variance + more,
            stated: part.stated,
        });
    }

    /// Finds or creates the level of a record with this common part.
    pub(super) fn meet(
        &mut self,
        part: SharedPart,
        prior: &Prior,
        components: &mut [Component],
    ) -> Shares {
        self.after_step(part, prior, components);
        self.last = Some(part);
        let apart = |level: &SharedPart| libm::fabs(libm::log(part.variance / level.variance));
        let shares = |h: [f64; 2], level: SharedPart| Shares { h, part, level };
        let near = 2.0 * libm::log(MAX_LEVEL_STD_RATIO);
        match self.levels {
            [None, _] => {
                for c in components {
                    let variance = noise_of(prior, c).map_or(0.0, |n| part.variance_of(n));
                    c.open(BASELINE, variance);
                }
                self.levels[0] = Some(part);
                shares([1.0, 0.0], part)
            }
            [Some(only), None] if apart(&only) <= near => shares([1.0, 0.0], only),
            [Some(only), None] if part.variance > only.variance => {
                for c in components {
                    let Some(noise) = noise_of(prior, c) else {
                        continue;
                    };
                    let more = part.variance_of(noise) - only.variance_of(noise);
                    c.open(EXCESS, more.max(0.0));
                }
                self.levels[1] = Some(part);
                shares([1.0, 1.0], part)
            }
            [Some(only), None] => {
                for c in components {
                    let Some(noise) = noise_of(prior, c) else {
                        continue;
                    };
                    split(c, part.variance_of(noise), only.variance_of(noise));
                }
                self.levels = [Some(part), Some(only)];
                shares([1.0, 0.0], part)
            }
            [Some(_), Some(poorer)] if self.misread == BaselineShift::Yes => {
                shares([1.0, 1.0], poorer)
            }
            [Some(better), Some(poorer)] => match apart(&better) <= apart(&poorer) {
                true => shares([1.0, 0.0], better),
                false => shares([1.0, 1.0], poorer),
            },
        }
    }

    /// Prior variance of both states under the noise of a filter, rad².
    pub(super) fn variances(&self, noise: &Noise) -> [f64; 2] {
        let of = |k: usize| self.levels[k].map(|l| l.variance_of(noise));
        let better = of(0).unwrap_or(0.0);
        [
            better,
            of(1).map_or(0.0, |poorer| (poorer - better).max(0.0)),
        ]
    }
}

fn noise_of<'a>(prior: &'a Prior, component: &Component) -> Option<&'a Noise> {
    prior.noises.get(component.noise as usize)
}

/// Inserts a level of variance `v` below the only one of `v₀`: `W(v)` given `W(v₀)` is that of a
/// Brownian bridge, `(v/v₀) W(v₀)` with variance `v (v₀ − v)/v₀`.
fn split(c: &mut Component, v: f64, v0: f64) {
    if !(v0 > 0.0 && v < v0) {
        return;
    }
    let share = v / v0;
    let free = share * (v0 - v);
    c.make(EXCESS, 1.0 - share, BASELINE);
    c.scale(BASELINE, share);
    c.open(BASELINE, free);
    c.open(EXCESS, free);
    c.covariance[entry(EXCESS, BASELINE)] -= free;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::generic_curves;

    // Sessions with nearly the same reported error share one error; a larger or smaller one adds a
    // second error.
    #[test]
    fn sessions_with_similar_std_share_one_error() {
        let prior = Prior::new(generic_curves(0.03));
        let noise = prior.noises[0];
        let stated = |mrad: f64| SharedPart {
            variance: 1e-6 * mrad * mrad,
            stated: true,
        };
        let met = |mrad: f64| {
            let mut error = BaselineError::default();
            let first = error.meet(stated(0.3), &prior, &mut []);
            assert_eq!((first.h, first.beyond(&noise)), ([1.0, 0.0], 0.0));
            let shares = error.meet(stated(mrad), &prior, &mut []);
            let [better, poorer] = error.variances(&noise).map(|v| 1e3 * libm::sqrt(v));
            (
                shares.h,
                1e3 * libm::sqrt(shares.beyond(&noise)),
                [better, poorer],
            )
        };
        let near = |is: f64, should: f64| (is - should).abs() < 1e-12;
        for (mrad, beyond) in [(0.2, 0.0), (0.29, 0.0), (0.3, 0.0), (0.34, 0.16)] {
            let (h, own, [better, poorer]) = met(mrad);
            assert_eq!(h, [1.0, 0.0], "{mrad}");
            // The excess of the reported error counts as independent: 0.34² = 0.3² + 0.16².
            assert!(near(own, beyond), "{mrad}: {own}");
            assert!(
                near(better, 0.3) && poorer == 0.0,
                "{mrad}: {better} {poorer}"
            );
        }
        // 0.5² = 0.3² + 0.4².
        let (h, own, [better, poorer]) = met(0.5);
        assert_eq!((h, own), ([1.0, 1.0], 0.0));
        assert!(near(better, 0.3) && near(poorer, 0.4), "{better} {poorer}");
        let (h, own, [better, poorer]) = met(0.18);
        assert_eq!((h, own), ([1.0, 0.0], 0.0));
        assert!(
            near(better, 0.18) && near(poorer, 0.24),
            "{better} {poorer}"
        );
    }
}
