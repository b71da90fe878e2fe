//! What is said of a recording, in words and units.

use serde::Serialize;

/// Offsets since the baseline.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Absolute {
    /// The robot.
    pub robot: String,
    /// The recording.
    pub recording: String,
    /// First recording of the baseline; `None`: data-sheet priors only.
    pub baseline: Option<String>,
    /// When the part used began, s since 1970 UTC; `None` where the recording's clock doesn't say.
    pub start_time_utc_s: Option<f64>,
    /// Length of the part used, s.
    pub duration_s: f64,
    /// Mean temperature, °C, where it was recorded.
    pub temperature_c: Option<f64>,
    /// Temperature the offsets refer to, °C, where it was recorded.
    pub reference_temperature_c: Option<f64>,
    /// One entry per elastic joint.
    pub joints: Vec<AbsoluteJoint>,
    /// Offsets at the end of every stretch of the recording.
    pub series: Vec<Stretch>,
    /// Block by block, for a plot; not part of the JSON.
    #[serde(skip)]
    pub course: Vec<Course>,
    /// Payload at the end, kg, and half its 95 % interval.
    pub payload_kg: [f64; 2],
    /// Loads picked up or put down within the recording.
    pub payload_changes: Vec<PayloadChange>,
    /// Whether the motor's torque was used as a second witness.
    pub motor_torque: bool,
    /// Whether that was a current times a torque constant.
    pub motor_current: bool,
    /// Share of the time left out as contact or disturbance.
    pub left_out_share: f64,
    /// The longest such stretches.
    pub left_out: Vec<LeftOut>,
    /// Distinct poses the arm stood or passed at, as far as gravity tells them apart.
    pub poses: usize,
    /// What no parameter explains, robust standard deviation per elastic joint, mrad.
    pub noise_mrad: Vec<f64>,
    /// Everything estimated along: what was believed before and after.
    pub nuisance: Vec<Moved>,
    /// Whether part of the file was lost.
    pub damaged: bool,
    /// What the reader should know.
    pub warnings: Vec<String>,
}

/// One tendon since its baseline.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AbsoluteJoint {
    /// Joint.
    pub name: String,
    /// Offset at the end of the recording, mrad.
    pub offset_mrad: f64,
    /// Half of its 95 % interval, mrad.
    pub interval_95_mrad: f64,
    /// Elongation, mm; `None` without tendon geometry.
    pub elongation_mm: Option<f64>,
    /// Half of its 95 % interval, mm.
    pub interval_95_mm: Option<f64>,
    /// "longer", "shorter", "unchanged" or "can't tell".
    pub verdict: String,
    /// Elongation at which the owner wants to tension again, mm, where robot.toml says.
    pub retension_at_mm: Option<f64>,
    /// Whether it is passed: surely (`true`), surely not (`false`), or can't tell (`None`).
    pub limit_passed: Option<bool>,
    /// Sudden changes within the recording.
    pub steps: Vec<Step>,
    /// Stiffness as the recording sees it over nominal, % and half its 95 % interval.
    pub stiffness_change_percent: [f64; 2],
    /// Whether it has changed since what was known before the recording; `None`: not sought.
    pub stiffness_since_before: Option<SinceBefore>,
    /// Half the dead zone of an antagonistic pair, mrad, and half its 95 % interval.
    pub slack_mrad: Option<[f64; 2]>,
    /// Least and greatest torque the joint carried, N·m.
    pub torque_range_nm: [f64; 2],
}

/// Stiffness that may have changed between two recordings. Offsets are averaged over whether it has.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SinceBefore {
    /// Probability that it has.
    pub probability: f64,
    /// By how much if it has, % and half its 95 % interval; lost stiffness is negative.
    pub change_percent: [f64; 2],
}

/// A sudden change of an offset.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Step {
    /// When, s from the start of the recording.
    pub time_s: f64,
    /// It happened between these with 95 %, s; `None` for what happened before the recording.
    pub between_s: Option<[f64; 2]>,
    /// Probability that it happened and lasts: one that comes late may be a contact as well. `None` for
    /// what happened before the recording.
    pub probability: Option<f64>,
    /// By how much, mrad.
    pub size_mrad: f64,
    /// Half of its 95 % interval, mrad.
    pub interval_95_mrad: f64,
    /// Stiffness lost or gained with it, %, and half its 95 % interval; `None`: no change seen.
    pub stiffness_change_percent: Option<[f64; 2]>,
    /// "strand failure" where the stiffness surely fell, "stiffer" where it rose, "re-tensioned" where
    /// much of the offset went without a slip of an encoder, "slip or strand failure" where neither alone
    /// is sure, else "slip"; "softer since before" and "stiffer since before" where the recording began so.
    pub kind: String,
    /// Of a slip: "rope", "motor encoder", "joint encoder" or "can't be told"; else empty.
    pub cause: String,
    /// The same in a sentence.
    pub cause_said: String,
}

/// A load picked up or put down.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PayloadChange {
    /// When, s from the start of the recording.
    pub time_s: f64,
    /// It happened between these with 95 %, s.
    pub between_s: Option<[f64; 2]>,
    /// Probability that it happened.
    pub probability: Option<f64>,
    /// By how much, kg.
    pub change_kg: f64,
    /// Half of its 95 % interval, kg.
    pub interval_95_kg: f64,
}

/// Offsets at one moment.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Stretch {
    /// From, s of the recording.
    pub from_s: f64,
    /// Up to here, s of the recording.
    pub to_s: f64,
    /// Offset of every elastic joint at `to_s`, mrad, in the order of `joints`.
    pub offset_mrad: Vec<f64>,
    /// Half of their 95 % intervals, mrad.
    pub interval_95_mrad: Vec<f64>,
}

/// One block of 0.2 s; offsets in the order of `joints`.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    /// Middle of the block, s.
    pub time_s: f64,
    /// Weight, 0 (left out) to 1.
    pub weight: f64,
    /// What the block says of the offset once everything else is taken off, mrad.
    pub block_mrad: Vec<f64>,
    /// Estimated offset then, mrad.
    pub offset_mrad: Vec<f64>,
    /// Half of its 95 % interval, mrad.
    pub interval_95_mrad: Vec<f64>,
}

/// A stretch that was left out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LeftOut {
    /// From, s.
    pub from_s: f64,
    /// To, s.
    pub to_s: f64,
}

/// A nuisance parameter before and after.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Moved {
    /// Joint or body; empty for the payload.
    pub joint: String,
    /// What it is.
    pub name: String,
    /// Its unit; empty for a ratio.
    pub unit: String,
    /// Mean and standard deviation believed before the recording.
    pub prior: [f64; 2],
    /// Mean and standard deviation after.
    pub posterior: [f64; 2],
    /// Whether the data moved it: surer by a fifth, or by more than a standard deviation off.
    pub moved: bool,
}
