//! Workbooks as cells.

use std::io::Cursor;

use calamine::{Data, Reader, Xlsx, open_workbook_from_rs};

use sinew_files::csv::Dialect;

use super::cells::{Cell, Table};
use crate::error::LogError;
use sinew_files::names::list;

/// Seconds of a day: workbooks keep times as days.
const DAY_S: f64 = 86_400.0;

pub(super) fn read(
    bytes: Vec<u8>,
    file: &str,
    sheet: Option<&str>,
) -> Result<Vec<Table>, LogError> {
    let refuse = |reason: String| LogError::refused(file, reason);
    // The library decodes foreign bytes; a panic in it must not end the program.
    let tables = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
        let mut book: Xlsx<_> = open_workbook_from_rs(Cursor::new(bytes))
            .map_err(|error| refuse(format!("not a workbook: {error}")))?;
        let names = book.sheet_names();
        let wanted: Vec<String> = match sheet {
            None => names,
            Some(sheet) if names.iter().any(|name| name == sheet) => vec![sheet.to_owned()],
            Some(sheet) => {
                return Err(LogError::request(
                    file,
                    format!("no sheet '{sheet}'; sheets are {}", list(&names)),
                ));
            }
        };
        let mut tables = Vec::new();
        for title in wanted {
            let range = book
                .worksheet_range(&title)
                .map_err(|error| refuse(format!("sheet '{title}': {error}")))?;
            let first = range.start().map_or(0, |start| u64::from(start.0)) + 1;
            let mut table = Table {
                title,
                ..Table::default()
            };
            for (index, row) in range.rows().enumerate() {
                table.rows.push(row.iter().map(cell).collect());
                table.places.push(first + index as u64);
            }
            if !table.rows.is_empty() {
                tables.push(table);
            }
        }
        Ok(tables)
    }))
    .map_err(|_| refuse("its workbook is damaged".to_owned()))??;
    Ok(tables)
}

fn cell(data: &Data) -> Cell {
    match data {
        Data::Empty => Cell::Empty,
        Data::Int(value) => Cell::Number(*value as f64),
        Data::Float(value) => Cell::Number(*value),
        Data::DateTime(time) => Cell::Clock(time.as_f64() * DAY_S),
        Data::Error(_) => Cell::Number(f64::NAN),
        // Also a number typed into a text cell, with a decimal comma.
        Data::String(text) => Cell::of_text(text, Dialect::of_header(b";")),
        other => Cell::Text(other.to_string()),
    }
}
