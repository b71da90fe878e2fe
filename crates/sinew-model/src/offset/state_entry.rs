//! The entries of a state in words.

use super::effects::bodies::Bodies;
use super::effects::joint_spring::JointSpring;
use super::effects::moment_arm::MomentArm;
use super::effects::payload::HeldPayload;
use super::effects::tension_sensor::TensionSensor;
use super::effects::{Effect, JOINT_PARAMETERS, JointParameter, Parameter};
use super::layout::Layout;

/// One entry of the state in words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StateEntry {
    /// Axis of the joint, tendon or body it belongs to; `None` for the payload.
    pub joint: Option<usize>,
    /// Whether it belongs to the joint of the axis, or to the body behind it; otherwise to the tendon or its motor.
    pub is_of_joint: bool,
    /// Name of the parameter.
    pub name: &'static str,
    /// Unit of the parameter; empty for a ratio.
    pub unit: &'static str,
}

impl StateEntry {
    /// Entry `k` of a state in which every body has all its parameters.
    pub(crate) fn of(layout: Layout, k: usize) -> Option<Self> {
        let (joint, parameter) = parameter(layout, k)?;
        let is_of_axis = k < layout.arm_start();
        let is_of_spring = (layout.spring_start()..layout.sensor_start()).contains(&k);
        Some(Self {
            joint,
            is_of_joint: match is_of_axis {
                true => JointParameter::is_of_joint(parameter.place),
                false => is_of_spring || k >= layout.body_start(),
            },
            name: parameter.name,
            unit: parameter.unit,
        })
    }
}

/// Returns the parameter of entry `k` of a state, and its joint or body.
pub(crate) fn parameter(layout: Layout, k: usize) -> Option<(Option<usize>, &'static Parameter)> {
    let own = |start: usize, all: &'static [Parameter]| {
        let k = k - start;
        let of = all.get(k % all.len())?;
        Some((Some(k / all.len()), of))
    };
    if k < layout.arm_start() {
        own(0, &JOINT_PARAMETERS)
    } else if k < layout.spring_start() {
        Some((None, MomentArm::DESCRIPTION.parameters.first()?))
    } else if k < layout.sensor_start() {
        let k = k - layout.spring_start();
        Some((None, JointSpring::DESCRIPTION.parameters.get(k % 2)?))
    } else if k < layout.body_start() {
        let k = k - layout.sensor_start();
        Some((None, TensionSensor::DESCRIPTION.parameters.get(k % 2)?))
    } else if k < layout.payload_place() {
        own(layout.body_start(), Bodies::DESCRIPTION.parameters)
    } else {
        let payload = HeldPayload::DESCRIPTION.parameters;
        let of = payload.get(k - layout.payload_place())?;
        Some((None, of))
    }
}
