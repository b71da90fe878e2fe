//! Open transport: its threads and its status.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

/// Error that prevents opening a transport.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TransportError {
    /// An option has an invalid value.
    #[error("{what} = {value}: {reason}")]
    Option {
        /// Name of the option.
        what: &'static str,
        /// Value of the option.
        value: String,
        /// Range or form that is expected.
        reason: String,
    },
    /// The network or its library rejected the connection.
    #[error("{transport}: cannot be opened: {reason}")]
    Rejected {
        /// Name of the transport, such as `dds:0`.
        transport: String,
        /// Reason given by the library.
        reason: String,
    },
    /// The operating system reported an error.
    #[error("{transport}: cannot be opened: {source}")]
    Io {
        /// Name of the transport, such as `dds:0`.
        transport: String,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The file is not a readable MCAP recording.
    #[error("{transport}: cannot be read: {reason}")]
    Content {
        /// Name of the transport, such as `dds:0`.
        transport: String,
        /// Reason why the content is invalid.
        reason: String,
    },
}

/// Status of a transport.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TransportStatus {
    /// Name, such as `dds:0` or `mcap:run.mcap`; stored records name it as their source.
    pub name: String,
    /// Reason of the disconnection; `None`: connected.
    pub disconnected: Option<String>,
    /// Number of messages received so far on topics that a robot requires.
    pub messages: u64,
    /// Whether the transport has ended: the recording was replayed to its end.
    pub ended: bool,
    /// Whether the reader ended with an internal error; the transport must be created again.
    pub failed: bool,
    /// Reason why the last message was not published; `None`: it was published, or there was none.
    pub not_published: Option<String>,
}

/// State shared by the threads of a transport and its owner.
#[derive(Debug)]
pub(crate) struct Shared {
    name: String,
    stop: AtomicBool,
    ended: AtomicBool,
    failed: AtomicBool,
    messages: AtomicU64,
    disconnected: Mutex<Option<String>>,
    not_published: Mutex<Option<String>>,
}

impl Shared {
    pub(crate) fn new(name: String) -> Arc<Self> {
        Arc::new(Shared {
            name,
            stop: AtomicBool::new(false),
            ended: AtomicBool::new(false),
            failed: AtomicBool::new(false),
            messages: AtomicU64::new(0),
            disconnected: Mutex::new(None),
            not_published: Mutex::new(None),
        })
    }

    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    pub(crate) fn stops(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Counts messages before they are passed to the queues, so that a receiver of a message finds it counted.
    pub(crate) fn count(&self, messages: u64) {
        self.messages.fetch_add(messages, Ordering::Relaxed);
    }

    pub(crate) fn end(&self) {
        self.ended.store(true, Ordering::Release);
    }

    pub(crate) fn set_disconnected(&self, reason: Option<String>) {
        *lock(&self.disconnected) = reason;
    }

    #[cfg(any(feature = "dds", feature = "zenoh"))]
    pub(crate) fn set_not_published(&self, reason: Option<String>) {
        *lock(&self.not_published) = reason;
    }
}

/// Locks a mutex even if a thread panicked: every change is complete in itself.
pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Open transport; dropping it closes it and joins its threads.
#[derive(Debug)]
pub struct Transport {
    shared: Arc<Shared>,
    threads: Vec<JoinHandle<()>>,
}

impl Transport {
    /// Runs `work` in a thread named after the transport until it is stopped.
    pub(crate) fn run(
        shared: Arc<Shared>,
        work: impl FnOnce(&Shared) + Send + 'static,
    ) -> Result<Self, TransportError> {
        let inside = Arc::clone(&shared);
        let thread = std::thread::Builder::new()
            .name(shared.name.clone())
            .spawn(move || {
                // Foreign bytes are decoded here: a panic costs this transport only, until it is created again.
                if catch_unwind(AssertUnwindSafe(|| work(&inside))).is_err() {
                    inside.set_disconnected(Some("internal error of the reader".to_owned()));
                    inside.failed.store(true, Ordering::Release);
                }
            })
            .map_err(|source| TransportError::Io {
                transport: shared.name.clone(),
                source,
            })?;
        Ok(Transport {
            shared,
            threads: vec![thread],
        })
    }

    /// Returns the thread of the transport, to wake it.
    #[cfg(any(feature = "dds", feature = "zenoh"))]
    pub(crate) fn thread(&self) -> Option<&std::thread::Thread> {
        self.threads.first().map(JoinHandle::thread)
    }

    /// Returns the present status.
    pub fn status(&self) -> TransportStatus {
        TransportStatus {
            name: self.shared.name.clone(),
            disconnected: lock(&self.shared.disconnected).clone(),
            not_published: lock(&self.shared.not_published).clone(),
            messages: self.shared.messages.load(Ordering::Relaxed),
            ended: self.shared.ended.load(Ordering::Acquire),
            failed: self.shared.failed.load(Ordering::Acquire),
        }
    }
}

impl Drop for Transport {
    fn drop(&mut self) {
        self.shared.stop.store(true, Ordering::Relaxed);
        for thread in self.threads.drain(..) {
            thread.thread().unpark();
            // A transport thread that panicked has nothing to report.
            let _panicked = thread.join();
        }
    }
}
