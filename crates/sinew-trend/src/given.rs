//! What a trend is given, in the order of time, and how far an earlier question came with it.

use super::clock::{Clock, LEVEL_UNKNOWN_RAD, Since};
use super::error::AnalyzeError;
use super::records::SessionRecord;
use super::result::TrendNote;
use super::stored::StoredTrend;
use crate::filter::{Added, Fingerprint, Prior, Record, Trend, TrendConfig, TrendNow};
use serde::{Deserialize, Serialize};
use sinew_model::offset::TENSIONED_OFFSET_RAD;

/// One thing a trend is given; times in s since the clock's start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Given {
    Tensioned { time_s: f64 },
    Rebased { time_s: f64, deviation_rad: f64 },
    Session(Record),
}

/// Sessions, and what was done between them.
pub(super) fn given(
    records: &[SessionRecord],
    clock: &Clock,
    name: &str,
    notes: &mut Vec<TrendNote>,
) -> Vec<Given> {
    let mut out = Vec::with_capacity(records.len() + clock.tensioned.len());
    let mut pending = clock.tensioned.iter().copied().peekable();
    let mut since: Option<Since<'_>> = None;
    // Where the trend stands, s since the start.
    let mut now_s = clock.baseline_s;
    for record in records {
        let mut just_tensioned = false;
        while let Some(t) = pending.next_if(|t| *t <= record.time_utc_s) {
            let time_s = t - clock.start_utc_s;
            out.push(Given::Tensioned { time_s });
            now_s = now_s.max(time_s);
            just_tensioned = true;
        }
        let time_s = record.time_utc_s - clock.start_utc_s;
        let own = Since::of(record);
        if since.is_some_and(|before| own.differs(before)) {
            let known = record.baseline_time_utc_s.map(|t| t - clock.start_utc_s);
            let (time_s, deviation_rad) = match known.filter(|t| (now_s..=time_s).contains(t)) {
                Some(t) => (t, TENSIONED_OFFSET_RAD),
                None => (now_s.max(time_s - 1.0), LEVEL_UNKNOWN_RAD),
            };
            out.push(Given::Rebased {
                time_s,
                deviation_rad,
            });
            if !just_tensioned {
                notes.push(TrendNote::OtherBaseline {
                    joint: name.into(),
                    time_utc_s: record.time_utc_s,
                });
            }
        }
        since = Some(since.map_or(own, |before| own.or(before)));
        out.push(Given::Session(Record {
            time_s,
            offset_rad: record.offset_rad,
            shared: record.shared_error,
            temperature_c: record.temperature_c,
            reference_c: record.reference_c,
            stiffness: record.stiffness_ratio,
        }));
        now_s = now_s.max(time_s);
    }
    out.extend(pending.map(|t| Given::Tensioned {
        time_s: t - clock.start_utc_s,
    }));
    out
}

/// Where a trend stood after what it was given first. Whoever has more of the same goes on from here: to the last bit as from
/// nothing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct KeptTrend {
    /// How much it was given.
    given: u64,
    /// Of all that.
    fingerprint: u64,
    /// What the last session with an offset showed.
    last: Option<Added>,
    trend: StoredTrend,
}

impl KeptTrend {
    /// How much of `given` it has seen, and where it stands then; `None`: it has seen something else.
    fn resume(self, prior: &Prior, given: &[Given]) -> Option<(usize, Trend, Option<Added>)> {
        let seen = usize::try_from(self.given).ok()?;
        if fingerprint(given.get(..seen)?) != self.fingerprint {
            return None;
        }
        let trend = self.trend.resume(prior.clone(), TrendConfig::default());
        Some((seen, trend.ok()?, self.last))
    }
}

/// A trend that has been given all there is.
pub(super) struct Fed {
    pub(super) trend: Trend,
    /// Where it stands then.
    pub(super) now: TrendNow,
    /// What the last session with an offset showed.
    pub(super) last: Option<Added>,
    given: usize,
    fingerprint: u64,
    /// Whether it went on from what was kept.
    pub(super) went_on: bool,
}

impl Fed {
    /// What to keep of it.
    pub(super) fn keep(&self) -> KeptTrend {
        KeptTrend {
            given: self.given as u64,
            fingerprint: self.fingerprint,
            last: self.last,
            trend: StoredTrend::from(&self.trend),
        }
    }
}

/// Gives a trend what there is, from where it was kept.
///
/// * `each`: called after each session.
pub(super) fn feed(
    prior: Prior,
    given: &[Given],
    kept: Option<KeptTrend>,
    mut each: impl FnMut(&Trend, &Added),
) -> Result<Fed, AnalyzeError> {
    let begun = kept.and_then(|kept| kept.resume(&prior, given));
    let went_on = begun.is_some();
    let (seen, mut trend, mut last) = match begun {
        Some(begun) => begun,
        None => (0, Trend::new(prior, TrendConfig::default())?, None),
    };
    for step in given.get(seen..).unwrap_or_default() {
        match *step {
            Given::Tensioned { time_s } => trend.tensioned(time_s)?,
            Given::Rebased {
                time_s,
                deviation_rad,
            } => trend.rebased(time_s, deviation_rad)?,
            Given::Session(record) => {
                let added = trend.add(record)?;
                each(&trend, &added);
                if record.offset_rad.is_some() {
                    last = Some(added);
                }
            }
        }
    }
    Ok(Fed {
        now: TrendNow::of(&trend),
        trend,
        last,
        given: given.len(),
        fingerprint: fingerprint(given),
        went_on,
    })
}

/// Of all that was given, in its order.
fn fingerprint(given: &[Given]) -> u64 {
    let mut out = Fingerprint::new();
    let mut take = |numbers: &[f64]| numbers.iter().for_each(|x| out.take(*x));
    // What is unknown is no number that could be known.
    let pair = |known: Option<[f64; 2]>| known.unwrap_or([f64::NAN; 2]);
    for step in given {
        match *step {
            Given::Tensioned { time_s } => take(&[0.0, time_s]),
            Given::Rebased {
                time_s,
                deviation_rad,
            } => take(&[1.0, time_s, deviation_rad]),
            Given::Session(r) => {
                take(&[2.0, r.time_s]);
                take(&pair(r.offset_rad.map(|o| [o.mean, o.deviation])));
                take(&pair(r.shared.map(|s| [s.baseline_rad, s.drift_rad])));
                take(&pair(r.stiffness.map(|s| [s.mean, s.deviation])));
                take(&[r.temperature_c, r.reference_c].map(|t| t.unwrap_or(f64::NAN)));
            }
        }
    }
    out.value()
}
