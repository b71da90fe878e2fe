//! Robots with unidirectional tendons, one with more tendons than joints, another with fewer.

use super::{biorob_like, repository, shipped_robot};
use crate::friction::Friction;
use crate::paths::{Least, Paths};
use crate::plant::{Drive, Inputs, Plant, State};
use crate::scenario::{
    CoContraction, Draw, FrictionSpec, Motion, Offset, OffsetKind, PerJoint, Record, Scenario,
    Shape,
};
use crate::truth::Truth;
use crate::{FaultCounts, SimulateOptions, Simulation, run};
use rand::RngExt;
use sinew_log::{Axis, Frame};
use sinew_model::arm::ArmWorkspace;
use sinew_model::robot::{Robot, RobotFile};
use sinew_model::tendons::{
    Coordinate, Coupling, CouplingDescription, CouplingState, JointDescription, MomentArm,
    ShorteningTable, TendonDescription, TendonKind, TendonStatus,
};
use sinew_model::transmission::Transmission;

const TWO_JOINTS: &str = r#"<robot name="two-joints"><link name="base"/>
<link name="a"><inertial><origin xyz="0.1 0 0"/><mass value="0.3"/>
<inertia ixx="0.001" ixy="0" ixz="0" iyy="0.001" iyz="0" izz="0.001"/></inertial></link>
<joint name="near" type="revolute"><parent link="base"/><child link="a"/><axis xyz="0 1 0"/>
<limit lower="-2" upper="2" effort="9" velocity="9"/><dynamics friction="0.02" damping="0.03"/></joint>
<link name="b"><inertial><origin xyz="0.05 0 0"/><mass value="0.1"/>
<inertia ixx="0.0004" ixy="0" ixz="0" iyy="0.0004" iyz="0" izz="0.0004"/></inertial></link>
<joint name="far" type="revolute"><parent link="a"/><child link="b"/><origin xyz="0.2 0 0"/><axis xyz="0 1 0"/>
<limit lower="-2" upper="2" effort="9" velocity="9"/><dynamics friction="0.005" damping="0.004"/></joint></robot>"#;

fn built(toml: &str) -> Robot {
    RobotFile::parse(toml, "robot.toml")
        .and_then(|file| file.build(TWO_JOINTS))
        .unwrap_or_else(|e| panic!("{e}"))
}

/// One strand over two joints that springs hold open.
fn sprung() -> Robot {
    built(
        "[joints.near]\nspring = { stiffness_nm_per_rad = 1.5, rest_rad = -0.4 }\n\
         [joints.far]\nspring = { stiffness_nm_per_rad = 0.8, rest_rad = -0.2 }\n\
         [motors.m]\ninertia_kg_m2 = 0.001\n\
         [[tendons]]\nname = \"flexor\"\nkind = \"strand\"\ndrums_mm = { m = 8.0 }\n\
         moment_arms_mm = { near = 20.0, far = 12.0 }\nstiffness_n_per_mm = 15.0\npretension_n = 5.0\n",
    )
}

/// Two strands of one motor at the near joint, a loop at the far one that runs over both.
fn shared() -> Robot {
    built(
        "[joints.near]\n[joints.far]\n[motors.m]\ninertia_kg_m2 = 0.002\n[motors.l]\ninertia_kg_m2 = 0.001\n\
         [[tendons]]\nname = \"up\"\nkind = \"strand\"\ndrums_mm = { m = 8.0 }\n\
         moment_arms_mm = { near = 20.0 }\nstiffness_n_per_mm = 15.0\npretension_n = 6.0\n\
         [[tendons]]\nname = \"down\"\nkind = \"strand\"\ndrums_mm = { m = -8.0 }\n\
         moment_arms_mm = { near = -20.0 }\nstiffness_n_per_mm = 12.0\npretension_n = 6.0\n\
         [[tendons]]\nname = \"far\"\ndrums_mm = { l = 6.0 }\n\
         moment_arms_mm = { near = 6.0, far = 12.0 }\nstiffness_n_per_mm = 20.0\n",
    )
}

/// An antagonist whose flexor has a moment arm that varies.
fn varying() -> Robot {
    let mut robot = shipped("antagonistic-elbow");
    let rows = (0..41).map(|k| -1.5 + 3.0 * f64::from(k) / 40.0);
    let q_rad: Vec<f64> = rows.collect();
    let shortening_m: Vec<f64> = q_rad
        .iter()
        .map(|q| 0.022 * q + 0.003 * (q - 0.2).sin())
        .collect();
    let table = ShorteningTable::new(&q_rad, &shortening_m).expect("a table");
    let tendon = |name: &str, arm: MomentArm| TendonDescription {
        name: name.into(),
        kind: TendonKind::Strand,
        coordinate: Coordinate::Metres,
        drums: vec![(name.into(), 0.009)],
        moment_arms: vec![("elbow".into(), arm)],
        stiffness: 18e3,
        pretension: Some(70.0),
    };
    let elbow = JointDescription {
        name: "elbow".into(),
        ..Default::default()
    };
    let coupling = Coupling::new(CouplingDescription {
        joints: vec![elbow],
        motors: vec!["flexor".into(), "extensor".into()],
        tendons: vec![
            tendon("flexor", MomentArm::Table(table)),
            tendon("extensor", MomentArm::Constant(-0.022)),
        ],
    })
    .expect("a coupling");
    let paired = coupling.paired().expect("axes").into_iter().flatten();
    robot.transmissions = paired
        .map(|paired| {
            let stiffness = 18e3 * paired.units_per_rad * paired.units_per_rad;
            Some(Transmission {
                motor_inertia_kg_m2: Some(0.01),
                routing: Some(paired.routing),
                ..Transmission::spring(stiffness)
            })
        })
        .collect();
    robot.coupling = Some(coupling);
    robot
}

fn shipped(name: &str) -> Robot {
    shipped_robot(name)
}

fn all_robots() -> [(&'static str, Robot); 5] {
    [
        ("antagonistic-elbow", shipped("antagonistic-elbow")),
        ("n-plus-1-finger", shipped("n-plus-1-finger")),
        ("sprung", sprung()),
        ("shared", shared()),
        ("varying", varying()),
    ]
}

/// Drives as described, without friction.
fn drives(robot: &Robot, paths: &Paths) -> Vec<Drive> {
    (robot.transmissions.iter().enumerate())
        .map(|(i, t)| {
            let inertia = t.as_ref().and_then(|t| t.motor_inertia_kg_m2);
            Drive {
                stiffness_nm_per_rad: t.as_ref().map_or(1.0, |t| t.stiffness_nm_per_rad),
                pretension_nm: paths.pretension_nm(i),
                cubic_per_rad2: 0.0,
                viscoelastic_fraction: 0.0,
                viscoelastic_time_s: 30.0,
                motor_inertia_kg_m2: inertia.unwrap_or(1.0),
                joint_friction: Friction::default(),
                motor_friction: Friction::default(),
                stops: [None; 2],
            }
        })
        .collect()
}

fn plant(robot: &Robot) -> Plant {
    let paths = Paths::of(robot).expect("tendons of several joints");
    let (dof, axes) = (robot.arm.dof(), robot.axes());
    let drives = drives(robot, &paths);
    let state = State::at_rest(vec![0.0; dof], axes);
    Plant::new(robot.arm.clone(), drives, Some(paths), state)
}

/// State from the robot description, computed from drums and moment arms in metres.
struct Reference<'a> {
    robot: &'a Robot,
    coupling: &'a Coupling,
    state: CouplingState,
}

impl<'a> Reference<'a> {
    fn new(robot: &'a Robot) -> Self {
        let coupling = robot.coupling.as_ref().expect("tendons");
        Self {
            robot,
            coupling,
            state: CouplingState::new(coupling),
        }
    }

    fn routing(&self, i: usize) -> Option<&'a sinew_model::tendons::Routing> {
        self.robot.transmissions[i].as_ref()?.routing.as_ref()
    }

    /// * `state`, `delta`: in the coordinates of the axes.
    fn evaluate(&mut self, state: &State, delta: &[f64]) {
        let axes = 0..self.robot.axes();
        let theta: Vec<f64> = (self.coupling.motor_names().iter())
            .map(|motor| {
                let mut own = axes.clone().filter_map(|i| Some((i, self.routing(i)?)));
                let (i, routing) = own.find(|(_, r)| r.motor == *motor).expect("a motor");
                state.theta[i] / routing.drive_ratio
            })
            .collect();
        let elongation: Vec<f64> = (self.coupling.tendon_names())
            .map(|tendon| {
                let i = self.robot.tendon_index(tendon).expect("a tendon");
                let pull = self
                    .routing(i)
                    .and_then(|r| r.pull.as_ref())
                    .expect("pulls");
                pull.metres_per_rad.expect("a radius") * delta[i]
            })
            .collect();
        self.coupling
            .evaluate(&mut self.state, &theta, &state.q, &elongation)
            .expect("finite");
    }

    fn tension_n(&self, tendon: &str) -> f64 {
        let mut names = self.coupling.tendon_names();
        let i = names.position(|name| name == tendon).expect("a tendon");
        self.state.tension()[i]
    }
}

/// Torque in the coordinate of a tendon per newton of its tension, m.
fn radius_m(robot: &Robot, i: usize) -> f64 {
    let transmission = robot.transmissions[i].as_ref().expect("a tendon");
    let pull = transmission.routing.as_ref().and_then(|r| r.pull.as_ref());
    pull.and_then(|pull| pull.metres_per_rad).expect("a radius")
}

fn near(found: f64, analytic: f64, tolerance: f64) {
    let error = (found - analytic).abs();
    assert!(error < tolerance, "{found} for {analytic}");
}

/// Joints, tensions and motors against the coupling of the description, in states of which many have a slack strand.
#[test]
fn torques_match_coupling() {
    let mut rng = crate::scenario::rng(11, crate::scenario::Stream::Truth);
    for (name, robot) in all_robots() {
        let mut plant = plant(&robot);
        let mut reference = Reference::new(&robot);
        let (dof, axes) = (robot.arm.dof(), robot.axes());
        let (mut slack, mut taut, mut largest) = (0, 0, 0.0_f64);
        let (zero, one) = (vec![0.0; axes], vec![1.0; axes]);
        for _ in 0..500 {
            let mut random = |size: f64| size * (2.0 * rng.random::<f64>() - 1.0);
            let mut state = State::at_rest((0..dof).map(|_| random(1.2)).collect(), axes);
            let delta: Vec<f64> = (0..axes).map(|_| random(0.02)).collect();
            let paths = plant.paths.clone().expect("paths");
            for i in 0..axes {
                state.theta[i] = paths.shortening(i, &state.q) + random(0.2);
            }
            for (i, first, ratio) in paths.followers() {
                state.theta[*i] = ratio * state.theta[*first];
            }
            plant.state = state;
            reference.evaluate(&plant.state, &delta);
            let inputs = Inputs {
                tau_m: &zero,
                delta_e: &delta,
                stiffness_scale: &one,
                forces: &[],
            };
            let (mut tendons, mut tau_el) = (vec![0.0; axes], vec![0.0; dof]);
            plant.elastic_torques(&inputs, &mut tendons, &mut tau_el);
            for status in reference.state.status() {
                match status {
                    TendonStatus::Slack => slack += 1,
                    _ => taut += 1,
                }
            }
            for j in 0..dof {
                near(tau_el[j], reference.state.tau_el()[j], 1e-12);
                let spring = paths.spring_torque(j, plant.state.q[j]);
                near(spring, reference.state.tau_spring()[j], 1e-12);
                largest = largest.max(tau_el[j].abs());
            }
            for i in (0..axes).filter(|i| paths.has_tendon(*i)) {
                let tension_n = tendons[i] / radius_m(&robot, i);
                near(tension_n, reference.tension_n(robot.tendon_name(i)), 1e-9);
            }
            // Motors without torque of their own are turned by the tendons alone.
            let before = plant.state.dtheta.clone();
            const STEP_S: f64 = 1e-9;
            plant.step(STEP_S, &inputs).expect("steps");
            for (k, motor) in reference.coupling.motor_names().iter().enumerate() {
                let mut own = (0..axes).filter_map(|i| Some((i, reference.routing(i)?)));
                let (i, routing) = own.find(|(_, r)| r.motor == *motor).expect("a motor");
                let inertia = plant.drives[i].motor_inertia_kg_m2 * routing.drive_ratio.powi(2);
                let speed = (plant.state.dtheta[i] - before[i]) / routing.drive_ratio;
                let load = -inertia * speed / STEP_S;
                near(load, reference.state.tau_motor()[k], 1e-6);
            }
        }
        println!("{name}: {slack} slack, {taut} taut, up to {largest:.2} N·m");
        assert!(slack > 50 && taut > 200 && largest > 0.5, "{name}");
    }
}

/// Work of the motors becomes kinetic energy, height and energy of tendons and springs.
#[test]
fn energy_change_equals_motor_work() {
    for (name, robot) in all_robots() {
        let mut plant = plant(&robot);
        let mut reference = Reference::new(&robot);
        let paths = plant.paths.clone().expect("paths");
        let (dof, axes) = (robot.arm.dof(), robot.axes());
        let zero = vec![0.0; axes];
        let is_motor = |i: usize| paths.has_tendon(i) && paths.motor_axis(i).0 == i;
        let mut energy = |plant: &Plant| {
            let s = &plant.state;
            reference.evaluate(s, &zero);
            let mut ws = ArmWorkspace::new(&robot.arm);
            let kinetic = robot.arm.kinetic_energy(&mut ws, &s.q, &s.dq);
            let height = robot.arm.potential_energy(&mut ws, &s.q);
            let motors = (0..axes).filter(|i| is_motor(*i));
            let motors =
                motors.map(|i| 0.5 * plant.drives[i].motor_inertia_kg_m2 * s.dtheta[i].powi(2));
            let tendons = reference.state.energy_j().iter().sum::<f64>();
            let is_slack = reference.state.status().contains(&TendonStatus::Slack);
            let elastic = tendons + reference.state.spring_energy_j();
            let arm = kinetic.expect("finite") + height.expect("finite");
            (arm + elastic + motors.sum::<f64>(), is_slack)
        };
        for i in 0..dof {
            plant.state.q[i] = 0.2 + 0.1 * i as f64;
            plant.state.dq[i] = 1.0 - 0.7 * i as f64;
        }
        for i in 0..axes {
            plant.state.theta[i] = paths.shortening(i, &plant.state.q) + 0.01;
        }
        for (i, first, ratio) in paths.followers() {
            plant.state.theta[*i] = ratio * plant.state.theta[*first];
        }
        let before = energy(&plant).0;
        let (mut work, mut slack) = (0.0, 0);
        let one = vec![1.0; axes];
        for tick in 0..500 {
            let t = f64::from(tick) * 1e-3;
            // About what holds the pretension; where there is none, a push of its own.
            let held = |i: usize| paths.routings.drive_ratio(i).signum() * paths.pretension_nm(i);
            let push = |i: usize| (9.0 * t + 2.0 * i as f64).sin() * held(i).abs().max(0.05);
            let tau_m: Vec<f64> = (0..axes).map(|i| held(i) + 1.2 * push(i)).collect();
            let at = plant.state.theta.clone();
            const STEPS: u32 = 100;
            for _ in 0..STEPS {
                let inputs = Inputs {
                    tau_m: &tau_m,
                    delta_e: &zero,
                    stiffness_scale: &one,
                    forces: &[],
                };
                plant.step(1e-3 / f64::from(STEPS), &inputs).expect("steps");
            }
            let motors = (0..axes).filter(|i| is_motor(*i));
            work += motors
                .map(|i| tau_m[i] * (plant.state.theta[i] - at[i]))
                .sum::<f64>();
            slack += usize::from(energy(&plant).1);
        }
        let error = (energy(&plant).0 - before - work).abs();
        println!("{name}: {error:.1e} J of {work:.2} J, slack in {slack} of 500 ms");
        assert!(error < 1e-7 && slack > 0, "{name}: {error} J, {slack} ms");
    }
}

/// Scenario at rest in a pose without friction.
fn holding(pose: &[(&str, f64)]) -> Scenario {
    let named = |(joint, value): &(&str, f64)| (joint.to_string(), 0, Draw::Fixed(*value));
    Scenario {
        duration_s: Some(1.0),
        sample_rate_hz: 100.0,
        settle_s: 0.5,
        motion: Motion::Hold {
            pose_rad: PerJoint {
                all: None,
                by_joint: pose.iter().map(named).collect(),
            },
        },
        joint_friction: FrictionSpec::none(),
        motor_friction: FrictionSpec::none(),
        record: Record {
            tau_el: true,
            tau_m: true,
            tension: true,
            ..Record::default()
        },
        ..Scenario::default()
    }
}

fn all(robot: &Robot, scenario: &Scenario) -> (Vec<Frame>, Simulation) {
    let mut simulation = Simulation::new(robot, scenario).unwrap_or_else(|e| panic!("{e}"));
    let mut frames = Vec::new();
    while let Some(frame) = simulation.next_frame().expect("steps") {
        frames.push(frame.clone());
    }
    (frames, simulation)
}

fn slip(tendon: &str, size_rad: f64) -> Offset {
    Offset {
        joint: tendon.into(),
        line: 0,
        kind: OffsetKind::Physical,
        size_rad: Draw::Fixed(size_rad),
        shape: Shape::Step { at_s: 1.0 },
        later_s: Draw::Fixed(0.0),
    }
}

const GRAVITY_M_S2: f64 = 9.81;

/// The forearm of 0.7 kg at 0.14 m hangs between two strands at 22 mm, of which the extensor keeps 30 N.
#[test]
fn antagonist_reaches_set_point_with_required_tension() {
    let robot = shipped("antagonistic-elbow");
    let q = 0.6_f64;
    let scenario = Scenario {
        co_contraction: Some(CoContraction {
            tension_n: 30.0,
            varies_n: 0.0,
            period_s: 1.0,
        }),
        ..holding(&[("elbow", q)])
    };
    let (frames, _) = all(&robot, &scenario);
    let torque = 0.7 * 0.14 * GRAVITY_M_S2 * q.cos();
    let tensions = [30.0 + torque / 0.022, 30.0];
    for frame in [&frames[0], &frames[99]] {
        near(frame.q[0], q, 1e-9);
        assert_eq!(frame.q[1], 0.0);
        near(frame.tau_el[0], torque, 1e-9);
        assert!(frame.tau_el[1].is_nan());
        for (i, sign) in [(0, 1.0), (1, -1.0)] {
            let tension = tensions[i];
            near(frame.tension[i], tension, 1e-6);
            near(frame.tau_m[i], 0.009 * tension, 1e-9);
            let rope_m = sign * 0.022 * q + (tension - 70.0) / 18e3;
            near(frame.theta[i], rope_m / 0.009, 1e-9);
        }
    }
}

/// A common elongation of both strands turns no joint: motors of 1.25 times their stiffness move by `K/(K + 1.25 K)`
/// of it.
#[test]
fn common_elongation_lowers_tension_only() {
    let robot = shipped("antagonistic-elbow");
    const STRETCH_RAD: f64 = 0.02;
    let scenario = Scenario {
        duration_s: Some(6.0),
        offsets: vec![slip("flexor", STRETCH_RAD), slip("extensor", STRETCH_RAD)],
        ..holding(&[("elbow", 0.6)])
    };
    let (frames, simulation) = all(&robot, &scenario);
    let (before, after) = (&frames[50], &frames[599]);
    near(after.q[0], before.q[0], 1e-6);
    let lost_n = 18e3 * 0.022 * STRETCH_RAD * 1.25 / 2.25;
    for i in 0..2 {
        near(after.tension[i], before.tension[i] - lost_n, 1e-3);
        near(after.tau_m[i], before.tau_m[i] - 0.009 * lost_n, 1e-5);
        near(simulation.true_state().delta_e[i], STRETCH_RAD, 1e-12);
    }
    // More than they have to lose: slack, never below 0.
    let mut scenario = scenario;
    scenario.offsets = vec![slip("flexor", 0.4), slip("extensor", 0.4)];
    let (frames, _) = all(&robot, &scenario);
    let tensions = || frames.iter().flat_map(|frame| &frame.tension);
    assert!(tensions().all(|tension| *tension >= 0.0));
    assert!(tensions().any(|tension| *tension == 0.0));
}

#[test]
fn strand_failure_removes_its_tension_share() {
    let robot = shipped("antagonistic-elbow");
    let mut scenario = holding(&[]);
    scenario.truth.stiffness_later_factor = PerJoint::one("extensor", 0.5);
    scenario.truth.stiffness_later_from_s = 0.5;
    scenario.duration_s = Some(0.51);
    let (frames, _) = all(&robot, &scenario);
    // One sample later the motor has hardly moved.
    near(frames[50].tension[1], 0.5 * frames[49].tension[1], 0.5);
    near(frames[50].tension[0], frames[49].tension[0], 0.5);
}

#[test]
fn strands_keep_required_tension_in_motion() {
    for (name, least_n) in [("antagonistic-elbow", 30.0), ("n-plus-1-finger", 4.0)] {
        let robot = shipped(name);
        let mut scenario = Scenario {
            duration_s: Some(8.0),
            motion: Motion::Random {
                range_rad: PerJoint::default(),
                move_s: Draw::Fixed(1.2),
                pause_s: Draw::Fixed(0.3),
            },
            co_contraction: Some(CoContraction {
                tension_n: least_n,
                varies_n: least_n,
                period_s: 2.0,
            }),
            ..holding(&[])
        };
        scenario.correction.set_point = crate::scenario::SetPointKind::Dynamic;
        let mut simulation = Simulation::new(&robot, &scenario).unwrap_or_else(|e| panic!("{e}"));
        let (mut lowest, mut highest, mut worst) = (f64::INFINITY, 0.0_f64, 0.0_f64);
        while simulation.next_frame().expect("steps").is_some() {
            let state = simulation.true_state();
            let least = state
                .tension_n
                .iter()
                .copied()
                .fold(f64::INFINITY, f64::min);
            lowest = lowest.min(least);
            highest = highest.max(least);
            for j in 0..robot.arm.dof() {
                worst = worst.max((state.q[j] - state.q_d[j]).abs());
            }
        }
        println!(
            "{name}: least of the strands {lowest:.2} to {highest:.2} N, {:.2} mrad off",
            1e3 * worst
        );
        // Within a fifth: the joints swing about where they are wanted.
        assert!(lowest > 0.8 * least_n && highest > 1.8 * least_n, "{name}");
        assert!(highest < 2.2 * least_n && worst < 0.02, "{name}");
    }
}

/// The strand bends the joints against their springs: both joints are in equilibrium at rest.
#[test]
fn strand_against_springs_rests_in_equilibrium() {
    let robot = sprung();
    let scenario = Scenario {
        settle_s: 10.0,
        joint_friction: FrictionSpec {
            viscous_nm_s_per_rad: PerJoint::fixed(0.05),
            ..FrictionSpec::none()
        },
        ..holding(&[("near", 0.3), ("far", 0.2)])
    };
    let (frames, simulation) = all(&robot, &scenario);
    let frame = frames.last().expect("frames");
    let mut ws = ArmWorkspace::new(&robot.arm);
    let g = (robot.arm.momentum(&mut ws, &frame.q, &[0.0; 2]))
        .expect("finite")
        .g
        .to_vec();
    let f = frame.tension[0];
    assert!(f > 10.0, "{f} N");
    let springs = [1.5 * (frame.q[0] + 0.4), 0.8 * (frame.q[1] + 0.2)];
    for (j, arm) in [0.020, 0.012].into_iter().enumerate() {
        near(arm * f, g[j] + springs[j], 1e-5);
    }
    // The far joint has neither motor nor tendon on its axis, but its own friction.
    assert!(frame.theta[1].is_nan() && frame.tau_m[1].is_nan() && frame.tension[1].is_nan());
    let plain = Scenario {
        joint_friction: FrictionSpec::default(),
        ..scenario
    };
    let (_, described) = all(&robot, &plain);
    near(
        described.drives()[1].joint_friction.coulomb_nm,
        0.005,
        1e-15,
    );
    near(
        described.drives()[1].joint_friction.viscous_nm_s_per_rad,
        0.004,
        1e-15,
    );
    let truth = Truth::of(&simulation, FaultCounts::default());
    assert_eq!(truth.tendons.len(), 1);
    assert_eq!(truth.motor_inertia_kg_m2.len(), 1);
    near(truth.motor_inertia_kg_m2["m"], 0.001, 1e-15);
}

/// Two strands of one motor hold the joint, one of them slack under this load, and their motor has one position and one torque.
#[test]
fn strands_of_one_motor_move_together() {
    let robot = shared();
    let (frames, simulation) = all(&robot, &holding(&[("near", 0.4), ("far", -0.3)]));
    let index = |name: &str| robot.tendon_index(name).expect("a tendon");
    let (up, down) = (index("up"), index("down"));
    for frame in [&frames[0], &frames[99]] {
        near(frame.q[0], 0.4, 1e-9);
        near(frame.q[1], -0.3, 1e-9);
        assert_eq!(frame.theta[up], frame.theta[down]);
        assert_eq!(frame.tau_m[up], frame.tau_m[down]);
        assert_eq!(frame.tension[up].min(frame.tension[down]), 0.0);
        let load = 0.008 * (frame.tension[up] - frame.tension[down]);
        near(frame.tau_m[up], load, 1e-9);
    }
    let truth = Truth::of(&simulation, FaultCounts::default());
    near(truth.motor_inertia_kg_m2["m"], 0.002, 1e-15);
}

/// Recordings of the two scenarios that are shipped.
#[test]
fn recording_round_trips() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(root) = repository() else { return };
    let examples = root.join("examples/scenarios");
    for name in ["antagonistic-elbow", "n-plus-1-finger"] {
        let robot = shipped(name);
        let mut scenario = Scenario::open(&examples.join(format!("{name}.toml")))
            .unwrap_or_else(|e| panic!("{e}"));
        scenario.duration_s = Some(1.0);
        scenario.record.dq = true;
        scenario.record.tau_el = true;
        let (expected, _) = all(&robot, &scenario);
        for ending in ["csv", "parquet"] {
            let out = folder.path().join(format!("{name}.{ending}"));
            run(&robot, &scenario, &SimulateOptions::new(&out), &mut |_| ()).expect("written");
            let mut recording = sinew_log::open(&out, &Default::default()).expect("opens");
            let (motors, tendons) = (robot.motors_at_shaft(), robot.tendon_names());
            let axes = (0..robot.axes()).map(|i| Axis {
                joint: robot.joint_names().get(i).map(String::as_str),
                motor: motors[i],
                tendon: Some(&tendons[i]),
            });
            recording.select_axes(&Vec::from_iter(axes)).expect("axes");
            let mut count = 0;
            while let Some(frame) = recording.next_frame().expect("reads") {
                let want = &expected[count];
                assert_eq!(frame.time_ns, want.time_ns);
                assert_eq!((&frame.q, &frame.theta), (&want.q, &want.theta), "{out:?}");
                assert_eq!((&frame.dq, &frame.tau_m), (&want.dq, &want.tau_m));
                assert_eq!(frame.tension, want.tension);
                let dof = robot.arm.dof();
                assert_eq!(frame.tau_el[..dof], want.tau_el[..dof]);
                assert!(frame.tau_el[dof..].iter().all(|tau| tau.is_nan()));
                count += 1;
            }
            assert_eq!(count, 250);
        }
        let out = folder.path().join("a.mcap");
        let refused = run(&robot, &scenario, &SimulateOptions::new(&out), &mut |_| ());
        let said = refused.expect_err("one motor per joint").to_string();
        assert!(said.contains(".parquet") && !out.exists(), "{said}");
    }
}

/// At different moment arms, the torques hold the joint and the least loaded strand has the required tension.
#[test]
fn tensions_balance_torque_at_all_positions() {
    for (name, robot) in all_robots() {
        let paths = Paths::of(&robot).expect("paths");
        let (dof, axes) = (robot.arm.dof(), robot.axes());
        for k in -10..=10 {
            let q: Vec<f64> = (0..dof)
                .map(|j| 0.1 * f64::from(k) + 0.05 * j as f64)
                .collect();
            let wanted: Vec<f64> = (0..dof).map(|j| 0.3 - 0.2 * j as f64).collect();
            let mut f = vec![0.0; axes];
            for least_n in [5.0, 50.0] {
                paths.distribute(&q, &wanted, Least::Tension(least_n), &mut f);
                let mut held = vec![0.0; dof];
                for (i, f) in f.iter().enumerate().filter(|(i, _)| paths.has_tendon(*i)) {
                    paths.add_torque(i, &q, *f, &mut held);
                }
                if name == "sprung" {
                    continue;
                }
                for (held, wanted) in held.iter().zip(&wanted) {
                    near(*held, *wanted, 1e-12);
                }
                let mut strands = (0..axes).filter(|i| paths.is_strand(*i));
                if name == "shared" {
                    // Its motor cannot pull both strands.
                    assert!(strands.all(|i| f[i] >= 0.0));
                    continue;
                }
                let tensions = strands.map(|i| f[i] / radius_m(&robot, i));
                near(tensions.fold(f64::INFINITY, f64::min), least_n, 1e-9);
            }
        }
        assert_eq!(paths.can_contract(), !["sprung", "shared"].contains(&name));
    }
}

fn refused(robot: &Robot, text: &str) -> String {
    let text = format!("duration_s = 1.0\n{text}\n[motion]\nkind = \"hold\"\n");
    match Scenario::from_toml(&text, "bad.toml") {
        Err(error) => error.to_string(),
        Ok(scenario) => match Simulation::new(robot, &scenario) {
            Err(error) => error.to_string(),
            Ok(_) => panic!("accepted: {text}"),
        },
    }
}

#[test]
fn protocol_unsupported_robot_returns_error() {
    let said = crate::protocol::plan_adapted("S7", &shipped("antagonistic-elbow"));
    let said = said
        .err()
        .map(|error| error.to_string())
        .unwrap_or_default();
    assert!(
        said.contains("antagonistic-elbow has tendons that share joints"),
        "{said}"
    );
}

#[test]
fn invalid_names_and_tensions_return_error() {
    let elbow = shipped("antagonistic-elbow");
    let contracts = "[co_contraction]\ntension_n = 5.0";
    let cases: [(&Robot, &str, &[&str]); 6] = [
        (
            &biorob_like(),
            contracts,
            &["co_contraction", "no antagonistic strands"],
        ),
        (&sprung(), contracts, &["co_contraction", "two-joints"]),
        (
            &elbow,
            "[co_contraction]\ntension_n = 5.0\nvaries_n = 2.0",
            &["period_s", "missing"],
        ),
        (
            &elbow,
            "[truth]\nstiffness_factor = { elbow = 1.1 }",
            &["line 3", "tendon 'elbow'", "flexor, extensor"],
        ),
        (
            &elbow,
            "[truth]\nmass_factor = { flexor = 1.1 }",
            &["joint 'flexor'", "elbow"],
        ),
        (
            &sprung(),
            "[controller]\nstiffness_nm_per_rad = { far = 1.1 }",
            &["motor 'far'", "it has m"],
        ),
    ];
    for (robot, text, words) in cases {
        let said = refused(robot, text);
        println!("{said}");
        for word in words {
            assert!(said.contains(word), "'{word}' is not in: {said}");
        }
    }
}
