//! What is known of one robot now, for whoever shows it. Written by its core thread, read by everybody.

use super::lock;
use sinew_watch_core::RobotSnapshot;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};

/// A robot's place.
#[derive(Default)]
pub struct Slot {
    now: Mutex<Seen>,
    /// Messages dropped before the estimator, by a full queue.
    pub dropped: AtomicU64,
}

/// What is known of a robot.
#[derive(Debug, Clone, Default)]
pub enum Seen {
    /// Its monitor hasn't said anything yet.
    #[default]
    Nothing,
    /// It is watched.
    Watched(Arc<RobotSnapshot>),
    /// It isn't, and why.
    NotWatched(String),
}

impl Slot {
    /// What is known.
    pub fn seen(&self) -> Seen {
        lock(&self.now).clone()
    }

    /// Says what is known.
    pub fn put(&self, seen: Seen) {
        *lock(&self.now) = seen;
    }

    /// Counts what a full queue dropped.
    pub fn count_dropped(&self, messages: u64) {
        self.dropped.fetch_add(messages, Ordering::Relaxed);
    }
}
