//! Inputs and settings of an estimate.

use crate::feeder::Injection;
use crate::given::Given;
use crate::touch::Touch;
use sinew_log::OpenOptions;
use sinew_model::offset::{Comparison, OffsetConfig, TorqueSource, VelocityFilter};
use std::path::PathBuf;

/// Inputs and settings of an estimate.
#[derive(Debug, Clone)]
pub struct Request {
    /// Path of the recording.
    pub log: PathBuf,
    /// Folder of the robot or `robot.toml`; `None` searches the folder of the recording, then the current folder.
    pub robot: Option<PathBuf>,
    /// Source of the elastic torque `tau_el`.
    pub source: TorqueSource,
    /// Treatment of the observer lag.
    pub comparison: Comparison,
    /// Observer gain, 1/s; `None` for the default.
    pub gain_per_s: Option<f64>,
    /// Source of the velocities.
    pub velocity_filter: VelocityFilter,
    /// Whether the recorded external torque is used.
    pub use_tau_ext: bool,
    /// Offsets to add to the measured motor positions.
    pub injections: Vec<Injection>,
    /// Index marks that joints or motors pass.
    pub touches: Vec<Touch>,
    /// Reference recording, estimated with the same robot and settings.
    pub reference: Option<PathBuf>,
    /// Options for reading recordings.
    pub open: OpenOptions,
    /// Date of the recording, s since 1970 UTC, which replaces that of its clock in the result of the absolute method.
    pub date_utc_s: Option<f64>,
    /// CSV file for the estimate of every frame.
    pub csv: Option<PathBuf>,
    /// Inputs in memory instead of files.
    pub given: Given,
}

impl Request {
    /// Creates a request with default settings for a recording.
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
            date_utc_s: None,
            csv: None,
            given: Given::default(),
        }
    }

    /// Returns the name of the recording in messages.
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

/// Progress of an estimate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Number of bytes read of the current recording.
    pub bytes_done: u64,
    /// Size of the current recording, bytes.
    pub bytes_total: u64,
    /// Number of frames estimated so far.
    pub frames: u64,
    /// Whether the current recording is the reference.
    pub reference: bool,
}
