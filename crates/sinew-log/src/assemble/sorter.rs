//! Bounded window that sorts samples by their time stamps.
//!
//! Samples arrive nearly sorted. The usual one is appended: no search, no
//! allocation (slots are recycled). A sample before the window is either late or the first one after a backward step
//! of the clock. The following samples decide: [`JUMP_EVIDENCE`] consecutive samples before the window indicate a
//! clock step and start a new epoch; fewer samples are late and dropped.

use std::collections::VecDeque;

use super::key::Key;
use super::steps::Steps;
use crate::frame::{ABSENT, is_absent};
use crate::health::{StreamRole, StreamTiming};

/// Number of consecutive samples before the window that indicate a clock step.
pub(crate) const JUMP_EVIDENCE: usize = 8;
/// Maximum number of samples in the window.
const SLOT_LIMIT: usize = 16_384;
/// Maximum memory of the samples in the window, bytes.
const BYTES_LIMIT: usize = 32 << 20;

#[derive(Debug)]
pub(crate) struct Slot {
    pub(crate) key: Key,
    /// Whether the stream was damaged just before this sample.
    pub(crate) after_damage: bool,
    pub(crate) values: Vec<f64>,
}

/// Counts of the sorting, added to the health of the recording.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub(crate) struct SortCounts {
    pub(crate) late: u64,
    pub(crate) duplicates: u64,
    /// Number of duplicates whose values differ from those of the stored sample.
    pub(crate) conflicting: u64,
    pub(crate) out_of_order: u64,
    pub(crate) clock_steps: u64,
}

/// Samples of one stream in the order of their stamps, within a window.
#[derive(Debug)]
pub struct Sorter {
    width: usize,
    window_ns: i64,
    slot_limit: usize,
    queue: VecDeque<Slot>,
    free: Vec<Slot>,
    behind: Vec<Slot>,
    scratch: Vec<f64>,
    epoch: u32,
    newest_ns: Option<i64>,
    released: Option<Key>,
    damage_pending: bool,
    pub(crate) counts: SortCounts,
    pub(crate) last_late_ns: Option<i64>,
    steps: Steps,
}

impl Sorter {
    /// A stream of rows of `width` values; a longer step than `gap_ns` is a pause.
    pub fn new(width: usize, window_ns: i64, gap_ns: i64) -> Self {
        let slot_limit = (BYTES_LIMIT / (width * 8 + 64)).clamp(16, SLOT_LIMIT);
        Sorter {
            width,
            window_ns,
            slot_limit,
            queue: VecDeque::new(),
            free: Vec::new(),
            behind: Vec::new(),
            scratch: vec![ABSENT; width],
            epoch: 0,
            newest_ns: None,
            released: None,
            damage_pending: false,
            counts: SortCounts::default(),
            last_late_ns: None,
            steps: Steps::new(gap_ns),
        }
    }

    /// Intervals of the time stamps, of released and of buffered samples.
    pub(crate) fn timing(&self, role: StreamRole) -> StreamTiming {
        let mut steps = self.steps.clone();
        for slot in &self.queue {
            steps.sample(slot.key);
        }
        steps.timing(role, self.counts.conflicting)
    }

    /// Newest stamp seen in the current epoch.
    pub(crate) fn newest(&self) -> Option<Key> {
        self.newest_ns.map(|time_ns| Key {
            epoch: self.epoch,
            time_ns,
        })
    }

    pub(crate) fn front(&self) -> Option<&Slot> {
        self.queue.front()
    }

    pub(crate) fn get(&self, index: usize) -> Option<&Slot> {
        self.queue.get(index)
    }

    pub(crate) fn len(&self) -> usize {
        self.queue.len()
    }

    pub(crate) fn is_full(&self) -> bool {
        self.queue.len() >= self.slot_limit
    }

    /// The next sample inserted is the first after a damaged part of the file.
    pub(crate) fn mark_damage(&mut self) {
        self.damage_pending = true;
    }

    /// Takes a sample in; `fill` writes it over a row of "absent".
    #[inline]
    pub fn insert(&mut self, time_ns: i64, fill: impl FnOnce(&mut [f64])) {
        let newest = match self.newest_ns {
            None => {
                return self.append(time_ns, fill);
            }
            Some(newest) => newest,
        };
        if time_ns > newest {
            if !self.behind.is_empty() {
                self.drop_behind();
            }
            self.append(time_ns, fill);
        } else {
            self.insert_out_of_order(time_ns, newest, fill);
        }
    }

    #[inline]
    fn append(&mut self, time_ns: i64, fill: impl FnOnce(&mut [f64])) {
        self.newest_ns = Some(time_ns);
        let mut slot = self.take_slot(time_ns);
        fill(&mut slot.values);
        self.queue.push_back(slot);
    }

    #[inline]
    fn take_slot(&mut self, time_ns: i64) -> Slot {
        let key = Key {
            epoch: self.epoch,
            time_ns,
        };
        let after_damage = std::mem::take(&mut self.damage_pending);
        match self.free.pop() {
            Some(mut slot) => {
                slot.key = key;
                slot.after_damage = after_damage;
                slot.values.fill(ABSENT);
                slot
            }
            None => Slot {
                key,
                after_damage,
                values: vec![ABSENT; self.width],
            },
        }
    }

    fn insert_out_of_order(&mut self, time_ns: i64, newest: i64, fill: impl FnOnce(&mut [f64])) {
        let key = Key {
            epoch: self.epoch,
            time_ns,
        };
        let released = self.released.is_some_and(|released| key <= released);
        if released || time_ns < newest.saturating_sub(self.window_ns) {
            // Amid samples from behind, the same stamp is one of them.
            if self.released == Some(key) && self.behind.is_empty() {
                self.counts.duplicates += 1;
                self.counts.conflicting += 1;
                return;
            }
            let mut slot = self.take_slot(time_ns);
            fill(&mut slot.values);
            self.behind.push(slot);
            if self.behind.len() >= JUMP_EVIDENCE {
                self.start_epoch();
            }
            return;
        }
        if !self.behind.is_empty() {
            self.drop_behind();
        }
        match self.queue.binary_search_by(|slot| slot.key.cmp(&key)) {
            Ok(index) => {
                self.scratch.fill(ABSENT);
                fill(&mut self.scratch);
                let kept = &mut self.queue[index].values;
                if !merge(kept, &self.scratch) {
                    self.counts.duplicates += 1;
                    let differs = |(kept, new): (&f64, &f64)| !is_absent(*new) && kept != new;
                    let conflicts = kept.iter().zip(&self.scratch).any(differs);
                    self.counts.conflicting += u64::from(conflicts);
                }
            }
            Err(index) => {
                self.counts.out_of_order += 1;
                let mut slot = self.take_slot(time_ns);
                fill(&mut slot.values);
                self.queue.insert(index, slot);
            }
        }
    }

    /// Counts the samples before the window as late.
    #[cold]
    pub(crate) fn drop_behind(&mut self) {
        self.counts.late += self.behind.len() as u64;
        if let Some(slot) = self.behind.last() {
            self.last_late_ns = Some(slot.key.time_ns);
        }
        self.free.append(&mut self.behind);
    }

    /// Starts a new epoch with the samples before the window.
    #[cold]
    fn start_epoch(&mut self) {
        self.counts.clock_steps += 1;
        self.epoch = self.epoch.saturating_add(1);
        self.behind.sort_by_key(|slot| slot.key.time_ns);
        // Its memory is kept.
        let mut behind = std::mem::take(&mut self.behind);
        for mut slot in behind.drain(..) {
            slot.key.epoch = self.epoch;
            self.newest_ns = Some(slot.key.time_ns);
            match self.queue.back_mut() {
                Some(back) if back.key == slot.key => {
                    if !merge(&mut back.values, &slot.values) {
                        self.counts.duplicates += 1;
                    }
                    self.free.push(slot);
                }
                _ => self.queue.push_back(slot),
            }
        }
        self.behind = behind;
    }

    /// Removes and returns the oldest sample; samples at or before its time are rejected afterwards.
    pub(crate) fn pop_front(&mut self) {
        if let Some(slot) = self.queue.pop_front() {
            self.released = Some(slot.key);
            self.steps.sample(slot.key);
            self.free.push(slot);
        }
    }

    /// Whether the oldest sample has waited through the window.
    #[inline]
    pub(crate) fn front_is_settled(&self, window_ns: i64) -> bool {
        let (Some(front), Some(newest)) = (self.queue.front(), self.newest()) else {
            return false;
        };
        has_reached(newest, front.key, window_ns)
    }
}

/// Whether a stream whose newest sample is `newest` is past `key` by `window_ns`.
#[inline]
pub(crate) fn has_reached(newest: Key, key: Key, window_ns: i64) -> bool {
    newest.epoch > key.epoch
        || (newest.epoch == key.epoch && newest.time_ns >= key.time_ns.saturating_add(window_ns))
}

/// Fills the absent values of `into`; returns whether there was any.
fn merge(into: &mut [f64], from: &[f64]) -> bool {
    let mut merged = false;
    for (into, from) in into.iter_mut().zip(from) {
        if is_absent(*into) && !is_absent(*from) {
            *into = *from;
            merged = true;
        }
    }
    merged
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drain(sorter: &mut Sorter) -> Vec<(u32, i64)> {
        let mut out = Vec::new();
        sorter.drop_behind();
        while let Some(front) = sorter.front() {
            out.push((front.key.epoch, front.key.time_ns));
            sorter.pop_front();
        }
        out
    }

    fn insert(sorter: &mut Sorter, time_ns: i64) {
        sorter.insert(time_ns, |row| row[0] = time_ns as f64);
    }

    #[test]
    fn late_within_the_window_is_sorted_in() {
        let mut sorter = Sorter::new(1, 100, 1_000_000);
        for time in [0, 50, 20, 60, 60, 55] {
            insert(&mut sorter, time);
        }
        assert_eq!(
            drain(&mut sorter),
            [(0, 0), (0, 20), (0, 50), (0, 55), (0, 60)]
        );
        assert_eq!(sorter.counts.out_of_order, 2);
        assert_eq!(sorter.counts.duplicates, 1);
    }

    #[test]
    fn sorter_few_behind_are_late_many_are_clock_step() {
        let mut sorter = Sorter::new(1, 100, 1_000_000);
        for time in [1000, 1010, 5, 6, 1020] {
            insert(&mut sorter, time);
        }
        assert_eq!(sorter.counts.late, 2);
        assert_eq!(sorter.counts.clock_steps, 0);
        for time in 0..JUMP_EVIDENCE as i64 {
            insert(&mut sorter, 10 + time);
        }
        assert_eq!(sorter.counts.clock_steps, 1);
        let order = drain(&mut sorter);
        assert_eq!(order[..3], [(0, 1000), (0, 1010), (0, 1020)]);
        assert_eq!(order[3], (1, 10));
        assert_eq!(order.len(), 3 + JUMP_EVIDENCE);
    }

    #[test]
    fn nothing_at_or_before_what_was_released_comes_back() {
        let mut sorter = Sorter::new(1, 100, 1_000_000);
        insert(&mut sorter, 0);
        insert(&mut sorter, 10);
        sorter.pop_front();
        insert(&mut sorter, 0);
        assert_eq!(sorter.counts.duplicates, 1);
        assert_eq!(drain(&mut sorter), [(0, 10)]);
    }

    #[test]
    fn extreme_stamps_do_not_overflow() {
        let mut sorter = Sorter::new(1, i64::MAX, 1_000_000);
        for time in [i64::MAX, i64::MIN, 0, i64::MIN, i64::MAX] {
            insert(&mut sorter, time);
        }
        assert!(sorter.len() >= 1);
        assert!(!sorter.front_is_settled(i64::MAX) || sorter.len() > 1);
    }
}
