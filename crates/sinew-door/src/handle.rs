//! A door that stands open: its threads, and what it says of itself.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

/// Why a door can't be opened.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DoorError {
    /// The options ask for what can't be.
    #[error("{what} = {value}: {why}")]
    Option {
        /// Name of the option.
        what: &'static str,
        /// The value that was given.
        value: String,
        /// What it may be.
        why: String,
    },
    /// The network's library refused.
    #[error("{door}: can't be opened: {why}")]
    Refused {
        /// The door's name, such as `dds:0`.
        door: String,
        /// The reason.
        why: String,
    },
    /// The operating system refused.
    #[error("{door}: can't be opened: {source}")]
    Io {
        /// The door's name, such as `dds:0`.
        door: String,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// What is there isn't what is looked for.
    #[error("{door}: can't be read: {why}")]
    Content {
        /// The door's name, such as `dds:0`.
        door: String,
        /// The reason.
        why: String,
    },
}

/// What a door says of itself.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DoorStatus {
    /// Its name, such as `dds:0` or `mcap:run.mcap`; records say that they came from there.
    pub name: String,
    /// Why nothing comes; `None`: it is open.
    pub shut: Option<String>,
    /// Messages received so far of topics that some robot wants.
    pub messages: u64,
    /// Whether it has nothing more to bring: a recording that was played to its end.
    pub ended: bool,
    /// Why the last message wasn't published; `None`: it was, or there was none.
    pub not_published: Option<String>,
}

/// What door threads and their owner share.
#[derive(Debug)]
pub(crate) struct Shared {
    name: String,
    stop: AtomicBool,
    ended: AtomicBool,
    messages: AtomicU64,
    shut: Mutex<Option<String>>,
    not_published: Mutex<Option<String>>,
}

impl Shared {
    pub(crate) fn new(name: String) -> Arc<Self> {
        Arc::new(Shared {
            name,
            stop: AtomicBool::new(false),
            ended: AtomicBool::new(false),
            messages: AtomicU64::new(0),
            shut: Mutex::new(None),
            not_published: Mutex::new(None),
        })
    }

    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    pub(crate) fn stops(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Before they are handed on: whoever has a message finds it counted.
    pub(crate) fn count(&self, messages: u64) {
        self.messages.fetch_add(messages, Ordering::Relaxed);
    }

    pub(crate) fn end(&self) {
        self.ended.store(true, Ordering::Release);
    }

    pub(crate) fn set_shut(&self, why: Option<String>) {
        *lock(&self.shut) = why;
    }

    #[cfg(any(feature = "dds", feature = "zenoh"))]
    pub(crate) fn set_not_published(&self, why: Option<String>) {
        *lock(&self.not_published) = why;
    }
}

/// A thread that panicked left whole values behind: every change is complete in itself.
pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A door that stands open; dropping it shuts it and waits for its threads.
#[derive(Debug)]
pub struct Door {
    shared: Arc<Shared>,
    threads: Vec<JoinHandle<()>>,
}

impl Door {
    /// Runs `work` in a thread of the door's name until it is told to stop.
    pub(crate) fn run(
        shared: Arc<Shared>,
        work: impl FnOnce(&Shared) + Send + 'static,
    ) -> Result<Self, DoorError> {
        let inside = Arc::clone(&shared);
        let thread = std::thread::Builder::new()
            .name(shared.name.clone())
            .spawn(move || work(&inside))
            .map_err(|source| DoorError::Io {
                door: shared.name.clone(),
                source,
            })?;
        Ok(Door {
            shared,
            threads: vec![thread],
        })
    }

    /// Its thread, to be woken.
    #[cfg(any(feature = "dds", feature = "zenoh"))]
    pub(crate) fn thread(&self) -> Option<&std::thread::Thread> {
        self.threads.first().map(JoinHandle::thread)
    }

    /// What it says of itself.
    pub fn status(&self) -> DoorStatus {
        DoorStatus {
            name: self.shared.name.clone(),
            shut: lock(&self.shared.shut).clone(),
            not_published: lock(&self.shared.not_published).clone(),
            messages: self.shared.messages.load(Ordering::Relaxed),
            ended: self.shared.ended.load(Ordering::Acquire),
        }
    }
}

impl Drop for Door {
    fn drop(&mut self) {
        self.shared.stop.store(true, Ordering::Relaxed);
        for thread in self.threads.drain(..) {
            thread.thread().unpark();
            // A door that panicked has nothing left to say.
            let _panicked = thread.join();
        }
    }
}
