//! Records from files.
//!
//! JSON: what `sinew estimate LOG --baseline FILE --json` prints, one document per session; several
//! documents or a list in one file are fine. Its date is `start_time_utc_s` of the session's estimate
//! or, without it, the recording's own clock; a record without a date is refused.
//!
//! CSV, one line per session and joint, with a header:
//!
//! | column | |
//! |---|---|
//! | `time` | start of the session: `2026-03-01T08:30Z`, `2026-03-01` or seconds since 1970 |
//! | `cycle` | cycle of the machine; beside `time`, or instead of it |
//! | `joint` | joint |
//! | `offset_mrad` | offset since the baseline; empty: the session couldn't tell |
//! | `interval_95_mrad` | half of its 95 % interval |
//! | `temperature_c` | optional, may be empty |
//! | `robot`, `recording`, `baseline`, `duration_s` | optional, may be empty |
//! | `baseline_time`, `reference_temperature_c` | of the baseline; optional, may be empty |
//! | `shared_interval_95_mrad` | part of the interval that every session since the baseline shares; optional |
//! | `drift_interval_95_mrad` | part of it that the zero's drift with temperature leaves; optional |
//! | `stiffness_change_percent`, `stiffness_interval_95_percent` | optional, may be empty |

use super::error::RecordError;
use super::records::{SessionRecord, Sorted, sort};
use rayon::prelude::*;
use serde::Deserialize;
use sinew_files::csv::{Row, Table};
use sinew_files::date::{PLAUSIBLE_S, parse_utc_s};
use sinew_files::{Bound, Fault, Fields as _, WORKS_AT_C, limits, read_text};
use sinew_model::offset::SharedError;
use sinew_model::robot::Robot;
use sinew_model::{Gaussian, Z95};
use std::path::{Path, PathBuf};

/// Reads the records of several files and puts them in order; joints must be elastic ones of the robot.
///
/// Files are read side by side.
///
/// * `cycle_s`: length of a cycle, s, for records that count cycles and have no time.
///
/// # Errors
/// [`RecordError`]; of several files that can't be read, the first's.
pub fn read_sessions(
    files: &[PathBuf],
    robot: Option<&Robot>,
    cycle_s: Option<f64>,
) -> Result<Sorted, RecordError> {
    let read: Vec<_> = files.par_iter().map(|file| read_records(file)).collect();
    let mut records = Vec::new();
    for of_file in read {
        records.extend(of_file?);
    }
    for record in records.iter_mut().filter(|r| r.time_utc_s.is_nan()) {
        let (Some(cycle_s), Some(cycle)) = (cycle_s, record.cycle) else {
            return Err(RecordError::CycleLength {
                place: record.source.clone(),
            });
        };
        record.time_utc_s = cycle * cycle_s;
    }
    sort_of(records, robot)
}

/// Puts records in order; joints must be elastic ones of the robot, where it is known.
///
/// # Errors
/// [`RecordError`].
pub fn sort_of(records: Vec<SessionRecord>, robot: Option<&Robot>) -> Result<Sorted, RecordError> {
    let elastic: Vec<String> = robot.map_or(Vec::new(), |r| {
        (r.tendon_names().into_iter().zip(&r.transmissions))
            .filter(|(_, t)| t.is_some())
            .map(|(n, _)| n)
            .collect()
    });
    sort(
        records,
        robot.map(|r| (r.name.as_str(), elastic.as_slice())),
    )
}

/// Reads the records of a file, CSV by the end of its name, else JSON. Records that count cycles alone have a time that is
/// NaN.
///
/// # Errors
/// [`RecordError`] with file, line or entry, and what to do.
pub fn read_records(path: &Path) -> Result<Vec<SessionRecord>, RecordError> {
    let file = path.display().to_string();
    let text = read_text(path, &limits::SESSIONS)?;
    let csv = path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("csv"));
    if csv {
        records_from_csv(&text, &file)
    } else {
        records_from_json(&text, &file)
    }
}

/// The part of an estimate's document that records are made of.
#[derive(Debug, Deserialize)]
struct EstimateParts {
    session: Option<SessionEstimate>,
    reading: ReadingParts,
}

/// A session's part of the document; `sinew-estimate` writes it.
#[derive(Debug, Deserialize)]
struct SessionEstimate {
    robot: String,
    recording: String,
    baseline: Option<String>,
    #[serde(default)]
    baseline_time_utc_s: Option<f64>,
    start_time_utc_s: Option<f64>,
    duration_s: f64,
    temperature_c: Option<f64>,
    reference_temperature_c: Option<f64>,
    joints: Vec<TendonEstimate>,
}

/// A joint's part of it.
#[derive(Debug, Deserialize)]
struct TendonEstimate {
    name: String,
    offset_rad: Gaussian,
    verdict: Verdict,
    #[serde(default)]
    shared_error: Option<SharedError>,
    stiffness_change_ratio: Gaussian,
}

/// Whether the session determined the offset.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Verdict {
    Longer,
    Shorter,
    Unchanged,
    CannotTell,
}

#[derive(Debug, Deserialize)]
struct ReadingParts {
    recording: RecordingStart,
}

#[derive(Debug, Deserialize)]
struct RecordingStart {
    start_time_ns: Option<i64>,
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
    let is_estimate = document.get("reading").is_some();
    let refuse =
        |e: serde_json::Error| value(place, format!("not a session's estimate: {e}; {MAKE}"));
    let (session, start_ns) = if is_estimate {
        let parts: EstimateParts = serde_json::from_value(document).map_err(refuse)?;
        let session = parts.session.ok_or_else(|| {
            let why = format!("has only the paper's reading, no verdict; {MAKE}");
            value(place, why)
        })?;
        (session, parts.reading.recording.start_time_ns)
    } else {
        let session: SessionEstimate = serde_json::from_value(document).map_err(refuse)?;
        (session, None)
    };
    let time_utc_s = session
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
    for joint in session.joints {
        let place = format!("{place}, joint '{}'", joint.name);
        let (y, i) = (
            1e3 * joint.offset_rad.mean,
            1e3 * joint.offset_rad.half_width_95(),
        );
        let checked = || {
            interval(y, i).map_err(|(key, must)| {
                let found = if key == "offset_mrad" { y } else { i };
                value(&place, format!("{key} = {found}: must be {must}"))
            })?;
            Ok::<_, RecordError>(joint.offset_rad)
        };
        let offset_rad = match joint.verdict {
            Verdict::CannotTell => None,
            _ => Some(checked()?),
        };
        let change = joint.stiffness_change_ratio;
        out.push(SessionRecord {
            shared_error: joint.shared_error.filter(|_| offset_rad.is_some()),
            offset_rad,
            source: place,
            robot: Some(session.robot.clone()),
            recording: Some(session.recording.clone()),
            baseline: session.baseline.clone(),
            baseline_time_utc_s: session.baseline_time_utc_s,
            reference_c: session.reference_temperature_c,
            time_utc_s,
            cycle: None,
            duration_s: Some(session.duration_s).filter(|d| *d >= 0.0),
            joint: joint.name,
            temperature_c: session.temperature_c.filter(|t| t.is_finite()),
            stiffness_ratio: Some(change)
                .filter(|c| c.mean.is_finite() && c.deviation > 0.0 && c.deviation.is_finite()),
        });
    }
    Ok(())
}

/// Reads a CSV table; `file` is its name for messages.
///
/// # Errors
/// [`RecordError::File`] with line and column.
pub fn records_from_csv(text: &str, file: &str) -> Result<Vec<SessionRecord>, RecordError> {
    let table = Table::parse(text, file)?;
    let clock = if table.column("cycle").is_some() && table.column("time").is_none() {
        "cycle"
    } else {
        "time"
    };
    table.need(&[clock, "joint", "offset_mrad", "interval_95_mrad"])?;
    table.rows().map(|row| row_record(&row, file)).collect()
}

fn row_record(row: &Row<'_>, file: &str) -> Result<SessionRecord, RecordError> {
    let number = |column| row.number(column, Bound::Any);
    let cycle = row.number("cycle", Bound::NotNegative)?;
    let time_utc_s = match (row.text("time"), cycle) {
        (None, Some(_)) => f64::NAN,
        _ => date(row, "time", row.need_text("time")?)?,
    };
    let offset_rad = match (number("offset_mrad")?, number("interval_95_mrad")?) {
        (None, _) => None,
        (Some(_), None) => {
            let problem = "interval_95_mrad is empty beside an offset";
            return Err(row.here(Fault::MissingKey, problem).into());
        }
        (Some(y), Some(i)) => {
            Some(interval(y, i).map_err(|(column, must)| row.refuse(column, must))?)
        }
    };
    let stiffness = number("stiffness_change_percent")?
        .zip(number("stiffness_interval_95_percent")?)
        .filter(|(_, i)| *i > 0.0);
    let text = |column: &str| row.text(column).map(str::to_string);
    let baseline_time_utc_s = match row.text("baseline_time") {
        None => None,
        Some(text) => Some(date(row, "baseline_time", text)?),
    };
    Ok(SessionRecord {
        robot: text("robot"),
        recording: text("recording"),
        baseline: text("baseline"),
        baseline_time_utc_s,
        reference_c: celsius(row, "reference_temperature_c")?,
        shared_error: shared_error(row, offset_rad)?,
        time_utc_s,
        cycle,
        duration_s: number("duration_s")?.filter(|d| *d >= 0.0),
        joint: row.need_text("joint")?.to_string(),
        offset_rad,
        temperature_c: celsius(row, "temperature_c")?,
        stiffness_ratio: stiffness.map(|(v, i)| Gaussian::new(0.01 * v, 0.01 * i / Z95)),
        source: format!("{file}, line {}", row.line()),
    })
}

/// A temperature at which a robot can work.
fn celsius(row: &Row<'_>, column: &'static str) -> Result<Option<f64>, RecordError> {
    let [least, most] = WORKS_AT_C;
    match row.number(column, Bound::Any)? {
        Some(c) if !(least..=most).contains(&c) => {
            let must = "-60 to 150 °C, where robots work; subtract 273.15 from kelvin";
            Err(row.refuse(column, must).into())
        }
        celsius => Ok(celsius),
    }
}

/// A date in a column.
fn date(row: &Row<'_>, column: &'static str, text: &str) -> Result<f64, RecordError> {
    parse_utc_s(text).ok_or_else(|| {
        let must = "2026-03-01T08:30Z, 2026-03-01 or seconds since 1970; this is no date";
        row.refuse(column, must).into()
    })
}

/// What of a row's interval other sessions have too.
fn shared_error(
    row: &Row<'_>,
    offset_rad: Option<Gaussian>,
) -> Result<Option<SharedError>, RecordError> {
    let part = |column: &'static str| {
        let half_mrad = row.number(column, Bound::Any)?;
        let most_mrad = offset_rad.map(|y| 1e3 * y.half_width_95());
        // As much as the digits of a table leave open.
        const ROUNDED: f64 = 1.01;
        match (half_mrad, most_mrad) {
            (Some(half), Some(most)) if !(0.0..=ROUNDED * most).contains(&half) => {
                let must = "from 0 to interval_95_mrad, of which it is a part";
                Err(RecordError::from(row.refuse(column, must)))
            }
            (half, _) => Ok(half.map(|half| 1e-3 * half / Z95)),
        }
    };
    let (baseline_rad, drift_rad) = (
        part("shared_interval_95_mrad")?,
        part("drift_interval_95_mrad")?,
    );
    let known = baseline_rad.filter(|_| offset_rad.is_some());
    Ok(known.map(|baseline_rad| SharedError {
        baseline_rad,
        drift_rad: drift_rad.unwrap_or(0.0),
    }))
}

/// An offset, mrad, and half its 95 % interval; else the key of what can't be, and what it must be.
fn interval(offset: f64, interval: f64) -> Result<Gaussian, (&'static str, &'static str)> {
    /// Half a turn, mrad.
    const MOST_MRAD: f64 = 3142.0;
    if !(offset.abs() <= MOST_MRAD) {
        return Err(("offset_mrad", "at most half a turn; is it in mrad?"));
    }
    if !(interval > 0.0 && interval.is_finite()) {
        return Err(("interval_95_mrad", "above 0 mrad"));
    }
    Ok(Gaussian::new(1e-3 * offset, 1e-3 * interval / Z95))
}

fn value(place: &str, why: String) -> RecordError {
    RecordError::Value {
        place: place.into(),
        why,
    }
}
