//! CSV with the column names of the design.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use super::FrameWriter;
use super::partial::Partial;
use crate::error::LogError;
use crate::frame::{Frame, Quantities, Quantity};

/// Writes frames as CSV: `time_s` with nanoseconds, then the quantities chosen.
///
/// Numbers are written so that reading gives the same double; NaN is an empty cell.
#[derive(Debug)]
pub struct CsvWriter {
    // Before `partial`: the file is closed before it is renamed or removed.
    out: BufWriter<File>,
    partial: Partial,
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
        for quantity in quantities.iter() {
            match quantity {
                Quantity::Temperature => header.push_str(",temperature_c"),
                _ => {
                    for joint in joints {
                        let name = format!("{}.{joint}{}", quantity.symbol(), quantity.suffix());
                        header.push(',');
                        header.push_str(&quoted(&name));
                    }
                }
            }
        }
        header.push('\n');
        let (partial, mut out) = Partial::create(path)?;
        out.write_all(header.as_bytes())
            .map_err(|source| partial.io("write", source))?;
        Ok(CsvWriter {
            out,
            partial,
            joints: joints.len(),
            quantities,
            line: Vec::new(),
        })
    }
}

impl FrameWriter for CsvWriter {
    fn write(&mut self, frame: &Frame) -> Result<(), LogError> {
        check_lengths(frame, self.joints, &self.partial)?;
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
        self.out
            .write_all(&self.line)
            .map_err(|source| self.partial.io("write", source))
    }

    fn finish(self: Box<Self>) -> Result<(), LogError> {
        let CsvWriter {
            mut out, partial, ..
        } = *self;
        out.flush().map_err(|source| partial.io("write", source))?;
        drop(out);
        partial.finish()
    }
}

fn quoted(name: &str) -> std::borrow::Cow<'_, str> {
    if name.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", name.replace('"', "\"\"")).into()
    } else {
        name.into()
    }
}

/// Every vector of the frame must have one value per joint.
pub(super) fn check_lengths(
    frame: &Frame,
    joints: usize,
    partial: &Partial,
) -> Result<(), LogError> {
    for quantity in Quantity::PER_JOINT {
        let found = frame.get(quantity).len();
        if found != joints {
            return Err(LogError::Write {
                file: partial.name(),
                reason: format!(
                    "the frame has {found} values of {} for {joints} joints",
                    quantity.symbol()
                ),
            });
        }
    }
    Ok(())
}
