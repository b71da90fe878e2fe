//! Robots whose tendons cross several joints.

use super::shipped_robot;
use crate::friction::Friction;
use crate::paths::Paths;
use crate::plant::{Drive, Inputs, Plant, State};
use crate::scenario::{
    Correction, Draw, Encoder, FrictionSpec, Motion, Offset, OffsetKind, PerJoint, Record,
    Scenario, SetPointKind, Shape, SpecifiedOffset, Waypoint,
};
use crate::truth::Truth;
use crate::{FaultCounts, SimulateOptions, Simulation, run};
use sinew_log::Frame;
use sinew_model::arm::ArmWorkspace;
use sinew_model::robot::Robot;

const GRAVITY_M_S2: f64 = 9.81;

fn robot(name: &str) -> Robot {
    shipped_robot(name)
}

fn draws(of: &[(&str, f64)]) -> PerJoint {
    let named = |(joint, value): &(&str, f64)| (joint.to_string(), 0, Draw::Fixed(*value));
    PerJoint {
        all: None,
        by_joint: of.iter().map(named).collect(),
    }
}

/// Scenario at rest in a pose without friction.
fn holding(pose: &[(&str, f64)]) -> Scenario {
    Scenario {
        duration_s: Some(2.0),
        sample_rate_hz: 100.0,
        settle_s: 0.5,
        motion: Motion::Hold {
            pose_rad: draws(pose),
        },
        joint_friction: FrictionSpec::none(),
        motor_friction: FrictionSpec::none(),
        record: Record {
            tau_el: true,
            tau_m: true,
            ..Record::default()
        },
        ..Scenario::default()
    }
}

fn offset(of: &str, kind: OffsetKind, size_rad: f64, shape: Shape) -> Offset {
    Offset {
        joint: of.into(),
        line: 0,
        kind,
        size_rad: Draw::Fixed(size_rad),
        shape,
        later_s: Draw::Fixed(0.0),
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

fn near(found: f64, analytic: f64) {
    assert!((found - analytic).abs() < 1e-9, "{found} for {analytic}");
}

/// Analytic gravity torque of the coupled arm, N·m: links along the x axis of the arm, which is level at 0.
fn coupled_gravity(q: [f64; 3]) -> [f64; 3] {
    let level = [q[0].cos(), (q[0] + q[1]).cos(), (q[0] + q[1] + q[2]).cos()];
    // Masses carried at the end of each link, and first moments of the link, kg·m.
    let parts = [
        level[0] * (0.85 * 0.13 + (0.5 + 0.25) * 0.31),
        level[1] * (0.5 * 0.14 + 0.25 * 0.31),
        level[2] * 0.25 * 0.07,
    ];
    let from = |first: usize| GRAVITY_M_S2 * parts[first..].iter().sum::<f64>();
    [from(0), from(1), from(2)]
}

/// Torques of the tendons in rad of their joints, N·m, by hand: the arms over the shoulder are 10 of 20 mm and 6 of 15 mm, that of
/// the wrist at the elbow is −9 of 15 mm.
fn coupled_tensions(tau: [f64; 3]) -> [f64; 3] {
    let wrist = tau[2];
    let elbow = tau[1] + 0.6 * wrist;
    let shoulder = tau[0] - 0.5 * elbow - 0.4 * wrist;
    [shoulder, elbow, wrist]
}

#[test]
fn specified_torque_gives_analytic_extension() {
    let robot = robot("coupled-arm");
    let q = [0.3, 0.8, -0.5];
    let stretched = [0.004, -0.006, 0.009];
    let pose = [("shoulder", q[0]), ("elbow", q[1]), ("wrist", q[2])];
    let mut scenario = holding(&pose);
    for (tendon, size) in ["shoulder", "elbow", "wrist"].iter().zip(stretched) {
        let physical = OffsetKind::Physical;
        (scenario.offsets).push(offset(tendon, physical, size, Shape::Constant));
    }
    // The controller corrects the stretch, so that the arm reaches its set-point.
    scenario.correction = Correction {
        offset: SpecifiedOffset::True,
        ..Correction::default()
    };
    let (frames, simulation) = all(&robot, &scenario);
    let tau = coupled_gravity(q);
    let tensions = coupled_tensions(tau);
    let stiffness = [40.0, 50e3 * 0.02 * 0.02, 35.5e3 * 0.015 * 0.015];
    let position = [q[0], q[1] + 0.5 * q[0], q[2] + 0.4 * q[0] - 0.6 * q[1]];
    for frame in [&frames[0], &frames[199]] {
        for i in 0..3 {
            near(frame.q[i], q[i]);
            near(frame.tau_el[i], tau[i]);
            near(frame.tau_m[i], tensions[i]);
            let extension = tensions[i] / stiffness[i];
            near(frame.theta[i], position[i] + extension + stretched[i]);
        }
    }
    near(simulation.true_state().delta_e[1], stretched[1]);
}

#[test]
fn unknown_offset_does_not_change_extension() {
    let robot = robot("coupled-arm");
    let mut scenario = holding(&[("shoulder", 0.3), ("elbow", 0.8), ("wrist", -0.5)]);
    scenario.duration_s = Some(15.0);
    let physical = OffsetKind::Physical;
    let step = Shape::Step { at_s: 1.0 };
    scenario.offsets = vec![offset("elbow", physical, 0.01, step)];
    let (frames, _) = all(&robot, &scenario);
    let stiffness = [40.0, 50e3 * 0.02 * 0.02, 35.5e3 * 0.015 * 0.015];
    let last = &frames[1499];
    assert!(last.q[1] < 0.8 - 0.008, "{:?}", last.q);
    let q = [last.q[0], last.q[1], last.q[2]];
    let tensions = coupled_tensions(coupled_gravity(q));
    let position = [q[0], q[1] + 0.5 * q[0], q[2] + 0.4 * q[0] - 0.6 * q[1]];
    for i in 0..3 {
        let left = last.theta[i] - position[i] - tensions[i] / stiffness[i];
        let stretch = if i == 1 { 0.01 } else { 0.0 };
        // Ringing has faded to a microradian.
        assert!((left - stretch).abs() < 1e-6, "{i}: {left}");
    }
}

/// Values in mm of rope, independent of the joints that tendons are paired with.
#[test]
fn differential_records_motor_encoder_positions() {
    let robot = robot("differential-wrist");
    let (pitch, roll) = (0.3, -0.4);
    let (frames, _) = all(&robot, &holding(&[("pitch", pitch), ("roll", roll)]));
    let mut ws = ArmWorkspace::new(&robot.arm);
    let terms = robot.arm.momentum(&mut ws, &[pitch, roll], &[0.0; 2]);
    let g = terms.expect("finite").g;
    // tau_pitch = 16 mm (left − right), tau_roll = 12 mm (left + right).
    let (difference, sum) = (g[0] / 0.016, g[1] / 0.012);
    let tensions = [0.5 * (sum + difference), 0.5 * (sum - difference)];
    assert!(tensions.iter().all(|f| f.abs() > 5.0), "{tensions:?}");
    let drums = [0.008, -0.008];
    let shortened = [0.016 * pitch + 0.012 * roll, -0.016 * pitch + 0.012 * roll];
    let motors = robot.motor_names();
    for frame in [&frames[0], &frames[199]] {
        for k in 0..2 {
            let name = ["left_motor", "right_motor"][k];
            let i = motors.iter().position(|m| m == name).expect("a motor");
            near(
                frame.theta[i],
                (shortened[k] + tensions[k] / 40e3) / drums[k],
            );
            near(frame.tau_m[i], drums[k] * tensions[k]);
        }
        near(frame.tau_el[0], g[0]);
        near(frame.tau_el[1], g[1]);
    }
}

#[test]
fn motor_resolution_refers_to_shaft() {
    const STEP_RAD: f64 = 0.001;
    let scenario = Scenario {
        encoder: Encoder {
            motor_resolution_rad: STEP_RAD,
            ..Encoder::default()
        },
        ..holding(&[("pitch", 0.3), ("roll", -0.4)])
    };
    let (frames, simulation) = all(&robot("differential-wrist"), &scenario);
    let last = frames.last().expect("frames");
    for (theta, true_theta) in last.theta.iter().zip(&simulation.true_state().theta) {
        let steps = theta / STEP_RAD;
        assert!((steps - steps.round()).abs() < 1e-9, "{theta}");
        assert!((theta - true_theta).abs() <= 0.5 * STEP_RAD * (1.0 + 1e-9));
    }
}

#[test]
fn columns_and_topics_use_motor_names() {
    let folder = tempfile::tempdir().expect("a folder");
    let robot = robot("differential-wrist");
    let scenario = Scenario {
        duration_s: Some(0.2),
        ..holding(&[("pitch", 0.3), ("roll", -0.4)])
    };
    let (expected, simulation) = all(&robot, &scenario);
    for name in ["a.csv", "a.parquet", "a.mcap"] {
        let out = folder.path().join(name);
        let options = SimulateOptions::new(&out);
        run(&robot, &scenario, &options, &mut |_| ()).expect("written");
        if name == "a.csv" {
            let text = std::fs::read_to_string(&out).expect("there");
            let header = text.lines().next().expect("a header");
            let motors = simulation.motor_names();
            let motor_columns = |what: &str, unit: &str| {
                let columns = motors.iter().map(|m| format!("{what}.{m}_{unit}"));
                columns.collect::<Vec<_>>().join(",")
            };
            let analytic = format!(
                "time_s,q.pitch_rad,q.roll_rad,{},tau_el.pitch_nm,tau_el.roll_nm,{}",
                motor_columns("theta", "rad"),
                motor_columns("tau_m", "nm")
            );
            assert_eq!(header, analytic);
            assert!(header.contains("theta.right_motor_rad,theta.left_motor_rad"));
        }
        let mut recording = sinew_log::open(&out, &Default::default()).expect("opens");
        let joints = robot.joint_names().iter();
        let axes = joints
            .zip(robot.motors_at_shaft())
            .map(|(joint, motor)| sinew_log::Axis {
                motor,
                ..sinew_log::Axis::of_joint(joint)
            });
        recording.select_axes(&Vec::from_iter(axes)).expect("both");
        let mut count = 0;
        while let Some(frame) = recording.next_frame().expect("reads") {
            let want = &expected[count];
            assert_eq!((&frame.q, &frame.theta), (&want.q, &want.theta), "{name}");
            assert_eq!((&frame.tau_el, &frame.tau_m), (&want.tau_el, &want.tau_m));
            count += 1;
        }
        assert_eq!(count, 20, "{name}");
    }
}

/// Work of the motors becomes kinetic energy, height and energy of the springs, to the fourth order of the step.
#[test]
fn energy_change_equals_motor_work() {
    for name in ["coupled-arm", "differential-wrist"] {
        let robot = robot(name);
        let transmissions: Vec<_> = robot.transmissions.iter().flatten().collect();
        let paths = Paths::of(&robot).expect("tendons of several joints");
        const CUBIC_PER_RAD2: f64 = 2.0;
        let drives: Vec<Drive> = transmissions
            .iter()
            .map(|t| Drive {
                stiffness_nm_per_rad: t.stiffness_nm_per_rad,
                pretension_nm: 0.0,
                cubic_per_rad2: CUBIC_PER_RAD2,
                viscoelastic_fraction: 0.0,
                viscoelastic_time_s: 30.0,
                motor_inertia_kg_m2: t.motor_inertia_kg_m2.expect("given"),
                joint_friction: Friction::default(),
                motor_friction: Friction::default(),
                stops: [None; 2],
            })
            .collect();
        let n = drives.len();
        let extension = |s: &State, i: usize| {
            let routing = transmissions[i].routing.as_ref();
            let arms = routing.map(|r| r.moment_arms.clone());
            let arms = arms.unwrap_or_else(|| (0..n).map(|j| f64::from(i == j)).collect());
            s.theta[i] - (0..n).map(|j| arms[j] * s.q[j]).sum::<f64>()
        };
        let energy = |plant: &Plant| {
            let s = &plant.state;
            let mut ws = ArmWorkspace::new(&robot.arm);
            let arm = robot
                .arm
                .kinetic_energy(&mut ws, &s.q, &s.dq)
                .expect("finite")
                + robot.arm.potential_energy(&mut ws, &s.q).expect("finite");
            let of_drives = drives.iter().enumerate().map(|(i, d)| {
                d.spring_energy(extension(s, i))
                    + 0.5 * d.motor_inertia_kg_m2 * s.dtheta[i] * s.dtheta[i]
            });
            arm + of_drives.sum::<f64>()
        };
        let mut errors = Vec::new();
        for steps in [1_u32, 2, 4] {
            let mut state = State::at_rest((0..n).map(|i| 0.3 + 0.2 * i as f64).collect(), n);
            state.dq = (0..n).map(|i| 1.0 - 0.7 * i as f64).collect();
            for i in 0..n {
                // At an extension of 50 mrad.
                state.theta[i] += 0.05 - extension(&state, i);
            }
            let arm = robot.arm.clone();
            let mut plant = Plant::new(arm, drives.clone(), Some(paths.clone()), state);
            let before = energy(&plant);
            let mut work = 0.0;
            let (zero, one) = (vec![0.0; n], vec![1.0; n]);
            for tick in 0..500 {
                let t = f64::from(tick) * 1e-3;
                let push = |i: usize| 0.3 * (3.0 * t + i as f64).sin();
                let tau_m: Vec<f64> = (0..n).map(push).collect();
                let at = plant.state.theta.clone();
                for _ in 0..steps {
                    let inputs = Inputs {
                        tau_m: &tau_m,
                        delta_e: &zero,
                        stiffness_scale: &one,
                        forces: &[],
                    };
                    plant.step(1e-3 / f64::from(steps), &inputs).expect("steps");
                }
                let moved = plant.state.theta.iter().zip(&at);
                work += (moved.zip(&tau_m))
                    .map(|((now, before), tau)| tau * (now - before))
                    .sum::<f64>();
            }
            errors.push((energy(&plant) - before - work).abs());
        }
        println!("{name}: {errors:?} J");
        // Halving the step brings a sixteenth; a wrong sign or index is wrong by joules at every step.
        assert!(
            errors[0] < 1e-4 && errors[2] < errors[0] / 60.0,
            "{name}: {errors:?}"
        );
    }
}

/// Elastic torque of the joints against the coupling of the description, which has units of its own and no pairs.
#[test]
fn joint_torque_matches_coupling() {
    for name in ["coupled-arm", "differential-wrist"] {
        let robot = robot(name);
        let (_, simulation) = all(
            &robot,
            &Scenario {
                duration_s: Some(0.05),
                ..holding(&[])
            },
        );
        let n = robot.arm.dof();
        let transmissions: Vec<_> = robot.transmissions.iter().flatten().collect();
        let coupling = robot.coupling.as_ref().expect("tendons");
        let state = simulation.true_state();
        let mut of_coupling = sinew_model::tendons::CouplingState::new(coupling);
        let motors: Vec<f64> = (coupling.motor_names().iter())
            .map(|name| {
                let mut names = simulation.motor_names().iter();
                state.theta[names.position(|m| m == name).expect("a motor")]
            })
            .collect();
        let still = vec![0.0; transmissions.len()];
        (coupling.evaluate(&mut of_coupling, &motors, &state.q, &still)).expect("finite");
        for j in 0..n {
            near(state.tau_el[j], of_coupling.tau_el()[j]);
        }
    }
}

fn follows(kind: SetPointKind) -> f64 {
    let scenario = Scenario {
        motion: Motion::Waypoints {
            start_rad: draws(&[("shoulder", -0.3), ("elbow", 0.4), ("wrist", 0.2)]),
            waypoints: vec![Waypoint {
                pose_rad: draws(&[("shoulder", 0.4), ("elbow", 1.2), ("wrist", -0.5)]),
                move_s: Draw::Fixed(1.5),
                pause_s: Draw::Fixed(0.0),
            }],
            repeat: false,
        },
        duration_s: Some(1.5),
        correction: Correction {
            set_point: kind,
            ..Correction::default()
        },
        ..holding(&[])
    };
    // The controller counts on the friction of the description.
    let mut robot = robot("coupled-arm");
    for transmission in robot.transmissions.iter_mut().flatten() {
        transmission.joint_friction = Default::default();
    }
    let mut simulation = Simulation::new(&robot, &scenario).expect("a scenario");
    let mut worst: f64 = 0.0;
    while simulation.next_frame().expect("steps").is_some() {
        let state = simulation.true_state();
        for (q, q_d) in state.q.iter().zip(&state.q_d) {
            worst = worst.max((q - q_d).abs());
        }
    }
    1e3 * worst
}

#[test]
fn coupled_joints_track_commanded_motion() {
    let (at_rest, in_motion) = (
        follows(SetPointKind::Static),
        follows(SetPointKind::Dynamic),
    );
    println!("static {at_rest:.2} mrad, dynamic {in_motion:.2} mrad");
    // Without the acceleration of the motors by other joints 1.8 mrad.
    assert!(in_motion < 1.5 && in_motion < 0.1 * at_rest);
}

/// Uncorrected, the offset of the elbow's rope appears as a torque at both joints that it crosses, by their moment
/// arms.
#[test]
fn unknown_offset_appears_as_torque_at_all_joints() {
    let mut robot = robot("coupled-arm");
    for transmission in robot.transmissions.iter_mut().flatten() {
        transmission.joint_friction = Default::default();
    }
    let mut scenario = holding(&[("shoulder", 0.3), ("elbow", 0.8), ("wrist", -0.5)]);
    scenario.duration_s = Some(20.0);
    scenario.settle_s = 10.0;
    let physical = OffsetKind::Physical;
    scenario.offsets = vec![offset("elbow", physical, 0.01, Shape::Constant)];
    scenario.correction.offset = SpecifiedOffset::True;
    scenario.contact_detection.noise_nm = PerJoint::fixed(0.01);
    let compared = crate::control::compare(&robot, &scenario).unwrap_or_else(|e| panic!("{e}"));
    let analytic = [-0.5 * 20.0 * 0.01, -20.0 * 0.01, 0.0];
    let joints = compared.without.joints.iter().zip(&compared.with.joints);
    for ((without, with), analytic) in joints.zip(analytic) {
        println!("{without:?}\n{with:?}");
        assert!((without.false_torque_nm - analytic).abs() < 1e-5);
        assert!(with.false_torque_nm.abs() < 1e-9 && with.rms_rad < 1e-9);
    }
    assert!(compared.without.joints[1].rest_mean_rad < -0.008);
}

#[test]
fn encoder_slip_appears_in_all_tendons_of_joint() {
    let mut scenario = holding(&[("shoulder", 0.3)]);
    let step = Shape::Step { at_s: 1.0 };
    scenario.offsets = vec![offset("shoulder", OffsetKind::JointEncoder, 0.01, step)];
    let (frames, simulation) = all(&robot("coupled-arm"), &scenario);
    near(frames[50].q[0] - frames[150].q[0], 0.01);
    let analytic = [0.01, 0.5 * 0.01, 0.4 * 0.01];
    for (delta_e, analytic) in simulation.true_state().delta_e.iter().zip(analytic) {
        near(*delta_e, analytic);
    }
}

#[test]
fn truth_contains_tendon_and_motor_names() {
    let mut scenario = holding(&[]);
    let step = |tendon: &str, rad| {
        let physical = OffsetKind::Physical;
        offset(tendon, physical, rad, Shape::Step { at_s: 1.0 })
    };
    scenario.offsets = vec![step("left", 0.003), step("right", 0.004)];
    scenario.motor_friction = FrictionSpec::default();
    let (_, simulation) = all(&robot("differential-wrist"), &scenario);
    let truth = Truth::of(&simulation, FaultCounts::default());
    let told: Vec<_> = (truth.steps.iter())
        .map(|s| (s.joint.as_str(), s.size_rad))
        .collect();
    assert_eq!(told, [("left", 0.003), ("right", 0.004)]);
    near(truth.offset_rad["left"], 0.003);
    near(truth.offset_rad["right"], 0.004);
    near(truth.motor_inertia_kg_m2["left_motor"], 0.003);
    near(truth.motor_coulomb_nm["right_motor"], 0.03);
    assert!(
        truth.mass_kg.contains_key("pitch") && truth.offset_trajectory_s_rad.contains_key("left")
    );
    let left = truth.tendons.iter().find(|t| t.name == "left");
    let left = left.expect("the left tendon");
    assert_eq!(left.motor, "left_motor");
    // 16 mm at the pitch and 12 mm at the roll, in rad of the joint it is paired with.
    let radius_mm = if left.joint == "pitch" { 16.0 } else { 12.0 };
    near(left.moment_arms["pitch"], 16.0 / radius_mm);
    near(left.moment_arms["roll"], 12.0 / radius_mm);
    near(left.drive_ratio, 8.0 / radius_mm);
    // A robot without named tendons has no such list.
    let (_, diagonal) = all(&super::pendulum(), &holding(&[]));
    let text = serde_json::to_string(&Truth::of(&diagonal, FaultCounts::default()));
    assert!(!text.expect("JSON").contains("tendons"));
}

const AT_REST: &str = "duration_s = 1.0\n[motion]\nkind = \"hold\"\n[[offsets]]\nrad = 0.01\n";

fn refused(robot: &Robot, offset: &str) -> String {
    let text = format!("{AT_REST}{offset}");
    let scenario = match Scenario::from_toml(&text, "bad.toml") {
        Ok(scenario) => scenario,
        Err(error) => return error.to_string(),
    };
    let refused = Simulation::new(robot, &scenario).err();
    refused
        .unwrap_or_else(|| panic!("accepted: {text}"))
        .to_string()
}

#[test]
fn unknown_tendon_error_lists_tendons() {
    let robot = robot("differential-wrist");
    let cases: [(&str, &[&str]); 5] = [
        (
            "tendon = \"lfet\"\nkind = \"physical\"",
            &[
                "line 4",
                "tendon 'lfet'",
                "left",
                "right",
                "differential-wrist",
            ],
        ),
        // A joint whose tendon has another name.
        (
            "joint = \"pitch\"\nkind = \"physical\"",
            &["tendon 'pitch'", "left", "right"],
        ),
        (
            "joint = \"left\"\nkind = \"joint-encoder\"",
            &["joint 'left'", "pitch", "roll"],
        ),
        (
            "tendon = \"left\"\nkind = \"joint-encoder\"",
            &["line 6", "tendon", "joint of the slipped encoder"],
        ),
        (
            "tendon = \"left\"\njoint = \"pitch\"\nkind = \"physical\"",
            &["line 6", "tendon", "omitted if joint is given"],
        ),
    ];
    for (text, words) in cases {
        let said = refused(&robot, text);
        println!("{said}");
        for word in words {
            assert!(said.contains(word), "'{word}' is not in: {said}");
        }
    }
}

/// A tendon with the name of its joint is accepted on every robot.
#[test]
fn tendon_with_joint_name_is_accepted() {
    for key in ["tendon", "joint"] {
        let text = format!("{AT_REST}{key} = \"swing\"\nkind = \"physical\"");
        let scenario = Scenario::from_toml(&text, "good.toml").unwrap_or_else(|e| panic!("{e}"));
        let (_, simulation) = all(&super::pendulum(), &scenario);
        near(simulation.true_state().delta_e[0], 0.01);
    }
}

#[test]
fn motor_without_inertia_error_names_joint() {
    let mut robot = robot("differential-wrist");
    let first = robot.transmissions[0].as_mut().expect("elastic");
    first.motor_inertia_kg_m2 = None;
    let refused = Simulation::new(&robot, &holding(&[])).expect_err("refused");
    let said = refused.to_string();
    for word in ["differential-wrist", "pitch", "[motors]"] {
        assert!(said.contains(word), "{said}");
    }
}

#[test]
fn protocol_adapts_to_named_tendons() {
    for (name, tendons) in [
        ("coupled-arm", &["shoulder", "elbow", "wrist"][..]),
        ("differential-wrist", &["right", "left"]),
    ] {
        let robot = robot(name);
        let plan = crate::protocol::plan_adapted("S7", &robot).unwrap_or_else(|e| panic!("{e}"));
        let mut simulation =
            Simulation::new(&plan.simulated, &plan.scenario).unwrap_or_else(|e| panic!("{e}"));
        for _ in 0..500 {
            simulation.next_frame().expect("steps");
        }
        for (i, tendon) in tendons.iter().enumerate() {
            assert_eq!(simulation.tendon_names()[i], *tendon);
            // A free offset between the sessions, at 60 s.
            assert!(simulation.offset_at(i, 61.0).physical > 0.0, "{tendon}");
        }
    }
}
