//! Months of sessions.

use crate::document::{Concern, Document, Shown};
use crate::failure::Failure;
use crate::robot::RobotArg;
use crate::work::work;
use pyo3::prelude::*;
use sinew_files::date::parse_utc_s;
use sinew_report::trend::{format_note, page, render_table, trend_series, trend_table};
use sinew_rope::Duty;
use sinew_trend::{
    Stated, TrendRequest, analyze, read_records, records_from_csv, records_from_json, sort_of,
};
use std::path::PathBuf;

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
#[pyo3(signature = (records, robot, tensioned, replaced, duty, ropes, horizon_days, seed, progress))]
#[expect(clippy::too_many_arguments, reason = "they have names in Python")]
pub(crate) fn trend(
    py: Python<'_>,
    records: Vec<Records>,
    robot: Option<RobotArg<'_>>,
    tensioned: Vec<(Option<String>, String)>,
    replaced: Vec<(Option<String>, String)>,
    duty: Option<PathBuf>,
    ropes: Vec<PathBuf>,
    horizon_days: f64,
    seed: u64,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Document> {
    let robot = robot.as_ref().map(RobotArg::load).transpose()?;
    let catalogue = crate::catalogue::with_folders(&ropes)?;
    let mut all = stated(tensioned, false)?;
    all.extend(stated(replaced, true)?);
    if !(1.0..=36_500.0).contains(&horizon_days) {
        let reason = format!("horizon_days is {horizon_days}; it must be 1 to 36500");
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
