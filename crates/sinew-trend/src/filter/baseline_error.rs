//! What all sessions since one baseline get wrong together.

use super::component::{BASELINE, Component, EXCESS, entry};
use super::prior::{Noise, Prior};
use super::record::Record;

/// A session whose shared part is by less than this factor another than that of a level is of that level.
const ALIKE: f64 = 1.6;
/// No session is known to share less than this, rad.
const LEAST_RAD: f64 = 1e-12;
/// A temperature nobody wrote down is known to some 5 K.
const UNKNOWN_K: f64 = 5.0;

/// The shared part of a session's error, as far as it says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SharedPart {
    /// Its variance, rad².
    pub variance: f64,
    /// Whether the session stated it; else it is all of what it stated, of which what shows as scatter is its own.
    pub stated: bool,
}

/// The part of the sessions' errors that comes with their baseline, at up to two levels:
///
/// ```text
/// e_s = W(v_s) + own error,    Cov[e_s, e_t] = min(v_s, v_t)
/// ```
///
/// A session that knows less has the error of the one that knows more, and another one beside it: so do errors of a chain
/// of estimates of which each rests on the one before. Two states hold it: `W` of the better level and what the
/// poorer one adds. No number of sessions averages them away.
///
/// After a jump a strand may have failed. How its lost stiffness is misread is another error of all sessions since: what they
/// state more than before. The second state takes it up, and every session since sees it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BaselineError {
    /// The better level, and the poorer one.
    pub levels: [Option<SharedPart>; 2],
    /// That of the last session.
    pub last: Option<SharedPart>,
    /// What a jump has made of it.
    pub misread: Misread,
}

/// Whether sessions since a jump have an error that those before it hadn't.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Misread {
    /// They haven't, as far as they say.
    #[default]
    No,
    /// It jumped after the last session; the next one will say.
    Awaited,
    /// They have.
    Yes,
    /// They have, and it jumped again after the last session.
    AwaitedAgain,
}

/// What a record sees of the shared error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Shares {
    /// How much of each of the two states.
    pub(super) h: [f64; 2],
    /// The record's own part.
    pub(super) part: SharedPart,
    /// That of its level.
    level: SharedPart,
}

impl SharedPart {
    /// Of a record with an offset.
    pub(super) fn of(prior: &Prior, record: &Record) -> Option<Self> {
        let offset = record.offset_rad?;
        let least = LEAST_RAD * LEAST_RAD;
        let Some(shared) = record.shared else {
            let all = offset.deviation * offset.deviation;
            let blur = match record.temperature_c {
                Some(_) => 0.0,
                None => UNKNOWN_K * prior.temperature_deviation_rad_per_k,
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

    /// Its variance as a filter takes it. Where only the whole error is stated, what doesn't scatter is shared.
    fn variance_of(self, noise: &Noise) -> f64 {
        if self.stated {
            return self.variance;
        }
        let scatter = noise.white_scale * noise.white_scale;
        (1.0 - scatter).max(0.0) * self.variance
    }
}

impl Shares {
    /// What the record has beyond its level, and so counts as its own, rad².
    pub(super) fn beyond(&self, noise: &Noise) -> f64 {
        (self.part.variance_of(noise) - self.level.variance_of(noise)).max(0.0)
    }
}

impl BaselineError {
    /// Whether it can be one.
    pub(super) fn is_possible(&self) -> bool {
        let parts = self.levels.iter().chain([&self.last]).flatten();
        let finite = parts
            .clone()
            .all(|l| l.variance > 0.0 && l.variance.is_finite());
        finite && (self.levels[1].is_none() || self.levels[0].is_some())
    }

    /// It jumped.
    pub(super) fn jumped(&mut self) {
        self.misread = match self.misread {
            Misread::No | Misread::Awaited => Misread::Awaited,
            Misread::Yes | Misread::AwaitedAgain => Misread::AwaitedAgain,
        };
    }

    /// The first session after a jump: what it states more than the last one is new, and stays.
    fn softened(&mut self, part: SharedPart, prior: &Prior, components: &mut [Component]) {
        let again = match self.misread {
            Misread::Awaited => false,
            Misread::AwaitedAgain => true,
            Misread::No | Misread::Yes => return,
        };
        let before = self.last.unwrap_or(part);
        let more = part.variance - before.variance;
        self.misread = match again || more > 0.0 {
            true => Misread::Yes,
            false => Misread::No,
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

    /// A record of this shared part comes: a level is found or made for it.
    pub(super) fn meet(
        &mut self,
        part: SharedPart,
        prior: &Prior,
        components: &mut [Component],
    ) -> Shares {
        self.softened(part, prior, components);
        self.last = Some(part);
        let apart = |level: &SharedPart| libm::fabs(libm::log(part.variance / level.variance));
        let shares = |h: [f64; 2], level: SharedPart| Shares { h, part, level };
        let near = 2.0 * libm::log(ALIKE);
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
            [Some(_), Some(poorer)] if self.misread == Misread::Yes => shares([1.0, 1.0], poorer),
            [Some(better), Some(poorer)] => match apart(&better) <= apart(&poorer) {
                true => shares([1.0, 0.0], better),
                false => shares([1.0, 1.0], poorer),
            },
        }
    }

    /// Variance of both states before any record, as a filter takes it, rad².
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

/// A better level of variance `v` comes below the only one, of `v₀`: `W(v)` given `W(v₀)` is that of a Brownian bridge,
/// `(v/v₀) W(v₀)` with variance `v (v₀ − v)/v₀`.
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

    /// Sessions that state nearly as much are wrong by the same error; one that states much more has another one beside
    /// it, and of one that states much less theirs has another one beside it.
    #[test]
    fn sessions_that_state_nearly_the_same_share_one_error() {
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
            // What it states more counts as its own: 0.34² = 0.3² + 0.16².
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
