//! Estimates of recordings, and baselines.

use crate::document::{Concern, Document, Notice, Shown};
use crate::failure::Failure;
use crate::recording::{LogArg, one_of};
use crate::robot::{RobotArg, hash_of};
use crate::table::Reduced;
use crate::trend::date_utc_s;
use crate::work::{ProgressTracker, work};
use pyo3::prelude::*;
use sinew_estimate::baseline::{self, MergeOptions};
use sinew_estimate::feeder::Injection;
use sinew_estimate::session::{self, Learning, Payload, SessionOptions, Window, stated};
use sinew_estimate::{
    BaselineDocument, EstimateDocument, Given, Method, Plan, Progress, Request,
    estimate_each as each,
};
use sinew_files::JsonDocument as _;
use sinew_model::Gaussian;
use sinew_model::offset::{Comparison, TorqueSource, VelocityFilter};
use sinew_report::{document_warnings, each_summary, each_table, estimate_series, tables};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Reference posterior recorded directly after tensioning, and updated by later sessions.
#[pyclass(frozen, module = "pysinew._core")]
pub(crate) struct Baseline {
    pub(crate) baseline: Arc<baseline::Baseline>,
    /// Name of the baseline in results and messages.
    pub(crate) name: String,
}

/// Baseline, or the path of its file.
#[derive(FromPyObject)]
pub(crate) enum BaselineArg<'py> {
    #[pyo3(annotation = "Baseline")]
    Held(Bound<'py, Baseline>),
    #[pyo3(annotation = "path")]
    File(PathBuf),
}

/// A baseline and its name.
pub(crate) type Named = (Arc<baseline::Baseline>, String);

impl BaselineArg<'_> {
    /// Returns the baseline, read from its file if necessary.
    pub(crate) fn read(&self) -> Result<Named, Failure> {
        Ok(match self {
            Self::Held(held) => (held.get().baseline.clone(), held.get().name.clone()),
            Self::File(path) => {
                let read = baseline::Baseline::read(path)?;
                (Arc::new(read), path.display().to_string())
            }
        })
    }
}

#[pymethods]
impl Baseline {
    /// Reads a baseline.
    ///
    /// Parameters
    /// ----------
    /// path
    ///     File of ``sinew baseline``.
    ///
    /// Returns
    /// -------
    /// Baseline
    ///     The baseline.
    ///
    /// Raises
    /// ------
    /// SinewError
    ///     For an invalid or missing file.
    #[staticmethod]
    fn read(path: PathBuf) -> PyResult<Self> {
        let (baseline, name) = BaselineArg::File(path).read()?;
        Ok(Self { baseline, name })
    }

    /// Parses a baseline.
    ///
    /// Parameters
    /// ----------
    /// text
    ///     Content of a file of ``sinew baseline``.
    /// name
    ///     Name of the baseline in results and messages.
    ///
    /// Returns
    /// -------
    /// Baseline
    ///     The baseline.
    ///
    /// Raises
    /// ------
    /// SinewError
    ///     For an invalid text.
    #[staticmethod]
    #[pyo3(signature = (text, *, name="baseline"))]
    fn from_text(text: &str, name: &str) -> PyResult<Self> {
        let parsed = baseline::Baseline::parse(text, name).map_err(Failure::from)?;
        Ok(Self {
            baseline: Arc::new(parsed),
            name: name.to_owned(),
        })
    }

    /// Text of the file, from which the C interface creates offsets.
    fn to_text(&self) -> String {
        self.baseline.to_text()
    }

    /// Writes a file for the option ``--baseline`` of the command; it is complete or absent.
    ///
    /// Parameters
    /// ----------
    /// path
    ///     File to write.
    ///
    /// Raises
    /// ------
    /// SinewError
    ///     If it cannot be written.
    fn write(&self, path: PathBuf) -> PyResult<()> {
        Ok(self.baseline.write(&path).map_err(Failure::from)?)
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.baseline.to_text() == other.baseline.to_text()
    }

    fn __hash__(&self) -> u64 {
        hash_of(&self.baseline.to_text())
    }

    #[staticmethod]
    #[pyo3(name = "_restore")]
    fn restore(text: &str, name: &str) -> PyResult<Self> {
        Self::from_text(text, name)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py, (String, String)>> {
        let restore = py.get_type::<Self>().getattr("_restore")?;
        Ok((restore, (self.to_text(), self.name.clone())))
    }

    /// Name of the robot.
    #[getter]
    fn robot(&self) -> &str {
        &self.baseline.robot
    }

    /// Names of the robot's joints.
    #[getter]
    fn joints(&self) -> Vec<String> {
        self.baseline.joints.clone()
    }

    /// Recordings from which the baseline was estimated.
    #[getter]
    fn recordings(&self) -> Vec<String> {
        self.baseline.recordings.clone()
    }

    fn __repr__(&self) -> String {
        let (robot, from) = (&self.baseline.robot, self.baseline.recordings.join(", "));
        format!("<pysinew.Baseline of '{robot}' from {from}>")
    }
}

const SOURCES: [(&str, TorqueSource); 3] = [
    ("observer", TorqueSource::Observer),
    ("torque-sensor", TorqueSource::TorqueSensor),
    ("motor", TorqueSource::Motor),
];

const COMPARISONS: [(&str, Comparison); 2] = [
    ("matched", Comparison::Matched),
    ("paper", Comparison::Paper),
];

const METHODS: [(&str, Method); 2] = [("absolute", Method::Absolute), ("paper", Method::Paper)];

/// A number, or its mean and standard deviation.
#[derive(FromPyObject, Clone, Copy)]
pub(crate) enum Stated {
    #[pyo3(transparent, annotation = "float")]
    Mean(f64),
    #[pyo3(annotation = "(mean, deviation)")]
    Both(f64, f64),
}

impl Stated {
    fn parts(self) -> (f64, Option<f64>) {
        match self {
            Self::Mean(mean) => (mean, None),
            Self::Both(mean, std) => (mean, Some(std)),
        }
    }
}

/// Temperature of a session, °C.
pub(crate) fn temperature(stated_c: Option<Stated>) -> Result<Option<Gaussian>, Failure> {
    let parts = stated_c.map(Stated::parts);
    let read = parts.map(|(c, std_k)| stated::temperature(c, std_k));
    Ok(read.transpose()?)
}

/// Converts a constant external force, N.
pub(crate) fn external_force(
    stated_n: Option<([f64; 3], f64)>,
) -> Result<Option<[Gaussian; 3]>, Failure> {
    let read = stated_n.map(|(mean_n, std_n)| stated::external_force(mean_n, std_n));
    Ok(read.transpose()?)
}

/// Payload of a session; `None`: unknown.
pub(crate) fn payload(empty: bool, stated_kg: Option<Stated>) -> Result<Payload, Failure> {
    match (empty, stated_kg) {
        (true, Some(_)) => Err(Failure::new("empty and payload_kg are mutually exclusive")),
        (true, None) => Ok(Payload::Empty),
        (false, None) => Ok(Payload::Unknown),
        (false, Some(stated_kg)) => {
            let (mass_kg, std_kg) = stated_kg.parts();
            Ok(stated::payload(mass_kg, std_kg)?)
        }
    }
}

/// A cut-off, rad/s, or the word `recorded`.
#[derive(FromPyObject)]
enum FilterArg {
    #[pyo3(transparent, annotation = "float")]
    Cutoff(f64),
    #[pyo3(transparent, annotation = "'recorded'")]
    Word(String),
}

/// Options of an estimate besides its recordings.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct EstimateArgs<'py> {
    robot: Option<RobotArg<'py>>,
    baseline: Option<BaselineArg<'py>>,
    reference: Option<LogArg<'py>>,
    method: Option<String>,
    inject: Vec<(String, f64, Option<f64>)>,
    source: Option<String>,
    comparison: Option<String>,
    gain_per_s: Option<f64>,
    velocity_filter: Option<FilterArg>,
    tau_ext: bool,
    empty: bool,
    payload_kg: Option<Stated>,
    temperature_c: Option<Stated>,
    /// Along the axes of the base, and the standard deviation of each.
    external_force_n: Option<([f64; 3], f64)>,
    motor_torque: bool,
    from_s: f64,
    to_s: Option<f64>,
    date: Option<String>,
    online: bool,
}

impl EstimateArgs<'_> {
    /// Returns the requested method, or the one whose options are set.
    fn method(&self) -> Result<Method, Failure> {
        let paper = self.reference.is_some()
            || self.source.is_some()
            || self.comparison.is_some()
            || self.gain_per_s.is_some()
            || self.velocity_filter.is_some()
            || self.tau_ext;
        match &self.method {
            Some(word) => one_of("method", word, &METHODS),
            None if paper && self.baseline.is_none() => Ok(Method::Paper),
            None => Ok(Method::Absolute),
        }
    }

    /// Rejects options of the absolute estimate for the paper's method.
    fn check_paper_options(&self) -> Result<(), Failure> {
        let options = [
            ("empty", self.empty),
            ("payload_kg", self.payload_kg.is_some()),
            ("temperature_c", self.temperature_c.is_some()),
            ("external_force_n", self.external_force_n.is_some()),
            ("motor_torque", !self.motor_torque),
            ("from_s", self.from_s != 0.0),
            ("to_s", self.to_s.is_some()),
            ("date", self.date.is_some()),
            ("online", self.online),
        ];
        match options.into_iter().find(|(_, is_set)| *is_set) {
            None => Ok(()),
            Some((option, _)) => Err(Failure::new(format!(
                "{option} applies to the absolute estimate only: set method='absolute' or remove {option}"
            ))),
        }
    }

    fn request(&self, log: &LogArg<'_>) -> Result<Request, Failure> {
        let mut request = Request::new(log.name());
        let mut given = log.give(Given::default());
        match &self.robot {
            Some(RobotArg::Loaded(robot)) => given.robot = Some(robot.get().loaded().clone()),
            Some(RobotArg::Place(place)) => request.robot = Some(place.clone()),
            None => {}
        }
        if let Some(reference) = &self.reference {
            // Recordings are distinguished by their names.
            let in_memory = |log: &LogArg<'_>| matches!(log, LogArg::Recording(_));
            if reference.name() == log.name() && (in_memory(reference) || in_memory(log)) {
                return Err(Failure::new(format!(
                    "the recording and its reference are both called '{}'; set another name= for one of them",
                    log.name().display()
                )));
            }
            request.reference = Some(reference.name());
            given = reference.give(given);
        }
        request.given = given;
        request.open = log.options();
        if let Some(word) = &self.source {
            request.source = one_of("source", word, &SOURCES)?;
        }
        if let Some(word) = &self.comparison {
            request.comparison = one_of("comparison", word, &COMPARISONS)?;
        }
        request.gain_per_s = self.gain_per_s;
        request.velocity_filter = match &self.velocity_filter {
            None => request.velocity_filter,
            Some(FilterArg::Word(word)) => one_of(
                "velocity_filter",
                word,
                &[("recorded", VelocityFilter::Recorded)],
            )?,
            Some(FilterArg::Cutoff(cutoff_rad_per_s)) => VelocityFilter::StateVariable {
                cutoff_rad_per_s: *cutoff_rad_per_s,
            },
        };
        request.use_tau_ext = self.tau_ext;
        request.date_utc_s = (self.date.as_deref()).map(date_utc_s).transpose()?;
        let inject = self.inject.iter().cloned();
        request.injections = inject
            .map(|(joint, offset_rad, from_s)| Injection {
                joint,
                offset_rad,
                from_s,
            })
            .collect();
        Ok(request)
    }

    fn plan(&self) -> Result<Planned, Failure> {
        let method = self.method()?;
        if method == Method::Paper {
            self.check_paper_options()?;
        }
        Ok(Planned {
            method,
            window: stated::window(self.from_s, self.to_s)?,
            online: self.online,
            baseline: self.baseline.as_ref().map(BaselineArg::read).transpose()?,
            options: SessionOptions {
                payload: payload(self.empty, self.payload_kg)?,
                motor_torque: self.motor_torque,
                temperature_c: temperature(self.temperature_c)?,
                external_force_n: external_force(self.external_force_n)?,
                ..SessionOptions::default()
            },
        })
    }
}

/// A plan that owns its baseline.
struct Planned {
    method: Method,
    window: Window,
    online: bool,
    baseline: Option<Named>,
    options: SessionOptions,
}

impl Planned {
    fn plan(&self) -> Plan<'_> {
        let baseline = self.baseline.as_ref();
        Plan {
            method: self.method,
            window: self.window,
            baseline: baseline.map(|(baseline, name)| (&**baseline, name.as_str())),
            options: self.options,
            online: self.online,
        }
    }
}

/// Returns a callback that reports the progress of an estimate.
fn reporter(tracker: &ProgressTracker) -> impl FnMut(Progress) + '_ {
    |at| {
        tracker.set_stage(match at.reference {
            true => "reference",
            false => "estimating",
        });
        tracker.at(at.bytes_done as f64, at.bytes_total as f64);
    }
}

/// Estimate with its text, page and tables.
fn shown(document: EstimateDocument) -> Document {
    // Warnings of the recording, then those of the session.
    let of_session = document.session.as_ref().map_or(0, |s| s.warnings.len());
    let warnings = document_warnings(&document);
    let of_recording = warnings.len().saturating_sub(of_session);
    let warnings: Vec<Notice> = (warnings.into_iter().enumerate())
        .map(|(i, warning)| match i < of_recording {
            true => (Concern::Recording, warning),
            false => (Concern::Result, warning),
        })
        .collect();
    let is_lossy = document.is_damaged() || document.requires_action();
    Shown::new(document, |d| tables::document(d, false))
        .page(sinew_report::page)
        .table("joints", sinew_report::estimate_rows)
        .table("series", estimate_series)
        .warnings(warnings)
        .lossy(is_lossy)
        .into()
}

/// An estimate from its JSON document.
#[pyfunction]
pub(crate) fn estimate_from_json(text: &str) -> PyResult<Document> {
    let mut json: serde_json::Value = serde_json::from_str(text).map_err(Failure::from)?;
    let schema = json.as_object_mut().and_then(|json| json.remove("schema"));
    let schema = schema.as_ref().and_then(|schema| schema.as_str());
    if schema != Some(EstimateDocument::SCHEMA) {
        let (found, wanted) = (schema.unwrap_or("none"), EstimateDocument::SCHEMA);
        let reason = format!("the schema of the document is {found}, expected {wanted}");
        return Err(Failure::new(reason).into());
    }
    Ok(shown(serde_json::from_value(json).map_err(Failure::from)?))
}

/// Estimates the offsets from a recording and returns the result and the posterior.
#[pyfunction]
pub(crate) fn estimate(
    py: Python<'_>,
    log: LogArg<'_>,
    args: EstimateArgs<'_>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<(Document, Option<Baseline>)> {
    let planned = args.plan()?;
    let request = args.request(&log)?;
    let name = request.log.display().to_string();
    let (document, next) = work(py, "estimating", progress.as_ref(), move |tracker| {
        let found = sinew_estimate::estimate(&request, &planned.plan(), &mut reporter(tracker));
        let (document, next) = found?;
        let nothing = sinew_report::nothing_estimated(&document.reading);
        match nothing.filter(|_| next.is_none()) {
            Some(reason) => Err(Failure::new(reason)),
            None => Ok((document, next)),
        }
    })?;
    let next = next.map(|baseline| Baseline {
        baseline: Arc::new(baseline),
        name,
    });
    Ok((shown(document), next))
}

/// Estimates many recordings, each on its own.
#[pyfunction]
pub(crate) fn estimate_each(
    py: Python<'_>,
    logs: Vec<LogArg<'_>>,
    args: EstimateArgs<'_>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Document> {
    let planned = args.plan()?;
    let mut requests = Vec::new();
    for log in &logs {
        match log {
            LogArg::Recording(_) => requests.push(args.request(log)?),
            LogArg::Path(place) => {
                for file in sinew_log::recordings_of(place).map_err(Failure::from)? {
                    requests.push(args.request(&LogArg::Path(file))?);
                }
            }
        }
    }
    let document = work(py, "estimating", progress.as_ref(), move |tracker| {
        let finished = AtomicUsize::new(0);
        Ok(each(&requests, &planned.plan(), |_| {
            let done = 1 + finished.fetch_add(1, Ordering::Relaxed);
            tracker.at(done as f64, requests.len() as f64);
        }))
    })?;
    let is_lossy = document.failed() > 0;
    Ok(Shown::new(document, each_summary)
        .table("joints", each_table)
        .lossy(is_lossy)
        .into())
}

/// Estimates a baseline from a recording directly after tensioning.
#[pyfunction]
#[pyo3(signature = (log, robot, start, temperature_c, motor_torque, from_s, to_s, progress))]
#[expect(clippy::too_many_arguments, reason = "they have names in Python")]
pub(crate) fn learn_baseline(
    py: Python<'_>,
    log: LogArg<'_>,
    robot: Option<RobotArg<'_>>,
    start: Option<BaselineArg<'_>>,
    temperature_c: Option<Stated>,
    motor_torque: bool,
    from_s: f64,
    to_s: Option<f64>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<(Document, Baseline)> {
    let mut request = Request::new(log.name());
    request.given = log.give(Given::default());
    request.open = log.options();
    match robot {
        Some(RobotArg::Loaded(robot)) => {
            request.given.robot = Some(robot.get().loaded().clone());
        }
        Some(RobotArg::Place(place)) => request.robot = Some(place),
        None => {}
    }
    let window = stated::window(from_s, to_s).map_err(Failure::from)?;
    let start = start.as_ref().map(BaselineArg::read).transpose()?;
    let temperature_c = temperature(temperature_c)?;
    let name = request.log.display().to_string();
    let (baseline, learned) = work(py, "learning", progress.as_ref(), move |tracker| {
        let learning = Learning {
            prior: start.as_ref().map(|(b, file)| (&**b, file.as_str())),
            motor_torque,
            temperature_c,
            ..Learning::default()
        };
        Ok(session::learn(
            &request,
            window,
            &learning,
            &mut reporter(tracker),
        )?)
    })?;
    let warnings = sinew_report::session_warnings(&learned);
    let warnings = (warnings.into_iter())
        .filter(|w| w.code != "no-baseline")
        .map(|warning| (Concern::Result, warning))
        .collect();
    let is_lossy = learned.damaged;
    let joints = baseline.joints.clone();
    let document = Shown::new(BaselineDocument { learned }, move |d| {
        tables::baseline(&d.learned, &joints)
    })
    .warnings(warnings)
    .lossy(is_lossy);
    let baseline = Baseline {
        baseline: Arc::new(baseline),
        name,
    };
    Ok((document.into(), baseline))
}

/// Merges several baselines.
#[pyfunction]
#[pyo3(signature = (baselines, robot, common, fleet, scatter))]
pub(crate) fn merge_baselines(
    baselines: Vec<BaselineArg<'_>>,
    robot: RobotArg<'_>,
    common: Option<BaselineArg<'_>>,
    fleet: bool,
    scatter: f64,
) -> PyResult<(Document, Baseline)> {
    let loaded = robot.load()?;
    let read = baselines.iter().map(BaselineArg::read);
    let parts: Vec<Named> = read.collect::<Result<_, _>>()?;
    let common = common.as_ref().map(BaselineArg::read).transpose()?;
    let borrowed: Vec<_> = parts.iter().map(|(b, f)| (&**b, f.as_str())).collect();
    let common = common.as_ref().map(|(b, f)| (&**b, f.as_str()));
    let options = MergeOptions { fleet, scatter };
    let (merged, summary) =
        baseline::merge(&loaded.robot, &borrowed, common, &options).map_err(Failure::from)?;
    let count = parts.len();
    let document = Shown::new(summary, move |s| tables::merged(s, count));
    let baseline = Baseline {
        baseline: Arc::new(merged),
        name: "merged".into(),
    };
    Ok((document.into(), baseline))
}
