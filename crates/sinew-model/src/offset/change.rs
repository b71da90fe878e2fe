//! Sudden changes within a recording.

use super::effects::{FORCE, JointParameter, PAYLOAD};
use super::layout::Layout;
use alloc::vec::Vec;

/// Kind of a change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum ChangeKind {
    /// Offset of a joint: a slip of rope or encoder, or a re-tensioning.
    Offset(usize),
    /// Compliance of a joint: a strand failure, which also changes the offset of that joint.
    Compliance(usize),
    /// Offset of a joint that changes at a constant rate from the given time, as of a creeping rope. Its entry is the
    /// rate, rad/s.
    Creep(usize),
    /// Payload in the gripper.
    Payload,
    /// Constant external force at the tool: a cable that drags, a hose, a spring balancer. Its entries belong to this
    /// recording alone and do not affect the posterior of the robot.
    Force,
}

impl ChangeKind {
    /// Returns the number of state entries that the change has.
    pub(crate) fn columns(self) -> usize {
        match self {
            Self::Offset(_) | Self::Compliance(_) | Self::Creep(_) => 1,
            Self::Payload => PAYLOAD,
            Self::Force => FORCE,
        }
    }

    /// First entry of the state that it changes; `None` if its entries are outside the state.
    pub(crate) fn place(self, layout: Layout) -> Option<usize> {
        Some(match self {
            Self::Offset(joint) | Self::Creep(joint) => layout.place(joint, JointParameter::Offset),
            Self::Compliance(joint) => layout.place(joint, JointParameter::Compliance),
            Self::Payload => layout.payload_place(),
            Self::Force => return None,
        })
    }
}

/// A change from a time to the end of the recording; changes of the same quantity add up.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ChangePoint {
    /// Kind of the change.
    pub kind: ChangeKind,
    /// Time of the change since the start of the recording, s.
    pub at_s: f64,
}

impl ChangePoint {
    /// Returns the factor of the change's entries at a time after it, s: 1 for a step, the elapsed time in s for creep.
    pub(crate) fn factor(&self, time_s: f64) -> f64 {
        match self.kind {
            ChangeKind::Creep(_) => time_s - self.at_s,
            _ => 1.0,
        }
    }

    /// Whether this is the stiffness loss that accompanies `slip`.
    pub(crate) fn accompanies(&self, slip: &Self) -> bool {
        self.at_s == slip.at_s
            && matches!((self.kind, slip.kind), (ChangeKind::Compliance(a), ChangeKind::Offset(b)) if a == b)
    }
}

/// Appearance of a sudden change of an offset or a payload in blocks: through the first-order low-pass of all signals.
///
/// ```text
/// share(t) = 1 − e^(−K_I (t − t₀)),   t₀ = at_s − delay_s
/// ```
///
/// `at_s`: start of the first block that contains half of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Appearance {
    /// Pole `K_I` of the low-pass, 1/s.
    pub(crate) gain_per_s: f64,
    /// Delay from the change to half of its size, s.
    pub(crate) delay_s: f64,
}

impl Appearance {
    /// Appearance without a low-pass.
    #[cfg(test)]
    pub(crate) const AT_ONCE: Self = Self {
        gain_per_s: f64::INFINITY,
        delay_s: 0.0,
    };

    /// Share of a change that the blocks contain at a time after it.
    pub(crate) fn share(&self, change: &ChangePoint, time_s: f64) -> f64 {
        /// Number of time constants after which less than 1/20,000 of a change is missing: blocks with one common
        /// factor are summed.
        const TIME_CONSTANTS: f64 = 10.0;
        let passed = self.gain_per_s * (time_s - change.at_s + self.delay_s);
        match change.kind {
            ChangeKind::Offset(_) | ChangeKind::Payload if passed < TIME_CONSTANTS => {
                1.0 - libm::exp(-passed)
            }
            // A force acts from the first block, and a strand may have failed before it; creep grows.
            _ => 1.0,
        }
    }
}

/// Kinds of changes that a search considers.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SearchScope {
    /// Whether slips and strand failures are searched for.
    pub offsets: bool,
    /// Whether payloads picked up or put down are searched for.
    pub payload: bool,
    /// Whether offsets with a constant rate, i.e. creeping ropes, are searched for. Requires `offsets`.
    pub creep: bool,
    /// Whether the data continues from the end of the prior's recording: a change may then occur at the first block.
    pub continues: bool,
    /// Step detected by a check of the newest blocks: the search accepts it up to two seconds before the end, whereas
    /// other changes require five.
    pub onset: Option<Onset>,
}

/// A step of a joint's offset, with its time from a predictive check of the newest blocks.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Onset {
    /// Index of the joint.
    pub joint: usize,
    /// Start of the first block that contains the step, s.
    pub at_s: f64,
}

impl Onset {
    /// Maximum time between a change point and an onset of the same step, s.
    const MAX_ONSET_DISTANCE_S: f64 = 1.0;

    /// Whether a change at a time may be the step of the onset: the joint's offset, or a payload that was picked up.
    pub(crate) fn may_be(&self, kind: ChangeKind, at_s: f64) -> bool {
        let is_kind = match kind {
            ChangeKind::Offset(joint) => joint == self.joint,
            ChangeKind::Payload => true,
            ChangeKind::Compliance(_) | ChangeKind::Creep(_) | ChangeKind::Force => false,
        };
        is_kind && (at_s - self.at_s).abs() <= Self::MAX_ONSET_DISTANCE_S
    }
}

/// Entries of the state that add up to a joint's offset at a time, each with its factor: its own, and every change
/// to it up to then of the kind `which`.
pub(crate) fn offset_terms(
    layout: Layout,
    changes: &[ChangePoint],
    which: impl Fn(&ChangePoint) -> bool,
    joint: usize,
    time_s: f64,
) -> Vec<(usize, f64)> {
    let place = layout.place(joint, JointParameter::Offset);
    let mut terms = alloc::vec![(place, 1.0)];
    let mut column = layout.dimension();
    for change in changes {
        if change.kind.place(layout) == Some(place) && change.at_s <= time_s && which(change) {
            terms.push((column, change.factor(time_s)));
        }
        column += change.kind.columns();
    }
    terms
}

/// All changes but the `k`-th and the stiffness it took along.
pub(crate) fn without(changes: &[ChangePoint], k: usize) -> Vec<ChangePoint> {
    let gone = changes[k];
    let changes = changes.iter().copied();
    changes
        .filter(|c| *c != gone && !c.accompanies(&gone))
        .collect()
}

/// Returns the changes with the `k`-th, and the stiffness change that accompanies it, at another time.
pub(crate) fn moved(changes: &[ChangePoint], k: usize, at_s: f64) -> Vec<ChangePoint> {
    let mut moved = changes.to_vec();
    for change in &mut moved {
        if change.accompanies(&changes[k]) {
            change.at_s = at_s;
        }
    }
    moved[k].at_s = at_s;
    moved
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The share is one half after the delay and one after a few time constants; it is one for a change that grows or
    /// starts with the first block.
    #[test]
    fn changes_appear_through_the_low_pass() {
        let appears = Appearance {
            gain_per_s: 3.0,
            delay_s: core::f64::consts::LN_2 / 3.0,
        };
        let share = |kind: ChangeKind, after_s: f64| {
            appears.share(&ChangePoint { kind, at_s: 4.0 }, 4.0 + after_s)
        };
        let slip = ChangeKind::Offset(0);
        for (after_s, expected) in [(0.0, 0.5), (1.0, 1.0 - 0.5 * libm::exp(-3.0)), (5.0, 1.0)] {
            assert!((share(slip, after_s) - expected).abs() < 1e-12, "{after_s}");
        }
        for kind in [
            ChangeKind::Creep(0),
            ChangeKind::Force,
            ChangeKind::Compliance(0),
        ] {
            assert!((share(kind, 0.0) - 1.0).abs() < 1e-12);
        }
    }
}
