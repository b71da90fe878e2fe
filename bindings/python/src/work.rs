//! Rust works on a thread of its own; Python's thread waits without the interpreter, hands on how far the work
//! is, and may be interrupted.
//!
//! A work that is to stop is unwound from where it says next how far it is. Files it was writing are not there then:
//! they get their names last.

use crate::failure::Failure;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// How often Python is asked whether to go on.
const LOOK: Duration = Duration::from_millis(40);
/// How long a work that is to stop is waited for; it goes on in the background until it looks.
const PATIENCE: Duration = Duration::from_secs(2);
/// Stack of the thread, bytes: what a program's main thread has.
const STACK_BYTES: usize = 8 << 20;

/// What a stopped work is unwound with.
struct Stopped;

/// How far a work is, from its thread to Python's.
#[derive(Clone, Default)]
pub(crate) struct Pace(Arc<State>);

#[derive(Default)]
struct State {
    /// Bits of the share, 0 to 1.
    share: AtomicU64,
    /// Counts words, so that a new one is noticed.
    words: AtomicUsize,
    word: Mutex<&'static str>,
    stop: AtomicBool,
}

impl Pace {
    /// Says how far the work is; does not return where it is to stop.
    pub(crate) fn at(&self, done: f64, of: f64) {
        let share = (done / of).clamp(0.0, 1.0);
        if share.is_finite() {
            self.0.share.store(share.to_bits(), Ordering::Relaxed);
        }
        self.look();
    }

    /// Says what is being done.
    pub(crate) fn say(&self, word: &'static str) {
        let mut now = self.0.word.lock().unwrap_or_else(PoisonError::into_inner);
        if *now != word {
            *now = word;
            self.0.words.fetch_add(1, Ordering::Relaxed);
        }
        drop(now);
        self.look();
    }

    fn look(&self) {
        if self.0.stop.load(Ordering::Relaxed) {
            // Past the panic hook: nobody needs to read of it.
            resume_unwind(Box::new(Stopped));
        }
    }

    /// What can be seen of it from outside; changes when it moves on.
    fn seen(&self) -> (u64, usize) {
        let share = self.0.share.load(Ordering::Relaxed);
        (share, self.0.words.load(Ordering::Relaxed))
    }

    fn tell(&self, callback: &Bound<'_, PyAny>) -> PyResult<()> {
        let word = *(self.0.word.lock()).unwrap_or_else(PoisonError::into_inner);
        let share = f64::from_bits(self.0.share.load(Ordering::Relaxed));
        callback.call1((share, word)).map(drop)
    }
}

/// Does a work, `progress(share, word)` being told now and then how far it is.
pub(crate) fn work<T: Send + 'static>(
    py: Python<'_>,
    word: &'static str,
    progress: Option<&Bound<'_, PyAny>>,
    task: impl FnOnce(&Pace) -> Result<T, Failure> + Send + 'static,
) -> PyResult<T> {
    let pace = Pace::default();
    pace.say(word);
    let (done, result) = sync_channel(1);
    // Waited for by this thread alone, from where Python is not held.
    let result = Mutex::new(result);
    let wait = |time| {
        py.detach(|| {
            let result = result.lock().unwrap_or_else(PoisonError::into_inner);
            result.recv_timeout(time)
        })
    };
    let of_thread = pace.clone();
    let thread = std::thread::Builder::new()
        .name("pysinew".into())
        .stack_size(STACK_BYTES);
    thread
        .spawn(move || {
            let outcome = catch_unwind(AssertUnwindSafe(|| task(&of_thread)));
            // Nobody waits for what was interrupted.
            let _ = done.send(outcome);
        })
        .map_err(|e| PyRuntimeError::new_err(format!("no thread to work on: {e}")))?;
    let mut seen = pace.seen();
    loop {
        match wait(LOOK) {
            Ok(outcome) => {
                if let (Some(callback), Ok(Ok(_))) = (progress, &outcome) {
                    pace.at(1.0, 1.0);
                    pace.tell(callback)?;
                }
                return finish(outcome);
            }
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("the work has gone"));
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
        let mut go_on = py.check_signals();
        let now = pace.seen();
        if let (Ok(()), Some(callback), true) = (&go_on, progress, now != seen) {
            seen = now;
            go_on = pace.tell(callback);
        }
        if let Err(why) = go_on {
            pace.0.stop.store(true, Ordering::Relaxed);
            let _ = wait(PATIENCE);
            return Err(why);
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
            let why = text.unwrap_or("it didn't say why");
            Err(PyRuntimeError::new_err(format!(
                "Sinew has a fault of its own here; please report it: {why}"
            )))
        }
    }
}
