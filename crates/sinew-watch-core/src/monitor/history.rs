//! The records a trend rests on: of each day the best.

use crate::record::{Clock, Record};
use sinew_files::date::DAY_S;
use sinew_model::Gaussian;
use sinew_trend::SessionRecord;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Days kept of a tendon: four years.
const DAYS_MOST: usize = 1461;

/// What a day's best record said of a tendon.
#[derive(Debug, Clone, PartialEq)]
struct Day {
    time_utc_s: f64,
    duration_s: f64,
    offset_rad: Gaussian,
    temperature_c: Option<f64>,
    stiffness_ratio: Option<Gaussian>,
    since: Option<Arc<str>>,
}

impl Day {
    fn number(&self) -> i64 {
        (self.time_utc_s / DAY_S).floor() as i64
    }
}

/// The records of a robot, as far as its monitor needs them: of each tendon the last one, and of each day the one
/// with the narrowest interval. Errors of one day's sessions are mostly the same: a second one hardly adds.
///
/// A hundred bytes a day and tendon, for four years at most.
#[derive(Debug, Clone, Default)]
pub struct History {
    days: BTreeMap<String, Vec<Day>>,
    last: BTreeMap<String, Record>,
}

impl History {
    /// Takes a record, in the order they were stored in; whether the trend changes by it.
    pub fn push(&mut self, record: &Record) -> bool {
        self.last.insert(record.joint.clone(), record.clone());
        self.push_day(record)
    }

    /// Takes a record for its day; whether it is the day's best.
    fn push_day(&mut self, record: &Record) -> bool {
        let (Some(offset_rad), Clock::Utc) = (record.offset(), record.clock) else {
            return false;
        };
        let days = self.days.entry(record.joint.clone()).or_default();
        let stiffness = record.stiffness_ratio.zip(record.stiffness_deviation_ratio);
        let mut day = Day {
            time_utc_s: record.time_utc_s,
            duration_s: record.duration_s,
            offset_rad,
            temperature_c: record.temperature_c,
            stiffness_ratio: stiffness.map(|(mean, deviation)| Gaussian::new(mean, deviation)),
            since: record.baseline.as_deref().map(Arc::from),
        };
        let at = days.partition_point(|d| d.number() < day.number());
        // A tensioning parts a day in two.
        let of_day = days[at..].iter().take_while(|d| d.number() == day.number());
        let same = of_day.clone().position(|d| d.since == day.since);
        if let Some(known) = same.and_then(|i| days.get_mut(at + i)) {
            if known.offset_rad.deviation <= offset_rad.deviation {
                return false;
            }
            std::mem::swap(known, &mut day);
        } else {
            let alike = days.iter().rev().find(|d| d.since == day.since);
            if let Some(since) = alike.and_then(|d| d.since.clone()) {
                day.since = Some(since);
            }
            days.push(day);
        }
        days.sort_by(|a, b| a.time_utc_s.total_cmp(&b.time_utc_s));
        let excess = days.len().saturating_sub(DAYS_MOST);
        days.drain(..excess);
        true
    }

    /// The last record of every tendon.
    pub(super) fn take_last(&mut self) -> BTreeMap<String, Record> {
        std::mem::take(&mut self.last)
    }

    /// Tendons that have rows.
    pub fn joints(&self) -> impl Iterator<Item = &str> {
        self.days.keys().map(String::as_str)
    }

    /// The rows of a tendon's trend, in the order of time.
    pub fn rows(&self, joint: &str) -> Vec<SessionRecord> {
        let days = self.days.get(joint).into_iter().flatten();
        let mut last_utc_s = f64::NEG_INFINITY;
        // A civil clock that stepped may have dated two alike.
        let later = days.filter(|day| {
            let is_later = day.time_utc_s > last_utc_s;
            last_utc_s = last_utc_s.max(day.time_utc_s);
            is_later
        });
        later
            .map(|day| SessionRecord {
                baseline: day.since.as_deref().map(str::to_string),
                time_utc_s: day.time_utc_s,
                duration_s: Some(day.duration_s),
                joint: joint.into(),
                offset_rad: Some(day.offset_rad),
                temperature_c: day.temperature_c,
                stiffness_ratio: day.stiffness_ratio,
                ..SessionRecord::default()
            })
            .collect()
    }
}
