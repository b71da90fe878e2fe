//! Jumps: each of the last records as the first after one, held against none.

use super::bank::{Bank, LEVEL};
use super::gauss::LogSum;
use super::record::{Added, Entry, Event, informative, time_of};
use super::tracker::Trend;

/// Seconds of a day.
const DAY_S: f64 = 86_400.0;
/// Filters that jumps are judged with.
const JUDGES: usize = 160;

/// The likeliest jump so far.
#[derive(Debug, Clone, Copy)]
struct Best {
    odds: f64,
    /// Entry it comes before.
    at: usize,
    deviation_rad: f64,
    /// Whether two records speak for it.
    agreed: bool,
}

impl Trend {
    /// Holds jumps within the window against none, and confirms one that is sure.
    pub(super) fn judge(&mut self, now_s: f64, added: &mut Added) {
        let start = self.anchor.thinned(JUDGES);
        let (none, _) = self.run(&mut start.clone(), &self.entries);
        let mut all = LogSum::new();
        all.add(0.0);
        let mut jumps = LogSum::new();
        let mut best: Option<Best> = None;
        // Filters before each entry, so that a hypothesis begins where it differs.
        let mut before = start;
        let mut stiffness = self.stiffness;
        let reference_c = self.prior.temperature_ref_c;
        let mut so_far = 0.0;
        let inside = self.entries.iter().filter(|e| informative(e)).count() as u64;
        let mut earlier = self.records - inside.min(self.records);
        let mut last_s = before.time_s;
        for i in 0..self.entries.len() {
            let entry = self.entries[i];
            if informative(&entry) {
                let time_s = time_of(&entry);
                let follows_event = i > 0 && !matches!(self.entries[i - 1], Entry::Record(_));
                // Two records before say what the level was.
                if earlier >= 2 && !follows_event {
                    let days = ((time_s - last_s) / DAY_S).clamp(0.1, 30.0);
                    let support = stiffness.support(&self.entries[i..], reference_c);
                    let log_prior = so_far - none + libm::log(days);
                    for found in self.hypotheses(&before, i, log_prior, support) {
                        all.add(found.odds);
                        jumps.add(found.odds);
                        if best.is_none_or(|b| found.odds > b.odds) {
                            best = Some(found);
                        }
                    }
                }
                earlier += 1;
                last_s = time_s;
            }
            so_far += self.run(&mut before, core::slice::from_ref(&entry)).0;
            stiffness.take(&entry, reference_c);
        }
        let probability = libm::exp(jumps.value() - all.value());
        added.jump_probability = if probability.is_finite() {
            probability
        } else {
            0.0
        };
        let (Some(best), true) = (best, added.jump_probability > 0.5) else {
            return;
        };
        added.suspected_s = Some(time_of(&self.entries[best.at]));
        if best.agreed && added.jump_probability > self.config.confirm {
            added.confirmed = self.confirm(best, now_s, added.jump_probability);
            added.suspected_s = None;
            added.jump_probability = 0.0;
        }
    }

    /// A jump and a large one before entry `at`; `log_prior` is added to the logarithms of their odds,
    /// to the jump's also the stiffness' `support`.
    fn hypotheses(&self, before: &Bank, at: usize, log_prior: f64, support: f64) -> [Best; 2] {
        let tail = &self.entries[at..];
        let config = &self.config;
        [
            (config.jumps_per_day, config.jump_deviation_rad, support),
            (config.falls_per_day, config.fall_deviation_rad, 0.0),
        ]
        .map(|(rate, deviation_rad, support)| {
            let mut bank = before.clone();
            bank.advance(&self.prior, time_of(&tail[0]));
            bank.open(LEVEL, deviation_rad);
            bank.forget_stiffness();
            let (evidence, off) = self.run(&mut bank, tail);
            let agree = tail
                .iter()
                .zip(&off)
                .filter(|(e, off)| informative(e) && !**off);
            Best {
                odds: evidence + log_prior + libm::log(rate) + support,
                at,
                deviation_rad,
                agreed: agree.count() >= 2,
            }
        })
    }

    /// Writes a jump before entry `at` down and opens the level there; `None` where it is too small to
    /// speak of.
    fn confirm(&mut self, best: Best, now_s: f64, probability: f64) -> Option<Event> {
        let Best {
            at, deviation_rad, ..
        } = best;
        let (head, tail) = self.entries.split_at(at);
        let time_s = tail.first().map_or(now_s, time_of);
        let mut bank = self.anchor.clone();
        self.run(&mut bank, head);
        let after_s = head
            .iter()
            .rev()
            .find(|e| informative(e))
            .map_or(self.anchor.time_s, time_of);
        let offset_before = bank.offset();
        let [size_rad, size_deviation] =
            bank.thinned(JUDGES)
                .jump(&self.prior, tail, deviation_rad, self.off());
        // A fall by much of what there was is somebody with a wrench, not a rope.
        const LEAST_RAD: f64 = 2e-3;
        let tensioned = size_rad < -LEAST_RAD.max(0.4 * offset_before);
        let entry = if tensioned {
            Entry::Tensioned { time_s }
        } else {
            Entry::Jump {
                time_s,
                deviation_rad,
            }
        };
        self.entries.insert(at, entry);
        let mut bank = self.anchor.clone();
        self.run(&mut bank, &self.entries);
        self.current = bank;
        if size_rad.abs() < self.config.least_jump_rad {
            return None;
        }
        let event = Event {
            time_s,
            after_s,
            size_rad,
            deviation_rad: size_deviation,
            confirmed_s: now_s,
            probability,
            tensioned,
        };
        self.events.push(event);
        Some(event)
    }
}
