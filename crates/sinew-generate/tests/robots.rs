//! Robots for which code is generated, and samples of a motion.

use sinew_model::arm::urdf;
use sinew_model::robot::{Robot, RobotFile};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Chains, a tree, sliding joints, many joints.
const MODELS: [&str; 6] = [
    "serial4",
    "serial7",
    "gantry6",
    "branching9",
    "torso17",
    "humanoid32",
];

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// The arm of the repository: every joint elastic.
pub(crate) fn biorob_like() -> Robot {
    let folder = repository().join("robots/biorob-like");
    let file = RobotFile::parse(&read(&folder.join("robot.toml")), "robot.toml").unwrap();
    file.build(&read(&folder.join("biorob-like.urdf"))).unwrap()
}

/// The reference models: of three joints one rigid, one with friction, one without.
pub(crate) fn models() -> impl Iterator<Item = Robot> {
    MODELS.iter().map(|name| {
        let folder = repository().join("crates/sinew-model/tests/reference/models");
        let text = read(&folder.join(format!("{name}.urdf")));
        let arm = urdf::parse(&text, &urdf::UrdfOptions::default()).unwrap().arm;
        let mut toml = "urdf = \"x.urdf\"\n".to_owned();
        for (i, joint) in arm.joint_names().iter().enumerate() {
            let _ = writeln!(toml, "[joints.{joint}]");
            let _ = match i % 3 {
                0 => writeln!(toml, "rigid = true"),
                1 => writeln!(
                    toml,
                    "stiffness_nm_per_rad = {}.0\njoint_friction = {{ coulomb_nm = 0.2, viscous_nm_s_per_rad = 0.1 }}",
                    10 + i
                ),
                _ => writeln!(toml, "stiffness_nm_per_rad = {}.0", 30 + i),
            };
        }
        RobotFile::parse(&toml, "robot.toml").unwrap().build(&text).unwrap()
    })
}

/// Inputs of one step of the generated code.
#[derive(Debug, Clone)]
pub(crate) struct Sample {
    pub(crate) dt_s: f64,
    pub(crate) known: bool,
    pub(crate) q: Vec<f64>,
    pub(crate) theta: Vec<f64>,
    pub(crate) tau_ext: Vec<f64>,
    pub(crate) dq: Vec<f64>,
}

/// Angles in every quarter, at the borders between quarters, and many turns away, rad.
const ANGLES: [f64; 24] = [
    -0.0,
    FRAC_PI_4,
    FRAC_PI_4.next_up(),
    FRAC_PI_2,
    3.0 * FRAC_PI_4,
    2.4,
    PI,
    4.0,
    7.0 * FRAC_PI_4,
    TAU,
    -FRAC_PI_4,
    -FRAC_PI_4.next_up(),
    -FRAC_PI_2,
    -2.4,
    -3.0,
    -5.0 * FRAC_PI_4,
    -5.0,
    -TAU,
    99_999.9,
    -98_765.4,
    100_000.1,
    -123_456.7,
    1e9,
    31_415.9,
];

/// Samples of [`motion`] that a step refuses.
pub(crate) const REFUSED: usize = 3 + ANGLES.len();

/// Returns a motion at 1 kHz that changes to 250 Hz, with invalid samples. It ends with arbitrary angles without a
/// time step, which only the momentum pass evaluates.
pub(crate) fn motion(joints: usize, known: bool) -> Vec<Sample> {
    let mut t = 0.0;
    (0..400 + ANGLES.len())
        .map(|k| {
            let mut dt_s = if k < 300 { 1e-3 } else { 4e-3 };
            t += dt_s;
            let rate = |i: usize| 2.0 + 0.7 * (i % 7) as f64;
            let each = |f: &dyn Fn(usize) -> f64| (0..joints).map(f).collect::<Vec<f64>>();
            let mut q = each(&|i| (rate(i) * t + i as f64).sin());
            let dq = each(&|i| rate(i) * (rate(i) * t + i as f64).cos());
            let theta = each(&|i| q[i] + 0.05 * (3.0 * t + 2.0 * i as f64).cos());
            let tau_ext = each(&|i| (5.0 * t - i as f64).sin());
            match k {
                150 => q[joints - 1] = f64::NAN,
                170 => dt_s = 0.0,
                190 => q[0] = 1e300,
                400.. => {
                    dt_s = 0.0;
                    q = each(&|i| ANGLES[(k + 5 * i) % ANGLES.len()]);
                }
                _ => {}
            }
            Sample {
                dt_s,
                known,
                q,
                theta,
                tau_ext,
                dq,
            }
        })
        .collect()
}
