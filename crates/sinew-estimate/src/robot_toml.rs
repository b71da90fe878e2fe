//! Text of a first robot.toml.

use crate::init::{Init, InitDescribed, InitJoint, InitPlan, InitTendon};
use crate::robot_check::JointMotion;
use sinew_files::number::three_digits;
use sinew_files::{names, plain};
use sinew_log::Quantity;
use sinew_model::transmission_map::{MappedMotor, Relation};
use std::fmt::Write as _;

/// Writes robot.toml: the values from the files, and every other key as a comment with its unit, its usual
/// range and its source.
pub fn robot_toml(init: &Init) -> String {
    let mut out = format!("# Made by `sinew init` from {}.\n", plain(&init.source));
    if let Some(recording) = &init.recording {
        for source in &recording.sources {
            let symbol = source.quantity.symbol();
            let _ = writeln!(out, "# {symbol} from {}", plain(&source.source));
        }
        if let Some(rate_hz) = recording.rate_hz {
            let _ = writeln!(out, "# {} Hz", three_digits(rate_hz));
        }
    }
    out += "# Lines with # are not specified yet: fill in the values and remove the #.\n\
            # `sinew robot check` lists missing and implausible values.\n\n";
    match &init.urdf {
        Some(urdf) => {
            let _ = writeln!(out, "urdf = {}", quoted(urdf));
        }
        None => {
            out +=
                "# urdf = \"ROBOT.urdf\"                # in this folder: links, masses, joints\n"
        }
    }
    for joint in &init.joints {
        out += &joint_section(joint, &init.tendons);
    }
    for motor in &init.motors {
        out += &motor_section(&motor.name);
    }
    for tendon in &init.tendons {
        out += &tendon_section(tendon);
    }
    out += "\n# Tolerances of the values in this file, one standard deviation each. Defaults:\n\
            # [tolerances]\n\
            # stiffness_percent = 12.0\n\
            # mass_percent = 6.0\n\
            # friction_percent = 50.0\n";
    out
}

fn joint_section(joint: &InitJoint, tendons: &[InitTendon]) -> String {
    let key = key(&joint.name);
    let mut out = String::from("\n");
    if joint.plan == InitPlan::Excluded {
        let name = plain(&joint.name);
        let _ = writeln!(
            out,
            "# '{name}' is recorded but is not a joint of the URDF."
        );
        return out;
    }
    let _ = writeln!(out, "[joints.{key}]");
    if let Some(described) = &joint.described {
        let _ = writeln!(out, "# {}", about(described));
    }
    match joint.plan {
        InitPlan::Rigid => {
            out += "# Motor position not recorded: elasticity is not observable.\nrigid = true\n";
        }
        InitPlan::Locked => {
            out += "# Not recorded: specify its constant position.\n\
                    # locked_at_rad =                   # rad; m if it slides\n";
        }
        InitPlan::Coupled => {
            let crossing = tendons.iter().filter(|t| t.joints.contains(&joint.name));
            let crossing: Vec<String> = crossing.map(|t| plain(&t.name)).collect();
            let _ = writeln!(out, "# Tendons that turn it: {}.", names::list(&crossing));
            out += "# joint_friction = { coulomb_nm = , viscous_nm_s_per_rad =  }\n\
                    # spring = { stiffness_nm_per_rad = , rest_rad =  }   # passive spring of the joint, if any\n";
        }
        InitPlan::Elastic | InitPlan::Excluded => {
            if let Some(motor) = joint.motor.as_ref().filter(|m| **m != joint.name) {
                let motor = names::shorten(&plain(motor), 40);
                let _ = writeln!(
                    out,
                    "# Its motor is '{motor}', 1 to 1: record its angle as theta of this joint."
                );
            }
            out += &spring(joint, &key);
        }
    }
    out
}

/// Writes the keys of a motor, all still to be specified.
fn motor_section(name: &str) -> String {
    format!(
        "\n[motors.{}]\n\
         # inertia_kg_m2 =                   # kg·m² at the shaft whose angle is recorded; data sheet\n\
         # friction = {{ coulomb_nm = , viscous_nm_s_per_rad =  }}   # at that shaft; default, unless specified here\n",
        key(name)
    )
}

/// Writes a tendon: the values of the description, and the other keys still to be specified.
fn tendon_section(tendon: &InitTendon) -> String {
    let mut out = format!("\n[[tendons]]\nname = {}\n", quoted(&tendon.name));
    out += "# kind = \"strand\"                   # a single rope, which only pulls; without it a loop, which pulls both ways\n";
    match &tendon.relation {
        Relation::Ratios {
            motor,
            ratios,
            motor_at_zero_rad,
        } => {
            let _ = write!(
                out,
                "motor = {}\nratios = {}   # rad of the motor per rad of the joint\n",
                quoted(motor),
                table(ratios)
            );
            if *motor_at_zero_rad != 0.0 {
                let offset = number(-motor_at_zero_rad);
                let _ = writeln!(
                    out,
                    "# With every joint at zero the motor reads {} rad: mapping.toml, offset = {offset} of its theta.",
                    number(*motor_at_zero_rad)
                );
            }
            out += "# stiffness_nm_per_rad =            # N·m/rad at the motor; needed\n\
                    # drum_mm =                         # mm of rope per rad of the motor; without it no mm and no strain\n";
        }
        Relation::MomentArms {
            motors,
            moment_arms_mm,
        } => {
            let drums = match motors.is_empty() {
                true => "MOTOR = ".to_owned(),
                false => {
                    let drum = |motor: &MappedMotor| format!("{} = ", key(&motor.name));
                    motors.iter().map(drum).collect::<Vec<_>>().join(", ")
                }
            };
            let _ = writeln!(
                out,
                "# drums_mm = {{ {drums} }}   # mm of rope that one rad of the motor takes in; needed"
            );
            for motor in motors {
                let name = names::shorten(&plain(&motor.name), 40);
                let sign = match motor.gear {
                    Some(gear) if gear > 0.0 => "longer: its drum is negative",
                    Some(gear) if gear < 0.0 => "shorter: its drum is positive",
                    _ => continue,
                };
                let _ = writeln!(
                    out,
                    "# By its gear, a positive angle of '{name}' makes the tendon {sign}."
                );
            }
            let _ = write!(
                out,
                "moment_arms_mm = {}   # mm/rad; positive: tension turns the joint positively\n\
                 # stiffness_n_per_mm =              # N/mm, of a loop both strands together; needed\n",
                table(moment_arms_mm)
            );
        }
    }
    out += "# rope = \"\"                         # a name of `sinew rope list`\n\
            # length_mm =                       # mm between the pulleys, 50 to 2000; measure it\n\
            # pretension_n =                    # N with every motor and joint at zero, of a loop of each strand\n\
            # guides = [{ radius_mm = , wrap_deg = , friction = 0.05 }]     # from drive to joint\n\
            # retension_at_mm =                 # mm of elongation at which to re-tension, 0.3 to 3\n";
    out
}

/// Formats an inline table of numbers.
fn table(entries: &[(String, f64)]) -> String {
    let entry = |(name, value): &(String, f64)| format!("{} = {}", key(name), number(*value));
    let entries: Vec<String> = entries.iter().map(entry).collect();
    format!("{{ {} }}", entries.join(", "))
}

/// Formats a number for TOML with 15 significant digits, which hides the rounding of a product.
fn number(value: f64) -> String {
    let rounded = format!("{value:.14e}").parse().unwrap_or(value);
    format!("{:?}", if rounded.is_finite() { rounded } else { value })
}

/// Describes a joint: `turns about 0 0 1, -2.60 to 2.60 rad, carries 1.50 kg`.
fn about(joint: &InitDescribed) -> String {
    let (kind, unit) = match joint.motion {
        JointMotion::Revolute => ("turns about", "rad"),
        JointMotion::Prismatic => ("slides along", "m"),
    };
    let axis = joint
        .axis
        .map(|x| ((1e3 * x).round() / 1e3).to_string())
        .join(" ");
    let range = match (joint.lower_rad, joint.upper_rad) {
        (Some(lower), Some(upper)) => {
            format!("{} to {} {unit}", three_digits(lower), three_digits(upper))
        }
        _ => "without end".into(),
    };
    let mass = three_digits(joint.carried_mass_kg);
    format!("{kind} {axis}, {range}, carries {mass} kg")
}

/// Writes the keys of an elastic joint, all still to be specified.
fn spring(joint: &InitJoint, key: &str) -> String {
    let described = joint.described.as_ref();
    let friction = match described.is_some_and(|d| d.friction_specified) {
        true => "from the URDF, unless specified here",
        false => "default, unless specified here",
    };
    let slides = described.is_some_and(|d| d.motion == JointMotion::Prismatic);
    let [unit, pull, inertia, radius] = match slides {
        false => [
            "N·m/rad",
            "torque",
            "kg·m², rotor's of the data sheet times gear ratio squared; 0.001 to 1",
            "mm, middle of the rope at the joint, 5 to 50; drawing or calliper",
        ],
        true => [
            "N/m, as the joint slides,",
            "force",
            "kg, rotor's kg·m² over the square of the travel per rad of the rotor, m",
            "mm of rope per m of travel: 1000 for a rope that moves with it",
        ],
    };
    let usual = match (slides, described.and_then(|d| d.stiffness_usual_nm_per_rad)) {
        (_, Some([low, high])) => {
            let (low, high) = (three_digits(low), three_digits(high));
            format!(" On this arm {low} to {high} (it swings at 1 to")
        }
        (false, None) => " Often 5 to 500 (the arm swings at 1 to".into(),
        (true, None) => " (The arm swings at 1 to".into(),
    };
    let mut out = format!(
        "# stiffness_nm_per_rad =            # {unit} at the joint; needed.{usual}\n\
         #                                   # 20 Hz). Hang a weight on the link, hold the motor: K = {pull} / change\n\
         #                                   # of theta - q. If it has no elasticity: rigid = true\n\
         # motor_inertia_kg_m2 =             # {inertia}\n\
         # joint_friction = {{ coulomb_nm = , viscous_nm_s_per_rad =  }}   # {friction}\n\
         # motor_friction = {{ coulomb_nm = , viscous_nm_s_per_rad =  }}   # {pull} that just turns motor and gear\n"
    );
    if joint.recorded.contains(&Quantity::TauM) {
        out += "# Its motor torque is recorded: with motor_inertia_kg_m2 it is an independent measurement.\n";
    }
    let _ = write!(
        out,
        "# [joints.{key}.tendon]             # for mm and strain; without it mrad only\n\
         # rope = \"\"                         # a name of `sinew rope list`\n\
         # length_mm =                       # mm between the pulleys, 50 to 2000; measure it\n\
         # joint_pulley_radius_mm =          # {radius}\n\
         # pretension_n =                    # N at rest, 5 to 20 % of the rope's breaking load; spring scale\n\
         # guides = [{{ radius_mm = , wrap_deg = , friction = 0.05 }}]     # from drive to joint\n\
         # retension_at_mm =                 # mm of elongation at which to re-tension, 0.3 to 3\n"
    );
    out
}

/// Formats a key of a TOML file.
fn key(name: &str) -> String {
    let bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    match !name.is_empty() && name.chars().all(bare) {
        true => name.to_owned(),
        false => quoted(name),
    }
}

/// Formats a string of a TOML file.
pub fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            c if c.is_control() => {
                let _ = write!(out, "\\u{:04X}", c as u32);
            }
            c => out.push(c),
        }
    }
    out + "\""
}

#[cfg(test)]
mod tests {
    use super::{key, number, quoted, robot_toml};
    use crate::init::{Init, InitGap, InitPlan};
    use sinew_files::{Bound, TomlFile};
    use sinew_log::{JointInfo, Quantity};
    use sinew_model::transmission_map::TransmissionMap;

    // URDF of a chain of these joints.
    fn urdf(joints: &[&str]) -> String {
        let mut out = String::from("<robot name='r'><link name='base'/>");
        let mut parent = "base";
        for name in joints {
            out += &format!(
                "<link name='{name}'><inertial><mass value='1'/>\
                 <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>\
                 <joint name='{name}' type='continuous'><parent link='{parent}'/><child link='{name}'/></joint>"
            );
            parent = name;
        }
        out + "</robot>"
    }

    fn coupled(joints: &[&str], transmissions: &str) -> Init {
        let mut init = Init::of("r.urdf", Some(("r.urdf", &urdf(joints))), None).expect("a URDF");
        let map = TransmissionMap::parse(transmissions, "t").expect(transmissions);
        init.couple(map, "t").expect(transmissions);
        init
    }

    // Strings and numbers of `[[tendons]]`, tables as `table.key`.
    fn tendons(text: &str) -> Vec<Vec<(String, String)>> {
        let file = TomlFile::parse(text, "robot.toml").expect(text);
        let root = file.root();
        let list = root.value("tendons").expect(text);
        let shown = |name: &str, value: &sinew_files::Value<'_>| match value.text() {
            Ok(text) => (name.to_owned(), text.to_owned()),
            Err(_) => {
                let number = value.number(Bound::Any).expect(text);
                (name.to_owned(), number.to_string())
            }
        };
        let tables = list.list("be a list").expect(text);
        let tables = tables.iter().map(|table| {
            let mut out = Vec::new();
            for (key, _, value) in table.section().expect(text).entries() {
                match value.is_table() {
                    false => out.push(shown(key, &value)),
                    true => {
                        for (inner, _, value) in value.section().expect(text).entries() {
                            out.push(shown(&format!("{key}.{inner}"), &value));
                        }
                    }
                }
            }
            out
        });
        tables.collect()
    }

    fn pairs(list: &[(&str, &str)]) -> Vec<(String, String)> {
        let pair = |(a, b): &(&str, &str)| (a.to_string(), b.to_string());
        list.iter().map(pair).collect()
    }

    #[test]
    fn table_becomes_ratios_and_keeps_shorthand() {
        let init = coupled(
            &["yaw", "pitch", "twist"],
            "motor,yaw,pitch,twist\nm1,1,,\nm2,0,28.25,-16.8\nm3,0,-28.25,-16.8\n",
        );
        let plans: Vec<_> = init.joints.iter().map(|j| j.plan).collect();
        let [elastic, coupled] = [InitPlan::Elastic, InitPlan::Coupled];
        assert_eq!(plans, [elastic, coupled, coupled]);
        let text = robot_toml(&init);
        let expected = [
            pairs(&[
                ("name", "m2"),
                ("motor", "m2"),
                ("ratios.pitch", "28.25"),
                ("ratios.twist", "-16.8"),
            ]),
            pairs(&[
                ("name", "m3"),
                ("motor", "m3"),
                ("ratios.pitch", "-28.25"),
                ("ratios.twist", "-16.8"),
            ]),
        ];
        let mut found = tendons(&text);
        for tendon in &mut found {
            tendon.sort();
        }
        assert_eq!(
            found,
            expected.map(|mut t| {
                t.sort();
                t
            }),
            "{text}"
        );
        for words in [
            "[joints.yaw]\n# turns",
            "# Its motor is 'm1', 1 to 1",
            "[motors.m2]\n# inertia_kg_m2",
            "# Tendons that turn it: 'm2', 'm3'.",
            "\n# stiffness_nm_per_rad = ",
        ] {
            assert!(text.contains(words), "{words} is not in\n{text}");
        }
        assert!(!text.contains("[motors.m1]"), "{text}");
        let gaps = [
            InitGap::Stiffness("yaw".into()),
            InitGap::TendonStiffness("m2".into()),
            InitGap::TendonStiffness("m3".into()),
        ];
        assert_eq!(init.missing, gaps);
    }

    #[test]
    fn fixed_tendon_becomes_moment_arms_with_open_drums() {
        let model = "<mujoco><tendon><fixed name='flexor'><joint joint='pip' coef='0.0033'/>\
             <joint joint='dip' coef='-0.005'/></fixed></tendon>\
             <actuator><motor name='m 1' tendon='flexor' gear='50'/><motor name='m' joint='mcp'/></actuator></mujoco>";
        let init = coupled(&["mcp", "pip", "dip"], model);
        let text = robot_toml(&init);
        let mut found = tendons(&text);
        found[0].sort();
        let expected = [
            ("moment_arms_mm.dip", "5"),
            ("moment_arms_mm.pip", "-3.3"),
            ("name", "flexor"),
        ];
        assert_eq!(found, [pairs(&expected)], "{text}");
        for words in [
            "# drums_mm = { \"m 1\" =  }",
            "a positive angle of 'm 1' makes the tendon longer: its drum is negative",
            "[motors.\"m 1\"]",
            "# stiffness_n_per_mm = ",
        ] {
            assert!(text.contains(words), "{words} is not in\n{text}");
        }
        assert!(init.missing.contains(&InitGap::Drums("flexor".into())));
        assert!(init.missing.contains(&InitGap::Stiffness("mcp".into())));
        assert!(
            text.lines().all(|line| line.chars().count() <= 120),
            "{text}"
        );
    }

    #[test]
    fn offset_becomes_motor_angle_at_zero() {
        let model = "<robot><transmission name='t'><type>transmission_interface/SimpleTransmission</type>\
             <joint name='a'><offset>0.5</offset></joint><actuator name='m'><mechanicalReduction>-80</mechanicalReduction>\
             </actuator></transmission></robot>";
        let text = robot_toml(&coupled(&["a"], model));
        let words = "the motor reads 40.0 rad: mapping.toml, offset = -40.0 of its theta";
        assert!(text.contains(words), "{text}");
        assert!(text.contains("ratios = { a = -80.0 }"), "{text}");
        // The ratio 1 with an offset is a tendon too, or the offset would be lost.
        let text = robot_toml(&coupled(&["a"], &model.replace("-80", "1")));
        assert!(text.contains("offset = 0.5 of its theta"), "{text}");
        assert!(
            text.lines().all(|line| line.chars().count() <= 120),
            "{text}"
        );
    }

    #[test]
    fn ambiguous_shorthand_becomes_a_tendon() {
        // Motors that have the other joint's name, and two motors of one joint.
        let init = coupled(&["a", "b"], "motor,a,b\na,0,1\nb,1,0\n");
        assert_eq!((init.tendons.len(), init.motors.len()), (2, 2));
        let init = coupled(&["a"], "motor,a\nm1,1\nm2,1\n");
        assert_eq!(init.tendons.len(), 2);
        // The motor of the joint's own name is no other.
        let init = coupled(&["a", "b"], "motor,a,b\na,1,0\nb,0.5,1\n");
        assert_eq!(
            (init.tendons.len(), init.joints[0].plan),
            (1, InitPlan::Elastic)
        );
        assert_eq!(init.joints[0].motor.as_deref(), Some("a"));
    }

    #[test]
    fn recorded_motors_are_no_joints() {
        let joint = |name: &str, channels: &[Quantity]| JointInfo {
            name: name.into(),
            channels: channels.to_vec(),
        };
        let recorded = [
            joint("a", &[Quantity::Q]),
            joint("b", &[Quantity::Q]),
            joint("m1", &[Quantity::Theta]),
            joint("m2", &[Quantity::Theta]),
        ];
        let text = urdf(&["a", "b"]);
        let mut init =
            Init::of_network("net", Some(("r.urdf", &text)), &recorded, None).expect("a URDF");
        let map = TransmissionMap::parse("motor,a,b\nm1,2,0\nm2,2,3\n", "t").expect("a table");
        init.couple(map, "t").expect("coupled");
        assert_eq!(init.joints.len(), 2);
        assert!(init.joints.iter().all(|j| j.plan == InitPlan::Coupled));
        assert!(init.motors.iter().all(|m| m.recorded == [Quantity::Theta]));
        assert!(
            !init.missing.contains(&InitGap::MotorSide),
            "{:?}",
            init.missing
        );
        let of_log = |init: &Init| {
            init.joints
                .iter()
                .map(|j| j.name.clone())
                .collect::<Vec<_>>()
        };
        let mut bare = Init::of_network("net", None, &recorded, None).expect("no URDF");
        let map = TransmissionMap::parse("motor,a,b\nm1,2,0\nm2,2,3\n", "t").expect("a table");
        bare.couple(map, "t").expect("coupled");
        assert_eq!(of_log(&bare), ["a", "b"]);
        // A joint that the URDF does not have changes nothing.
        let before = init.clone();
        let map = TransmissionMap::parse("motor,a,bb\nm1,2,0\nm2,2,3\n", "t.csv").expect("a table");
        let error = init.couple(map, "t.csv").unwrap_err().to_string();
        let words = "t.csv, line 3: tendon 'm2': joint 'bb' is not a moving joint of the URDF; did you mean 'b'?";
        assert!(error.starts_with(words), "{error}");
        assert_eq!(init, before);
    }

    #[test]
    fn numbers_are_valid_toml() {
        for (value, text) in [
            (-1000.0 * 0.0033, "-3.3"),
            (1e-9, "1e-9"),
            (1e22, "1e22"),
            (28.25, "28.25"),
            (-2.0, "-2.0"),
        ] {
            assert_eq!(number(value), text);
            let toml = format!("a = {text}\n");
            let file = TomlFile::parse(&toml, "t").expect(&toml);
            let read = file
                .root()
                .value("a")
                .expect("a")
                .number(Bound::Any)
                .expect("a number");
            assert!((read - value).abs() <= 1e-14 * value.abs());
        }
        assert_eq!(number(f64::MAX).parse(), Ok(f64::MAX));
    }

    #[test]
    fn keys_and_strings_round_trip_through_toml() {
        for name in [
            "elbow",
            "",
            "a b",
            "größe",
            "\"",
            "back\\slash",
            "a\tb\nc",
            "a = [1]",
            "\u{7f}",
        ] {
            let text = format!("{} = {}\n", key(name), quoted(name));
            let file = TomlFile::parse(&text, "robot.toml").unwrap();
            let entries = file.root().entries();
            assert_eq!(entries.len(), 1, "{text}");
            for (read, _, value) in entries {
                assert_eq!((read, value.text().unwrap()), (name, name), "{text}");
            }
        }
    }
}
