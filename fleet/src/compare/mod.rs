//! `compare`: which rope, batch, site or temperature creeps more, and whether the difference is significant.

mod apart;
pub(crate) mod design;
mod factor;
pub(crate) mod show;
pub(crate) mod values;
mod verdict;

pub use factor::{Factor, GroupKey};
pub use verdict::{Group, Verdict};

use crate::FleetError;
use crate::args::{By, Compare};
use crate::creep::Ages;
use crate::engine::Engine;
use crate::gather::{FleetTable, gather};
use crate::hierarchy::sample;
use crate::rows::report_rejected;
use design::Design;
use std::process::ExitCode;

/// Result of a comparison of groups.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// Grouping key of the comparison.
    pub by: By,
    /// Range of rope ages for the creep rate.
    pub ages: Ages,
    /// Groups, largest creep first within each family.
    pub groups: Vec<Group>,
    /// Unit of the creep.
    pub unit: CreepUnit,
    /// Factors for which the differences are adjusted.
    pub freed_of: Vec<Factor>,
    /// Typical ratio between tendons of one kind and group: exponential of the median standard deviation of the logarithm.
    pub tendon_factor: f64,
    /// Number of compared tendons.
    pub tendons: usize,
    /// Number of tendons with too few sessions at these ages.
    pub too_few: usize,
    /// Number of tendons without a specified group.
    pub without_group: usize,
    /// Number of tendons whose age counts from their first session because the rope installation is not recorded.
    pub undated: usize,
    /// Ratio of between-chain to within-chain estimates if the four chains have not converged; no verdict is given then.
    pub apart: Option<f64>,
}

impl Comparison {
    /// Groups that are worse than the others.
    pub fn worse(&self) -> impl Iterator<Item = &Group> {
        self.groups.iter().filter(|g| g.verdict == Verdict::Worse)
    }
}

/// Unit of the creep.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CreepUnit {
    /// Strain of the rope per decade of time.
    Strain,
    /// Offset of the joint per decade of time, rad, because a robot type has no description.
    Offset,
}

/// Compares the groups of a fleet.
///
/// # Errors
///
/// Returns [`FleetError::NoGroups`] if the metadata distinguish fewer than two groups, and [`FleetError`] if the records
/// cannot be read.
pub fn compare(engine: &mut Engine, request: &Compare) -> Result<Comparison, FleetError> {
    let gathered = gather(engine, &request.robots, request.ages)?;
    compared(&gathered, request)
}

/// Compares groups of tendons that were gathered.
///
/// # Errors
/// As [`compare`].
pub fn compared(gathered: &FleetTable, request: &Compare) -> Result<Comparison, FleetError> {
    let design = Design::of(&gathered.tendons, request.by);
    let groups = design.groups.len();
    if groups < 2 {
        return Err(FleetError::NoGroups {
            by: request.by,
            groups,
            tendons: gathered.tendons.len(),
            too_few: gathered.too_few,
            ages: request.ages,
        });
    }
    let draws = sample(&design.hierarchy, request.seed).ok_or(FleetError::NoDraws)?;
    let mut tendon: Vec<f64> = draws.stds.iter().map(|d| d[0].hypot(d[1])).collect();
    let middle = sinew_model::statistics::upper_median(&mut tendon).unwrap_or(f64::NAN);
    Ok(Comparison {
        by: request.by,
        ages: request.ages,
        groups: verdict::groups(&design, &draws, request.least),
        unit: design.unit,
        freed_of: design.freed_of.clone(),
        tendon_factor: middle.exp(),
        tendons: design.hierarchy.units.len(),
        too_few: gathered.too_few,
        without_group: design.without_group,
        undated: design.undated,
        apart: (!draws.have_converged()).then_some(draws.disagreement),
    })
}

/// The command.
///
/// # Errors
/// [`FleetError`].
pub fn command(request: &Compare) -> Result<ExitCode, FleetError> {
    let mut engine = Engine::open(&request.source)?;
    let found = compare(&mut engine, request)?;
    print!("{}", show::text(&found, request));
    if let Some(path) = &request.csv {
        show::csv(&found, path)?;
    }
    let rejected = report_rejected(&engine.folder);
    Ok(match found.worse().next() {
        Some(_) => ExitCode::from(3),
        None => rejected,
    })
}
