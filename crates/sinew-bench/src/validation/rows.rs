//! Entries of the documents of the studies, reduced to what the page shows. The keys are those of the documents, where
//! they are described. A value is missing if no table shows it.

use crate::scenarios::{End, Form};
use crate::year::{Extrapolation, Forecaster};
use serde::{Deserialize, Serialize};

/// Results of a study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Rows {
    /// Scenarios of a [`ScenarioReport`](crate::scenarios::ScenarioReport).
    Scenarios(Vec<Scenario>),
    /// Scenarios of a [`TrajectoryReport`](crate::scenarios::TrajectoryReport).
    Trajectories(Vec<Trajectory>),
    /// Forecasters of a [`YearReport`](crate::year::YearReport).
    Years(Vec<Year>),
    Extrapolations(Vec<Extrapolation>),
    /// Forecasters of a [`WithheldReport`](sinew_creep::WithheldReport).
    HoldOuts(Vec<sinew_creep::Coverage>),
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Scenario {
    pub(super) scenario: String,
    pub(super) robot: String,
    pub(super) recordings: usize,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) ends: Vec<EndOffsets>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) joints: Vec<Joint>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) slips: Vec<Slips>,
    pub(super) false_alarms_per_hour: Option<f64>,
    pub(super) exposure_s: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct EndOffsets {
    pub(super) end: End,
    pub(super) form: Form,
    pub(super) offsets: usize,
    pub(super) coverage_share: Option<f64>,
    pub(super) rmse_rad: Option<f64>,
    pub(super) warned_share: Option<f64>,
    pub(super) silent_share: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Joint {
    pub(super) name: String,
    pub(super) rmse_rad: f64,
    pub(super) reported_std_rad: Option<f64>,
    pub(super) coverage_share: Option<f64>,
    pub(super) bound_rad: Option<f64>,
    pub(super) paper_minus_baseline_rmse_rad: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Slips {
    pub(super) joint: String,
    pub(super) found_share: f64,
    pub(super) found_rmse_rad: Option<f64>,
    pub(super) time_coverage_share: Option<f64>,
    pub(super) delay_s: Option<f64>,
    pub(super) delay_90_s: Option<f64>,
}

/// Online estimates of one scenario, or of all together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Trajectory {
    pub(super) scenario: String,
    pub(super) recordings: usize,
    /// The first entry is that of all joints together.
    pub(super) joints: Vec<JointTrajectory>,
    pub(super) slips: SlipTrajectories,
    pub(super) false_changes_per_h: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct JointTrajectory {
    pub(super) joint: String,
    pub(super) first_useful_s: [Option<f64>; 2],
    pub(super) useful_share: f64,
    pub(super) calm_provisional_share: Option<f64>,
    pub(super) silent_share: f64,
    pub(super) far_share: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct SlipTrajectories {
    pub(super) silent_s: [Option<f64>; 3],
    pub(super) right_s: [Option<f64>; 3],
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Year {
    pub(super) forecaster: Forecaster,
    pub(super) robots: usize,
    pub(super) failures: usize,
    pub(super) found_two_days: usize,
    pub(super) false_alarms_per_robot_year: f64,
    pub(super) tracking_rms_rad: f64,
    pub(super) half_width_95_rad: Option<f64>,
    pub(super) covered_95: Option<Share>,
    pub(super) failed_covered_95: Option<Share>,
    pub(super) forecasts: Vec<Forecasts>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Forecasts {
    pub(super) made_day: f64,
    pub(super) error_of_day_ratio: Option<f64>,
    pub(super) covered_90: Share,
}

/// Share with its standard error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Share {
    pub(super) mean: f64,
    pub(super) std: Option<f64>,
}
