//! Tables: CSV, or Parquet where the file's name ends so. One set of columns for both.

use super::csv_table::CsvTable;
#[cfg(feature = "parquet")]
use super::parquet_table::ParquetTable;
use super::{Cell, CellKind, Column, is_parquet, refuse};
use crate::error::LogError;
use std::path::{Path, PathBuf};

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
pub struct TableWriter {
    sink: Sink,
    path: PathBuf,
    columns: usize,
}

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
        if !is_parquet(path) {
            return Self::csv(path, columns);
        }
        #[cfg(not(feature = "parquet"))]
        return Err(refuse(
            path,
            "Parquet is written by a build with the feature parquet; name a .csv".into(),
        ));
        #[cfg(feature = "parquet")]
        Self::of(path, columns, |path, columns| {
            ParquetTable::create(path, columns).map(|table| Sink::Parquet(Box::new(table)))
        })
    }

    /// Starts a CSV file, whatever its name.
    pub(super) fn csv(path: &Path, columns: &[Column]) -> Result<Self, LogError> {
        Self::of(path, columns, |path, columns| {
            CsvTable::create(path, columns).map(Sink::Csv)
        })
    }

    fn of(
        path: &Path,
        columns: &[Column],
        create: fn(&Path, &[Column]) -> Result<Sink, LogError>,
    ) -> Result<Self, LogError> {
        let mut names: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
        names.sort_unstable();
        if let Some(twice) = names.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(refuse(path, format!("two columns '{}'", twice[0])));
        }
        Ok(Self {
            sink: create(path, columns)?,
            path: path.to_path_buf(),
            columns: columns.len(),
        })
    }

    /// Appends a row, a cell per column.
    ///
    /// # Errors
    /// Another number of cells, or the system refuses.
    pub fn row(&mut self, cells: &[Cell]) -> Result<(), LogError> {
        if cells.len() != self.columns {
            let (found, columns) = (cells.len(), self.columns);
            let why = format!("a row of {found} cells for {columns} columns");
            return Err(refuse(&self.path, why));
        }
        match &mut self.sink {
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
        match self.sink {
            Sink::Csv(table) => table.finish(),
            #[cfg(feature = "parquet")]
            Sink::Parquet(table) => table.finish(),
        }
    }
}
