//! One tendon's trend: records in, posterior and events out.

use super::bank::{Bank, Component, LEVEL, OffRecords, TAKEN_OUT};
use super::prior::Prior;
use super::record::{Added, Entry, Event, Record, State, TrendConfig, TrendError};
use super::stiffness::Stiffness;
use alloc::vec;
use alloc::vec::Vec;

/// The trend of one tendon.
#[derive(Debug, Clone, PartialEq)]
pub struct Trend {
    pub(super) prior: Prior,
    pub(super) config: TrendConfig,
    /// Before the window.
    pub(super) anchor: Bank,
    /// The same of the stiffness.
    pub(super) stiffness: Stiffness,
    pub(super) entries: Vec<Entry>,
    /// After the last entry.
    pub(super) current: Bank,
    pub(super) events: Vec<Event>,
    pub(super) records: u64,
}

impl Trend {
    /// A trend before its first record.
    ///
    /// # Errors
    /// [`TrendError::Prior`].
    pub fn new(prior: Prior, config: TrendConfig) -> Result<Self, TrendError> {
        if !prior.is_possible() {
            return Err(TrendError::Prior);
        }
        let anchor = Bank::new(&prior);
        Ok(Self {
            current: anchor.clone(),
            prior,
            config,
            anchor,
            stiffness: Stiffness::new(),
            entries: Vec::new(),
            events: Vec::new(),
            records: 0,
        })
    }

    /// Goes on from a state, bit for bit.
    ///
    /// # Errors
    /// [`TrendError::State`] when it belongs to another prior or can't be.
    pub fn resume(prior: Prior, config: TrendConfig, state: State) -> Result<Self, TrendError> {
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
            || !state.components.iter().all(possible)
            || !state.stiffness.is_possible()
            || state.softened.is_some_and(|s| !s.is_possible())
        {
            return Err(TrendError::State);
        }
        out.anchor = Bank {
            time_s: state.time_s,
            components: state.components,
            softened: state.softened,
        };
        out.stiffness = state.stiffness;
        out.entries = state.entries;
        out.events = state.events;
        out.records = state.records;
        out.current = out.anchor.clone();
        let mut bank = out.anchor.clone();
        out.run(&mut bank, &out.entries);
        out.current = bank;
        Ok(out)
    }

    /// What to store to go on later.
    #[must_use]
    pub fn state(&self) -> State {
        State {
            fingerprint: self.prior.fingerprint(),
            time_s: self.anchor.time_s,
            components: self.anchor.components.clone(),
            softened: self.anchor.softened,
            stiffness: self.stiffness,
            entries: self.entries.clone(),
            events: self.events.clone(),
            records: self.records,
        }
    }

    /// What was known before the first record.
    #[must_use]
    pub fn prior(&self) -> &Prior {
        &self.prior
    }

    /// Changes confirmed and stated so far.
    #[must_use]
    pub fn events(&self) -> &[Event] {
        &self.events
    }

    /// Records with an offset so far.
    #[must_use]
    pub fn records(&self) -> u64 {
        self.records
    }

    /// Time of the last entry, s since tensioning; of the baseline before the first.
    #[must_use]
    pub fn time_s(&self) -> f64 {
        self.current.time_s
    }

    /// The filters after the last entry, for who wants to look inside.
    #[must_use]
    pub fn components(&self) -> &[Component] {
        &self.current.components
    }

    /// Takes a session in.
    ///
    /// # Errors
    /// [`TrendError::NotFinite`], [`TrendError::OutOfOrder`]; the trend is unchanged.
    pub fn add(&mut self, record: Record) -> Result<Added, TrendError> {
        let finite = record.time_s.is_finite()
            && record.temperature_c.is_none_or(f64::is_finite)
            && [record.offset_rad, record.stiffness]
                .iter()
                .all(|p| p.is_none_or(|[y, s]| y.is_finite() && s.is_finite() && s > 0.0));
        if !finite {
            return Err(TrendError::NotFinite);
        }
        self.in_order(record.time_s)?;
        let mut added = Added {
            jump_probability: 0.0,
            suspected_s: None,
            off: false,
            confirmed: None,
        };
        self.entries.push(Entry::Record(record));
        self.current.advance(&self.prior, record.time_s);
        added.off = self.current.update(&self.prior, &record, self.off()).off;
        if record.offset_rad.is_some() {
            self.records += 1;
            self.judge(record.time_s, &mut added);
        }
        self.roll();
        Ok(added)
    }

    /// States that the tendon was tensioned again. What the rope remembers stays: the creep goes on
    /// along its curve, what was taken out is open.
    ///
    /// # Errors
    /// [`TrendError::OutOfOrder`], [`TrendError::NotFinite`]; the trend is unchanged.
    pub fn tensioned(&mut self, time_s: f64) -> Result<(), TrendError> {
        if !time_s.is_finite() {
            return Err(TrendError::NotFinite);
        }
        self.in_order(time_s)?;
        let entry = Entry::Tensioned { time_s };
        self.entries.push(entry);
        let after_s = self.current.time_s;
        let mut bank = core::mem::replace(
            &mut self.current,
            Bank {
                time_s,
                components: vec![],
                softened: None,
            },
        );
        self.run(&mut bank, &[entry]);
        self.current = bank;
        self.events.push(Event {
            time_s,
            after_s,
            size_rad: f64::NAN,
            deviation_rad: f64::NAN,
            confirmed_s: time_s,
            probability: 1.0,
            tensioned: true,
        });
        Ok(())
    }

    fn in_order(&self, time_s: f64) -> Result<(), TrendError> {
        if time_s < self.current.time_s {
            return Err(TrendError::OutOfOrder {
                time_s,
                last_s: self.current.time_s,
            });
        }
        Ok(())
    }

    pub(super) fn off(&self) -> OffRecords {
        OffRecords {
            share: self.config.off_share,
            deviation_rad: self.config.off_deviation_rad,
        }
    }

    /// Runs filters through entries; logarithm of the evidence, and which records were taken as off.
    pub(super) fn run(&self, bank: &mut Bank, entries: &[Entry]) -> (f64, Vec<bool>) {
        let mut log_evidence = 0.0;
        let mut off = Vec::with_capacity(entries.len());
        for entry in entries {
            let mut is_off = false;
            match entry {
                Entry::Record(record) => {
                    bank.advance(&self.prior, record.time_s);
                    let updated = bank.update(&self.prior, record, self.off());
                    log_evidence += updated.log_evidence;
                    is_off = updated.off;
                }
                Entry::Jump {
                    time_s,
                    deviation_rad,
                } => {
                    bank.advance(&self.prior, *time_s);
                    bank.open(LEVEL, *deviation_rad);
                    bank.reconsider_errors(&self.prior);
                    bank.jumped();
                }
                Entry::Tensioned { time_s } => {
                    bank.advance(&self.prior, *time_s);
                    bank.open(TAKEN_OUT, self.config.fall_deviation_rad);
                }
            }
            off.push(is_off);
        }
        (log_evidence, off)
    }

    /// Lets the oldest entries go into the filters.
    fn roll(&mut self) {
        let window = self.config.window.max(1);
        let sessions = |e: &&Entry| matches!(e, Entry::Record(_));
        while self.entries.iter().filter(sessions).count() > window {
            let first = self.entries.remove(0);
            let mut bank = core::mem::replace(
                &mut self.anchor,
                Bank {
                    time_s: 0.0,
                    components: vec![],
                    softened: None,
                },
            );
            self.run(&mut bank, &[first]);
            self.anchor = bank;
            self.stiffness.take(&first, self.prior.temperature_ref_c);
        }
    }
}
