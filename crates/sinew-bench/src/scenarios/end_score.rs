//! One recording at the end of a session: which offsets are inside their intervals, and which are outside unsaid.

use serde::{Deserialize, Serialize};
use sinew_estimate::online::{OnlineJoint, Window};
use sinew_estimate::session::{SessionEstimate, TendonEstimate};
use sinew_model::Gaussian;
use sinew_model::robot::Robot;

/// Sessions to estimate, and the purpose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sessions {
    /// Session B only, with the baseline of session A.
    B,
    /// Sessions B and C, each assessed at its end; C uses the posterior of B as prior.
    Chain,
    /// Sessions B and C, and the detection of the slips of C with its delay.
    Slips,
}

impl Sessions {
    /// Selects sessions with or without C.
    pub fn with_slips(slips: bool) -> Self {
        if slips { Self::Slips } else { Self::B }
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::B => "b",
            Self::Chain => "chain",
            Self::Slips => "slips",
        }
    }
}

/// End at which offsets are assessed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum End {
    /// At the end of session B, estimated with A's baseline.
    B,
    /// End of session C, estimated with the posterior of B as prior.
    Chain,
}

/// Form of the estimator.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Form {
    /// The estimate of a whole recording.
    Batch,
    /// The estimate on a sliding window, with a check of the newest blocks. A provisional state counts as a warning.
    Online,
}

impl Form {
    pub(super) const ALL: [Self; 2] = [Self::Batch, Self::Online];
}

/// All elastic joints of one recording at one end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EndScore {
    /// End at which the offsets are assessed.
    pub end: End,
    /// Form of the estimator.
    pub form: Form,
    /// Estimate minus truth per elastic joint, with the reported standard deviation, rad.
    pub errors_rad: Vec<Gaussian>,
    /// Whether the result of that session has a warning or is provisional.
    pub is_warned: bool,
}

impl EndScore {
    pub(super) fn of(
        end: End,
        robot: &Robot,
        truth_rad: &[f64],
        estimate: &SessionEstimate,
    ) -> Self {
        let error = |joint: &TendonEstimate| {
            let truth_rad = truth_rad[robot.tendon_index(&joint.name)?];
            let offset = joint.offset_rad;
            Some(Gaussian::new(offset.mean - truth_rad, offset.std))
        };
        Self {
            end,
            form: Form::Batch,
            errors_rad: estimate.joints.iter().filter_map(error).collect(),
            is_warned: !estimate.warnings.is_empty(),
        }
    }

    /// Returns the score of the online estimate.
    pub(super) fn online(end: End, truth_rad: &[f64], window: &Window) -> Self {
        let answer = window.answer();
        let error = |own: &OnlineJoint| {
            let offset = own.offset_rad;
            Gaussian::new(offset.mean - truth_rad[own.joint], offset.std)
        };
        let warns = |estimate: &SessionEstimate| !estimate.warnings.is_empty();
        Self {
            end,
            form: Form::Online,
            errors_rad: answer.joints.iter().map(error).collect(),
            is_warned: answer.is_provisional() || window.estimate().is_none_or(warns),
        }
    }

    pub(super) fn outside(&self) -> usize {
        self.errors_rad.iter().filter(|e| e.is_nonzero_95()).count()
    }

    /// Returns the number of offsets outside their intervals without a warning.
    pub(super) fn silent(&self) -> usize {
        if self.is_warned { 0 } else { self.outside() }
    }

    /// Returns the number of offsets without a warning that are more than three standard deviations from the truth,
    /// or not finite.
    pub(super) fn far(&self) -> usize {
        const MAX_Z: f64 = 3.0;
        let is_near = |e: &&Gaussian| e.mean.abs() <= MAX_Z * e.std;
        match self.is_warned {
            true => 0,
            false => self.errors_rad.len() - self.errors_rad.iter().filter(is_near).count(),
        }
    }
}
