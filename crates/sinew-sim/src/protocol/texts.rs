//! Embedded texts of the protocol's scenarios, and the scenarios that they extend.

use super::PlanError;
use sinew_model::robot::BIOROB_LIKE;
use toml::{Table, Value};

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

pub(super) const ROBOT: &str = BIOROB_LIKE.robot_toml;

pub(super) const ROBOT_FILE: &str = "robots/biorob-like/robot.toml";

pub(super) const URDF: &str = BIOROB_LIKE.urdf;

/// Names of the texts.
pub(super) fn names() -> impl Iterator<Item = &'static str> {
    TEXTS.iter().map(|(name, _)| *name)
}

/// All texts that a recording of a named scenario depends on.
pub fn everything() -> String {
    let texts: String = TEXTS.iter().map(|(_, text)| *text).collect();
    texts + ROBOT + URDF
}

/// Returns a scenario merged with the one that it extends: tables are merged, and lists and the motion are replaced.
pub(super) fn merged(name: &str) -> Result<Table, PlanError> {
    let text = TEXTS
        .iter()
        .find(|(n, _)| *n == name)
        .map(|(_, text)| *text)
        .ok_or_else(|| PlanError::Unknown {
            name: name.into(),
            available: names().collect::<Vec<_>>().join(", "),
        })?;
    let mut own: Table = text.parse().map_err(|e| PlanError::Text {
        name: name.into(),
        reason: format!("{e}"),
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

/// Sets a key of a section, which is created if it is missing.
pub(super) fn set(table: &mut Table, section: &str, key: &str, value: Value) {
    let section = table
        .entry(section)
        .or_insert_with(|| Value::Table(Table::new()));
    if let Value::Table(section) = section {
        section.insert(key.into(), value);
    }
}
