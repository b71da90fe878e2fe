//! Sudden changes within a recording.

use super::effects::{FORCE, JointParameter, PAYLOAD};
use super::layout::Layout;
use alloc::vec::Vec;

/// What changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum ChangeKind {
    /// Offset of a joint: a slip of rope or encoder, a re-tensioning.
    Offset(usize),
    /// Compliance of a joint: a failed strand, with the offset of that joint.
    Compliance(usize),
    /// Offset of a joint, evenly from then on: a rope that creeps. Its entry is the rate, rad/s.
    Creep(usize),
    /// What the gripper holds.
    Payload,
    /// A constant force from outside, at the tool: a cable that drags, a hose, a spring balancer. Its entries are the
    /// recording's alone: they change nothing that is believed of the robot.
    Force,
}

impl ChangeKind {
    /// Entries of the state it changes.
    pub(crate) fn columns(self) -> usize {
        match self {
            Self::Offset(_) | Self::Compliance(_) | Self::Creep(_) => 1,
            Self::Payload => PAYLOAD,
            Self::Force => FORCE,
        }
    }

    /// First entry of the state it changes; `None`: it comes beside them.
    pub(crate) fn place(self, layout: Layout) -> Option<usize> {
        Some(match self {
            Self::Offset(joint) | Self::Creep(joint) => layout.place(joint, JointParameter::Offset),
            Self::Compliance(joint) => layout.place(joint, JointParameter::Compliance),
            Self::Payload => layout.payload_place(),
            Self::Force => return None,
        })
    }
}

/// A change from a time to the end of the recording; changes of the same thing add up.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ChangePoint {
    /// What changes.
    pub kind: ChangeKind,
    /// When, s.
    pub at_s: f64,
}

impl ChangePoint {
    /// By how much of its entry what it changes has changed by a time after it, s.
    pub(crate) fn factor(&self, time_s: f64) -> f64 {
        match self.kind {
            ChangeKind::Creep(_) => time_s - self.at_s,
            _ => 1.0,
        }
    }

    /// Whether this is the loss of stiffness that was opened with `slip`.
    pub(crate) fn accompanies(&self, slip: &Self) -> bool {
        self.at_s == slip.at_s
            && matches!((self.kind, slip.kind), (ChangeKind::Compliance(a), ChangeKind::Offset(b)) if a == b)
    }
}

/// How a sudden change of an offset or a payload appears in blocks: through the first-order low-pass of all signals.
///
/// ```text
/// share(t) = 1 − e^(−K_I (t − t₀)),   t₀ = at_s − delay_s
/// ```
///
/// `at_s`: beginning of the first block that shows half of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Appearance {
    /// Pole `K_I` of the low-pass, 1/s.
    pub(crate) gain_per_s: f64,
    /// From the change to half of it, s.
    pub(crate) delay_s: f64,
}

impl Appearance {
    /// Without a low-pass.
    #[cfg(test)]
    pub(crate) const AT_ONCE: Self = Self {
        gain_per_s: f64::INFINITY,
        delay_s: 0.0,
    };

    /// Share of a change that blocks show at a time after it.
    pub(crate) fn share(&self, change: &ChangePoint, time_s: f64) -> f64 {
        /// From here on less than a twenty-thousandth of a change is missing: blocks of one factor are summed together.
        const TIME_CONSTANTS: f64 = 10.0;
        let passed = self.gain_per_s * (time_s - change.at_s + self.delay_s);
        match change.kind {
            ChangeKind::Offset(_) | ChangeKind::Payload if passed < TIME_CONSTANTS => {
                1.0 - libm::exp(-passed)
            }
            // A force acts, and a strand may have failed, before the first block; creep grows.
            _ => 1.0,
        }
    }
}

/// Which changes a search looks for.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SearchScope {
    /// Slips and failed strands.
    pub offsets: bool,
    /// Payloads picked up or put down.
    pub payload: bool,
    /// Offsets that move evenly: ropes that creep. It takes `offsets`, too.
    pub creep: bool,
    /// Whether the data goes on from where the belief ends: a change may come with its first
    /// block then.
    pub continues: bool,
    /// A step that a check of the newest blocks has found: the search accepts it from two seconds before the end on, where it
    /// asks for five of other changes.
    pub onset: Option<Onset>,
}

/// A step of a joint's offset as a predictive check of the newest blocks dates it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Onset {
    /// Index of the joint.
    pub joint: usize,
    /// Beginning of the first block that shows it, s.
    pub at_s: f64,
}

impl Onset {
    /// Change points within this time of an onset may be the step, s.
    const NEAR_S: f64 = 1.0;

    /// Whether a change at a time may be what the onset shows: the joint's offset, or a payload that was picked up.
    pub(crate) fn may_be(&self, kind: ChangeKind, at_s: f64) -> bool {
        let is_kind = match kind {
            ChangeKind::Offset(joint) => joint == self.joint,
            ChangeKind::Payload => true,
            ChangeKind::Compliance(_) | ChangeKind::Creep(_) | ChangeKind::Force => false,
        };
        is_kind && (at_s - self.at_s).abs() <= Self::NEAR_S
    }
}

/// Entries of the state that add up to a joint's offset at a time, each with its factor: its own, and every change
/// to it up to then.
pub(crate) fn offset_terms(
    layout: Layout,
    changes: &[ChangePoint],
    joint: usize,
    time_s: f64,
) -> Vec<(usize, f64)> {
    let place = layout.place(joint, JointParameter::Offset);
    let mut terms = alloc::vec![(place, 1.0)];
    let mut column = layout.dimension();
    for change in changes {
        if change.kind.place(layout) == Some(place) && change.at_s <= time_s {
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

/// The changes with the `k`-th, and the stiffness that goes with it, at another time.
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

    /// Half after the delay, all after a few time constants; what grows, or comes with the first block, is whole.
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
