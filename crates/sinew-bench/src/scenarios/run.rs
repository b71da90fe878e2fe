//! Many recordings, in parallel, resumable.

use super::outcome::{Judged, Outcome};
use super::result::ScenarioReport;
use super::summary::summarise;
use super::{Options, Recording, Refusal, ScenarioError, record};
use crate::journal::{Journal, Setting};
use crate::{jobs, journal};
use serde::Serialize;
use serde::de::DeserializeOwned;
use sinew_estimate::robot_dir;
use sinew_sim::protocol::{Plan, PlanError, plan_adapted, plan_named};
use sinew_sim::{Scenario, SimulateError};
use std::collections::BTreeSet;
use std::path::Path;

/// Another simulation or estimator: what older files hold can't go on.
const RECORDINGS: journal::Kind = journal::Kind {
    format: "sinew-scenarios",
    version: 19,
    holds: "scenario results",
};

/// What all recordings say together; see [`run_recordings`].
///
/// # Errors
/// [`ScenarioError`].
pub fn run(
    options: &Options,
    progress: &mut (dyn FnMut(usize, usize) + Send),
) -> Result<ScenarioReport, ScenarioError> {
    run_recordings(options, progress).map(|(report, _)| report)
}

/// Runs all recordings, and returns them too; `progress` is told how many of how many are done.
///
/// # Errors
/// [`ScenarioError`]; what was finished before is in the file of results.
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
            "of another robot, or of other scenarios than this program's",
        ),
    ];
    let judge = |plan: &Plan, seed: u64| record(plan, seed, options.sessions);
    let (recordings, refusals) = study(options, &plans, &RECORDINGS, &settings, judge, progress)?;
    let report = summarise(&plans, &recordings, refusals, options);
    Ok((report, recordings))
}

/// Judges every plan with every seed, but for those that are in the file of results. What was judged, in the order of seeds, and what
/// was refused; `progress` is told how many of how many are done.
///
/// # Errors
/// [`ScenarioError`]; what was finished before is in the file of results.
pub(super) fn study<T: Judged + Clone + Send + Serialize + DeserializeOwned>(
    options: &Options,
    plans: &[Plan],
    kind: &journal::Kind,
    settings: &[Setting],
    judge: impl Fn(&Plan, u64) -> Result<T, ScenarioError> + Sync,
    progress: &mut (dyn FnMut(usize, usize) + Send),
) -> Result<(Vec<T>, Vec<Refusal>), ScenarioError> {
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
            give(Outcome::of(judge(&plans[plan], seed))?);
            Ok::<_, ScenarioError>(())
        },
        |outcome| {
            journal.add(&outcome)?;
            outcomes.push(outcome);
            progress(outcomes.len(), wanted.len());
            Ok(())
        },
    )?;
    // In the order of seeds, whoever was first: sums come out the same to the last bit.
    outcomes.sort_by(|a, b| (a.key().1, a.key().0).cmp(&(b.key().1, b.key().0)));
    let (mut judged, mut refusals) = (Vec::new(), Vec::new());
    for outcome in outcomes {
        match outcome {
            Outcome::Judged(one) => judged.push(*one),
            Outcome::Refused(refusal) => refusals.push(refusal),
        }
    }
    Ok((judged, refusals))
}

/// What is to be run, each by a name of its own.
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
            let why = format!(
                "another scenario of this run is called '{}', too; give it another name",
                plan.name
            );
            let name = name.clone();
            return Err(PlanError::Text { name, why }.into());
        }
        plans.push(plan);
    }
    Ok(plans)
}

/// A scenario from a file, with the robot that is given or the one it names.
fn own(path: &Path, robot: Option<sinew_model::robot::Robot>) -> Result<Plan, ScenarioError> {
    let file = path.display().to_string();
    let text = sinew_files::read_text(path, &sinew_files::limits::SETTINGS)
        .map_err(SimulateError::from)?;
    let scenario = Scenario::open(path)?;
    let beside = path.parent().unwrap_or(Path::new(""));
    let robot = match (robot, &scenario.robot) {
        (Some(robot), _) => robot,
        (None, Some(folder)) => robot_dir::load(&beside.join(folder), None)?.robot,
        (None, None) => {
            let why = "names no robot; name its folder with --robot DIR".into();
            return Err(PlanError::Text { name: file, why }.into());
        }
    };
    Ok(Plan::own(scenario, &text, &file, robot)?)
}

/// All that recordings depend on.
pub(super) fn everything(plans: &[Plan]) -> String {
    let own: BTreeSet<&str> = plans.iter().map(|p| p.rests_on.as_str()).collect();
    sinew_sim::protocol::everything() + &own.into_iter().collect::<String>()
}

impl Judged for Recording {
    fn key(&self) -> (&str, u64) {
        (&self.scenario, self.seed)
    }
}
