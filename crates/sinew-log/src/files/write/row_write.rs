//! Recordings as tables, with the column names of the design.

use super::{Cell, CellKind, Column, FrameWriter, TableWriter, refuse};
use crate::error::LogError;
use crate::frame::{DrivenJoint, Frame, Quantities, Quantity};
use std::path::{Path, PathBuf};

/// Names in a recording, in the order of the frames.
#[derive(Debug, Clone, Copy)]
pub struct RecordedNames<'a> {
    /// Joints.
    pub joints: &'a [String],
    /// Motor that stands beside each joint, under whose name its position and torque are recorded.
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
    pub(super) fn driven(&self, path: &Path) -> Result<Vec<DrivenJoint>, LogError> {
        if self.joints.len() != self.motors.len() {
            let (joints, motors) = (self.joints.len(), self.motors.len());
            let why = format!("{joints} joints have {motors} motors: each has one");
            return Err(refuse(path, why));
        }
        let pairs = self.joints.iter().zip(self.motors);
        Ok(pairs
            .map(|(joint, motor)| DrivenJoint::new(joint, Some(motor)))
            .collect())
    }
}

/// Writes frames as rows: the time, then the quantities chosen; NaN is an empty cell, in Parquet null.
///
/// CSV has `time_s` with nanoseconds, and numbers such that reading gives the same double; Parquet has `time_ns`.
pub struct RowWriter {
    table: TableWriter,
    path: PathBuf,
    joints: usize,
    quantities: Quantities,
    /// How a time is written.
    time: fn(i64) -> Cell,
    row: Vec<Cell>,
}

impl RowWriter {
    /// Creates a CSV file and writes the header.
    ///
    /// # Errors
    /// No joints, two of one name, or the system refuses.
    pub fn create<'a>(
        path: &Path,
        names: impl Into<RecordedNames<'a>>,
        quantities: Quantities,
    ) -> Result<Self, LogError> {
        let joints = names.into().driven(path)?;
        if joints.is_empty() {
            let why = "a recording needs at least one joint";
            return Err(refuse(path, why.into()));
        }
        let columns = columns("time_s", CellKind::Text, &joints, quantities);
        let table = TableWriter::csv(path, &columns)?;
        Ok(Self::of(table, path, &joints, quantities, |time_ns| {
            let sign = if time_ns < 0 { "-" } else { "" };
            let time = time_ns.unsigned_abs();
            let (seconds, nanos) = (time / 1_000_000_000, time % 1_000_000_000);
            format!("{sign}{seconds}.{nanos:09}").into()
        }))
    }

    /// Creates a Parquet file, whose name ends in `.parquet`.
    ///
    /// # Errors
    /// No joints, two of one name, another ending, a build without Parquet, or the system refuses.
    pub fn create_parquet<'a>(
        path: &Path,
        names: impl Into<RecordedNames<'a>>,
        quantities: Quantities,
    ) -> Result<Self, LogError> {
        let joints = names.into().driven(path)?;
        if joints.is_empty() || !super::is_parquet(path) {
            let why = "a recording as Parquet needs a joint and a name that ends in .parquet";
            return Err(refuse(path, why.into()));
        }
        let columns = columns("time_ns", CellKind::Integer, &joints, quantities);
        let table = TableWriter::create(path, &columns)?;
        Ok(Self::of(table, path, &joints, quantities, Cell::Integer))
    }

    fn of(
        table: TableWriter,
        path: &Path,
        joints: &[DrivenJoint],
        quantities: Quantities,
        time: fn(i64) -> Cell,
    ) -> Self {
        Self {
            table,
            path: path.to_path_buf(),
            joints: joints.len(),
            quantities,
            time,
            row: Vec::new(),
        }
    }
}

impl FrameWriter for RowWriter {
    fn write(&mut self, frame: &Frame) -> Result<(), LogError> {
        check_lengths(frame, self.joints, &self.path)?;
        self.row.clear();
        self.row.push((self.time)(frame.time_ns));
        for quantity in self.quantities.iter() {
            let values = frame.get(quantity).iter();
            self.row.extend(values.map(|value| Cell::Number(*value)));
        }
        self.table.row(&self.row)
    }

    fn finish(self: Box<Self>) -> Result<(), LogError> {
        self.table.finish()
    }
}

fn columns(
    time: &str,
    kind: CellKind,
    joints: &[DrivenJoint],
    quantities: Quantities,
) -> Vec<Column> {
    let values = value_columns(joints, quantities).into_iter();
    let values = values.map(|name| (name, CellKind::Number));
    std::iter::once((time.into(), kind)).chain(values).collect()
}

/// Names of the columns besides the time.
fn value_columns(joints: &[DrivenJoint], quantities: Quantities) -> Vec<String> {
    let of = |quantity: Quantity| match quantity {
        Quantity::Temperature => vec!["temperature_c".to_owned()],
        _ => {
            let name = |joint: &DrivenJoint| {
                let owner = joint.recorded(quantity);
                format!("{}.{owner}{}", quantity.symbol(), quantity.suffix())
            };
            joints.iter().map(name).collect()
        }
    };
    quantities.iter().flat_map(of).collect()
}

/// Every vector of the frame must have one value per joint.
pub(super) fn check_lengths(frame: &Frame, joints: usize, path: &Path) -> Result<(), LogError> {
    for quantity in Quantity::PER_JOINT {
        let found = frame.get(quantity).len();
        if found != joints {
            let symbol = quantity.symbol();
            let why = format!("the frame has {found} values of {symbol} for {joints} joints");
            return Err(refuse(path, why));
        }
    }
    Ok(())
}
