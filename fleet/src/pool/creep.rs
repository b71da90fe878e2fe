//! How fast ropes of a robot type creep, by its fleet's records: what trends of new robots begin with.
//!
//! Of every kind of tendon, with its batch or site and without, creep per decade of time is log-normal:
//!
//! ```text
//! ln s ~ N(m, w² + u + v)
//! m  mean of what the model of `compare` says of the kind's tendons; without a batch, of its batches alike
//! w  what tendons of one kind, batch and site differ by
//! u  what isn't known of m; without a site, how far sites and temperatures move it
//! v  without a batch: how far batches differ
//! ```

use crate::FleetError;
use crate::args::{Pool, Source};
use crate::compare::CreepUnit;
use crate::compare::design::Design;
use crate::compare::values::usual_widths;
use crate::creep::Ages;
use crate::engine::Engine;
use crate::folder::Folder;
use crate::gather::{CreepingTendon, gather};
use crate::hierarchy::sample;
use crate::known_creep::{CreepKind, KnownCreep, KnownCreeps};
use crate::outliers::usual;
use sinew_estimate::robot_dir;
use std::collections::{BTreeMap, BTreeSet};

/// Ages creep is told over, days.
const AGES: Ages = Ages {
    from_days: 1.0,
    to_days: 30.0,
};
/// Fewer tendons say nothing of how they differ.
const LEAST: usize = 20;
/// A batch or a site with fewer is taken for any.
const FEW: usize = 5;
/// Batches may differ by so much, as a standard deviation of the logarithm, where only one is known.
const ONE_BATCH: f64 = 0.2;
const SEED: u64 = 1;

/// Learns from the records of a folder how fast ropes of a robot type creep.
///
/// # Errors
/// [`FleetError`].
pub fn learn(asked: &Pool) -> Result<(KnownCreeps, Folder), FleetError> {
    let source = Source {
        folder: asked.folder.clone(),
        memory_mb: 1024,
    };
    let mut engine = Engine::open(&source)?;
    let name = robot_dir::load(&asked.robot, None)?.robot.name;
    let gathered = gather(&mut engine, std::slice::from_ref(&asked.robot), AGES)?;
    let of_type = gathered.tendons.into_iter();
    let tendons: Vec<CreepingTendon> = of_type.filter(|t| t.robot_type == name).collect();
    if tendons.len() < LEAST {
        return Err(FleetError::TooFewTendons {
            tendons: tendons.len(),
            needed: LEAST,
            too_few: gathered.too_few,
            ages: AGES,
        });
    }
    Ok((known(&tendons)?, engine.folder))
}

/// What tendons say of their kinds.
///
/// # Errors
/// [`FleetError::NoDraws`], [`FleetError::DrawsApart`].
pub fn known(tendons: &[CreepingTendon]) -> Result<KnownCreeps, FleetError> {
    let design = Design::by_any_batch(tendons);
    let draws = sample(&design.hierarchy, SEED).ok_or(FleetError::NoDraws)?;
    if !draws.have_come_together() {
        return Err(FleetError::DrawsApart {
            ratio: draws.disagreement,
        });
    }
    let usual = usual(&design, &draws);
    let departures: Vec<(f64, f64)> = (design.logarithms.iter())
        .zip(&design.hierarchy.units)
        .zip(&usual)
        .map(|((value, unit), (mean, _))| (value - mean, unit.variance))
        .collect();
    let widths = usual_widths(&departures, tendons);
    // Of each kind its batches: those asked for with batch or site, and without.
    let mut said: BTreeMap<CreepKind, BTreeMap<Option<&str>, Vec<Said>>> = BTreeMap::new();
    for ((tendon, (mean, variance)), width) in tendons.iter().zip(usual).zip(widths) {
        // As an offset of this joint again.
        let per_rad = match design.unit {
            CreepUnit::Strain => tendon.strain_per_rad.unwrap_or(1.0),
            CreepUnit::Offset => 1.0,
        };
        let batch = tendon.fit.batch.as_deref();
        let kind = CreepKind {
            robot_type: tendon.robot_type.clone(),
            joint: tendon.joint.clone(),
            rope: tendon.fit.rope.clone(),
            batch: batch.map(str::to_owned),
            site: tendon.site.clone(),
        };
        for kind in kind.and_wider().collect::<BTreeSet<_>>() {
            said.entry(kind)
                .or_default()
                .entry(batch)
                .or_default()
                .push(Said {
                    mean: mean - per_rad.ln(),
                    variance,
                    width,
                });
        }
    }
    let told = said.into_iter().map(|(kind, batches)| {
        let tendons = batches.values().map(Vec::len).sum();
        let told: Vec<[f64; 2]> = batches.values().map(|of| moments(of)).collect();
        let count = told.len() as f64;
        let mean = told.iter().map(|t| t[0]).sum::<f64>() / count;
        let within = told.iter().map(|t| t[1]).sum::<f64>() / count;
        let squares = told.iter().map(|t| (t[0] - mean).powi(2)).sum::<f64>();
        let between = match (&kind.batch, told.len()) {
            (Some(_), _) => 0.0,
            (None, 1) => ONE_BATCH * ONE_BATCH,
            (None, _) => squares / (count - 1.0) * (1.0 + 1.0 / count),
        };
        let creep = KnownCreep {
            median_rad: mean.exp(),
            spread: (within + between).sqrt(),
            ages: AGES,
            tendons,
        };
        (kind, creep)
    });
    Ok(told.filter(|(_, creep)| creep.tendons >= FEW).collect())
}

/// What the model says of a tendon: logarithm of its creep and the variance of that, and what tendons differ by.
struct Said {
    mean: f64,
    variance: f64,
    width: f64,
}

/// Mean and variance of a tendon like these.
fn moments(said: &[Said]) -> [f64; 2] {
    let count = said.len() as f64;
    let mean = said.iter().map(|s| s.mean).sum::<f64>() / count;
    let of = |s: &Said| s.variance + s.width * s.width + (s.mean - mean).powi(2);
    [mean, said.iter().map(of).sum::<f64>() / count]
}
