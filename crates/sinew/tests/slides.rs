//! A joint that slides has mm and N where one that turns has mrad and N·m.

use std::path::Path;
use std::process::Command;

const URDF: &str = r#"<robot name="lift">
  <link name="base"/>
  <link name="carriage"><inertial><origin xyz="0 0 0.1"/><mass value="3"/>
    <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="arm"><inertial><origin xyz="0.2 0 0"/><mass value="1"/>
    <inertia ixx="0.002" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="lift" type="prismatic"><parent link="base"/><child link="carriage"/><axis xyz="0 0 1"/>
    <limit lower="0" upper="0.5" effort="200" velocity="1"/></joint>
  <joint name="turn" type="revolute"><parent link="carriage"/><child link="arm"/><axis xyz="0 1 0"/>
    <limit lower="-1.5" upper="1.5" effort="20" velocity="3"/></joint>
</robot>"#;

/// The rope of the lift moves as far as it does: a radius of 1000 mm per m.
const ROBOT: &str = r#"urdf = "lift.urdf"
[joints.lift]
stiffness_nm_per_rad = 20000.0
motor_inertia_kg_m2 = 4.0
joint_friction = { coulomb_nm = 2.0, viscous_nm_s_per_rad = 5.0 }
motor_friction = { coulomb_nm = 5.0, viscous_nm_s_per_rad = 10.0 }
[joints.lift.tendon]
rope = "liros-dc000-0701"
length_mm = 1000.0
joint_pulley_radius_mm = 1000.0
pretension_n = 60.0
antagonistic = true
[joints.turn]
stiffness_nm_per_rad = 40.0
motor_inertia_kg_m2 = 0.1
joint_friction = { coulomb_nm = 0.05, viscous_nm_s_per_rad = 0.03 }
motor_friction = { coulomb_nm = 0.2, viscous_nm_s_per_rad = 0.05 }
"#;

const SCENARIO: &str = r#"name = "lift"
robot = "."
duration_s = 20.0
sample_rate_hz = 200
seed = 1
[controller]
stiffness_nm_per_rad = { lift = 20000.0, turn = 40.0 }
damping_nm_s_per_rad = { lift = 800.0, turn = 4.0 }
[motion]
kind = "random"
range_rad = { lift = { min = 0.05, max = 0.4 }, turn = { min = -1.0, max = 1.0 } }
move_s = 1.0
pause_s = 0.5
[encoder]
motor_noise_rad = 0.00002
[[offsets]]
joint = "lift"
kind = "physical"
rad = 0.0004
"#;

fn sinew(dir: &Path, args: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_sinew"))
        .args(args)
        .current_dir(dir)
        .output();
    let output = output.expect("the program starts");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.code() == Some(0) || output.status.code() == Some(3),
        "{args:?}: {errors}"
    );
    String::from_utf8_lossy(&output.stdout).into_owned() + &errors
}

#[test]
fn prismatic_joint_is_shown_in_mm_and_newtons() {
    let folder = tempfile::tempdir().expect("a folder");
    let dir = folder.path();
    for (name, text) in [
        ("lift.urdf", URDF),
        ("robot.toml", ROBOT),
        ("lift.toml", SCENARIO),
    ] {
        std::fs::write(dir.join(name), text).expect("written");
    }
    sinew(dir, &["init", "lift.urdf", "--out", "first"]);
    let first = std::fs::read_to_string(dir.join("first/robot.toml")).expect("a robot");
    let [lift, turn] = ["[joints.lift]", "[joints.turn]"].map(|s| first.split(s).nth(1));
    let lift = lift.and_then(|s| s.split("[joints.turn]").next());
    assert!(
        lift.is_some_and(|s| s.contains(" N/m") && !s.contains("N·m")),
        "{first}"
    );
    assert!(
        turn.is_some_and(|s| s.contains(" N·m/rad") && !s.contains(" N/m")),
        "{first}"
    );
    sinew(dir, &["simulate", "lift.toml", "--out", "lift.mcap"]);
    for method in ["absolute", "paper"] {
        let text = sinew(
            dir,
            &[
                "estimate",
                "lift.mcap",
                "--method",
                method,
                "--report",
                "lift.html",
            ],
        );
        assert!(text.contains("lift (mm, N)"), "{text}");
        // Lines may break anywhere; sentences about the lift use its units.
        let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
        for sentence in text.split("lift: ").skip(1) {
            let sentence = &sentence[..sentence.find(['.', ';']).unwrap_or(sentence.len())];
            assert!(
                !sentence.contains("mrad") && !sentence.contains("N·m"),
                "{sentence}"
            );
        }
        let page = std::fs::read_to_string(dir.join("lift.html")).expect("a report");
        assert!(
            page.contains("(mm)") && page.contains("force (N)") || page.contains("(N)"),
            "{method}"
        );
        assert!(page.contains("lift (mm, N)"), "{method}");
    }
    let nuisance = sinew(dir, &["estimate", "lift.mcap", "--nuisance"]);
    let line = nuisance
        .lines()
        .find(|l| l.starts_with("lift") && l.contains("Coulomb"))
        .expect("friction");
    assert!(line.contains(" N ") && !line.contains("N·m"), "{line}");
    let json = sinew(dir, &["estimate", "lift.mcap", "--json", "--quiet"]);
    let json: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    let joints = json["session"]["joints"].as_array().expect("joints");
    assert_eq!(
        (&joints[0]["slides"], joints[1].get("slides")),
        (&true.into(), None)
    );
    // 0.4 mm, in m, within what is claimed.
    let [mean, std] =
        ["mean", "std"].map(|key| joints[0]["offset_rad"][key].as_f64().expect("a number"));
    assert!(
        (mean - 0.4e-3).abs() < 1.96 * std && std < 2e-3,
        "{mean} {std}"
    );
    let plan = sinew(
        dir,
        &[
            "rope",
            "pretension",
            "--robot",
            ".",
            "--joint",
            "lift",
            "--torque",
            "20",
            "--draws",
            "20",
        ],
    );
    let plan = plan.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        plan.contains("joint torque 20.0 N;") && plan.contains("sag of the joint"),
        "{plan}"
    );
    // A robot of joints that slide alone has their units in the heads.
    let alone = URDF.replace("type=\"revolute\"", "type=\"fixed\"");
    let robot = &ROBOT[..ROBOT.find("[joints.turn]").expect("there")];
    let scenario = SCENARIO
        .replace(", turn = 40.0", "")
        .replace(", turn = 4.0", "")
        .replace(", turn = { min = -1.0, max = 1.0 }", "");
    for (name, text) in [
        ("lift.urdf", alone.as_str()),
        ("robot.toml", robot),
        ("lift.toml", &scenario),
    ] {
        std::fs::write(dir.join(name), text).expect("written");
    }
    sinew(dir, &["simulate", "lift.toml", "--out", "alone.mcap"]);
    let text = sinew(dir, &["estimate", "alone.mcap"]);
    assert!(
        !text.contains("mrad") && !text.contains("N·m") && text.contains("offset"),
        "{text}"
    );
}
