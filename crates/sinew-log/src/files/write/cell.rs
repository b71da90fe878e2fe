//! Cells of a table.

/// Type of the cells of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CellKind {
    /// Numbers; NaN is an empty cell.
    Number,
    /// Whole numbers, such as nanoseconds.
    Integer,
    /// Text in UTF-8.
    Text,
    /// True or false.
    Flag,
}

/// Column of a table whose meaning its schema states.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SchemaColumn {
    /// Name, with the unit as its last part.
    pub name: &'static str,
    /// Type of the cells.
    pub kind: CellKind,
    /// Unit; empty for texts, counts and flags, 1 for ratios.
    pub unit: &'static str,
    /// Meaning, as a sentence or part of one.
    pub meaning: &'static str,
}

impl SchemaColumn {
    /// Column of numbers.
    pub const fn number(name: &'static str, unit: &'static str, meaning: &'static str) -> Self {
        Self {
            name,
            kind: CellKind::Number,
            unit,
            meaning,
        }
    }

    /// Column of texts, whole numbers or flags, without a unit.
    pub const fn plain(name: &'static str, kind: CellKind, meaning: &'static str) -> Self {
        Self {
            name,
            kind,
            unit: "",
            meaning,
        }
    }
}

/// Schema of a table: its name with its version, and its columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TableSchema<'a> {
    /// Name and version, such as `sinew-record/2`.
    pub name: &'a str,
    /// Columns in their order.
    pub columns: &'a [SchemaColumn],
}

/// Cell of a table. A cell of another kind than its column is written as empty.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// Cell without a value.
    Empty,
    /// Number; a non-finite one is written as empty.
    Number(f64),
    /// A whole number.
    Integer(i64),
    /// Text in UTF-8.
    Text(String),
    /// True or false.
    Flag(bool),
}

impl From<f64> for Cell {
    fn from(value: f64) -> Self {
        Self::Number(value)
    }
}

impl From<i64> for Cell {
    fn from(value: i64) -> Self {
        Self::Integer(value)
    }
}

impl From<usize> for Cell {
    fn from(value: usize) -> Self {
        i64::try_from(value).map_or(Self::Empty, Self::Integer)
    }
}

impl From<bool> for Cell {
    fn from(value: bool) -> Self {
        Self::Flag(value)
    }
}

impl From<&str> for Cell {
    fn from(value: &str) -> Self {
        Self::Text(value.into())
    }
}

impl From<String> for Cell {
    fn from(value: String) -> Self {
        Self::Text(value)
    }
}

impl<T: Into<Cell>> From<Option<T>> for Cell {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::Empty, Into::into)
    }
}

/// Name and kind of a column; the name ends in its unit.
pub type Column = (String, CellKind);
