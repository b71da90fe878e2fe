//! Errors of the estimates.

use crate::robot_dir::RobotDirError;
use sinew_files::OutputError;
use sinew_log::LogError;
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
    /// Joint positions far beyond the limits of the URDF, and within these as degrees.
    Degrees {
        /// Joints with the range of their positions, rad.
        joints: Vec<(String, [f64; 2])>,
    },
}

/// Motor whose position is not proportional to the position of its joint with a factor near one.
#[derive(Debug, Clone, PartialEq)]
pub struct MotorRatio {
    /// Name of the joint.
    pub joint: String,
    /// Slope of the motor position over the joint position.
    pub slope: f64,
}

impl MotorRatio {
    /// Keys of the mapping's `theta` (or `q`) with which the slope is near one.
    fn remedy(&self) -> String {
        /// Maximum relative distance of a slope from the factor between two units: deflections of the spring.
        const MAX_FACTOR_ERROR: f64 = 0.1;
        let is = |factor: f64| (self.slope.abs() / factor - 1.0).abs() < MAX_FACTOR_ERROR;
        let sign = if self.slope < 0.0 { ", sign = -1" } else { "" };
        let degrees_per_rad = 180.0 / std::f64::consts::PI;
        let name = &self.joint;
        if is(1.0) {
            format!("[joints.{name}] theta = {{ …{sign} }}")
        } else if is(degrees_per_rad) {
            format!("[joints.{name}] theta = {{ …, unit = \"deg\"{sign} }}")
        } else if is(1.0 / degrees_per_rad) {
            format!("[joints.{name}] q = {{ …, unit = \"deg\"{sign} }}")
        } else {
            let ratio = self.slope.abs();
            format!("[joints.{name}] theta = {{ …, gear_ratio = {ratio:.4}{sign} }}")
        }
    }
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
            Self::Ratio { ratios } => {
                let slopes: Vec<String> = (ratios.iter())
                    .map(|r| format!("{:.4} at '{}'", r.slope, r.joint))
                    .collect();
                let lines: Vec<String> = ratios.iter().map(MotorRatio::remedy).collect();
                write!(
                    f,
                    "motor positions are a multiple of the joint positions, by a factor of {}; expected 1: a unit, the gear ratio or a sign is wrong; specify it in a mapping (--mapping): {}",
                    slopes.join(", "),
                    lines.join("; ")
                )
            }
        }
    }
}
