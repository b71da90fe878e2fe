//! Tables: one row is one instant, columns are named signals.

mod arrays;
mod columns;
mod csv_read;
mod decimal;
#[cfg(feature = "parquet")]
mod parquet_cells;
#[cfg(feature = "parquet")]
mod parquet_read;

pub(super) use arrays::ArrayReader;
pub use arrays::Arrays;
pub(super) use csv_read::CsvReader;
#[cfg(feature = "parquet")]
pub(super) use parquet_read::ParquetReader;

use super::reader::{Format, Progress, Reader};
use crate::assemble::Joiner;
use crate::error::LogError;
use crate::frame::{ABSENT, BLOCKS, Channels, DrivenJoint};
use crate::health::Health;
use crate::options::OpenOptions;
use crate::sources::SignalSource;
use columns::Columns;
use sinew_files::{Fault, Located};
use std::cmp::Ordering;

/// What the next row of a table is.
enum Row {
    /// Its time, ns; its cells are filled in.
    At(i64),
    /// Lost, or without a time.
    Skipped,
    /// There is none.
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

/// Rows and what their columns mean.
pub(super) struct Table<R> {
    rows: R,
    columns: Columns,
    cells: Vec<f64>,
    wide: Vec<f64>,
    last_ns: Option<i64>,
    file: String,
    clock: Clock,
}

/// Why times are equal that were not.
const ROUNDED: &str = "a float of 32 bits rounds so: write times as float64 or integer ns";

/// How the times of rows follow each other.
#[derive(Default)]
struct Clock {
    rising: u64,
    falling: u64,
    equal: u64,
}

impl Clock {
    /// Steps after which a clock is known.
    const STEPS: u64 = 64;
    /// A share of equal times above one in so many is told.
    const TOLD: u64 = 20;
    /// Steps of a table from which on its clock can be judged.
    const FEWEST: u64 = 2;

    fn steps(&self) -> u64 {
        self.rising + self.falling + self.equal
    }

    fn step(&mut self, from_ns: i64, to_ns: i64) {
        match to_ns.cmp(&from_ns) {
            Ordering::Greater => self.rising += 1,
            Ordering::Less => self.falling += 1,
            Ordering::Equal => self.equal += 1,
        }
    }

    /// What no clock does, and the cure.
    fn fault(&self) -> Option<(&'static str, &'static str)> {
        if self.steps() < Self::FEWEST {
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
        table.resize(table.columns.found().0.len());
        table
    }

    fn check_clock(&self) -> Result<(), LogError> {
        let Some((problem, cure)) = self.clock.fault() else {
            return Ok(());
        };
        let time = &self.columns.names[self.columns.time_column];
        let located = Located::new(&self.file, Fault::Contradiction, problem);
        Err(located.column(time).cure(cure).into())
    }

    fn resize(&mut self, joints: usize) {
        self.cells = vec![ABSENT; self.columns.used.len()];
        self.wide = vec![ABSENT; BLOCKS * joints];
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
        let mut unseen = Health::default();
        loop {
            match (self.rows).next(&self.columns, &mut self.cells, None, &mut unseen)? {
                Row::At(time_ns) => return Ok(Some(time_ns)),
                Row::Skipped => {}
                Row::End => return Ok(None),
            }
        }
    }

    fn found(&self) -> (Vec<String>, Channels) {
        self.columns.found()
    }

    fn select(&mut self, joints: &[DrivenJoint]) {
        self.columns.select(joints);
        self.resize(joints.len());
    }

    fn joiner(&self, joints: &[DrivenJoint], options: &OpenOptions) -> Joiner {
        self.columns.joiner(joints, options)
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
                } else if Clock::TOLD * self.clock.equal > self.clock.steps() {
                    health.suspicion(format!(
                        "{} of {} rows have the {} of the row before and are dropped: {ROUNDED}",
                        self.clock.equal,
                        self.clock.steps() + 1,
                        self.columns.names[self.columns.time_column],
                    ));
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
