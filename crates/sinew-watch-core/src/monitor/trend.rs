//! A tendon's trend, from the best record of every day.

use super::Monitor;
use super::tendon_trend::{Made, TrendWork};
use crate::instant::Instant;
use sinew_trend::Stated;
use std::sync::Arc;

/// The trends of a robot's tendons, and which of them are to be made anew.
#[derive(Debug, Clone, Default)]
pub(super) struct Trends {
    of: Vec<Trended>,
}

#[derive(Debug, Clone, Default)]
struct Trended {
    made: Option<Made>,
    /// Whether its records changed since.
    changed: bool,
    /// When it was last begun.
    begun: Option<Instant>,
}

/// A trend is made anew at most so often, s: it is of days.
const BETWEEN_S: f64 = 3600.0;

impl Trends {
    pub(super) fn new(tendons: usize) -> Self {
        let one = Trended {
            changed: true,
            ..Trended::default()
        };
        Self {
            of: vec![one; tendons],
        }
    }

    pub(super) fn get(&self, tendon: usize) -> Option<&Made> {
        self.of.get(tendon)?.made.as_ref()
    }

    pub(super) fn set(&mut self, tendon: usize, made: Option<Made>) {
        if let Some(of) = self.of.get_mut(tendon) {
            of.made = made;
        }
    }

    pub(super) fn changed(&mut self, tendon: usize) {
        if let Some(of) = self.of.get_mut(tendon) {
            of.changed = true;
        }
    }

    pub(super) fn all_changed(&mut self) {
        for of in &mut self.of {
            (of.changed, of.begun) = (true, None);
        }
    }

    /// Nothing is known of what comes.
    pub(super) fn forget(&mut self, tendon: usize) {
        if let Some(of) = self.of.get_mut(tendon) {
            *of = Trended::default();
        }
    }

    /// The next to make anew.
    fn next(&mut self, now: Instant) -> Option<usize> {
        let is_due = |of: &Trended| {
            let waited = |begun: Instant| now.since_s(begun) >= BETWEEN_S;
            of.changed && of.begun.is_none_or(waited)
        };
        let next = self.of.iter().position(is_due)?;
        let of = &mut self.of[next];
        (of.changed, of.begun) = (false, Some(now));
        Some(next)
    }
}

impl Monitor {
    /// The next trend to make, if one is due.
    pub(super) fn trend_work(&mut self) -> Option<TrendWork> {
        let now = self.feed.ticked?;
        while let Some(tendon) = self.trends.next(now) {
            let joint = &self.names[tendon];
            let records = self.history.rows(joint);
            if records.is_empty() {
                continue;
            }
            let belief = &self.belief.tendons[tendon];
            let stated = |time_utc_s: f64, replaced: bool| Stated {
                joint: None,
                time_utc_s,
                replaced,
            };
            let replaced = belief.replaced_utc_s;
            let tensioned = belief.tensioned_utc_s.iter().copied();
            return Some(TrendWork {
                of: self.tensionings,
                tendon,
                joint: joint.clone(),
                records,
                stated: (tensioned.filter(|t| Some(*t) != replaced))
                    .map(|t| stated(t, false))
                    .chain(replaced.map(|t| stated(t, true)))
                    .collect(),
                catalogue: Arc::clone(&self.config.catalogue),
            });
        }
        None
    }
}
