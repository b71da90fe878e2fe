//! Why there is no estimate.

use crate::robot_dir::RobotDirError;
use sinew_files::OutputError;
use sinew_log::LogError;
use sinew_model::offset::{MapError, OffsetConfigError};

/// Why there is no estimate. Nothing has been written then.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EstimateError {
    /// The recording can't be read.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The robot can't be loaded.
    #[error(transparent)]
    Robot(#[from] RobotDirError),
    /// The catalogue of ropes can't be read.
    #[error(transparent)]
    Ropes(#[from] sinew_rope::CatalogueError),
    /// The settings don't make an estimator.
    #[error(transparent)]
    Config(#[from] OffsetConfigError),
    /// An output file can't be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// Recording and robot (or settings) don't go together.
    #[error("{file}: {why}")]
    Mismatch {
        /// The recording.
        file: String,
        /// What doesn't fit and what to do.
        why: String,
    },
    /// `--inject` with a joint or value nobody has.
    #[error("can't inject an offset: {0}")]
    Injection(String),
    /// Motor and joint side can't be the two sides of springs.
    #[error("{file}: {fault}")]
    Sides {
        /// The recording.
        file: String,
        /// What is wrong with them.
        fault: SidesFault,
    },
    /// A mark is said to be passed where none is, or when nothing was recorded.
    #[error("no mark is read: {0}")]
    Touch(String),
}

/// Why there is no session estimate.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SessionError {
    /// Recording or robot can't be used.
    #[error(transparent)]
    Estimate(#[from] EstimateError),
    /// The estimator refused.
    #[error("{file}: {error}")]
    Map {
        /// The recording.
        file: String,
        /// Why.
        error: MapError,
    },
    /// An online estimate that is provisional is not saved.
    #[error(
        "{recording}: an offset is provisional (no window solved yet, or a change that has not settled); save when none is, or keep the file from before"
    )]
    Provisional {
        /// The recording, or what stands for it.
        recording: String,
    },
    /// The baseline file can't be used.
    #[error("{file}: {why}")]
    Baseline {
        /// The file.
        file: String,
        /// Why, and what to do.
        why: String,
    },
}

/// Why motor and joint side can't be the two sides of springs.
#[derive(Debug, Clone, PartialEq)]
pub enum SidesFault {
    /// Both are one signal at these joints.
    Same {
        /// Joints.
        joints: Vec<String>,
    },
    /// Springs that turn against what they carry.
    Opposed {
        /// Which.
        springs: Vec<OpposedSpring>,
    },
}

/// A spring that turns against what it carries.
#[derive(Debug, Clone, PartialEq)]
pub struct OpposedSpring {
    /// Joint.
    pub joint: String,
    /// How far its deflection lies about the turned one that masses and motion ask for, over how far about that one; above 1
    /// is right.
    pub turned_share: f64,
}

impl std::fmt::Display for SidesFault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Same { joints } => {
                let joints: Vec<String> = joints.iter().map(|name| format!("'{name}'")).collect();
                write!(
                    f,
                    "motor and joint position of {} are the same all the time: both come from one encoder or one topic; name the motor side with --motor-topic, --motor-interface or --mapping",
                    joints.join(", ")
                )
            }
            Self::Opposed { springs } => {
                let springs: Vec<String> = (springs.iter())
                    .map(|s| format!("{:.1} times at '{}'", 1.0 / s.turned_share, s.joint))
                    .collect();
                write!(
                    f,
                    "motor and joint side look swapped, or one has the wrong sign: turned round, what the springs show fits the described masses better, {}; look at topics, interfaces, columns and signs (--mapping); if they are right, at gravity_m_s2, and for a counterweight that the URDF lacks",
                    springs.join(", ")
                )
            }
        }
    }
}
