//! A table as CSV.

use super::{Cell, CellKind, Column};
use crate::error::LogError;
use sinew_files::{AtomicFile, csv_cell};
use std::fmt::Write as _;
use std::path::Path;

/// A CSV table being written: comma, decimal point, a header.
pub(super) struct CsvTable {
    file: AtomicFile,
    kinds: Vec<CellKind>,
    line: String,
}

impl CsvTable {
    pub(super) fn create(path: &Path, columns: &[Column]) -> Result<Self, LogError> {
        let mut file = AtomicFile::create(path)?;
        let names: Vec<_> = columns.iter().map(|(name, _)| csv_cell(name)).collect();
        file.append((names.join(",") + "\n").as_bytes())?;
        Ok(Self {
            file,
            kinds: columns.iter().map(|(_, kind)| *kind).collect(),
            line: String::new(),
        })
    }

    pub(super) fn row(&mut self, cells: &[Cell]) -> Result<(), LogError> {
        self.line.clear();
        for (at, (cell, kind)) in cells.iter().zip(&self.kinds).enumerate() {
            if at > 0 {
                self.line.push(',');
            }
            // Writing into a string cannot fail.
            let _ok = match (cell, kind) {
                (Cell::Number(x), CellKind::Number) if x.is_finite() => {
                    write!(self.line, "{x:?}")
                }
                (Cell::Integer(x), CellKind::Integer) => write!(self.line, "{x}"),
                (Cell::Text(x), CellKind::Text) => write!(self.line, "{}", csv_cell(x)),
                (Cell::Flag(x), CellKind::Flag) => write!(self.line, "{x}"),
                _ => Ok(()),
            };
        }
        self.line.push('\n');
        Ok(self.file.append(self.line.as_bytes())?)
    }

    pub(super) fn finish(self) -> Result<(), LogError> {
        Ok(self.file.finish()?)
    }
}
