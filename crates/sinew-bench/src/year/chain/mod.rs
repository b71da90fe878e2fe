//! Daily sessions through the whole chain: simulated recording, baseline, absolute estimate.
//!
//! The robot is drawn once as in `docs/src/validation.md` (masses, stiffness, friction, encoders) and is the same
//! every day. Its offsets creep by the creep law of their rope. Temperature shifts its zero by 0.1 mrad/K and lowers
//! its stiffness by 0.1 to 0.3 %/K, and a failed strand removes its share of the stiffness. Recordings stay in
//! memory.

mod motion;
mod session;
mod statistics;

pub use motion::SessionKind;
pub use session::{Session, SessionJoint};
pub use statistics::{FailureSeen, JointErrors, LagCorrelation, statistics};

use super::simulated_year::{DAYS_PER_YEAR, SimulatedYear};
use crate::jobs;
use crate::journal::{self, Journal, JournalError};
use session::ChainRobot;
use sinew_estimate::session::SessionError;
use sinew_model::robot::Robot;
use sinew_sim::SimulateError;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Sessions to simulate.
#[derive(Debug, Clone, PartialEq)]
pub struct ChainRequest {
    /// Check or work.
    pub kind: SessionKind,
    /// Number of sessions of each robot, one a day, at most those of a year. Part of a year shows the errors of the
    /// sessions; its trend would not be comparable and is not computed.
    pub days: usize,
    /// Whether each session starts from the posterior of the previous one; otherwise it starts from the baseline of
    /// the first day.
    pub chained: bool,
    /// Number of threads.
    pub jobs: usize,
    /// File with a line per session, from which a stopped run resumes.
    pub out: Option<PathBuf>,
}

impl ChainRequest {
    /// Creates a request for a year of sessions of a kind since the first day's baseline, on one thread, without a
    /// file.
    pub fn new(kind: SessionKind) -> Self {
        Self {
            kind,
            days: DAYS_PER_YEAR,
            chained: false,
            jobs: 1,
            out: None,
        }
    }
}

/// Format of the file of results; the version changes with simulation or estimator, because older files cannot be
/// resumed.
const SESSIONS: journal::Kind = journal::Kind {
    format: "sinew-sessions",
    version: 9,
    holds: "simulated sessions",
};

/// Errors of the sessions.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ChainError {
    /// The simulation failed.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
    /// The estimate failed.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// The threads could not be started.
    #[error("cannot start threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// The file of sessions.
    #[error(transparent)]
    Journal(#[from] JournalError),
}

/// Simulates the sessions of every simulated year that are not in the file yet; calls `progress` with the number done
/// and the total. Returns all, by year and day.
pub(super) fn sessions(
    robot: &Robot,
    joints: &[String],
    lives: &[SimulatedYear],
    request: &ChainRequest,
    progress: &mut (dyn FnMut(usize, usize) + Send),
) -> Result<Vec<Vec<Session>>, ChainError> {
    let days = request.days.clamp(1, DAYS_PER_YEAR);
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

/// Simulates the missing days of one robot; ends early on request.
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
    // The posteriors of stored days have to be estimated again.
    for day in 1..=days.last().copied().unwrap_or(0) {
        let (session, next) = own.session(day, &since)?;
        since = next;
        if days.contains(&day) && !give(session) {
            break;
        }
    }
    Ok(())
}
