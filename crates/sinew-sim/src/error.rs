//! Why a simulation was refused.

/// What can go wrong between a scenario file and a recording.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SimulateError {
    /// A scenario that can't be, with its place.
    #[error(transparent)]
    File(#[from] sinew_files::Located),
    /// A robot that can't be simulated.
    #[error("robot '{robot}': joint '{joint}' {why}")]
    Robot {
        /// Robot's name.
        robot: String,
        /// Joint at fault.
        joint: String,
        /// What is missing and what to do.
        why: &'static str,
    },
    /// The truth drawn makes an impossible arm.
    #[error("the truth of the scenario makes an impossible arm: {0}")]
    Arm(#[from] sinew_model::arm::ArmError),
    /// What the scenario says is known can't be used.
    #[error("what [correction] or [contact_detection] says can't be used: {0}")]
    Correction(#[from] sinew_model::correction::CorrectionError),
    /// The estimate the scenario names can't be used.
    #[error("{file}: no estimate to correct with: {why}; make one with sinew estimate LOG --json")]
    Estimate {
        /// File at fault.
        file: String,
        /// What is wrong with it.
        why: String,
    },
    /// The state left the range of numbers.
    #[error(
        "the simulation broke down at {time_s} s ({reason}); use a smaller integration_step_s or softer controller gains"
    )]
    Diverged {
        /// Simulated time, s.
        time_s: f64,
        /// What was seen.
        reason: String,
    },
    /// The recording could not be written.
    #[error(transparent)]
    Log(#[from] sinew_log::LogError),
    /// The file's name doesn't say its format.
    #[error(
        "{file}: recordings are written as MCAP, Parquet or CSV; name a file that ends in .mcap, .parquet or .csv"
    )]
    Format {
        /// Output asked for.
        file: String,
    },
    /// The truth file could not be written.
    #[error(transparent)]
    Output(#[from] sinew_files::OutputError),
    /// The truth could not be put into JSON.
    #[error("{file}: can't write the truth: {message}")]
    Truth {
        /// File at fault.
        file: String,
        /// What went wrong.
        message: String,
    },
}
