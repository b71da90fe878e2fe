//! What is known of all robots now, and where commands to them go.

use super::lock;
use super::messages::CoreHandle;
use super::slot::Slot;
use sinew_door::RobotId;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

/// All robots by name.
#[derive(Default)]
pub struct Board {
    robots: Mutex<BTreeMap<String, Place>>,
}

/// A robot's place.
#[derive(Default)]
struct Place {
    slot: Arc<Slot>,
    /// Where commands to it go; `None`: it isn't watched.
    address: Option<(CoreHandle, RobotId)>,
}

impl Board {
    /// What is known of a robot; a place is made where there is none.
    pub fn slot(&self, robot: &str) -> Arc<Slot> {
        Arc::clone(&lock(&self.robots).entry(robot.into()).or_default().slot)
    }

    /// What is known of a robot.
    pub fn get(&self, robot: &str) -> Option<Arc<Slot>> {
        let robots = lock(&self.robots);
        robots.get(robot).map(|place| Arc::clone(&place.slot))
    }

    /// Where commands to a robot go; `None`: it isn't watched.
    pub fn address(&self, robot: &str) -> Option<(CoreHandle, RobotId)> {
        lock(&self.robots).get(robot)?.address.clone()
    }

    /// Says where commands to a robot go.
    pub fn set_address(&self, robot: &str, address: Option<(CoreHandle, RobotId)>) {
        lock(&self.robots).entry(robot.into()).or_default().address = address;
    }

    /// A robot is no longer in the configuration.
    pub fn remove(&self, robot: &str) {
        lock(&self.robots).remove(robot);
    }

    /// All robots, by name.
    pub fn all(&self) -> Vec<(String, Arc<Slot>)> {
        (lock(&self.robots).iter())
            .map(|(name, place)| (name.clone(), Arc::clone(&place.slot)))
            .collect()
    }
}
