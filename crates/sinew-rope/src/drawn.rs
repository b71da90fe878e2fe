//! A strand of a rope as it might be: with the catalogue's values, and in every draw.

use super::CatalogueRope;
use super::caution::Caution;
use super::draws::{Draws, bounded};
use super::duty::DutySummary;
use super::limits::{self, STRAIN_MOST_PERCENT};
use super::predict::{Prediction, Reading, TENSIONED_AFTER_S, bending, cautions};
use super::refusal::PredictError;
use super::route::Request;
use super::strand::{Mean, StrandError, strand};
use rayon::prelude::*;
use sinew_model::rope::holds::Beyond;
use sinew_model::rope::{Law, RopeLoad};
use std::sync::atomic::{AtomicUsize, Ordering};

/// One rope's strand at the catalogue's values and in every draw.
pub(crate) struct Drawn {
    pub(crate) draws: Draws,
    read_at: RopeLoad,
    /// A minute after tensioning, then at the times of the request.
    nominal: Vec<Mean>,
    /// The same in each draw, up to where the rope breaks.
    drawn: Vec<Vec<Mean>>,
    /// When the rope has crept until it breaks.
    breaks_after_s: Option<f64>,
    /// How far the duty lies beyond the rope's data.
    beyond: Beyond,
}

/// How far a duty's loads and temperatures lie beyond a rope's data. Low loads count by their mean:
/// a moment without tension is no extrapolation.
fn beyond(rope: &CatalogueRope, law: &Law, duty: &DutySummary) -> Beyond {
    let share = [duty.tension_mean_n, duty.tension_max_n].map(|n| law.load_ratio(n));
    let celsius = [duty.temperature_min_c, duty.temperature_max_c];
    rope.holds().beyond(share, celsius)
}

/// Strains of one draw with what the law may miss beyond its data: `doubt` is a standard normal
/// number. The strain at once and what is added later are multiplied by `exp(doubt s)`, with `s` of
/// [`Beyond`].
fn widened(
    means: &[Mean],
    decades: impl Iterator<Item = f64>,
    beyond: Beyond,
    doubt: f64,
) -> Vec<Mean> {
    let start = means.first().copied().unwrap_or_default();
    let at_once = (doubt * beyond.deviation()).exp();
    let later = |(mean, decades): (&Mean, f64)| {
        let factor = (doubt * beyond.deviation_after(decades)).exp();
        Mean {
            strain: at_once * start.strain + factor * (mean.strain - start.strain),
            irreversible: factor * mean.irreversible,
        }
    };
    means.iter().zip(decades).map(later).collect()
}

/// Runs a strand through the duty, at the catalogue's values and in every draw. A rope that creeps
/// until it breaks has times up to there, or none where it must last the `whole` time.
pub(crate) fn drawn(
    rope: &CatalogueRope,
    request: &Request,
    whole: bool,
    done: &(dyn Fn(usize) + Sync),
) -> Result<Drawn, PredictError> {
    limits::check(rope, request)?;
    let draws = Draws::new(rope, request.draws, request.seed)?;
    let summary = request.duty.summary();
    let read_at = request.read_at.unwrap_or(RopeLoad::celsius(
        summary.tension_mean_n,
        summary.temperature_mean_c,
    ));
    let mut times = vec![TENSIONED_AFTER_S];
    times.extend(&request.times_s);
    let mut nominal = strand(&draws.nominal, request, read_at, &times).map_err(|e| match e {
        StrandError::Load(error) => PredictError::Load {
            rope: rope.entry.name.clone(),
            error,
        },
        StrandError::Routing(error) => error.into(),
    })?;
    let unbroken = |means: &[Mean]| {
        let past = |m: &Mean| m.strain > STRAIN_MOST_PERCENT;
        means.iter().position(past).unwrap_or(means.len())
    };
    let crept = unbroken(&nominal);
    let breaks_after_s = (crept < times.len()).then(|| {
        // Halved in the logarithm of time, to a hundredth of it.
        let whole = |t: f64| {
            let now = strand(&draws.nominal, request, read_at, &[t]);
            now.is_ok_and(|means| unbroken(&means) > 0)
        };
        let mut from = if crept > 0 { times[crept - 1] } else { 0.0 };
        let mut to = times[crept];
        while crept > 0 && to > 1.01 * from {
            let middle = (from * to).sqrt();
            if whole(middle) {
                from = middle;
            } else {
                to = middle;
            }
        }
        to
    });
    if let Some(time_s) = breaks_after_s
        && (crept == 0 || whole)
    {
        return Err(PredictError::Creeps {
            rope: rope.entry.name.clone(),
            tension_n: summary.tension_max_n,
            time_s,
        });
    }
    nominal.truncate(crept);
    let beyond = beyond(rope, &draws.nominal, &summary);
    let holds = rope.holds();
    let doubts = draws.doubts(rope, request.seed);
    let finished = AtomicUsize::new(0);
    let each = draws.laws.par_iter().zip(&doubts).map(|(law, doubt)| {
        let mut means = strand(law, request, read_at, &times).unwrap_or_default();
        done(finished.fetch_add(1, Ordering::Relaxed) + 1);
        means.truncate(unbroken(&means));
        let decades = times.iter().map(|t| holds.decades_beyond(*t));
        widened(&means, decades, beyond, *doubt)
    });
    let drawn = each.collect();
    Ok(Drawn {
        draws,
        read_at,
        nominal,
        drawn,
        breaks_after_s,
        beyond,
    })
}

impl Drawn {
    /// Elongation since tensioned at the last time asked for, m, in each draw; NaN where the rope
    /// breaks.
    pub(crate) fn growth_m(&self, request: &Request) -> Vec<f64> {
        let of = |m: &Vec<Mean>| match (m.first(), m.get(self.nominal.len() - 1)) {
            (Some(first), Some(last)) => {
                0.01 * request.route.length_m * (last.strain - first.strain)
            }
            _ => f64::NAN,
        };
        self.drawn.iter().map(of).collect()
    }

    /// What the draws say.
    pub(crate) fn prediction(&self, rope: &CatalogueRope, request: &Request) -> Prediction {
        let share = |broken: usize| broken as f64 / self.drawn.len().max(1) as f64;
        let broken = self.drawn.iter().filter(|m| m.is_empty()).count();
        let m_per_percent = 0.01 * request.route.length_m;
        let reading = |(at, &time_s): (usize, &f64)| {
            // The first is a minute after tensioning.
            let at = at + 1;
            let drawn: Vec<&Vec<Mean>> = self.drawn.iter().filter(|m| m.len() > at).collect();
            let interval = |f: &dyn Fn(&[Mean]) -> f64| {
                let all: Vec<f64> = drawn.iter().map(|m| f(m)).collect();
                bounded(f(&self.nominal), &all)
            };
            let strain_percent = interval(&|m| m[at].strain);
            Reading {
                time_s,
                strain_ratio: strain_percent.scaled(0.01),
                elongation_m: strain_percent.scaled(m_per_percent),
                since_tensioned_m: interval(&|m| m[at].strain - m[0].strain).scaled(m_per_percent),
                irreversible_m: interval(&|m| m[at].irreversible).scaled(m_per_percent),
                broken_share: share(self.drawn.len() - drawn.len()),
            }
        };
        let times = request.times_s.iter().take(self.nominal.len() - 1);
        let mut cautions = cautions(rope, &self.draws.nominal, request, self.beyond);
        if let Some(time_s) = self.breaks_after_s {
            cautions.insert(0, Caution::CreepsApart { time_s });
        }
        let entry = &rope.entry;
        Prediction {
            rope: entry.name.clone(),
            duty: request.duty.about.clone(),
            summary: request.duty.summary(),
            length_m: request.route.length_m,
            read_at_n: self.read_at.tension_n,
            read_at_c: self.read_at.temperature_k - sinew_model::rope::CELSIUS_ZERO_K,
            readings: times.enumerate().map(reading).collect(),
            strength_left_share: bending(rope, &self.draws, request),
            broken_share: share(broken),
            starting_guesses: entry.guesses(),
            parameters: entry.law.len(),
            draws: request.draws,
            seed: request.seed,
            breaks_after_s: self.breaks_after_s,
            holds: rope.holds(),
            beyond: self.beyond,
            cautions,
        }
    }
}
