//! The joint-elastic arm and its integrator.

use super::friction::Friction;
use super::paths::Paths;
use sinew_model::StepError;
use sinew_model::arm::{Arm, ArmWorkspace};

/// End stop: a stiff spring with damping beyond an angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EndStop {
    /// Position at which the stop begins, rad.
    pub at_rad: f64,
    /// Whether the stop limits the joint from above.
    pub is_upper: bool,
    /// Contact stiffness of the stop, N·m/rad.
    pub stiffness_nm_per_rad: f64,
}

impl EndStop {
    /// Time constant of its damping, s, which prevents bouncing.
    const DAMPING_S: f64 = 1e-3;

    /// Torque on the joint, N·m: it only pushes away.
    fn torque(&self, q: f64, dq: f64) -> f64 {
        let side = if self.is_upper { 1.0 } else { -1.0 };
        let (into, speed) = (side * (q - self.at_rad), side * dq);
        if into <= 0.0 {
            return 0.0;
        }
        -side * (self.stiffness_nm_per_rad * (into + Self::DAMPING_S * speed)).max(0.0)
    }
}

/// True parameters of one elastic transmission. For a tendon that crosses several joints they are in the coordinate of
/// the joint that it is paired with. Joint parameters are unused on an axis without a joint, and tendon parameters on
/// an axis without a tendon.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// Torsional stiffness `K`, N·m/rad.
    pub stiffness_nm_per_rad: f64,
    /// Torque of a strand at `theta = 0`, `q = 0` and `delta = 0`, N·m; 0 for a bidirectional tendon.
    pub pretension_nm: f64,
    /// Cubic coefficient `c` of `tau_el = K x (1 + c x²)`, rad⁻².
    pub cubic_per_rad2: f64,
    /// Share of delayed elasticity.
    pub viscoelastic_fraction: f64,
    /// Time constant of the viscoelastic element, s.
    pub viscoelastic_time_s: f64,
    /// Motor inertia reflected to the joint, kg·m².
    pub motor_inertia_kg_m2: f64,
    /// At the joint itself.
    pub joint_friction: Friction,
    /// At the motor.
    pub motor_friction: Friction,
    /// Lower and upper end stop of the joint.
    pub stops: [Option<EndStop>; 2],
}

impl Drive {
    /// Torque at the deflection `x`, N·m.
    #[inline]
    pub fn spring(&self, x: f64, stiffness_scale: f64) -> f64 {
        self.stiffness_nm_per_rad * stiffness_scale * x * (1.0 + self.cubic_per_rad2 * x * x)
    }

    /// Returns the torque of a strand at the deflection `x`, N·m, which is never negative. A stiffness loss reduces
    /// the pretension by the same share.
    #[inline]
    pub fn strand(&self, x: f64, stiffness_scale: f64) -> f64 {
        (self.pretension_nm * stiffness_scale + self.spring(x, stiffness_scale)).max(0.0)
    }

    /// Energy in the spring at the deflection `x`, J.
    #[cfg(test)]
    pub fn spring_energy(&self, x: f64) -> f64 {
        let x2 = x * x;
        self.stiffness_nm_per_rad * (0.5 * x2 + 0.25 * self.cubic_per_rad2 * x2 * x2)
    }

    /// The deflection that gives `tau_el`, rad, by Newton's method on a rising function.
    pub fn deflection(&self, tau_el: f64, stiffness_scale: f64) -> f64 {
        let k = self.stiffness_nm_per_rad * stiffness_scale;
        let mut x = tau_el / k;
        const STEPS: usize = 60;
        for _ in 0..STEPS {
            let slope = k * (1.0 + 3.0 * self.cubic_per_rad2 * x * x);
            let step = (self.spring(x, stiffness_scale) - tau_el) / slope;
            x -= step;
            if step.abs() <= 1e-17 + 1e-16 * x.abs() {
                break;
            }
        }
        x
    }
}

/// External force on a link.
#[derive(Debug, Clone, PartialEq)]
pub struct PointForce {
    pub link: String,
    pub point_m: [f64; 3],
    pub force_n: [f64; 3],
}

/// Inputs of the plant during one step, one entry per axis each.
pub(crate) struct Inputs<'a> {
    /// Motor torque, N·m; of a motor with several tendons in the coordinate of the first.
    pub tau_m: &'a [f64],
    /// Length the ropes have gained, as motor position, rad.
    pub delta_e: &'a [f64],
    /// Factor on the stiffness.
    pub stiffness_scale: &'a [f64],
    /// Forces of the contacts.
    pub forces: &'a [PointForce],
}

/// State of the arm.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct State {
    /// Joint positions and velocities, one per joint, rad and rad/s.
    pub q: Vec<f64>,
    pub dq: Vec<f64>,
    /// Motor positions (encoder values in the coordinate of the tendon) and velocities. One entry per axis from here
    /// on.
    pub theta: Vec<f64>,
    pub dtheta: Vec<f64>,
    /// Delayed deflection of the rope, rad.
    pub creep: Vec<f64>,
    /// Pre-sliding of every joint, and of every motor.
    pub z_joint: Vec<f64>,
    pub z_motor: Vec<f64>,
}

impl State {
    /// * `axes`: their number, at least that of the joints.
    pub(crate) fn at_rest(q: Vec<f64>, axes: usize) -> Self {
        let (of_joints, of_axes) = (vec![0.0; q.len()], vec![0.0; axes]);
        let mut theta = q.clone();
        theta.resize(axes, 0.0);
        Self {
            theta,
            q,
            dq: of_joints.clone(),
            dtheta: of_axes.clone(),
            creep: of_axes.clone(),
            z_joint: of_joints,
            z_motor: of_axes,
        }
    }
}

/// Rates of change of the five integrated vectors.
#[derive(Debug, Clone)]
struct Rates {
    dq: Vec<f64>,
    ddq: Vec<f64>,
    dtheta: Vec<f64>,
    ddtheta: Vec<f64>,
    dcreep: Vec<f64>,
}

impl Rates {
    fn new(dof: usize, axes: usize) -> Self {
        let (of_joints, of_axes) = (vec![0.0; dof], vec![0.0; axes]);
        Self {
            dq: of_joints.clone(),
            ddq: of_joints,
            dtheta: of_axes.clone(),
            ddtheta: of_axes.clone(),
            dcreep: of_axes,
        }
    }
}

/// The arm, its drives and its state, integrated with a fixed step:
///
/// ```text
/// M(q) ddq + C dq + g + tau_friction_joint = tau_el + tau_ext
/// I_m ddtheta + tau_friction_motor + tau_el = tau_m
/// tau_el = K x (1 + c x²),   x = theta − delta_e − q − v,   v̇ = (s tau_el/K − v)/T
/// ```
///
/// Tendons that cross several joints have [`Paths`], and the torque `f` of a tendon is not the elastic torque of a joint:
///
/// ```text
/// I_m ddtheta + tau_friction_motor + f = tau_m,   f = K x (1 + c x²),   v̇ = (s f/K − v)/T
/// x = theta − delta_e − l(q) − v,                 tau_el_j = Σ_i (∂l_i/∂q_j) f_i,   l = rho q where moment arms are constant
/// ```
///
/// A strand is unidirectional, `f = max(0, f0 + K x (1 + c x²))`, and its delayed elasticity follows `f − f0`. A
/// passive spring of a joint adds
/// `−k_s (q − q_rest)` to its `tau_el`. A motor with several tendons carries the sum of their torques.
///
/// Classical Runge–Kutta of fourth order, with the pre-sliding of friction solved exactly along
/// the travel since the step began. Without dry friction the error falls with the fourth power
/// of the step; a reversal with dry friction is a kink, where it falls with the second.
#[derive(Debug, Clone)]
pub(crate) struct Plant {
    pub arm: Arm,
    pub drives: Vec<Drive>,
    /// Paths of tendons that cross several joints.
    pub paths: Option<Paths>,
    pub state: State,
    ws: ArmWorkspace,
    stage: State,
    k: [Rates; 4],
    tau: Vec<f64>,
    /// Torques of the tendons, of the motors and of the joints they cross, N·m; unused without paths.
    tendon_torque: Vec<f64>,
    motor_load: Vec<f64>,
    tau_el: Vec<f64>,
}

impl Plant {
    pub(crate) fn new(arm: Arm, drives: Vec<Drive>, paths: Option<Paths>, state: State) -> Self {
        let (dof, axes) = (arm.dof(), drives.len());
        Self {
            ws: ArmWorkspace::new(&arm),
            arm,
            drives,
            paths,
            stage: state.clone(),
            state,
            k: std::array::from_fn(|_| Rates::new(dof, axes)),
            tau: vec![0.0; dof],
            tendon_torque: vec![0.0; axes],
            motor_load: vec![0.0; axes],
            tau_el: vec![0.0; dof],
        }
    }

    /// Attaches or releases a load: masses change, positions and velocities do not.
    pub(crate) fn set_arm(&mut self, arm: Arm) {
        debug_assert_eq!(arm.dof(), self.arm.dof());
        self.arm = arm;
    }

    /// Torques of the tendons in their coordinates and elastic torques of the joints, N·m.
    ///
    /// * `tendons`: one entry per axis, 0 without a tendon. `tau_el`: one entry per joint, without its passive spring.
    pub(crate) fn elastic_torques(
        &self,
        inputs: &Inputs<'_>,
        tendons: &mut [f64],
        tau_el: &mut [f64],
    ) {
        elastic_torques(
            self.paths.as_ref(),
            &self.drives,
            &self.state,
            inputs,
            (tendons, tau_el),
        );
    }

    /// Returns `tau_ext = Σ Jᵀ f` at the present state, N·m.
    pub(crate) fn external_torque(
        &mut self,
        forces: &[PointForce],
        out: &mut [f64],
    ) -> Result<(), StepError> {
        out.fill(0.0);
        for f in forces {
            self.arm.add_point_force(
                &mut self.ws,
                &self.state.q,
                &f.link,
                f.point_m,
                f.force_n,
                out,
            )?;
        }
        Ok(())
    }

    /// Returns the gravity torque at the present state, N·m.
    pub(crate) fn gravity_torque(&mut self) -> Result<&[f64], StepError> {
        // The workspace's velocity scratch is the stage, which is free between steps.
        self.stage.dq.fill(0.0);
        Ok(self
            .arm
            .momentum(&mut self.ws, &self.state.q, &self.stage.dq)?
            .g)
    }

    /// Advances by `h`, s.
    pub(crate) fn step(&mut self, h: f64, inputs: &Inputs<'_>) -> Result<(), StepError> {
        for stage in 0..4 {
            match stage {
                0 => self.stage.clone_from(&self.state),
                1 | 2 => self.advance(stage - 1, 0.5 * h),
                _ => self.advance(stage - 1, h),
            }
            self.rates(stage, inputs)?;
        }
        let weight = h / 6.0;
        let s = &mut self.state;
        let [a, b, c, d] = &self.k;
        for (i, drive) in self.drives.iter().enumerate() {
            let sum =
                |f: fn(&Rates) -> &[f64]| weight * (f(a)[i] + 2.0 * (f(b)[i] + f(c)[i]) + f(d)[i]);
            if i < s.q.len() {
                let travel = sum(|r| &r.dq);
                s.z_joint[i] = drive.joint_friction.presliding(s.z_joint[i], travel);
                s.q[i] += travel;
                s.dq[i] += sum(|r| &r.ddq);
            }
            let motor_travel = sum(|r| &r.dtheta);
            s.z_motor[i] = drive.motor_friction.presliding(s.z_motor[i], motor_travel);
            s.theta[i] += motor_travel;
            s.dtheta[i] += sum(|r| &r.ddtheta);
            s.creep[i] += sum(|r| &r.dcreep);
        }
        follow(self.paths.as_ref(), s);
        Ok(())
    }

    /// Puts the stage at `state + h k[from]`.
    fn advance(&mut self, from: usize, h: f64) {
        let (s, k, out) = (&self.state, &self.k[from], &mut self.stage);
        for (i, drive) in self.drives.iter().enumerate() {
            if i < s.q.len() {
                out.q[i] = s.q[i] + h * k.dq[i];
                out.dq[i] = s.dq[i] + h * k.ddq[i];
                if drive.joint_friction.is_dry() {
                    out.z_joint[i] = drive.joint_friction.presliding(s.z_joint[i], h * k.dq[i]);
                }
            }
            out.theta[i] = s.theta[i] + h * k.dtheta[i];
            out.dtheta[i] = s.dtheta[i] + h * k.ddtheta[i];
            out.creep[i] = s.creep[i] + h * k.dcreep[i];
            if drive.motor_friction.is_dry() {
                out.z_motor[i] = drive
                    .motor_friction
                    .presliding(s.z_motor[i], h * k.dtheta[i]);
            }
        }
        follow(self.paths.as_ref(), out);
    }

    /// Rates of change at the stage.
    fn rates(&mut self, stage: usize, inputs: &Inputs<'_>) -> Result<(), StepError> {
        let (s, k) = (&self.stage, &mut self.k[stage]);
        elastic_torques(
            self.paths.as_ref(),
            &self.drives,
            s,
            inputs,
            (&mut self.tendon_torque, &mut self.tau_el),
        );
        self.motor_load.clone_from(&self.tendon_torque);
        for (i, first, ratio) in self.paths.iter().flat_map(Paths::followers) {
            self.motor_load[*first] += ratio * self.tendon_torque[*i];
        }
        for (i, drive) in self.drives.iter().enumerate() {
            let (tendon, load) = (self.tendon_torque[i], self.motor_load[i]);
            let motor = drive.motor_friction.torque(s.z_motor[i], s.dtheta[i], load);
            k.dtheta[i] = s.dtheta[i];
            k.ddtheta[i] = (inputs.tau_m[i] - motor - load) / drive.motor_inertia_kg_m2;
            let scale = inputs.stiffness_scale[i];
            let stiffness = drive.stiffness_nm_per_rad * scale;
            let beyond = tendon - scale * drive.pretension_nm;
            let deflection = if stiffness > 0.0 {
                beyond / stiffness
            } else {
                0.0
            };
            k.dcreep[i] =
                (drive.viscoelastic_fraction * deflection - s.creep[i]) / drive.viscoelastic_time_s;
            let Some(tau_el) = self.tau_el.get(i) else {
                continue;
            };
            k.dq[i] = s.dq[i];
            let stops = drive.stops.iter().flatten();
            let stop: f64 = stops.map(|stop| stop.torque(s.q[i], s.dq[i])).sum();
            self.tau[i] =
                tau_el - drive.joint_friction.torque(s.z_joint[i], s.dq[i], *tau_el) + stop;
            if let Some(paths) = &self.paths {
                self.tau[i] -= paths.spring_torque(i, s.q[i]);
            }
        }
        for f in inputs.forces {
            self.arm.add_point_force(
                &mut self.ws,
                &s.q,
                &f.link,
                f.point_m,
                f.force_n,
                &mut self.tau,
            )?;
        }
        self.arm
            .forward_dynamics(&mut self.ws, &s.q, &s.dq, &self.tau, &mut k.ddq)
    }
}

/// Torques of the tendons, by axis, and elastic torques of the joints, N·m.
fn elastic_torques(
    paths: Option<&Paths>,
    drives: &[Drive],
    s: &State,
    inputs: &Inputs<'_>,
    (tendons, tau_el): (&mut [f64], &mut [f64]),
) {
    let Some(paths) = paths else {
        for (i, drive) in drives.iter().enumerate() {
            let x = s.theta[i] - inputs.delta_e[i] - s.q[i] - s.creep[i];
            tendons[i] = drive.spring(x, inputs.stiffness_scale[i]);
        }
        tau_el.copy_from_slice(tendons);
        return;
    };
    tau_el.fill(0.0);
    for (i, drive) in drives.iter().enumerate() {
        tendons[i] = 0.0;
        if !paths.has_tendon(i) {
            continue;
        }
        let x = s.theta[i] - inputs.delta_e[i] - paths.shortening(i, &s.q) - s.creep[i];
        let scale = inputs.stiffness_scale[i];
        let torque = match paths.is_strand(i) {
            true => drive.strand(x, scale),
            false => drive.spring(x, scale),
        };
        tendons[i] = torque;
        paths.add_torque(i, &s.q, torque, tau_el);
    }
}

/// Moves tendons with the motors that they share with one before them.
fn follow(paths: Option<&Paths>, s: &mut State) {
    for (i, first, ratio) in paths.into_iter().flat_map(Paths::followers) {
        s.theta[*i] = ratio * s.theta[*first];
        s.dtheta[*i] = ratio * s.dtheta[*first];
    }
}
