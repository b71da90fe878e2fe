//! Errors of a simulation.

/// Error between a scenario file and a recording.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SimulateError {
    /// The scenario is invalid; with file and line.
    #[error(transparent)]
    File(#[from] sinew_files::Located),
    /// The robot cannot be simulated.
    #[error("robot '{robot}': joint '{joint}' {reason}")]
    Robot {
        /// Name of the robot.
        robot: String,
        /// Name of the joint.
        joint: String,
        /// Missing property and remedy.
        reason: &'static str,
    },
    /// The drawn truth is not a valid arm.
    #[error("the drawn truth of the scenario is not a valid arm: {0}")]
    Arm(#[from] sinew_model::arm::ArmError),
    /// The specified correction is invalid.
    #[error("invalid [correction] or [contact_detection]: {0}")]
    Correction(#[from] sinew_model::correction::CorrectionError),
    /// The estimate named in the scenario is invalid.
    #[error(
        "{file}: no estimate for the correction: {reason}; create it with sinew estimate LOG --json"
    )]
    Estimate {
        /// Name of the file.
        file: String,
        /// Reason of the failure.
        reason: String,
    },
    /// The simulation diverged.
    #[error(
        "the simulation diverged at {time_s} s ({reason}); reduce integration_step_s or the controller gains"
    )]
    Diverged {
        /// Simulated time, s.
        time_s: f64,
        /// Observation that shows the failure.
        reason: String,
    },
    /// The recording could not be written.
    #[error(transparent)]
    Log(#[from] sinew_log::LogError),
    /// The file name has no supported extension.
    #[error("{file}: unsupported file extension; use .mcap, .parquet or .csv")]
    Format {
        /// Name of the requested output file.
        file: String,
    },
    /// The format does not support the recorded quantities.
    #[error("{file}: MCAP supports one motor per joint and no tensions; use .parquet or .csv")]
    Axes {
        /// Name of the requested output file.
        file: String,
    },
    /// The truth file could not be written.
    #[error(transparent)]
    Output(#[from] sinew_files::OutputError),
    /// The truth could not be put into JSON.
    #[error("{file}: cannot write the truth: {message}")]
    Truth {
        /// Name of the file.
        file: String,
        /// Error message of the system.
        message: String,
    },
}
