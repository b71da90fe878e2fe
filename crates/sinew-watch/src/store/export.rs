//! Export of records: CSV or Parquet, and the session table for `sinew trend`.

use super::StoreError;
use super::read::{Reader, RecordQuery};
use super::row::{COLUMNS, record};
use rusqlite::params;
use sinew_log::{Cell as TableCell, CellKind, Column, TableWriter};
use sinew_model::Z95;
use sinew_watch_core::History;
use sinew_watch_core::table::{SCHEMA, row};
use std::path::Path;

/// Records of a robot type and month that are in no file yet.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pending {
    /// Type of the robots.
    pub robot_type: String,
    /// Year and month, such as `2026-11`.
    pub month: String,
    /// Number of the file to write.
    pub number: u32,
    after: i64,
    /// Number of the last record in the file.
    pub(super) last: i64,
}

/// Writes records in chronological order; returns their number.
///
/// # Errors
/// Returns a [`StoreError`] if reading or writing fails; no file remains.
pub fn write_records(reader: &Reader, query: &RecordQuery, path: &Path) -> Result<u64, StoreError> {
    let mut writer = TableWriter::of_schema(path, &SCHEMA)?;
    let count = reader.each_record(query, |record| Ok(writer.row(&row(&record))?))?;
    writer.finish()?;
    Ok(count)
}

/// Columns of a session table: docs/src/reference/sessions.md.
const SESSIONS: [(&str, CellKind); 10] = [
    ("time", CellKind::Number),
    ("joint", CellKind::Text),
    ("offset_mrad", CellKind::Number),
    ("interval_95_mrad", CellKind::Number),
    ("temperature_c", CellKind::Number),
    ("robot", CellKind::Text),
    ("baseline", CellKind::Text),
    ("duration_s", CellKind::Number),
    ("stiffness_change_percent", CellKind::Number),
    ("stiffness_interval_95_percent", CellKind::Number),
];

/// Writes the records of a robot as the table for `sinew trend`: the best record of each day and tendon, on which the
/// trend of the monitor is based; returns their number.
///
/// # Errors
/// Returns a [`StoreError`] if reading or writing fails; no file remains.
pub fn write_sessions(
    reader: &Reader,
    query: &RecordQuery,
    path: &Path,
) -> Result<u64, StoreError> {
    let (mut history, mut robot_type) = (History::default(), String::new());
    reader.each_record(query, |record| {
        history.push(&record);
        robot_type = record.robot_type;
        Ok(())
    })?;
    let columns: Vec<Column> = SESSIONS.map(|(name, kind)| (name.to_owned(), kind)).into();
    let mut writer = TableWriter::create(path, &columns)?;
    let number = |x: Option<f64>| x.map_or(TableCell::Empty, TableCell::Number);
    let text = |of: &str| TableCell::Text(of.to_owned());
    let mut count = 0;
    for joint in history.joints() {
        for row in history.rows(joint) {
            let (offset, stiffness) = (row.offset_rad, row.stiffness_ratio);
            writer.row(&[
                TableCell::Number(row.time_utc_s),
                text(joint),
                number(offset.map(|o| 1e3 * o.mean)),
                number(offset.map(|o| 1e3 * o.half_width_95())),
                number(row.temperature_c),
                text(&robot_type),
                row.baseline.as_deref().map_or(TableCell::Empty, text),
                number(row.duration_s),
                number(stiffness.map(|s| 1e2 * s.mean)),
                number(stiffness.map(|s| 1e2 * Z95 * s.std)),
            ])?;
            count += 1;
        }
    }
    writer.finish()?;
    Ok(count)
}

impl Reader {
    /// Returns the months with records that are in no file yet, by robot type.
    ///
    /// # Errors
    /// Returns a [`StoreError`] if the database cannot be read.
    pub fn not_exported(&self) -> Result<Vec<Pending>, StoreError> {
        let mut statement = self.connection().prepare_cached(
            "WITH of_month AS (
                SELECT robot_type, strftime('%Y-%m', time_utc_s, 'unixepoch') AS month, max(id) AS last
                FROM record GROUP BY 1, 2
             ), written AS (
                SELECT robot_type, month, max(number) AS number, max(last_record) AS last
                FROM exported GROUP BY 1, 2
             )
             SELECT robot_type, month, coalesce(number, 0) + 1, coalesce(written.last, 0), of_month.last
             FROM of_month LEFT JOIN written USING (robot_type, month)
             WHERE month IS NOT NULL AND of_month.last > coalesce(written.last, 0)
             ORDER BY month, robot_type",
        )?;
        let rows = statement.query_map([], |row| {
            Ok(Pending {
                robot_type: row.get(0)?,
                month: row.get(1)?,
                number: row.get(2)?,
                after: row.get(3)?,
                last: row.get(4)?,
            })
        })?;
        Ok(rows.collect::<Result<_, _>>()?)
    }

    /// Writes the records of a month, sorted by robot, joint and time; `bounds` are s since 1970 UTC.
    ///
    /// # Errors
    /// Returns a [`StoreError`] if reading or writing fails; no file remains.
    pub fn write_month(
        &self,
        pending: &Pending,
        [from_utc_s, to_utc_s]: [f64; 2],
        path: &Path,
    ) -> Result<(), StoreError> {
        let folder = sinew_files::folder_of(path);
        std::fs::create_dir_all(folder).map_err(|source| StoreError::Folder {
            folder: folder.into(),
            source,
        })?;
        let mut writer = TableWriter::of_schema(path, &SCHEMA)?;
        let mut statement = self.connection().prepare_cached(&format!(
            "SELECT {} FROM record WHERE robot_type = ?1 AND time_utc_s >= ?2 AND time_utc_s < ?3
             AND id > ?4 AND id <= ?5 ORDER BY robot, joint, time_utc_s",
            COLUMNS.join(", ")
        ))?;
        let values = params![
            pending.robot_type,
            from_utc_s,
            to_utc_s,
            pending.after,
            pending.last
        ];
        let mut rows = statement.query(values)?;
        while let Some(found) = rows.next()? {
            writer.row(&row(&record(found)?))?;
        }
        writer.finish()?;
        Ok(())
    }
}
