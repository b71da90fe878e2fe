//! Results of simulated years, as data in SI units. The clock of a year is its day: sessions are one a day.

use super::chain::{FailureSeen, JointErrors, SessionKind};
use serde::{Deserialize, Serialize};
use sinew_files::JsonDocument;
use sinew_model::Gaussian;
use sinew_sim::year::surrogate::{Failure, SessionErrors};

/// Simulated years of a robot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct YearReport {
    /// Version of the program that created the result.
    pub sinew_version: String,
    /// Name of the robot.
    pub robot: String,
    /// Monitored joints; a strand fails in one of them.
    pub joints: Vec<String>,
    /// Source of the sessions.
    pub sessions: SessionSource,
    /// Results of each forecaster.
    pub summary: Vec<YearSummary>,
    /// The years, in the order of seeds; none where only part of a year was simulated.
    pub years: Vec<RobotYear>,
}

impl JsonDocument for YearReport {
    const SCHEMA: &'static str = "sinew/trend-simulate/2";
}

/// Source of the sessions of a year.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum SessionSource {
    /// Truth plus errors drawn.
    Drawn {
        /// Error model of the sessions.
        errors: SessionErrors,
    },
    /// Simulated recordings, estimated.
    Simulated {
        /// Motion of the robot.
        session: SessionKind,
        /// Whether each session starts from the posterior of the previous one.
        chained: bool,
        /// Error statistics per joint.
        errors: Vec<JointErrors>,
        /// Effects of failed strands on them.
        failures: Vec<FailureSeen>,
    },
}

/// Forecaster of the trend.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Forecaster {
    /// `sinew trend` with the rope named in the robot file.
    #[value(help = "sinew trend with the rope named in robot.toml")]
    Rope,
    /// `sinew trend` with every error taken as independent, so that many sessions average it out: the method used
    /// before sessions reported their systematic error.
    #[value(help = "sinew trend with the rope, and every error taken as independent")]
    Alone,
    /// `sinew trend` without a named rope.
    #[value(help = "sinew trend without a rope")]
    Generic,
    /// Forecaster that knows the creep law and the distributions of ropes, duties and errors, but not the values of
    /// the tendon: the best attainable result.
    #[value(help = "Forecaster with the true creep law")]
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
    /// Seed of the year.
    pub seed: u64,
    /// Joint whose strand failed.
    pub failed_joint: String,
    /// Failure of the year.
    pub failure: Failure,
    /// One entry per forecaster and tendon.
    pub tendons: Vec<TendonResult>,
}

/// Results of a forecaster for one tendon.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TendonResult {
    /// Name of the forecaster.
    pub forecaster: Forecaster,
    /// Name of the joint.
    pub joint: String,
    /// Days from the first session after the failure to its confirmation; `None`: not found, or
    /// no failure here.
    pub found_after_days: Option<f64>,
    /// Days of confirmed changes that did not occur.
    pub false_alarm_days: Vec<f64>,
    /// Days of confirmed changes that were there and no failure: a hard day's work lengthened the rope.
    pub sudden_creep_days: Vec<f64>,
    /// RMS of the filtered offset against the truth, rad.
    pub error_rms_rad: f64,
    /// Coverage on every fifteenth day while the tendon was intact: filtered offset compared with the truth.
    pub whole: DaysInside,
    /// Coverage after the failure of the tendon.
    pub failed: DaysInside,
    /// Mean half-width of the 95 % interval, rad.
    pub half_width_95_rad: f64,
    /// Forecasts of the year.
    pub forecasts: Vec<DayForecast>,
}

impl TendonResult {
    /// Returns a result without records.
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

/// Days on which an interval was compared with the truth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DaysInside {
    /// Number of days compared.
    pub checked: usize,
    /// Number of days on which the truth was inside the 95 % interval.
    pub inside_95: usize,
}

impl DaysInside {
    /// Share of days inside; `None` of none.
    pub fn share(self) -> Option<f64> {
        (self.checked > 0).then(|| self.inside_95 as f64 / self.checked as f64)
    }
}

/// Forecast of the day of limit exceedance, without further failures.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DayForecast {
    /// Day of the forecast.
    pub made_day: f64,
    /// True day without any failure after the forecast.
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

/// Results of one forecaster.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct YearSummary {
    /// Name of the forecaster.
    pub forecaster: Forecaster,
    /// Number of robots.
    pub robots: usize,
    /// Number of simulated failures.
    pub failures: usize,
    /// Number of failures detected within two days of the first session after them.
    pub found_two_days: usize,
    /// Number of detected failures.
    pub found: usize,
    /// Median delay of the detected failures, days.
    pub delay_median_days: Option<f64>,
    /// Number of false alarms.
    pub false_alarms: usize,
    /// Confirmed changes that were a hard day's creep.
    pub sudden_creep: usize,
    /// Per robot and year.
    pub false_alarms_per_robot_year: f64,
    /// RMS of the tracked offset against the truth, rad: median over tendons.
    pub tracking_rms_rad: f64,
    /// Share of days, every fifteenth, on which the true offset of a whole tendon was inside the 95 % interval.
    pub covered_95: Option<Gaussian>,
    /// Coverage of tendons with a failed strand.
    pub failed_covered_95: Option<Gaussian>,
    /// Mean half-width of that interval, rad.
    pub half_width_95_rad: Option<f64>,
    /// Forecasts by the day of the forecast.
    pub forecasts: Vec<ForecastSummary>,
}

/// Forecasts of one day. Infinite values are `None`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ForecastSummary {
    /// Day of the forecasts.
    pub made_day: f64,
    /// Number of forecasts.
    pub forecasts: usize,
    /// Median of |error| over the true day.
    pub error_of_day_ratio: Option<f64>,
    /// Median ratio of |error| to the time remaining until the true day.
    pub error_of_rest_ratio: Option<f64>,
    /// Share of true days inside the 90 % interval, with its standard error.
    pub covered_90: Gaussian,
    /// Share of true days inside the 95 % interval, with its standard error.
    pub covered_95: Gaussian,
    /// Median width of the 90 % interval over the true day.
    pub width_90_ratio: Option<f64>,
}
