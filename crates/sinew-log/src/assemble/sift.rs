//! Samples of a second publisher among those of the first one.
//!
//! A node that repeats a fixed pose, or relays positions, on the topic of the driver sends further samples between those
//! of the driver. Such a sample is a step of the position there and back, and it comes in addition: the samples
//! before and after it are one period apart. A step that lasts (an encoder that slips), and a wrong value in place of
//! a right one, are therefore samples of the driver.
//!
//! The driver is the publisher of most of the first samples, or the one whose positions change.

use super::key::Key;
use super::slot::Slot;
use crate::frame::is_absent;
use std::collections::VecDeque;
use std::ops::Range;

/// Ratio of a step of the position to the mean step above which it may be that to another publisher.
const STEP_RATIO: f64 = 4.0;
/// The same for the first samples, relative to the median step.
const FIRST_STEP_RATIO: f64 = 8.0;
/// Ratio of what is left of a step to the step, below which the position is back.
const BACK_RATIO: f64 = 0.25;
/// Ratio of an interval to the period below which no sample of the driver is missing in it.
const PERIOD_RATIO: f64 = 1.6;
/// Weight of the latest step in the mean step and in the period.
const LATEST: f64 = 1.0 / 16.0;
/// Number of the first samples that is enough to recognise the driver.
const FIRST_SAMPLES: usize = 5;

/// Assesses the samples of one stream in the order of their time stamps.
#[derive(Debug)]
pub(crate) struct Sift {
    /// Columns of positions.
    columns: Range<usize>,
    gap_ns: i64,
    /// Last sample of the driver.
    last: Option<Key>,
    positions: Vec<f64>,
    /// Mean absolute step of each position of the driver.
    steps: Vec<f64>,
    /// Smallest step other than zero of each position of the driver: its resolution.
    resolution: Vec<f64>,
    period_ns: f64,
    /// Last positions of the second publisher; empty before its first sample.
    other: Vec<f64>,
}

/// Publisher of a sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Writer {
    /// Publisher whose samples are used.
    Driver,
    /// Publisher of further samples.
    Second,
    /// Sample with the time stamp of the one before.
    Duplicate,
}

/// Absolute difference of two positions; `None` if one of them is absent.
fn step(from: f64, to: f64) -> Option<f64> {
    let step = (to - from).abs();
    step.is_finite().then_some(step)
}

/// Value that one of `parts` parts of the values do not exceed, such as the median for 2; 0 of nothing.
fn quantile(values: &mut [f64], parts: usize) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / parts).copied().unwrap_or(0.0)
}

/// Whether two rows are bitwise equal.
fn is_same(a: &[f64], b: &[f64]) -> bool {
    a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits())
}

/// Intervals between the samples, ns.
fn intervals_ns(track: &[&Slot]) -> Vec<f64> {
    let pairs = track.iter().zip(track.iter().skip(1));
    let interval = |(a, b): (&&Slot, &&Slot)| b.key.time_ns.saturating_sub(a.key.time_ns) as f64;
    pairs.map(interval).collect()
}

/// Whether the samples come in addition to those of the `driver`: wherever one lies between two samples of the driver,
/// none of the driver's is missing.
fn is_between(further: &[&Slot], driver: &[&Slot]) -> bool {
    let period_ns = quantile(&mut intervals_ns(driver), 4);
    let around_ns = |slot: &&Slot| {
        let at = driver.partition_point(|own| own.key < slot.key);
        let (before, after) = (driver.get(at.checked_sub(1)?)?, driver.get(at)?);
        Some(after.key.time_ns.saturating_sub(before.key.time_ns) as f64)
    };
    let mut around_ns = further.iter().filter_map(around_ns).peekable();
    around_ns.peek().is_some() && around_ns.all(|ns| ns <= PERIOD_RATIO * period_ns)
}

impl Sift {
    pub(crate) fn new(columns: Range<usize>, gap_ns: i64) -> Self {
        let n = columns.len();
        Self {
            columns,
            gap_ns,
            last: None,
            positions: vec![f64::NAN; n],
            steps: vec![0.0; n],
            resolution: vec![f64::INFINITY; n],
            period_ns: 0.0,
            other: Vec::new(),
        }
    }

    fn of<'a>(&self, slot: &'a Slot) -> &'a [f64] {
        slot.values.get(self.columns.clone()).unwrap_or_default()
    }

    /// Whether `row` repeats the last positions of the second publisher.
    fn repeats_other(&self, row: &[f64]) -> bool {
        !self.other.is_empty() && is_same(row, &self.other)
    }

    /// Assesses the sample at `index`, of which the ones before are assessed, by those after it.
    pub(crate) fn assess(&mut self, queue: &VecDeque<Slot>, index: usize) -> Writer {
        let Some(slot) = queue.get(index) else {
            return Writer::Driver;
        };
        let continues = |last: &Key| {
            let pause_ns = slot.key.time_ns.saturating_sub(last.time_ns);
            last.epoch == slot.key.epoch && pause_ns <= self.gap_ns
        };
        let writer = match self.last.filter(continues) {
            None => self.assess_first(queue, index),
            Some(last) => self.assess_next(queue, index, last),
        };
        match writer {
            Writer::Driver => self.accept(slot),
            Writer::Second => {
                self.other.clear();
                self.other
                    .extend_from_slice(&slot.values[self.columns.clone()]);
            }
            Writer::Duplicate => {}
        }
        writer
    }

    fn assess_next(&self, queue: &VecDeque<Slot>, index: usize, last: Key) -> Writer {
        let slot = &queue[index];
        let row = self.of(slot);
        let is_step = |column: usize| {
            let limit = STEP_RATIO * self.steps[column] + 2.0 * self.resolution[column];
            // Without a resolution there was no motion yet.
            let limit = if limit.is_finite() { limit } else { 0.0 };
            step(self.positions[column], row[column]).is_some_and(|step| step > limit)
        };
        let steps = (0..row.len()).any(is_step);
        let repeats = self.repeats_other(row);
        let is_same_time = slot.key == last;
        if !steps && !repeats {
            return match is_same_time {
                true => Writer::Duplicate,
                false => Writer::Driver,
            };
        }
        let is_back = |after: &&Slot| {
            let after = self.of(after);
            let stepped = (0..row.len()).filter(|column| is_step(*column));
            let ways = stepped.filter_map(|column| {
                let whole = step(self.positions[column], row[column])?;
                Some((step(self.positions[column], after[column])?, whole))
            });
            let (left, whole) = ways.fold((0.0, 0.0), |sum, way| (sum.0 + way.0, sum.1 + way.1));
            match steps {
                true => left < BACK_RATIO * whole,
                false => !self.repeats_other(after),
            }
        };
        // Within a period of the driver; a pose that the second publisher has sent before may be back later.
        let is_near = |after: &&Slot| {
            let between_ns = after.key.time_ns.saturating_sub(last.time_ns) as f64;
            let is_within = between_ns <= PERIOD_RATIO * self.period_ns;
            after.key.epoch == slot.key.epoch && (is_within || steps && repeats)
        };
        let mut after = queue.range(index + 1..).take_while(is_near);
        match after.any(|after| is_back(&after)) {
            true => Writer::Second,
            false if is_same_time => Writer::Duplicate,
            false => Writer::Driver,
        }
    }

    /// Assesses the first sample of a segment: the driver is the publisher of most of the following samples, or of
    /// those that change.
    fn assess_first(&mut self, queue: &VecDeque<Slot>, index: usize) -> Writer {
        let first = &queue[index];
        let rows = queue.range(index..);
        let rows = rows.take_while(|slot| slot.key.epoch == first.key.epoch);
        let rows = Vec::from_iter(rows);
        let scale = |column: usize| {
            let of_lag = |lag: usize| {
                let pairs = rows.iter().zip(rows.iter().skip(lag));
                let steps = pairs.filter_map(|(a, b)| step(self.of(a)[column], self.of(b)[column]));
                quantile(&mut Vec::from_iter(steps), 2)
            };
            // Every second sample may be one of the second publisher.
            of_lag(1).min(of_lag(2)).min(of_lag(3))
        };
        let scales = Vec::from_iter((0..self.columns.len()).map(scale));
        let [own, others] = self.tracks(&rows, &scales);
        let rests = |track: &[&Slot]| {
            let mut others = track.iter().skip(1);
            others.all(|slot| is_same(self.of(slot), self.of(track[0])))
        };
        let own_rests = rests(&own) != rests(&others) && rests(&own);
        let others_rest = rests(&own) != rests(&others) && !own_rests;
        let is_second = own_rests || !others_rest && others.len() > own.len();
        if own.len() > 1 && is_second && is_between(&own, &others) {
            return Writer::Second;
        }
        let driver = if is_between(&others, &own) {
            &own
        } else {
            &rows
        };
        self.period_ns = quantile(&mut intervals_ns(driver), 2);
        self.steps = scales;
        self.positions.fill(f64::NAN);
        Writer::Driver
    }

    /// Samples like the first one, and those like the first one that differs much from the one before it.
    fn tracks<'a>(&self, rows: &[&'a Slot], scales: &[f64]) -> [Vec<&'a Slot>; 2] {
        let all = [rows.to_vec(), Vec::new()];
        let Some(first) = rows.first().filter(|_| rows.len() >= FIRST_SAMPLES) else {
            return all;
        };
        let is_far = |a: &Slot, b: &Slot| {
            let pairs = self.of(a).iter().zip(self.of(b)).zip(scales);
            let mut steps = pairs.filter_map(|((a, b), scale)| Some((step(*a, *b)?, scale)));
            steps.any(|(step, scale)| step > FIRST_STEP_RATIO * scale)
        };
        let mut pairs = rows.iter().zip(rows.iter().skip(1));
        let Some((_, other)) = pairs.find(|(before, after)| is_far(before, after)) else {
            return all;
        };
        let (from, to) = (self.of(first), self.of(other));
        let steps = from.iter().zip(to).enumerate();
        let steps = steps.filter_map(|(column, (a, b))| Some((column, step(*a, *b)?)));
        let Some((column, _)) = steps.max_by(|a, b| a.1.total_cmp(&b.1)) else {
            return all;
        };
        let is_own = |slot: &&Slot| {
            let at = self.of(slot)[column];
            (at - from[column]).abs() <= (at - to[column]).abs()
        };
        let (own, others) = rows.iter().copied().partition(is_own);
        [own, others]
    }

    /// Continues the track of the driver.
    fn accept(&mut self, slot: &Slot) {
        let row = slot.values.get(self.columns.clone()).unwrap_or_default();
        let each = self.positions.iter_mut().zip(row);
        let each = each.zip(&mut self.steps).zip(&mut self.resolution);
        for (((position, now), mean), resolution) in each {
            if is_absent(*now) {
                continue;
            }
            if let Some(step) = step(*position, *now) {
                *mean += LATEST * (step - *mean);
                if step > 0.0 && step < *resolution {
                    *resolution = step;
                }
            }
            *position = *now;
        }
        let last = self.last.replace(slot.key);
        let last = last.filter(|last| last.epoch == slot.key.epoch);
        if let Some(last) = last {
            let interval_ns = slot.key.time_ns.saturating_sub(last.time_ns);
            if (1..=self.gap_ns).contains(&interval_ns) {
                let limited = (interval_ns as f64).min(2.0 * self.period_ns.max(1.0));
                self.period_ns = match self.period_ns > 0.0 {
                    true => self.period_ns + LATEST * (limited - self.period_ns),
                    false => interval_ns as f64,
                };
            }
        }
    }
}
