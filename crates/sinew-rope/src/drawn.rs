//! Simulation of a strand at the catalogue values and in every draw.

use super::CatalogueRope;
use super::caution::Caution;
use super::draws::{Draw, Draws, bounded};
use super::life::{
    BreakCause, LIFE_MOST_S, MAY_BREAK_SHARE, RopeLifetime, bent_share, cause, life_s, spots, wear,
};
use super::limits;
use super::predict_error::PredictError;
use super::prediction::{PredictedElongation, Prediction, PulleyPlace, cautions};
use super::route::Request;
use super::strand::{Mean, StrandError, Trajectory, strand};
use super::times::TENSIONED_AFTER_S;
use crate::law::endurance::Endurance;
use crate::law::routing::{self, Pulley};
use crate::law::tested_range::Extrapolation;
use crate::law::{Law, RopeLoad, State, damage};
use rayon::prelude::*;
use sinew_files::interrupt;
use sinew_model::Bounded;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Simulated strand of one rope at the catalogue values and in every draw.
pub(crate) struct Drawn {
    pub(crate) draws: Draws,
    read_at: RopeLoad,
    /// A minute after tensioning, then at the times of the request.
    nominal: Vec<Mean>,
    /// Results in each draw, up to the break of the rope.
    drawn: Vec<Trajectory>,
    /// Time at which the rope breaks, s, within the requested times.
    pub(crate) breaks_after_s: Option<f64>,
    /// Predicted lifetime of the rope.
    pub(crate) lifetime: RopeLifetime,
    /// Extrapolation distance of the duty from the tested range of the rope.
    extrapolation: Extrapolation,
}

/// Runs a strand through the duty, at the catalogue's values and in every draw, up to where it
/// breaks.
pub(crate) fn drawn(
    rope: &CatalogueRope,
    request: &Request,
    done: &(dyn Fn(usize) + Sync),
) -> Result<Drawn, PredictError> {
    limits::check(rope, request)?;
    let draws = Draws::new(rope, request.draws, request.seed)?;
    let summary = request.duty.summary();
    let read_at = request.read_at.unwrap_or(RopeLoad::celsius(
        summary.tension_mean_n,
        summary.temperature_mean_c,
    ));
    let to_error = |error| PredictError::Load {
        rope: rope.entry.name.clone(),
        error,
    };
    let hardest = RopeLoad::celsius(summary.tension_max_n, summary.temperature_max_c);
    draws.nominal.rates(hardest).map_err(to_error)?;
    let rope_m = rope.diameter_m();
    let wears = wear(&draws.nominal, &draws.endurance, request, rope_m)?;
    let life = life_s(&wears).min(LIFE_MOST_S);
    if life <= TENSIONED_AFTER_S {
        let name = rope.entry.name.clone();
        let e = &draws.endurance;
        let pulleys: Vec<&Pulley> = request.route.pulleys.iter().collect();
        let bent_share = bent_share(e, &pulleys, rope_m);
        let weakest = request.route.termination.share(e).min(bent_share);
        let strength = weakest * e.strength_share(hardest.temperature_k);
        let strength_n = strength * draws.nominal.parameters().breaking_load_n;
        // Friction on the guides pulls a rope that moves harder than its drive does.
        let friction = draws.nominal.parameters().friction;
        let share = match request.route.stroke_m > 0.0 {
            true => routing::far_share(&request.route.pulleys, friction, false),
            false => 1.0,
        };
        let tension_n = share * summary.tension_max_n;
        return Err(if tension_n > strength_n {
            PredictError::TooWeak {
                rope: name,
                tension_n,
                strength_n,
                temperature_c: summary.temperature_max_c,
                termination: request.route.termination,
                is_bent: bent_share <= weakest && bent_share < 1.0,
            }
        } else {
            PredictError::BreaksEarly {
                rope: name,
                tension_n,
                cause: cause(&wears),
                time_s: life,
            }
        });
    }
    let mut times = vec![TENSIONED_AFTER_S];
    times.extend(&request.times_s);
    let lasts = times.iter().position(|t| *t >= life);
    let within = &times[..lasts.unwrap_or(times.len())];
    let nominal = strand(&draws.nominal, request, read_at, rope_m, within);
    let nominal = nominal.map_err(|e| match e {
        StrandError::Load(error) => to_error(error),
        StrandError::Routing(error) => error.into(),
    })?;
    let extrapolation = draws.extrapolation(
        [summary.tension_mean_n, summary.tension_max_n],
        [summary.temperature_min_c, summary.temperature_max_c],
    );
    let finished = AtomicUsize::new(0);
    let each: Vec<Draw<'_>> = draws.each(extrapolation).collect();
    let simulated = each.par_iter().map(|draw| {
        interrupt::check();
        let Draw { law, endurance, .. } = *draw;
        let life_s = wear(law, endurance, request, rope_m).map_or(0.0, |w| life_s(&w));
        let load_share = law.load_ratio(read_at.tension_n);
        let trajectory = Trajectory::new(draw, life_s, load_share, &times, |times_s| {
            strand(law, request, read_at, rope_m, times_s).ok()
        });
        done(finished.fetch_add(1, Ordering::Relaxed) + 1);
        trajectory
    });
    let drawn: Vec<Trajectory> = simulated.collect();
    let lives_s: Vec<f64> = drawn.iter().map(|c| c.life_s).collect();
    let last_s = request.times_s.last().copied().unwrap_or(0.0);
    let early = lives_s.iter().filter(|l| **l <= last_s).count();
    let life_range = bounded(life, &lives_s);
    Ok(Drawn {
        lifetime: RopeLifetime {
            breaks_after_s: (life_range.low.min(life) < LIFE_MOST_S).then_some(life_range),
            cause: cause(&wears),
            broken_share: early as f64 / lives_s.len().max(1) as f64,
            termination: request.route.termination,
            termination_share: request.route.termination.share(&draws.endurance),
            abrasion_factor: request.route.abrasion_factor,
            spots: spots(&wears, life.min(last_s)),
        },
        draws,
        read_at,
        nominal,
        drawn,
        breaks_after_s: (life <= last_s).then_some(life),
        extrapolation,
    })
}

impl Drawn {
    /// Endurance of the rope at the catalogue values.
    pub(crate) fn endurance(&self) -> &Endurance {
        &self.draws.endurance
    }

    /// Strength of the most bent section at the last requested time; `None` without bending or if the rope is
    /// broken by then.
    fn strength_left(&self, rope: &CatalogueRope, request: &Request) -> Option<Bounded> {
        let rope_m = rope.diameter_m()?;
        let last_s = *request.times_s.last()?;
        let route = &request.route;
        if self.breaks_after_s.is_some()
            || route.strokes_per_hour == 0.0
            || route.pulleys.is_empty()
        {
            return None;
        }
        let left = |law: &Law| {
            let worn = wear(law, self.endurance(), request, Some(rope_m)).unwrap_or_default();
            let most = spots(&worn, last_s)
                .iter()
                .map(|s| s.bending_damage)
                .fold(0.0, f64::max);
            let state = State {
                bending_damage: most,
                ..State::default()
            };
            damage::strength_left(&state)
        };
        let (nominal, drawn) = self.draws.map(left);
        Some(bounded(nominal, &drawn))
    }

    /// Elongation after pretensioning at the last requested time, m, per draw; `None` where the rope breaks.
    pub(crate) fn growth_m(&self, request: &Request) -> Vec<Option<f64>> {
        let of = |c: &Trajectory| {
            let (first, last) = (c.start()?, c.means.get(request.times_s.len())?);
            Some(0.01 * request.route.length_m * (last.strain - first.strain))
        };
        self.drawn.iter().map(of).collect()
    }

    /// Warning that the strain exceeds the manufacturer's discard strain at the catalogue values or in more
    /// than [`MAY_BREAK_SHARE`] of the draws.
    fn replaced(&self, rope: &CatalogueRope, request: &Request) -> Option<Caution> {
        let strain_ratio = rope.entry.discard_strain()?;
        let is_beyond = |m: &Mean| 0.01 * m.strain > strain_ratio;
        let (times, readings) = (&request.times_s, self.nominal.iter().skip(1));
        let first = times.iter().zip(readings).find(|(_, m)| is_beyond(m));
        let time_s = first.map(|(time_s, _)| *time_s);
        let beyond = |c: &&Trajectory| c.means.get(times.len()).is_none_or(is_beyond);
        let count = self.drawn.iter().filter(beyond).count();
        let share = count as f64 / self.drawn.len().max(1) as f64;
        (time_s.is_some() || share > MAY_BREAK_SHARE).then_some(Caution::Replace {
            strain_ratio,
            time_s,
            share,
        })
    }

    /// Summarises the draws as a prediction.
    pub(crate) fn prediction(&self, rope: &CatalogueRope, request: &Request) -> Prediction {
        let share = |broken: usize| broken as f64 / self.drawn.len().max(1) as f64;
        let broken = self.drawn.iter().filter(|c| c.means.is_empty()).count();
        let m_per_percent = 0.01 * request.route.length_m;
        let reading = |(at, &time_s): (usize, &f64)| {
            // The first is a minute after tensioning.
            let at = at + 1;
            let lasting = self.drawn.iter().filter(|c| c.means.len() > at).count();
            let drawn = self.drawn.iter();
            let drawn: Vec<[&Mean; 2]> = drawn
                .filter_map(|c| Some([c.start()?, c.at(at)?]))
                .collect();
            let nominal = [&self.nominal[0], &self.nominal[at]];
            let interval = |f: &dyn Fn(&[&Mean; 2]) -> f64| {
                let all: Vec<f64> = drawn.iter().map(f).collect();
                bounded(f(&nominal), &all)
            };
            let strain_percent = interval(&|m| m[1].strain);
            PredictedElongation {
                time_s,
                strain_ratio: strain_percent.scaled(0.01),
                elongation_m: strain_percent.scaled(m_per_percent),
                since_tensioned_m: interval(&|m| m[1].strain - m[0].strain).scaled(m_per_percent),
                irreversible_m: interval(&|m| m[1].irreversible).scaled(m_per_percent),
                broken_share: share(self.drawn.len() - lasting),
            }
        };
        let times = request.times_s.iter().take(self.nominal.len() - 1);
        let law = &self.draws.nominal;
        let mut cautions = cautions(rope, law, self.endurance(), request, self.extrapolation);
        if let Some(time_s) = self.breaks_after_s {
            let caution = match self.lifetime.cause {
                BreakCause::CreepRupture => Caution::CreepsApart { time_s },
                BreakCause::BendingFatigue => Caution::WornOut { time_s },
            };
            cautions.insert(0, caution);
        }
        cautions.extend(self.replaced(rope, request));
        let entry = &rope.entry;
        let rope_m = rope.diameter_m();
        let mut pulleys: Vec<PulleyPlace> = (request.route.pulleys.iter())
            .map(|p| PulleyPlace::new(p, rope_m))
            .collect();
        pulleys.sort_by(|a, b| a.at_m.total_cmp(&b.at_m));
        Prediction {
            pulleys,
            rope: entry.name.clone(),
            duty: request.duty.about.clone(),
            summary: request.duty.summary(),
            length_m: request.route.length_m,
            read_at_n: self.read_at.tension_n,
            read_at_c: self.read_at.temperature_k - crate::law::CELSIUS_ZERO_K,
            readings: times.enumerate().map(reading).collect(),
            strength_left_share: self.strength_left(rope, request),
            lifetime: self.lifetime.clone(),
            broken_share: share(broken),
            assumed_parameters: entry.assumed(),
            parameters: entry.law.len(),
            draws: request.draws,
            seed: request.seed,
            breaks_after_s: self.breaks_after_s,
            tested_range: rope.tested_range(),
            extrapolation: self.extrapolation,
            cautions,
        }
    }
}
