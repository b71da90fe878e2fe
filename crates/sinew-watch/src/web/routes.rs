//! Where everything is. The router and the OpenAPI description are made of one list.

#[cfg(feature = "schema")]
use super::api::{
    AlarmList, Done, DueAsked, EventsAsked, Fleet, Journal, JournalAsked, Login, Records, RobotNow,
    TendonNow,
};
#[cfg(feature = "schema")]
use super::describe::NoBody;
use super::{App, assets, events, guard, handlers, metrics, records};
#[cfg(feature = "schema")]
use crate::store::RecordQuery;
use axum::Router;
use axum::extract::DefaultBodyLimit;
use axum::middleware::from_fn_with_state;
use axum::routing::{MethodRouter, get, post};
#[cfg(feature = "schema")]
use sinew_watch_core::{command::Command, due::DueList};

/// A body has at most so many bytes.
pub const BODY_MOST: usize = 64 << 10;

/// An address of the HTTP API.
pub struct Endpoint {
    /// `get` or `post`.
    pub method: &'static str,
    /// Address, with its parameters in braces.
    pub path: &'static str,
    /// What it is, in one line.
    pub summary: &'static str,
    handler: fn() -> MethodRouter<App>,
    /// What it takes and gives, for the OpenAPI description.
    #[cfg(feature = "schema")]
    pub(super) describe: fn(&mut super::describe::Maker) -> super::describe::Described,
}

/// A list of addresses: method, address, handler, what it takes (`query` or `body` of a type), what it gives (`json` of a
/// type, or `media` of a kind), and what it is in one line.
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

/// The HTTP API.
#[rustfmt::skip]
pub const API: &[Endpoint] = endpoints! {
    get "/api/v1/fleet" handlers::fleet, () -> json Fleet, "All robots in a line each";
    get "/api/v1/robots/{robot}" handlers::robot, () -> json RobotNow, "What is known of a robot now";
    get "/api/v1/robots/{robot}/tendons/{joint}" handlers::tendon, () -> json TendonNow, "A tendon with its trend and forecast";
    post "/api/v1/robots/{robot}/commands" handlers::command, (body Command) -> json Done, "Tell the monitor something; the answer comes once it is stored";
    get "/api/v1/due" handlers::due, (query DueAsked) -> json DueList, "Which tendons pass a limit when, those first that have";
    get "/api/v1/alarms" handlers::alarms, () -> json AlarmList, "Alarms that aren't normal, the most severe first";
    get "/api/v1/journal" handlers::journal, (query JournalAsked) -> json Journal, "What happened, the newest first";
    get "/api/v1/records" records::json, (query RecordQuery) -> json Records, "Records of sessions, in the order of time";
    get "/api/v1/records.csv" records::csv, (query RecordQuery) -> media "text/csv", "The same as CSV";
    get "/api/v1/records.parquet" records::parquet, (query RecordQuery) -> media "application/vnd.apache.parquet", "The same as Parquet";
    get "/api/v1/robots/{robot}/sessions.csv" records::sessions, () -> media "text/csv", "Of each day and tendon the best record, as `sinew trend` reads it";
    get "/api/v1/events" events::events, (query EventsAsked) -> media "text/event-stream", "Server-sent events: fleet, change and robot, once a second";
    get "/api/v1/openapi.json" handlers::openapi, () -> media "application/json", "This description";
    get "/metrics" metrics::metrics, () -> media "text/plain", "Metrics for Prometheus";
    get "/healthz" handlers::health, () -> media "text/plain", "Whether the monitor works: 200 or 503";
    post "/login" handlers::login, (body Login) -> json Done, "Give the token, get a cookie";
    post "/logout" handlers::logout, (body NoBody) -> json Done, "Give the cookie back";
};

/// Everything there is, behind the guard.
pub fn router(app: App) -> Router {
    let api = API.iter().fold(Router::new(), |router, endpoint| {
        router.route(endpoint.path, (endpoint.handler)())
    });
    let files = [
        "/app.js",
        "/app.css",
        "/icon.svg",
        "/favicon.ico",
        "/",
        "/r/{robot}",
        "/r/{robot}/{joint}",
        "/due",
        "/alarms",
        "/journal",
        "/journal/{robot}",
    ];
    let all = (files.into_iter()).fold(api, |router, path| router.route(path, get(assets::file)));
    all.fallback(guard::not_found)
        .layer(DefaultBodyLimit::max(BODY_MOST))
        .layer(from_fn_with_state(app.guard.clone(), guard::guard))
        .with_state(app)
}
