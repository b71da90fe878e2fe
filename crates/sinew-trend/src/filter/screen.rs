//! Screening of all step changes of a window in one pass.

use super::bank::{Bank, LOST_SHARE, Prediction};
use super::component::{
    AMPLITUDE, BASELINE, Component, EXCESS, LEVEL, RETENSIONED, STATES, TAKEN_OUT,
};
use super::gauss::LogSum;
use super::prior::Prior;
use super::record::{TrendConfig, TrendEntry};

/// Candidate step changes: before each of some records.
///
/// Given a filter, its innovations `ν` with variances `S` respond to a unit step by `d`. A step
/// change of prior variance `V` explains them better than none by `½ (V q²/(1 + V p) − ln(1 + V
/// p))` with `p = Σ d²/S`, `q = Σ d ν/S`: its Gaussian integral over the size.
#[derive(Debug, Default)]
pub(super) struct Screen {
    candidates: Vec<Candidate>,
}

/// Candidate step change before one record.
#[derive(Debug)]
struct Candidate {
    /// Time interval in which it may have occurred, days.
    days: f64,
    /// Factor on its odds by the stiffness.
    support: f64,
    /// Per filter: response of its states to a unit step, and `p` and `q`.
    answers: Vec<([f64; STATES], f64, f64)>,
}

impl Screen {
    /// Adds a candidate step change before the next record.
    pub(super) fn candidate(&mut self, filters: usize, days: f64, support: f64) {
        let mut unit = [0.0; STATES];
        unit[LEVEL] = 1.0;
        self.candidates.push(Candidate {
            days,
            support,
            answers: vec![(unit, 0.0, 0.0); filters],
        });
    }

    /// Odds of any candidate against none; `rates`: per day, and standard deviations, rad.
    pub(super) fn odds(&self, bank: &Bank, rates: [(f64, f64); 2]) -> f64 {
        let mut none = LogSum::new();
        bank.components.iter().for_each(|c| none.add(c.log_weight));
        let none = none.value();
        let mut odds = 0.0;
        for candidate in &self.candidates {
            for (k, (rate, std_rad)) in rates.into_iter().enumerate() {
                let v = std_rad * std_rad;
                let mut sum = LogSum::new();
                for (c, (_, p, q)) in bank.components.iter().zip(&candidate.answers) {
                    let free = 1.0 + v * p;
                    sum.add(c.log_weight + 0.5 * (v * q * q / free - libm::log(free)));
                }
                // Large changes are not strand failures.
                let support = if k == 0 { candidate.support } else { 1.0 };
                odds += libm::exp(sum.value() - none) * rate * candidate.days * support;
            }
        }
        odds
    }

    /// Applies a function to every filter with its response to every candidate.
    fn each(&mut self, filters: &[Component], mut f: impl FnMut(&Component, &mut [f64; STATES])) {
        for candidate in &mut self.candidates {
            for (c, (answer, _, _)) in filters.iter().zip(&mut candidate.answers) {
                f(c, answer);
            }
        }
    }
}

impl Bank {
    /// Processes an entry without dropping filters, and updates every candidate.
    pub(super) fn screen(
        &mut self,
        prior: &Prior,
        config: &TrendConfig,
        entry: &TrendEntry,
        screen: &mut Screen,
    ) {
        let passing = self.passing(prior, entry.time_s());
        screen.each(&self.components, |c, answer| passing.apply(c, answer));
        self.advance(prior, entry.time_s());
        match entry {
            TrendEntry::Record(record) => {
                let Some((h, predictions)) = self.predict(prior, record) else {
                    return;
                };
                let offset = record.offset_rad.map_or(f64::NAN, |offset| offset.mean);
                let live = self.live();
                for candidate in &mut screen.candidates {
                    for ((answer, p, q), prediction) in
                        candidate.answers.iter_mut().zip(&predictions)
                    {
                        let Prediction { expected, s, .. } = prediction;
                        let d: f64 = h.iter().zip(answer.iter()).map(|(a, b)| a * b).sum();
                        *p += d * d / s;
                        *q += d * (offset - expected.mean) / s;
                        for (a, with) in answer.iter_mut().zip(&expected.with_states) {
                            *a -= with / s * d;
                        }
                    }
                }
                for (c, prediction) in self.components.iter_mut().zip(&predictions) {
                    c.log_weight += prediction.log_density;
                    let error = offset - prediction.expected.mean;
                    c.correct(&prediction.expected, error, prediction.s, live);
                }
                self.take_stiffness(record);
            }
            TrendEntry::Tensioned { .. } => {
                self.undergo(prior, config, entry);
                screen.each(&self.components, |_, answer| {
                    answer[RETENSIONED] = LOST_SHARE.mean * answer[AMPLITUDE];
                });
            }
            TrendEntry::Baseline { .. } => {
                self.undergo(prior, config, entry);
                screen.each(&self.components, |_, answer| {
                    answer[TAKEN_OUT] = -answer[LEVEL];
                    answer[BASELINE] = 0.0;
                    answer[EXCESS] = 0.0;
                });
            }
            other => self.undergo(prior, config, other),
        }
    }
}
