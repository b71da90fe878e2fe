//! Location of the table in a file: names and values above, header, units, rows.

use super::cells::{Cell, Table};
use super::names::{quantity_of, split};
use super::quantity::{TestQuantity, parse_unit};
use sinew_files::csv::is_comment;
use sinew_files::unit::bare;

/// Maximum number of rows above the first row of numbers.
const HEAD_ROWS: usize = 200;

/// Cells that only mark a comment.
const MARKS: [&str; 3] = ["#", "%", "//"];

/// Head of a table.
#[derive(Debug, Default)]
pub(super) struct Head {
    pub(super) headers: Vec<String>,
    /// Line of units under the header; empty if there is none.
    pub(super) units: Vec<String>,
    /// Whether the first cell of each column is a clock time or a date, which has units of its own.
    pub(super) clocks: Vec<bool>,
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
    // A comment names the columns only where no other row does.
    let solid = |row: &[Cell]| !is_remark(row) && !row.iter().all(|c| matches!(c, Cell::Empty));
    let header = find_names(table, solid)
        .or_else(|| find_names(table, |_| true))
        .ok_or_else(|| {
            format!(
                "no header found in the first {HEAD_ROWS} rows: expected a row of column names followed by a row with numbers, for example time_s,force_N,elongation_mm"
            )
        })?;
    head.headers = table.rows[header].iter().map(Cell::text).collect();
    if let Some(first) = head.headers.first_mut() {
        *first = unmarked(first).to_owned();
    }
    head.first_row = header + 1;
    if let Some(next) = table.rows.get(header + 1)
        && is_units(next, head.headers.len())
        && !holds_numbers(next, head.headers.len())
    {
        head.units = next
            .iter()
            .map(|cell| bare(&cell.text()).to_owned())
            .collect();
        head.first_row += 1;
    }
    let is_clock = |column: usize| {
        let rows = table.rows[head.first_row..].iter();
        let first = rows
            .filter(|row| !is_remark(row))
            .find_map(|row| row.get(column).filter(|c| !matches!(c, Cell::Empty)));
        first.is_some_and(Cell::is_clock)
    };
    head.clocks = (0..head.headers.len()).map(is_clock).collect();
    for row in &table.rows[..header] {
        let mut cells = row
            .iter()
            .filter(|cell| !matches!(cell, Cell::Empty) && !MARKS.contains(&cell.text().as_str()));
        let (Some(name), Some(value)) = (cells.next(), cells.next()) else {
            continue;
        };
        let name = name.text();
        let name = unmarked(&name).trim_end_matches(':');
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

/// Index of the first of these rows that names columns above numbers, or above units and numbers.
fn find_names(table: &Table, is_wanted: impl Fn(&[Cell]) -> bool) -> Option<usize> {
    let rows = table.rows.iter().enumerate().take(HEAD_ROWS);
    let rows: Vec<(usize, &[Cell])> = rows
        .map(|(index, row)| (index, row.as_slice()))
        .filter(|(_, row)| is_wanted(row))
        .collect();
    let row = |index: usize| rows.get(index).map_or(&[][..], |(_, row)| row);
    let found = (0..rows.len()).find(|&index| {
        let (names, next, after) = (row(index), row(index + 1), row(index + 2));
        is_names(names)
            && (holds_numbers(next, names.len())
                || (is_units(next, names.len()) && holds_numbers(after, names.len())))
    });
    found.map(|index| rows[index].0)
}

/// Whether a row is a comment.
pub(super) fn is_remark(row: &[Cell]) -> bool {
    let first = row.first().map(Cell::text).unwrap_or_default();
    is_comment(first.as_bytes()) || first.starts_with(';')
}

/// Name without the mark of a comment before it.
fn unmarked(name: &str) -> &str {
    name.trim_start_matches(['#', '%', '/', ';']).trim()
}

/// Whether a row has at least two names and no number.
fn is_names(row: &[Cell]) -> bool {
    row.iter().filter(|cell| cell.is_text()).count() >= 2
        && !row.iter().any(Cell::is_number)
        && !row.iter().any(Cell::is_clock)
        && row
            .first()
            .is_none_or(|cell| !MARKS.contains(&cell.text().as_str()))
}

fn holds_numbers(row: &[Cell], columns: usize) -> bool {
    let is_value = |cell: &&Cell| cell.is_number() || cell.is_clock();
    row.len() >= columns.min(2) && row.iter().filter(is_value).count() >= 2
}

/// Whether a row contains units: text that names units, gaps and dashes.
fn is_units(row: &[Cell], columns: usize) -> bool {
    row.len() <= columns
        && row.iter().any(Cell::is_text)
        && row.iter().all(|cell| {
            let text = cell.text();
            bare(&text).is_empty() || parse_unit(bare(&text)).is_ok()
        })
}
