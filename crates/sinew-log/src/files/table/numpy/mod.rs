//! Arrays of NumPy: one of them (`.npy`), or several with names (`.npz`). The rows are read in blocks.

mod archive;
mod header;

pub(in crate::files) use archive::MAGIC as NPZ_MAGIC;
pub(in crate::files) use header::MAGIC as NPY_MAGIC;

use super::columns::{Columns, Headers};
use super::decimal::float_ns;
use super::{Row, Rows, Table};
use crate::error::LogError;
use crate::files::read_seek::ReadSeek;
use crate::files::reader::{Format, Progress};
use crate::files::spool::Spool;
use crate::frame::ABSENT;
use crate::health::Health;
use crate::options::OpenOptions;
use archive::Entry;
use flate2::read::DeflateDecoder;
use header::{Header, ValueType};
use sinew_files::{Budget, Limit, ProcessorTime};
use std::io::{Read, Seek, SeekFrom};

/// Maximum number of rows read at a time, and of the bytes of all arrays in them.
const BLOCK_ROWS: u64 = 1024;
const BLOCK_BYTES: u64 = 4 << 20;

/// An array whose first index, or second index if it is transposed, counts the rows.
struct Array {
    name: String,
    value_type: ValueType,
    /// Values of a row.
    columns: u64,
    /// Whether the rows of a column follow each other.
    is_by_column: bool,
    /// Bytes from the start of the array to its values.
    header_bytes: u64,
    /// Place of the array in an archive; `None`: it is the file.
    entry: Option<Entry>,
    /// Unpacked content of a compressed array, once it is used.
    unpacked: Option<Spool>,
}

impl Array {
    fn row_bytes(&self) -> u64 {
        self.columns.saturating_mul(self.value_type.bytes as u64)
    }
}

/// The rows of arrays in a file.
pub(crate) struct NumpyRows {
    file: String,
    unpacked: Limit,
    time: ProcessorTime,
    reader: Box<dyn ReadSeek>,
    arrays: Vec<Array>,
    /// Array and value of its row, for every column.
    places: Vec<(usize, u64)>,
    rows: u64,
    /// Number of rows that are missing at the end of the file.
    lost_rows: u64,
    unpacked_bytes: u64,
    /// Values of the used columns in the block, and the integers of the time.
    block: Vec<Vec<f64>>,
    integers: Vec<Option<i128>>,
    block_rows: u64,
    /// Number of rows returned, and that number before this block.
    done: u64,
    before: u64,
}

/// Arrays of NumPy as a recording.
pub(crate) type NumpyReader = Table<NumpyRows>;

impl NumpyReader {
    pub(crate) fn open(
        reader: Box<dyn ReadSeek>,
        file: &str,
        options: &OpenOptions,
    ) -> Result<Self, LogError> {
        let (rows, headers, has_names) = NumpyRows::open(reader, file, &options.budget)?;
        let no_names = "an array has no names of columns";
        Table::of(rows, (&headers, has_names), options, file, no_names)
    }
}

/// Whether an archive contains arrays.
pub(in crate::files) fn is_archive_of_arrays(reader: &mut dyn ReadSeek, budget: &Budget) -> bool {
    let entries = archive::entries(reader, budget);
    entries.is_ok_and(|entries| entries.iter().any(|entry| entry.name.ends_with(".npy")))
}

/// Rows and columns of an array, and whether its second index counts the rows.
fn layout(shape: &[u64], rows: u64) -> Option<(u64, bool)> {
    match *shape {
        [length] if length == rows => Some((1, false)),
        [length, columns] if length == rows => Some((columns, false)),
        [columns, length] if length == rows => Some((columns, true)),
        _ => None,
    }
}

impl NumpyRows {
    /// Reads the headers of a file; returns its rows, its columns, and whether the file names them.
    pub(super) fn open(
        mut reader: Box<dyn ReadSeek>,
        file: &str,
        budget: &Budget,
    ) -> Result<(Self, Headers, bool), LogError> {
        let io = |source| LogError::io(file, "read", source);
        let to_error = |reason: String| LogError::not_a_recording(file, reason);
        let mut magic = Vec::new();
        let length = reader.seek(SeekFrom::End(0)).map_err(io)?;
        reader.seek(SeekFrom::Start(0)).map_err(io)?;
        (reader.by_ref().take(NPY_MAGIC.len() as u64))
            .read_to_end(&mut magic)
            .map_err(io)?;
        let is_archive = magic != NPY_MAGIC;
        let mut time = ProcessorTime::new(budget, length);
        let found = match is_archive {
            true => headers_of_archive(reader.as_mut(), budget, &mut time).map_err(to_error)?,
            false => {
                reader.seek(SeekFrom::Start(0)).map_err(io)?;
                let header = Header::read(reader.by_ref(), budget).map_err(to_error)?;
                vec![(String::new(), header, None)]
            }
        };
        // Times are one array, and every other signal has as many rows.
        let longest = |(_, header, _): &(String, Header, Option<Entry>)| match header.shape[..] {
            [length] => length,
            [a, b] => match is_archive {
                true => a.max(b),
                false => a,
            },
            _ => 0,
        };
        let is_number = |header: &Header| header.value_type.is_ok();
        let numbers = found.iter().filter(|(_, header, _)| is_number(header));
        let rows = numbers.map(longest).max().unwrap_or(0);
        let mut out = Self {
            file: file.to_owned(),
            unpacked: budget.unpacked,
            time,
            reader,
            arrays: Vec::new(),
            places: Vec::new(),
            rows,
            lost_rows: 0,
            unpacked_bytes: 0,
            block: Vec::new(),
            integers: Vec::new(),
            block_rows: 0,
            done: 0,
            before: 0,
        };
        let mut headers = Headers::default();
        let mut others = Vec::new();
        for (name, header, entry) in found {
            let readable = layout(&header.shape, rows).zip(header.value_type.clone().ok());
            let Some(((columns, is_transposed), value_type)) = readable.filter(|_| rows > 0) else {
                let shape = header.shape;
                let of = header.value_type.err();
                let of = of.unwrap_or_else(|| "numbers".to_owned());
                others.push(format!("{name} {of} {shape:?}").trim().to_owned());
                continue;
            };
            let all = columns.saturating_add(out.places.len() as u64);
            budget.columns.check(all).map_err(to_error)?;
            let unit = value_type.time_unit().unwrap_or_default();
            for column in 0..columns {
                headers.names.push(match (is_archive, header.shape.len()) {
                    (false, _) => format!("column {}", column + 1),
                    (true, 1) => name.clone(),
                    (true, _) => format!("{name}[{column}]"),
                });
                headers.units.push(unit.to_owned());
                out.places.push((out.arrays.len(), column));
            }
            out.arrays.push(Array {
                name,
                value_type,
                columns,
                is_by_column: header.is_fortran != is_transposed,
                header_bytes: header.bytes,
                entry,
                unpacked: None,
            });
        }
        if headers.names.is_empty() {
            let has_fields = others.iter().any(|other| other.contains(header::FIELDS));
            let cure = match has_fields {
                true => format!(
                    "python3 -c \"import numpy as np; a = np.load('{file}'); np.savez('columns.npz', **{{name: a[name] for name in a.dtype.names}})\" writes one for each field"
                ),
                false => "numpy.savez('columns.npz', time_s=..., q=..., theta=...) writes them"
                    .to_owned(),
            };
            let found = others.join(", ");
            return Err(to_error(format!(
                "it has no array of numbers with a row for each time, only {found}; {cure}"
            )));
        }
        out.check_lengths()?;
        Ok((out, headers, is_archive))
    }

    /// Compares the size that the header of each uncompressed array states with that of the file.
    fn check_lengths(&mut self) -> Result<(), LogError> {
        let length = (self.reader.seek(SeekFrom::End(0)))
            .map_err(|source| LogError::io(&self.file, "read", source))?;
        for array in &self.arrays {
            let there = match &array.entry {
                None => length,
                Some(entry) if entry.is_deflated => continue,
                Some(entry) => entry.packed_bytes,
            };
            let there = there.saturating_sub(array.header_bytes);
            let stated = self.rows.saturating_mul(array.row_bytes());
            if there >= stated {
                continue;
            }
            if array.entry.is_none() && !array.is_by_column {
                let rows = there / array.row_bytes().max(1);
                self.lost_rows = self.rows - rows;
                self.rows = rows;
                return Ok(());
            }
            let reason = format!(
                "array '{}' states {stated} bytes and has {there}: the file is cut off",
                array.name
            );
            return Err(LogError::not_a_recording(&self.file, reason));
        }
        Ok(())
    }

    /// Reads the next block of these columns; whether there was one.
    fn fill(&mut self, used: &[usize], time: Option<usize>) -> Result<bool, LogError> {
        let row_bytes: u64 = self.arrays.iter().map(Array::row_bytes).sum();
        let most = (BLOCK_BYTES / row_bytes.max(1)).clamp(1, BLOCK_ROWS);
        self.before = self.done;
        self.block_rows = most.min(self.rows - self.done);
        self.block.resize(used.len(), Vec::new());
        // Columns of one array follow each other, and share the bytes of its rows.
        let (mut bytes, mut bytes_of) = (Vec::new(), None);
        for (index, &column) in used.iter().enumerate() {
            let (array, place) = self.places[column];
            let size = self.arrays[array].value_type.bytes;
            let (stride, offset) = match self.arrays[array].is_by_column {
                true => (size, 0),
                false => (
                    self.arrays[array].row_bytes() as usize,
                    place as usize * size,
                ),
            };
            if self.arrays[array].is_by_column || bytes_of != Some(array) {
                bytes = self.read_block(array, place)?;
                bytes_of = Some(array);
            }
            let value_type = self.arrays[array].value_type;
            let values = bytes
                .chunks_exact(stride)
                .map(|row| &row[offset..offset + size]);
            self.block[index].clear();
            let floats = values.clone().map(|value| value_type.float(value));
            self.block[index].extend(floats.map(|value| value.unwrap_or(ABSENT)));
            if Some(column) == time {
                self.integers = values.map(|value| value_type.integer(value)).collect();
            }
        }
        Ok(self.block_rows > 0)
    }

    /// Bytes of the rows of the block: of a column, or of all of them.
    fn read_block(&mut self, index: usize, column: u64) -> Result<Vec<u8>, LogError> {
        self.unpack(index)?;
        let array = &mut self.arrays[index];
        let size = array.value_type.bytes as u64;
        let (at, bytes) = match array.is_by_column {
            true => (
                (column * self.rows + self.done) * size,
                self.block_rows * size,
            ),
            false => {
                let row_bytes = array.row_bytes();
                (self.done * row_bytes, self.block_rows * row_bytes)
            }
        };
        let at = at + array.header_bytes;
        let mut read = vec![0; bytes as usize];
        let result = match (&mut array.unpacked, &array.entry) {
            (Some(spool), _) => read_exact_at(spool, at, &mut read),
            (None, entry) => {
                let start = entry.as_ref().map_or(0, |entry| entry.start);
                read_exact_at(&mut self.reader, start + at, &mut read)
            }
        };
        result.map_err(|source| LogError::io(&self.file, "read", source))?;
        Ok(read)
    }

    /// Unpacks an array that is compressed.
    fn unpack(&mut self, index: usize) -> Result<(), LogError> {
        let array = &mut self.arrays[index];
        let packed = array.entry.as_ref().filter(|entry| entry.is_deflated);
        let Some(entry) = packed.filter(|_| array.unpacked.is_none()) else {
            return Ok(());
        };
        let to_error = |reason: &dyn std::fmt::Display| {
            let reason = format!("array '{}': {reason}", array.name);
            LogError::not_a_recording(&self.file, reason)
        };
        let stated =
            (self.rows.saturating_mul(array.row_bytes())).saturating_add(array.header_bytes);
        self.unpacked
            .check(self.unpacked_bytes.saturating_add(stated))
            .map_err(|reason| to_error(&reason))?;
        self.reader
            .seek(SeekFrom::Start(entry.start))
            .map_err(|error| to_error(&error))?;
        let mut content = Checked {
            reader: self.time.reader(DeflateDecoder::new(
                self.reader.by_ref().take(entry.packed_bytes),
            )),
            checksum: crc32fast::Hasher::new(),
            bytes: 0,
        };
        let spool = Spool::of(&mut content, stated).map_err(|error| to_error(&error))?;
        if content.bytes != stated || content.checksum.finalize() != entry.checksum {
            return Err(to_error(&"its content is damaged (size or checksum)"));
        }
        self.unpacked_bytes += stated;
        array.unpacked = Some(spool);
        Ok(())
    }

    /// Values of the first rows by column, at most `most`; fewer if the file cannot be read further.
    pub(super) fn first_values(&mut self, most: usize) -> Vec<Vec<f64>> {
        let used: Vec<usize> = (0..self.places.len()).collect();
        let mut values = vec![Vec::new(); used.len()];
        while values.first().is_some_and(|column| column.len() < most) {
            if !self.fill(&used, None).is_ok_and(|is_filled| is_filled) {
                break;
            }
            self.done += self.block_rows;
            for (column, block) in values.iter_mut().zip(&self.block) {
                let present = |value: &f64| match crate::frame::is_absent(*value) {
                    true => f64::NAN,
                    false => *value,
                };
                column.extend(block.iter().map(present).take(most - column.len()));
            }
        }
        values
    }
}

/// Content with its size and checksum.
struct Checked<R> {
    reader: R,
    checksum: crc32fast::Hasher,
    bytes: u64,
}

impl<R: Read> Read for Checked<R> {
    fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
        let read = self.reader.read(into)?;
        self.checksum.update(&into[..read]);
        self.bytes += read as u64;
        Ok(read)
    }
}

fn read_exact_at(reader: &mut (impl Read + Seek), at: u64, into: &mut [u8]) -> std::io::Result<()> {
    reader.seek(SeekFrom::Start(at))?;
    reader.read_exact(into)
}

/// Names, headers and places of the arrays of an archive; the error is a description.
fn headers_of_archive(
    reader: &mut dyn ReadSeek,
    budget: &Budget,
    time: &mut ProcessorTime,
) -> Result<Vec<(String, Header, Option<Entry>)>, String> {
    let mut found = Vec::new();
    for entry in archive::entries(reader, budget)? {
        let Some(name) = entry.name.strip_suffix(".npy").map(str::to_owned) else {
            continue;
        };
        reader
            .seek(SeekFrom::Start(entry.start))
            .map_err(|error| format!("array '{name}': {error}"))?;
        let content = Read::take(&mut *reader, entry.packed_bytes);
        // Many entries may have the same content.
        let header = time.spend(|| match entry.is_deflated {
            true => Header::read(DeflateDecoder::new(content), budget),
            false => Header::read(content, budget),
        })?;
        let header = header.map_err(|reason| format!("array '{name}': {reason}"))?;
        found.push((name, header, Some(entry)));
    }
    Ok(found)
}

impl Rows for NumpyRows {
    const FORMAT: Format = Format::Numpy;

    fn next(
        &mut self,
        columns: &Columns,
        cells: &mut [f64],
        last_ns: Option<i64>,
        health: &mut Health,
    ) -> Result<Row, LogError> {
        if self.done == self.before + self.block_rows
            && !self.fill(&columns.used, columns.time_column)?
        {
            let lost = std::mem::take(&mut self.lost_rows);
            if lost > 0 {
                let of = self.rows + lost;
                let (at, bytes) = (self.progress().bytes_total, 0);
                let reason = format!("the file ends in row {} of {of}", self.rows + 1);
                health.damaged(at, bytes, last_ns, reason);
            }
            return Ok(Row::End);
        }
        let row = (self.done - self.before) as usize;
        self.done += 1;
        health.messages += 1;
        for (cell, values) in cells.iter_mut().zip(&self.block) {
            *cell = values[row];
        }
        let Some(time_column) = columns.time_column else {
            let time_ns = columns.time_of_row(self.done - 1);
            return Ok(time_ns.map_or(Row::Skipped, Row::At));
        };
        let exponent = columns.time_exponent;
        let time_ns = match self.integers.get(row).copied().flatten() {
            Some(integer) => (10_i128.checked_pow(exponent.unsigned_abs()))
                .and_then(|factor| integer.checked_mul(factor))
                .and_then(|time_ns| i64::try_from(time_ns).ok()),
            None => {
                let place = columns.used.binary_search(&time_column).ok();
                let value = place.map_or(f64::NAN, |place| self.block[place][row]);
                float_ns(value, exponent)
            }
        };
        let Some(time_ns) = time_ns else {
            health.rows_without_time += 1;
            return Ok(Row::Skipped);
        };
        Ok(Row::At(time_ns))
    }

    fn progress(&self) -> Progress {
        let row_bytes: u64 = self.arrays.iter().map(Array::row_bytes).sum();
        Progress {
            bytes_done: self.done.saturating_mul(row_bytes),
            bytes_total: self.rows.saturating_mul(row_bytes),
        }
    }
}
