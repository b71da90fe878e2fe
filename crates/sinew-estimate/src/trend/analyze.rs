//! From records to what a maintenance engineer acts on.

use super::limits::{self, Ahead};
use super::prior::{Grounds, days, grounds};
use super::records::{SessionRecord, Sorted};
use super::result::{EventSaid, JointTrend, Series, Suspicion, TrendReport};
use super::stiffness;
use sinew_files::date::day_of;
use sinew_model::Gaussian;
use sinew_model::robot::Robot;
use sinew_model::transmission::Tendon;
use sinew_model::trend::{Added, Event, Record, Trend, TrendConfig, TrendError, TrendNow};
use sinew_rope::{Catalogue, CatalogueError, Duty};

/// 97.5 % quantile of the normal distribution.
pub(super) const Z95: f64 = 1.96;
/// Baselines are learned about so long after tensioning, s.
const BASELINE_AFTER_S: f64 = 3600.0;
/// Level where nobody said when the tendon was tensioned, rad.
const LEVEL_UNKNOWN_RAD: f64 = 30e-3;

/// Something somebody did, on a day.
#[derive(Debug, Clone, PartialEq)]
pub struct Stated {
    /// Joint; `None`: all.
    pub joint: Option<String>,
    /// When, s since 1970.
    pub time_utc_s: f64,
    /// Whether the rope was replaced; else it was tensioned.
    pub replaced: bool,
}

/// What is asked beside the records.
#[derive(Debug)]
pub struct TrendRequest<'a> {
    /// The robot: ropes, geometry and limits.
    pub robot: Option<&'a Robot>,
    /// Ropes.
    pub catalogue: &'a Catalogue,
    /// Tensionings and replacements, in any order.
    pub stated: Vec<Stated>,
    /// The ropes' duty, where it is known.
    pub duty: Option<Duty>,
    /// Days forecasts look ahead.
    pub horizon_days: f64,
    /// Seed of the draws.
    pub seed: u64,
}

/// Why there is no trend.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AnalyzeError {
    /// A rope of the robot file.
    #[error(transparent)]
    Catalogue(#[from] CatalogueError),
    /// The estimator.
    #[error(transparent)]
    Trend(#[from] TrendError),
    /// A stated day for a joint without records.
    #[error(
        "no records of joint '{joint}', which was stated as tensioned or replaced; records have {known}"
    )]
    Joint {
        /// Joint.
        joint: String,
        /// Joints there are.
        known: String,
    },
    /// Everything is older than the replacement.
    #[error("all records of '{joint}' are older than its replacement on {day}")]
    Replaced {
        /// Joint.
        joint: String,
        /// Day.
        day: String,
    },
}

/// Analyses sorted records.
///
/// # Errors
/// [`AnalyzeError`].
pub fn analyze(sorted: Sorted, request: &TrendRequest<'_>) -> Result<TrendReport, AnalyzeError> {
    let known: Vec<&str> = sorted.joints.iter().map(|(n, _)| n.as_str()).collect();
    for stated in &request.stated {
        if let Some(joint) = stated.joint.as_deref().filter(|j| !known.contains(j)) {
            return Err(AnalyzeError::Joint {
                joint: joint.into(),
                known: known.join(", "),
            });
        }
    }
    let mut notes = sorted.notes;
    let mut joints = Vec::new();
    for (name, records) in &sorted.joints {
        joints.push(joint(name, records, request, &mut notes)?);
    }
    let attention = joints.iter().any(|j| {
        j.limits.iter().any(|l| l.state == "passed")
            || j.events.iter().any(|e| e.kind == "jump" && !e.stated)
    });
    Ok(TrendReport {
        sinew_version: env!("CARGO_PKG_VERSION").into(),
        robot: sorted.robot,
        joints,
        attention,
        horizon_days: request.horizon_days,
        notes,
    })
}

/// When a tendon's clock began, and what was done to it since.
struct Clock {
    start_utc_s: f64,
    stated: bool,
    /// Baseline, s after the start.
    baseline_s: f64,
    /// Later tensionings, s since 1970.
    tensioned: Vec<f64>,
}

/// The clock of a joint, and its records from then on.
fn clock<'a>(
    name: &str,
    records: &'a [SessionRecord],
    stated: &[Stated],
) -> Result<(Clock, &'a [SessionRecord]), AnalyzeError> {
    let own = stated
        .iter()
        .filter(|s| s.joint.as_deref().is_none_or(|j| j == name));
    let replaced = own
        .clone()
        .filter(|s| s.replaced)
        .map(|s| s.time_utc_s)
        .fold(f64::NEG_INFINITY, f64::max);
    let from = records.partition_point(|r| r.time_utc_s < replaced);
    let records = &records[from..];
    let Some(first) = records.first() else {
        return Err(AnalyzeError::Replaced {
            joint: name.into(),
            day: day_of(replaced),
        });
    };
    let mut tensioned: Vec<f64> = own
        .filter(|s| !s.replaced && s.time_utc_s > replaced)
        .map(|s| s.time_utc_s)
        .collect();
    if replaced.is_finite() {
        tensioned.push(replaced);
    }
    tensioned.sort_unstable_by(f64::total_cmp);
    let before = tensioned.partition_point(|t| *t <= first.time_utc_s);
    let later = tensioned.split_off(before);
    let clock = match (tensioned.first(), tensioned.last()) {
        (Some(start), Some(last)) => Clock {
            start_utc_s: *start,
            stated: true,
            baseline_s: (last - start + BASELINE_AFTER_S).min(first.time_utc_s - start),
            tensioned: later,
        },
        _ => Clock {
            start_utc_s: first.time_utc_s - BASELINE_AFTER_S,
            stated: false,
            baseline_s: BASELINE_AFTER_S,
            tensioned: later,
        },
    };
    Ok((clock, records))
}

/// One tendon from its records.
fn joint(
    name: &str,
    records: &[SessionRecord],
    request: &TrendRequest<'_>,
    notes: &mut Vec<String>,
) -> Result<JointTrend, AnalyzeError> {
    let tendon = request.robot.and_then(|r| tendon_of(r, name));
    let (clock, records) = clock(name, records, &request.stated)?;
    let temperatures: Vec<f64> = records.iter().filter_map(|r| r.temperature_c).collect();
    let mean_c = match temperatures.len() {
        0 => 23.0,
        n => temperatures.iter().sum::<f64>() / n as f64,
    };
    let mut grounds = grounds(
        tendon,
        request.catalogue,
        request.duty.as_ref(),
        mean_c,
        request.seed,
    )?;
    grounds.prior.temperature_ref_c = temperatures.first().copied().unwrap_or(23.0);
    grounds.prior.baseline_s = clock.baseline_s;
    if !clock.stated {
        grounds.prior.level_deviation_rad = LEVEL_UNKNOWN_RAD;
        notes.push(format!(
            "{name}: nobody said when it was tensioned (--tensioned DATE); the clock of its creep begins with the first session"
        ));
    }
    let mut trend = Trend::new(grounds.prior.clone(), TrendConfig::default())?;
    let (series, added) = feed(&mut trend, records, &clock, name, notes)?;
    let mut out = said(name, &trend, &clock, records, tendon, &grounds, series);
    out.suspicion = added.and_then(|a| {
        Some(Suspicion {
            day: day_of(clock.start_utc_s + a.suspected_s?),
            probability: a.jump_probability,
        })
    });
    let ahead = Ahead::draw(&trend, days(request.horizon_days), request.seed);
    out.series.forecast_utc_s = (ahead.paths.times_s.iter())
        .map(|t| clock.start_utc_s + t)
        .collect();
    out.series.forecast_mrad = ahead.quantiles_mrad();
    out.limits = limits::limits(
        tendon,
        &trend,
        &ahead,
        out.last_utc_s,
        grounds.rope.is_some(),
    );
    out.verdict = limits::verdict(&out);
    Ok(out)
}

/// Where a tendon stands, without its future.
fn said(
    name: &str,
    trend: &Trend,
    clock: &Clock,
    records: &[SessionRecord],
    tendon: Option<&Tendon>,
    grounds: &Grounds,
    mut series: Series,
) -> JointTrend {
    let now = TrendNow::of(trend);
    let reference_c = trend.prior().temperature_ref_c;
    let mrad = |x: Gaussian| [1e3 * x.mean, 1e3 * Z95 * x.deviation];
    let scale = |[m, h]: [f64; 2], factor: f64| [m * factor, h * factor];
    let drift = now.drift_rad_per_k.mean;
    series.at_reference_mrad = (records.iter())
        .map(|r| {
            let warm = r.temperature_c.map_or(0.0, |t| t - reference_c);
            r.offset_mrad
                .map_or(f64::NAN, |[y, _]| y - 1e3 * drift * warm)
        })
        .collect();
    let (first_utc_s, last_utc_s) = match records {
        [] => (f64::NAN, f64::NAN),
        [first, .., last] => (first.time_utc_s, last.time_utc_s),
        [only] => (only.time_utc_s, only.time_utc_s),
    };
    let warmth = records.iter().any(|r| r.temperature_c.is_some());
    let offset_mrad = mrad(now.offset_rad);
    JointTrend {
        name: name.into(),
        sessions: records.len(),
        without_information: records.iter().filter(|r| r.offset_mrad.is_none()).count(),
        first_day: day_of(first_utc_s),
        last_day: day_of(last_utc_s),
        last_utc_s,
        tensioned_day: day_of(clock.start_utc_s),
        tensioned_stated: clock.stated,
        offset_mrad,
        elongation_mm: tendon.map(|t| scale(offset_mrad, t.joint_pulley_radius_m)),
        strain_percent: tendon.map(|t| {
            scale(
                mrad(now.whole_rad),
                0.1 * t.joint_pulley_radius_m / t.length_m,
            )
        }),
        rate_mrad_per_month: scale(mrad(now.rate_rad_per_s), days(30.0)),
        drift_mrad_per_k: warmth.then(|| mrad(now.drift_rad_per_k)),
        reference_c,
        shared_error_mrad: 1e3 * now.slow_deviation_rad,
        stated_width_factor: now.white_scale,
        events: (trend.events().iter())
            .map(|e| event_said(e, clock, records))
            .collect(),
        suspicion: None,
        limits: Vec::new(),
        basis: grounds.basis.clone(),
        verdict: String::new(),
        series,
    }
}

fn tendon_of<'a>(robot: &'a Robot, joint: &str) -> Option<&'a Tendon> {
    let i = robot.arm.joint_index(joint)?;
    robot.transmissions.get(i)?.as_ref()?.tendon.as_ref()
}

/// Gives the records and what was stated to the trend in the order of time.
fn feed(
    trend: &mut Trend,
    records: &[SessionRecord],
    clock: &Clock,
    name: &str,
    notes: &mut Vec<String>,
) -> Result<(Series, Option<Added>), AnalyzeError> {
    let mut series = Series::default();
    let mut pending = clock.tensioned.iter().copied().peekable();
    let (mut last, mut baseline): (Option<Added>, Option<&str>) = (None, None);
    for record in records {
        let mut just_tensioned = false;
        while let Some(t) = pending.next_if(|t| *t <= record.time_utc_s) {
            trend.tensioned(t - clock.start_utc_s)?;
            just_tensioned = true;
        }
        let time_s = record.time_utc_s - clock.start_utc_s;
        let own = record.baseline.as_deref();
        if own.is_some() && baseline.is_some() && own != baseline && !just_tensioned {
            trend.tensioned(trend.time_s().max(time_s - 1.0))?;
            notes.push(format!(
                "{name}: another baseline from {} on; taken as a tensioning",
                day_of(record.time_utc_s)
            ));
        }
        baseline = own.or(baseline);
        let added = trend.add(Record {
            time_s,
            offset_rad: record
                .offset_mrad
                .map(|[y, i]| Gaussian::new(1e-3 * y, 1e-3 * i / Z95)),
            temperature_c: record.temperature_c,
            stiffness: (record.stiffness_percent)
                .map(|[v, i]| Gaussian::new(0.01 * v, 0.01 * i / Z95)),
        })?;
        let Gaussian { mean, deviation } = TrendNow::of(trend).offset_rad;
        let [offset, interval] = record.offset_mrad.unwrap_or([f64::NAN; 2]);
        series.time_utc_s.push(record.time_utc_s);
        series.offset_mrad.push(offset);
        series.interval_95_mrad.push(interval);
        series
            .temperature_c
            .push(record.temperature_c.unwrap_or(f64::NAN));
        series
            .tracked_mrad
            .push([1e3 * mean, 1e3 * Z95 * deviation]);
        series.jump_probability.push(added.jump_probability);
        series.off.push(added.off);
        if record.offset_mrad.is_some() {
            last = Some(added);
        }
    }
    for t in pending {
        trend.tensioned(t - clock.start_utc_s)?;
    }
    Ok((series, last))
}

fn event_said(event: &Event, clock: &Clock, records: &[SessionRecord]) -> EventSaid {
    let utc = |t: f64| clock.start_utc_s + t;
    let stated = event.size_rad.mean.is_nan();
    let change = stiffness::change(records, utc(event.time_s));
    let meaning = match (event.tensioned, stated) {
        (true, true) => "tensioned".into(),
        (true, false) => "the offset fell: tensioned, and nobody wrote it down?".into(),
        (false, _) => stiffness::meaning(change),
    };
    EventSaid {
        day: day_of(utc(event.time_s)),
        time_utc_s: utc(event.time_s),
        kind: if event.tensioned { "tensioned" } else { "jump" }.into(),
        stated,
        size_mrad: (!stated).then_some([
            1e3 * event.size_rad.mean,
            1e3 * Z95 * event.size_rad.deviation,
        ]),
        confirmed_day: day_of(utc(event.confirmed_s)),
        probability: event.probability,
        stiffness_change_percent: change,
        meaning,
    }
}
