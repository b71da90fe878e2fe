//! A mark that a joint or its motor passed, as its owner says.

use sinew_model::robot::Robot;
use sinew_model::transmission::{Anchor, AnchorKind, Transmission};
use std::cmp::Ordering;

/// A joint whose reading is further than this from a stop's position has not touched it, rad.
pub(crate) const NEAR_RAD: f64 = 0.05;

/// A mark that a joint or its motor passes, as its owner says.
#[derive(Debug, Clone, PartialEq)]
pub struct Touch {
    /// Joint.
    pub joint: String,
    /// Whose mark it is, the joint's or the motor's; `None`: the joint has one mark there.
    pub kind: Option<AnchorKind>,
    /// When, s since the recording began.
    pub time_s: f64,
}

/// Where a joint and its motor stood at a touch.
#[derive(Debug, Clone, PartialEq)]
pub struct TouchReading {
    /// Joint.
    pub joint: String,
    /// Whose mark it is said to be.
    pub kind: Option<AnchorKind>,
    /// When, s since the recording began.
    pub time_s: f64,
    /// Joint position, rad.
    pub q: f64,
    /// Motor position as measured, rad.
    pub theta_measured: f64,
}

/// How far a touch's reading is from a mark, rad; `None`: it isn't said to be that mark.
fn from_mark(anchor: &Anchor, touch: &TouchReading) -> Option<f64> {
    let read = match anchor.kind {
        AnchorKind::Stop => return None,
        AnchorKind::JointMark => touch.q,
        AnchorKind::MotorMark => touch.theta_measured,
    };
    let meant = touch.kind.is_none_or(|kind| kind == anchor.kind);
    meant.then(|| (read - anchor.position_rad).abs())
}

/// The mark that a touch is of: of those it may be, the nearest.
pub(crate) fn nearest<'a>(t: &'a Transmission, touch: &TouchReading) -> Option<&'a Anchor> {
    let apart = |a: &&Anchor| from_mark(a, touch);
    let marks = t.anchors.iter().filter(|a| apart(a).is_some());
    marks.min_by(|a, b| apart(a).partial_cmp(&apart(b)).unwrap_or(Ordering::Equal))
}

/// Whether a touch is of exactly one mark of robot.toml.
///
/// # Errors
/// In words: no mark is where joint or motor stood then, or two are.
pub(crate) fn mark_of(robot: &Robot, touch: &TouchReading) -> Result<(), String> {
    let transmission = robot.tendon_index(&touch.joint);
    let transmission = transmission.and_then(|i| robot.transmissions[i].as_ref());
    let anchors = transmission.map_or(&[][..], |t| &t.anchors);
    let near = |a: &&Anchor| from_mark(a, touch).is_some_and(|apart| apart < NEAR_RAD);
    let stood = format!(
        "the joint stood at {:.4} rad and the motor at {:.4} rad",
        touch.q, touch.theta_measured
    );
    match anchors.iter().filter(near).count() {
        1 => Ok(()),
        0 => {
            let marks = anchors.iter().filter(|a| a.kind.is_mark());
            let places: Vec<String> = marks.map(|a| format!("{} rad", a.position_rad)).collect();
            Err(format!(
                "{stood}, more than {NEAR_RAD} rad from its marks at {}; check the time, the unit and whose mark it is",
                places.join(", ")
            ))
        }
        _ => Err(format!(
            "{stood}, where two marks are; say which: {joint}:joint-mark@… or {joint}:motor-mark@…",
            joint = touch.joint
        )),
    }
}
