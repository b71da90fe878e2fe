//! Result of a survival analysis of ropes as data, the source of tables and pages.

use serde::{Deserialize, Serialize};
use sinew_files::JsonDocument;
use sinew_model::Interval95;
use sinew_rope::survival::SurvivalPoint;

/// Survival analysis of ropes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SurvivalReport {
    /// Version of the program that wrote the report.
    pub sinew_version: String,
    /// Table it was computed from.
    pub source: String,
    /// Unit of every age.
    pub age_unit: AgeUnit,
    /// All ropes together, then each group if the table has several.
    pub groups: Vec<SurvivalGroup>,
    /// Notes on excluded rows and assumptions.
    pub notes: Vec<SurvivalNote>,
}

impl JsonDocument for SurvivalReport {
    const SCHEMA: &'static str = "sinew/trend-survival/2";
}

/// Unit of an age.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum AgeUnit {
    /// Age in seconds.
    Seconds,
    /// Age in cycles of a machine.
    Cycles,
}

/// Group of ropes counted together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SurvivalGroup {
    /// Name of the group; `None` for all ropes.
    pub name: Option<String>,
    /// Number of ropes.
    pub ropes: usize,
    /// Number of broken ropes; the others are censored.
    pub broke: usize,
    /// Exposure: sum of the ages.
    pub exposure_age: f64,
    /// Kaplan-Meier curve, one point for every age at which a rope broke.
    pub curve: Vec<SurvivalPoint>,
    /// Median lifetime from the curve with its 95 % interval; `None` if not reached.
    pub median: LifeQuantile,
    /// Fitted law; `None` if fewer than two broke, or all at one age.
    pub weibull: Option<FittedWeibull>,
    /// Benefit of age-based replacement.
    pub replacement: AgeReplacement,
}

/// Weibull law, `S(t) = exp(−(t/scale)^shape)`, with intervals from the likelihood.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FittedWeibull {
    /// Shape parameter `k`.
    pub shape: f64,
    /// 95 % interval of the shape by profile likelihood; `None` for an open end.
    pub shape_interval_95: [Option<f64>; 2],
    /// Scale parameter `λ`, an age.
    pub scale: f64,
    /// 95 % interval of the scale; `None` for an open end.
    pub scale_interval_95: [Option<f64>; 2],
    /// Logarithm of the maximum likelihood.
    pub log_likelihood: f64,
    /// Ages by which 5, 10 and 50 % have broken.
    pub broken_by: Vec<LifeQuantile>,
    /// Survival function of the law over age, with its band.
    pub curve: Vec<FittedPoint>,
    /// Number of points of the Kaplan-Meier curve whose band does not contain the law.
    pub outside_band: usize,
}

/// Age by which a share of the ropes has broken.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LifeQuantile {
    /// Share of broken ropes.
    pub broken_ratio: f64,
    /// Age at that share; `None` if not reached during observation.
    pub age: Option<f64>,
    /// Lower end of the 95 % interval; `None` for an open end.
    pub age_low: Option<f64>,
    /// Upper end of the 95 % interval; `None` for an open end.
    pub age_high: Option<f64>,
}

/// Survival function of a law at an age.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FittedPoint {
    /// Age in the unit of the report.
    pub age: f64,
    /// Share of ropes that last longer.
    pub survival: f64,
    /// 95 % interval of that share.
    pub interval_95: Interval95,
}

/// Benefit of age-based replacement.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AgeReplacement {
    /// Verdict at the required probability.
    pub verdict: ReplacementVerdict,
    /// Posterior probability that the hazard increases with age, a Weibull shape above 1; `None` without
    /// a break.
    pub wear_probability: Option<f64>,
    /// Probability of an increasing or a decreasing hazard that a verdict requires.
    pub required_probability: f64,
    /// 95 % interval of the prior of the shape: log-normal, median 1.
    pub shape_prior_95: [f64; 2],
    /// Approximate number of further breaks for a verdict if the shape remains as it is; `None` with a
    /// verdict, without a break, or above a thousand.
    pub further_failures: Option<usize>,
    /// Age of replacement; `None` unless it helps.
    pub age: Option<LifeQuantile>,
}

/// Whether age-based replacement reduces failures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum ReplacementVerdict {
    /// The hazard increases with age: replacement in time reduces failures.
    Helps,
    /// The hazard decreases with age: a rope that has lasted is better than a new one.
    DoesNotHelp,
    /// Neither has the required probability.
    Inconclusive,
}

/// Note on excluded rows or an assumption.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum SurvivalNote {
    /// First break at a location: the installation date of that rope is unknown.
    AgeUnknown {
        /// Number of such breaks.
        breaks: usize,
    },
    /// Locations without any event after a break: out of observation from then on.
    NoNewRope {
        /// Number of such locations.
        places: usize,
    },
    /// Events without a location.
    WithoutPlace {
        /// Number of such events.
        events: usize,
    },
    /// Events whose text mentions a break among other words: interpreted as a break of the rope.
    TakenForBroken {
        /// Number of such events.
        events: usize,
        /// Examples of their texts.
        words: Vec<String>,
    },
    /// Events that are not the end of a rope's lifetime.
    NoEnd {
        /// Number of such events.
        events: usize,
        /// Examples of their texts.
        words: Vec<String>,
    },
    /// Ropes that broke on the day of their installation: half a day.
    SameDay {
        /// Number of such ropes.
        ropes: usize,
    },
    /// End of observation of intact ropes.
    ObservationEnd {
        /// End of observation of the whole table, s since 1970.
        utc_s: f64,
        /// Column of locations observed together, each until its last event.
        by: Option<String>,
    },
}

/// Age-based replacement of a rope.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LifeForecast {
    /// Share of such ropes that have broken by the age of replacement.
    pub broken_ratio: f64,
    /// Age of this rope at its last session, s.
    pub age_s: f64,
    /// Share of such ropes that have broken by that age: posterior mean.
    pub broken_by_now_ratio: f64,
    /// Probability that the age of replacement is exceeded.
    pub passed_probability: f64,
    /// Median time from the last session to replacement, s; negative if it was earlier.
    pub after_s: f64,
    /// 2.5 % quantile of that time, s.
    pub after_low_s: f64,
    /// 97.5 % quantile of that time, s.
    pub after_high_s: f64,
    /// Number of ropes the forecast is based on.
    pub ropes: usize,
    /// Number of those ropes that broke.
    pub broke: usize,
    /// Table with their lifetimes.
    pub source: String,
}

impl LifeForecast {
    /// Whether the rope exceeds the age of replacement with a probability above one half.
    pub fn is_passed(&self) -> bool {
        self.passed_probability > 0.5
    }
}
