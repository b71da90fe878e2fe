//! Web page and HTTP API.
//!
//! Reading order: [`api`] (types), [`routes`] (addresses), [`guard`] (access control), `ticks` and `events`
//! (updates), `records`, `assets`, [`metrics`], `serve`.

pub mod api;
mod assets;
mod calendar;
#[cfg(feature = "schema")]
mod describe;
mod events;
pub mod guard;
mod handlers;
mod logins;
pub mod metrics;
#[cfg(feature = "schema")]
pub mod openapi;
mod records;
pub mod routes;
mod serve;
mod ticks;

pub use serve::serve;
pub use ticks::{Tick, Ticker};

use crate::config::Receiver;
use crate::runtime::{Health, RobotRegistry, lock};
use crate::store::{Place, Reader, StoreError};
use crate::words::response;
use api::ErrorBody;
use axum::Json;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use guard::Guard;
use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use tokio::sync::{Semaphore, watch};

/// Maximum number of simultaneous event streams.
const MAX_STREAMS: usize = 512;
/// Maximum number of simultaneous exports.
const MAX_EXPORTS: usize = 2;
/// Maximum number of idle connections to the store.
const MAX_IDLE_READERS: usize = 8;

/// State shared by all handlers.
#[derive(Clone)]
pub struct App {
    /// Registry of all robots.
    pub registry: Arc<RobotRegistry>,
    /// Health of the monitor.
    pub health: Arc<Health>,
    /// Access control of the page and the API.
    pub guard: Guard,
    /// Updates sent every second.
    pub ticks: watch::Receiver<Arc<Tick>>,
    /// Receivers of alarm notifications.
    pub receivers: watch::Receiver<Vec<Receiver>>,
    readers: Arc<Readers>,
    listeners: Arc<Semaphore>,
    exports: Arc<Semaphore>,
}

impl App {
    /// Creates the state for the store in this place.
    pub fn new(
        (registry, health): (Arc<RobotRegistry>, Arc<Health>),
        guard: Guard,
        ticks: watch::Receiver<Arc<Tick>>,
        receivers: watch::Receiver<Vec<Receiver>>,
        place: Place,
    ) -> Self {
        Self {
            registry,
            health,
            guard,
            ticks,
            receivers,
            readers: Arc::new(Readers {
                place,
                idle: Mutex::default(),
            }),
            listeners: Arc::new(Semaphore::new(MAX_STREAMS)),
            exports: Arc::new(Semaphore::new(MAX_EXPORTS)),
        }
    }

    /// Returns a folder for temporary files: that of the store, as `/tmp` may be in memory.
    fn temporary_folder(&self) -> PathBuf {
        let folder = self.readers.place.folder();
        folder.map_or_else(std::env::temp_dir, PathBuf::from)
    }

    /// Reads the store in a thread that may wait for the disk.
    async fn read<T: Send + 'static>(
        &self,
        read: impl FnOnce(&Reader) -> Result<T, StoreError> + Send + 'static,
    ) -> Result<T, ErrorResponse> {
        let readers = Arc::clone(&self.readers);
        let done = tokio::task::spawn_blocking(move || readers.with(read)).await;
        match done {
            Ok(Ok(value)) => Ok(value),
            Ok(Err(error)) => Err(ErrorResponse::unavailable(error.in_words())),
            Err(_panicked) => Err(ErrorResponse::new(
                StatusCode::INTERNAL_SERVER_ERROR,
                response::STORE_NOT_READ,
            )),
        }
    }
}

/// Pool of connections that read the store.
struct Readers {
    place: Place,
    idle: Mutex<Vec<Reader>>,
}

impl Readers {
    fn with<T>(
        &self,
        read: impl FnOnce(&Reader) -> Result<T, StoreError>,
    ) -> Result<T, StoreError> {
        let kept = lock(&self.idle).pop();
        let reader = match kept {
            Some(reader) => reader,
            None => Reader::open(&self.place)?,
        };
        let done = read(&reader);
        let mut idle = lock(&self.idle);
        // A connection that failed may have lost its file.
        if done.is_ok() && idle.len() < MAX_IDLE_READERS {
            idle.push(reader);
        }
        done
    }
}

/// Error response with status and reason, sent as JSON.
#[derive(Debug)]
struct ErrorResponse(StatusCode, String);

impl ErrorResponse {
    fn new(status: StatusCode, reason: impl Into<String>) -> Self {
        Self(status, reason.into())
    }

    fn not_found(reason: impl Into<String>) -> Self {
        Self::new(StatusCode::NOT_FOUND, reason)
    }

    fn conflict(reason: impl Into<String>) -> Self {
        Self::new(StatusCode::CONFLICT, reason)
    }

    fn unprocessable(reason: impl Into<String>) -> Self {
        Self::new(StatusCode::UNPROCESSABLE_ENTITY, reason)
    }

    fn unavailable(reason: impl Into<String>) -> Self {
        Self::new(StatusCode::SERVICE_UNAVAILABLE, reason)
    }
}

impl IntoResponse for ErrorResponse {
    fn into_response(self) -> Response {
        (self.0, Json(ErrorBody { error: self.1 })).into_response()
    }
}
