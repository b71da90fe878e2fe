//! Rows and columns.

use sinew_files::plain;

/// Rows and columns.
#[derive(Debug, Clone, PartialEq, Default, serde::Serialize)]
pub struct Table {
    /// Line above; may be empty.
    pub caption: String,
    /// Heading of every column; a terminal breaks it at its line ends. Empty: a table of names and values.
    pub head: Vec<String>,
    /// Cells, one per column. The first of a row names it; the others are numbers to the right
    /// when the table has a head.
    pub rows: Vec<Vec<String>>,
    /// Numbers of the columns of words: they stand to the left and are broken into lines.
    pub worded: Vec<usize>,
}

impl Table {
    /// A table under a heading of every column.
    pub fn new(head: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> Self {
        Self {
            head: head.iter().map(ToString::to_string).collect(),
            rows: rows.into_iter().collect(),
            ..Self::default()
        }
    }

    /// A table of names and values.
    pub fn facts<'a>(rows: impl IntoIterator<Item = (&'a str, String)>) -> Self {
        let rows = rows
            .into_iter()
            .map(|(name, value)| vec![name.to_owned(), value]);
        Self::new(&[], rows)
    }

    /// Columns of these headings hold words: they stand to the left and are broken into lines. A heading that isn't there is none.
    #[must_use]
    pub fn worded(mut self, headings: &[&str]) -> Self {
        let worded = |name: &String| headings.contains(&name.as_str());
        self.worded = (0..self.head.len())
            .filter(|i| worded(&self.head[*i]))
            .collect();
        self
    }

    /// Puts a line above.
    #[must_use]
    pub fn captioned(mut self, text: impl Into<String>) -> Self {
        self.caption = text.into();
        self
    }
}

/// A table that is filled column by column, with a row for each of some things.
///
/// ```
/// let table = sinew_figure::Columns::of([("elbow", 1.5), ("wrist", 0.25)])
///     .words("joint", |j| j.0)
///     .column("offset, mrad", |j| format!("{:.2}", j.1))
///     .table();
/// assert_eq!(table.rows[1], ["wrist", "0.25"]);
/// ```
#[derive(Debug, Clone)]
pub struct Columns<T> {
    things: Vec<T>,
    table: Table,
}

impl<T> Columns<T> {
    /// A table without columns.
    pub fn of(things: impl IntoIterator<Item = T>) -> Self {
        let things: Vec<T> = things.into_iter().collect();
        let mut table = Table::default();
        table.rows.resize(things.len(), Vec::new());
        Self { things, table }
    }

    /// Adds a column of numbers. Characters that a terminal would obey are replaced.
    #[must_use]
    pub fn column<C: ToString>(self, head: impl Into<String>, cell: impl Fn(&T) -> C) -> Self {
        self.lines(head, |thing| plain(&cell(thing).to_string()))
    }

    /// Adds a column of words, which stand to the left.
    #[must_use]
    pub fn words<C: ToString>(self, head: impl Into<String>, cell: impl Fn(&T) -> C) -> Self {
        self.column(head, cell).left()
    }

    /// The last column holds words.
    #[must_use]
    pub fn left(mut self) -> Self {
        let last = self.table.head.len().checked_sub(1);
        self.table.worded.extend(last);
        self
    }

    /// Adds neighbouring columns of numbers.
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

    /// Adds a column whose cells have lines of their own; nothing in them is replaced.
    #[must_use]
    pub fn lines(mut self, head: impl Into<String>, cell: impl Fn(&T) -> String) -> Self {
        self.table.head.push(head.into());
        for (row, thing) in self.table.rows.iter_mut().zip(&self.things) {
            row.push(cell(thing));
        }
        self
    }

    /// The table.
    pub fn table(self) -> Table {
        self.table
    }

    /// The table with a line above.
    pub fn captioned(self, text: impl Into<String>) -> Table {
        self.table.captioned(text)
    }
}
