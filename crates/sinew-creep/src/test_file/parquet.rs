//! Parquet file as cells: names in the first row.

use ::parquet::errors::ParquetError;
use ::parquet::file::reader::{FileReader, SerializedFileReader};
use ::parquet::record::Field;
use bytes::Bytes;

use sinew_files::csv::Dialect;
use sinew_files::parquet::BoundedParquet;
use sinew_files::{Budget, ProcessorTime};

use super::cells::{Cell, Room, Table};
use crate::error::TestFileError;

pub(super) fn read(bytes: Vec<u8>, file: &str) -> Result<Table, TestFileError> {
    // The library's decoders may panic on damaged pages.
    std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| cells(bytes, file)))
        .map_err(|_| TestFileError::invalid(file, "its pages are damaged"))?
}

fn cells(bytes: Vec<u8>, file: &str) -> Result<Table, TestFileError> {
    let invalid = |error: ParquetError| {
        TestFileError::invalid(file, format!("not readable as Parquet: {error}"))
    };
    let mut time = ProcessorTime::new(&Budget::TABLE, bytes.len() as u64);
    let bounded = BoundedParquet::new(Bytes::from(bytes), &Budget::TABLE);
    let reader = SerializedFileReader::new(bounded).map_err(invalid)?;
    let mut room = Room::new(file);
    let names: Vec<Cell> = reader
        .metadata()
        .file_metadata()
        .schema()
        .get_fields()
        .iter()
        .map(|field| Cell::Text(field.name().to_owned()))
        .collect();
    let mut table = Table {
        rows: vec![names],
        places: vec![0],
        ..Table::default()
    };
    let mut rows = reader.get_row_iter(None).map_err(invalid)?;
    for place in 1.. {
        let row = time.spend(|| rows.next());
        let Some(row) = row.map_err(|reason| TestFileError::invalid(file, reason))? else {
            break;
        };
        room.take_row()?;
        room.take(table.rows[0].len())?;
        let row = row.map_err(invalid)?;
        for (_, field) in row.get_column_iter() {
            if let Field::Str(text) = field {
                room.take_text(text)?;
            }
        }
        let cells = row.get_column_iter().map(|(_, field)| cell(field));
        table.rows.push(cells.collect());
        table.places.push(place);
    }
    Ok(table)
}

fn cell(field: &Field) -> Cell {
    match field {
        Field::Null => Cell::Empty,
        Field::Byte(value) => Cell::Number(f64::from(*value)),
        Field::Short(value) => Cell::Number(f64::from(*value)),
        Field::Int(value) => Cell::Number(f64::from(*value)),
        Field::Long(value) => Cell::Number(*value as f64),
        Field::UByte(value) => Cell::Number(f64::from(*value)),
        Field::UShort(value) => Cell::Number(f64::from(*value)),
        Field::UInt(value) => Cell::Number(f64::from(*value)),
        Field::ULong(value) => Cell::Number(*value as f64),
        Field::Float(value) => Cell::Number(f64::from(*value)),
        Field::Double(value) => Cell::Number(*value),
        Field::TimestampMillis(value) => Cell::Clock(*value as f64 * 1e-3),
        Field::TimestampMicros(value) => Cell::Clock(*value as f64 * 1e-6),
        Field::TimeMillis(value) => Cell::Clock(f64::from(*value) * 1e-3),
        Field::TimeMicros(value) => Cell::Clock(*value as f64 * 1e-6),
        Field::Str(text) => Cell::Text(text.clone()),
        // Decimals and short floats come as text that is a number.
        other => Cell::of_text(&other.to_string(), Dialect::of_header(b"")),
    }
}
