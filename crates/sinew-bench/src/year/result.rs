//! What simulated years show, as data in SI. The clock of a year is its day: sessions are one a day.

use super::chain::{FailureSeen, JointErrors, SessionKind};
use serde::{Deserialize, Serialize};
use sinew_files::JsonDocument;
use sinew_model::Gaussian;
use sinew_sim::year::surrogate::{Failure, SessionErrors};

/// Simulated years of a robot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct YearReport {
    /// Version of the program that made it.
    pub sinew_version: String,
    /// Robot.
    pub robot: String,
    /// Joints watched; a strand fails in one of them.
    pub joints: Vec<String>,
    /// Where sessions come from.
    pub sessions: SessionSource,
    /// What each forecaster reached.
    pub summary: Vec<YearSummary>,
    /// The years, in the order of seeds; none where only part of a year was simulated.
    pub years: Vec<RobotYear>,
}

impl JsonDocument for YearReport {
    const SCHEMA: &'static str = "sinew/trend-simulate/1";
}

/// Where the sessions of a year come from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum SessionSource {
    /// Truth plus errors drawn.
    Drawn {
        /// The errors.
        errors: SessionErrors,
    },
    /// Simulated recordings, estimated.
    Simulated {
        /// What the robot does.
        session: SessionKind,
        /// Whether each session starts from what the last one learned.
        chained: bool,
        /// How wrong they were, per joint.
        errors: Vec<JointErrors>,
        /// What failed strands did to them.
        failures: Vec<FailureSeen>,
    },
}

/// Who forecasts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Forecaster {
    /// `sinew trend` with the rope named in the robot file.
    #[value(help = "sinew trend, the rope named in robot.toml")]
    Rope,
    /// The same, but every error is taken for its session's own, so that many sessions average it away: what it was
    /// before sessions said what they share.
    #[value(help = "The same, taking every error for its session's own")]
    Alone,
    /// `sinew trend` without.
    #[value(help = "sinew trend without a rope")]
    Generic,
    /// Knows the law, how ropes, duties and errors are drawn, and lacks this tendon's numbers: what
    /// is reachable at all.
    #[value(help = "Knows the true law")]
    Oracle,
}

impl Forecaster {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Rope, Self::Alone, Self::Generic, Self::Oracle];
}

/// One robot's year.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RobotYear {
    /// Seed.
    pub seed: u64,
    /// Joint whose strand failed.
    pub failed_joint: String,
    /// The failure.
    pub failure: Failure,
    /// One entry per forecaster and tendon.
    pub tendons: Vec<TendonResult>,
}

/// What a forecaster made of one tendon.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TendonResult {
    /// Who.
    pub forecaster: Forecaster,
    /// Joint.
    pub joint: String,
    /// Days from the first session after the failure to its confirmation; `None`: not found, or
    /// no failure here.
    pub found_after_days: Option<f64>,
    /// Days of confirmed changes that weren't there.
    pub false_alarm_days: Vec<f64>,
    /// Days of confirmed changes that were there and no failure: a hard day's work lengthened the rope.
    pub sudden_creep_days: Vec<f64>,
    /// RMS of the filtered offset against the truth, rad.
    pub error_rms_rad: f64,
    /// Days, every fifteenth, on which the filtered offset was held against the truth while the tendon was whole.
    pub whole: DaysInside,
    /// The same after its failure.
    pub failed: DaysInside,
    /// Mean half of the 95 % interval, rad.
    pub half_width_95_rad: f64,
    /// Forecasts.
    pub forecasts: Vec<DayForecast>,
}

impl TendonResult {
    /// Of no records yet.
    pub(super) fn new(forecaster: Forecaster, joint: &str) -> Self {
        Self {
            forecaster,
            joint: joint.into(),
            found_after_days: None,
            false_alarm_days: Vec::new(),
            sudden_creep_days: Vec::new(),
            error_rms_rad: 0.0,
            whole: DaysInside::default(),
            failed: DaysInside::default(),
            half_width_95_rad: 0.0,
            forecasts: Vec::new(),
        }
    }
}

/// Days on which an interval was held against the truth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DaysInside {
    /// How many.
    pub checked: usize,
    /// Those of them on which the truth was inside the 95 % interval.
    pub inside_95: usize,
}

impl DaysInside {
    /// Share of days inside; `None` of none.
    pub fn share(self) -> Option<f64> {
        (self.checked > 0).then(|| self.inside_95 as f64 / self.checked as f64)
    }
}

/// A forecast of the day a limit is passed, no further failure supposed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DayForecast {
    /// Day it was made.
    pub made_day: f64,
    /// True day, had nothing failed since.
    pub true_day: f64,
    /// Median; `None`: beyond ten years.
    pub median_day: Option<f64>,
    /// Quantiles of 5 and 95 %.
    pub interval_90_day: DayInterval,
    /// Quantiles of 2.5 and 97.5 %.
    pub interval_95_day: DayInterval,
}

/// Two quantiles of a day; `None`: beyond ten years.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DayInterval {
    /// The lower one.
    pub low: Option<f64>,
    /// The upper one.
    pub high: Option<f64>,
}

impl DayInterval {
    /// Whether a day lies inside.
    pub fn contains(self, day: f64) -> bool {
        self.low.is_some_and(|q| q <= day) && self.high.is_none_or(|q| q >= day)
    }
}

/// What one forecaster reached.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct YearSummary {
    /// Who.
    pub forecaster: Forecaster,
    /// Robots.
    pub robots: usize,
    /// Failures there were.
    pub failures: usize,
    /// Found within two days of the first session that could see them.
    pub found_two_days: usize,
    /// Found at all.
    pub found: usize,
    /// Median delay of those found, days.
    pub delay_median_days: Option<f64>,
    /// False alarms.
    pub false_alarms: usize,
    /// Confirmed changes that were a hard day's creep.
    pub sudden_creep: usize,
    /// Per robot and year.
    pub false_alarms_per_robot_year: f64,
    /// RMS of the tracked offset against the truth, rad: median over tendons.
    pub tracking_rms_rad: f64,
    /// Share of days, every fifteenth, on which the true offset of a whole tendon was inside the 95 % interval.
    pub covered_95: Option<Gaussian>,
    /// The same of tendons of which a strand has failed.
    pub failed_covered_95: Option<Gaussian>,
    /// Mean half of that interval, rad.
    pub half_width_95_rad: Option<f64>,
    /// Forecasts by the day they were made.
    pub forecasts: Vec<ForecastSummary>,
}

/// Forecasts made on one day. What is infinite is `None`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ForecastSummary {
    /// Day they were made.
    pub made_day: f64,
    /// How many.
    pub forecasts: usize,
    /// Median of |error| over the true day.
    pub error_of_day_ratio: Option<f64>,
    /// Median of |error| over what was left until the true day.
    pub error_of_rest_ratio: Option<f64>,
    /// Share of true days inside the 90 % interval, with its standard error.
    pub covered_90: Gaussian,
    /// Share of true days inside the 95 % interval, with its standard error.
    pub covered_95: Gaussian,
    /// Median width of the 90 % interval over the true day.
    pub width_90_ratio: Option<f64>,
}
