//! The physics against closed forms and balances, and the scenario file against bad input.

mod files;
mod invalid_scenarios;
mod later;
mod physics;
mod recording;
mod strands;
mod tendons;

use sinew_model::robot::{Robot, RobotFile};

/// The arm that is shipped.
pub(super) fn biorob_like() -> Robot {
    RobotFile::parse(
        include_str!("../../../../robots/biorob-like/robot.toml"),
        "robot.toml",
    )
    .and_then(|f| {
        f.build(include_str!(
            "../../../../robots/biorob-like/biorob-like.urdf"
        ))
    })
    .expect("the shipped robot is readable")
}

/// The robot of a folder, with the only URDF in it.
pub(super) fn shipped_robot(folder: &std::path::Path) -> Robot {
    let read = |path: &std::path::Path| {
        std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
    };
    let is_urdf = |path: &std::path::PathBuf| path.extension().is_some_and(|e| e == "urdf");
    let urdf = std::fs::read_dir(folder)
        .unwrap_or_else(|e| panic!("{}: {e}", folder.display()))
        .filter_map(|entry| Some(entry.ok()?.path()))
        .find(is_urdf)
        .expect("a URDF beside robot.toml");
    RobotFile::parse(&read(&folder.join("robot.toml")), "robot.toml")
        .and_then(|f| f.build(&read(&urdf)))
        .unwrap_or_else(|e| panic!("{}: {e}", folder.display()))
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
