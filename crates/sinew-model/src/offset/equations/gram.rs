//! Information of many blocks' equations: sums of products of rows, sixteen rows at a time.
//!
//! Rows are collected in panels of four columns, so that a tile of 4 × 4 sums remains in registers while the panel is
//! processed. Otherwise most of the time is spent on reading and writing the sums for every row. A row is determined
//! by the joint's own entries and the joint's torque,
//!
//! ```text
//! h = (own, gain · carried),   Σ w hᵀ h = | Σ w ownᵀ own                        |
//!                                          | Σ carriedᵀ (w gain own)   Σ w gain² carriedᵀ carried |
//! ```
//!
//! so that link and motor row of a block share all but the first. A change of an entry has the column of that entry
//! from the time of the change, so that it has the same sums over the later blocks.

use super::equation::{Active, Equation, Equations, width};
use crate::offset::change::{ChangeKind, ChangePoint};
use crate::offset::effects::{JointParameter as P, PER_JOINT, entries};
use crate::offset::layout::Layout;
use crate::tile::{TILE, Tile, lower, products};
use alloc::vec::Vec;

/// Rows that are held back.
const HELD: usize = 16;
/// Entries of a joint that only the link row has, `Zero` aside, which has the column of `Offset`; that both rows have; that only
/// the motor row has.
const LINK_ALONE: usize = entries(true, false).1 - 1;
const BOTH: usize = entries(true, true).1;
/// Parameters of a joint: those of the link equation only, of both equations, and of the motor equation only.
const OWN_PARAMETERS: [usize; PER_JOINT - 1] = {
    let (mut own, mut count) = ([0; PER_JOINT - 1], 0);
    let parts = [
        entries(true, false),
        entries(true, true),
        entries(false, true),
    ];
    let mut part = 0;
    while part < parts.len() {
        let (places, of_part) = parts[part];
        let mut k = 0;
        while k < of_part {
            if places[k] != P::Zero as usize {
                own[count] = places[k];
                count += 1;
            }
            k += 1;
        }
        part += 1;
    }
    own
};
/// Tiles of the link row, of the motor row, of both.
const LINK: core::ops::Range<usize> = 0..(LINK_ALONE + BOTH).div_ceil(TILE);
const MOTOR: core::ops::Range<usize> = LINK_ALONE / TILE..OWN_TILES;
const OWN_TILES: usize = OWN_PARAMETERS.len().div_ceil(TILE);

/// A joint's own entries in the order of [`OWN_PARAMETERS`].
type Own = [[f64; TILE]; OWN_TILES];

/// Rows not yet added, and the sums of all earlier rows.
#[derive(Debug, Clone)]
pub(crate) struct Gram {
    layout: Layout,
    joints: Vec<JointGram>,
    /// `Σ w gain² carriedᵀ carried`, the lower half.
    square: Vec<Tile>,
    /// Changes that have happened by the blocks in it.
    active: Vec<Active>,
    empty: bool,
}

#[derive(Debug, Clone)]
struct JointGram {
    held: usize,
    /// First tile of bodies the joint carries, of the rows held back.
    first: usize,
    link: Panel,
    motor: Panel,
    /// Times their information.
    link_weighed: Panel,
    motor_weighed: Panel,
    /// Sums `Σ w gain own` of link and motor.
    along: Panel,
    carried: Panel,
    carried_weighed: Panel,
    /// `Σ w ownᵀ own`, the lower half.
    own: Vec<Tile>,
    /// `Σ carriedᵀ (w gain own)`.
    mixed: Vec<Tile>,
}

/// Columns of the rows held back, by fours.
#[derive(Debug, Clone)]
struct Panel(Vec<[f64; TILE]>);

impl Panel {
    fn new(tiles: usize) -> Self {
        Self(alloc::vec![[0.0; TILE]; tiles * HELD])
    }

    fn put(&mut self, row: usize, tiles: &[[f64; TILE]], factor: f64) {
        for (to, tile) in self.0.iter_mut().skip(row).step_by(HELD).zip(tiles) {
            *to = tile.map(|x| factor * x);
        }
    }

    fn put_slice(&mut self, row: usize, values: &[f64], factor: f64) {
        let lanes = self.0.iter_mut().skip(row).step_by(HELD);
        for (to, values) in lanes.zip(values.chunks(TILE)) {
            for (to, x) in to.iter_mut().zip(values) {
                *to = factor * x;
            }
        }
    }

    fn rows(&self, tile: usize, held: usize) -> &[[f64; TILE]] {
        &self.0[tile * HELD..tile * HELD + held]
    }
}

/// `sum += Σ aᵀ b` over rows.
fn add(sum: &mut Tile, a: &[[f64; TILE]], b: &[[f64; TILE]]) {
    let more = products(a, b);
    for (sum, more) in sum.as_flattened_mut().iter_mut().zip(more.as_flattened()) {
        *sum += more;
    }
}

/// Entry of a lower triangle that is stored in tiles.
fn entry(tiles: &[Tile], i: usize, k: usize) -> f64 {
    let (i, k) = (i.max(k), i.min(k));
    tiles[lower(i / TILE, k / TILE)][i % TILE][k % TILE]
}

/// The own entries in the order of [`OWN_PARAMETERS`].
fn own(e: &Equation) -> Own {
    let mut own = Own::default();
    for (to, place) in own.as_flattened_mut().iter_mut().zip(OWN_PARAMETERS) {
        *to = e.own[place];
    }
    own
}

impl Gram {
    /// Allocates rows for these changes.
    pub(crate) fn new(layout: Layout, changes: &[ChangePoint]) -> Self {
        let tiles = width(layout, changes).div_ceil(TILE);
        let (zero, link, motor) = ([[0.0; TILE]; TILE], LINK.len(), MOTOR.len());
        let joint = JointGram {
            held: 0,
            first: tiles,
            link: Panel::new(link),
            motor: Panel::new(motor),
            link_weighed: Panel::new(link),
            motor_weighed: Panel::new(motor),
            along: Panel::new(OWN_TILES),
            carried: Panel::new(tiles),
            carried_weighed: Panel::new(tiles),
            own: alloc::vec![zero; lower(OWN_TILES, 0)],
            mixed: alloc::vec![zero; tiles * OWN_TILES],
        };
        Self {
            layout,
            joints: alloc::vec![joint; layout.joints],
            square: alloc::vec![zero; lower(tiles, 0)],
            active: Vec::new(),
            empty: true,
        }
    }

    /// Whether a block of these equations can be added to the preceding blocks, because no change lies between them.
    pub(crate) fn continues(&self, equations: &Equations) -> bool {
        self.empty || self.active == equations.active()
    }

    /// Adds the equations of a block, each with its information.
    pub(crate) fn add(&mut self, equations: &Equations, information: impl Fn(&Equation) -> f64) {
        if self.empty {
            self.active.clear();
            self.active.extend_from_slice(equations.active());
            self.empty = false;
        }
        let mut rest = equations.list.as_slice();
        while let Some((link, others)) = rest.split_first() {
            let motor = others.first().filter(|e| e.joint == link.joint);
            rest = &others[usize::from(motor.is_some())..];
            let joint = &mut self.joints[link.joint];
            joint.hold(
                (link, information(link)),
                motor.map(|e| (e, information(e))),
                equations.row(link.joint),
            );
            if joint.held == HELD {
                joint.sum(&mut self.square);
            }
        }
    }

    /// Moves all sums to the information of the state, the lower triangle of a matrix of `total` columns.
    pub(crate) fn move_to(&mut self, information: &mut [f64], total: usize) {
        let mut to = |i: usize, k: usize, value: f64| {
            information[i.max(k) * total + i.min(k)] += value;
        };
        let bodies = self.layout.bodies;
        let mut carried: Vec<(usize, usize)> = self.layout.carried().enumerate().collect();
        for &Active { first, kind, .. } in &self.active {
            let from = match kind {
                ChangeKind::Payload => bodies,
                ChangeKind::Force => self.layout.carried().len(),
                _ => continue,
            };
            carried.extend((0..kind.columns()).map(|k| (from + k, first + k)));
        }
        let mut own = Vec::new();
        for (i, joint) in self.joints.iter_mut().enumerate() {
            joint.sum(&mut self.square);
            let start = self.layout.own(i).start;
            own.clear();
            let entries = OWN_PARAMETERS.into_iter().enumerate();
            own.extend(entries.map(|(k, at)| (k, start + at, 1.0)));
            own.push((OFFSET, start + P::Zero as usize, 1.0));
            for active in &self.active {
                let k = match active.kind {
                    ChangeKind::Offset(joint) | ChangeKind::Creep(joint) if joint == i => OFFSET,
                    ChangeKind::Compliance(joint) if joint == i => COMPLIANCE,
                    _ => continue,
                };
                own.push((k, active.first, active.factor));
            }
            for &(k, at_k, factor) in &own {
                for &(j, at_j, other) in own.iter().filter(|(_, at, _)| *at <= at_k) {
                    to(at_k, at_j, factor * other * entry(&joint.own, k, j));
                }
                for &(j, at_j) in &carried {
                    let tile = &joint.mixed[j / TILE * OWN_TILES + k / TILE];
                    to(at_j, at_k, factor * tile[j % TILE][k % TILE]);
                }
            }
            joint.own.as_flattened_mut().as_flattened_mut().fill(0.0);
            joint.mixed.as_flattened_mut().as_flattened_mut().fill(0.0);
        }
        for &(k, at_k) in &carried {
            for &(j, at_j) in carried.iter().filter(|(_, at)| *at <= at_k) {
                to(at_k, at_j, entry(&self.square, k, j));
            }
        }
        self.square.as_flattened_mut().as_flattened_mut().fill(0.0);
        self.empty = true;
    }
}

impl JointGram {
    /// Holds back the rows of a block.
    fn hold(
        &mut self,
        (link, w0): (&Equation, f64),
        motor: Option<(&Equation, f64)>,
        carried: &[f64],
    ) {
        let row = self.held;
        let mut along = Own::default();
        let mut squared = 0.0;
        let mut with = |rows: &Own, weight: f64, gain: f64| {
            let factor = weight * gain;
            for (to, x) in along.as_flattened_mut().iter_mut().zip(rows.as_flattened()) {
                *to += factor * x;
            }
            squared += factor * gain;
        };
        let rows = own(link);
        with(&rows, w0, link.torque_gain);
        self.link.put(row, &rows[LINK], 1.0);
        self.link_weighed.put(row, &rows[LINK], w0);
        // Without a motor equation, an empty row is used.
        let (rows, w1) = match motor {
            Some((motor, w1)) => {
                let rows = own(motor);
                with(&rows, w1, motor.torque_gain);
                (rows, w1)
            }
            None => (Own::default(), 0.0),
        };
        self.motor.put(row, &rows[MOTOR], 1.0);
        self.motor_weighed.put(row, &rows[MOTOR], w1);
        self.along.put(row, &along, 1.0);
        self.carried.put_slice(row, carried, 1.0);
        self.carried_weighed.put_slice(row, carried, squared);
        // Bodies closer to the base do not affect this joint.
        let first = carried.iter().position(|x| *x != 0.0);
        self.first = self.first.min(first.unwrap_or(carried.len()) / TILE);
        self.held += 1;
    }

    /// Adds the collected rows to the sums.
    fn sum(&mut self, square: &mut [Tile]) {
        let held = self.held;
        for (tiles, a, b) in [
            (LINK, &self.link_weighed, &self.link),
            (MOTOR, &self.motor_weighed, &self.motor),
        ] {
            for i in 0..tiles.len() {
                for k in 0..=i {
                    let to = &mut self.own[lower(tiles.start + i, tiles.start + k)];
                    add(to, a.rows(i, held), b.rows(k, held));
                }
            }
        }
        let tiles = self.mixed.len() / OWN_TILES;
        for i in self.first..tiles {
            let carried = self.carried.rows(i, held);
            let mixed = &mut self.mixed[i * OWN_TILES..];
            for (k, to) in mixed.iter_mut().take(OWN_TILES).enumerate() {
                add(to, carried, self.along.rows(k, held));
            }
            for k in self.first..=i {
                let to = &mut square[lower(i, k)];
                add(to, carried, self.carried_weighed.rows(k, held));
            }
        }
        self.held = 0;
        self.first = tiles;
    }
}

/// Places in [`OWN_PARAMETERS`] that changes add to.
const OFFSET: usize = 0;
const COMPLIANCE: usize = 1;
const _: () = assert!(
    OWN_PARAMETERS[OFFSET] == P::Offset as usize
        && OWN_PARAMETERS[COMPLIANCE] == P::Compliance as usize
);
