//! Builder of machine-readable tables.

use sinew_log::{Cell, CellKind, Table};
use sinew_model::Bounded;

/// Table that is built column by column, with one row per item.
pub(crate) struct Data<T> {
    items: Vec<T>,
    table: Table,
}

impl<T> Data<T> {
    /// Makes a table without columns.
    pub(crate) fn of(items: impl IntoIterator<Item = T>) -> Self {
        let items: Vec<T> = items.into_iter().collect();
        let mut table = Table::new(&[]);
        table.rows.resize(items.len(), Vec::new());
        Self { items, table }
    }

    fn column<C: Into<Cell>>(mut self, name: &str, kind: CellKind, cell: impl Fn(&T) -> C) -> Self {
        self.table.columns.push((name.to_owned(), kind));
        for (row, item) in self.table.rows.iter_mut().zip(&self.items) {
            row.push(cell(item).into());
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

    /// Adds a value and its bounds, one column each.
    pub(crate) fn bounded(self, names: [&str; 3], of: impl Fn(&T) -> Option<Bounded>) -> Self {
        let [value, low, high] = names;
        self.number(value, |x| of(x).map(|x| x.value))
            .number(low, |x| of(x).map(|x| x.low))
            .number(high, |x| of(x).map(|x| x.high))
    }

    /// Returns the table.
    pub(crate) fn table(self) -> Table {
        self.table
    }
}
