//! What is asked of an estimate.

use crate::feeder::Injection;
use crate::given::Given;
use crate::touch::Touch;
use sinew_log::OpenOptions;
use sinew_model::offset::{Comparison, OffsetConfig, TorqueSource, VelocityFilter};
use std::path::PathBuf;

/// What is asked.
#[derive(Debug, Clone)]
pub struct Request {
    /// Recording.
    pub log: PathBuf,
    /// Robot's folder or `robot.toml`; `None` looks beside the recording, then here.
    pub robot: Option<PathBuf>,
    /// Where `tau_el` comes from.
    pub source: TorqueSource,
    /// Lag treatment.
    pub comparison: Comparison,
    /// Observer gain, 1/s; `None` for the default.
    pub gain_per_s: Option<f64>,
    /// Where velocities come from.
    pub velocity_filter: VelocityFilter,
    /// Use the recording's known external torque.
    pub use_tau_ext: bool,
    /// Offsets to add to the measured motor positions.
    pub injections: Vec<Injection>,
    /// Marks that joints or motors pass.
    pub touches: Vec<Touch>,
    /// Recording to compare with, made with the same robot and settings.
    pub reference: Option<PathBuf>,
    /// How recordings are read.
    pub open: OpenOptions,
    /// Where every frame's estimate goes as CSV.
    pub csv: Option<PathBuf>,
    /// What of it is in memory and no file.
    pub given: Given,
}

impl Request {
    /// The defaults for a recording.
    pub fn new(log: PathBuf) -> Self {
        let defaults = OffsetConfig::default();
        Self {
            log,
            robot: None,
            source: defaults.source,
            comparison: defaults.comparison,
            gain_per_s: None,
            velocity_filter: defaults.velocity,
            use_tau_ext: false,
            injections: Vec::new(),
            touches: Vec::new(),
            reference: None,
            open: OpenOptions::default(),
            csv: None,
            given: Given::default(),
        }
    }

    /// The recording as messages name it.
    pub(crate) fn name(&self) -> String {
        self.log.display().to_string()
    }

    pub(crate) fn config(&self) -> OffsetConfig {
        OffsetConfig {
            source: self.source,
            comparison: self.comparison,
            gain_per_s: self
                .gain_per_s
                .unwrap_or(OffsetConfig::default().gain_per_s),
            velocity: self.velocity_filter,
        }
    }
}

/// How far an estimate has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Bytes read of the recording under way.
    pub bytes_done: u64,
    /// Bytes there are.
    pub bytes_total: u64,
    /// Frames estimated so far.
    pub frames: u64,
    /// Whether this is the reference recording.
    pub reference: bool,
}
