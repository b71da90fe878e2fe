//! How long ropes last, as data: tables and pages are made from this alone.

use serde::{Deserialize, Serialize};
use sinew_files::JsonDocument;
use sinew_model::Interval95;
use sinew_rope::survival::SurvivalPoint;

/// How long ropes last.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SurvivalReport {
    /// Version of the program that made it.
    pub sinew_version: String,
    /// Table it was made from.
    pub source: String,
    /// Unit of every age.
    pub age_unit: AgeUnit,
    /// All ropes together, then each group where the table has several.
    pub groups: Vec<SurvivalGroup>,
    /// What was left out or supposed.
    pub notes: Vec<SurvivalNote>,
}

impl JsonDocument for SurvivalReport {
    const SCHEMA: &'static str = "sinew/trend-survival/1";
}

/// Unit of ages.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum AgeUnit {
    /// s.
    Seconds,
    /// Cycles of a machine.
    Cycles,
}

/// Ropes counted together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SurvivalGroup {
    /// Name of the group; `None`: all.
    pub name: Option<String>,
    /// Ropes.
    pub ropes: usize,
    /// Ropes that broke; the others were replaced in time, or run still.
    pub broke: usize,
    /// Sum of their ages.
    pub watched_age: f64,
    /// Kaplan and Meier's curve, a point for every age at which a rope broke.
    pub curve: Vec<SurvivalPoint>,
    /// Age that half of them outlast, from the curve; its 95 % interval. `None`: open.
    pub median: LifeQuantile,
    /// The law fitted; `None`: fewer than two broke, or all at one age.
    pub weibull: Option<FittedWeibull>,
    /// What age says of breaking.
    pub wear: Wear,
}

/// A Weibull law, `S(t) = exp(−(t/scale)^shape)`, with what the likelihood says of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FittedWeibull {
    /// `k`.
    pub shape: f64,
    /// Its 95 % interval by profile likelihood; `None` at an end: open.
    pub shape_interval_95: [Option<f64>; 2],
    /// `λ`, an age.
    pub scale: f64,
    /// Its 95 % interval.
    pub scale_interval_95: [Option<f64>; 2],
    /// Logarithm of the likelihood.
    pub log_likelihood: f64,
    /// Ages by which 5, 10 and 50 % have broken.
    pub broken_by: Vec<LifeQuantile>,
    /// The law over age, with its band.
    pub curve: Vec<FittedPoint>,
    /// Points of Kaplan and Meier's curve whose band the law leaves.
    pub outside_band: usize,
}

/// Age by which a share of the ropes has broken.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LifeQuantile {
    /// The share.
    pub broken_ratio: f64,
    /// The age; `None`: not reached while they were watched.
    pub age: Option<f64>,
    /// Lower end of its 95 % interval; `None`: open.
    pub age_low: Option<f64>,
    /// Upper end; `None`: open.
    pub age_high: Option<f64>,
}

/// A law at an age.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FittedPoint {
    /// The age.
    pub age: f64,
    /// Share that lasts longer.
    pub survival: f64,
    /// Its 95 % interval.
    pub interval_95: Interval95,
}

/// What the age of a rope says of its breaking.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Wear {
    /// The shape's interval lies above 1: old ropes break sooner. Replacing in time helps.
    WearsOut,
    /// It lies below 1: those that break do so early. A rope that has lasted is better than a new one.
    BreaksEarly,
    /// 1 is inside: an old rope may be as good as a new one.
    AgeSaysNothing,
    /// Too few broke to say.
    CannotTell,
}

/// What was left out or supposed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum SurvivalNote {
    /// The first break at a place: when that rope was put in isn't known.
    AgeUnknown {
        /// How many.
        breaks: usize,
    },
    /// Places whose rope broke, and of which nothing is said since: out of observation from then on.
    NoNewRope {
        /// How many.
        places: usize,
    },
    /// Events without a place.
    WithoutPlace {
        /// How many.
        events: usize,
    },
    /// Events whose words, beside others, say that something broke: taken for the rope.
    TakenForBroken {
        /// How many.
        events: usize,
        /// Some of their words.
        words: Vec<String>,
    },
    /// Events that end no rope's life.
    NoEnd {
        /// How many.
        events: usize,
        /// Some of their words.
        words: Vec<String>,
    },
    /// Ropes that broke on the day they were put in: half a day.
    SameDay {
        /// How many.
        ropes: usize,
    },
    /// Until when ropes that didn't break were watched.
    WatchEnds {
        /// s since 1970; of the whole table.
        utc_s: f64,
        /// Column whose places were watched together, each until its last event.
        by: Option<String>,
    },
}

/// When a rope should be replaced, from its age.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LifeForecast {
    /// Share of such ropes that have broken by the age at which to replace.
    pub broken_ratio: f64,
    /// Age of this one at its last session, s.
    pub age_s: f64,
    /// Share of such ropes that have broken by that age: mean over what the lives leave open.
    pub broken_by_now_ratio: f64,
    /// Probability that the age at which to replace is passed.
    pub passed_probability: f64,
    /// Median of the time from the last session until it is, s; below 0: it was passed before.
    pub after_s: f64,
    /// 2.5 % quantile of it, s.
    pub after_low_s: f64,
    /// 97.5 % quantile of it, s.
    pub after_high_s: f64,
    /// Ropes it rests on.
    pub ropes: usize,
    /// Those of them that broke.
    pub broke: usize,
    /// Table they stand in.
    pub source: String,
}

impl LifeForecast {
    /// Whether the rope is likelier older than the age at which to replace than not.
    pub fn is_passed(&self) -> bool {
        self.passed_probability > 0.5
    }
}
