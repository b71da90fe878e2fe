//! The one place where the bench calls the estimator it judges.

use sinew_estimate::baseline::Baseline;
use sinew_estimate::session;
use sinew_estimate::session::{
    Payload, Recorded, Recorder, SessionError, SessionEstimate, SessionOptions,
};
use sinew_model::offset::FeatureConfig;
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
        &SessionOptions {
            payload: if payload {
                Payload::Unknown
            } else {
                Payload::Empty
            },
            ..SessionOptions::default()
        },
    )
}
