//! Rows of numbers that somebody else holds in memory.

use super::columns::Columns;
use super::{Row, Rows, Table};
use crate::error::LogError;
use crate::files::reader::{Format, Progress};
use crate::frame::{ABSENT, Quantities, Quantity};
use crate::health::Health;
use crate::options::OpenOptions;

/// Rows copied at a time.
const BLOCK_ROWS: usize = 1024;

/// Numbers that somebody else holds, one row an instant: read block by block, never copied whole.
///
/// What the columns of a CSV file are, these are in memory. NaN means "not recorded".
pub trait Arrays: Send {
    /// Names of the `n` joints, in the order of the values.
    fn joints(&self) -> &[String];

    /// Which quantities there are.
    fn quantities(&self) -> Quantities;

    /// Rows there are.
    fn rows(&self) -> u64;

    /// Copies the times of the rows from `from` on, ns.
    ///
    /// # Errors
    /// Why they can't be had, in words.
    fn times_ns(&mut self, from: u64, into: &mut [i64]) -> Result<(), String>;

    /// Copies a quantity's values of the rows from `from` on: `n` a row, SI; one a row of the temperature, °C.
    ///
    /// # Errors
    /// Why they can't be had, in words.
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
    /// Of every column but the time: its block and its place in a row of that.
    places: Vec<(usize, usize)>,
    times_ns: Vec<i64>,
    /// Rows handed out, and how many of them were before this block.
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
        // Names are ours: no mapping says what they mean.
        let options = OpenOptions {
            mapping: None,
            ..options.clone()
        };
        let columns = Columns::new(&names, &options, file)?;
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
        let refuse = |why: String| LogError::request(&self.file, why);
        self.times_ns.resize(rows, 0);
        (self.arrays)
            .times_ns(self.done, &mut self.times_ns)
            .map_err(refuse)?;
        for block in &mut self.blocks {
            block.values.resize(rows * block.width, ABSENT);
            (self.arrays)
                .values(block.quantity, self.done, &mut block.values)
                .map_err(refuse)?;
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
