//! Every frame's estimate as CSV.

use super::frames::FrameOutcome;
use crate::error::EstimateError;
use sinew_files::{AtomicFile, csv_cell};
use sinew_model::transmission::Transmission;
use std::fmt::Write as _;
use std::path::Path;

/// `--csv`: every frame's estimate.
pub(super) struct CsvSink {
    file: AtomicFile,
    elastic: Vec<usize>,
    line: String,
}

impl CsvSink {
    pub(super) fn create(
        path: &Path,
        names: &[String],
        transmissions: &[Option<Transmission>],
    ) -> Result<Self, EstimateError> {
        let mut file = AtomicFile::create(path)?;
        let elastic: Vec<usize> = (0..names.len())
            .filter(|&i| transmissions[i].is_some())
            .collect();
        let mut line = "time_ns,time_s".to_string();
        for &i in &elastic {
            for (symbol, unit) in [("delta_e", "_rad"), ("tau_el", "_nm"), ("usable", "")] {
                let column = format!("{symbol}.{}{unit}", names[i]);
                let _ = write!(line, ",{}", csv_cell(&column));
            }
        }
        line.push('\n');
        file.append(line.as_bytes())?;
        Ok(Self {
            file,
            elastic,
            line,
        })
    }

    pub(super) fn write(&mut self, outcome: &FrameOutcome<'_>) -> Result<(), EstimateError> {
        self.line.clear();
        let _ = write!(
            self.line,
            "{},{:.9}",
            outcome.time_ns,
            outcome.since_start_ns as f64 * 1e-9
        );
        for &i in &self.elastic {
            // A frame that could not be used has an empty estimate, not a stale one.
            if outcome.usable[i] {
                let _ = write!(
                    self.line,
                    ",{:.9},{:.6},1",
                    outcome.delta_e[i], outcome.tau_el[i]
                );
            } else {
                self.line.push_str(",,,0");
            }
        }
        self.line.push('\n');
        self.file.append(self.line.as_bytes())?;
        Ok(())
    }

    /// The file appears under its name.
    pub(super) fn finish(self) -> Result<(), EstimateError> {
        self.file.finish()?;
        Ok(())
    }
}
