//! Daily sessions through the whole chain: simulated recording, baseline, absolute estimate.
//!
//! The robot is drawn once as `docs/src/science/scenarios.md` says (masses, stiffness, friction, encoders) and is the
//! same every day; its offsets creep by their rope's law, temperature drifts its zero by 0.1 mrad/K and
//! softens it by 0.1 to 0.3 %/K, a failed strand takes its share of the stiffness along. Recordings stay in
//! memory.

mod motion;
mod session;
mod statistics;

pub use motion::SessionKind;
pub use session::{Session, SessionJoint};
pub use statistics::{FailureSeen, JointErrors, LagCorrelation, statistics};

use super::simulated_year::{SimulatedYear, WATCHED};
use crate::jobs;
use crate::journal::{self, Journal, JournalError};
use session::ChainRobot;
use sinew_estimate::session::SessionError;
use sinew_model::robot::Robot;
use sinew_sim::SimulateError;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Which sessions are simulated.
#[derive(Debug, Clone, PartialEq)]
pub struct ChainRequest {
    /// Check or work.
    pub kind: SessionKind,
    /// Sessions of each robot, one a day, at most those of a year. Part of a year shows the sessions'
    /// errors; a trend of it would be judged unfairly, so that none is made.
    pub days: usize,
    /// Each session starts from the last one's posterior; else from the first day's baseline.
    pub chained: bool,
    /// Threads.
    pub jobs: usize,
    /// Where a line per session goes, and where a stopped run is taken up again.
    pub out: Option<PathBuf>,
}

impl ChainRequest {
    /// A year of sessions of a kind since the first day's baseline, on one thread, kept nowhere.
    pub fn new(kind: SessionKind) -> Self {
        Self {
            kind,
            days: WATCHED,
            chained: false,
            jobs: 1,
            out: None,
        }
    }
}

/// Another simulation or estimator: what older files hold can't go on.
const SESSIONS: journal::Kind = journal::Kind {
    format: "sinew-sessions",
    version: 9,
    holds: "simulated sessions",
};

/// Why there are no sessions.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ChainError {
    /// The simulation.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
    /// The estimate.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// There are no threads to work on.
    #[error("can't start threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// The file of sessions.
    #[error(transparent)]
    Journal(#[from] JournalError),
}

/// Simulates the sessions of every life that aren't kept yet; `progress` is told how many
/// of how many are done. Returns all, by life and day.
pub(super) fn sessions(
    robot: &Robot,
    joints: &[String],
    lives: &[SimulatedYear],
    request: &ChainRequest,
    progress: &mut (dyn FnMut(usize, usize) + Send),
) -> Result<Vec<Vec<Session>>, ChainError> {
    let days = request.days.clamp(1, WATCHED);
    let described = (
        &robot.arm,
        &robot.transmissions,
        &robot.limits,
        &robot.tolerances,
    );
    let settings = [
        (
            "session",
            request.kind.name().into(),
            "{} sessions (--session)",
        ),
        (
            "chained",
            request.chained.to_string(),
            "with and without --chained",
        ),
        ("robot", robot.name.clone(), "robot '{}'"),
        ("joints", joints.join(", "), "joints {} (--joints)"),
        (
            "description",
            journal::checksum(&format!("{described:?}")),
            "another description of the robot",
        ),
    ];
    let (mut journal, kept) =
        Journal::open::<Session>(request.out.as_deref(), &SESSIONS, &settings)?;
    let mut done: BTreeMap<(u64, usize), Session> = kept
        .into_iter()
        .filter(|s| (1..=days).contains(&s.day) && lives.iter().any(|l| l.seed == s.seed))
        .map(|s| ((s.seed, s.day), s))
        .collect();
    let missing: Vec<(&SimulatedYear, Vec<usize>)> = lives
        .iter()
        .map(|l| {
            let own = (1..=days).filter(|day| !done.contains_key(&(l.seed, *day)));
            (l, own.collect())
        })
        .filter(|(_, own): &(_, Vec<usize>)| !own.is_empty())
        .collect();
    let all = lives.len() * days;
    progress(done.len(), all);
    jobs::each(
        &missing,
        request.jobs,
        |(life, days), give| live(robot, life, days, request, give),
        |session: Session| {
            journal.add(&session)?;
            done.insert((session.seed, session.day), session);
            progress(done.len(), all);
            Ok(())
        },
    )?;
    let mut out: Vec<Vec<Session>> = lives.iter().map(|_| Vec::with_capacity(days)).collect();
    for session in done.into_values() {
        if let Some(i) = lives.iter().position(|l| l.seed == session.seed) {
            out[i].push(session);
        }
    }
    Ok(out)
}

/// One robot's missing days; ends early where it is told to.
fn live(
    robot: &Robot,
    life: &SimulatedYear,
    days: &[usize],
    request: &ChainRequest,
    give: &dyn Fn(Session) -> bool,
) -> Result<(), ChainError> {
    let own = ChainRobot::new(robot, life, request.kind)?;
    let mut since = own.baseline()?;
    if !request.chained {
        for &day in days {
            if !give(own.session(day, &since)?.0) {
                break;
            }
        }
        return Ok(());
    }
    // What days that are kept taught has to be learned again.
    for day in 1..=days.last().copied().unwrap_or(0) {
        let (session, next) = own.session(day, &since)?;
        since = next;
        if days.contains(&day) && !give(session) {
            break;
        }
    }
    Ok(())
}
