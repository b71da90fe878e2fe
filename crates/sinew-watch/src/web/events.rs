//! Server-sent events: one stream per browser, as fast as it is read. A slow browser skips ticks.

use super::api::{EventsQuery, LiveEvent};
use super::guard::Guard;
use super::ticks::Tick;
use super::{App, ErrorResponse};
use crate::runtime::{LiveSeries, RobotRegistry};
use crate::words::response;
use axum::extract::{Query, State};
use axum::http::HeaderMap;
use axum::response::sse::{Event, Sse};
use axum::response::{IntoResponse as _, Response};
use futures_util::stream;
use std::convert::Infallible;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::watch;
use tokio::time::{Interval, MissedTickBehavior, interval};

/// Maximum number of robots whose states one stream carries: one for each window of a browser.
const MAX_ROBOTS: usize = 64;
/// Interval in which samples of the live series are sent.
const LIVE_INTERVAL: Duration = Duration::from_millis(100);

/// Live series of a tendon for one browser.
struct Live {
    robot: String,
    joint: String,
    /// Series with the number of the next sample; `None`: the robot is not monitored.
    series: Option<(Arc<LiveSeries>, u64)>,
}

impl Live {
    /// Returns an event with the samples since the last one; `None`: there are none.
    fn event(&mut self, registry: &RobotRegistry) -> Option<Event> {
        // Again each time, because the robot may have been removed and added meanwhile.
        let slot = registry.get(&self.robot);
        let series = slot.and_then(|slot| {
            let robot = slot.state().snapshot()?;
            let tendon = robot.tendons.iter().position(|t| t.joint == self.joint)?;
            Some(slot.live.subscribe(tendon))
        });
        self.series = series.map(|series| match &self.series {
            Some((same, next)) if Arc::ptr_eq(same, &series) => (series, *next),
            _ => (series, 0),
        });
        let (series, next) = self.series.as_mut()?;
        let (samples, end) = series.since(*next);
        *next = end;
        if samples.is_empty() {
            return None;
        }
        let data = LiveEvent {
            robot: &self.robot,
            joint: &self.joint,
            samples,
        };
        Some(event("live", &serde_json::to_vec(&data).ok()?))
    }
}

/// Stream of one browser.
struct Listener {
    ticks: watch::Receiver<Arc<Tick>>,
    /// Number of the last tick that was sent.
    last_tick: u64,
    robots: Vec<String>,
    live: Vec<Live>,
    live_timer: Interval,
    registry: Arc<RobotRegistry>,
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
                tokio::select! {
                    // An error: the monitor stops.
                    changed = self.ticks.changed() => changed.ok()?,
                    _ = self.live_timer.tick(), if !self.live.is_empty() => {
                        let live = self.live.iter_mut();
                        self.ready.extend(live.filter_map(|live| live.event(&self.registry)));
                        continue;
                    }
                }
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
    let list = |text: Option<&str>| -> Vec<String> {
        let names = text
            .unwrap_or("")
            .split(',')
            .filter(|name| !name.is_empty());
        names.take(MAX_ROBOTS).map(str::to_owned).collect()
    };
    let live = list(query.live.as_deref()).into_iter().filter_map(|name| {
        // Names of robots contain no slash.
        let (robot, joint) = name.split_once('/')?;
        Some(Live {
            robot: robot.into(),
            joint: joint.into(),
            series: None,
        })
    });
    let mut live_timer = interval(LIVE_INTERVAL);
    live_timer.set_missed_tick_behavior(MissedTickBehavior::Skip);
    let listener = Listener {
        ticks: app.ticks.clone(),
        last_tick: 0,
        robots: list(query.robot.as_deref()),
        live: live.collect(),
        live_timer,
        registry: app.registry,
        guard: app.guard.clone(),
        headers,
        ready: Vec::new(),
        _permit: permit,
    };
    Sse::new(stream::unfold(listener, Listener::next)).into_response()
}
