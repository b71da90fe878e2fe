//! Delimited text: one header line, one row per instant.

use std::io::{BufRead as _, BufReader, Read, Seek, SeekFrom};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use csv::ByteRecord;
use sinew_files::csv::Dialect;
use sinew_files::text::Encoding;
use sinew_files::{Fault, Located, Utf16Reader};

use super::columns::Columns;
use super::decimal::parse_ns;
use super::{Row, Rows, Table};
use crate::error::LogError;
use crate::files::read_seek::ReadSeek;
use crate::files::reader::{Format, Progress};
use crate::frame::ABSENT;
use crate::health::Health;
use crate::options::OpenOptions;
use sinew_files::names::shorten;

/// Maximum length of a line (header or row), bytes.
const ROW_LIMIT_BYTES: u64 = sinew_files::limits::CSV_LINE.most;
/// Bytes of the start in which the header line must end.
const HEADER_LIMIT_BYTES: u64 = sinew_files::limits::CSV_LINE.most;
/// First character of a line without a row.
const COMMENT: u8 = b'#';
/// Size of one read of the operating system, bytes.
const BUFFER_BYTES: usize = 256 << 10;

/// Hands the file to the CSV parser and stops it before an unclosed quote or a
/// file without line ends is collected in memory.
struct Meter {
    reader: Box<dyn Read + Send>,
    /// Number of bytes returned.
    given: u64,
    /// Bytes up to which rows were complete, set by the row loop.
    done: Arc<AtomicU64>,
}

impl Read for Meter {
    fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
        let open = self.given.saturating_sub(self.done.load(Ordering::Relaxed));
        if open > ROW_LIMIT_BYTES + BUFFER_BYTES as u64 {
            return Err(std::io::Error::new(
                std::io::ErrorKind::InvalidData,
                format!(
                    "a row of more than {ROW_LIMIT_BYTES} bytes: a quote that is not closed, or no line ends"
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
}

/// Delimited text as a recording.
pub(crate) type CsvReader = Table<CsvRows>;

impl CsvReader {
    pub(crate) fn open(
        mut reader: Box<dyn ReadSeek>,
        file: &str,
        options: &OpenOptions,
    ) -> Result<Self, LogError> {
        let io = |source| LogError::io(file, "read", source);
        let to_error = |reason: String| LogError::not_a_recording(file, reason);
        reader.seek(SeekFrom::Start(0)).map_err(io)?;
        let head = read_head(&mut reader).map_err(io)?;
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
        let (header, is_comment) = match wide {
            true => find_header(Utf16Reader::new(&mut reader, encoding == Encoding::Utf16Be)),
            false => find_header(&mut reader),
        }
        .map_err(io)?;
        let names_in = Encoding::of(&header).0;
        let header = names_in.decode(&header);
        let dialect = Dialect::of_header(header.as_bytes());
        let reader: Box<dyn Read + Send> = if wide {
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

        let done = Arc::new(AtomicU64::new(0));
        let meter = Meter {
            reader,
            given: start,
            done: Arc::clone(&done),
        };
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(dialect.delimiter)
            .flexible(true)
            .has_headers(false)
            .comment(Some(COMMENT))
            .buffer_capacity(BUFFER_BYTES)
            .from_reader(meter);
        let mut record = ByteRecord::new();
        let found = match is_comment {
            true => csv::ReaderBuilder::new()
                .delimiter(dialect.delimiter)
                .has_headers(false)
                .from_reader(header.as_bytes())
                .read_byte_record(&mut record),
            false => reader.read_byte_record(&mut record),
        };
        if !found.map_err(|error| csv_error(file, error))? {
            return Err(to_error("it has no header line".to_owned()));
        }
        let names_in = if is_comment { Encoding::Utf8 } else { names_in };
        let names: Vec<String> = record
            .iter()
            .map(|name| names_in.decode(name).trim().to_owned())
            .collect();
        let columns = Columns::new(&names, options, file)?;
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
        };
        Ok(Table::new(rows, columns, file))
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
        let start = self.base + self.reader.position().byte();
        let found = self
            .reader
            .read_byte_record(&mut self.record)
            .map_err(|error| csv_error(&self.file, error))?;
        if !found {
            self.done.store(self.length, Ordering::Relaxed);
            return Ok(Row::End);
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
            if column == columns.time_column {
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
        let cell = self
            .record
            .get(columns.time_column)
            .unwrap_or(b"")
            .trim_ascii();
        let time_ns = match self.time(cell, columns.time_exponent) {
            Some(time_ns) => time_ns,
            None if cell.is_empty()
                || self.dialect.number(cell).flatten().is_some_and(f64::is_nan) =>
            {
                health.rows_without_time += 1;
                return Ok(Row::Skipped);
            }
            None if cut_off && columns.time_column + 1 == self.record.len() => {
                return Ok(self.lost_tail(start, last_ns, health, "its last cell is not a time"));
            }
            None => {
                return Err(self.bad_cell(
                    columns,
                    columns.time_column,
                    "is not a time within the years 1677 to 2262",
                ));
            }
        };
        Ok(Row::At(time_ns))
    }
}

impl CsvRows {
    fn time(&self, cell: &[u8], exponent: i32) -> Option<i64> {
        parse_ns(cell, exponent).or_else(|| {
            if !self.dialect.decimal_comma {
                return None;
            }
            let text = std::str::from_utf8(cell).ok()?.replacen(',', ".", 1);
            parse_ns(text.as_bytes(), exponent)
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
        let cell = self.record.get(column).unwrap_or(b"");
        let cell = String::from_utf8_lossy(cell);
        Located::new(&self.file, Fault::WrongType, what)
            .line(self.record.position().map_or(0, |position| position.line()))
            .column(columns.names.get(column).map_or("", String::as_str))
            .value(format!("'{}'", shorten(&cell, 60)))
            .cure("empty or nan means not recorded")
            .into()
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
fn read_head(reader: &mut Box<dyn ReadSeek>) -> std::io::Result<Vec<u8>> {
    let mut head = Vec::new();
    for byte in BufReader::new(reader.take(HEADER_LIMIT_BYTES)).bytes() {
        match byte? {
            b'\n' | b'\r' if head.is_empty() => {}
            b'\n' | b'\r' => break,
            byte => head.push(byte),
        }
    }
    Ok(head)
}

/// The line of column names, and whether it is a comment: the last one above rows that begin with numbers.
fn find_header(text: impl Read) -> std::io::Result<(Vec<u8>, bool)> {
    let mut text = BufReader::new(text.take(HEADER_LIMIT_BYTES));
    let (mut line, mut comment) = (Vec::new(), None);
    loop {
        line.clear();
        if text.read_until(b'\n', &mut line)? == 0 {
            return Ok((Vec::new(), false));
        }
        // Old line ends part lines too.
        let own = line.split(|byte| *byte == b'\r').next().unwrap_or(&line);
        let own = own.trim_ascii();
        match own.strip_prefix(&[COMMENT]) {
            Some(text) => comment = Some(text.trim_ascii().to_vec()),
            None if own.is_empty() => {}
            None => {
                let is_number = |comment: &Vec<u8>| {
                    let dialect = Dialect::of_header(comment);
                    let mut cells = own.split(|byte| *byte == dialect.delimiter);
                    cells.all(|cell| dialect.number(cell).is_some())
                };
                return Ok(match comment.filter(is_number) {
                    Some(comment) => (comment, true),
                    None => (own.to_vec(), false),
                });
            }
        }
    }
}

fn csv_error(file: &str, error: csv::Error) -> LogError {
    let line = error.position().map(csv::Position::line);
    match error.into_kind() {
        csv::ErrorKind::Io(source) if source.kind() == std::io::ErrorKind::InvalidData => {
            LogError::not_a_recording(file, source.to_string())
        }
        csv::ErrorKind::Io(source) => LogError::io(file, "read", source),
        other => Located::new(file, Fault::Syntax, format!("{other:?}"))
            .line(line.unwrap_or(0))
            .into(),
    }
}
