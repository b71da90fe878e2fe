//! Workbook sheets as cells.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::io::{BufRead as _, BufReader, Cursor};

use calamine::{Data, Reader, Xlsx, XlsxError, open_workbook_from_rs};

use sinew_files::csv::Dialect;

use super::cells::{Cell, Room, Table};
use crate::error::TestFileError;
use sinew_files::names::list;
use sinew_files::{Budget, ProcessorTime};

/// Number of seconds of a day: workbooks store times as days.
const DAY_S: f64 = 86_400.0;

pub(super) fn read(
    bytes: Vec<u8>,
    file: &str,
    sheet: Option<&str>,
) -> Result<Vec<Table>, TestFileError> {
    let invalid = |reason: String| TestFileError::invalid(file, reason);
    // The library decodes foreign bytes; a panic in it must not end the program.
    std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
        check_parts(&bytes, file)?;
        let mut room = Room::new(file);
        let mut book: Xlsx<_> = open_workbook_from_rs(Cursor::new(bytes))
            .map_err(|error| invalid(format!("not a workbook: {error}")))?;
        let names = book.sheet_names();
        let wanted: Vec<String> = match sheet {
            None => names,
            Some(sheet) if names.iter().any(|name| name == sheet) => vec![sheet.to_owned()],
            Some(sheet) => {
                return Err(TestFileError::Request {
                    file: file.to_owned(),
                    reason: format!("sheet '{sheet}' not found; sheets are {}", list(&names)),
                });
            }
        };
        let mut tables = Vec::new();
        for title in wanted {
            let damaged = |error: XlsxError| invalid(format!("sheet '{title}': {error}"));
            let mut reader = book.worksheet_cells_reader(&title).map_err(damaged)?;
            // Only existing rows and columns: a single remote cell costs its row only.
            let mut rows: BTreeMap<u32, Vec<Cell>> = BTreeMap::new();
            let mut first_column = usize::MAX;
            while let Some(found) = reader.next_cell().map_err(damaged)? {
                let (row, column) = found.get_position();
                let data = Data::from(found.get_value().clone());
                if data == Data::Empty {
                    continue;
                }
                let column = column as usize;
                first_column = first_column.min(column);
                let row = match rows.entry(row) {
                    Entry::Occupied(row) => row.into_mut(),
                    Entry::Vacant(place) => {
                        room.take_row()?;
                        place.insert(Vec::new())
                    }
                };
                if column >= row.len() {
                    room.take(column + 1 - row.len())?;
                    row.resize(column + 1, Cell::Empty);
                }
                row[column] = cell(&data);
                if let Cell::Text(text) = &row[column] {
                    room.take_text(text)?;
                }
            }
            let mut table = Table {
                title,
                ..Table::default()
            };
            for (place, mut row) in rows {
                row.drain(..first_column.min(row.len()));
                table.rows.push(row);
                table.places.push(u64::from(place) + 1);
            }
            if !table.rows.is_empty() {
                tables.push(table);
            }
        }
        Ok(tables)
    }))
    .map_err(|_| invalid("its workbook is damaged".to_owned()))?
}

/// Decompresses every part once, piece by piece, and rejects parts that exceed the memory limits.
fn check_parts(bytes: &[u8], file: &str) -> Result<(), TestFileError> {
    const PIECE_BYTES: usize = 1 << 16;
    let invalid = |reason: String| TestFileError::invalid(file, reason);
    let damaged = |error: &dyn std::fmt::Display| invalid(format!("not a workbook: {error}"));
    let mut parts = zip::ZipArchive::new(Cursor::new(bytes)).map_err(|e| damaged(&e))?;
    let [mut sheets, mut others] = [0_u64; 2];
    let mut elements = Room::new(file);
    let mut time = ProcessorTime::new(&Budget::TABLE, bytes.len() as u64);
    for index in 0..parts.len() {
        let part = parts.by_index(index).map_err(|e| damaged(&e))?;
        let name = part.name().map_err(|e| damaged(&e))?.to_ascii_lowercase();
        // Sheets are read in parts later; texts and styles are kept, each element at least as large as a cell.
        let is_kept = !name.starts_with("xl/worksheets/");
        let (unpacked, limit) = match is_kept {
            true => (&mut others, Budget::TABLE.memory),
            false => (&mut sheets, Budget::TABLE.unpacked),
        };
        let is_xml = name.ends_with(".xml");
        let mut part = BufReader::with_capacity(PIECE_BYTES, time.reader(part));
        // Number of bytes since the last bracket: a text or an element, which the reader stores as
        // a whole.
        let mut text = 0_u64;
        loop {
            let piece = part.fill_buf().map_err(|e| damaged(&e))?;
            if piece.is_empty() {
                break;
            }
            for span in piece.split_inclusive(|byte| *byte == b'<') {
                text += span.len() as u64;
                if is_xml {
                    Budget::TABLE.text.check(text).map_err(invalid)?;
                }
                if span.ends_with(b"<") {
                    text = 0;
                    elements.take(usize::from(is_kept))?;
                }
            }
            let length = piece.len();
            *unpacked += length as u64;
            limit.check(*unpacked).map_err(invalid)?;
            part.consume(length);
        }
    }
    Ok(())
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
