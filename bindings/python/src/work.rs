//! Runs Rust work on threads of its own. Python's thread waits without the interpreter lock, reports progress, and can be
//! interrupted.
//!
//! Every call has its own [`pool`] of threads. No thread is left over for the next call, so that a process may fork between two
//! calls: the threads of a pool exist in the parent only, and a child that waits for them never ends.
//!
//! Interrupted work is unwound at its next progress report or [`interrupt::check`], on whichever of its threads that is. Incomplete
//! files do not remain, because a file receives its final name last.

use crate::failure::Failure;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use sinew_files::interrupt;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// Interval at which Python checks for interrupts.
const POLL_INTERVAL: Duration = Duration::from_millis(10);
/// Maximum time to wait for interrupted work, which otherwise continues in the background until its next check. With
/// [`POLL_INTERVAL`] it is half of the 0.1 s within which an interrupt is promised; the other half is for a busy machine.
const STOP_TIMEOUT: Duration = Duration::from_millis(40);
/// Stack size of a thread, bytes; equal to that of a main thread.
const STACK_BYTES: usize = 8 << 20;

/// Progress of the work, shared between its thread and Python's.
#[derive(Clone, Default)]
pub(crate) struct ProgressTracker(Arc<State>);

#[derive(Default)]
struct State {
    /// Bits of the completed share, 0 to 1.
    share: AtomicU64,
    /// Number of stages so far, which reveals a new one.
    words: AtomicUsize,
    word: Mutex<&'static str>,
    stop: Arc<AtomicBool>,
}

impl ProgressTracker {
    /// Reports progress; does not return if the work is interrupted.
    pub(crate) fn at(&self, done: f64, of: f64) {
        let share = (done / of).clamp(0.0, 1.0);
        if share.is_finite() {
            self.0.share.store(share.to_bits(), Ordering::Relaxed);
        }
        interrupt::check();
    }

    /// Reports the current stage.
    pub(crate) fn set_stage(&self, word: &'static str) {
        let mut now = self.0.word.lock().unwrap_or_else(PoisonError::into_inner);
        if *now != word {
            *now = word;
            self.0.words.fetch_add(1, Ordering::Relaxed);
        }
        drop(now);
        interrupt::check();
    }

    /// Progress visible to Python; the value changes when the work proceeds.
    fn seen(&self) -> (u64, usize) {
        let share = self.0.share.load(Ordering::Relaxed);
        (share, self.0.words.load(Ordering::Relaxed))
    }

    fn notify(&self, callback: &Bound<'_, PyAny>) -> PyResult<()> {
        let word = *(self.0.word.lock()).unwrap_or_else(PoisonError::into_inner);
        let share = f64::from_bits(self.0.share.load(Ordering::Relaxed));
        callback.call1((share, word)).map(drop)
    }
}

/// Starts the threads of one call, one per processor. Their work ends at its next check after `stop` has become true. They end
/// when the pool is dropped and their work is done.
pub(crate) fn pool(stop: &Arc<AtomicBool>) -> PyResult<ThreadPool> {
    let stop = stop.clone();
    ThreadPoolBuilder::new()
        .thread_name(|i| format!("pysinew-{i}"))
        .stack_size(STACK_BYTES)
        .start_handler(move |_| interrupt::watch(stop.clone()))
        .build()
        .map_err(|e| PyRuntimeError::new_err(format!("cannot start threads: {e}")))
}

/// Runs work on threads of its own and calls `progress(share, stage)` from time to time.
pub(crate) fn work<T: Send + 'static>(
    py: Python<'_>,
    word: &'static str,
    progress: Option<&Bound<'_, PyAny>>,
    task: impl FnOnce(&ProgressTracker) -> Result<T, Failure> + Send + 'static,
) -> PyResult<T> {
    let tracker = ProgressTracker::default();
    tracker.set_stage(word);
    let (done, result) = sync_channel(1);
    // Waited for by this thread alone, from where Python is not held.
    let result = Mutex::new(result);
    let wait = |time| {
        py.detach(|| {
            let result = result.lock().unwrap_or_else(PoisonError::into_inner);
            result.recv_timeout(time)
        })
    };
    let of_thread = tracker.clone();
    let pool = pool(&tracker.0.stop)?;
    pool.spawn(move || {
        let outcome = catch_unwind(AssertUnwindSafe(|| task(&of_thread)));
        // Results of interrupted work are discarded.
        let _ = done.send(outcome);
    });
    let mut seen = tracker.seen();
    loop {
        match wait(POLL_INTERVAL) {
            Ok(outcome) => {
                if let (Some(callback), Ok(Ok(_))) = (progress, &outcome) {
                    tracker.at(1.0, 1.0);
                    tracker.notify(callback)?;
                }
                return finish(outcome);
            }
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("the worker thread has ended"));
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
        let mut signals = py.check_signals();
        let now = tracker.seen();
        if let (Ok(()), Some(callback), true) = (&signals, progress, now != seen) {
            seen = now;
            signals = tracker.notify(callback);
        }
        if let Err(reason) = signals {
            tracker.0.stop.store(true, Ordering::Relaxed);
            let _ = wait(STOP_TIMEOUT);
            return Err(reason);
        }
    }
}

/// The result, or the exception.
fn finish<T>(outcome: Result<Result<T, Failure>, Box<dyn Any + Send>>) -> PyResult<T> {
    match outcome {
        Ok(result) => Ok(result?),
        Err(payload) => {
            let text = payload.downcast_ref::<String>().map(String::as_str);
            let text = text.or(payload.downcast_ref::<&str>().copied());
            let reason = text.unwrap_or("no reason reported");
            Err(PyRuntimeError::new_err(format!(
                "internal error of Sinew; please report it: {reason}"
            )))
        }
    }
}
