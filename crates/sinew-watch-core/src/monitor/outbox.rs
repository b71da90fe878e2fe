//! What waits for the store, and what may be spoken of.

use crate::alarm::{Alarm, AlarmsStored};
use crate::journal::Entry;
use crate::record::Record;
use crate::transaction::{Belief, Transaction};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Entries of the journal that wait at most: beyond, the oldest are given up.
const JOURNAL_MOST: usize = 10_000;
/// Records that wait at most: three months of seven tendons at work all day. Beyond, the oldest are given up.
const RECORDS_MOST: usize = 100_000;

/// Transactions on their way to the store: at most one is under way, and one waits that holds all the rest.
///
/// A store that refuses for days so costs bounded memory. Of the beliefs and alarms that wait only the last ones
/// matter; entries of the journal are given up first, from the oldest, records after months.
#[derive(Debug, Clone, Default)]
pub(super) struct Outbox {
    robot: String,
    last_id: u64,
    under_way: Option<Transaction>,
    waiting: Option<Transaction>,
    /// Parts that were put together in what waits.
    parts: usize,
    /// Alarms and last records that are stored.
    pub(super) alarms: Vec<Alarm>,
    pub(super) last: BTreeMap<String, Record>,
    given_up: [u64; 2],
}

impl Outbox {
    pub(super) fn new(robot: &str, last_id: u64, alarms: AlarmsStored) -> Self {
        Self {
            robot: robot.into(),
            last_id,
            alarms: alarms.alarms,
            ..Self::default()
        }
    }

    /// Adds what belongs together.
    pub(super) fn push(
        &mut self,
        records: Vec<Record>,
        belief: Option<Arc<Belief>>,
        alarms: Option<AlarmsStored>,
        journal: Vec<Entry>,
    ) {
        self.last_id += 1;
        let next = Transaction {
            id: self.last_id,
            robot: self.robot.clone(),
            records,
            belief,
            alarms,
            journal,
        };
        self.parts += 1;
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

    /// Entries of the journal and records given up since the last call; `None`: none.
    pub(super) fn take_given_up(&mut self) -> Option<[u64; 2]> {
        let given_up = std::mem::take(&mut self.given_up);
        (given_up != [0; 2]).then_some(given_up)
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
