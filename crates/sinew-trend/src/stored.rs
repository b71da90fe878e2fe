//! Stored state of a trend: versioned, separate from the types of the model.

use crate::filter::{
    BaselineError, BaselineShift, Component, Event, Prior, Record, SharedPart, Stiffness,
    StiffnessLossStats, Trend, TrendConfig, TrendEntry, TrendError, TrendState,
};
use serde::{Deserialize, Serialize};
use sinew_model::Gaussian;
use sinew_model::offset::SharedError;

/// Version of the written format.
const VERSION: u32 = 7;

/// State from which a trend is resumed: some tens of kilobytes, just after a step change about one
/// megabyte.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredTrend {
    /// Version of this record.
    pub version: u32,
    /// Hash of the prior it belongs to, as hexadecimal digits, because a JSON number would lose
    /// digits.
    pub prior: String,
    /// Time of the filters, s since tensioning.
    pub time_s: f64,
    /// Number of records with an offset so far.
    pub records: u64,
    /// Filters before the last entries.
    pub filters: Vec<StoredFilter>,
    /// State of the stiffness: means, lower triangle of the covariance, shape and rate.
    pub stiffness: [f64; 7],
    /// Common error of the sessions since the baseline: variance of each level, rad², and whether
    /// sessions report it.
    #[serde(default)]
    pub baseline: Vec<(f64, bool)>,
    /// Common error of the last session before the last entries: variance, rad², and whether it was
    /// reported.
    pub baseline_last: Option<(f64, bool)>,
    /// State of the additional error of sessions since a step change.
    #[serde(default)]
    pub misread: BaselineShift,
    /// Time of the last re-tensioning before the last entries, s since tensioning.
    pub retensioned_s: Option<f64>,
    /// Stiffness since the last step change: mean, information, number of sessions.
    #[serde(alias = "softened")]
    pub stiffness_loss: Option<(f64, f64, u64)>,
    /// Number of sessions with a stiffness.
    pub stiffness_sessions: u64,
    /// Entries of the window.
    pub entries: Vec<StoredEntry>,
    /// Events so far; without a size for a specified tensioning.
    pub events: Vec<StoredEvent>,
}

/// Filter: curve, noise, logarithm of the weight, means, lower triangle of the covariance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StoredFilter(u32, u32, f64, Vec<f64>, Vec<f64>);

impl StoredFilter {
    fn of(c: &Component) -> Self {
        let (mean, covariance) = (c.mean.to_vec(), c.covariance.to_vec());
        Self(c.curve, c.noise, c.log_weight, mean, covariance)
    }

    /// Converts to a filter; `None` if the lengths differ.
    fn component(self) -> Option<Component> {
        let Self(curve, noise, log_weight, mean, covariance) = self;
        Some(Component {
            curve,
            noise,
            log_weight,
            mean: mean.try_into().ok()?,
            covariance: covariance.try_into().ok()?,
        })
    }
}

/// Session, or event between sessions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum StoredEntry {
    /// Result of a session.
    Session {
        /// Time, s since tensioning.
        time_s: f64,
        /// Offset and standard deviation, rad.
        offset_rad: Option<[f64; 2]>,
        /// Parts of the error common to other sessions: of the baseline, of the drift, rad.
        shared_rad: Option<[f64; 2]>,
        /// Temperature of the session, °C.
        temperature_c: Option<f64>,
        /// Temperature of the baseline, °C.
        reference_c: Option<f64>,
        /// Stiffness over nominal less 1, and standard deviation.
        stiffness: Option<[f64; 2]>,
    },
    /// Confirmed step change.
    #[serde(alias = "jump")]
    StepChange {
        /// Time, s since tensioning.
        time_s: f64,
        /// Standard deviation of its size, rad.
        #[serde(alias = "deviation_rad")]
        std_rad: f64,
    },
    /// Tensioning of the tendon.
    Tensioned {
        /// Time, s since tensioning.
        time_s: f64,
    },
    /// New baseline of the sessions.
    Baseline {
        /// Time, s since tensioning.
        time_s: f64,
        /// Standard deviation of the offset at that time, rad.
        #[serde(alias = "deviation_rad")]
        std_rad: f64,
    },
}

/// Event of a stored trend.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredEvent {
    time_s: f64,
    after_s: f64,
    size_rad: Option<[f64; 2]>,
    confirmed_s: f64,
    probability: f64,
    #[serde(default)]
    sessions: u32,
    tensioned: bool,
}

/// Error of an invalid stored trend.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StoredTrendError {
    /// State of an earlier or a later program version.
    #[error(
        "the stored trend has version {0}, this program reads version {expected}: recompute it from its sessions",
        expected = VERSION
    )]
    Version(u32),
    /// State of another prior, or damaged state.
    #[error(transparent)]
    Trend(#[from] TrendError),
}

impl From<&Trend> for StoredTrend {
    fn from(trend: &Trend) -> Self {
        let state = trend.state();
        Self {
            version: VERSION,
            prior: format!("{:016x}", state.fingerprint),
            time_s: state.time_s,
            records: state.records,
            filters: (state.components.iter()).map(StoredFilter::of).collect(),
            stiffness: {
                let s = state.stiffness;
                let ([m0, m1], [c0, c1, c2]) = (s.mean, s.covariance);
                [m0, m1, c0, c1, c2, s.shape, s.rate]
            },
            baseline: (state.baseline.levels.iter().flatten())
                .map(|level| (level.variance, level.stated))
                .collect(),
            baseline_last: (state.baseline.last).map(|last| (last.variance, last.stated)),
            misread: state.baseline.misread,
            retensioned_s: state.retensioned_s,
            stiffness_loss: (state.stiffness_loss).map(|s| (s.mean, s.information, s.sessions)),
            stiffness_sessions: state.stiffness.sessions,
            entries: state.entries.iter().map(entry).collect(),
            events: (state.events.iter())
                .map(|e| StoredEvent {
                    time_s: e.time_s,
                    after_s: e.after_s,
                    size_rad: (!e.size_rad.mean.is_nan()).then_some(pair(e.size_rad)),
                    confirmed_s: e.confirmed_s,
                    probability: e.probability,
                    sessions: e.sessions,
                    tensioned: e.tensioned,
                })
                .collect(),
        }
    }
}

fn pair(x: Gaussian) -> [f64; 2] {
    [x.mean, x.std]
}

fn gaussian([mean, std]: [f64; 2]) -> Gaussian {
    Gaussian { mean, std }
}

fn entry(entry: &TrendEntry) -> StoredEntry {
    match *entry {
        TrendEntry::Record(Record {
            time_s,
            offset_rad,
            shared,
            temperature_c,
            reference_c,
            stiffness,
        }) => StoredEntry::Session {
            time_s,
            offset_rad: offset_rad.map(pair),
            shared_rad: shared.map(|s| [s.baseline_rad, s.drift_rad]),
            temperature_c,
            reference_c,
            stiffness: stiffness.map(pair),
        },
        TrendEntry::StepChange { time_s, std_rad } => StoredEntry::StepChange { time_s, std_rad },
        TrendEntry::Tensioned { time_s } => StoredEntry::Tensioned { time_s },
        TrendEntry::Baseline { time_s, std_rad } => StoredEntry::Baseline { time_s, std_rad },
    }
}

impl StoredTrend {
    /// Common error of the sessions since a baseline; at most two levels.
    fn baseline(&self) -> Result<BaselineError, TrendError> {
        let part = |(variance, stated)| SharedPart { variance, stated };
        let mut out = BaselineError {
            last: self.baseline_last.map(part),
            misread: self.misread,
            ..BaselineError::default()
        };
        if self.baseline.len() > out.levels.len() {
            return Err(TrendError::State);
        }
        for (level, stored) in out.levels.iter_mut().zip(&self.baseline) {
            *level = Some(part(*stored));
        }
        Ok(out)
    }

    /// Resumes the trend with the prior it was created with.
    ///
    /// # Errors
    /// Returns a [`StoredTrendError`] for another version, another prior or damage.
    pub fn resume(self, prior: Prior, config: TrendConfig) -> Result<Trend, StoredTrendError> {
        if self.version != VERSION {
            return Err(StoredTrendError::Version(self.version));
        }
        let fingerprint = u64::from_str_radix(&self.prior, 16).map_err(|_| TrendError::State)?;
        let [m0, m1, c0, c1, c2, shape, rate] = self.stiffness;
        let baseline = self.baseline()?;
        let state = TrendState {
            fingerprint,
            time_s: self.time_s,
            components: (self.filters.into_iter())
                .map(StoredFilter::component)
                .collect::<Option<_>>()
                .ok_or(TrendError::State)?,
            baseline,
            retensioned_s: self.retensioned_s,
            stiffness_loss: self.stiffness_loss.map(|(mean, information, sessions)| {
                StiffnessLossStats {
                    mean,
                    information,
                    sessions,
                }
            }),
            stiffness: Stiffness {
                mean: [m0, m1],
                covariance: [c0, c1, c2],
                shape,
                rate,
                sessions: self.stiffness_sessions,
            },
            entries: (self.entries.into_iter())
                .map(|e| match e {
                    StoredEntry::Session {
                        time_s,
                        offset_rad,
                        shared_rad,
                        temperature_c,
                        reference_c,
                        stiffness,
                    } => TrendEntry::Record(Record {
                        time_s,
                        offset_rad: offset_rad.map(gaussian),
                        shared: shared_rad.map(|[baseline_rad, drift_rad]| SharedError {
                            baseline_rad,
                            drift_rad,
                        }),
                        temperature_c,
                        reference_c,
                        stiffness: stiffness.map(gaussian),
                    }),
                    StoredEntry::StepChange { time_s, std_rad } => {
                        TrendEntry::StepChange { time_s, std_rad }
                    }
                    StoredEntry::Tensioned { time_s } => TrendEntry::Tensioned { time_s },
                    StoredEntry::Baseline { time_s, std_rad } => {
                        TrendEntry::Baseline { time_s, std_rad }
                    }
                })
                .collect(),
            events: (self.events.into_iter())
                .map(|e| Event {
                    time_s: e.time_s,
                    after_s: e.after_s,
                    size_rad: gaussian(e.size_rad.unwrap_or([f64::NAN; 2])),
                    confirmed_s: e.confirmed_s,
                    probability: e.probability,
                    sessions: e.sessions,
                    tensioned: e.tensioned,
                })
                .collect(),
            records: self.records,
        };
        Ok(Trend::resume(prior, config, state)?)
    }
}
