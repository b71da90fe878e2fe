//! Column types of record files.

use datafusion::arrow::compute::can_cast_types;
use datafusion::arrow::datatypes::{DataType, Schema};
use sinew_log::CellKind;
use sinew_watch_core::table::{COLUMNS, kind};

/// Names of columns in version 1 of the schema and their present names.
///
/// Present names are those of [`COLUMNS`]; the old ones still occur in stored files.
const VERSION_1: [(&str, &str); 5] = [
    ("offset_deviation_rad", "offset_std_rad"),
    ("elongation_deviation_m", "elongation_std_m"),
    ("strain_deviation_ratio", "strain_std_ratio"),
    ("stiffness_deviation_ratio", "stiffness_std_ratio"),
    ("in_doubt", "provisional"),
];

/// Returns the present name of a column; other columns keep their name.
pub(crate) fn present_name(column: &str) -> &str {
    let renamed = VERSION_1.iter().find(|(old, _)| *old == column);
    renamed.map_or(column, |(_, present)| *present)
}

/// Returns the name of a column in version 1 of the schema, if it was renamed since.
pub(crate) fn version_1_name(column: &str) -> Option<&'static str> {
    let renamed = VERSION_1.iter().find(|(_, present)| *present == column);
    renamed.map(|(old, _)| *old)
}

/// Returns the type of a column of `sinew-record/2`.
pub(crate) fn data_type(column: &str) -> DataType {
    match kind(column) {
        CellKind::Number => DataType::Float64,
        CellKind::Integer => DataType::Int64,
        CellKind::Text => DataType::Utf8,
        CellKind::Flag => DataType::Boolean,
    }
}

/// Checks that the columns of a file have compatible types.
///
/// # Errors
///
/// Names the first column with an incompatible type.
pub(crate) fn check_types(schema: &Schema) -> Result<(), String> {
    for field in schema.fields() {
        let name = field.name();
        let present = present_name(name);
        let (found, wanted) = (field.data_type(), data_type(present));
        if COLUMNS.contains(&present) && !can_cast_types(found, &wanted) {
            return Err(format!("'{name}' is {found}, expected {wanted}"));
        }
    }
    Ok(())
}
