//! Many recordings, in parallel, resumable.

use super::outcome::{Assessment, Outcome};
use super::result::ScenarioReport;
use super::summary::summarise;
use super::{Options, Recording, RejectedRecording, ScenarioError, record};
use crate::journal::{Journal, Setting};
use crate::{jobs, journal};
use serde::Serialize;
use serde::de::DeserializeOwned;
use sinew_estimate::robot_dir;
use sinew_sim::protocol::{Plan, PlanError, plan_adapted, plan_named};
use sinew_sim::{Scenario, SimulateError};
use std::collections::BTreeSet;
use std::path::Path;

/// Format of the file of results; the version changes with simulation or estimator, because older files cannot be
/// resumed.
const RECORDINGS: journal::Kind = journal::Kind {
    format: "sinew-scenarios",
    version: 19,
    holds: "scenario results",
};

/// Runs all recordings and returns their summary; see [`run_recordings`].
///
/// # Errors
/// Returns a [`ScenarioError`] if a scenario cannot be run.
pub fn run(
    options: &Options,
    progress: &mut (dyn FnMut(usize, usize) + Send),
) -> Result<ScenarioReport, ScenarioError> {
    run_recordings(options, progress).map(|(report, _)| report)
}

/// Runs all recordings and returns the summary and the recordings; calls `progress` with the number done and the
/// total.
///
/// # Errors
/// Returns a [`ScenarioError`] if a scenario cannot be run; recordings finished before are in the file of results.
pub fn run_recordings(
    options: &Options,
    progress: &mut (dyn FnMut(usize, usize) + Send),
) -> Result<(ScenarioReport, Vec<Recording>), ScenarioError> {
    let mut plans = plans(options)?;
    if !options.motor_torque {
        for plan in &mut plans {
            plan.scenario.record.tau_m = false;
        }
    }
    let settings = [
        (
            "sessions",
            options.sessions.name().into(),
            "other sessions (--no-steps, --variants)",
        ),
        (
            "motor_torque",
            options.motor_torque.to_string(),
            "with and without motor torque (--no-motor-torque)",
        ),
        (
            "scenarios",
            journal::checksum(&everything(&plans)),
            "another robot, or other scenarios than those of this version",
        ),
    ];
    let assess = |plan: &Plan, seed: u64| record(plan, seed, options.sessions);
    let (recordings, rejections) =
        study(options, &plans, &RECORDINGS, &settings, assess, progress)?;
    let report = summarise(&plans, &recordings, rejections, options);
    Ok((report, recordings))
}

/// Assesses every plan with every seed, except those already in the file of results. Returns the assessments, in the
/// order of seeds, and the rejected recordings; calls `progress` with the number done and the total.
///
/// # Errors
/// Returns a [`ScenarioError`] if a scenario cannot be run; recordings finished before are in the file of results.
pub(super) fn study<T: Assessment + Clone + Send + Serialize + DeserializeOwned>(
    options: &Options,
    plans: &[Plan],
    kind: &journal::Kind,
    settings: &[Setting],
    assess: impl Fn(&Plan, u64) -> Result<T, ScenarioError> + Sync,
    progress: &mut (dyn FnMut(usize, usize) + Send),
) -> Result<(Vec<T>, Vec<RejectedRecording>), ScenarioError> {
    let (mut journal, done) = Journal::open::<Outcome<T>>(options.out.as_deref(), kind, settings)?;
    let wanted: Vec<(usize, u64)> = (0..options.n)
        .flat_map(|k| (0..plans.len()).map(move |plan| (plan, k)))
        .map(|(plan, k)| (plan, options.first_seed.wrapping_add(k)))
        .collect();
    let is = |o: &Outcome<T>, (plan, seed): (usize, u64)| o.key() == (&plans[plan].name, seed);
    // Two runs at once may have kept the same recording: it counts once.
    let mut seen = BTreeSet::new();
    let mut outcomes: Vec<Outcome<T>> = done
        .into_iter()
        .filter(|o| wanted.iter().any(|&w| is(o, w)))
        .filter(|o| seen.insert((o.key().0.to_owned(), o.key().1)))
        .collect();
    let missing: Vec<(usize, u64)> = wanted
        .iter()
        .copied()
        .filter(|&w| !outcomes.iter().any(|o| is(o, w)))
        .collect();
    progress(outcomes.len(), wanted.len());

    jobs::each(
        &missing,
        options.jobs,
        |&(plan, seed), give| {
            give(Outcome::of(assess(&plans[plan], seed))?);
            Ok::<_, ScenarioError>(())
        },
        |outcome| {
            journal.add(&outcome)?;
            outcomes.push(outcome);
            progress(outcomes.len(), wanted.len());
            Ok(())
        },
    )?;
    // In the order of seeds, independent of the order of completion: sums are bitwise identical.
    outcomes.sort_by(|a, b| (a.key().1, a.key().0).cmp(&(b.key().1, b.key().0)));
    let (mut assessed, mut rejections) = (Vec::new(), Vec::new());
    for outcome in outcomes {
        match outcome {
            Outcome::Assessed(one) => assessed.push(*one),
            Outcome::Rejected(rejected) => rejections.push(rejected),
        }
    }
    Ok((assessed, rejections))
}

/// Returns the plans to run, each with a unique name.
pub(super) fn plans(options: &Options) -> Result<Vec<Plan>, ScenarioError> {
    let robot = match &options.robot {
        Some(folder) => Some(robot_dir::load(folder, None)?.robot),
        None => None,
    };
    let mut plans: Vec<Plan> = Vec::new();
    for name in &options.scenarios {
        let path = Path::new(name);
        let plan = match &robot {
            robot if path.extension().is_some_and(|e| e == "toml") => own(path, robot.clone())?,
            Some(robot) => plan_adapted(name, robot)?,
            None => plan_named(name)?,
        };
        if plans.iter().any(|other| other.name == plan.name) {
            let reason = format!(
                "another scenario of this run has the name '{}'; rename one of them",
                plan.name
            );
            let name = name.clone();
            return Err(PlanError::Text { name, reason }.into());
        }
        plans.push(plan);
    }
    Ok(plans)
}

/// Reads a scenario from a file, with the specified robot or the one that it names.
fn own(path: &Path, robot: Option<sinew_model::robot::Robot>) -> Result<Plan, ScenarioError> {
    let file = path.display().to_string();
    let text = sinew_files::read_text(path, &sinew_files::Budget::SETTINGS)
        .map_err(SimulateError::from)?;
    let scenario = Scenario::open(path)?;
    let base_folder = path.parent().unwrap_or(Path::new(""));
    let robot = match (robot, &scenario.robot) {
        (Some(robot), _) => robot,
        (None, Some(folder)) => robot_dir::load(&base_folder.join(folder), None)?.robot,
        (None, None) => {
            let reason = "robot is missing; specify its folder with --robot DIR".into();
            return Err(PlanError::Text { name: file, reason }.into());
        }
    };
    Ok(Plan::own(scenario, &text, &file, robot)?)
}

/// All that recordings depend on.
pub(super) fn everything(plans: &[Plan]) -> String {
    let own: BTreeSet<&str> = plans.iter().map(|p| p.based_on.as_str()).collect();
    sinew_sim::protocol::everything() + &own.into_iter().collect::<String>()
}

impl Assessment for Recording {
    fn key(&self) -> (&str, u64) {
        (&self.scenario, self.seed)
    }
}
