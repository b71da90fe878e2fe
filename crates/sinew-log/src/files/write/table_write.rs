//! Tables as CSV, or as Parquet by the extension of the file; the columns are the same.

use super::csv_table::CsvTable;
#[cfg(feature = "parquet")]
use super::parquet_table::ParquetTable;
use super::{Cell, CellKind, Column, TableSchema, is_parquet, write_error};
use crate::error::LogError;
use std::path::{Path, PathBuf};

/// A table in memory.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// Columns of the table.
    pub columns: Vec<Column>,
    /// Rows of the table, one cell per column.
    pub rows: Vec<Vec<Cell>>,
}

impl Table {
    /// Table without rows.
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

/// Writer of a table: Parquet if the name ends in `.parquet`, otherwise CSV.
///
/// Both have the same columns and the same numbers: CSV writes the shortest text that reads back as
/// the same number. A missing value is an empty cell in CSV and null in Parquet. The metadata of a
/// Parquet file state `sinew_version` and, for a table with a schema, `sinew_schema` (its name) and
/// `sinew_columns` (JSON: unit and meaning of each column).
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
        Self::start(path, columns, None)
    }

    /// Starts a file with the columns of a schema, which Parquet states in its metadata.
    ///
    /// # Errors
    /// [`TableWriter::create`].
    pub fn of_schema(path: &Path, schema: &TableSchema<'_>) -> Result<Self, LogError> {
        let columns = schema.columns.iter().map(|c| (c.name.to_owned(), c.kind));
        Self::start(path, &Vec::from_iter(columns), Some(schema))
    }

    #[cfg_attr(not(feature = "parquet"), expect(unused_variables))]
    fn start(
        path: &Path,
        columns: &[Column],
        schema: Option<&TableSchema<'_>>,
    ) -> Result<Self, LogError> {
        if !is_parquet(path) {
            return Self::csv(path, columns);
        }
        #[cfg(not(feature = "parquet"))]
        return Err(write_error(
            path,
            "Parquet is written by a build with the feature parquet; name a .csv".into(),
        ));
        #[cfg(feature = "parquet")]
        Self::of(path, columns, |path, columns| {
            let table = ParquetTable::create(path, columns, schema)?;
            Ok(Sink::Parquet(Box::new(table)))
        })
    }

    /// Creates a CSV file, independent of the file extension.
    pub(super) fn csv(path: &Path, columns: &[Column]) -> Result<Self, LogError> {
        Self::of(path, columns, |path, columns| {
            CsvTable::create(path, columns).map(Sink::Csv)
        })
    }

    fn of(
        path: &Path,
        columns: &[Column],
        create: impl FnOnce(&Path, &[Column]) -> Result<Sink, LogError>,
    ) -> Result<Self, LogError> {
        let mut names: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
        names.sort_unstable();
        if let Some(twice) = names.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(write_error(path, format!("two columns '{}'", twice[0])));
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
    /// Returns [`LogError`] for another number of cells, or an error of the system.
    pub fn row(&mut self, cells: &[Cell]) -> Result<(), LogError> {
        if cells.len() != self.columns {
            let (found, columns) = (cells.len(), self.columns);
            let reason = format!("a row has {found} cells, expected {columns}");
            return Err(write_error(&self.path, reason));
        }
        match &mut self.sink {
            Sink::Csv(table) => table.row(cells),
            #[cfg(feature = "parquet")]
            Sink::Parquet(table) => table.row(cells),
        }
    }

    /// Completes the file and renames it to its final name.
    ///
    /// # Errors
    /// Returns [`LogError`] if the system fails to write; no file remains.
    pub fn finish(self) -> Result<(), LogError> {
        match self.sink {
            Sink::Csv(table) => table.finish(),
            #[cfg(feature = "parquet")]
            Sink::Parquet(table) => table.finish(),
        }
    }
}
