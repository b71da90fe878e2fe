//! Groups of joints and tendons, the maps between their offsets, elongations and torques, and observability.
//!
//! These functions allocate: they run when a robot is checked or a recording is evaluated, not in a control loop.

use super::coupling::Coupling;
use super::description::Coordinate;
use super::error::{EvaluationError, check_length};
use super::state::{CouplingState, TendonStatus, add_scaled};
use crate::cholesky::Factor;
use crate::eigen;
use crate::moment_arm::{MomentArm, TendonKind};
use alloc::vec::Vec;

/// Largest condition number that counts as full rank. A convention: up to here the equation of one tendon amplifies the
/// noise of the others at most a thousandfold.
pub const MAX_CONDITION: f64 = 1e3;

/// Elastic joints and tendons that are connected by moment arms, and with no others.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    joints: Vec<usize>,
    tendons: Vec<usize>,
    equations: Equations,
}

impl Group {
    /// Indices of the joints, increasing; at least one.
    pub fn joints(&self) -> &[usize] {
        &self.joints
    }

    /// Indices of the tendons, increasing.
    pub fn tendons(&self) -> &[usize] {
        &self.tendons
    }

    /// Equations that estimate the elongations of the group.
    pub fn equations(&self) -> Equations {
        self.equations
    }
}

/// Equations that estimate the elongations of a group.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Equations {
    /// One equation per joint, which has one loop and one motor with all ratios 1.
    Diagonal,
    /// One equation per tendon, `delta_i = y_i − f_i/k_i` with `f = R⁻ᵀ tau_el`.
    Tendon {
        /// Condition number of `√K R` with columns scaled to unit length, which is the same in every coordinate.
        condition: f64,
    },
    /// One equation per joint, `Rᵀ f = tau_el`.
    Joint(JointEquationsReason),
}

/// Reason why a group has one equation per joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum JointEquationsReason {
    /// The numbers of tendons and joints differ.
    NotSquare,
    /// A joint, given by its index, has a passive spring.
    Spring(usize),
    /// A tendon, given by its index, is a strand.
    Strand(usize),
    /// A moment arm of a tendon, given by its index, varies with position.
    VariableMomentArm(usize),
    /// The condition number of `√K R`, columns scaled to unit length, exceeds [`MAX_CONDITION`].
    IllConditioned(f64),
}

/// Measurements beyond joint dynamics.
#[derive(Debug, Clone, Copy, Default)]
pub struct Sensors<'a> {
    /// Indices of the motors whose torque is measured.
    pub motor_torque: &'a [usize],
    /// Indices of the tendons whose tension is measured.
    pub tension: &'a [usize],
}

/// Observability of the elongations at one position.
#[derive(Debug, Clone, PartialEq)]
pub struct Observability {
    /// Number of independent combinations of elongations that change a measured torque or tension.
    pub rank: usize,
    /// Basis of the `T − rank` combinations that change none, row by row: elongation of every tendon in its coordinate,
    /// of unit norm, the largest entry positive. A slack strand has a row of its own.
    pub unobservable: Vec<Vec<f64>>,
}

impl Coupling {
    /// Splits the robot into groups, each of which is estimated separately. Rigid joints belong to none.
    pub fn groups(&self) -> Vec<Group> {
        // Label of every joint: the smallest index it is connected to.
        let mut label: Vec<usize> = (0..self.joints.len()).collect();
        let elastic = |i: usize| {
            let arms = self.tendons[i].arms.iter().map(|(j, _)| *j);
            arms.filter(|j| !self.joints[*j].is_rigid)
        };
        for i in 0..self.tendons.len() {
            let Some(least) = elastic(i).map(|j| label[j]).min() else {
                continue;
            };
            let joined: Vec<usize> = elastic(i).map(|j| label[j]).collect();
            for to in label.iter_mut().filter(|to| joined.contains(to)) {
                *to = least;
            }
        }
        let first = (0..label.len()).filter(|j| label[*j] == *j && !self.joints[*j].is_rigid);
        first
            .map(|first| {
                let joints: Vec<usize> = (0..label.len()).filter(|j| label[*j] == first).collect();
                let tendons: Vec<usize> = (0..self.tendons.len())
                    .filter(|i| elastic(*i).any(|j| label[j] == first))
                    .collect();
                let equations = self.equations(&joints, &tendons);
                Group {
                    joints,
                    tendons,
                    equations,
                }
            })
            .collect()
    }

    fn equations(&self, joints: &[usize], tendons: &[usize]) -> Equations {
        let all = || tendons.iter().map(|i| (*i, &self.tendons[*i]));
        if tendons.len() != joints.len() {
            return Equations::Joint(JointEquationsReason::NotSquare);
        }
        if let Some(j) = joints.iter().find(|j| self.joints[**j].spring.is_some()) {
            return Equations::Joint(JointEquationsReason::Spring(*j));
        }
        if let Some((i, _)) = all().find(|(_, t)| t.kind == TendonKind::Strand) {
            return Equations::Joint(JointEquationsReason::Strand(i));
        }
        let mut weighted = Vec::with_capacity(tendons.len() * joints.len());
        for (i, tendon) in all() {
            for joint in joints {
                weighted.push(match tendon.arms.iter().find(|(j, _)| j == joint) {
                    None => 0.0,
                    Some((_, MomentArm::Constant(arm))) => *arm * libm::sqrt(tendon.stiffness),
                    Some((_, MomentArm::Table(_))) => {
                        return Equations::Joint(JointEquationsReason::VariableMomentArm(i));
                    }
                });
            }
        }
        if let [i] = tendons {
            let (tendon, m) = (&self.tendons[*i], self.motor_names().len());
            let mut drums = self.drums[i * m..(i + 1) * m].iter().filter(|s| **s != 0.0);
            let has_unit_drum = drums.next() == Some(&1.0) && drums.next().is_none();
            let is_in_radians = tendon.coordinate != Coordinate::Metres;
            let has_unit_arm = matches!(tendon.arms[..], [(_, MomentArm::Constant(1.0))]);
            if has_unit_arm && has_unit_drum && is_in_radians {
                return Equations::Diagonal;
            }
        }
        scale_columns(&mut weighted, joints.len());
        match condition(&gram(&weighted, joints.len()), joints.len()) {
            condition if condition < MAX_CONDITION => Equations::Tendon { condition },
            condition => Equations::Joint(JointEquationsReason::IllConditioned(condition)),
        }
    }

    /// Offset of the group's joints due to the elongations of its tendons, `(Rᵀ K R)⁻¹ Rᵀ K delta`, rad, in the order
    /// of
    /// `group.joints()`; `R⁻¹ delta` where `R` is square. Positive: the joints stay behind their motors.
    ///
    /// * `state`: evaluated at the position in question. `delta`: elongations of all tendons, length `T`.
    ///
    /// # Errors
    /// Returns [`EvaluationError::Slack`] where a strand of the group is slack, [`EvaluationError::Singular`] where the tendons do not determine
    /// the joints, [`EvaluationError::Length`].
    pub fn joint_offset(
        &self,
        state: &CouplingState,
        group: &Group,
        delta: &[f64],
    ) -> Result<Vec<f64>, EvaluationError> {
        check_length("delta", delta.len(), self.tendons.len())?;
        let weighted = self.weighted_arms(state, group)?;
        let mut offset = alloc::vec![0.0; group.joints.len()];
        for (row, i) in weighted.chunks_exact(offset.len()).zip(&group.tendons) {
            add_scaled(
                &mut offset,
                row,
                libm::sqrt(state.stiffness[*i]) * delta[*i],
            );
        }
        solve_normal(weighted, &mut offset, group)?;
        Ok(offset)
    }

    /// Elongations that turn the group's joints by `offset` and leave no tension behind, `R offset`, in the order of
    /// `group.tendons()` and their coordinates: the inverse of [`joint_offset`](Self::joint_offset) where `R` is square, else
    /// those without a change of co-contraction.
    ///
    /// * `offset`: rad, in the order of `group.joints()`.
    ///
    /// # Errors
    /// Returns [`EvaluationError::Length`].
    pub fn elongation_from_joint_offset(
        &self,
        state: &CouplingState,
        group: &Group,
        offset: &[f64],
    ) -> Result<Vec<f64>, EvaluationError> {
        self.check_group(state, group)?;
        check_length("offset", offset.len(), group.joints.len())?;
        let r = self.arms_of(state, group);
        let rows = r.chunks_exact(offset.len());
        Ok(rows
            .map(|r| r.iter().zip(offset).map(|(r, o)| r * o).sum())
            .collect())
    }

    /// Tensions that carry the elastic torques `tau_el` of a group with as many tendons as joints, `R⁻ᵀ tau_el`, in the order of
    /// `group.tendons()`. With the extension `y` at `delta = 0`, the elongation is `y − f/k` (loops).
    ///
    /// * `tau_el`: N·m, in the order of `group.joints()`.
    ///
    /// # Errors
    /// Returns [`EvaluationError::NotSquare`] where the numbers differ, [`EvaluationError::Slack`] where a strand of the group is slack,
    /// [`EvaluationError::Singular`] where `√K R` has a condition number above [`MAX_CONDITION`], [`EvaluationError::Length`].
    pub fn tension_from_torque(
        &self,
        state: &CouplingState,
        group: &Group,
        tau_el: &[f64],
    ) -> Result<Vec<f64>, EvaluationError> {
        check_length("tau_el", tau_el.len(), group.joints.len())?;
        let (tendons, joints) = (group.tendons.len(), group.joints.len());
        if tendons != joints {
            return Err(EvaluationError::NotSquare { tendons, joints });
        }
        // R⁻ᵀ = K R (Rᵀ K R)⁻¹.
        let mut offset = tau_el.to_vec();
        solve_normal(self.weighted_arms(state, group)?, &mut offset, group)?;
        let mut tension = self.elongation_from_joint_offset(state, group, &offset)?;
        for (f, i) in tension.iter_mut().zip(&group.tendons) {
            *f *= state.stiffness[*i];
        }
        Ok(tension)
    }

    /// Combinations of elongations that joint dynamics and `sensors` observe at one position, and those that they do not.
    ///
    /// Joint dynamics observe `Rᵀ K delta` of elastic joints, a motor's torque its row of `Sᵀ K delta`, a tension sensor `k delta` of its
    /// tendon; slack strands have no stiffness. A change of position, where moment arms vary or strands become slack, may
    /// show more. A combination counts as observed where its singular value is above the largest divided by
    /// [`MAX_CONDITION`], with rows and columns scaled to unit length. Indices beyond the last motor or tendon are ignored.
    ///
    /// # Errors
    /// Returns [`EvaluationError::Length`] of `state`.
    pub fn observability(
        &self,
        state: &CouplingState,
        sensors: Sensors<'_>,
    ) -> Result<Observability, EvaluationError> {
        self.observability_over(&[state], sensors)
    }

    /// Combinations of elongations that joint dynamics and `sensors` [observe](Self::observability) at several
    /// positions together, and those that they observe at none; variable moment arms make further combinations
    /// observable.
    ///
    /// * `states`: evaluated at the positions.
    ///
    /// # Errors
    /// Returns [`EvaluationError::Length`] of a state.
    pub fn observability_over(
        &self,
        states: &[&CouplingState],
        sensors: Sensors<'_>,
    ) -> Result<Observability, EvaluationError> {
        for state in states {
            self.check_state(state)?;
        }
        let (n, m, count) = (
            self.joints.len(),
            self.motor_names().len(),
            self.tendons.len(),
        );
        let mut unobservable = Vec::new();
        let unit = |i: usize| {
            (0..count)
                .map(|k| f64::from(u8::from(k == i)))
                .collect::<Vec<_>>()
        };
        // One row per taut tendon, with a torque or tension per column.
        let elastic: Vec<usize> = (0..n).filter(|j| !self.joints[*j].is_rigid).collect();
        let motors: Vec<usize> = (0..m)
            .filter(|k| sensors.motor_torque.contains(k))
            .collect();
        let width = states.len() * (elastic.len() + motors.len()) + count;
        let (mut g, mut taut, mut scale) = (Vec::new(), Vec::new(), Vec::new());
        for i in 0..count {
            let stiffness = states.iter().map(|state| state.stiffness[i]);
            let stiffness = stiffness.fold(0.0, f64::max);
            if stiffness == 0.0 {
                unobservable.push(unit(i));
                continue;
            }
            let mut torques = Vec::with_capacity(width);
            for state in states {
                let share = state.stiffness[i] / stiffness;
                let arms = elastic.iter().map(|j| state.moment_arms()[i * n + j]);
                let drums = motors.iter().map(|k| self.drums[i * m + k]);
                torques.extend(arms.chain(drums).map(|torque| share * torque));
            }
            let length = libm::sqrt(torques.iter().map(|x| x * x).sum());
            let length = if length > 0.0 { length } else { 1.0 };
            g.extend(torques.iter().map(|x| x / length));
            g.extend(
                (0..count).map(|k| f64::from(u8::from(k == i && sensors.tension.contains(&k)))),
            );
            taut.push(i);
            scale.push(length * stiffness);
        }
        scale_columns(&mut g, width);
        // Tensions u with Gᵀ u = 0 change nothing; the elongations that make them are u/k.
        let transposed: Vec<f64> = (0..width)
            .flat_map(|c| g.iter().skip(c).step_by(width))
            .copied()
            .collect();
        let (values, vectors) = eigen::symmetric(gram(&transposed, taut.len()), taut.len());
        let largest = values.iter().copied().fold(0.0, f64::max);
        for (value, u) in values.iter().zip(vectors.chunks_exact(taut.len().max(1))) {
            if *value * MAX_CONDITION * MAX_CONDITION > largest {
                continue;
            }
            let mut direction = alloc::vec![0.0; count];
            for ((i, u), scale) in taut.iter().zip(u).zip(&scale) {
                direction[*i] = u / scale;
            }
            let largest = direction
                .iter()
                .copied()
                .fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
            let norm = libm::sqrt(direction.iter().map(|x| x * x).sum()).copysign(largest);
            direction.iter_mut().for_each(|x| *x /= norm);
            unobservable.push(direction);
        }
        Ok(Observability {
            rank: count - unobservable.len(),
            unobservable,
        })
    }

    /// Checks that a state and a group belong to a coupling of this size.
    fn check_group(&self, state: &CouplingState, group: &Group) -> Result<(), EvaluationError> {
        self.check_state(state)?;
        let (n, tendons) = (self.joints.len(), self.tendons.len());
        let needed = |indices: &[usize]| indices.last().map_or(0, |last| last + 1);
        check_length("group.joints", needed(&group.joints).max(n), n)?;
        check_length(
            "group.tendons",
            needed(&group.tendons).max(tendons),
            tendons,
        )
    }

    /// Moment arms of a group, row-major, its tendons by its joints.
    fn arms_of(&self, state: &CouplingState, group: &Group) -> Vec<f64> {
        let (n, r) = (self.joints.len(), state.moment_arms());
        let rows = group.tendons.iter();
        rows.flat_map(|i| group.joints.iter().map(move |j| r[i * n + j]))
            .collect()
    }

    /// Weighted moment arms `√K R` of a group without slack strands, as [`arms_of`](Self::arms_of).
    fn weighted_arms(
        &self,
        state: &CouplingState,
        group: &Group,
    ) -> Result<Vec<f64>, EvaluationError> {
        self.check_group(state, group)?;
        let mut weighted = self.arms_of(state, group);
        let rows = weighted.chunks_exact_mut(group.joints.len());
        for (row, tendon) in rows.zip(&group.tendons) {
            if state.status()[*tendon] == TendonStatus::Slack {
                return Err(EvaluationError::Slack { tendon: *tendon });
            }
            let root = libm::sqrt(state.stiffness[*tendon]);
            row.iter_mut().for_each(|r| *r *= root);
        }
        Ok(weighted)
    }
}

fn singular(group: &Group) -> EvaluationError {
    EvaluationError::Singular {
        joint: group.joints.first().copied().unwrap_or(0),
    }
}

/// Solves `Aᵀ A x = b` in place for `a`, row-major with a column per joint of the group.
fn solve_normal(mut a: Vec<f64>, b: &mut [f64], group: &Group) -> Result<(), EvaluationError> {
    let n = b.len();
    let scale = scale_columns(&mut a, n);
    let normal = gram(&a, n);
    if !(condition(&normal, n) < MAX_CONDITION) {
        return Err(singular(group));
    }
    let factor = Factor::of(&normal, n).map_err(|_| singular(group))?;
    b.iter_mut().zip(&scale).for_each(|(b, scale)| *b /= scale);
    factor.solve(b);
    b.iter_mut().zip(&scale).for_each(|(b, scale)| *b /= scale);
    Ok(())
}

/// Gram matrix `AᵀA` of a row-major matrix of `n` columns.
fn gram(a: &[f64], n: usize) -> Vec<f64> {
    let mut normal = alloc::vec![0.0; n * n];
    for row in a.chunks_exact(n.max(1)) {
        for (to, x) in normal.chunks_exact_mut(n.max(1)).zip(row) {
            to.iter_mut().zip(row).for_each(|(to, y)| *to += x * y);
        }
    }
    normal
}

/// Scales columns to unit length; returns the lengths, 1 of a column of zeros.
fn scale_columns(a: &mut [f64], n: usize) -> Vec<f64> {
    let lengths: Vec<f64> = (0..n)
        .map(|c| libm::sqrt(a.iter().skip(c).step_by(n).map(|x| x * x).sum()))
        .map(|length| if length > 0.0 { length } else { 1.0 })
        .collect();
    for row in a.chunks_exact_mut(n.max(1)) {
        row.iter_mut()
            .zip(&lengths)
            .for_each(|(x, length)| *x /= length);
    }
    lengths
}

/// Condition number of `A` from `AᵀA`, `n × n`; infinite where an eigenvalue is 0 or negative by rounding.
fn condition(normal: &[f64], n: usize) -> f64 {
    let (values, _) = eigen::symmetric(normal.to_vec(), n);
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = values.iter().copied().fold(0.0, f64::max);
    if least > 0.0 {
        libm::sqrt(largest / least)
    } else {
        f64::INFINITY
    }
}
