//! `report`: page of a fleet for maintenance planning: work by week, comparison of ropes, worse batches.

mod page;
mod weeks;

use crate::FleetError;
use crate::args::{By, Compare, Due, Report};
use crate::compare::{Comparison, compared};
use crate::due::show::report_unused_state;
use crate::due::{DueList, Passage, due};
use crate::engine::Engine;
use crate::gather::gather;
use crate::rows::report_rejected;
use std::process::ExitCode;

/// Smallest relevant relative difference.
const MIN_DIFFERENCE: f64 = 0.05;
/// Maximum number of rows in the list of tendons.
const ROWS: usize = 40;

/// Content of the page.
#[derive(Debug)]
pub struct Found {
    /// Tendons that may exceed a limit.
    pub due: DueList,
    /// Look-ahead time of the list, days.
    pub within_days: f64,
    /// Number of robots with records.
    pub robots: usize,
    /// Number of records.
    pub records: u64,
    /// Comparisons of ropes, ropes by temperature and batches, or the reason why one is missing.
    pub compared: [Result<Comparison, FleetError>; 3],
    /// Number of rejected files.
    pub rejected: usize,
}

/// Comparisons on the page, in their order.
pub const BY: [By; 3] = [By::Rope, By::RopeTemperature, By::Batch];

/// Evaluates a fleet for the page.
///
/// # Errors
/// Returns [`FleetError`] if the records cannot be read. A failed comparison is on the page with its reason.
pub fn find(engine: &mut Engine, request: &Report) -> Result<Found, FleetError> {
    let within_days = 7.0 * f64::from(request.weeks);
    let due = due(
        engine,
        &Due {
            source: request.source.clone(),
            robots: request.robots.clone(),
            within_days,
            rows: ROWS,
            csv: None,
            state: request.state.clone(),
            creep: None,
            follow_all: false,
        },
    )?;
    let gathered = gather(engine, &request.robots, request.ages)?;
    let compare = |by: By| {
        compared(
            &gathered,
            &Compare {
                source: request.source.clone(),
                by,
                robots: request.robots.clone(),
                ages: request.ages,
                least: MIN_DIFFERENCE,
                seed: request.seed,
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
        rejected: engine.folder.rejected.len(),
    })
}

/// The command.
///
/// # Errors
/// [`FleetError`].
pub fn command(request: &Report) -> Result<ExitCode, FleetError> {
    let mut engine = Engine::open(&request.source)?;
    let found = find(&mut engine, request)?;
    report_unused_state(&found.due, request.state.as_deref());
    sinew_files::write_file(&request.out, page::page(&found).html().as_bytes())?;
    println!("{}", request.out.display());
    let rejected = report_rejected(&engine.folder);
    let followed = found.due.followed.iter();
    let passed = followed.flat_map(|f| &f.passages).any(Passage::is_passed);
    let worse = found.compared.iter().flatten();
    let worse = worse.flat_map(Comparison::worse).next().is_some();
    Ok(match passed || worse || !found.due.failed.is_empty() {
        true => ExitCode::from(3),
        false => rejected,
    })
}
