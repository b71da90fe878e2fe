//! `due`: tendons that may exceed a limit, most urgent first.
//!
//! Robots are processed in batches, which bounds the memory. A bound in closed form ([`screen`]) comes first; tendons it cannot
//! rule out are tracked by the trend of `sinew trend`.

mod follow;
pub mod screen;
pub(crate) mod show;
mod state;

pub use follow::TrackedTendon;
pub use sinew_trend::Passage;
pub use state::StateUnused;

use crate::FleetError;
use crate::args::Due;
use crate::engine::Engine;
use crate::folder::sides::Fitted;
use crate::metadata::FleetMetadata;
use crate::rows::report_rejected;
use datafusion::arrow::array::AsArray as _;
use datafusion::arrow::datatypes::Float64Type;
use follow::{Followers, Outcome};
use rayon::prelude::*;
use sinew_files::date::DAY_S;
use state::State;
use std::collections::BTreeMap;
use std::io::IsTerminal as _;
use std::process::ExitCode;
use std::time::{SystemTime, UNIX_EPOCH};

/// Number of robots in memory at a time.
const ROBOTS_IN_MEMORY: usize = 50;

/// Result of `due` for the tendons of a fleet.
#[derive(Debug, Clone, Default)]
pub struct DueList {
    /// Time of the last session of the fleet, s since 1970; days count from here.
    pub now_utc_s: f64,
    /// Tracked tendons, most urgent first.
    pub followed: Vec<TrackedTendon>,
    /// Number of tracked tendons that resumed from a stored state.
    pub resumed: usize,
    /// Number of tracked tendons whose prior is the reference creep of a fleet.
    pub with_reference_creep: usize,
    /// Reason why the stored state was not used.
    pub state_unused: Option<StateUnused>,
    /// Number of tendons with records.
    pub tendons: usize,
    /// Number of tendons that the bound ruled out.
    pub out_of_reach: usize,
    /// Number of tendons without a limit or without a description of their robot type.
    pub without_limit: usize,
    /// Robot types without a description.
    pub unknown_types: Vec<String>,
    /// Tendons without a trend: robot, joint and reason.
    pub failed: Vec<(String, String, String)>,
}

impl DueList {
    /// Tendons that may exceed a limit within the requested days: exceeded, or the lower end of the interval is within.
    pub fn due(&self, within_days: f64) -> impl Iterator<Item = &TrackedTendon> {
        let until_utc_s = self.now_utc_s + within_days * DAY_S;
        (self.followed.iter()).filter(move |f| f.worst().is_some_and(|p| p.is_due(until_utc_s)))
    }
}

/// Evaluates the tendons of a fleet.
///
/// # Errors
/// Returns [`FleetError`] if the records cannot be read. A tendon without a trend is in the list with its reason.
pub fn due(engine: &mut Engine, request: &Due) -> Result<DueList, FleetError> {
    due_with_progress(engine, request, &|_, _| ())
}

/// Evaluates the tendons of a fleet as [`due`] does.
///
/// * `done`: called with the number of evaluated robots and of all robots.
fn due_with_progress(
    engine: &mut Engine,
    request: &Due,
    done: &dyn Fn(usize, usize),
) -> Result<DueList, FleetError> {
    let metadata = FleetMetadata::read(&engine.folder.path, &request.robots)?
        .with_creep(request.creep.as_deref())?;
    let mut out = DueList {
        now_utc_s: now_utc_s(engine)?,
        ..DueList::default()
    };
    let followers = Followers {
        metadata: &metadata,
        now_utc_s: out.now_utc_s,
        within_s: request.within_days * DAY_S,
        screen: !request.follow_all,
        keeps: request.state.is_some(),
    };
    let mut state = request.state.as_deref().map(State::open).transpose()?;
    let names: Vec<String> = engine
        .folder
        .robots()
        .into_iter()
        .map(str::to_owned)
        .collect();
    let mut unknown = BTreeMap::new();
    for (i, robots) in names.chunks(ROBOTS_IN_MEMORY).enumerate() {
        done(i * ROBOTS_IN_MEMORY, names.len());
        let tendons = engine.sessions(robots)?;
        out.tendons += tendons.len();
        let mut before = (state.as_mut()).map_or_else(BTreeMap::new, |state| state.of(robots));
        let outcomes: Vec<Outcome> = (tendons.par_iter())
            .map(|t| followers.evaluate(t, before.get(&t.tendon)))
            .collect();
        for (sessions, outcome) in tendons.iter().zip(outcomes) {
            // A tendon that is not tracked today keeps its last trend.
            let mut keep = before.remove(&sessions.tendon);
            match outcome {
                Outcome::OutOfReach => out.out_of_reach += 1,
                Outcome::NoLimit => out.without_limit += 1,
                Outcome::UnknownType(name) => {
                    out.without_limit += 1;
                    unknown.insert(name, ());
                }
                Outcome::Failed(robot, joint, reason) => out.failed.push((robot, joint, reason)),
                Outcome::Tracked {
                    found,
                    kept,
                    is_resumed,
                    has_reference_creep,
                } => {
                    out.followed.push(*found);
                    out.resumed += usize::from(is_resumed);
                    out.with_reference_creep += usize::from(has_reference_creep);
                    keep = Some(kept);
                }
            }
            if let (Some(state), Some(trend)) = (&mut state, keep) {
                state.keep(&sessions.tendon, &trend)?;
            }
        }
    }
    done(names.len(), names.len());
    out.state_unused = state.map_or(Ok(None), State::finish)?;
    out.unknown_types = unknown.into_keys().collect();
    out.followed.sort_by(TrackedTendon::worse_first);
    Ok(out)
}

/// Time of the fleet's last session, by UTC clocks that are not ahead of this computer's.
fn now_utc_s(engine: &mut Engine) -> Result<f64, FleetError> {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    let today_utc_s = since.map_or(f64::INFINITY, |since| since.as_secs_f64() + DAY_S);
    let sql = format!(
        "SELECT max(time_utc_s) FROM records WHERE clock = 'utc' AND time_utc_s <= {today_utc_s:e}"
    );
    let answer = engine.query(&sql)?;
    let found = answer.batches.iter().filter(|batch| batch.num_rows() > 0);
    let found = found.map(|batch| batch.column(0).as_primitive::<Float64Type>().value(0));
    Ok(found.fold(0.0, f64::max))
}

/// Reports progress on a terminal, in one line that ends empty.
fn report_progress(done: usize, of: usize) {
    if std::io::stderr().is_terminal() {
        match done < of {
            true => eprint!("\r{done} of {of} robots"),
            false => eprint!("\r\x1b[K"),
        }
    }
}

/// The command.
///
/// # Errors
/// [`FleetError`].
pub fn command(request: &Due) -> Result<ExitCode, FleetError> {
    let mut engine = Engine::open(&request.source)?;
    let list = due_with_progress(&mut engine, request, &report_progress)
        .inspect_err(|_| report_progress(0, 0))?;
    print!("{}", show::text(&list, request));
    show::report_unused_state(&list, request.state.as_deref());
    if let Some(path) = &request.csv {
        show::csv(&list, request, path)?;
    }
    let rejected = report_rejected(&engine.folder);
    let passed = list
        .followed
        .iter()
        .any(|f| f.passages.iter().any(Passage::is_passed));
    Ok(
        match rejected == ExitCode::SUCCESS && !passed && list.failed.is_empty() {
            true => ExitCode::SUCCESS,
            false => ExitCode::from(3),
        },
    )
}

/// Name of the rope of a tendon, if specified.
fn rope_of(fit: &Fitted) -> Option<&str> {
    fit.rope.as_deref()
}
