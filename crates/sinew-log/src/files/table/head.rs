//! Head of delimited text: comments, names and values, the header, units, and exports of a PLC scope.

use super::blanks::{self, Blanks};
use super::columns::{Headers, has_usual_name};
use sinew_files::Budget;
use sinew_files::csv::{Dialect, is_comment};
use sinew_files::date::is_stamp;
use sinew_files::text::Encoding;
use sinew_files::unit::{Dimension, Unit, bare};
use std::io::Read;

/// Lines in which the header is searched.
const LINES: usize = 200;
/// Bytes read at a time.
const PIECE_BYTES: u64 = 64 << 10;

/// Position and form of the header.
#[derive(Debug, PartialEq)]
pub(super) enum Header {
    /// The next row of the text.
    Row,
    /// Names in a comment, or in the block of a scope export.
    Stated(Vec<String>),
    /// No names: the first row holds numbers.
    None,
}

/// Head of a table.
#[derive(Debug)]
pub(super) struct Head {
    pub(super) header: Header,
    pub(super) dialect: Dialect,
    /// First byte of a line without a row.
    pub(super) comment: u8,
    /// Bytes before the header row, or before the first row where no row is the header.
    pub(super) skipped_bytes: u64,
    /// Line of the text at which they end, from 1.
    pub(super) line: u64,
    /// Number of cells of the first row, where no row is the header.
    pub(super) columns: usize,
    /// Units below the header; empty if no row contains them.
    pub(super) units: Vec<String>,
    /// Whether the row after the header contains units.
    pub(super) has_units_row: bool,
    /// Columns whose first cell is a clock time or a date.
    pub(super) clocks: Vec<usize>,
    /// Time columns of further channels, which must agree with the first.
    pub(super) further_times: Vec<usize>,
}

impl Head {
    /// The head with the names of its columns.
    pub(super) fn headers(&self, names: Vec<String>) -> Headers {
        Headers {
            names,
            units: self.units.clone(),
            clocks: self.clocks.clone(),
        }
    }
}

/// Line of the head with its place.
struct Line {
    start: usize,
    number: u64,
    text: String,
}

/// Finds the head of a text that begins with it.
pub(super) fn find(text: impl Read, budget: &Budget) -> std::io::Result<Head> {
    let text = start_of(text, budget.text.length())?;
    let lines = lines_of(&text);
    let is_remark = |line: &Line| is_comment(line.text.as_bytes());
    let joined = |lines: &[&Line]| -> String {
        let texts: Vec<&str> = lines.iter().map(|line| line.text.as_str()).collect();
        texts.join("\n")
    };
    let plain: Vec<&Line> = lines.iter().filter(|line| !is_remark(line)).collect();
    let marked: Vec<&Line> = plain
        .iter()
        .copied()
        .filter(|l| !l.text.starts_with(';'))
        .collect();
    // A line that begins with a semicolon has an empty first cell only where semicolons separate cells.
    let separates = marked.is_empty() || Dialect::of_lines(&joined(&marked)).delimiter == b';';
    let rows = if separates { plain } else { marked };
    let is_row = |line: &Line| rows.iter().any(|row| row.start == line.start);
    let comments: Vec<&Line> = lines.iter().filter(|line| !is_row(line)).collect();
    let comment = comments.first().and_then(|line| line.text.bytes().next());
    let head = |header, dialect: Dialect, at: Option<&&Line>| Head {
        header,
        dialect: dialect.with_thousands(&joined(&rows)),
        comment: comment.unwrap_or(b'#'),
        skipped_bytes: at.map_or(0, |line| line.start as u64),
        line: at.map_or(1, |line| line.number),
        columns: 0,
        units: Vec::new(),
        has_units_row: false,
        clocks: Vec::new(),
        further_times: Vec::new(),
    };
    if let Some(scope) = Scope::find(&rows) {
        let first = rows.get(scope.first_row);
        let header = Header::Stated(scope.names());
        return Ok(Head {
            further_times: (1..scope.channels.len())
                .map(|channel| 2 * channel)
                .collect(),
            units: scope.units(),
            ..head(header, scope.dialect, first)
        });
    }
    let Some(first) = rows.first() else {
        return Ok(head(Header::Row, Dialect::of_header(b""), None));
    };
    let clocks = |row: Option<&&Line>, dialect: Dialect| -> Vec<usize> {
        let row = row.map_or(Vec::new(), |row| cells(&row.text, dialect));
        let stamps = row.iter().enumerate().filter(|(_, cell)| is_stamp(cell));
        stamps.map(|(column, _)| column).collect()
    };
    let of_rows = Dialect::of_lines(&joined(&rows));
    let has_blanks = are_blanks_separators(&rows, of_rows);
    let of_rows = if has_blanks { Dialect::BLANKS } else { of_rows };
    let has_numbers = |line: &&Line| is_numbers(&cells(&line.text, of_rows), of_rows);
    let first = match has_blanks {
        true => rows.iter().find(|line| has_numbers(line)).unwrap_or(first),
        false => first,
    };
    let numbers = cells(&first.text, of_rows);
    if is_numbers(&numbers, of_rows) {
        // Lines directly above: units, and above them the names. Only blanks permit lines that are no comments.
        let above = lines.iter().filter(|line| line.start < first.start);
        let fits = |names: &Vec<String>| names.len() == numbers.len() && is_names(names, of_rows);
        let above: Vec<Vec<String>> = above
            .filter_map(|line| {
                let text = unmarked(&line.text);
                let own = cells(text, Dialect::of_header(text.as_bytes()));
                let by_blanks = || has_blanks.then(|| cells(text, of_rows));
                Some(own)
                    .filter(&fits)
                    .or_else(|| by_blanks().filter(&fits))
            })
            .collect();
        // A sentence may have as many words as the rows have cells.
        let has_usual = |names: &Vec<String>| names.iter().any(|name| has_usual_name(name));
        let last = above.len().checked_sub(1);
        let above_units = last.filter(|last| *last > 0 && is_units(&above[*last]));
        let named = (above.iter().rposition(has_usual))
            .or(above_units.map(|last| last - 1))
            .or(last);
        let below = named.and_then(|named| above.get(named + 1));
        let below = below.filter(|row| is_units(row));
        let header = match named {
            Some(named) => Header::Stated(above[named].clone()),
            None => Header::None,
        };
        return Ok(Head {
            units: below.map_or(Vec::new(), |row| bare_units(row)),
            clocks: clocks(Some(first), of_rows),
            columns: numbers.len(),
            ..head(header, of_rows, Some(first))
        });
    }
    let split = |index: usize| {
        let dialect = rows
            .get(index)
            .map(|row| Dialect::of_header(row.text.as_bytes()));
        let dialect = dialect.unwrap_or(of_rows);
        let row = |index: usize| {
            rows.get(index)
                .map_or(Vec::new(), |row| cells(&row.text, dialect))
        };
        (dialect, [row(index), row(index + 1), row(index + 2)])
    };
    let is_header = |index: &usize| {
        let (dialect, [names, next, after]) = split(*index);
        let fits = |row: &[String]| row.len() == names.len() && holds_numbers(row, dialect);
        is_names(&names, dialect)
            && (names.iter().any(|name| has_usual_name(name))
                || fits(&next)
                || is_units(&next) && fits(&after))
    };
    // Without such a row the first one is the header, and its errors are those of a table.
    let index = (0..rows.len()).find(is_header).unwrap_or(0);
    let (dialect, [_, next, _]) = split(index);
    let has_units_row = is_units(&next);
    let units = match has_units_row {
        true => bare_units(&next),
        false => Vec::new(),
    };
    Ok(Head {
        units,
        has_units_row,
        clocks: clocks(rows.get(index + 1 + usize::from(has_units_row)), dialect),
        ..head(Header::Row, dialect, rows.get(index))
    })
}

/// Reads the first lines, up to the limit; the last one is complete unless the text ends within it.
fn start_of(mut text: impl Read, most: usize) -> std::io::Result<Vec<u8>> {
    let mut start = Vec::new();
    let is_end = |byte: &&u8| matches!(byte, b'\n' | b'\r');
    loop {
        let read = text.by_ref().take(PIECE_BYTES).read_to_end(&mut start)?;
        let ends = start.iter().filter(is_end).count();
        if read == 0 {
            return Ok(start);
        }
        if ends > LINES || start.len() >= most {
            let last = start.iter().rposition(|byte| is_end(&byte));
            start.truncate(last.map_or(start.len(), |last| last + 1));
            return Ok(start);
        }
    }
}

/// Lines that are not empty; old line ends part lines too.
fn lines_of(text: &[u8]) -> Vec<Line> {
    let mut lines = Vec::new();
    let (mut start, mut number) = (0, 1);
    for line in text.split_inclusive(|byte| matches!(byte, b'\n' | b'\r')) {
        let trimmed = line.trim_ascii();
        if !trimmed.is_empty() && lines.len() < LINES {
            let text = Encoding::of(trimmed).0.decode(trimmed);
            lines.push(Line {
                start,
                number,
                text: text.trim().to_owned(),
            });
        }
        start += line.len();
        number += u64::from(line.ends_with(b"\n"));
    }
    lines
}

/// Whether blanks separate the cells of most rows, which a separator does not.
fn are_blanks_separators(rows: &[&Line], of_rows: Dialect) -> bool {
    let by_blanks = |line: &&&Line| {
        let row = cells(&line.text, Dialect::BLANKS);
        let separated = cells(&line.text, of_rows);
        // Blanks separate thousands too, so that a row may be one number.
        let is_separated = separated.len() > 1 && is_numbers(&separated, of_rows);
        row.len() > 1 && is_numbers(&row, Dialect::BLANKS) && !is_separated
    };
    2 * rows.iter().filter(by_blanks).count() >= rows.len()
}

/// Cells of one line.
fn cells(line: &str, dialect: Dialect) -> Vec<String> {
    let (separator, text): (u8, Box<dyn Read + '_>) = match dialect.has_blanks() {
        true => (blanks::SEPARATOR, Box::new(Blanks::new(line.as_bytes()))),
        false => (dialect.delimiter, Box::new(line.as_bytes())),
    };
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(separator)
        .has_headers(false)
        .flexible(true)
        .from_reader(text);
    let row = reader.records().next().and_then(Result::ok);
    let cells = row.iter().flat_map(csv::StringRecord::iter);
    cells.map(|cell| cell.trim().to_owned()).collect()
}

/// Text of a comment without its mark.
fn unmarked(line: &str) -> &str {
    line.trim_start_matches(['#', '%', '/', ';']).trim()
}

fn is_value(cell: &str, dialect: Dialect) -> bool {
    matches!(dialect.number(cell.as_bytes()), Some(Some(_))) || is_stamp(cell)
}

/// Whether a row names something and contains no number.
fn is_names(row: &[String], dialect: Dialect) -> bool {
    row.iter().any(|cell| !cell.is_empty()) && !row.iter().any(|cell| is_value(cell, dialect))
}

/// Whether a row consists of numbers, clock times and gaps.
fn is_numbers(row: &[String], dialect: Dialect) -> bool {
    row.iter().any(|cell| is_value(cell, dialect))
        && row
            .iter()
            .all(|cell| cell.is_empty() || is_value(cell, dialect))
}

/// Whether a row holds at least two numbers, or nothing else.
fn holds_numbers(row: &[String], dialect: Dialect) -> bool {
    let values = row.iter().filter(|cell| is_value(cell, dialect)).count();
    values >= 2 || is_numbers(row, dialect)
}

/// Whether a row contains units, gaps and nothing else.
fn is_units(row: &[String]) -> bool {
    let is_unit = |cell: &&String| Unit::parse(bare(cell), &Dimension::ALL).is_ok();
    let mut units = row.iter().filter(|cell| !bare(cell).is_empty()).peekable();
    // A row of ones is a row of numbers.
    units.peek().is_some()
        && units.all(|cell| is_unit(&cell))
        && row.iter().any(|cell| cell != "1" && !cell.is_empty())
}

fn bare_units(row: &[String]) -> Vec<String> {
    row.iter().map(|cell| bare(cell).to_owned()).collect()
}

/// Block above the rows of a PLC scope export: names of the channels, each with a time column of its own.
struct Scope {
    dialect: Dialect,
    /// Name and unit.
    channels: Vec<(String, String)>,
    /// Index of the first row of values.
    first_row: usize,
}

impl Scope {
    fn find(rows: &[&Line]) -> Option<Self> {
        // The file itself has a name too: the last row of names above the values is that of the channels.
        let mut found = None;
        for (index, line) in rows.iter().enumerate() {
            let dialect = Dialect::of_header(line.text.as_bytes());
            let row = cells(&line.text, dialect);
            if row.first().is_some_and(|cell| cell == "Name") && row.len().is_multiple_of(2) {
                found = Some((index, dialect));
            }
        }
        let (named, dialect) = found?;
        let pairs = |row: &[String]| -> Vec<(String, String)> {
            let pairs = row.chunks_exact(2);
            pairs
                .map(|pair| (pair[0].clone(), pair[1].clone()))
                .collect()
        };
        let names = pairs(&cells(&rows[named].text, dialect));
        if !names
            .iter()
            .all(|(key, name)| key == "Name" && !name.is_empty())
        {
            return None;
        }
        let mut units = Vec::new();
        let mut has_period = false;
        for (index, line) in rows.iter().enumerate().skip(named + 1) {
            let row = cells(&line.text, dialect);
            if is_numbers(&row, dialect) {
                let channels = names.iter().enumerate().map(|(channel, (_, name))| {
                    let unit: Option<&(String, String)> = units.get(channel);
                    (
                        name.clone(),
                        unit.map_or(String::new(), |unit| bare(&unit.1).to_owned()),
                    )
                });
                let fits = row.len() >= 2 * names.len() && has_period;
                return fits.then(|| Self {
                    dialect,
                    channels: channels.collect(),
                    first_row: index,
                });
            }
            match row.first().map(String::as_str) {
                Some("Unit") => units = pairs(&row),
                Some(key) => has_period |= key.starts_with("SampleTime"),
                None => {}
            }
        }
        None
    }

    /// A time column in ms and a column of values for each channel.
    fn names(&self) -> Vec<String> {
        let channels = self.channels.iter().enumerate();
        let pair = channels.map(|(channel, (name, _))| match channel {
            0 => ["time_ms".to_owned(), name.clone()],
            _ => [format!("time_ms of {name}"), name.clone()],
        });
        pair.flatten().collect()
    }

    fn units(&self) -> Vec<String> {
        let channels = self.channels.iter();
        channels
            .flat_map(|(_, unit)| ["ms".to_owned(), unit.clone()])
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn head(text: &str) -> Head {
        find(text.as_bytes(), &Budget::RECORDING).expect("read")
    }

    #[test]
    fn header_is_found_below_comments_and_metadata() {
        for (text, line) in [
            ("t,q\n0,1\n", 1),
            ("# of monday\nt,q\n0,1\n", 2),
            ("% of monday\n// and\nt,q\n0,1\n", 3),
            (
                "robot,head-07\noperator,X\ndate,2024-03-01\n\nt,q,p\n0,1,2\n",
                5,
            ),
            ("Recording of monday\nrate,100\nt,q\n(s),(deg)\n0,1\n", 3),
            ("a;b\n\nZeit;q\n00:00:01;1,5\n", 3),
            ("x,y\nq.a_rad,time_s\n,\n", 2),
            ("t,q\nnot,here\n", 1),
            ("t,q\n", 1),
        ] {
            let head = head(text);
            assert_eq!((head.line, &head.header), (line, &Header::Row), "{text}");
        }
    }

    #[test]
    fn header_in_comment_has_as_many_names_as_rows_have_cells() {
        let names =
            |names: &[&str]| Header::Stated(names.iter().map(|n| (*n).to_owned()).collect());
        for (text, header) in [
            (
                "% rec, of, monday, morning\n% t,q\n0,1\n",
                names(&["t", "q"]),
            ),
            ("# t,q\n# s,rad\n0,1\n", names(&["t", "q"])),
            ("# of monday\n0,1\n", Header::None),
            ("0;1,5\n0,1;2\n", Header::None),
            ("; of monday\n0,1\n", Header::None),
            (";1,5\n0,1;2\n", Header::None),
        ] {
            assert_eq!(head(text).header, header, "{text}");
        }
        assert_eq!(head("# t,q\n# [s],[rad]\n0,1\n").units, ["s", "rad"]);
    }

    #[test]
    fn blanks_separate_rows_without_another_separator() {
        let names =
            |names: &[&str]| Header::Stated(names.iter().map(|n| (*n).to_owned()).collect());
        let named = names(&["t", "q"]);
        for (text, header, columns) in [
            ("# t q\n0 1\n1 2\n", &named, 2),
            ("t q\n0 1\n1 2\n", &named, 2),
            (
                "# time_s q.a_rad\n# of monday\n0 1\n1 2\n",
                &names(&["time_s", "q.a_rad"]),
                2,
            ),
            ("% of monday\nt   q\n[s] [rad]\n0 1\n1 2\n", &named, 2),
            ("0 1634.5 1 2\n1 1634.6 1 2\n", &Header::None, 4),
            // Each row could be one number with separated thousands.
            ("1 100 200\n2 100 200\n", &Header::None, 3),
            ("0,5 1,5\n1,0 2,5\n", &Header::None, 2),
        ] {
            let head = head(text);
            assert_eq!((&head.header, head.columns), (header, columns), "{text}");
            assert_eq!(head.dialect.delimiter, b' ', "{text}");
        }
        // Tabs with spaces next to them are tabs.
        let tabs = head("# t, q\n 0\t 1\n 1\t 2\n");
        assert_eq!((&tabs.header, tabs.columns), (&named, 2));
        for text in [
            "0, 1, 2\n1, 2, 3\n",
            "0;1 000;2\n1;1 001;3\n",
            "t q,p\n0,1\n",
        ] {
            assert_ne!(head(text).dialect.delimiter, b' ', "{text}");
        }
    }

    #[test]
    fn scope_export_gives_channels_with_their_times() {
        let text = "Name\thead\n\nName\ta\tName\tb\nData-Type\tREAL64\tData-Type\tREAL64\nSampleTime[ms]\t10\tSampleTime[ms]\t10\nUnit\tdeg\tUnit\t(deg)\n\n0\t1\t0\t2\n";
        let head = head(text);
        let names = ["time_ms", "a", "time_ms of b", "b"].map(str::to_owned);
        assert_eq!(head.header, Header::Stated(names.to_vec()));
        assert_eq!((head.line, head.further_times), (8, vec![2]));
        assert_eq!(head.units, ["ms", "deg", "ms", "deg"]);
    }
}
