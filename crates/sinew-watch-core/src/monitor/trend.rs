//! The trend of every tendon, from the best record of every day.

use super::history::History;
use super::setup::Setup;
use crate::instant::Instant;
use crate::record::Record;
use crate::transaction::TendonBelief;
use sinew_model::robot::Robot;
use sinew_rope::Catalogue;
use sinew_trend::{JointTrend, PassageTimes, SessionRecord, Stated, TrendRequest, analyze_joint};
use std::sync::Arc;

/// Days a trend's forecast looks ahead, as that of `sinew trend`.
pub const HORIZON_DAYS: f64 = 1095.0;
/// Seed of its draws: that of `sinew trend`.
const SEED: u64 = 1;
/// A trend is made anew at most so often, s: it is of days.
const BETWEEN_S: f64 = 3600.0;

/// The records of a robot, the trends of its tendons, and which of them are to be made anew.
#[derive(Debug)]
pub(super) struct Trends {
    history: History,
    tendons: Vec<TendonTrend>,
}

#[derive(Debug, Clone, Default)]
struct TendonTrend {
    made: Option<Made>,
    /// Whether its records changed since.
    changed: bool,
    /// When it was last begun.
    begun: Option<Instant>,
}

/// A trend without its series, and when it passes its limits.
#[derive(Debug, Clone)]
pub(super) struct Made {
    pub(super) trend: Arc<JointTrend>,
    pub(super) passages: Arc<[PassageTimes]>,
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

    pub(super) fn get(&self, tendon: usize) -> Option<&Made> {
        self.tendons.get(tendon)?.made.as_ref()
    }

    /// Takes a trend that was made after so many tensionings, where there were `tensionings` by now.
    pub(super) fn set(&mut self, made: TrendMade, tensionings: u32) {
        let Some(of) = self.tendons.get_mut(made.tendon) else {
            return;
        };
        if made.of == tensionings {
            of.made = made.made;
        } else {
            // A rope was tensioned since: what was to come of it isn't any more.
            of.changed = true;
        }
    }

    /// Takes a record.
    pub(super) fn record(&mut self, record: &Record, setup: &Setup) {
        if self.history.push(record)
            && let Some(i) = setup.tendon_of(&record.joint)
        {
            self.tendons[i].changed = true;
        }
    }

    pub(super) fn all_changed(&mut self) {
        for of in &mut self.tendons {
            (of.changed, of.begun) = (true, None);
        }
    }

    /// Forgets the trend of a tendon that was tensioned.
    pub(super) fn forget(&mut self, tendon: usize) {
        if let Some(of) = self.tendons.get_mut(tendon) {
            *of = TendonTrend::default();
        }
    }

    /// The tendon whose trend is to be made anew.
    fn next(&mut self, now: Instant) -> Option<usize> {
        let is_due = |of: &TendonTrend| {
            let waited = |begun: Instant| now.since_s(begun) >= BETWEEN_S;
            of.changed && of.begun.is_none_or(waited)
        };
        let next = self.tendons.iter().position(is_due)?;
        let of = &mut self.tendons[next];
        (of.changed, of.begun) = (false, Some(now));
        Some(next)
    }

    /// The next trend to make, if one is due; `tensionings`: how many there were by now.
    pub(super) fn work(
        &mut self,
        setup: &Setup,
        beliefs: &[TendonBelief],
        tensionings: u32,
        now: Instant,
    ) -> Option<TrendWork> {
        while let Some(tendon) = self.next(now) {
            let (joint, belief) = (&setup.names[tendon], &beliefs[tendon]);
            let records = self.history.rows(joint);
            if records.is_empty() {
                continue;
            }
            let stated = |time_utc_s: f64, replaced: bool| Stated {
                joint: None,
                time_utc_s,
                replaced,
            };
            let replaced = belief.replaced_utc_s;
            let tensioned = belief.tensioned_utc_s.iter().copied();
            return Some(TrendWork {
                of: tensionings,
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

/// What a tendon's trend needs.
#[derive(Debug)]
pub(super) struct TrendWork {
    /// After how many tensionings it was begun.
    of: u32,
    tendon: usize,
    joint: String,
    records: Vec<SessionRecord>,
    stated: Vec<Stated>,
    catalogue: Arc<Catalogue>,
}

/// What became of a [`TrendWork`].
#[derive(Debug)]
pub(super) struct TrendMade {
    of: u32,
    tendon: usize,
    made: Option<Made>,
}

impl TrendWork {
    /// What is given where the trend could not be made.
    pub(super) fn nothing(&self) -> TrendMade {
        TrendMade {
            of: self.of,
            tendon: self.tendon,
            made: None,
        }
    }

    /// Makes the trend.
    pub(super) fn run(&self, robot: &Robot) -> TrendMade {
        TrendMade {
            made: self.analyze(robot),
            ..self.nothing()
        }
    }

    /// The trend; `None` where the records make none.
    fn analyze(&self, robot: &Robot) -> Option<Made> {
        let last_utc_s = self.records.last()?.time_utc_s;
        let request = TrendRequest {
            robot: Some(robot),
            catalogue: &self.catalogue,
            // Of what was done since the last record, the next one will tell.
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
        Some(Made {
            trend: Arc::new(trend),
            passages: passages.into(),
        })
    }
}
