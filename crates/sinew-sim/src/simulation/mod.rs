//! Simulation of a robot and a scenario, frame by frame.

mod measure;
mod setup;

use crate::contacts::Contacts;
use crate::controller::Controller;
use crate::controller_model::ControllerModel;
use crate::error::SimulateError;
use crate::motion::Trajectory;
use crate::paths::Paths;
use crate::plant::{Drive, Inputs, Plant, PointForce};
use crate::sampled::{SampledOffset, SampledPayload, SampledTemperature};
use crate::scenario::{Jam, OffsetKind, Scenario};
use crate::sensors::Sensors;
use sinew_files::interrupt;
use sinew_log::Frame;
use sinew_model::StepError;
use sinew_model::arm::{Arm, BodyInertia};
use sinew_model::correction::JointCorrection;
use sinew_model::tendons::Routings;
use std::collections::VecDeque;

/// True state of a frame. One entry per axis each; 0 for quantities that an axis does not have.
#[derive(Debug, Clone, PartialEq)]
pub struct TrueState {
    /// Time since the start of the recording, s.
    pub time_s: f64,
    /// Commanded joint positions, rad.
    pub q_d: Vec<f64>,
    /// Commanded joint velocities, rad/s: 0 at rest.
    pub dq_d: Vec<f64>,
    /// Joint position, rad.
    pub q: Vec<f64>,
    /// Joint velocity, rad/s.
    pub dq: Vec<f64>,
    /// Motor position as its encoder would show it without error, rad: with a physical offset
    /// in it, without an injected one.
    pub theta: Vec<f64>,
    /// Offset in `theta_measured − q`, rad: physical, of slipped encoders, plus injected where it
    /// was added. That of a tendon which crosses several joints is in rad of the joint that it is paired with.
    pub delta_e: Vec<f64>,
    /// Elastic torque, N·m.
    pub tau_el: Vec<f64>,
    /// Torque of contacts, N·m.
    pub tau_ext: Vec<f64>,
    /// Torque of the tendon in its coordinate, N·m; 0 of a slack strand.
    pub tendon_torque: Vec<f64>,
    /// Tension of the tendon, N, of a loop the difference of its two sides; NaN where no radius is specified.
    pub tension_n: Vec<f64>,
}

/// Components of the offset of a tendon, rad.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct OffsetParts {
    /// Elongation of the rope.
    pub physical: f64,
    /// Added to the recorded motor position by the paper's rule.
    pub injected: f64,
    /// Slip of the motor encoder (positive: measured position too large).
    pub motor_encoder: f64,
    /// Slip of the joint encoder (positive: measured position too small); for a tendon that crosses several joints
    /// the sum over these, each times its moment arm.
    pub joint_encoder: f64,
}

impl OffsetParts {
    /// Returns the offset that `theta_measured − q` contains, rad.
    pub fn sum(self) -> f64 {
        self.physical + self.injected + self.motor_encoder + self.joint_encoder
    }
}

/// A simulated robot that is recorded frame by frame, in constant memory.
///
/// ```no_run
/// # fn f(robot: &sinew_model::robot::Robot) -> Result<(), sinew_sim::SimulateError> {
/// use sinew_sim::{Scenario, Simulation};
/// let mut simulation = Simulation::new(robot, &Scenario::default())?;
/// while let Some(frame) = simulation.next_frame()? {
///     println!("{} {:?}", frame.time_ns, frame.q);
/// }
/// # Ok(()) }
/// ```
#[derive(Debug, Clone)]
pub struct Simulation {
    scenario: Scenario,
    names: Vec<String>,
    /// Names of the tendon on each axis, and of its motor.
    tendons: Vec<String>,
    motors: Vec<String>,
    /// The true arm with an empty gripper.
    empty: Arm,
    plant: Plant,
    controller: Controller,
    trajectory: Trajectory,
    contacts: Contacts,
    sensors: Sensors,
    offsets: Vec<SampledOffset>,
    controller_model: ControllerModel,
    payloads: Vec<SampledPayload>,
    held: Vec<bool>,
    temperature: SampledTemperature,
    /// Jammed joints with their intervals.
    jams: Vec<(usize, Jam)>,
    /// Coulomb friction of each joint without a jam, N·m.
    joint_coulomb_nm: Vec<f64>,
    /// Factor on the stiffness of each tendon from the scenario's time on.
    stiffness_later: Vec<f64>,
    /// Torque per newton of tension, m, by axis; NaN where no radius is specified.
    metres_per_rad: Vec<f64>,
    /// Motor positions of the last frames, the newest last, where they are recorded late.
    shown: VecDeque<Vec<f64>>,
    duration_s: f64,
    control_steps: u64,
    sample_steps: u64,
    settle_steps: u64,
    tick: u64,
    frames: u64,
    frame_count: u64,
    // One entry per joint each.
    q_d: Vec<f64>,
    dq_d: Vec<f64>,
    ddq_d: Vec<f64>,
    tau_el: Vec<f64>,
    tau_ext: Vec<f64>,
    // One entry per axis each.
    tau_m: Vec<f64>,
    /// Motor position measured by the controller.
    theta_read: Vec<f64>,
    delta_e: Vec<f64>,
    stiffness_scale: Vec<f64>,
    forces: Vec<PointForce>,
    frame: Frame,
    truth: TrueState,
}

impl Simulation {
    /// Time since the start of the recording, s; below 0 while the arm settles.
    fn time_s(&self) -> f64 {
        (self.tick as f64 - self.settle_steps as f64) * self.scenario.integration_step_s
    }

    /// Length of the recording, s.
    pub fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// Frames the recording will have, before faults.
    pub fn frame_count(&self) -> u64 {
        self.frame_count
    }

    /// Joint names in the order of a frame.
    pub fn joint_names(&self) -> &[String] {
        &self.names
    }

    /// Name of the tendon on each axis: the joint's own where it has no other.
    pub fn tendon_names(&self) -> &[String] {
        &self.tendons
    }

    /// Name of the motor of each tendon: the joint's own where it has no other.
    pub fn motor_names(&self) -> &[String] {
        &self.motors
    }

    /// Number of axes: entries of the arrays of a frame.
    pub fn axes(&self) -> usize {
        self.plant.drives.len()
    }

    /// Paths of tendons that cross several joints.
    pub(crate) fn paths(&self) -> Option<&Paths> {
        self.plant.paths.as_ref()
    }

    /// Routings of tendons that cross several joints.
    pub(crate) fn routings(&self) -> Option<&Routings> {
        self.paths().map(|paths| &paths.routings)
    }

    /// Whether there is a tendon on an axis, and a motor with it.
    pub(crate) fn has_tendon(&self, i: usize) -> bool {
        self.paths().is_none_or(|paths| paths.has_tendon(i))
    }

    /// First axis with the motor of axis `i`.
    pub(crate) fn motor_axis(&self, i: usize) -> usize {
        self.paths().map_or(i, |paths| paths.motor_axis(i).0)
    }

    /// Ratio of the position in the coordinate of tendon `i` to the position of its motor shaft; `None` if both are
    /// identical.
    pub(crate) fn drive_ratio(&self, i: usize) -> Option<f64> {
        self.routings().map(|routings| routings.drive_ratio(i))
    }

    /// Returns the weight of an offset in the measured position of tendon `i`.
    pub(crate) fn weight(&self, offset: &SampledOffset, i: usize) -> f64 {
        match self.routings() {
            Some(routings) if offset.kind == OffsetKind::JointEncoder => {
                routings.moment_arm(i, offset.joint)
            }
            _ if offset.joint == i => 1.0,
            Some(_) if matches!(offset.kind, OffsetKind::MotorEncoder | OffsetKind::Injected) => {
                self.in_coordinate_of(i, offset.joint)
            }
            _ => 0.0,
        }
    }

    /// Ratio of the position of tendon `i` to that of tendon `of` if one motor drives both; 0 otherwise.
    fn in_coordinate_of(&self, i: usize, of: usize) -> f64 {
        let Some(paths) = self.paths() else {
            return 0.0;
        };
        let ((motor, ratio), (other, of_ratio)) = (paths.motor_axis(i), paths.motor_axis(of));
        if motor == other {
            ratio / of_ratio
        } else {
            0.0
        }
    }

    /// Error of the encoder of joint `i` at `t`, s, rad: its reading is so much smaller.
    fn joint_encoder_error(&self, i: usize, t: f64) -> f64 {
        let own = |o: &&SampledOffset| o.joint == i && o.kind == OffsetKind::JointEncoder;
        let own = self.offsets.iter().filter(own);
        own.fold(0.0, |sum, o| sum + o.size_rad * o.shape.at(t))
    }

    /// The next frame, or `None` at the end.
    ///
    /// # Errors
    /// Returns [`SimulateError::Diverged`] if the simulation diverges.
    pub fn next_frame(&mut self) -> Result<Option<&Frame>, SimulateError> {
        interrupt::check();
        if self.frames >= self.frame_count {
            return Ok(None);
        }
        let target = self.settle_steps + self.frames * self.sample_steps;
        while self.tick < target {
            self.advance()?;
        }
        self.measure()?;
        self.frames += 1;
        Ok(Some(&self.frame))
    }

    /// Returns the true state at the latest frame.
    pub fn true_state(&self) -> &TrueState {
        &self.truth
    }

    /// Offset of the tendon on axis `i` at `t`, s, as the scenario has it, in rad of its coordinate.
    pub fn offset_at(&self, i: usize, t: f64) -> OffsetParts {
        let mut sum = OffsetParts::default();
        for o in &self.offsets {
            let weight = self.weight(o, i);
            if weight == 0.0 {
                continue;
            }
            // A weight of 1 changes no bit.
            let value = weight * (o.size_rad * o.shape.at(t));
            match o.kind {
                OffsetKind::Physical => sum.physical += value,
                OffsetKind::Injected => sum.injected += value,
                OffsetKind::MotorEncoder => sum.motor_encoder += value,
                OffsetKind::JointEncoder => sum.joint_encoder += value,
            }
        }
        sum
    }

    /// Returns the correction of the tendon on axis `i` at `t`, s, as used to correct a recording: injected offsets
    /// included.
    pub fn correction_at(&self, i: usize, t: f64) -> JointCorrection {
        self.controller_model
            .of_joint(i, self.offset_at(i, t).sum())
    }

    /// Whether the correction changes with the true offset.
    pub fn correction_changes(&self) -> bool {
        self.controller_model.follows_truth()
    }

    /// Offsets as drawn.
    pub fn offsets(&self) -> &[SampledOffset] {
        &self.offsets
    }

    /// Payloads as drawn.
    pub fn payloads(&self) -> &[SampledPayload] {
        &self.payloads
    }

    /// Returns the contacts with the environment.
    pub fn contacts(&self) -> &Contacts {
        &self.contacts
    }

    /// Returns the true transmission on every axis.
    pub fn drives(&self) -> &[Drive] {
        &self.plant.drives
    }

    /// Returns the true model of the arm, with an empty gripper.
    pub fn true_empty_arm(&self) -> &Arm {
        &self.empty
    }

    /// Temperature as drawn.
    pub fn temperature(&self) -> &SampledTemperature {
        &self.temperature
    }

    /// Returns the simulated scenario.
    pub fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// One integration step.
    fn advance(&mut self) -> Result<(), SimulateError> {
        let h = self.scenario.integration_step_s;
        let t = self.time_s();
        // Time-dependent values are held at the middle of the step: second order for a smooth profile, and a step
        // change on the grid of steps falls between two of them.
        let middle = t + 0.5 * h;
        self.set_inputs(middle);
        let inputs = Inputs {
            tau_m: &self.tau_m,
            delta_e: &self.delta_e,
            stiffness_scale: &self.stiffness_scale,
            forces: &self.forces,
        };
        self.plant.step(h, &inputs).map_err(|e| diverged(t, e))?;
        self.tick += 1;
        self.begin_tick()
    }

    /// Controller and load at the start of a step.
    fn begin_tick(&mut self) -> Result<(), SimulateError> {
        let t = self.time_s();
        self.change_payload(t)?;
        if self.tick.is_multiple_of(self.control_steps) {
            self.trajectory
                .at(t, &mut self.q_d, &mut self.dq_d, &mut self.ddq_d);
            if self.controller_model.follows_truth() {
                for i in 0..self.axes() {
                    // The set-point needs the offset that acts on the spring; an injected offset does not.
                    let correction = self
                        .controller_model
                        .of_joint(i, self.offset_at(i, t).physical);
                    self.controller.set_correction(i, &correction)?;
                }
            }
            for i in 0..self.axes() {
                self.theta_read[i] = self.plant.state.theta[i] + self.offset_at(i, t).motor_encoder;
            }
            let wanted = [&self.q_d[..], &self.dq_d, &self.ddq_d];
            let dtheta = &self.plant.state.dtheta;
            self.controller
                .step(t, wanted, &self.theta_read, dtheta, &mut self.tau_m)
                .map_err(|e| diverged(t, e))?;
        }
        Ok(())
    }

    fn set_inputs(&mut self, t: f64) {
        if self.offsets.is_empty() {
            self.delta_e.fill(0.0);
        } else {
            for i in 0..self.axes() {
                self.delta_e[i] = self.offset_at(i, t).physical;
            }
        }
        let warmer = self.temperature.at(t) - self.temperature.reference_c;
        for (scale, per_k) in self
            .stiffness_scale
            .iter_mut()
            .zip(&self.temperature.stiffness_per_k)
        {
            *scale = 1.0 + per_k * warmer;
        }
        if t >= self.scenario.truth.stiffness_later_from_s {
            for (scale, later) in self.stiffness_scale.iter_mut().zip(&self.stiffness_later) {
                *scale *= later;
            }
        }
        for (joint, jam) in &self.jams {
            let held = (jam.from_s..jam.to_s).contains(&t);
            self.plant.drives[*joint].joint_friction.coulomb_nm =
                self.joint_coulomb_nm[*joint] + if held { jam.torque_nm } else { 0.0 };
        }
        self.contacts.at(t, &mut self.forces);
    }

    /// Takes up and puts down loads.
    fn change_payload(&mut self, t: f64) -> Result<(), SimulateError> {
        // Half a step of tolerance puts the change on the tick that the file means.
        let soon = t + 0.5 * self.scenario.integration_step_s;
        let holds = |p: &SampledPayload| soon >= p.attach_s && soon < p.release_s;
        let same = self
            .payloads
            .iter()
            .zip(&self.held)
            .all(|(p, &held)| holds(p) == held);
        if same {
            return Ok(());
        }
        let mut arm = self.empty.clone();
        for (p, held) in self.payloads.iter().zip(&mut self.held) {
            *held = holds(p);
            if *held {
                let body = BodyInertia::point(p.mass_kg, p.com_m);
                if let Some(loaded) = arm.with_payload(&p.link, body)? {
                    arm = loaded;
                }
            }
        }
        self.plant.set_arm(arm);
        Ok(())
    }
}

fn diverged(time_s: f64, error: StepError) -> SimulateError {
    SimulateError::Diverged {
        time_s,
        reason: error.to_string(),
    }
}
