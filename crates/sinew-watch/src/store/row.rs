//! A record as a row, and a row as a record.

use rusqlite::types::{ToSqlOutput, Value};
use rusqlite::{Row, ToSql};
use sinew_watch_core::Record;
use sinew_watch_core::record::{Clock, NoOffset};

pub use sinew_watch_core::table::COLUMNS;

/// A word that a typed value is stored as: the one it has in JSON.
pub(super) fn word<T: serde::Serialize>(value: &T) -> String {
    match serde_json::to_value(value) {
        Ok(serde_json::Value::String(word)) => word,
        _ => String::new(),
    }
}

fn typed<T: serde::de::DeserializeOwned>(word: String) -> Option<T> {
    serde_json::from_value(serde_json::Value::String(word)).ok()
}

/// A cell.
pub(super) enum Cell<'r> {
    Text(&'r str),
    Word(String),
    Number(f64),
    Count(u64),
    Flag(bool),
    Nothing,
}

impl ToSql for Cell<'_> {
    fn to_sql(&self) -> rusqlite::Result<ToSqlOutput<'_>> {
        Ok(match self {
            Self::Text(text) => (*text).into(),
            Self::Word(word) => word.as_str().into(),
            Self::Number(x) if x.is_finite() => (*x).into(),
            Self::Number(_) | Self::Nothing => ToSqlOutput::Owned(Value::Null),
            Self::Count(n) => i64::try_from(*n).unwrap_or(i64::MAX).into(),
            Self::Flag(flag) => i64::from(*flag).into(),
        })
    }
}

fn maybe(value: Option<f64>) -> Cell<'static> {
    value.map_or(Cell::Nothing, Cell::Number)
}

/// A number that every record has.
fn finite(value: f64) -> Cell<'static> {
    Cell::Number(if value.is_finite() { value } else { 0.0 })
}

/// The cells of a record, one per [`COLUMNS`].
pub(super) fn cells(record: &Record) -> [Cell<'_>; COLUMNS.len()] {
    [
        Cell::Text(&record.robot),
        Cell::Text(&record.robot_type),
        Cell::Text(&record.joint),
        finite(record.time_utc_s),
        finite(record.duration_s),
        maybe(record.offset_rad),
        maybe(record.offset_deviation_rad),
        maybe(record.elongation_m),
        maybe(record.elongation_deviation_m),
        maybe(record.strain_ratio),
        maybe(record.strain_deviation_ratio),
        maybe(record.temperature_c),
        maybe(record.stiffness_ratio),
        maybe(record.stiffness_deviation_ratio),
        record.baseline.as_deref().map_or(Cell::Nothing, Cell::Text),
        Cell::Text(&record.source),
        Cell::Word(word(&record.clock)),
        Cell::Flag(record.in_doubt),
        record
            .reason
            .as_ref()
            .map_or(Cell::Nothing, |r| Cell::Word(word(r))),
        Cell::Count(record.poses),
        Cell::Count(record.frames),
        Cell::Count(record.frames_lost),
        Cell::Text(&record.sinew_version),
    ]
}

/// The record of a row whose columns are [`COLUMNS`].
pub(super) fn record(row: &Row<'_>) -> rusqlite::Result<Record> {
    Ok(Record {
        robot: row.get(0)?,
        robot_type: row.get(1)?,
        joint: row.get(2)?,
        time_utc_s: row.get(3)?,
        duration_s: row.get(4)?,
        offset_rad: row.get(5)?,
        offset_deviation_rad: row.get(6)?,
        elongation_m: row.get(7)?,
        elongation_deviation_m: row.get(8)?,
        strain_ratio: row.get(9)?,
        strain_deviation_ratio: row.get(10)?,
        temperature_c: row.get(11)?,
        stiffness_ratio: row.get(12)?,
        stiffness_deviation_ratio: row.get(13)?,
        baseline: row.get(14)?,
        source: row.get(15)?,
        // A word that a later version of the program wrote: the date is not trusted.
        clock: typed(row.get(16)?).unwrap_or(Clock::Stepped),
        in_doubt: row.get(17)?,
        reason: row
            .get::<_, Option<String>>(18)?
            .map(|w| typed(w).unwrap_or(NoOffset::Refused)),
        poses: count(row, 19)?,
        frames: count(row, 20)?,
        frames_lost: count(row, 21)?,
        sinew_version: row.get(22)?,
    })
}

fn count(row: &Row<'_>, column: usize) -> rusqlite::Result<u64> {
    let n: i64 = row.get(column)?;
    Ok(u64::try_from(n).unwrap_or(0))
}
