//! Draws the truth of a simulation and puts its arm at rest.

use super::*;
use crate::plant::State;
use crate::sampled::{
    Names, check_names, draw_temperature, drives, offset_owner, transmissions, true_arm, unknown,
};
use crate::scenario::{Stream, rng};
use rand::RngExt;
use sinew_files::{Budget, Fault, Located};
use sinew_model::robot::Robot;

impl Simulation {
    /// Draws the truth and puts the arm at rest at its first pose.
    ///
    /// # Errors
    /// Returns a [`SimulateError`] for a joint or link that is not in the robot, a joint without an elastic
    /// transmission or motor inertia, rates that are not multiples of the integration step, or an endless motion
    /// without a duration.
    pub fn new(robot: &Robot, scenario: &Scenario) -> Result<Self, SimulateError> {
        let names = Names::of(robot);
        check_names(robot, scenario)?;
        let paths = Paths::of(robot);
        if scenario.co_contraction.is_some() {
            check_co_contraction(robot, scenario, paths.as_ref())?;
        }
        let transmissions = transmissions(robot, paths.as_ref())?;
        let nominal_inertia: Vec<f64> = transmissions
            .iter()
            .map(|t| t.and_then(|t| t.motor_inertia_kg_m2).unwrap_or(0.0))
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
        let mut drives = drives(
            scenario,
            &names,
            &transmissions,
            paths.as_ref(),
            &mut truth_rng,
        );
        let temperature = draw_temperature(scenario, &names.tendons, &mut truth_rng);
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
        // Features added in later versions are drawn from a separate stream.
        let mut later_rng = rng(robot_seed, Stream::Later);
        let mut sensors = Sensors::new(
            scenario,
            &names,
            &mut truth_rng,
            &mut later_rng,
            rng(scenario.seed, Stream::Sensors),
        );
        let one = vec![1.0; robot.axes()];
        let later = &scenario.truth.stiffness_later_factor;
        let stiffness_later = later.sample(&names.tendons, &one, &mut later_rng);
        let pretension = &scenario.truth.pretension_factor;
        let pretension = pretension.sample(&names.tendons, &one, &mut later_rng);
        for (drive, factor) in drives.iter_mut().zip(pretension) {
            drive.pretension_nm *= factor;
        }
        sensors.add_tension(scenario, &names.tendons, &mut later_rng);
        let jams = scenario
            .jams
            .iter()
            .filter_map(|j| Some((robot.arm.joint_index(&j.joint)?, j.clone())))
            .collect();
        let controller_model = ControllerModel::new(robot, scenario)?;
        let controller = Controller::new(
            robot,
            &names,
            paths.clone(),
            &nominal_inertia,
            scenario,
            controller_model.at_start(),
            &mut truth_rng,
        )?;
        let limits: Vec<(f64, f64)> = robot.limits.iter().map(|l| (l.lower, l.upper)).collect();
        let trajectory = Trajectory::new(
            &scenario.motion,
            &names.joints,
            &limits,
            rng(scenario.seed, Stream::Motion),
            |line, name| unknown(robot, scenario, line, "joint", name),
        )?;
        let duration_s = scenario
            .duration_s
            .or(trajectory.length_s())
            .ok_or_else(|| {
                let problem = "duration_s is missing: this motion has no end";
                Located::new(&scenario.file, Fault::MissingKey, problem)
            })?;
        let steps = (duration_s + scenario.settle_s) / scenario.integration_step_s;
        // A length with a non-finite number of steps exceeds any bound.
        if Budget::SIMULATION.records.check(steps as u64).is_err() {
            let problem = format!(
                "{steps:.3e} integration steps; {}",
                Budget::SIMULATION.records
            );
            let located = Located::new(&scenario.file, Fault::TooLarge, problem);
            let key = match scenario.duration_s {
                Some(_) => "duration_s",
                None => "motion",
            };
            Err(located.key(key).value(duration_s).unit("s"))?;
        }

        let (dof, axes) = (names.joints.len(), robot.axes());
        let joint_coulomb_nm = drives.iter().map(|d| d.joint_friction.coulomb_nm).collect();
        let (of_joints, zero) = (vec![0.0; dof], vec![0.0; axes]);
        let start = trajectory.start().to_vec();
        let period_s = control_steps as f64 * scenario.integration_step_s;
        let mut simulation = Self {
            plant: Plant::new(empty.clone(), drives, paths, State::at_rest(start, axes)),
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
            q_d: of_joints.clone(),
            dq_d: of_joints.clone(),
            ddq_d: of_joints.clone(),
            tau_el: of_joints.clone(),
            tau_ext: of_joints,
            tau_m: zero.clone(),
            theta_read: zero.clone(),
            delta_e: zero.clone(),
            stiffness_scale: one,
            forces: Vec::new(),
            frame: Frame::new(axes),
            truth: TrueState {
                time_s: 0.0,
                q_d: zero.clone(),
                dq_d: zero.clone(),
                q: zero.clone(),
                dq: zero.clone(),
                theta: zero.clone(),
                delta_e: zero.clone(),
                tau_el: zero.clone(),
                tau_ext: zero.clone(),
                tendon_torque: zero.clone(),
                tension_n: zero,
            },
            metres_per_rad: metres_per_rad(robot),
            tendons: robot.tendon_names(),
            motors: robot.motor_names(),
            names: names.joints,
            scenario: scenario.clone(),
        };
        simulation.rest_at_start()?;
        simulation.begin_tick()?;
        Ok(simulation)
    }

    /// Stretches the tendons to the loads of gravity and passive springs, and strands to their initial tension.
    fn rest_at_start(&mut self) -> Result<(), SimulateError> {
        let t = self.time_s();
        self.change_payload(t)?;
        self.set_inputs(t);
        let mut tau_el = self
            .plant
            .gravity_torque()
            .map_err(|e| diverged(t, e))?
            .to_vec();
        let least = self.controller.least(t);
        let mut held = vec![0.0; self.axes()];
        let plant = &mut self.plant;
        match &plant.paths {
            Some(paths) => {
                for (j, tau) in tau_el.iter_mut().enumerate() {
                    *tau += paths.spring_torque(j, plant.state.q[j]);
                }
                paths.distribute(&plant.state.q, &tau_el, least, &mut held);
            }
            None => held.copy_from_slice(&tau_el),
        }
        for (i, held) in held.iter().enumerate() {
            let drive = plant.drives[i];
            let scale = self.stiffness_scale[i];
            let s = &mut plant.state;
            let (held, position) = match &plant.paths {
                Some(paths) if !paths.has_tendon(i) => {
                    s.theta[i] = 0.0;
                    continue;
                }
                Some(paths) => (
                    held - scale * drive.pretension_nm,
                    paths.shortening(i, &s.q),
                ),
                None => (*held, s.q[i]),
            };
            // A torn tendon has no deflection.
            let (creep, deflection) = match scale > 0.0 {
                true => (
                    drive.viscoelastic_fraction * held / (drive.stiffness_nm_per_rad * scale),
                    drive.deflection(held, scale),
                ),
                false => (0.0, 0.0),
            };
            s.creep[i] = creep;
            s.theta[i] = position + self.delta_e[i] + creep + deflection;
        }
        if let Some(paths) = &plant.paths {
            paths.join(&held, &mut plant.state.theta);
        }
        Ok(())
    }
}

/// Torque of the tendon on each axis per newton of its tension, m; NaN where no radius is specified.
fn metres_per_rad(robot: &Robot) -> Vec<f64> {
    let transmissions = robot.transmissions.iter();
    let metres = transmissions.map(|transmission| {
        let transmission = transmission.as_ref()?;
        let pull = (transmission.routing.as_ref()).and_then(|routing| routing.pull.as_ref());
        let radius_m = transmission
            .tendon
            .as_ref()
            .map(|t| t.joint_pulley_radius_m);
        pull.and_then(|pull| pull.metres_per_rad).or(radius_m)
    });
    metres.map(|metres| metres.unwrap_or(f64::NAN)).collect()
}

/// Checks that strands required to pull against each other exist and that their tension has the unit newton.
fn check_co_contraction(
    robot: &Robot,
    scenario: &Scenario,
    paths: Option<&Paths>,
) -> Result<(), SimulateError> {
    let scenario_error = |problem: String| {
        let located = Located::new(&scenario.file, Fault::NotAllowed, problem);
        SimulateError::from(located.key("co_contraction"))
    };
    let Some(paths) = paths.filter(|paths| paths.can_contract()) else {
        let robot = &robot.name;
        return Err(scenario_error(format!(
            "robot '{robot}' has no antagonistic strands; remove co_contraction"
        )));
    };
    if let Some(axis) = paths.strand_without_radius() {
        let tendon = robot.tendon_name(axis);
        return Err(scenario_error(format!(
            "tendon '{tendon}' has no radius to convert its tension to N; set drum_mm"
        )));
    }
    Ok(())
}
