//! Draws the truth of a simulation and puts its arm at rest.

use super::*;
use crate::plant::State;
use crate::sampled::{
    check_names, draw_temperature, drives, offset_owner, transmissions, true_arm, unknown,
};
use crate::scenario::{Stream, rng};
use rand::RngExt;
use sinew_files::{Fault, Located, limits};
use sinew_model::robot::Robot;

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
            scenario.steps_per(rate).ok_or_else(|| {
                let problem = "must be a rate whose period is a multiple of integration_step_s";
                Located::new(&scenario.file, Fault::NotAllowed, problem)
                    .key(what)
                    .value(rate)
                    .unit("Hz")
            })
        };
        let control_steps = steps_per("control_rate_hz", scenario.control_rate_hz)?;
        let sample_steps = steps_per("sample_rate_hz", scenario.sample_rate_hz)?;

        // Everything drawn for the robot comes from one stream in a fixed order. What happens to it has streams of
        // its own: with it and without it the robot is the same.
        let robot_seed = scenario.robot_seed.unwrap_or(scenario.seed);
        let mut truth_rng = rng(robot_seed, Stream::Truth);
        let empty = true_arm(robot, scenario, &mut truth_rng)?;
        let drives = drives(scenario, &names, &transmissions, &mut truth_rng);
        let temperature = draw_temperature(scenario, &names, &mut truth_rng);
        let mut grip_rng = rng(robot_seed, Stream::Grip);
        let mut payload_rng = rng(robot_seed, Stream::Payloads);
        let payloads: Vec<SampledPayload> = scenario
            .payloads
            .iter()
            .map(|p| SampledPayload {
                link: p.link.clone(),
                mass_kg: p.mass_kg.sample(&mut payload_rng),
                com_m: std::array::from_fn(|k| {
                    p.com_m[k] + p.com_spread_m[k] * (2.0 * grip_rng.random::<f64>() - 1.0)
                }),
                attach_s: p.attach_s,
                release_s: p.release_s,
            })
            .collect();
        let mut size_rng = rng(robot_seed, Stream::OffsetSizes);
        let mut delay_rng = rng(robot_seed, Stream::OffsetDelays);
        let offsets: Vec<SampledOffset> = scenario
            .offsets
            .iter()
            .filter_map(|o| {
                Some(SampledOffset {
                    joint: offset_owner(robot, o)?,
                    kind: o.kind,
                    size_rad: o.size_rad.sample(&mut size_rng),
                    shape: o.shape.later(o.later_s.sample(&mut delay_rng)),
                })
            })
            .collect();
        // What the language learned later is drawn from a stream of its own.
        let mut later_rng = rng(robot_seed, Stream::Later);
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
            .filter_map(|j| Some((robot.arm.joint_index(&j.joint)?, j.clone())))
            .collect();
        let controller_model = ControllerModel::new(robot, scenario)?;
        let routings = Routings::of(&robot.transmissions);
        let controller = Controller::new(
            robot,
            routings.clone(),
            &nominal_inertia,
            scenario,
            controller_model.at_start(),
            &mut truth_rng,
        )?;
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
            .ok_or_else(|| {
                let problem = "duration_s is missing: this motion never ends by itself";
                Located::new(&scenario.file, Fault::MissingKey, problem)
            })?;
        let steps = (duration_s + scenario.settle_s) / scenario.integration_step_s;
        // A length that is no number of steps at all is above any bound.
        if limits::SIMULATED_STEPS.check(steps as u64).is_err() {
            let problem = format!("{steps:.3e} integration steps; {}", limits::SIMULATED_STEPS);
            let located = Located::new(&scenario.file, Fault::TooLarge, problem);
            let key = match scenario.duration_s {
                Some(_) => "duration_s",
                None => "motion",
            };
            Err(located.key(key).value(duration_s).unit("s"))?;
        }

        let n = names.len();
        let joint_coulomb_nm = drives.iter().map(|d| d.joint_friction.coulomb_nm).collect();
        let zero = vec![0.0; n];
        let start = trajectory.start().to_vec();
        let period_s = control_steps as f64 * scenario.integration_step_s;
        let mut simulation = Self {
            plant: Plant::new(empty.clone(), drives, routings, State::at_rest(start)),
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
            controller_model,
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
            ddq_d: zero.clone(),
            tau_m: zero.clone(),
            theta_read: zero.clone(),
            delta_e: zero.clone(),
            stiffness_scale: vec![1.0; n],
            forces: Vec::new(),
            frame: Frame::new(n),
            truth: TrueState {
                time_s: 0.0,
                q_d: zero.clone(),
                dq_d: zero.clone(),
                q: zero.clone(),
                dq: zero.clone(),
                theta: zero.clone(),
                delta_e: zero.clone(),
                tau_el: zero.clone(),
                tau_ext: zero,
            },
            tendons: robot.tendon_names(),
            motors: robot.motor_names(),
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
        for i in 0..g.len() {
            let drive = self.plant.drives[i];
            let scale = self.stiffness_scale[i];
            let s = &mut self.plant.state;
            let (held, position) = match &self.plant.routings {
                Some(routings) => (
                    routings.torque_of(i, g.iter().copied()),
                    routings.path(i, &s.q),
                ),
                None => (g[i], s.q[i]),
            };
            let creep = drive.viscoelastic_fraction * held / (drive.stiffness_nm_per_rad * scale);
            s.creep[i] = creep;
            s.theta[i] = position + self.delta_e[i] + creep + drive.deflection(held, scale);
        }
        Ok(())
    }
}
