//! The one place where the bench calls the estimator it judges.

use sinew_estimate::baseline::Baseline;
use sinew_estimate::session;
use sinew_estimate::session::{
    Payload, Recorded, Recorder, SessionError, SessionEstimate, SessionOptions,
};
use sinew_model::offset::{FeatureConfig, RecursiveOffsets};
use sinew_model::robot::Robot;

/// A recorder as `sinew baseline` and `sinew estimate` use it.
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

/// What a user says. `payload`: whether the gripper may hold something.
fn options(payload: bool) -> SessionOptions {
    SessionOptions {
        payload: if payload {
            Payload::Unknown
        } else {
            Payload::Empty
        },
        ..SessionOptions::default()
    }
}

/// The estimate that goes on block by block, from A's baseline.
pub(super) fn live(
    robot: &Robot,
    baseline: &Baseline,
    payload: bool,
) -> Result<RecursiveOffsets, SessionError> {
    session::live(robot, (baseline, "session A"), &options(payload))
}

/// Takes a session's blocks; one that isn't finite is left out.
pub(super) fn follow(filter: &mut RecursiveOffsets, recorded: &Recorded) {
    for block in &recorded.blocks {
        let _left_out = filter.step(block);
    }
}

/// The answer and what is known then. `payload`: whether the gripper may hold something, which its user knows.
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
