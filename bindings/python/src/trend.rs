//! Months of sessions.

use crate::document::{Concern, Document, Shown};
use crate::failure::Failure;
use crate::robot::RobotArg;
use crate::work::work;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use sinew_files::date::{DAY_S, parse_utc_s};
use sinew_model::Gaussian;
use sinew_report::trend::{format_note, page, render_table, trend_series, trend_table};
use sinew_rope::{Catalogue, Duty};
use sinew_trend::fleet::{FleetTendon, RopePriors, best_of_days, trend_of_tendon};
use sinew_trend::{
    Passage, SessionRecord, Stated, TrendRequest, analyze, read_records, records_from_csv,
    records_from_json, sort_of,
};
use std::path::PathBuf;
use std::sync::OnceLock;

/// Source of session records: a file, or a text with a name.
#[derive(FromPyObject)]
pub(crate) enum Records {
    #[pyo3(annotation = "(kind, name, text)")]
    Text(String, String, String),
    #[pyo3(annotation = "path")]
    File(PathBuf),
}

/// Converts a date to s since 1970 UTC.
pub(crate) fn date_utc_s(date: &str) -> Result<f64, Failure> {
    parse_utc_s(date).ok_or_else(|| {
        Failure::new(format!(
            "'{date}' is not a date; expected a form such as 2026-03-01 or 2026-03-01T08:30Z"
        ))
    })
}

/// Converts specified tensionings or replacements.
fn stated(all: Vec<(Option<String>, String)>, replaced: bool) -> Result<Vec<Stated>, Failure> {
    let one = |(joint, date): (Option<String>, String)| {
        let time_utc_s = date_utc_s(&date)?;
        Ok(Stated {
            joint,
            time_utc_s,
            replaced,
        })
    };
    all.into_iter().map(one).collect()
}

/// Evaluates the trend of sessions over months.
#[pyfunction]
#[pyo3(signature = (records, robot, tensioned, replaced, duty, ropes, horizon_s, seed, progress))]
#[expect(clippy::too_many_arguments, reason = "they have names in Python")]
pub(crate) fn trend(
    py: Python<'_>,
    records: Vec<Records>,
    robot: Option<RobotArg<'_>>,
    tensioned: Vec<(Option<String>, String)>,
    replaced: Vec<(Option<String>, String)>,
    duty: Option<PathBuf>,
    ropes: Vec<PathBuf>,
    horizon_s: f64,
    seed: u64,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Document> {
    let robot = robot.as_ref().map(RobotArg::load).transpose()?;
    let catalogue = crate::catalogue::with_folders(&ropes)?;
    let mut all = stated(tensioned, false)?;
    all.extend(stated(replaced, true)?);
    let horizon_days = horizon_s / DAY_S;
    if !(1.0..=36_500.0).contains(&horizon_days) {
        let reason = format!(
            "horizon_s is {horizon_s} s; expected 86400 to 3.1536e9 s (1 day to 100 years)"
        );
        return Err(Failure::new(reason).into());
    }
    let report = work(py, "reading", progress.as_ref(), move |tracker| {
        let mut read = Vec::new();
        for source in &records {
            read.extend(match source {
                Records::File(path) => read_records(path)?,
                Records::Text(kind, name, text) if kind == "csv" => records_from_csv(text, name)?,
                Records::Text(_, name, text) => records_from_json(text, name)?,
            });
        }
        let robot = robot.as_ref().map(|loaded| &loaded.robot);
        let sorted = sort_of(read, robot)?;
        tracker.set_stage("analysing");
        let request = TrendRequest {
            robot,
            catalogue: &catalogue,
            stated: all,
            duty: duty.as_deref().map(Duty::open).transpose()?,
            // Lifetime statistics are available in the command only: sinew trend --life.
            life: None,
            horizon_days,
            seed,
        };
        Ok(analyze(sorted, &request)?)
    })?;
    let warnings = Concern::Recording.texts(report.notes.iter().map(format_note));
    let is_lossy = report.action_required;
    Ok(Shown::new(report, render_table)
        .page(page)
        .table("sessions", trend_table)
        .table("series", trend_series)
        .warnings(warnings)
        .lossy(is_lossy)
        .into())
}

/// Priors of the ropes of all tendons that this process follows.
static PRIORS: OnceLock<RopePriors> = OnceLock::new();

fn priors() -> Result<&'static RopePriors, Failure> {
    if let Some(priors) = PRIORS.get() {
        return Ok(priors);
    }
    let catalogue = Catalogue::shipped()?;
    Ok(PRIORS.get_or_init(|| RopePriors::new(catalogue)))
}

/// Session of a tendon: baseline, time and duration, s; offset and its standard deviation, rad; temperature, °C; stiffness ratio and
/// its standard deviation.
type Session = (
    Option<String>,
    f64,
    Option<f64>,
    f64,
    f64,
    Option<f64>,
    Option<f64>,
    Option<f64>,
);

/// Trend of one tendon of a fleet, identical to that of `sinew-fleet`, as a row of its columns.
///
/// * `rope`: installed rope, instead of that of the robot.
/// * `sessions`: in order of time, at most one at a time.
/// * `events`: dates of maintenance, and whether the rope was replaced.
#[pyfunction]
#[pyo3(signature = (robot, joint, rope, sessions, events))]
pub(crate) fn tendon_trend<'py>(
    py: Python<'py>,
    robot: RobotArg<'_>,
    joint: String,
    rope: Option<String>,
    sessions: Vec<Session>,
    events: Vec<(String, bool)>,
) -> PyResult<Bound<'py, PyDict>> {
    let mut robot = robot.load()?.robot.clone();
    if rope.is_some() {
        for transmission in robot.transmissions.iter_mut().flatten() {
            if let Some(tendon) = &mut transmission.tendon {
                tendon.rope = rope.clone();
            }
        }
    }
    let event = |(date, replaced): &(String, bool)| {
        Ok::<_, Failure>(Stated {
            joint: Some(joint.clone()),
            time_utc_s: date_utc_s(date)?,
            replaced: *replaced,
        })
    };
    let events = events.iter().map(event).collect::<Result<Vec<_>, _>>()?;
    let record = |session: Session| {
        let (baseline, time_utc_s, duration_s, mean, std, temperature_c, stiffness, its_std) =
            session;
        let stiffness = stiffness.zip(its_std.filter(|std| *std > 0.0));
        SessionRecord {
            baseline,
            time_utc_s,
            duration_s,
            joint: joint.clone(),
            offset_rad: Some(Gaussian::new(mean, std)),
            temperature_c,
            stiffness_ratio: stiffness.map(|(mean, std)| Gaussian::new(mean, std)),
            ..SessionRecord::default()
        }
    };
    let sessions = best_of_days(sessions.into_iter().map(record));
    let (name, count) = (joint.clone(), sessions.len());
    let trend = work(py, "analysing", None, move |_| {
        let index = robot.arm.joint_index(&name);
        let transmission = index.and_then(|i| robot.transmissions.get(i)?.as_ref());
        let of = FleetTendon {
            joint: &name,
            robot: Some(&robot),
            tendon: transmission.and_then(|t| t.tendon.as_ref()),
            events: &events,
        };
        Ok(trend_of_tendon(of, &sessions, priors()?, None, None)?.trend)
    })?;
    let row = PyDict::new(py);
    row.set_item("verdict", trend.verdict.name())?;
    for (name, value) in [
        ("offset_rad", Some(trend.offset_rad.mean)),
        ("offset_std_rad", Some(trend.offset_rad.std)),
        ("elongation_m", trend.elongation_m.map(|e| e.mean)),
        ("elongation_std_m", trend.elongation_m.map(|e| e.std)),
        ("rate_rad_per_s", Some(trend.rate_rad_per_s.mean)),
        ("rate_std_rad_per_s", Some(trend.rate_rad_per_s.std)),
        ("tensioned_utc_s", Some(trend.tensioned_utc_s)),
        ("last_utc_s", Some(trend.last_utc_s)),
    ] {
        // As in SQL, a value that is not finite is missing.
        row.set_item(name, value.filter(|x| x.is_finite()))?;
    }
    row.set_item("steps", trend.events.iter().filter(|e| e.is_jump()).count())?;
    row.set_item("sessions", count)?;
    let passages = Passage::all(&trend);
    if let Some(first) = Passage::first(&passages) {
        row.set_item("limit", first.limit.name())?;
        row.set_item("state", first.state.name())?;
        for (name, at_utc_s) in ["after_s", "after_low_s", "after_high_s"]
            .into_iter()
            .zip(first.at_utc_s)
        {
            row.set_item(name, at_utc_s.map(|at| at - trend.last_utc_s))?;
        }
    }
    Ok(row)
}
