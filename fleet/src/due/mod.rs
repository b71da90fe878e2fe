//! `due`: which tendon passes its limit when, the worst first.
//!
//! Robots are taken some at a time, so memory is bounded by them and not by the fleet. Of each tendon a bound in closed
//! form comes first ([`screen`]); whoever it can't rule out is followed by the trend of `sinew trend`.

mod follow;
pub mod screen;
pub(crate) mod show;
mod state;

pub use follow::Followed;
pub use sinew_trend::Passage;
pub use state::StateUnused;

use crate::FleetError;
use crate::args::Due;
use crate::beside::Beside;
use crate::engine::Engine;
use crate::folder::sides::Fitted;
use crate::rows::tell_refused;
use datafusion::arrow::array::AsArray as _;
use datafusion::arrow::datatypes::Float64Type;
use follow::{Followers, Outcome};
use rayon::prelude::*;
use sinew_files::date::DAY_S;
use state::State;
use std::collections::BTreeMap;
use std::process::ExitCode;
use std::time::{SystemTime, UNIX_EPOCH};

/// Robots that are in memory at a time.
const TOGETHER: usize = 50;

/// What the tendons of a fleet come to.
#[derive(Debug, Clone, Default)]
pub struct DueList {
    /// Last session of the fleet, s since 1970: days count from here.
    pub now_utc_s: f64,
    /// Tendons that were followed, the worst first.
    pub followed: Vec<Followed>,
    /// Of them those that went on from where the last question left them.
    pub went_on: usize,
    /// Of them those that began with how fast such ropes creep in a fleet.
    pub creep_known: usize,
    /// Why what the last question left was of no use.
    pub state_unused: Option<StateUnused>,
    /// Tendons with records.
    pub tendons: usize,
    /// Tendons that the screen ruled out.
    pub out_of_reach: usize,
    /// Tendons without a limit, or of a type nobody described.
    pub without_limit: usize,
    /// Robot types of which there is no description.
    pub unknown_types: Vec<String>,
    /// Tendons whose trend was refused, and why.
    pub refused: Vec<(String, String, String)>,
}

impl DueList {
    /// Those that may pass a limit within the days asked for: passed, or the lower end of the interval is within.
    pub fn due(&self, within_days: f64) -> impl Iterator<Item = &Followed> {
        let until_utc_s = self.now_utc_s + within_days * DAY_S;
        (self.followed.iter()).filter(move |f| f.worst().is_some_and(|p| p.is_due(until_utc_s)))
    }
}

/// Looks through a fleet.
///
/// # Errors
/// [`FleetError`]; a tendon whose records are refused is in the list with its reason.
pub fn due(engine: &mut Engine, asked: &Due) -> Result<DueList, FleetError> {
    let beside =
        Beside::read(&engine.folder.path, &asked.robots)?.with_creep(asked.creep.as_deref())?;
    let mut out = DueList {
        now_utc_s: now_utc_s(engine)?,
        ..DueList::default()
    };
    let followers = Followers {
        beside: &beside,
        now_utc_s: out.now_utc_s,
        within_s: asked.within_days * DAY_S,
        screen: !asked.follow_all,
        keeps: asked.state.is_some(),
    };
    let mut state = asked.state.as_deref().map(State::open).transpose()?;
    let names: Vec<String> = engine
        .folder
        .robots()
        .into_iter()
        .map(str::to_owned)
        .collect();
    let mut unknown = BTreeMap::new();
    for robots in names.chunks(TOGETHER) {
        let tendons = engine.sessions(robots)?;
        out.tendons += tendons.len();
        let mut before = (state.as_mut()).map_or_else(BTreeMap::new, |state| state.of(robots));
        let outcomes: Vec<Outcome> = (tendons.par_iter())
            .map(|t| followers.look(t, before.get(&t.tendon)))
            .collect();
        for (sessions, outcome) in tendons.iter().zip(outcomes) {
            // Of one that needn't be followed today the last trend stays.
            let mut keep = before.remove(&sessions.tendon);
            match outcome {
                Outcome::OutOfReach => out.out_of_reach += 1,
                Outcome::NoLimit => out.without_limit += 1,
                Outcome::UnknownType(name) => {
                    out.without_limit += 1;
                    unknown.insert(name, ());
                }
                Outcome::Refused(robot, joint, why) => out.refused.push((robot, joint, why)),
                Outcome::Followed {
                    found,
                    kept,
                    went_on,
                    creep_known,
                } => {
                    out.followed.push(*found);
                    out.went_on += usize::from(went_on);
                    out.creep_known += usize::from(creep_known);
                    keep = Some(kept);
                }
            }
            if let (Some(state), Some(trend)) = (&mut state, keep) {
                state.keep(&sessions.tendon, &trend)?;
            }
        }
    }
    out.state_unused = state.map_or(Ok(None), State::finish)?;
    out.unknown_types = unknown.into_keys().collect();
    out.followed.sort_by(Followed::worse_first);
    Ok(out)
}

/// The fleet's last session, by civil clocks that aren't ahead of this computer's.
fn now_utc_s(engine: &mut Engine) -> Result<f64, FleetError> {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    let today_utc_s = since.map_or(f64::INFINITY, |since| since.as_secs_f64() + DAY_S);
    let sql = format!(
        "SELECT max(time_utc_s) FROM records WHERE clock = 'utc' AND time_utc_s <= {today_utc_s:e}"
    );
    let answer = engine.ask(&sql)?;
    let found = answer.batches.iter().filter(|batch| batch.num_rows() > 0);
    let found = found.map(|batch| batch.column(0).as_primitive::<Float64Type>().value(0));
    Ok(found.fold(0.0, f64::max))
}

/// The command.
///
/// # Errors
/// [`FleetError`].
pub fn command(asked: &Due) -> Result<ExitCode, FleetError> {
    let mut engine = Engine::open(&asked.source)?;
    let list = due(&mut engine, asked)?;
    print!("{}", show::text(&list, asked));
    show::tell_unused(&list, asked.state.as_deref());
    if let Some(path) = &asked.csv {
        show::csv(&list, asked, path)?;
    }
    let refused = tell_refused(&engine.folder);
    let passed = list
        .followed
        .iter()
        .any(|f| f.passages.iter().any(Passage::is_passed));
    Ok(
        match refused == ExitCode::SUCCESS && !passed && list.refused.is_empty() {
            true => ExitCode::SUCCESS,
            false => ExitCode::from(3),
        },
    )
}

/// A tendon as its rope says.
fn rope_of(fit: &Fitted) -> Option<&str> {
    fit.rope.as_deref()
}
