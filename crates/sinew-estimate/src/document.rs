//! What commands print as JSON.

use crate::replay::Estimate;
use crate::session::SessionEstimate;
use serde::{Deserialize, Serialize};
use sinew_files::JsonDocument;

/// Which estimate answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Absolute offsets, all joints together, with an interval that holds what is unknown.
    #[default]
    Absolute,
    /// The paper's: a reading of each joint, right in differences between like recordings.
    Paper,
}

/// The estimate of one recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EstimateDocument {
    /// Which estimate answers.
    pub method: Method,
    /// The answer of the absolute method, with verdicts.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub session: Option<SessionEstimate>,
    /// What the paper's equation reads of the same frames. It takes stiffness, masses, payload and
    /// contact as known, so it is no verdict.
    pub reading: Estimate,
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
