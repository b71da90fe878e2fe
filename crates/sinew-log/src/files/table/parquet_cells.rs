//! The cells of one column of a Parquet file, a batch at a time.

use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::errors::{ParquetError, Result as ParquetResult};
use parquet::file::reader::{ChunkReader, FileReader, SerializedFileReader};

use crate::frame::ABSENT;
use sinew_files::ProcessorTime;

/// Rows decoded at a time.
const BATCH_ROWS: usize = 1024;

/// Conversion of the cells of a column to numbers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Leaf {
    /// Index of the column in the file.
    pub(super) column: usize,
    /// Index of the element in a list, if the column has lists.
    pub(super) element: Option<usize>,
    /// Definition level at which a value is present.
    pub(super) present: i16,
    /// Power of ten to nanoseconds of a timestamp column, which is exact as an integer.
    pub(super) timestamp: Option<i32>,
}

/// Column of the current row group.
pub(super) struct Cells {
    reader: ColumnReader,
    levels: Vec<i16>,
    repeated: Vec<i16>,
    /// Decoded batch: values, or integers for an integer column.
    pub(super) values: Vec<f64>,
    pub(super) exact: Vec<i64>,
    pub(super) is_integer: bool,
}

/// Reads records of a column: how many there were, and their values.
fn records<T: DataType>(
    reader: &mut ColumnReaderImpl<T>,
    most: usize,
    levels: Option<&mut Vec<i16>>,
    repeated: Option<&mut Vec<i16>>,
) -> ParquetResult<(usize, Vec<T::T>)> {
    let mut values = Vec::new();
    let (rows, ..) = reader.read_records(most, levels, repeated, &mut values)?;
    Ok((rows, values))
}

impl Cells {
    pub(super) fn new(reader: ColumnReader) -> Self {
        let is_integer = matches!(
            reader,
            ColumnReader::Int32ColumnReader(_) | ColumnReader::Int64ColumnReader(_)
        );
        Cells {
            reader,
            levels: Vec::new(),
            repeated: Vec::new(),
            values: Vec::new(),
            exact: Vec::new(),
            is_integer,
        }
    }

    /// Selects one element of each row's list; missing elements are absent.
    fn pick(&mut self, element: usize, present: i16, rows: usize) {
        let (mut picked, mut exact) = (vec![ABSENT; rows], vec![0; rows]);
        let (mut row, mut place, mut from) = (0, 0, 0);
        for (at, (level, repeated)) in self.levels.iter().zip(&self.repeated).enumerate() {
            let fresh = *repeated == 0;
            row += usize::from(fresh && at > 0);
            place = if fresh { 0 } else { place + 1 };
            if *level != present {
                continue;
            }
            if place == element && row < rows && from < self.values.len() {
                picked[row] = self.values[from];
                exact[row] = self.exact.get(from).copied().unwrap_or(0);
            }
            from += 1;
        }
        self.values = picked;
        self.exact = exact;
    }

    /// Decodes a batch; how many rows there were.
    pub(super) fn decode(&mut self, leaf: Leaf) -> ParquetResult<usize> {
        self.levels.clear();
        self.repeated.clear();
        self.values.clear();
        self.exact.clear();
        let levels = (leaf.present > 0).then_some(&mut self.levels);
        let repeated = leaf.element.map(|_| &mut self.repeated);
        let rows = match &mut self.reader {
            ColumnReader::DoubleColumnReader(reader) => {
                let (rows, values) = records(reader, BATCH_ROWS, levels, repeated)?;
                self.values = values;
                rows
            }
            ColumnReader::FloatColumnReader(reader) => {
                let (rows, values) = records(reader, BATCH_ROWS, levels, repeated)?;
                self.values.extend(values.into_iter().map(f64::from));
                rows
            }
            ColumnReader::Int32ColumnReader(reader) => {
                let (rows, values) = records(reader, BATCH_ROWS, levels, repeated)?;
                self.exact.extend(values.into_iter().map(i64::from));
                rows
            }
            ColumnReader::Int64ColumnReader(reader) => {
                let (rows, values) = records(reader, BATCH_ROWS, levels, repeated)?;
                self.exact = values;
                rows
            }
            _ => return Err(ParquetError::General("not a numeric column".to_owned())),
        };
        if self.is_integer {
            self.values
                .extend(self.exact.iter().map(|value| *value as f64));
        }
        if let Some(element) = leaf.element {
            self.pick(element, leaf.present, rows);
        } else if leaf.present > 0 && self.values.len() < rows {
            self.spread_nulls(leaf.present, rows)?;
        }
        if self.values.len() != rows {
            return Err(ParquetError::General(format!(
                "{} values for {rows} rows",
                self.values.len()
            )));
        }
        Ok(rows)
    }

    /// Moves the values to their rows, from the back; nulls become absent.
    fn spread_nulls(&mut self, present: i16, rows: usize) -> ParquetResult<()> {
        let mut from = self.values.len();
        let filled = self
            .levels
            .iter()
            .filter(|level| **level == present)
            .count();
        if self.levels.len() != rows || filled != from {
            return Err(ParquetError::General(format!(
                "{} levels and {from} values for {rows} rows",
                self.levels.len()
            )));
        }
        self.values.resize(rows, ABSENT);
        if self.is_integer {
            self.exact.resize(rows, 0);
        }
        for to in (0..rows).rev() {
            if self.levels[to] == present {
                from -= 1;
                self.values[to] = self.values[from];
                if self.is_integer {
                    self.exact[to] = self.exact[from];
                }
            } else {
                self.values[to] = ABSENT;
            }
        }
        Ok(())
    }
}

/// Number of elements in the list of the first row.
pub(super) fn first_length(
    reader: &SerializedFileReader<impl ChunkReader + 'static>,
    column: usize,
) -> ParquetResult<usize> {
    if reader.num_row_groups() == 0 {
        return Ok(0);
    }
    let (mut levels, mut repeated) = (Vec::new(), Vec::new());
    let (places, repeats) = (Some(&mut levels), Some(&mut repeated));
    match &mut reader.get_row_group(0)?.get_column_reader(column)? {
        ColumnReader::DoubleColumnReader(r) => records(r, 1, places, repeats)?.0,
        ColumnReader::FloatColumnReader(r) => records(r, 1, places, repeats)?.0,
        ColumnReader::Int32ColumnReader(r) => records(r, 1, places, repeats)?.0,
        ColumnReader::Int64ColumnReader(r) => records(r, 1, places, repeats)?.0,
        _ => return Ok(0),
    };
    Ok(levels.len())
}

/// Runs the Parquet library with a net: its decoders may panic on damaged pages.
pub(super) fn guarded<T>(
    time: &mut ProcessorTime,
    work: impl FnOnce() -> ParquetResult<T>,
) -> Result<T, String> {
    let work = std::panic::AssertUnwindSafe(work);
    match time.spend(|| std::panic::catch_unwind(work))? {
        Ok(Ok(value)) => Ok(value),
        Ok(Err(error)) => Err(error.to_string()),
        Err(_) => Err("its pages are damaged".to_owned()),
    }
}
