//! Recordings as tables, with the column names of the design.

use super::{Cell, CellKind, Column, FrameWriter, TableWriter, write_error};
use crate::error::LogError;
use crate::frame::{Axis, AxisNames, Frame, Quantities, Quantity};
use std::path::{Path, PathBuf};

/// Names in a recording, in the order of the frames.
#[derive(Debug, Clone, Copy)]
pub struct RecordedNames<'a> {
    /// Names of the joints.
    pub joints: &'a [String],
    /// Motor of each joint, under whose name its position and torque are recorded.
    pub motors: &'a [String],
}

/// Motors with the names of their joints.
impl<'a, T: AsRef<[String]> + ?Sized> From<&'a T> for RecordedNames<'a> {
    fn from(joints: &'a T) -> Self {
        Self {
            joints: joints.as_ref(),
            motors: joints.as_ref(),
        }
    }
}

impl RecordedNames<'_> {
    pub(super) fn driven(&self, path: &Path) -> Result<Vec<AxisNames>, LogError> {
        if self.joints.len() != self.motors.len() {
            let (joints, motors) = (self.joints.len(), self.motors.len());
            let reason = format!("{joints} joints and {motors} motors: each joint needs one motor");
            return Err(write_error(path, reason));
        }
        let pairs = self.joints.iter().zip(self.motors);
        Ok(pairs
            .map(|(joint, motor)| {
                AxisNames::new(Axis {
                    motor: Some(motor),
                    ..Axis::of_joint(joint)
                })
            })
            .collect())
    }
}

/// Writes frames as rows: the time, then the quantities chosen; NaN is an empty cell, in Parquet null.
///
/// CSV has `time_s` with nanoseconds, and numbers such that reading gives the same double; Parquet has `time_ns`.
pub struct RowWriter {
    table: TableWriter,
    path: PathBuf,
    axes: usize,
    /// Quantity and axis of each column besides the time.
    columns: Vec<(Quantity, usize)>,
    /// Representation of the time.
    time: fn(i64) -> Cell,
    row: Vec<Cell>,
}

impl RowWriter {
    /// Creates a CSV file and writes the header.
    ///
    /// # Errors
    /// Returns [`LogError`] for no joints, duplicate names, or an error of the system.
    pub fn create<'a>(
        path: &Path,
        names: impl Into<RecordedNames<'a>>,
        quantities: Quantities,
    ) -> Result<Self, LogError> {
        Self::csv(path, &names.into().driven(path)?, quantities)
    }

    fn csv(path: &Path, axes: &[AxisNames], quantities: Quantities) -> Result<Self, LogError> {
        if axes.is_empty() {
            let reason = "a recording needs at least one joint";
            return Err(write_error(path, reason.into()));
        }
        let columns = columns("time_s", CellKind::Text, axes, quantities);
        let table = TableWriter::csv(path, &columns)?;
        Ok(Self::of(table, path, axes, quantities, |time_ns| {
            let sign = if time_ns < 0 { "-" } else { "" };
            let time = time_ns.unsigned_abs();
            let (seconds, nanos) = (time / 1_000_000_000, time % 1_000_000_000);
            format!("{sign}{seconds}.{nanos:09}").into()
        }))
    }

    /// Creates a file whose rows contain these axes: Parquet if its name ends in `.parquet`, otherwise CSV.
    /// An axis without a joint has no column `q`, one without a tendon no column `tension`. A motor that is
    /// omitted for a joint has the name of the joint.
    ///
    /// # Errors
    /// Returns [`LogError`] for no axes, two columns of one name, a build without Parquet, or an error of the
    /// system.
    pub fn create_axes(
        path: &Path,
        axes: &[Axis<'_>],
        quantities: Quantities,
    ) -> Result<Self, LogError> {
        let axes = Vec::from_iter(axes.iter().copied().map(AxisNames::new));
        match super::is_parquet(path) {
            true => Self::parquet(path, &axes, quantities),
            false => Self::csv(path, &axes, quantities),
        }
    }

    /// Creates a Parquet file with the extension `.parquet`.
    ///
    /// # Errors
    /// Returns [`LogError`] for no joints, duplicate names, another extension, a build without Parquet, or an
    /// error of the system.
    pub fn create_parquet<'a>(
        path: &Path,
        names: impl Into<RecordedNames<'a>>,
        quantities: Quantities,
    ) -> Result<Self, LogError> {
        Self::parquet(path, &names.into().driven(path)?, quantities)
    }

    fn parquet(path: &Path, axes: &[AxisNames], quantities: Quantities) -> Result<Self, LogError> {
        if axes.is_empty() || !super::is_parquet(path) {
            let reason = "a recording as Parquet needs a joint and a name that ends in .parquet";
            return Err(write_error(path, reason.into()));
        }
        let columns = columns("time_ns", CellKind::Integer, axes, quantities);
        let table = TableWriter::create(path, &columns)?;
        Ok(Self::of(table, path, axes, quantities, Cell::Integer))
    }

    fn of(
        table: TableWriter,
        path: &Path,
        axes: &[AxisNames],
        quantities: Quantities,
        time: fn(i64) -> Cell,
    ) -> Self {
        let columns = value_columns(axes, quantities);
        Self {
            table,
            path: path.to_path_buf(),
            axes: axes.len(),
            columns: columns.into_iter().map(|(place, _)| place).collect(),
            time,
            row: Vec::new(),
        }
    }
}

impl FrameWriter for RowWriter {
    fn write(&mut self, frame: &Frame) -> Result<(), LogError> {
        check_lengths(frame, self.axes, &self.path)?;
        self.row.clear();
        self.row.push((self.time)(frame.time_ns));
        for (quantity, axis) in &self.columns {
            let value = frame.get(*quantity).get(*axis);
            self.row.push(Cell::Number(*value.unwrap_or(&f64::NAN)));
        }
        self.table.row(&self.row)
    }

    fn finish(self: Box<Self>) -> Result<(), LogError> {
        self.table.finish()
    }
}

fn columns(time: &str, kind: CellKind, axes: &[AxisNames], quantities: Quantities) -> Vec<Column> {
    let values = value_columns(axes, quantities).into_iter();
    let values = values.map(|(_, name)| (name, CellKind::Number));
    std::iter::once((time.into(), kind)).chain(values).collect()
}

/// Quantity and axis of the columns besides the time, with their names.
fn value_columns(axes: &[AxisNames], quantities: Quantities) -> Vec<((Quantity, usize), String)> {
    let of = |quantity: Quantity| match quantity {
        Quantity::Temperature => vec![((quantity, 0), "temperature_c".to_owned())],
        _ => {
            let name = |(place, axis): (usize, &AxisNames)| {
                let owner = axis.recorded(quantity)?;
                let name = format!("{}.{owner}{}", quantity.symbol(), quantity.suffix());
                Some(((quantity, place), name))
            };
            axes.iter().enumerate().filter_map(name).collect()
        }
    };
    quantities.iter().flat_map(of).collect()
}

/// Every vector of the frame must have one value per axis; that of the tensions may be empty.
pub(super) fn check_lengths(frame: &Frame, axes: usize, path: &Path) -> Result<(), LogError> {
    let no_tension = frame.tension.is_empty();
    let all = Quantity::PER_JOINT.into_iter();
    for quantity in all.chain((!no_tension).then_some(Quantity::Tension)) {
        let found = frame.get(quantity).len();
        if found != axes {
            let symbol = quantity.symbol();
            let reason = format!("the frame has {found} values of {symbol} for {axes} joints");
            return Err(write_error(path, reason));
        }
    }
    Ok(())
}
