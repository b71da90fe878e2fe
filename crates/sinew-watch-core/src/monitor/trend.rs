//! Trend of each tendon, from the best record of each day.

use super::setup::Setup;
use crate::history::History;
use crate::instant::Instant;
use crate::record::Record;
use crate::transaction::{TendonState, Without};
use sinew_model::robot::Robot;
use sinew_rope::Catalogue;
use sinew_trend::{FirstPassage, JointTrend, SessionRecord, Stated, TrendRequest, analyze_joint};
use std::sync::Arc;

/// Forecast horizon of a trend, days; the default of `sinew trend`.
pub const HORIZON_DAYS: f64 = 1095.0;
/// Seed of the posterior draws; the default of `sinew trend`.
const SEED: u64 = 1;
/// Minimum time between two computations of a trend, s; trends change within days.
const MIN_INTERVAL_S: f64 = 3600.0;

/// Records of a robot and the trends of its tendons.
#[derive(Debug)]
pub(super) struct Trends {
    history: History,
    tendons: Vec<TendonTrend>,
}

#[derive(Debug, Clone, Default)]
struct TendonTrend {
    computed: Option<ComputedTrend>,
    /// Whether the records changed since the last computation.
    changed: bool,
    /// Start of the last computation.
    begun: Option<Instant>,
}

/// Trend without its time series, and the first-passage times of its limits.
#[derive(Debug, Clone)]
pub(super) struct ComputedTrend {
    pub(super) trend: Arc<JointTrend>,
    pub(super) passages: Arc<[FirstPassage]>,
}

impl Trends {
    pub(super) fn new(tendons: usize, history: History) -> Self {
        let one = TendonTrend {
            changed: true,
            ..TendonTrend::default()
        };
        Self {
            history,
            tendons: vec![one; tendons],
        }
    }

    pub(super) fn get(&self, tendon: usize) -> Option<&ComputedTrend> {
        self.tendons.get(tendon)?.computed.as_ref()
    }

    /// Stores a computed trend unless a rope was re-tensioned since its start; `tensionings`: present count.
    pub(super) fn set(&mut self, result: TrendResult, tensionings: u32) {
        let Some(of) = self.tendons.get_mut(result.tendon) else {
            return;
        };
        if result.tensionings == tensionings {
            of.computed = result.computed;
        } else {
            // A rope was re-tensioned meanwhile: the forecast is obsolete.
            of.changed = true;
        }
    }

    /// Adds a record to the history.
    pub(super) fn record(&mut self, record: &Record, setup: &Setup) {
        if self.history.push(record)
            && let Some(i) = setup.tendon_of(&record.joint)
        {
            self.tendons[i].changed = true;
        }
    }

    /// Returns the rows of the day of a time, s since 1970 UTC.
    pub(super) fn since_day(&self, utc_s: f64) -> History {
        self.history.since_day(utc_s)
    }

    /// Replaces the rows since an entry that is withdrawn, and discards the trends.
    pub(super) fn withdraw(&mut self, without: &Without) {
        let Without {
            since_utc_s,
            day,
            records,
            ..
        } = without;
        self.history.replace_from(*since_utc_s, day, records);
        for of in &mut self.tendons {
            *of = TendonTrend {
                changed: true,
                ..TendonTrend::default()
            };
        }
    }

    pub(super) fn all_changed(&mut self) {
        for of in &mut self.tendons {
            (of.changed, of.begun) = (true, None);
        }
    }

    /// Discards the trend of a re-tensioned tendon.
    pub(super) fn discard(&mut self, tendon: usize) {
        if let Some(of) = self.tendons.get_mut(tendon) {
            *of = TendonTrend::default();
        }
    }

    /// Returns the next tendon whose trend is outdated.
    fn next(&mut self, now: Instant) -> Option<usize> {
        let is_due = |of: &TendonTrend| {
            let waited = |begun: Instant| now.since_s(begun) >= MIN_INTERVAL_S;
            of.changed && of.begun.is_none_or(waited)
        };
        let next = self.tendons.iter().position(is_due)?;
        let of = &mut self.tendons[next];
        (of.changed, of.begun) = (false, Some(now));
        Some(next)
    }

    /// Returns the next trend to compute, if one is due; `tensionings`: present count.
    pub(super) fn next_job(
        &mut self,
        setup: &Setup,
        states: &[TendonState],
        tensionings: u32,
        now: Instant,
    ) -> Option<TrendJob> {
        while let Some(tendon) = self.next(now) {
            let (joint, state) = (&setup.names[tendon], &states[tendon]);
            let records = self.history.rows(joint);
            if records.is_empty() {
                continue;
            }
            let stated = |time_utc_s: f64, replaced: bool| Stated {
                joint: None,
                time_utc_s,
                replaced,
            };
            let replaced = state.replaced_utc_s;
            let tensioned = state.tensioned_utc_s.iter().copied();
            return Some(TrendJob {
                tensionings,
                tendon,
                joint: joint.clone(),
                records,
                stated: (tensioned.filter(|t| Some(*t) != replaced))
                    .map(|t| stated(t, false))
                    .chain(replaced.map(|t| stated(t, true)))
                    .collect(),
                catalogue: Arc::clone(&setup.config.catalogue),
            });
        }
        None
    }
}

/// Inputs of the trend of a tendon.
#[derive(Debug)]
pub(super) struct TrendJob {
    /// Number of tensionings at the start of the computation.
    tensionings: u32,
    tendon: usize,
    joint: String,
    records: Vec<SessionRecord>,
    stated: Vec<Stated>,
    catalogue: Arc<Catalogue>,
}

/// Result of a [`TrendJob`].
#[derive(Debug)]
pub(super) struct TrendResult {
    tensionings: u32,
    tendon: usize,
    computed: Option<ComputedTrend>,
}

impl TrendJob {
    /// Returns the result of a failed computation.
    pub(super) fn failed(&self) -> TrendResult {
        TrendResult {
            tensionings: self.tensionings,
            tendon: self.tendon,
            computed: None,
        }
    }

    /// Computes the trend.
    pub(super) fn run(&self, robot: &Robot) -> TrendResult {
        TrendResult {
            computed: self.analyze(robot),
            ..self.failed()
        }
    }

    /// Returns the trend; `None` if the records are not sufficient.
    fn analyze(&self, robot: &Robot) -> Option<ComputedTrend> {
        let last_utc_s = self.records.last()?.time_utc_s;
        let request = TrendRequest {
            robot: Some(robot),
            catalogue: &self.catalogue,
            // The effect of later actions appears in the next record.
            stated: (self.stated.iter())
                .filter(|stated| stated.time_utc_s <= last_utc_s)
                .cloned()
                .collect(),
            duty: None,
            life: None,
            horizon_days: HORIZON_DAYS,
            seed: SEED,
        };
        let (mut trend, passages) = analyze_joint(&self.joint, &self.records, &request).ok()?;
        trend.series = Vec::new();
        Some(ComputedTrend {
            trend: Arc::new(trend),
            passages: passages.into(),
        })
    }
}
