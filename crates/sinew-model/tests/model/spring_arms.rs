//! A pendulum and a tree on springs.

use sinew_model::Gaussian;
use sinew_model::arm::{Arm, urdf};
use sinew_model::correction::JointCorrection;
use sinew_model::transmission::Transmission;

/// A point mass of 0.5 kg at 0.3 m that hangs at `q = 0`: `g(q) = m g l sin q`.
const PENDULUM: &str = r#"<robot name="pendulum"><link name="base"/><link name="bob"><inertial>
    <origin xyz="0 0 -0.3"/><mass value="0.5"/>
    <inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>
    <joint name="swing" type="revolute"><parent link="base"/><child link="bob"/>
    <axis xyz="0 -1 0"/><limit lower="-3" upper="3" effort="9" velocity="9"/></joint></robot>"#;
pub(crate) const MGL: f64 = 0.5 * 9.81 * 0.3;
pub(crate) const K: f64 = 20.0;

fn arm(text: &str) -> Arm {
    urdf::parse(text, &urdf::UrdfOptions::default())
        .unwrap()
        .arm
}

/// A tree of nine joints.
pub(crate) fn branching() -> Arm {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/reference/models/branching9.urdf"
    );
    arm(&std::fs::read_to_string(path).unwrap())
}

/// Springs and friction, all different.
pub(crate) fn springs(n: usize) -> Vec<Option<Transmission>> {
    (0..n)
        .map(|i| {
            let mut t = Transmission::spring(20.0 + 5.0 * i as f64);
            t.joint_friction.coulomb_nm = 0.02 * i as f64;
            t.joint_friction.viscous_nm_s_per_rad = 0.05;
            Some(t)
        })
        .collect()
}

/// An offset, a wrong stiffness and a stiffening per joint, all different.
pub(crate) fn known(n: usize) -> Vec<JointCorrection> {
    (0..n)
        .map(|i| JointCorrection {
            delta_e_rad: Gaussian::new(0.004 * (i as f64 - 2.0), 0.0),
            stiffness_factor: Gaussian::new(0.9 + 0.05 * i as f64, 0.0),
            cubic_per_rad2: 0.7 * i as f64,
        })
        .collect()
}

/// Position, velocity and acceleration of a smooth motion at `t`.
pub(crate) fn motion(t: f64, n: usize) -> [Vec<f64>; 3] {
    let of = |f: &dyn Fn(f64, f64) -> f64| (0..n).map(|i| f(1.0 + 0.3 * i as f64, t)).collect();
    [
        of(&|w, t| 0.4 * (w * t).sin()),
        of(&|w, t| 0.4 * w * (w * t).cos()),
        of(&|w, t| -0.4 * w * w * (w * t).sin()),
    ]
}

/// The pendulum above.
pub(crate) fn pendulum() -> Arm {
    arm(PENDULUM)
}
