//! The paper's method for comparison: eq. (5)–(7) with the mean over a session.

use sinew_estimate::feeder::{Feeder, FeederOptions};
use sinew_log::Frame;
use sinew_model::offset::{Comparison, OffsetConfig, OffsetConfigError, OffsetObserver};
use sinew_model::robot::Robot;

/// Means of the paper's estimate over sessions.
pub(super) struct PaperMeans {
    feeder: Feeder<OffsetObserver>,
    /// Per session and joint: sum and count.
    sums: Vec<Vec<(f64, u32)>>,
}

impl PaperMeans {
    pub(super) fn new(
        robot: &Robot,
        comparison: Comparison,
        sessions: usize,
    ) -> Result<Self, OffsetConfigError> {
        let config = OffsetConfig {
            comparison,
            ..OffsetConfig::default()
        };
        let observer = OffsetObserver::new(&robot.arm, &robot.transmissions, config)?;
        let options = FeederOptions::default();
        Ok(Self {
            feeder: Feeder::new(observer, &robot.transmissions, options),
            sums: vec![vec![(0.0, 0); robot.arm.dof()]; sessions],
        })
    }

    /// Processes a frame of a session; the influence of earlier frames ends when the filters have settled.
    pub(super) fn push(&mut self, frame: &Frame, session: usize) {
        let fed = self.feeder.frame(frame);
        let observer = self.feeder.observer();
        // An invalid frame is excluded, as in a recording.
        if fed.output().is_none() || !observer.is_settled() {
            return;
        }
        for ((sum, count), delta_e) in self.sums[session].iter_mut().zip(observer.delta_e()) {
            if delta_e.is_finite() {
                *sum += delta_e;
                *count += 1;
            }
        }
    }

    /// Mean of joint `i` over a session, rad.
    pub(super) fn mean_rad(&self, session: usize, i: usize) -> Option<f64> {
        let (sum, count) = self.sums[session][i];
        (count > 0).then(|| sum / f64::from(count))
    }
}
