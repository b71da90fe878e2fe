//! Present state of one robot, written by its core thread and read by all others.

use super::live::LiveBoard;
use super::lock;
use sinew_watch_core::RobotSnapshot;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};

/// Shared state of a robot with its counters.
#[derive(Default)]
pub struct Slot {
    now: Mutex<RobotState>,
    /// Numbers of the incidents that have a recording.
    recordings: Mutex<Vec<u64>>,
    /// Number of messages dropped before the estimator because of a full queue.
    pub dropped: AtomicU64,
    /// Live series that browsers show.
    pub live: LiveBoard,
}

/// State of a robot.
#[derive(Debug, Clone, Default)]
pub enum RobotState {
    /// No snapshot of its monitor yet.
    #[default]
    Starting,
    /// Monitored, with the newest snapshot.
    Monitored(Arc<RobotSnapshot>),
    /// Not monitored, with the reason.
    NotMonitored(String),
}

impl Slot {
    /// Returns the present state.
    pub fn state(&self) -> RobotState {
        lock(&self.now).clone()
    }

    /// Sets the present state.
    pub fn put(&self, state: RobotState) {
        *lock(&self.now) = state;
    }

    /// Returns the numbers of the incidents that have a recording.
    pub fn recordings(&self) -> Vec<u64> {
        lock(&self.recordings).clone()
    }

    /// Sets the numbers of the incidents that have a recording.
    pub fn set_recordings(&self, numbers: Vec<u64>) {
        *lock(&self.recordings) = numbers;
    }

    /// Counts messages dropped by a full queue.
    pub fn count_dropped(&self, messages: u64) {
        self.dropped.fetch_add(messages, Ordering::Relaxed);
    }
}
