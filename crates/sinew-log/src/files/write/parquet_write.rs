//! Recordings as Parquet.

use super::FrameWriter;
use super::csv_write::{check_lengths, value_columns};
use super::{Cell, CellKind, Column, TableWriter, refuse};
use crate::error::LogError;
use crate::frame::{Frame, Quantities};
use std::path::{Path, PathBuf};

/// Writes frames as Parquet: `time_ns`, then the columns of [`CsvWriter`](super::CsvWriter); NaN is null.
pub struct ParquetWriter {
    table: TableWriter,
    path: PathBuf,
    joints: usize,
    quantities: Quantities,
    row: Vec<Cell>,
}

impl ParquetWriter {
    /// Creates the file, whose name ends in `.parquet`.
    ///
    /// # Errors
    /// No joints, another ending, a build without Parquet, or the system refuses.
    pub fn create(
        path: &Path,
        joints: &[String],
        quantities: Quantities,
    ) -> Result<Self, LogError> {
        let is_parquet = path
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("parquet"));
        if joints.is_empty() || !is_parquet {
            let why = "a recording as Parquet needs a joint and a name that ends in .parquet";
            return Err(refuse(path, why.into()));
        }
        let mut columns: Vec<Column> = vec![("time_ns".into(), CellKind::Integer)];
        let values = value_columns(joints, quantities).into_iter();
        columns.extend(values.map(|name| (name, CellKind::Number)));
        Ok(Self {
            table: TableWriter::create(path, &columns)?,
            path: path.to_path_buf(),
            joints: joints.len(),
            quantities,
            row: Vec::with_capacity(columns.len()),
        })
    }
}

impl FrameWriter for ParquetWriter {
    fn write(&mut self, frame: &Frame) -> Result<(), LogError> {
        check_lengths(frame, self.joints, &self.path)?;
        self.row.clear();
        self.row.push(frame.time_ns.into());
        for quantity in self.quantities.iter() {
            self.row
                .extend(frame.get(quantity).iter().map(|x| Cell::Number(*x)));
        }
        self.table.row(&self.row)
    }

    fn finish(self: Box<Self>) -> Result<(), LogError> {
        self.table.finish()
    }
}
