//! Bounded window that sorts samples by their time stamps.
//!
//! Samples arrive nearly sorted. The usual one is appended: no search, no
//! allocation (slots are recycled). A sample before the window is either late or the first one after a backward step
//! of the clock. The following samples decide: [`JUMP_EVIDENCE`] consecutive rising samples before the newest one
//! indicate a clock step and start a new epoch; fewer samples are late and dropped, or sorted in within the window.

use std::collections::VecDeque;
use std::ops::Range;

use super::key::Key;
use super::sift::{Sift, Writer};
use super::slot::Slot;
use super::steps::Steps;
use crate::frame::{ABSENT, is_absent};
use crate::health::{StreamRole, StreamTiming};

/// Number of consecutive samples before the window, or rising before the newest one, that indicate a clock step.
pub(crate) const JUMP_EVIDENCE: usize = 8;
/// Maximum number of samples in the window.
const SLOT_LIMIT: usize = 16_384;
/// Maximum memory of the samples in the window, bytes.
const BYTES_LIMIT: usize = 32 << 20;

/// Consecutive rising samples that are not after the newest one.
#[derive(Debug, Default, Clone, Copy)]
struct Run {
    length: usize,
    last_ns: i64,
    /// Number of its first sample in the order of insertion.
    first_order: u64,
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
    /// Number of samples of a second publisher.
    pub(crate) second: u64,
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
    /// The recorder's clock at the sample that is being inserted, ns.
    received_ns: Option<i64>,
    inserted: u64,
    run: Run,
    pub(crate) counts: SortCounts,
    pub(crate) last_late_ns: Option<i64>,
    /// Intervals of the samples by their first column: publishers of different joints may share a stream.
    steps: Vec<(usize, Steps)>,
    gap_ns: i64,
    sift: Option<Sift>,
    /// Number of samples at the front that were assessed.
    assessed: usize,
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
            received_ns: None,
            inserted: 0,
            run: Run::default(),
            counts: SortCounts::default(),
            last_late_ns: None,
            steps: Vec::new(),
            gap_ns,
            sift: None,
            assessed: 0,
        }
    }

    /// Excludes samples of a second publisher, by the positions in `columns`.
    pub(crate) fn sift_by(&mut self, columns: Range<usize>) {
        self.sift = Some(Sift::new(columns, self.gap_ns));
    }

    /// Assesses the samples that are followed by half a window of others, or all of an ended stream.
    #[inline]
    pub(crate) fn assess(&mut self, ended: bool) {
        let Some(sift) = &mut self.sift else {
            return;
        };
        let newest = self.newest_ns.map(|time_ns| Key {
            epoch: self.epoch,
            time_ns,
        });
        while let Some(slot) = self.queue.get(self.assessed) {
            let is_full = self.assessed == 0 && self.queue.len() >= self.slot_limit;
            let is_followed = newest.is_some_and(|n| has_reached(n, slot.key, self.window_ns / 2));
            if !(ended || is_full || is_followed) {
                return;
            }
            match sift.assess(&self.queue, self.assessed) {
                Writer::Driver => {
                    self.assessed += 1;
                    continue;
                }
                Writer::Second => self.counts.second += 1,
                Writer::Duplicate => {
                    self.counts.duplicates += 1;
                    self.counts.conflicting += 1;
                }
            }
            self.free.extend(self.queue.remove(self.assessed));
        }
    }

    /// Intervals of the time stamps, of released and of buffered samples.
    pub(crate) fn timing(&self, role: StreamRole) -> StreamTiming {
        let mut steps = self.steps.clone();
        for slot in &self.queue {
            sample(&mut steps, self.gap_ns, slot);
        }
        let timings = steps.iter().map(|(_, steps)| steps.timing(role, 0));
        let most = timings.clone().max_by_key(|timing| timing.samples);
        let mut all = most.unwrap_or_else(|| Steps::new(self.gap_ns).timing(role, 0));
        all.repeated = self.counts.conflicting;
        all.samples = timings.clone().map(|timing| timing.samples).sum();
        let missing = |_| timings.map(|timing| timing.missing.unwrap_or(0)).sum();
        all.missing = all.missing.map(missing);
        all
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

    /// Inserts a sample that was received at `received_ns` of the recorder's clock; see [`Self::insert`].
    #[inline]
    pub fn insert_received(
        &mut self,
        time_ns: i64,
        received_ns: i64,
        fill: impl FnOnce(&mut [f64]),
    ) {
        self.received_ns = Some(received_ns);
        self.insert(time_ns, fill);
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
            self.run.length = 0;
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
        let received_ns = self.received_ns;
        self.inserted += 1;
        let order = self.inserted;
        match self.free.pop() {
            Some(mut slot) => {
                slot.key = key;
                slot.after_damage = after_damage;
                slot.received_ns = received_ns;
                slot.order = order;
                slot.values.fill(ABSENT);
                slot
            }
            None => Slot {
                key,
                after_damage,
                received_ns,
                order,
                values: vec![ABSENT; self.width],
            },
        }
    }

    fn insert_out_of_order(&mut self, time_ns: i64, newest: i64, fill: impl FnOnce(&mut [f64])) {
        if self.run.length == 0 || time_ns <= self.run.last_ns {
            self.run.length = 0;
            self.run.first_order = self.inserted + 1;
        }
        self.run.length += 1;
        self.run.last_ns = time_ns;
        self.sort_in(time_ns, newest, fill);
        if self.run.length.max(self.behind.len()) >= JUMP_EVIDENCE {
            self.start_epoch();
        }
    }

    /// Sorts in a sample that is not after the newest one, or keeps it for a step of the clock.
    fn sort_in(&mut self, time_ns: i64, newest: i64, fill: impl FnOnce(&mut [f64])) {
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
            return;
        }
        if self.run.length == 1 && !self.behind.is_empty() {
            self.drop_behind();
        }
        match self.queue.binary_search_by(|slot| slot.key.cmp(&key)) {
            Ok(index) => {
                self.scratch.fill(ABSENT);
                fill(&mut self.scratch);
                let kept = &mut self.queue[index].values;
                if !merge(kept, &self.scratch) {
                    let differs = |(kept, new): (&f64, &f64)| !is_absent(*new) && kept != new;
                    let conflicts = kept.iter().zip(&self.scratch).any(differs);
                    if conflicts && self.sift.is_some() {
                        let mut slot = self.take_slot(time_ns);
                        slot.values.copy_from_slice(&self.scratch);
                        match index < self.assessed {
                            // It may follow a step of the clock.
                            true => self.behind.push(slot),
                            // Which of them the driver sent is assessed later.
                            false => self.queue.insert(index + 1, slot),
                        }
                        return;
                    }
                    self.counts.duplicates += 1;
                    self.counts.conflicting += u64::from(conflicts);
                }
            }
            Err(index) => {
                self.counts.out_of_order += 1;
                self.assessed += usize::from(index < self.assessed);
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

    /// Discards the newest samples if the samples before the window continue those before them: stamps from the
    /// future, and not a step of the clock. Returns whether it did.
    fn drop_ahead(&mut self, first_ns: i64, last_ns: i64) -> bool {
        let is_ahead = |slot: &&Slot| slot.key.epoch == self.epoch && slot.key.time_ns > last_ns;
        let ahead = self.queue.iter().rev().take_while(is_ahead).count();
        let at = self.queue.len() - ahead;
        let before = at.checked_sub(1).and_then(|last| self.queue.get(last));
        let before = before.map(|slot| slot.key).or(self.released);
        let continues = before.is_some_and(|before| {
            let pause_ns = first_ns.saturating_sub(before.time_ns);
            before.epoch == self.epoch && (1..=self.gap_ns).contains(&pause_ns)
        });
        if !continues || ahead == 0 || ahead >= JUMP_EVIDENCE / 2 {
            return false;
        }
        self.counts.late += ahead as u64;
        self.last_late_ns = self.queue.back().map(|slot| slot.key.time_ns);
        self.free.extend(self.queue.drain(at..));
        self.assessed = self.assessed.min(at);
        true
    }

    /// Starts a new epoch with the samples before the window, unless they continue the samples of this one.
    #[cold]
    fn start_epoch(&mut self) {
        // Those of its samples that were sorted in.
        let mut index = 0;
        while index < self.queue.len() {
            if self.queue[index].order < self.run.first_order {
                index += 1;
                continue;
            }
            self.behind.extend(self.queue.remove(index));
            self.assessed -= usize::from(index < self.assessed);
            self.counts.out_of_order = self.counts.out_of_order.saturating_sub(1);
        }
        self.run.length = 0;
        self.behind.sort_by_key(|slot| slot.key.time_ns);
        let ends = self.behind.first().zip(self.behind.last());
        let Some((first_ns, last_ns)) =
            ends.map(|(first, last)| (first.key.time_ns, last.key.time_ns))
        else {
            return;
        };
        if !self.drop_ahead(first_ns, last_ns) {
            self.counts.clock_steps += 1;
            self.epoch = self.epoch.saturating_add(1);
        }
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
            sample(&mut self.steps, self.gap_ns, &slot);
            self.assessed = self.assessed.saturating_sub(1);
            self.free.push(slot);
        }
    }

    /// Whether the oldest sample has waited for `wait_ns`, of samples after a step of the clock too.
    pub(crate) fn has_waited(&self, wait_ns: i64) -> bool {
        let (Some(front), Some(newest)) = (self.queue.front(), self.newest()) else {
            return false;
        };
        let is_newest = |slot: &&Slot| slot.key.epoch == newest.epoch;
        let since = match newest.epoch == front.key.epoch {
            true => Some(front),
            false => self.queue.iter().find(is_newest),
        };
        since.is_some_and(|since| has_reached(newest, since.key, wait_ns))
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

/// Adds a sample to the intervals of the samples with the same first column.
#[inline]
fn sample(steps: &mut Vec<(usize, Steps)>, gap_ns: i64, slot: &Slot) {
    let first = slot.values.iter().position(|value| !is_absent(*value));
    let first = first.unwrap_or(0);
    let index = match steps.iter().position(|(column, _)| *column == first) {
        Some(index) => index,
        None => {
            steps.push((first, Steps::new(gap_ns)));
            steps.len() - 1
        }
    };
    if let Some((_, steps)) = steps.get_mut(index) {
        steps.sample(slot.key);
    }
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
