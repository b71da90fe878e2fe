//! The one place where the bench calls the estimator it judges.

use sinew_estimate::absolute;
use sinew_estimate::absolute::{
    Absolute, AbsoluteError, Baseline, Payload, Recorded, Recorder, WatchOptions,
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
) -> Result<(Baseline, Absolute), AbsoluteError> {
    absolute::learn_recorded(robot, recorded, "session A")
}

/// The answer and what is known then. `payload`: whether the gripper may hold something, which its user knows.
pub(super) fn watch(
    robot: &Robot,
    recorded: &Recorded,
    name: &str,
    baseline: &Baseline,
    payload: bool,
) -> Result<(Absolute, Baseline), AbsoluteError> {
    absolute::watch_recorded(
        robot,
        recorded,
        name,
        Some((baseline, "session A")),
        &WatchOptions {
            payload: if payload {
                Payload::Unknown
            } else {
                Payload::Empty
            },
            ..WatchOptions::default()
        },
    )
}
