//! Parquet through its low-level column readers, a batch of rows at a time.

use std::io::{Read, Seek, SeekFrom};
use std::sync::{Arc, Mutex, PoisonError};

use bytes::Bytes;
use parquet::basic::{LogicalType, TimeUnit, Type as Physical};
use parquet::errors::Result as ParquetResult;
use parquet::file::reader::{ChunkReader, FileReader, Length, SerializedFileReader};

use super::columns::{Columns, Headers};
use super::decimal::float_ns;
use super::parquet_cells::{Cells, Leaf, first_length, guarded};
use super::{Row, Rows, Table};
use crate::error::LogError;
use crate::files::lerobot::ListNames;
use crate::files::read_seek::ReadSeek;
use crate::files::reader::{Format, Progress};
use crate::frame::is_absent;
use crate::health::Health;
use crate::options::OpenOptions;
use sinew_files::ProcessorTime;
use sinew_files::parquet::BoundedParquet;

/// File that the column readers share, each with its own position.
#[derive(Clone)]
struct Shared {
    reader: Arc<Mutex<Box<dyn ReadSeek>>>,
    length: u64,
}

impl Shared {
    fn read_at(&self, at: u64, into: &mut [u8]) -> std::io::Result<usize> {
        let mut reader = self.reader.lock().unwrap_or_else(PoisonError::into_inner);
        reader.seek(SeekFrom::Start(at))?;
        reader.read(into)
    }
}

impl Length for Shared {
    fn len(&self) -> u64 {
        self.length
    }
}

struct SharedAt {
    shared: Shared,
    at: u64,
}

impl Read for SharedAt {
    fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
        let read = self.shared.read_at(self.at, into)?;
        self.at += read as u64;
        Ok(read)
    }
}

impl ChunkReader for Shared {
    type T = std::io::BufReader<SharedAt>;

    fn get_read(&self, start: u64) -> ParquetResult<Self::T> {
        Ok(std::io::BufReader::new(SharedAt {
            shared: self.clone(),
            at: start,
        }))
    }

    fn get_bytes(&self, start: u64, length: usize) -> ParquetResult<Bytes> {
        let mut bytes = vec![0; length];
        SharedAt {
            shared: self.clone(),
            at: start,
        }
        .read_exact(&mut bytes)?;
        Ok(bytes.into())
    }
}

/// The rows of a Parquet file.
pub(crate) struct ParquetRows {
    leaves: Vec<Leaf>,
    reader: SerializedFileReader<BoundedParquet<Shared>>,
    time: ProcessorTime,
    length: u64,
    rows_total: u64,
    next_group: usize,
    group: Vec<Cells>,
    batch_rows: usize,
    batch_at: usize,
    rows_done: u64,
    ended: bool,
}

/// A Parquet file as a recording.
pub(crate) type ParquetReader = Table<ParquetRows>;

impl ParquetReader {
    pub(crate) fn open(
        mut reader: Box<dyn ReadSeek>,
        file: &str,
        options: &OpenOptions,
        list_names: &ListNames,
    ) -> Result<Self, LogError> {
        let io = |source| LogError::io(file, "read", source);
        let length = reader.seek(SeekFrom::End(0)).map_err(io)?;
        let shared = Shared {
            reader: Arc::new(Mutex::new(reader)),
            length,
        };
        let to_error = |reason: String| LogError::not_a_recording(file, reason);
        let mut time = ProcessorTime::new(&options.budget, length);
        let shared = BoundedParquet::new(shared, &options.budget);
        let reader = guarded(&mut time, || SerializedFileReader::new(shared)).map_err(|reason| {
            to_error(format!(
                "its Parquet footer cannot be read ({reason}); a Parquet file that was cut off cannot be recovered"
            ))
        })?;
        let schema = reader.metadata().file_metadata().schema_descr_ptr();
        let mut names = Vec::new();
        let mut leaves = Vec::new();
        for (index, column) in schema.columns().iter().enumerate() {
            let numeric = matches!(
                column.physical_type(),
                Physical::DOUBLE | Physical::FLOAT | Physical::INT32 | Physical::INT64
            );
            if !numeric || column.max_rep_level() > 1 {
                continue;
            }
            let timestamp = match column.logical_type_ref() {
                Some(LogicalType::Timestamp(timestamp)) => Some(match timestamp.unit {
                    TimeUnit::MILLIS => 6,
                    TimeUnit::MICROS => 3,
                    TimeUnit::NANOS => 0,
                }),
                _ => None,
            };
            let leaf = Leaf {
                column: index,
                element: None,
                present: column.max_def_level(),
                timestamp,
            };
            if column.max_rep_level() == 0 {
                names.push(column.path().string());
                leaves.push(leaf);
                continue;
            }
            // Each element of a list is a column: `state.elbow`, or `state.2`.
            let path = column.path().parts();
            let list = path[..path.len().saturating_sub(2).max(1)].join(".");
            let elements = list_names.get(&list);
            for element in 0..guarded(&mut time, || first_length(&reader, index)).unwrap_or(0) {
                let name = elements.and_then(|elements| elements.get(element));
                let name = name.map_or_else(|| element.to_string(), Clone::clone);
                names.push(format!("{list}.{name}"));
                leaves.push(Leaf {
                    element: Some(element),
                    ..leaf
                });
            }
        }
        let columns = Columns::new(&Headers::of_names(names), options, file)?;
        let rows_total = reader.metadata().file_metadata().num_rows().max(0) as u64;
        let rows = ParquetRows {
            leaves,
            reader,
            time,
            length,
            rows_total,
            next_group: 0,
            group: Vec::new(),
            batch_rows: 0,
            batch_at: 0,
            rows_done: 0,
            ended: false,
        };
        Ok(Table::new(rows, columns, file))
    }
}

impl Rows for ParquetRows {
    const FORMAT: Format = Format::Parquet;

    fn progress(&self) -> Progress {
        let share = self.rows_done.min(self.rows_total) as f64 / self.rows_total as f64;
        let bytes_done = match self.ended || self.rows_total == 0 {
            true => self.length,
            false => (share * self.length as f64) as u64,
        };
        Progress {
            bytes_done,
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
        while self.batch_at >= self.batch_rows {
            if self.ended {
                return Ok(Row::End);
            }
            if let Err(reason) = self.next_batch(columns) {
                self.ended = true;
                let lost_rows = self.rows_total.saturating_sub(self.rows_done);
                let share = lost_rows as f64 / self.rows_total.max(1) as f64;
                health.damaged(
                    self.progress().bytes_done,
                    (share * self.length as f64) as u64,
                    last_ns,
                    format!(
                        "row {} of {}: {reason}; the remaining {lost_rows} rows are lost",
                        self.rows_done, self.rows_total
                    ),
                );
                return Ok(Row::End);
            }
        }
        let at = self.batch_at;
        self.batch_at += 1;
        self.rows_done += 1;
        health.messages += 1;
        for (cell, column) in cells.iter_mut().zip(&self.group) {
            *cell = column.values[at];
        }
        let Some((column, place)) = columns.time_column.zip(columns.time_place()) else {
            let time_ns = columns.time_of_row(self.rows_done - 1);
            return Ok(time_ns.map_or(Row::Skipped, Row::At));
        };
        let time = &self.group[place];
        let exponent = self.leaves[column]
            .timestamp
            .unwrap_or(columns.time_exponent);
        let time_ns = if is_absent(time.values[at]) {
            None
        } else if time.is_integer {
            i64::checked_pow(10, exponent.unsigned_abs())
                .and_then(|factor| time.exact[at].checked_mul(factor))
        } else {
            float_ns(time.values[at], exponent)
        };
        let Some(time_ns) = time_ns else {
            health.rows_without_time += 1;
            return Ok(Row::Skipped);
        };
        Ok(Row::At(time_ns))
    }
}

impl ParquetRows {
    /// Decodes the next rows of all used columns in lockstep.
    fn next_batch(&mut self, columns: &Columns) -> Result<(), String> {
        self.batch_at = 0;
        self.batch_rows = 0;
        loop {
            if self.group.is_empty() {
                if self.next_group >= self.reader.num_row_groups() {
                    self.ended = true;
                    return Ok(());
                }
                self.open_group(&columns.used)?;
            }
            let mut rows = None;
            for (cells, &column) in self.group.iter_mut().zip(&columns.used) {
                let leaf = self.leaves[column];
                let read = guarded(&mut self.time, || cells.decode(leaf))
                    .map_err(|reason| format!("column '{}': {reason}", columns.names[column]))?;
                match rows {
                    None => rows = Some(read),
                    Some(rows) if rows != read => {
                        return Err(format!(
                            "column '{}' has {read} values where the time has {rows}",
                            columns.names[column]
                        ));
                    }
                    Some(_) => {}
                }
            }
            match rows {
                Some(rows) if rows > 0 => {
                    self.batch_rows = rows;
                    return Ok(());
                }
                _ => self.group.clear(),
            }
        }
    }

    fn open_group(&mut self, used: &[usize]) -> Result<(), String> {
        let group = guarded(&mut self.time, || {
            self.reader.get_row_group(self.next_group)
        })?;
        self.next_group += 1;
        for &column in used {
            let column = self.leaves[column].column;
            let reader = guarded(&mut self.time, || group.get_column_reader(column))?;
            self.group.push(Cells::new(reader));
        }
        Ok(())
    }
}
