//! A robot and a scenario, frame by frame.

use super::contacts::Contacts;
use super::controller::Controller;
use super::error::SimulateError;
use super::friction::Friction;
use super::motion::Trajectory;
use super::plant::{Drive, Inputs, Plant, PointForce, State};
use super::scenario::{
    FrictionSpec, OffsetKind, PerJoint, Scenario, Shape, Stream, interpolate, rng,
};
use super::sensors::Sensors;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use sinew_log::Frame;
use sinew_model::StepError;
use sinew_model::arm::{Arm, BodyInertia};
use sinew_model::robot::Robot;
use sinew_model::transmission::Transmission;
use std::collections::VecDeque;

/// An offset, drawn.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct DrawnOffset {
    pub(crate) joint: usize,
    pub(crate) kind: OffsetKind,
    pub(crate) size_rad: f64,
    pub(crate) shape: Shape,
}

/// A load, drawn.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct DrawnPayload {
    pub(crate) link: String,
    pub(crate) mass_kg: f64,
    pub(crate) com_m: [f64; 3],
    pub(crate) attach_s: f64,
    pub(crate) release_s: f64,
}

/// A joint that sticks.
#[derive(Debug, Clone, Copy, PartialEq)]
struct DrawnJam {
    joint: usize,
    torque_nm: f64,
    from_s: f64,
    to_s: f64,
}

/// Temperature and its effects, drawn.
#[derive(Debug, Clone)]
pub(crate) struct DrawnTemperature {
    reference_c: f64,
    profile_c: Vec<(f64, f64)>,
    pub(crate) change_k: f64,
    change_from_to_s: (f64, f64),
    reading_error_k: f64,
    reading_error_from_s: f64,
    stiffness_per_k: Vec<f64>,
    drift_rad_per_k: Vec<f64>,
}

impl DrawnTemperature {
    /// °C at `t`, s.
    fn at(&self, t: f64) -> f64 {
        let base = if self.profile_c.is_empty() {
            self.reference_c
        } else {
            interpolate(&self.profile_c, t)
        };
        let (from, to) = self.change_from_to_s;
        let share = if t <= from {
            0.0
        } else if t >= to {
            1.0
        } else {
            (t - from) / (to - from)
        };
        // A change from 0 to 0 s is there from the start.
        let share = if to == 0.0 { 1.0 } else { share };
        base + share * self.change_k
    }
}

/// The true state behind a frame. All of length `n`.
#[derive(Debug, Clone, PartialEq)]
pub struct TrueState {
    /// Time since the start of the recording, s.
    pub time_s: f64,
    /// Joint position, rad.
    pub q: Vec<f64>,
    /// Joint velocity, rad/s.
    pub dq: Vec<f64>,
    /// Motor position as its encoder would show it without error, rad: with a physical offset
    /// in it, without an injected one.
    pub theta: Vec<f64>,
    /// Offset in the recorded motor position, rad: physical, plus injected where it was added.
    pub delta_e: Vec<f64>,
    /// Elastic torque, N·m.
    pub tau_el: Vec<f64>,
    /// Torque of contacts, N·m.
    pub tau_ext: Vec<f64>,
}

/// A simulated robot that is recorded frame by frame, in constant memory.
///
/// ```no_run
/// # fn f(robot: &sinew_model::robot::Robot) -> Result<(), sinew_lab::simulate::SimulateError> {
/// use sinew_lab::simulate::{Scenario, Simulation};
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
    /// The true arm with an empty gripper.
    empty: Arm,
    plant: Plant,
    controller: Controller,
    trajectory: Trajectory,
    contacts: Contacts,
    sensors: Sensors,
    offsets: Vec<DrawnOffset>,
    payloads: Vec<DrawnPayload>,
    held: Vec<bool>,
    temperature: DrawnTemperature,
    jams: Vec<DrawnJam>,
    /// Coulomb friction of each joint without a jam, N·m.
    joint_coulomb_nm: Vec<f64>,
    /// Factor on the stiffness of each joint from the scenario's time on.
    stiffness_later: Vec<f64>,
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
    tau_m: Vec<f64>,
    delta_e: Vec<f64>,
    stiffness_scale: Vec<f64>,
    forces: Vec<PointForce>,
    frame: Frame,
    truth: TrueState,
}

impl Simulation {
    /// Draws the truth and puts the arm at rest at its first pose.
    ///
    /// # Errors
    /// [`SimulateError`]: a joint or link the robot doesn't have, a joint without an elastic
    /// transmission or motor inertia, rates that don't fit the integration step, a motion that
    /// never ends without a duration.
    pub fn new(robot: &Robot, scenario: &Scenario) -> Result<Self, SimulateError> {
        let names = robot.joint_names().to_vec();
        check_names(robot, scenario)?;
        let transmissions = transmissions(robot)?;
        let nominal_inertia: Vec<f64> = transmissions
            .iter()
            .map(|t| t.motor_inertia_kg_m2.unwrap_or(0.0))
            .collect();
        let steps_per = |what: &str, rate: f64| {
            scenario
                .steps_per(rate)
                .ok_or_else(|| SimulateError::Value {
                    file: scenario.file.clone(),
                    line: 0,
                    key: what.into(),
                    value: format!("{rate} (Hz)"),
                    why: "must be a rate whose period is a multiple of integration_step_s".into(),
                })
        };
        let control_steps = steps_per("control_rate_hz", scenario.control_rate_hz)?;
        let sample_steps = steps_per("sample_rate_hz", scenario.sample_rate_hz)?;

        // Everything drawn for the robot comes from one stream in a fixed order.
        let robot_seed = scenario.robot_seed.unwrap_or(scenario.seed);
        let mut truth_rng = rng(robot_seed, Stream::Truth);
        let empty = true_arm(robot, scenario, &mut truth_rng)?;
        let drives = drives(scenario, &names, &transmissions, &mut truth_rng);
        let temperature = draw_temperature(scenario, &names, &mut truth_rng);
        let payloads: Vec<DrawnPayload> = scenario
            .payloads
            .iter()
            .map(|p| DrawnPayload {
                link: p.link.clone(),
                mass_kg: p.mass_kg.sample(&mut truth_rng),
                com_m: p.com_m,
                attach_s: p.attach_s,
                release_s: p.release_s,
            })
            .collect();
        // What the language learned later is drawn from a stream of its own.
        let mut later_rng = rng(robot_seed, Stream::Later);
        let offsets: Vec<DrawnOffset> = scenario
            .offsets
            .iter()
            .filter_map(|o| {
                Some(DrawnOffset {
                    joint: robot.arm.joint_index(&o.joint)?,
                    kind: o.kind,
                    size_rad: o.size_rad.sample(&mut truth_rng),
                    shape: o.shape.later(o.later_s.sample(&mut later_rng)),
                })
            })
            .collect();
        let sensors = Sensors::new(
            scenario,
            &names,
            &mut truth_rng,
            &mut later_rng,
            rng(scenario.seed, Stream::Sensors),
        );
        let stiffness_later = scenario.truth.stiffness_later_factor.sample(
            &names,
            &vec![1.0; names.len()],
            &mut later_rng,
        );
        let jams = scenario
            .jams
            .iter()
            .filter_map(|j| {
                Some(DrawnJam {
                    joint: robot.arm.joint_index(&j.joint)?,
                    torque_nm: j.torque_nm,
                    from_s: j.from_s,
                    to_s: j.to_s,
                })
            })
            .collect();
        let controller = Controller::new(
            &robot.arm,
            &transmissions,
            &nominal_inertia,
            &scenario.controller,
            1.0 / scenario.control_rate_hz,
            &mut truth_rng,
        );
        let limits: Vec<(f64, f64)> = robot.limits.iter().map(|l| (l.lower, l.upper)).collect();
        let trajectory = Trajectory::new(
            &scenario.motion,
            &names,
            &limits,
            rng(scenario.seed, Stream::Motion),
            |line, name| unknown(robot, scenario, line, "joint", name),
        )?;
        let duration_s = scenario
            .duration_s
            .or(trajectory.length_s())
            .ok_or_else(|| SimulateError::Missing {
                file: scenario.file.clone(),
                line: 1,
                section: "the scenario".into(),
                key: "duration_s".into(),
                why: "this motion never ends by itself".into(),
            })?;

        let n = names.len();
        let joint_coulomb_nm = drives.iter().map(|d| d.joint_friction.coulomb_nm).collect();
        let zero = vec![0.0; n];
        let start = trajectory.start().to_vec();
        let period_s = control_steps as f64 * scenario.integration_step_s;
        let mut simulation = Self {
            plant: Plant::new(empty.clone(), drives, State::at_rest(start)),
            empty,
            controller,
            trajectory,
            contacts: Contacts::new(
                &scenario.contacts,
                scenario.random_contacts.as_ref(),
                rng(scenario.seed, Stream::Contacts),
            ),
            sensors,
            offsets,
            held: vec![false; payloads.len()],
            payloads,
            temperature,
            joint_coulomb_nm,
            jams,
            stiffness_later,
            shown: VecDeque::new(),
            duration_s,
            control_steps,
            sample_steps,
            settle_steps: (scenario.settle_s / period_s).round() as u64 * control_steps,
            tick: 0,
            frames: 0,
            frame_count: (duration_s * scenario.sample_rate_hz).round().max(1.0) as u64,
            q_d: zero.clone(),
            dq_d: zero.clone(),
            tau_m: zero.clone(),
            delta_e: zero.clone(),
            stiffness_scale: vec![1.0; n],
            forces: Vec::new(),
            frame: Frame::new(n),
            truth: TrueState {
                time_s: 0.0,
                q: zero.clone(),
                dq: zero.clone(),
                theta: zero.clone(),
                delta_e: zero.clone(),
                tau_el: zero.clone(),
                tau_ext: zero,
            },
            names,
            scenario: scenario.clone(),
        };
        simulation.rest_at_start()?;
        simulation.begin_tick()?;
        Ok(simulation)
    }

    /// Stretches the springs to what gravity asks for.
    fn rest_at_start(&mut self) -> Result<(), SimulateError> {
        let t = self.time_s();
        self.change_payload(t)?;
        self.set_inputs(t);
        let g = self
            .plant
            .gravity_torque()
            .map_err(|e| diverged(t, e))?
            .to_vec();
        for (i, g) in g.iter().enumerate() {
            let drive = self.plant.drives[i];
            let scale = self.stiffness_scale[i];
            let creep = drive.viscoelastic_fraction * g / (drive.stiffness_nm_per_rad * scale);
            let s = &mut self.plant.state;
            s.creep[i] = creep;
            s.theta[i] = s.q[i] + self.delta_e[i] + creep + drive.deflection(*g, scale);
        }
        Ok(())
    }

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

    /// The next frame, or `None` at the end.
    ///
    /// # Errors
    /// [`SimulateError::Diverged`] when the state leaves the range of numbers.
    pub fn next_frame(&mut self) -> Result<Option<&Frame>, SimulateError> {
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

    /// What was true at the latest frame.
    pub fn true_state(&self) -> &TrueState {
        &self.truth
    }

    /// Offset of joint `i` at `t`, s, as the scenario has it: `(physical, injected)`, rad.
    pub(crate) fn offset_at(&self, i: usize, t: f64) -> (f64, f64) {
        let mut sum = (0.0, 0.0);
        for o in self.offsets.iter().filter(|o| o.joint == i) {
            let value = o.size_rad * o.shape.at(t);
            match o.kind {
                OffsetKind::Physical => sum.0 += value,
                OffsetKind::Injected => sum.1 += value,
            }
        }
        sum
    }

    pub(crate) fn offsets(&self) -> &[DrawnOffset] {
        &self.offsets
    }

    pub(crate) fn payloads(&self) -> &[DrawnPayload] {
        &self.payloads
    }

    pub(crate) fn contacts(&self) -> &Contacts {
        &self.contacts
    }

    pub(crate) fn drives(&self) -> &[Drive] {
        &self.plant.drives
    }

    pub(crate) fn true_empty_arm(&self) -> &Arm {
        &self.empty
    }

    pub(crate) fn temperature(&self) -> &DrawnTemperature {
        &self.temperature
    }

    pub(crate) fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// One integration step.
    fn advance(&mut self) -> Result<(), SimulateError> {
        let h = self.scenario.integration_step_s;
        let t = self.time_s();
        // What changes with time is held at the middle of the step: second order in a smooth
        // course, and a jump on the grid of steps falls between two of them.
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
            self.trajectory.at(t, &mut self.q_d, &mut self.dq_d);
            let s = &self.plant.state;
            self.controller
                .step(&self.q_d, &s.theta, &s.dtheta, &mut self.tau_m)
                .map_err(|e| diverged(t, e))?;
        }
        Ok(())
    }

    fn set_inputs(&mut self, t: f64) {
        if self.offsets.is_empty() {
            self.delta_e.fill(0.0);
        } else {
            for i in 0..self.names.len() {
                self.delta_e[i] = self.offset_at(i, t).0;
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
        for jam in &self.jams {
            let held = (jam.from_s..jam.to_s).contains(&t);
            self.plant.drives[jam.joint].joint_friction.coulomb_nm =
                self.joint_coulomb_nm[jam.joint] + if held { jam.torque_nm } else { 0.0 };
        }
        self.contacts.at(t, &mut self.forces);
    }

    /// Takes up and puts down loads.
    fn change_payload(&mut self, t: f64) -> Result<(), SimulateError> {
        // Half a step of tolerance puts the change on the tick that the file means.
        let soon = t + 0.5 * self.scenario.integration_step_s;
        let holds = |p: &DrawnPayload| soon >= p.attach_s && soon < p.release_s;
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

    /// Fills the frame and the truth behind it.
    fn measure(&mut self) -> Result<(), SimulateError> {
        let t = self.time_s();
        let state = &self.plant.state;
        // No joint turns a thousand radians in a recording made by a working controller.
        const FAR_RAD: f64 = 1e3;
        let lost = |q: &f64| !q.is_finite() || q.abs() >= FAR_RAD;
        if let Some(i) = state.q.iter().position(lost) {
            return Err(SimulateError::Diverged {
                time_s: t,
                reason: format!("joint '{}' is at {} rad", self.names[i], state.q[i]),
            });
        }
        self.set_inputs(t);
        let inputs = Inputs {
            tau_m: &self.tau_m,
            delta_e: &self.delta_e,
            stiffness_scale: &self.stiffness_scale,
            forces: &self.forces,
        };
        self.plant.elastic_torque(&inputs, &mut self.truth.tau_el);
        self.plant
            .external_torque(&self.forces, &mut self.truth.tau_ext)
            .map_err(|e| diverged(t, e))?;
        self.truth.time_s = t;
        let temperature_c = self.temperature.at(t);
        let warmer = temperature_c - self.temperature.reference_c;
        let record = self.scenario.record;
        let rate = self.scenario.sample_rate_hz;
        self.delay_motor(rate);
        self.frame.time_ns =
            self.scenario.start_time_ns + (self.frames as f64 * (1e9 / rate)).round() as i64;
        for i in 0..self.names.len() {
            let (q, dq) = (self.plant.state.q[i], self.plant.state.dq[i]);
            let theta = self.plant.state.theta[i];
            let (physical, injection) = self.offset_at(i, t);
            let tau_el = self.truth.tau_el[i];
            self.truth.q[i] = q;
            self.truth.dq[i] = dq;
            self.truth.theta[i] = theta;
            self.truth.delta_e[i] = physical + super::sensors::injected(theta, injection) - theta;
            let drift = self.temperature.drift_rad_per_k[i] * warmer;
            self.frame.q[i] = self.sensors.joint(i, q);
            let shown = self.shown_theta(i, rate);
            self.frame.theta[i] = self.sensors.motor(i, shown, injection, drift);
            if record.dq {
                self.frame.dq[i] = self.sensors.velocity(dq);
            }
            if record.tau_el {
                let sensor = &self.sensors.torque_sensor;
                self.frame.tau_el[i] = sensor.read(i, tau_el, theta, &mut self.sensors.rng);
            }
            if record.tau_m {
                let sensor = &self.sensors.motor_torque;
                self.frame.tau_m[i] = sensor.read(i, self.tau_m[i], theta, &mut self.sensors.rng);
            }
            if record.tau_ext {
                self.frame.tau_ext[i] = self.truth.tau_ext[i];
            }
        }
        if record.temperature {
            let error_k = if t >= self.temperature.reading_error_from_s {
                self.temperature.reading_error_k
            } else {
                0.0
            };
            self.frame.temperature_c = temperature_c + error_k;
        }
        Ok(())
    }
}

impl Simulation {
    /// Remembers motor positions as long as they are recorded late.
    fn delay_motor(&mut self, rate_hz: f64) {
        let delay = self.scenario.encoder.motor_delay_s * rate_hz;
        if delay > 0.0 {
            self.shown.push_back(self.plant.state.theta.clone());
            while self.shown.len() > delay.ceil() as usize + 1 {
                self.shown.pop_front();
            }
        }
    }

    /// The motor position that reaches the recording now, between frames along a straight line;
    /// the first one until there are enough.
    fn shown_theta(&self, i: usize, rate_hz: f64) -> f64 {
        let delay = self.scenario.encoder.motor_delay_s * rate_hz;
        let Some(newest) = self.shown.len().checked_sub(1) else {
            return self.plant.state.theta[i];
        };
        let at = |frames: usize| self.shown[newest.saturating_sub(frames)][i];
        let share = delay - delay.floor();
        let whole = delay.floor() as usize;
        at(whole) + share * (at(whole + 1) - at(whole))
    }
}

fn diverged(time_s: f64, error: StepError) -> SimulateError {
    SimulateError::Diverged {
        time_s,
        reason: error.to_string(),
    }
}

fn unknown(
    robot: &Robot,
    scenario: &Scenario,
    line: usize,
    what: &'static str,
    name: &str,
) -> SimulateError {
    let known = match what {
        "link" => robot.arm.link_names().collect::<Vec<_>>().join(", "),
        _ => robot.joint_names().join(", "),
    };
    SimulateError::Unknown {
        file: scenario.file.clone(),
        line,
        what,
        name: name.into(),
        robot: robot.name.clone(),
        known,
    }
}

/// Every joint and link the scenario names must be the robot's.
fn check_names(robot: &Robot, scenario: &Scenario) -> Result<(), SimulateError> {
    for (name, line) in scenario.joints_named() {
        if robot.arm.joint_index(name).is_none() {
            return Err(unknown(robot, scenario, line, "joint", name));
        }
    }
    for (name, line) in scenario.links_named() {
        if !robot.arm.link_names().any(|l| l == name) {
            return Err(unknown(robot, scenario, line, "link", name));
        }
    }
    Ok(())
}

fn transmissions(robot: &Robot) -> Result<Vec<&Transmission>, SimulateError> {
    robot
        .joint_names()
        .iter()
        .zip(&robot.transmissions)
        .map(|(joint, t)| {
            let refuse = |why| SimulateError::Robot {
                robot: robot.name.clone(),
                joint: joint.clone(),
                why,
            };
            let t = t.as_ref().ok_or_else(|| {
                refuse("is rigid; the simulator needs stiffness_nm_per_rad, or lock the joint with locked_at_rad")
            })?;
            if t.motor_inertia_kg_m2.is_some_and(|i| i > 0.0) {
                Ok(t)
            } else {
                Err(refuse("has no motor_inertia_kg_m2 above 0, which the simulator needs"))
            }
        })
        .collect()
}

/// The arm as it truly is.
fn true_arm(
    robot: &Robot,
    scenario: &Scenario,
    rng: &mut ChaCha8Rng,
) -> Result<Arm, SimulateError> {
    let names = robot.joint_names();
    let n = names.len();
    let (one, zero) = (vec![1.0; n], vec![0.0; n]);
    let t = &scenario.truth;
    let mass = t.mass_factor.sample(names, &one, rng);
    let com = t.com_factor.sample(names, &one, rng);
    let across = t.com_across_fraction.sample(names, &zero, rng);
    let inertia = t.inertia_factor.sample(names, &one, rng);
    let mut arm = robot.arm.clone();
    for i in 0..n {
        let angle: f64 = rng.random::<f64>() * std::f64::consts::TAU;
        if [mass[i], com[i], inertia[i]] == [1.0; 3] && across[i] == 0.0 {
            continue;
        }
        let Some(body) = arm.body(i) else { continue };
        let factor = mass[i] * inertia[i];
        arm = arm.with_body(
            i,
            BodyInertia {
                mass: body.mass * mass[i],
                com: shifted(body.com, com[i], across[i], angle),
                inertia: body.inertia.map(|row| row.map(|x| x * factor)),
            },
        )?;
    }
    Ok(arm)
}

/// `com` made longer by `along` and moved across by a fraction of its length, at `angle`.
fn shifted(com: [f64; 3], along: f64, across: f64, angle: f64) -> [f64; 3] {
    let length = (com[0] * com[0] + com[1] * com[1] + com[2] * com[2]).sqrt();
    if length == 0.0 {
        return com;
    }
    let u = com.map(|x| x / length);
    // Any vector not along `u`: the axis it has least of.
    let least = (0..3)
        .min_by(|&a, &b| u[a].abs().total_cmp(&u[b].abs()))
        .unwrap_or(0);
    let mut e = [0.0; 3];
    e[least] = 1.0;
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ]
    };
    let v = cross(u, e);
    let norm = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    let v = v.map(|x| x / norm);
    let w = cross(u, v);
    let (sin, cos) = libm::sincos(angle);
    std::array::from_fn(|k| along * com[k] + across * length * (cos * v[k] + sin * w[k]))
}

fn drives(
    scenario: &Scenario,
    names: &[String],
    nominal: &[&Transmission],
    rng: &mut ChaCha8Rng,
) -> Vec<Drive> {
    let n = names.len();
    let (one, zero) = (vec![1.0; n], vec![0.0; n]);
    let t = &scenario.truth;
    let mut draw = |spec: &PerJoint, defaults: &[f64]| spec.sample(names, defaults, rng);
    let stiffness = draw(&t.stiffness_factor, &one);
    let inertia = draw(&t.motor_inertia_factor, &one);
    let cubic = draw(&t.spring_cubic_per_rad2, &zero);
    let creep = draw(&t.viscoelastic_fraction, &zero);
    let creep_time = draw(&t.viscoelastic_time_s, &vec![30.0; n]);
    let mut friction = |spec: &FrictionSpec, of: &dyn Fn(&Transmission) -> (f64, f64)| {
        let (dry, viscous): (Vec<f64>, Vec<f64>) = nominal.iter().map(|t| of(t)).unzip();
        let coulomb = draw(&spec.coulomb_nm, &dry);
        let share = draw(&spec.torque_fraction, &zero);
        let viscous = draw(&spec.viscous_nm_s_per_rad, &viscous);
        let presliding = draw(&spec.presliding_rad, &vec![1e-3; n]);
        (0..n)
            .map(|i| Friction {
                coulomb_nm: coulomb[i],
                torque_fraction: share[i],
                viscous_nm_s_per_rad: viscous[i],
                presliding_rad: presliding[i],
            })
            .collect::<Vec<_>>()
    };
    let joint = friction(&scenario.joint_friction, &|t| {
        (
            t.joint_friction.coulomb_nm,
            t.joint_friction.viscous_nm_s_per_rad,
        )
    });
    let motor = friction(&scenario.motor_friction, &|t| {
        (
            t.motor_friction.coulomb_nm,
            t.motor_friction.viscous_nm_s_per_rad,
        )
    });
    (0..n)
        .map(|i| Drive {
            stiffness_nm_per_rad: nominal[i].stiffness_nm_per_rad * stiffness[i],
            cubic_per_rad2: cubic[i],
            viscoelastic_fraction: creep[i],
            viscoelastic_time_s: creep_time[i],
            motor_inertia_kg_m2: nominal[i].motor_inertia_kg_m2.unwrap_or(0.0) * inertia[i],
            joint_friction: joint[i],
            motor_friction: motor[i],
        })
        .collect()
}

fn draw_temperature(
    scenario: &Scenario,
    names: &[String],
    rng: &mut ChaCha8Rng,
) -> DrawnTemperature {
    let t = &scenario.temperature;
    let zero = vec![0.0; names.len()];
    DrawnTemperature {
        reference_c: t.reference_c,
        profile_c: t.profile_c.clone().unwrap_or_default(),
        change_k: t.change_k.sample(rng),
        change_from_to_s: t.change_from_to_s,
        reading_error_k: t.reading_error_k.sample(rng),
        reading_error_from_s: t.reading_error_from_s,
        stiffness_per_k: t.stiffness_per_k.sample(names, &zero, rng),
        drift_rad_per_k: t.zero_drift_rad_per_k.sample(names, &zero, rng),
    }
}
