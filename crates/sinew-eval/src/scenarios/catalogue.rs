//! The scenarios of the protocol, as texts in the program.

use super::ScenarioError;
use super::adapted::{ADAPTABLE, adapt};
use super::variants;
use sinew_model::robot::{Robot, RobotFile};
use sinew_sim::{Scenario, SimulateError};
use toml::{Table, Value};

/// What runs when nothing is named.
pub const DEFAULT: [&str; 4] = ["S5", "S6", "S7", "S8"];
/// The protocol's scenarios.
pub const STANDARD: [&str; 8] = ["S5", "S6", "S7", "S8", "S8b", "S9", "S9b", "S9c"];
/// Errors of the model that the estimator doesn't know of.
pub const UNMODELLED: [&str; 9] = ["U1", "U2", "U3", "U3b", "U4", "U5", "U6", "U7", "U8"];

const TEXTS: [(&str, &str); 17] = [
    ("S5", include_str!("toml/S5.toml")),
    ("S6", include_str!("toml/S6.toml")),
    ("S7", include_str!("toml/S7.toml")),
    ("S8", include_str!("toml/S8.toml")),
    ("S8b", include_str!("toml/S8b.toml")),
    ("S9", include_str!("toml/S9.toml")),
    ("S9b", include_str!("toml/S9b.toml")),
    ("S9c", include_str!("toml/S9c.toml")),
    ("U1", include_str!("toml/U1.toml")),
    ("U2", include_str!("toml/U2.toml")),
    ("U3", include_str!("toml/U3.toml")),
    ("U3b", include_str!("toml/U3b.toml")),
    ("U4", include_str!("toml/U4.toml")),
    ("U5", include_str!("toml/U5.toml")),
    ("U6", include_str!("toml/U6.toml")),
    ("U7", include_str!("toml/U7.toml")),
    ("U8", include_str!("toml/U8.toml")),
];

const ROBOT: &str = include_str!("../../../../robots/biorob-like/robot.toml");
const ROBOT_FILE: &str = "robots/biorob-like/robot.toml";
const URDF: &str = include_str!("../../../../robots/biorob-like/biorob-like.urdf");

/// All texts a recording depends on.
pub(super) fn everything() -> String {
    let texts: String = TEXTS.iter().map(|(_, text)| *text).collect();
    texts + ROBOT + URDF
}

/// A scenario, ready to be recorded with any seed.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Its name.
    pub name: String,
    /// What it is about, where that isn't the protocol's.
    pub about: Option<String>,
    /// The whole scenario as `sinew simulate` reads it.
    pub text: String,
    /// The same, read.
    pub scenario: Scenario,
    /// The robot as the estimator knows it.
    pub robot: Robot,
    /// The robot that is simulated, before anything is drawn: the same but for a tilted axis.
    pub simulated: Robot,
    /// Whether the gripper may hold something, as far as the estimator is told.
    pub payload_unknown: bool,
    /// What it depends on beside the program: another robot, a file.
    pub(super) rests_on: String,
}

impl Plan {
    /// The scenario or the variant of that name.
    ///
    /// # Errors
    /// [`ScenarioError::Unknown`].
    pub fn named(name: &str) -> Result<Self, ScenarioError> {
        if let Some(variant) = variants::plan(name) {
            return variant;
        }
        let mut table = merged(name)?;
        let refuse = |why: String| ScenarioError::Text {
            name: name.into(),
            why,
        };
        let about = match table.remove("about") {
            Some(Value::String(about)) => Some(about),
            _ => None,
        };
        let robot = RobotFile::parse(ROBOT, ROBOT_FILE)?.build(URDF)?;
        let simulated = match table.remove("tilted_axis") {
            None => robot.clone(),
            Some(tilt) => {
                let joint = tilt.get("joint").and_then(Value::as_str);
                let angle = tilt.get("angle_deg").and_then(Value::as_float);
                let (Some(joint), Some(angle)) = (joint, angle) else {
                    return Err(refuse("tilted_axis needs joint and angle_deg".into()));
                };
                let urdf = tilted(URDF, joint, angle.to_radians())
                    .ok_or_else(|| refuse(format!("joint '{joint}' has no <axis>")))?;
                RobotFile::parse(ROBOT, ROBOT_FILE)?.build(&urdf)?
            }
        };
        let plan = Self::of(&table, name, robot)?;
        Ok(Self {
            about,
            simulated,
            ..plan
        })
    }

    /// `table` with the protocol's robot, which is as it is described before anything is drawn.
    pub(super) fn shipped(table: &Table, name: &str) -> Result<Self, ScenarioError> {
        let robot = RobotFile::parse(ROBOT, ROBOT_FILE)?.build(URDF)?;
        Self::of(table, name, robot)
    }

    /// The protocol's scenario of that name for another robot: its draws, said of that robot's joints
    /// (docs/src/science/scenarios.md).
    ///
    /// # Errors
    /// [`ScenarioError::Unknown`]; [`ScenarioError::Text`] for a scenario that is about the protocol's own
    /// robot, and for a robot without an elastic joint.
    pub fn adapted(name: &str, robot: &Robot) -> Result<Self, ScenarioError> {
        let mut table = merged(name)?;
        let refuse = |why: String| ScenarioError::Text {
            name: name.into(),
            why,
        };
        if !ADAPTABLE.contains(&name) {
            return Err(refuse(format!(
                "is about the BioRob-like arm's own joints and poses; for other robots there are {}",
                ADAPTABLE.join(", ")
            )));
        }
        adapt(&mut table, robot).map_err(refuse)?;
        let plan = Self::of(&table, name, robot.clone())?;
        Ok(Self {
            rests_on: format!("{robot:?}"),
            ..plan
        })
    }

    /// A scenario of one's own; `file` is what messages call it.
    ///
    /// # Errors
    /// [`ScenarioError::Simulate`] where it is none, [`ScenarioError::Text`] without the sessions A, B and C.
    pub fn own(
        scenario: Scenario,
        text: &str,
        file: &str,
        robot: Robot,
    ) -> Result<Self, ScenarioError> {
        let plan = Self::with(scenario, text.into(), file, robot)?;
        let rests_on = format!("{text}{:?}", plan.robot);
        Ok(Self { rests_on, ..plan })
    }

    fn of(table: &Table, name: &str, robot: Robot) -> Result<Self, ScenarioError> {
        let text = toml::to_string(table).map_err(|e| ScenarioError::Text {
            name: name.into(),
            why: e.to_string(),
        })?;
        let scenario =
            Scenario::from_toml(&text, &format!("scenario {name}")).map_err(SimulateError::from)?;
        Self::with(scenario, text, name, robot)
    }

    fn with(
        scenario: Scenario,
        text: String,
        name: &str,
        robot: Robot,
    ) -> Result<Self, ScenarioError> {
        if scenario.sessions.len() != 3 {
            return Err(ScenarioError::Text {
                name: name.into(),
                why: "needs three [[sessions]]: A teaches the baseline, B is judged, in C something may slip".into(),
            });
        }
        Ok(Self {
            name: scenario.name.clone(),
            about: None,
            text,
            payload_unknown: !scenario.payloads.is_empty(),
            scenario,
            simulated: robot.clone(),
            robot,
            rests_on: String::new(),
        })
    }
}

/// A scenario with what it extends: tables are merged, lists and the motion are replaced.
pub(super) fn merged(name: &str) -> Result<Table, ScenarioError> {
    let text = TEXTS
        .iter()
        .find(|(n, _)| *n == name)
        .map(|(_, text)| *text)
        .ok_or_else(|| ScenarioError::Unknown {
            name: name.into(),
            known: (TEXTS.iter().map(|(n, _)| *n).chain(variants::variants()))
                .collect::<Vec<_>>()
                .join(", "),
        })?;
    let mut own: Table = text.parse().map_err(|e| ScenarioError::Text {
        name: name.into(),
        why: format!("{e}"),
    })?;
    let Some(Value::String(base)) = own.remove("extends") else {
        return Ok(own);
    };
    let mut table = merged(&base)?;
    table.remove("about");
    for (key, value) in own {
        match (table.get_mut(&key), value) {
            (Some(Value::Table(old)), Value::Table(new)) if key != "motion" => old.extend(new),
            (_, value) => {
                table.insert(key, value);
            }
        }
    }
    Ok(table)
}

/// Sets a key of a section, which comes to be where it is missing.
pub(super) fn set(table: &mut Table, section: &str, key: &str, value: Value) {
    let section = table
        .entry(section)
        .or_insert_with(|| Value::Table(Table::new()));
    if let Value::Table(section) = section {
        section.insert(key.into(), value);
    }
}

/// The URDF with one joint's axis turned by `angle` about a direction across it.
fn tilted(urdf: &str, joint: &str, angle: f64) -> Option<String> {
    let at = urdf.find(&format!("<joint name=\"{joint}\""))?;
    const MARK: &str = "<axis xyz=\"";
    let from = at + urdf[at..].find(MARK)? + MARK.len();
    let to = from + urdf[from..].find('"')?;
    let axis: Vec<f64> = urdf[from..to]
        .split_whitespace()
        .filter_map(|x| x.parse().ok())
        .collect();
    let &[x, y, z] = axis.as_slice() else {
        return None;
    };
    // Across: the coordinate axis after the largest component, which no unit axis lies along.
    let across = if y.abs() >= x.abs() && y.abs() >= z.abs() {
        [1.0, 0.0, 0.0]
    } else {
        [0.0, 1.0, 0.0]
    };
    let (sin, cos) = libm::sincos(angle);
    let turned = [x, y, z]
        .iter()
        .zip(across)
        .map(|(a, c)| format!("{}", cos * a + sin * c))
        .collect::<Vec<_>>()
        .join(" ");
    Some(format!("{}{turned}{}", &urdf[..from], &urdf[to..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scenario_is_one_and_names_itself() {
        for (name, _) in TEXTS {
            let plan = Plan::named(name).unwrap_or_else(|e| panic!("{name}: {e}"));
            assert_eq!(plan.scenario.name, name);
            assert_eq!(plan.scenario.duration_s, Some(180.0));
            assert!(plan.about.is_some() == name.starts_with('U'), "{name}");
        }
        let listed = STANDARD.len() + UNMODELLED.len();
        assert_eq!(listed, TEXTS.len());
        let unknown = Plan::named("S4").unwrap_err().to_string();
        assert!(unknown.contains("S5, S6"), "{unknown}");
    }

    #[test]
    fn a_tilted_axis_is_a_degree_from_the_description() {
        let urdf = tilted(URDF, "elbow", 1f64.to_radians()).unwrap();
        let at = urdf.find("<joint name=\"elbow\"").unwrap();
        let line = urdf[at..].lines().find(|l| l.contains("<axis")).unwrap();
        let axis: Vec<f64> = line
            .split('"')
            .nth(1)
            .unwrap()
            .split(' ')
            .map(|x| x.parse().unwrap())
            .collect();
        // cos of the angle to (0, −1, 0), and a unit vector.
        assert!((-axis[1] - 1f64.to_radians().cos()).abs() < 1e-12);
        assert!((axis.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-12);
    }
}
