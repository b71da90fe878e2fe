//! Result of a trend analysis as data in SI units, the source of tables, pages and CSV.

use super::survival::LifeForecast;
use serde::{Deserialize, Serialize};
use sinew_files::JsonDocument;
use sinew_files::date::PLAUSIBLE_S;
use sinew_model::{Gaussian, Interval95};

/// Trend of a robot's tendons.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TrendReport {
    /// Version of the program that wrote the report.
    pub sinew_version: String,
    /// Robot, if specified or named by a record.
    pub robot: Option<String>,
    /// Result of each joint with records.
    pub joints: Vec<JointTrend>,
    /// Whether a limit is exceeded or a step change was confirmed (exit code 3).
    pub action_required: bool,
    /// Forecast horizon, s from the last session.
    pub horizon_s: f64,
    /// Notes on dropped records and assumptions.
    pub notes: Vec<TrendNote>,
}

impl JsonDocument for TrendReport {
    const SCHEMA: &'static str = "sinew/trend/2";
}

/// Reason why the lifetimes of other ropes do not apply to a rope.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum LifeNotUsed {
    /// Installation date not specified.
    AgeUnknown,
    /// Replacement determined by a strain limit.
    StrainLimit,
}

/// Note on dropped records or an assumption of a trend.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum TrendNote {
    /// Duplicate session, counted once.
    Repeated {
        /// File and location of the first duplicate.
        source: String,
        /// Number of further duplicates.
        more: usize,
    },
    /// Session rejected because it overlaps the previous one.
    Overlapping {
        /// File and location of the first rejected session.
        source: String,
        /// Number of further rejected sessions.
        more: usize,
    },
    /// Tensioning date not specified: the clock starts at the first session.
    TensioningNotSpecified {
        /// Name of the joint.
        joint: String,
    },
    /// Lifetimes of such ropes were specified, but do not apply to this one.
    LifeNotUsed {
        /// Name of the joint.
        joint: String,
        /// Reason why they do not apply.
        reason: LifeNotUsed,
    },
    /// Long gap between tensioning and first session: the date may be wrong.
    LongBefore {
        /// Name of the joint.
        joint: String,
        /// Specified day, s since 1970.
        time_utc_s: f64,
        /// Time from that day to the first session, days.
        days: f64,
    },
    /// Change of the baseline, treated as a re-tensioning.
    OtherBaseline {
        /// Name of the joint.
        joint: String,
        /// First session with the new baseline, s since 1970.
        time_utc_s: f64,
    },
}

/// Trend of one tendon.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JointTrend {
    /// Name of the joint.
    pub name: String,
    /// Recommended action for the tendon.
    pub verdict: TrendVerdict,
    /// Number of sessions.
    pub sessions: usize,
    /// Number of inconclusive sessions.
    pub without_information: usize,
    /// Start of the first session, s since 1970.
    pub first_utc_s: f64,
    /// Start of the last session, s since 1970.
    pub last_utc_s: f64,
    /// Machine cycles, if sessions record them.
    #[serde(default)]
    pub cycles: Option<CycleClock>,
    /// Start of the creep clock, tensioning or replacement, s since 1970.
    pub tensioned_utc_s: f64,
    /// Whether the start was specified by the user; otherwise it is that of the first session.
    pub tensioned_specified: bool,
    /// Offset at the reference temperature since the last tensioning, rad.
    pub offset_rad: Gaussian,
    /// Elongation since the last tensioning, m; `None` without tendon geometry.
    pub elongation_m: Option<Gaussian>,
    /// Strain since the first tensioning, as a fraction; `None` without tendon geometry.
    pub strain_ratio: Option<Gaussian>,
    /// Present creep rate, rad/s.
    pub rate_rad_per_s: Gaussian,
    /// Drift of the records with temperature, rad/K; `None` without temperatures.
    pub drift_rad_per_k: Option<Gaussian>,
    /// Reference temperature of the offset, °C.
    pub reference_c: f64,
    /// Common error of all sessions since the baseline, rad; its uncertainty is included in the
    /// offset's interval and does not decrease with the number of sessions.
    pub baseline_error_rad: Gaussian,
    /// Standard deviation of the slow error of neighbouring sessions, rad.
    pub systematic_error_rad: f64,
    /// Ratio of actual to reported width of the sessions' intervals.
    pub reported_width_ratio: f64,
    /// Step changes and re-tensionings.
    pub events: Vec<TrendEvent>,
    /// Suspected step change, which the next session confirms or withdraws.
    pub suspected_step: Option<SuspectedStep>,
    /// Limits of robot.toml, re-tensioning first.
    pub limits: Vec<LimitForecast>,
    /// Age-based replacement, if the strain has no limit and lifetimes of other ropes were
    /// specified.
    #[serde(default)]
    pub life: Option<LifeForecast>,
    /// Basis of the prior and of the forecast.
    pub basis: PriorBasis,
    /// Sessions in order of time.
    pub series: Vec<SessionPoint>,
    /// Forecast of the offset from the last session on.
    pub forecast: Vec<ForecastPoint>,
}

impl JointTrend {
    /// Whether sessions have dates; otherwise they have cycle counts only.
    pub fn is_dated(&self) -> bool {
        PLAUSIBLE_S.contains(&self.first_utc_s)
    }
}

/// Cycle count of a machine and its rate.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CycleClock {
    /// Cycle of the last session with a cycle count.
    pub last: f64,
    /// Recent cycle rate, 1/s; `None` with one session only.
    pub per_s: Option<f64>,
}

/// Recommended action for a tendon.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum TrendVerdict {
    /// Re-tension: its limit is exceeded.
    Retension,
    /// Replace the rope: its limit is exceeded.
    Replace,
    /// Inspect the tendon: a step change was confirmed.
    Inspect,
    /// Replace the rope because of its age: such ropes break.
    ReplaceByAge,
    /// Monitor the tendon: a step change is suspected.
    Watch,
    /// No action until the first limit.
    Wait,
    /// No limit specified in `robot.toml`.
    NoLimit,
}

impl TrendVerdict {
    /// Name in tables, as in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Retension => "retension",
            Self::Replace => "replace",
            Self::Inspect => "inspect",
            Self::ReplaceByAge => "replace-by-age",
            Self::Watch => "watch",
            Self::Wait => "wait",
            Self::NoLimit => "no-limit",
        }
    }
}

/// Step change or re-tensioning of a tendon.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TrendEvent {
    /// Kind of the event.
    #[serde(flatten)]
    pub kind: TrendEventKind,
    /// First session after the event, or specified time, s since 1970.
    pub time_utc_s: f64,
    /// Change of the offset, rad; `None` for a specified event.
    pub size_rad: Option<Gaussian>,
    /// Session that confirmed the event, s since 1970.
    pub confirmed_utc_s: f64,
    /// Posterior probability at confirmation.
    pub probability: f64,
    /// Number of supporting sessions: 1 if beyond every modelled error; 0 for a specified event.
    pub sessions: u32,
    /// Simultaneous change of the stiffness as a fraction of nominal, if sessions report it.
    pub stiffness_change_ratio: Option<Gaussian>,
}

impl TrendEvent {
    /// Whether the offset increased suddenly.
    pub fn is_jump(&self) -> bool {
        matches!(self.kind, TrendEventKind::StepChange { .. })
    }
}

/// Kind of an event.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum TrendEventKind {
    /// Sudden increase of the offset.
    StepChange {
        /// Cause of the increase, as far as the stiffness determines it.
        cause: StepCause,
    },
    /// Tensioning of the tendon.
    Tensioned {
        /// Whether it was specified by the user; otherwise the offset decreased.
        stated: bool,
    },
}

/// Cause of a sudden increase of the offset.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum StepCause {
    /// Strand failure: the stiffness decreased too.
    StrandFailure,
    /// Slip of rope, clamp or encoder: the stiffness is unchanged.
    Slip,
    /// Cause not determined by the stiffness.
    Unknown,
}

/// Suspected step change.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SuspectedStep {
    /// First session after the step change, s since 1970.
    pub time_utc_s: f64,
    /// Probability of the step change.
    pub probability: f64,
}

/// Limit of `robot.toml`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Limit {
    /// Re-tensioning at this elongation since the last tensioning.
    Retension {
        /// Elongation limit, m.
        elongation_m: f64,
    },
    /// Replacement at this strain since the first tensioning.
    Replace {
        /// Strain limit as a fraction.
        strain_ratio: f64,
    },
}

impl Limit {
    /// Name in tables, as in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Retension { .. } => "retension",
            Self::Replace { .. } => "replace",
        }
    }
}

/// Limit and forecast of its exceedance.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LimitForecast {
    /// Limit that is forecast.
    #[serde(flatten)]
    pub limit: Limit,
    /// Limit as an offset, rad.
    pub limit_rad: f64,
    /// State of the forecast.
    pub state: LimitState,
    /// Probability that the limit is exceeded already.
    pub passed_probability: f64,
    /// Median time from the last session to the exceedance, s; `None` beyond the horizon, or
    /// unknown.
    pub after_s: Option<f64>,
    /// 2.5 % quantile of that time, s; `None` beyond the horizon, or unknown.
    pub after_low_s: Option<f64>,
    /// 97.5 % quantile of that time, s; `None` beyond the horizon, or unknown.
    pub after_high_s: Option<f64>,
    /// Median as a date, s since 1970; `None` as above, or if sessions have no dates.
    pub at_utc_s: Option<f64>,
    /// 2.5 % quantile as a date, s since 1970.
    pub at_low_utc_s: Option<f64>,
    /// 97.5 % quantile as a date, s since 1970.
    pub at_high_utc_s: Option<f64>,
}

/// State of the forecast of a limit's exceedance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum LimitState {
    /// Exceeded with a probability above one half.
    Passed,
    /// Median within the horizon.
    Forecast,
    /// Only the lower bound within the horizon.
    NotBefore,
    /// No exceedance within the horizon.
    NotWithinHorizon,
    /// Too few sessions for a forecast.
    TooFewSessions,
}

impl LimitState {
    /// Name in tables, as in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Passed => "passed",
            Self::Forecast => "forecast",
            Self::NotBefore => "not-before",
            Self::NotWithinHorizon => "not-within-horizon",
            Self::TooFewSessions => "too-few-sessions",
        }
    }
}

/// Basis of the prior of a tendon.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum PriorBasis {
    /// Rope or pretension not specified: the laws of all ropes of the catalogue, or its own, and
    /// one fifth generic curves.
    Unknown {
        /// Missing entry of the robot description.
        missing: MissingFromRobot,
        /// Number of ropes whose laws represent it; 1 for its own rope under any pretension.
        ropes: usize,
    },
    /// Law of the specified rope, and one fifth generic curves.
    Rope {
        /// Name of the rope.
        rope: String,
        /// Number of parameters of its law.
        parameters: usize,
        /// Number of parameters with an assumed value.
        assumed: usize,
        /// Number of draws of the law.
        draws: usize,
        /// Specified duty; `None` for an unknown load with unknown peaks.
        duty: Option<String>,
    },
}

/// Entry that a robot description lacks for a prior of its rope.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum MissingFromRobot {
    /// Tendon of this joint.
    Tendon,
    /// Rope of the tendon.
    Rope,
    /// Pretension of the tendon.
    Pretension,
}

/// Session, and the state of the trend after it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SessionPoint {
    /// Start of the session, s since 1970; from cycle 0 if only cycles are recorded.
    pub time_utc_s: f64,
    /// Cycle of the machine.
    #[serde(default)]
    pub cycle: Option<f64>,
    /// Offset as recorded, rad; `None` if the session was inconclusive.
    pub offset_rad: Option<Gaussian>,
    /// Offset at the reference temperature, with the final drift, rad.
    pub at_reference_rad: Option<f64>,
    /// Temperature of the session, °C.
    pub temperature_c: Option<f64>,
    /// Offset estimated by the trend at that time, rad.
    pub tracked_rad: Gaussian,
    /// Probability of an unconfirmed step change.
    pub step_probability: f64,
    /// Whether the record was treated as an outlier.
    pub is_outlier: bool,
}

/// Forecast of the offset at one time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ForecastPoint {
    /// Time of the forecast, s since 1970.
    pub time_utc_s: f64,
    /// Median of the offset, rad.
    pub offset_rad: f64,
    /// Quantiles of 2.5 and 97.5 %, rad.
    pub interval_95_rad: Interval95,
}
