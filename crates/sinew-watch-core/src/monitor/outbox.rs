//! Outbox: journal, transactions waiting for the store, and stored results that may be published.

use super::config::Stored;
use crate::alarm::{Alarm, AlarmsStored, Transition};
use crate::instant::Instant;
use crate::journal::{Entry, Event};
use crate::record::Record;
use crate::transaction::{MonitorState, Transaction};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Maximum number of journal entries kept until the next tick.
const JOURNAL_CAPACITY: usize = 256;
/// Minimum time between two reports of losses, s.
const LOSS_REPORT_PERIOD_S: f64 = 60.0;
/// Maximum number of waiting journal entries; beyond it, the oldest are discarded.
const MAX_WAITING_ENTRIES: usize = 10_000;
/// Maximum number of waiting records: three months of seven tendons at continuous work; beyond it, the oldest are
/// discarded.
const MAX_WAITING_RECORDS: usize = 100_000;

/// Transactions for the store: at most one is being stored, and one waits that contains all the rest.
///
/// A store that fails for days therefore costs bounded memory. Only the last waiting state and alarms are kept; journal
/// entries are discarded first, the oldest first, records only after months.
#[derive(Debug, Default)]
pub(super) struct Outbox {
    robot: String,
    last_id: u64,
    /// Journal entries and records since the last tick, and whether the state changed.
    journal: Vec<Entry>,
    records: Vec<Record>,
    replaced_from_utc_s: Option<f64>,
    state_changed: bool,
    under_way: Option<Transaction>,
    waiting: Option<Transaction>,
    /// Number of transactions merged in the waiting one.
    parts: usize,
    /// Stored alarms and last stored record per joint.
    pub(super) alarms: Vec<Alarm>,
    pub(super) last: BTreeMap<String, Record>,
    discarded: [u64; 2],
    /// Whether the store rejected the last transaction.
    pub(super) fails: bool,
    /// Dropped messages, and motion that was not estimated, s, since the last report.
    pub(super) dropped: u64,
    pub(super) behind_s: f64,
    losses_reported: Option<Instant>,
}

impl Outbox {
    pub(super) fn new(robot: &str, stored: &mut Stored) -> Self {
        Self {
            robot: robot.into(),
            last_id: stored.last_id,
            journal: Vec::with_capacity(JOURNAL_CAPACITY),
            alarms: stored.alarms.alarms.clone(),
            last: stored.history.take_last(),
            ..Self::default()
        }
    }

    /// Adds an entry to the journal.
    pub(super) fn event(&mut self, event: Event, now: Instant) {
        if self.journal.len() == JOURNAL_CAPACITY {
            self.journal.remove(0);
        }
        self.journal.push(Entry {
            time_utc_s: now.utc_s(),
            event,
        });
    }

    /// Adds the results of an estimate: records and a changed state.
    pub(super) fn add_results(&mut self, records: Vec<Record>) {
        self.records.extend(records);
        self.state_changed = true;
    }

    /// Replaces the robot's records from a time on, s since 1970 UTC; the state changed.
    pub(super) fn replace_results(&mut self, from_utc_s: f64, records: Vec<Record>) {
        self.records.retain(|record| record.time_utc_s < from_utc_s);
        let before = self.replaced_from_utc_s.unwrap_or(f64::INFINITY);
        self.replaced_from_utc_s = Some(before.min(from_utc_s));
        self.add_results(records);
    }

    /// Reports losses in the journal, together and at most once per minute.
    pub(super) fn report_losses(&mut self, now: Instant) {
        let reported = self.losses_reported;
        let (messages, motion_s) = (self.dropped, self.behind_s);
        if reported.is_some_and(|reported| now.since_s(reported) < LOSS_REPORT_PERIOD_S)
            || (messages == 0 && motion_s == 0.0)
        {
            return;
        }
        (self.dropped, self.behind_s, self.losses_reported) = (0, 0.0, Some(now));
        if messages > 0 {
            self.event(Event::Dropped { messages }, now);
        }
        if motion_s > 0.0 {
            self.event(Event::Behind { motion_s }, now);
        }
    }

    /// Makes a transaction of all changes; `alarms`: those that are not normal, if one of them changed.
    pub(super) fn flush(
        &mut self,
        state: &Arc<MonitorState>,
        transitions: Vec<Transition>,
        alarms: Option<AlarmsStored>,
        now: Instant,
    ) {
        let discarded = std::mem::take(&mut self.discarded);
        if discarded != [0; 2] {
            let [entries, records] = discarded;
            self.event(Event::GivenUp { entries, records }, now);
        }
        let steps = transitions.into_iter().map(|transition| Entry {
            time_utc_s: transition.time_utc_s,
            event: Event::Alarm { transition },
        });
        let journal: Vec<Entry> = self.journal.drain(..).chain(steps).collect();
        let records = std::mem::take(&mut self.records);
        let replaced_from_utc_s = self.replaced_from_utc_s.take();
        let state = std::mem::take(&mut self.state_changed).then(|| Arc::clone(state));
        if journal.is_empty() && records.is_empty() && state.is_none() && alarms.is_none() {
            return;
        }
        self.last_id += 1;
        self.parts += 1;
        let next = Transaction {
            id: self.last_id,
            robot: self.robot.clone(),
            records,
            replaced_from_utc_s,
            state,
            alarms,
            journal,
        };
        self.waiting = Some(match self.waiting.take() {
            None => next,
            Some(older) => merged(older, next),
        });
        self.bound();
    }

    /// Discards the oldest entries and records beyond the maximum.
    fn bound(&mut self) {
        let Some(waiting) = &mut self.waiting else {
            return;
        };
        let excess = |length: usize, most: usize| length.saturating_sub(most);
        let entries = excess(waiting.journal.len(), MAX_WAITING_ENTRIES);
        waiting.journal.drain(..entries);
        let records = excess(waiting.records.len(), MAX_WAITING_RECORDS);
        waiting.records.drain(..records);
        self.discarded[0] += entries as u64;
        self.discarded[1] += records as u64;
    }

    /// Returns the next transaction to store; it waits for [`Outbox::committed`] or [`Outbox::store_failed`].
    pub(super) fn take(&mut self) -> Option<Transaction> {
        if self.under_way.is_none() {
            self.under_way = self.waiting.take();
            self.parts = 0;
            return self.under_way.clone();
        }
        None
    }

    /// Notes that the transaction was stored; `false`: it is another one.
    pub(super) fn committed(&mut self, id: u64) -> bool {
        let Some(stored) = self.under_way.take_if(|t| t.id == id) else {
            return false;
        };
        for record in stored.records {
            self.last.insert(record.joint.clone(), record);
        }
        if let Some(alarms) = stored.alarms {
            self.alarms = alarms.alarms;
        }
        self.fails = false;
        true
    }

    /// Notes that the transaction could not be stored; it is returned again, merged with later ones.
    pub(super) fn store_failed(&mut self, id: u64) -> bool {
        let Some(failed) = self.under_way.take_if(|t| t.id == id) else {
            return false;
        };
        self.parts += 1;
        self.waiting = Some(match self.waiting.take() {
            None => failed,
            Some(newer) => merged(failed, newer),
        });
        self.bound();
        self.fails = true;
        true
    }

    /// Returns the number of transactions that are not stored.
    pub(super) fn len(&self) -> usize {
        self.parts + usize::from(self.under_way.is_some())
    }
}

/// Merges two transactions.
fn merged(mut older: Transaction, mut newer: Transaction) -> Transaction {
    if let Some(from_utc_s) = newer.replaced_from_utc_s {
        older
            .records
            .retain(|record| record.time_utc_s < from_utc_s);
    }
    let replaced = [older.replaced_from_utc_s, newer.replaced_from_utc_s];
    older.records.append(&mut newer.records);
    older.journal.append(&mut newer.journal);
    Transaction {
        id: newer.id,
        robot: newer.robot,
        records: older.records,
        replaced_from_utc_s: replaced.into_iter().flatten().reduce(f64::min),
        state: newer.state.or(older.state),
        alarms: newer.alarms.or(older.alarms),
        journal: older.journal,
    }
}
