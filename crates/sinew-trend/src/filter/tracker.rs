//! Trend of one tendon: records in, posterior and events out.

use super::bank::{Bank, log_total};
use super::component::Component;
use super::detector::{Confirmed, MAX_TEST_FILTERS, Window};
use super::prior::Prior;
use super::record::{Added, Event, Record, TrendConfig, TrendEntry, TrendError};
use super::state::TrendState;
use super::stiffness::Stiffness;
use sinew_model::Gaussian;

/// Trend estimator of one tendon.
#[derive(Debug, Clone, PartialEq)]
pub struct Trend {
    prior: Prior,
    config: TrendConfig,
    /// Filters before the window.
    anchor: Bank,
    /// Stiffness before the window.
    stiffness: Stiffness,
    entries: Vec<TrendEntry>,
    /// Filters after the last entry; unused while they are deferred.
    current: Bank,
    is_deferred: bool,
    events: Vec<Event>,
    records: u64,
}

impl Trend {
    /// Creates a trend before its first record.
    ///
    /// # Errors
    /// Returns [`TrendError::Prior`] if the prior is invalid.
    pub fn new(prior: Prior, config: TrendConfig) -> Result<Self, TrendError> {
        if !prior.is_possible() {
            return Err(TrendError::Prior);
        }
        let anchor = Bank::new(&prior);
        Ok(Self {
            current: anchor.clone(),
            is_deferred: false,
            prior,
            config,
            anchor,
            stiffness: Stiffness::new(),
            entries: Vec::new(),
            events: Vec::new(),
            records: 0,
        })
    }

    /// Resumes from a state, bitwise identically.
    ///
    /// # Errors
    /// Returns [`TrendError::State`] if the state belongs to another prior or is invalid.
    pub fn resume(
        prior: Prior,
        config: TrendConfig,
        state: TrendState,
    ) -> Result<Self, TrendError> {
        let mut out = Self::new(prior, config)?;
        let possible = |c: &Component| {
            (c.curve as usize) < out.prior.curves.len()
                && (c.noise as usize) < out.prior.noises.len()
                && c.log_weight.is_finite()
                && c.mean.iter().chain(&c.covariance).all(|v| v.is_finite())
        };
        if state.fingerprint != out.prior.fingerprint()
            || state.components.is_empty()
            || !state.time_s.is_finite()
            || state.retensioned_s.is_some_and(|t| !t.is_finite())
            || !state.components.iter().all(possible)
            || !state.stiffness.is_possible()
            || !state.baseline.is_possible()
            || state.stiffness_loss.is_some_and(|s| !s.is_possible())
        {
            return Err(TrendError::State);
        }
        out.anchor = Bank {
            time_s: state.time_s,
            log_total: log_total(&state.components),
            components: state.components,
            stiffness_loss: state.stiffness_loss,
            baseline: state.baseline,
            retensioned_s: state.retensioned_s,
        };
        out.stiffness = state.stiffness;
        out.entries = state.entries;
        out.events = state.events;
        out.records = state.records;
        out.replay();
        Ok(out)
    }

    /// State to be stored for resumption.
    #[must_use]
    pub fn state(&self) -> TrendState {
        TrendState {
            fingerprint: self.prior.fingerprint(),
            time_s: self.anchor.time_s,
            components: self.anchor.components.clone(),
            stiffness_loss: self.anchor.stiffness_loss,
            baseline: self.anchor.baseline,
            retensioned_s: self.anchor.retensioned_s,
            stiffness: self.stiffness,
            entries: self.entries.clone(),
            events: self.events.clone(),
            records: self.records,
        }
    }

    /// Prior before the first record.
    #[must_use]
    pub fn prior(&self) -> &Prior {
        &self.prior
    }

    /// Confirmed and specified events so far.
    #[must_use]
    pub fn events(&self) -> &[Event] {
        &self.events
    }

    /// Number of records with an offset so far.
    #[must_use]
    pub fn records(&self) -> u64 {
        self.records
    }

    /// Time of the last re-tensioning, s since tensioning.
    pub(super) fn retensioned_s(&self) -> Option<f64> {
        self.current.retensioned_s
    }

    /// Time of the last entry, s since tensioning; that of the baseline before the first entry.
    #[must_use]
    pub fn time_s(&self) -> f64 {
        (self.entries.last()).map_or(self.anchor.time_s, TrendEntry::time_s)
    }

    /// Filters after the last entry, for inspection.
    #[must_use]
    pub fn components(&self) -> &[Component] {
        &self.current.components
    }

    /// Defers the filters after the last entry, of which the step-change detector makes no use: entries
    /// then take half of the time. Until [`Trend::catch_up`] the present state is not available, and an
    /// added record is not marked as an outlier.
    pub(crate) fn defer(&mut self) {
        self.is_deferred = true;
    }

    /// Computes the deferred filters, bitwise identical to those of entries that were not deferred.
    pub(crate) fn catch_up(&mut self) {
        if std::mem::take(&mut self.is_deferred) {
            self.replay();
        }
    }

    /// Adds the result of a session.
    ///
    /// # Errors
    /// Returns [`TrendError::NotFinite`] or [`TrendError::OutOfOrder`]; the trend is unchanged.
    pub fn add(&mut self, record: Record) -> Result<Added, TrendError> {
        if !record.is_possible() {
            return Err(TrendError::NotFinite);
        }
        self.in_order(record.time_s)?;
        let mut added = Added {
            step_probability: 0.0,
            suspected_s: None,
            off: false,
            confirmed: None,
            withdrawn: None,
        };
        self.entries.push(TrendEntry::Record(record));
        if !self.is_deferred {
            self.current.advance(&self.prior, record.time_s);
            added.off = self.current.update(&self.prior, &record, &self.config).off;
        }
        if record.offset_rad.is_some() {
            self.records += 1;
            added.withdrawn = self.second();
            self.test_for_steps(record.time_s, &mut added);
        }
        self.roll();
        Ok(added)
    }

    /// Registers a specified re-tensioning. The rope keeps its memory: the creep continues along
    /// its curve, and the tension that is restored adds its own. The variance of the removed offset
    /// is inflated.
    ///
    /// # Errors
    /// Returns [`TrendError::OutOfOrder`] or [`TrendError::NotFinite`]; the trend is unchanged.
    pub fn tensioned(&mut self, time_s: f64) -> Result<(), TrendError> {
        if !time_s.is_finite() {
            return Err(TrendError::NotFinite);
        }
        self.in_order(time_s)?;
        self.stated(TrendEntry::Tensioned { time_s });
        Ok(())
    }

    /// Registers a new baseline from `time_s` on: the offset was zero then, with standard deviation
    /// `std_rad` (large if that time is unknown). The rope keeps its memory; the common error of
    /// the sessions is independent from here on. It is an event unless a re-tensioning was
    /// specified since the last session.
    ///
    /// # Errors
    /// Returns [`TrendError::OutOfOrder`] or [`TrendError::NotFinite`]; the trend is unchanged.
    pub fn rebased(&mut self, time_s: f64, std_rad: f64) -> Result<(), TrendError> {
        if !(time_s.is_finite() && std_rad.is_finite() && std_rad >= 0.0) {
            return Err(TrendError::NotFinite);
        }
        self.in_order(time_s)?;
        let just_tensioned = matches!(self.entries.last(), Some(TrendEntry::Tensioned { .. }));
        let entry = TrendEntry::Baseline { time_s, std_rad };
        match just_tensioned {
            true => self.enter(entry),
            false => self.stated(entry),
        }
        Ok(())
    }

    fn enter(&mut self, entry: TrendEntry) {
        self.entries.push(entry);
        if !self.is_deferred {
            self.current.run(&self.prior, &self.config, &[entry]);
        }
    }

    /// Registers a specified entry as an event.
    fn stated(&mut self, entry: TrendEntry) {
        let (time_s, after_s) = (entry.time_s(), self.time_s());
        self.enter(entry);
        self.events.push(Event {
            time_s,
            after_s,
            size_rad: Gaussian::new(f64::NAN, f64::NAN),
            confirmed_s: time_s,
            probability: 1.0,
            sessions: 0,
            tensioned: true,
        });
    }

    fn in_order(&self, time_s: f64) -> Result<(), TrendError> {
        let last_s = self.time_s();
        if time_s < last_s {
            return Err(TrendError::OutOfOrder { time_s, last_s });
        }
        Ok(())
    }

    /// Recomputes the filters after the last entry from those before the window.
    fn replay(&mut self) {
        if self.is_deferred {
            return;
        }
        self.current = self.anchor.clone();
        self.current.run(&self.prior, &self.config, &self.entries);
    }

    /// Tests for step changes within the window, and registers a confirmed one.
    fn test_for_steps(&mut self, now_s: f64, added: &mut Added) {
        let window = Window {
            prior: &self.prior,
            config: &self.config,
            anchor: &self.anchor,
            stiffness: self.stiffness,
            entries: &self.entries,
            records: self.records,
        };
        let (step_probability, best) = window.test_for_steps();
        added.step_probability = step_probability;
        let (Some(best), true) = (best, step_probability > 0.5) else {
            return;
        };
        let agreed = best.is_agreed() && step_probability > self.config.confirm;
        if !(agreed || step_probability >= self.config.confirm_at_once) {
            added.suspected_s = Some(window.time_s(&best));
            return;
        }
        let Confirmed { at, entry, event } = window.confirm(&best, now_s, step_probability);
        added.step_probability = 0.0;
        self.entries.insert(at, entry);
        self.replay();
        if event.size_rad.mean.abs() >= self.config.least_jump_rad {
            self.events.push(event);
            added.confirmed = Some(event);
        }
    }

    /// Re-evaluates a step change that one session supports with the next one: it is confirmed or
    /// withdrawn, depending on which explains both sessions better. Returns the withdrawn event.
    fn second(&mut self) -> Option<Event> {
        let event = self.events.iter().rposition(|e| e.sessions == 1)?;
        let time_s = self.events[event].time_s;
        let is_its = |e: &TrendEntry| match e {
            TrendEntry::StepChange { .. } | TrendEntry::Tensioned { .. } => e.time_s() == time_s,
            _ => false,
        };
        let Some(at) = self.entries.iter().position(is_its) else {
            // It has left the window, so that a session agreed earlier.
            self.events[event].sessions = 2;
            return None;
        };
        let mut without = self.entries.clone();
        without.remove(at);
        let start = self.anchor.thinned(MAX_TEST_FILTERS);
        let evidence =
            |entries: &[TrendEntry]| start.clone().run(&self.prior, &self.config, entries).0;
        let (kept, taken_back) = (evidence(&self.entries), evidence(&without));
        if kept + libm::log(self.config.falls_per_day) >= taken_back {
            self.events[event].sessions = 2;
            return None;
        }
        self.entries = without;
        self.replay();
        Some(self.events.remove(event))
    }

    /// Moves the oldest entries from the window into the filters.
    fn roll(&mut self) {
        let window = self.config.window.max(1);
        let sessions = |e: &&TrendEntry| matches!(e, TrendEntry::Record(_));
        while self.entries.iter().filter(sessions).count() > window {
            let first = self.entries.remove(0);
            self.anchor.run(&self.prior, &self.config, &[first]);
            self.stiffness.take(&first, self.prior.temperature_ref_c);
        }
    }
}
