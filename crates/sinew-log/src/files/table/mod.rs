//! Tables: one row is one instant, columns are named signals.

mod arrays;
mod blanks;
mod columns;
mod csv_read;
mod decimal;
mod head;
#[cfg(feature = "numpy")]
mod numpy;
#[cfg(feature = "parquet")]
mod parquet_cells;
#[cfg(feature = "parquet")]
mod parquet_read;
mod propose;

pub(super) use arrays::ArrayReader;
pub use arrays::Arrays;
pub(super) use csv_read::CsvReader;
#[cfg(feature = "numpy")]
pub(super) use numpy::{NPY_MAGIC, NPZ_MAGIC, NumpyReader, is_archive_of_arrays};
#[cfg(feature = "parquet")]
pub(super) use parquet_read::ParquetReader;
pub use propose::{MappingProposal, ProposedJoint, ProposedSource, ProposedTime, TableColumn};

use super::reader::{Format, Progress, Reader};
use crate::assemble::Joiner;
use crate::error::LogError;
use crate::frame::{ABSENT, AxisNames, Channels};
use crate::health::Health;
use crate::options::OpenOptions;
use crate::sources::SignalSource;
use columns::{Columns, Headers, TIME_UNITS, time_unit_of_rate};
use sinew_files::number::three_digits;
use sinew_files::{Fault, Located};
use std::cmp::Ordering;

/// Next row of a table.
enum Row {
    /// Row with its time, ns; its cells are filled in.
    At(i64),
    /// Row that is lost or has no time.
    Skipped,
    /// End of the table.
    End,
}

/// A format that holds rows.
trait Rows: Send {
    const FORMAT: Format;

    /// Reads the used cells of a row; `last_ns` is the time of the last good one.
    fn next(
        &mut self,
        columns: &Columns,
        cells: &mut [f64],
        last_ns: Option<i64>,
        health: &mut Health,
    ) -> Result<Row, LogError>;

    fn progress(&self) -> Progress;
}

/// Rows with their column mapping.
pub(super) struct Table<R> {
    rows: R,
    columns: Columns,
    cells: Vec<f64>,
    wide: Vec<f64>,
    last_ns: Option<i64>,
    file: String,
    clock: Clock,
}

/// Cause and remedy of equal times.
const ROUNDED: &str = "probably rounded to 32-bit floats; write times as float64 or integer ns";

/// Counts of the steps between the times of rows.
#[derive(Default)]
struct Clock {
    rising: u64,
    falling: u64,
    equal: u64,
    /// Sum of the rising steps, s.
    rise_s: f64,
}

/// Plausible rates of a recording, Hz: slower ones have a gap from row to row, faster ones exceed encoder buses.
const PLAUSIBLE_HZ: std::ops::Range<f64> = 2.0..50_000.0;

impl Clock {
    /// Steps after which a clock is known.
    const STEPS: u64 = 64;
    /// Minimum share of equal times that is reported: one in this many.
    const EQUAL_TIMES_RATIO: u64 = 20;
    /// Minimum number of steps for a check of the clock.
    const MIN_STEPS: u64 = 2;

    fn steps(&self) -> u64 {
        self.rising + self.falling + self.equal
    }

    fn step(&mut self, from_ns: i64, to_ns: i64) {
        match to_ns.cmp(&from_ns) {
            Ordering::Greater => {
                self.rising += 1;
                self.rise_s += (to_ns as f64 - from_ns as f64) * 1e-9;
            }
            Ordering::Less => self.falling += 1,
            Ordering::Equal => self.equal += 1,
        }
    }

    /// Warning of times in another unit than that of `exponent`.
    fn other_unit(&self, exponent: i32) -> Option<String> {
        /// Number of steps that show a rate.
        const MIN_RISES: u64 = 20;
        let step_s = self.rise_s / self.rising as f64;
        if self.rising < MIN_RISES || PLAUSIBLE_HZ.contains(&step_s.recip()) {
            return None;
        }
        let stated = TIME_UNITS.iter().find(|unit| unit.1 == exponent)?.0;
        let step = step_s * 10_f64.powi(9 - exponent);
        let unit = time_unit_of_rate(step)?;
        let other = TIME_UNITS.iter().find(|found| found.0 == unit)?.1;
        let hz = three_digits(10_f64.powi(9 - other) / step);
        let step = three_digits(step_s);
        Some(format!(
            "the times advance by {step} s per row in {stated}: probably in {unit} ({hz} Hz); set unit = \"{unit}\" in [time] of the mapping"
        ))
    }

    /// Fault of the times, with its remedy.
    fn fault(&self) -> Option<(&'static str, &'static str)> {
        if self.steps() < Self::MIN_STEPS {
            None
        } else if self.rising == 0 && self.falling > self.equal {
            Some((
                "the clock runs backwards from row to row",
                "sort the rows by time",
            ))
        } else if self.equal > self.rising + self.falling {
            let problem = "most rows have the same time as the row before";
            Some((problem, ROUNDED))
        } else {
            None
        }
    }
}

impl<R> Table<R> {
    fn new(rows: R, columns: Columns, file: &str) -> Self {
        let mut table = Table {
            file: file.to_owned(),
            clock: Clock::default(),
            rows,
            columns,
            cells: Vec::new(),
            wide: Vec::new(),
            last_ns: None,
        };
        table.resize();
        table
    }

    /// Opens a table whose columns may have no names; they are then named by a mapping. `no_names`: problem without one.
    fn of(
        rows: R,
        (headers, has_names): (&Headers, bool),
        options: &OpenOptions,
        file: &str,
        no_names: &str,
    ) -> Result<Self, LogError> {
        let is_mapped =
            (options.mapping.as_ref()).is_some_and(|m| m.joint_names().next().is_some());
        if !has_names && !is_mapped {
            let reason = format!(
                "{no_names}; name the columns by their numbers in a mapping, such as column = 2, with rate_hz in [time] if no column is a time"
            );
            return Err(LogError::columns(file, &reason, &headers.names));
        }
        Ok(Self::new(rows, Columns::new(headers, options, file)?, file))
    }

    fn check_clock(&self) -> Result<(), LogError> {
        let Some((problem, cure)) = self.clock.fault() else {
            return Ok(());
        };
        let located = Located::new(&self.file, Fault::Contradiction, problem);
        let time = self.columns.time_name();
        Err(located.column(time).cure(cure).into())
    }

    fn resize(&mut self) {
        self.cells = vec![ABSENT; self.columns.used.len()];
        self.wide = vec![ABSENT; self.columns.width];
    }
}

impl<R: Rows> Reader for Table<R> {
    fn format(&self) -> Format {
        R::FORMAT
    }

    fn layout(&self) -> String {
        "a table".to_owned()
    }

    fn starts_ns(&mut self) -> Result<Option<i64>, LogError> {
        let mut unobservable = Health::default();
        loop {
            match (self.rows).next(&self.columns, &mut self.cells, None, &mut unobservable)? {
                Row::At(time_ns) => return Ok(Some(time_ns)),
                Row::Skipped => {}
                Row::End => return Ok(None),
            }
        }
    }

    fn found(&self) -> (Vec<String>, Channels) {
        self.columns.found()
    }

    fn tendons(&self) -> &[String] {
        self.columns.tendons()
    }

    fn select(&mut self, axes: &[AxisNames]) {
        self.columns.select(axes);
        self.resize();
    }

    fn joiner(&self, axes: &[AxisNames], options: &OpenOptions) -> Joiner {
        let mut joiner = self.columns.joiner(axes, options);
        joiner.exclude_second_publishers();
        joiner
    }

    fn pull(&mut self, joiner: &mut Joiner, health: &mut Health) -> Result<bool, LogError> {
        match (self.rows).next(&self.columns, &mut self.cells, self.last_ns, health)? {
            Row::At(time_ns) => {
                if let Some(last_ns) = self.last_ns {
                    self.clock.step(last_ns, time_ns);
                    if self.clock.steps() == Clock::STEPS {
                        self.check_clock()?;
                    }
                }
                self.last_ns = Some(time_ns);
                self.columns.row(&self.cells, &mut self.wide);
                let wide = &self.wide;
                (joiner.primary).insert(time_ns, |slot| slot.copy_from_slice(wide));
                Ok(true)
            }
            Row::Skipped => Ok(true),
            Row::End => {
                if self.clock.steps() < Clock::STEPS {
                    self.check_clock()?;
                } else if Clock::EQUAL_TIMES_RATIO * self.clock.equal > self.clock.steps()
                    && joiner.primary.counts.second == 0
                {
                    health.implausible_signal(format!(
                        "{} of {} rows have the same {} as the row before and are discarded: {ROUNDED}",
                        self.clock.equal,
                        self.clock.steps() + 1,
                        self.columns.time_name(),
                    ));
                }
                let (column, exponent) = (self.columns.time_column, self.columns.time_exponent);
                if let Some(warning) = column.and_then(|_| self.clock.other_unit(exponent)) {
                    health.implausible_signal(warning);
                }
                Ok(false)
            }
        }
    }

    fn progress(&self) -> Progress {
        self.rows.progress()
    }

    fn sources(&self) -> Vec<SignalSource> {
        self.columns.sources()
    }

    fn unused_columns(&self) -> Vec<String> {
        self.columns.unused()
    }
}
