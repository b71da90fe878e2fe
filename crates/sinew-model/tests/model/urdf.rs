//! URDF text to arm: what is accepted, warned of and refused.

use sinew_model::arm::urdf::{UrdfError, UrdfOptions, parse};
use sinew_model::arm::{ArmError, ArmWorkspace};

const PENDULUM: &str = r#"<robot name="pendulum">
  <link name="base"/>
  <link name="bob"><inertial><origin xyz="0 0 -0.5"/><mass value="2"/>
    <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
  <joint name="swing" type="revolute"><parent link="base"/><child link="bob"/>
    <axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/>
    <dynamics damping="0.1" friction="0.2"/></joint>
</robot>"#;

fn refused(text: &str) -> UrdfError {
    parse(text, &UrdfOptions::default()).unwrap_err()
}

/// The message of a refusal.
fn message(text: &str) -> String {
    refused(text).to_string()
}

fn warnings(text: &str) -> Vec<String> {
    parse(text, &UrdfOptions::default()).unwrap().warnings
}

#[test]
fn pendulum_urdf_is_parsed() {
    let urdf = parse(PENDULUM, &UrdfOptions::default()).unwrap();
    assert_eq!(urdf.name, "pendulum");
    assert!(urdf.warnings.is_empty(), "{:?}", urdf.warnings);
    assert_eq!(
        (urdf.coulomb_nm[0], urdf.viscous_nm_s_per_rad[0]),
        (0.2, 0.1)
    );
    let mut ws = ArmWorkspace::new(&urdf.arm);
    let terms = urdf.arm.momentum(&mut ws, &[0.3], &[2.0]).unwrap();
    // (m l² + I) dq and m g l sin q
    assert!((terms.p[0] - (2.0 * 0.25 + 0.01) * 2.0).abs() < 1e-14);
    assert!((terms.g[0] - 2.0 * 9.81 * 0.5 * 0.3f64.sin()).abs() < 1e-14);
}

#[test]
fn invalid_urdf_returns_error() {
    for text in [
        "",
        "  \n",
        "hello",
        "<robot",
        "<html><body/></html>",
        "{}",
        "<robot name='x'></robot>",
    ] {
        let error = message(text);
        assert!(!error.contains('\n'), "{error}");
    }
    // Every truncation of a good file is refused or read, never a panic.
    for end in 0..PENDULUM.len() {
        let _ = parse(&PENDULUM[..end], &UrdfOptions::default());
    }
    assert!(message(&PENDULUM[..PENDULUM.len() / 2]).contains("not a readable URDF"));
}

#[test]
fn invalid_mass_error_names_location_and_value() {
    let error = refused(&PENDULUM.replace("value=\"2\"", "value=\"-2\""));
    assert!(
        matches!(&error, UrdfError::Arm(ArmError::NegativeMass { mass_kg, .. }) if *mass_kg == -2.0)
    );
    assert!(error.to_string().contains("link 'bob'") && error.to_string().contains("-2 kg"));
    for value in ["NaN", "inf", "-inf"] {
        let error = message(&PENDULUM.replace("value=\"2\"", &format!("value=\"{value}\"")));
        assert!(
            error.contains("link 'bob'") && error.contains("mass"),
            "{error}"
        );
        let error = message(&PENDULUM.replace("ixx=\"0.01\"", &format!("ixx=\"{value}\"")));
        assert!(error.contains("inertia"), "{error}");
        let error = message(&PENDULUM.replace("xyz=\"0 0 -0.5\"", &format!("xyz=\"0 0 {value}\"")));
        assert!(error.contains("link 'bob'"), "{error}");
    }
    assert!(
        message(&PENDULUM.replace("axis xyz=\"0 1 0\"", "axis xyz=\"0 0 0\"")).contains("axis")
    );
}

#[test]
fn implausible_values_give_warnings() {
    let no_mass = PENDULUM.replace("value=\"2\"", "value=\"0\"");
    let all = warnings(&no_mass).join("\n");
    assert!(all.contains("no mass") && all.contains("'swing'"), "{all}");

    let not_definite = PENDULUM.replace("ixx=\"0.01\"", "ixx=\"-0.01\"");
    assert!(warnings(&not_definite)[0].contains("not positive definite"));
    let coupled = PENDULUM.replace("ixy=\"0\"", "ixy=\"0.02\"");
    assert!(warnings(&coupled)[0].contains("not positive definite"));
    let triangle = PENDULUM.replace("izz=\"0.01\"", "izz=\"0.05\"");
    assert!(warnings(&triangle)[0].contains("triangle"));

    let negative_friction = PENDULUM.replace("friction=\"0.2\"", "friction=\"-0.39\"");
    let urdf = parse(&negative_friction, &UrdfOptions::default()).unwrap();
    assert!(
        urdf.warnings[0].contains("negative friction")
            && urdf.warnings[0].contains("swing (friction -0.390 N·m)")
    );
    assert_eq!(urdf.coulomb_nm[0], 0.0);
}

#[test]
fn invalid_tree_returns_error() {
    let second_base = PENDULUM.replace("</robot>", "<link name=\"island\"/></robot>");
    assert!(message(&second_base).contains("'island'"));
    let twice = PENDULUM.replace("</robot>", "<link name=\"bob\"/></robot>");
    assert!(message(&twice).contains("twice"));
    let unknown = PENDULUM.replace("child link=\"bob\"", "child link=\"rod\"");
    assert!(message(&unknown).contains("'rod'"));
    let ring = r#"<robot name="ring"><link name="base"/><link name="a"/><link name="b"/>
      <joint name="ab" type="continuous"><parent link="a"/><child link="b"/></joint>
      <joint name="ba" type="continuous"><parent link="b"/><child link="a"/></joint></robot>"#;
    assert!(message(ring).contains("closed loop"));
    let only_base = r#"<robot name="rock"><link name="base"/></robot>"#;
    assert!(message(only_base).contains("no moving joint"));
}

#[test]
fn unsupported_joint_returns_error_unless_locked() {
    for kind in ["floating", "planar"] {
        let text = PENDULUM.replace("type=\"revolute\"", &format!("type=\"{kind}\""));
        let error = message(&text);
        assert!(error.contains("'swing'") && error.contains(kind), "{error}");
    }
    assert!(!message(&PENDULUM.replace("\"revolute\"", "\"hinge\"")).is_empty());
}

/// Two links; the second joint is locked at an angle.
const DOUBLE: &str = r#"<robot name="double">
  <link name="base"/>
  <link name="upper"><inertial><origin xyz="0 0 -0.5"/><mass value="2"/>
    <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
  <link name="lower"><inertial><origin xyz="0 0 -0.3"/><mass value="1"/>
    <inertia ixx="0.02" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.01"/></inertial></link>
  <joint name="a" type="revolute"><parent link="base"/><child link="upper"/>
    <axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <joint name="b" type="KIND"><parent link="upper"/><child link="lower"/>
    <origin xyz="0 0 -1"/><axis xyz="0 2 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
</robot>"#;

#[test]
fn locked_joint_equals_fixed_joint() {
    for (kind, at) in [("revolute", 0.7), ("prismatic", -0.2)] {
        let text = DOUBLE.replace("KIND", kind);
        let free = parse(&text, &UrdfOptions::default()).unwrap().arm;
        let options = UrdfOptions {
            locked: vec![("b".into(), at)],
            ..Default::default()
        };
        let locked = parse(&text, &options).unwrap().arm;
        assert_eq!(locked.joint_names(), ["a"]);
        let (mut ws_free, mut ws_locked) = (ArmWorkspace::new(&free), ArmWorkspace::new(&locked));
        let a = free
            .momentum(&mut ws_free, &[0.4, at], &[1.5, 0.0])
            .unwrap();
        let b = locked.momentum(&mut ws_locked, &[0.4], &[1.5]).unwrap();
        assert!((a.p[0] - b.p[0]).abs() < 1e-14, "{kind}");
        assert!((a.g[0] - b.g[0]).abs() < 1e-13, "{kind}");
    }
    let options = UrdfOptions {
        locked: vec![("c".into(), 0.0)],
        ..Default::default()
    };
    let error = parse(&DOUBLE.replace("KIND", "revolute"), &options).unwrap_err();
    assert!(error.to_string().contains("'c'") && error.to_string().contains("a, b"));
}

#[test]
fn mimic_joints_are_joints_with_a_warning() {
    let text = DOUBLE.replace("KIND", "revolute").replace(
        "<origin xyz=\"0 0 -1\"/>",
        "<origin xyz=\"0 0 -1\"/><mimic joint=\"a\"/>",
    );
    let urdf = parse(&text, &UrdfOptions::default()).unwrap();
    assert_eq!(urdf.arm.dof(), 2);
    assert!(urdf.warnings[0].contains("mimics 'a'"));
}

#[test]
fn gravity_follows_the_base() {
    // A base lying on its side: world z is base −x.
    let options = UrdfOptions {
        base_rpy_rad: [0.0, std::f64::consts::FRAC_PI_2, 0.0],
        ..Default::default()
    };
    let arm = parse(PENDULUM, &options).unwrap().arm;
    let g = arm.gravity();
    assert!((g[0] - 9.81).abs() < 1e-14 && g[2].abs() < 1e-14, "{g:?}");
}

#[test]
fn urdf_error_names_line_and_element() {
    for (good, bad, part) in [
        (
            "value=\"2\"",
            "value=\"two\"",
            "line 3: link 'bob', <mass> value = \"two\" must be a number",
        ),
        (
            "xyz=\"0 1 0\"",
            "xyz=\"0 1\"",
            "line 6: joint 'swing', <axis> xyz = \"0 1\" must be 3 numbers",
        ),
        (
            "ixx=\"0.01\" ",
            "",
            "line 4: link 'bob', <inertia> has no ixx",
        ),
        (
            "<parent link=\"base\"/>",
            "",
            "line 5: joint 'swing', <joint> has no <parent>",
        ),
        (
            "type=\"revolute\"",
            "type=\"hinge\"",
            "line 5: joint 'swing', <joint> type = \"hinge\" must be one of revolute",
        ),
        ("</link>\n  <joint", "</lonk>\n  <joint", "line 4"),
    ] {
        let error = message(&PENDULUM.replace(good, bad));
        assert!(error.contains(part), "{error}");
    }
}

#[test]
fn later_urdf_versions_are_parsed() {
    let versioned =
        |text: &str| text.replace("name=\"pendulum\"", "name=\"pendulum\" version=\"1.2\"");
    let free = versioned(PENDULUM).replace(
        "<limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/>",
        "<limit effort=\"3\"/>",
    );
    let limits = parse(&free, &UrdfOptions::default()).unwrap().limits[0];
    assert_eq!((limits.lower, limits.effort), (f64::NEG_INFINITY, 3.0));
    // A quarter turn about x, as a quaternion and as roll, pitch, yaw.
    let half = std::f64::consts::FRAC_PI_4;
    let quaternion = format!(
        "<origin xyz=\"0 0 -0.5\" quat_xyzw=\"{} 0 0 {}\"/>",
        half.sin(),
        half.cos()
    );
    let turned = versioned(PENDULUM).replace("<origin xyz=\"0 0 -0.5\"/>", &quaternion);
    let told = PENDULUM.replace(
        "<origin xyz=\"0 0 -0.5\"/>",
        "<origin xyz=\"0 0 -0.5\" rpy=\"1.5707963267948966 0 0\"/>",
    );
    let inertia = |text: &str| {
        let urdf = parse(text, &UrdfOptions::default()).unwrap();
        let mut ws = ArmWorkspace::new(&urdf.arm);
        urdf.arm.momentum(&mut ws, &[0.3], &[2.0]).unwrap().p[0]
    };
    assert!((inertia(&turned) - inertia(&told)).abs() < 1e-14);
}

#[test]
fn deep_nesting_is_skipped() {
    let deep = "<gazebo>".repeat(20_000) + &"</gazebo>".repeat(20_000);
    let text = PENDULUM.replace("</robot>", &(deep + "</robot>"));
    assert_eq!(parse(&text, &UrdfOptions::default()).unwrap().arm.dof(), 1);
}

/// Content of published descriptions besides dynamics: textures without a file, sensors, tags of simulators,
/// undeclared prefixes.
const DECORATED: &str = r#"<?xml version="1.0" ?>
<!-- made by a converter -->
<robot name="pendulum" xmlns:xacro="http://www.ros.org/wiki/xacro" xmlns:drake="http://drake.mit.edu">
  <material/>
  <material name="grey"><texture/></material>
  <link name="base"><visual name=""><geometry><mesh/></geometry>
    <material name=""><color rgba=""/><texture /></material></visual><collision/></link>
  <link name="bob">
    <drake:inertial><mass value="7"/></drake:inertial>
    <visual><origin xyz="a b"/><material><texture/></material></visual>
    <inertial><origin xyz="0 0 -0.5"/><mass value="2"/>
      <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial>
    <contact/><self_collision_checking/></link>
  <joint name="swing" type="revolute"><parent link="base"/><child link="bob"/>
    <axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/>
    <calibration/><safety_controller/>
    <dynamics damping="0.1" friction="0.2"/></joint>
  <sensor name="imu" type="accelerometer"><parent link="bob"/><origin/></sensor>
  <transmission name="t"><type/><joint name="swing"><hardwareInterface/></joint><actuator name="m"/></transmission>
  <gazebo reference="bob"><sensor><plugin/></sensor><link/><joint/></gazebo>
  <gazebo><controller:position name="c" interface:unit="x"/></gazebo>
  <yarp:port/>
</robot>"#;

#[test]
fn urdf_extras_are_ignored() {
    let plain = parse(PENDULUM, &UrdfOptions::default()).unwrap();
    assert_eq!(parse(DECORATED, &UrdfOptions::default()).unwrap(), plain);
    // Lines are still those of the file.
    let spoiled = DECORATED.replace("mass value=\"2\"", "mass value=\"two\"");
    let said = message(&spoiled);
    assert!(said.contains("line 11") && said.contains("'bob'"), "{said}");
}

#[test]
fn xacro_within_ignored_elements_gives_warning_with_line() {
    let plain = parse(PENDULUM, &UrdfOptions::default()).expect("a URDF");
    for element in ["visual", "collision", "gazebo"] {
        let inside = format!(
            "<link name=\"base\">\n<{element}><geometry/><xacro:steel_look/></{element}></link>"
        );
        let text = PENDULUM.replace("<link name=\"base\"/>", &inside);
        let parsed = parse(&text, &UrdfOptions::default()).expect("read");
        assert_eq!(parsed.arm, plain.arm, "{element}");
        let [warning] = &parsed.warnings[..] else {
            panic!("{element}: {:?}", parsed.warnings);
        };
        let line = 1 + text[..text.find("<xacro").expect("there")]
            .matches('\n')
            .count();
        assert!(
            warning.starts_with(&format!("line {line}: <xacro:steel_look>")),
            "{warning}"
        );
        // Where it would be read, it is an error.
        let inside = "<link name=\"base\"><inertial><xacro:steel/></inertial></link>";
        let text = PENDULUM.replace("<link name=\"base\"/>", inside);
        assert!(message(&text).contains("<xacro:steel> is xacro"));
    }
}

#[test]
fn declaration_after_blank_lines_is_accepted() {
    let declaration = "<?xml version=\"1.0\" encoding=\"utf-8\"?>";
    let plain = parse(PENDULUM, &UrdfOptions::default()).expect("a URDF");
    for before in ["\n", "\u{feff}", " \r\n\t", "\u{feff}\n\n", "\n\u{feff}"] {
        let text = format!("{before}{declaration}\n{PENDULUM}");
        let parsed = parse(&text, &UrdfOptions::default());
        assert_eq!(parsed.expect("read").arm, plain.arm, "{before:?}");
    }
    // Lines stay where they are.
    let text = format!("\n\n{declaration}\n<robot name='a'><link></robot>");
    let UrdfError::Xml { line, .. } = refused(&text) else {
        panic!("no XML error");
    };
    assert_eq!(line, 4);
}

#[test]
fn xacro_error_names_expand_command() {
    let macros = PENDULUM.replace(
        "<robot name=\"pendulum\">",
        "<robot name=\"pendulum\" xmlns:xacro=\"http://www.ros.org/wiki/xacro\">\n  <xacro:include filename=\"arm.xacro\"/>",
    );
    let undeclared = PENDULUM.replace("<link name=\"base\"/>", "<link name=\"base\"/><xacro:arm/>");
    let numbers = PENDULUM.replace("value=\"2\"", "value=\"${mass}\"");
    for (text, what) in [
        (&macros, "line 2: <xacro:include>"),
        (&undeclared, "line 2: <xacro:arm>"),
        (&numbers, "line 3: value = \"${mass}\""),
    ] {
        let said = message(text);
        assert!(said.contains(what), "{said}");
        assert!(said.contains("xacro FILE > robot.urdf"), "{said}");
        let located = refused(text).located("arm.urdf.xacro", text).to_string();
        assert!(located.starts_with("arm.urdf.xacro, line "), "{located}");
    }
}

#[test]
fn links_that_a_joint_carries_are_its_own_and_those_fixed_to_it() {
    let hand = r#"<link name="hand"/><joint name="wrist" type="fixed"><parent link="bob"/><child link="hand"/>
        <origin xyz="0.1 0 -0.7"/></joint></robot>"#;
    let urdf = parse(&PENDULUM.replace("</robot>", hand), &UrdfOptions::default()).unwrap();
    let links: Vec<_> = urdf.arm.links_of(0).collect();
    let names: Vec<&str> = links.iter().map(|(name, _)| *name).collect();
    assert_eq!(names, ["bob", "hand"]);
    // The joint turns about z of its frame: 0.7 m from there, whatever that axis is.
    let [x, y, z] = links[1].1.translation;
    assert!(((x * x + y * y + z * z) - (0.01 + 0.49)).abs() < 1e-14);
    assert_eq!(links[0].1.translation, [0.0; 3]);
    assert_eq!(urdf.arm.links_of(1).count(), 0);
}
