//! A trend's state as a file keeps it: versioned, apart from the model's own types.

use crate::filter::{
    BaselineError, Component, Event, Misread, Prior, Record, SharedPart, Softened, Stiffness,
    Trend, TrendConfig, TrendEntry, TrendError, TrendState,
};
use serde::{Deserialize, Serialize};
use sinew_model::Gaussian;
use sinew_model::offset::SharedError;

/// Version written.
const VERSION: u32 = 5;

/// What a trend remembers, to go on from later: some tens of kilobytes, just after a jump about one
/// megabyte.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredTrend {
    /// Version of this record.
    pub version: u32,
    /// Of the prior it belongs to, as hexadecimal digits: a JSON number would lose some.
    pub prior: String,
    /// Time of the filters, s since tensioning.
    pub time_s: f64,
    /// Records with an offset so far.
    pub records: u64,
    /// The filters.
    pub filters: Vec<StoredFilter>,
    /// The stiffness: means, lower triangle of the covariance, shape and rate.
    pub stiffness: [f64; 7],
    /// What sessions since the baseline get wrong together: variance of each level, and whether sessions state it.
    #[serde(default)]
    pub baseline: Vec<(f64, bool)>,
    /// The same of the last session before the last entries.
    pub baseline_last: Option<(f64, bool)>,
    /// Whether sessions since a jump have an error that those before it hadn't.
    #[serde(default)]
    pub misread: Misread,
    /// The stiffness since the last jump: mean, information, sessions.
    pub softened: Option<(f64, f64, u64)>,
    /// Sessions that reported one.
    pub stiffness_sessions: u64,
    /// Last entries.
    pub entries: Vec<StoredEntry>,
    /// Events so far; a size that is missing is that of a stated tensioning.
    pub events: Vec<StoredEvent>,
}

/// A filter: curve, noise, logarithm of the weight, means, lower triangle of the covariance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StoredFilter(u32, u32, f64, Vec<f64>, Vec<f64>);

impl StoredFilter {
    fn of(c: &Component) -> Self {
        let (mean, covariance) = (c.mean.to_vec(), c.covariance.to_vec());
        Self(c.curve, c.noise, c.log_weight, mean, covariance)
    }

    /// `None`: it is of another length.
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

/// A session, or what happened between sessions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum StoredEntry {
    /// A session.
    Session {
        /// s since tensioning.
        time_s: f64,
        /// Offset and standard deviation, rad.
        offset_rad: Option<[f64; 2]>,
        /// Parts of that which other sessions have too: the baseline's, the drift's, rad.
        shared_rad: Option<[f64; 2]>,
        /// °C.
        temperature_c: Option<f64>,
        /// Of the baseline, °C.
        reference_c: Option<f64>,
        /// Stiffness over nominal less 1 and standard deviation.
        stiffness: Option<[f64; 2]>,
    },
    /// A confirmed jump.
    Jump {
        /// s since tensioning.
        time_s: f64,
        /// rad.
        deviation_rad: f64,
    },
    /// A tensioning.
    Tensioned {
        /// s since tensioning.
        time_s: f64,
    },
    /// A new baseline.
    Baseline {
        /// s since tensioning.
        time_s: f64,
        /// rad.
        deviation_rad: f64,
    },
}

/// An event.
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

/// Why a stored trend was refused.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StoredTrendError {
    /// Written by an earlier or a later program.
    #[error(
        "the trend has version {0}; this program reads version {known}: make it anew from its sessions",
        known = VERSION
    )]
    Version(u32),
    /// Another prior, or damaged.
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
            softened: (state.softened).map(|s| (s.mean, s.information, s.sessions)),
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
    [x.mean, x.deviation]
}

fn gaussian([mean, deviation]: [f64; 2]) -> Gaussian {
    Gaussian { mean, deviation }
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
        TrendEntry::Jump {
            time_s,
            deviation_rad,
        } => StoredEntry::Jump {
            time_s,
            deviation_rad,
        },
        TrendEntry::Tensioned { time_s } => StoredEntry::Tensioned { time_s },
        TrendEntry::Baseline {
            time_s,
            deviation_rad,
        } => StoredEntry::Baseline {
            time_s,
            deviation_rad,
        },
    }
}

impl StoredTrend {
    /// What sessions since a baseline get wrong together; at most two levels.
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

    /// Goes on from here with the prior it was made with.
    ///
    /// # Errors
    /// [`StoredTrendError`] for another version, another prior or damage.
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
            softened: self.softened.map(|(mean, information, sessions)| Softened {
                mean,
                information,
                sessions,
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
                    StoredEntry::Jump {
                        time_s,
                        deviation_rad,
                    } => TrendEntry::Jump {
                        time_s,
                        deviation_rad,
                    },
                    StoredEntry::Tensioned { time_s } => TrendEntry::Tensioned { time_s },
                    StoredEntry::Baseline {
                        time_s,
                        deviation_rad,
                    } => TrendEntry::Baseline {
                        time_s,
                        deviation_rad,
                    },
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
