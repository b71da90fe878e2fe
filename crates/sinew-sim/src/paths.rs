//! Paths of tendons that cross several joints, and the tensions that hold a torque.

use sinew_model::cholesky::{Factor, dot};
use sinew_model::robot::Robot;
use sinew_model::tendons::{MomentArm, PulledAxis, PulledGroup, Routings, TendonKind};

/// Tendons by axis, for a robot with at least one tendon that crosses several joints or has a separate name.
///
/// Extension and torque of a tendon are in the coordinate of a joint:
///
/// ```text
/// y_i = theta_i − delta_i − l_i(q),   tau_el_j = Σ_i (∂l_i/∂q_j) f_i,   f_i ≥ 0 of a strand
/// ```
///
/// Tendons of one motor move with the first of them, `theta_i = theta_first drive_ratio_i / drive_ratio_first`.
#[derive(Debug, Clone)]
pub(crate) struct Paths {
    pub(crate) routings: Routings,
    dof: usize,
    tendons: Vec<Option<AxisTendon>>,
    groups: Vec<Group>,
    /// Axes that share the motor of one before them, with that axis and the ratio of their positions to its.
    followers: Vec<(usize, usize, f64)>,
}

/// Tendon on an axis.
#[derive(Debug, Clone, PartialEq)]
struct AxisTendon {
    is_strand: bool,
    pretension_nm: f64,
    stiffness_nm_per_rad: f64,
    /// Torque per newton of tension, m, where a radius is specified.
    metres_per_rad: Option<f64>,
    /// Moment arms at the joints where a group has an equation per joint; `None`: the constant ones of the routings.
    arms: Option<Vec<(usize, MomentArm)>>,
}

/// Joints and tendons with an equation per joint that are connected with each other.
#[derive(Debug, Clone, PartialEq)]
struct Group {
    /// Axes of the tendons.
    axes: Vec<usize>,
    joints: Vec<usize>,
    /// Torques that turn no joint at `q = 0` and tension every strand by at least 1 N·m, by tendon, if they exist.
    balanced: Option<Vec<f64>>,
}

/// Required minimum tensions of the strands of a group.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Least {
    /// The pretension, and more only where a strand would be slack.
    Pretension,
    /// The least tension of a strand in the group is this, N.
    Tension(f64),
}

impl Paths {
    /// Paths of a robot; `None` where every joint has a tendon of its own.
    pub(crate) fn of(robot: &Robot) -> Option<Self> {
        let routings = Routings::of(&robot.transmissions)?;
        let (dof, axes) = (robot.arm.dof(), robot.axes());
        let tendons: Vec<Option<AxisTendon>> = (robot.transmissions.iter())
            .map(|transmission| {
                let transmission = transmission.as_ref()?;
                let pull = transmission.routing.as_ref().and_then(|r| r.pull.as_ref());
                let radius_m = transmission.tendon.as_ref();
                let radius_m = radius_m.map(|tendon| tendon.joint_pulley_radius_m);
                Some(AxisTendon {
                    is_strand: pull.is_some_and(|pull| pull.kind == TendonKind::Strand),
                    pretension_nm: pull.map_or(0.0, |pull| pull.pretension_nm),
                    stiffness_nm_per_rad: transmission.stiffness_nm_per_rad,
                    metres_per_rad: pull.and_then(|pull| pull.metres_per_rad).or(radius_m),
                    arms: pull.map(|pull| {
                        let arms = pull.joints.iter();
                        arms.map(|own| (own.joint, own.arm.clone())).collect()
                    }),
                })
            })
            .collect();
        let followers = (0..axes).filter_map(|i| {
            let first = routings.motor_axis(i);
            let ratio = routings.drive_ratio(i) / routings.drive_ratio(first);
            (first != i).then_some((i, first, ratio))
        });
        let mut paths = Self {
            dof,
            tendons,
            groups: Vec::new(),
            followers: followers.collect(),
            routings,
        };
        paths.groups = paths.connected();
        Some(paths)
    }

    /// Groups with an equation per joint.
    fn connected(&self) -> Vec<Group> {
        let at_zero = vec![0.0; self.dof];
        let groups = self.routings.groups().into_iter();
        groups
            .map(|PulledGroup { joints, tendons }| {
                let mut group = Group {
                    axes: tendons,
                    joints,
                    balanced: None,
                };
                group.balanced = self.balanced(&group, &at_zero);
                group
            })
            .collect()
    }

    /// Joint with an equation of its own.
    pub(crate) fn joint(&self, j: usize) -> Option<&PulledAxis> {
        self.routings.pulled(j)
    }

    /// Whether a group has an equation per joint.
    pub(crate) fn has_pulls(&self) -> bool {
        !self.groups.is_empty()
    }

    /// Whether strands of a group can pull against each other without turning a joint.
    pub(crate) fn can_contract(&self) -> bool {
        let mut groups = self.groups.iter();
        groups.any(|group| group.balanced.is_some())
    }

    /// Returns the index of a strand whose tension in newtons cannot be computed because it has no radius.
    pub(crate) fn strand_without_radius(&self) -> Option<usize> {
        let lacks = |t: &Option<AxisTendon>| {
            t.as_ref()
                .is_some_and(|t| t.is_strand && t.metres_per_rad.is_none())
        };
        self.tendons.iter().position(lacks)
    }

    /// Whether there is a tendon on an axis.
    pub(crate) fn has_tendon(&self, i: usize) -> bool {
        self.tendons.get(i).is_some_and(Option::is_some)
    }

    /// Whether the tendon on an axis is unidirectional.
    pub(crate) fn is_strand(&self, i: usize) -> bool {
        let tendon = self.tendons.get(i).and_then(Option::as_ref);
        tendon.is_some_and(|tendon| tendon.is_strand)
    }

    /// Torque of a strand at `theta = 0`, `q = 0` and `delta = 0` as described, N·m; 0 of a loop.
    pub(crate) fn pretension_nm(&self, i: usize) -> f64 {
        let tendon = self.tendons.get(i).and_then(Option::as_ref);
        tendon.map_or(0.0, |tendon| tendon.pretension_nm)
    }

    /// Axes that share the motor of one before them, with that axis and the ratio of their positions to its.
    pub(crate) fn followers(&self) -> &[(usize, usize, f64)] {
        &self.followers
    }

    /// Returns the first axis that has the same motor as axis `i`, and the ratio of the position of axis `i` to that
    /// of the first axis.
    pub(crate) fn motor_axis(&self, i: usize) -> (usize, f64) {
        let own = self.followers.iter().find(|(axis, ..)| *axis == i);
        own.map_or((i, 1.0), |(_, first, ratio)| (*first, *ratio))
    }

    /// Moves tendons of one motor to the motor position of [`of_motor`](Self::of_motor).
    ///
    /// * `torque`: of the tendons, N·m. `theta`: where each of them has it, rad. One entry per axis.
    pub(crate) fn join(&self, torque: &[f64], theta: &mut [f64]) {
        let firsts = self.followers.iter().map(|(_, first, _)| *first);
        let motors: Vec<(usize, f64)> = firsts
            .map(|first| (first, self.of_motor(first, torque, |i| theta[i])))
            .collect();
        for ((first, position), (i, _, ratio)) in motors.into_iter().zip(&self.followers) {
            theta[first] = position;
            theta[*i] = ratio * position;
        }
    }

    /// Position of a motor whose tendons require different positions, in the coordinate of the first: it minimises `Σ
    /// K (theta − position)²` over the taut tendons.
    pub(crate) fn of_motor(
        &self,
        first: usize,
        torque: &[f64],
        position: impl Fn(usize) -> f64,
    ) -> f64 {
        let followers = self.followers.iter();
        let mut own = followers.filter(|(_, axis, _)| *axis == first).peekable();
        if own.peek().is_none() {
            return position(first);
        }
        let stiffness = |i: usize| match &self.tendons[i] {
            Some(tendon) if !tendon.is_strand || torque[i] > 0.0 => tendon.stiffness_nm_per_rad,
            _ => 0.0,
        };
        let k = stiffness(first);
        let (sum, weight) = own.fold((k * position(first), k), |(sum, weight), (i, _, ratio)| {
            let k = stiffness(*i);
            (sum + k * ratio * position(*i), weight + k * ratio * ratio)
        });
        if weight > 0.0 {
            sum / weight
        } else {
            position(first)
        }
    }

    /// Shortening `l_i(q)` of the path of a tendon, rad of its coordinate; 0 at `q = 0`.
    pub(crate) fn shortening(&self, i: usize, q: &[f64]) -> f64 {
        match self.tendons[i].as_ref().and_then(|t| t.arms.as_ref()) {
            None => self.routings.path(i, q),
            Some(arms) => arms.iter().fold(0.0, |sum, (joint, arm)| {
                let [shortening, _] = evaluate(arm, q[*joint]);
                sum + shortening
            }),
        }
    }

    /// Adds the torque `f` of a tendon, N·m, to the elastic torques of the joints.
    pub(crate) fn add_torque(&self, i: usize, q: &[f64], f: f64, tau_el: &mut [f64]) {
        match self.tendons[i].as_ref().and_then(|t| t.arms.as_ref()) {
            None => self.routings.add_torque(i, f, tau_el),
            Some(arms) => {
                for (joint, arm) in arms {
                    let [_, arm] = evaluate(arm, q[*joint]);
                    tau_el[*joint] += arm * f;
                }
            }
        }
    }

    /// Returns the restoring torque of the passive spring of a joint, N·m; 0 without one.
    pub(crate) fn spring_torque(&self, j: usize, q: f64) -> f64 {
        let spring = self.joint(j).and_then(|joint| joint.spring);
        spring.map_or(0.0, |spring| {
            spring.stiffness_nm_per_rad * (q - spring.rest_rad)
        })
    }

    /// Writes the torques of the tendons, N·m, that hold elastic torques of the joints.
    ///
    /// A tendon with an equation of its own has one solution. A group with an equation per joint starts from its
    /// pretension and takes the change of least `Σ f²/K` that holds the torque; then all its strands are tensioned
    /// together along the torques that turn no joint. Without such torques, a strand may become slack. If there are
    /// fewer tendons than joints, they hold as much of the torque as they can.
    ///
    /// * `tau_el`: `dof`, N·m. `f`: one entry per axis.
    pub(crate) fn distribute(&self, q: &[f64], tau_el: &[f64], least: Least, f: &mut [f64]) {
        for (i, f) in f.iter_mut().enumerate() {
            *f = match &self.tendons[i] {
                None => 0.0,
                Some(tendon) if tendon.arms.is_some() => tendon.pretension_nm,
                Some(_) => self.routings.torque_of(i, tau_el.iter().copied()),
            };
        }
        for group in &self.groups {
            let arms = self.arms(group, q);
            let target: Vec<f64> = group.joints.iter().map(|j| tau_el[*j]).collect();
            let mut torque: Vec<f64> = group.axes.iter().map(|i| f[*i]).collect();
            let mut pulls = vec![true; torque.len()];
            self.hold(group, &arms, &target, &pulls, &mut torque);
            let mut along = group.balanced.clone().unwrap_or_default();
            if along.is_empty() {
                // Nothing keeps the strands taut: the others hold what a slack one would have to push.
                while let Some(slack) = self.pushing(group, &torque) {
                    (pulls[slack], torque[slack]) = (false, 0.0);
                    self.hold(group, &arms, &target, &pulls, &mut torque);
                }
            } else {
                // At this position, where moment arms may be others.
                self.hold(group, &arms, &vec![0.0; target.len()], &pulls, &mut along);
            }
            // Additional tension at which the least loaded strand reaches the required tension.
            let mut pull: Option<f64> = None;
            for ((i, torque), along) in group.axes.iter().zip(&torque).zip(&along) {
                let Some(tendon) = self.tendons[*i].as_ref().filter(|t| t.is_strand) else {
                    continue;
                };
                let required = match least {
                    Least::Pretension => 0.0,
                    Least::Tension(newtons) => newtons * tendon.metres_per_rad.unwrap_or(0.0),
                };
                const PULLED: f64 = 1e-6;
                if *along > PULLED {
                    let own = (required - torque) / along;
                    pull = Some(pull.map_or(own, |pull| pull.max(own)));
                }
            }
            let pull = match least {
                Least::Pretension => pull.unwrap_or(0.0).max(0.0),
                Least::Tension(_) => pull.unwrap_or(0.0),
            };
            for (k, i) in group.axes.iter().enumerate() {
                let sum = torque[k] + pull * along.get(k).copied().unwrap_or(0.0);
                f[*i] = if self.is_strand(*i) {
                    sum.max(0.0)
                } else {
                    sum
                };
            }
        }
    }

    /// Moment arms of a group at a position, its tendons by its joints.
    fn arms(&self, group: &Group, q: &[f64]) -> Vec<f64> {
        let width = group.joints.len();
        let mut all = vec![0.0; group.axes.len() * width];
        for (row, i) in all.chunks_exact_mut(width).zip(&group.axes) {
            let arms = self.tendons[*i].as_ref().and_then(|t| t.arms.as_ref());
            for (joint, arm) in arms.into_iter().flatten() {
                if let Some(column) = group.joints.iter().position(|j| j == joint) {
                    let [_, arm] = evaluate(arm, q[*joint]);
                    row[column] = arm;
                }
            }
        }
        all
    }

    /// Strand of a group that would have to push most.
    fn pushing(&self, group: &Group, torque: &[f64]) -> Option<usize> {
        let strands = (0..torque.len()).filter(|k| self.is_strand(group.axes[*k]));
        let pushing = strands.filter(|k| torque[*k] < 0.0);
        pushing.min_by(|a, b| torque[*a].total_cmp(&torque[*b]))
    }

    /// Changes the torques of a group with minimal `Σ f²/K` so that they yield `target` at its joints, with
    /// non-negative tensions.
    fn hold(
        &self,
        group: &Group,
        arms: &[f64],
        target: &[f64],
        pulls: &[bool],
        torque: &mut [f64],
    ) {
        let joints = group.joints.len();
        let row = |k: usize| &arms[k * joints..(k + 1) * joints];
        let pulling: Vec<usize> = (0..torque.len()).filter(|k| pulls[*k]).collect();
        let mut left = target.to_vec();
        for k in &pulling {
            for (left, arm) in left.iter_mut().zip(row(*k)) {
                *left -= arm * torque[*k];
            }
        }
        let stiffness = |k: usize| {
            let tendon = self.tendons[group.axes[k]].as_ref();
            tendon.map_or(0.0, |tendon| tendon.stiffness_nm_per_rad)
        };
        if pulling.len() >= joints {
            // Rᵀ K R z = left, f += K R z.
            let mut matrix = vec![0.0; joints * joints];
            for k in &pulling {
                for (line, a) in matrix.chunks_exact_mut(joints).zip(row(*k)) {
                    for (to, b) in line.iter_mut().zip(row(*k)) {
                        *to += stiffness(*k) * a * b;
                    }
                }
            }
            if solve(&matrix, &mut left) {
                for k in pulling {
                    torque[k] += stiffness(k) * dot(row(k), &left);
                }
            }
            return;
        }
        // R Rᵀ change = R left: the closest that so few tendons can.
        let mut change: Vec<f64> = pulling.iter().map(|k| dot(row(*k), &left)).collect();
        let pairs = (pulling.iter()).flat_map(|a| pulling.iter().map(move |b| (*a, *b)));
        let matrix: Vec<f64> = pairs.map(|(a, b)| dot(row(a), row(b))).collect();
        if solve(&matrix, &mut change) {
            for (k, change) in pulling.into_iter().zip(change) {
                torque[k] += change;
            }
        }
    }

    /// Torques of a group that turn no joint, of strands at least 1 N·m: the least squares of the joint torques under that bound, by
    /// descent along one tendon after the other. `None` where strands cannot be balanced, as against springs, or two of them have one
    /// motor, which cannot pull both.
    fn balanced(&self, group: &Group, q: &[f64]) -> Option<Vec<f64>> {
        const SWEEPS: usize = 20_000;
        const BALANCED: f64 = 1e-7;
        let joints = group.joints.len();
        let arms = self.arms(group, q);
        let bound = |i: usize| {
            if self.is_strand(group.axes[i]) {
                1.0
            } else {
                f64::NEG_INFINITY
            }
        };
        let is_shared = |i: &usize| self.followers.iter().any(|(axis, ..)| axis == i);
        if !group.axes.iter().any(|i| self.is_strand(*i)) || group.axes.iter().any(is_shared) {
            return None;
        }
        let mut torque: Vec<f64> = (0..group.axes.len()).map(|i| bound(i).max(0.0)).collect();
        let mut left = vec![0.0; joints];
        for (row, torque) in arms.chunks_exact(joints).zip(&torque) {
            for (left, arm) in left.iter_mut().zip(row) {
                *left += arm * torque;
            }
        }
        for _ in 0..SWEEPS {
            let mut moved: f64 = 0.0;
            for (i, row) in arms.chunks_exact(joints).enumerate() {
                let square = dot(row, row);
                if square == 0.0 {
                    continue;
                }
                let to = (torque[i] - dot(row, &left) / square).max(bound(i));
                let step = to - torque[i];
                for (left, arm) in left.iter_mut().zip(row) {
                    *left += arm * step;
                }
                torque[i] = to;
                moved = moved.max(step.abs());
            }
            let largest = torque
                .iter()
                .fold(1.0_f64, |most, torque| most.max(torque.abs()));
            if left.iter().all(|left| left.abs() <= BALANCED * largest) {
                return Some(torque);
            }
            if moved <= 1e-15 * largest {
                break;
            }
        }
        None
    }
}

/// Shortening and moment arm of a path at a joint position.
fn evaluate(arm: &MomentArm, q: f64) -> [f64; 2] {
    match arm {
        MomentArm::Constant(arm) => [arm * q, *arm],
        MomentArm::Table(table) => {
            let [shortening, arm, _] = table.evaluate(q);
            [shortening, arm]
        }
    }
}

/// Solves `A x = b` for a symmetric positive definite `A`, row-major, `x` in the place of `b`; `false` where `A` is singular.
fn solve(a: &[f64], b: &mut [f64]) -> bool {
    let factor = Factor::of(a, b.len());
    if let Ok(factor) = &factor {
        factor.solve(b);
    }
    factor.is_ok()
}
