//! Ropes: the catalogue, the law, prediction, selection, pretension.

use crate::catalogue::with_folders;
use crate::document::{Document, Shown};
use crate::failure::Failure;
use crate::recording::{LogArg, one_of};
use crate::robot::RobotArg;
use crate::work::{ProgressTracker, work};
use numpy::{AllowTypeChange, PyArray1, PyArrayLike1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use sinew_estimate::strand_duty::{self, Strand};
use sinew_estimate::{Given, Progress, Request as EstimateRequest};
use sinew_model::transmission::Tendon;
use sinew_report::rope::{
    catalogue_table, curve_times, plan_table, planned, predicted, prediction_series,
    prediction_table, rope_table, selected, selection_table,
};
use sinew_rope::duty::{Duty, Stretch};
use sinew_rope::law::{Law, RopeLoad, State};
use sinew_rope::predict::{self, Guide};
use sinew_rope::select::{self, Constraints};
use sinew_rope::task::{Drive, PretensionTask, RopeTask, TaskError};
use sinew_rope::{Draws, RopeTermination, pretension};
use std::path::PathBuf;
use std::sync::Arc;

fn find<'a>(
    catalogue: &'a sinew_rope::Catalogue,
    name: &str,
) -> Result<&'a sinew_rope::CatalogueRope, Failure> {
    catalogue.find(name).map_err(|error| {
        let hint = sinew_files::names::did_you_mean(name, &catalogue.names());
        Failure::new(format!("{error}{hint}"))
    })
}

/// Ropes by name.
///
/// Parameters
/// ----------
/// ropes
///     Folders with additional ropes.
///
/// Raises
/// ------
/// LocatedError
///     For an invalid entry.
#[pyclass(frozen, module = "pysinew._core")]
pub(crate) struct Catalogue(Arc<sinew_rope::Catalogue>);

#[pymethods]
impl Catalogue {
    #[new]
    #[pyo3(signature = (ropes=Vec::new()))]
    fn new(ropes: Vec<PathBuf>) -> PyResult<Self> {
        Ok(Self(Arc::new(with_folders(&ropes)?)))
    }

    /// Names of all ropes.
    #[getter]
    fn names(&self) -> Vec<String> {
        self.0.names()
    }

    /// Lists all ropes.
    #[pyo3(name = "_list")]
    fn list(&self) -> Document {
        let catalogue = self.0.clone();
        Shown::new(self.0.list(), move |_| catalogue_table(&catalogue)).into()
    }

    /// Everything known about a rope.
    #[pyo3(name = "_describe")]
    fn describe(&self, name: &str) -> PyResult<Document> {
        let rope = find(&self.0, name)?.clone();
        Ok(Shown::new(rope.describe(), move |_| rope_table(&rope)).into())
    }

    /// A rope's catalogue entry as text, from which a new entry can be made.
    ///
    /// Parameters
    /// ----------
    /// name
    ///     Name of the rope.
    ///
    /// Returns
    /// -------
    /// str
    ///     Text of a rope file.
    ///
    /// Raises
    /// ------
    /// UnknownNameError
    ///     Where there is no such rope.
    fn entry(&self, name: &str) -> PyResult<String> {
        Ok(find(&self.0, name)?.entry.to_toml())
    }
}

/// The law of a rope at its catalogue values: strain under a history of loads.
///
/// Parameters
/// ----------
/// rope
///     Name of the rope.
/// ropes
///     Folders with additional ropes.
///
/// Raises
/// ------
/// UnknownNameError
///     Where there is no such rope.
#[pyclass(module = "pysinew._core")]
pub(crate) struct RopeLaw {
    name: String,
    law: Law,
    state: State,
}

#[pymethods]
impl RopeLaw {
    #[new]
    #[pyo3(signature = (rope, *, ropes=Vec::new()))]
    fn new(rope: &str, ropes: Vec<PathBuf>) -> PyResult<Self> {
        let catalogue = with_folders(&ropes)?;
        let law = Draws::new(find(&catalogue, rope)?, 0, 0);
        Ok(Self {
            name: rope.to_owned(),
            law: law.map_err(Failure::from)?.nominal,
            state: State::default(),
        })
    }

    /// Name of the rope.
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// Load at which it breaks, N.
    #[getter]
    fn breaking_load_n(&self) -> f64 {
        self.law.parameters().breaking_load_n
    }

    /// Holds a tension. The state at the end does not depend on how a time is divided.
    ///
    /// Parameters
    /// ----------
    /// tension_n
    ///     Tension, N.
    /// duration_s
    ///     Duration, s.
    /// temperature_c
    ///     Temperature, °C.
    ///
    /// Raises
    /// ------
    /// SinewError
    ///     For a tension beyond the breaking load or an invalid value.
    #[pyo3(signature = (tension_n, duration_s, *, temperature_c=23.0))]
    fn hold(&mut self, tension_n: f64, duration_s: f64, temperature_c: f64) -> PyResult<()> {
        let load = RopeLoad::celsius(tension_n, temperature_c);
        let held = self.law.hold(&mut self.state, load, duration_s);
        Ok(held.map_err(Failure::from)?)
    }

    /// Present strain under a tension, and its components.
    ///
    /// Parameters
    /// ----------
    /// tension_n
    ///     Tension, N.
    /// temperature_c
    ///     Temperature, °C.
    ///
    /// Returns
    /// -------
    /// dict of str to float
    ///     Strains by component, relative to the new, unloaded rope.
    ///
    /// Raises
    /// ------
    /// SinewError
    ///     For a tension beyond the breaking load or an invalid value.
    #[pyo3(signature = (tension_n, *, temperature_c=23.0))]
    fn strain<'py>(
        &self,
        py: Python<'py>,
        tension_n: f64,
        temperature_c: f64,
    ) -> PyResult<Bound<'py, PyDict>> {
        let load = RopeLoad::celsius(tension_n, temperature_c);
        let strain = self.law.strain(&self.state, load).map_err(Failure::from)?;
        let out = PyDict::new(py);
        for (name, percent) in [
            ("strain_ratio", strain.total_percent()),
            ("irreversible_strain_ratio", strain.irreversible_percent()),
            ("elastic_strain_ratio", strain.elastic_percent),
            ("bedding_strain_ratio", strain.bedding_percent),
            ("delayed_strain_ratio", strain.delayed_percent),
            ("flow_strain_ratio", strain.flow_percent),
            ("retraction_strain_ratio", strain.retraction_percent),
            ("thermal_strain_ratio", strain.thermal_percent),
        ] {
            out.set_item(name, 0.01 * percent)?;
        }
        Ok(out)
    }

    /// Strain at the end of every step of a history.
    ///
    /// Parameters
    /// ----------
    /// duration_s
    ///     Duration of every step, s, ``(k,)``.
    /// tension_n
    ///     Tension of every step, N, ``(k,)``.
    /// temperature_c
    ///     Temperature, °C.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Strain under the tension of the step, relative to the new, unloaded rope, ``(k,)``.
    ///
    /// Raises
    /// ------
    /// SinewError
    ///     For arrays of different length, a tension beyond the breaking load or an invalid value.
    #[pyo3(signature = (duration_s, tension_n, *, temperature_c=23.0))]
    fn follow<'py>(
        &mut self,
        py: Python<'py>,
        duration_s: PyArrayLike1<'py, f64, AllowTypeChange>,
        tension_n: PyArrayLike1<'py, f64, AllowTypeChange>,
        temperature_c: f64,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let (durations, tensions) = (duration_s.as_array(), tension_n.as_array());
        if durations.len() != tensions.len() {
            let (a, b) = (durations.len(), tensions.len());
            let reason =
                format!("duration_s has {a} values and tension_n {b}; both need one per step");
            return Err(Failure::new(reason).into());
        }
        let mut state = self.state;
        let mut strains = Vec::with_capacity(durations.len());
        for (duration_s, tension_n) in durations.iter().zip(&tensions) {
            let load = RopeLoad::celsius(*tension_n, temperature_c);
            self.law
                .hold(&mut state, load, *duration_s)
                .map_err(Failure::from)?;
            let strain = self.law.strain(&state, load).map_err(Failure::from)?;
            strains.push(0.01 * strain.total_percent());
        }
        self.state = state;
        Ok(PyArray1::from_vec(py, strains))
    }

    /// A new rope again.
    fn reset(&mut self) {
        self.state = State::default();
    }
}

/// A guiding pulley: wrap, radius, friction, place.
type GuideArg = (f64, f64, Option<f64>, Option<f64>);

fn guides(all: &[GuideArg]) -> Vec<Guide> {
    let guide = |(wrap_rad, radius_m, friction, at_m): &GuideArg| Guide {
        wrap_rad: *wrap_rad,
        radius_m: *radius_m,
        friction: *friction,
        at_m: *at_m,
    };
    all.iter().map(guide).collect()
}

const STRANDS: [(&str, Strand); 2] = [
    ("positive", Strand::Positive),
    ("negative", Strand::Negative),
];

const TERMINATIONS: [(&str, RopeTermination); 2] = [
    ("splice", RopeTermination::Spliced),
    ("knot", RopeTermination::Knotted),
];

/// A duty: the file of one, or blocks of duration, tension and temperature.
#[derive(FromPyObject)]
enum DutyArg {
    #[pyo3(annotation = "blocks")]
    Blocks(Vec<(f64, f64, f64)>),
    #[pyo3(annotation = "path")]
    File(PathBuf),
}

impl DutyArg {
    fn read(&self) -> Result<Duty, Failure> {
        match self {
            Self::File(path) => Ok(Duty::open(path)?),
            Self::Blocks(blocks) => {
                let mut stretches = Vec::with_capacity(blocks.len());
                for (i, (duration_s, tension_n, temperature_c)) in blocks.iter().enumerate() {
                    let possible = *duration_s > 0.0
                        && duration_s.is_finite()
                        && *tension_n >= 0.0
                        && tension_n.is_finite()
                        && (-100.0..=200.0).contains(temperature_c);
                    if !possible {
                        return Err(Failure::new(format!(
                            "duty, block {i}: {duration_s} s at {tension_n} N and {temperature_c} °C is invalid; expected a duration above 0 s, a tension of at least 0 N and a temperature from -100 to 200 °C"
                        )));
                    }
                    let load = RopeLoad::celsius(*tension_n, *temperature_c);
                    stretches.push(Stretch::hold(load, *duration_s));
                }
                Ok(Duty::checked(stretches, true, "duty")?)
            }
        }
    }
}

/// Load of a rope and its geometry.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct LoadArgs<'py> {
    tension_n: Option<f64>,
    temperature_c: f64,
    duty: Option<DutyArg>,
    recording: Option<LogArg<'py>>,
    strand: String,
    robot: Option<RobotArg<'py>>,
    joint: Option<String>,
    length_m: Option<f64>,
    guides: Vec<GuideArg>,
    stroke_m: f64,
    strokes_per_hour: f64,
    termination: Option<String>,
    abrasion_factor: f64,
    times_s: Vec<f64>,
    draws: usize,
    seed: u64,
    ropes: Vec<PathBuf>,
}

/// Returns the drive of the joint if both a robot and a joint are specified.
fn drive(robot: Option<&RobotArg<'_>>, joint: Option<&str>) -> Result<Option<Drive>, Failure> {
    match (robot, joint) {
        (None, None) => Ok(None),
        (Some(robot), Some(joint)) => Ok(Some(robot.load()?.drive(joint)?)),
        (Some(_), None) => Err(Failure::new(
            "robot requires joint, which selects the tendon",
        )),
        (None, Some(_)) => Err(Failure::new(
            "joint requires robot, which describes the tendon",
        )),
    }
}

/// Inputs of the duty of a strand, computed from the torques of a recording.
struct Recorded {
    request: EstimateRequest,
    joint: String,
    tendon: Tendon,
    strand: Strand,
    temperature_c: f64,
}

impl Recorded {
    fn duty(&self, tracker: &ProgressTracker) -> Result<Duty, Failure> {
        let mut report = |at: Progress| tracker.at(at.bytes_done as f64, at.bytes_total as f64);
        Ok(strand_duty::recorded(
            &self.request,
            &self.joint,
            &self.tendon,
            self.temperature_c,
            self.strand,
            &mut report,
        )?)
    }
}

impl LoadArgs<'_> {
    /// Returns the rope task, the tendon and the recorded duty.
    fn task(&self) -> Result<(RopeTask, Option<Tendon>, Option<Recorded>), Failure> {
        let tendon = drive(self.robot.as_ref(), self.joint.as_deref())?.map(|d| d.tendon);
        let termination = self.termination.as_deref();
        let task = RopeTask {
            duty: self.duty.as_ref().map(DutyArg::read).transpose()?,
            tension_n: self.tension_n,
            temperature_c: self.temperature_c,
            length_m: self.length_m,
            guides: guides(&self.guides),
            stroke_m: self.stroke_m,
            strokes_per_hour: self.strokes_per_hour,
            termination: termination.map_or(Ok(RopeTermination::NotSpecified), |word| {
                one_of("termination", word, &TERMINATIONS)
            })?,
            abrasion_factor: self.abrasion_factor,
            times_s: self.times_s.clone(),
            draws: self.draws,
            seed: self.seed,
        };
        let recorded = match (&self.recording, &self.joint, &tendon) {
            (None, ..) => None,
            (Some(log), Some(joint), Some(tendon)) => {
                let mut request = EstimateRequest::new(log.name());
                request.given = log.give(Given::default());
                request.given.robot = (self.robot.as_ref()).map(RobotArg::load).transpose()?;
                request.open = log.options();
                Some(Recorded {
                    request,
                    joint: joint.clone(),
                    tendon: tendon.clone(),
                    strand: one_of("strand", &self.strand, &STRANDS)?,
                    temperature_c: self.temperature_c,
                })
            }
            _ => return Err(Failure::new("recording needs robot and joint")),
        };
        Ok((task, tendon, recorded))
    }
}

/// The rope that is meant.
fn named(rope: Option<String>, tendon: Option<&Tendon>) -> Result<String, Failure> {
    let own = tendon.and_then(|t| t.rope.clone());
    let which = "which rope? name it; pysinew.Catalogue().names has all";
    rope.or(own).ok_or_else(|| Failure::new(which))
}

/// Predicts the elongation of a rope under a duty.
#[pyfunction]
pub(crate) fn predict_rope(
    py: Python<'_>,
    rope: Option<String>,
    read_at_n: Option<f64>,
    args: LoadArgs<'_>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Document> {
    let (mut task, tendon, recorded) = args.task()?;
    let catalogue = with_folders(&args.ropes)?;
    let rope = find(&catalogue, &named(rope, tendon.as_ref())?)?.clone();
    let read_at = read_at_n.map(|n| RopeLoad::celsius(n, args.temperature_c));
    let (found, rope, request) = work(py, "draws", progress.as_ref(), move |tracker| {
        if let Some(recorded) = recorded {
            tracker.set_stage("torques");
            task.duty = Some(recorded.duty(tracker)?);
            tracker.set_stage("draws");
        }
        let mut request = task.request(tendon.as_ref())?;
        request.read_at = read_at;
        let draws = request.draws as f64;
        let report = |done: usize| tracker.at(done as f64, draws);
        let found = predict::predict_with_progress(&rope, &request, &report)?;
        Ok((found, rope, request))
    })?;
    let is_lossy = found.breaks_after_s.is_some();
    // The curve between the data points is computed on first use.
    let curve = Arc::new(move |found: &predict::Prediction| {
        let more = predict::Request {
            times_s: curve_times(&request.times_s, request.duty.summary().duration_s),
            ..request.clone()
        };
        predict::predict(&rope, &more).unwrap_or_else(|_| found.clone())
    });
    let drawn = curve.clone();
    Ok(Shown::new(found, prediction_table)
        .page(move |p| predicted(p, &curve(p).readings))
        .table("series", move |p| prediction_series(&drawn(p)))
        .lossy(is_lossy)
        .into())
}

/// Constraints on a rope.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Limits {
    diameter_max_mm: Option<f64>,
    diameter_min_mm: Option<f64>,
    bend_ratio_min: Option<f64>,
    pulley_diameter_mm: Option<f64>,
    safety_factor_min: Option<f64>,
    elongation_max_mm: Option<f64>,
    stiffness_min_n_per_mm: Option<f64>,
    weight_max_g_per_m: Option<f64>,
}

/// Selects the ropes that satisfy the constraints, ranked.
#[pyfunction]
pub(crate) fn select_rope(
    py: Python<'_>,
    limits: Limits,
    args: LoadArgs<'_>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Document> {
    let (mut task, tendon, recorded) = args.task()?;
    let catalogue = with_folders(&args.ropes)?;
    if limits.bend_ratio_min.is_some() && limits.pulley_diameter_mm.is_none() {
        return Err(Failure::new("bend_ratio_min needs pulley_diameter_m").into());
    }
    let constraints = Constraints {
        diameter_max_mm: limits.diameter_max_mm,
        diameter_min_mm: limits.diameter_min_mm,
        bend_ratio_min: limits.bend_ratio_min,
        pulley_diameter_mm: limits.pulley_diameter_mm,
        safety_factor_min: limits.safety_factor_min,
        elongation_max_mm: limits.elongation_max_mm,
        stiffness_min_n_per_mm: limits.stiffness_min_n_per_mm,
        weight_max_g_per_m: limits.weight_max_g_per_m,
    };
    let found = work(py, "draws", progress.as_ref(), move |tracker| {
        if let Some(recorded) = recorded {
            task.duty = Some(recorded.duty(tracker)?);
        }
        let request = task.request(tendon.as_ref())?;
        let report = |done: f64| tracker.at(done, 1.0);
        Ok(select::select_with_progress(
            &catalogue,
            &request,
            &constraints,
            &report,
        )?)
    })?;
    let is_lossy = found.candidates.is_empty();
    Ok(Shown::new(found, selection_table)
        .page(move |found| selected(found, &constraints))
        .lossy(is_lossy)
        .into())
}

/// Options of a pretension plan.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct PlanArgs<'py> {
    tension_n: Option<f64>,
    lowest_n: Option<f64>,
    temperature_c: f64,
    robot: Option<RobotArg<'py>>,
    joint: Option<String>,
    length_m: Option<f64>,
    guides: Vec<GuideArg>,
    series_compliance_m_per_n: Option<f64>,
    joint_radius_m: Option<f64>,
    torque_nm: f64,
    horizon_s: f64,
    remove: f64,
    draws: usize,
    seed: u64,
    ropes: Vec<PathBuf>,
}

/// How much pretension, how to bed a rope in, when to tension it again.
#[pyfunction]
pub(crate) fn plan_pretension(
    py: Python<'_>,
    rope: Option<String>,
    args: PlanArgs<'_>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Document> {
    let drive = drive(args.robot.as_ref(), args.joint.as_deref())?;
    let catalogue = with_folders(&args.ropes)?;
    let rope = named(rope, drive.as_ref().map(|d| &d.tendon))?;
    let rope = find(&catalogue, &rope)?.clone();
    let task = PretensionTask {
        tension_n: args.tension_n,
        lowest_n: args.lowest_n,
        temperature_c: args.temperature_c,
        length_m: args.length_m,
        guides: guides(&args.guides),
        series_compliance_m_per_n: args.series_compliance_m_per_n,
        joint_radius_m: args.joint_radius_m,
        torque_nm: args.torque_nm,
        horizon_s: args.horizon_s,
        remove: args.remove,
        draws: args.draws,
        seed: args.seed,
    };
    let plan = work(py, "procedures", progress.as_ref(), move |_| {
        let request = task
            .request(&rope, drive.as_ref())
            .map_err(|error| match error {
                TaskError::NoTension => {
                    Failure::new("specify tension_n, because the tendon has no pretension_n")
                }
                other => other.into(),
            })?;
        Ok(pretension::plan(&rope, &request)?)
    })?;
    Ok(Shown::new(plan, plan_table).page(planned).into())
}
