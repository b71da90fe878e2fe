//! Endpoints of the HTTP API: the router and the OpenAPI description are generated from one list.

#[cfg(feature = "schema")]
use super::api::{
    AlarmList, Done, DueQuery, EventsQuery, Fleet, Journal, JournalQuery, Login, Records, RobotNow,
    TendonNow, TestResults,
};
#[cfg(feature = "schema")]
use super::describe::EmptyBody;
use super::{App, assets, events, guard, handlers, metrics, records, serve};
#[cfg(feature = "schema")]
use crate::store::{RecordQuery, Series, SeriesQuery};
use axum::Router;
use axum::middleware::{from_fn, from_fn_with_state};
use axum::routing::{MethodRouter, get, post};
#[cfg(feature = "schema")]
use sinew_watch_core::{command::Command, due::DueList};

/// Endpoint of the HTTP API.
pub struct Endpoint {
    /// HTTP method, `get` or `post`.
    pub method: &'static str,
    /// Path with its parameters in braces.
    pub path: &'static str,
    /// Summary in one line.
    pub summary: &'static str,
    handler: fn() -> MethodRouter<App>,
    /// Generator of the request and response schemas.
    #[cfg(feature = "schema")]
    pub(super) describe: fn(&mut super::describe::Maker) -> super::describe::Described,
}

/// Defines the endpoints: method, path, handler, request (`query` or `body` of a type), response (`json` of a type,
/// or `media` of a kind), and summary.
macro_rules! endpoints {
    ($($method:ident $path:literal $handler:path, ($($takes:ident $of:ty)?) -> $gives:ident $what:tt, $summary:literal;)*) => {
        &[$(Endpoint {
            method: stringify!($method),
            path: $path,
            summary: $summary,
            handler: || $method($handler),
            #[cfg(feature = "schema")]
            describe: |maker| super::describe::Described {
                $($takes: maker.takes::<$of>(),)?
                ..endpoints!(@gives maker $gives $what)
            },
        }),*]
    };
    (@gives $maker:ident json $what:tt) => { $maker.json::<$what>() };
    (@gives $maker:ident media $what:tt) => { $maker.media($what) };
}

/// Endpoints of the HTTP API.
#[rustfmt::skip]
pub const API: &[Endpoint] = endpoints! {
    get "/api/v1/fleet" handlers::fleet, () -> json Fleet, "Summary of all robots";
    get "/api/v1/robots/{robot}" handlers::robot, () -> json RobotNow, "State of a robot";
    get "/api/v1/robots/{robot}/tendons/{joint}" handlers::tendon, () -> json TendonNow, "State of a tendon with trend and forecast";
    post "/api/v1/robots/{robot}/commands" handlers::command, (body Command) -> json Done, "Execute an operator command; responds once it is stored; role operate";
    get "/api/v1/robots/{robot}/tendons/{joint}/series" handlers::series, (query SeriesQuery) -> json Series, "Records of a tendon over any time, reduced to a number of points";
    get "/api/v1/robots/{robot}/incidents/{number}/recording.mcap" records::recording, () -> media "application/octet-stream", "Frames around the change of an incident, input of `sinew estimate`";
    get "/api/v1/due.ics" handlers::calendar, (query DueQuery) -> media "text/calendar", "Maintenance forecast as a calendar";
    get "/api/v1/due" handlers::due, (query DueQuery) -> json DueList, "Maintenance forecast: tendons by date of limit exceedance, exceeded limits first";
    get "/api/v1/alarms" handlers::alarms, () -> json AlarmList, "Alarms that are not normal, the most severe first";
    get "/api/v1/journal" handlers::journal, (query JournalQuery) -> json Journal, "Journal entries, the newest first";
    get "/api/v1/records" records::json, (query RecordQuery) -> json Records, "Records of sessions in chronological order";
    get "/api/v1/records.csv" records::csv, (query RecordQuery) -> media "text/csv", "Records of sessions as CSV";
    get "/api/v1/records.parquet" records::parquet, (query RecordQuery) -> media "application/vnd.apache.parquet", "Records of sessions as Parquet";
    get "/api/v1/robots/{robot}/sessions.csv" records::sessions, () -> media "text/csv", "Best record of each day and tendon, input of `sinew trend`";
    get "/api/v1/survival.csv" records::lives, () -> media "text/csv", "Lifetimes of ropes by replacements and findings, input of `sinew trend survival`";
    get "/api/v1/events" events::events, (query EventsQuery) -> media "text/event-stream", "Server-sent events: fleet, change and robot, once a second; live, at 10 Hz";
    get "/api/v1/openapi.json" handlers::openapi, () -> media "application/json", "This description";
    post "/api/v1/notify/test" handlers::test_notifications, (body EmptyBody) -> json TestResults, "Send a test notification to every receiver; role operate";
    get "/metrics" metrics::metrics, () -> media "text/plain", "Metrics for Prometheus";
    get "/healthz" handlers::health, () -> media "text/plain", "Whether the monitor works: 200 or 503";
    post "/login" handlers::login, (body Login) -> json Done, "Log in with the token; sets a cookie";
    post "/logout" handlers::logout, (body EmptyBody) -> json Done, "Log out; removes the cookie";
};

/// Returns the router of all endpoints, behind the access control.
pub fn router(app: App) -> Router {
    let api = API.iter().fold(Router::new(), |router, endpoint| {
        router.route(endpoint.path, (endpoint.handler)())
    });
    let files = [
        "/app.js",
        "/stream.js",
        "/app.css",
        "/icon.svg",
        "/favicon.ico",
        "/",
        "/r/{robot}",
        "/r/{robot}/{joint}",
        "/due",
        "/plan",
        "/compare",
        "/alarms",
        "/journal",
        "/journal/{robot}",
    ];
    let all = (files.into_iter()).fold(api, |router, path| router.route(path, get(assets::file)));
    all.fallback(guard::not_found)
        .layer(from_fn(serve::complete))
        .layer(from_fn_with_state(app.guard.clone(), guard::guard))
        .with_state(app)
}
