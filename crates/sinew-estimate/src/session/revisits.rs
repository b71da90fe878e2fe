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
                .position(|p| are_alike(&blocks[p.block], block));
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

/// Whether all joints are at the same place and move alike.
fn are_alike(a: &Block, b: &Block) -> bool {
    let places = a.q.iter().zip(&b.q);
    let speeds = a.dq.iter().zip(&b.dq);
    places.zip(speeds).all(|((qa, qb), (va, vb))| {
        let speed = va.abs().max(vb.abs());
        (qa - qb).abs() <= NEAR_RAD + BETWEEN_S * speed
            && (va - vb).abs() <= LIKE_RAD_PER_S + LIKE_SHARE * speed
    })
}
