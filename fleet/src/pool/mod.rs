//! `pool`: prior of a new robot of a type, from the baselines of the type's robots.

pub mod creep;
mod show;

use crate::FleetError;
use crate::args::Pool;
use crate::folder::{BASELINES, find};
use crate::reference_creep;
use crate::rows::report_rejected;
use sinew_estimate::baseline::{self, Baseline, MergeSummary};
use sinew_estimate::robot_dir;
use sinew_model::offset::shared_parameters::SharedParameters;
use std::path::PathBuf;
use std::process::ExitCode;

/// Reason for the exclusion of a baseline.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Excluded {
    /// Unreadable file, with the message.
    Unreadable(String),
    /// Baseline of another robot type, with its name.
    OtherType(String),
    /// Baseline of a chain, whose earlier recordings would count again, with its number of recordings.
    Chained(usize),
}

/// Pooled baselines of a robot type.
#[derive(Debug, Clone, PartialEq)]
pub struct Pooled {
    /// Prior of a new robot.
    pub start: Baseline,
    /// Change of the uncertainties by the merge.
    pub summary: MergeSummary,
    /// Similarity of the robots by kind of parameter.
    pub similarity: Vec<SharedParameters>,
    /// Number of pooled robots.
    pub robots: usize,
    /// Excluded files.
    pub excluded: Vec<(PathBuf, Excluded)>,
}

/// Pools the baselines of a folder.
///
/// # Errors
///
/// Returns [`FleetError`] if fewer than two baselines are usable; unusable files are excluded and listed.
pub fn pool(request: &Pool) -> Result<Pooled, FleetError> {
    let robot = robot_dir::load(&request.robot, None)?.robot;
    let mut files = Vec::new();
    find(&request.folder, BASELINES, &mut files)?;
    files.sort_unstable();
    let (mut used, mut excluded) = (Vec::new(), Vec::new());
    for path in files {
        match Baseline::read(&path) {
            Err(error) => excluded.push((path, Excluded::Unreadable(error.to_string()))),
            Ok(baseline) if baseline.robot != robot.name => {
                excluded.push((path, Excluded::OtherType(baseline.robot)));
            }
            Ok(baseline) => match baseline.recordings.len() + baseline.before.len() {
                0 | 1 => used.push((baseline, path.display().to_string())),
                more => excluded.push((path, Excluded::Chained(more))),
            },
        }
    }
    if used.len() < 2 {
        return Err(FleetError::TooFewBaselines {
            folder: request.folder.clone(),
            robot: robot.name,
            found: used.len(),
        });
    }
    let parts: Vec<(&Baseline, &str)> = used.iter().map(|(b, file)| (b, file.as_str())).collect();
    let (start, summary, similarity) = baseline::pool(&robot, &parts)?;
    Ok(Pooled {
        start,
        summary,
        similarity,
        robots: used.len(),
        excluded,
    })
}

/// The command.
///
/// # Errors
/// [`FleetError`].
pub fn command(request: &Pool) -> Result<ExitCode, FleetError> {
    if request.creep {
        let (references, folder) = creep::learn(request)?;
        reference_creep::write(&references, &request.out)?;
        print!("{}", show::creep(&references, &request.out));
        return Ok(report_rejected(&folder));
    }
    let pooled = pool(request)?;
    pooled.start.write(&request.out)?;
    print!("{}", show::text(&pooled, &request.out));
    for (path, reason) in &pooled.excluded {
        eprintln!("{}", show::excluded(path, reason));
    }
    let unreadable = |(_, reason): &(PathBuf, Excluded)| matches!(reason, Excluded::Unreadable(_));
    Ok(match pooled.excluded.iter().any(unreadable) {
        true => ExitCode::from(3),
        false => ExitCode::SUCCESS,
    })
}
