//! Passages of index marks, as specified by the operator.

use sinew_model::robot::Robot;
use sinew_model::transmission::{Anchor, AnchorKind, Transmission};
use std::cmp::Ordering;

/// Maximum distance of a measured position from the described position of a stop or mark, rad.
pub(crate) const NEAR_RAD: f64 = 0.05;

/// Passage of an index mark by a joint or its motor, as specified by the operator.
#[derive(Debug, Clone, PartialEq)]
pub struct Touch {
    /// Name of the joint.
    pub joint: String,
    /// Kind of the mark, of the joint or the motor; `None` if only one mark matches.
    pub kind: Option<AnchorKind>,
    /// Time since the start of the recording, s.
    pub time_s: f64,
}

/// Positions of a joint and its motor at the passage of a mark.
#[derive(Debug, Clone, PartialEq)]
pub struct TouchReading {
    /// Name of the joint.
    pub joint: String,
    /// Kind of the mark, if specified.
    pub kind: Option<AnchorKind>,
    /// Time since the start of the recording, s.
    pub time_s: f64,
    /// Joint position, rad.
    pub q: f64,
    /// Motor position as measured, rad.
    pub theta_measured: f64,
}

/// Returns the distance of the measured position from a mark, rad; `None` for a mark of another kind.
fn from_mark(anchor: &Anchor, touch: &TouchReading) -> Option<f64> {
    let measured_rad = match anchor.kind {
        AnchorKind::Stop => return None,
        AnchorKind::JointMark => touch.q,
        AnchorKind::MotorMark => touch.theta_measured,
    };
    let is_specified = touch.kind.is_none_or(|kind| kind == anchor.kind);
    is_specified.then(|| (measured_rad - anchor.position_rad).abs())
}

/// Returns the nearest mark of the specified kind.
pub(crate) fn nearest<'a>(t: &'a Transmission, touch: &TouchReading) -> Option<&'a Anchor> {
    let apart = |a: &&Anchor| from_mark(a, touch);
    let marks = t.anchors.iter().filter(|a| apart(a).is_some());
    marks.min_by(|a, b| apart(a).partial_cmp(&apart(b)).unwrap_or(Ordering::Equal))
}

/// Checks that a passage matches exactly one mark of robot.toml.
///
/// # Errors
/// Returns a message if no mark is near the position of joint or motor, or if several are.
pub(crate) fn mark_of(robot: &Robot, touch: &TouchReading) -> Result<(), String> {
    let transmission = robot.tendon_index(&touch.joint);
    let transmission = transmission.and_then(|i| robot.transmissions[i].as_ref());
    let anchors = transmission.map_or(&[][..], |t| &t.anchors);
    let near = |a: &&Anchor| from_mark(a, touch).is_some_and(|apart| apart < NEAR_RAD);
    let positions = format!(
        "joint at {:.4} rad and motor at {:.4} rad",
        touch.q, touch.theta_measured
    );
    match anchors.iter().filter(near).count() {
        1 => Ok(()),
        0 => {
            let marks = anchors.iter().filter(|a| a.kind.is_mark());
            let places: Vec<String> = marks.map(|a| format!("{} rad", a.position_rad)).collect();
            Err(format!(
                "{positions}, more than {NEAR_RAD} rad from the marks at {}; check the time, the unit and the kind of the mark",
                places.join(", ")
            ))
        }
        _ => Err(format!(
            "{positions}: two marks match; specify {joint}:joint-mark@… or {joint}:motor-mark@…",
            joint = touch.joint
        )),
    }
}
