//! Bank of parallel Kalman filters, one per pair of curve and noise.

use super::baseline_error::{BaselineError, SharedPart};
use super::component::{
    AMPLITUDE, BASELINE, Component, DRIFT, EXCESS, Expected, LEVEL, LIVE_AT_START, LIVE_TENSIONED,
    RETENSIONED, SLOW, STATES, STIFFNESS, TAKEN_OUT, TRIANGLE, entry,
};
use super::curve::{FIRST_S, Place};
use super::gauss::{above_zero, log_normal};
use super::prior::{Noise, Prior};
use super::record::{Record, TrendConfig, TrendEntry};
use super::stiffness_loss::StiffnessLossStats;
use sinew_files::interrupt;
use sinew_model::Gaussian;

/// Standard deviation of a session's offset error per unit of its stiffness error, rad: 0.5 mrad
/// per percent. Assumed value.
const STIFFNESS_RAD: f64 = 0.05;
/// Correlation time of the error that comes with the baseline, s: ten years. The friction and
/// stiffness of a baseline become outdated; within a year the error of the sessions changes by at
/// most half of it. Assumed value.
const BASELINE_CORRELATION_S: f64 = 3.2e8;
/// Maximum log-weight difference to the most probable filter, e^-18 = 1.5e-8; filters below are
/// dropped.
const MAX_LOG_WEIGHT_DIFFERENCE: f64 = 18.0;

/// State of all filters at one time.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Bank {
    /// Time since tensioning, s.
    pub time_s: f64,
    pub components: Vec<Component>,
    /// Logarithm of the sum of the weights ([`log_total`]).
    pub log_total: f64,
    /// Statistics of the stiffness since the last step change.
    pub stiffness_loss: Option<StiffnessLossStats>,
    /// Common error of all sessions since the baseline.
    pub baseline: BaselineError,
    /// Time of the last re-tensioning, s since the first tensioning.
    pub retensioned_s: Option<f64>,
}

/// Share of the pretension that a tendon has lost before it is re-tensioned: uniform from 0 to 1,
/// as no session measures it.
pub(super) const LOST_SHARE: Gaussian = Gaussian {
    mean: 0.5,
    std: 0.288_675_134_594_812_9,
};

/// Decay of the errors of one noise over a time step.
struct Forgets {
    /// Factor on the slow error.
    slow: f64,
    /// Variance added to both states of the baseline error, rad².
    baseline: [f64; 2],
}

/// Transition of a filter's response to a step change over a time step.
pub(super) struct Passing {
    /// Creep per curve for an amplitude of 1, rad.
    creep: Vec<f64>,
    /// Additional creep since the last re-tensioning, in the same way.
    added: Vec<f64>,
    /// Factor on the slow error, per noise.
    slow: Vec<f64>,
    ages: f64,
}

impl Passing {
    pub(super) fn apply(&self, c: &Component, answer: &mut [f64; STATES]) {
        let at = |of: &[f64], k: u32, none: f64| of.get(k as usize).copied().unwrap_or(none);
        answer[LEVEL] += answer[AMPLITUDE] * at(&self.creep, c.curve, 0.0);
        answer[LEVEL] += answer[RETENSIONED] * at(&self.added, c.curve, 0.0);
        answer[SLOW] *= at(&self.slow, c.noise, 1.0);
        answer[BASELINE] *= self.ages;
        answer[EXCESS] *= self.ages;
    }
}

/// Result of an update: evidence of the record and whether it was treated as an outlier.
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
                covariance[entry(LEVEL, LEVEL)] = square(prior.level_std_rad);
                covariance[entry(AMPLITUDE, AMPLITUDE)] = square(curve.amplitude_std);
                covariance[entry(DRIFT, DRIFT)] = square(prior.temperature_std_rad_per_k);
                covariance[entry(SLOW, SLOW)] = square(noise.slow_std_rad);
                covariance[entry(STIFFNESS, STIFFNESS)] = square(STIFFNESS_RAD);
                components.push(Component {
                    curve: i as u32,
                    noise: k as u32,
                    // The prior of the amplitude is truncated at 0: the remaining probability is
                    // normalised.
                    log_weight: curve.log_weight + noise.log_weight
                        - libm::log(above_zero(curve.amplitude, curve.amplitude_std)),
                    mean,
                    covariance,
                });
            }
        }
        Self {
            time_s: prior.baseline_s,
            log_total: log_total(&components),
            components,
            stiffness_loss: None,
            baseline: BaselineError::default(),
            retensioned_s: None,
        }
    }

    /// Number of live states: the others are zero, or neither observed nor correlated.
    pub(super) fn live(&self) -> usize {
        let is_tensioned = self.retensioned_s.is_some()
            || (self.components.first()).is_some_and(|c| {
                c.mean[TAKEN_OUT] != 0.0 || c.covariance[entry(TAKEN_OUT, TAKEN_OUT)] > 0.0
            });
        match (self.stiffness_loss, self.baseline.levels[1]) {
            (None, None) if is_tensioned => LIVE_TENSIONED,
            (None, None) => LIVE_AT_START,
            _ => STATES,
        }
    }

    /// Mean of the true offset at the reference temperature, rad.
    pub(super) fn offset(&self) -> f64 {
        self.components
            .iter()
            .map(|c| libm::exp(c.log_weight - self.log_total) * (c.mean[LEVEL] + c.mean[TAKEN_OUT]))
            .sum()
    }

    /// Advances the filters in time: the level creeps, the creep rate may deviate from its curve,
    /// the slow error decays, the baseline error ages. After a re-tensioning the additional creep
    /// deviates from its curve in the same way, per e-fold of the time since then.
    pub(super) fn advance(&mut self, prior: &Prior, time_s: f64) {
        let dt = time_s - self.time_s;
        if !(dt > 0.0) {
            return;
        }
        let creep = creep(prior, self.time_s, time_s);
        let folds = folds(prior, self.time_s, time_s);
        let added = self.added(prior, time_s);
        let added_folds = added_folds(self.retensioned_s, self.time_s, time_s);
        let ages = libm::exp(-dt / BASELINE_CORRELATION_S);
        let renewed = 1.0 - ages * ages;
        let live = self.live();
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
            c.shear(AMPLITUDE, *step, live);
            // The amplitude walks relative to its own size; one near 0 can still rise.
            let size = c.mean[AMPLITUDE].max(0.1 * (curve.amplitude + curve.amplitude_std));
            let walk = noise.creep_rate_rel_error * size;
            c.walk(AMPLITUDE, walk * walk * folds, *step);
            // Creep comes in steps: a day of hard work contributes more than ten others.
            c.open(LEVEL, prior.step_rad * (c.mean[AMPLITUDE] * step).max(0.0));
            if let Some(step) = added.get(c.curve as usize) {
                c.shear(RETENSIONED, *step, live);
                let size = c.mean[RETENSIONED].max(0.1 * size);
                let walk = noise.creep_rate_rel_error * size;
                c.walk(RETENSIONED, walk * walk * added_folds, *step);
                c.open(
                    LEVEL,
                    prior.step_rad * (c.mean[RETENSIONED] * step).max(0.0),
                );
            }
            c.scale(SLOW, forgets.slow);
            let stationary = noise.slow_std_rad * noise.slow_std_rad;
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

    /// Additional creep since the last re-tensioning from the time of the filters to `time_s` for an
    /// amplitude of 1, per curve, rad; empty without a re-tensioning.
    fn added(&self, prior: &Prior, time_s: f64) -> Vec<f64> {
        added(prior, self.retensioned_s, self.time_s, time_s)
    }

    /// Registers a re-tensioning: the removed offset is unknown, up to `removed_std_rad`, and the
    /// tension rises again by the share that it has lost.
    ///
    /// By superposition that rise adds its own creep from here on: of the curve since tensioning for
    /// a linear viscoelastic rope, else of its law (`retensioned` of a curve). The share is unknown
    /// ([`LOST_SHARE`]).
    fn retensioned(&mut self, removed_std_rad: f64) {
        self.open(TAKEN_OUT, removed_std_rad);
        for c in &mut self.components {
            c.make_random(RETENSIONED, LOST_SHARE, AMPLITUDE);
        }
        self.retensioned_s = Some(self.time_s);
    }

    /// Transition of the filters' responses to a step change up to `time_s`.
    pub(super) fn passing(&self, prior: &Prior, time_s: f64) -> Passing {
        let dt = (time_s - self.time_s).max(0.0);
        Passing {
            creep: creep(prior, self.time_s, time_s.max(self.time_s)),
            added: self.added(prior, time_s.max(self.time_s)),
            slow: (prior.noises.iter())
                .map(|noise| libm::exp(-dt / noise.slow_time_s))
                .collect(),
            ages: libm::exp(-dt / BASELINE_CORRELATION_S),
        }
    }

    /// Updates all filters with a record without dropping any, and adds its information about a
    /// step change, to which the states respond by `answers`, to `sums`: to the precision and to
    /// the precision times the mean. A record that remains an outlier contributes little.
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
        let Some((h, own)) = self.sees(prior, record) else {
            return;
        };
        let live = self.live();
        for ((c, answer), sum) in self.components.iter_mut().zip(answers).zip(sums) {
            let expected = c.expect(&h, live);
            let variance = expected.variance;
            let d: f64 = h.iter().zip(answer.iter()).map(|(a, b)| a * b).sum();
            // Residual of the record after the present estimate of the step change.
            let left = offset - expected.mean - d * sum[1] / sum[0];
            let mut own = own.get(c.noise as usize).copied().unwrap_or(0.0);
            let off = config.off_std_rad * config.off_std_rad;
            let wide = own + off;
            let free = variance + d * d / sum[0];
            let odds = log_normal(left, off) - log_normal(left, free + own);
            if odds + libm::log(config.off_share) > libm::log(1.0 - config.off_share) {
                own = wide;
            }
            let (s, error) = (variance + own, offset - expected.mean);
            sum[0] += d * d / s;
            sum[1] += d * error / s;
            c.correct(&expected, error, s, live);
            c.log_weight += log_normal(error, s);
            for i in 0..STATES {
                answer[i] -= expected.with_states[i] / s * d;
            }
        }
        self.take_stiffness(record);
    }

    /// Observation vector of a record with an offset, and the variance of its independent error under
    /// each noise, rad².
    fn sees(&mut self, prior: &Prior, record: &Record) -> Option<([f64; STATES], Vec<f64>)> {
        let part = SharedPart::of(prior, record)?;
        let shares = self.baseline.meet(part, prior, &mut self.components);
        let reference_c = record.reference_c.unwrap_or(prior.temperature_ref_c);
        let warm = record.temperature_c.map_or(0.0, |t| t - reference_c);
        let off = self.stiffness_loss.map_or(0.0, |s| s.off(record));
        let [better, poorer] = shares.h;
        let h = [1.0, 0.0, warm, 1.0, better, 1.0, 0.0, poorer, off];
        let reported_rad = record.own_std_rad(prior.temperature_std_rad_per_k);
        let own = |noise: &Noise| {
            let own = noise.white_scale * reported_rad;
            own * own + shares.beyond(noise)
        };
        Some((h, prior.noises.iter().map(own).collect()))
    }

    /// Predictions of all filters for a record with an offset, and the record's observation vector.
    pub(super) fn predict(
        &mut self,
        prior: &Prior,
        record: &Record,
    ) -> Option<([f64; STATES], Vec<Prediction>)> {
        let (h, own) = self.sees(prior, record)?;
        let offset = record.offset_rad?.mean;
        let live = self.live();
        let of = |c: &Component| {
            let expected = c.expect(&h, live);
            let s = expected.variance + own.get(c.noise as usize).copied().unwrap_or(0.0);
            Prediction {
                expected,
                s,
                log_density: log_normal(offset - expected.mean, s),
            }
        };
        Some((h, self.components.iter().map(of).collect()))
    }

    pub(super) fn take_stiffness(&mut self, record: &Record) {
        if let Some(stiffness_loss) = &mut self.stiffness_loss {
            stiffness_loss.take(record);
        }
    }

    /// Resets the stiffness statistics after a possible further step change.
    pub(super) fn forget_stiffness(&mut self) {
        if self.stiffness_loss.is_some() {
            self.jumped();
        }
    }

    /// Registers a step change: a strand may have failed, whose stiffness loss every session
    /// estimates again.
    pub(super) fn jumped(&mut self) {
        self.stiffness_loss = Some(StiffnessLossStats::new());
        self.baseline.jumped();
    }

    /// Inflates the variance of the level (or of the removed offset) by `std_rad` squared.
    pub(super) fn open(&mut self, state: usize, std_rad: f64) {
        for c in &mut self.components {
            c.open(state, std_rad * std_rad);
        }
    }

    /// Registers a new baseline: the offset since then is 0, up to `std_rad`, and the common error
    /// of its sessions is independent of the earlier one.
    pub(super) fn rebase(&mut self, std_rad: f64) {
        for c in &mut self.components {
            c.make(TAKEN_OUT, -1.0, LEVEL);
            c.open(TAKEN_OUT, std_rad * std_rad);
            for state in [BASELINE, EXCESS] {
                c.scale(state, 0.0);
            }
        }
        self.baseline = BaselineError::default();
    }

    /// Adds copies of each filter with the other levels of the independent error, because the
    /// scatter of the sessions may change after a strand failure.
    ///
    /// Filters with the same curve and noise are merged, as in interacting multiple models. So
    /// there are never more filters than curves times noises, however often a tendon slips.
    /// Existing filters keep their index.
    pub(super) fn reconsider_errors(&mut self, prior: &Prior) {
        /// Prior probability of each other level.
        const OTHER_LEVEL_PROBABILITY: f64 = 0.1;
        let same_slow_error = |a: &Noise, b: &Noise| {
            a.slow_std_rad == b.slow_std_rad
                && a.slow_time_s == b.slow_time_s
                && a.creep_rate_rel_error == b.creep_rate_rel_error
        };
        let mut more = Vec::new();
        for c in &self.components {
            let Some(own) = prior.noises.get(c.noise as usize) else {
                continue;
            };
            for (other, noise) in (0u32..).zip(&prior.noises) {
                if other != c.noise && same_slow_error(own, noise) {
                    more.push(Component {
                        noise: other,
                        log_weight: c.log_weight + libm::log(OTHER_LEVEL_PROBABILITY),
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
        self.log_total = log_total(&self.components);
    }

    /// Updates the filters with a record; one without an offset changes nothing.
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
        let after = |(c, p): (&Component, &Prediction)| c.log_weight + p.log_density;
        let weights =
            || (self.components.iter().zip(&expected).map(after)).filter(|w| w.is_finite());
        let most = weights().fold(f64::NEG_INFINITY, f64::max);
        // Sum of the weights with this record, and the part of it that is not dropped.
        let (mut plain, mut kept) = (0.0, 0.0);
        for weight in weights() {
            let share = libm::exp(weight - most);
            plain += share;
            kept += if weight > most - MAX_LOG_WEIGHT_DIFFERENCE {
                share
            } else {
                0.0
            };
        }
        let all = self.log_total;
        let plain_e = most + libm::log(plain) - all + libm::log(1.0 - config.off_share);
        // An outlier carries no information about the tendon: its error is measured from the mean
        // of all filters. Its evidence is therefore bounded by this value.
        let off = config.off_std_rad;
        let share = libm::log(config.off_share);
        let mut wide_e = f64::NEG_INFINITY;
        if !(plain_e > log_normal(0.0, off * off) + share) {
            let mean: f64 = (self.components.iter().zip(&expected))
                .map(|(c, p)| libm::exp(c.log_weight - all) * p.expected.mean)
                .sum();
            wide_e = log_normal(offset - mean, off * off) + share;
        }
        let is_outlier = wide_e > plain_e;
        let live = self.live();
        for (c, p) in self.components.iter_mut().zip(&expected) {
            let error = offset - p.expected.mean;
            if is_outlier {
                // The size of an outlier must not select filters: bound in multiples of the outlier
                // standard deviation.
                const MAX_OUTLIER_STDS: f64 = 3.0;
                let (error, s) = (
                    error.clamp(-MAX_OUTLIER_STDS * off, MAX_OUTLIER_STDS * off),
                    p.s + off * off,
                );
                c.log_weight += log_normal(error, s);
                c.correct(&p.expected, error, s, live);
            } else {
                c.log_weight += p.log_density;
                c.correct(&p.expected, error, p.s, live);
            }
        }
        self.let_go();
        self.log_total = match is_outlier {
            true => log_total(&self.components),
            false => libm::log(kept),
        };
        self.take_stiffness(record);
        Updated {
            log_evidence: plain_e.max(wide_e),
            off: is_outlier,
        }
    }

    /// Runs the filters through entries; returns the log-evidence, and per entry whether it was
    /// treated as an outlier.
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
            let mut is_outlier = false;
            match entry {
                TrendEntry::Record(record) => {
                    let updated = self.update(prior, record, config);
                    log_evidence += updated.log_evidence;
                    is_outlier = updated.off;
                }
                other => self.undergo(prior, config, other),
            }
            off.push(is_outlier);
        }
        (log_evidence, off)
    }

    /// Applies an entry other than a record, at the time of the filters.
    pub(super) fn undergo(&mut self, prior: &Prior, config: &TrendConfig, entry: &TrendEntry) {
        interrupt::check();
        match entry {
            TrendEntry::Record(_) => {}
            TrendEntry::StepChange { std_rad, .. } => {
                self.open(LEVEL, *std_rad);
                self.reconsider_errors(prior);
                self.jumped();
            }
            TrendEntry::Tensioned { .. } => self.retensioned(config.fall_std_rad),
            TrendEntry::Baseline { std_rad, .. } => self.rebase(*std_rad),
        }
    }

    /// Drops negligible filters and normalises the most probable one to weight 0.
    fn let_go(&mut self) {
        let most = self
            .components
            .iter()
            .map(|c| c.log_weight)
            .fold(f64::NEG_INFINITY, f64::max);
        if most.is_finite() {
            self.components
                .retain(|c| c.log_weight > most - MAX_LOG_WEIGHT_DIFFERENCE);
            self.components
                .iter_mut()
                .for_each(|c| c.log_weight -= most);
        }
    }

    /// Reduces the bank to at most `count` filters: systematic draws by weight, equal ones merged.
    pub(super) fn thinned(&self, count: usize) -> Self {
        let mut components = Vec::with_capacity(count);
        let (mut reached, mut drawn) = (0.0, 0usize);
        for c in &self.components {
            reached += libm::exp(c.log_weight - self.log_total);
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
            log_total: log_total(&components),
            components,
            stiffness_loss: self.stiffness_loss,
            baseline: self.baseline,
            retensioned_s: self.retensioned_s,
        }
    }
}

/// Logarithm of the sum of the weights of filters.
pub(super) fn log_total(components: &[Component]) -> f64 {
    let weights = || {
        components
            .iter()
            .map(|c| c.log_weight)
            .filter(|w| w.is_finite())
    };
    let most = weights().fold(f64::NEG_INFINITY, f64::max);
    let sum: f64 = weights().map(|weight| libm::exp(weight - most)).sum();
    most + libm::log(sum)
}

/// Creep between two times for an amplitude of 1, per curve, rad.
pub(super) fn creep(prior: &Prior, from_s: f64, to_s: f64) -> Vec<f64> {
    let [from, to] = [from_s, to_s].map(Place::of);
    (prior.curves.iter())
        .map(|c| c.between(to) - c.between(from))
        .collect()
}

/// Additional creep since a re-tensioning between two times for an amplitude of 1, per curve, rad;
/// empty without a re-tensioning.
pub(super) fn added(prior: &Prior, retensioned_s: Option<f64>, from_s: f64, to_s: f64) -> Vec<f64> {
    let Some(start_s) = retensioned_s else {
        return Vec::new();
    };
    let [from, to] = [from_s, to_s].map(|t| Place::of(t - start_s));
    (prior.curves.iter())
        .map(|c| c.added_between(to) - c.added_between(from))
        .collect()
}

/// Number of e-folds of the time since a re-tensioning between two times; the curves begin with
/// their first node.
pub(super) fn added_folds(retensioned_s: Option<f64>, from_s: f64, to_s: f64) -> f64 {
    retensioned_s.map_or(0.0, |start_s| {
        let [from, to] = [from_s, to_s].map(|t| (t - start_s).max(FIRST_S));
        libm::log(to / from).max(0.0)
    })
}

/// Number of e-folds of the time since tensioning between two times.
pub(super) fn folds(prior: &Prior, from_s: f64, to_s: f64) -> f64 {
    // The clock starts with the baseline; the logarithm needs a value above 0.
    let start = prior.baseline_s.max(60.0);
    libm::log(to_s.max(start) / from_s.max(start)).max(0.0)
}

/// Prediction of a filter for a record, and the density of the recorded value.
pub(super) struct Prediction {
    pub(super) expected: Expected,
    /// Total variance of the record, rad².
    pub(super) s: f64,
    /// Logarithm of the density of the recorded value.
    pub(super) log_density: f64,
}
