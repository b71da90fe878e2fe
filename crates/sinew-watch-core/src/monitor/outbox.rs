//! What is written down: the journal, what waits for the store, and what may be spoken of.

use super::config::Stored;
use crate::alarm::{Alarm, AlarmsStored, Transition};
use crate::instant::Instant;
use crate::journal::{Entry, Event};
use crate::record::Record;
use crate::transaction::{Belief, Transaction};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Entries of the journal kept until the next tick, at most.
const JOURNAL_ROOM: usize = 256;
/// Losses are told together, once in this time, s.
const LOSSES_EVERY_S: f64 = 60.0;
/// Entries of the journal that wait at most: beyond, the oldest are given up.
const JOURNAL_MOST: usize = 10_000;
/// Records that wait at most: three months of seven tendons at work all day. Beyond, the oldest are given up.
const RECORDS_MOST: usize = 100_000;

/// Transactions on their way to the store: at most one is under way, and one waits that holds all the rest.
///
/// A store that refuses for days so costs bounded memory. Of the beliefs and alarms that wait only the last ones
/// matter; entries of the journal are given up first, from the oldest, records after months.
#[derive(Debug, Default)]
pub(super) struct Outbox {
    robot: String,
    last_id: u64,
    /// Entries and records since the last tick, and whether the belief is another one.
    journal: Vec<Entry>,
    records: Vec<Record>,
    belief_changed: bool,
    under_way: Option<Transaction>,
    waiting: Option<Transaction>,
    /// Parts that were put together in what waits.
    parts: usize,
    /// Alarms and last records that are stored.
    pub(super) alarms: Vec<Alarm>,
    pub(super) last: BTreeMap<String, Record>,
    given_up: [u64; 2],
    /// Whether the store refused the last transaction.
    pub(super) fails: bool,
    /// Messages that were dropped, and motion that was not estimated, s, since that was last told.
    pub(super) dropped: u64,
    pub(super) behind_s: f64,
    losses_told: Option<Instant>,
}

impl Outbox {
    pub(super) fn new(robot: &str, stored: &mut Stored) -> Self {
        Self {
            robot: robot.into(),
            last_id: stored.last_id,
            journal: Vec::with_capacity(JOURNAL_ROOM),
            alarms: stored.alarms.alarms.clone(),
            last: stored.history.take_last(),
            ..Self::default()
        }
    }

    /// Writes an entry of the journal.
    pub(super) fn event(&mut self, event: Event, now: Instant) {
        if self.journal.len() == JOURNAL_ROOM {
            self.journal.remove(0);
        }
        self.journal.push(Entry {
            time_utc_s: now.utc_s(),
            event,
        });
    }

    /// Takes what was learned: records, and another belief.
    pub(super) fn learned(&mut self, records: Vec<Record>) {
        self.records.extend(records);
        self.belief_changed = true;
    }

    /// Writes losses, together and once a minute at most.
    pub(super) fn tell_losses(&mut self, now: Instant) {
        let told = self.losses_told;
        let (messages, motion_s) = (self.dropped, self.behind_s);
        if told.is_some_and(|told| now.since_s(told) < LOSSES_EVERY_S)
            || (messages == 0 && motion_s == 0.0)
        {
            return;
        }
        (self.dropped, self.behind_s, self.losses_told) = (0, 0.0, Some(now));
        if messages > 0 {
            self.event(Event::Dropped { messages }, now);
        }
        if motion_s > 0.0 {
            self.event(Event::Behind { motion_s }, now);
        }
    }

    /// Makes a transaction of what is new; `alarms` are those that aren't normal.
    pub(super) fn flush(
        &mut self,
        belief: &Arc<Belief>,
        transitions: Vec<Transition>,
        alarms: impl FnOnce() -> AlarmsStored,
        now: Instant,
    ) {
        let given_up = std::mem::take(&mut self.given_up);
        if given_up != [0; 2] {
            let [entries, records] = given_up;
            self.event(Event::GivenUp { entries, records }, now);
        }
        let alarms = (!transitions.is_empty()).then(alarms);
        let steps = transitions.into_iter().map(|transition| Entry {
            time_utc_s: transition.time_utc_s,
            event: Event::Alarm { transition },
        });
        let journal: Vec<Entry> = self.journal.drain(..).chain(steps).collect();
        let records = std::mem::take(&mut self.records);
        let belief = std::mem::take(&mut self.belief_changed).then(|| Arc::clone(belief));
        if journal.is_empty() && records.is_empty() && belief.is_none() {
            return;
        }
        self.last_id += 1;
        self.parts += 1;
        let next = Transaction {
            id: self.last_id,
            robot: self.robot.clone(),
            records,
            belief,
            alarms,
            journal,
        };
        self.waiting = Some(match self.waiting.take() {
            None => next,
            Some(older) => joined(older, next),
        });
        self.bound();
    }

    /// Gives up what is too old.
    fn bound(&mut self) {
        let Some(waiting) = &mut self.waiting else {
            return;
        };
        let excess = |length: usize, most: usize| length.saturating_sub(most);
        let entries = excess(waiting.journal.len(), JOURNAL_MOST);
        waiting.journal.drain(..entries);
        let records = excess(waiting.records.len(), RECORDS_MOST);
        waiting.records.drain(..records);
        self.given_up[0] += entries as u64;
        self.given_up[1] += records as u64;
    }

    /// The next to store; it waits for [`Outbox::committed`] or [`Outbox::refused`].
    pub(super) fn take(&mut self) -> Option<Transaction> {
        if self.under_way.is_none() {
            self.under_way = self.waiting.take();
            self.parts = 0;
            return self.under_way.clone();
        }
        None
    }

    /// What is under way is stored; `false`: it isn't that one.
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

    /// It could not be stored: it is handed out again, with what came since.
    pub(super) fn refused(&mut self, id: u64) -> bool {
        let Some(refused) = self.under_way.take_if(|t| t.id == id) else {
            return false;
        };
        self.parts += 1;
        self.waiting = Some(match self.waiting.take() {
            None => refused,
            Some(newer) => joined(refused, newer),
        });
        self.bound();
        self.fails = true;
        true
    }

    /// Transactions that aren't stored.
    pub(super) fn len(&self) -> usize {
        self.parts + usize::from(self.under_way.is_some())
    }
}

/// Two as one.
fn joined(mut older: Transaction, mut newer: Transaction) -> Transaction {
    older.records.append(&mut newer.records);
    older.journal.append(&mut newer.journal);
    Transaction {
        id: newer.id,
        robot: newer.robot,
        records: older.records,
        belief: newer.belief.or(older.belief),
        alarms: newer.alarms.or(older.alarms),
        journal: older.journal,
    }
}
