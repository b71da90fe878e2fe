//! Session records: one per joint and session, sorted and without duplicates.

use super::error::RecordError;
use super::result::TrendNote;
use serde::{Deserialize, Serialize};
use sinew_files::date::day_of;
use sinew_files::names;
use sinew_model::Gaussian;
use sinew_model::offset::SharedError;
use std::collections::BTreeMap;

/// Result of one session for one joint.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SessionRecord {
    /// File and location of the record, for messages.
    pub source: String,
    /// Robot, if the record names it.
    pub robot: Option<String>,
    /// Recording the record was estimated from, if stated.
    pub recording: Option<String>,
    /// Baseline the offset refers to, if stated.
    pub baseline: Option<String>,
    /// Time of the baseline, s since 1970, if stated: the offset was zero then.
    #[serde(default)]
    pub baseline_time_utc_s: Option<f64>,
    /// Temperature of the baseline, to which the offset refers, °C, if stated.
    #[serde(default)]
    pub reference_c: Option<f64>,
    /// Start of the session, s since 1970; s since cycle 0 if only cycles are recorded.
    pub time_utc_s: f64,
    /// Cycle of the machine, if recorded.
    #[serde(default)]
    pub cycle: Option<f64>,
    /// Duration of the session, s, if recorded.
    pub duration_s: Option<f64>,
    /// Name of the joint.
    pub joint: String,
    /// Offset since the baseline, rad; `None` if the session was inconclusive.
    pub offset_rad: Option<Gaussian>,
    /// Part of the error that is common to other sessions, rad; `None` if not reported.
    #[serde(default)]
    #[serde(alias = "shared_error")]
    pub systematic_error: Option<SharedError>,
    /// Temperature of the session, °C.
    pub temperature_c: Option<f64>,
    /// Change of stiffness as a fraction of nominal.
    pub stiffness_ratio: Option<Gaussian>,
}

/// Records of every joint in order of time, and notes on them.
#[derive(Debug, Clone, PartialEq)]
pub struct Sorted {
    /// Joints with their records, in the order of the robot or, without one, of names.
    pub joints: Vec<(String, Vec<SessionRecord>)>,
    /// Robot, if any record names it.
    pub robot: Option<String>,
    /// Notes on dropped records.
    pub notes: Vec<TrendNote>,
}

/// Maximum apparent overlap of consecutive sessions, s: start and duration may each be rounded to a
/// second.
const ROUNDED_S: f64 = 2.0;

/// Whether two records belong to different cycles of the machine.
fn cycles_differ(a: &SessionRecord, b: &SessionRecord) -> bool {
    a.cycle.zip(b.cycle).is_some_and(|(a, b)| a != b)
}

/// Whether two records of the same time belong to different sessions with rounded dates.
fn are_two(a: &SessionRecord, b: &SessionRecord) -> bool {
    let named = a.recording.as_ref().zip(b.recording.as_ref());
    cycles_differ(a, b) || named.is_some_and(|(a, b)| a != b)
}

/// Sorts records, one list per tendon.
///
/// - Files may be in any order: the dates decide.
/// - A duplicate session counts once; two different offsets of a joint at one time are an error,
///   unless their recordings or cycles differ, because dates may be rounded.
/// - Of sessions that overlap by more than a rounded date does, the later is rejected, because they
///   share their motion.
/// - Records of two robots, and of joints that the robot lacks, are an error.
/// - An inconclusive session is kept as one without information.
///
/// * `robot_joints`: name and joints of the robot, if specified.
///
/// # Errors
/// Returns a [`RecordError`] for no records, conflicting records, several robots or an unknown
/// joint.
pub fn sort(
    records: Vec<SessionRecord>,
    robot_joints: Option<(&str, &[String])>,
) -> Result<Sorted, RecordError> {
    if records.is_empty() {
        return Err(RecordError::Empty);
    }
    let mut robot = robot_joints.map(|(name, _)| name.to_string());
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
        if let Some((_, joints)) = robot_joints
            && !joints.contains(&record.joint)
        {
            return Err(RecordError::Joint {
                place: record.source,
                hint: names::hint(&record.joint, joints),
                joint: record.joint,
                available: joints.join(", "),
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
    if let Some((_, names)) = robot_joints {
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
