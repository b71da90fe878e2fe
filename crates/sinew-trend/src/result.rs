//! What a trend finds, as data in SI: tables, pages and the CSV are made from this alone.

use super::survival::LifeForecast;
use serde::{Deserialize, Serialize};
use sinew_files::JsonDocument;
use sinew_files::date::PLAUSIBLE_S;
use sinew_model::{Gaussian, Interval95};

/// The trend of a robot's tendons.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TrendReport {
    /// Version of the program that made it.
    pub sinew_version: String,
    /// Robot, where it is known.
    pub robot: Option<String>,
    /// One entry per joint with records.
    pub joints: Vec<JointTrend>,
    /// Whether a limit is passed or a sudden change was confirmed (exit code 3).
    pub needs_attention: bool,
    /// How far forecasts look, s from the last session.
    pub horizon_s: f64,
    /// What was dropped or assumed.
    pub notes: Vec<TrendNote>,
}

impl JsonDocument for TrendReport {
    const SCHEMA: &'static str = "sinew/trend/1";
}

/// Why what is known of other ropes' lives says nothing of one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum LifeNotUsed {
    /// Nobody said when it was put in.
    AgeUnknown,
    /// A strain says when to replace it.
    StrainLimit,
}

/// What was dropped or assumed on the way to a trend.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum TrendNote {
    /// The same session again, counted once.
    Repeated {
        /// File and place of the first.
        source: String,
        /// How many more.
        more: usize,
    },
    /// Overlaps the session before it, left out.
    Overlapping {
        /// File and place of the first.
        source: String,
        /// How many more.
        more: usize,
    },
    /// Nobody said when the tendon was tensioned: its clock begins with the first session.
    TensioningNotStated {
        /// Joint.
        joint: String,
    },
    /// How long such ropes last was stated, and says nothing of this one.
    LifeNotUsed {
        /// Joint.
        joint: String,
        /// Why.
        why: LifeNotUsed,
    },
    /// The first session comes so long after the tensioning that the date may be wrong.
    LongBefore {
        /// Joint.
        joint: String,
        /// Day stated, s since 1970.
        time_utc_s: f64,
        /// Days without a session after it.
        days: f64,
    },
    /// Another baseline, taken as a tensioning.
    OtherBaseline {
        /// Joint.
        joint: String,
        /// First session with it, s since 1970.
        time_utc_s: f64,
    },
}

/// One tendon.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JointTrend {
    /// Joint.
    pub name: String,
    /// What to do.
    pub verdict: TrendVerdict,
    /// Sessions.
    pub sessions: usize,
    /// Sessions that couldn't tell.
    pub without_information: usize,
    /// Start of the first session, s since 1970.
    pub first_utc_s: f64,
    /// Start of the last session, s since 1970.
    pub last_utc_s: f64,
    /// Cycles of the machine, where sessions count them.
    #[serde(default)]
    pub cycles: Option<CycleClock>,
    /// Start of the creep's clock, tensioning or replacement, s since 1970.
    pub tensioned_utc_s: f64,
    /// Whether somebody stated that; else it is the first session's.
    pub tensioned_stated: bool,
    /// Offset at the reference temperature since the last tensioning.
    pub offset_rad: Gaussian,
    /// The same as elongation; `None` without tendon geometry.
    pub elongation_m: Option<Gaussian>,
    /// Strain since the first tensioning, as a fraction; `None` without tendon geometry.
    pub strain_ratio: Option<Gaussian>,
    /// Creep now.
    pub rate_rad_per_s: Gaussian,
    /// Drift of the records with temperature; `None` without temperatures.
    pub drift_rad_per_k: Option<Gaussian>,
    /// Reference temperature, °C.
    pub reference_c: f64,
    /// Error that all sessions since the baseline share: the offset's interval holds what is left unknown of it, however
    /// many sessions there are.
    pub baseline_error_rad: Gaussian,
    /// Standard deviation of the error that neighbouring sessions share, rad.
    pub shared_error_rad: f64,
    /// True over stated width of the sessions' intervals.
    pub stated_width_ratio: f64,
    /// Sudden changes and re-tensionings.
    pub events: Vec<TrendEvent>,
    /// A sudden change that waits for another session.
    pub suspicion: Option<Suspicion>,
    /// Limits of robot.toml, re-tensioning first.
    pub limits: Vec<LimitForecast>,
    /// When to replace the rope by its age, where its strain has no limit and lives of other ropes were given.
    #[serde(default)]
    pub life: Option<LifeForecast>,
    /// What the forecast rests on.
    pub basis: PriorBasis,
    /// Sessions in the order of time.
    pub series: Vec<SessionPoint>,
    /// Offset from the last session on.
    pub forecast: Vec<ForecastPoint>,
}

impl JointTrend {
    /// Whether sessions have dates; else they count cycles alone.
    pub fn is_dated(&self) -> bool {
        PLAUSIBLE_S.contains(&self.first_utc_s)
    }
}

/// Cycles of a machine beside its time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CycleClock {
    /// Cycle of the last session that counts them.
    pub last: f64,
    /// Cycles a second of late; `None`: one session alone doesn't say.
    pub per_s: Option<f64>,
}

/// What to do about a tendon.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum TrendVerdict {
    /// Tension it again: its limit is passed.
    Retension,
    /// Replace the rope: its limit is passed.
    Replace,
    /// Look at it: it jumped.
    Inspect,
    /// Replace the rope: such ropes break at its age.
    ReplaceByAge,
    /// Watch it: a jump is suspected.
    Watch,
    /// Nothing until the first limit.
    Wait,
    /// Nothing known: `robot.toml` states no limit.
    NoLimit,
}

/// A sudden change or a re-tensioning.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TrendEvent {
    /// What it is.
    #[serde(flatten)]
    pub kind: TrendEventKind,
    /// First session after it, or as stated, s since 1970.
    pub time_utc_s: f64,
    /// Change of the offset; `None` for a stated one.
    pub size_rad: Option<Gaussian>,
    /// Session that confirmed it, s since 1970.
    pub confirmed_utc_s: f64,
    /// Posterior probability when it was confirmed.
    pub probability: f64,
    /// Sessions that speak for it: one where it is beyond every error; 0 for a stated one.
    pub sessions: u32,
    /// Change of the stiffness over it, as a fraction of nominal, where sessions state it.
    pub stiffness_change_ratio: Option<Gaussian>,
}

impl TrendEvent {
    /// Whether the offset grew suddenly.
    pub fn is_jump(&self) -> bool {
        matches!(self.kind, TrendEventKind::Jump { .. })
    }
}

/// What happened.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum TrendEventKind {
    /// The offset grew suddenly.
    Jump {
        /// Why, as far as the stiffness tells.
        cause: JumpCause,
    },
    /// The tendon was tensioned.
    Tensioned {
        /// Whether somebody said so; else the offset fell.
        stated: bool,
    },
}

/// Why a tendon grew suddenly.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum JumpCause {
    /// The stiffness fell too: a strand has failed.
    StrandFailure,
    /// The stiffness stayed: rope, clamp or encoder slipped.
    Slip,
    /// The stiffness doesn't tell.
    Unknown,
}

/// A sudden change that isn't confirmed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Suspicion {
    /// First session after it, s since 1970.
    pub time_utc_s: f64,
    /// Its probability.
    pub probability: f64,
}

/// A limit of `robot.toml`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Limit {
    /// Tension again at this elongation since the last tensioning.
    Retension {
        /// m.
        elongation_m: f64,
    },
    /// Replace at this strain since the first tensioning.
    Replace {
        /// As a fraction.
        strain_ratio: f64,
    },
}

/// A limit and when it is passed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LimitForecast {
    /// The limit.
    #[serde(flatten)]
    pub limit: Limit,
    /// The limit as an offset, rad.
    pub limit_rad: f64,
    /// What is known.
    pub state: LimitState,
    /// Probability that it is passed already.
    pub passed_probability: f64,
    /// Median of the time from the last session until it is passed, s; `None`: beyond the horizon, or unknown.
    pub after_s: Option<f64>,
    /// 2.5 % quantile of that time, s; `None`: beyond the horizon, or unknown.
    pub after_low_s: Option<f64>,
    /// 97.5 % quantile of that time, s; `None`: beyond the horizon, or unknown.
    pub after_high_s: Option<f64>,
    /// The median as a date, s since 1970; `None`: as above, or sessions have no dates.
    pub at_utc_s: Option<f64>,
    /// The 2.5 % quantile as a date.
    pub at_low_utc_s: Option<f64>,
    /// The 97.5 % quantile as a date.
    pub at_high_utc_s: Option<f64>,
}

/// What is known of the day a limit is passed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum LimitState {
    /// Likelier passed than not.
    Passed,
    /// Its median lies within the horizon.
    Forecast,
    /// Only its lower bound lies within the horizon.
    NotBefore,
    /// Not passed within the horizon.
    NotWithinHorizon,
    /// Too few sessions for a forecast.
    TooFewSessions,
}

/// What the prior of a tendon rests on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum PriorBasis {
    /// Nobody knows the rope or its pretension: the laws of all ropes of the catalogue, or its own, and a fifth generic curves.
    Unknown {
        /// What the robot file lacks.
        missing: MissingFromRobot,
        /// Ropes whose laws stand for it; one: its own, under any pretension.
        ropes: usize,
    },
    /// The law of a rope, and a fifth generic curves.
    Rope {
        /// Rope.
        rope: String,
        /// Parameters of its law.
        parameters: usize,
        /// Parameters that are starting guesses.
        guesses: usize,
        /// Laws drawn.
        draws: usize,
        /// The duty, where it is known; else work with peaks nobody recorded.
        duty: Option<String>,
    },
}

/// What a robot file lacks for a prior of its rope.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum MissingFromRobot {
    /// A tendon at this joint.
    Tendon,
    /// The tendon's rope.
    Rope,
    /// Its pretension.
    Pretension,
}

/// A session, and what the trend knew after it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SessionPoint {
    /// Its start, s since 1970; from cycle 0 where only cycles are known.
    pub time_utc_s: f64,
    /// Cycle of the machine.
    #[serde(default)]
    pub cycle: Option<f64>,
    /// As recorded; `None` where it couldn't tell.
    pub offset_rad: Option<Gaussian>,
    /// At the reference temperature, with the drift found in the end.
    pub at_reference_rad: Option<f64>,
    /// Temperature, °C.
    pub temperature_c: Option<f64>,
    /// Offset as the trend knew it then.
    pub tracked_rad: Gaussian,
    /// Probability of an unconfirmed jump.
    pub jump_probability: f64,
    /// Whether the record looked off by itself.
    pub is_off: bool,
}

/// Offset at a time to come.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ForecastPoint {
    /// When, s since 1970.
    pub time_utc_s: f64,
    /// Median.
    pub offset_rad: f64,
    /// Quantiles of 2.5 and 97.5 %.
    pub interval_95_rad: Interval95,
}
