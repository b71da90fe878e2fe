//! Location of the table in a file: names and values above, header, units, rows.

use super::cells::{Cell, Table};
use super::columns::{quantity_of, split};
use super::quantity::{TestQuantity, parse_unit};

/// Maximum number of rows above the first row of numbers.
const HEAD_ROWS: usize = 200;

/// Head of a table.
#[derive(Debug, Default)]
pub(super) struct Head {
    pub(super) headers: Vec<String>,
    /// Line of units under the header; empty if there is none.
    pub(super) units: Vec<String>,
    /// Index of the first row of values.
    pub(super) first_row: usize,
    /// Names and values above the header.
    pub(super) words: Vec<(String, String)>,
    /// Quantities above the header, in their internal units.
    pub(super) constants: Vec<(TestQuantity, f64)>,
}

/// Finds the header; the error describes the expected format.
pub(super) fn find(table: &Table) -> Result<Head, String> {
    let mut head = Head::default();
    let header = table
        .rows
        .iter()
        .take(HEAD_ROWS)
        .enumerate()
        .position(|(index, row)| {
            is_names(row) && {
                let next = table.rows.get(index + 1).map_or(&[][..], Vec::as_slice);
                let after = table.rows.get(index + 2).map_or(&[][..], Vec::as_slice);
                holds_numbers(next, row.len())
                    || (is_units(next, row.len()) && holds_numbers(after, row.len()))
            }
        })
        .ok_or_else(|| {
            format!(
                "no header found in the first {HEAD_ROWS} rows: expected a row of column names followed by a row with numbers, for example time_s,force_N,elongation_mm"
            )
        })?;
    head.headers = table.rows[header].iter().map(Cell::text).collect();
    head.first_row = header + 1;
    if let Some(next) = table.rows.get(header + 1)
        && is_units(next, head.headers.len())
        && !holds_numbers(next, head.headers.len())
    {
        head.units = next.iter().map(Cell::text).collect();
        head.first_row += 1;
    }
    for row in &table.rows[..header] {
        let mut cells = row
            .iter()
            .filter(|cell| !matches!(cell, Cell::Empty) && cell.text() != "#");
        let (Some(name), Some(value)) = (cells.next(), cells.next()) else {
            continue;
        };
        let name = name.text();
        let name = name.trim_start_matches('#').trim().trim_end_matches(':');
        let (bare, mut unit) = split(name);
        if unit.is_none() {
            unit = cells.next().map(Cell::text);
        }
        if let (Cell::Number(raw), Some(unit)) = (value, &unit)
            && let Some(quantity) = quantity_of(&bare, Some(unit))
            && let Ok(unit) = parse_unit(unit)
            && quantity.may_be_in(unit)
        {
            head.constants
                .push((quantity, quantity.convert(unit, *raw)));
        }
        head.words.push((name.to_owned(), value.text()));
    }
    Ok(head)
}

/// Whether a row has at least two names and no number.
fn is_names(row: &[Cell]) -> bool {
    row.iter().filter(|cell| cell.is_text()).count() >= 2
        && !row.iter().any(Cell::is_number)
        && row.first().is_none_or(|cell| cell.text() != "#")
}

fn holds_numbers(row: &[Cell], columns: usize) -> bool {
    row.len() >= columns.min(2) && row.iter().filter(|cell| cell.is_number()).count() >= 2
}

/// Whether a row contains units: text that names units, gaps and dashes.
fn is_units(row: &[Cell], columns: usize) -> bool {
    row.len() <= columns
        && row.iter().any(Cell::is_text)
        && row.iter().all(|cell| {
            let text = cell.text();
            let text = text.trim_matches(['[', ']', '(', ')']);
            text.is_empty() || parse_unit(text).is_ok()
        })
}
