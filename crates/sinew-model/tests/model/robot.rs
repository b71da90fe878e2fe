//! Tests of `robot.toml`: its content, and the errors of invalid values.

use sinew_files::{Fault, Located};
use sinew_model::robot::{Robot, RobotFile};

const TOML: &str = include_str!("../../robots/biorob-like/robot.toml");
const URDF: &str = include_str!("../../robots/biorob-like/biorob-like.urdf");

fn build(text: &str) -> Result<Robot, Located> {
    RobotFile::parse(text, "robot.toml")?.build(URDF)
}

/// The error after one replacement; the place in the file is checked by the caller.
fn slip(from: &str, to: &str) -> String {
    assert!(TOML.contains(from), "{from}");
    build(&TOML.replacen(from, to, 1)).unwrap_err().to_string()
}

#[test]
fn shipped_robot_file_is_read_completely() {
    let robot = build(TOML).unwrap();
    assert_eq!(
        robot.joint_names(),
        ["shoulder_yaw", "shoulder_pitch", "elbow", "wrist"]
    );
    assert!(robot.warnings.is_empty(), "{:?}", robot.warnings);
    let elbow = robot.transmissions[2].as_ref().unwrap();
    assert_eq!(elbow.stiffness_nm_per_rad, 20.0);
    assert_eq!(elbow.motor_inertia_kg_m2, Some(0.06));
    let tendon = elbow.tendon.as_ref().unwrap();
    assert_eq!(tendon.rope.as_deref(), Some("liros-dc000-0301"));
    assert!((tendon.length_m - 0.7).abs() < 1e-15);
    assert!((tendon.guides[0].wrap_rad - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
    // 10 mrad on a 25 mm pulley: 0.25 mm, 0.036 % of 700 mm.
    assert!((tendon.elongation_m(0.01) - 0.25e-3).abs() < 1e-18);
    assert!((tendon.strain(0.01) - 0.25 / 700.0).abs() < 1e-15);
}

#[test]
fn robot_error_names_file_line_key_value_remedy() {
    for value in ["0.0", "-50.0", "nan", "inf"] {
        let error = slip(
            "stiffness_nm_per_rad = 50.0",
            &format!("stiffness_nm_per_rad = {value}"),
        );
        assert_eq!(
            error,
            format!(
                "robot.toml, line 6: joints.shoulder_yaw.stiffness_nm_per_rad = {value} (N·m/rad): must be above 0 N·m/rad"
            ),
        );
    }
    let error = slip("length_mm = 420.0", "length_mm = -420.0");
    assert!(
        error.contains("line 12") && error.contains("joints.shoulder_yaw.tendon.length_mm = -420"),
        "{error}"
    );
    let error = slip("coulomb_nm = 0.08", "coulomb_nm = -0.08");
    assert!(
        error.contains("joint_friction.coulomb_nm = -0.08 (N·m): must be at least 0"),
        "{error}"
    );
    let error = slip("radius_mm = 8.0", "radius_mm = 0.0");
    assert!(error.contains("guides[0].radius_mm"), "{error}");
}

#[test]
fn unknown_keys_and_joints_return_error() {
    let error = slip("stiffness_nm_per_rad = 50.0", "stiffnes_nm_per_rad = 50.0");
    assert!(
        error.contains("line 6") && error.contains("stiffnes_nm_per_rad"),
        "{error}"
    );
    let error = slip(
        "[joints.elbow]",
        "[joints.elbo]\nrigid = true\n[joints.elbow]",
    );
    assert!(
        error.contains("'elbo'") && error.contains("shoulder_yaw"),
        "{error}"
    );
    let without = TOML.split("[joints.wrist]").next().unwrap();
    let error = build(without).unwrap_err().to_string();
    assert!(
        error.contains("'wrist'") && error.contains("locked_at_rad"),
        "{error}"
    );
    let error = slip("stiffness_nm_per_rad = 50.0\n", "");
    assert!(error.contains("stiffness_nm_per_rad is missing"), "{error}");
    let error = slip(
        "stiffness_nm_per_rad = 50.0\n",
        "stiffness_nm_per_rad = \"stiff\"\n",
    );
    assert!(error.contains("line 6"), "{error}");
    assert!(matches!(build("joints = 3"), Err(e) if e.fault == Fault::WrongType));
    assert!(
        build("")
            .unwrap_err()
            .to_string()
            .contains("'shoulder_yaw'")
    );
}

#[test]
fn joints_can_be_rigid_or_locked() {
    let head = TOML.split("[joints.wrist]").next().unwrap();
    let rigid = build(&format!("{head}[joints.wrist]\nrigid = true\n")).unwrap();
    assert!(rigid.transmissions[3].is_none());
    let locked = build(&format!("{head}[joints.wrist]\nlocked_at_rad = 0.5\n")).unwrap();
    assert_eq!(locked.arm.dof(), 3);
    let both = build(&format!(
        "{head}[joints.wrist]\nrigid = true\nstiffness_nm_per_rad = 8.0\n"
    ));
    assert!(both.unwrap_err().to_string().contains("drop one"));
}

#[test]
fn urdf_errors_carry_the_file() {
    let file = RobotFile::parse(TOML, "robot.toml").unwrap();
    assert_eq!(file.urdf(), Some("biorob-like.urdf"));
    let error = file.build("<robot").unwrap_err().to_string();
    assert!(error.starts_with("biorob-like.urdf, line 1: "), "{error}");
}

#[test]
fn friction_along_path_replaces_spring() {
    let head = "[joints.elbow]\n";
    let with = TOML.replacen(head, &format!("{head}friction_along_path = true\n"), 1);
    let (robot, spring) = (build(&with).unwrap(), build(TOML).unwrap());
    assert_eq!((robot.cables.len(), robot.cables[0].axis), (1, 2));
    assert_eq!(robot.transmissions[2], None);
    assert_eq!(robot.cable(2), spring.transmissions[2].as_ref());
    assert_eq!(robot.cable(1), None);
    assert_eq!(robot.transmissions[1], spring.transmissions[1]);
    // The friction of the drive is the scale of its priors.
    let friction = "motor_friction = { coulomb_nm = 0.25";
    assert_eq!(with.matches(friction).count(), 1);
    let without = with.replacen(friction, "motor_friction = { coulomb_nm = 0.0", 1);
    let error = build(&without).unwrap_err().to_string();
    assert!(error.contains("friction_along_path requires"), "{error}");
    assert!(error.contains("coulomb_nm = VALUE"), "{error}");
}
