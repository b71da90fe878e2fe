//! Records from files.
//!
//! JSON: what `sinew estimate LOG --baseline FILE --json` prints, one document per session; several
//! documents or a list in one file are fine. Its date is `start_time_utc_s` of the absolute estimate
//! or, without it, the recording's own clock; a record without a date is refused.
//!
//! CSV, one line per session and joint, with a header:
//!
//! | column | |
//! |---|---|
//! | `time` | start of the session: `2026-03-01T08:30Z`, `2026-03-01` or seconds since 1970 |
//! | `joint` | joint |
//! | `offset_mrad` | offset since the baseline; empty: the session couldn't tell |
//! | `interval_95_mrad` | half of its 95 % interval |
//! | `temperature_c` | optional, may be empty |
//! | `robot`, `recording`, `baseline`, `duration_s` | optional, may be empty |
//! | `stiffness_change_percent`, `stiffness_interval_95_percent` | optional, may be empty |

use super::date::{PLAUSIBLE_S, parse_utc_s};
use super::records::{RecordError, SessionRecord};
use serde::Deserialize;
use std::path::Path;

/// Largest file read, bytes: a session of 32 joints takes some ten thousand.
const BYTES_MAX: u64 = 1 << 28;

/// Reads the records of a file, CSV by the end of its name, else JSON.
///
/// # Errors
/// [`RecordError`] with file, line or entry, and what to do.
pub fn read_records(path: &Path) -> Result<Vec<SessionRecord>, RecordError> {
    let file = path.display().to_string();
    let refuse = |why: String| RecordError::Read {
        file: file.clone(),
        why,
    };
    let bytes = std::fs::metadata(path)
        .map_err(|e| refuse(e.to_string()))?
        .len();
    if bytes > BYTES_MAX {
        return Err(refuse(format!(
            "{bytes} bytes are too many for records of sessions"
        )));
    }
    let text = std::fs::read_to_string(path).map_err(|e| refuse(e.to_string()))?;
    let csv = path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("csv"));
    if csv {
        records_from_csv(&text, &file)
    } else {
        records_from_json(&text, &file)
    }
}

#[derive(Debug, Deserialize)]
struct RawEstimate {
    recording: RawRecording,
    robot: Option<RawRobot>,
    absolute: Option<RawAbsolute>,
}

#[derive(Debug, Deserialize)]
struct RawRecording {
    start_time_ns: Option<i64>,
}

#[derive(Debug, Deserialize)]
struct RawRobot {
    name: String,
}

#[derive(Debug, Deserialize)]
struct RawAbsolute {
    recording: Option<String>,
    robot: Option<String>,
    baseline: Option<String>,
    duration_s: Option<f64>,
    start_time_utc_s: Option<f64>,
    temperature_c: Option<f64>,
    joints: Vec<RawJoint>,
}

#[derive(Debug, Deserialize)]
struct RawJoint {
    name: String,
    offset_mrad: Option<f64>,
    interval_95_mrad: Option<f64>,
    verdict: Option<String>,
    stiffness_change_percent: Option<[f64; 2]>,
}

/// Reads JSON documents; `file` is their name for messages.
///
/// # Errors
/// [`RecordError::Value`].
pub fn records_from_json(text: &str, file: &str) -> Result<Vec<SessionRecord>, RecordError> {
    let mut out = Vec::new();
    let mut count = 0;
    for document in serde_json::Deserializer::from_str(text).into_iter::<serde_json::Value>() {
        let document = document.map_err(|e| value(file, format!("not JSON: {e}")))?;
        let list = match document {
            serde_json::Value::Array(list) => list,
            one => vec![one],
        };
        for one in list {
            count += 1;
            let place = if count == 1 {
                file.to_string()
            } else {
                format!("{file}, document {count}")
            };
            document_records(one, &place, &mut out)?;
        }
    }
    if count == 0 {
        return Err(value(file, "is empty".into()));
    }
    Ok(out)
}

fn document_records(
    document: serde_json::Value,
    place: &str,
    out: &mut Vec<SessionRecord>,
) -> Result<(), RecordError> {
    const MAKE: &str = "make records with sinew estimate LOG --baseline FILE --json";
    let is_estimate = document
        .get("recording")
        .is_some_and(serde_json::Value::is_object);
    let refuse =
        |e: serde_json::Error| value(place, format!("not a session's estimate: {e}; {MAKE}"));
    let (absolute, robot, start_ns) = if is_estimate {
        let raw: RawEstimate = serde_json::from_value(document).map_err(refuse)?;
        let Some(absolute) = raw.absolute else {
            return Err(value(
                place,
                format!("has no absolute estimate, only differences; {MAKE}"),
            ));
        };
        (
            absolute,
            raw.robot.map(|r| r.name),
            raw.recording.start_time_ns,
        )
    } else {
        (
            serde_json::from_value::<RawAbsolute>(document).map_err(refuse)?,
            None,
            None,
        )
    };
    let time_utc_s = absolute
        .start_time_utc_s
        .or(start_ns.map(|ns| ns as f64 * 1e-9))
        .filter(|t| PLAUSIBLE_S.contains(t))
        .ok_or_else(|| {
            value(
                place,
                "says no date: start_time_utc_s is missing and the recording's clock counts from its \
                 own start; write the records as CSV with a time column"
                    .into(),
            )
        })?;
    for joint in absolute.joints {
        let place = format!("{place}, joint '{}'", joint.name);
        let told = joint.verdict.as_deref() != Some("can't tell");
        let offset = told
            .then_some(joint.offset_mrad.zip(joint.interval_95_mrad))
            .flatten();
        out.push(SessionRecord {
            offset_mrad: offset.map(|(y, i)| interval(y, i, &place)).transpose()?,
            source: place,
            robot: absolute.robot.clone().or(robot.clone()),
            recording: absolute.recording.clone(),
            baseline: absolute.baseline.clone(),
            time_utc_s,
            duration_s: absolute.duration_s.filter(|d| *d >= 0.0),
            joint: joint.name,
            temperature_c: absolute.temperature_c.filter(|t| t.is_finite()),
            stiffness_percent: joint
                .stiffness_change_percent
                .filter(|[v, i]| v.is_finite() && *i > 0.0 && i.is_finite()),
        });
    }
    Ok(())
}

/// Reads a CSV table; `file` is its name for messages.
///
/// # Errors
/// [`RecordError::Value`] with the line.
pub fn records_from_csv(text: &str, file: &str) -> Result<Vec<SessionRecord>, RecordError> {
    const NEEDED: [&str; 4] = ["time", "joint", "offset_mrad", "interval_95_mrad"];
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        .flexible(true)
        .from_reader(text.as_bytes());
    let head = reader
        .headers()
        .map_err(|e| value(file, e.to_string()))?
        .clone();
    let column = |name: &str| {
        head.iter()
            .position(|h| h.trim_start_matches('\u{feff}').eq_ignore_ascii_case(name))
    };
    if let Some(missing) = NEEDED.iter().find(|n| column(n).is_none()) {
        return Err(value(
            file,
            format!("has no column '{missing}'; it needs {}", NEEDED.join(", ")),
        ));
    }
    let mut out = Vec::new();
    for row in reader.records() {
        let row = row.map_err(|e| value(file, e.to_string()))?;
        let line = row.position().map_or(0, csv::Position::line);
        let cell = |name: &str| {
            column(name)
                .and_then(|i| row.get(i))
                .filter(|text| !text.is_empty())
        };
        out.push(row_record(&cell, format!("{file}, line {line}"))?);
    }
    Ok(out)
}

/// One line; `cell` finds what stands in a column, if anything does.
fn row_record<'a>(
    cell: &dyn Fn(&str) -> Option<&'a str>,
    place: String,
) -> Result<SessionRecord, RecordError> {
    let number = |name: &str| number(cell(name), name, &place);
    let need = |name: &str| cell(name).ok_or_else(|| value(&place, format!("'{name}' is empty")));
    let time = need("time")?;
    let time_utc_s = parse_utc_s(time).ok_or_else(|| {
        value(
            &place,
            format!(
                "time '{time}' is no date; write such as 2026-03-01T08:30Z or seconds since 1970"
            ),
        )
    })?;
    let offset_mrad = match (number("offset_mrad")?, number("interval_95_mrad")?) {
        (None, _) => None,
        (Some(_), None) => {
            return Err(value(
                &place,
                "interval_95_mrad is empty beside an offset".into(),
            ));
        }
        (Some(y), Some(i)) => Some(interval(y, i, &place)?),
    };
    let stiffness = number("stiffness_change_percent")?
        .zip(number("stiffness_interval_95_percent")?)
        .filter(|(_, i)| *i > 0.0);
    let text = |name: &str| cell(name).map(str::to_string);
    Ok(SessionRecord {
        robot: text("robot"),
        recording: text("recording"),
        baseline: text("baseline"),
        time_utc_s,
        duration_s: number("duration_s")?.filter(|d| *d >= 0.0),
        joint: need("joint")?.to_string(),
        offset_mrad,
        temperature_c: number("temperature_c")?,
        stiffness_percent: stiffness.map(|(v, i)| [v, i]),
        source: place.clone(),
    })
}

fn number(cell: Option<&str>, name: &str, place: &str) -> Result<Option<f64>, RecordError> {
    cell.map(|text| {
        text.parse::<f64>()
            .ok()
            .filter(|v| v.is_finite())
            .ok_or_else(|| {
                value(
                    place,
                    format!("{name} = '{text}' is not a finite number; leave it empty where nothing is known"),
                )
            })
    })
    .transpose()
}

/// An offset that can be one.
fn interval(offset: f64, interval: f64, place: &str) -> Result<[f64; 2], RecordError> {
    /// Half a turn, mrad.
    const MOST_MRAD: f64 = 3142.0;
    if !(offset.abs() <= MOST_MRAD) {
        return Err(value(
            place,
            format!("offset_mrad = {offset} is more than half a turn; is it in mrad?"),
        ));
    }
    if !(interval > 0.0 && interval.is_finite()) {
        return Err(value(
            place,
            format!("interval_95_mrad = {interval} must be above 0 mrad"),
        ));
    }
    Ok([offset, interval])
}

fn value(place: &str, why: String) -> RecordError {
    RecordError::Value {
        place: place.into(),
        why,
    }
}
