//! `compare`: which rope, batch, site or temperature creeps more, and whether that can be told.

mod apart;
pub(crate) mod design;
mod factor;
mod judge;
pub(crate) mod show;
pub(crate) mod values;

pub use factor::{Factor, GroupKey};
pub use judge::{Group, Verdict};

use crate::FleetError;
use crate::args::{By, Compare};
use crate::creep::Ages;
use crate::engine::Engine;
use crate::gather::{Gathered, gather};
use crate::hierarchy::sample;
use crate::rows::tell_refused;
use design::Design;
use std::process::ExitCode;

/// What the groups of a fleet come to.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// What was compared.
    pub by: By,
    /// Ages of the ropes over which they were.
    pub ages: Ages,
    /// Groups, the worst first within each family.
    pub groups: Vec<Group>,
    /// What creep is given in.
    pub unit: CreepUnit,
    /// What differences were freed of.
    pub freed_of: Vec<Factor>,
    /// What tendons of a kind and group differ by, of one robot or of several, as a factor: one standard deviation, median.
    pub tendon_factor: f64,
    /// Tendons that were compared.
    pub tendons: usize,
    /// Tendons with too few sessions of these ages.
    pub too_few: usize,
    /// Tendons of which nobody says to which group they belong.
    pub without_group: usize,
    /// Tendons whose age counts from their first session, as nobody says when their rope was fitted.
    pub undated: usize,
    /// Ratio of what four chains say, where they differ too much for any claim.
    pub apart: Option<f64>,
}

impl Comparison {
    /// Groups that are worse than the others.
    pub fn worse(&self) -> impl Iterator<Item = &Group> {
        self.groups.iter().filter(|g| g.verdict == Verdict::Worse)
    }
}

/// What creep is given in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CreepUnit {
    /// Strain of the rope per decade of time.
    Strain,
    /// Offset of the joint per decade of time, rad: some robot type isn't described.
    Offset,
}

/// Compares the groups of a fleet.
///
/// # Errors
/// [`FleetError`]; [`FleetError::NoGroups`] where fewer than two can be told apart by what lies beside the records.
pub fn compare(engine: &mut Engine, asked: &Compare) -> Result<Comparison, FleetError> {
    let gathered = gather(engine, &asked.robots, asked.ages)?;
    compared(&gathered, asked)
}

/// Compares groups of tendons that were gathered.
///
/// # Errors
/// As [`compare`].
pub fn compared(gathered: &Gathered, asked: &Compare) -> Result<Comparison, FleetError> {
    let design = Design::of(&gathered.tendons, asked.by);
    let groups = design.groups.len();
    if groups < 2 {
        return Err(FleetError::NoGroups {
            by: asked.by,
            groups,
            tendons: gathered.tendons.len(),
            too_few: gathered.too_few,
            ages: asked.ages,
        });
    }
    let draws = sample(&design.hierarchy, asked.seed).ok_or(FleetError::NoDraws)?;
    let mut tendon: Vec<f64> = draws.deviations.iter().map(|d| d[0].hypot(d[1])).collect();
    let middle = sinew_model::statistics::upper_median(&mut tendon).unwrap_or(f64::NAN);
    Ok(Comparison {
        by: asked.by,
        ages: asked.ages,
        groups: judge::groups(&design, &draws, asked.least),
        unit: design.unit,
        freed_of: design.freed_of.clone(),
        tendon_factor: middle.exp(),
        tendons: design.hierarchy.units.len(),
        too_few: gathered.too_few,
        without_group: design.without_group,
        undated: design.undated,
        apart: (!draws.have_come_together()).then_some(draws.disagreement),
    })
}

/// The command.
///
/// # Errors
/// [`FleetError`].
pub fn command(asked: &Compare) -> Result<ExitCode, FleetError> {
    let mut engine = Engine::open(&asked.source)?;
    let found = compare(&mut engine, asked)?;
    print!("{}", show::text(&found, asked));
    if let Some(path) = &asked.csv {
        show::csv(&found, path)?;
    }
    let refused = tell_refused(&engine.folder);
    Ok(match found.worse().next() {
        Some(_) => ExitCode::from(3),
        None => refused,
    })
}
