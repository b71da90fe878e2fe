//! Rows of numbers in memory of the caller.

use super::columns::{Columns, Headers};
use super::{Row, Rows, Table};
use crate::error::LogError;
use crate::files::reader::{Format, Progress};
use crate::frame::{ABSENT, Quantities, Quantity};
use crate::health::Health;
use crate::options::OpenOptions;

/// Rows copied at a time.
const BLOCK_ROWS: usize = 1024;

/// Numbers in memory of the caller, one row per time stamp: read in blocks, never copied whole.
///
/// They correspond to the columns of a CSV file. NaN means "not recorded".
pub trait Arrays: Send {
    /// Names of the `n` joints, in the order of the values.
    fn joints(&self) -> &[String];

    /// Recorded quantities of the joints.
    fn quantities(&self) -> Quantities;

    /// Number of rows.
    fn rows(&self) -> u64;

    /// Copies the times of the rows from `from` on, ns.
    ///
    /// # Errors
    /// Returns a description of the error.
    fn times_ns(&mut self, from: u64, into: &mut [i64]) -> Result<(), String>;

    /// Copies a quantity's values of the rows from `from` on: `n` a row, SI; one a row of the temperature, °C.
    ///
    /// # Errors
    /// Returns a description of the error.
    fn values(&mut self, quantity: Quantity, from: u64, into: &mut [f64]) -> Result<(), String>;
}

/// A block of one quantity.
struct Block {
    quantity: Quantity,
    /// Values a row.
    width: usize,
    values: Vec<f64>,
}

/// The rows of arrays.
pub(crate) struct ArrayRows {
    arrays: Box<dyn Arrays>,
    file: String,
    blocks: Vec<Block>,
    /// Block and index in the row of that block, for every column but the time.
    places: Vec<(usize, usize)>,
    times_ns: Vec<i64>,
    /// Number of rows returned, and that number before this block.
    done: u64,
    before: u64,
}

/// Arrays as a recording.
pub(crate) type ArrayReader = Table<ArrayRows>;

impl ArrayReader {
    pub(crate) fn open(
        arrays: Box<dyn Arrays>,
        file: &str,
        options: &OpenOptions,
    ) -> Result<Self, LogError> {
        let joints = arrays.joints().to_vec();
        let mut names = vec!["time_ns".to_owned()];
        let (mut blocks, mut places) = (Vec::new(), Vec::new());
        for quantity in arrays.quantities().iter() {
            let columns: Vec<String> = match quantity {
                Quantity::Temperature => vec!["temperature_c".to_owned()],
                _ => {
                    let (symbol, suffix) = (quantity.symbol(), quantity.suffix());
                    let name = |joint| format!("{symbol}.{joint}{suffix}");
                    joints.iter().map(name).collect()
                }
            };
            places.extend((0..columns.len()).map(|place| (blocks.len(), place)));
            blocks.push(Block {
                quantity,
                width: columns.len(),
                values: Vec::new(),
            });
            names.extend(columns);
        }
        // The names are fixed: no mapping applies.
        let options = OpenOptions {
            mapping: None,
            ..options.clone()
        };
        let columns = Columns::new(&Headers::of_names(names), &options, file)?;
        let rows = ArrayRows {
            arrays,
            file: file.to_owned(),
            blocks,
            places,
            times_ns: Vec::new(),
            done: 0,
            before: 0,
        };
        Ok(Table::new(rows, columns, file))
    }
}

impl ArrayRows {
    /// Copies the next block; whether there was one.
    fn fill(&mut self) -> Result<bool, LogError> {
        let left = self.arrays.rows() - self.done;
        let rows = left.min(BLOCK_ROWS as u64) as usize;
        self.before = self.done;
        let to_error = |reason: String| LogError::request(&self.file, reason);
        self.times_ns.resize(rows, 0);
        (self.arrays)
            .times_ns(self.done, &mut self.times_ns)
            .map_err(to_error)?;
        for block in &mut self.blocks {
            block.values.resize(rows * block.width, ABSENT);
            (self.arrays)
                .values(block.quantity, self.done, &mut block.values)
                .map_err(to_error)?;
        }
        Ok(rows > 0)
    }
}

impl Rows for ArrayRows {
    const FORMAT: Format = Format::Arrays;

    fn next(
        &mut self,
        columns: &Columns,
        cells: &mut [f64],
        _last_ns: Option<i64>,
        health: &mut Health,
    ) -> Result<Row, LogError> {
        if self.done == self.before + self.times_ns.len() as u64 && !self.fill()? {
            return Ok(Row::End);
        }
        let row = (self.done - self.before) as usize;
        self.done += 1;
        health.messages += 1;
        for (cell, column) in cells.iter_mut().zip(&columns.used) {
            // The first column is the time, which is exact as it is.
            let Some((block, place)) = column.checked_sub(1).map(|c| self.places[c]) else {
                continue;
            };
            let block = &self.blocks[block];
            let value = block.values[row * block.width + place];
            *cell = if value.is_nan() { ABSENT } else { value };
        }
        Ok(Row::At(self.times_ns[row]))
    }

    fn progress(&self) -> Progress {
        let width: usize = self.blocks.iter().map(|b| b.width).sum();
        let bytes_per_row = (8 * (1 + width)) as u64;
        Progress {
            bytes_done: self.done * bytes_per_row,
            bytes_total: self.arrays.rows() * bytes_per_row,
        }
    }
}
