//! What is known of every robot now, for whoever shows it. Written by core threads, read by everybody.

use super::core_thread::CoreHandle;
use sinew_door::RobotId;
use sinew_watch_core::RobotSnapshot;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError, RwLock};

/// A robot's place.
#[derive(Default)]
pub struct Slot {
    now: Mutex<Seen>,
    address: Mutex<Option<(CoreHandle, RobotId)>>,
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
        self.now
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
    }

    /// Says what is known.
    pub fn put(&self, seen: Seen) {
        *self.now.lock().unwrap_or_else(PoisonError::into_inner) = seen;
    }

    /// Where commands to it go; `None`: it isn't watched.
    pub fn address(&self) -> Option<(CoreHandle, RobotId)> {
        self.address
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
    }

    /// Says where commands to it go.
    pub fn set_address(&self, address: Option<(CoreHandle, RobotId)>) {
        *self.address.lock().unwrap_or_else(PoisonError::into_inner) = address;
    }

    /// Counts what a full queue dropped.
    pub fn count_dropped(&self, messages: u64) {
        self.dropped.fetch_add(messages, Ordering::Relaxed);
    }
}

/// All robots by name.
#[derive(Default)]
pub struct Board {
    robots: RwLock<BTreeMap<String, Arc<Slot>>>,
}

impl Board {
    /// The place of a robot; made where there is none.
    pub fn slot(&self, robot: &str) -> Arc<Slot> {
        if let Some(slot) = self.get(robot) {
            return slot;
        }
        let mut robots = self.robots.write().unwrap_or_else(PoisonError::into_inner);
        Arc::clone(robots.entry(robot.into()).or_default())
    }

    /// The place of a robot.
    pub fn get(&self, robot: &str) -> Option<Arc<Slot>> {
        let robots = self.robots.read().unwrap_or_else(PoisonError::into_inner);
        robots.get(robot).cloned()
    }

    /// A robot is no longer in the configuration.
    pub fn remove(&self, robot: &str) {
        let mut robots = self.robots.write().unwrap_or_else(PoisonError::into_inner);
        robots.remove(robot);
    }

    /// All robots, by name.
    pub fn all(&self) -> Vec<(String, Arc<Slot>)> {
        let robots = self.robots.read().unwrap_or_else(PoisonError::into_inner);
        robots
            .iter()
            .map(|(name, slot)| (name.clone(), Arc::clone(slot)))
            .collect()
    }
}
