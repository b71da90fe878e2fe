//! Session records from files.
//!
//! JSON: the output of `sinew estimate LOG --baseline FILE --json`, one document per session; one
//! file may contain several documents or a list. The date is `start_time_utc_s` of the session's
//! estimate (see `--date`) or, without it, the clock of the recording; a record without a date is rejected. CSV,
//! one line per session and joint, with a header:
//!
//! | column | |
//! |---|---|
//! | `time` | start of the session: `2026-03-01T08:30Z`, `2026-03-01` or seconds since 1970 |
//! | `cycle` | cycle of the machine; in addition to `time`, or instead of it |
//! | `joint` | name of the joint |
//! | `offset_mrad` | offset since the baseline; empty if the session was inconclusive |
//! | `interval_95_mrad` | half-width of the 95 % interval |
//! | `temperature_c` | optional, may be empty |
//! | `robot`, `recording`, `baseline`, `duration_s` | optional, may be empty |
//! | `baseline_time`, `reference_temperature_c` | of the baseline; optional, may be empty |
//! | `shared_interval_95_mrad` | part of the interval that is common to all sessions since the
//! baseline; optional |
//! | `drift_interval_95_mrad` | part of the interval due to the drift of the zero with temperature;
//! optional |
//! | `stiffness_change_percent`, `stiffness_interval_95_percent` | optional, may be empty |

use super::error::RecordError;
use super::records::{SessionRecord, Sorted, sort};
use rayon::prelude::*;
use serde::Deserialize;
use sinew_files::csv::{Row, Table};
use sinew_files::date::{PLAUSIBLE_S, parse_utc_s};
use sinew_files::{Bound, Budget, Fault, Fields as _, WORKS_AT_C, read_text};
use sinew_model::offset::SharedError;
use sinew_model::robot::Robot;
use sinew_model::{Gaussian, Z95};
use std::path::{Path, PathBuf};

/// Reads the records of several files and sorts them; joints must be elastic ones of the robot.
///
/// Files are read in parallel.
///
/// * `cycle_s`: duration of a cycle, s, for records with cycle counts and without time.
///
/// # Errors
/// Returns a [`RecordError`] if a file is unreadable or invalid; that of the first such file.
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

/// Sorts records; joints must be elastic ones of the robot, if it is specified.
///
/// # Errors
/// Returns a [`RecordError`] as [`sort`] does.
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

/// Reads the records of a file, CSV by file extension, otherwise JSON. The time of records with
/// cycle counts only is NaN.
///
/// # Errors
/// Returns a [`RecordError`] with file, line or entry, and remedy.
pub fn read_records(path: &Path) -> Result<Vec<SessionRecord>, RecordError> {
    let file = path.display().to_string();
    let text = read_text(path, &Budget::TABLE)?;
    let csv = path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("csv"));
    if csv {
        records_from_csv(&text, &file)
    } else {
        records_from_json(&text, &file)
    }
}

/// Part of an estimate's document from which records are created.
#[derive(Debug, Deserialize)]
struct EstimateParts {
    session: Option<SessionEstimate>,
    reading: ReadingParts,
}

/// Session in the document, as `sinew-estimate` writes it.
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

/// Joint of a session.
#[derive(Debug, Deserialize)]
struct TendonEstimate {
    name: String,
    offset_rad: Gaussian,
    verdict: Verdict,
    #[serde(default)]
    #[serde(alias = "shared_error")]
    systematic_error: Option<SharedError>,
    stiffness_change_ratio: Gaussian,
}

/// Verdict of the session on the offset.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Verdict {
    #[serde(alias = "longer")]
    Elongated,
    #[serde(alias = "shorter")]
    Shortened,
    #[serde(alias = "unchanged")]
    NoChangeDetected,
    OffsetDetected,
    NoneDetected,
    #[serde(alias = "cannot-tell")]
    Inconclusive,
    TransmissionLost,
}

#[derive(Debug, Deserialize)]
struct ReadingParts {
    recording: RecordingStart,
}

#[derive(Debug, Deserialize)]
struct RecordingStart {
    start_time_ns: Option<i64>,
}

/// Reads JSON documents; `file` is their name in messages.
///
/// # Errors
/// Returns [`RecordError::Value`] if a document is invalid.
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
    const MAKE: &str = "create records with sinew estimate LOG --baseline FILE --json";
    let is_estimate = document.get("reading").is_some();
    let invalid =
        |e: serde_json::Error| value(place, format!("not a session's estimate: {e}; {MAKE}"));
    let (session, start_ns) = if is_estimate {
        let parts: EstimateParts = serde_json::from_value(document).map_err(invalid)?;
        let session = parts.session.ok_or_else(|| {
            let reason = format!("contains only the uncorrected estimate, no verdict; {MAKE}");
            value(place, reason)
        })?;
        (session, parts.reading.recording.start_time_ns)
    } else {
        let session: SessionEstimate = serde_json::from_value(document).map_err(invalid)?;
        (session, None)
    };
    let time_utc_s = session
        .start_time_utc_s
        .or(start_ns.map(|ns| ns as f64 * 1e-9))
        .filter(|t| PLAUSIBLE_S.contains(t))
        .ok_or_else(|| {
            value(
                place,
                "has no date: start_time_utc_s is missing and the clock of the recording starts at its \
                 own start; repeat sinew estimate with --date 2026-11-29, or write the records as CSV \
                 with a time column"
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
            Verdict::Inconclusive | Verdict::TransmissionLost => None,
            _ => Some(checked()?),
        };
        let change = joint.stiffness_change_ratio;
        out.push(SessionRecord {
            systematic_error: joint.systematic_error.filter(|_| offset_rad.is_some()),
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
                .filter(|c| c.mean.is_finite() && c.std > 0.0 && c.std.is_finite()),
        });
    }
    Ok(())
}

/// Reads a CSV table; `file` is its name in messages.
///
/// # Errors
/// Returns [`RecordError::File`] with line and column if a value is invalid.
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
            let problem = "interval_95_mrad is missing for an offset";
            return Err(row.here(Fault::MissingKey, problem).into());
        }
        (Some(y), Some(i)) => {
            Some(interval(y, i).map_err(|(column, must)| row.invalid(column, must))?)
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
        systematic_error: systematic_error(row, offset_rad)?,
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

/// Temperature within the operating range of robots, °C.
fn celsius(row: &Row<'_>, column: &'static str) -> Result<Option<f64>, RecordError> {
    let [least, most] = WORKS_AT_C;
    match row.number(column, Bound::Any)? {
        Some(c) if !(least..=most).contains(&c) => {
            let must = "-60 to 150 °C, the operating range of robots; subtract 273.15 from kelvin";
            Err(row.invalid(column, must).into())
        }
        celsius => Ok(celsius),
    }
}

/// Date of a column, s since 1970.
fn date(row: &Row<'_>, column: &'static str, text: &str) -> Result<f64, RecordError> {
    parse_utc_s(text).ok_or_else(|| {
        let must = "2026-03-01T08:30Z, 2026-03-01 or seconds since 1970; the date is invalid";
        row.invalid(column, must).into()
    })
}

/// Part of a row's error that is common to other sessions.
fn systematic_error(
    row: &Row<'_>,
    offset_rad: Option<Gaussian>,
) -> Result<Option<SharedError>, RecordError> {
    let part = |column: &'static str| {
        let half_mrad = row.number(column, Bound::Any)?;
        let most_mrad = offset_rad.map(|y| 1e3 * y.half_width_95());
        // Tolerance for rounding in a table.
        const ROUNDED: f64 = 1.01;
        match (half_mrad, most_mrad) {
            (Some(half), Some(most)) if !(0.0..=ROUNDED * most).contains(&half) => {
                let must = "from 0 to interval_95_mrad, of which it is a part";
                Err(RecordError::from(row.invalid(column, must)))
            }
            (half, _) => Ok(half.map(|half| 1e-3 * half / Z95)),
        }
    };
    let (baseline_rad, drift_rad) = (
        part("shared_interval_95_mrad")?,
        part("drift_interval_95_mrad")?,
    );
    let reported = baseline_rad.filter(|_| offset_rad.is_some());
    Ok(reported.map(|baseline_rad| SharedError {
        baseline_rad,
        drift_rad: drift_rad.unwrap_or(0.0),
    }))
}

/// Offset from its value and the half-width of its 95 % interval, mrad; otherwise the invalid key
/// and its allowed range.
fn interval(offset: f64, interval: f64) -> Result<Gaussian, (&'static str, &'static str)> {
    /// Maximum offset, mrad: half a revolution.
    const MAX_OFFSET_MRAD: f64 = 3142.0;
    if !(offset.abs() <= MAX_OFFSET_MRAD) {
        return Err((
            "offset_mrad",
            "at most half a revolution; check that the unit is mrad",
        ));
    }
    if !(interval > 0.0 && interval.is_finite()) {
        return Err(("interval_95_mrad", "above 0 mrad"));
    }
    Ok(Gaussian::new(1e-3 * offset, 1e-3 * interval / Z95))
}

fn value(place: &str, reason: String) -> RecordError {
    RecordError::Value {
        place: place.into(),
        reason,
    }
}
