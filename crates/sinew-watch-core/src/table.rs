//! Table form of a record: the same columns in every file format.

use crate::Record;
use sinew_log::{Cell, CellKind, Column, SchemaColumn, TableSchema};

/// Columns of a record in the order of `sinew-record/2`, identical in SQL, Parquet and CSV.
const ABOUT: [SchemaColumn; 23] = [
    SchemaColumn::plain(
        "robot",
        CellKind::Text,
        "Name of the robot in the configuration",
    ),
    SchemaColumn::plain(
        "robot_type",
        CellKind::Text,
        "Robot name in URDF and robot.toml",
    ),
    SchemaColumn::plain("joint", CellKind::Text, "Name of the joint"),
    SchemaColumn::number(
        "time_utc_s",
        "s",
        "Start of the session by the monitor's clock, since 1970 UTC",
    ),
    SchemaColumn::number("duration_s", "s", "Duration of motion in the session"),
    SchemaColumn::number(
        "offset_rad",
        "rad",
        "Offset since the last tensioning; null: inconclusive, with the cause in reason",
    ),
    SchemaColumn::number("offset_std_rad", "rad", "Standard deviation of the offset"),
    SchemaColumn::number(
        "elongation_m",
        "m",
        "Elongation since the last tensioning; null without an offset or tendon geometry",
    ),
    SchemaColumn::number(
        "elongation_std_m",
        "m",
        "Standard deviation of the elongation",
    ),
    SchemaColumn::number(
        "strain_ratio",
        "1",
        "Total strain since the rope was new; includes elongation from before the last tensioning",
    ),
    SchemaColumn::number("strain_std_ratio", "1", "Standard deviation of the strain"),
    SchemaColumn::number(
        "temperature_c",
        "°C",
        "Mean temperature of the session; null: not recorded",
    ),
    SchemaColumn::number(
        "stiffness_ratio",
        "1",
        "Stiffness relative to nominal, minus 1",
    ),
    SchemaColumn::number(
        "stiffness_std_ratio",
        "1",
        "Standard deviation of the relative stiffness",
    ),
    SchemaColumn::plain(
        "baseline",
        CellKind::Text,
        "Reference of the offset: name of the last tensioning; null: encoder zero",
    ),
    SchemaColumn::plain("source", CellKind::Text, "Source of the frames"),
    SchemaColumn::plain(
        "clock",
        CellKind::Text,
        "Clock of the time stamps: utc, stamp or stepped",
    ),
    SchemaColumn::plain(
        "provisional",
        CellKind::Flag,
        "Whether an offset was provisional at the end of the session",
    ),
    SchemaColumn::plain("reason", CellKind::Text, "Reason for a missing offset"),
    SchemaColumn::plain(
        "poses",
        CellKind::Integer,
        "Number of distinct poses in the session",
    ),
    SchemaColumn::plain("frames", CellKind::Integer, "Number of frames used"),
    SchemaColumn::plain(
        "frames_lost",
        CellKind::Integer,
        "Number of frames lost, rejected or incomplete",
    ),
    SchemaColumn::plain(
        "sinew_version",
        CellKind::Text,
        "Version of the program that made the record",
    ),
];

/// Schema of a table of records.
pub const SCHEMA: TableSchema<'static> = TableSchema {
    name: Record::SCHEMA,
    columns: &ABOUT,
};

/// Names of the columns.
pub const COLUMNS: [&str; ABOUT.len()] = {
    let mut names = [""; ABOUT.len()];
    let mut i = 0;
    while i < names.len() {
        names[i] = ABOUT[i].name;
        i += 1;
    }
    names
};

/// Returns the cell type of a column.
pub fn kind(column: &str) -> CellKind {
    (ABOUT.iter().find(|c| c.name == column)).map_or(CellKind::Number, |c| c.kind)
}

/// Returns the names and cell types of all columns.
pub fn columns() -> Vec<Column> {
    (ABOUT.iter().map(|c| (c.name.to_owned(), c.kind))).collect()
}

/// Returns the cells of a record, one per entry of [`COLUMNS`].
pub fn row(of: &Record) -> [Cell; COLUMNS.len()] {
    let text = |text: &str| Cell::Text(text.to_owned());
    let maybe = |x: Option<f64>| x.map_or(Cell::Empty, Cell::Number);
    // Every record has this number.
    let number = |x: f64| Cell::Number(if x.is_finite() { x } else { 0.0 });
    let count = |n: u64| Cell::Integer(i64::try_from(n).unwrap_or(i64::MAX));
    [
        text(&of.robot),
        text(&of.robot_type),
        text(&of.joint),
        number(of.time_utc_s),
        number(of.duration_s),
        maybe(of.offset_rad),
        maybe(of.offset_std_rad),
        maybe(of.elongation_m),
        maybe(of.elongation_std_m),
        maybe(of.strain_ratio),
        maybe(of.strain_std_ratio),
        maybe(of.temperature_c),
        maybe(of.stiffness_ratio),
        maybe(of.stiffness_std_ratio),
        of.baseline.as_deref().map_or(Cell::Empty, text),
        text(&of.source),
        text(of.clock.name()),
        Cell::Flag(of.provisional),
        of.reason.map_or(Cell::Empty, |reason| text(reason.name())),
        count(of.poses),
        count(of.frames),
        count(of.frames_lost),
        text(&of.sinew_version),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_agree_with_names() {
        for column in &ABOUT {
            assert!(!column.meaning.is_empty(), "{}", column.name);
            let unit = match (column.kind, column.name.rsplit('_').next()) {
                (CellKind::Number, Some("c")) => "°C",
                (CellKind::Number, Some("ratio")) => "1",
                (CellKind::Number, Some(unit)) => unit,
                _ => "",
            };
            assert_eq!(column.unit, unit, "{}", column.name);
        }
    }
}
