//! Delimited text as cells.

use super::cells::{Cell, Table};
use crate::error::LogError;
use crate::table::parse_cell;

/// Lines looked at to find the delimiter.
const LOOK_LINES: usize = 40;

pub(super) fn read(bytes: &[u8], file: &str) -> Result<Vec<Table>, LogError> {
    let mut table = Table::default();
    let text = decode(bytes, file, &mut table.notes)?;
    let delimiter = delimiter_of(&text);
    let comma_is_decimal = delimiter != b',';
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(delimiter)
        .flexible(true)
        .has_headers(false)
        .from_reader(text.as_bytes());
    for record in reader.records() {
        let record = record.map_err(|error| LogError::NotARecording {
            file: file.to_owned(),
            reason: format!("it is not delimited text: {error}"),
        })?;
        let line = record.position().map_or(0, csv::Position::line);
        let row: Vec<Cell> = record
            .iter()
            .map(|cell| match parse_cell(cell.as_bytes(), comma_is_decimal) {
                _ if cell.trim().is_empty() => Cell::Empty,
                Some(value) => Cell::Number(value),
                None => Cell::Text(cell.trim().to_owned()),
            })
            .collect();
        table.rows.push(row);
        table.places.push(line);
    }
    Ok(vec![table])
}

/// Text of the file; instruments write UTF-8, UTF-16 with a mark, or Windows code page 1252.
fn decode(bytes: &[u8], file: &str, notes: &mut Vec<String>) -> Result<String, LogError> {
    let utf16 = |bytes: &[u8], unit: fn([u8; 2]) -> u16| {
        let units: Vec<u16> = bytes
            .chunks_exact(2)
            .map(|pair| unit([pair[0], pair[1]]))
            .collect();
        String::from_utf16_lossy(&units)
    };
    if let Some(rest) = bytes.strip_prefix(b"\xff\xfe") {
        return Ok(utf16(rest, u16::from_le_bytes));
    }
    if let Some(rest) = bytes.strip_prefix(b"\xfe\xff") {
        return Ok(utf16(rest, u16::from_be_bytes));
    }
    if bytes.contains(&0) {
        return Err(LogError::NotARecording {
            file: file.to_owned(),
            reason: "it holds zero bytes, so it is not text; CSV, XLSX and Parquet are read"
                .to_owned(),
        });
    }
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    match std::str::from_utf8(bytes) {
        Ok(text) => Ok(text.to_owned()),
        Err(_) => {
            notes.push("not UTF-8: read as code page 1252 (Latin)".to_owned());
            Ok(bytes.iter().map(|byte| char::from(*byte)).collect())
        }
    }
}

/// The delimiter that splits the most of the first lines into the same number of cells.
fn delimiter_of(text: &str) -> u8 {
    let mut best = (b',', 0);
    for delimiter in [b'\t', b';', b','] {
        let mut counts: Vec<usize> = text
            .lines()
            .filter(|line| !line.trim().is_empty())
            .take(LOOK_LINES)
            .map(|line| {
                let mut quoted = false;
                line.bytes()
                    .filter(|byte| {
                        quoted ^= *byte == b'"';
                        *byte == delimiter && !quoted
                    })
                    .count()
            })
            .collect();
        counts.sort_unstable();
        // The median: names and values above the header have fewer delimiters. A tab or a
        // semicolon wins a draw, because the comma may then be the decimal sign.
        let median = counts.get(counts.len() / 2).copied().unwrap_or(0);
        if median > best.1 && (best.1 == 0 || delimiter != b',') {
            best = (delimiter, median);
        }
    }
    best.0
}
