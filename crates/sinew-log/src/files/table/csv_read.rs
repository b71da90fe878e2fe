//! Delimited text: one header line, one row per instant.

use std::io::{BufReader, Read, Seek, SeekFrom};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use csv::ByteRecord;
use sinew_files::csv::{Dialect, is_comment};
use sinew_files::date::ClockColumn;
use sinew_files::text::Encoding;
use sinew_files::{Budget, Fault, Located, Utf16Reader};

use super::blanks::{self, Blanks};
use super::columns::{Columns, Headers};
use super::decimal::parse_ns;
use super::head::{self, Header};
use super::{Row, Rows, Table};
use crate::error::LogError;
use crate::files::read_seek::ReadSeek;
use crate::files::reader::{Format, Progress};
use crate::frame::ABSENT;
use crate::health::Health;
use crate::options::OpenOptions;
use sinew_files::names::shorten;

/// Size of one read of the operating system, bytes.
const BUFFER_BYTES: usize = 256 << 10;

/// Hands the file to the CSV parser and stops it before an unclosed quote or a
/// file without line ends is collected in memory.
struct Meter {
    reader: Box<dyn Read + Send>,
    /// Number of bytes returned.
    given: u64,
    /// Maximum length of a row, bytes.
    row_bytes: u64,
    /// Bytes up to which rows were complete, set by the row loop.
    done: Arc<AtomicU64>,
}

impl Read for Meter {
    fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
        let open = self.given.saturating_sub(self.done.load(Ordering::Relaxed));
        let most = self.row_bytes;
        if open > most.saturating_add(BUFFER_BYTES as u64) {
            return Err(std::io::Error::new(
                std::io::ErrorKind::InvalidData,
                format!(
                    "a row of more than {most} bytes: a quote that is not closed, or no line ends"
                ),
            ));
        }
        let read = self.reader.read(into)?;
        self.given += read as u64;
        Ok(read)
    }
}

/// The rows of delimited text.
pub(crate) struct CsvRows {
    file: String,
    reader: csv::Reader<Meter>,
    record: ByteRecord,
    done: Arc<AtomicU64>,
    length: u64,
    /// Bytes before the header: a byte order mark.
    base: u64,
    /// The file's last byte is not a line end.
    unterminated: bool,
    dialect: Dialect,
    /// Lines before the first that the reader sees.
    lines_before: u64,
    /// Time columns of further channels.
    further_times: Vec<usize>,
    clock: ClockColumn,
    /// Number of rows read.
    rows: u64,
}

/// Delimited text as a recording.
pub(crate) type CsvReader = Table<CsvRows>;

impl CsvReader {
    pub(crate) fn open(
        reader: Box<dyn ReadSeek>,
        file: &str,
        options: &OpenOptions,
    ) -> Result<Self, LogError> {
        let (rows, headers, has_names) = CsvRows::open(reader, file, &options.budget)?;
        let no_names = format!("no header: line {} holds numbers", rows.lines_before + 1);
        Table::of(rows, (&headers, has_names), options, file, &no_names)
    }
}

impl CsvRows {
    /// Reads the head of a text; returns its rows, its headers, and whether the text names its columns.
    pub(super) fn open(
        mut reader: Box<dyn ReadSeek>,
        file: &str,
        budget: &Budget,
    ) -> Result<(Self, Headers, bool), LogError> {
        let row_bytes = budget.text.value();
        let io = |source| LogError::io(file, "read", source);
        let to_error = |reason: String| LogError::not_a_recording(file, reason);
        reader.seek(SeekFrom::Start(0)).map_err(io)?;
        let head = read_head(&mut reader, row_bytes).map_err(io)?;
        let (encoding, mark) = Encoding::of(&head);
        let wide = matches!(encoding, Encoding::Utf16Le | Encoding::Utf16Be);
        if head.contains(&0) && !wide {
            return Err(to_error(
                "it contains zero bytes and is not text; supported are MCAP, Parquet and delimited text"
                    .to_owned(),
            ));
        }
        // The byte order mark is not part of the first column's name.
        let mut start = mark as u64;
        let mut length = reader.seek(SeekFrom::End(0)).map_err(io)?;
        let mut last = b'\n';
        reader.seek(SeekFrom::Start(start)).map_err(io)?;
        let head = match wide {
            true => head::find(
                Utf16Reader::new(&mut reader, encoding == Encoding::Utf16Be),
                budget,
            ),
            false => head::find(&mut reader, budget),
        }
        .map_err(io)?;
        let dialect = head.dialect;
        let mut reader: Box<dyn Read + Send> = if wide {
            // Places count in UTF-8; how many there are takes a reading of its own.
            let big_endian = encoding == Encoding::Utf16Be;
            reader.seek(SeekFrom::Start(start)).map_err(io)?;
            (length, last) = end_of(Utf16Reader::new(&mut reader, big_endian)).map_err(io)?;
            reader.seek(SeekFrom::Start(start)).map_err(io)?;
            start = 0;
            Box::new(Utf16Reader::new(reader, big_endian))
        } else {
            let before = length.saturating_sub(1);
            reader.seek(SeekFrom::Start(before)).map_err(io)?;
            let _none_is_a_line_end = reader.read(std::slice::from_mut(&mut last)).map_err(io)?;
            reader.seek(SeekFrom::Start(start)).map_err(io)?;
            reader
        };
        let unterminated = last != b'\n' && last != b'\r';

        let mut before = reader.by_ref().take(head.skipped_bytes);
        std::io::copy(&mut before, &mut std::io::sink()).map_err(io)?;
        start += head.skipped_bytes;
        let (separator, reader): (u8, Box<dyn Read + Send>) = match dialect.has_blanks() {
            true => (blanks::SEPARATOR, Box::new(Blanks::new(reader))),
            false => (dialect.delimiter, reader),
        };

        let done = Arc::new(AtomicU64::new(start));
        let meter = Meter {
            reader,
            given: start,
            row_bytes,
            done: Arc::clone(&done),
        };
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(separator)
            .flexible(true)
            .has_headers(false)
            .comment(Some(head.comment))
            .buffer_capacity(BUFFER_BYTES)
            .from_reader(meter);
        let mut record = ByteRecord::new();
        let mut read = |record: &mut ByteRecord| {
            let found = reader.read_byte_record(record);
            found.map_err(|error| csv_error(file, head.line - 1, error))
        };
        let names = match &head.header {
            Header::Stated(names) => names.clone(),
            Header::Row => {
                read(&mut record)?;
                let names_in = Encoding::of(record.as_slice()).0;
                let names = record
                    .iter()
                    .map(|name| names_in.decode(name).trim().to_owned());
                let names = names.collect();
                if head.has_units_row {
                    read(&mut record)?;
                }
                names
            }
            Header::None => {
                let columns = head.columns;
                (1..=columns)
                    .map(|number| format!("column {number}"))
                    .collect()
            }
        };
        if names.iter().all(String::is_empty) {
            return Err(to_error("it has no header line".to_owned()));
        }
        let headers = head.headers(names);
        done.store(start + reader.position().byte(), Ordering::Relaxed);
        let rows = CsvRows {
            file: file.to_owned(),
            reader,
            record,
            done,
            length,
            base: start,
            unterminated,
            dialect,
            lines_before: head.line - 1,
            further_times: head.further_times,
            clock: ClockColumn::default(),
            rows: 0,
        };
        Ok((rows, headers, head.header != Header::None))
    }

    /// Numbers of the next row, `None` at the end; a cell that is no number is NaN.
    pub(super) fn numbers(&mut self) -> Option<Vec<f64>> {
        let read = self.reader.read_byte_record(&mut self.record);
        read.is_ok_and(|found| found).then(|| {
            let number = |cell| self.dialect.number(cell).flatten().unwrap_or(f64::NAN);
            self.record.iter().map(number).collect()
        })
    }
}

impl Rows for CsvRows {
    const FORMAT: Format = Format::Csv;

    fn progress(&self) -> Progress {
        Progress {
            bytes_done: self.done.load(Ordering::Relaxed).min(self.length),
            bytes_total: self.length,
        }
    }

    fn next(
        &mut self,
        columns: &Columns,
        cells: &mut [f64],
        last_ns: Option<i64>,
        health: &mut Health,
    ) -> Result<Row, LogError> {
        let mut start = self.base + self.reader.position().byte();
        loop {
            let found = self.reader.read_byte_record(&mut self.record);
            if !found.map_err(|error| csv_error(&self.file, self.lines_before, error))? {
                self.done.store(self.length, Ordering::Relaxed);
                return Ok(Row::End);
            }
            // The CSV reader knows one mark of a comment, and no empty line that has blanks.
            let first = self.record.get(0).unwrap_or_default().trim_ascii_start();
            let is_empty = self.record.len() == 1 && first.is_empty();
            if !is_comment(first) && !is_empty {
                break;
            }
            start = self.base + self.reader.position().byte();
            self.done.store(start, Ordering::Relaxed);
        }
        let end = self.base + self.reader.position().byte();
        self.done.store(end, Ordering::Relaxed);
        health.messages += 1;
        // Only the last row can lack its line end.
        let cut_off = self.unterminated && end >= self.length;
        let short = self.record.len() < columns.names.len();
        if cut_off && short {
            return Ok(self.lost_tail(start, last_ns, health, "it has too few cells"));
        }
        if self.record.len() != columns.names.len() {
            health.ragged_rows += 1;
        }
        for (place, &column) in columns.used.iter().enumerate() {
            if Some(column) == columns.time_column {
                continue;
            }
            let cell = self.record.get(column).unwrap_or(b"");
            cells[place] = match self.dialect.number(cell) {
                Some(value) => value.unwrap_or(ABSENT),
                None if cut_off && column + 1 == self.record.len() => {
                    return Ok(self.lost_tail(
                        start,
                        last_ns,
                        health,
                        "its last cell is not a number",
                    ));
                }
                None => return Err(self.bad_cell(columns, column, "is not a number")),
            };
        }
        let row = self.rows;
        self.rows += 1;
        let Some(time_column) = columns.time_column else {
            return Ok(columns.time_of_row(row).map_or(Row::Skipped, Row::At));
        };
        let cell = self.record.get(time_column).unwrap_or(b"").trim_ascii();
        for &further in &self.further_times {
            if self.record.get(further).unwrap_or(b"").trim_ascii() != cell {
                let problem = "differs from the time of the first channel";
                let error = self.located(columns, further, problem);
                let cure = "export the channels with a common time column, or each to a file";
                return Err(error.cure(cure).into());
            }
        }
        let time_ns = match self.time(cell, columns.time_exponent) {
            Some(time_ns) => time_ns,
            None if cell.is_empty()
                || self.dialect.number(cell).flatten().is_some_and(f64::is_nan) =>
            {
                health.rows_without_time += 1;
                return Ok(Row::Skipped);
            }
            None => {
                let text = String::from_utf8_lossy(self.record.get(time_column).unwrap_or(b""));
                match self.clock.read(&text) {
                    Some(time_ns) => time_ns,
                    None if cut_off && time_column + 1 == self.record.len() => {
                        let reason = "its last cell is not a time";
                        return Ok(self.lost_tail(start, last_ns, health, reason));
                    }
                    None => {
                        let what = "is not a time within the years 1677 to 2262";
                        return Err(self.bad_cell(columns, time_column, what));
                    }
                }
            }
        };
        Ok(Row::At(time_ns))
    }
}

impl CsvRows {
    fn time(&self, cell: &[u8], exponent: i32) -> Option<i64> {
        let exact = parse_ns(cell, exponent).filter(|_| !self.dialect.thousands_point);
        exact.or_else(|| {
            let grouped = || {
                let number = self.dialect.number(cell).flatten()?;
                parse_ns(number.to_string().as_bytes(), exponent)
            };
            let text = std::str::from_utf8(cell).ok()?;
            if !self.dialect.decimal_comma || text.contains('.') {
                return grouped();
            }
            parse_ns(text.replacen(',', ".", 1).as_bytes(), exponent)
        })
    }

    fn lost_tail(
        &self,
        start: u64,
        last_ns: Option<i64>,
        health: &mut Health,
        reason: &str,
    ) -> Row {
        health.damaged(
            start,
            self.length.saturating_sub(start),
            last_ns,
            format!("the last line is truncated: {reason}"),
        );
        Row::Skipped
    }

    fn bad_cell(&self, columns: &Columns, column: usize, what: &str) -> LogError {
        let located = self.located(columns, column, what);
        located.cure("empty or nan means not recorded").into()
    }

    /// Fault of a cell of the row.
    fn located(&self, columns: &Columns, column: usize, what: &str) -> Located {
        let cell = self.record.get(column).unwrap_or(b"");
        let cell = String::from_utf8_lossy(cell.trim_ascii());
        let line = self.record.position().map_or(0, csv::Position::line);
        Located::new(&self.file, Fault::WrongType, what)
            .line(self.lines_before + line)
            .column(columns.names.get(column).map_or("", String::as_str))
            .value(format!("'{}'", shorten(&cell, 60)))
    }
}

/// Bytes of a text, and the last of them.
fn end_of(mut text: impl Read) -> std::io::Result<(u64, u8)> {
    let mut buffer = vec![0; BUFFER_BYTES];
    let (mut length, mut last) = (0, b'\n');
    loop {
        match text.read(&mut buffer)? {
            0 => return Ok((length, last)),
            read => {
                length += read as u64;
                last = buffer[read - 1];
            }
        }
    }
}

/// First line that is not empty, up to the limit.
fn read_head(reader: &mut Box<dyn ReadSeek>, most: u64) -> std::io::Result<Vec<u8>> {
    let mut head = Vec::new();
    for byte in BufReader::new(reader.take(most)).bytes() {
        match byte? {
            b'\n' | b'\r' if head.is_empty() => {}
            b'\n' | b'\r' => break,
            byte => head.push(byte),
        }
    }
    Ok(head)
}

fn csv_error(file: &str, lines_before: u64, error: csv::Error) -> LogError {
    let line = error.position().map(csv::Position::line);
    match error.into_kind() {
        csv::ErrorKind::Io(source) if source.kind() == std::io::ErrorKind::InvalidData => {
            LogError::not_a_recording(file, source.to_string())
        }
        csv::ErrorKind::Io(source) => LogError::io(file, "read", source),
        other => Located::new(file, Fault::Syntax, format!("{other:?}"))
            .line(lines_before + line.unwrap_or(0))
            .into(),
    }
}
