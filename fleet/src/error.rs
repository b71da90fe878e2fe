//! Why there is no answer.

use std::path::PathBuf;

/// Why there is no answer.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FleetError {
    /// A folder that isn't one, or can't be read or made.
    #[error("{path}: {source}", path = path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// Records would be mixed with others'.
    #[error("{path} has files in it; name a folder that is new or empty", path = .0.display())]
    NotEmpty(PathBuf),
    /// Nothing to read.
    #[error(
        "{path}: no file of records in it; give the folder that holds the monitors' records/, or make one up with sinew-fleet simulate", path = .0.display()
    )]
    NoRecords(PathBuf),
    /// No tendon can creep.
    #[error(
        "{robot}: no joint has a tendon with a rope, a pretension and retension_at_mm; a simulated fleet needs them"
    )]
    NoTendon {
        /// The robot.
        robot: String,
    },
    /// A text file, with the place of what is wrong.
    #[error(transparent)]
    File(#[from] sinew_files::Located),
    /// A table to write.
    #[error(transparent)]
    Log(#[from] sinew_log::LogError),
    /// A robot.
    #[error(transparent)]
    Robot(#[from] sinew_estimate::robot_dir::RobotDirError),
    /// A rope.
    #[error(transparent)]
    Catalogue(#[from] sinew_rope::CatalogueError),
    /// SQL, or a query that can't be done.
    #[error("{0}")]
    Engine(String),
}

impl From<datafusion::error::DataFusionError> for FleetError {
    fn from(error: datafusion::error::DataFusionError) -> Self {
        Self::Engine(error.strip_backtrace())
    }
}
