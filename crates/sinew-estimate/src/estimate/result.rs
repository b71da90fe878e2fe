//! What an estimate says, as data: the table, the JSON and the report are made from this alone.

use crate::feeder::Injection;
use serde::Serialize;

/// The estimate of one recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Estimate {
    /// Version of the program that made it.
    pub sinew_version: String,
    /// The recording.
    pub recording: RecordingInfo,
    /// The robot.
    pub robot: RobotInfo,
    /// How it was made.
    pub settings: Settings,
    /// One entry per joint of the robot, in its order.
    pub joints: Vec<JointEstimate>,
    /// Frames of the recording that could not be used for any joint, by reason.
    pub losses: Vec<Loss>,
    /// Whether data was lost to damage (exit code 3).
    pub damaged: bool,
    /// What the reader should know, in sentences.
    pub warnings: Vec<String>,
    /// What the numbers rest on.
    pub basis: Vec<Basis>,
}

/// What was read.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RecordingInfo {
    /// File name as given.
    pub path: String,
    /// "MCAP", "CSV" or "Parquet".
    pub format: String,
    /// Time of the first frame, ns since the recording's epoch.
    pub start_time_ns: i64,
    /// From first to last frame, s.
    pub duration_s: f64,
    /// Frames read.
    pub frames: u64,
    /// Median frame rate, Hz.
    pub rate_hz: f64,
    /// Stretches without a gap or clock jump.
    pub segments: u32,
}

/// What it was held against.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RobotInfo {
    /// Name in the URDF.
    pub name: String,
    /// Where the robot's file is.
    pub file: String,
    /// Where the URDF comes from: a file, or the recording's own description.
    pub urdf: String,
}

/// How the estimate was made.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Settings {
    /// "observer", "torque-sensor" or "motor": where `tau_el` comes from.
    pub source: String,
    /// "matched" or "paper": whether `theta − q` lags like the observed torque.
    pub comparison: String,
    /// Observer gain `K_I`, 1/s.
    pub gain_per_s: f64,
    /// Cut-off of the velocity filter, rad/s; `None`: recorded velocities, unfiltered positions.
    pub velocity_filter_rad_per_s: Option<f64>,
    /// Whether the recording's known external torque was used.
    pub tau_ext: bool,
    /// Offsets added by hand.
    pub injected: Vec<Injection>,
    /// Recording the estimate is compared with.
    pub reference: Option<String>,
}

/// Frames that gave no estimate, and why.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Loss {
    /// Reason, in words ("settling after the start or a gap", "motor position missing", …).
    pub reason: String,
    /// How many frames.
    pub frames: u64,
    /// Share of all frames, 0 to 1.
    pub share: f64,
}

/// The estimate of one joint.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointEstimate {
    /// Joint.
    pub name: String,
    /// `None` where there is an estimate; else why there is none.
    pub refused: Option<String>,
    /// Mean offset of the motor position, rad (NaN, written as null, where refused).
    pub delta_e_rad: f64,
    /// The same in mrad.
    pub delta_e_mrad: f64,
    /// Standard deviation of the single estimates, mrad.
    pub scatter_mrad: f64,
    /// Standard error of the mean that respects their correlation (batch means), mrad; NaN (null)
    /// when the recording is too short for one.
    pub standard_error_mrad: f64,
    /// Elongation of the tendon, mm; `None` without tendon geometry.
    pub elongation_mm: Option<f64>,
    /// Standard error of the elongation, mm.
    pub elongation_standard_error_mm: Option<f64>,
    /// Strain of the tendon, %.
    pub strain_percent: Option<f64>,
    /// Frames that gave an estimate.
    pub usable_frames: u64,
    /// Their share of all frames, 0 to 1.
    pub usable_share: f64,
    /// Why the rest didn't.
    pub losses: Vec<Loss>,
    /// Stiffness used, N·m/rad.
    pub stiffness_nm_per_rad: f64,
    /// Smallest, mean and largest elastic torque, N·m.
    pub tau_el_nm: [f64; 3],
    /// What 1 % too much stiffness adds to the offset, mrad: `mean(tau_el)/K · 1 %`. An error of
    /// the masses has the same size and the opposite sign.
    pub stiffness_error_mrad_per_percent: f64,
    /// Against the reference recording.
    pub difference: Option<Difference>,
    /// The estimate over time.
    pub series: Series,
}

/// Change since a reference recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Difference {
    /// Offset of the reference, mrad.
    pub reference_mrad: f64,
    /// Offset now minus offset then, mrad.
    pub difference_mrad: f64,
    /// Standard error of the difference, mrad.
    pub standard_error_mrad: f64,
    /// The difference as elongation, mm.
    pub elongation_mm: Option<f64>,
    /// What 1 % too much stiffness adds to the difference, mrad.
    pub stiffness_error_mrad_per_percent: f64,
}

/// A joint's estimate over time, averaged into at most [`Series::POINTS`] intervals.
///
/// All columns have the same length; intervals without an estimate hold NaN (null).
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Series {
    /// Middle of each interval, s from the start of the recording.
    pub time_s: Vec<f64>,
    /// Mean offset, mrad.
    pub delta_e_mrad: Vec<f64>,
    /// Smallest offset in the interval, mrad.
    pub delta_e_min_mrad: Vec<f64>,
    /// Largest offset in the interval, mrad.
    pub delta_e_max_mrad: Vec<f64>,
    /// Mean elastic torque from the source chosen, N·m.
    pub tau_el_nm: Vec<f64>,
    /// Mean torque of the spring as the encoders show it, `K (theta_measured − q)`, N·m.
    pub tau_spring_nm: Vec<f64>,
    /// Mean joint position, rad.
    pub q_rad: Vec<f64>,
    /// Share of the interval's frames that could be used, 0 to 1.
    pub usable_share: Vec<f64>,
}

impl Series {
    /// Most intervals a series holds, however long the recording.
    pub const POINTS: usize = 2000;
}

/// What a quantity rests on.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Basis {
    /// Quantity, with its unit.
    pub quantity: String,
    /// Where it comes from, in words.
    pub rests_on: String,
}
