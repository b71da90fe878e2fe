//! Closed forms and balances.

use super::{biorob_like, pendulum};
use crate::friction::Friction;
use crate::plant::{Drive, Inputs, Plant, PointForce, State};
use sinew_model::arm::{Arm, ArmWorkspace};
use sinew_model::robot::Robot;

const FREE: Friction = Friction {
    coulomb_nm: 0.0,
    torque_fraction: 0.0,
    viscous_nm_s_per_rad: 0.0,
    presliding_rad: 1e-3,
};

/// The robot's drives without friction and with a stiffening spring.
fn drives(robot: &Robot, cubic_per_rad2: f64) -> Vec<Drive> {
    robot
        .transmissions
        .iter()
        .map(|t| {
            let t = t.as_ref().expect("elastic");
            Drive {
                stiffness_nm_per_rad: t.stiffness_nm_per_rad,
                pretension_nm: 0.0,
                cubic_per_rad2,
                viscoelastic_fraction: 0.0,
                viscoelastic_time_s: 30.0,
                motor_inertia_kg_m2: t.motor_inertia_kg_m2.expect("given"),
                joint_friction: FREE,
                motor_friction: FREE,
                stops: [None; 2],
            }
        })
        .collect()
}

/// A lively state of the BioRob-like arm: about 2 rad/s and springs stretched by 50 mrad.
fn lively(robot: &Robot, cubic: f64) -> Plant {
    let mut state = State::at_rest(vec![0.3, 0.9, 0.7, -0.4], 4);
    state.dq = vec![1.0, -2.0, 1.5, 3.0];
    state.dtheta = vec![0.9, -1.8, 1.0, 2.0];
    for (theta, stretch) in state.theta.iter_mut().zip([0.05, 0.08, -0.05, 0.04]) {
        *theta += stretch;
    }
    Plant::new(robot.arm.clone(), drives(robot, cubic), None, state)
}

/// Motor torque of tick `k`, held over it.
fn pushing(k: u64) -> [f64; 4] {
    let t = k as f64 * 1e-3;
    [
        2.0 * (3.0 * t).sin(),
        3.0 + (5.0 * t).cos(),
        1.0,
        0.3 * (7.0 * t).sin(),
    ]
}

fn energy(arm: &Arm, plant: &Plant) -> f64 {
    let mut ws = ArmWorkspace::new(arm);
    let s = &plant.state;
    let arm_energy = arm.kinetic_energy(&mut ws, &s.q, &s.dq).expect("finite")
        + arm.potential_energy(&mut ws, &s.q).expect("finite");
    let drives: f64 = plant
        .drives
        .iter()
        .enumerate()
        .map(|(i, d)| {
            d.spring_energy(s.theta[i] - s.q[i])
                + 0.5 * d.motor_inertia_kg_m2 * s.dtheta[i] * s.dtheta[i]
        })
        .sum();
    arm_energy + drives
}

/// Runs `ticks` of 1 ms with `steps` integration steps each; returns plant and motor work.
fn run(plant: &mut Plant, ticks: u64, steps: u32) -> f64 {
    let (zero, one) = ([0.0; 4], [1.0; 4]);
    let mut work = 0.0;
    for k in 0..ticks {
        let tau_m = pushing(k);
        let before = plant.state.theta.clone();
        for _ in 0..steps {
            let inputs = Inputs {
                tau_m: &tau_m,
                delta_e: &zero,
                stiffness_scale: &one,
                forces: &[],
            };
            plant.step(1e-3 / f64::from(steps), &inputs).expect("steps");
        }
        // The torque is constant over the tick, so its work is exact.
        work += (0..4)
            .map(|i| tau_m[i] * (plant.state.theta[i] - before[i]))
            .sum::<f64>();
    }
    work
}

#[test]
fn energy_change_equals_motor_work() {
    let robot = biorob_like();
    let mut errors = Vec::new();
    let mut exchanged = 0.0;
    for steps in [1, 2, 4] {
        let mut plant = lively(&robot, 2.0);
        let before = energy(&robot.arm, &plant);
        let work = run(&mut plant, 1000, steps);
        let error = (energy(&robot.arm, &plant) - before - work).abs();
        println!(
            "energy error after 1 s at {} ms: {error:.2e} J, motors did {work:.2} J",
            1.0 / f64::from(steps)
        );
        errors.push(error);
        exchanged = work.abs() + before.abs();
    }
    // Classical Runge-Kutta changes the energy of a mode by (ωh)⁶/72 per step. The hand, on its spring is the fastest,
    // ω below 200 rad/s while it spins: at h = 0.5 ms that is 1.4e-8 per step, 3e-5 in the 2000 steps of a second.
    assert!(errors[1] < 3e-5 * exchanged, "{errors:?} of {exchanged} J");
    // Per time the loss falls with h⁵ where it is a mode's, with h⁴ in general.
    assert!(errors[2] < errors[1] / 8.0, "{errors:?}");
}

#[test]
fn integrator_error_is_fourth_order() {
    let robot = biorob_like();
    let end = |steps: u32| {
        let mut plant = lively(&robot, 2.0);
        run(&mut plant, 300, steps);
        plant.state.q
    };
    let best = end(32);
    let error = |steps| {
        end(steps)
            .iter()
            .zip(&best)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max)
    };
    let (coarse, fine) = (error(1), error(2));
    let order = (coarse / fine).log2();
    println!("error at 1 ms {coarse:.2e} rad, at 0.5 ms {fine:.2e} rad, order {order:.2}");
    // Between two finite steps the next term shows: half an order either way.
    assert!((3.5..=4.7).contains(&order), "order {order}");
    // A hundredth of the finest thing estimated (0.1 mrad) is the bar for the default step.
    assert!(fine < 1e-6, "{fine:.2e} rad");
}

#[test]
fn integrator_with_friction_is_second_order() {
    let robot = biorob_like();
    let end = |steps: u32| {
        let mut plant = lively(&robot, 0.0);
        for d in &mut plant.drives {
            d.joint_friction = Friction {
                coulomb_nm: 0.05,
                torque_fraction: 0.02,
                viscous_nm_s_per_rad: 0.02,
                presliding_rad: 1e-3,
            };
            d.motor_friction = Friction {
                coulomb_nm: 0.2,
                torque_fraction: 0.1,
                viscous_nm_s_per_rad: 0.05,
                presliding_rad: 1e-3,
            };
        }
        run(&mut plant, 300, steps);
        plant.state.q
    };
    let best = end(64);
    let error = |steps| {
        end(steps)
            .iter()
            .zip(&best)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max)
    };
    let errors = [1, 2, 4, 8].map(error);
    println!("with dry friction, 1 to 0.125 ms: {errors:.2?} rad");
    // Reversals fall anywhere in a step, so that single ratios scatter: three halvings together.
    let order = (errors[0] / errors[3]).log2() / 3.0;
    assert!(order > 1.7, "order {order}: {errors:?}");
    // A tenth of a milliradian is the finest thing estimated; the default step's error stays
    // below a tenth of it.
    assert!(errors[1] < 1e-5, "{errors:?}");
}

/// Period of the joint about its rest, from upward zero crossings of the deflection.
fn period(plant: &mut Plant, of: impl Fn(&State) -> f64) -> f64 {
    let h = 1e-4;
    let mut crossings = Vec::new();
    let mut before = of(&plant.state);
    for k in 0..60_000u32 {
        let inputs = Inputs {
            tau_m: &[0.0],
            delta_e: &[0.0],
            stiffness_scale: &[1.0],
            forces: &[],
        };
        plant.step(h, &inputs).expect("steps");
        let now = of(&plant.state);
        if before < 0.0 && now >= 0.0 {
            crossings.push((f64::from(k) + before / (before - now)) * h);
        }
        before = now;
    }
    (crossings[crossings.len() - 1] - crossings[0]) / (crossings.len() - 1) as f64
}

#[test]
fn elastic_joint_oscillates_at_natural_frequency() {
    let robot = pendulum();
    let inertia = 0.5 * 0.3 * 0.3;
    // No gravity: only the spring.
    let arm = {
        let text = "gravity_m_s2 = [0.0, 0.0, 0.0]\n[joints.swing]\nstiffness_nm_per_rad = 20.0\nmotor_inertia_kg_m2 = 0.05\n";
        let urdf = r#"<robot name="p"><link name="base"/><link name="bob"><inertial><origin xyz="0 0 -0.3"/><mass value="0.5"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link><joint name="swing" type="revolute"><parent link="base"/><child link="bob"/><axis xyz="0 -1 0"/><limit lower="-3" upper="3" effort="9" velocity="9"/></joint></robot>"#;
        sinew_model::robot::RobotFile::parse(text, "p.toml")
            .and_then(|f| f.build(urdf))
            .expect("a robot")
            .arm
    };
    for motor in [0.05, 1e9] {
        let mut drives = drives(&robot, 0.0);
        drives[0].motor_inertia_kg_m2 = motor;
        let mut state = State::at_rest(vec![0.0], 1);
        state.q[0] = 0.01;
        let mut plant = Plant::new(arm.clone(), drives, None, state);
        let found = period(&mut plant, |s| s.theta[0] - s.q[0]);
        let omega = (20.0 * (1.0 / inertia + 1.0 / motor)).sqrt();
        let expected = std::f64::consts::TAU / omega;
        // Phase error of the integrator (ωh)⁴/120 is below 1e-12; what remains is the straight
        // line through a crossing, (ωh)³/6 of a step over some fifty periods.
        assert!(
            (found / expected - 1.0).abs() < 1e-8,
            "{found} s against {expected} s"
        );
    }
}

/// Lets a plant come to rest under constant motor torque with viscous damping.
fn settle(plant: &mut Plant, tau_m: &[f64], delta_e: &[f64], forces: &[PointForce], seconds: f64) {
    let one = vec![1.0; tau_m.len()];
    for _ in 0..(seconds / 5e-4) as usize {
        let inputs = Inputs {
            tau_m,
            delta_e,
            stiffness_scale: &one,
            forces,
        };
        plant.step(5e-4, &inputs).expect("steps");
    }
}

fn damped(robot: &Robot) -> Vec<Drive> {
    let mut drives = drives(robot, 0.0);
    for d in &mut drives {
        d.joint_friction.viscous_nm_s_per_rad = 0.5;
        d.motor_friction.viscous_nm_s_per_rad = 1.0;
    }
    drives
}

#[test]
fn spring_at_rest_carries_gravity() {
    // Pendulum held by a constant torque of half its weight: rests where sin q = 1/2.
    let robot = pendulum();
    let weight = 0.5 * 9.81 * 0.3;
    let mut plant = Plant::new(
        robot.arm.clone(),
        damped(&robot),
        None,
        State::at_rest(vec![0.4], 1),
    );
    settle(&mut plant, &[0.5 * weight], &[0.0], &[], 60.0);
    let s = &plant.state;
    // Rest is reached exponentially; 60 s are more than twenty time constants of 2.5 s.
    assert!(
        (s.q[0] - std::f64::consts::FRAC_PI_6).abs() < 1e-9,
        "q = {}",
        s.q[0]
    );
    assert!((s.theta[0] - s.q[0] - 0.5 * weight / 20.0).abs() < 1e-9);
}

#[test]
fn longer_rope_moves_motor_not_joint() {
    let robot = pendulum();
    let torque = [0.7];
    let rest = |delta_e: f64| {
        let mut plant = Plant::new(
            robot.arm.clone(),
            damped(&robot),
            None,
            State::at_rest(vec![0.4], 1),
        );
        settle(&mut plant, &torque, &[delta_e], &[], 60.0);
        (plant.state.q[0], plant.state.theta[0])
    };
    let ((q0, theta0), (q1, theta1)) = (rest(0.0), rest(0.01));
    assert!((q1 - q0).abs() < 1e-9);
    assert!((theta1 - theta0 - 0.01).abs() < 1e-9);
}

#[test]
fn contact_at_rest_matches_transposed_jacobian() {
    let robot = biorob_like();
    let point = [0.0, 0.01, -0.02];
    let force = [1.5, -0.8, 2.0];
    let mut plant = Plant::new(
        robot.arm.clone(),
        damped(&robot),
        None,
        State::at_rest(vec![0.2, 0.6, 0.5, 0.3], 4),
    );
    let forces = [PointForce {
        link: "tool".into(),
        point_m: point,
        force_n: force,
    }];
    // Motors of enormous inertia hold; the joints find their rest against gravity and contact.
    for d in &mut plant.drives {
        d.motor_inertia_kg_m2 = 1e12;
    }
    settle(&mut plant, &[0.0; 4], &[0.0; 4], &forces, 30.0);
    let q = plant.state.q.clone();
    let mut ws = ArmWorkspace::new(&robot.arm);
    let g = robot
        .arm
        .momentum(&mut ws, &q, &[0.0; 4])
        .expect("finite")
        .g
        .to_vec();
    let position = |ws: &mut ArmWorkspace, q: &[f64]| {
        robot
            .arm
            .link_pose(ws, q, "tool")
            .expect("a link")
            .apply(point)
    };
    for i in 0..4 {
        // J by central differences, error below h² = 1e-10.
        let h = 1e-5;
        let (mut a, mut b) = (q.clone(), q.clone());
        a[i] += h;
        b[i] -= h;
        let (pa, pb) = (position(&mut ws, &a), position(&mut ws, &b));
        let contact: f64 = (0..3).map(|k| (pa[k] - pb[k]) / (2.0 * h) * force[k]).sum();
        let tau_el = plant.drives[i].spring(plant.state.theta[i] - q[i], 1.0);
        assert!(
            (tau_el + contact - g[i]).abs() < 1e-8,
            "joint {i}: {tau_el} + {contact} against {}",
            g[i]
        );
    }
}

#[test]
fn coulomb_friction_holds_joint_up_to_limit() {
    let robot = pendulum();
    let weight = 0.5 * 9.81 * 0.3;
    let coulomb = 0.3;
    // The spring balances gravity at 30°; then a push at the bob, 0.3 m from the joint.
    let mut drives = drives(&robot, 0.0);
    drives[0].motor_inertia_kg_m2 = 1e12;
    drives[0].joint_friction = Friction {
        coulomb_nm: coulomb,
        presliding_rad: 1e-3,
        viscous_nm_s_per_rad: 0.2,
        ..FREE
    };
    let q0 = std::f64::consts::FRAC_PI_6;
    let mut state = State::at_rest(vec![q0], 1);
    state.theta[0] = q0 + 0.5 * weight / 20.0;
    let pushed = |torque: f64| {
        let mut plant = Plant::new(robot.arm.clone(), drives.clone(), None, state.clone());
        // Along the motion of the bob at 30° (positive q swings towards +x and up), brought up
        // slowly: a sudden push would overshoot by its own size.
        let forces = |torque: f64| {
            let f = torque / 0.3;
            let force_n = [f * q0.cos(), 0.0, f * q0.sin()];
            [PointForce {
                link: "bob".into(),
                point_m: [0.0, 0.0, -0.3],
                force_n,
            }]
        };
        for step in 1..=10_000 {
            let part = forces(torque * f64::from(step) / 10_000.0);
            settle(&mut plant, &[0.0], &[0.0], &part, 1e-3);
        }
        settle(&mut plant, &[0.0], &[0.0], &forces(torque), 3.0);
        let early = plant.state.q[0] - q0;
        settle(&mut plant, &[0.0], &[0.0], &forces(torque), 10.0);
        (early, plant.state.q[0] - q0, plant.state.z_joint[0])
    };
    let slope = 20.0 + weight * q0.cos();
    let (early, late, z) = pushed(0.5 * coulomb);
    // The residual oscillation is a ten-thousandth of x_s.
    assert!(
        (late - early).abs() < 1e-7,
        "creeps: {early} then {late} rad"
    );
    // It has moved within pre-sliding only, and friction, spring and gravity carry the push; the
    // spring's and gravity's share is linear to sin(x) − x = 5e-11.
    assert!(late > 0.0 && late < 1e-3, "moved {late} rad");
    let carried = coulomb * z + slope * late;
    assert!(
        (carried / (0.5 * coulomb) - 1.0).abs() < 1e-5,
        "carried {carried} N·m"
    );
    // On the way it followed Dahl's curve; ringing ratchets it a little further along (1 % of
    // the load for a push brought up in 10 s, by an independent integration), never back.
    let along = coulomb * (1.0 - (-late / 1e-3f64).exp()) + slope * late;
    let further = along / (0.5 * coulomb) - 1.0;
    assert!((0.0..0.02).contains(&further), "{further} beyond the curve");
    let (_, late, z) = pushed(3.0 * coulomb);
    // Sliding: spring, gravity and friction carry the push, whose arm shortens as it turns.
    let carried = coulomb * z + 20.0 * late + weight * ((q0 + late).sin() - q0.sin());
    let push = 3.0 * coulomb * late.cos();
    assert!(
        (carried / push - 1.0).abs() < 1e-5,
        "carried {carried} N·m of {push}"
    );
    // It stops where full friction holds it, or one swing further, where less friction holds it.
    let (first, last) = (2.0 * coulomb / slope, 2.2 * coulomb / slope);
    assert!(
        z > 0.8 && (first..last).contains(&late),
        "slid {late} rad, z = {z}"
    );
}

#[test]
fn delayed_elasticity_matches_share_and_time_constant() {
    let robot = pendulum();
    let mut drives = damped(&robot);
    drives[0].viscoelastic_fraction = 0.04;
    drives[0].viscoelastic_time_s = 30.0;
    let mut plant = Plant::new(
        robot.arm.clone(),
        drives,
        None,
        State::at_rest(vec![0.0], 1),
    );
    // Constant load from the start: the creep of eq. v̇ = (s τ/K − v)/T, τ = 0.7 N·m at rest.
    settle(&mut plant, &[0.7], &[0.0], &[], 30.0);
    let full = 0.04 * 0.7 / 20.0;
    let expected = full * (1.0 - (-1f64).exp());
    // The swing to rest in the first seconds (3 s of 30 s) disturbs the load by a tenth.
    assert!(
        (plant.state.creep[0] / expected - 1.0).abs() < 0.05,
        "{}",
        plant.state.creep[0]
    );
    settle(&mut plant, &[0.7], &[0.0], &[], 600.0);
    assert!((plant.state.creep[0] / full - 1.0).abs() < 1e-6);
}
