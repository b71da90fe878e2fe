//! Sessions as records: one per joint and session, put in order and freed of repeats.

use super::error::RecordError;
use super::result::TrendNote;
use serde::{Deserialize, Serialize};
use sinew_files::date::day_of;
use sinew_files::names;
use sinew_model::Gaussian;
use sinew_model::offset::SharedError;
use std::collections::BTreeMap;

/// What one session said about one joint.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SessionRecord {
    /// File and place in it, for messages.
    pub source: String,
    /// Robot, where the record names it.
    pub robot: Option<String>,
    /// Recording it was estimated from, where known.
    pub recording: Option<String>,
    /// Baseline it counts from, where known.
    pub baseline: Option<String>,
    /// When that was, s since 1970, where known: the offset was zero then.
    #[serde(default)]
    pub baseline_time_utc_s: Option<f64>,
    /// Temperature the offset refers to, the baseline's, °C, where known.
    #[serde(default)]
    pub reference_c: Option<f64>,
    /// Start of the session, s since 1970; s since cycle 0 where only cycles are known.
    pub time_utc_s: f64,
    /// Cycle of the machine, where it counts them.
    #[serde(default)]
    pub cycle: Option<f64>,
    /// Its length, s, where known.
    pub duration_s: Option<f64>,
    /// Joint.
    pub joint: String,
    /// Offset since the baseline; `None`: it couldn't tell.
    pub offset_rad: Option<Gaussian>,
    /// What of its error other sessions have too; `None`: not known.
    #[serde(default)]
    pub shared_error: Option<SharedError>,
    /// Temperature, °C.
    pub temperature_c: Option<f64>,
    /// Change of stiffness as a fraction of nominal.
    pub stiffness_ratio: Option<Gaussian>,
}

/// Records of every joint in the order of time, and what was done to them.
#[derive(Debug, Clone, PartialEq)]
pub struct Sorted {
    /// Per joint, in the order of the robot or, without one, of names.
    pub joints: Vec<(String, Vec<SessionRecord>)>,
    /// Robot, where any record names it.
    pub robot: Option<String>,
    /// What was dropped.
    pub notes: Vec<TrendNote>,
}

/// Start and length of a session may each be rounded to a second: back to back, two sessions seem to overlap by so much, s.
const ROUNDED_S: f64 = 2.0;

/// Whether two records are of two cycles of the machine.
fn cycles_differ(a: &SessionRecord, b: &SessionRecord) -> bool {
    a.cycle.zip(b.cycle).is_some_and(|(a, b)| a != b)
}

/// Whether two records at one time are surely of two sessions, whose dates were rounded.
fn are_two(a: &SessionRecord, b: &SessionRecord) -> bool {
    let named = a.recording.as_ref().zip(b.recording.as_ref());
    cycles_differ(a, b) || named.is_some_and(|(a, b)| a != b)
}

/// Puts records in order, one tendon each.
///
/// - any order of files is fine: the dates decide;
/// - the same session twice counts once; two different offsets of a joint at one time are refused, unless their
///   recordings or cycles differ: dates may be rounded;
/// - sessions that overlap by more than a rounded date does share their motion, so the later is left out;
/// - records of two robots, and of joints the robot doesn't have, are refused;
/// - a session that couldn't tell stays as one without information.
///
/// * `known`: name and joints of the robot, if there is one.
///
/// # Errors
/// [`RecordError`].
pub fn sort(
    records: Vec<SessionRecord>,
    known: Option<(&str, &[String])>,
) -> Result<Sorted, RecordError> {
    if records.is_empty() {
        return Err(RecordError::Empty);
    }
    let mut robot = known.map(|(name, _)| name.to_string());
    let mut by_joint: BTreeMap<String, Vec<SessionRecord>> = BTreeMap::new();
    for record in records {
        match (&robot, &record.robot) {
            (Some(expected), Some(found)) if expected != found => {
                return Err(RecordError::Robot {
                    place: record.source,
                    found: found.clone(),
                    expected: expected.clone(),
                });
            }
            (None, Some(found)) => robot = Some(found.clone()),
            _ => {}
        }
        if let Some((_, joints)) = known
            && !joints.contains(&record.joint)
        {
            return Err(RecordError::Joint {
                place: record.source,
                hint: names::hint(&record.joint, joints),
                joint: record.joint,
                known: joints.join(", "),
            });
        }
        by_joint
            .entry(record.joint.clone())
            .or_default()
            .push(record);
    }
    let mut out = Sorted {
        joints: Vec::new(),
        robot,
        notes: Vec::new(),
    };
    let (mut twice, mut overlapping) = (Vec::new(), Vec::new());
    for (joint, mut own) in by_joint {
        let cycle = |r: &SessionRecord| r.cycle.unwrap_or(0.0);
        own.sort_by(|a, b| {
            let by_time = a.time_utc_s.total_cmp(&b.time_utc_s);
            by_time.then(cycle(a).total_cmp(&cycle(b)))
        });
        let mut kept: Vec<SessionRecord> = Vec::with_capacity(own.len());
        for record in own {
            let Some(last) = kept.last() else {
                kept.push(record);
                continue;
            };
            let end_utc_s = last.time_utc_s + last.duration_s.unwrap_or(0.0);
            if record.time_utc_s == last.time_utc_s && !are_two(&record, last) {
                if record.offset_rad != last.offset_rad {
                    return Err(RecordError::Conflict {
                        first: last.source.clone(),
                        second: record.source,
                        joint,
                        date: day_of(record.time_utc_s),
                    });
                }
                twice.push(record.source);
            } else if record.time_utc_s < end_utc_s - ROUNDED_S && !cycles_differ(&record, last) {
                overlapping.push(record.source);
            } else {
                kept.push(record);
            }
        }
        out.joints.push((joint, kept));
    }
    if let Some((_, names)) = known {
        let place = |name: &String| names.iter().position(|n| n == name);
        out.joints.sort_by_key(|(name, _)| place(name));
    }
    let counted = |mut sources: Vec<String>| {
        sources.dedup();
        let more = sources.len().saturating_sub(1);
        sources.into_iter().next().map(|first| (first, more))
    };
    let repeated = counted(twice).map(|(source, more)| TrendNote::Repeated { source, more });
    let overlapping = counted(overlapping);
    let overlapping = overlapping.map(|(source, more)| TrendNote::Overlapping { source, more });
    out.notes.extend(repeated.into_iter().chain(overlapping));
    Ok(out)
}
