//! How the monitor itself is: its threads, its store, what it has to say.

use super::door::DoorNow;
use crate::store::StoreError;
use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// How the monitor itself is.
#[derive(Debug)]
pub struct Health {
    started: Instant,
    /// Whether the monitor ends: what isn't lost is left out.
    pub ends: AtomicBool,
    /// Of each core thread: when it last went round, ms since the start.
    beats: Vec<AtomicU64>,
    store: Mutex<StoreNow>,
    /// The doors, as they were when they were looked at last.
    doors: Mutex<Vec<DoorNow>>,
    /// Lines said of late.
    said: Mutex<VecDeque<(Instant, String)>>,
    /// Transactions stored, and tries that failed.
    pub transactions: AtomicU64,
    /// Tries to store that failed.
    pub failures: AtomicU64,
    /// Commits, and how long they took together, µs.
    pub commits: AtomicU64,
    /// Microseconds that commits took.
    pub commit_us: AtomicU64,
    /// Estimates made, and how long they took together, µs.
    pub jobs: AtomicU64,
    /// Microseconds that estimates took.
    pub job_us: AtomicU64,
    /// Webhooks that were delivered.
    pub webhooks: AtomicU64,
    /// Webhooks that were given up.
    pub webhooks_lost: AtomicU64,
}

/// A line is not said again within this time.
const SAID_FOR: Duration = Duration::from_secs(10);
/// Lines that are remembered for that.
const SAID_MOST: usize = 256;

fn lock<T>(of: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}

/// How the store is.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StoreNow {
    /// Why the last try to store failed; `None`: it didn't.
    pub fails: Option<String>,
    /// When the last transaction was stored.
    pub stored: Option<Instant>,
}

impl Health {
    /// Of a monitor with so many core threads.
    pub fn new(cores: usize) -> Self {
        Self {
            started: Instant::now(),
            ends: AtomicBool::new(false),
            beats: (0..cores).map(|_| AtomicU64::new(0)).collect(),
            store: Mutex::default(),
            doors: Mutex::default(),
            said: Mutex::default(),
            transactions: AtomicU64::new(0),
            failures: AtomicU64::new(0),
            commits: AtomicU64::new(0),
            commit_us: AtomicU64::new(0),
            jobs: AtomicU64::new(0),
            job_us: AtomicU64::new(0),
            webhooks: AtomicU64::new(0),
            webhooks_lost: AtomicU64::new(0),
        }
    }

    /// A core thread went round.
    pub fn beat(&self, core: usize) {
        if let Some(beat) = self.beats.get(core) {
            beat.store(self.started.elapsed().as_millis() as u64, Ordering::Relaxed);
        }
    }

    /// How long ago the core thread that is the longest silent went round.
    pub fn silent_for(&self) -> Duration {
        let now = self.started.elapsed();
        let oldest = self.beats.iter().map(|b| b.load(Ordering::Relaxed)).min();
        now.saturating_sub(Duration::from_millis(oldest.unwrap_or(0)))
    }

    /// How long the monitor runs.
    pub fn up(&self) -> Duration {
        self.started.elapsed()
    }

    /// So many transactions were stored together, or not.
    pub fn committed(&self, transactions: usize, took: Duration, error: Option<&StoreError>) {
        let mut store = self.store.lock().unwrap_or_else(PoisonError::into_inner);
        match error {
            None => {
                self.transactions
                    .fetch_add(transactions as u64, Ordering::Relaxed);
                self.commits.fetch_add(1, Ordering::Relaxed);
                self.commit_us
                    .fetch_add(took.as_micros() as u64, Ordering::Relaxed);
                if store.fails.take().is_some() {
                    self.say("the store works again");
                }
                store.stored = Some(Instant::now());
            }
            Some(error) => {
                self.failures.fetch_add(1, Ordering::Relaxed);
                let why = error.in_words();
                if store.fails.as_ref() != Some(&why) {
                    self.say(&format!("nothing can be stored: {why}"));
                }
                store.fails = Some(why);
            }
        }
    }

    /// One transaction can't be stored, others can: the store works.
    pub fn refused(&self, robot: &str, error: &StoreError) {
        self.failures.fetch_add(1, Ordering::Relaxed);
        self.say_once(&format!("{robot}: can't be stored: {}", error.in_words()));
    }

    /// The doors, as they were when they were looked at last.
    pub fn doors(&self) -> Vec<DoorNow> {
        lock(&self.doors).clone()
    }

    /// The doors are so now.
    pub fn set_doors(&self, doors: Vec<DoorNow>) {
        *lock(&self.doors) = doors;
    }

    /// How the store is.
    pub fn store(&self) -> StoreNow {
        self.store
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
    }

    /// An estimate was made.
    pub fn job(&self, took: Duration) {
        self.jobs.fetch_add(1, Ordering::Relaxed);
        self.job_us
            .fetch_add(took.as_micros() as u64, Ordering::Relaxed);
    }

    /// A line that a thousand robots may have to say at the same time: one of a kind within a few seconds is enough.
    pub fn say_once(&self, line: &str) {
        let now = Instant::now();
        {
            let mut said = lock(&self.said);
            while said.front().is_some_and(|(at, _)| now - *at > SAID_FOR) {
                said.pop_front();
            }
            if said.iter().any(|(_, known)| known == line) {
                return;
            }
            if said.len() >= SAID_MOST {
                said.pop_front();
            }
            said.push_back((now, line.to_owned()));
        }
        self.say(line);
    }

    /// A line for whoever reads the log: stderr, which systemd keeps.
    pub fn say(&self, line: &str) {
        eprintln!("sinew-watch: {line}");
    }
}
