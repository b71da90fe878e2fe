//! Lifetimes of ropes: age and end.

use super::result::{AgeUnit, SurvivalNote};
use crate::RecordError;
use sinew_files::Fault;
use sinew_files::csv::Row;

/// End of a rope's lifetime.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LifeEnd {
    /// Break of the rope.
    Broke,
    /// Replacement before it broke, or removal from service.
    Replaced,
    /// Intact at the end of observation (censored).
    Whole,
}

/// Lifetime of one rope: from installation to break, or to its last observation intact.
#[derive(Debug, Clone, PartialEq)]
pub struct RopeLife {
    /// Location of the rope.
    pub unit: String,
    /// Group it is counted with; `None` for all ropes only.
    pub group: Option<String>,
    /// Age at the end, in the unit of the table.
    pub age: f64,
    /// End of the lifetime.
    pub end: LifeEnd,
}

/// Lifetimes of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Lifetimes {
    /// Unit of the ages.
    pub age_unit: AgeUnit,
    /// Lifetime of each rope.
    pub lives: Vec<RopeLife>,
    /// Notes on excluded rows and assumptions.
    pub notes: Vec<SurvivalNote>,
}

/// End of a lifetime from a word.
pub(super) fn end_of(word: &str) -> Option<LifeEnd> {
    Some(match word.to_lowercase().as_str() {
        "broken" | "broke" | "torn" | "failed" | "1" | "true" | "yes" => LifeEnd::Broke,
        "replaced" | "retired" | "removed" => LifeEnd::Replaced,
        "running" | "whole" | "censored" | "0" | "false" | "no" => LifeEnd::Whole,
        _ => return None,
    })
}

/// Error of a missing or empty column.
pub(super) fn no_column(row: &Row<'_>, name: &str, reason: &str) -> RecordError {
    let problem = format!("'{name}' is empty or missing: {reason}");
    row.here(Fault::MissingKey, problem).into()
}
