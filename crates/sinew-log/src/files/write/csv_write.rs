//! CSV with the column names of the design.

use std::io::Write as _;
use std::path::Path;

use sinew_files::{AtomicFile, csv_cell};

use super::FrameWriter;
use crate::error::LogError;
use crate::frame::{Frame, Quantities, Quantity};

/// Writes frames as CSV: `time_s` with nanoseconds, then the quantities chosen.
///
/// Numbers are written so that reading gives the same double; NaN is an empty cell.
#[derive(Debug)]
pub struct CsvWriter {
    file: AtomicFile,
    joints: usize,
    quantities: Quantities,
    line: Vec<u8>,
}

impl CsvWriter {
    /// Creates the file and writes the header.
    ///
    /// # Errors
    /// No joints, or the system refuses.
    pub fn create(
        path: &Path,
        joints: &[String],
        quantities: Quantities,
    ) -> Result<Self, LogError> {
        if joints.is_empty() {
            return Err(LogError::Write {
                file: path.display().to_string(),
                reason: "a recording needs at least one joint".to_owned(),
            });
        }
        let mut header = String::from("time_s");
        for name in value_columns(joints, quantities) {
            header.push(',');
            header.push_str(&csv_cell(&name));
        }
        header.push('\n');
        let mut file = AtomicFile::create(path)?;
        file.append(header.as_bytes())?;
        Ok(CsvWriter {
            file,
            joints: joints.len(),
            quantities,
            line: Vec::new(),
        })
    }
}

impl FrameWriter for CsvWriter {
    fn write(&mut self, frame: &Frame) -> Result<(), LogError> {
        check_lengths(frame, self.joints, self.file.path())?;
        self.line.clear();
        let sign = if frame.time_ns < 0 { "-" } else { "" };
        let time = frame.time_ns.unsigned_abs();
        let (seconds, nanos) = (time / 1_000_000_000, time % 1_000_000_000);
        // Writing into a vector cannot fail.
        let _ok = write!(self.line, "{sign}{seconds}.{nanos:09}");
        for quantity in self.quantities.iter() {
            for value in frame.get(quantity) {
                self.line.push(b',');
                if !value.is_nan() {
                    let _ok = write!(self.line, "{value:?}");
                }
            }
        }
        self.line.push(b'\n');
        Ok(self.file.append(&self.line)?)
    }

    fn finish(self: Box<Self>) -> Result<(), LogError> {
        Ok(self.file.finish()?)
    }
}

/// Names of the columns besides the time.
pub(super) fn value_columns(joints: &[String], quantities: Quantities) -> Vec<String> {
    let of = |quantity: Quantity| match quantity {
        Quantity::Temperature => vec!["temperature_c".to_owned()],
        _ => {
            let name = |joint| format!("{}.{joint}{}", quantity.symbol(), quantity.suffix());
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
            return Err(LogError::Write {
                file: path.display().to_string(),
                reason: format!(
                    "the frame has {found} values of {} for {joints} joints",
                    quantity.symbol()
                ),
            });
        }
    }
    Ok(())
}
