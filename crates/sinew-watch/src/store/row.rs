//! A record as a row, and a row as a record.

use rusqlite::Row;
use rusqlite::types::Value;
use sinew_log::Cell;
use sinew_watch_core::Record;
use sinew_watch_core::record::{Clock, NoOffset};
use sinew_watch_core::table;

pub use sinew_watch_core::table::COLUMNS;

/// The word that a typed value has in JSON, in the database and in metrics.
pub(crate) fn word<T: serde::Serialize>(value: &T) -> String {
    match serde_json::to_value(value) {
        Ok(serde_json::Value::String(word)) => word,
        _ => String::new(),
    }
}

fn typed<T: serde::de::DeserializeOwned>(word: String) -> Option<T> {
    serde_json::from_value(serde_json::Value::String(word)).ok()
}

/// The values of a record, one per [`COLUMNS`].
pub(super) fn values(record: &Record) -> [Value; COLUMNS.len()] {
    table::row(record).map(|cell| match cell {
        Cell::Number(x) if x.is_finite() => x.into(),
        Cell::Number(_) | Cell::Empty => Value::Null,
        Cell::Integer(n) => n.into(),
        Cell::Text(text) => text.into(),
        Cell::Flag(flag) => flag.into(),
    })
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
