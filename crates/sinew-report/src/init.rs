//! A first robot.toml and mapping, and what is still missing in them.

use crate::text::{indented, paragraph, plain};
use sinew_estimate::init::{Init, InitChoice, InitGap, InitPlan};
use sinew_estimate::robot_toml::quoted;
use std::fmt::Write as _;

/// The text of a mapping file for a choice that only a person can make.
pub fn mapping_toml(source: &str, choice: &InitChoice) -> String {
    let mut out = format!("# Made by `sinew init` from {}.\n", plain(source));
    match choice {
        InitChoice::Topic(open) => {
            let (side, key, option) = open.words();
            let _ = write!(
                out,
                "# Several topics could be the {side}. Take the # away before one ({option} does the same).\n[mcap]\n"
            );
            for topic in &open.candidates {
                let _ = writeln!(out, "# {key} = {}", quoted(topic));
            }
        }
        InitChoice::Columns(columns) => {
            out += "# None of its columns has a name Sinew knows. Say which is what, one [joints.NAME] a joint, and take\n\
                    # the # away. Units: rad, deg, turn, count; rad/s, deg/s, rpm; N·m, N·mm, A; s, ms, us, ns.\n#\n\
                    # Columns:\n";
            for column in columns {
                let _ = writeln!(out, "#   {}", plain(column));
            }
            let first = columns.first().map_or("\"\"".into(), |c| quoted(c));
            let _ = write!(
                out,
                "#\n# [time]\n# column = {first}\n# unit = \"s\"\n#\n\
                 # [joints.NAME]                     # the name in the URDF\n\
                 # q = {{ column = \"\", unit = \"rad\" }}                          # joint side\n\
                 # theta = {{ column = \"\", unit = \"rad\", gear_ratio = 1.0 }}      # motor side; turns of the motor per turn of the joint\n\
                 # tau_m = {{ column = \"\", unit = \"N·m\", gear_ratio = 1.0 }}      # optional; A needs torque_constant_nm_per_a\n"
            );
        }
    }
    out
}

/// What was written, what is missing, and what to run next. `folder` holds robot.toml.
pub fn render(init: &Init, folder: &str) -> String {
    let mut out = String::new();
    for file in &init.written {
        let word = match init.replaced.contains(file) {
            true => "replaced",
            false => "wrote",
        };
        out += &paragraph(&plain(&format!("{word} {file}")), 2);
    }
    if let Some(recording) = &init.recording {
        for source in &recording.sources {
            let line = format!("{} from {}", source.quantity.symbol(), source.source);
            out += &paragraph(&plain(&line), 2);
        }
    }
    for joint in &init.joints {
        let name = plain(&joint.name);
        match joint.plan {
            InitPlan::Rigid => {
                out += &paragraph(&format!("{name}: no motor position recorded, so rigid"), 2);
            }
            InitPlan::LeftOut => {
                let line = format!("{name}: recorded, but not in the URDF; left out");
                out += &paragraph(&line, 2);
            }
            InitPlan::Elastic | InitPlan::Locked => {}
        }
    }
    if !init.missing.is_empty() {
        out += "\nstill missing:\n";
        for line in gaps(init) {
            out += &indented(&plain(&line), 2, 4);
        }
    }
    out += "\nnext:\n";
    let log = init
        .recording
        .as_ref()
        .map_or("LOG", |_| init.source.as_str());
    let options: String = init.options.iter().map(|o| format!(" {o}")).collect();
    let lines = match &init.choice {
        Some(_) => vec![
            "choose in the mapping file, then".to_owned(),
            format!("sinew init {} --mapping {folder}/mapping.toml", init.source),
        ],
        None => vec![
            format!("fill in {folder}/robot.toml, then"),
            format!("sinew robot check {folder}"),
            format!("sinew estimate {log} --robot {folder}{options}"),
        ],
    };
    for line in lines {
        let _ = writeln!(out, "  {}", plain(&line));
    }
    out
}

/// Gaps, those of a kind in one line.
fn gaps(init: &Init) -> Vec<String> {
    let joined = |name: fn(&InitGap) -> Option<&String>| -> String {
        let names = init.missing.iter().filter_map(name);
        names.map(String::as_str).collect::<Vec<_>>().join(", ")
    };
    let stiffness = joined(|gap| match gap {
        InitGap::Stiffness(joint) => Some(joint),
        _ => None,
    });
    let locked = joined(|gap| match gap {
        InitGap::LockedAt(joint) => Some(joint),
        _ => None,
    });
    let mut out = Vec::new();
    for gap in &init.missing {
        match gap {
            InitGap::Urdf => out.push(
                "a URDF with the masses: the recording holds none; name it with --urdf FILE".into(),
            ),
            InitGap::MotorSide => out.push(
                "motor positions: the recording holds none, and without them nothing can be estimated; name the topic with --motor-topic, the interface with --motor-interface, or columns in a mapping".into(),
            ),
            InitGap::Choice => out.push("a choice in the mapping file".into()),
            InitGap::Stiffness(_) | InitGap::LockedAt(_) => {}
        }
    }
    if !stiffness.is_empty() {
        out.push(format!("stiffness_nm_per_rad of {stiffness}"));
    }
    if !locked.is_empty() {
        out.push(format!("locked_at_rad of {locked}, which are not recorded"));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_log::{Ambiguity, Mapping, TopicUse};

    #[test]
    fn a_mapping_to_fill_in_is_one_and_each_choice_makes_it_complete() {
        let open = InitChoice::Topic(Ambiguity {
            file: "a.mcap".into(),
            side: TopicUse::MotorSide,
            candidates: vec!["/left/motor\"s".into(), "/right/motors".into()],
        });
        let columns = InitChoice::Columns(vec!["t".into(), "pos".into()]);
        for choice in [&open, &columns] {
            let text = mapping_toml("a\n[b", choice);
            Mapping::from_toml(&text, "mapping.toml").expect(&text);
        }
        let chosen = mapping_toml("a", &open).replace("# motor_topic", "motor_topic");
        let one = chosen.replacen("motor_topic = \"/right", "# motor_topic = \"/right", 1);
        Mapping::from_toml(&one, "mapping.toml").expect(&one);
        assert!(one.contains(r#"motor_topic = "/left/motor\"s""#), "{one}");
    }
}
