//! Reference creep of the ropes of a robot type, from the records of its fleet: prior for the trends of new robots.
//!
//! The creep per decade of time of every kind of tendon, with and without batch or site, is log-normal:
//!
//! ```text
//! ln s ~ N(m, w² + u + v)
//! m  mean of the model of `compare` over the tendons of the kind; without a batch, with equal weights of its batches
//! w  standard deviation between tendons of one kind, batch and site
//! u  variance of m; without a site, including the differences between sites and temperatures
//! v  without a batch: variance between batches
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
use crate::outliers::usual;
use crate::reference_creep::{CreepKind, ReferenceCreep, ReferenceCreeps};
use sinew_estimate::robot_dir;
use std::collections::{BTreeMap, BTreeSet};

/// Range of rope ages of the estimate, days.
const AGES: Ages = Ages {
    from_days: 1.0,
    to_days: 30.0,
};
/// Minimum number of tendons.
const MIN_TENDONS: usize = 20;
/// Minimum number of tendons of a batch or a site; with fewer, the values for any batch or site apply.
const MIN_TENDONS_OF_KIND: usize = 5;
/// Assumed standard deviation of the logarithm between batches if only one is present.
const BATCH_STD: f64 = 0.2;
const SEED: u64 = 1;

/// Estimates the creep of the ropes of a robot type from the records of a folder.
///
/// # Errors
/// [`FleetError`].
pub fn learn(request: &Pool) -> Result<(ReferenceCreeps, Folder), FleetError> {
    let source = Source {
        folder: request.folder.clone(),
        memory_mb: 1024,
    };
    let mut engine = Engine::open(&source)?;
    let name = robot_dir::load(&request.robot, None)?.robot.name;
    let gathered = gather(&mut engine, std::slice::from_ref(&request.robot), AGES)?;
    let of_type = gathered.tendons.into_iter();
    let tendons: Vec<CreepingTendon> = of_type.filter(|t| t.robot_type == name).collect();
    if tendons.len() < MIN_TENDONS {
        return Err(FleetError::TooFewTendons {
            tendons: tendons.len(),
            needed: MIN_TENDONS,
            too_few: gathered.too_few,
            ages: AGES,
        });
    }
    Ok((reference_creeps(&tendons)?, engine.folder))
}

/// Estimates the reference creep of the kinds of tendons.
///
/// # Errors
/// [`FleetError::NoDraws`], [`FleetError::DrawsApart`].
pub fn reference_creeps(tendons: &[CreepingTendon]) -> Result<ReferenceCreeps, FleetError> {
    let design = Design::by_any_batch(tendons);
    let draws = sample(&design.hierarchy, SEED).ok_or(FleetError::NoDraws)?;
    if !draws.have_converged() {
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
    // Batches of each kind, with and without batch or site.
    let mut estimates: BTreeMap<CreepKind, BTreeMap<Option<&str>, Vec<TendonEstimate>>> =
        BTreeMap::new();
    for ((tendon, (mean, variance)), width) in tendons.iter().zip(usual).zip(widths) {
        // Converts back to an offset of this joint.
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
            estimates
                .entry(kind)
                .or_default()
                .entry(batch)
                .or_default()
                .push(TendonEstimate {
                    mean: mean - per_rad.ln(),
                    variance,
                    width,
                });
        }
    }
    let references = estimates.into_iter().map(|(kind, batches)| {
        let tendons = batches.values().map(Vec::len).sum();
        let moments_of_batches: Vec<[f64; 2]> = batches.values().map(|of| moments(of)).collect();
        let count = moments_of_batches.len() as f64;
        let mean = moments_of_batches.iter().map(|t| t[0]).sum::<f64>() / count;
        let within = moments_of_batches.iter().map(|t| t[1]).sum::<f64>() / count;
        let squares = moments_of_batches
            .iter()
            .map(|t| (t[0] - mean).powi(2))
            .sum::<f64>();
        let between = match (&kind.batch, moments_of_batches.len()) {
            (Some(_), _) => 0.0,
            (None, 1) => BATCH_STD * BATCH_STD,
            (None, _) => squares / (count - 1.0) * (1.0 + 1.0 / count),
        };
        let creep = ReferenceCreep {
            median_rad: mean.exp(),
            spread: (within + between).sqrt(),
            ages: AGES,
            tendons,
        };
        (kind, creep)
    });
    Ok(references
        .filter(|(_, creep)| creep.tendons >= MIN_TENDONS_OF_KIND)
        .collect())
}

/// Model result of a tendon: mean and variance of the logarithm of its creep, and the usual deviation of its kind.
struct TendonEstimate {
    mean: f64,
    variance: f64,
    width: f64,
}

/// Mean and variance of a further tendon of these.
fn moments(estimates: &[TendonEstimate]) -> [f64; 2] {
    let count = estimates.len() as f64;
    let mean = estimates.iter().map(|s| s.mean).sum::<f64>() / count;
    let of = |s: &TendonEstimate| s.variance + s.width * s.width + (s.mean - mean).powi(2);
    [mean, estimates.iter().map(of).sum::<f64>() / count]
}
