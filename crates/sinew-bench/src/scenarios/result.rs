//! What many recordings show together, as data in SI.

use super::{End, Form, Refusal};
use serde::{Deserialize, Serialize};
use sinew_files::JsonDocument;
use sinew_model::Interval95;
use std::collections::BTreeMap;

/// All scenarios of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ScenarioReport {
    /// Version of the program that made it.
    pub sinew_version: String,
    /// Seed of the first recording of each scenario.
    pub first_seed: u64,
    /// Recordings asked for per scenario.
    pub recordings: u64,
    /// Whether session C, with its slips, was simulated.
    pub with_slips: bool,
    /// One entry per scenario.
    pub scenarios: Vec<ScenarioSummary>,
    /// Recordings that the estimate refused; they are in no figure.
    #[serde(default)]
    pub refusals: Vec<Refusal>,
}

impl JsonDocument for ScenarioReport {
    const SCHEMA: &'static str = "sinew/scenarios/1";
}

/// One scenario. What nothing is known of, for lack of recordings, is `None`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ScenarioSummary {
    /// Its name.
    pub scenario: String,
    /// Its robot.
    pub robot: String,
    /// What it is about, where that isn't the protocol's.
    pub about: Option<String>,
    /// Recordings.
    pub recordings: usize,
    /// All elastic joints together at the end of B, and of C where it was estimated.
    pub ends: Vec<EndSummary>,
    /// Offset of B at its end, per elastic joint.
    pub joints: Vec<ScenarioJoint>,
    /// Slips of session C, per joint that slips.
    pub slips: Vec<SlipSummary>,
    /// Sudden changes reported where there was none, per hour.
    pub false_alarms_per_hour: Option<f64>,
    /// Mean of the probabilities stated of them.
    pub false_alarm_probability: Option<f64>,
    /// Time they were looked for, s.
    pub watched_s: f64,
    /// Payload: root mean square error, kg.
    pub payload_rmse_kg: Option<f64>,
    /// Mean share of B left out as contact or disturbance.
    pub left_out_share: Option<f64>,
    /// Share of recordings in which each warning was given, by its text up to the first number.
    pub warnings: BTreeMap<String, f64>,
}

/// One joint's offset at the end of B. Errors are estimate less truth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ScenarioJoint {
    /// Joint.
    pub name: String,
    /// Mean error, rad.
    pub bias_rad: f64,
    /// Root mean square error, rad.
    pub rmse_rad: f64,
    /// 95 % quantile of the size of the error, rad.
    pub error_q95_rad: f64,
    /// Share of truths inside the 95 % interval.
    pub coverage_share: f64,
    /// Where that share lies with 95 % confidence (Wilson).
    pub coverage_95: Interval95,
    /// Mean standard deviation stated, rad.
    pub stated_rad: f64,
    /// Mean of error over standard deviation stated; 0 when unbiased.
    pub z_mean: f64,
    /// Standard deviation of error over standard deviation stated; 1 when honest, below 1 when
    /// intervals are too wide.
    pub z_deviation: f64,
    /// Share of recordings in which the estimate couldn't tell.
    pub cant_tell_share: f64,
    /// Root mean square of the Bayesian Cramér–Rao bounds, rad.
    pub bound_rad: Option<f64>,
    /// Root mean square error of the paper's mean over B, rad.
    pub paper_rmse_rad: Option<f64>,
    /// The same minus its mean over A.
    pub paper_minus_baseline_rmse_rad: Option<f64>,
    /// With matched filters.
    pub matched_rmse_rad: Option<f64>,
    /// The same minus its mean over A.
    pub matched_minus_baseline_rmse_rad: Option<f64>,
}

/// Slips of one joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SlipSummary {
    /// Joint.
    pub joint: String,
    /// Slips.
    pub slips: usize,
    /// Share found with 20 s of recording after them.
    pub found_share: f64,
    /// Root mean square error of the size, rad; a slip not found counts in full.
    pub rmse_rad: f64,
    /// The same of those found.
    pub found_rmse_rad: Option<f64>,
    /// Mean probability stated of those found.
    pub probability: Option<f64>,
    /// Share of those found that happened within the 95 % interval of their time.
    pub time_coverage_share: Option<f64>,
    /// Mean half-width of that interval, s.
    pub time_half_width_95_s: Option<f64>,
    /// Root mean square error of the time, s.
    pub time_rmse_s: Option<f64>,
    /// Seconds of recording needed to find it: median of those found.
    pub delay_s: Option<f64>,
    /// The same, 90 % quantile.
    pub delay_90_s: Option<f64>,
}

/// All recordings of a scenario at one end, all elastic joints together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EndSummary {
    /// Which end.
    pub end: End,
    /// Whose estimates.
    pub form: Form,
    /// Offsets judged: recordings times elastic joints.
    pub offsets: usize,
    /// Share of truths inside the 95 % interval.
    pub coverage_share: f64,
    /// Root mean square error, rad.
    pub rmse_rad: f64,
    /// Mean half of the 95 % interval, rad.
    pub half_width_95_rad: f64,
    /// Share of recordings whose session warned of anything, or was in doubt.
    pub warned_share: f64,
    /// Share of offsets outside their interval in a session that warned of nothing.
    pub silent_share: f64,
    /// Share of offsets more than three standard deviations off in such a session; chance leaves 0.0027 of those that are told without a
    /// warning.
    pub far_share: f64,
}
