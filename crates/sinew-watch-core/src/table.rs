//! A record as a row of a file: the same columns, whoever writes it.

use crate::Record;
use sinew_log::{Cell, CellKind, Column};

/// Columns of a record, in the order of `sinew-record/1`. The same names in SQL, Parquet and CSV.
pub const COLUMNS: [&str; 23] = [
    "robot",
    "robot_type",
    "joint",
    "time_utc_s",
    "duration_s",
    "offset_rad",
    "offset_deviation_rad",
    "elongation_m",
    "elongation_deviation_m",
    "strain_ratio",
    "strain_deviation_ratio",
    "temperature_c",
    "stiffness_ratio",
    "stiffness_deviation_ratio",
    "baseline",
    "source",
    "clock",
    "in_doubt",
    "reason",
    "poses",
    "frames",
    "frames_lost",
    "sinew_version",
];

/// What a column holds.
pub fn kind(column: &str) -> CellKind {
    match column {
        "poses" | "frames" | "frames_lost" => CellKind::Integer,
        "in_doubt" => CellKind::Flag,
        "robot" | "robot_type" | "joint" | "baseline" | "source" | "clock" | "reason"
        | "sinew_version" => CellKind::Text,
        _ => CellKind::Number,
    }
}

/// Columns of a file of records.
pub fn columns() -> Vec<Column> {
    COLUMNS
        .iter()
        .map(|name| ((*name).to_owned(), kind(name)))
        .collect()
}

/// The cells of a record, one per [`COLUMNS`].
pub fn row(of: &Record) -> [Cell; COLUMNS.len()] {
    let text = |text: &str| Cell::Text(text.to_owned());
    let maybe = |x: Option<f64>| x.map_or(Cell::Empty, Cell::Number);
    // A number that every record has.
    let number = |x: f64| Cell::Number(if x.is_finite() { x } else { 0.0 });
    let count = |n: u64| Cell::Integer(i64::try_from(n).unwrap_or(i64::MAX));
    [
        text(&of.robot),
        text(&of.robot_type),
        text(&of.joint),
        number(of.time_utc_s),
        number(of.duration_s),
        maybe(of.offset_rad),
        maybe(of.offset_deviation_rad),
        maybe(of.elongation_m),
        maybe(of.elongation_deviation_m),
        maybe(of.strain_ratio),
        maybe(of.strain_deviation_ratio),
        maybe(of.temperature_c),
        maybe(of.stiffness_ratio),
        maybe(of.stiffness_deviation_ratio),
        of.baseline.as_deref().map_or(Cell::Empty, text),
        text(&of.source),
        text(of.clock.word()),
        Cell::Flag(of.in_doubt),
        of.reason.map_or(Cell::Empty, |reason| text(reason.word())),
        count(of.poses),
        count(of.frames),
        count(of.frames_lost),
        text(&of.sinew_version),
    ]
}
