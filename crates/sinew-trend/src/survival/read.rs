//! Lifetimes from a table of ages or of events.

use super::events::{EventColumns, lives_of_events};
use super::lives::{Lifetimes, RopeLife, end_of, no_column};
use super::result::AgeUnit;
use crate::RecordError;
use sinew_files::csv::{Row, Table};
use sinew_files::date::DAY_S;
use sinew_files::{Bound, Budget, Fault, Fields as _};
use std::path::Path;

/// Reads the lifetimes of a CSV file: one row per rope with its age (`age_days`, `age_hours` or
/// `age_cycles`) and its end, or one row per event with its date.
///
/// # Errors
/// Returns a [`RecordError`] with file, line and remedy.
pub fn read_lives(path: &Path, columns: &EventColumns) -> Result<Lifetimes, RecordError> {
    let table = Table::read(path, &Budget::TABLE)?;
    let ages = [
        ("age_days", AgeUnit::Seconds, DAY_S),
        ("age_hours", AgeUnit::Seconds, 3600.0),
        ("age_cycles", AgeUnit::Cycles, 1.0),
    ];
    let named = [
        (&columns.group, "--group must name an existing column"),
        (
            &columns.monitored,
            "--monitored must name an existing column",
        ),
    ];
    for (column, reason) in named {
        if let (Some(name), Some(row)) = (column, table.rows().next())
            && table.column(name).is_none()
        {
            return Err(no_column(&row, name, reason));
        }
    }
    let aged = ages
        .into_iter()
        .find(|(name, ..)| table.column(name).is_some());
    if let (Some((name, ..)), Some(row)) = (aged, table.rows().next())
        && (columns.until_utc_s.is_some() || columns.monitored.is_some())
    {
        let problem = format!(
            "a table with '{name}' contains the age of every rope; --until and --monitored apply to events only"
        );
        return Err(row.here(Fault::Contradiction, problem).into());
    }
    let lives = match aged {
        Some((column, age_unit, factor)) => Lifetimes {
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

/// Lifetime from a row of a table of ages.
fn aged_rope(
    row: &Row<'_>,
    columns: &EventColumns,
    column: &'static str,
    factor: f64,
) -> Result<RopeLife, RecordError> {
    let age = row.need(
        column,
        Bound::Positive,
        "every rope needs an age; remove the row",
    )?;
    let end = row.need_text("end")?;
    Ok(RopeLife {
        unit: columns.unit_of(row).unwrap_or_default(),
        group: columns.group_of(row),
        age: factor * age,
        end: end_of(end)
            .ok_or_else(|| row.invalid("end", "broken, replaced, retired or running"))?,
    })
}
