//! A pendulum whose every number is known in closed form.

use sinew_files::Located;
use sinew_model::arm::Arm;
use sinew_model::correction::Spring;
use sinew_model::offset::{Block, FeatureConfig, FeatureObserver, Prior};
use sinew_model::robot::{Robot, RobotFile};

pub(crate) const K: f64 = 20.0;
pub(crate) const MASS_KG: f64 = 0.5;
pub(crate) const LENGTH_M: f64 = 0.3;
pub(crate) const G: f64 = 9.80665;

/// A point mass on a massless rod, hanging straight down at `q = 0`.
pub(crate) fn pendulum(extra: &str) -> Result<Robot, Located> {
    let toml = format!(
        "[joints.swing]\nstiffness_nm_per_rad = {K}\nmotor_inertia_kg_m2 = 0.05\n\
         joint_friction = {{ coulomb_nm = 0.01 }}\n{extra}"
    );
    RobotFile::parse(&toml, "pendulum.toml")?.build(&format!(
        r#"<robot name="pendulum"><link name="base"/><link name="bob"><inertial>
        <origin xyz="0 0 -{LENGTH_M}"/><mass value="{MASS_KG}"/>
        <inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>
        <joint name="swing" type="revolute"><parent link="base"/><child link="bob"/>
        <axis xyz="0 -1 0"/><limit lower="-3" upper="3" effort="9" velocity="9"/></joint></robot>"#
    ))
}

pub(crate) fn prior(robot: &Robot) -> Prior {
    Prior::new(
        &robot.arm,
        &robot.transmissions,
        0,
        [0.0, 0.0, -LENGTH_M],
        robot.tolerances,
    )
}

/// True parameters of a swing.
#[derive(Clone, Copy)]
pub(crate) struct Truth {
    pub(crate) offset_rad: f64,
    pub(crate) compliance: f64,
    pub(crate) slack_rad: f64,
    /// Coefficient `c` of `τ = K x (1 + c x²)`, 1/rad².
    pub(crate) cubic_per_rad2: f64,
    /// The offset grows by this at half time.
    pub(crate) step_rad: f64,
    /// Amplitude and middle of the swing, rad.
    pub(crate) swing_rad: [f64; 2],
}

pub(crate) const PLAIN: Truth = Truth {
    offset_rad: 0.01,
    compliance: 0.1,
    slack_rad: 0.0,
    cubic_per_rad2: 0.0,
    step_rad: 0.0,
    swing_rad: [1.2, 0.2],
};

/// Blocks of 60 s of `q = middle + a (sin 0.7 t + sin 0.31 t)/2`, the spring's torque in closed
/// form: `τ = m l² ddq + m g l sin q`.
pub(crate) fn blocks(arm: &Arm, truth: Truth) -> Vec<Block> {
    let mut features = FeatureObserver::new(arm, FeatureConfig::default());
    let dt = 0.004;
    let [a, middle] = truth.swing_rad;
    let spring = Spring::new(K / (1.0 + truth.compliance), truth.cubic_per_rad2).unwrap();
    let mut out = Vec::new();
    for k in 0..15_000 {
        let t = f64::from(k) * dt;
        let (w1, w2) = (0.7, 0.31);
        let q = middle + 0.5 * a * ((w1 * t).sin() + (w2 * t).sin());
        let ddq = -0.5 * a * (w1 * w1 * (w1 * t).sin() + w2 * w2 * (w2 * t).sin());
        let tau = MASS_KG * LENGTH_M * LENGTH_M * ddq + MASS_KG * G * LENGTH_M * q.sin();
        let mut offset = truth.offset_rad;
        if t > 30.0 {
            offset += truth.step_rad;
        }
        let theta = q + spring.deflection(tau).unwrap() + offset + truth.slack_rad * tau.signum();
        if features.step(dt, &[q], &[theta], &[f64::NAN], f64::NAN) == Ok(true) {
            out.push(features.block().clone());
        }
    }
    out
}
