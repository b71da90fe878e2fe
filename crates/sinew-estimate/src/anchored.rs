//! Measurements at end stops and index marks, and the corrections of offsets derived from them.

use serde::{Deserialize, Serialize};
use sinew_model::Gaussian;
use sinew_model::transmission::AnchorKind;

/// Measurement at one reference (end stop or index mark) in one recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ReferenceMeasurement {
    /// Name of the joint.
    pub joint: String,
    /// Kind of the reference.
    pub kind: AnchorKind,
    /// Position of the reference, rad (m for a prismatic joint).
    pub position_rad: f64,
    /// Time of the contact since the start of the recording, s.
    pub time_s: f64,
    /// Error of the encoder that measures the reference, rad: the joint encoder at a stop or joint mark, the motor
    /// encoder at a motor mark.
    pub encoder_error_rad: Gaussian,
    /// Offset of the tendon from the push alone, rad; none without a push or without motor torque.
    pub offset_rad: Option<Gaussian>,
}

/// Correction of one tendon's estimate by references.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ReferenceOffset {
    /// Measurements at references, in order of time.
    pub readings: Vec<ReferenceMeasurement>,
    /// Whether the baseline contains the same references, so that the following values are differences.
    pub since_baseline: bool,
    /// Error of the encoders by which the offset has been corrected, rad.
    pub correction_rad: Gaussian,
    /// Offset from motion alone, rad.
    pub by_motion_rad: Gaussian,
    /// Offset from pushes alone, rad; none without a push.
    pub by_push_rad: Option<Gaussian>,
}

impl ReferenceMeasurement {
    /// Whether both measurements belong to the same reference.
    pub(crate) fn is_of(&self, other: &Self) -> bool {
        self.joint == other.joint
            && self.kind == other.kind
            && self.position_rad == other.position_rad
    }
}

/// Adds the measurements of an earlier part of the same recording at references that this part did not touch.
pub(crate) fn keep(readings: &mut Vec<ReferenceMeasurement>, before: &[ReferenceMeasurement]) {
    for r in before {
        if !readings.iter().any(|own| own.is_of(r)) {
            readings.push(r.clone());
        }
    }
}
