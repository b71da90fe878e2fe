//! Identities of the physics on random trees.
//!
//! Derivatives are taken without truncation error (see `crate::random_tree::derivative`), so that every
//! tolerance is rounding only: [`ROUNDING`] times the magnitudes that were added or subtracted.

use crate::random_tree::{Case, ROUNDING, case, config, derivative, dot, joint_name, link_name};
use proptest::prelude::*;
use sinew_model::arm::{Arm, ArmBuilder, ArmWorkspace, BodySpec, Pose};

/// `p`, `Cᵀdq`, `g`, copied out of the workspace.
struct Terms {
    p: Vec<f64>,
    ct_dq: Vec<f64>,
    g: Vec<f64>,
}

fn momentum(arm: &Arm, q: &[f64], dq: &[f64]) -> Terms {
    let mut ws = ArmWorkspace::new(arm);
    let terms = arm.momentum(&mut ws, q, dq).unwrap();
    Terms {
        p: terms.p.to_vec(),
        ct_dq: terms.ct_dq.to_vec(),
        g: terms.g.to_vec(),
    }
}

fn mass_matrix(arm: &Arm, q: &[f64]) -> Vec<Vec<f64>> {
    let mut ws = ArmWorkspace::new(arm);
    let m = arm.mass_matrix(&mut ws, q).unwrap();
    m.chunks(arm.dof()).map(<[f64]>::to_vec).collect()
}

/// Largest `Σ |M_ij| |x_j|`: what rounding in a product with `M` is relative to.
fn magnitude(m: &[Vec<f64>], x: &[f64]) -> f64 {
    m.iter()
        .map(|row| row.iter().zip(x).map(|(a, b)| (a * b).abs()).sum())
        .fold(0.0, f64::max)
}

/// Bound of what gravity torques are made of: weight times the largest distance in the tree.
fn gravity_magnitude(case: &Case) -> f64 {
    let mass: f64 = case.links.iter().map(|l| l.body().mass).sum();
    mass * crate::random_tree::norm(case.gravity) * reach(case)
}

/// No particle is farther than this from any joint, m.
fn reach(case: &Case) -> f64 {
    let travel = |(l, q): (&crate::random_tree::Link, &f64)| if l.revolute { 0.0 } else { q.abs() };
    let links = case.links.iter().zip(&case.q);
    0.6 + links
        .map(|l| crate::random_tree::norm(l.0.xyz) + travel(l))
        .sum::<f64>()
}

#[track_caller]
fn close(what: &str, ours: f64, reference: f64, size: f64) {
    let difference = (ours - reference).abs();
    assert!(
        difference <= ROUNDING * size,
        "{what}: {ours} is not {reference}: they differ by {difference:e}, rounding allows {:e}",
        ROUNDING * size
    );
}

proptest! {
    #![proptest_config(config(200))]

    #[test]
    fn momentum_is_mass_matrix_times_velocity(case in case(12)) {
        let arm = case.arm();
        let (m, terms) = (mass_matrix(&arm, &case.q), momentum(&arm, &case.q, &case.dq));
        let size = magnitude(&m, &case.dq);
        for (i, row) in m.iter().enumerate() {
            close("p", terms.p[i], dot(row, &case.dq), size);
        }
    }

    #[test]
    fn kinetic_energy_is_half_dq_m_dq(case in case(12)) {
        let arm = case.arm();
        let mut ws = ArmWorkspace::new(&arm);
        let energy = arm.kinetic_energy(&mut ws, &case.q, &case.dq).unwrap();
        let m = mass_matrix(&arm, &case.q);
        let by_matrix: f64 = m.iter().zip(&case.dq).map(|(row, v)| 0.5 * v * dot(row, &case.dq)).sum();
        let terms = momentum(&arm, &case.q, &case.dq);
        let size = magnitude(&m, &case.dq) * case.dq.iter().map(|v| v.abs()).sum::<f64>();
        close("½ dqᵀ M dq", energy, by_matrix, size);
        close("½ dqᵀ p", energy, 0.5 * dot(&terms.p, &case.dq), size);
    }

    /// Against nothing of ours but positions: every particle's speed from its moving position.
    #[test]
    fn kinetic_energy_is_that_of_the_particles(case in case(8)) {
        let arm = case.arm();
        let mut ws = ArmWorkspace::new(&arm);
        let energy = arm.kinetic_energy(&mut ws, &case.q, &case.dq).unwrap();
        let mut by_particles = 0.0;
        let mut size = 0.0;
        for (i, link) in case.links.iter().enumerate() {
            for (mass, x) in &link.particles {
                for axis in 0..3 {
                    let mut speed = 0.0;
                    let mut speed_size = 0.0;
                    for j in 0..case.dof() {
                        let (d, s) = derivative(&case.q, j, case.links[j].kind(), |q| {
                            arm.link_pose(&mut ws, q, &link_name(i)).unwrap().apply(*x)[axis]
                        });
                        speed += d * case.dq[j];
                        speed_size += s * case.dq[j].abs();
                    }
                    by_particles += 0.5 * mass * speed * speed;
                    size += mass * speed_size * speed_size;
                }
            }
        }
        close("T", energy, by_particles, size);
    }

    #[test]
    fn ct_dq_is_the_gradient_of_kinetic_energy(case in case(12)) {
        let arm = case.arm();
        let mut ws = ArmWorkspace::new(&arm);
        let terms = momentum(&arm, &case.q, &case.dq);
        for i in 0..case.dof() {
            let (gradient, size) = derivative(&case.q, i, case.links[i].kind(), |q| {
                arm.kinetic_energy(&mut ws, q, &case.dq).unwrap()
            });
            close("∂T/∂q", terms.ct_dq[i], gradient, size);
        }
    }

    #[test]
    fn gravity_torque_is_the_gradient_of_potential_energy(case in case(12)) {
        let arm = case.arm();
        let mut ws = ArmWorkspace::new(&arm);
        let terms = momentum(&arm, &case.q, &case.dq);
        for i in 0..case.dof() {
            let (gradient, size) = derivative(&case.q, i, case.links[i].kind(), |q| {
                arm.potential_energy(&mut ws, q).unwrap()
            });
            close("∂V/∂q", terms.g[i], gradient, size + gravity_magnitude(&case));
        }
    }

    /// Checks `Ṁ dq = C dq + Cᵀ dq`, the identity that the observer requires.
    #[test]
    fn momentum_changes_as_the_observer_assumes(case in case(12)) {
        let mut weightless = case.clone();
        weightless.gravity = [0.0; 3];
        let arm = weightless.arm();
        let mut ws = ArmWorkspace::new(&arm);
        let terms = momentum(&arm, &case.q, &case.dq);
        let c_dq = arm.bias_torque(&mut ws, &case.q, &case.dq).unwrap().to_vec();
        for k in 0..case.dof() {
            let (mut change, mut size) = (0.0, 0.0);
            for i in 0..case.dof() {
                let (d, s) = derivative(&case.q, i, case.links[i].kind(), |q| {
                    arm.momentum(&mut ws, q, &case.dq).unwrap().p[k]
                });
                change += d * case.dq[i];
                size += s * case.dq[i].abs();
            }
            let speed: f64 = case.dq.iter().map(|v| v.abs()).sum();
            let size = size + magnitude(&mass_matrix(&arm, &case.q), &case.dq) * speed;
            close("Ṁ dq", c_dq[k] + terms.ct_dq[k], change, size);
        }
    }

    #[test]
    fn forward_dynamics_undoes_inverse_dynamics(case in case(12)) {
        let arm = case.arm();
        let mut ws = ArmWorkspace::new(&arm);
        let tau = arm.inverse_dynamics(&mut ws, &case.q, &case.dq, &case.other).unwrap().to_vec();
        let mut ddq = vec![0.0; case.dof()];
        arm.forward_dynamics(&mut ws, &case.q, &case.dq, &tau, &mut ddq).unwrap();
        // The torque of the difference, not the difference: a light joint at the end of a heavy
        // chain makes M ill conditioned, and Cholesky promises a small residual only.
        let m = mass_matrix(&arm, &case.q);
        let difference: Vec<f64> = ddq.iter().zip(&case.other).map(|(a, b)| a - b).collect();
        let bias = arm.bias_torque(&mut ws, &case.q, &case.dq).unwrap();
        let bias = bias.iter().fold(gravity_magnitude(&case), |a, b| a.max(b.abs()));
        let size = magnitude(&m, &ddq) + magnitude(&m, &case.other) + bias;
        for row in &m {
            close("M (ddq − ddq')", dot(row, &difference), 0.0, size);
        }
    }

    #[test]
    fn mass_matrix_is_symmetric_and_positive(case in case(12)) {
        let arm = case.arm();
        let m = mass_matrix(&arm, &case.q);
        for i in 0..case.dof() {
            prop_assert!(m[i][i] > 0.0);
            for k in 0..i {
                prop_assert_eq!(m[i][k], m[k][i]);
            }
        }
        let energy: f64 = m.iter().zip(&case.other).map(|(row, x)| x * dot(row, &case.other)).sum();
        prop_assert!(energy > 0.0);
    }

    /// Bodies may be given in any order that has parents first.
    #[test]
    fn order_of_the_bodies_does_not_matter(case in case(12)) {
        let n = case.dof();
        // `other` ranks the joints; a joint follows once its parent is there.
        let mut order: Vec<usize> = Vec::new();
        while order.len() < n {
            let ready = (0..n).filter(|i| !order.contains(i))
                .filter(|&i| case.parent(i).is_none_or(|p| order.contains(&p)));
            let next = ready.min_by(|&a, &b| case.other[a].total_cmp(&case.other[b])).unwrap();
            order.push(next);
        }
        let place = |i: usize| order.iter().position(|&x| x == i).unwrap();
        let builder = order.iter().fold(
            ArmBuilder::new().gravity(case.gravity),
            |b, &i| b.body(BodySpec { parent: case.parent(i).map(place), ..case.spec(i) }),
        );
        let (arm, shuffled) = (case.arm(), builder.build().unwrap());
        let reorder = |x: &[f64]| order.iter().map(|&i| x[i]).collect::<Vec<_>>();
        let ours = momentum(&arm, &case.q, &case.dq);
        let theirs = momentum(&shuffled, &reorder(&case.q), &reorder(&case.dq));
        let size = magnitude(&mass_matrix(&arm, &case.q), &case.dq);
        let speed: f64 = case.dq.iter().map(|v| v.abs()).sum();
        for i in 0..n {
            prop_assert_eq!(shuffled.joint_index(&joint_name(i)), Some(place(i)));
            close("p", theirs.p[place(i)], ours.p[i], size);
            close("ct_dq", theirs.ct_dq[place(i)], ours.ct_dq[i], size * speed);
            close("g", theirs.g[place(i)], ours.g[i], gravity_magnitude(&case));
        }
    }

    #[test]
    fn payload_equals_rigidly_attached_body(
        case in case(8),
        which in 0.0..1.0f64,
        xyz in prop::array::uniform3(-0.3..0.3f64),
        rpy in prop::array::uniform3(-3.0..3.0f64),
    ) {
        let at = ((case.dof() as f64) * which) as usize;
        let pose = Pose::from_xyz_rpy(xyz, rpy);
        // Any physical body will do: that of another link.
        let payload = case.links[0].body();
        let arm = case.builder().link("flange".into(), Some(at), pose).build().unwrap();
        let loaded = arm.with_payload("flange", payload).unwrap().unwrap();
        let mut heavier = case.clone();
        for (mass, x) in &case.links[0].particles {
            heavier.links[at].particles.push((*mass, pose.apply(*x)));
        }
        let explicit = heavier.arm();
        let (a, b) = (momentum(&loaded, &case.q, &case.dq), momentum(&explicit, &case.q, &case.dq));
        let size = magnitude(&mass_matrix(&explicit, &case.q), &case.dq);
        let speed: f64 = case.dq.iter().map(|v| v.abs()).sum();
        for i in 0..case.dof() {
            close("p", a.p[i], b.p[i], size);
            close("ct_dq", a.ct_dq[i], b.ct_dq[i], size * speed);
            close("g", a.g[i], b.g[i], gravity_magnitude(&heavier));
        }
    }

    #[test]
    fn force_torque_equals_jacobian_transpose(
        case in case(8),
        which in 0.0..1.0f64,
        point in prop::array::uniform3(-0.3..0.3f64),
        force in prop::array::uniform3(-20.0..20.0f64),
    ) {
        let arm = case.arm();
        let mut ws = ArmWorkspace::new(&arm);
        let link = link_name(((case.dof() as f64) * which) as usize);
        let mut tau = case.other.clone();
        arm.add_point_force(&mut ws, &case.q, &link, point, force, &mut tau).unwrap();
        for i in 0..case.dof() {
            let (work, _) = derivative(&case.q, i, case.links[i].kind(), |q| {
                dot(&arm.link_pose(&mut ws, q, &link).unwrap().apply(point), &force)
            });
            let size = crate::random_tree::norm(force) * reach(&case) + case.other[i].abs();
            close("Jᵀ f", tau[i], case.other[i] + work, size);
        }
    }

    /// A leaning base is gravity leaning the other way, and is the same as leaning what it carries.
    #[test]
    fn base_orientation_turns_gravity(case in case(8), rpy in prop::array::uniform3(-3.0..3.0f64)) {
        let lean = Pose::from_xyz_rpy([0.0; 3], rpy);
        let leaning = case.builder().base_orientation_rpy(rpy).build().unwrap();
        let builder = (0..case.dof()).fold(
            ArmBuilder::new().gravity(case.gravity),
            |b, i| {
                let spec = case.spec(i);
                let placement = match spec.parent {
                    None => lean.then(&spec.placement),
                    Some(_) => spec.placement,
                };
                b.body(BodySpec { placement, ..spec })
            },
        );
        let carried = builder.build().unwrap();
        let (a, b) = (momentum(&leaning, &case.q, &case.dq), momentum(&carried, &case.q, &case.dq));
        let size = magnitude(&mass_matrix(&leaning, &case.q), &case.dq);
        let speed: f64 = case.dq.iter().map(|v| v.abs()).sum();
        for i in 0..case.dof() {
            close("p", a.p[i], b.p[i], size);
            close("ct_dq", a.ct_dq[i], b.ct_dq[i], size * speed);
            close("g", a.g[i], b.g[i], gravity_magnitude(&case));
        }
    }
}

/// Returns `E(1 s) − E(0)` of a free motion by the classical Runge–Kutta method with `steps` steps.
fn energy_drift(arm: &Arm, q0: &[f64], dq0: &[f64], steps: usize) -> f64 {
    let n = arm.dof();
    let mut ws = ArmWorkspace::new(arm);
    let none = vec![0.0; n];
    let energy = |ws: &mut ArmWorkspace, q: &[f64], dq: &[f64]| {
        arm.kinetic_energy(ws, q, dq).unwrap() + arm.potential_energy(ws, q).unwrap()
    };
    let (mut q, mut dq) = (q0.to_vec(), dq0.to_vec());
    let before = energy(&mut ws, &q, &dq);
    let h = 1.0 / steps as f64;
    let moved = |x: &[f64], v: &[f64], h: f64| -> Vec<f64> {
        x.iter().zip(v).map(|(x, v)| x + h * v).collect()
    };
    let mut slope = |q: &[f64], dq: &[f64]| {
        let mut ddq = vec![0.0; n];
        arm.forward_dynamics(&mut ws, q, dq, &none, &mut ddq)
            .unwrap();
        ddq
    };
    for _ in 0..steps {
        let (v1, a1) = (dq.clone(), slope(&q, &dq));
        let v2 = moved(&dq, &a1, 0.5 * h);
        let a2 = slope(&moved(&q, &v1, 0.5 * h), &v2);
        let v3 = moved(&dq, &a2, 0.5 * h);
        let a3 = slope(&moved(&q, &v2, 0.5 * h), &v3);
        let v4 = moved(&dq, &a3, h);
        let a4 = slope(&moved(&q, &v3, h), &v4);
        for i in 0..n {
            q[i] += h / 6.0 * (v1[i] + 2.0 * v2[i] + 2.0 * v3[i] + v4[i]);
            dq[i] += h / 6.0 * (a1[i] + 2.0 * a2[i] + 2.0 * a3[i] + a4[i]);
        }
    }
    energy(&mut ws, &q, &dq) - before
}

/// A tree with both kinds of joints and a branch, at rest, falling.
fn falling_tree() -> (Arm, Vec<f64>) {
    let link = |revolute, parent, xyz, axis| crate::random_tree::Link {
        revolute,
        parent,
        xyz,
        rpy: [0.2, -0.4, 0.3],
        axis,
        particles: vec![
            (0.6, [0.1, 0.05, -0.1]),
            (0.5, [-0.1, 0.1, -0.3]),
            (0.4, [0.05, -0.15, -0.2]),
            (0.7, [0.0, 0.0, -0.35]),
        ],
    };
    let case = Case {
        links: vec![
            link(true, 0.0, [0.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
            link(false, 1.0, [0.1, 0.0, -0.3], [1.0, 0.0, 0.2]),
            link(true, 1.0, [0.0, 0.1, -0.1], [0.3, 1.0, -0.5]),
            link(true, 0.34, [0.0, -0.2, -0.2], [1.0, 0.0, 0.0]),
        ],
        gravity: [0.0, 0.0, -9.81],
        q: vec![1.1, 0.1, -0.7, 0.9],
        dq: vec![0.0; 4],
        other: vec![0.0; 4],
    };
    assert_eq!(case.parent(3), Some(0), "the tree branches");
    (case.arm(), case.q)
}

#[test]
fn energy_is_conserved_without_friction() {
    let (arm, q) = falling_tree();
    let rest = vec![0.0; arm.dof()];
    let drifts: Vec<f64> = [250, 500, 1000, 2000]
        .iter()
        .map(|&steps| energy_drift(&arm, &q, &rest, steps).abs())
        .collect();
    println!("energy drift over 1 s, J: {drifts:?}");
    // The error of the method decreases at least with the fourth power of the step; a wrong term in the
    // equations causes a constant drift.
    for pair in drifts.windows(2).take(2) {
        assert!(
            pair[1] < pair[0] / 12.0,
            "drift falls too slowly: {drifts:?}"
        );
    }
    assert!(drifts[3] < 1e-9, "drift of {} J", drifts[3]);
}

proptest! {
    #![proptest_config(config(12))]

    #[test]
    fn energy_is_conserved_by_any_tree(case in case(5)) {
        let arm = case.arm();
        let mut ws = ArmWorkspace::new(&arm);
        let scale = arm.kinetic_energy(&mut ws, &case.q, &case.dq).unwrap()
            + gravity_magnitude(&case);
        // Fast trees need small steps: halve until the drift is gone, which a wrong term forbids.
        let mut drift = f64::INFINITY;
        for steps in [500, 1000, 2000, 4000, 8000, 16_000] {
            drift = energy_drift(&arm, &case.q, &case.dq, steps).abs();
            if drift < 1e-9 * scale {
                break;
            }
        }
        prop_assert!(drift < 1e-9 * scale, "drift of {} J at 16 kHz, energies of {} J", drift, scale);
    }
}
