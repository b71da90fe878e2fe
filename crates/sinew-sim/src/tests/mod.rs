//! The physics against closed forms and balances, and the scenario file against bad input.

mod files;
mod invalid_scenarios;
mod later;
mod physics;
mod recording;
mod strands;
mod tendons;

use sinew_model::robot::{BIOROB_LIKE, Robot, RobotFile, SHIPPED_ROBOTS};
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// The arm that is shipped.
pub(super) fn biorob_like() -> Robot {
    shipped_robot(BIOROB_LIKE.name)
}

/// The robot of this name that is shipped.
pub(super) fn shipped_robot(name: &str) -> Robot {
    let shipped = SHIPPED_ROBOTS
        .into_iter()
        .find(|robot| robot.name == name)
        .unwrap_or_else(|| panic!("{name} is not shipped"));
    RobotFile::parse(shipped.robot_toml, "robot.toml")
        .and_then(|file| file.build(shipped.urdf))
        .unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// The folder of the repository, with its examples and pages; `None`, with a visible message, in the package alone.
pub(super) fn repository() -> Option<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    if root.join("examples/scenarios").is_dir() {
        return Some(root);
    }
    // Past the capture of a passing test's output.
    let _ = std::io::stderr().write_all(b"SKIPPED: examples and pages are not in the package\n");
    None
}

/// A pendulum of 0.5 kg at 0.3 m on a spring of 20 N·m/rad, motor inertia 0.05 kg·m², horizontal
/// at `q = 90°`.
pub(super) fn pendulum() -> Robot {
    RobotFile::parse(
        "[joints.swing]\nstiffness_nm_per_rad = 20.0\nmotor_inertia_kg_m2 = 0.05\n",
        "pendulum.toml",
    )
    .and_then(|f| {
        f.build(
            r#"<robot name="pendulum"><link name="base"/><link name="bob"><inertial>
            <origin xyz="0 0 -0.3"/><mass value="0.5"/>
            <inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>
            <joint name="swing" type="revolute"><parent link="base"/><child link="bob"/>
            <axis xyz="0 -1 0"/><limit lower="-3" upper="3" effort="9" velocity="9"/></joint></robot>"#,
        )
    })
    .expect("a pendulum is a robot")
}
