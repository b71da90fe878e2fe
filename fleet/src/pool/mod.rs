//! `pool`: what a new robot of a type starts from, by what the type's robots have learned.

pub mod creep;
mod show;

use crate::FleetError;
use crate::args::Pool;
use crate::folder::{BASELINES, find};
use crate::known_creep;
use crate::rows::tell_refused;
use sinew_estimate::baseline::{self, Baseline, MergeSummary};
use sinew_estimate::robot_dir;
use sinew_model::offset::alike::Alike;
use std::path::PathBuf;
use std::process::ExitCode;

/// Why a baseline was left out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum LeftOut {
    /// It can't be read.
    Unreadable(String),
    /// It is of another type: its name.
    OtherType(String),
    /// It goes on from others, so what they learned would count again: how many recordings it rests on.
    GoesOn(usize),
}

/// What robots of a type have learned.
#[derive(Debug, Clone, PartialEq)]
pub struct Pooled {
    /// What a new robot starts from.
    pub start: Baseline,
    /// What became surer.
    pub summary: MergeSummary,
    /// How alike robots are.
    pub alike: Vec<Alike>,
    /// Robots it rests on.
    pub robots: usize,
    /// Files that were left out.
    pub left_out: Vec<(PathBuf, LeftOut)>,
}

/// Learns from the baselines of a folder.
///
/// # Errors
/// [`FleetError`]; a file that can't be used is left out and named.
pub fn pool(asked: &Pool) -> Result<Pooled, FleetError> {
    let robot = robot_dir::load(&asked.robot, None)?.robot;
    let mut files = Vec::new();
    find(&asked.folder, BASELINES, &mut files)?;
    files.sort_unstable();
    let (mut used, mut left_out) = (Vec::new(), Vec::new());
    for path in files {
        match Baseline::read(&path) {
            Err(error) => left_out.push((path, LeftOut::Unreadable(error.to_string()))),
            Ok(baseline) if baseline.robot != robot.name => {
                left_out.push((path, LeftOut::OtherType(baseline.robot)));
            }
            Ok(baseline) => match baseline.recordings.len() + baseline.before.len() {
                0 | 1 => used.push((baseline, path.display().to_string())),
                more => left_out.push((path, LeftOut::GoesOn(more))),
            },
        }
    }
    if used.len() < 2 {
        return Err(FleetError::TooFewBaselines {
            folder: asked.folder.clone(),
            robot: robot.name,
            found: used.len(),
        });
    }
    let parts: Vec<(&Baseline, &str)> = used.iter().map(|(b, file)| (b, file.as_str())).collect();
    let (start, summary, alike) = baseline::pool(&robot, &parts)?;
    Ok(Pooled {
        start,
        summary,
        alike,
        robots: used.len(),
        left_out,
    })
}

/// The command.
///
/// # Errors
/// [`FleetError`].
pub fn command(asked: &Pool) -> Result<ExitCode, FleetError> {
    if asked.creep {
        let (known, folder) = creep::learn(asked)?;
        known_creep::write(&known, &asked.out)?;
        print!("{}", show::creep(&known, &asked.out));
        return Ok(tell_refused(&folder));
    }
    let pooled = pool(asked)?;
    pooled.start.write(&asked.out)?;
    print!("{}", show::text(&pooled, &asked.out));
    for (path, why) in &pooled.left_out {
        eprintln!("{}", show::left_out(path, why));
    }
    let unreadable = |(_, why): &(PathBuf, LeftOut)| matches!(why, LeftOut::Unreadable(_));
    Ok(match pooled.left_out.iter().any(unreadable) {
        true => ExitCode::from(3),
        false => ExitCode::SUCCESS,
    })
}
