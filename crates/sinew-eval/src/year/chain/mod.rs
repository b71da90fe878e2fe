//! Daily sessions through the whole chain: simulated recording, baseline, absolute estimate.
//!
//! The robot is drawn once as `docs/src/science/scenarios.md` says (masses, stiffness, friction, encoders) and is the
//! same every day; its offsets creep by their rope's law, temperature drifts its zero by 0.1 mrad/K and
//! softens it by 0.1 to 0.3 %/K, a failed strand takes its share of the stiffness along. Recordings stay in
//! memory.

mod journal;
mod motion;
mod session;
mod statistics;

pub use motion::SessionKind;
pub use session::{Session, SessionJoint};
pub use statistics::{FailureSeen, JointErrors, statistics};

use super::life::Life;
use crate::journal::Journal;
use journal::Settings;
use session::ChainRobot;
use sinew_estimate::absolute::AbsoluteError;
use sinew_estimate::hands::Processors;
use sinew_model::robot::Robot;
use sinew_sim::SimulateError;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;

/// Which sessions are simulated.
#[derive(Debug, Clone, PartialEq)]
pub struct ChainRequest {
    /// Check or work.
    pub kind: SessionKind,
    /// Each session starts from the last one's posterior; else from the first day's baseline.
    pub chained: bool,
    /// Threads.
    pub jobs: usize,
    /// Where a line per session goes, and where a stopped run is taken up again.
    pub out: Option<PathBuf>,
}

impl ChainRequest {
    /// Sessions of a kind since the first day's baseline, on one thread, kept nowhere.
    pub fn new(kind: SessionKind) -> Self {
        Self {
            kind,
            chained: false,
            jobs: 1,
            out: None,
        }
    }
}

/// Why there are no sessions.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ChainError {
    /// The simulation.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
    /// The estimate.
    #[error(transparent)]
    Absolute(#[from] AbsoluteError),
    /// The file of sessions.
    #[error("{file}: {why}")]
    Journal {
        /// File.
        file: String,
        /// Why, and what to do.
        why: String,
    },
}

/// Simulates the first `days` sessions of every life that aren't kept yet; `progress` is told how many
/// of how many are done. Returns all, by life and day.
pub(super) fn sessions(
    robot: &Robot,
    joints: &[String],
    lives: &[Life],
    days: usize,
    request: &ChainRequest,
    progress: &mut dyn FnMut(usize, usize),
) -> Result<Vec<Vec<Session>>, ChainError> {
    let settings = Settings::new(robot, joints, request);
    let out = request.out.as_ref();
    let wrong = |why: String| ChainError::Journal {
        file: out.map_or_else(String::new, |path| path.display().to_string()),
        why,
    };
    let (mut journal, kept) = match out {
        Some(path) => {
            let (journal, kept): (_, Vec<Session>) =
                Journal::open(path, &settings).map_err(wrong)?;
            (Some(journal), kept)
        }
        None => (None, Vec::new()),
    };
    let mut done: BTreeMap<(u64, usize), Session> = kept
        .into_iter()
        .filter(|s| (1..=days).contains(&s.day) && lives.iter().any(|l| l.seed == s.seed))
        .map(|s| ((s.seed, s.day), s))
        .collect();
    let missing: Vec<(&Life, Vec<usize>)> = lives
        .iter()
        .map(|l| {
            let own = (1..=days).filter(|day| !done.contains_key(&(l.seed, *day)));
            (l, own.collect())
        })
        .filter(|(_, own): &(_, Vec<usize>)| !own.is_empty())
        .collect();
    let all = lives.len() * days;
    progress(done.len(), all);
    let next = AtomicUsize::new(0);
    let (sender, receiver) = mpsc::channel();
    // This thread only waits.
    let _taken = Processors::machine().take_up_to(request.jobs.saturating_sub(1));
    let mut failed = None;
    std::thread::scope(|scope| {
        for _ in 0..request.jobs.clamp(1, missing.len().max(1)) {
            let (sender, next, missing) = (sender.clone(), &next, &missing);
            scope.spawn(move || {
                while let Some((life, days)) = missing.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let mut send = |result| sender.send(result).is_ok();
                    if let Err(error) = live(robot, life, days, request, &mut send) {
                        send(Err(error));
                    }
                }
            });
        }
        drop(sender);
        for result in &receiver {
            let kept = result.and_then(|session: Session| {
                if let Some(journal) = &mut journal {
                    journal.add(&session).map_err(wrong)?;
                }
                Ok(session)
            });
            match kept {
                Ok(session) => {
                    done.insert((session.seed, session.day), session);
                }
                Err(error) => {
                    failed = Some(error);
                    // Nobody listens any more: every thread ends after its session.
                    next.store(missing.len(), Ordering::Relaxed);
                    break;
                }
            }
            progress(done.len(), all);
        }
        drop(receiver);
    });
    if let Some(error) = failed {
        return Err(error);
    }
    let mut out: Vec<Vec<Session>> = lives.iter().map(|_| Vec::with_capacity(days)).collect();
    for session in done.into_values() {
        if let Some(i) = lives.iter().position(|l| l.seed == session.seed) {
            out[i].push(session);
        }
    }
    Ok(out)
}

/// One robot's missing days; ends early where nobody listens.
fn live(
    robot: &Robot,
    life: &Life,
    days: &[usize],
    request: &ChainRequest,
    send: &mut dyn FnMut(Result<Session, ChainError>) -> bool,
) -> Result<(), ChainError> {
    let own = ChainRobot::new(robot, life, request.kind)?;
    let mut since = own.baseline()?;
    if !request.chained {
        for &day in days {
            if !send(Ok(own.session(day, &since)?.0)) {
                break;
            }
        }
        return Ok(());
    }
    // What days that are kept taught has to be learned again.
    for day in 1..=days.last().copied().unwrap_or(0) {
        let (session, next) = own.session(day, &since)?;
        since = next;
        if days.contains(&day) && !send(Ok(session)) {
            break;
        }
    }
    Ok(())
}
