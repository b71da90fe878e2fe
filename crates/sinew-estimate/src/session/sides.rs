//! Whether motor and joint side stand in each other's place.

use super::recorder::Recorded;
use crate::error::{EstimateError, OpposedSpring, SidesFault};
use sinew_model::offset::Prior;
use sinew_model::robot::Robot;
use sinew_model::statistics::upper_median;

/// The deflection that the description expects must spread by more for its sign to be told, rad: half of the blocks
/// lie farther from its median.
const LOADED_RAD: f64 = 5e-3;
/// Spread about the turned expectation over that about the expectation. Where sides are right the least was 1.26 of some 2,100 recordings
/// and joints, with pushes, payloads, slips and wrong masses; where they were exchanged the most was 0.66.
const OPPOSED: f64 = 0.7;
/// Fewer blocks tell nothing: contacts may last as long. One of 46 blocks had a share of 0.62.
const ENOUGH: usize = 100;

/// Refuses a recording in which a joint's motor and joint side are exchanged, or one has the wrong sign.
///
/// A spring's deflection `y` follows what moves with the joint, `d = Φ z / K` with the described masses `z`. Where the sides are
/// exchanged it follows `−d`, and no tolerance of stiffness or mass leads there. Medians tell: a contact pushes for a part
/// of the time only, and can turn a regression round.
pub(super) fn check(
    robot: &Robot,
    prior: &Prior,
    recorded: &Recorded,
    name: &str,
) -> Result<(), EstimateError> {
    let springs = recorded.elastic.iter().filter_map(|&i| {
        let turned_share = turned_share(prior, recorded, i)?;
        (turned_share < OPPOSED).then(|| OpposedSpring {
            joint: robot.joint_names()[i].clone(),
            turned_share,
        })
    });
    let springs: Vec<OpposedSpring> = springs.collect();
    match springs.is_empty() {
        true => Ok(()),
        false => Err(EstimateError::Sides {
            file: name.into(),
            fault: SidesFault::Opposed { springs },
        }),
    }
}

/// Spread of `y + d` over that of `y − d`; `None` where `d` hardly changes.
fn turned_share(prior: &Prior, recorded: &Recorded, joint: usize) -> Option<f64> {
    let described = prior.described_deflections_rad(&recorded.blocks, joint);
    if described.len() < ENOUGH || !(spread(described.clone()) > LOADED_RAD) {
        return None;
    }
    let about = |sign: f64| {
        let pairs = recorded.blocks.iter().zip(&described);
        spread(pairs.map(|(b, d)| b.y[joint] + sign * d).collect())
    };
    Some(about(1.0) / about(-1.0))
}

/// Median distance from the median; NaN of nothing.
fn spread(mut values: Vec<f64>) -> f64 {
    let median = |values: &mut Vec<f64>| upper_median(values).unwrap_or(f64::NAN);
    let middle = median(&mut values);
    values.iter_mut().for_each(|x| *x = (*x - middle).abs());
    median(&mut values)
}
