//! Input and output of a trend.

use sinew_model::Gaussian;
use sinew_model::offset::SharedError;

/// Result of one session.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Record {
    /// Time of the session, s since tensioning.
    pub time_s: f64,
    /// Offset since the baseline, rad; `None` if the session was inconclusive.
    pub offset_rad: Option<Gaussian>,
    /// Part of the error that is common to other sessions; `None` if not reported.
    #[serde(default)]
    pub shared: Option<SharedError>,
    /// Temperature, °C; `None` if not recorded.
    pub temperature_c: Option<f64>,
    /// Temperature of the baseline, °C; `None` for that of the prior.
    #[serde(default)]
    pub reference_c: Option<f64>,
    /// Stiffness over nominal less 1 with its independent error; `None` if not reported.
    pub stiffness: Option<Gaussian>,
}

/// Entry of a trend, in order of time.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum TrendEntry {
    /// Result of one session.
    Record(Record),
    /// Step change of the level, whose variance is inflated by `std_rad` squared.
    StepChange {
        /// Latest possible time, s.
        time_s: f64,
        /// Standard deviation of the step change, rad.
        std_rad: f64,
    },
    /// Re-tensioning of the tendon.
    Tensioned {
        /// Time of the re-tensioning, s.
        time_s: f64,
    },
    /// New baseline, to which the following sessions refer.
    Baseline {
        /// Time of the baseline, s: the offset was zero then.
        time_s: f64,
        /// Standard deviation of the offset at that time, rad: large if the time is unknown.
        std_rad: f64,
    },
}

/// Confirmed step change, or specified re-tensioning.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Event {
    /// Time of the first record after the event (or the specified time), s.
    pub time_s: f64,
    /// Time of the last record before the event, s.
    pub after_s: f64,
    /// Change of the offset, rad; NaN for a specified re-tensioning.
    pub size_rad: Gaussian,
    /// Time of the record that confirmed the event, s.
    pub confirmed_s: f64,
    /// Posterior probability at confirmation; 1 for a specified event.
    pub probability: f64,
    /// Number of supporting sessions: 1 if beyond every modelled error, until the next one agrees;
    /// 0 for a specified event.
    pub sessions: u32,
    /// Whether the event is a re-tensioning.
    pub tensioned: bool,
}

/// Outcome of adding a record.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Added {
    /// Probability of an unconfirmed step change within the last records.
    pub step_probability: f64,
    /// Time of the first record after the suspected step change, s, if its probability is above one
    /// half.
    pub suspected_s: Option<f64>,
    /// Whether this record is provisionally treated as an outlier.
    pub off: bool,
    /// Step change confirmed by this record.
    pub confirmed: Option<Event>,
    /// Step change supported by the previous record only, withdrawn by this one.
    pub withdrawn: Option<Event>,
}

/// Rates, sizes and thresholds of the step-change detector.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TrendConfig {
    /// Number of sessions within which step changes are searched.
    pub window: usize,
    /// Prior rate of step changes, per day.
    pub jumps_per_day: f64,
    /// Prior rate of large changes in both directions (re-tensioning, slip), per day.
    pub falls_per_day: f64,
    /// Standard deviation of a step change, rad.
    pub jump_std_rad: f64,
    /// Standard deviation of a large change, rad.
    pub fall_std_rad: f64,
    /// Prior probability that a record is an outlier.
    pub off_share: f64,
    /// Standard deviation of an outlier's error, rad.
    pub off_std_rad: f64,
    /// Minimum probability for confirmation by two sessions.
    pub confirm: f64,
    /// Minimum probability for confirmation by one session, beyond every modelled error.
    pub confirm_at_once: f64,
    /// Minimum size of a reported step change, rad; smaller ones are tracked only.
    pub least_jump_rad: f64,
}

impl Default for TrendConfig {
    fn default() -> Self {
        Self {
            window: 7,
            jumps_per_day: 4e-3,
            falls_per_day: 5e-4,
            jump_std_rad: 4e-3,
            fall_std_rad: 30e-3,
            off_share: 2e-3,
            off_std_rad: 6e-3,
            confirm: 0.95,
            confirm_at_once: 1.0 - 1e-6,
            least_jump_rad: 1e-3,
        }
    }
}

/// Error of an invalid record or state.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TrendError {
    /// Non-finite value, or a standard deviation that is not above 0.
    #[error(
        "a record's time, offset, stiffness, standard deviations and temperature must be finite numbers, standard deviations above 0"
    )]
    NotFinite,
    /// Record earlier than the last one.
    #[error("a record at {time_s} s follows one at {last_s} s; records must be in order of time")]
    OutOfOrder {
        /// Time of the record, s.
        time_s: f64,
        /// Time of the last record, s.
        last_s: f64,
    },
    /// Prior with invalid curves or noises.
    #[error("the prior of a trend needs curves and noises of finite, positive numbers")]
    Prior,
    /// State of another prior, or damaged state.
    #[error("the stored trend belongs to another rope, routing or program, or is damaged")]
    State,
}

impl Record {
    /// Stiffness of the record, if plausible.
    pub(super) fn credible_stiffness(&self) -> Option<Gaussian> {
        /// Maximum plausible relative stiffness change and standard deviation; values beyond it are
        /// ignored.
        const ABSURD: f64 = 10.0;
        let credible = |s: &Gaussian| s.mean.abs() < ABSURD && s.std < ABSURD && s.std > 1e-6;
        self.stiffness.filter(credible)
    }

    /// Reported standard deviation of the independent error, rad, before the factor of the noise.
    ///
    /// If the common parts are reported it is the remainder of the whole; estimates scatter by 0.4
    /// to 1.7 times that (240 simulated sessions), and by 0.2 to 1.1 times the whole.
    pub fn own_std_rad(&self, drift_std_rad_per_k: f64) -> f64 {
        /// Standard deviation of the temperature between days if not recorded, K.
        const UNKNOWN_DAY_K: f64 = 1.5;
        /// Ratio of the middle factor on the whole error to that on the remainder.
        const OF_WHOLE: f64 = 0.6;
        /// Minimum remainder as a share of the whole.
        const MIN_REMAINING_SHARE: f64 = 0.3;
        let whole = self.offset_rad.map_or(0.0, |offset| offset.std);
        let Some(shared) = self.shared else {
            let blur = match self.temperature_c {
                Some(_) => 0.0,
                None => UNKNOWN_DAY_K * drift_std_rad_per_k,
            };
            return libm::hypot(whole, blur);
        };
        let steady = (whole * whole - shared.drift_rad * shared.drift_rad).max(0.0);
        let left = steady - shared.baseline_rad * shared.baseline_rad;
        libm::sqrt(left.max(MIN_REMAINING_SHARE * MIN_REMAINING_SHARE * steady)).max(1e-3 * whole)
            / OF_WHOLE
    }

    /// Whether all values are finite and standard deviations above 0.
    pub(super) fn is_possible(&self) -> bool {
        let part = |x: f64| x.is_finite() && x >= 0.0;
        self.time_s.is_finite()
            && self.temperature_c.is_none_or(f64::is_finite)
            && self.reference_c.is_none_or(f64::is_finite)
            && (self.shared).is_none_or(|s| part(s.baseline_rad) && part(s.drift_rad))
            && [self.offset_rad, self.stiffness]
                .iter()
                .all(|p| p.is_none_or(|p| p.is_finite() && p.std > 0.0))
    }
}

impl TrendEntry {
    /// Whether the entry is a session with an offset.
    pub(super) fn is_informative(&self) -> bool {
        matches!(
            self,
            Self::Record(Record {
                offset_rad: Some(_),
                ..
            })
        )
    }

    /// Time of the entry, s.
    pub(super) fn time_s(&self) -> f64 {
        match self {
            Self::Record(r) => r.time_s,
            Self::StepChange { time_s, .. }
            | Self::Tensioned { time_s }
            | Self::Baseline { time_s, .. } => *time_s,
        }
    }
}
