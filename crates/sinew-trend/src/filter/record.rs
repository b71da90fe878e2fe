//! What goes into a trend and what comes out.

use sinew_model::Gaussian;
use sinew_model::offset::SharedError;

/// Result of one session.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Record {
    /// When, s since tensioning.
    pub time_s: f64,
    /// Offset since the baseline, rad; `None`: it couldn't tell.
    pub offset_rad: Option<Gaussian>,
    /// What of its error other sessions have too; `None`: not known.
    #[serde(default)]
    pub shared: Option<SharedError>,
    /// Temperature, °C; `None`: not known.
    pub temperature_c: Option<f64>,
    /// Temperature of its baseline, °C; `None`: that of the prior.
    #[serde(default)]
    pub reference_c: Option<f64>,
    /// Stiffness over nominal less 1 with its own error; `None`: not known.
    pub stiffness: Option<Gaussian>,
}

/// What happened, in the order of time.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum TrendEntry {
    /// A session.
    Record(Record),
    /// The level jumped; it is open by `deviation_rad`.
    Jump {
        /// When at the latest, s.
        time_s: f64,
        /// Standard deviation the level is opened by, rad.
        deviation_rad: f64,
    },
    /// The tendon was tensioned again.
    Tensioned {
        /// When, s.
        time_s: f64,
    },
    /// Sessions count from a new baseline from here on.
    Baseline {
        /// When it was learned, s: the offset was zero then.
        time_s: f64,
        /// As a standard deviation, rad: large where that time isn't known.
        deviation_rad: f64,
    },
}

/// A sudden change that was confirmed, or a re-tensioning that was stated.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Event {
    /// Time of the first record after it (or the stated time), s.
    pub time_s: f64,
    /// Time of the last record before it, s.
    pub after_s: f64,
    /// By how much the offset changed, rad; NaN for a stated re-tensioning.
    pub size_rad: Gaussian,
    /// Time of the record that confirmed it, s.
    pub confirmed_s: f64,
    /// Posterior probability when it was confirmed; 1 for a stated one.
    pub probability: f64,
    /// Sessions that speak for it: one where it is beyond every error, until the next agrees; 0 for a stated one.
    pub sessions: u32,
    /// Whether it is a re-tensioning.
    pub tensioned: bool,
}

/// What adding a record showed.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Added {
    /// Probability that the level jumped within the last records and isn't confirmed yet.
    pub jump_probability: f64,
    /// Where that is above one half: time of the first record after the suspected jump, s.
    pub suspected_s: Option<f64>,
    /// Whether this record, for now, is taken as an outlier.
    pub off: bool,
    /// A change that this record confirmed.
    pub confirmed: Option<Event>,
    /// A change that only the record before spoke for, and that this one takes back.
    pub withdrawn: Option<Event>,
}

/// Rates and sizes the detector reckons with.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TrendConfig {
    /// Sessions within which jumps are looked for.
    pub window: usize,
    /// Jumps per day.
    pub jumps_per_day: f64,
    /// Large falls and rises (re-tensioning, slipping) per day.
    pub falls_per_day: f64,
    /// Standard deviation of a jump, rad.
    pub jump_deviation_rad: f64,
    /// Standard deviation of a large one, rad.
    pub fall_deviation_rad: f64,
    /// Share of records that are off by themselves.
    pub off_share: f64,
    /// By how much they are, rad.
    pub off_deviation_rad: f64,
    /// Probability from which a jump is confirmed, if two sessions agree on it.
    pub confirm: f64,
    /// Probability from which it is without a second session: no error explains it.
    pub confirm_at_once: f64,
    /// A jump below this is taken into account and not reported: nobody's failed strand, rad.
    pub least_jump_rad: f64,
}

impl Default for TrendConfig {
    fn default() -> Self {
        Self {
            window: 7,
            jumps_per_day: 4e-3,
            falls_per_day: 5e-4,
            jump_deviation_rad: 4e-3,
            fall_deviation_rad: 30e-3,
            off_share: 2e-3,
            off_deviation_rad: 6e-3,
            confirm: 0.95,
            confirm_at_once: 1.0 - 1e-6,
            least_jump_rad: 1e-3,
        }
    }
}

/// Why a record or a state was refused.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TrendError {
    /// NaN, infinite, or a deviation that isn't above 0.
    #[error(
        "a record's time, offset, stiffness, deviations and temperature must be finite numbers, deviations above 0"
    )]
    NotFinite,
    /// Earlier than the last.
    #[error(
        "a record at {time_s} s comes after one at {last_s} s; records come in the order of time"
    )]
    OutOfOrder {
        /// Time of the record, s.
        time_s: f64,
        /// Time of the last, s.
        last_s: f64,
    },
    /// The prior is none.
    #[error("the prior of a trend needs curves and noises of finite, positive numbers")]
    Prior,
    /// The state belongs to another prior or is damaged.
    #[error("the stored trend belongs to another rope, routing or program, or is damaged")]
    State,
}

impl Record {
    /// Its stiffness, if it can be one.
    pub(super) fn credible_stiffness(&self) -> Option<Gaussian> {
        /// No transmission is ten times as stiff as stated, or known to less than that.
        const ABSURD: f64 = 10.0;
        let credible =
            |s: &Gaussian| s.mean.abs() < ABSURD && s.deviation < ABSURD && s.deviation > 1e-6;
        self.stiffness.filter(credible)
    }

    /// What its own error is stated as, rad: a factor of noise is on it.
    ///
    /// Where the shared parts are stated it is what they leave of the whole; estimates scatter by 0.4 to 1.7 times that
    /// (240 simulated sessions), and by a fifth to 1.1 times the whole.
    pub fn own_deviation_rad(&self, drift_deviation_rad_per_k: f64) -> f64 {
        /// Days differ by so much in temperature where nobody wrote it down, K.
        const UNKNOWN_DAY_K: f64 = 1.5;
        /// Middle factor on the whole over that on what shared parts leave.
        const OF_WHOLE: f64 = 0.6;
        /// What is left of the whole at least.
        const LEAST: f64 = 0.3;
        let whole = self.offset_rad.map_or(0.0, |offset| offset.deviation);
        let Some(shared) = self.shared else {
            let blur = match self.temperature_c {
                Some(_) => 0.0,
                None => UNKNOWN_DAY_K * drift_deviation_rad_per_k,
            };
            return libm::hypot(whole, blur);
        };
        let steady = (whole * whole - shared.drift_rad * shared.drift_rad).max(0.0);
        let left = steady - shared.baseline_rad * shared.baseline_rad;
        libm::sqrt(left.max(LEAST * LEAST * steady)).max(1e-3 * whole) / OF_WHOLE
    }

    /// Whether all of it is finite, and deviations are above 0.
    pub(super) fn is_possible(&self) -> bool {
        let part = |x: f64| x.is_finite() && x >= 0.0;
        self.time_s.is_finite()
            && self.temperature_c.is_none_or(f64::is_finite)
            && self.reference_c.is_none_or(f64::is_finite)
            && (self.shared).is_none_or(|s| part(s.baseline_rad) && part(s.drift_rad))
            && [self.offset_rad, self.stiffness]
                .iter()
                .all(|p| p.is_none_or(|p| p.is_finite() && p.deviation > 0.0))
    }
}

impl TrendEntry {
    /// Whether it is a session that says something of the offset.
    pub(super) fn is_informative(&self) -> bool {
        matches!(
            self,
            Self::Record(Record {
                offset_rad: Some(_),
                ..
            })
        )
    }

    /// When, s.
    pub(super) fn time_s(&self) -> f64 {
        match self {
            Self::Record(r) => r.time_s,
            Self::Jump { time_s, .. }
            | Self::Tensioned { time_s }
            | Self::Baseline { time_s, .. } => *time_s,
        }
    }
}
