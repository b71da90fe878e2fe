//! Table of the estimates of all frames.

use super::frames::FrameOutcome;
use crate::error::EstimateError;
use sinew_log::{Cell, CellKind, Column, TableWriter};
use sinew_model::transmission::Transmission;
use std::path::Path;

/// Writer of the estimates of all frames (`--csv`); format CSV, or Parquet by the extension of the file name.
pub(super) struct FrameTable {
    table: TableWriter,
    elastic: Vec<usize>,
    row: Vec<Cell>,
}

impl FrameTable {
    pub(super) fn create(
        path: &Path,
        names: &[String],
        transmissions: &[Option<Transmission>],
    ) -> Result<Self, EstimateError> {
        let elastic: Vec<usize> = (0..names.len())
            .filter(|&i| transmissions[i].is_some())
            .collect();
        let mut columns: Vec<Column> = vec![
            ("time_ns".into(), CellKind::Integer),
            ("time_s".into(), CellKind::Number),
        ];
        for name in elastic.iter().map(|&i| &names[i]) {
            columns.push((format!("delta_e.{name}_rad"), CellKind::Number));
            columns.push((format!("tau_el.{name}_nm"), CellKind::Number));
            columns.push((format!("usable.{name}"), CellKind::Integer));
        }
        Ok(Self {
            table: TableWriter::create(path, &columns)?,
            elastic,
            row: Vec::with_capacity(columns.len()),
        })
    }

    pub(super) fn write(&mut self, outcome: &FrameOutcome<'_>) -> Result<(), EstimateError> {
        self.row.clear();
        self.row.push(outcome.time_ns.into());
        self.row.push((outcome.since_start_ns as f64 / 1e9).into());
        for &i in &self.elastic {
            // A frame that was not used has an empty estimate instead of the last one.
            let usable = outcome.usable[i];
            let estimate = |x: f64| Some(x).filter(|_| usable);
            self.row.push(estimate(outcome.delta_e[i]).into());
            self.row.push(estimate(outcome.tau_el[i]).into());
            self.row.push(i64::from(usable).into());
        }
        Ok(self.table.row(&self.row)?)
    }

    /// Completes the file under its final name.
    pub(super) fn finish(self) -> Result<(), EstimateError> {
        Ok(self.table.finish()?)
    }
}
