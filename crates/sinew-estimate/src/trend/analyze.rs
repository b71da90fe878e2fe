//! From records to what a maintenance engineer acts on.

use super::clock::{Clock, LEVEL_UNKNOWN_RAD, Since, Stated, clock};
use super::error::AnalyzeError;
use super::limits;
use super::prior::{RopePrior, days, rope_prior};
use super::records::{SessionRecord, Sorted};
use super::result::{
    CycleClock, JointTrend, LifeNotUsed, Limit, LimitForecast, LimitState, PriorBasis,
    SessionPoint, Suspicion, TrendEvent, TrendEventKind, TrendNote, TrendReport, TrendVerdict,
};
use super::stiffness;
use super::survival::{LifeForecast, LifePrior};
use sinew_files::date::DAY_S;
use sinew_model::offset::TENSIONED_OFFSET_RAD;
use sinew_model::robot::Robot;
use sinew_model::transmission::Tendon;
use sinew_model::trend::{Added, Event, Record, Trend, TrendConfig, TrendNow};
use sinew_rope::{Catalogue, Duty};

/// A drift with temperature somewhat beyond what robot.toml, or rope and frame, allow for surprises nobody.
const DRIFT_FACTOR: f64 = 1.25;

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
    /// How long such ropes last, for tendons of which no strain limit says when to replace them.
    pub life: Option<LifePrior>,
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
            || j.life.as_ref().is_some_and(LifeForecast::is_passed)
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
    if let Some(robot) = request.robot {
        let unknown = drift_deviation_rad_per_k(robot, name);
        prior.prior.temperature_deviation_rad_per_k = DRIFT_FACTOR * unknown;
    }
    prior.prior.baseline_s = clock.baseline_s;
    prior.prior.level_deviation_rad = clock.level_deviation_rad;
    if clock.level_deviation_rad == LEVEL_UNKNOWN_RAD {
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
    for (point, record) in series.iter_mut().zip(records) {
        let reference_c = record.reference_c.unwrap_or(reference_c);
        let warm = point.temperature_c.map_or(0.0, |t| t - reference_c);
        point.at_reference_rad =
            (point.offset_rad).map(|y| y.mean - now.drift_rad_per_k.mean * warm);
    }
    let paths = limits::forecast_paths(&trend, days(request.horizon_days), request.seed);
    let rope_known = matches!(prior.basis, PriorBasis::Rope { .. });
    let time_of = |r: Option<&SessionRecord>| r.map_or(f64::NAN, |r| r.time_utc_s);
    let last_utc_s = time_of(records.last());
    let limits = limits::limits(tendon, &trend, &paths, rope_known, last_utc_s);
    let is_strain = |l: &LimitForecast| matches!(l.limit, Limit::Replace { .. });
    let unused = match limits.iter().any(is_strain) {
        true => Some(LifeNotUsed::StrainLimit),
        false => (!clock.stated).then_some(LifeNotUsed::AgeUnknown),
    };
    let life = request.life.as_ref().and_then(|life| match unused {
        None => Some(life.forecast(last_utc_s - clock.start_utc_s)),
        Some(why) => {
            let joint = name.into();
            notes.push(TrendNote::LifeNotUsed { joint, why });
            None
        }
    });
    let mut out = JointTrend {
        name: name.into(),
        verdict: TrendVerdict::NoLimit,
        sessions: records.len(),
        without_information: records.iter().filter(|r| r.offset_rad.is_none()).count(),
        first_utc_s: time_of(records.first()),
        last_utc_s,
        cycles: cycles(records),
        tensioned_utc_s: clock.start_utc_s,
        tensioned_stated: clock.stated,
        offset_rad: now.offset_rad,
        elongation_m: tendon.map(|t| now.offset_rad.scaled(t.joint_pulley_radius_m)),
        strain_ratio: tendon.map(|t| now.whole_rad.scaled(t.joint_pulley_radius_m / t.length_m)),
        rate_rad_per_s: now.rate_rad_per_s,
        drift_rad_per_k: (records.iter().any(|r| r.temperature_c.is_some()))
            .then_some(now.drift_rad_per_k),
        reference_c,
        baseline_error_rad: now.baseline_error_rad,
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
        limits,
        life,
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
    let reference_c = records.first().and_then(|r| r.reference_c);
    let first_c = temperatures.first().copied();
    prior.prior.temperature_ref_c = reference_c.or(first_c).unwrap_or(23.0);
    Ok(prior)
}

/// What is unknown of a joint's drift with temperature, as a standard deviation, rad/K: its sessions expect what rope and
/// frame do.
fn drift_deviation_rad_per_k(robot: &Robot, name: &str) -> f64 {
    let index = robot.arm.joint_index(name);
    let transmission = index.and_then(|i| robot.transmissions[i].as_ref());
    let warmth = transmission.and_then(|t| t.warmth);
    warmth.map_or(robot.tolerances.drift_rad_per_k(), |w| {
        w.drift_rad_per_k.deviation
    })
}

/// Cycles of the machine, where records count them: at the last, and how many a second.
fn cycles(records: &[SessionRecord]) -> Option<CycleClock> {
    /// Records the present pace is read off.
    const RECENT: usize = 20;
    let counted: Vec<(f64, f64)> = (records.iter().rev())
        .filter_map(|r| Some((r.time_utc_s, r.cycle?)))
        .take(RECENT)
        .collect();
    let (&(last_s, last), &(first_s, first)) = (counted.first()?, counted.last()?);
    let per_s = (last - first) / (last_s - first_s);
    Some(CycleClock {
        last,
        per_s: Some(per_s).filter(|p| *p > 0.0 && p.is_finite()),
    })
}

fn verdict(joint: &JointTrend) -> TrendVerdict {
    let mut passed = (joint.limits.iter()).filter(|l| l.state == LimitState::Passed);
    match (passed.next().map(|l| l.limit), joint.suspicion) {
        (Some(Limit::Replace { .. }), _) => TrendVerdict::Replace,
        (Some(Limit::Retension { .. }), _) => TrendVerdict::Retension,
        _ if joint.events.iter().any(TrendEvent::is_jump) => TrendVerdict::Inspect,
        _ if joint.life.as_ref().is_some_and(LifeForecast::is_passed) => TrendVerdict::ReplaceByAge,
        (_, Some(_)) => TrendVerdict::Watch,
        _ if joint.limits.is_empty() && joint.life.is_none() => TrendVerdict::NoLimit,
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
    let (mut last, mut since): (Option<Added>, Option<Since<'_>>) = (None, None);
    for record in records {
        let mut just_tensioned = false;
        while let Some(t) = pending.next_if(|t| *t <= record.time_utc_s) {
            trend.tensioned(t - clock.start_utc_s)?;
            just_tensioned = true;
        }
        let time_s = record.time_utc_s - clock.start_utc_s;
        let own = Since::of(record);
        if since.is_some_and(|before| own.differs(before)) {
            let known = record.baseline_time_utc_s.map(|t| t - clock.start_utc_s);
            match known.filter(|t| (trend.time_s()..=time_s).contains(t)) {
                Some(t) => trend.rebased(t, TENSIONED_OFFSET_RAD)?,
                None => trend.rebased(trend.time_s().max(time_s - 1.0), LEVEL_UNKNOWN_RAD)?,
            }
            if !just_tensioned {
                notes.push(TrendNote::OtherBaseline {
                    joint: name.into(),
                    time_utc_s: record.time_utc_s,
                });
            }
        }
        since = Some(since.map_or(own, |before| own.or(before)));
        let added = trend.add(Record {
            time_s,
            offset_rad: record.offset_rad,
            shared: record.shared_error,
            temperature_c: record.temperature_c,
            reference_c: record.reference_c,
            stiffness: record.stiffness_ratio,
        })?;
        series.push(SessionPoint {
            time_utc_s: record.time_utc_s,
            cycle: record.cycle,
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
        sessions: event.sessions,
        stiffness_change_ratio,
    }
}
