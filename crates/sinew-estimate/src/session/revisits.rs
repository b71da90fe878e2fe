//! How often the arm went through the same motion.

use sinew_model::offset::Block;

/// Two blocks are of the same motion where every joint is as near as this, rad, and what it turns in a tenth of a
/// second: blocks of one round lie between those of another.
const NEAR_RAD: f64 = 0.05;
const BETWEEN_S: f64 = 0.1;
/// And as fast, rad/s, with a share of the speed.
const LIKE_RAD_PER_S: f64 = 0.2;
const LIKE_SHARE: f64 = 0.3;
/// Blocks nearer in time are of one visit, s.
const APART_S: f64 = 2.0;
/// Places that are remembered; beyond them nothing is counted.
const MOST: usize = 4000;

/// A place the arm came by, with the way it moved.
struct Place {
    block: usize,
    last_s: f64,
    visits: f64,
}

/// How often the arm came by as in each block, all visits of the recording counted.
pub(super) fn visits(blocks: &[Block]) -> Vec<f64> {
    let mut places: Vec<Place> = Vec::new();
    let own: Vec<Option<usize>> = (blocks.iter().enumerate())
        .map(|(b, block)| {
            let known = places
                .iter()
                .position(|p| are_alike(way(&blocks[p.block]), way(block)));
            if let Some(place) = known {
                let found = &mut places[place];
                if block.time_s - found.last_s > APART_S {
                    found.visits += 1.0;
                }
                found.last_s = block.time_s;
                return known;
            }
            (places.len() < MOST).then(|| {
                places.push(Place {
                    block: b,
                    last_s: block.time_s,
                    visits: 1.0,
                });
                places.len() - 1
            })
        })
        .collect();
    let of = |place: Option<usize>| place.map_or(1.0, |place| places[place].visits);
    own.into_iter().map(of).collect()
}

/// Places and speeds of a block, rad and rad/s.
fn way(block: &Block) -> [&[f64]; 2] {
    [&block.q, &block.dq]
}

/// Whether all joints are at the same place and move alike.
fn are_alike([qa, va]: [&[f64]; 2], [qb, vb]: [&[f64]; 2]) -> bool {
    let (places, speeds) = (qa.iter().zip(qb), va.iter().zip(vb));
    places.zip(speeds).all(|((qa, qb), (va, vb))| {
        let speed = va.abs().max(vb.abs());
        (qa - qb).abs() <= NEAR_RAD + BETWEEN_S * speed
            && (va - vb).abs() <= LIKE_RAD_PER_S + LIKE_SHARE * speed
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: 0.05 rad and what is turned in a tenth of a second; 0.2 rad/s and three tenths of the faster one.
    #[test]
    fn blocks_of_one_motion_are_as_near_and_as_fast() {
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
            let (places, speeds) = ([[0.3, 0.0], [0.3, q]], [[0.0, dq], [0.0, other]]);
            let [a, b] = [0, 1].map(|k| [places[k].as_slice(), speeds[k].as_slice()]);
            assert_eq!(are_alike(a, b), are, "{q} {dq} {other}");
            assert_eq!(are_alike(b, a), are, "{q} {dq} {other}");
        }
    }
}
