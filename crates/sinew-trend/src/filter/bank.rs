//! Filters side by side: one per pair of curve and noise.

use super::baseline_error::{BaselineError, SharedPart, Shares};
use super::component::{
    AMPLITUDE, BASELINE, Component, DRIFT, EXCESS, Expected, LEVEL, SLOW, STATES, STIFFNESS,
    TAKEN_OUT, TRIANGLE, entry,
};
use super::curve::Place;
use super::gauss::{LogSum, above_zero, log_normal};
use super::prior::{Noise, Prior};
use super::record::{Record, TrendConfig, TrendEntry};
use super::softened::Softened;
use sinew_model::Gaussian;

/// Standard deviation of a session's error in the offset per error of its stiffness, rad: half a
/// millirad per percent. A starting guess.
const STIFFNESS_RAD: f64 = 0.05;
/// Time in which the part of the error that comes with the baseline becomes another, s: ten years. What a baseline taught
/// of friction and stiffness ages; in a year the sessions' error moves by half of it at most. A starting guess.
const AGES_S: f64 = 3.2e8;
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
    /// What sessions since the baseline get wrong together.
    pub baseline: BaselineError,
}

/// What a time takes from the errors of one noise.
struct Forgets {
    /// Of the slow error.
    slow: f64,
    /// Variance that both states of the baseline's error get anew, rad².
    baseline: [f64; 2],
}

/// What a time does to what a filter's states have answered to a jump.
pub(super) struct Passing {
    /// Per curve, rad.
    creep: Vec<f64>,
    /// Per noise.
    slow: Vec<f64>,
    ages: f64,
}

impl Passing {
    pub(super) fn apply(&self, c: &Component, answer: &mut [f64; STATES]) {
        let at = |of: &[f64], k: u32, none: f64| of.get(k as usize).copied().unwrap_or(none);
        answer[LEVEL] += answer[AMPLITUDE] * at(&self.creep, c.curve, 0.0);
        answer[SLOW] *= at(&self.slow, c.noise, 1.0);
        answer[BASELINE] *= self.ages;
        answer[EXCESS] *= self.ages;
    }
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
                covariance[entry(STIFFNESS, STIFFNESS)] = square(STIFFNESS_RAD);
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
            baseline: BaselineError::default(),
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

    /// Time passes: the level creeps on, its pace may leave its curve, the slow error forgets, what the baseline taught
    /// ages.
    pub(super) fn advance(&mut self, prior: &Prior, time_s: f64) {
        let dt = time_s - self.time_s;
        if !(dt > 0.0) {
            return;
        }
        let creep = creep(prior, self.time_s, time_s);
        let folds = folds(prior, self.time_s, time_s);
        let ages = libm::exp(-dt / AGES_S);
        let renewed = 1.0 - ages * ages;
        let noises: Vec<Forgets> = (prior.noises.iter())
            .map(|noise| Forgets {
                slow: libm::exp(-dt / noise.slow_time_s),
                baseline: self.baseline.variances(noise).map(|v| renewed * v),
            })
            .collect();
        for c in &mut self.components {
            let (Some(step), Some(curve), Some(noise), Some(forgets)) = (
                creep.get(c.curve as usize),
                prior.curves.get(c.curve as usize),
                prior.noises.get(c.noise as usize),
                noises.get(c.noise as usize),
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
            c.scale(SLOW, forgets.slow);
            let stationary = noise.slow_deviation_rad * noise.slow_deviation_rad;
            c.open(SLOW, (1.0 - forgets.slow * forgets.slow) * stationary);
            for (state, variance) in [BASELINE, EXCESS].into_iter().zip(forgets.baseline) {
                if variance > 0.0 {
                    c.scale(state, ages);
                    c.open(state, variance);
                }
            }
        }
        self.time_s = time_s;
    }

    /// What time up to `time_s` does to the filters' answers to a jump.
    pub(super) fn passing(&self, prior: &Prior, time_s: f64) -> Passing {
        let dt = (time_s - self.time_s).max(0.0);
        Passing {
            creep: creep(prior, self.time_s, time_s.max(self.time_s)),
            slow: (prior.noises.iter())
                .map(|noise| libm::exp(-dt / noise.slow_time_s))
                .collect(),
            ages: libm::exp(-dt / AGES_S),
        }
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
        let Some((h, shares)) = self.sees(prior, record) else {
            return;
        };
        for ((c, answer), sum) in self.components.iter_mut().zip(answers).zip(sums) {
            let expected = c.expect(&h);
            let variance = expected.variance;
            let d: f64 = h.iter().zip(answer.iter()).map(|(a, b)| a * b).sum();
            // Where a jump as known so far leaves the record.
            let left = offset - expected.mean - d * sum[1] / sum[0];
            let mut own = own_variance(prior, record, &shares, c);
            let off = config.off_deviation_rad * config.off_deviation_rad;
            let wide = own + off;
            let free = variance + d * d / sum[0];
            let odds = log_normal(left, off) - log_normal(left, free + own);
            if odds + libm::log(config.off_share) > libm::log(1.0 - config.off_share) {
                own = wide;
            }
            let (s, error) = (variance + own, offset - expected.mean);
            sum[0] += d * d / s;
            sum[1] += d * error / s;
            c.correct(&expected, error, s);
            c.log_weight += log_normal(error, s);
            for i in 0..STATES {
                answer[i] -= expected.with_states[i] / s * d;
            }
        }
        self.take_stiffness(record);
    }

    /// What a record with an offset sees of each state, and of the error that others share.
    fn sees(&mut self, prior: &Prior, record: &Record) -> Option<([f64; STATES], Shares)> {
        let part = SharedPart::of(prior, record)?;
        let shares = self.baseline.meet(part, prior, &mut self.components);
        let reference_c = record.reference_c.unwrap_or(prior.temperature_ref_c);
        let warm = record.temperature_c.map_or(0.0, |t| t - reference_c);
        let off = self.softened.map_or(0.0, |s| s.off(record));
        let [better, poorer] = shares.h;
        Some(([1.0, 1.0, 0.0, warm, 1.0, off, better, poorer], shares))
    }

    /// What every filter expects of a record with an offset, and what a record sees of each state.
    pub(super) fn predict(
        &mut self,
        prior: &Prior,
        record: &Record,
    ) -> Option<([f64; STATES], Vec<Prediction>)> {
        let (h, shares) = self.sees(prior, record)?;
        let offset = record.offset_rad?.mean;
        let of = |c: &Component| {
            let expected = c.expect(&h);
            let s = expected.variance + own_variance(prior, record, &shares, c);
            Prediction {
                expected,
                s,
                log_density: log_normal(offset - expected.mean, s),
            }
        };
        Some((h, self.components.iter().map(of).collect()))
    }

    pub(super) fn take_stiffness(&mut self, record: &Record) {
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
        self.baseline.jumped();
    }

    /// Opens the level (or what was taken out) to a change of `deviation_rad`.
    pub(super) fn open(&mut self, state: usize, deviation_rad: f64) {
        for c in &mut self.components {
            c.open(state, deviation_rad * deviation_rad);
        }
    }

    /// A new baseline: the offset since then is 0, up to `deviation_rad`, and what its sessions will get wrong together
    /// is another.
    pub(super) fn rebase(&mut self, deviation_rad: f64) {
        for c in &mut self.components {
            c.make(TAKEN_OUT, -1.0, LEVEL);
            c.open(TAKEN_OUT, deviation_rad * deviation_rad);
            for state in [BASELINE, EXCESS] {
                c.scale(state, 0.0);
            }
        }
        self.baseline = BaselineError::default();
    }

    /// After a failed strand sessions may scatter as they didn't before: each filter also with the
    /// other levels of the records' own errors.
    ///
    /// Filters of one curve and one noise that come together are merged, as interacting multiple models are: so there are
    /// never more than curves times noises, however often a tendon jumps. Those that were there keep their places.
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
        let noises = prior.noises.len();
        let place = |c: &Component| c.curve as usize * noises + c.noise as usize;
        let mut places: Vec<Option<usize>> = vec![None; prior.curves.len() * noises];
        for (at, c) in self.components.iter().enumerate() {
            if let Some(free) = places.get_mut(place(c)) {
                *free = Some(at);
            }
        }
        for c in more {
            let Some(taken) = places.get_mut(place(&c)) else {
                continue;
            };
            match taken.and_then(|at| self.components.get_mut(at)) {
                Some(own) => own.merge(&c),
                None => {
                    *taken = Some(self.components.len());
                    self.components.push(c);
                }
            }
        }
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
        let Some((_, expected)) = self.predict(prior, record) else {
            return none;
        };
        let offset = record.offset_rad.map_or(f64::NAN, |offset| offset.mean);
        let mut all = LogSum::new();
        let mut plain = LogSum::new();
        for (c, p) in self.components.iter().zip(&expected) {
            all.add(c.log_weight);
            plain.add(c.log_weight + p.log_density);
        }
        let all = all.value();
        let plain_e = plain.value() - all + libm::log(1.0 - config.off_share);
        // A record that is off by itself says nothing of the tendon: what it is off by counts from the mean of all filters,
        // whatever else may have happened. So it is at most this likely.
        let off = config.off_deviation_rad;
        let share = libm::log(config.off_share);
        let mut wide_e = f64::NEG_INFINITY;
        if !(plain_e > log_normal(0.0, off * off) + share) {
            let mean: f64 = (self.components.iter().zip(&expected))
                .map(|(c, p)| libm::exp(c.log_weight - all) * p.expected.mean)
                .sum();
            wide_e = log_normal(offset - mean, off * off) + share;
        }
        let is_off = wide_e > plain_e;
        for (c, p) in self.components.iter_mut().zip(&expected) {
            let error = offset - p.expected.mean;
            if is_off {
                // How far off it is must not choose filters.
                const FAR: f64 = 3.0;
                let (error, s) = (error.clamp(-FAR * off, FAR * off), p.s + off * off);
                c.log_weight += log_normal(error, s);
                c.correct(&p.expected, error, s);
            } else {
                c.log_weight += p.log_density;
                c.correct(&p.expected, error, p.s);
            }
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
            self.advance(prior, entry.time_s());
            let mut is_off = false;
            match entry {
                TrendEntry::Record(record) => {
                    let updated = self.update(prior, record, config);
                    log_evidence += updated.log_evidence;
                    is_off = updated.off;
                }
                other => self.undergo(prior, config, other),
            }
            off.push(is_off);
        }
        (log_evidence, off)
    }

    /// What happened between sessions, at the filters' time.
    pub(super) fn undergo(&mut self, prior: &Prior, config: &TrendConfig, entry: &TrendEntry) {
        match entry {
            TrendEntry::Record(_) => {}
            TrendEntry::Jump { deviation_rad, .. } => {
                self.open(LEVEL, *deviation_rad);
                self.reconsider_errors(prior);
                self.jumped();
            }
            TrendEntry::Tensioned { .. } => self.open(TAKEN_OUT, config.fall_deviation_rad),
            TrendEntry::Baseline { deviation_rad, .. } => self.rebase(*deviation_rad),
        }
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
            baseline: self.baseline,
        }
    }
}

/// Creep between two times for an amplitude of 1, per curve, rad.
pub(super) fn creep(prior: &Prior, from_s: f64, to_s: f64) -> Vec<f64> {
    let [from, to] = [from_s, to_s].map(Place::of);
    (prior.curves.iter())
        .map(|c| c.between(to) - c.between(from))
        .collect()
}

/// E-folds of time since tensioning between two times.
pub(super) fn folds(prior: &Prior, from_s: f64, to_s: f64) -> f64 {
    // The clock begins with the baseline, which a logarithm needs to be above 0.
    let start = prior.baseline_s.max(60.0);
    libm::log(to_s.max(start) / from_s.max(start)).max(0.0)
}

/// What a filter expects of a record, and how likely it found it.
pub(super) struct Prediction {
    pub(super) expected: Expected,
    /// Variance of the record in all, rad².
    pub(super) s: f64,
    /// Logarithm of the density of what was recorded.
    pub(super) log_density: f64,
}

/// Variance of a record's own error as a filter sees it, rad².
fn own_variance(prior: &Prior, record: &Record, shares: &Shares, c: &Component) -> f64 {
    let Some(noise) = prior.noises.get(c.noise as usize) else {
        return 0.0;
    };
    let own = noise.white_scale * record.own_deviation_rad(prior.temperature_deviation_rad_per_k);
    own * own + shares.beyond(noise)
}
