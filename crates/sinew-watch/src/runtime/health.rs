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
    /// Why the last try to store failed; `None`: it didn't.
    store_fails: Mutex<Option<String>>,
    /// The doors, as they were when they were looked at last.
    doors: Mutex<Vec<DoorNow>>,
    /// Lines said of late.
    said: Mutex<VecDeque<(Instant, String)>>,
    /// What the monitor counts, for metrics.
    pub counts: Counts,
}

/// What the monitor counts, for metrics.
#[derive(Debug, Default)]
pub struct Counts {
    /// Transactions that were stored.
    pub transactions: AtomicU64,
    /// Tries to store that failed.
    pub failures: AtomicU64,
    /// Commits, each of one transaction or several.
    pub commits: AtomicU64,
    /// Microseconds that commits took.
    pub commit_us: AtomicU64,
    /// Estimates and trends made.
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

/// A thread that panicked left whole values behind: every change is complete in itself.
pub(crate) fn lock<T>(of: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Health {
    /// Of a monitor with so many core threads.
    pub fn new(cores: usize) -> Self {
        Self {
            started: Instant::now(),
            ends: AtomicBool::new(false),
            beats: (0..cores).map(|_| AtomicU64::new(0)).collect(),
            store_fails: Mutex::default(),
            doors: Mutex::default(),
            said: Mutex::default(),
            counts: Counts::default(),
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
        let mut fails = lock(&self.store_fails);
        match error {
            None => {
                self.counts
                    .transactions
                    .fetch_add(transactions as u64, Ordering::Relaxed);
                self.counts.commits.fetch_add(1, Ordering::Relaxed);
                self.counts
                    .commit_us
                    .fetch_add(took.as_micros() as u64, Ordering::Relaxed);
                if fails.take().is_some() {
                    self.say("the store works again");
                }
            }
            Some(error) => {
                self.counts.failures.fetch_add(1, Ordering::Relaxed);
                let why = error.in_words();
                if fails.as_ref() != Some(&why) {
                    self.say(&format!("nothing can be stored: {why}"));
                }
                *fails = Some(why);
            }
        }
    }

    /// One transaction can't be stored, others can: the store works.
    pub fn refused(&self, robot: &str, error: &StoreError) {
        self.counts.failures.fetch_add(1, Ordering::Relaxed);
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

    /// Why the last try to store failed; `None`: it didn't.
    pub fn store_fails(&self) -> Option<String> {
        lock(&self.store_fails).clone()
    }

    /// An estimate was made.
    pub fn job(&self, took: Duration) {
        self.counts.jobs.fetch_add(1, Ordering::Relaxed);
        self.counts
            .job_us
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
