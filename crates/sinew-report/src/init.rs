//! Templates of robot.toml and mapping.toml, and their missing values.

use crate::text::{TerminalText, plain};
use sinew_estimate::init::{Init, InitChoice, InitGap, InitPlan};
use sinew_estimate::robot_toml::quoted;
use sinew_log::{MappingProposal, Quantity};
use std::fmt::Write as _;

/// Returns the text of a mapping file template for a choice between topics or columns. `proposal` is for columns.
pub fn mapping_toml(source: &str, choice: &InitChoice, proposal: &MappingProposal) -> String {
    let mut out = format!("# Made by `sinew init` from {}.\n", plain(source));
    match choice {
        InitChoice::Topic(open) => {
            let (side, key, option) = open.words();
            let _ = write!(
                out,
                "# Several topics match the {side}. Uncomment one of them (equivalent to {option}).\n[mcap]\n"
            );
            for topic in &open.candidates {
                let _ = writeln!(out, "# {key} = {}", quoted(topic));
            }
        }
        InitChoice::Columns(columns) => {
            out += "# No column has a known name. Assign the columns, one [joints.NAME] per joint, and uncomment\n\
                    # the lines. Units: rad, deg, turn, count; rad/s, deg/s, rpm; N·m, N·mm, A; s, ms, us, ns.\n#\n\
                    # Columns:\n";
            for column in columns {
                let _ = writeln!(out, "#   {}", plain(column));
            }
            out += "#\n";
            propose(&mut out, columns, proposal);
            let _ = write!(
                out,
                "#\n# Form of a joint:\n\
                 # [joints.NAME]                     # name in the URDF\n\
                 # q = {{ column = \"\", unit = \"rad\" }}                          # joint side\n\
                 # theta = {{ column = \"\", unit = \"rad\", gear_ratio = 1.0 }}      # motor side; motor turns per joint turn\n\
                 # tau_m = {{ column = \"\", unit = \"N·m\", gear_ratio = 1.0 }}      # optional; unit A requires torque_constant_nm_per_a\n"
            );
        }
    }
    out
}

/// Adds the proposed time and joints. Lines are comments where neither a name nor a unit supports them.
fn propose(out: &mut String, columns: &[String], proposal: &MappingProposal) {
    let key = |index: usize| match proposal.columns.get(index) {
        Some(column) => match column.number {
            Some(number) => number.to_string(),
            None => quoted(&column.name),
        },
        None => columns
            .get(index)
            .map_or("\"\"".into(), |name| quoted(name)),
    };
    match &proposal.time {
        None => {
            let first = key(0);
            let _ = write!(
                out,
                "# [time]\n# column = {first}                     # no column rises; without times: rate_hz = 100\n# unit = \"s\"\n"
            );
        }
        Some(time) => {
            let named = if time.is_named { "name, " } else { "" };
            let _ = writeln!(
                out,
                "[time]\ncolumn = {}  # assumed: {named}rises from row to row",
                key(time.column)
            );
            let rate = time.rate_hz.map_or(String::new(), |hz| {
                format!("; {} Hz", sinew_files::number::three_digits(hz))
            });
            let _ = match (&time.unit, time.is_unit_stated) {
                (Some(unit), true) => {
                    writeln!(out, "unit = {}  # from the header{rate}", quoted(unit))
                }
                (Some(unit), false) => {
                    writeln!(
                        out,
                        "unit = {}  # assumed: a usual rate{rate}",
                        quoted(unit)
                    )
                }
                (None, _) => writeln!(out, "# clock times and dates need no unit"),
            };
        }
    }
    for joint in &proposal.joints {
        let has = |quantity| joint.sources.iter().any(|s| s.quantity == quantity);
        let is_supported = has(Quantity::Q)
            && has(Quantity::Theta)
            && joint.name != "NAME"
            && joint.sources.iter().all(|s| s.is_named && s.is_unit_stated);
        let mark = if is_supported { "" } else { "# " };
        let name = match joint
            .name
            .bytes()
            .all(|b| b.is_ascii_alphanumeric() || b == b'_')
        {
            true => joint.name.clone(),
            false => quoted(&joint.name),
        };
        let _ = writeln!(
            out,
            "{}\n{mark}[joints.{name}]  # assumed: name in the URDF",
            mark.trim_end()
        );
        for source in &joint.sources {
            let (symbol, unit) = (source.quantity.symbol(), quoted(&source.unit));
            let ratio = source
                .gear_ratio
                .map_or(String::new(), |r| format!(", gear_ratio = {r}"));
            let named = match source.is_named {
                true => "assumed: name",
                false => "assumed: order of the columns",
            };
            let range = proposal
                .columns
                .get(source.column)
                .and_then(|column| column.range);
            let range = range.map_or(String::new(), |[low, high]| {
                let digits = sinew_files::number::three_digits;
                format!("; first values {} to {}", digits(low), digits(high))
            });
            let stated = match source.is_unit_stated {
                true => "unit from the header",
                false => "unit assumed",
            };
            let moves = match (source.quantity, source.gear_ratio) {
                (Quantity::Theta, Some(ratio)) => {
                    format!("; moves about {ratio} times as far as q, compare the data sheet")
                }
                (Quantity::Theta, None) => "; set gear_ratio".to_owned(),
                _ => String::new(),
            };
            let _ = writeln!(
                out,
                "# {named}; {stated}{range}{moves}\n{mark}{symbol} = {{ column = {}, unit = {unit}{ratio} }}",
                key(source.column)
            );
        }
    }
}

/// Renders the written files, the missing values, and the next commands.
///
/// * `folder`: folder of robot.toml.
pub fn render(init: &Init, folder: &str) -> String {
    let mut out = TerminalText::default();
    for file in &init.written {
        let word = match init.replaced.contains(file) {
            true => "replaced",
            false => "wrote",
        };
        out.paragraph(format!("{word} {file}"));
    }
    for warning in &init.warnings {
        out.paragraph(format!("warning: {warning}"));
    }
    for source in init.recording.iter().flat_map(|r| &r.sources) {
        out.paragraph(format!(
            "{} from {}",
            source.quantity.symbol(),
            source.source
        ));
    }
    for joint in &init.joints {
        let name = &joint.name;
        match joint.plan {
            InitPlan::Rigid => out.paragraph(format!(
                "{name}: motor position not recorded; configured as rigid"
            )),
            InitPlan::Excluded => {
                out.paragraph(format!("{name}: recorded, but not in the URDF; ignored"));
            }
            InitPlan::Elastic | InitPlan::Coupled | InitPlan::Locked => {}
        }
    }
    for tendon in &init.tendons {
        let (motors, joints) = (tendon.motors.join(", "), tendon.joints.join(", "));
        let motors = match motors.is_empty() {
            true => "motor not specified".to_owned(),
            false => motors,
        };
        out.paragraph(format!("tendon {}: {motors} to {joints}", tendon.name));
    }
    if !init.missing.is_empty() {
        out.add("\nmissing:\n");
        for line in gaps(init) {
            out.item(line);
        }
    }
    out.add("\nnext:\n");
    let log = init
        .recording
        .as_ref()
        .map_or("LOG", |_| init.source.as_str());
    let options: String = init.options.iter().map(|o| format!(" {o}")).collect();
    let lines = match &init.choice {
        Some(_) => vec![
            "select an alternative in the mapping file, then".to_owned(),
            format!("sinew init {} --mapping {folder}/mapping.toml", init.source),
        ],
        None => vec![
            format!("complete {folder}/robot.toml, then"),
            format!("sinew robot check {folder}"),
            format!("sinew estimate {log} --robot {folder}{options}"),
        ],
    };
    for line in lines {
        out.add(format!("  {}\n", plain(&line)));
    }
    out.0
}

/// Lists the missing values, one line per kind.
fn gaps(init: &Init) -> Vec<String> {
    let (mut out, mut stiffness, mut locked) = (Vec::new(), Vec::new(), Vec::new());
    let (mut drums, mut of_tendons) = (Vec::new(), Vec::new());
    for gap in &init.missing {
        match gap {
            InitGap::Urdf => out.push(
                "URDF with masses: not in the recording; specify --urdf FILE".into(),
            ),
            InitGap::MotorSide => out.push(
                "motor positions: not found in the recording, required for every estimate; specify --motor-topic, --motor-interface, or columns in a mapping file".into(),
            ),
            InitGap::Choice => out.push("selection in the mapping file".into()),
            InitGap::Stiffness(joint) => stiffness.push(joint.as_str()),
            InitGap::LockedAt(joint) => locked.push(joint.as_str()),
            InitGap::Drums(tendon) => drums.push(tendon.as_str()),
            InitGap::TendonStiffness(tendon) => of_tendons.push(tendon.as_str()),
        }
    }
    let [stiffness, locked] = [stiffness, locked].map(|joints| joints.join(", "));
    if !stiffness.is_empty() {
        out.push(format!("stiffness_nm_per_rad of {stiffness}"));
    }
    let [drums, of_tendons] = [drums, of_tendons].map(|tendons| tendons.join(", "));
    if !drums.is_empty() {
        out.push(format!("drums_mm of the tendons {drums}"));
    }
    if !of_tendons.is_empty() {
        out.push(format!("stiffness of the tendons {of_tendons}"));
    }
    if !locked.is_empty() {
        out.push(format!("locked_at_rad of {locked} (not recorded)"));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_log::{Ambiguity, Mapping, TopicUse};

    #[test]
    fn mapping_template_is_valid_with_and_without_choice() {
        let open = InitChoice::Topic(Ambiguity {
            file: "a.mcap".into(),
            side: TopicUse::MotorSide,
            candidates: vec!["/left/motor\"s".into(), "/right/motors".into()],
        });
        let columns = InitChoice::Columns(vec!["t".into(), "pos".into()]);
        for choice in [&open, &columns] {
            let text = mapping_toml("a\n[b", choice, &MappingProposal::default());
            Mapping::from_toml(&text, "mapping.toml").expect(&text);
        }
        let none = MappingProposal::default();
        let chosen = mapping_toml("a", &open, &none).replace("# motor_topic", "motor_topic");
        let one = chosen.replacen("motor_topic = \"/right", "# motor_topic = \"/right", 1);
        Mapping::from_toml(&one, "mapping.toml").expect(&one);
        assert!(one.contains(r#"motor_topic = "/left/motor\"s""#), "{one}");
    }
}
