//! Events for browsers: one stream each, as fast as it is read. Who is slow skips ticks.

use super::api::EventsAsked;
use super::ticks::Tick;
use super::{App, Refused};
use axum::extract::{Query, State};
use axum::response::sse::{Event, Sse};
use axum::response::{IntoResponse as _, Response};
use futures_util::stream;
use std::convert::Infallible;
use std::sync::Arc;
use tokio::sync::watch;

/// One browser's stream.
struct Listener {
    ticks: watch::Receiver<Arc<Tick>>,
    /// Number of the last tick it was told.
    told: u64,
    robot: Option<String>,
    /// Events of the present tick that are still to be told.
    ready: Vec<Event>,
    _permit: tokio::sync::OwnedSemaphorePermit,
}

impl Listener {
    async fn next(mut self) -> Option<(Result<Event, Infallible>, Self)> {
        while self.ready.is_empty() {
            if self.told > 0 {
                // An error: the monitor ends.
                self.ticks.changed().await.ok()?;
            }
            let tick = Arc::clone(&self.ticks.borrow_and_update());
            if tick.number == self.told {
                self.ticks.changed().await.ok()?;
                continue;
            }
            // Told in reverse, so that popping gives their order.
            if let Some(json) = self.robot.as_deref().and_then(|robot| tick.robot(robot)) {
                self.ready.push(event("robot", &json));
            }
            self.ready.push(match tick.number == self.told + 1 {
                true => event("change", &tick.change),
                false => event("fleet", &tick.fleet),
            });
            self.told = tick.number;
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

/// `GET /api/v1/events`.
pub(super) async fn events(State(app): State<App>, Query(asked): Query<EventsAsked>) -> Response {
    let Ok(permit) = Arc::clone(&app.listeners).try_acquire_owned() else {
        return Refused::unavailable("too many browsers listen; close some").into_response();
    };
    let listener = Listener {
        ticks: app.ticks.clone(),
        told: 0,
        robot: asked.robot,
        ready: Vec::new(),
        _permit: permit,
    };
    Sse::new(stream::unfold(listener, Listener::next)).into_response()
}
