//! The text of a first robot.toml.

use crate::init::{Init, InitDescribed, InitJoint, InitPlan};
use crate::robot_check::JointMotion;
use sinew_files::number::three_digits;
use sinew_files::plain;
use sinew_log::Quantity;
use std::fmt::Write as _;

/// The text of robot.toml: what the files say, and every other key as a comment with its unit, what is
/// usual and where to find it.
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
    out += "# Lines with # are not known from there: fill in what you know and take the # away.\n\
            # `sinew robot check` says what is still missing and what looks odd.\n\n";
    match &init.urdf {
        Some(urdf) => {
            let _ = writeln!(out, "urdf = {}", quoted(urdf));
        }
        None => {
            out +=
                "# urdf = \"ROBOT.urdf\"                # beside this file: links, masses, joints\n"
        }
    }
    for joint in &init.joints {
        out += &joint_section(joint);
    }
    out += "\n# How far the robot may be from this file, one standard deviation each. Defaults:\n\
            # [tolerances]\n\
            # stiffness_percent = 12.0\n\
            # mass_percent = 6.0\n\
            # friction_percent = 50.0\n";
    out
}

fn joint_section(joint: &InitJoint) -> String {
    let key = key(&joint.name);
    let mut out = String::from("\n");
    if joint.plan == InitPlan::LeftOut {
        let name = plain(&joint.name);
        let _ = writeln!(
            out,
            "# '{name}' is recorded, and the URDF has no such joint."
        );
        return out;
    }
    let _ = writeln!(out, "[joints.{key}]");
    if let Some(described) = &joint.described {
        let _ = writeln!(out, "# {}", about(described));
    }
    match joint.plan {
        InitPlan::Rigid => {
            out += "# No motor position of it is recorded, so that no spring would show.\nrigid = true\n";
        }
        InitPlan::Locked => {
            out += "# It is not recorded. Where does it stand meanwhile?\n\
                    # locked_at_rad =                   # rad; m if it slides\n";
        }
        InitPlan::Elastic | InitPlan::LeftOut => out += &spring(joint, &key),
    }
    out
}

/// `revolute about 0 0 1, −2.60 to 2.60 rad, carries 1.50 kg`.
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
    let mass = three_digits(joint.carried_kg);
    format!("{kind} {axis}, {range}, carries {mass} kg")
}

/// Keys of an elastic joint, all still to be filled in.
fn spring(joint: &InitJoint, key: &str) -> String {
    let described = joint.described.as_ref();
    let friction = match described.is_some_and(|d| d.friction_stated) {
        true => "the URDF's, unless stated here",
        false => "guessed, unless stated here",
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
         #                                   # of theta - q. No spring in it? Then: rigid = true\n\
         # motor_inertia_kg_m2 =             # {inertia}\n\
         # joint_friction = {{ coulomb_nm = , viscous_nm_s_per_rad =  }}   # {friction}\n\
         # motor_friction = {{ coulomb_nm = , viscous_nm_s_per_rad =  }}   # {pull} that just turns motor and gear\n"
    );
    if joint.recorded.contains(&Quantity::TauM) {
        out += "# Its motor torque is recorded: with motor_inertia_kg_m2 it is a second witness.\n";
    }
    let _ = write!(
        out,
        "# [joints.{key}.tendon]             # for mm and strain; without it mrad only\n\
         # rope = \"\"                         # a name of `sinew rope list`\n\
         # length_mm =                       # mm between the pulleys, 50 to 2000; measure it\n\
         # joint_pulley_radius_mm =          # {radius}\n\
         # pretension_n =                    # N at rest, 5 to 20 % of the rope's breaking load; spring scale\n\
         # guides = [{{ radius_mm = , wrap_deg = , friction = 0.05 }}]     # from drive to joint\n\
         # retension_at_mm =                 # mm of elongation at which you tension again, 0.3 to 3\n"
    );
    out
}

/// A key of a TOML file.
fn key(name: &str) -> String {
    let bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    match !name.is_empty() && name.chars().all(bare) {
        true => name.to_owned(),
        false => quoted(name),
    }
}

/// A text of a TOML file.
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
    use super::{key, quoted};
    use sinew_files::TomlFile;

    #[test]
    fn any_name_is_read_as_it_was_written() {
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
