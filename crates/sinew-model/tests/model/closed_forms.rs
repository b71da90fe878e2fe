//! Closed forms from textbooks, written by hand.

use sinew_model::arm::{Arm, ArmBuilder, ArmWorkspace, BodyInertia, BodySpec, JointKind, Pose};

/// Agreement up to rounding: some 200 operations on values of this `size`.
#[track_caller]
fn close(what: &str, ours: f64, reference: f64, size: f64) {
    let difference = (ours - reference).abs();
    assert!(
        difference <= 100.0 * f64::EPSILON * size,
        "{what}: {ours} is not {reference}, they differ by {difference:e}"
    );
}

/// `p`, `Cᵀdq`, `g`.
fn momentum(arm: &Arm, q: &[f64], dq: &[f64]) -> [Vec<f64>; 3] {
    let mut ws = ArmWorkspace::new(arm);
    let terms = arm.momentum(&mut ws, q, dq).unwrap();
    [terms.p.to_vec(), terms.ct_dq.to_vec(), terms.g.to_vec()]
}

fn joint(
    name: &str,
    kind: JointKind,
    parent: Option<usize>,
    xyz: [f64; 3],
    axis: [f64; 3],
    body: BodyInertia,
) -> BodySpec {
    BodySpec {
        name: name.into(),
        kind,
        parent,
        placement: Pose::from_xyz_rpy(xyz, [0.0; 3]),
        axis,
        body,
    }
}

/// A rod of length `l`: `g = ½ m g l sin q`, `p = ⅓ m l² dq`.
#[test]
fn physical_pendulum() {
    let (m, l, g) = (1.3, 0.7, 9.81);
    let mut body = BodyInertia::point(m, [0.0, 0.0, -0.5 * l]);
    body.inertia[0][0] = m * l * l / 12.0;
    body.inertia[1][1] = m * l * l / 12.0;
    let arm = ArmBuilder::new()
        .body(joint(
            "swing",
            JointKind::Revolute,
            None,
            [0.0; 3],
            [0.0, 1.0, 0.0],
            body,
        ))
        .build()
        .unwrap();
    for (q, dq) in [(0.0f64, 1.0), (0.4, -2.0), (1.9, 3.0), (-2.6, 0.5)] {
        let [p, ct_dq, g_tau] = momentum(&arm, &[q], &[dq]);
        close("p", p[0], m * l * l / 3.0 * dq, m);
        close("ct_dq", ct_dq[0], 0.0, m);
        close("g", g_tau[0], 0.5 * m * g * l * q.sin(), m * g);
        let mut ws = ArmWorkspace::new(&arm);
        let mut ddq = [0.0];
        arm.forward_dynamics(&mut ws, &[q], &[dq], &[0.0], &mut ddq)
            .unwrap();
        close("ddq", ddq[0], -1.5 * g / l * q.sin(), 1.5 * g / l);
    }
}

/// Tedrake, *Underactuated Robotics*, ch. 3.2.1 (cart-pole; pole angle from hanging down):
/// `T = ½ (m_c + m_p) ẋ² + m_p ẋ θ̇ l cos θ + ½ m_p l² θ̇²`, `V = −m_p g l cos θ`.
#[test]
fn cart_pole() {
    let (mc, mp, l, g) = (2.1, 0.45, 0.6, 9.81);
    let cart = BodyInertia::point(mc, [0.1, 0.0, 0.0]);
    let pole = BodyInertia::point(mp, [0.0, 0.0, -l]);
    let arm = ArmBuilder::new()
        .body(joint(
            "cart",
            JointKind::Prismatic,
            None,
            [0.0; 3],
            [1.0, 0.0, 0.0],
            cart,
        ))
        // Turning about −y swings a hanging pole towards +x.
        .body(joint(
            "pole",
            JointKind::Revolute,
            Some(0),
            [0.0; 3],
            [0.0, -1.0, 0.0],
            pole,
        ))
        .build()
        .unwrap();
    for (x, a, dx, da) in [
        (0.0f64, 0.0f64, 1.0, 1.0),
        (0.3, 0.8, -0.5, 2.2),
        (-1.2, 2.5, 0.9, -1.4),
        (2.0, -1.1, 1.6, 0.7),
    ] {
        let (s, c) = a.sin_cos();
        let [p, ct_dq, g_tau] = momentum(&arm, &[x, a], &[dx, da]);
        let size = 10.0 * (mc + mp);
        close("p_x", p[0], (mc + mp) * dx + mp * l * c * da, size);
        close("p_θ", p[1], mp * l * c * dx + mp * l * l * da, size);
        close("∂T/∂x", ct_dq[0], 0.0, size);
        close("∂T/∂θ", ct_dq[1], -mp * l * s * dx * da, size);
        close("g_x", g_tau[0], 0.0, size);
        close("g_θ", g_tau[1], mp * g * l * s, size);
        let mut ws = ArmWorkspace::new(&arm);
        let bias = arm.bias_torque(&mut ws, &[x, a], &[dx, da]).unwrap();
        close("bias_x", bias[0], -mp * l * s * da * da, size);
        close("bias_θ", bias[1], mp * g * l * s, size);
        // Tedrake's eq. for ẍ without a force on the cart.
        let mut ddq = [0.0; 2];
        arm.forward_dynamics(&mut ws, &[x, a], &[dx, da], &[0.0; 2], &mut ddq)
            .unwrap();
        let ddx = mp * s * (l * da * da + g * c) / (mc + mp * s * s);
        close("ẍ", ddq[0], ddx, size);
    }
}

/// Murray, Li, Sastry, *A Mathematical Introduction to Robotic Manipulation*, 1994, example 4.2
/// (planar two-link arm), with gravity along −y added.
#[test]
fn planar_two_link_arm() {
    let (m1, m2, l1, r1, r2, i1, i2, g) = (1.4, 0.9, 0.5, 0.23, 0.19, 0.031, 0.014, 9.81);
    let link = |m: f64, r: f64, i: f64| {
        let mut body = BodyInertia::point(m, [r, 0.0, 0.0]);
        body.inertia[2][2] = i;
        body
    };
    let z = [0.0, 0.0, 1.0];
    let arm = ArmBuilder::new()
        .gravity([0.0, -g, 0.0])
        .body(joint(
            "one",
            JointKind::Revolute,
            None,
            [0.0; 3],
            z,
            link(m1, r1, i1),
        ))
        .body(joint(
            "two",
            JointKind::Revolute,
            Some(0),
            [l1, 0.0, 0.0],
            z,
            link(m2, r2, i2),
        ))
        .build()
        .unwrap();
    let alpha = i1 + i2 + m1 * r1 * r1 + m2 * (l1 * l1 + r2 * r2);
    let (beta, delta) = (m2 * l1 * r2, i2 + m2 * r2 * r2);
    for (a, b, da, db) in [
        (0.0f64, 0.0f64, 1.0, 1.0),
        (0.7, -1.3, 2.0, -0.6),
        (-2.2, 0.9, -1.1, 1.9),
    ] {
        let (s2, c2) = b.sin_cos();
        let m = [
            [alpha + 2.0 * beta * c2, delta + beta * c2],
            [delta + beta * c2, delta],
        ];
        let c = [
            [-beta * s2 * db, -beta * s2 * (da + db)],
            [beta * s2 * da, 0.0],
        ];
        let [p, ct_dq, g_tau] = momentum(&arm, &[a, b], &[da, db]);
        let mut ws = ArmWorkspace::new(&arm);
        let bias = arm.bias_torque(&mut ws, &[a, b], &[da, db]).unwrap();
        let gravity = [
            (m1 * r1 + m2 * l1) * g * a.cos() + m2 * r2 * g * (a + b).cos(),
            m2 * r2 * g * (a + b).cos(),
        ];
        for i in 0..2 {
            close("p", p[i], m[i][0] * da + m[i][1] * db, 10.0);
            close("Cᵀdq", ct_dq[i], c[0][i] * da + c[1][i] * db, 10.0);
            close("g", g_tau[i], gravity[i], 2.0 * g);
            close(
                "C dq + g",
                bias[i],
                c[i][0] * da + c[i][1] * db + gravity[i],
                2.0 * g,
            );
        }
    }
}

#[test]
fn bodies_without_mass_add_their_inertias() {
    let of = |xx: f64, xy: f64| BodyInertia {
        inertia: [[xx, xy, 0.0], [xy, 2.0 * xx, 0.0], [0.0, 0.0, 3.0 * xx]],
        ..BodyInertia::ZERO
    };
    assert_eq!(of(1.0, 0.25).plus(&of(2.0, 0.5)), of(3.0, 0.75));
}
