//! Routings of all tendons of a robot, as the matrices that the estimate and the observer need.
//!
//! See [`crate::tendons::Coupling::paired`] for the equations.

use crate::friction::Friction;
use crate::moment_arm::{JointSpring, MomentArm, TendonKind};
use crate::routing::{PulledJoint, moved_by_others};
use crate::transmission::Transmission;
use alloc::vec::Vec;

/// Routings of all tendons of a robot as matrices over axes, each in the coordinate of its joint; joints with a tendon of their own
/// have a row of the identity.
///
/// ```text
/// y_i = drive_ratio_i theta_motor − Σ_j rho_ij q_j,   tau_el_j = Σ_i rho_ij f_i,   f = B tau_el,   tau_motor_i = drive_ratio_i f_i
/// ```
///
/// Positions of axes without a joint are 0.
///
/// # Realtime
/// No method but the constructor and [`groups`](Self::groups) allocates; none locks or panics.
#[derive(Debug, Clone, PartialEq)]
pub struct Routings {
    n: usize,
    /// `rho`, row-major `n × n`.
    moment_arms: Vec<f64>,
    /// `B`, row-major `n × n`.
    torque_shares: Vec<f64>,
    /// Stiffness in the coordinate of every axis, N·m/rad; 0 of a rigid one.
    stiffness: Vec<f64>,
    /// `drive_ratio`; 1 of a joint with a motor of its own.
    drive_ratios: Vec<f64>,
    /// Joint in whose rad the coordinate of every axis is.
    joints: Vec<usize>,
    /// Tendons with joints other than their own that they cross.
    crossings: Vec<(usize, usize)>,
    /// Tendons whose group has one equation per joint; empty where there is no such group.
    pulls: Vec<Option<AxisPull>>,
    /// Joints with an equation of their own, by axis; as long as `pulls`.
    pulled: Vec<Option<PulledAxis>>,
    /// Joints of these with a spring.
    sprung: Vec<usize>,
    /// Tendons with joints at which the moment arm varies.
    varying: Vec<(usize, usize, MomentArm)>,
}

/// Tendon on an axis whose group has one equation per joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct AxisPull {
    /// Way in which it pulls.
    pub(crate) kind: TendonKind,
    /// Pretension `f0`, N·m.
    pub(crate) pretension_nm: f64,
    /// Torque per newton of tension, m.
    pub(crate) metres_per_rad: Option<f64>,
    /// First axis with the same motor.
    pub(crate) first_of_motor: usize,
}

/// Joint with an equation of its own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PulledAxis {
    /// Friction of the joint.
    pub friction: Friction,
    /// Passive spring of the joint.
    pub spring: Option<JointSpring>,
    /// `Σ_i rho_ij² K_i`, by which its equation is divided, N·m/rad.
    pub stiffness_nm_per_rad: f64,
}

/// Joints with an equation of their own and tendons that moment arms connect, and with no others.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PulledGroup {
    /// Joints, by axis, increasing.
    pub joints: Vec<usize>,
    /// Axes of the tendons, increasing.
    pub tendons: Vec<usize>,
}

impl Routings {
    /// Collects the routings of a robot; `None` where every joint has a tendon of its own. Allocates.
    ///
    /// * `transmissions`: one entry per axis, `None` for one without a tendon.
    pub fn of(transmissions: &[Option<Transmission>]) -> Option<Self> {
        let routing = |t: &Option<Transmission>| t.as_ref().is_some_and(|t| t.routing.is_some());
        if !transmissions.iter().any(routing) {
            return None;
        }
        let n = transmissions.len();
        let mut routes = Self {
            n,
            moment_arms: alloc::vec![0.0; n * n],
            torque_shares: alloc::vec![0.0; n * n],
            stiffness: alloc::vec![0.0; n],
            drive_ratios: alloc::vec![1.0; n],
            joints: (0..n).collect(),
            crossings: Vec::new(),
            pulls: Vec::new(),
            pulled: Vec::new(),
            sprung: Vec::new(),
            varying: Vec::new(),
        };
        for (i, transmission) in transmissions.iter().enumerate() {
            let row = i * n..(i + 1) * n;
            let (arms, shares) = (
                &mut routes.moment_arms[row.clone()],
                &mut routes.torque_shares[row],
            );
            arms[i] = 1.0;
            shares[i] = 1.0;
            let Some(transmission) = transmission else {
                continue;
            };
            routes.stiffness[i] = transmission.stiffness_nm_per_rad;
            if let Some(routing) =
                (transmission.routing.as_ref()).filter(|routing| routing.moment_arms.len() <= n)
            {
                arms.fill(0.0);
                shares.fill(0.0);
                for (to, arm) in arms.iter_mut().zip(&routing.moment_arms) {
                    *to = *arm;
                }
                for (to, share) in shares.iter_mut().zip(&routing.torque_shares) {
                    *to = *share;
                }
                routes.drive_ratios[i] = routing.drive_ratio;
                routes.joints[i] = routing.joint;
            }
            let others = (0..n).filter(|j| *j != i && arms[*j] != 0.0);
            routes.crossings.extend(others.map(|j| (i, j)));
        }
        routes.collect_pulls(transmissions);
        Some(routes)
    }

    /// Collects the tendons of groups with one equation per joint.
    fn collect_pulls(&mut self, transmissions: &[Option<Transmission>]) {
        let n = self.n;
        let routing = |i: usize| transmissions.get(i)?.as_ref()?.routing.as_ref();
        let of_pull = |i: usize| routing(i)?.pull.as_ref();
        if (0..n).all(|i| of_pull(i).is_none()) {
            return;
        }
        let motor = |i: usize| routing(i).map(|routing| routing.motor.as_str());
        self.pulled = alloc::vec![None; n];
        for i in 0..n {
            let Some(pull) = of_pull(i) else {
                self.pulls.push(None);
                continue;
            };
            self.pulls.push(Some(AxisPull {
                kind: pull.kind,
                pretension_nm: pull.pretension_nm,
                metres_per_rad: pull.metres_per_rad,
                first_of_motor: (0..i).find(|k| motor(*k) == motor(i)).unwrap_or(i),
            }));
            for (j, arm) in pull.varying() {
                self.varying.push((i, j, arm.clone()));
            }
            let stiffness = self.stiffness[i];
            for pulled in &pull.joints {
                let PulledJoint {
                    joint,
                    friction,
                    spring,
                    ..
                } = *pulled;
                let arm = self.moment_arm(i, joint);
                if let Some(to) = self.pulled.get_mut(joint) {
                    let own = to.get_or_insert(PulledAxis {
                        friction,
                        spring,
                        stiffness_nm_per_rad: 0.0,
                    });
                    own.stiffness_nm_per_rad += arm * arm * stiffness;
                }
            }
        }
        let has_spring = |j: &usize| self.pulled[*j].is_some_and(|own| own.spring.is_some());
        self.sprung = (0..n).filter(has_spring).collect();
    }

    /// Pull of the tendon on an axis; `None` where it has an equation of its own.
    #[inline]
    pub(crate) fn pull(&self, i: usize) -> Option<&AxisPull> {
        self.pulls.get(i)?.as_ref()
    }

    /// Joint whose equation is most sensitive to a tendon's offset, and the change there per rad of offset, rad:
    /// `rho_ij K_i / K_j` by the nominal
    /// stiffnesses. The axis itself, with 1, of a tendon with an equation of its own.
    pub fn shown_at(&self, i: usize) -> (usize, f64) {
        if self.pull(i).is_none() {
            return (i, 1.0);
        }
        let stiffness = self.stiffness.get(i).copied().unwrap_or(0.0);
        let share = |j: usize| {
            let own = self
                .pulled(j)
                .map_or(f64::INFINITY, |own| own.stiffness_nm_per_rad);
            self.moment_arm(i, j) * stiffness / own
        };
        let joints = (0..self.n).map(|j| (j, share(j)));
        let most = joints.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
        most.unwrap_or((i, 1.0))
    }

    /// Axis at which the motor of an axis is measured: the first one of those that share a motor.
    #[inline]
    pub fn motor_axis(&self, i: usize) -> usize {
        self.pull(i).map_or(i, |pull| pull.first_of_motor)
    }

    /// Joint with an equation of its own.
    #[inline]
    pub fn pulled(&self, j: usize) -> Option<&PulledAxis> {
        self.pulled.get(j)?.as_ref()
    }

    /// Groups with an equation per joint. Allocates.
    pub fn groups(&self) -> Vec<PulledGroup> {
        let crosses = |i: usize, j: usize| self.pulled(j).is_some() && self.moment_arm(i, j) != 0.0;
        let mut groups: Vec<PulledGroup> = Vec::new();
        for i in (0..self.n).filter(|i| self.pull(*i).is_some()) {
            let mut group = PulledGroup {
                joints: (0..self.n).filter(|j| crosses(i, *j)).collect(),
                tendons: alloc::vec![i],
            };
            groups.retain(|other| {
                let is_apart = other.joints.iter().all(|j| !group.joints.contains(j));
                if !is_apart {
                    group.joints.extend(&other.joints);
                    group.tendons.extend(&other.tendons);
                }
                is_apart
            });
            group.joints.sort_unstable();
            group.joints.dedup();
            group.tendons.sort_unstable();
            groups.push(group);
        }
        groups
    }

    /// Whether a group has an equation per joint.
    pub(crate) fn has_pulls(&self) -> bool {
        !self.pulls.is_empty()
    }

    /// Joints with an equation of their own and a spring.
    pub(crate) fn sprung(&self) -> &[usize] {
        &self.sprung
    }

    /// Tendons with joints at which the moment arm varies.
    pub(crate) fn varying(&self) -> &[(usize, usize, MomentArm)] {
        &self.varying
    }

    /// Nominal pull of a tendon at the extension `y` over its stiffness, rad: `f / K`.
    #[inline]
    pub fn pull_rad(&self, i: usize, y: f64) -> f64 {
        match (self.pull(i), self.stiffness.get(i)) {
            (Some(pull), Some(k)) if pull.kind == TendonKind::Strand && *k > 0.0 => {
                (pull.pretension_nm / k + y).max(0.0)
            }
            _ => y,
        }
    }

    /// Joint in whose rad the coordinate of an axis is; the axis itself where there is no such axis.
    pub fn joint(&self, i: usize) -> usize {
        self.joints.get(i).copied().unwrap_or(i)
    }

    /// Tendons, each with a joint other than its own that it crosses.
    pub(crate) fn crossings(&self) -> &[(usize, usize)] {
        &self.crossings
    }

    /// Moment arms of tendon `i`, `rho_i`, length `n`; empty where there is no such tendon.
    #[inline]
    pub fn moment_arms(&self, i: usize) -> &[f64] {
        let n = self.n;
        self.moment_arms.get(i * n..(i + 1) * n).unwrap_or_default()
    }

    /// Row `i` of `B`.
    #[inline]
    pub(crate) fn torque_shares(&self, i: usize) -> &[f64] {
        let n = self.n;
        self.torque_shares
            .get(i * n..(i + 1) * n)
            .unwrap_or_default()
    }

    /// Moment arm of tendon `i` at joint `j`, `rho_ij`; 0 where there is none.
    #[inline]
    pub fn moment_arm(&self, i: usize, j: usize) -> f64 {
        self.moment_arms(i).get(j).copied().unwrap_or(0.0)
    }

    /// Ratio of the position in the coordinate of tendon `i` to the position of its motor shaft; 1 if there is no such
    /// tendon.
    #[inline]
    pub fn drive_ratio(&self, i: usize) -> f64 {
        self.drive_ratios.get(i).copied().unwrap_or(1.0)
    }

    /// Path of tendon `i` by joint positions, velocities or accelerations, `Σ_j rho_ij x_j`.
    /// Of moment arms that vary, those at `q = 0` count.
    #[inline]
    pub fn path(&self, i: usize, x: &[f64]) -> f64 {
        let arms = self.moment_arms(i).iter().zip(x);
        arms.fold(0.0, |sum, (arm, x)| sum + arm * x)
    }

    /// Adds the torque `f` of tendon `i` to the elastic torques of the joints, N·m.
    #[inline]
    pub fn add_torque(&self, i: usize, f: f64, tau_el: &mut [f64]) {
        for (to, arm) in tau_el.iter_mut().zip(self.moment_arms(i)) {
            *to += arm * f;
        }
    }

    /// Change of the coordinate of tendon `i` due to the joints other than `q_i`, `Σ_j rho_ij q_j − q_i`, rad.
    #[inline]
    pub(crate) fn moved_by_others(&self, i: usize, q: impl Iterator<Item = f64> + Clone) -> f64 {
        moved_by_others(self.moment_arms(i), self.varying_of(i), i, q)
    }

    /// Velocity of the coordinate of tendon `i` due to the joints other than `q_i`, at velocities `dq` and positions `q`, rad/s.
    #[inline]
    pub(crate) fn speed_by_others(
        &self,
        i: usize,
        q: impl Iterator<Item = f64> + Clone,
        dq: impl Iterator<Item = f64> + Clone,
    ) -> f64 {
        let nominal = moved_by_others(self.moment_arms(i), core::iter::empty(), i, dq.clone());
        self.varying_of(i).fold(nominal, |sum, (j, arm)| {
            let [_, arm, _] = arm.evaluate(q.clone().nth(j).unwrap_or(0.0));
            sum + (arm - self.moment_arm(i, j)) * dq.clone().nth(j).unwrap_or(0.0)
        })
    }

    /// Joints at which the moment arm of a tendon varies.
    fn varying_of(&self, i: usize) -> impl Iterator<Item = (usize, &MomentArm)> {
        let own = self.varying.iter().filter(move |(tendon, ..)| *tendon == i);
        own.map(|(_, joint, arm)| (*joint, arm))
    }

    /// Elastic torque of joint `j` over its stiffness, rad, by the nominal stiffnesses: `Σ_i rho_ij K_i y_i / K_j`, of a joint with an
    /// equation of its own `Σ_i rho_ij f_i / K_j`.
    ///
    /// * `y`: extensions in the coordinates of the tendons, `n`, rad.
    #[inline]
    pub(crate) fn joint_deflection(&self, j: usize, y: impl Iterator<Item = f64>) -> f64 {
        let rows = self.moment_arms.chunks_exact(self.n.max(1));
        let tendons = rows.zip(&self.stiffness).zip(y);
        let pulled = self.pulled(j);
        let torque = tendons.enumerate().fold(0.0, |sum, (i, ((row, k), y))| {
            let y = match pulled {
                Some(_) => self.pull_rad(i, y),
                None => y,
            };
            sum + row.get(j).copied().unwrap_or(0.0) * k * y
        });
        let stiffness = match pulled {
            Some(pulled) => pulled.stiffness_nm_per_rad,
            None => self.stiffness.get(j).copied().unwrap_or(0.0),
        };
        if stiffness > 0.0 {
            torque / stiffness
        } else {
            0.0
        }
    }

    /// Torque of tendon `i` that carries elastic torques of the joints, `Σ_j B_ij tau_j`, N·m.
    #[inline]
    pub fn torque_of(&self, i: usize, x: impl Iterator<Item = f64>) -> f64 {
        let shares = self.torque_shares(i).iter().zip(x);
        shares.fold(0.0, |sum, (share, x)| sum + share * x)
    }
}
