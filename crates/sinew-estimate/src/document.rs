//! What commands print as JSON.

use crate::replay::{Estimate, JointRefusal};
use crate::session::{LimitState, SessionEstimate};
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

impl EstimateDocument {
    /// Whether part of the recording was lost.
    pub fn is_damaged(&self) -> bool {
        self.reading.damaged
    }

    /// Whether a tendon has no estimate because the position of its joint is not recorded.
    pub fn lacks_encoder(&self) -> bool {
        let mut joints = self.reading.joints.iter();
        joints.any(|joint| joint.refused == Some(JointRefusal::NoJointPosition))
    }

    /// Whether a tendon is past the elongation at which to tension again.
    pub fn passes_limit(&self) -> bool {
        let joints = self.session.iter().flat_map(|s| &s.joints);
        let mut limits = joints.filter_map(|j| j.retension);
        limits.any(|limit| limit.state == LimitState::Passed)
    }
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
