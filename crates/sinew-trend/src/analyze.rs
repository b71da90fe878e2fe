//! Trend analysis: from session records to verdicts, events and forecasts per tendon.

use super::clock::{Clock, LEVEL_UNKNOWN_RAD, Stated, clock};
use super::error::AnalyzeError;
use super::inputs::{CompleteTrend, LoadedTrend, feed, inputs};
use super::limits;
use super::passage::FirstPassage;
use super::prior::{RopePrior, days, rope_prior_with_progress};
use super::records::{SessionRecord, Sorted};
use super::result::{
    CycleClock, ForecastPoint, JointTrend, LifeNotUsed, Limit, LimitForecast, LimitState,
    PriorBasis, SessionPoint, SuspectedStep, TrendEvent, TrendEventKind, TrendNote, TrendReport,
    TrendVerdict,
};
use super::stiffness;
use super::survival::{LifeForecast, LifePrior};
use crate::filter::{Added, Event, Paths, Prior, Trend, TrendNow};
use sinew_files::date::DAY_S;
use sinew_model::robot::Robot;
use sinew_model::transmission::Tendon;
use sinew_rope::{Catalogue, Duty};

/// Factor on the drift prior of robot.toml, or of rope and frame, so that somewhat larger drifts
/// remain plausible.
const DRIFT_FACTOR: f64 = 1.25;

/// Inputs of a trend analysis in addition to the records.
#[derive(Debug)]
pub struct TrendRequest<'a> {
    /// Robot description: ropes, geometry and limits.
    pub robot: Option<&'a Robot>,
    /// Catalogue of ropes.
    pub catalogue: &'a Catalogue,
    /// Specified tensionings and replacements, in any order.
    pub stated: Vec<Stated>,
    /// Duty of the ropes, if specified.
    pub duty: Option<Duty>,
    /// Lifetime distribution of such ropes, for tendons without a strain limit.
    pub life: Option<LifePrior>,
    /// Forecast horizon, days.
    pub horizon_days: f64,
    /// Seed of the posterior draws.
    pub seed: u64,
}

/// Analyses sorted records of all tendons.
///
/// # Errors
/// Returns an [`AnalyzeError`] if a specified day matches no joint or no session, a rope is
/// invalid, or a record is invalid.
pub fn analyze(sorted: Sorted, request: &TrendRequest<'_>) -> Result<TrendReport, AnalyzeError> {
    analyze_with_progress(sorted, request, &|_| ())
}

/// Analyses sorted records as [`analyze`] does.
///
/// * `done`: called with the completed share; a duty takes most of the time.
///
/// # Errors
/// Returns an [`AnalyzeError`] as [`analyze`] does.
pub fn analyze_with_progress(
    sorted: Sorted,
    request: &TrendRequest<'_>,
    done: &dyn Fn(f64),
) -> Result<TrendReport, AnalyzeError> {
    let available: Vec<&str> = sorted.joints.iter().map(|(n, _)| n.as_str()).collect();
    for stated in &request.stated {
        if let Some(joint) = stated.joint.as_deref().filter(|j| !available.contains(j)) {
            return Err(AnalyzeError::Joint {
                joint: joint.into(),
                available: available.join(", "),
            });
        }
    }
    let mut notes = sorted.notes;
    let mut joints = Vec::new();
    let count = sorted.joints.len() as f64;
    for (i, (name, records)) in sorted.joints.iter().enumerate() {
        let done = |share: f64| done((i as f64 + share) / count);
        joints.push(joint(name, records, request, &mut notes, &done)?.0);
    }
    let action_required = joints.iter().any(|j| {
        (j.limits.iter()).any(|l| l.state == LimitState::Passed)
            || j.events.iter().any(TrendEvent::is_jump)
            || j.life.as_ref().is_some_and(LifeForecast::is_passed)
    });
    Ok(TrendReport {
        sinew_version: env!("CARGO_PKG_VERSION").into(),
        robot: sorted.robot,
        joints,
        action_required,
        horizon_s: days(request.horizon_days),
        notes,
    })
}

/// Analyses one tendon as [`analyze`] does, and returns the first-passage times of its limits.
///
/// * `records`: in order of time, as returned by [`sort`](super::sort).
///
/// # Errors
/// Returns an [`AnalyzeError`] as [`analyze`] does.
pub fn analyze_joint(
    name: &str,
    records: &[SessionRecord],
    request: &TrendRequest<'_>,
) -> Result<(JointTrend, Vec<FirstPassage>), AnalyzeError> {
    let (trend, paths) = joint(name, records, request, &mut Vec::new(), &|_| ())?;
    let limits = trend.limits.iter();
    let times = limits.filter_map(|limit| limits::passage_times(limit, &paths));
    let times = times.collect();
    Ok((trend, times))
}

/// Trend of one tendon and its forecast paths.
fn joint(
    name: &str,
    records: &[SessionRecord],
    request: &TrendRequest<'_>,
    notes: &mut Vec<TrendNote>,
    done: &dyn Fn(f64),
) -> Result<(JointTrend, Paths), AnalyzeError> {
    let tendon = request.robot.and_then(|r| tendon_of(r, name));
    let (clock, records) = clock(name, records, &request.stated)?;
    let duty = request.duty.as_ref();
    let mean_c = mean_temperature_c(records);
    let load = (duty, mean_c);
    let rope = rope_prior_with_progress(tendon, request.catalogue, load, request.seed, done)?;
    let prior = prior(name, rope.prior, records, &clock, request);
    note_clock(name, records, &clock, notes);
    let inputs = inputs(records, &clock, name, notes);
    let mut sessions = records.iter();
    let mut series = Vec::with_capacity(records.len());
    let mut each = |trend: &Trend, added: &Added| {
        series.extend(sessions.next().map(|record| SessionPoint {
            time_utc_s: record.time_utc_s,
            cycle: record.cycle,
            offset_rad: record.offset_rad,
            at_reference_rad: None,
            temperature_c: record.temperature_c,
            tracked_rad: TrendNow::of(trend).offset_rad,
            step_probability: added.step_probability,
            is_outlier: added.off,
        }));
    };
    let fed = feed(prior, &inputs, None, Some(&mut each))?;
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

/// Resumes the trend of one tendon from an earlier call, without series and without forecast over
/// time.
///
/// The result is bitwise identical to that of all records at once. The trend is restarted if the
/// records, the specified actions or the prior of the rope changed.
///
/// * `rope`: prior of the rope ([`rope_prior`](super::prior::rope_prior)), used instead of that of the request.
///
/// # Errors
/// Returns an [`AnalyzeError`] as [`analyze`] does.
pub fn resume_joint(
    name: &str,
    records: &[SessionRecord],
    rope: &RopePrior,
    request: &TrendRequest<'_>,
    kept: Option<LoadedTrend>,
) -> Result<ResumedTrend, AnalyzeError> {
    let mut notes = Vec::new();
    let (clock, records) = clock(name, records, &request.stated)?;
    let prior = prior(name, rope.prior.clone(), records, &clock, request);
    let inputs = inputs(records, &clock, name, &mut notes);
    let fed = feed(prior, &inputs, kept, None)?;
    let basis = rope.basis.clone();
    let (trend, paths) = found(name, records, basis, &clock, &fed, request, &mut notes);
    Ok(ResumedTrend {
        trend,
        kept: fed.keep(),
        is_resumed: fed.is_resumed,
        paths,
        now_s: fed.trend.time_s(),
    })
}

/// Trend of one tendon with the state to resume it from.
#[derive(Debug, Clone, PartialEq)]
pub struct ResumedTrend {
    /// Result without series and forecast.
    pub trend: JointTrend,
    /// State to resume from when further sessions arrive.
    pub kept: LoadedTrend,
    /// Whether the stored state was resumed rather than restarted.
    pub is_resumed: bool,
    paths: Paths,
    now_s: f64,
}

impl ResumedTrend {
    /// Offset at a time after the last session, s; `None` beyond the horizon.
    pub fn offset_after(&self, after_s: f64) -> Option<ForecastPoint> {
        let time_utc_s = self.trend.last_utc_s + after_s;
        limits::forecast_at(&self.paths, self.now_s + after_s, time_utc_s)
    }
}

/// Adds notes about the start of a clock.
fn note_clock(name: &str, records: &[SessionRecord], clock: &Clock, notes: &mut Vec<TrendNote>) {
    if clock.level_std_rad == LEVEL_UNKNOWN_RAD {
        notes.push(TrendNote::TensioningNotSpecified { joint: name.into() });
    }
    /// Minimum time between tensioning and first session that is reported, days.
    const MIN_REPORTED_GAP_DAYS: f64 = 90.0;
    let first_utc_s = records.first().map_or(f64::NAN, |r| r.time_utc_s);
    let silent_days = (first_utc_s - clock.start_utc_s) / DAY_S;
    if clock.stated && silent_days > MIN_REPORTED_GAP_DAYS {
        notes.push(TrendNote::LongBefore {
            joint: name.into(),
            time_utc_s: clock.start_utc_s,
            days: silent_days,
        });
    }
}

/// Result of a trend after its last record, without series and forecast over time, and its forecast
/// paths.
fn found(
    name: &str,
    records: &[SessionRecord],
    basis: PriorBasis,
    clock: &Clock,
    fed: &CompleteTrend,
    request: &TrendRequest<'_>,
    notes: &mut Vec<TrendNote>,
) -> (JointTrend, Paths) {
    let tendon = request.robot.and_then(|r| tendon_of(r, name));
    let (trend, now) = (&fed.trend, fed.now);
    let paths = limits::forecast_paths(trend, days(request.horizon_days), request.seed);
    let rope_specified = matches!(basis, PriorBasis::Rope { .. });
    let time_of = |r: Option<&SessionRecord>| r.map_or(f64::NAN, |r| r.time_utc_s);
    let last_utc_s = time_of(records.last());
    let limits = limits::limits(tendon, trend, &paths, rope_specified, last_utc_s);
    let is_strain = |l: &LimitForecast| matches!(l.limit, Limit::Replace { .. });
    let unused = match limits.iter().any(is_strain) {
        true => Some(LifeNotUsed::StrainLimit),
        false => (!clock.stated).then_some(LifeNotUsed::AgeUnknown),
    };
    let life = request.life.as_ref().and_then(|life| match unused {
        None => Some(life.forecast(last_utc_s - clock.start_utc_s)),
        Some(reason) => {
            let joint = name.into();
            notes.push(TrendNote::LifeNotUsed { joint, reason });
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
        tensioned_specified: clock.stated,
        offset_rad: now.offset_rad,
        elongation_m: tendon.map(|t| now.offset_rad.scaled(t.joint_pulley_radius_m)),
        strain_ratio: tendon.map(|t| now.whole_rad.scaled(t.joint_pulley_radius_m / t.length_m)),
        rate_rad_per_s: now.rate_rad_per_s,
        drift_rad_per_k: (records.iter().any(|r| r.temperature_c.is_some()))
            .then_some(now.drift_rad_per_k),
        reference_c: trend.prior().temperature_ref_c,
        baseline_error_rad: now.baseline_error_rad,
        systematic_error_rad: now.slow_std_rad,
        reported_width_ratio: now.white_scale,
        events: (trend.events().iter())
            .map(|e| found_event(e, clock, records))
            .collect(),
        suspected_step: fed.last.and_then(|added| {
            Some(SuspectedStep {
                time_utc_s: clock.start_utc_s + added.suspected_s?,
                probability: added.step_probability,
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

/// Mean temperature of the sessions, °C; 23 °C if none reports one.
pub fn mean_temperature_c(records: &[SessionRecord]) -> f64 {
    let (count, sum) = (records.iter().filter_map(|r| r.temperature_c))
        .fold((0.0, 0.0), |(count, sum), celsius| {
            (count + 1.0, sum + celsius)
        });
    if count > 0.0 { sum / count } else { 23.0 }
}

/// Prior of a tendon before its first record, from its rope and the start of its clock.
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
        let unknown = drift_std_rad_per_k(robot, name);
        out.temperature_std_rad_per_k = DRIFT_FACTOR * unknown;
    }
    out.baseline_s = clock.baseline_s;
    out.level_std_rad = clock.level_std_rad;
    out
}

/// Standard deviation of a joint's unknown drift with temperature, rad/K; the sessions already
/// correct the expected drift of rope and frame.
fn drift_std_rad_per_k(robot: &Robot, name: &str) -> f64 {
    let index = robot.tendon_index(name);
    let transmission = index.and_then(|i| robot.transmissions[i].as_ref());
    let thermal = transmission.and_then(|t| t.temperature_effect);
    thermal.map_or(robot.tolerances.drift_rad_per_k(), |w| {
        w.drift_rad_per_k.std
    })
}

/// Machine cycles, if records count them: the count at the last record and the rate.
fn cycles(records: &[SessionRecord]) -> Option<CycleClock> {
    /// Number of records used for the present cycle rate.
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
    match (passed.next().map(|l| l.limit), joint.suspected_step) {
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
            false => TrendEventKind::StepChange { cause },
        },
        time_utc_s,
        size_rad: (!stated).then_some(event.size_rad),
        confirmed_utc_s: clock.start_utc_s + event.confirmed_s,
        probability: event.probability,
        sessions: event.sessions,
        stiffness_change_ratio,
    }
}
