//! Whether motor and joint side stand in each other's place.

use super::recorder::Recorded;
use crate::error::{EstimateError, OpposedSpring, SidesFault};
use sinew_model::offset::{Payload, PointMass, Prior};
use sinew_model::robot::Robot;
use sinew_model::statistics::upper_median;

/// The deflection that the description expects must spread by more for its sign to be told, rad: half of the blocks
/// lie farther from its median.
const LOADED_RAD: f64 = 5e-3;
/// Spread about the turned expectation over that about the expectation. Where sides are right the least was 1.26 of some 2,100 recordings
/// and joints, with pushes, payloads, slips and wrong masses; where they were exchanged the most was 0.66. A load that was
/// held behind a light last link turned that link's spring round in one of 2,000 more, 0.55: so what may be held is asked first.
const OPPOSED: f64 = 0.7;
/// Fewer blocks tell nothing: contacts may last as long. One of 46 blocks had a share of 0.62.
const ENOUGH: usize = 100;

/// Refuses a recording in which a joint's motor and joint side are exchanged, or one has the wrong sign.
///
/// A spring's deflection `y` follows what moves with the joint, `d = Φ z / K` with the described masses `z`. Where the sides are
/// exchanged it follows `−d`, and no tolerance of stiffness or mass leads there, nor anything that the gripper may hold. Medians
/// tell: a contact pushes for a part of the time only, and can turn a regression round.
pub(super) fn check(
    robot: &Robot,
    prior: &Prior,
    recorded: &Recorded,
    payload: Payload,
    name: &str,
) -> Result<(), EstimateError> {
    let held = prior.payload_range(payload);
    let springs = recorded.elastic.iter().filter_map(|&i| {
        let turned_share = turned_share(prior, recorded, i, &held)?;
        if turned_share >= OPPOSED {
            return None;
        }
        Some(OpposedSpring {
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

/// Spread of `y + d` over that of `y − d`, each with what the gripper may hold that makes it least; `None` where `d` of an
/// empty one hardly changes.
fn turned_share(
    prior: &Prior,
    recorded: &Recorded,
    joint: usize,
    held: &[PointMass],
) -> Option<f64> {
    let mut least = [f64::INFINITY; 2];
    for (k, held) in held.iter().enumerate() {
        let described = prior.described_deflections_rad(&recorded.blocks, joint, *held);
        if k == 0 && (described.len() < ENOUGH || !(spread(described.clone()) > LOADED_RAD)) {
            return None;
        }
        for (least, sign) in least.iter_mut().zip([1.0, -1.0]) {
            let pairs = recorded.blocks.iter().zip(&described);
            *least = least.min(spread(pairs.map(|(b, d)| b.y[joint] + sign * d).collect()));
        }
        // Right, whatever it holds.
        let [turned, as_it_is] = least;
        if k == 0 && turned >= OPPOSED * as_it_is {
            break;
        }
    }
    let [turned, as_it_is] = least;
    Some(turned / as_it_is)
}

/// Median distance from the median; NaN of nothing.
fn spread(mut values: Vec<f64>) -> f64 {
    let median = |values: &mut Vec<f64>| upper_median(values).unwrap_or(f64::NAN);
    let middle = median(&mut values);
    values.iter_mut().for_each(|x| *x = (*x - middle).abs());
    median(&mut values)
}
