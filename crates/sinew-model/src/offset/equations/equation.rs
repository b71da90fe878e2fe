//! Equations of a block: rows with respect to the state, and residuals.

use super::pull_state::PullState;
use crate::cholesky::dot;
use crate::offset::change::{Appearance, ChangeKind, ChangePoint};
use crate::offset::effects::{FORCE, JointParameter as P, JointRow, Measured, PAYLOAD, PER_JOINT};
use crate::offset::layout::Layout;
use alloc::vec::Vec;
use core::ops::Range;

/// Side of the transmission from which an equation originates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Side {
    /// `theta_measured − q`, or the torque of the tendons at a joint divided by its stiffness, rad.
    Link,
    /// Motor torque, N·m.
    Motor,
    /// Torque by a tension sensor, N·m.
    Tension,
}

/// Rows of every axis.
const SIDES: usize = 3;

/// One equation of a block.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Equation {
    pub(crate) joint: usize,
    pub(crate) side: Side,
    /// Derivatives of the expected value with respect to the joint's parameters: zero for those that occur only on the
    /// other side, and equal for the zero and the offset ([`super::gram`] requires this).
    pub(crate) own: [f64; PER_JOINT],
    /// Derivative with respect to the joint's torque: masses and load act only through it, so over them
    /// the row is this times [`Equations::carried`].
    pub(crate) torque_gain: f64,
    /// Measured less expected.
    pub(crate) residual: f64,
    /// Standard deviation of an unknown effect in addition to the noise: friction of a drive at rest.
    pub(crate) added_std: f64,
    /// Share of the time the drive stationary_share.
    pub(crate) stationary_share: f64,
}

/// A change that has happened.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Active {
    /// First column of the change.
    pub(crate) first: usize,
    pub(crate) kind: ChangeKind,
    /// Factor of the change's entries in the block: 1 for a step, the elapsed time in s for creep.
    pub(crate) factor: f64,
}

/// Equations of one block, reused from block to block.
#[derive(Debug)]
pub(crate) struct Equations {
    layout: Layout,
    pub(crate) list: Vec<Equation>,
    /// Derivatives of every joint's torque with respect to bodies, load, and a force if one is searched for, `n` rows.
    carried: Vec<f64>,
    /// Length of such a row.
    width: usize,
    /// Changes that have happened by the block's time.
    active: Vec<Active>,
    /// Rows over the parameters of the other joints and the errors of moment arms, of the link and the motor side of every joint; empty where every joint has a tendon of its own.
    cross: Vec<f64>,
    /// Measured values of a block at every joint, while coupled equations are set up.
    pub(super) measured: Vec<Option<Measured>>,
    /// Room for derivatives with respect to the parameters of other joints.
    pub(super) of_others: Vec<JointRow>,
    /// Tensions of tendons whose group has one equation per joint; empty where there is no such group.
    pub(super) pulls: Vec<PullState>,
    /// Room for a row over the parameters of all axes.
    pub(super) row: Vec<f64>,
}

/// A copy has the same room: [`Equations::push`] never makes any.
impl Clone for Equations {
    fn clone(&self) -> Self {
        let mut list = Vec::with_capacity(self.list.capacity());
        list.extend_from_slice(&self.list);
        let mut active = Vec::with_capacity(self.active.capacity());
        active.extend_from_slice(&self.active);
        Self {
            layout: self.layout,
            list,
            carried: self.carried.clone(),
            width: self.width,
            active,
            cross: self.cross.clone(),
            measured: Vec::with_capacity(self.measured.capacity()),
            of_others: self.of_others.clone(),
            pulls: self.pulls.clone(),
            row: self.row.clone(),
        }
    }
}

/// Length of a row of the derivatives of a joint's torque: bodies, load, and a force if one is searched for.
pub(crate) fn width(layout: Layout, changes: &[ChangePoint]) -> usize {
    let is_sought = changes.iter().any(|c| c.kind == ChangeKind::Force);
    layout.carried().len() + if is_sought { FORCE } else { 0 }
}

impl Equations {
    /// Allocates the equations of a block for these changes; later calls do not allocate.
    pub(crate) fn new(layout: Layout, changes: &[ChangePoint]) -> Self {
        let n = layout.joints;
        let width = width(layout, changes);
        let coupled = if layout.is_coupled { n } else { 0 };
        let pulls = layout.sensors > 0;
        Self {
            layout,
            list: Vec::with_capacity(if layout.sensors > 0 { SIDES } else { 2 } * n),
            carried: alloc::vec![0.0; n * width],
            width,
            active: Vec::with_capacity(changes.len()),
            cross: alloc::vec![0.0; SIDES * coupled * layout.body_start()],
            measured: Vec::with_capacity(coupled),
            of_others: alloc::vec![[0.0; PER_JOINT]; coupled],
            pulls: alloc::vec![PullState::NONE; if pulls { n } else { 0 }],
            row: alloc::vec![0.0; if pulls { layout.body_start() } else { 0 }],
        }
    }

    /// Derivatives of an equation with respect to the parameters of all other joints and the errors of moment arms;
    /// empty where every joint has a tendon of its own.
    fn cross(&self, e: &Equation) -> &[f64] {
        self.cross
            .get(self.cross_place((e.joint, e.side)))
            .unwrap_or_default()
    }

    fn cross_place(&self, (joint, side): (usize, Side)) -> Range<usize> {
        let width = self.layout.body_start();
        let row = SIDES * joint + side as usize;
        row * width..(row + 1) * width
    }

    /// How an equation moves with the parameters of all axes but its own, and with those of moment arms, springs and sensors: room to
    /// fill, zero at first. Never allocates.
    pub(super) fn cross_row(&mut self, of: (usize, Side)) -> &mut [f64] {
        let place = self.cross_place(of);
        let row = self.cross.get_mut(place).unwrap_or_default();
        row.fill(0.0);
        row
    }

    /// Takes how an equation moves with the parameters of every joint, and with the errors of moment arms. Never allocates.
    pub(super) fn cross_rows(
        &mut self,
        of: (usize, Side),
        rows: impl Iterator<Item = JointRow>,
        arms: impl Iterator<Item = f64>,
    ) {
        let (place, joints) = (self.cross_place(of), self.layout.arm_start());
        let to = self.cross.get_mut(place).unwrap_or_default();
        let Some((of_joints, of_arms)) = to.split_at_mut_checked(joints) else {
            return;
        };
        for (to, row) in of_joints.chunks_exact_mut(PER_JOINT).zip(rows) {
            to.copy_from_slice(&row);
        }
        for (to, x) in of_arms.iter_mut().zip(arms) {
            *to = x;
        }
    }

    /// Derivatives of the torque of a joint with respect to bodies and payload.
    pub(crate) fn carried(&self, joint: usize) -> &[f64] {
        let bodies_and_load = self.layout.carried().len();
        self.row(joint).get(..bodies_and_load).unwrap_or_default()
    }

    /// Derivatives of the torque of a joint with respect to bodies, payload, and an external force if one is estimated.
    pub(crate) fn row(&self, joint: usize) -> &[f64] {
        let m = self.width;
        let row = self.carried.get(joint * m..(joint + 1) * m);
        row.unwrap_or_default()
    }

    /// Changes that have happened by the block's time.
    pub(crate) fn active(&self) -> &[Active] {
        &self.active
    }

    /// Whether the predicted measurement of `e` depends on such a change. A motor torque depends on its rope only
    /// through the load, unless an equation per joint derives the tension from the extension of the rope.
    pub(crate) fn moves_with(&self, e: &Equation, kind: ChangeKind) -> bool {
        match kind {
            ChangeKind::Offset(joint)
            | ChangeKind::Compliance(joint)
            | ChangeKind::Creep(joint) => match self.layout.sensors > 0 {
                true => self.entry(e, kind, 0) != 0.0,
                false => joint == e.joint && e.side == Side::Link,
            },
            ChangeKind::Payload | ChangeKind::Force => true,
        }
    }

    /// Entry `k` of the changed parameters in the row of `e`, for a factor of 1.
    pub(crate) fn entry(&self, e: &Equation, kind: ChangeKind, k: usize) -> f64 {
        let of = |joint: usize, parameter: P| match joint == e.joint {
            true => e.own[parameter as usize],
            false if self.layout.sensors > 0 => {
                entry(self.cross(e), self.layout.place(joint, parameter))
            }
            false => 0.0,
        };
        match kind {
            ChangeKind::Offset(joint) | ChangeKind::Creep(joint) => of(joint, P::Offset),
            ChangeKind::Compliance(joint) => of(joint, P::Compliance),
            ChangeKind::Payload => {
                e.torque_gain * entry(self.carried(e.joint), self.layout.bodies + k)
            }
            ChangeKind::Force => {
                e.torque_gain * entry(self.row(e.joint), self.layout.carried().len() + k)
            }
        }
    }

    /// Columns of the changes that have happened, with their values in the row of `e`.
    pub(crate) fn changes<'a>(
        &'a self,
        e: &'a Equation,
    ) -> impl Iterator<Item = (usize, f64)> + 'a {
        let columns = move |active: &Active| {
            let Active {
                first,
                kind,
                factor,
            } = *active;
            (0..kind.columns()).map(move |k| (first + k, factor * self.entry(e, kind, k)))
        };
        let active = self.active.iter();
        active
            .filter(move |active| self.moves_with(e, active.kind))
            .flat_map(columns)
    }

    /// The row of `e` times a column.
    pub(crate) fn dot(&self, e: &Equation, column: &[f64]) -> f64 {
        let part = |range: Range<usize>| column.get(range).unwrap_or_default();
        let own = dot(&e.own, part(self.layout.own(e.joint)));
        let carried = dot(self.carried(e.joint), part(self.layout.carried()));
        let changes = self.changes(e).map(|(i, value)| value * entry(column, i));
        let sum = own + e.torque_gain * carried + changes.sum::<f64>();
        if self.layout.is_coupled {
            sum + dot(self.cross(e), part(0..self.layout.body_start()))
        } else {
            sum
        }
    }

    /// Adds the row of `e`, times a factor, to a column.
    pub(crate) fn add_to(&self, e: &Equation, factor: f64, column: &mut [f64]) {
        let mut add = |range: Range<usize>, values: &[f64], factor: f64| {
            let to = column.get_mut(range).unwrap_or_default();
            for (to, value) in to.iter_mut().zip(values) {
                *to += factor * value;
            }
        };
        add(self.layout.own(e.joint), &e.own, factor);
        add(
            self.layout.carried(),
            self.carried(e.joint),
            factor * e.torque_gain,
        );
        if self.layout.is_coupled {
            add(0..self.layout.body_start(), self.cross(e), factor);
        }
        for (i, value) in self.changes(e) {
            add(i..i + 1, &[value], factor);
        }
    }

    /// Computes the derivatives of the torque of joint `i` with respect to bodies, load, and a force if one is searched
    /// for. Never allocates.
    pub(crate) fn carry(
        &mut self,
        i: usize,
        phi: &[f64],
        load: &[f64; PAYLOAD],
        force: Option<&[f64; FORCE]>,
    ) {
        let m = self.width;
        let row = self.carried.get_mut(i * m..(i + 1) * m);
        let values = phi.iter().chain(load).chain(force.into_iter().flatten());
        for (to, value) in row.unwrap_or_default().iter_mut().zip(values) {
            *to = *value;
        }
    }

    /// An equation more. Never allocates.
    pub(crate) fn push(&mut self, equation: Equation) {
        debug_assert!(self.list.len() < self.list.capacity(), "list is too short");
        if self.list.len() < self.list.capacity() {
            self.list.push(equation);
        }
    }

    /// The changes that have happened by now. Never allocates.
    pub(crate) fn activate(&mut self, changes: &[ChangePoint], time_s: f64, appears: Appearance) {
        self.active.clear();
        let mut column = self.layout.dimension();
        for change in changes {
            if time_s >= change.at_s && self.active.len() < self.active.capacity() {
                self.active.push(Active {
                    first: column,
                    kind: change.kind,
                    factor: change.factor(in_steps(change.at_s, time_s))
                        * appears.share(change, time_s),
                });
            }
            column += change.kind.columns();
        }
    }

    /// Entry `k` of the changed parameters, including all earlier changes.
    pub(crate) fn sum(&self, x: &[f64], kind: ChangeKind, k: usize) -> f64 {
        let place = kind.place(self.layout);
        let own = self
            .active
            .iter()
            .filter(|a| a.kind.place(self.layout) == place);
        let added = own.map(|a| a.factor * entry(x, a.first + k));
        place.map_or(0.0, |place| entry(x, place + k)) + added.sum::<f64>()
    }

    /// The entries of a force, where one acts.
    pub(crate) fn force(&self, x: &[f64]) -> Option<[f64; FORCE]> {
        let mut active = self.active.iter();
        let of = active.find(|a| a.kind == ChangeKind::Force)?;
        x.get(of.first..of.first + FORCE)?.try_into().ok()
    }
}

/// Centre of the two-second step that contains a time. Blocks of one step share the creep, so that their rows can be
/// summed.
fn in_steps(from_s: f64, time_s: f64) -> f64 {
    const STEP_S: f64 = 2.0;
    from_s + (libm::floor((time_s - from_s) / STEP_S) + 0.5) * STEP_S
}

/// `values[place]`; NaN, which no estimate hides, where there is none.
fn entry(values: &[f64], place: usize) -> f64 {
    values.get(place).copied().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::fixtures::{own, random};

    /// The terms of bodies, load and force in a joint's torque are independent of those of the other joints.
    #[test]
    fn joints_have_separate_rows() {
        let layout = Layout::diagonal(3, 5);
        let force = ChangePoint {
            kind: ChangeKind::Force,
            at_s: 0.0,
        };
        for changes in [&[][..], &[force]] {
            let mut seed = 3;
            let mut equations = Equations::new(layout, changes);
            equations.activate(changes, 1.0, Appearance::AT_ONCE);
            let total = layout.dimension() + FORCE * changes.len();
            let x: Vec<f64> = (0..total).map(|_| random(&mut seed)).collect();
            let given: Vec<Vec<f64>> = (0..layout.joints)
                .map(|i| {
                    let phi: Vec<f64> = (0..layout.bodies).map(|_| random(&mut seed)).collect();
                    let load: [f64; PAYLOAD] = core::array::from_fn(|_| random(&mut seed));
                    let pushed: [f64; FORCE] = core::array::from_fn(|_| random(&mut seed));
                    let pushed = (!changes.is_empty()).then_some(pushed);
                    equations.carry(i, &phi, &load, pushed.as_ref());
                    let pushed = pushed.into_iter().flatten();
                    phi.into_iter().chain(load).chain(pushed).collect()
                })
                .collect();
            for (joint, given) in given.iter().enumerate() {
                assert_eq!(equations.row(joint), given, "joint {joint}");
                let e = Equation {
                    joint,
                    side: Side::Link,
                    own: own(Side::Link, &mut seed),
                    torque_gain: -0.7,
                    residual: 0.0,
                    added_std: 0.0,
                    stationary_share: 0.0,
                };
                // All entries other than the joint's follow the joints in one block.
                let of_own = dot(&e.own, &x[layout.own(joint)]);
                let expected = of_own - 0.7 * dot(given, &x[layout.body_start()..]);
                assert!((equations.dot(&e, &x) - expected).abs() < 1e-13);
            }
            // There is no fourth.
            assert!(equations.row(3).is_empty());
        }
    }
}
