//! What is known of all robots now, and where commands to them go.

use super::messages::CoreHandle;
use super::slot::Slot;
use sinew_door::RobotId;
use std::collections::BTreeMap;
use std::sync::{Arc, PoisonError, RwLock};

/// All robots by name.
#[derive(Default)]
pub struct Board {
    robots: RwLock<BTreeMap<String, Place>>,
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
        if let Some(slot) = self.get(robot) {
            return slot;
        }
        let mut robots = self.robots.write().unwrap_or_else(PoisonError::into_inner);
        Arc::clone(&robots.entry(robot.into()).or_default().slot)
    }

    /// What is known of a robot.
    pub fn get(&self, robot: &str) -> Option<Arc<Slot>> {
        let robots = self.robots.read().unwrap_or_else(PoisonError::into_inner);
        robots.get(robot).map(|place| Arc::clone(&place.slot))
    }

    /// Where commands to a robot go; `None`: it isn't watched.
    pub fn address(&self, robot: &str) -> Option<(CoreHandle, RobotId)> {
        let robots = self.robots.read().unwrap_or_else(PoisonError::into_inner);
        robots.get(robot)?.address.clone()
    }

    /// Says where commands to a robot go.
    pub fn set_address(&self, robot: &str, address: Option<(CoreHandle, RobotId)>) {
        let mut robots = self.robots.write().unwrap_or_else(PoisonError::into_inner);
        robots.entry(robot.into()).or_default().address = address;
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
            .map(|(name, place)| (name.clone(), Arc::clone(&place.slot)))
            .collect()
    }
}
