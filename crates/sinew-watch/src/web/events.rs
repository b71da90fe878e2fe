//! Server-sent events: one stream per browser, as fast as it is read. A slow browser skips ticks.

use super::api::EventsQuery;
use super::guard::Guard;
use super::ticks::Tick;
use super::{App, ErrorResponse};
use crate::words::response;
use axum::extract::{Query, State};
use axum::http::HeaderMap;
use axum::response::sse::{Event, Sse};
use axum::response::{IntoResponse as _, Response};
use futures_util::stream;
use std::convert::Infallible;
use std::sync::Arc;
use tokio::sync::watch;

/// Maximum number of robots whose states one stream carries: one for each window of a browser.
const MAX_ROBOTS: usize = 64;

/// Stream of one browser.
struct Listener {
    ticks: watch::Receiver<Arc<Tick>>,
    /// Number of the last tick that was sent.
    last_tick: u64,
    robots: Vec<String>,
    /// Access of the request: the stream ends with its login.
    guard: Guard,
    headers: HeaderMap,
    /// Events of the present tick that remain to be sent.
    ready: Vec<Event>,
    _permit: tokio::sync::OwnedSemaphorePermit,
}

impl Listener {
    async fn next(mut self) -> Option<(Result<Event, Infallible>, Self)> {
        while self.ready.is_empty() {
            if self.last_tick > 0 {
                // An error: the monitor stops.
                self.ticks.changed().await.ok()?;
            }
            if !self.guard.remains(&self.headers) {
                return None;
            }
            let tick = Arc::clone(&self.ticks.borrow_and_update());
            if tick.number == self.last_tick {
                self.ticks.changed().await.ok()?;
                continue;
            }
            // In reverse order, because events are popped from the end.
            let robots = self.robots.iter().filter_map(|robot| tick.robot(robot));
            self.ready.extend(robots.map(|json| event("robot", &json)));
            self.ready.push(match tick.number == self.last_tick + 1 {
                true => event("change", &tick.change),
                false => event("fleet", &tick.fleet),
            });
            self.last_tick = tick.number;
        }
        let event = self.ready.pop()?;
        Some((Ok(event), self))
    }
}

fn event(name: &str, json: &[u8]) -> Event {
    Event::default()
        .event(name)
        .data(String::from_utf8_lossy(json))
}

/// Starts the event stream of `GET /api/v1/events`.
pub(super) async fn events(
    State(app): State<App>,
    Query(query): Query<EventsQuery>,
    headers: HeaderMap,
) -> Response {
    let Ok(permit) = Arc::clone(&app.listeners).try_acquire_owned() else {
        return ErrorResponse::unavailable(response::TOO_MANY_PAGES).into_response();
    };
    let listener = Listener {
        ticks: app.ticks.clone(),
        last_tick: 0,
        robots: (query.robot.as_deref().unwrap_or("").split(','))
            .filter(|robot| !robot.is_empty())
            .take(MAX_ROBOTS)
            .map(str::to_owned)
            .collect(),
        guard: app.guard.clone(),
        headers,
        ready: Vec::new(),
        _permit: permit,
    };
    Sse::new(stream::unfold(listener, Listener::next)).into_response()
}
