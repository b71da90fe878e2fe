//! The scenarios of the protocol and their variants, by name.

use super::adapted::{ADAPTABLE, adapt};
use super::texts::{self, ROBOT, ROBOT_FILE, URDF, merged};
use super::{Plan, PlanError, variants};
use sinew_model::robot::{Robot, RobotFile};
use toml::Value;

/// Scenarios that run by default.
pub const DEFAULT: [&str; 4] = ["S5", "S6", "S7", "S8"];
/// The protocol's scenarios.
pub const STANDARD: [&str; 8] = ["S5", "S6", "S7", "S8", "S8b", "S9", "S9b", "S9c"];
/// Scenarios with model errors that the estimator does not model.
pub const UNMODELLED: [&str; 9] = ["U1", "U2", "U3", "U3b", "U4", "U5", "U6", "U7", "U8"];

/// The scenario or the variant of that name.
///
/// # Errors
/// [`PlanError::Unknown`].
pub fn plan_named(name: &str) -> Result<Plan, PlanError> {
    if let Some(variant) = variants::plan(name) {
        return variant;
    }
    check_name(name)?;
    let mut table = merged(name)?;
    let text_error = |reason: String| PlanError::Text {
        name: name.into(),
        reason,
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
                return Err(text_error("tilted_axis needs joint and angle_deg".into()));
            };
            let urdf = tilted(URDF, joint, angle.to_radians())
                .ok_or_else(|| text_error(format!("joint '{joint}' has no <axis>")))?;
            RobotFile::parse(ROBOT, ROBOT_FILE)?.build(&urdf)?
        }
    };
    let plan = Plan::of(&table, name, robot)?;
    Ok(Plan {
        about,
        simulated,
        ..plan
    })
}

/// Returns the protocol's scenario of that name for another robot, with its draws transferred to that robot's joints
/// (docs/src/validation.md).
///
/// # Errors
/// - [`PlanError::Unknown`] if there is no scenario of that name.
/// - [`PlanError::Text`] if the scenario refers to the protocol's own robot, or the robot has no elastic joint.
pub fn plan_adapted(name: &str, robot: &Robot) -> Result<Plan, PlanError> {
    check_name(name)?;
    let mut table = merged(name)?;
    let text_error = |reason: String| PlanError::Text {
        name: name.into(),
        reason,
    };
    if !ADAPTABLE.contains(&name) {
        return Err(text_error(format!(
            "is specific to the joints and poses of the BioRob-like arm; available for other robots: {}",
            ADAPTABLE.join(", ")
        )));
    }
    adapt(&mut table, robot).map_err(text_error)?;
    let plan = Plan::of(&table, name, robot.clone())?;
    Ok(Plan {
        based_on: format!("{robot:?}"),
        ..plan
    })
}

/// Whether there is a scenario of that name; the refusal lists all there are.
fn check_name(name: &str) -> Result<(), PlanError> {
    let all: Vec<&str> = texts::names().chain(variants::variants()).collect();
    if all.contains(&name) {
        return Ok(());
    }
    Err(PlanError::Unknown {
        name: name.into(),
        available: all.join(", "),
    })
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
    fn catalogue_scenarios_are_valid_and_named() {
        for name in texts::names() {
            let plan = plan_named(name).unwrap_or_else(|e| panic!("{name}: {e}"));
            assert_eq!(plan.scenario.name, name);
            assert_eq!(plan.scenario.duration_s, Some(180.0));
            assert!(plan.about.is_some() == name.starts_with('U'), "{name}");
        }
        let listed = STANDARD.len() + UNMODELLED.len();
        assert_eq!(listed, texts::names().count());
        let unknown = plan_named("S4").unwrap_err().to_string();
        assert!(unknown.contains("S5, S6"), "{unknown}");
    }

    #[test]
    fn tilted_axis_differs_by_one_degree() {
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
