//! Errors of the estimates.

use crate::robot_dir::RobotDirError;
use sinew_files::OutputError;
use sinew_log::{LogError, MotorRatio, describe_ratios};
use sinew_model::offset::{MapError, OffsetConfigError};

/// Error of an estimate; no file has been written then.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EstimateError {
    /// The recording cannot be read.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The robot cannot be loaded.
    #[error(transparent)]
    Robot(#[from] RobotDirError),
    /// The rope catalogue cannot be read.
    #[error(transparent)]
    Ropes(#[from] sinew_rope::CatalogueError),
    /// The settings of the estimator are invalid.
    #[error(transparent)]
    Config(#[from] OffsetConfigError),
    /// An output file cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// Recording and robot (or settings) are inconsistent.
    #[error("{file}: {reason}")]
    Mismatch {
        /// Name of the recording.
        file: String,
        /// Inconsistency and its remedy.
        reason: String,
    },
    /// `--inject` with an unknown joint or an invalid value.
    #[error("cannot inject an offset: {0}")]
    Injection(String),
    /// Motor and joint side are not the two sides of elastic joints.
    #[error("{file}: {fault}")]
    Sides {
        /// Name of the recording.
        file: String,
        /// Fault of the two sides.
        fault: SidesFault,
    },
    /// An index mark is specified where robot.toml has none, or at a time without a frame.
    #[error("invalid index mark: {0}")]
    Touch(String),
}

/// Error of a session estimate.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SessionError {
    /// Recording or robot cannot be used.
    #[error(transparent)]
    Estimate(#[from] EstimateError),
    /// The estimator has no solution.
    #[error("{file}: {error}")]
    Map {
        /// Name of the recording.
        file: String,
        /// Error of the estimator.
        error: MapError,
    },
    /// The transmission of a joint was lost in a recording for a baseline.
    #[error(
        "{file}: '{joint}' transmits no torque from {time_s:.1} s on: the tendon is torn or off its pulley, or its motor side is detached; repair the tendon and record the baseline again"
    )]
    TransmissionLost {
        /// Name of the recording.
        file: String,
        /// Name of the joint or tendon.
        joint: String,
        /// Onset since the start of the recording, s.
        time_s: f64,
    },
    /// A provisional online estimate cannot be saved.
    #[error(
        "{recording}: an offset is provisional (no window solved yet, or an unresolved change); save when no offset is provisional, or keep the previous file"
    )]
    Provisional {
        /// Name of the recording or session.
        recording: String,
    },
    /// The baseline file cannot be used.
    #[error("{file}: {reason}")]
    Baseline {
        /// Name of the baseline file.
        file: String,
        /// Reason and remedy.
        reason: String,
    },
}

/// Reason why motor and joint side are not the two sides of elastic joints.
#[derive(Debug, Clone, PartialEq)]
pub enum SidesFault {
    /// Both sides are the same signal at these joints.
    Same {
        /// Names of the joints.
        joints: Vec<String>,
    },
    /// Deflections of springs have the opposite sign of their load.
    Opposed {
        /// Springs with the opposite sign.
        springs: Vec<OpposedSpring>,
    },
    /// Motors move by a constant multiple of their joints that is not near one: another unit, a missing gear ratio or a
    /// wrong sign.
    Ratio {
        /// Joints with the ratio of their motors.
        ratios: Vec<MotorRatio>,
    },
    /// Motors that each follow the joint of the other, and not their own.
    SwappedMotors {
        /// Names of the joints, in pairs.
        pairs: Vec<[String; 2]>,
    },
    /// Motor positions that are constant in the whole recording while their joints move.
    ConstantMotor {
        /// Motors with their constant position.
        motors: Vec<ConstantMotor>,
    },
    /// Joint positions far beyond the limits of the URDF, and within these as degrees.
    Degrees {
        /// Joints with the range of their positions, rad.
        joints: Vec<(String, [f64; 2])>,
    },
}

/// Motor whose position is constant while its joint travels farther than its spring can be bent.
#[derive(Debug, Clone, PartialEq)]
pub struct ConstantMotor {
    /// Name of the joint.
    pub joint: String,
    /// Constant motor position, rad.
    pub motor_rad: f64,
    /// Range of the joint position, rad.
    pub joint_travel_rad: f64,
    /// Whether the joint is prismatic: values in rad are then in m.
    pub slides: bool,
}

/// Spring whose deflection has the opposite sign of its load.
#[derive(Debug, Clone, PartialEq)]
pub struct OpposedSpring {
    /// Name of the joint.
    pub joint: String,
    /// Scatter of the deflection about the expected deflection with opposite sign, divided by the scatter about the
    /// expected deflection; above 1 if the sign is right.
    pub turned_share: f64,
}

impl std::fmt::Display for SidesFault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Same { joints } => {
                let joints: Vec<String> = joints.iter().map(|name| format!("'{name}'")).collect();
                write!(
                    f,
                    "motor and joint positions of {} are identical in all frames: both come from one encoder or one topic; specify the motor side with --motor-topic, --motor-interface or --mapping",
                    joints.join(", ")
                )
            }
            Self::Opposed { springs } => {
                let springs: Vec<String> = (springs.iter())
                    .map(|s| {
                        format!(
                            "by a factor of {:.1} at '{}'",
                            1.0 / s.turned_share,
                            s.joint
                        )
                    })
                    .collect();
                write!(
                    f,
                    "motor and joint side are probably swapped, or one has the wrong sign: with the opposite sign the spring deflections agree better with the described masses, {}; check topics, interfaces, columns and signs (--mapping); if these are right, check gravity_m_s2 and whether the URDF lacks a counterweight",
                    springs.join(", ")
                )
            }
            Self::SwappedMotors { pairs } => {
                let pairs: Vec<String> = (pairs.iter())
                    .map(|[one, other]| format!("'{one}' and '{other}'"))
                    .collect();
                write!(
                    f,
                    "the motor position of each of these joints follows the other joint, and not its own: {}; exchange theta of both joints in a mapping (--mapping)",
                    pairs.join(", ")
                )
            }
            Self::ConstantMotor { motors } => {
                let constant: Vec<String> = (motors.iter())
                    .map(|m| {
                        let unit = if m.slides { "m" } else { "rad" };
                        format!(
                            "'{}' at {:.4} {unit} while the joint moved {:.2} {unit}",
                            m.joint, m.motor_rad, m.joint_travel_rad
                        )
                    })
                    .collect();
                let lines: Vec<String> = (motors.iter())
                    .map(|m| format!("[joints.{}] theta = {{ … }}", m.joint))
                    .collect();
                write!(
                    f,
                    "motor positions are constant in the whole recording: {}; the motor encoder is not connected, or the channel is another one; check the drive, or specify the channel of the motor in a mapping (--mapping): {}",
                    constant.join(", "),
                    lines.join("; ")
                )
            }
            Self::Degrees { joints } => {
                let ranges: Vec<String> = (joints.iter())
                    .map(|(name, [low, high])| format!("'{name}' {low:.1} to {high:.1} rad"))
                    .collect();
                write!(
                    f,
                    "joint positions are beyond the limits of the URDF, and within them as degrees: {}; specify unit = \"deg\" for q and theta in a mapping (--mapping)",
                    ranges.join(", ")
                )
            }
            Self::Ratio { ratios } => f.write_str(&describe_ratios(ratios)),
        }
    }
}
