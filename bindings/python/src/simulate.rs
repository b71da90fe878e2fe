//! Simulated recordings with known ground truth, scenarios of the protocol and informative poses.

use crate::document::{Concern, Document, Shown};
use crate::estimate::BaselineArg;
use crate::failure::Failure;
use crate::recording::{Columns, one_of};
use crate::robot::RobotArg;
use crate::work::work;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use sinew_estimate::excitation::{self, Sensors};
use sinew_estimate::robot_dir::{self, LoadedRobot};
use sinew_log::Compression;
use sinew_sim::control::Simulated;
use sinew_sim::protocol::{plan_adapted, plan_named};
use sinew_sim::{Scenario, SimulateOptions, Simulation};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A scenario: the file of one, or its text.
#[derive(FromPyObject)]
pub(crate) enum ScenarioArg {
    #[pyo3(annotation = "(text, name)")]
    Text(String, String),
    #[pyo3(annotation = "path")]
    File(PathBuf),
}

/// Scenario to simulate and its robot.
struct Task {
    scenario: Scenario,
    loaded: Arc<LoadedRobot>,
}

impl Task {
    fn new(
        scenario: &ScenarioArg,
        robot: Option<&RobotArg<'_>>,
        seed: Option<u64>,
        duration_s: Option<f64>,
    ) -> Result<Self, Failure> {
        let (mut scenario, folder) = match scenario {
            ScenarioArg::File(path) => {
                let folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
                (Scenario::open(path)?, folder)
            }
            ScenarioArg::Text(text, name) => {
                let mut scenario = Scenario::from_toml(text, name)?;
                scenario.correction.read_estimate(Path::new(""))?;
                (scenario, PathBuf::new())
            }
        };
        let loaded = match (robot, &scenario.robot) {
            (Some(robot), _) => robot.load()?,
            (None, Some(named)) => Arc::new(robot_dir::load(&folder.join(named), None)?),
            (None, None) => {
                let file = &scenario.file;
                let reason = format!("{file} specifies no robot; set the argument robot");
                return Err(Failure::new(reason));
            }
        };
        scenario.seed = seed.unwrap_or(scenario.seed);
        if let Some(duration_s) = duration_s {
            if !(duration_s > 0.0 && duration_s.is_finite()) {
                let reason = format!("duration_s is {duration_s}; it must be above 0 s");
                return Err(Failure::new(reason));
            }
            scenario.duration_s = Some(duration_s);
        }
        Ok(Self { scenario, loaded })
    }
}

/// The truth as the command prints it.
fn shown(truth: sinew_sim::Truth, warnings: Vec<String>) -> Document {
    let document = Simulated {
        truth,
        control: None,
    };
    Shown::new(document, |_| "a simulated recording's truth".into())
        .warnings(Concern::Robot.texts(warnings))
        .into()
}

/// Simulates into arrays: those of the recording, and the truth.
#[pyfunction]
#[pyo3(signature = (scenario, robot, seed, duration_s, progress))]
pub(crate) fn simulate<'py>(
    py: Python<'py>,
    scenario: ScenarioArg,
    robot: Option<RobotArg<'py>>,
    seed: Option<u64>,
    duration_s: Option<f64>,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<(Bound<'py, PyDict>, Document)> {
    let Task { scenario, loaded } = Task::new(&scenario, robot.as_ref(), seed, duration_s)?;
    let warnings = loaded.robot.warnings.clone();
    let joints = loaded.robot.joint_names().to_vec();
    let (columns, truth) = work(py, "simulating", progress.as_ref(), move |tracker| {
        let simulation = Simulation::new(&loaded.robot, &scenario)?;
        let mut columns = Columns::new(sinew_sim::recorded_quantities(&scenario));
        let mut keep = |frame: &sinew_log::Frame| {
            columns.push(frame);
            Ok(())
        };
        let mut report = |at: sinew_sim::Progress| tracker.at(at.done_s, at.total_s);
        let (truth, _) = sinew_sim::record(simulation, &scenario, &mut keep, &mut report)?;
        Ok((columns, truth))
    })?;
    Ok((columns.arrays(py, &joints)?, shown(truth, warnings)))
}

const PACKINGS: [(&str, Compression); 3] = [
    ("zstd", Compression::Zstd),
    ("lz4", Compression::Lz4),
    ("none", Compression::None),
];

/// Simulates into a file and writes the ground truth next to it.
#[pyfunction]
#[pyo3(signature = (scenario, out, robot, seed, duration_s, compression, progress))]
#[expect(clippy::too_many_arguments, reason = "they have names in Python")]
pub(crate) fn simulate_to(
    py: Python<'_>,
    scenario: ScenarioArg,
    out: PathBuf,
    robot: Option<RobotArg<'_>>,
    seed: Option<u64>,
    duration_s: Option<f64>,
    compression: &str,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Document> {
    let Task { scenario, loaded } = Task::new(&scenario, robot.as_ref(), seed, duration_s)?;
    let warnings = loaded.robot.warnings.clone();
    let mut options = SimulateOptions::new(&out);
    options.robot_description = Some(loaded.urdf_text.clone());
    options.compression = one_of("compression", compression, &PACKINGS)?;
    let summary = work(py, "simulating", progress.as_ref(), move |tracker| {
        let mut report = |at: sinew_sim::Progress| tracker.at(at.done_s, at.total_s);
        Ok(sinew_sim::run(
            &loaded.robot,
            &scenario,
            &options,
            &mut report,
        )?)
    })?;
    Ok(shown(summary.truth, warnings))
}

/// Scenarios whose recordings are sample data of the package, with their names.
const DATASETS: [(&str, &str); 2] = [
    (
        "stretched-arm",
        include_str!("../../../examples/scenarios/stretched-arm.toml"),
    ),
    (
        "work-session",
        include_str!("../../../examples/scenarios/work-session.toml"),
    ),
];

/// Names of the sample data.
#[pyfunction]
pub(crate) fn dataset_names() -> Vec<&'static str> {
    DATASETS.iter().map(|(name, _)| *name).collect()
}

/// Scenario, robot.toml and URDF of sample data.
#[pyfunction]
pub(crate) fn dataset(name: &str) -> PyResult<(&'static str, &'static str, &'static str)> {
    let scenario = one_of("the name", name, &DATASETS)?;
    let robot_toml = include_str!("../../../crates/sinew-model/robots/biorob-like/robot.toml");
    let urdf = include_str!("../../../crates/sinew-model/robots/biorob-like/biorob-like.urdf");
    Ok((scenario, robot_toml, urdf))
}

/// A scenario of the protocol (S5 to S8b, U1 …) as text, for a robot's joints where one is named.
///
/// Parameters
/// ----------
/// name
///     Name of the scenario.
/// robot
///     Folder of the robot or a ``Robot``.
///
/// Returns
/// -------
/// str
///     A scenario that ``simulate`` takes as ``(text, name)``.
///
/// Raises
/// ------
/// SinewError
///     Where there is no such scenario.
#[pyfunction]
#[pyo3(signature = (name, robot=None))]
pub(crate) fn scenario_text(name: &str, robot: Option<RobotArg<'_>>) -> PyResult<String> {
    let plan = match robot {
        Some(robot) => plan_adapted(name, &robot.load()?.robot).map_err(Failure::from)?,
        None => plan_named(name).map_err(Failure::from)?,
    };
    Ok(plan.text)
}

/// Poses that make the offsets show; with a format also the text of a file of them.
#[pyfunction]
#[pyo3(signature = (robot, baseline, poses, pause_s, payload, joint_bits, candidates, seed, progress))]
#[expect(clippy::too_many_arguments, reason = "they have names in Python")]
pub(crate) fn propose_poses(
    py: Python<'_>,
    robot: RobotArg<'_>,
    baseline: Option<BaselineArg<'_>>,
    poses: usize,
    pause_s: f64,
    payload: bool,
    joint_bits: u32,
    candidates: usize,
    seed: u64,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<(Document, String)> {
    let loaded = robot.load()?;
    let baseline = baseline.as_ref().map(BaselineArg::read).transpose()?;
    if !(2..=100).contains(&poses) || !(1..=1000).contains(&candidates) {
        let reason = "poses must be 2 to 100, candidates 1 to 1000";
        return Err(Failure::new(reason).into());
    }
    if !(pause_s > 0.0 && pause_s.is_finite() && (4..=40).contains(&joint_bits)) {
        let reason = "pause_s must be above 0 s, joint_bits 4 to 40";
        return Err(Failure::new(reason).into());
    }
    let options = excitation::Options {
        poses,
        pause_s,
        candidates,
        payload,
        sensors: Sensors {
            joint_bits,
            ..Sensors::default()
        },
        seed,
        ..excitation::Options::default()
    };
    let proposal = work(py, "trying poses", progress.as_ref(), move |tracker| {
        let prior = baseline.as_ref().map(|(b, file)| (&**b, file.as_str()));
        let mut report = |done: usize, all: usize| tracker.at(done as f64, all as f64);
        Ok(excitation::propose(
            &loaded.robot,
            prior,
            &options,
            &mut report,
        )?)
    })?;
    let motion = proposal.to_toml();
    Ok((
        Shown::new(proposal, sinew_report::excitation::render).into(),
        motion,
    ))
}
