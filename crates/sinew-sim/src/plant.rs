//! The joint-elastic arm and its integrator.

use super::friction::Friction;
use sinew_model::StepError;
use sinew_model::arm::{Arm, ArmWorkspace};
use sinew_model::tendons::Routings;

/// An end stop: a stiff spring with some damping beyond an angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EndStop {
    /// Where it begins, rad.
    pub at_rad: f64,
    /// Whether it holds the joint from above.
    pub is_upper: bool,
    /// What it gives by, N·m/rad.
    pub stiffness_nm_per_rad: f64,
}

impl EndStop {
    /// Time constant of its damping, s: it doesn't bounce.
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

/// One elastic transmission, as it truly is; of a tendon that crosses several joints in the coordinate of the joint that it is
/// paired with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// `K`, N·m/rad.
    pub stiffness_nm_per_rad: f64,
    /// `c` of `tau_el = K x (1 + c x²)`, rad⁻².
    pub cubic_per_rad2: f64,
    /// Share of delayed elasticity.
    pub viscoelastic_fraction: f64,
    /// Its time constant, s.
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

/// A force on a link.
#[derive(Debug, Clone, PartialEq)]
pub struct PointForce {
    pub link: String,
    pub point_m: [f64; 3],
    pub force_n: [f64; 3],
}

/// What acts on the arm during one step. All of length `n`.
pub(crate) struct Inputs<'a> {
    /// Motor torque, N·m.
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
    /// Joint positions and velocities, rad and rad/s.
    pub q: Vec<f64>,
    pub dq: Vec<f64>,
    /// Motor positions (what its encoder shows, in the coordinate of the tendon) and velocities.
    pub theta: Vec<f64>,
    pub dtheta: Vec<f64>,
    /// Delayed deflection of the rope, rad.
    pub creep: Vec<f64>,
    /// Pre-sliding of joint and motor.
    pub z_joint: Vec<f64>,
    pub z_motor: Vec<f64>,
}

impl State {
    pub(crate) fn at_rest(q: Vec<f64>) -> Self {
        let n = q.len();
        let zero = vec![0.0; n];
        Self {
            theta: q.clone(),
            q,
            dq: zero.clone(),
            dtheta: zero.clone(),
            creep: zero.clone(),
            z_joint: zero.clone(),
            z_motor: zero,
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
    fn new(n: usize) -> Self {
        let zero = vec![0.0; n];
        Self {
            dq: zero.clone(),
            ddq: zero.clone(),
            dtheta: zero.clone(),
            ddtheta: zero.clone(),
            dcreep: zero,
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
/// Tendons that cross several joints have [`Routings`], and the torque `f` of a tendon is not the elastic torque of a joint:
///
/// ```text
/// I_m ddtheta + tau_friction_motor + f = tau_m,   f = K x (1 + c x²),   v̇ = (s f/K − v)/T
/// x = theta − delta_e − rho q − v,                tau_el = rhoᵀ f
/// ```
///
/// Classical Runge–Kutta of fourth order, with the pre-sliding of friction solved exactly along
/// the travel since the step began. Without dry friction the error falls with the fourth power
/// of the step; a reversal with dry friction is a kink, where it falls with the second.
#[derive(Debug, Clone)]
pub(crate) struct Plant {
    pub arm: Arm,
    pub drives: Vec<Drive>,
    /// Of tendons that cross several joints.
    pub routings: Option<Routings>,
    pub state: State,
    ws: ArmWorkspace,
    stage: State,
    k: [Rates; 4],
    tau: Vec<f64>,
    /// Torques of the tendons and of the joints they cross, N·m; unused without routings.
    tendon_torque: Vec<f64>,
    tau_el: Vec<f64>,
}

impl Plant {
    pub(crate) fn new(
        arm: Arm,
        drives: Vec<Drive>,
        routings: Option<Routings>,
        state: State,
    ) -> Self {
        let n = arm.dof();
        Self {
            ws: ArmWorkspace::new(&arm),
            arm,
            drives,
            routings,
            stage: state.clone(),
            state,
            k: std::array::from_fn(|_| Rates::new(n)),
            tau: vec![0.0; n],
            tendon_torque: vec![0.0; n],
            tau_el: vec![0.0; n],
        }
    }

    /// Takes up or puts down a load: masses change, positions and velocities don't.
    pub(crate) fn set_arm(&mut self, arm: Arm) {
        debug_assert_eq!(arm.dof(), self.arm.dof());
        self.arm = arm;
    }

    /// `tau_el` of every joint, N·m.
    pub(crate) fn elastic_torque(&self, inputs: &Inputs<'_>, out: &mut [f64]) {
        if let Some(routings) = &self.routings {
            out.fill(0.0);
            for (i, drive) in self.drives.iter().enumerate() {
                let x = extension(routings, &self.state, inputs, i);
                routings.add_torque(i, drive.spring(x, inputs.stiffness_scale[i]), out);
            }
            return;
        }
        for (i, drive) in self.drives.iter().enumerate() {
            let x = self.state.theta[i] - inputs.delta_e[i] - self.state.q[i] - self.state.creep[i];
            out[i] = drive.spring(x, inputs.stiffness_scale[i]);
        }
    }

    /// `tau_ext = Σ Jᵀ f` at the present state, N·m.
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

    /// Gravity torque at the present state, N·m.
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
            let travel = sum(|r| &r.dq);
            let motor_travel = sum(|r| &r.dtheta);
            s.z_joint[i] = drive.joint_friction.presliding(s.z_joint[i], travel);
            s.z_motor[i] = drive.motor_friction.presliding(s.z_motor[i], motor_travel);
            s.q[i] += travel;
            s.dq[i] += sum(|r| &r.ddq);
            s.theta[i] += motor_travel;
            s.dtheta[i] += sum(|r| &r.ddtheta);
            s.creep[i] += sum(|r| &r.dcreep);
        }
        Ok(())
    }

    /// Puts the stage at `state + h k[from]`.
    fn advance(&mut self, from: usize, h: f64) {
        let (s, k, out) = (&self.state, &self.k[from], &mut self.stage);
        for (i, drive) in self.drives.iter().enumerate() {
            out.q[i] = s.q[i] + h * k.dq[i];
            out.dq[i] = s.dq[i] + h * k.ddq[i];
            out.theta[i] = s.theta[i] + h * k.dtheta[i];
            out.dtheta[i] = s.dtheta[i] + h * k.ddtheta[i];
            out.creep[i] = s.creep[i] + h * k.dcreep[i];
            if drive.joint_friction.is_dry() {
                out.z_joint[i] = drive.joint_friction.presliding(s.z_joint[i], h * k.dq[i]);
            }
            if drive.motor_friction.is_dry() {
                out.z_motor[i] = drive
                    .motor_friction
                    .presliding(s.z_motor[i], h * k.dtheta[i]);
            }
        }
    }

    /// Rates of change at the stage.
    fn rates(&mut self, stage: usize, inputs: &Inputs<'_>) -> Result<(), StepError> {
        let (s, k) = (&self.stage, &mut self.k[stage]);
        if let Some(routings) = &self.routings {
            self.tau_el.fill(0.0);
            for (i, drive) in self.drives.iter().enumerate() {
                let x = extension(routings, s, inputs, i);
                let torque = drive.spring(x, inputs.stiffness_scale[i]);
                self.tendon_torque[i] = torque;
                routings.add_torque(i, torque, &mut self.tau_el);
            }
        }
        for (i, drive) in self.drives.iter().enumerate() {
            let scale = inputs.stiffness_scale[i];
            let (tendon, tau_el) = match self.routings {
                Some(_) => (self.tendon_torque[i], self.tau_el[i]),
                None => {
                    let x = s.theta[i] - inputs.delta_e[i] - s.q[i] - s.creep[i];
                    let tau_el = drive.spring(x, scale);
                    (tau_el, tau_el)
                }
            };
            let motor = drive
                .motor_friction
                .torque(s.z_motor[i], s.dtheta[i], tendon);
            k.dq[i] = s.dq[i];
            k.dtheta[i] = s.dtheta[i];
            k.ddtheta[i] = (inputs.tau_m[i] - motor - tendon) / drive.motor_inertia_kg_m2;
            let stiffness = drive.stiffness_nm_per_rad * scale;
            k.dcreep[i] = (drive.viscoelastic_fraction * tendon / stiffness - s.creep[i])
                / drive.viscoelastic_time_s;
            let stops = drive.stops.iter().flatten();
            let stop: f64 = stops.map(|stop| stop.torque(s.q[i], s.dq[i])).sum();
            self.tau[i] =
                tau_el - drive.joint_friction.torque(s.z_joint[i], s.dq[i], tau_el) + stop;
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

/// Extension of tendon `i` of those that cross several joints, rad of its coordinate.
fn extension(routings: &Routings, s: &State, inputs: &Inputs<'_>, i: usize) -> f64 {
    s.theta[i] - inputs.delta_e[i] - routings.path(i, &s.q) - s.creep[i]
}
