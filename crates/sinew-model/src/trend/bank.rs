//! Filters side by side: one per pair of curve and noise.

use super::component::{
    AMPLITUDE, Component, DRIFT, LEVEL, SHARED, SLOW, STATES, TAKEN_OUT, TRIANGLE, entry,
};
use super::gauss::{LogSum, above_zero, log_normal};
use super::prior::{Noise, Prior};
use super::record::{Record, TrendConfig, TrendEntry};
use super::softened::Softened;
use crate::Gaussian;
use alloc::vec::Vec;

/// Standard deviation of a session's error in the offset per error of its stiffness, rad: half a
/// millirad per percent. A starting guess.
const SHARED_RAD: f64 = 0.05;
/// A filter this much less likely than the likeliest, e^-18 = 1.5e-8, is let go.
const NEGLIGIBLE: f64 = 18.0;

/// All filters at one time.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Bank {
    /// Time since tensioning, s.
    pub time_s: f64,
    pub components: Vec<Component>,
    /// The stiffness since the last jump.
    pub softened: Option<Softened>,
}

/// An update chosen: evidence of the record and whether it was taken as off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Updated {
    pub log_evidence: f64,
    pub off: bool,
}

impl Bank {
    pub(super) fn new(prior: &Prior) -> Self {
        let mut components = Vec::with_capacity(prior.curves.len() * prior.noises.len());
        for (i, curve) in prior.curves.iter().enumerate() {
            for (k, noise) in prior.noises.iter().enumerate() {
                let mut mean = [0.0; STATES];
                mean[AMPLITUDE] = curve.amplitude;
                let mut covariance = [0.0; TRIANGLE];
                let square = |v: f64| v * v;
                covariance[entry(LEVEL, LEVEL)] = square(prior.level_deviation_rad);
                covariance[entry(AMPLITUDE, AMPLITUDE)] = square(curve.amplitude_deviation);
                covariance[entry(DRIFT, DRIFT)] = square(prior.temperature_deviation_rad_per_k);
                covariance[entry(SLOW, SLOW)] = square(noise.slow_deviation_rad);
                covariance[entry(SHARED, SHARED)] = square(SHARED_RAD);
                components.push(Component {
                    curve: i as u32,
                    noise: k as u32,
                    // The amplitude's prior is cut at 0: what is left of it counts as all.
                    log_weight: curve.log_weight + noise.log_weight
                        - libm::log(above_zero(curve.amplitude, curve.amplitude_deviation)),
                    mean,
                    covariance,
                });
            }
        }
        Self {
            time_s: prior.baseline_s,
            components,
            softened: None,
        }
    }

    /// Mean of the true offset at the reference temperature, rad.
    pub(super) fn offset(&self) -> f64 {
        let mut all = LogSum::new();
        self.components.iter().for_each(|c| all.add(c.log_weight));
        let all = all.value();
        self.components
            .iter()
            .map(|c| libm::exp(c.log_weight - all) * (c.mean[LEVEL] + c.mean[TAKEN_OUT]))
            .sum()
    }

    /// Time passes: the level creeps on, its pace may leave its curve, the slow error forgets.
    pub(super) fn advance(&mut self, prior: &Prior, time_s: f64) {
        let dt = time_s - self.time_s;
        if !(dt > 0.0) {
            return;
        }
        let creep = creep(prior, self.time_s, time_s);
        let folds = folds(prior, self.time_s, time_s);
        for c in &mut self.components {
            let (Some(step), Some(curve), Some(noise)) = (
                creep.get(c.curve as usize),
                prior.curves.get(c.curve as usize),
                prior.noises.get(c.noise as usize),
            ) else {
                continue;
            };
            // Level after: level + amplitude · step.
            c.mean[LEVEL] += c.mean[AMPLITUDE] * step;
            let p = &mut c.covariance;
            p[entry(LEVEL, LEVEL)] +=
                step * (2.0 * p[entry(AMPLITUDE, LEVEL)] + step * p[entry(AMPLITUDE, AMPLITUDE)]);
            for k in TAKEN_OUT..STATES {
                p[entry(LEVEL, k)] += step * p[entry(AMPLITUDE, k)];
            }
            // The amplitude walks, by shares of itself; one near 0 can still rise.
            let size = c.mean[AMPLITUDE].max(0.1 * (curve.amplitude + curve.amplitude_deviation));
            let walk = noise.pace_error * size;
            let walk = walk * walk * folds;
            p[entry(AMPLITUDE, AMPLITUDE)] += walk;
            p[entry(AMPLITUDE, LEVEL)] += 0.5 * walk * step;
            p[entry(LEVEL, LEVEL)] += walk * step * step / 3.0;
            // Creep comes in steps: a day of hard work does what ten others don't.
            p[entry(LEVEL, LEVEL)] += prior.step_rad * (c.mean[AMPLITUDE] * step).max(0.0);
            let phi = libm::exp(-dt / noise.slow_time_s);
            c.mean[SLOW] *= phi;
            for k in (0..STATES).filter(|k| *k != SLOW) {
                p[entry(SLOW, k)] *= phi;
            }
            let own = &mut p[entry(SLOW, SLOW)];
            let stationary = noise.slow_deviation_rad * noise.slow_deviation_rad;
            *own = stationary + phi * phi * (*own - stationary);
        }
        self.time_s = time_s;
    }

    /// [`Bank::advance`] with answers of the filters to a jump going along.
    pub(super) fn advance_keeping(
        &mut self,
        prior: &Prior,
        time_s: f64,
        answers: &mut [[f64; STATES]],
    ) {
        let dt = (time_s - self.time_s).max(0.0);
        let creep = creep(prior, self.time_s, time_s);
        for (c, answer) in self.components.iter().zip(answers) {
            let step = creep.get(c.curve as usize).copied().unwrap_or(0.0);
            answer[LEVEL] += answer[AMPLITUDE] * step;
            if let Some(noise) = prior.noises.get(c.noise as usize) {
                answer[SLOW] *= libm::exp(-dt / noise.slow_time_s);
            }
        }
        self.advance(prior, time_s);
    }

    /// Takes a record in without letting filters go, and adds what it says on a jump that the states
    /// answer to by `answers`: to the precision and to the precision times the mean. A record that
    /// is off even so says little.
    pub(super) fn answer(
        &mut self,
        prior: &Prior,
        record: &Record,
        config: &TrendConfig,
        answers: &mut [[f64; STATES]],
        sums: &mut [[f64; 2]],
    ) {
        let Some(Gaussian { mean: offset, .. }) = record.offset_rad else {
            return;
        };
        let h = self.sees(prior, record);
        for ((c, answer), sum) in self.components.iter_mut().zip(answers).zip(sums) {
            let (expected, variance) = c.predict(&h);
            let d: f64 = h.iter().zip(answer.iter()).map(|(a, b)| a * b).sum();
            // Where a jump as known so far leaves the record.
            let left = offset - expected - d * sum[1] / sum[0];
            let mut own = own_variance(prior, record, c);
            let wide = own + config.off_deviation_rad * config.off_deviation_rad;
            let free = variance + d * d / sum[0];
            let odds = log_normal(left, free + wide) - log_normal(left, free + own);
            if odds + libm::log(config.off_share) > libm::log(1.0 - config.off_share) {
                own = wide;
            }
            let s = variance + own;
            sum[0] += d * d / s;
            sum[1] += d * (offset - expected) / s;
            let gain = c.correct(&h, offset, own);
            for i in 0..STATES {
                answer[i] -= gain[i] * d;
            }
        }
        self.take_stiffness(record);
    }

    /// What a record sees of each state.
    fn sees(&self, prior: &Prior, record: &Record) -> [f64; STATES] {
        let warm = record
            .temperature_c
            .map_or(0.0, |t| t - prior.temperature_ref_c);
        let off = self.softened.map_or(0.0, |s| s.off(record));
        [1.0, 1.0, 0.0, warm, 1.0, off]
    }

    fn take_stiffness(&mut self, record: &Record) {
        if let Some(softened) = &mut self.softened {
            softened.take(record);
        }
    }

    /// It may have jumped again: what is known of the stiffness ends.
    pub(super) fn forget_stiffness(&mut self) {
        if self.softened.is_some() {
            self.jumped();
        }
    }

    /// The tendon has jumped: a strand may have failed, whose stiffness every session finds anew.
    pub(super) fn jumped(&mut self) {
        self.softened = Some(Softened::new());
    }

    /// Opens the level (or what was taken out) to a change of `deviation_rad`.
    pub(super) fn open(&mut self, state: usize, deviation_rad: f64) {
        for c in &mut self.components {
            c.covariance[entry(state, state)] += deviation_rad * deviation_rad;
        }
    }

    /// After a failed strand sessions may scatter as they didn't before: each filter also with the
    /// other levels of the records' own errors.
    pub(super) fn reconsider_errors(&mut self, prior: &Prior) {
        /// Probability of each other level.
        const OTHER: f64 = 0.1;
        let alike = |a: &Noise, b: &Noise| {
            a.slow_deviation_rad == b.slow_deviation_rad
                && a.slow_time_s == b.slow_time_s
                && a.pace_error == b.pace_error
        };
        let mut more = Vec::new();
        for c in &self.components {
            let Some(own) = prior.noises.get(c.noise as usize) else {
                continue;
            };
            for (other, noise) in (0u32..).zip(&prior.noises) {
                if other != c.noise && alike(own, noise) {
                    more.push(Component {
                        noise: other,
                        log_weight: c.log_weight + libm::log(OTHER),
                        ..*c
                    });
                }
            }
        }
        self.components.extend(more);
    }

    /// Takes a record in; one without an offset changes nothing.
    pub(super) fn update(
        &mut self,
        prior: &Prior,
        record: &Record,
        config: &TrendConfig,
    ) -> Updated {
        let none = Updated {
            log_evidence: 0.0,
            off: false,
        };
        let Some(Gaussian { mean: offset, .. }) = record.offset_rad else {
            return none;
        };
        let h = self.sees(prior, record);
        let own = |c: &Component| own_variance(prior, record, c);
        let add = config.off_deviation_rad * config.off_deviation_rad;
        // Evidence of both readings of the record, over all filters.
        let mut plain = LogSum::new();
        let mut wide = LogSum::new();
        let mut all = LogSum::new();
        for c in &self.components {
            let (expected, variance) = c.predict(&h);
            let r = own(c);
            plain.add(c.log_weight + log_normal(offset - expected, variance + r));
            wide.add(c.log_weight + log_normal(offset - expected, variance + r + add));
            all.add(c.log_weight);
        }
        let plain_e = plain.value() - all.value() + libm::log(1.0 - config.off_share);
        let wide_e = wide.value() - all.value() + libm::log(config.off_share);
        let is_off = wide_e > plain_e;
        for c in &mut self.components {
            let r = own(c) + if is_off { add } else { 0.0 };
            c.correct(&h, offset, r);
        }
        self.let_go();
        self.take_stiffness(record);
        Updated {
            log_evidence: plain_e.max(wide_e),
            off: is_off,
        }
    }

    /// Runs filters through entries; logarithm of the evidence, and which records were taken as off.
    pub(super) fn run(
        &mut self,
        prior: &Prior,
        config: &TrendConfig,
        entries: &[TrendEntry],
    ) -> (f64, Vec<bool>) {
        let mut log_evidence = 0.0;
        let mut off = Vec::with_capacity(entries.len());
        for entry in entries {
            let mut is_off = false;
            match entry {
                TrendEntry::Record(record) => {
                    self.advance(prior, record.time_s);
                    let updated = self.update(prior, record, config);
                    log_evidence += updated.log_evidence;
                    is_off = updated.off;
                }
                TrendEntry::Jump {
                    time_s,
                    deviation_rad,
                } => {
                    self.advance(prior, *time_s);
                    self.open(LEVEL, *deviation_rad);
                    self.reconsider_errors(prior);
                    self.jumped();
                }
                TrendEntry::Tensioned { time_s } => {
                    self.advance(prior, *time_s);
                    self.open(TAKEN_OUT, config.fall_deviation_rad);
                }
            }
            off.push(is_off);
        }
        (log_evidence, off)
    }

    /// Drops filters that don't count any more and brings the likeliest to weight 0.
    fn let_go(&mut self) {
        let most = self
            .components
            .iter()
            .map(|c| c.log_weight)
            .fold(f64::NEG_INFINITY, f64::max);
        if most.is_finite() {
            self.components.retain(|c| c.log_weight > most - NEGLIGIBLE);
            self.components
                .iter_mut()
                .for_each(|c| c.log_weight -= most);
        }
    }

    /// At most `count` filters that stand for all: systematic draws by weight, equal ones merged.
    pub(super) fn thinned(&self, count: usize) -> Self {
        let mut sum = LogSum::new();
        self.components.iter().for_each(|c| sum.add(c.log_weight));
        let total = sum.value();
        let mut components = Vec::with_capacity(count);
        let (mut reached, mut drawn) = (0.0, 0usize);
        for c in &self.components {
            reached += libm::exp(c.log_weight - total);
            let mut times = 0usize;
            while drawn < count && (drawn as f64 + 0.5) / (count as f64) < reached {
                drawn += 1;
                times += 1;
            }
            if times > 0 {
                components.push(Component {
                    log_weight: libm::log(times as f64),
                    ..*c
                });
            }
        }
        Self {
            time_s: self.time_s,
            components,
            softened: self.softened,
        }
    }
}

/// Creep between two times for an amplitude of 1, per curve, rad.
pub(super) fn creep(prior: &Prior, from_s: f64, to_s: f64) -> Vec<f64> {
    prior
        .curves
        .iter()
        .map(|c| c.at(to_s) - c.at(from_s))
        .collect()
}

/// E-folds of time since tensioning between two times.
pub(super) fn folds(prior: &Prior, from_s: f64, to_s: f64) -> f64 {
    // The clock begins with the baseline, which a logarithm needs to be above 0.
    let start = prior.baseline_s.max(60.0);
    libm::log(to_s.max(start) / from_s.max(start)).max(0.0)
}

/// Variance of a record's own error as a filter sees it, rad².
fn own_variance(prior: &Prior, record: &Record, c: &Component) -> f64 {
    /// A temperature nobody wrote down is not known to some 5 K, and the drift blurs the record.
    const UNKNOWN_K: f64 = 5.0;
    let deviation = record.offset_rad.map_or(0.0, |offset| offset.deviation);
    let scale = prior
        .noises
        .get(c.noise as usize)
        .map_or(1.0, |n| n.white_scale);
    let blur = match record.temperature_c {
        Some(_) => 0.0,
        None => UNKNOWN_K * prior.temperature_deviation_rad_per_k,
    };
    deviation * deviation * scale * scale + blur * blur
}
