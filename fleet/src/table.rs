//! Formats the rows of a query for a terminal: numbers are right-aligned and never broken, and a table that is too
//! wide is printed as one block per row with one column per line.

use crate::FleetError;
use crate::engine::Answer;
use datafusion::arrow::array::{Array as _, ArrayRef, AsArray as _};
use datafusion::arrow::datatypes::{DataType, Float64Type};
use datafusion::arrow::util::display::{ArrayFormatter, FormatOptions};
use sinew_files::plain;
use sinew_report::text::WIDTH;

/// A cell as text; six digits of a number that has more.
pub(crate) fn cell(column: &ArrayRef, row: usize) -> Result<String, FleetError> {
    if column.is_null(row) {
        return Ok("–".into());
    }
    if column.data_type() == &DataType::Float64 {
        return Ok(six(column.as_primitive::<Float64Type>().value(row)));
    }
    let wrong = |e: datafusion::arrow::error::ArrowError| FleetError::Engine(e.to_string());
    let format = ArrayFormatter::try_new(column, &FormatOptions::default()).map_err(wrong)?;
    Ok(plain(&format.value(row).to_string()))
}

/// Six significant digits, without zeros at the end.
fn six(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return x.to_string();
    }
    let decimals = 5 - x.abs().log10().floor() as i32;
    match decimals {
        0..=9 => {
            let text = format!("{x:.*}", decimals as usize);
            match text.contains('.') {
                true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
                false => text,
            }
        }
        _ if x.abs() < 1e15 && decimals < 0 => format!("{x:.0}"),
        _ => format!("{x:.5e}"),
    }
}

/// Formats the first `most` rows; returns them with the total number of rows.
pub(crate) fn render(answer: &Answer, most: usize) -> Result<(String, usize), FleetError> {
    let fields = answer.schema.fields();
    let names: Vec<&str> = fields.iter().map(|f| f.name().as_str()).collect();
    let right: Vec<bool> = fields.iter().map(|f| f.data_type().is_numeric()).collect();
    let mut rows: Vec<Vec<String>> = Vec::new();
    let mut count = 0;
    for batch in &answer.batches {
        for row in 0..batch.num_rows().min(most.saturating_sub(count)) {
            let cells = batch.columns().iter().map(|column| cell(column, row));
            rows.push(cells.collect::<Result<_, _>>()?);
        }
        count += batch.num_rows();
    }
    Ok((lay_out(&names, &right, &rows), count))
}

fn lay_out(names: &[&str], right: &[bool], rows: &[Vec<String>]) -> String {
    let length = |text: &str| text.chars().count();
    let widths: Vec<usize> = (names.iter().enumerate())
        .map(|(i, name)| {
            let widest = rows.iter().map(|row| length(&row[i])).max();
            widest.unwrap_or(0).max(length(name))
        })
        .collect();
    let total = widths.iter().sum::<usize>() + 2 * widths.len().saturating_sub(1);
    if total > WIDTH {
        return below(names, rows);
    }
    let line = |cells: &[&str]| {
        let padded = cells.iter().enumerate().map(|(i, text)| match right[i] {
            true => format!("{text:>width$}", width = widths[i]),
            false => format!("{text:<width$}", width = widths[i]),
        });
        let line = padded.collect::<Vec<_>>().join("  ");
        format!("{}\n", line.trim_end())
    };
    let mut out = line(names);
    out += &format!("{}\n", "─".repeat(total));
    for row in rows {
        out += &line(&row.iter().map(String::as_str).collect::<Vec<_>>());
    }
    out
}

/// Formats one block per row with one column per line.
fn below(names: &[&str], rows: &[Vec<String>]) -> String {
    let widest = names.iter().map(|n| n.chars().count()).max().unwrap_or(0);
    let block = |row: &Vec<String>| {
        let lines = names.iter().zip(row);
        lines
            .map(|(name, text)| format!("{name:<widest$}  {text}\n"))
            .collect::<String>()
    };
    rows.iter().map(block).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn table_numbers_have_six_digits_right_aligned() {
        assert_eq!(six(0.1 + 0.2), "0.3");
        assert_eq!(six(-1234.5678), "-1234.57");
        assert_eq!(six(1_735_689_600.0), "1735689600");
        assert_eq!(six(1.23456789e-12), "1.23457e-12");
        let rows = [vec!["a".into(), "1".into()], vec!["b".into(), "10".into()]];
        let text = lay_out(&["x", "n"], &[false, true], &rows);
        assert_eq!(text, "x   n\n─────\na   1\nb  10\n");
    }

    #[test]
    fn table_wider_than_terminal_lists_columns() {
        let row = vec!["a".repeat(50), "b".repeat(50)];
        let text = lay_out(&["first", "second"], &[false, false], &[row]);
        assert_eq!(text.lines().count(), 2);
        assert!(text.starts_with("first   aaa"), "{text}");
    }
}
