//! Number of repetitions of each motion in a recording.

use sinew_model::offset::Block;

/// Maximum position difference of every joint between two blocks of the same motion, rad.
///
/// The travel of the joint in [`MAX_TIME_DIFFERENCE_S`] is added, because the blocks of one round lie between those of
/// another.
const MAX_POSITION_DIFFERENCE_RAD: f64 = 0.05;
/// Maximum time shift between the blocks of two rounds, s: half of a block.
const MAX_TIME_DIFFERENCE_S: f64 = 0.1;
/// Maximum velocity difference between two blocks of the same motion at rest, rad/s.
const MAX_VELOCITY_DIFFERENCE_RAD_PER_S: f64 = 0.2;
/// Share of the larger speed that is added to the maximum velocity difference.
const VELOCITY_DIFFERENCE_RATIO: f64 = 0.3;
/// Minimum time between two visits, s: blocks closer in time belong to one visit.
const MIN_REVISIT_TIME_S: f64 = 2.0;
/// Maximum number of distinct motions; blocks of further ones count as one visit.
const MAX_MOTIONS: usize = 4000;

/// Motion of the arm in one block, with the number of visits.
struct Motion {
    block: usize,
    last_s: f64,
    visits: f64,
}

/// Returns, for each block, the number of visits of its motion in the whole recording.
pub(super) fn visits(blocks: &[Block]) -> Vec<f64> {
    let mut motions: Vec<Motion> = Vec::new();
    let own: Vec<Option<usize>> = (blocks.iter().enumerate())
        .map(|(b, block)| {
            let index = motions
                .iter()
                .position(|p| is_same_motion(state(&blocks[p.block]), state(block)));
            if let Some(k) = index {
                let found = &mut motions[k];
                if block.time_s - found.last_s > MIN_REVISIT_TIME_S {
                    found.visits += 1.0;
                }
                found.last_s = block.time_s;
                return index;
            }
            (motions.len() < MAX_MOTIONS).then(|| {
                motions.push(Motion {
                    block: b,
                    last_s: block.time_s,
                    visits: 1.0,
                });
                motions.len() - 1
            })
        })
        .collect();
    let of = |index: Option<usize>| index.map_or(1.0, |k| motions[k].visits);
    own.into_iter().map(of).collect()
}

/// Joint positions (rad) and velocities (rad/s) of a block.
fn state(block: &Block) -> [&[f64]; 2] {
    [&block.q, &block.dq]
}

/// Whether positions and velocities of all joints agree within the limits above.
fn is_same_motion([qa, va]: [&[f64]; 2], [qb, vb]: [&[f64]; 2]) -> bool {
    let (positions, speeds) = (qa.iter().zip(qb), va.iter().zip(vb));
    positions.zip(speeds).all(|((qa, qb), (va, vb))| {
        let speed = va.abs().max(vb.abs());
        (qa - qb).abs() <= MAX_POSITION_DIFFERENCE_RAD + MAX_TIME_DIFFERENCE_S * speed
            && (va - vb).abs()
                <= MAX_VELOCITY_DIFFERENCE_RAD_PER_S + VELOCITY_DIFFERENCE_RATIO * speed
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    // Analytic limits: 0.05 rad plus the travel in 0.1 s; 0.2 rad/s plus 30 % of the larger speed.
    #[test]
    fn is_same_motion_compares_position_and_velocity() {
        for (q, dq, other, are) in [
            (0.049, 0.0, 0.0, true),
            (0.051, 0.0, 0.0, false),
            (0.149, 1.0, 1.0, true),
            (0.151, 1.0, 1.0, false),
            (-0.149, -1.0, -1.0, true),
            (-0.249, -2.0, -2.0, true),
            (0.0, 0.0, 0.285, true),
            (0.0, 0.0, 0.287, false),
            (0.0, 2.0, 1.21, true),
            (0.0, 2.0, 1.19, false),
            (0.0, 0.2, -0.2, false),
        ] {
            let (positions, speeds) = ([[0.3, 0.0], [0.3, q]], [[0.0, dq], [0.0, other]]);
            let [a, b] = [0, 1].map(|k| [positions[k].as_slice(), speeds[k].as_slice()]);
            assert_eq!(is_same_motion(a, b), are, "{q} {dq} {other}");
            assert_eq!(is_same_motion(b, a), are, "{q} {dq} {other}");
        }
    }
}
