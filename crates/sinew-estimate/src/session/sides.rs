//! Whether what is recorded can be the two sides of springs.

use super::recorder::Recorded;
use crate::error::{OpposedSpring, SessionError, SidesFault};
use sinew_model::offset::Prior;
use sinew_model::robot::Robot;

/// A joint that moved less than this tells nothing, rad.
const MOVED_RAD: f64 = 10e-3;
/// A spring whose deflection changes by no more than this carries nothing at all: rounding of positions, rad.
const NOTHING_RAD: f64 = 1e-9;
/// The description must expect so much change of the deflection (standard deviation) for its sign to be told, rad.
const LOADED_RAD: f64 = 5e-3;
/// Slope over what the description expects. Wrong masses and a payload leave it above zero.
const OPPOSED: f64 = -0.5;
/// Correlation with it. A contact can turn a slope round, but then what is read follows nothing.
const FOLLOWS: f64 = -0.9;
/// Fewer blocks tell no slope.
const ENOUGH: usize = 20;

/// Refuses a recording whose motor and joint side are one signal, or stand in each other's place.
///
/// A spring's deflection `y` follows what moves with the joint, `Φ z / K` with the described masses `z`, with a slope near
/// one. Where both sides are exchanged it is minus one at every joint, and no tolerance of stiffness or mass leads there.
pub(super) fn check(
    robot: &Robot,
    prior: &Prior,
    recorded: &Recorded,
    name: &str,
) -> Result<(), SessionError> {
    let refuse = |fault| {
        Err(SessionError::Sides {
            file: name.into(),
            fault,
        })
    };
    let named = |i: usize| robot.joint_names()[i].clone();
    let elastic = || recorded.elastic.iter().copied();
    let same: Vec<String> = elastic()
        .filter(|&i| are_one(recorded, i))
        .map(named)
        .collect();
    if !same.is_empty() {
        return refuse(SidesFault::Same { joints: same });
    }
    let loaded: Vec<(usize, Fit)> = elastic()
        .filter_map(|i| Some((i, fit(prior, recorded, i)?)))
        .collect();
    let opposed = |fit: &Fit| fit.slope < OPPOSED && fit.correlation < FOLLOWS;
    if !loaded.is_empty() && loaded.iter().all(|(_, fit)| opposed(fit)) {
        let springs = loaded.iter().map(|(i, fit)| OpposedSpring {
            joint: named(*i),
            slope: fit.slope,
        });
        let springs = springs.collect();
        return refuse(SidesFault::Opposed { springs });
    }
    Ok(())
}

/// Whether a joint moved and its motor went along to the last digit.
fn are_one(recorded: &Recorded, joint: usize) -> bool {
    let range = |of: &dyn Fn(usize) -> f64| {
        let all = (0..recorded.blocks.len()).map(of);
        let (least, most) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
            (a.min(x), b.max(x))
        });
        most - least
    };
    range(&|k| recorded.blocks[k].turned[joint]) > MOVED_RAD
        && range(&|k| recorded.blocks[k].y[joint]) <= NOTHING_RAD
}

/// The deflection as read, over the described one.
struct Fit {
    slope: f64,
    correlation: f64,
}

/// Least squares; `None` where the described deflection hardly changes.
fn fit(prior: &Prior, recorded: &Recorded, joint: usize) -> Option<Fit> {
    let described = prior.described_deflections_rad(&recorded.blocks, joint);
    let pairs: Vec<(f64, f64)> = (described.into_iter())
        .zip(recorded.blocks.iter().map(|b| b.y[joint]))
        .collect();
    if pairs.len() < ENOUGH {
        return None;
    }
    let count = pairs.len() as f64;
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>() / count;
    let (described, read) = (mean(&|p| p.0), mean(&|p| p.1));
    let variance = mean(&|p| (p.0 - described).powi(2));
    let of_reading = mean(&|p| (p.1 - read).powi(2));
    let both = mean(&|p| (p.0 - described) * (p.1 - read));
    (variance.sqrt() > LOADED_RAD).then(|| Fit {
        slope: both / variance,
        correlation: both / (variance * of_reading).sqrt(),
    })
}
