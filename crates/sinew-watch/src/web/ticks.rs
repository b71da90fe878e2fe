//! Once a second: what all browsers are told, made once for all of them.

use super::api::{Fleet, NotWatched, RobotNow, RobotRow, StoreState};
use crate::runtime::{Board, Health, Seen, lock};
use bytes::Bytes;
use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, Mutex};

/// What all browsers are told in one second.
pub struct Tick {
    /// Number; who has seen the one before needs the changes only.
    pub number: u64,
    /// Time of the monitor, s since 1970 UTC.
    pub time_utc_s: f64,
    /// All robots, as JSON.
    pub fleet: Bytes,
    /// What changed since the tick before, as JSON.
    pub change: Bytes,
    /// Robots somebody looks at, as JSON, made when the first one asks.
    robots: Mutex<HashMap<String, Option<Bytes>>>,
    board: Arc<Board>,
}

impl Tick {
    /// A robot, as JSON; `None`: it isn't watched.
    pub fn robot(&self, name: &str) -> Option<Bytes> {
        let mut robots = lock(&self.robots);
        if let Some(made) = robots.get(name) {
            return made.clone();
        }
        let slot = self.board.get(name)?;
        let now = slot
            .seen()
            .watched()
            .map(|robot| RobotNow::of(robot, &slot));
        let made = now
            .and_then(|now| serde_json::to_vec(&now).ok())
            .map(Bytes::from);
        robots.insert(name.into(), made.clone());
        made
    }
}

/// Makes a tick every second.
pub struct Ticker {
    board: Arc<Board>,
    health: Arc<Health>,
    demo: Option<String>,
    rows: BTreeMap<String, RobotRow>,
    number: u64,
}

impl Ticker {
    /// Nothing was said yet.
    pub fn new(board: Arc<Board>, health: Arc<Health>, demo: Option<String>) -> Self {
        Self {
            board,
            health,
            demo,
            rows: BTreeMap::new(),
            number: 0,
        }
    }

    /// What is known at this time, s since 1970 UTC.
    pub fn tick(&mut self, time_utc_s: f64) -> Tick {
        let mut waiting = 0;
        let (mut changed, mut not_watched) = (Vec::new(), Vec::new());
        let mut rows = BTreeMap::new();
        for (name, slot) in self.board.all() {
            match slot.seen() {
                Seen::Nothing => {}
                Seen::NotWatched(why) => not_watched.push(NotWatched { robot: name, why }),
                Seen::Watched(robot) => {
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
            Some(why) => StoreState::Failing { why, waiting },
        };
        let mut fleet = Fleet {
            version: env!("CARGO_PKG_VERSION"),
            demo: self.demo.clone(),
            time_utc_s,
            store,
            doors: self.health.doors(),
            robots: changed,
            not_watched,
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
            board: Arc::clone(&self.board),
        }
    }
}

fn json(fleet: &Fleet) -> Bytes {
    Bytes::from(serde_json::to_vec(fleet).unwrap_or_default())
}
