//! Role of a column: its quantity, unit and specimen.

use super::quantity::TestQuantity;
use sinew_files::unit::Unit;

/// Column with its quantity and unit.
#[derive(Debug, Clone)]
pub(super) struct Role {
    pub(super) quantity: TestQuantity,
    pub(super) index: usize,
    pub(super) unit: Unit,
    pub(super) unit_name: String,
    /// Specimen of the column; `None` if the table has one specimen, or all share the column.
    pub(super) label: Option<String>,
}
