//! Delimited text in every common dialect: `,`, `;`, tab or blanks; a decimal comma if the comma does not
//! separate cells; any [`Encoding`](crate::text::Encoding).

use crate::bound::{Bound, unit_of};
use crate::located::{Fault, Fields, Located};
use crate::names;
use ::csv::{ReaderBuilder, StringRecord, Trim};
use std::path::Path;

/// Lines looked at where a table may begin with names and values above its header.
const LOOK_LINES: usize = 40;

/// How cells are parted and numbers written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Dialect {
    /// Separator of the cells; a space stands for any run of spaces and tabs.
    pub delimiter: u8,
    /// Whether a comma may be a decimal sign.
    pub decimal_comma: bool,
    /// Whether a point separates thousands, as in `1.099,8`.
    pub thousands_point: bool,
}

impl Dialect {
    /// Cells separated by any run of spaces and tabs.
    pub const BLANKS: Self = Self {
        delimiter: b' ',
        decimal_comma: true,
        thousands_point: false,
    };

    /// Whether blanks separate the cells.
    pub fn has_blanks(self) -> bool {
        self.delimiter == Self::BLANKS.delimiter
    }

    fn of_delimiter(delimiter: u8) -> Self {
        Self {
            delimiter,
            decimal_comma: delimiter != b',',
            thousands_point: false,
        }
    }

    /// The dialect with [`thousands_point`](Self::thousands_point) where a cell of the text has a point before a
    /// decimal comma. A cell `1.099` is then 1099.
    pub fn with_thousands(self, text: &str) -> Self {
        let is_grouped = |cell: &str| {
            let cell = cell.trim().trim_matches('"');
            cell.contains(',') && ungrouped(cell, ',', &['.']).is_some()
        };
        let separator = char::from(self.delimiter);
        let mut cells = text.split([separator, '\t', '\n', '\r']);
        Self {
            thousands_point: self.decimal_comma && cells.any(is_grouped),
            ..self
        }
    }

    /// Dialect of a table that begins with its header: the delimiter that occurs most often in it
    /// outside quotes, a comma when none does. No comma in a header is a decimal sign.
    pub fn of_header(header: &[u8]) -> Self {
        let mut best = (b',', count(header, b','));
        for delimiter in [b';', b'\t'] {
            let found = count(header, delimiter);
            if found > best.1 {
                best = (delimiter, found);
            }
        }
        Self::of_delimiter(best.0)
    }

    /// Dialect of a table somewhere in a text: the delimiter that occurs in most of the first lines.
    ///
    /// By the median over lines: names and values above a header have fewer. A tab or a semicolon
    /// wins over any number of commas, which may then be decimal signs.
    pub fn of_lines(text: &str) -> Self {
        // A line that begins with a semicolon may be a comment.
        let solid = |line: &&str| !line.trim().is_empty() && !line.starts_with(';');
        let are_solid = text.lines().any(|line| solid(&line));
        let median = |delimiter: u8| {
            let is_counted = |line: &&str| solid(line) || !are_solid && !line.trim().is_empty();
            let lines = text.lines().filter(is_counted).take(LOOK_LINES);
            let mut counts: Vec<usize> = lines.map(|l| count(l.as_bytes(), delimiter)).collect();
            counts.sort_unstable();
            counts.get(counts.len() / 2).copied().unwrap_or(0)
        };
        let (tabs, semicolons) = (median(b'\t'), median(b';'));
        let dialect = Self::of_delimiter(match (tabs, semicolons) {
            (0, 0) => b',',
            _ if semicolons > tabs => b';',
            _ => b'\t',
        });
        dialect.with_thousands(text)
    }

    /// Parses a cell as a number: `None` if it is not a number, `Some(None)` if it is empty.
    ///
    /// Accepts the spellings of common programs: `nan`, `inf`, `1e-3`, words for a missing value (NaN), and a decimal
    /// comma if the dialect has one.
    #[inline]
    pub fn number(self, cell: &[u8]) -> Option<Option<f64>> {
        let cell = cell.trim_ascii();
        if cell.is_empty() {
            return Some(None);
        }
        let text = std::str::from_utf8(cell).ok()?;
        match text.parse::<f64>() {
            Ok(value) if !self.thousands_point => Some(Some(value)),
            parsed => self.odd_number(text).or(parsed.ok()).map(Some),
        }
    }

    fn odd_number(self, text: &str) -> Option<f64> {
        if self.decimal_comma && text.matches(',').count() == 1 && !text.contains(GROUPS) {
            return text.replace(',', ".").parse().ok();
        }
        let commas = || ungrouped(text, '.', &[',']).filter(|_| text.contains('.'));
        let gaps = || ungrouped(text, '.', &GROUPS[1..]);
        let points = || {
            let is_certain = self.thousands_point || text.contains(',');
            let permitted = self.decimal_comma && (is_certain || text.matches('.').count() > 1);
            ungrouped(text, ',', &GROUPS).filter(|_| permitted)
        };
        if let Some(number) = points().or_else(commas).or_else(gaps) {
            return number.parse().ok();
        }
        matches!(
            text.to_ascii_lowercase().as_str(),
            "na" | "n/a" | "null" | "none" | "-nan" | "nan(ind)" | "-nan(ind)"
        )
        .then_some(f64::NAN)
    }
}

/// Separators of thousands, except the comma.
const GROUPS: [char; 6] = ['.', ' ', '\u{a0}', '\u{202f}', '\'', '’'];

/// Number without its separators of thousands and with a decimal point; `None` if it has no groups of three digits.
fn ungrouped(text: &str, decimal: char, separators: &[char]) -> Option<String> {
    let (whole, fraction) = match text.split_once(decimal) {
        Some((whole, fraction)) => (whole, Some(fraction)),
        None => (text, None),
    };
    let digits = whole.strip_prefix(['-', '+']).unwrap_or(whole);
    let separator = digits.chars().find(|c| separators.contains(c))?;
    let is_digits = |part: &str| part.bytes().all(|b| b.is_ascii_digit());
    let mut groups = digits.split(separator);
    let first = groups.next()?;
    let is_grouped = (1..=3).contains(&first.len())
        && !first.starts_with('0')
        && is_digits(first)
        && groups.all(|group| group.len() == 3 && is_digits(group))
        && fraction.is_none_or(is_digits);
    let plain = || whole.replace(separator, "");
    is_grouped.then(|| match fraction {
        Some(fraction) => format!("{}.{fraction}", plain()),
        None => plain(),
    })
}

/// Whether a line, or the first cell of a row, begins a comment.
#[inline]
pub fn is_comment(start: &[u8]) -> bool {
    matches!(start, [b'#' | b'%', ..] | [b'/', b'/', ..])
}

/// Line of a row: the library counts from before the empty lines that it skips.
fn line_of(row: &StringRecord, text: &str) -> u64 {
    let (byte, line) = row.position().map_or((0, 1), |p| (p.byte(), p.line()));
    let rest = text.bytes().skip(byte as usize);
    let skipped = rest.take_while(|b| matches!(b, b'\n' | b'\r'));
    line + skipped.filter(|b| *b == b'\n').count() as u64
}

/// Counts the delimiters outside quotes.
fn count(line: &[u8], delimiter: u8) -> usize {
    let mut quoted = false;
    line.iter()
        .filter(|byte| {
            quoted ^= **byte == b'"';
            **byte == delimiter && !quoted
        })
        .count()
}

/// A small table with a header, in memory. Lines that begin with `#`, `%` or `//` are comments.
#[derive(Debug)]
pub struct Table {
    file: String,
    dialect: Dialect,
    headers: Vec<String>,
    rows: Vec<(u64, StringRecord)>,
}

impl Table {
    /// Reads a file within its budget.
    ///
    /// # Errors
    /// Returns the errors of [`read_text`](crate::read_text) and [`Table::parse`].
    pub fn read(path: &Path, budget: &crate::Budget) -> Result<Self, Located> {
        let text = crate::read_text(path, budget)?;
        Self::parse(&text, &path.display().to_string())
    }

    /// Reads a text; `file` is its name for messages.
    ///
    /// # Errors
    /// Returns [`Fault::Syntax`] with the line, for a row with more cells than the header has too.
    pub fn parse(text: &str, file: &str) -> Result<Self, Located> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let header = text
            .lines()
            .find(|line| !line.trim().is_empty() && !is_comment(line.as_bytes()));
        let dialect = Dialect::of_header(header.unwrap_or_default().as_bytes());
        let mut reader = ReaderBuilder::new()
            .delimiter(dialect.delimiter)
            .trim(Trim::All)
            .flexible(true)
            .has_headers(false)
            .from_reader(text.as_bytes());
        let mut rows = Vec::new();
        for row in reader.records() {
            let row = row.map_err(|e| Located::new(file, Fault::Syntax, e.to_string()))?;
            if !row.get(0).is_some_and(|cell| is_comment(cell.as_bytes())) {
                rows.push((line_of(&row, text), row));
            }
        }
        if rows.is_empty() {
            let problem = "is empty; it needs a line of column names";
            return Err(Located::new(file, Fault::Syntax, problem));
        }
        let (_, header) = rows.remove(0);
        let headers: Vec<String> = header.iter().map(str::to_owned).collect();
        for (line, row) in &rows {
            if row.iter().skip(headers.len()).any(|cell| !cell.is_empty()) {
                let (found, columns) = (row.len(), headers.len());
                let problem = format!("{found} cells under {columns} columns");
                return Err(Located::new(file, Fault::Syntax, problem)
                    .line(*line)
                    .cure("a decimal comma needs ; or tab between cells"));
            }
        }
        Ok(Self {
            file: file.to_owned(),
            dialect,
            headers,
            rows,
        })
    }

    /// Index of a column by its name, ignoring case.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.headers
            .iter()
            .position(|header| header.eq_ignore_ascii_case(name))
    }

    /// Checks that the table has these columns.
    ///
    /// # Errors
    /// Returns [`Fault::MissingKey`] with the columns needed and found.
    pub fn need(&self, columns: &[&str]) -> Result<(), Located> {
        match columns.iter().find(|name| self.column(name).is_none()) {
            None => Ok(()),
            Some(missing) => {
                let problem = format!("has no column '{missing}'; it needs {}", columns.join(", "));
                let found = names::list(&self.headers);
                Err(Located::new(&self.file, Fault::MissingKey, problem)
                    .cure(format!("columns are {found}")))
            }
        }
    }

    /// Checks that the table has no other columns.
    ///
    /// # Errors
    /// Returns [`Fault::UnknownKey`] with the nearest name and all there are.
    pub fn only(&self, columns: &[&str]) -> Result<(), Located> {
        let permitted = |header: &&String| columns.iter().any(|c| c.eq_ignore_ascii_case(header));
        match self.headers.iter().find(|header| !permitted(header)) {
            None => Ok(()),
            Some(stranger) => {
                let hint = names::hint(stranger, columns);
                let problem = format!("unknown column '{stranger}'{hint} valid columns:");
                let problem = format!("{problem} {}", columns.join(", "));
                Err(Located::new(&self.file, Fault::UnknownKey, problem))
            }
        }
    }

    /// Names of the columns, as written.
    pub fn headers(&self) -> &[String] {
        &self.headers
    }

    /// Iterates over the rows of the table.
    pub fn rows(&self) -> impl Iterator<Item = Row<'_>> {
        self.rows.iter().map(|(line, cells)| Row {
            table: self,
            line: *line,
            cells,
        })
    }
}

/// A row of a [`Table`].
#[derive(Debug, Clone, Copy)]
pub struct Row<'t> {
    table: &'t Table,
    line: u64,
    cells: &'t StringRecord,
}

impl<'t> Row<'t> {
    /// Line, from 1.
    pub fn line(&self) -> u64 {
        self.line
    }

    /// Returns the text of a column, or `None` if the column is missing or the cell empty.
    pub fn text(&self, column: &str) -> Option<&'t str> {
        let cell = self.cells.get(self.table.column(column)?)?;
        (!cell.is_empty()).then_some(cell)
    }

    /// Returns the text of a column.
    ///
    /// # Errors
    /// Returns an error if the cell is empty or missing.
    pub fn need_text(&self, column: &'static str) -> Result<&'t str, Located> {
        self.text(column)
            .ok_or_else(|| self.missing(column, "required in every row"))
    }

    /// The finite number in a column, counted from 0; `None` where the cell is empty or not there.
    ///
    /// # Errors
    /// Returns [`Fault::NotAllowed`] with line, column and cell where it is no finite number.
    pub fn number_at(&self, column: usize) -> Result<Option<f64>, Located> {
        let cell = self.cells.get(column).unwrap_or_default();
        match self.table.dialect.number(cell.as_bytes()) {
            Some(value) if value.is_none_or(f64::is_finite) => Ok(value),
            _ => {
                let header = self.table.headers.get(column).map_or("", String::as_str);
                let located = self.here(Fault::NotAllowed, "is not a finite number");
                let cell = format!("'{}'", names::shorten(cell, 60));
                Err(located.column(header).value(cell))
            }
        }
    }

    /// The text in a column, counted from 0; empty where the cell is not there.
    pub fn text_at(&self, column: usize) -> &'t str {
        self.cells.get(column).unwrap_or_default()
    }

    fn fault(&self, column: &str, cell: &str, problem: &str) -> Located {
        self.here(Fault::NotAllowed, problem)
            .column(column)
            .value(format!("'{}'", names::shorten(cell, 60)))
            .unit(unit_of(column))
    }

    /// A fault of the row.
    pub fn here(&self, fault: Fault, problem: impl Into<String>) -> Located {
        Located::new(&self.table.file, fault, problem).line(self.line)
    }
}

impl Fields for Row<'_> {
    fn number(&self, key: &'static str, bound: Bound) -> Result<Option<f64>, Located> {
        let Some(cell) = self.text(key) else {
            return Ok(None);
        };
        match self.table.dialect.number(cell.as_bytes()) {
            Some(Some(v)) if bound.allows(v) => Ok(Some(v)),
            Some(None) => Ok(None),
            Some(Some(v)) if v.is_finite() => Err(self.invalid(key, &bound.must(unit_of(key)))),
            _ => Err(self
                .fault(key, cell, "is not a finite number")
                .cure("leave it empty where nothing is known")),
        }
    }

    fn invalid(&self, key: &'static str, must: &str) -> Located {
        match self.text(key) {
            None => self.missing(key, must),
            Some(cell) => self.fault(key, cell, &format!("must be {must}")),
        }
    }

    fn missing(&self, key: &'static str, reason: &str) -> Located {
        self.here(Fault::MissingKey, format!("'{key}' is empty: {reason}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_table_in_every_dialect() {
        for text in [
            "a_s,b_mm,c\n1.5,2,x\n# not a row\n,-3,\"y,z\"\n",
            "\u{feff}A_s;b_mm;c\r\n1,5;2;x\r\n% not a row\r\n;-3;y,z\r\n",
            "a_s\tb_mm\tc\n1,5\t2\tx\n// not a row\n\t-3\ty,z\t\n",
        ] {
            let table = Table::parse(text, "t.csv").unwrap();
            let rows: Vec<Row<'_>> = table.rows().collect();
            assert_eq!(rows.len(), 2, "{text}");
            assert_eq!(rows[0].number("a_s", Bound::Any).unwrap(), Some(1.5));
            assert_eq!(rows[1].number("a_s", Bound::Any).unwrap(), None);
            assert_eq!((rows[1].text("c"), rows[1].line()), (Some("y,z"), 4));
            assert_eq!(
                rows[1]
                    .number("b_mm", Bound::Positive)
                    .unwrap_err()
                    .to_string(),
                "t.csv, line 4, column 'b_mm' = '-3' (mm): must be above 0 mm"
            );
            table.need(&["a_s", "b_mm"]).unwrap();
            let error = table.need(&["d"]).unwrap_err().to_string();
            assert!(
                error.contains("no column 'd'") && error.contains("'b_mm'"),
                "{error}"
            );
            let error = table.only(&["a_s", "bb_mm", "c"]).unwrap_err().to_string();
            assert!(error.contains("did you mean 'bb_mm'"), "{error}");
        }
        let error = Table::parse("a,b\n1,5,2\n", "t.csv")
            .unwrap_err()
            .to_string();
        assert!(
            error.contains("line 2") && error.contains("decimal comma"),
            "{error}"
        );
    }

    #[test]
    fn csv_cell_is_number_empty_or_error() {
        let comma = Dialect::of_header(b"a,b");
        let semicolon = Dialect::of_header(b"a;b");
        assert_eq!(comma.number(b"  "), Some(None));
        assert_eq!(comma.number(b" 1.5e-3 "), Some(Some(1.5e-3)));
        assert_eq!(semicolon.number(b"1,5"), Some(Some(1.5)));
        assert_eq!(comma.number(b"1,5"), None);
        assert_eq!(semicolon.number(b"1,500,000"), None);
        assert!(comma.number(b"NaN").flatten().unwrap().is_nan());
        assert_eq!(comma.number(b"-inf"), Some(Some(f64::NEG_INFINITY)));
        assert_eq!(comma.number(b"error"), None);
        // Thousands, where they are certain.
        assert_eq!(semicolon.number(b"1.099,8"), Some(Some(1099.8)));
        assert_eq!(semicolon.number(b"-12.345.678"), Some(Some(-12_345_678.0)));
        assert_eq!(semicolon.number(b"1 099,8"), Some(Some(1099.8)));
        assert_eq!(comma.number(b"1,099.8"), Some(Some(1099.8)));
        assert_eq!(comma.number(b"1'099.8"), Some(Some(1099.8)));
        assert_eq!(comma.number(b"1.099,8"), None);
        assert_eq!(semicolon.number(b"1.09,8"), None);
        assert_eq!(semicolon.number(b"1.099"), Some(Some(1.099)));
        let german = Dialect::of_lines("t;F\n0;1.099,8\n1;1.100\n");
        assert_eq!(german.number(b"1.100"), Some(Some(1100.0)));
        assert_eq!(german.number(b"0.5"), Some(Some(0.5)));
        assert_eq!(german.number(b"0.125"), Some(Some(0.125)));
        assert_eq!(comma.number(b"\xff"), None);
    }

    #[test]
    fn csv_delimiter_detected_below_header_lines() {
        let german = "Probe;A1\nL0;350;mm\n\nZeit;Kraft\ns;N\n0,5;1,5\n1,0;1,5\n";
        assert_eq!(Dialect::of_lines(german).delimiter, b';');
        assert_eq!(Dialect::of_lines("t,f\n1,2\n3,4\n").delimiter, b',');
        assert_eq!(Dialect::of_lines("; a\n; b\nt,f\n1,2\n").delimiter, b',');
        assert_eq!(Dialect::of_lines(";t;f\n;1,5;2\n").delimiter, b';');
        assert_eq!(Dialect::of_lines("t\tf\n1,5\t2,5\n3\t4\n").delimiter, b'\t');
    }
}
