//! Lifetimes: how old a rope became, and how that ended.

use super::result::{AgeUnit, SurvivalNote};
use crate::RecordError;
use sinew_files::Fault;
use sinew_files::csv::Row;

/// How a rope's life ended, as far as is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LifeEnd {
    /// It broke.
    Broke,
    /// It was replaced before it broke, or taken out of service.
    Replaced,
    /// It was last seen whole.
    Whole,
}

/// One rope: from when it was put in to when it broke, or was last known whole.
#[derive(Debug, Clone, PartialEq)]
pub struct RopeLife {
    /// The place it ran at.
    pub unit: String,
    /// What it is counted with; `None`: only with all.
    pub group: Option<String>,
    /// Age at its end, in the unit of the table.
    pub age: f64,
    /// How it ended.
    pub end: LifeEnd,
}

/// The lives of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Lives {
    /// Unit of their ages.
    pub age_unit: AgeUnit,
    /// One per rope.
    pub lives: Vec<RopeLife>,
    /// What was left out or supposed.
    pub notes: Vec<SurvivalNote>,
}

/// How a life ended, from a word.
pub(super) fn end_of(word: &str) -> Option<LifeEnd> {
    Some(match word.to_lowercase().as_str() {
        "broken" | "broke" | "torn" | "failed" | "1" | "true" | "yes" => LifeEnd::Broke,
        "replaced" | "retired" | "removed" => LifeEnd::Replaced,
        "running" | "whole" | "censored" | "0" | "false" | "no" => LifeEnd::Whole,
        _ => return None,
    })
}

/// A column that is not there, with those that are.
pub(super) fn no_column(row: &Row<'_>, name: &str, why: &str) -> RecordError {
    let problem = format!("'{name}' is empty or no column: {why}");
    row.here(Fault::MissingKey, problem).into()
}
