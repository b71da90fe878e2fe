//! JSON documents of the commands.

use crate::replay::{Estimate, JointError};
use crate::session::{LimitState, SessionEstimate, TendonEstimate, Verdict};
use serde::{Deserialize, Serialize};
use sinew_files::JsonDocument;

/// Method of an estimate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Absolute offsets of all joints, estimated jointly, with intervals that include the uncertainty of the nuisance
    /// parameters.
    #[default]
    Absolute,
    /// Method of the paper: an uncorrected estimate per joint, valid for differences of comparable recordings.
    Paper,
}

/// The estimate of one recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EstimateDocument {
    /// Estimation method of the result.
    pub method: Method,
    /// Result of the absolute method, with verdicts.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub session: Option<SessionEstimate>,
    /// Uncorrected estimate by the equation of the paper from the same frames. The method assumes exact stiffness and
    /// masses, no payload and no contact, so no verdict is derived from it.
    pub reading: Estimate,
}

impl JsonDocument for EstimateDocument {
    const SCHEMA: &'static str = "sinew/estimate/2";
}

impl EstimateDocument {
    /// Whether part of the recording was lost.
    pub fn is_damaged(&self) -> bool {
        self.reading.damaged
    }

    /// Whether a tendon has no estimate because the position of its joint is not recorded.
    pub fn lacks_encoder(&self) -> bool {
        let mut joints = self.reading.joints.iter();
        joints.any(|joint| joint.reason == Some(JointError::NoJointPosition))
    }

    /// Whether a tendon requires action: it transmits no torque, or exceeds the elongation at which it is to be
    /// re-tensioned.
    pub fn requires_action(&self) -> bool {
        let is_passed = |joint: &TendonEstimate| {
            (joint.retension).is_some_and(|limit| limit.state == LimitState::Passed)
        };
        let mut joints = self.session.iter().flat_map(|s| &s.joints);
        joints.any(|j| j.verdict == Verdict::TransmissionLost || is_passed(j))
    }
}

/// Result of a recording taken directly after tensioning, from which a baseline was estimated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BaselineDocument {
    /// Estimate of the recording; its offsets are zero by definition.
    #[serde(flatten)]
    pub learned: SessionEstimate,
}

impl JsonDocument for BaselineDocument {
    const SCHEMA: &'static str = "sinew/baseline/2";
}
