//! Results of many recordings, as data in SI units.

use super::{End, Form, RejectedRecording};
use serde::{Deserialize, Serialize};
use sinew_files::JsonDocument;
use sinew_model::Interval95;
use std::collections::BTreeMap;

/// All scenarios of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ScenarioReport {
    /// Version of the program that created the report.
    pub sinew_version: String,
    /// Seed of the first recording of each scenario.
    pub first_seed: u64,
    /// Number of requested recordings per scenario.
    pub recordings: u64,
    /// Whether session C, with its slips, was simulated.
    pub with_slips: bool,
    /// One entry per scenario.
    pub scenarios: Vec<ScenarioSummary>,
    /// Recordings rejected by the estimator and excluded from all figures.
    #[serde(default)]
    pub rejections: Vec<RejectedRecording>,
}

impl JsonDocument for ScenarioReport {
    const SCHEMA: &'static str = "sinew/scenarios/2";
}

/// Results of one scenario. Values that cannot be computed for lack of recordings are `None`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ScenarioSummary {
    /// Name of the scenario.
    pub scenario: String,
    /// Name of the robot.
    pub robot: String,
    /// Description, if it differs from that of the protocol.
    pub about: Option<String>,
    /// Number of recordings.
    pub recordings: usize,
    /// All elastic joints together at the end of B, and of C where it was estimated.
    pub ends: Vec<EndSummary>,
    /// Offset of B at its end, per elastic joint.
    pub joints: Vec<ScenarioJoint>,
    /// Slips of session C, per joint that slips.
    pub slips: Vec<SlipSummary>,
    /// Sudden changes reported where there was none, per hour.
    pub false_alarms_per_hour: Option<f64>,
    /// Mean reported probability of them.
    pub false_alarm_probability: Option<f64>,
    /// Time in which they were searched for, s.
    pub exposure_s: f64,
    /// Payload: root mean square error, kg.
    pub payload_rmse_kg: Option<f64>,
    /// Mean share of B rejected as contact or disturbance.
    pub rejected_share: Option<f64>,
    /// Share of recordings in which each warning was given, by its text up to the first number.
    pub warnings: BTreeMap<String, f64>,
}

/// One joint's offset at the end of B. Errors are estimate minus truth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ScenarioJoint {
    /// Name of the joint.
    pub name: String,
    /// Mean error, rad.
    pub bias_rad: f64,
    /// Root mean square error, rad.
    pub rmse_rad: f64,
    /// 95 % quantile of the size of the error, rad.
    pub error_q95_rad: f64,
    /// Share of truths inside the 95 % interval.
    pub coverage_share: f64,
    /// 95 % confidence interval of that share (Wilson).
    pub coverage_95: Interval95,
    /// Mean reported standard deviation, rad.
    pub reported_std_rad: f64,
    /// Mean of error over reported standard deviation; 0 if unbiased.
    pub z_mean: f64,
    /// Standard deviation of error over reported standard deviation; 1 if calibrated, below 1 if
    /// intervals are too wide.
    pub z_std: f64,
    /// Share of recordings in which the estimate is inconclusive.
    pub inconclusive_share: f64,
    /// Root mean square of the Bayesian Cramér–Rao bounds, rad.
    pub bound_rad: Option<f64>,
    /// Root mean square error of the paper's mean over B, rad.
    pub paper_rmse_rad: Option<f64>,
    /// Root mean square error of the difference between the paper's means over B and A, rad.
    pub paper_minus_baseline_rmse_rad: Option<f64>,
    /// Root mean square error of the mean over B with matched filters, rad.
    pub matched_rmse_rad: Option<f64>,
    /// Root mean square error of the difference between the means over B and A with matched filters, rad.
    pub matched_minus_baseline_rmse_rad: Option<f64>,
}

/// Statistics of the slips of one joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SlipSummary {
    /// Name of the joint.
    pub joint: String,
    /// Number of slips.
    pub slips: usize,
    /// Share found with 20 s of recording after them.
    pub found_share: f64,
    /// Root mean square error of the size, rad; a slip not found counts in full.
    pub rmse_rad: f64,
    /// Root mean square error of the size of those found, rad.
    pub found_rmse_rad: Option<f64>,
    /// Mean reported probability of those found.
    pub probability: Option<f64>,
    /// Share of those found that happened within the 95 % interval of their time.
    pub time_coverage_share: Option<f64>,
    /// Mean half-width of that interval, s.
    pub time_half_width_95_s: Option<f64>,
    /// Root mean square error of the time, s.
    pub time_rmse_s: Option<f64>,
    /// Seconds of recording needed to find it: median of those found.
    pub delay_s: Option<f64>,
    /// 90 % quantile of that recording time, s.
    pub delay_90_s: Option<f64>,
}

/// All recordings of a scenario at one end, all elastic joints together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EndSummary {
    /// End at which the offsets are assessed.
    pub end: End,
    /// Form of the estimator.
    pub form: Form,
    /// Number of assessed offsets: recordings times elastic joints.
    pub offsets: usize,
    /// Share of truths inside the 95 % interval.
    pub coverage_share: f64,
    /// Root mean square error, rad.
    pub rmse_rad: f64,
    /// Mean half-width of the 95 % interval, rad.
    pub half_width_95_rad: f64,
    /// Share of recordings whose session had a warning or was provisional.
    pub warned_share: f64,
    /// Share of offsets outside their interval in sessions without a warning.
    pub silent_share: f64,
    /// Share of offsets more than three standard deviations from the truth in a session without a warning; 0.0027 is
    /// expected by chance.
    pub far_share: f64,
}
