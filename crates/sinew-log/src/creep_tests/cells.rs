//! A table before anybody knows what its columns mean.

use sinew_files::csv::Dialect;

/// A cell as found.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Cell {
    Empty,
    Number(f64),
    /// A time that carries its own unit, s: a workbook's time of day, a Parquet timestamp.
    #[cfg_attr(not(any(feature = "parquet", feature = "sheets")), allow(dead_code))]
    Clock(f64),
    Text(String),
}

impl Cell {
    /// A number where it is one.
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

    pub(super) fn text(&self) -> String {
        match self {
            Cell::Empty => String::new(),
            Cell::Number(value) | Cell::Clock(value) => format!("{value}"),
            Cell::Text(text) => text.trim().to_owned(),
        }
    }
}

/// Rows of cells, each with its place for messages.
#[derive(Debug, Default)]
pub(super) struct Table {
    /// Sheet, or empty.
    pub(super) title: String,
    pub(super) rows: Vec<Vec<Cell>>,
    /// Line (text), row (workbook, from one) of each row.
    pub(super) places: Vec<u64>,
    /// What was repaired while reading.
    pub(super) notes: Vec<String>,
}
