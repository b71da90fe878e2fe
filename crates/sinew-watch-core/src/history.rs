//! Records on which a trend is based: the best one of each day.

use crate::record::{Clock, Record};
use serde::{Deserialize, Serialize};
use sinew_files::date::DAY_S;
use sinew_model::Gaussian;
use sinew_trend::SessionRecord;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Maximum number of days kept per tendon: four years.
const MAX_DAYS: usize = 1461;

/// Best record of a tendon of one day.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Day {
    time_utc_s: f64,
    duration_s: f64,
    offset_rad: Gaussian,
    temperature_c: Option<f64>,
    stiffness_ratio: Option<Gaussian>,
    since: Option<Arc<str>>,
}

/// Number of the day of a time, s since 1970 UTC.
fn day_number(utc_s: f64) -> i64 {
    (utc_s / DAY_S).floor() as i64
}

impl Day {
    fn number(&self) -> i64 {
        day_number(self.time_utc_s)
    }
}

/// Records of a robot that its monitor needs: the last one of each tendon, and of each day the one with the narrowest
/// interval. Errors of the sessions of one day are mostly common; a second one adds little.
///
/// Size: about 100 bytes per day and tendon, for at most four years.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct History {
    days: BTreeMap<String, Vec<Day>>,
    #[serde(skip)]
    last: BTreeMap<String, Record>,
}

impl History {
    /// Adds a record in the order of storage; returns whether it changes the trend.
    pub fn push(&mut self, record: &Record) -> bool {
        self.last.insert(record.joint.clone(), record.clone());
        self.push_day(record)
    }

    /// Adds a record to its day; returns whether it is the best of the day.
    fn push_day(&mut self, record: &Record) -> bool {
        let (Some(offset_rad), Clock::Utc) = (record.offset(), record.clock) else {
            return false;
        };
        let days = self.days.entry(record.joint.clone()).or_default();
        let stiffness = record.stiffness_ratio.zip(record.stiffness_std_ratio);
        let mut day = Day {
            time_utc_s: record.time_utc_s,
            duration_s: record.duration_s,
            offset_rad,
            temperature_c: record.temperature_c,
            stiffness_ratio: stiffness.map(|(mean, std)| Gaussian::new(mean, std)),
            since: record.baseline.as_deref().map(Arc::from),
        };
        let at = days.partition_point(|d| d.number() < day.number());
        // A re-tensioning divides a day into two.
        let of_day = days[at..].iter().take_while(|d| d.number() == day.number());
        let same = of_day.clone().position(|d| d.since == day.since);
        if let Some(stored) = same.and_then(|i| days.get_mut(at + i)) {
            if stored.offset_rad.std <= offset_rad.std {
                return false;
            }
            std::mem::swap(stored, &mut day);
        } else {
            let same_reference = days.iter().rev().find(|d| d.since == day.since);
            if let Some(since) = same_reference.and_then(|d| d.since.clone()) {
                day.since = Some(since);
            }
            days.push(day);
        }
        days.sort_by(|a, b| a.time_utc_s.total_cmp(&b.time_utc_s));
        let excess = days.len().saturating_sub(MAX_DAYS);
        days.drain(..excess);
        true
    }

    /// Returns the rows of the day of a time, s since 1970 UTC, and of later days.
    pub(crate) fn since_day(&self, utc_s: f64) -> Self {
        let is_later = |day: &&Day| day.number() >= day_number(utc_s);
        let days = self.days.iter();
        let days = days.map(|(joint, days)| {
            (
                joint.clone(),
                days.iter().filter(is_later).cloned().collect(),
            )
        });
        Self {
            days: days.collect(),
            last: BTreeMap::new(),
        }
    }

    /// Replaces the rows of the day of a time, s since 1970 UTC, and of later days by those of `day` and `records`.
    pub(crate) fn replace_from(&mut self, utc_s: f64, day: &Self, records: &[Record]) {
        for (joint, days) in &mut self.days {
            days.retain(|day| day.number() < day_number(utc_s));
            days.extend(day.days.get(joint).into_iter().flatten().cloned());
        }
        for record in records {
            self.push(record);
        }
    }

    /// Returns the last record of each tendon.
    pub(crate) fn take_last(&mut self) -> BTreeMap<String, Record> {
        std::mem::take(&mut self.last)
    }

    /// Iterates over the joints that have rows.
    pub fn joints(&self) -> impl Iterator<Item = &str> {
        self.days.keys().map(String::as_str)
    }

    /// Returns the rows of a tendon's trend in chronological order.
    pub fn rows(&self, joint: &str) -> Vec<SessionRecord> {
        let days = self.days.get(joint).into_iter().flatten();
        let mut last_utc_s = f64::NEG_INFINITY;
        // After a step of the civil clock, two records may have the same date.
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
