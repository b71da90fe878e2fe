//! Delimited text as cells.

use super::cells::{Cell, Room, Table};
use crate::error::LogError;
use sinew_files::csv::Dialect;
use sinew_files::text::{Encoding, decode};

pub(super) fn read(bytes: &[u8], file: &str) -> Result<Vec<Table>, LogError> {
    let mut table = Table::default();
    let (text, encoding) = decode(bytes, file)?;
    if encoding == Encoding::Cp1252 {
        let note = "not UTF-8: read as code page 1252 (Latin)";
        table.notes.push(note.to_owned());
    }
    let dialect = Dialect::of_lines(&text);
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(dialect.delimiter)
        .flexible(true)
        .has_headers(false)
        .from_reader(text.as_bytes());
    let mut room = Room::new(file);
    for record in reader.records() {
        let record = record.map_err(|error| {
            LogError::refused(file, format!("it is not delimited text: {error}"))
        })?;
        let line = record.position().map_or(0, csv::Position::line);
        room.take_row()?;
        room.take(record.len())?;
        let row = record.iter().map(|cell| Cell::of_text(cell, dialect));
        table.rows.push(row.collect());
        table.places.push(line);
    }
    Ok(vec![table])
}
