//! Updates of all browsers, generated once a second for all of them.

use super::api::{Fleet, NotMonitored, RobotNow, RobotRow, StoreState};
use crate::runtime::{Health, RobotRegistry, RobotState, lock};
use bytes::Bytes;
use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, Mutex};

/// Update of all browsers.
pub struct Tick {
    /// Number of the tick; a browser that has the previous one needs only the changes.
    pub number: u64,
    /// Time of the monitor, s since 1970 UTC.
    pub time_utc_s: f64,
    /// All robots, as JSON.
    pub fleet: Bytes,
    /// Changes since the previous tick, as JSON.
    pub change: Bytes,
    /// Robots shown by a browser, as JSON, generated at the first request.
    robots: Mutex<HashMap<String, Option<Bytes>>>,
    registry: Arc<RobotRegistry>,
}

impl Tick {
    /// Returns a robot as JSON; `None`: not monitored.
    pub fn robot(&self, name: &str) -> Option<Bytes> {
        let mut robots = lock(&self.robots);
        if let Some(made) = robots.get(name) {
            return made.clone();
        }
        let slot = self.registry.get(name)?;
        let now = slot
            .state()
            .snapshot()
            .map(|robot| RobotNow::of(robot, &slot));
        let made = now
            .and_then(|now| serde_json::to_vec(&now).ok())
            .map(Bytes::from);
        robots.insert(name.into(), made.clone());
        made
    }
}

/// Generator of one tick per second.
pub struct Ticker {
    registry: Arc<RobotRegistry>,
    health: Arc<Health>,
    demo: Option<String>,
    rows: BTreeMap<String, RobotRow>,
    number: u64,
}

impl Ticker {
    /// Creates the generator; its first tick contains everything.
    pub fn new(registry: Arc<RobotRegistry>, health: Arc<Health>, demo: Option<String>) -> Self {
        Self {
            registry,
            health,
            demo,
            rows: BTreeMap::new(),
            number: 0,
        }
    }

    /// Generates the tick at this time, s since 1970 UTC.
    pub fn tick(&mut self, time_utc_s: f64) -> Tick {
        let mut waiting = 0;
        let (mut changed, mut not_monitored) = (Vec::new(), Vec::new());
        let mut rows = BTreeMap::new();
        for (name, slot) in self.registry.all() {
            match slot.state() {
                RobotState::Starting => {}
                RobotState::NotMonitored(reason) => not_monitored.push(NotMonitored {
                    robot: name,
                    reason,
                }),
                RobotState::Monitored(robot) => {
                    waiting += robot.waiting_to_be_stored;
                    let row = RobotRow::of(&robot);
                    if self.rows.get(&name) != Some(&row) {
                        changed.push(row.clone());
                    }
                    rows.insert(name, row);
                }
            }
        }
        let gone = self.rows.keys().filter(|name| !rows.contains_key(*name));
        let gone: Vec<String> = gone.cloned().collect();
        let store = match self.health.store_fails() {
            None => StoreState::Works,
            Some(reason) => StoreState::Failing { reason, waiting },
        };
        let mut fleet = Fleet {
            version: env!("CARGO_PKG_VERSION"),
            demo: self.demo.clone(),
            time_utc_s,
            store,
            transports: self.health.transports(),
            robots: changed,
            not_monitored,
            gone,
        };
        let change = json(&fleet);
        fleet.robots = rows.values().cloned().collect();
        fleet.gone = Vec::new();
        self.rows = rows;
        self.number += 1;
        Tick {
            number: self.number,
            time_utc_s,
            fleet: json(&fleet),
            change,
            robots: Mutex::default(),
            registry: Arc::clone(&self.registry),
        }
    }
}

fn json(fleet: &Fleet) -> Bytes {
    Bytes::from(serde_json::to_vec(fleet).unwrap_or_default())
}
