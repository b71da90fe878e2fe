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
