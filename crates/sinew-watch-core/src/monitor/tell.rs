//! What is written down: the journal, and what goes to the store together.

use super::Monitor;
use crate::instant::Instant;
use crate::journal::{Entry, Event};
use crate::record::Record;

/// Entries kept until the next tick, at most.
pub(super) const JOURNAL_ROOM: usize = 256;

impl Monitor {
    /// An entry of the journal.
    pub(super) fn event(&mut self, event: Event, now: Instant) {
        if self.journal.len() == JOURNAL_ROOM {
            self.journal.remove(0);
        }
        self.journal.push(Entry {
            time_utc_s: now.utc_s(),
            event,
        });
    }

    /// What was learned goes to the store, with everything else there is to say.
    pub(super) fn keep(&mut self, records: Vec<Record>) {
        self.unstored.records.extend(records);
        self.unstored.belief = true;
    }

    /// What is new becomes a transaction.
    pub(super) fn flush(&mut self, now: Instant) {
        if let Some([entries, records]) = self.outbox.take_given_up() {
            self.event(Event::GivenUp { entries, records }, now);
        }
        let transitions = self.alarms.take_transitions();
        let alarms = (!transitions.is_empty()).then(|| self.alarms.stored());
        let alarm_entries = transitions.into_iter().map(|transition| Entry {
            time_utc_s: transition.time_utc_s,
            event: Event::Alarm { transition },
        });
        let mut journal: Vec<Entry> = self.journal.drain(..).collect();
        journal.extend(alarm_entries);
        let unstored = std::mem::take(&mut self.unstored);
        if journal.is_empty() && unstored.records.is_empty() && !unstored.belief {
            return;
        }
        let belief = unstored.belief.then(|| self.belief.clone());
        self.outbox.push(unstored.records, belief, alarms, journal);
    }
}
