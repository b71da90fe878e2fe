//! The entries of a state in words.

use super::effects::bodies::Bodies;
use super::effects::moment_arm::MomentArm;
use super::effects::payload::HeldPayload;
use super::effects::{Effect, JOINT_PARAMETERS, Parameter};
use super::layout::Layout;

/// One entry of the state in words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StateEntry {
    /// Joint, tendon or body it belongs to; `None` for the payload.
    pub joint: Option<usize>,
    /// What it is.
    pub name: &'static str,
    /// Its unit; empty for a ratio.
    pub unit: &'static str,
}

impl StateEntry {
    /// Entry `k` of a state in which every body has all its parameters.
    pub(crate) fn of(layout: Layout, k: usize) -> Option<Self> {
        let (joint, parameter) = parameter(layout, k)?;
        Some(Self {
            joint,
            name: parameter.name,
            unit: parameter.unit,
        })
    }
}

/// What entry `k` of such a state is, and of which joint or body.
pub(crate) fn parameter(layout: Layout, k: usize) -> Option<(Option<usize>, &'static Parameter)> {
    let own = |start: usize, all: &'static [Parameter]| {
        let k = k - start;
        let of = all.get(k % all.len())?;
        Some((Some(k / all.len()), of))
    };
    if k < layout.arm_start() {
        own(0, &JOINT_PARAMETERS)
    } else if k < layout.body_start() {
        Some((None, MomentArm::DESCRIPTION.parameters.first()?))
    } else if k < layout.payload_place() {
        own(layout.body_start(), Bodies::DESCRIPTION.parameters)
    } else {
        let payload = HeldPayload::DESCRIPTION.parameters;
        let of = payload.get(k - layout.payload_place())?;
        Some((None, of))
    }
}
