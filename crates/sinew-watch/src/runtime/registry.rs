//! Registry of all robots: their present state and the destination of commands.

use super::lock;
use super::messages::CoreHandle;
use super::slot::Slot;
use sinew_transport::RobotId;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

/// Registry of all robots by name.
#[derive(Default)]
pub struct RobotRegistry {
    robots: Mutex<BTreeMap<String, Place>>,
}

/// Entry of a robot.
#[derive(Default)]
struct Place {
    slot: Arc<Slot>,
    /// Core thread and queue that receive commands; `None`: not monitored.
    address: Option<(CoreHandle, RobotId)>,
}

impl RobotRegistry {
    /// Returns the state of a robot; creates it if missing.
    pub fn slot(&self, robot: &str) -> Arc<Slot> {
        Arc::clone(&lock(&self.robots).entry(robot.into()).or_default().slot)
    }

    /// Returns the state of a robot.
    pub fn get(&self, robot: &str) -> Option<Arc<Slot>> {
        let robots = lock(&self.robots);
        robots.get(robot).map(|place| Arc::clone(&place.slot))
    }

    /// Returns the destination of commands to a robot; `None`: not monitored.
    pub fn address(&self, robot: &str) -> Option<(CoreHandle, RobotId)> {
        lock(&self.robots).get(robot)?.address.clone()
    }

    /// Sets the destination of commands to a robot.
    pub fn set_address(&self, robot: &str, address: Option<(CoreHandle, RobotId)>) {
        lock(&self.robots).entry(robot.into()).or_default().address = address;
    }

    /// Removes a robot that is no longer in the configuration.
    pub fn remove(&self, robot: &str) {
        lock(&self.robots).remove(robot);
    }

    /// Returns all robots, sorted by name.
    pub fn all(&self) -> Vec<(String, Arc<Slot>)> {
        (lock(&self.robots).iter())
            .map(|(name, place)| (name.clone(), Arc::clone(&place.slot)))
            .collect()
    }
}
