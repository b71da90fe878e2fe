//! The page and the HTTP API.
//!
//! Reading order: [`api`] (what is said), [`routes`] (where), [`guard`] (to whom), `ticks` and `events` (when),
//! `records`, `assets`, [`metrics`], `serve`.

pub mod api;
mod assets;
#[cfg(feature = "schema")]
mod describe;
mod events;
pub mod guard;
mod handlers;
pub mod metrics;
#[cfg(feature = "schema")]
pub mod openapi;
mod records;
pub mod routes;
mod serve;
mod ticks;

pub use serve::serve;
pub use ticks::{Tick, Ticker};

use crate::runtime::{Board, Health, lock};
use crate::store::{Place, Reader, StoreError};
use api::Refusal;
use axum::Json;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use guard::Guard;
use std::sync::{Arc, Mutex};
use tokio::sync::{Semaphore, watch};

/// Browsers that listen at one time, at most.
const LISTENERS: usize = 512;
/// Files of records that are made at one time, at most.
const EXPORTS: usize = 2;
/// Connections for reading that are kept.
const READERS: usize = 8;

/// What every handler knows.
#[derive(Clone)]
pub struct App {
    /// What is known of every robot.
    pub board: Arc<Board>,
    /// How the monitor itself is.
    pub health: Arc<Health>,
    /// Who may ask.
    pub guard: Guard,
    /// What is told every second.
    pub ticks: watch::Receiver<Arc<Tick>>,
    readers: Arc<Readers>,
    listeners: Arc<Semaphore>,
    exports: Arc<Semaphore>,
}

impl App {
    /// With the store in this place.
    pub fn new(
        (board, health): (Arc<Board>, Arc<Health>),
        guard: Guard,
        ticks: watch::Receiver<Arc<Tick>>,
        place: Place,
    ) -> Self {
        Self {
            board,
            health,
            guard,
            ticks,
            readers: Arc::new(Readers {
                place,
                idle: Mutex::default(),
            }),
            listeners: Arc::new(Semaphore::new(LISTENERS)),
            exports: Arc::new(Semaphore::new(EXPORTS)),
        }
    }

    /// Reads the store, on a thread that may wait for the disk.
    async fn read<T: Send + 'static>(
        &self,
        read: impl FnOnce(&Reader) -> Result<T, StoreError> + Send + 'static,
    ) -> Result<T, Refused> {
        let readers = Arc::clone(&self.readers);
        let done = tokio::task::spawn_blocking(move || readers.with(read)).await;
        match done {
            Ok(Ok(value)) => Ok(value),
            Ok(Err(error)) => Err(Refused::unavailable(error.in_words())),
            Err(_panicked) => Err(Refused::new(
                StatusCode::INTERNAL_SERVER_ERROR,
                "reading failed",
            )),
        }
    }
}

/// Connections that read the store.
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
        // One that failed may have lost its file.
        if done.is_ok() && idle.len() < READERS {
            idle.push(reader);
        }
        done
    }
}

/// Why something is refused; said as JSON.
#[derive(Debug)]
struct Refused(StatusCode, String);

impl Refused {
    fn new(status: StatusCode, why: impl Into<String>) -> Self {
        Self(status, why.into())
    }

    fn not_found(why: impl Into<String>) -> Self {
        Self::new(StatusCode::NOT_FOUND, why)
    }

    fn conflict(why: impl Into<String>) -> Self {
        Self::new(StatusCode::CONFLICT, why)
    }

    fn unprocessable(why: impl Into<String>) -> Self {
        Self::new(StatusCode::UNPROCESSABLE_ENTITY, why)
    }

    fn unavailable(why: impl Into<String>) -> Self {
        Self::new(StatusCode::SERVICE_UNAVAILABLE, why)
    }
}

impl IntoResponse for Refused {
    fn into_response(self) -> Response {
        (self.0, Json(Refusal { error: self.1 })).into_response()
    }
}
