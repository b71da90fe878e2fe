//! Step-change detector: each of the last records is tested as the first one after a step change.

use super::bank::Bank;
use super::component::LEVEL;
use super::gauss::LogSum;
use super::jump::jump_size;
use super::prior::Prior;
use super::record::{Event, TrendConfig, TrendEntry};
use super::screen::Screen;
use super::stiffness::Stiffness;

/// Number of seconds of a day.
const DAY_S: f64 = 86_400.0;
/// Maximum number of filters used to test for step changes.
pub(super) const MAX_TEST_FILTERS: usize = 160;

/// Minimum screened probability of a step change for an exact test.
const MIN_SCREENED_PROBABILITY: f64 = 0.005;

/// Hypothesis of a step change.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hypothesis {
    odds: f64,
    /// Index of the entry it precedes.
    at: usize,
    std_rad: f64,
    /// Whether two records support it.
    agreed: bool,
}

impl Hypothesis {
    /// Whether two records support it.
    pub(super) fn is_agreed(&self) -> bool {
        self.agreed
    }
}

/// Confirmed step change, and the entry to insert for it.
pub(super) struct Confirmed {
    pub(super) at: usize,
    pub(super) entry: TrendEntry,
    pub(super) event: Event,
}

/// Window of the last records, and the state before them.
pub(super) struct Window<'a> {
    pub(super) prior: &'a Prior,
    pub(super) config: &'a TrendConfig,
    pub(super) anchor: &'a Bank,
    pub(super) stiffness: Stiffness,
    pub(super) entries: &'a [TrendEntry],
    /// Number of records with an offset, including those in the window.
    pub(super) records: u64,
}

impl Window<'_> {
    /// Probability of a step change within the window, and the most probable hypothesis.
    pub(super) fn test_for_steps(&self) -> (f64, Option<Hypothesis>) {
        let start = self.anchor.thinned(MAX_TEST_FILTERS);
        let (none, off) = start.clone().run(self.prior, self.config, self.entries);
        let jumped = |e: &TrendEntry| matches!(e, TrendEntry::StepChange { .. });
        if !off.contains(&true) && !self.entries.iter().any(jumped) {
            let screened = self.screened(&start);
            if screened < MIN_SCREENED_PROBABILITY {
                return (screened, None);
            }
        }
        let mut all = LogSum::new();
        all.add(0.0);
        let mut jumps = LogSum::new();
        let mut best: Option<Hypothesis> = None;
        // Filters before each entry, so that a hypothesis starts where it differs.
        let mut before = start;
        let mut stiffness = self.stiffness;
        let reference_c = self.prior.temperature_ref_c;
        let mut so_far = 0.0;
        let inside = self.entries.iter().filter(|e| e.is_informative()).count() as u64;
        let mut earlier = self.records - inside.min(self.records);
        let mut last_s = before.time_s;
        for i in 0..self.entries.len() {
            let entry = self.entries[i];
            if entry.is_informative() {
                let time_s = entry.time_s();
                let follows_event = i > 0 && !matches!(self.entries[i - 1], TrendEntry::Record(_));
                // Two earlier records determine the level.
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
            so_far += before.run(self.prior, self.config, &[entry]).0;
            stiffness.take(&entry, reference_c);
        }
        let probability = libm::exp(jumps.value() - all.value());
        let probability = if probability.is_finite() {
            probability
        } else {
            0.0
        };
        (probability, best)
    }

    /// Probability of a step change within the window from one pass: exact if no record is an
    /// outlier and the stiffness since an earlier step change carries no information.
    fn screened(&self, start: &Bank) -> f64 {
        let config = self.config;
        let rates = [
            (config.jumps_per_day, config.jump_std_rad),
            (config.falls_per_day, config.fall_std_rad),
        ];
        let with = self.odds(start, rates);
        let odds = match start.stiffness_loss {
            None => with,
            Some(_) => {
                let mut forgetful = start.clone();
                forgetful.stiffness_loss = None;
                with.max(self.odds(&forgetful, rates))
            }
        };
        odds / (1.0 + odds)
    }

    /// Odds of any step change against none.
    fn odds(&self, start: &Bank, rates: [(f64, f64); 2]) -> f64 {
        let mut bank = start.clone();
        let mut stiffness = self.stiffness;
        let reference_c = self.prior.temperature_ref_c;
        let inside = self.entries.iter().filter(|e| e.is_informative()).count() as u64;
        let mut earlier = self.records - inside.min(self.records);
        let mut last_s = bank.time_s;
        let mut screen = Screen::default();
        for (i, entry) in self.entries.iter().enumerate() {
            if entry.is_informative() {
                let follows_event = i > 0 && !matches!(self.entries[i - 1], TrendEntry::Record(_));
                if earlier >= 2 && !follows_event {
                    let days = ((entry.time_s() - last_s) / DAY_S).clamp(0.1, 30.0);
                    let support = stiffness.support(&self.entries[i..], reference_c);
                    screen.candidate(bank.components.len(), days, libm::exp(support));
                }
                earlier += 1;
                last_s = entry.time_s();
            }
            bank.screen(self.prior, self.config, entry, &mut screen);
            stiffness.take(entry, reference_c);
        }
        screen.odds(&bank, rates)
    }

    /// Time of the first record after a step change, s.
    pub(super) fn time_s(&self, jump: &Hypothesis) -> f64 {
        self.entries[jump.at].time_s()
    }

    /// Hypotheses of a step change and of a large one before entry `at`; `log_prior` is added to
    /// their log-odds, and `support` of the stiffness to that of the first.
    fn hypotheses(
        &self,
        before: &Bank,
        at: usize,
        log_prior: f64,
        support: f64,
    ) -> [Hypothesis; 2] {
        let tail = &self.entries[at..];
        let config = self.config;
        [
            (config.jumps_per_day, config.jump_std_rad, support),
            (config.falls_per_day, config.fall_std_rad, 0.0),
        ]
        .map(|(rate, std_rad, support)| {
            let mut bank = before.clone();
            bank.advance(self.prior, tail[0].time_s());
            bank.open(LEVEL, std_rad);
            bank.forget_stiffness();
            let (evidence, off) = bank.run(self.prior, self.config, tail);
            let agree = tail
                .iter()
                .zip(&off)
                .filter(|(e, off)| e.is_informative() && !**off);
            Hypothesis {
                odds: evidence + log_prior + libm::log(rate) + support,
                at,
                std_rad,
                agreed: agree.count() >= 2,
            }
        })
    }

    /// Estimates the size of a step change, and creates the entry that inflates the variance of the
    /// level there.
    pub(super) fn confirm(&self, jump: &Hypothesis, now_s: f64, probability: f64) -> Confirmed {
        let &Hypothesis { at, std_rad, .. } = jump;
        let (head, tail) = self.entries.split_at(at);
        let time_s = tail.first().map_or(now_s, TrendEntry::time_s);
        let mut bank = self.anchor.clone();
        bank.run(self.prior, self.config, head);
        let after_s = head
            .iter()
            .rev()
            .find(|e| e.is_informative())
            .map_or(self.anchor.time_s, TrendEntry::time_s);
        let offset_before = bank.offset();
        let size_rad = jump_size(
            &bank.thinned(MAX_TEST_FILTERS),
            self.prior,
            tail,
            std_rad,
            self.config,
        );
        // A decrease by a large part of the offset is a re-tensioning, not a rope. A decrease far
        // beyond the offset is no re-tensioning either.
        const MIN_TENSIONING_FALL_RAD: f64 = 2e-3;
        const TIGHTER_RAD: f64 = 10e-3;
        let fell = size_rad.mean < -MIN_TENSIONING_FALL_RAD.max(0.4 * offset_before);
        let tensioned = fell && offset_before + size_rad.mean > -TIGHTER_RAD.max(offset_before);
        let entry = if tensioned {
            TrendEntry::Tensioned { time_s }
        } else {
            TrendEntry::StepChange { time_s, std_rad }
        };
        Confirmed {
            at,
            entry,
            event: Event {
                time_s,
                after_s,
                size_rad,
                confirmed_s: now_s,
                probability,
                sessions: if jump.agreed { 2 } else { 1 },
                tensioned,
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::curve::{Curve, node_times_s};
    use crate::filter::prior::Noise;
    use crate::filter::record::Record;
    use sinew_model::Gaussian;

    /// Linear creep and errors, so that the evidence of a step change has a closed form.
    fn linear() -> Prior {
        let curve = |amplitude: f64| Curve {
            retensioned: None,
            values: (node_times_s().iter())
                .map(|t| libm::log(t / 100.0))
                .collect(),
            amplitude,
            amplitude_std: 0.3 * amplitude,
            log_weight: 0.0,
        };
        let noise = |white_scale: f64| Noise {
            slow_std_rad: 0.2e-3,
            slow_time_s: 10.0 * DAY_S,
            white_scale,
            creep_rate_rel_error: 0.0,
            log_weight: 0.0,
        };
        let mut prior = Prior::new(vec![curve(1e-3), curve(0.5e-3)]);
        prior.noises = vec![noise(0.5), noise(1.1)];
        prior.step_rad = 0.0;
        prior
    }

    // Compares one pass through the window with one pass per possible step change.
    #[test]
    fn screen_matches_exact_hypotheses() {
        let (prior, config) = (linear(), TrendConfig::default());
        let session = |days: f64, jumped_rad: f64| {
            let scatter = 0.1e-3 * libm::sin(37.0 * days);
            let mean = 0.8e-3 * libm::log(24.0 * days) + scatter + jumped_rad;
            TrendEntry::Record(Record {
                time_s: days * DAY_S,
                offset_rad: Some(Gaussian::new(mean, 0.3e-3)),
                temperature_c: Some(23.0 + libm::sin(days)),
                ..Record::default()
            })
        };
        // Irregular session times, once twice a day, once after three weeks.
        const BEFORE: [f64; 6] = [1.0, 2.0, 3.5, 5.0, 6.0, 9.0];
        const INSIDE: [f64; 6] = [10.0, 11.5, 12.0, 33.0, 34.0, 36.5];
        const JUMPS_AT: usize = 3;
        let mut quiet = 0.0;
        for jump_rad in [0.0, 0.5e-3, 1e-3, -1e-3] {
            let mut anchor = Bank::new(&prior);
            anchor.run(&prior, &config, &BEFORE.map(|days| session(days, 0.0)));
            let mut entries = INSIDE.map(|days| session(days, 0.0));
            for (entry, days) in entries.iter_mut().zip(INSIDE).skip(JUMPS_AT) {
                *entry = session(days, jump_rad);
            }
            let window = Window {
                prior: &prior,
                config: &config,
                anchor: &anchor,
                stiffness: Stiffness::new(),
                entries: &entries,
                records: (BEFORE.len() + INSIDE.len()) as u64,
            };
            let (none, off) = anchor.clone().run(&prior, &config, &entries);
            assert!(!off.contains(&true));
            let mut odds = 0.0;
            let mut before_days = BEFORE[BEFORE.len() - 1];
            for (at, days) in INSIDE.into_iter().enumerate() {
                for (per_day, std_rad) in [
                    (config.jumps_per_day, config.jump_std_rad),
                    (config.falls_per_day, config.fall_std_rad),
                ] {
                    let mut jumped = anchor.clone();
                    let (head, tail) = entries.split_at(at);
                    let mut evidence = jumped.run(&prior, &config, head).0;
                    jumped.advance(&prior, days * DAY_S);
                    jumped.open(LEVEL, std_rad);
                    evidence += jumped.run(&prior, &config, tail).0;
                    odds += libm::exp(evidence - none) * per_day * (days - before_days);
                }
                before_days = days;
            }
            let screened = window.screened(&anchor);
            let expected = odds / (1.0 + odds);
            assert!(
                (screened / expected - 1.0).abs() < 1e-6,
                "{jump_rad}: {screened} {expected}"
            );
            // The screen responds to step changes.
            match jump_rad {
                0.0 => quiet = screened,
                _ => assert!(screened > 2.0 * quiet, "{jump_rad}: {screened} {quiet}"),
            }
        }
    }
}
