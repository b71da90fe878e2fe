//! Assembly of frames from streams of samples: sorted, joined, conditioned.
//!
//! One *primary* stream sets the time stamps (joint side, or the rows of a table); *side* streams (motor
//! side, external torque, joints of the joint side in messages of their own) are evaluated at these time stamps: the
//! sample with the same stamp, or the linear interpolation of its neighbours.

mod condition;
mod coverage;
mod key;
mod sift;
mod slot;
mod sorter;
mod steps;
mod timeline;

use crate::frame::{Frame, Quantity, is_absent};
use crate::health::{EventKind, Health, SecondPublisher, StreamRole};

pub use crate::frame::ABSENT;
pub use condition::{Conditioner, Signal};
use key::Key;
pub use sorter::Sorter;
use sorter::has_reached;

/// A joint-side sample waits for a stalled side stream at most this many windows.
const PATIENCE_WINDOWS: i64 = 4;

/// Stream that is evaluated at the time stamps of the primary one.
#[derive(Debug)]
pub struct Side {
    /// Sorted samples of the stream.
    pub sorter: Sorter,
    /// The quantity of each block of `n` values in its rows.
    blocks: Vec<Quantity>,
    /// Columns with a value in any message.
    seen: Vec<bool>,
    /// Index of the last sample at or before the current time stamp.
    cursor: usize,
    /// Whether the stream exists; frames do not wait for a missing one.
    expected: bool,
}

/// Sorts, joins and conditions samples; returns one frame at a time.
#[derive(Debug)]
pub struct Joiner {
    n: usize,
    window_ns: i64,
    interpolate_ns: i64,
    /// Samples of the joint side, or rows of a table.
    pub primary: Sorter,
    primary_blocks: Vec<Quantity>,
    /// Side streams, in the order of [`Joiner::new`].
    pub sides: Vec<Side>,
    raw: Vec<f64>,
    conditioner: Conditioner,
    frame: Frame,
    ended: bool,
    /// Key up to which all samples are released.
    released: Option<Key>,
    late_reported: u64,
}

impl Joiner {
    /// A joiner of `n` axes.
    ///
    /// * `primary_blocks`: the quantity of each block of `n` values in a row of the primary stream;
    ///   `side_blocks`: the same of each side stream.
    /// * `window_ns`: samples late by at most this much are reordered.
    /// * `interpolate_ns`: maximum distance of a neighbour.
    pub fn new(
        n: usize,
        primary_blocks: &[Quantity],
        side_blocks: &[&[Quantity]],
        window_ns: i64,
        interpolate_ns: i64,
        conditioner: Conditioner,
    ) -> Self {
        Joiner {
            n,
            window_ns,
            interpolate_ns,
            primary: Sorter::new(n * primary_blocks.len(), window_ns, conditioner.gap_ns()),
            primary_blocks: primary_blocks.to_vec(),
            sides: side_blocks
                .iter()
                .map(|blocks| Side {
                    sorter: Sorter::new(n * blocks.len(), window_ns, conditioner.gap_ns()),
                    blocks: blocks.to_vec(),
                    seen: vec![false; n * blocks.len()],
                    cursor: 0,
                    expected: true,
                })
                .collect(),
            raw: vec![ABSENT; n * conditioner.blocks().len()],
            conditioner,
            frame: Frame::new(n),
            ended: false,
            released: None,
            late_reported: 0,
        }
    }

    /// Keeps the time stamps in the frames as they are. Otherwise the time of the frames continues over steps of the
    /// clock, by the recorder's clock or the last period.
    pub fn keep_stamps(&mut self) {
        self.conditioner.keep_stamps();
    }

    /// Excludes samples of a second publisher on the topic of a side, and counts them.
    pub fn exclude_second_publishers(&mut self) {
        let sides = self.sides.iter_mut();
        let sides = sides.map(|side| (&mut side.sorter, &side.blocks));
        let all = std::iter::once((&mut self.primary, &self.primary_blocks)).chain(sides);
        for (sorter, blocks) in all {
            let is_position = |block: &Quantity| matches!(block, Quantity::Q | Quantity::Theta);
            if let Some(block) = blocks.iter().position(is_position) {
                sorter.sift_by(block * self.n..(block + 1) * self.n);
            }
        }
    }

    /// Ends the input: all samples are released.
    pub fn end(&mut self) {
        self.primary.drop_behind();
        for side in &mut self.sides {
            side.sorter.drop_behind();
        }
        self.ended = true;
    }

    /// Sets whether a side stream exists; frames do not wait for a missing one, and its values are absent.
    pub fn expect(&mut self, side: usize, expected: bool) {
        let Some(side) = self.sides.get_mut(side) else {
            return;
        };
        side.expected = expected;
        if !expected {
            for quantity in &side.blocks {
                let into = quantity.index() * self.n;
                self.raw[into..into + self.n].fill(ABSENT);
            }
        }
    }

    /// Releases all samples as they are; the next sample begins a new segment.
    pub fn release(&mut self) {
        self.primary.drop_behind();
        for side in &mut self.sides {
            side.sorter.drop_behind();
        }
        self.released = self.primary.newest();
        self.primary.mark_damage();
    }

    /// Marks that the next sample follows a damaged part of the file.
    pub fn mark_damage(&mut self) {
        self.primary.mark_damage();
    }

    /// Whether the oldest joint-side sample may become a frame now.
    #[inline]
    pub fn is_ready(&mut self) -> bool {
        self.primary.assess(self.ended);
        for side in &mut self.sides {
            side.sorter.assess(self.ended);
        }
        let Some(front) = self.primary.front() else {
            return false;
        };
        let released = self.released.is_some_and(|newest| front.key <= newest);
        if self.ended || released || self.primary.is_full() {
            return true;
        }
        if !self.primary.front_is_settled(self.window_ns) {
            return false;
        }
        let key = front.key;
        let sides_reached = self.sides.iter().filter(|side| side.expected).all(|side| {
            side.sorter.is_full()
                || side
                    .sorter
                    .newest()
                    .is_some_and(|newest| has_reached(newest, key, self.window_ns))
        });
        sides_reached
            || self
                .primary
                .has_waited(self.window_ns.saturating_mul(PATIENCE_WINDOWS))
    }

    /// Makes the frame of the oldest joint-side sample. Call only when [`Self::is_ready`].
    pub fn compose(&mut self, health: &mut Health) -> &Frame {
        let n = self.n;
        let (key, received_ns, after_damage) = match self.primary.front() {
            None => return &self.frame,
            Some(slot) => {
                for (block, quantity) in self.primary_blocks.iter().enumerate() {
                    let into = quantity.index() * n;
                    self.raw[into..into + n]
                        .copy_from_slice(&slot.values[block * n..(block + 1) * n]);
                }
                (slot.key, slot.received_ns, slot.after_damage)
            }
        };
        for side in self.sides.iter_mut().filter(|side| side.expected) {
            side.look_up(
                key,
                n,
                self.interpolate_ns,
                &self.conditioner,
                &mut self.raw,
            );
        }
        self.primary.pop_front();
        if self.primary.counts.late != self.late_reported {
            let newly = self.primary.counts.late - self.late_reported;
            self.late_reported = self.primary.counts.late;
            let at = self.primary.last_late_ns.unwrap_or(key.time_ns);
            health.event(at, EventKind::Late, || {
                format!("{newly} messages discarded: too late to be reordered")
            });
        }
        self.conditioner.apply(
            key,
            received_ns,
            after_damage,
            &mut self.raw,
            &mut self.frame,
            health,
        );
        &self.frame
    }

    /// Adds the counts of the sorters and the conditioner.
    pub fn finish(&self, health: &mut Health) {
        let mut counts = self.primary.counts;
        for side in self.sides.iter().filter(|side| side.expected) {
            counts.late += side.sorter.counts.late;
            counts.duplicates += side.sorter.counts.duplicates;
            counts.out_of_order += side.sorter.counts.out_of_order;
        }
        health.late = counts.late;
        health.duplicates = counts.duplicates;
        health.out_of_order = counts.out_of_order;
        let mut expected = self.sides.iter().filter(|side| side.expected);
        let motor_apart = expected.any(Side::is_motor);
        let of_primary = match motor_apart {
            true => StreamRole::JointSide,
            false => StreamRole::BothSides,
        };
        health.streams = vec![self.primary.timing(of_primary)];
        let second = (of_primary, self.primary.counts.second);
        let mut seconds = vec![second];
        for side in self.sides.iter().filter(|side| side.expected) {
            let role = match side.blocks[..] {
                _ if side.is_rest() => of_primary,
                _ if side.is_motor() => StreamRole::MotorSide,
                [Quantity::Tension] => StreamRole::Tension,
                _ => StreamRole::ExternalTorque,
            };
            let timing = side.sorter.timing(role);
            seconds.push((role, side.sorter.counts.second));
            match health.streams.first_mut().filter(|_| side.is_rest()) {
                Some(primary) => primary.add(&timing),
                None => health.streams.push(timing),
            }
        }
        health.second_publishers.clear();
        for (stream, samples) in seconds.into_iter().filter(|(_, samples)| *samples > 0) {
            let mut counted = health.second_publishers.iter_mut();
            match counted.find(|counted| counted.stream == stream) {
                Some(counted) => counted.samples += samples,
                None => health
                    .second_publishers
                    .push(SecondPublisher { stream, samples }),
            }
        }
        self.conditioner.finish(health);
    }
}

impl Side {
    fn is_motor(&self) -> bool {
        self.blocks.contains(&Quantity::Theta)
    }

    /// Whether the stream holds joints of the joint side that the primary stream does not hold.
    fn is_rest(&self) -> bool {
        self.blocks.contains(&Quantity::Q)
    }

    /// Writes the values of this stream at `key` into the wide row; absent if there are none.
    fn look_up(
        &mut self,
        key: Key,
        n: usize,
        interpolate_ns: i64,
        conditioner: &Conditioner,
        raw: &mut [f64],
    ) {
        let horizon = Key {
            epoch: key.epoch,
            time_ns: key.time_ns.saturating_sub(interpolate_ns),
        };
        while self
            .sorter
            .get(1)
            .is_some_and(|second| second.key <= horizon)
        {
            self.sorter.pop_front();
            self.cursor = self.cursor.saturating_sub(1);
        }
        // The cursor corrects itself after samples were sorted in before it.
        self.cursor = self.cursor.min(self.sorter.len().saturating_sub(1));
        while self.cursor > 0 && self.sorter.get(self.cursor).is_some_and(|s| s.key > key) {
            self.cursor -= 1;
        }
        while self
            .sorter
            .get(self.cursor + 1)
            .is_some_and(|next| next.key <= key)
        {
            self.cursor += 1;
        }

        let near = |index: Option<usize>| {
            index
                .and_then(|index| self.sorter.get(index))
                .filter(|slot| {
                    slot.key.epoch == key.epoch
                        && slot.key.time_ns.abs_diff(key.time_ns) <= interpolate_ns.unsigned_abs()
                })
        };
        let before = near(Some(self.cursor)).filter(|slot| slot.key <= key);
        let after_index = if self
            .sorter
            .get(self.cursor)
            .is_some_and(|slot| slot.key > key)
        {
            self.cursor
        } else {
            self.cursor + 1
        };
        let after = near(Some(after_index));

        let is_rest = self.is_rest();
        // The usual sample has the stamp of the frame and is copied.
        let exact = before.filter(|slot| slot.key == key);
        for (block, quantity) in self.blocks.iter().enumerate() {
            let into = quantity.index() * n;
            let columns = block * n..(block + 1) * n;
            if let Some(slot) = exact.filter(|_| !is_rest) {
                let values = &slot.values[columns.clone()];
                raw[into..into + n].copy_from_slice(values);
                let missing = values
                    .iter()
                    .zip(&self.seen[columns])
                    .fold(false, |missing, (value, seen)| {
                        missing | (*seen & is_absent(*value))
                    });
                if !missing {
                    continue;
                }
            }
            for joint in 0..n {
                let column = block * n + joint;
                if is_rest && !is_absent(raw[into + joint]) {
                    continue;
                }
                let value = match (before, after) {
                    (Some(a), _) if a.key == key => a.values[column],
                    (Some(a), Some(b)) => {
                        let (va, vb) = (a.values[column], b.values[column]);
                        if is_absent(va) || is_absent(vb) {
                            ABSENT
                        } else {
                            let period = conditioner.raw_period(*quantity, joint);
                            interpolate(key.time_ns, a.key, va, b.key, vb, period)
                        }
                    }
                    _ => ABSENT,
                };
                raw[into + joint] = if is_absent(value) {
                    if self.seen[column] {
                        self.look_farther(key, column, after_index, interpolate_ns, || {
                            conditioner.raw_period(*quantity, joint)
                        })
                    } else {
                        ABSENT
                    }
                } else {
                    value
                };
            }
        }
    }

    /// A joint missing in the nearest samples (each message may hold a subset):
    /// its own nearest samples on both sides, within the same distance.
    #[cold]
    fn look_farther(
        &self,
        key: Key,
        column: usize,
        after_index: usize,
        interpolate_ns: i64,
        period: impl Fn() -> Option<f64>,
    ) -> f64 {
        let near = |key_of: Key| {
            key_of.epoch == key.epoch
                && key_of.time_ns.abs_diff(key.time_ns) <= interpolate_ns.unsigned_abs()
        };
        let found = |index: usize| {
            self.sorter
                .get(index)
                .map(|slot| (slot.key, slot.values[column]))
        };
        let before = (0..after_index)
            .rev()
            .map_while(found)
            .take_while(|(at, _)| near(*at))
            .find(|(_, value)| !is_absent(*value));
        let after = (after_index..self.sorter.len())
            .map_while(found)
            .take_while(|(at, _)| near(*at))
            .find(|(_, value)| !is_absent(*value));
        match (before, after) {
            (Some((at, value)), _) if at == key => value,
            (Some((ka, va)), Some((kb, vb))) => interpolate(key.time_ns, ka, va, kb, vb, period()),
            _ => ABSENT,
        }
    }

    /// Permits values of this column from neighbouring samples from now on.
    pub fn note_column(&mut self, column: usize) {
        if let Some(seen) = self.seen.get_mut(column) {
            *seen = true;
        }
    }
}

fn interpolate(time_ns: i64, ka: Key, va: f64, kb: Key, vb: f64, period: Option<f64>) -> f64 {
    // Both lie within the interpolation distance, so the differences are small and exact.
    let span = kb.time_ns.wrapping_sub(ka.time_ns) as f64;
    let weight = time_ns.wrapping_sub(ka.time_ns) as f64 / span;
    let mut difference = vb - va;
    if let Some(period) = period
        && difference.abs() > 0.5 * period
    {
        difference -= period * (difference / period).round();
    }
    va + weight * difference
}
