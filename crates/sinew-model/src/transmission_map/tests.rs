use super::{MappedTendon, Relation, TransmissionMap};
use std::fmt::Write as _;

/// The map of a text that is valid.
#[track_caller]
fn read(text: &str) -> Vec<MappedTendon> {
    TransmissionMap::parse(text, "f").expect(text).tendons
}

/// The message of a text that is not.
#[track_caller]
fn error(text: &str) -> String {
    TransmissionMap::parse(text, "f")
        .expect_err(text)
        .to_string()
}

/// Ratio of a motor and a joint, 0 where the joint does not move the motor.
fn ratio(tendons: &[MappedTendon], motor: &str, joint: &str) -> f64 {
    let tendon = tendons.iter().find(|t| t.motors() == [motor]).expect(motor);
    let found = tendon.joints().iter().find(|(name, _)| name == joint);
    found.map_or(0.0, |(_, ratio)| *ratio)
}

/// Motor angle `Σ ratio q + θ₀`, rad.
fn theta(tendons: &[MappedTendon], motor: &str, q: [f64; 2]) -> f64 {
    let tendon = tendons.iter().find(|t| t.motors() == [motor]).expect(motor);
    let Relation::Ratios {
        motor_at_zero_rad, ..
    } = tendon.relation
    else {
        panic!("{tendon:?}");
    };
    let moved = ["j1", "j2"].map(|joint| ratio(tendons, motor, joint));
    moved[0] * q[0] + moved[1] * q[1] + motor_at_zero_rad
}

const ACTUATOR: [f64; 2] = [50.0, -30.0];
const JOINT: [f64; 2] = [1.5, -0.7];
const OFFSET: [f64; 2] = [0.2, -0.4];

/// A transmission of two joints in the first format, second parts first, and in the second.
fn of_two(kind: &str) -> [String; 2] {
    let part = |tag: &str, i: usize, ratio: f64, offset: f64| {
        let (name, role) = (format!("{}{}", &tag[..1], i + 1), format!("{tag}{}", i + 1));
        [
            format!(
                "<{tag} name='{name}'><role>{role}</role><offset>{offset}</offset>\
                 <mechanicalReduction>{ratio}</mechanicalReduction></{tag}>\n"
            ),
            format!(
                "<{tag} name='{name}' role='{role}'><offset>{offset}</offset>\
                 <mechanical_reduction> {ratio} </mechanical_reduction></{tag}>\n"
            ),
        ]
    };
    let [j1, j2] = [0, 1].map(|i| part("joint", i, JOINT[i], OFFSET[i]));
    let [a1, a2] = [0, 1].map(|i| part("actuator", i, ACTUATOR[i], 0.0));
    [
        format!(
            "<robot name='r'><transmission name='t'><type>transmission_interface/{kind}</type>\n{}{}{}{}</transmission></robot>",
            j2[0], j1[0], a2[0], a1[0]
        ),
        format!(
            "<robot name='r'><ros2_control name='c' type='system'><transmission name='t'>\
             <plugin>transmission_interface/{kind}</plugin>{}{}{}{}</transmission></ros2_control></robot>",
            j1[1], j2[1], a1[1], a2[1]
        ),
    ]
}

/// Joint positions of actuator positions, as ros_control's `actuatorToJointPosition` has them.
fn joints_of(kind: &str, x: [f64; 2], offset: [f64; 2]) -> [f64; 2] {
    let ([a1, a2], [n1, n2]) = (ACTUATOR, JOINT);
    match kind {
        "DifferentialTransmission" => [
            (x[0] / a1 + x[1] / a2) / (2.0 * n1) + offset[0],
            (x[0] / a1 - x[1] / a2) / (2.0 * n2) + offset[1],
        ],
        _ => [
            x[0] / (n1 * a1) + offset[0],
            (x[1] / a2 - x[0] / (n1 * a1)) / n2 + offset[1],
        ],
    }
}

#[test]
fn two_joint_transmissions_invert_the_loaders_map() {
    for kind in ["DifferentialTransmission", "FourBarLinkageTransmission"] {
        let [old, new] = of_two(kind);
        assert_eq!(read(&old).len(), 2, "{kind}");
        for text in [&old, &new] {
            let tendons = read(text);
            for x in [[0.0, 0.0], [3.0, 0.0], [0.0, -2.0], [7.0, 11.0]] {
                let q = joints_of(kind, x, OFFSET);
                for (motor, x) in ["a1", "a2"].into_iter().zip(x) {
                    let found = theta(&tendons, motor, q);
                    assert!(
                        (found - x).abs() < 1e-12,
                        "{kind} {motor}: {found}, not {x}"
                    );
                }
            }
            // Virtual work: the power of the motors is the power of the joints under τ_q = Rᵀ τ_θ.
            let (tau, rate) = ([0.3, -0.8], [2.0, 5.0]);
            let dq = joints_of(kind, rate, [0.0; 2]);
            let power = |joint: usize| {
                let name = ["j1", "j2"][joint];
                let torque =
                    ratio(&tendons, "a1", name) * tau[0] + ratio(&tendons, "a2", name) * tau[1];
                torque * dq[joint]
            };
            let of_motors = tau[0] * rate[0] + tau[1] * rate[1];
            assert!((power(0) + power(1) - of_motors).abs() < 1e-12, "{kind}");
        }
    }
    // Factors as printed in the documentation of both.
    let tendons = read(&of_two("DifferentialTransmission")[0]);
    assert!((ratio(&tendons, "a1", "j2") - 50.0 * -0.7).abs() < 1e-12);
    assert!((ratio(&tendons, "a2", "j2") - -(-30.0 * -0.7)).abs() < 1e-12);
    let tendons = read(&of_two("FourBarLinkageTransmission")[1]);
    assert_eq!(ratio(&tendons, "a1", "j2"), 0.0);
    assert!((ratio(&tendons, "a2", "j1") - -30.0).abs() < 1e-12);
}

const SIMPLE: &str = "<robot>\n<transmission name='t'>\n<type>transmission_interface/SimpleTransmission</type>\n\
    <joint name='j1'><hardwareInterface>x</hardwareInterface><offset>0.5</offset></joint>\n\
    <actuator name='m'><mechanicalReduction>-80</mechanicalReduction></actuator>\n</transmission>\n</robot>";

const SIMPLE_2: &str = "<robot xmlns:v='v'>\n<ros2_control name='c' type='actuator'>\n<v:other/><transmission name='t'>\n\
    <plugin>transmission_interface/SimpleTransmission</plugin>\n<joint name='j1' role='joint1'>\
    <mechanical_reduction>-80</mechanical_reduction><offset>0.5</offset></joint>\n\
    <actuator name='m' role='actuator1'/>\n</transmission>\n</ros2_control>\n</robot>";

const FIXED: &str = "<mujoco>\n<worldbody/>\n<tendon>\n<fixed name='flexor'>\n\
    <joint joint='pip' coef='0.007'/>\n<joint joint='dip' coef='-0.005'/>\n<joint joint='mcp' coef='0'/>\n\
    </fixed>\n</tendon>\n<actuator>\n<motor name='m1' tendon='flexor' gear='-200 0 0'/>\n\
    <position name='m2' joint='mcp'/>\n<velocity name='m3' joint='mcp'/>\n</actuator>\n</mujoco>";

const TABLE: &str = "motor; pitch; twist\n# WAM\nm2; 28,25; -16,8\nm3; -28,25;-16,8\nm4;;1\n";

#[test]
fn simple_transmissions_subtract_the_joint_offset() {
    for text in [SIMPLE, SIMPLE_2] {
        let tendons = read(text);
        assert_eq!(tendons.len(), 1);
        assert_eq!(tendons[0].name, "m");
        // x_a = n (x_j − x_off)
        for q in [0.0, 0.5, 1.25] {
            assert_eq!(theta(&tendons, "m", [q, 9.0]), -80.0 * (q - 0.5));
        }
    }
    let bare = SIMPLE_2.replace("<actuator name='m' role='actuator1'/>", "");
    assert_eq!(read(&bare)[0].motors(), ["j1"]);
}

/// A positive tension is a negative force of MuJoCo: joint torque `coef · (−f)`, here `R f`.
#[test]
fn fixed_tendon_shortens_by_the_negative_length() {
    let tendons = read(FIXED);
    assert_eq!(tendons[0].name, "flexor");
    let arms: Vec<_> = tendons[0]
        .joints()
        .iter()
        .map(|(j, r)| (j.as_str(), *r))
        .collect();
    assert_eq!(arms, [("pip", -7.0), ("dip", 5.0)]);
    let Relation::MomentArms { motors, .. } = &tendons[0].relation else {
        panic!("{tendons:?}");
    };
    assert_eq!(
        (motors[0].name.as_str(), motors[0].gear),
        ("m1", Some(-200.0))
    );
    let tension = 3.0;
    for ((_, arm_mm), coef) in tendons[0].joints().iter().zip([0.007, -0.005]) {
        assert!((1e-3 * arm_mm * tension - coef * -tension).abs() < 1e-15);
    }
    // Two servos of one joint are one motor.
    assert_eq!(tendons.len(), 2);
    assert_eq!(
        (tendons[1].motors(), ratio(&tendons, "m2", "mcp")),
        (vec!["m2"], 1.0)
    );
}

#[test]
fn table_rows_are_ratios() {
    let tendons = read(TABLE);
    assert_eq!(tendons.len(), 3);
    let found = ["m2", "m3", "m4"].map(|m| ["pitch", "twist"].map(|j| ratio(&tendons, m, j)));
    assert_eq!(found, [[28.25, -16.8], [-28.25, -16.8], [0.0, 1.0]]);
    assert_eq!((tendons[2].joints().len(), tendons[2].line), (1, 5));
}

#[test]
fn invalid_sources_return_line_value_and_remedy() {
    let differential = &of_two("DifferentialTransmission");
    for (text, words) in [
        (
            SIMPLE.replace("-80", "0"),
            "f, line 5: actuator 'm' = 0: <mechanicalReduction> must not be 0",
        ),
        (SIMPLE.replace("-80", "1e400"), "expected a finite number"),
        (
            SIMPLE.replace("-80", "${n}"),
            "line 5: <mechanicalReduction>: is xacro, not URDF; expand it",
        ),
        (
            SIMPLE.replace("mechanicalReduction", "mechanical_reduction"),
            "line 5: <mechanical_reduction>: is not read in this format; write <mechanicalReduction>",
        ),
        (
            SIMPLE_2.replace(
                "role='actuator1'/>",
                "><mechanical_reduction>2</mechanical_reduction></actuator>",
            ),
            "ignores this ratio; move it to the <joint>",
        ),
        (
            SIMPLE.replace("/SimpleT", "/HalfT"),
            "line 2: transmission 't' = 'transmission_interface/HalfTransmission': unsupported transmission; supported are",
        ),
        (
            SIMPLE.replace("</joint>", "</joint><joint name='k'/>"),
            "needs 1 <joint> and 1 <actuator>, found 2 and 1",
        ),
        (
            SIMPLE.replace("<joint name='j1'>", "<joint>"),
            "line 4: <joint>: missing attribute name",
        ),
        (
            SIMPLE
                .replace("<robot>", "<sdf>")
                .replace("</robot>", "</sdf>"),
            "expected <robot>, <ros2_control> or <mujoco>, found <sdf>",
        ),
        ("<robot name='r'/>".into(), "has no <transmission>"),
        ("<robot>\n<a></robot>".into(), "f, line 2: invalid XML"),
        (
            differential[0].replace("<role>joint2</role>", ""),
            "expected the roles joint1 and joint2, found none and joint1",
        ),
        (
            differential[1]
                .replace("'joint1'", "'x'")
                .replace("'joint2'", "'joint1'")
                .replace("'x'", "'joint2'"),
            "'joint2' precedes 'joint1', and ros2_control ignores roles; write 'joint1' first",
        ),
        (
            differential[0].replace("name='j2'", "name='j1'"),
            "duplicate joint 'j1'",
        ),
        (
            differential[0].replace("name='a2'", "name='a1'"),
            "duplicate name",
        ),
        (
            differential[0]
                .replace("50", "1e300")
                .replace("1.5", "1e300"),
            "must be finite and not 0",
        ),
        (
            FIXED.replace("fixed", "spatial"),
            "f, line 4: spatial 'flexor': unsupported: its moment arms depend on the joint positions; remove it here",
        ),
        (
            FIXED.replace("'flexor' gear", "'x' gear"),
            "line 11: motor 'm1': tendon 'x' not found",
        ),
        (
            FIXED.replace("0.007", "a"),
            "line 5: <joint> = 'a': expected a finite number",
        ),
        (FIXED.replace(" coef='0.007'", ""), "missing attribute coef"),
        (
            FIXED.replace("0.007", "0").replace("-0.005", "0"),
            "crosses no joint: every coefficient is 0",
        ),
        (
            "<mujoco><include file='a'/></mujoco>".into(),
            "has no <fixed> tendon; a model with <include>",
        ),
        ("hello\n".into(), "the header must name at least one joint"),
        ("motor,a,\nm,1,\n".into(), "the header must name"),
        ("motor,a\n".into(), "has no motor"),
        (
            "motor,a\nm,x\n".into(),
            "f, line 2, column 'a' = 'x': is not a finite number",
        ),
        ("motor,a\nm,inf\n".into(), "line 2, column 'a' = 'inf'"),
        (
            "motor,a\n,1\n".into(),
            "line 2: the first cell must name the motor",
        ),
        (
            "motor,a,a\nm,1,2\n".into(),
            "line 2: tendon 'm': duplicate joint 'a'",
        ),
        (
            "motor,a\nm,1\nm,2\n".into(),
            "line 3: tendon 'm': duplicate name",
        ),
        ("motor,a\nm,0\n".into(), "every coefficient is 0"),
        ("".into(), "is empty"),
    ] {
        let found = error(&text);
        assert!(found.contains(words), "{words}\nis not in\n{found}");
    }
    let mut wide = String::from("motor");
    for i in 0..257 {
        let _ = write!(wide, ",j{i}");
    }
    assert!(error(&wide).contains("at most 256 moving joints"));
    let transmission = SIMPLE
        .split_once("<robot>")
        .and_then(|(_, t)| t.split_once("</robot>"))
        .expect("one")
        .0;
    let many = format!("<robot>{}</robot>", transmission.repeat(300));
    assert!(error(&many).contains("at most 256"));
    let many = "<fixed name='t'><joint joint='j' coef='1'/></fixed>".repeat(300);
    assert!(error(&format!("<mujoco><tendon>{many}</tendon></mujoco>")).contains("at most 256"));
    let mut long = String::from("motor,a\n");
    for i in 0..257 {
        let _ = writeln!(long, "m{i},1");
    }
    assert!(error(&long).contains("at most 256"));
}

/// Every prefix and every text with one byte changed is read or rejected; neither panics, and no number is invalid.
#[test]
fn corrupt_text_never_panics() {
    let [old, new] = of_two("FourBarLinkageTransmission");
    for text in [SIMPLE, SIMPLE_2, FIXED, TABLE, &old, &new] {
        for at in 0..text.len() {
            let mut texts = vec![text.as_bytes()[..at].to_vec()];
            for byte in [b'<', b'>', b'\'', b'/', b'0', b'-', b'e', b' ', b'\n', 0xff] {
                let mut changed = text.as_bytes().to_vec();
                changed[at] = byte;
                texts.push(changed);
            }
            for bytes in texts {
                let text = String::from_utf8_lossy(&bytes);
                if let Ok(map) = TransmissionMap::parse(&text, "f") {
                    assert!(!map.tendons.is_empty());
                    let joints = map.tendons.iter().flat_map(MappedTendon::joints);
                    joints.for_each(|(_, v)| assert!(v.is_finite() && *v != 0.0, "{text}"));
                }
            }
        }
    }
}
