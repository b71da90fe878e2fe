//! Table of cells before the interpretation of its columns.

use crate::error::TestFileError;
use sinew_files::Budget;
use sinew_files::csv::Dialect;
use sinew_files::text::{Encoding, decode};

/// Cell of a table as read.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Cell {
    Empty,
    Number(f64),
    /// Time with its own unit, s: a workbook's time of day, a Parquet timestamp.
    #[cfg_attr(not(any(feature = "parquet", feature = "sheets")), allow(dead_code))]
    Clock(f64),
    Text(String),
}

impl Cell {
    /// Cell from text, as a number if it is one.
    pub(super) fn of_text(text: &str, dialect: Dialect) -> Cell {
        match dialect.number(text.as_bytes()) {
            Some(Some(value)) => Cell::Number(value),
            _ if text.trim().is_empty() => Cell::Empty,
            _ => Cell::Text(text.trim().to_owned()),
        }
    }

    pub(super) fn is_text(&self) -> bool {
        matches!(self, Cell::Text(_))
    }

    pub(super) fn is_number(&self) -> bool {
        matches!(self, Cell::Number(_) | Cell::Clock(_))
    }

    /// Whether the cell is a clock time or a date, as a value or as text.
    pub(super) fn is_clock(&self) -> bool {
        match self {
            Cell::Clock(_) => true,
            Cell::Text(text) => sinew_files::date::is_stamp(text),
            Cell::Empty | Cell::Number(_) => false,
        }
    }

    pub(super) fn text(&self) -> String {
        match self {
            Cell::Empty => String::new(),
            Cell::Number(value) | Cell::Clock(value) => format!("{value}"),
            Cell::Text(text) => text.trim().to_owned(),
        }
    }
}

/// Counter of the cells read, with a limit.
pub(super) struct Room<'f> {
    file: &'f str,
    taken: u64,
}

impl<'f> Room<'f> {
    pub(super) fn new(file: &'f str) -> Self {
        Self { file, taken: 0 }
    }

    /// Counts a row, which needs as much memory as some cells.
    pub(super) fn take_row(&mut self) -> Result<(), TestFileError> {
        const AS_CELLS: usize = 4;
        self.take(AS_CELLS)
    }

    /// Counts a text as the cells that need as much memory: compressed formats repeat a long text for few bytes.
    #[cfg(any(test, feature = "parquet", feature = "sheets"))]
    pub(super) fn take_text(&mut self, text: &str) -> Result<(), TestFileError> {
        self.take(text.len() / size_of::<Cell>())
    }

    /// Counts cells against the limit.
    pub(super) fn take(&mut self, cells: usize) -> Result<(), TestFileError> {
        self.taken = self.taken.saturating_add(cells as u64);
        let limit = Budget::TABLE.cells;
        limit.check(self.taken).map_err(|_| {
            let reason = format!("it has more cells; {limit}: remove columns or rows");
            TestFileError::invalid(self.file, reason)
        })
    }
}

/// Rows of cells, each with its location for messages.
#[derive(Debug, Default)]
pub(super) struct Table {
    /// Name of the sheet, or empty.
    pub(super) title: String,
    pub(super) rows: Vec<Vec<Cell>>,
    /// Line (text) or row (workbook, from one) of each row.
    pub(super) places: Vec<u64>,
    /// Notes on repairs while reading.
    pub(super) notes: Vec<String>,
}

impl Table {
    /// Table of cells from delimited text.
    pub(super) fn of_text(bytes: &[u8], file: &str) -> Result<Table, TestFileError> {
        let mut table = Table::default();
        let (text, encoding) = decode(bytes, file)?;
        if encoding == Encoding::Cp1252 {
            let note = "not UTF-8: interpreted as code page 1252 (Latin)";
            table.notes.push(note.to_owned());
        }
        let dialect = Dialect::of_lines(&text);
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(dialect.delimiter)
            .flexible(true)
            .has_headers(false)
            .from_reader(text.as_bytes());
        let mut room = Room::new(file);
        for record in reader.records() {
            let record = record.map_err(|error| {
                TestFileError::invalid(file, format!("it is not delimited text: {error}"))
            })?;
            room.take_row()?;
            room.take(record.len())?;
            let row = record.iter().map(|cell| Cell::of_text(cell, dialect));
            table.rows.push(row.collect());
            let line = record.position().map_or(0, csv::Position::line);
            table.places.push(line);
        }
        Ok(table)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repeated_long_texts_exceed_limit() {
        let text = "x".repeat(1 << 20);
        let mut room = Room::new("a.parquet");
        let most = Budget::TABLE.cells.length() * size_of::<Cell>() / text.len();
        for _ in 0..most {
            room.take_text(&text).expect("within the limit");
        }
        let error = room.take_text(&text).expect_err("beyond the limit");
        assert!(error.to_string().contains("more cells"), "{error}");
    }
}
