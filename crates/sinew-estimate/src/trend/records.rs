//! Sessions as records: one per joint and session, put in order and freed of repeats.

use super::result::TrendNote;
use serde::{Deserialize, Serialize};
use sinew_files::date::day_of;
use sinew_files::{Located, names};
use sinew_model::Gaussian;
use std::collections::BTreeMap;

/// What one session said about one joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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
    /// Start of the session, s since 1970.
    pub time_utc_s: f64,
    /// Its length, s, where known.
    pub duration_s: Option<f64>,
    /// Joint.
    pub joint: String,
    /// Offset since the baseline; `None`: it couldn't tell.
    pub offset_rad: Option<Gaussian>,
    /// Temperature, °C.
    pub temperature_c: Option<f64>,
    /// Change of stiffness as a fraction of nominal.
    pub stiffness_ratio: Option<Gaussian>,
}

/// Why records were refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// A file that can't be read, or a table with the place of what is wrong.
    #[error(transparent)]
    File(#[from] Located),
    /// A document that can't be.
    #[error("{place}: {why}")]
    Value {
        /// File and line or entry.
        place: String,
        /// What is wrong and what to do.
        why: String,
    },
    /// Records of several robots.
    #[error("{place} is of robot '{found}', not of '{expected}'; a trend is of one robot")]
    Robot {
        /// File and place.
        place: String,
        /// Its robot.
        found: String,
        /// The others'.
        expected: String,
    },
    /// Two sessions at one time that differ.
    #[error(
        "{first} and {second}: two different offsets of '{joint}' at the same time ({date}); keep one"
    )]
    Conflict {
        /// File and place.
        first: String,
        /// File and place.
        second: String,
        /// Joint.
        joint: String,
        /// Day.
        date: String,
    },
    /// A joint the robot doesn't have.
    #[error(
        "{place}: joint '{joint}' has no elastic transmission in the robot's description{hint} it has {known}"
    )]
    Joint {
        /// File and place.
        place: String,
        /// Joint.
        joint: String,
        /// The one that may have been meant, as `; did you mean …?`.
        hint: String,
        /// Joints there are.
        known: String,
    },
    /// Nothing at all.
    #[error(
        "no records; give files written by sinew estimate LOG --baseline FILE --json, or a CSV (sinew trend --help)"
    )]
    Empty,
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

/// Puts records in order, one tendon each.
///
/// - any order of files is fine: the dates decide;
/// - the same session twice counts once; two different offsets of a joint at one time are refused;
/// - sessions that overlap share their motion, so the later is left out;
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
        own.sort_by(|a, b| a.time_utc_s.total_cmp(&b.time_utc_s));
        let mut kept: Vec<SessionRecord> = Vec::with_capacity(own.len());
        for record in own {
            let Some(last) = kept.last() else {
                kept.push(record);
                continue;
            };
            if record.time_utc_s == last.time_utc_s {
                if record.offset_rad != last.offset_rad {
                    return Err(RecordError::Conflict {
                        first: last.source.clone(),
                        second: record.source,
                        joint,
                        date: day_of(record.time_utc_s),
                    });
                }
                twice.push(record.source);
            } else if record.time_utc_s < last.time_utc_s + last.duration_s.unwrap_or(0.0) {
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
