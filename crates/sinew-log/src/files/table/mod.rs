//! Tables: one row is one instant, columns are named signals.

mod columns;
mod csv_read;
mod decimal;
#[cfg(feature = "parquet")]
mod parquet_read;

pub(super) use csv_read::CsvReader;
#[cfg(feature = "parquet")]
pub(super) use parquet_read::ParquetReader;

use super::reader::Reader;
use super::recording::{Format, Progress};
use crate::assemble::Joiner;
use crate::error::LogError;
use crate::frame::{ABSENT, BLOCKS, Channels};
use crate::health::Health;
use crate::options::OpenOptions;
use columns::Columns;

/// What the next row of a table is.
enum Row {
    /// Its time, ns; its cells are filled in.
    At(i64),
    /// Lost, or without a time.
    Skipped,
    /// There is none.
    End,
}

/// A format that holds rows.
trait Rows: Send {
    const FORMAT: Format;

    /// Reads the used cells of a row; `last_ns` is the time of the last good one.
    fn next(
        &mut self,
        columns: &Columns,
        cells: &mut [f64],
        last_ns: Option<i64>,
        health: &mut Health,
    ) -> Result<Row, LogError>;

    fn progress(&self) -> Progress;
}

/// Rows and what their columns mean.
pub(super) struct Table<R> {
    rows: R,
    columns: Columns,
    cells: Vec<f64>,
    wide: Vec<f64>,
    last_ns: Option<i64>,
}

impl<R> Table<R> {
    fn new(rows: R, columns: Columns) -> Self {
        let mut table = Table {
            rows,
            columns,
            cells: Vec::new(),
            wide: Vec::new(),
            last_ns: None,
        };
        table.resize(table.columns.found().0.len());
        table
    }

    fn resize(&mut self, joints: usize) {
        self.cells = vec![ABSENT; self.columns.used.len()];
        self.wide = vec![ABSENT; BLOCKS * joints];
    }
}

impl<R: Rows> Reader for Table<R> {
    fn format(&self) -> Format {
        R::FORMAT
    }

    fn found(&self) -> (Vec<String>, Channels) {
        self.columns.found()
    }

    fn select(&mut self, joints: &[String]) {
        self.columns.select(joints);
        self.resize(joints.len());
    }

    fn joiner(&self, joints: &[String], options: &OpenOptions) -> Joiner {
        self.columns.joiner(joints, options)
    }

    fn pull(&mut self, joiner: &mut Joiner, health: &mut Health) -> Result<bool, LogError> {
        let cells = &mut self.cells;
        match (self.rows).next(&self.columns, cells, self.last_ns, health)? {
            Row::At(time_ns) => {
                self.last_ns = Some(time_ns);
                self.columns.row(cells, &mut self.wide);
                let wide = &self.wide;
                (joiner.primary).insert(time_ns, |slot| slot.copy_from_slice(wide));
                Ok(true)
            }
            Row::Skipped => Ok(true),
            Row::End => Ok(false),
        }
    }

    fn progress(&self) -> Progress {
        self.rows.progress()
    }
}
