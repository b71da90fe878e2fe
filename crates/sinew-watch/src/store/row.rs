//! Conversion between records and rows of the database.

use rusqlite::Row;
use rusqlite::types::Value;
use sinew_log::Cell;
use sinew_watch_core::Record;
use sinew_watch_core::record::{Clock, NoOffset};
use sinew_watch_core::table;

pub use sinew_watch_core::table::COLUMNS;

/// Returns the word of an enumeration value in JSON, in the database and in metrics.
pub(crate) fn word<T: serde::Serialize>(value: &T) -> String {
    match serde_json::to_value(value) {
        Ok(serde_json::Value::String(word)) => word,
        _ => String::new(),
    }
}

fn typed<T: serde::de::DeserializeOwned>(word: String) -> Option<T> {
    serde_json::from_value(serde_json::Value::String(word)).ok()
}

/// Returns the values of a record, one per column of [`COLUMNS`].
pub(super) fn values(record: &Record) -> [Value; COLUMNS.len()] {
    table::row(record).map(|cell| match cell {
        Cell::Number(x) if x.is_finite() => x.into(),
        Cell::Number(_) | Cell::Empty => Value::Null,
        Cell::Integer(n) => n.into(),
        Cell::Text(text) => text.into(),
        Cell::Flag(flag) => flag.into(),
    })
}

/// Returns the record of a row with the columns [`COLUMNS`].
pub(super) fn record(row: &Row<'_>) -> rusqlite::Result<Record> {
    Ok(Record {
        robot: row.get(0)?,
        robot_type: row.get(1)?,
        joint: row.get(2)?,
        time_utc_s: row.get(3)?,
        duration_s: row.get(4)?,
        offset_rad: row.get(5)?,
        offset_std_rad: row.get(6)?,
        elongation_m: row.get(7)?,
        elongation_std_m: row.get(8)?,
        strain_ratio: row.get(9)?,
        strain_std_ratio: row.get(10)?,
        temperature_c: row.get(11)?,
        stiffness_ratio: row.get(12)?,
        stiffness_std_ratio: row.get(13)?,
        baseline: row.get(14)?,
        source: row.get(15)?,
        // A word of a later version of the program: the date is not trusted.
        clock: typed(row.get(16)?).unwrap_or(Clock::Stepped),
        provisional: row.get(17)?,
        reason: row
            .get::<_, Option<String>>(18)?
            .map(|w| typed(w).unwrap_or(NoOffset::Rejected)),
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
