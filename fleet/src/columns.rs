//! What the columns of records hold.

use datafusion::arrow::compute::can_cast_types;
use datafusion::arrow::datatypes::{DataType, Schema};
use sinew_log::CellKind;
use sinew_watch_core::table::{COLUMNS, kind};

/// What a column of `sinew-record/1` holds.
pub(crate) fn data_type(column: &str) -> DataType {
    match kind(column) {
        CellKind::Number => DataType::Float64,
        CellKind::Integer => DataType::Int64,
        CellKind::Text => DataType::Utf8,
        CellKind::Flag => DataType::Boolean,
    }
}

/// Says which column of a file can't be what it is called.
pub(crate) fn check_types(schema: &Schema) -> Result<(), String> {
    for field in schema.fields() {
        let name = field.name();
        let (found, wanted) = (field.data_type(), data_type(name));
        if COLUMNS.contains(&name.as_str()) && !can_cast_types(found, &wanted) {
            return Err(format!("'{name}' is {found}, not {wanted}"));
        }
    }
    Ok(())
}
