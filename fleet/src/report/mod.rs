//! `report`: a page of a fleet, for whoever plans the work: what is due in which week, ropes compared, worse batches.

mod page;
mod weeks;

use crate::FleetError;
use crate::args::{By, Compare, Due, Report};
use crate::compare::{Comparison, compared};
use crate::due::show::tell_unused;
use crate::due::{DueList, Passage, due};
use crate::engine::Engine;
use crate::gather::gather;
use crate::rows::tell_refused;
use std::process::ExitCode;

/// Differences below this are none.
const LEAST: f64 = 0.05;
/// Rows of the list of tendons.
const ROWS: usize = 40;

/// What a page says.
#[derive(Debug)]
pub struct Found {
    /// What is due.
    pub due: DueList,
    /// Days the list looks ahead.
    pub within_days: f64,
    /// Robots with records.
    pub robots: usize,
    /// Records.
    pub records: u64,
    /// Ropes, ropes by temperature, batches; or why there is no such comparison.
    pub compared: [Result<Comparison, FleetError>; 3],
    /// Files that were refused.
    pub refused: usize,
}

/// What is compared on the page, in its order.
pub const BY: [By; 3] = [By::Rope, By::RopeTemperature, By::Batch];

/// Looks through a fleet.
///
/// # Errors
/// [`FleetError`]; a comparison that can't be made is on the page with its reason.
pub fn find(engine: &mut Engine, asked: &Report) -> Result<Found, FleetError> {
    let within_days = 7.0 * f64::from(asked.weeks);
    let due = due(
        engine,
        &Due {
            source: asked.source.clone(),
            robots: asked.robots.clone(),
            within_days,
            rows: ROWS,
            csv: None,
            state: asked.state.clone(),
            creep: None,
            follow_all: false,
        },
    )?;
    let gathered = gather(engine, &asked.robots, asked.ages)?;
    let compare = |by: By| {
        compared(
            &gathered,
            &Compare {
                source: asked.source.clone(),
                by,
                robots: asked.robots.clone(),
                ages: asked.ages,
                least: LEAST,
                seed: asked.seed,
                csv: None,
            },
        )
    };
    Ok(Found {
        due,
        within_days,
        robots: engine.folder.robots().len(),
        records: engine.count("records")?,
        compared: BY.map(compare),
        refused: engine.folder.refused.len(),
    })
}

/// The command.
///
/// # Errors
/// [`FleetError`].
pub fn command(asked: &Report) -> Result<ExitCode, FleetError> {
    let mut engine = Engine::open(&asked.source)?;
    let found = find(&mut engine, asked)?;
    tell_unused(&found.due, asked.state.as_deref());
    sinew_files::write_file(&asked.out, page::page(&found).html().as_bytes())?;
    println!("{}", asked.out.display());
    let refused = tell_refused(&engine.folder);
    let followed = found.due.followed.iter();
    let passed = followed.flat_map(|f| &f.passages).any(Passage::is_passed);
    let worse = found.compared.iter().flatten();
    let worse = worse.flat_map(Comparison::worse).next().is_some();
    Ok(match passed || worse || !found.due.refused.is_empty() {
        true => ExitCode::from(3),
        false => refused,
    })
}
