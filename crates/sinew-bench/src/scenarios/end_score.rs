//! One recording at the end of a session: which offsets are inside their intervals, and which are outside unsaid.

use serde::{Deserialize, Serialize};
use sinew_estimate::online::{OnlineJoint, Window};
use sinew_estimate::session::{SessionEstimate, TendonEstimate};
use sinew_model::Gaussian;
use sinew_model::robot::Robot;

/// Which sessions are estimated, and what for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sessions {
    /// B alone, with A's baseline.
    B,
    /// B, then C with what was known after B, each judged at its end.
    Chain,
    /// The same, and the slips of C: whether they are found, and how soon.
    Slips,
}

impl Sessions {
    /// With session C or without.
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

/// Where offsets are judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum End {
    /// At the end of session B, estimated with A's baseline.
    B,
    /// At the end of session C, estimated with what was known after B.
    Chain,
}

/// Who estimates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Form {
    /// The estimate of a whole recording.
    Batch,
    /// The same on a sliding window, with a check of the newest blocks. It warns by being provisional, too.
    Online,
}

impl Form {
    pub(super) const ALL: [Self; 2] = [Self::Batch, Self::Online];
}

/// All elastic joints of one recording at one end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EndScore {
    /// Which.
    pub end: End,
    /// Whose estimate.
    pub form: Form,
    /// Estimate less truth per elastic joint, with the deviation stated, rad.
    pub errors_rad: Vec<Gaussian>,
    /// Whether that session's own result warned of anything, or was provisional.
    pub is_warned: bool,
}

impl EndScore {
    pub(super) fn of(end: End, robot: &Robot, truth_rad: &[f64], said: &SessionEstimate) -> Self {
        let error = |joint: &TendonEstimate| {
            let truth_rad = truth_rad[robot.tendon_index(&joint.name)?];
            let offset = joint.offset_rad;
            Some(Gaussian::new(offset.mean - truth_rad, offset.deviation))
        };
        Self {
            end,
            form: Form::Batch,
            errors_rad: said.joints.iter().filter_map(error).collect(),
            is_warned: !said.warnings.is_empty(),
        }
    }

    /// Of the online estimate.
    pub(super) fn online(end: End, truth_rad: &[f64], window: &Window) -> Self {
        let answer = window.answer();
        let error = |own: &OnlineJoint| {
            let offset = own.offset_rad;
            Gaussian::new(offset.mean - truth_rad[own.joint], offset.deviation)
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

    /// Outside their intervals, and nothing was said.
    pub(super) fn silent(&self) -> usize {
        if self.is_warned { 0 } else { self.outside() }
    }

    /// More than three standard deviations off, or no number, and nothing was said.
    pub(super) fn far(&self) -> usize {
        const FAR: f64 = 3.0;
        let is_near = |e: &&Gaussian| e.mean.abs() <= FAR * e.deviation;
        match self.is_warned {
            true => 0,
            false => self.errors_rad.len() - self.errors_rad.iter().filter(is_near).count(),
        }
    }
}
