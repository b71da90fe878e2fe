//! Why a simulation was refused.

/// What can go wrong between a scenario file and a recording.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SimulateError {
    /// The operating system refused.
    #[error("{file}: can't {action}: {source}")]
    Io {
        /// File at fault.
        file: String,
        /// What was tried.
        action: &'static str,
        /// The system's word.
        source: std::io::Error,
    },
    /// Not TOML.
    #[error("{file}: {message}")]
    Toml {
        /// Name of the file.
        file: String,
        /// What the parser says, with line and column.
        message: String,
    },
    /// A key that means nothing here.
    #[error("{file}, line {line}: '{key}' is not a key of {section}; it takes {known}")]
    UnknownKey {
        /// Name of the file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Key found.
        key: String,
        /// Where it stands.
        section: String,
        /// Keys there are.
        known: String,
    },
    /// A value that can't be, or is of the wrong type.
    #[error("{file}, line {line}: {key} = {value}: {why}")]
    Value {
        /// Name of the file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Full key, with the unit in its name.
        key: String,
        /// Value found, as written.
        value: String,
        /// What it must be.
        why: String,
    },
    /// A key that is needed and isn't there.
    #[error("{file}, line {line}: {section} needs {key}: {why}")]
    Missing {
        /// Name of the file.
        file: String,
        /// Line of the section, from 1.
        line: usize,
        /// Where it is missing.
        section: String,
        /// The key.
        key: String,
        /// What it is for.
        why: String,
    },
    /// A joint or link the robot doesn't have.
    #[error("{file}, line {line}: {what} '{name}' is not in robot '{robot}'; it has {known}")]
    Unknown {
        /// Name of the file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// `joint` or `link`.
        what: &'static str,
        /// Name found.
        name: String,
        /// Robot's name.
        robot: String,
        /// Names there are.
        known: String,
    },
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
    /// Parquet is read, not written.
    #[error(
        "{file}: recordings are written as MCAP or CSV; name a file that ends in .mcap or .csv"
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
