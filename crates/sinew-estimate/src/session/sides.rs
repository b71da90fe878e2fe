//! Detection of exchanged motor and joint sides, of constant motor positions, of wrong signs, units and gear ratios.

use super::frozen_encoder;
use super::recorder::Recorded;
use crate::error::{EstimateError, OpposedSpring, SidesFault};
use sinew_log::{MotorRatio, RatioSums};
use sinew_model::offset::{Block, Payload, PayloadRange, Prior};
use sinew_model::robot::Robot;
use sinew_model::statistics::upper_median;
use sinew_model::tendons::Routings;

/// Minimum spread of the deflection expected from the robot description for its sign to be tested, rad: median distance
/// from the median.
const MIN_EXPECTED_SPREAD_RAD: f64 = 5e-3;
/// Maximum ratio of the spread about the reversed expectation to the spread about the expectation for exchanged sides.
///
/// With correct sides the minimum was 1.26 in about 2,100 recordings and joints with pushes, payloads, slips and wrong
/// masses; with exchanged sides the maximum was 0.66. In one of 2,000 further cases a load behind a light last link
/// reversed the spring of that link (0.55); the possible payload is therefore considered first.
const MAX_REVERSED_RATIO: f64 = 0.7;
/// Minimum number of blocks: contacts may last as long as a shorter recording. One recording of 46 blocks had a ratio
/// of 0.62.
const MIN_BLOCKS: usize = 100;

/// Checks that no joint has positions in degrees.
///
/// # Errors
/// Returns [`EstimateError::Sides`] with the joints whose both sides exceed the limits by more than a turn, and are within
/// the limits as degrees. A joint whose transmission is lost swings freely, but its motor does not.
fn check_units(robot: &Robot, recorded: &Recorded, name: &str) -> Result<(), EstimateError> {
    const TURN_RAD: f64 = std::f64::consts::TAU;
    let in_degrees = recorded.elastic.iter().filter_map(|&i| {
        let limits = robot.limits.get(i)?;
        let range = |of: &dyn Fn(&Block) -> Option<f64>| {
            let positions = recorded.blocks.iter().filter_map(of);
            positions.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| {
                [a.min(x), b.max(x)]
            })
        };
        let is_degrees = |[low, high]: [f64; 2]| {
            let is_beyond = high > limits.upper + TURN_RAD || low < limits.lower - TURN_RAD;
            is_beyond && low.to_radians() > limits.lower && high.to_radians() < limits.upper
        };
        let joint = range(&|block| block.turned.get(i).copied());
        let motor = range(&|block| Some(block.turned.get(i)? + block.y.get(i)?));
        let is_limited = (limits.upper - limits.lower).is_finite();
        let are_degrees = is_limited && is_degrees(joint) && is_degrees(motor);
        are_degrees.then(|| (robot.tendon_name(i).to_owned(), joint))
    });
    let joints: Vec<(String, [f64; 2])> = in_degrees.collect();
    match joints.is_empty() {
        true => Ok(()),
        false => Err(EstimateError::Sides {
            file: name.into(),
            fault: SidesFault::Degrees { joints },
        }),
    }
}

/// Checks that no motor position is constant in the whole recording while its joint moves.
///
/// # Errors
/// Returns [`EstimateError::Sides`] with the motors.
fn check_constant_motors(
    robot: &Robot,
    recorded: &Recorded,
    name: &str,
) -> Result<(), EstimateError> {
    let motors = frozen_encoder::constant_motors(robot, recorded);
    match motors.is_empty() {
        true => Ok(()),
        false => Err(EstimateError::Sides {
            file: name.into(),
            fault: SidesFault::ConstantMotor { motors },
        }),
    }
}

/// Checks that no motor moves by a multiple of its joint other than one.
///
/// # Errors
/// Returns [`EstimateError::Sides`] with the ratios.
fn check_ratios(robot: &Robot, recorded: &Recorded, name: &str) -> Result<(), EstimateError> {
    // A tendon that crosses several joints has no ratio to one of them.
    if Routings::of(&robot.transmissions).is_some() {
        return Ok(());
    }
    let ratios = recorded.elastic.iter().filter_map(|&i| {
        let mut sums = RatioSums::default();
        for block in &recorded.blocks {
            sums.push(block.turned[i], block.turned[i] + block.y[i]);
        }
        let held_rad = frozen_encoder::held_travel_rad(robot, i);
        sums.implausible(robot.tendon_name(i), held_rad)
    });
    let ratios: Vec<MotorRatio> = ratios.collect();
    match ratios.is_empty() {
        true => Ok(()),
        false => Err(EstimateError::Sides {
            file: name.into(),
            fault: SidesFault::Ratio { ratios },
        }),
    }
}

/// Checks that no two motors are exchanged: each would follow the joint of the other.
///
/// # Errors
/// Returns [`EstimateError::Sides`] with the joints.
fn check_swapped_motors(
    robot: &Robot,
    recorded: &Recorded,
    name: &str,
) -> Result<(), EstimateError> {
    // A motor that moves several joints follows none of them.
    if Routings::of(&robot.transmissions).is_some() {
        return Ok(());
    }
    let follows = |motor: usize, joint: usize| {
        let mut sums = RatioSums::default();
        for block in &recorded.blocks {
            sums.push(block.turned[joint], block.turned[motor] + block.y[motor]);
        }
        sums.is_direct()
    };
    let lost = recorded.elastic.iter().filter(|&&i| !follows(i, i));
    let lost: Vec<usize> = lost.copied().collect();
    let mut pairs = Vec::new();
    for (k, &i) in lost.iter().enumerate() {
        let mut others = lost.iter().skip(k + 1);
        if let Some(&other) = others.find(|&&j| follows(i, j) && follows(j, i)) {
            pairs.push([i, other].map(|j| robot.tendon_name(j).to_owned()));
        }
    }
    match pairs.is_empty() {
        true => Ok(()),
        false => Err(EstimateError::Sides {
            file: name.into(),
            fault: SidesFault::SwappedMotors { pairs },
        }),
    }
}

/// Checks that no position has a wrong unit, gear ratio or sign, and that no motors are exchanged, before any block is
/// excluded: a transmission that is lost has no constant ratio.
///
/// # Errors
/// Returns [`EstimateError::Sides`] with the ratios, the positions in degrees, or the exchanged motors.
pub(super) fn check_scales(
    robot: &Robot,
    recorded: &Recorded,
    name: &str,
) -> Result<(), EstimateError> {
    check_ratios(robot, recorded, name)?;
    check_units(robot, recorded, name)?;
    check_swapped_motors(robot, recorded, name)
}

/// Checks that no joint has exchanged motor and joint sides, a wrong sign, or a constant motor position.
///
/// The deflection `y` of a spring follows the load of the joint, `d = Φ z / K` with the described masses `z`. With
/// exchanged sides it follows `−d`, which no tolerance of stiffness or mass explains, nor any possible payload. The
/// check uses medians, because a contact is present for part of the time only but can reverse the sign of a regression.
///
/// # Errors
/// Returns [`EstimateError::Sides`] with the constant motor positions or the reversed springs.
pub(super) fn check(
    robot: &Robot,
    prior: &Prior,
    recorded: &Recorded,
    payload: Payload,
    name: &str,
) -> Result<(), EstimateError> {
    check_constant_motors(robot, recorded, name)?;
    let held = prior.payload_range(payload);
    let is_excluded = |i: usize| recorded.blocks.iter().any(|b| b.y[i].is_nan());
    let intact = recorded.elastic.iter().filter(|&&i| !is_excluded(i));
    let springs = intact.filter_map(|&i| {
        let turned_share = reversed_ratio(prior, recorded, i, held)?;
        if turned_share >= MAX_REVERSED_RATIO {
            return None;
        }
        Some(OpposedSpring {
            joint: robot.tendon_name(i).to_owned(),
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

/// Ratio of the spread of `y + d` to that of `y − d`, each minimised over the possible payload.
///
/// `None` if `d` with an empty gripper hardly varies, or if the described masses with a possible payload explain most of
/// `y` without a reversal: behind the last joints a load can give the spring either direction.
fn reversed_ratio(
    prior: &Prior,
    recorded: &Recorded,
    joint: usize,
    held: Option<PayloadRange>,
) -> Option<f64> {
    let described = prior.described_deflections_rad(&recorded.blocks, joint);
    let alone = described.iter().map(|[alone, ..]| *alone).collect();
    if described.len() < MIN_BLOCKS || !(spread(alone) > MIN_EXPECTED_SPREAD_RAD) {
        return None;
    }
    let y: Vec<f64> = recorded.blocks.iter().map(|b| b.y[joint]).collect();
    let spreads = |held: Option<PayloadRange>| {
        [-1.0, 1.0].map(|sign| least_spread(&y, &described, sign, held))
    };
    let [turned, as_it_is] = spreads(None);
    let empty = turned / as_it_is;
    if held.is_none() || empty >= MAX_REVERSED_RATIO {
        return Some(empty);
    }
    let [turned, as_it_is] = spreads(held);
    (as_it_is > MIN_RESIDUAL_RATIO * spread(y.clone())).then(|| turned / as_it_is)
}

/// Minimum spread of the residual of `y` relative to the spread of `y` for a reversed spring, which has a ratio of 2.
const MIN_RESIDUAL_RATIO: f64 = 0.5;

/// Number of unknowns: a constant, and mass and first moments of the payload.
const UNKNOWNS: usize = 5;

/// Minimum spread of `y − sign (d + X p)` over the possible payload `p`, by robust least squares within its range;
/// outlying blocks are down-weighted.
fn least_spread(
    y: &[f64],
    described: &[[f64; UNKNOWNS]],
    sign: f64,
    held: Option<PayloadRange>,
) -> f64 {
    /// Number of iterations of the weights.
    const ROUNDS: usize = 10;
    /// Number of coordinate-descent sweeps over the unknowns per iteration.
    const SWEEPS: usize = 100;
    /// Scale of the robust weight, in median distances from the median.
    const SCALE: f64 = 3.0;
    // Constant, then mass and first moments of the payload.
    let mut x = [0.0; UNKNOWNS];
    let residuals_of = |x: &[f64; UNKNOWNS]| -> Vec<f64> {
        let rows = y.iter().zip(described);
        let [constant, load @ ..] = x;
        rows.map(|(y, [alone, more @ ..])| {
            let held: f64 = more.iter().zip(load).map(|(d, p)| d * p).sum();
            y - sign * (alone + held) - constant
        })
        .collect()
    };
    let mut least = spread(residuals_of(&x));
    let Some(held) = held else {
        return least;
    };
    let [low_kg, high_kg] = held.mass_kg;
    let most = held.moment_kg_m;
    let wide = f64::INFINITY;
    let low = [-wide, low_kg, -most, -most, -most];
    let high = [wide, high_kg, most, most, most];
    for (x, (low, high)) in x.iter_mut().zip(low.into_iter().zip(high)) {
        *x = x.clamp(low, high);
    }
    for _ in 0..ROUNDS {
        let residuals = residuals_of(&x);
        let scale = SCALE * spread(residuals.clone());
        let (mut information, mut pull) = ([[0.0; UNKNOWNS]; UNKNOWNS], [0.0; UNKNOWNS]);
        for (residual, [_, more @ ..]) in residuals.iter().zip(described) {
            let weight = 1.0 / (1.0 + (residual / scale).powi(2));
            let [a, b, c, d] = more.map(|d| sign * d);
            let row = [1.0, a, b, c, d];
            for (i, own) in row.iter().enumerate() {
                pull[i] += weight * own * residual;
                for (to, other) in information[i].iter_mut().zip(row) {
                    *to += weight * own * other;
                }
            }
        }
        let from = x;
        for _ in 0..SWEEPS {
            for i in 0..UNKNOWNS {
                let moved = x.iter().zip(from).map(|(x, from)| x - from);
                let taken: f64 = information[i].iter().zip(moved).map(|(a, m)| a * m).sum();
                if information[i][i] > 0.0 {
                    let step = (pull[i] - taken) / information[i][i];
                    x[i] = (x[i] + step).clamp(low[i], high[i]);
                }
            }
        }
        least = least.min(spread(residuals_of(&x)));
    }
    least
}

/// Median distance from the median; NaN for an empty list.
fn spread(mut values: Vec<f64>) -> f64 {
    let median = |values: &mut Vec<f64>| upper_median(values).unwrap_or(f64::NAN);
    let middle = median(&mut values);
    values.iter_mut().for_each(|x| *x = (*x - middle).abs());
    median(&mut values)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Blocks of a joint with the payload `p` in addition to the described masses; 10 % of them are in contact.
    fn blocks(p: [f64; 4], turned: f64) -> (Vec<f64>, Vec<[f64; UNKNOWNS]>) {
        let wave = |k: usize, rate: f64| (rate * k as f64).sin();
        let described: Vec<[f64; UNKNOWNS]> = (0..400)
            .map(|k| {
                [
                    0.02 * wave(k, 0.11),
                    0.05 * wave(k, 0.11),
                    0.3 * wave(k, 0.11),
                    0.3 * wave(k, 0.17),
                    0.01 * wave(k, 0.5),
                ]
            })
            .collect();
        let y = described.iter().enumerate().map(|(k, [alone, more @ ..])| {
            let held: f64 = more.iter().zip(p).map(|(d, p)| d * p).sum();
            let pushed = if k % 10 == 0 { 0.1 } else { 0.0 };
            turned * (alone + held) + 0.003 + pushed + 2e-4 * wave(k, 7.7)
        });
        (y.collect(), described)
    }

    // A load behind the joint reverses its spring. A payload range that contains the load explains it, an empty gripper
    // does not.
    #[test]
    fn least_spread_finds_payload_within_range() {
        let range = |moment_kg_m: f64| {
            Some(PayloadRange {
                mass_kg: [0.0, 0.75],
                moment_kg_m,
            })
        };
        let (y, described) = blocks([0.4, -0.3, 0.06, 0.0], 1.0);
        let spread = |held| [-1.0, 1.0].map(|sign| least_spread(&y, &described, sign, held));
        let [turned, as_it_is] = spread(None);
        assert!(
            turned < MAX_REVERSED_RATIO * as_it_is,
            "{turned} {as_it_is}"
        );
        let [turned, as_it_is] = spread(range(0.4));
        assert!(as_it_is < 3e-4, "{as_it_is}");
        assert!(
            turned > MAX_REVERSED_RATIO * as_it_is,
            "{turned} {as_it_is}"
        );
        // A load outside the payload range is not explained.
        let [_, as_it_is] = spread(range(0.02));
        assert!(as_it_is > 3e-3, "{as_it_is}");
    }

    #[test]
    fn least_spread_light_payload_keeps_reversed_spring() {
        let held = Some(PayloadRange {
            mass_kg: [0.0, 0.1],
            moment_kg_m: 0.005,
        });
        let (y, described) = blocks([0.0; 4], -1.0);
        let [turned, as_it_is] = [-1.0, 1.0].map(|sign| least_spread(&y, &described, sign, held));
        assert!(turned < 0.1 * as_it_is, "{turned} {as_it_is}");
    }
}
