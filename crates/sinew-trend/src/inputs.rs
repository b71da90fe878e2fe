//! Inputs of a trend in order of time, and resumption from a stored state.

use super::clock::{Clock, LEVEL_UNKNOWN_RAD, Since};
use super::error::AnalyzeError;
use super::records::SessionRecord;
use super::result::TrendNote;
use super::stored::StoredTrend;
use crate::filter::{Added, Fingerprint, Prior, Record, Trend, TrendConfig, TrendNow};
use serde::{Deserialize, Serialize};
use sinew_model::offset::TENSIONED_OFFSET_RAD;

/// Input of a trend; times in s since the start of the clock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum TrendInput {
    Tensioned { time_s: f64 },
    Rebased { time_s: f64, std_rad: f64 },
    Session(Record),
}

/// Collects sessions and the actions between them in order of time.
pub(super) fn inputs(
    records: &[SessionRecord],
    clock: &Clock,
    name: &str,
    notes: &mut Vec<TrendNote>,
) -> Vec<TrendInput> {
    let mut out = Vec::with_capacity(records.len() + clock.tensioned.len());
    let mut pending = clock.tensioned.iter().copied().peekable();
    let mut since: Option<Since<'_>> = None;
    // Time of the last input, s since the start.
    let mut now_s = clock.baseline_s;
    for record in records {
        let mut just_tensioned = false;
        while let Some(t) = pending.next_if(|t| *t <= record.time_utc_s) {
            let time_s = t - clock.start_utc_s;
            out.push(TrendInput::Tensioned { time_s });
            now_s = now_s.max(time_s);
            just_tensioned = true;
        }
        let time_s = record.time_utc_s - clock.start_utc_s;
        let own = Since::of(record);
        if since.is_some_and(|before| own.differs(before)) {
            let stated = record.baseline_time_utc_s.map(|t| t - clock.start_utc_s);
            let (time_s, std_rad) = match stated.filter(|t| (now_s..=time_s).contains(t)) {
                Some(t) => (t, TENSIONED_OFFSET_RAD),
                None => (now_s.max(time_s - 1.0), LEVEL_UNKNOWN_RAD),
            };
            out.push(TrendInput::Rebased { time_s, std_rad });
            if !just_tensioned {
                notes.push(TrendNote::OtherBaseline {
                    joint: name.into(),
                    time_utc_s: record.time_utc_s,
                });
            }
        }
        since = Some(since.map_or(own, |before| own.or(before)));
        out.push(TrendInput::Session(Record {
            time_s,
            offset_rad: record.offset_rad,
            shared: record.systematic_error,
            temperature_c: record.temperature_c,
            reference_c: record.reference_c,
            stiffness: record.stiffness_ratio,
        }));
        now_s = now_s.max(time_s);
    }
    out.extend(pending.map(|t| TrendInput::Tensioned {
        time_s: t - clock.start_utc_s,
    }));
    out
}

/// State of a trend after its first inputs. A trend resumed from it with further inputs is bitwise
/// identical to one computed from the start.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LoadedTrend {
    /// Number of inputs processed.
    inputs: u64,
    /// Hash of all processed inputs.
    fingerprint: u64,
    /// Outcome of the last session with an offset.
    last: Option<Added>,
    trend: StoredTrend,
}

impl LoadedTrend {
    /// Number of inputs processed, and the trend after them; `None` if they differ from `inputs`.
    fn resume(self, prior: &Prior, inputs: &[TrendInput]) -> Option<(usize, Trend, Option<Added>)> {
        let seen = usize::try_from(self.inputs).ok()?;
        if fingerprint(inputs.get(..seen)?) != self.fingerprint {
            return None;
        }
        let trend = self.trend.resume(prior.clone(), TrendConfig::default());
        Some((seen, trend.ok()?, self.last))
    }
}

/// Trend after all inputs.
pub(super) struct CompleteTrend {
    pub(super) trend: Trend,
    /// Present state of the trend.
    pub(super) now: TrendNow,
    /// Outcome of the last session with an offset.
    pub(super) last: Option<Added>,
    inputs: usize,
    fingerprint: u64,
    /// Whether a stored state was resumed.
    pub(super) is_resumed: bool,
}

impl CompleteTrend {
    /// State to be stored.
    pub(super) fn keep(&self) -> LoadedTrend {
        LoadedTrend {
            inputs: self.inputs as u64,
            fingerprint: self.fingerprint,
            last: self.last,
            trend: StoredTrend::from(&self.trend),
        }
    }
}

/// Called after each session.
type EachSession<'a> = &'a mut dyn FnMut(&Trend, &Added);

/// Runs a trend through the inputs, from a stored state if there is one.
///
/// * `each`: called after each session; without it, the filters of the sessions before the last one are deferred.
pub(super) fn feed(
    prior: Prior,
    inputs: &[TrendInput],
    kept: Option<LoadedTrend>,
    mut each: Option<EachSession<'_>>,
) -> Result<CompleteTrend, AnalyzeError> {
    let begun = kept.and_then(|kept| kept.resume(&prior, inputs));
    let is_resumed = begun.is_some();
    let (seen, mut trend, mut last) = match begun {
        Some(begun) => begun,
        None => (0, Trend::new(prior, TrendConfig::default())?, None),
    };
    let steps = inputs.get(seen..).unwrap_or_default();
    let has_offset =
        |step: &TrendInput| matches!(step, TrendInput::Session(r) if r.offset_rad.is_some());
    // The last session with an offset reports whether it is an outlier.
    let deferred = steps.iter().rposition(has_offset).unwrap_or(0);
    if each.is_none() && deferred > 0 {
        trend.defer();
    }
    for (i, step) in steps.iter().enumerate() {
        if i == deferred {
            trend.catch_up();
        }
        match *step {
            TrendInput::Tensioned { time_s } => trend.tensioned(time_s)?,
            TrendInput::Rebased { time_s, std_rad } => trend.rebased(time_s, std_rad)?,
            TrendInput::Session(record) => {
                let added = trend.add(record)?;
                if let Some(each) = &mut each {
                    each(&trend, &added);
                }
                if record.offset_rad.is_some() {
                    last = Some(added);
                }
            }
        }
    }
    Ok(CompleteTrend {
        now: TrendNow::of(&trend),
        trend,
        last,
        inputs: inputs.len(),
        fingerprint: fingerprint(inputs),
        is_resumed,
    })
}

/// Hash of all inputs in their order.
fn fingerprint(inputs: &[TrendInput]) -> u64 {
    let mut out = Fingerprint::new();
    let mut take = |numbers: &[f64]| numbers.iter().for_each(|x| out.take(*x));
    // A missing value is NaN, which no valid value equals.
    let pair = |value: Option<[f64; 2]>| value.unwrap_or([f64::NAN; 2]);
    for step in inputs {
        match *step {
            TrendInput::Tensioned { time_s } => take(&[0.0, time_s]),
            TrendInput::Rebased { time_s, std_rad } => take(&[1.0, time_s, std_rad]),
            TrendInput::Session(r) => {
                take(&[2.0, r.time_s]);
                take(&pair(r.offset_rad.map(|o| [o.mean, o.std])));
                take(&pair(r.shared.map(|s| [s.baseline_rad, s.drift_rad])));
                take(&pair(r.stiffness.map(|s| [s.mean, s.std])));
                take(&[r.temperature_c, r.reference_c].map(|t| t.unwrap_or(f64::NAN)));
            }
        }
    }
    out.value()
}
