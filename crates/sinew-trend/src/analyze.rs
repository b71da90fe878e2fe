//! From records to what a maintenance engineer acts on.

use super::clock::{Clock, LEVEL_UNKNOWN_RAD, Stated, clock};
use super::error::AnalyzeError;
use super::given::{Fed, KeptTrend, feed, given};
use super::limits;
use super::passage::PassageTimes;
use super::prior::{RopePrior, days, rope_prior};
use super::records::{SessionRecord, Sorted};
use super::result::{
    CycleClock, ForecastPoint, JointTrend, LifeNotUsed, Limit, LimitForecast, LimitState,
    PriorBasis, SessionPoint, Suspicion, TrendEvent, TrendEventKind, TrendNote, TrendReport,
    TrendVerdict,
};
use super::stiffness;
use super::survival::{LifeForecast, LifePrior};
use crate::filter::{Event, Paths, Prior, TrendNow};
use sinew_files::date::DAY_S;
use sinew_model::robot::Robot;
use sinew_model::transmission::Tendon;
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
        joints.push(joint(name, records, request, &mut notes)?.0);
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

/// One tendon as [`analyze`] makes it, and when it passes its limits.
///
/// * `records`: in the order of time, as [`sort`](super::sort) gives them.
///
/// # Errors
/// [`AnalyzeError`].
pub fn analyze_joint(
    name: &str,
    records: &[SessionRecord],
    request: &TrendRequest<'_>,
) -> Result<(JointTrend, Vec<PassageTimes>), AnalyzeError> {
    let (trend, paths) = joint(name, records, request, &mut Vec::new())?;
    let limits = trend.limits.iter();
    let times = limits.filter_map(|limit| limits::passage_times(limit, &paths));
    let times = times.collect();
    Ok((trend, times))
}

/// One tendon from its records, and the paths it may take.
fn joint(
    name: &str,
    records: &[SessionRecord],
    request: &TrendRequest<'_>,
    notes: &mut Vec<TrendNote>,
) -> Result<(JointTrend, Paths), AnalyzeError> {
    let tendon = request.robot.and_then(|r| tendon_of(r, name));
    let (clock, records) = clock(name, records, &request.stated)?;
    let duty = request.duty.as_ref();
    let mean_c = mean_temperature_c(records);
    let rope = rope_prior(tendon, request.catalogue, duty, mean_c, request.seed)?;
    let prior = prior(name, rope.prior, records, &clock, request);
    note_clock(name, records, &clock, notes);
    let given = given(records, &clock, name, notes);
    let mut sessions = records.iter();
    let mut series = Vec::with_capacity(records.len());
    let fed = feed(prior, &given, None, |trend, added| {
        series.extend(sessions.next().map(|record| SessionPoint {
            time_utc_s: record.time_utc_s,
            cycle: record.cycle,
            offset_rad: record.offset_rad,
            at_reference_rad: None,
            temperature_c: record.temperature_c,
            tracked_rad: TrendNow::of(trend).offset_rad,
            jump_probability: added.jump_probability,
            is_off: added.off,
        }));
    })?;
    let (mut out, paths) = found(name, records, rope.basis, &clock, &fed, request, notes);
    for (point, record) in series.iter_mut().zip(records) {
        let reference_c = record.reference_c.unwrap_or(out.reference_c);
        let warm = point.temperature_c.map_or(0.0, |t| t - reference_c);
        let drift = fed.now.drift_rad_per_k.mean;
        point.at_reference_rad = (point.offset_rad).map(|y| y.mean - drift * warm);
    }
    out.series = series;
    out.forecast = limits::forecast(&paths, clock.start_utc_s);
    Ok((out, paths))
}

/// The trend of one tendon without its series and the forecast over time, from where an earlier question left it: to the last
/// bit as from nothing. Where the records, what was done or the rope's prior aren't what they were, it begins anew.
///
/// * `rope`: what its rope says ([`rope_prior`]), instead of the request's.
///
/// # Errors
/// [`AnalyzeError`].
pub fn go_on(
    name: &str,
    records: &[SessionRecord],
    rope: &RopePrior,
    request: &TrendRequest<'_>,
    kept: Option<KeptTrend>,
) -> Result<GoneOn, AnalyzeError> {
    let mut notes = Vec::new();
    let (clock, records) = clock(name, records, &request.stated)?;
    let prior = prior(name, rope.prior.clone(), records, &clock, request);
    let given = given(records, &clock, name, &mut notes);
    let fed = feed(prior, &given, kept, |_, _| ())?;
    let basis = rope.basis.clone();
    let (trend, paths) = found(name, records, basis, &clock, &fed, request, &mut notes);
    Ok(GoneOn {
        trend,
        kept: fed.keep(),
        went_on: fed.went_on,
        paths,
        now_s: fed.trend.time_s(),
    })
}

/// A trend that can go on.
#[derive(Debug, Clone, PartialEq)]
pub struct GoneOn {
    /// The trend.
    pub trend: JointTrend,
    /// To go on from, when there are more sessions.
    pub kept: KeptTrend,
    /// Whether it went on from what was kept, and not from nothing.
    pub went_on: bool,
    paths: Paths,
    now_s: f64,
}

impl GoneOn {
    /// The offset so long after the last session; `None`: beyond the horizon.
    pub fn offset_after(&self, after_s: f64) -> Option<ForecastPoint> {
        let time_utc_s = self.trend.last_utc_s + after_s;
        limits::forecast_at(&self.paths, self.now_s + after_s, time_utc_s)
    }
}

/// What is worth a word of how a clock began.
fn note_clock(name: &str, records: &[SessionRecord], clock: &Clock, notes: &mut Vec<TrendNote>) {
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
}

/// What a trend that has seen everything says, without its series and the forecast over time; and the paths it may take.
fn found(
    name: &str,
    records: &[SessionRecord],
    basis: PriorBasis,
    clock: &Clock,
    fed: &Fed,
    request: &TrendRequest<'_>,
    notes: &mut Vec<TrendNote>,
) -> (JointTrend, Paths) {
    let tendon = request.robot.and_then(|r| tendon_of(r, name));
    let (trend, now) = (&fed.trend, fed.now);
    let paths = limits::forecast_paths(trend, days(request.horizon_days), request.seed);
    let rope_known = matches!(basis, PriorBasis::Rope { .. });
    let time_of = |r: Option<&SessionRecord>| r.map_or(f64::NAN, |r| r.time_utc_s);
    let last_utc_s = time_of(records.last());
    let limits = limits::limits(tendon, trend, &paths, rope_known, last_utc_s);
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
        reference_c: trend.prior().temperature_ref_c,
        baseline_error_rad: now.baseline_error_rad,
        shared_error_rad: now.slow_deviation_rad,
        stated_width_ratio: now.white_scale,
        events: (trend.events().iter())
            .map(|e| found_event(e, clock, records))
            .collect(),
        suspicion: fed.last.and_then(|added| {
            Some(Suspicion {
                time_utc_s: clock.start_utc_s + added.suspected_s?,
                probability: added.jump_probability,
            })
        }),
        limits,
        life,
        basis,
        series: Vec::new(),
        forecast: Vec::new(),
    };
    out.verdict = verdict(&out);
    (out, paths)
}

/// Mean temperature of sessions, °C; that of a workshop where none says one.
pub fn mean_temperature_c(records: &[SessionRecord]) -> f64 {
    let (count, sum) = (records.iter().filter_map(|r| r.temperature_c))
        .fold((0.0, 0.0), |(count, sum), celsius| {
            (count + 1.0, sum + celsius)
        });
    if count > 0.0 { sum / count } else { 23.0 }
}

/// What is known of a tendon before its first record: its rope's prior, and how its clock began.
fn prior(
    name: &str,
    rope: Prior,
    records: &[SessionRecord],
    clock: &Clock,
    request: &TrendRequest<'_>,
) -> Prior {
    let mut out = rope;
    let reference_c = records.first().and_then(|r| r.reference_c);
    let first_c = records.iter().find_map(|r| r.temperature_c);
    out.temperature_ref_c = reference_c.or(first_c).unwrap_or(23.0);
    if let Some(robot) = request.robot {
        let unknown = drift_deviation_rad_per_k(robot, name);
        out.temperature_deviation_rad_per_k = DRIFT_FACTOR * unknown;
    }
    out.baseline_s = clock.baseline_s;
    out.level_deviation_rad = clock.level_deviation_rad;
    out
}

/// What is unknown of a joint's drift with temperature, as a standard deviation, rad/K: its sessions expect what rope and
/// frame do.
fn drift_deviation_rad_per_k(robot: &Robot, name: &str) -> f64 {
    let index = robot.tendon_index(name);
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
    let i = robot.tendon_index(joint)?;
    robot.transmissions.get(i)?.as_ref()?.tendon.as_ref()
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
