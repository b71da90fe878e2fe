//! Whether motor and joint side stand in each other's place.

use super::recorder::Recorded;
use crate::error::{EstimateError, OpposedSpring, SidesFault};
use sinew_model::offset::{Payload, PayloadRange, Prior};
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
        let turned_share = turned_share(prior, recorded, i, held)?;
        if turned_share >= OPPOSED {
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

/// Spread of `y + d` over that of `y − d`, each with what the gripper may hold that makes it least; `None` where `d` of an
/// empty one hardly changes, or what is held explains most of `y` as it is: behind the last joints a load turns a spring either way.
fn turned_share(
    prior: &Prior,
    recorded: &Recorded,
    joint: usize,
    held: Option<PayloadRange>,
) -> Option<f64> {
    let described = prior.described_deflections_rad(&recorded.blocks, joint);
    let alone = described.iter().map(|[alone, ..]| *alone).collect();
    if described.len() < ENOUGH || !(spread(alone) > LOADED_RAD) {
        return None;
    }
    let y: Vec<f64> = recorded.blocks.iter().map(|b| b.y[joint]).collect();
    let spreads = |held: Option<PayloadRange>| {
        [-1.0, 1.0].map(|sign| least_spread(&y, &described, sign, held))
    };
    let [turned, as_it_is] = spreads(None);
    let empty = turned / as_it_is;
    if held.is_none() || empty >= OPPOSED {
        return Some(empty);
    }
    let [turned, as_it_is] = spreads(held);
    (as_it_is > EXPLAINED * spread(y.clone())).then(|| turned / as_it_is)
}

/// What is left of `y` must be more than this share of it. Of a spring that is turned round twice of it is left.
const EXPLAINED: f64 = 0.5;

/// Entries of what is held, and what `y` has beside it all.
const UNKNOWNS: usize = 5;

/// Least spread of `y − sign (d + X p)` with what the gripper may hold, `p`: robust least squares within its range, block by block of
/// which one that lies far off has little weight.
fn least_spread(
    y: &[f64],
    described: &[[f64; UNKNOWNS]],
    sign: f64,
    held: Option<PayloadRange>,
) -> f64 {
    /// Until the weights have settled, and until the unknowns have.
    const ROUNDS: usize = 10;
    const SWEEPS: usize = 100;
    /// Scale of the weight, in median distances.
    const SCALE: f64 = 3.0;
    // What lies beside it all, then mass and moments.
    let mut x = [0.0; UNKNOWNS];
    let left = |x: &[f64; UNKNOWNS]| -> Vec<f64> {
        let rows = y.iter().zip(described);
        let [beside, load @ ..] = x;
        rows.map(|(y, [alone, more @ ..])| {
            let held: f64 = more.iter().zip(load).map(|(d, p)| d * p).sum();
            y - sign * (alone + held) - beside
        })
        .collect()
    };
    let mut least = spread(left(&x));
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
        let residuals = left(&x);
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
        least = least.min(spread(left(&x)));
    }
    least
}

/// Median distance from the median; NaN of nothing.
fn spread(mut values: Vec<f64>) -> f64 {
    let median = |values: &mut Vec<f64>| upper_median(values).unwrap_or(f64::NAN);
    let middle = median(&mut values);
    values.iter_mut().for_each(|x| *x = (*x - middle).abs());
    median(&mut values)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Blocks of a joint that carries `p` beside what is described; a tenth of them pushed.
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

    /// A load that is held behind the joint turns its spring round. A range that holds it explains that, and an empty gripper doesn't.
    #[test]
    fn what_is_held_is_found_within_its_range() {
        let range = |moment_kg_m: f64| {
            Some(PayloadRange {
                mass_kg: [0.0, 0.75],
                moment_kg_m,
            })
        };
        let (y, described) = blocks([0.4, -0.3, 0.06, 0.0], 1.0);
        let spread = |held| [-1.0, 1.0].map(|sign| least_spread(&y, &described, sign, held));
        let [turned, as_it_is] = spread(None);
        assert!(turned < OPPOSED * as_it_is, "{turned} {as_it_is}");
        let [turned, as_it_is] = spread(range(0.4));
        assert!(as_it_is < 3e-4, "{as_it_is}");
        assert!(turned > OPPOSED * as_it_is, "{turned} {as_it_is}");
        // Beyond what may be held it isn't explained.
        let [_, as_it_is] = spread(range(0.02));
        assert!(as_it_is > 3e-3, "{as_it_is}");
    }

    #[test]
    fn a_turned_spring_is_turned_whatever_is_held_lightly() {
        let held = Some(PayloadRange {
            mass_kg: [0.0, 0.1],
            moment_kg_m: 0.005,
        });
        let (y, described) = blocks([0.0; 4], -1.0);
        let [turned, as_it_is] = [-1.0, 1.0].map(|sign| least_spread(&y, &described, sign, held));
        assert!(turned < 0.1 * as_it_is, "{turned} {as_it_is}");
    }
}
