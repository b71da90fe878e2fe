//! Lifetimes, from a table of ages or of events.

use super::events::{EventColumns, lives_of_events};
use super::result::{AgeUnit, SurvivalNote};
use crate::trend::RecordError;
use sinew_files::csv::{Row, Table};
use sinew_files::date::DAY_S;
use sinew_files::{Bound, Fault, Fields as _, limits};
use std::path::Path;

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

/// Reads the lives of a CSV: a row a rope with its age (`age_days`, `age_hours` or `age_cycles`) and how it ended, or a
/// row an event with its date.
///
/// # Errors
/// [`RecordError`] with file, line and what to do.
pub fn read_lives(path: &Path, columns: &EventColumns) -> Result<Lives, RecordError> {
    let table = Table::read(path, &limits::SESSIONS)?;
    let ages = [
        ("age_days", AgeUnit::Seconds, DAY_S),
        ("age_hours", AgeUnit::Seconds, 3600.0),
        ("age_cycles", AgeUnit::Cycles, 1.0),
    ];
    let named = [
        (&columns.group, "--group names a column that is there"),
        (&columns.watched, "--watched names a column that is there"),
    ];
    for (column, why) in named {
        if let (Some(name), Some(row)) = (column, table.rows().next())
            && table.column(name).is_none()
        {
            return Err(no_column(&row, name, why));
        }
    }
    let aged = ages
        .into_iter()
        .find(|(name, ..)| table.column(name).is_some());
    if let (Some((name, ..)), Some(row)) = (aged, table.rows().next())
        && (columns.until_utc_s.is_some() || columns.watched.is_some())
    {
        let problem = format!(
            "a table with '{name}' says how old every rope became; --until and --watched are for events"
        );
        return Err(row.here(Fault::Contradiction, problem).into());
    }
    let lives = match aged {
        Some((column, age_unit, factor)) => Lives {
            age_unit,
            lives: (table.rows())
                .map(|row| aged_rope(&row, columns, column, factor))
                .collect::<Result<_, _>>()?,
            notes: Vec::new(),
        },
        None => lives_of_events(&table, columns)?,
    };
    if lives.lives.is_empty() {
        return Err(RecordError::NoLives {
            file: path.display().to_string(),
        });
    }
    Ok(lives)
}

/// A row of a table of ages.
fn aged_rope(
    row: &Row<'_>,
    columns: &EventColumns,
    column: &'static str,
    factor: f64,
) -> Result<RopeLife, RecordError> {
    let age = row.need(
        column,
        Bound::Positive,
        "every rope has an age; leave the row out",
    )?;
    let end = row.need_text("end")?;
    Ok(RopeLife {
        unit: columns.unit_of(row).unwrap_or_default(),
        group: columns.group_of(row),
        age: factor * age,
        end: end_of(end)
            .ok_or_else(|| row.refuse("end", "broken, replaced, retired or running"))?,
    })
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
