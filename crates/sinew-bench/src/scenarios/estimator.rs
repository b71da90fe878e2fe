//! Calls of the assessed estimator; no other module of the bench calls it.

use sinew_estimate::baseline::Baseline;
use sinew_estimate::online::Window;
use sinew_estimate::session;
use sinew_estimate::session::{
    Payload, Recorded, Recorder, SessionError, SessionEstimate, SessionOptions,
};
use sinew_model::offset::FeatureConfig;
use sinew_model::robot::Robot;

/// Creates a recorder with the settings of `sinew baseline` and `sinew estimate`.
pub(super) fn recorder(robot: &Robot) -> Recorder {
    let gap_s = sinew_log::OpenOptions::default().gap_s;
    Recorder::new(robot, &FeatureConfig::default(), gap_s)
}

pub(super) fn learn(
    robot: &Robot,
    recorded: &Recorded,
) -> Result<(Baseline, SessionEstimate), SessionError> {
    session::learn_recorded(robot, recorded, "session A", &session::Learning::default())
}

/// Returns the options that a user would specify. `payload`: whether the gripper may carry a payload.
pub(super) fn options(payload: bool) -> SessionOptions {
    SessionOptions {
        payload: if payload {
            Payload::Unknown
        } else {
            Payload::Empty
        },
        ..SessionOptions::default()
    }
}

/// The online estimate since A's baseline.
pub(super) fn online(
    robot: &Robot,
    baseline: &Baseline,
    payload: bool,
) -> Result<Window, SessionError> {
    let baseline = Some((baseline.clone(), "session A".to_owned()));
    Window::new(
        robot.clone(),
        baseline,
        &options(payload),
        "sessions B and C",
    )
}

/// Takes the blocks of a session, and solves the window whenever that is due.
pub(super) fn follow(window: &mut Window, recorded: &Recorded) {
    for part in recorded.parts() {
        window.push(&part);
        if window.is_due() {
            window.solve();
        }
    }
}

/// Returns the estimate and the posterior. `payload`: whether the gripper may carry a payload, as specified by the user.
pub(super) fn watch(
    robot: &Robot,
    recorded: &Recorded,
    name: &str,
    baseline: &Baseline,
    payload: bool,
) -> Result<(SessionEstimate, Baseline), SessionError> {
    session::estimate_recorded(
        robot,
        recorded,
        name,
        Some((baseline, "session A")),
        &options(payload),
    )
}
