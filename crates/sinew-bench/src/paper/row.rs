//! Row of the table: one robot with one correction.

use serde::Serialize;
use sinew_model::Gaussian;
use sinew_sim::control::{ContactScore, Sensitivity};

/// True robot of a row. All but the first have stretched ropes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum RobotCase {
    /// Robot as described, with new ropes.
    NewRopes,
    /// Robot as described except for its ropes.
    Stretched,
    /// Stiffness 20 % below the described one.
    Softer,
    /// Stiffness 20 % above the described one.
    Stiffer,
    /// Masses 10 % below the described ones.
    Lighter,
    /// Masses 10 % above the described ones.
    Heavier,
    /// Friction of the drive.
    DriveFriction,
}

impl RobotCase {
    /// Returns the name used in the table.
    pub fn name(self) -> &'static str {
        match self {
            Self::NewRopes => "new ropes",
            Self::Stretched => "stretched",
            Self::Softer => "K −20 %",
            Self::Stiffer => "K +20 %",
            Self::Lighter => "M −10 %",
            Self::Heavier => "M +10 %",
            Self::DriveFriction => "friction",
        }
    }

    /// True stiffness over the described one.
    pub(super) fn stiffness_factor(self) -> f64 {
        match self {
            Self::Softer => 0.8,
            Self::Stiffer => 1.2,
            _ => 1.0,
        }
    }

    /// True masses over the described ones.
    pub(super) fn mass_factor(self) -> f64 {
        match self {
            Self::Lighter => 0.9,
            Self::Heavier => 1.1,
            _ => 1.0,
        }
    }
}

/// Correction available to controller and detector.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Knowledge {
    /// No correction of the offset.
    Nothing,
    /// The true offset.
    True,
    /// The true offset, and the dynamic set-point.
    TrueAndDynamics,
    /// The offset as estimated.
    Estimate,
    /// The offset and the stiffness as estimated.
    EstimateAndStiffness,
    /// Correction as `Estimate`, and the detector has the tolerances of stiffness and masses.
    EstimateAndTolerances,
}

impl Knowledge {
    /// Returns the name used in the table.
    pub fn name(self) -> &'static str {
        match self {
            Self::Nothing => "nothing",
            Self::True => "true",
            Self::TrueAndDynamics => "dynamic",
            Self::Estimate => "estimate",
            Self::EstimateAndStiffness => "+ stiffness",
            Self::EstimateAndTolerances => "+ tolerance",
        }
    }
}

/// One robot with one correction, over all sessions.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Row {
    /// True robot of the row.
    pub robot: RobotCase,
    /// Correction available to controller and detector.
    pub knowledge: Knowledge,
    /// Shoulder pitch and elbow.
    pub joints: [RowJoint; 2],
    /// Contacts of all sessions together.
    pub contacts: ContactScore,
    /// Share of the contacts missed, lowest and highest session.
    pub missed_share: Range,
    /// Share of the time without contact with a false alarm, lowest and highest session.
    pub false_share: Range,
    /// Contacts of all sessions with other thresholds.
    pub sensitivities: Vec<Sensitivity>,
}

/// Joint of a [`Row`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RowJoint {
    /// RMS of `q − q_d` at rest, rad: mean and standard deviation over the sessions.
    pub rest_rad: Gaussian,
    /// RMS of `q − q_d` over the whole session, rad; mean and standard deviation over the sessions.
    pub overall_rad: Gaussian,
    /// Mean estimated external torque without contact, N·m.
    pub false_torque_nm: f64,
    /// Mean threshold, N·m.
    pub threshold_nm: f64,
}

/// Lowest and highest of several values.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Range {
    /// Lowest; null where no session had a value.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub lowest: f64,
    /// Highest; null where no session had a value.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub highest: f64,
}

impl Row {
    /// Mean RMS at rest of shoulder pitch (0) or elbow (1), mrad.
    pub(super) fn rest_mrad(&self, slot: usize) -> f64 {
        1e3 * self.joints[slot].rest_rad.mean
    }

    /// Mean of the RMS error over the whole session, mrad.
    pub(super) fn overall_mrad(&self, slot: usize) -> f64 {
        1e3 * self.joints[slot].overall_rad.mean
    }

    /// Share of the time without contact with a false alarm, %.
    pub(super) fn false_percent(&self) -> f64 {
        100.0 * self.contacts.false_share()
    }

    /// Share of the contacts missed, %.
    pub(super) fn missed_percent(&self) -> f64 {
        100.0 * self.contacts.missed_share()
    }

    /// Median delay of the alarms, ms.
    pub(super) fn delay_median_ms(&self) -> f64 {
        1e3 * self.contacts.delay_median_s()
    }
}
