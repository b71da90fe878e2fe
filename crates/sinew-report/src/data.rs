//! Tables for other programs, column by column.

use sinew_log::{Cell, CellKind, Table};
use sinew_model::Bounded;

/// A table that is filled column by column, with a row for each of some things.
pub(crate) struct Data<T> {
    things: Vec<T>,
    table: Table,
}

impl<T> Data<T> {
    /// A table without columns.
    pub(crate) fn of(things: impl IntoIterator<Item = T>) -> Self {
        let things: Vec<T> = things.into_iter().collect();
        let mut table = Table::new(&[]);
        table.rows.resize(things.len(), Vec::new());
        Self { things, table }
    }

    fn column<C: Into<Cell>>(mut self, name: &str, kind: CellKind, cell: impl Fn(&T) -> C) -> Self {
        self.table.columns.push((name.to_owned(), kind));
        for (row, thing) in self.table.rows.iter_mut().zip(&self.things) {
            row.push(cell(thing).into());
        }
        self
    }

    pub(crate) fn text<C: Into<Cell>>(self, name: &str, cell: impl Fn(&T) -> C) -> Self {
        self.column(name, CellKind::Text, cell)
    }

    pub(crate) fn number<C: Into<Cell>>(self, name: &str, cell: impl Fn(&T) -> C) -> Self {
        self.column(name, CellKind::Number, cell)
    }

    pub(crate) fn integer<C: Into<Cell>>(self, name: &str, cell: impl Fn(&T) -> C) -> Self {
        self.column(name, CellKind::Integer, cell)
    }

    pub(crate) fn flag<C: Into<Cell>>(self, name: &str, cell: impl Fn(&T) -> C) -> Self {
        self.column(name, CellKind::Flag, cell)
    }

    /// A value and its bounds, a column each.
    pub(crate) fn bounded(self, names: [&str; 3], of: impl Fn(&T) -> Option<Bounded>) -> Self {
        let [value, low, high] = names;
        self.number(value, |x| of(x).map(|x| x.value))
            .number(low, |x| of(x).map(|x| x.low))
            .number(high, |x| of(x).map(|x| x.high))
    }

    /// The table.
    pub(crate) fn table(self) -> Table {
        self.table
    }
}
