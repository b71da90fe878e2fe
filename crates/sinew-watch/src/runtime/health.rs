//! Health of the monitor: threads, store and log messages.

use super::transport::TransportView;
use crate::store::StoreError;
use crate::words;
use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Health of the monitor.
#[derive(Debug)]
pub struct Health {
    started: Instant,
    /// Whether the monitor is stopping: optional work is skipped.
    pub ends: AtomicBool,
    /// Time of the last loop of each core thread, ms since the start.
    beats: Vec<AtomicU64>,
    /// Reason of the last failure to store; `None`: the last attempt succeeded.
    store_fails: Mutex<Option<String>>,
    /// Transports at the last check.
    transports: Mutex<Vec<TransportView>>,
    /// Recently logged lines.
    recent_lines: Mutex<VecDeque<(Instant, String)>>,
    /// Counters for metrics.
    pub counts: Counts,
}

/// Counters for metrics.
#[derive(Debug, Default)]
pub struct Counts {
    /// Number of stored transactions.
    pub transactions: AtomicU64,
    /// Number of failed attempts to store.
    pub failures: AtomicU64,
    /// Number of commits, each of one or several transactions.
    pub commits: AtomicU64,
    /// Total duration of commits, µs.
    pub commit_us: AtomicU64,
    /// Number of estimates and trends.
    pub jobs: AtomicU64,
    /// Total duration of estimates, µs.
    pub job_us: AtomicU64,
    /// Number of delivered notifications.
    pub webhooks: AtomicU64,
    /// Number of notifications discarded after the last attempt.
    pub webhooks_lost: AtomicU64,
}

/// Time within which a line is not logged again.
const MIN_REPEAT_INTERVAL: Duration = Duration::from_secs(10);
/// Maximum number of remembered lines.
const MAX_RECENT_LINES: usize = 256;

/// Locks a mutex even if a thread panicked: every change is complete in itself.
pub(crate) fn lock<T>(of: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Health {
    /// Creates the health of a monitor with this number of core threads.
    pub fn new(cores: usize) -> Self {
        Self {
            started: Instant::now(),
            ends: AtomicBool::new(false),
            beats: (0..cores).map(|_| AtomicU64::new(0)).collect(),
            store_fails: Mutex::default(),
            transports: Mutex::default(),
            recent_lines: Mutex::default(),
            counts: Counts::default(),
        }
    }

    /// Records a loop of a core thread.
    pub fn beat(&self, core: usize) {
        if let Some(beat) = self.beats.get(core) {
            beat.store(self.started.elapsed().as_millis() as u64, Ordering::Relaxed);
        }
    }

    /// Returns the time since the last loop of the slowest core thread.
    pub fn silent_for(&self) -> Duration {
        let now = self.started.elapsed();
        let oldest = self.beats.iter().map(|b| b.load(Ordering::Relaxed)).min();
        now.saturating_sub(Duration::from_millis(oldest.unwrap_or(0)))
    }

    /// Returns the time since the start of the monitor.
    pub fn up(&self) -> Duration {
        self.started.elapsed()
    }

    /// Records the result of storing several transactions together.
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
                    self.log(&words::log::store_recovered());
                }
            }
            Some(error) => {
                self.counts.failures.fetch_add(1, Ordering::Relaxed);
                let reason = error.in_words();
                if fails.as_ref() != Some(&reason) {
                    self.log(&words::log::store_failed(&reason));
                }
                *fails = Some(reason);
            }
        }
    }

    /// Reports a transaction that cannot be stored while others can: the store works.
    pub fn transaction_rejected(&self, robot: &str, error: &StoreError) {
        self.counts.failures.fetch_add(1, Ordering::Relaxed);
        self.log_once(&words::log::transaction_rejected(robot, &error.in_words()));
    }

    /// Returns the transports at the last check.
    pub fn transports(&self) -> Vec<TransportView> {
        lock(&self.transports).clone()
    }

    /// Sets the present transports.
    pub fn set_transports(&self, transports: Vec<TransportView>) {
        *lock(&self.transports) = transports;
    }

    /// Returns the reason of the last failure to store; `None`: the last attempt succeeded.
    pub fn store_fails(&self) -> Option<String> {
        lock(&self.store_fails).clone()
    }

    /// Records an estimate.
    pub fn job(&self, took: Duration) {
        self.counts.jobs.fetch_add(1, Ordering::Relaxed);
        self.counts
            .job_us
            .fetch_add(took.as_micros() as u64, Ordering::Relaxed);
    }

    /// Logs a line that many robots may produce at the same time, once within a few seconds.
    pub fn log_once(&self, line: &str) {
        let now = Instant::now();
        {
            let mut recent_lines = lock(&self.recent_lines);
            while recent_lines
                .front()
                .is_some_and(|(at, _)| now - *at > MIN_REPEAT_INTERVAL)
            {
                recent_lines.pop_front();
            }
            if recent_lines
                .iter()
                .any(|(_, line_before)| line_before == line)
            {
                return;
            }
            if recent_lines.len() >= MAX_RECENT_LINES {
                recent_lines.pop_front();
            }
            recent_lines.push_back((now, line.to_owned()));
        }
        self.log(line);
    }

    /// Logs a line to stderr, which systemd keeps.
    pub fn log(&self, line: &str) {
        eprintln!("sinew-watch: {line}");
    }
}
