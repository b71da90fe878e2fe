//! From records to what a maintenance engineer acts on.

use super::clock::{Clock, Stated, clock};
use super::error::AnalyzeError;
use super::limits;
use super::prior::{RopePrior, days, rope_prior};
use super::records::{SessionRecord, Sorted};
use super::result::{
    JointTrend, Limit, LimitState, PriorBasis, SessionPoint, Suspicion, TrendEvent, TrendEventKind,
    TrendNote, TrendReport, TrendVerdict,
};
use super::stiffness;
use sinew_files::date::DAY_S;
use sinew_model::robot::Robot;
use sinew_model::transmission::Tendon;
use sinew_model::trend::{Added, Event, Record, Trend, TrendConfig, TrendNow};
use sinew_rope::{Catalogue, Duty};

/// Level where nobody said when the tendon was tensioned, rad.
const LEVEL_UNKNOWN_RAD: f64 = 30e-3;

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
    let needs_attention = joints.iter().any(|j| {
        (j.limits.iter()).any(|l| l.state == LimitState::Passed)
            || j.events.iter().any(TrendEvent::is_jump)
    });
    Ok(TrendReport {
        sinew_version: env!("CARGO_PKG_VERSION").into(),
        robot: sorted.robot,
        joints,
        needs_attention,
        horizon_s: days(request.horizon_days),
        notes,
    })
}

/// One tendon from its records.
fn joint(
    name: &str,
    records: &[SessionRecord],
    request: &TrendRequest<'_>,
    notes: &mut Vec<TrendNote>,
) -> Result<JointTrend, AnalyzeError> {
    let tendon = request.robot.and_then(|r| tendon_of(r, name));
    let (clock, records) = clock(name, records, &request.stated)?;
    let mut prior = prior_of(tendon, records, request)?;
    prior.prior.baseline_s = clock.baseline_s;
    if !clock.stated {
        prior.prior.level_deviation_rad = LEVEL_UNKNOWN_RAD;
        notes.push(TrendNote::TensioningNotStated { joint: name.into() });
    }
    /// Longer between a tensioning and the first session is worth a word, days.
    const LONG_DAYS: f64 = 90.0;
    let first_utc_s = records.first().map_or(f64::NAN, |r| r.time_utc_s);
    let silent_days = (first_utc_s - clock.start_utc_s) / DAY_S;
    if clock.stated && silent_days > LONG_DAYS {
        notes.push(TrendNote::LongBefore {
            joint: name.into(),
            time_utc_s: clock.start_utc_s,
            days: silent_days,
        });
    }
    let mut trend = Trend::new(prior.prior, TrendConfig::default())?;
    let (mut series, last) = feed(&mut trend, records, &clock, name, notes)?;
    let now = TrendNow::of(&trend);
    let reference_c = trend.prior().temperature_ref_c;
    for point in &mut series {
        let warm = point.temperature_c.map_or(0.0, |t| t - reference_c);
        point.at_reference_rad =
            (point.offset_rad).map(|y| y.mean - now.drift_rad_per_k.mean * warm);
    }
    let paths = limits::forecast_paths(&trend, days(request.horizon_days), request.seed);
    let rope_known = matches!(prior.basis, PriorBasis::Rope { .. });
    let time_of = |r: Option<&SessionRecord>| r.map_or(f64::NAN, |r| r.time_utc_s);
    let mut out = JointTrend {
        name: name.into(),
        verdict: TrendVerdict::NoLimit,
        sessions: records.len(),
        without_information: records.iter().filter(|r| r.offset_rad.is_none()).count(),
        first_utc_s: time_of(records.first()),
        last_utc_s: time_of(records.last()),
        tensioned_utc_s: clock.start_utc_s,
        tensioned_stated: clock.stated,
        offset_rad: now.offset_rad,
        elongation_m: tendon.map(|t| now.offset_rad.scaled(t.joint_pulley_radius_m)),
        strain_ratio: tendon.map(|t| now.whole_rad.scaled(t.joint_pulley_radius_m / t.length_m)),
        rate_rad_per_s: now.rate_rad_per_s,
        drift_rad_per_k: (records.iter().any(|r| r.temperature_c.is_some()))
            .then_some(now.drift_rad_per_k),
        reference_c,
        shared_error_rad: now.slow_deviation_rad,
        stated_width_ratio: now.white_scale,
        events: (trend.events().iter())
            .map(|e| found_event(e, &clock, records))
            .collect(),
        suspicion: last.and_then(|added| {
            Some(Suspicion {
                time_utc_s: clock.start_utc_s + added.suspected_s?,
                probability: added.jump_probability,
            })
        }),
        limits: limits::limits(tendon, &trend, &paths, rope_known),
        basis: prior.basis,
        series,
        forecast: limits::forecast(&paths, clock.start_utc_s),
    };
    out.verdict = verdict(&out);
    Ok(out)
}

/// The prior of a tendon before its first record.
fn prior_of(
    tendon: Option<&Tendon>,
    records: &[SessionRecord],
    request: &TrendRequest<'_>,
) -> Result<RopePrior, AnalyzeError> {
    let temperatures: Vec<f64> = records.iter().filter_map(|r| r.temperature_c).collect();
    let mean_c = match temperatures.len() {
        0 => 23.0,
        n => temperatures.iter().sum::<f64>() / n as f64,
    };
    let duty = request.duty.as_ref();
    let mut prior = rope_prior(tendon, request.catalogue, duty, mean_c, request.seed)?;
    prior.prior.temperature_ref_c = temperatures.first().copied().unwrap_or(23.0);
    Ok(prior)
}

fn verdict(joint: &JointTrend) -> TrendVerdict {
    let mut passed = (joint.limits.iter()).filter(|l| l.state == LimitState::Passed);
    match (passed.next().map(|l| l.limit), joint.suspicion) {
        (Some(Limit::Replace { .. }), _) => TrendVerdict::Replace,
        (Some(Limit::Retension { .. }), _) => TrendVerdict::Retension,
        _ if joint.events.iter().any(TrendEvent::is_jump) => TrendVerdict::Inspect,
        (_, Some(_)) => TrendVerdict::Watch,
        _ if joint.limits.is_empty() => TrendVerdict::NoLimit,
        _ => TrendVerdict::Wait,
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
    notes: &mut Vec<TrendNote>,
) -> Result<(Vec<SessionPoint>, Option<Added>), AnalyzeError> {
    let mut series = Vec::with_capacity(records.len());
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
            notes.push(TrendNote::OtherBaseline {
                joint: name.into(),
                time_utc_s: record.time_utc_s,
            });
        }
        baseline = own.or(baseline);
        let added = trend.add(Record {
            time_s,
            offset_rad: record.offset_rad,
            temperature_c: record.temperature_c,
            stiffness: record.stiffness_ratio,
        })?;
        series.push(SessionPoint {
            time_utc_s: record.time_utc_s,
            offset_rad: record.offset_rad,
            at_reference_rad: None,
            temperature_c: record.temperature_c,
            tracked_rad: TrendNow::of(trend).offset_rad,
            jump_probability: added.jump_probability,
            is_off: added.off,
        });
        if record.offset_rad.is_some() {
            last = Some(added);
        }
    }
    for t in pending {
        trend.tensioned(t - clock.start_utc_s)?;
    }
    Ok((series, last))
}

fn found_event(event: &Event, clock: &Clock, records: &[SessionRecord]) -> TrendEvent {
    let time_utc_s = clock.start_utc_s + event.time_s;
    let stated = event.size_rad.mean.is_nan();
    let stiffness_change_ratio = stiffness::change(records, time_utc_s);
    let cause = stiffness::cause(stiffness_change_ratio);
    TrendEvent {
        kind: match event.tensioned {
            true => TrendEventKind::Tensioned { stated },
            false => TrendEventKind::Jump { cause },
        },
        time_utc_s,
        size_rad: (!stated).then_some(event.size_rad),
        confirmed_utc_s: clock.start_utc_s + event.confirmed_s,
        probability: event.probability,
        stiffness_change_ratio,
    }
}
