//! Tables with rows and columns.

use sinew_files::plain;

/// Table with rows and columns.
#[derive(Debug, Clone, PartialEq, Default, serde::Serialize)]
pub struct Table {
    /// Caption above the table; may be empty.
    pub caption: String,
    /// Heading of each column; a terminal breaks it at its line ends. Empty: a table of names and values.
    pub head: Vec<String>,
    /// Rows of cells, one cell per column. The first cell names the row; the others are right-aligned numbers if the
    /// table has headings.
    pub rows: Vec<Vec<String>>,
    /// Indices of the text columns, which are left-aligned and wrapped.
    pub worded: Vec<usize>,
}

impl Table {
    /// Creates a table with a heading for each column.
    pub fn new(head: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> Self {
        Self {
            head: head.iter().map(ToString::to_string).collect(),
            rows: rows.into_iter().collect(),
            ..Self::default()
        }
    }

    /// Creates a table of names and values.
    pub fn facts<'a>(rows: impl IntoIterator<Item = (&'a str, String)>) -> Self {
        let rows = rows
            .into_iter()
            .map(|(name, value)| vec![name.to_owned(), value]);
        Self::new(&[], rows)
    }

    /// Marks the columns with these headings as text: left-aligned and wrapped. Unknown headings are ignored.
    #[must_use]
    pub fn worded(mut self, headings: &[&str]) -> Self {
        let worded = |name: &String| headings.contains(&name.as_str());
        self.worded = (0..self.head.len())
            .filter(|i| worded(&self.head[*i]))
            .collect();
        self
    }

    /// Sets the caption.
    #[must_use]
    pub fn captioned(mut self, text: impl Into<String>) -> Self {
        self.caption = text.into();
        self
    }
}

/// Builder of a table, column by column, with one row per item.
///
/// ```
/// let table = sinew_figure::Columns::of([("elbow", 1.5), ("wrist", 0.25)])
///     .words("joint", |j| j.0)
///     .column("offset (mrad)", |j| format!("{:.2}", j.1))
///     .table();
/// assert_eq!(table.rows[1], ["wrist", "0.25"]);
/// ```
#[derive(Debug, Clone)]
pub struct Columns<T> {
    things: Vec<T>,
    table: Table,
}

impl<T> Columns<T> {
    /// Creates a table without columns, with one row per item.
    pub fn of(things: impl IntoIterator<Item = T>) -> Self {
        let things: Vec<T> = things.into_iter().collect();
        let mut table = Table::default();
        table.rows.resize(things.len(), Vec::new());
        Self { things, table }
    }

    /// Adds a column of numbers. Terminal control characters are replaced.
    #[must_use]
    pub fn column<C: ToString>(self, head: impl Into<String>, cell: impl Fn(&T) -> C) -> Self {
        self.lines(head, |thing| plain(&cell(thing).to_string()))
    }

    /// Adds a left-aligned text column.
    #[must_use]
    pub fn words<C: ToString>(self, head: impl Into<String>, cell: impl Fn(&T) -> C) -> Self {
        self.column(head, cell).left()
    }

    /// Marks the last column as text.
    #[must_use]
    pub fn left(mut self) -> Self {
        let last = self.table.head.len().checked_sub(1);
        self.table.worded.extend(last);
        self
    }

    /// Adds adjacent columns of numbers.
    #[must_use]
    pub fn columns<const N: usize>(
        mut self,
        heads: [&str; N],
        cells: impl Fn(&T) -> [String; N],
    ) -> Self {
        self.table.head.extend(heads.map(str::to_owned));
        for (row, thing) in self.table.rows.iter_mut().zip(&self.things) {
            row.extend(cells(thing));
        }
        self
    }

    /// Adds a column with multi-line cells; no characters are replaced.
    #[must_use]
    pub fn lines(mut self, head: impl Into<String>, cell: impl Fn(&T) -> String) -> Self {
        self.table.head.push(head.into());
        for (row, thing) in self.table.rows.iter_mut().zip(&self.things) {
            row.push(cell(thing));
        }
        self
    }

    /// Returns the finished table.
    pub fn table(self) -> Table {
        self.table
    }

    /// Returns the finished table with a caption.
    pub fn captioned(self, text: impl Into<String>) -> Table {
        self.table.captioned(text)
    }
}
