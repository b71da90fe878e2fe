//! One tendon's trend: records in, posterior and events out.

use super::bank::{Bank, Component, LEVEL, LogSum, OffRecords, TAKEN_OUT};
use super::prior::Prior;
use alloc::vec;
use alloc::vec::Vec;

/// Seconds of a day.
const DAY_S: f64 = 86_400.0;
/// Filters that jumps are judged with.
const JUDGES: usize = 160;

/// What one session said.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Record {
    /// When, s since tensioning.
    pub time_s: f64,
    /// Offset since the baseline and its own standard deviation, rad; `None`: it couldn't tell.
    pub offset_rad: Option<[f64; 2]>,
    /// Temperature, °C; `None`: not known.
    pub temperature_c: Option<f64>,
}

/// What happened, in the order of time.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Entry {
    /// A session.
    Record(Record),
    /// The level jumped; it is open by `deviation_rad`.
    Jump {
        /// When at the latest, s.
        time_s: f64,
        /// Standard deviation the level is opened by, rad.
        deviation_rad: f64,
    },
    /// The tendon was tensioned again.
    Tensioned {
        /// When, s.
        time_s: f64,
    },
}

/// A sudden change that was confirmed, or a re-tensioning that was stated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Event {
    /// Time of the first record after it (or the stated time), s.
    pub time_s: f64,
    /// Time of the last record before it, s.
    pub after_s: f64,
    /// By how much the offset changed, rad; NaN for a stated re-tensioning.
    pub size_rad: f64,
    /// Its standard deviation, rad.
    pub deviation_rad: f64,
    /// Time of the record that confirmed it, s.
    pub confirmed_s: f64,
    /// Posterior probability when it was confirmed; 1 for a stated one.
    pub probability: f64,
    /// Whether it is a re-tensioning.
    pub tensioned: bool,
}

/// What adding a record showed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Added {
    /// Probability that the level jumped within the last records and isn't confirmed yet.
    pub jump_probability: f64,
    /// Where that is above one half: time of the first record after the suspected jump, s.
    pub suspected_s: Option<f64>,
    /// Whether this record, for now, looks off by itself.
    pub off: bool,
    /// A change that this record confirmed.
    pub confirmed: Option<Event>,
}

/// Rates and sizes the detector reckons with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrendConfig {
    /// Sessions within which jumps are looked for.
    pub window: usize,
    /// Jumps per day.
    pub jumps_per_day: f64,
    /// Large falls and rises (re-tensioning, slipping) per day.
    pub falls_per_day: f64,
    /// Standard deviation of a jump, rad.
    pub jump_deviation_rad: f64,
    /// Standard deviation of a large one, rad.
    pub fall_deviation_rad: f64,
    /// Share of records that are off by themselves.
    pub off_share: f64,
    /// By how much they are, rad.
    pub off_deviation_rad: f64,
    /// Probability from which a jump is confirmed.
    pub confirm: f64,
}

impl Default for TrendConfig {
    fn default() -> Self {
        Self {
            window: 7,
            jumps_per_day: 1e-3,
            falls_per_day: 2e-4,
            jump_deviation_rad: 4e-3,
            fall_deviation_rad: 30e-3,
            off_share: 3e-3,
            off_deviation_rad: 6e-3,
            confirm: 0.98,
        }
    }
}

/// Why a record or a state was refused.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TrendError {
    /// NaN, infinite, or a deviation that isn't above 0.
    #[error(
        "a record's time, offset, deviation and temperature must be finite numbers, the deviation above 0"
    )]
    NotFinite,
    /// Earlier than the last.
    #[error(
        "a record at {time_s} s comes after one at {last_s} s; records come in the order of time"
    )]
    OutOfOrder {
        /// Time of the record, s.
        time_s: f64,
        /// Time of the last, s.
        last_s: f64,
    },
    /// The prior is none.
    #[error("the prior of a trend needs curves and noises of finite, positive numbers")]
    Prior,
    /// The state belongs to another prior or is damaged.
    #[error("the stored trend belongs to another rope, routing or program, or is damaged")]
    State,
}

/// What a trend remembers: the filters before the last records, and those.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// [`Prior::fingerprint`].
    pub fingerprint: u64,
    /// Time of the filters, s.
    pub time_s: f64,
    /// The filters.
    pub components: Vec<Component>,
    /// Last entries.
    pub entries: Vec<Entry>,
    /// Events so far.
    pub events: Vec<Event>,
    /// Records with an offset so far.
    pub records: u64,
}

/// The trend of one tendon.
#[derive(Debug, Clone, PartialEq)]
pub struct Trend {
    prior: Prior,
    config: TrendConfig,
    /// Before the window.
    anchor: Bank,
    entries: Vec<Entry>,
    /// After the last entry.
    pub(super) current: Bank,
    events: Vec<Event>,
    records: u64,
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
        {
            return Err(TrendError::State);
        }
        out.anchor = Bank {
            time_s: state.time_s,
            components: state.components,
        };
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
            && record
                .offset_rad
                .is_none_or(|[y, s]| y.is_finite() && s.is_finite() && s > 0.0);
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

    fn off(&self) -> OffRecords {
        OffRecords {
            share: self.config.off_share,
            deviation_rad: self.config.off_deviation_rad,
        }
    }

    /// Runs filters through entries; logarithm of the evidence, and which records were taken as off.
    fn run(&self, bank: &mut Bank, entries: &[Entry]) -> (f64, Vec<bool>) {
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

    /// Holds jumps within the window against none, and confirms one that is sure.
    fn judge(&mut self, now_s: f64, added: &mut Added) {
        let start = self.anchor.thinned(JUDGES);
        let (none, _) = self.run(&mut start.clone(), &self.entries);
        let mut all = LogSum::new();
        all.add(0.0);
        let mut jumps = LogSum::new();
        let mut best: Option<(f64, usize, f64, bool)> = None;
        // Filters before each entry, so that a hypothesis begins where it differs.
        let mut before = start;
        let mut so_far = 0.0;
        let inside = self.entries.iter().filter(|e| informative(e)).count() as u64;
        let mut earlier = self.records - inside.min(self.records);
        let mut last_s = before.time_s;
        for i in 0..self.entries.len() {
            let entry = self.entries[i];
            if let (Entry::Record(record), true) = (entry, informative(&entry)) {
                let follows_event = i > 0 && !matches!(self.entries[i - 1], Entry::Record(_));
                // Two records before say what the level was.
                if earlier >= 2 && !follows_event {
                    let days = ((record.time_s - last_s) / DAY_S).clamp(0.1, 30.0);
                    for (rate, deviation) in [
                        (self.config.jumps_per_day, self.config.jump_deviation_rad),
                        (self.config.falls_per_day, self.config.fall_deviation_rad),
                    ] {
                        let mut bank = before.clone();
                        bank.advance(&self.prior, record.time_s);
                        bank.open(LEVEL, deviation);
                        let (evidence, off) = self.run(&mut bank, &self.entries[i..]);
                        let odds = so_far + evidence - none + libm::log(rate * days);
                        all.add(odds);
                        jumps.add(odds);
                        let agree = self.entries[i..]
                            .iter()
                            .zip(&off)
                            .filter(|(e, off)| informative(e) && !**off)
                            .count();
                        if best.is_none_or(|b| odds > b.0) {
                            best = Some((odds, i, deviation, agree >= 2));
                        }
                    }
                }
                earlier += 1;
                last_s = record.time_s;
            }
            so_far += self.run(&mut before, core::slice::from_ref(&entry)).0;
        }
        let probability = libm::exp(jumps.value() - all.value());
        added.jump_probability = if probability.is_finite() {
            probability
        } else {
            0.0
        };
        let Some((_, at, deviation_rad, agreed)) = best else {
            return;
        };
        if !(added.jump_probability > 0.5) {
            return;
        }
        let Entry::Record(first) = self.entries[at] else {
            return;
        };
        added.suspected_s = Some(first.time_s);
        if agreed && added.jump_probability > self.config.confirm {
            added.confirmed = Some(self.confirm(at, deviation_rad, now_s, added.jump_probability));
            added.suspected_s = None;
            added.jump_probability = 0.0;
        }
    }

    /// Writes a jump before entry `at` down and opens the level there.
    fn confirm(&mut self, at: usize, deviation_rad: f64, now_s: f64, probability: f64) -> Event {
        let (head, tail) = self.entries.split_at(at);
        let time_s = tail.first().map_or(now_s, time_of);
        let mut bank = self.anchor.clone();
        self.run(&mut bank, head);
        let after_s = head
            .iter()
            .rev()
            .find(|e| informative(e))
            .map_or(self.anchor.time_s, time_of);
        let offset_before = bank.offset(&self.prior, after_s);
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
        event
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
                },
            );
            self.run(&mut bank, &[first]);
            self.anchor = bank;
        }
    }
}

pub(super) fn informative(entry: &Entry) -> bool {
    matches!(
        entry,
        Entry::Record(Record {
            offset_rad: Some(_),
            ..
        })
    )
}

fn time_of(entry: &Entry) -> f64 {
    match entry {
        Entry::Record(r) => r.time_s,
        Entry::Jump { time_s, .. } | Entry::Tensioned { time_s } => *time_s,
    }
}
