//! What commands print as JSON.

use crate::replay::Estimate;
use crate::session::SessionEstimate;
use serde::{Deserialize, Serialize};
use sinew_files::JsonDocument;

/// The estimate of one recording, and the session's estimate where it was asked for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EstimateDocument {
    /// The paper's estimate.
    #[serde(flatten)]
    pub estimate: Estimate,
    /// Absolute offsets since the baseline.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub session: Option<SessionEstimate>,
}

impl JsonDocument for EstimateDocument {
    const SCHEMA: &'static str = "sinew/estimate/1";
}

/// What a recording right after tensioning taught.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BaselineDocument {
    /// The recording's own estimate, its offsets zero by definition.
    #[serde(flatten)]
    pub learned: SessionEstimate,
}

impl JsonDocument for BaselineDocument {
    const SCHEMA: &'static str = "sinew/baseline/1";
}
