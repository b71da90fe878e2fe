//! Table form of a record: the same columns in every file format.

use crate::Record;
use sinew_log::{Cell, CellKind, Column};

/// Column names of a record, in the order of `sinew-record/2`; identical in SQL, Parquet and CSV.
pub const COLUMNS: [&str; 23] = [
    "robot",
    "robot_type",
    "joint",
    "time_utc_s",
    "duration_s",
    "offset_rad",
    "offset_std_rad",
    "elongation_m",
    "elongation_std_m",
    "strain_ratio",
    "strain_std_ratio",
    "temperature_c",
    "stiffness_ratio",
    "stiffness_std_ratio",
    "baseline",
    "source",
    "clock",
    "provisional",
    "reason",
    "poses",
    "frames",
    "frames_lost",
    "sinew_version",
];

/// Returns the cell type of a column.
pub fn kind(column: &str) -> CellKind {
    match column {
        "poses" | "frames" | "frames_lost" => CellKind::Integer,
        "provisional" => CellKind::Flag,
        "robot" | "robot_type" | "joint" | "baseline" | "source" | "clock" | "reason"
        | "sinew_version" => CellKind::Text,
        _ => CellKind::Number,
    }
}

/// Returns the names and cell types of all columns.
pub fn columns() -> Vec<Column> {
    COLUMNS
        .iter()
        .map(|name| ((*name).to_owned(), kind(name)))
        .collect()
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
