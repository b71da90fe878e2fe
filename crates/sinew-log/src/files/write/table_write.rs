//! Tables: CSV, or Parquet where the file's name ends so. One set of columns for both.

use super::csv_table::CsvTable;
#[cfg(feature = "parquet")]
use super::parquet_table::ParquetTable;
use super::{Cell, CellKind, Column, refuse};
use crate::error::LogError;
use std::path::Path;

/// A table in memory.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// Its columns.
    pub columns: Vec<Column>,
    /// Its rows, a cell per column.
    pub rows: Vec<Vec<Cell>>,
}

impl Table {
    /// No rows yet.
    pub fn new(columns: &[(&str, CellKind)]) -> Self {
        let named = columns.iter().map(|(name, kind)| ((*name).into(), *kind));
        Self {
            columns: named.collect(),
            rows: Vec::new(),
        }
    }

    /// Adds a row.
    pub fn push(&mut self, row: Vec<Cell>) {
        self.rows.push(row);
    }

    /// Writes it.
    ///
    /// # Errors
    /// [`TableWriter::create`], [`TableWriter::row`].
    pub fn write(&self, path: &Path) -> Result<(), LogError> {
        let mut writer = TableWriter::create(path, &self.columns)?;
        for row in &self.rows {
            writer.row(row)?;
        }
        writer.finish()
    }
}

/// A table on its way into a file: Parquet where the name ends in `.parquet`, else CSV.
///
/// Both have the same columns and the same numbers: CSV writes the shortest text that reads back as
/// the same number. What isn't known is an empty cell in CSV and null in Parquet.
pub struct TableWriter(Sink);

enum Sink {
    Csv(CsvTable),
    #[cfg(feature = "parquet")]
    Parquet(Box<ParquetTable>),
}

impl TableWriter {
    /// Starts the file.
    ///
    /// # Errors
    /// Two columns of one name, Parquet in a build without it, or the system refuses.
    pub fn create(path: &Path, columns: &[Column]) -> Result<Self, LogError> {
        let mut names: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
        names.sort_unstable();
        if let Some(twice) = names.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(refuse(path, format!("two columns '{}'", twice[0])));
        }
        let ending = path.extension().and_then(|ending| ending.to_str());
        if !ending.is_some_and(|ending| ending.eq_ignore_ascii_case("parquet")) {
            return Ok(Self(Sink::Csv(CsvTable::create(path, columns)?)));
        }
        #[cfg(feature = "parquet")]
        return Ok(Self(Sink::Parquet(Box::new(ParquetTable::create(
            path, columns,
        )?))));
        #[cfg(not(feature = "parquet"))]
        Err(refuse(
            path,
            "Parquet is written by a build with the feature parquet; name a .csv".into(),
        ))
    }

    /// Appends a row, a cell per column.
    ///
    /// # Errors
    /// Another number of cells, or the system refuses.
    pub fn row(&mut self, cells: &[Cell]) -> Result<(), LogError> {
        match &mut self.0 {
            Sink::Csv(table) => table.row(cells),
            #[cfg(feature = "parquet")]
            Sink::Parquet(table) => table.row(cells),
        }
    }

    /// Completes the file and gives it its name.
    ///
    /// # Errors
    /// The system refuses; no file is left.
    pub fn finish(self) -> Result<(), LogError> {
        match self.0 {
            Sink::Csv(table) => table.finish(),
            #[cfg(feature = "parquet")]
            Sink::Parquet(table) => table.finish(),
        }
    }
}
