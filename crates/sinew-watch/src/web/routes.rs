//! Where everything is. The router and the OpenAPI description are made of one list.

use super::{App, assets, events, guard, handlers, metrics, records};
use axum::Router;
use axum::extract::DefaultBodyLimit;
use axum::middleware::from_fn_with_state;
use axum::routing::{MethodRouter, get, post};

/// A body has at most so many bytes.
pub const BODY_MOST: usize = 64 << 10;

/// One address.
pub struct Endpoint {
    /// `get` or `post`.
    pub method: &'static str,
    /// Address, with its parameters in braces.
    pub path: &'static str,
    /// What it is, in one line.
    pub summary: &'static str,
    handler: fn() -> MethodRouter<App>,
}

macro_rules! endpoints {
    ($($method:ident $path:literal $handler:path, $summary:literal;)*) => {
        &[$(Endpoint {
            method: stringify!($method),
            path: $path,
            summary: $summary,
            handler: || $method($handler),
        }),*]
    };
}

/// The HTTP API.
pub const API: &[Endpoint] = endpoints! {
    get "/api/v1/fleet" handlers::fleet, "All robots in a line each";
    get "/api/v1/robots/{robot}" handlers::robot, "What is known of a robot now";
    get "/api/v1/robots/{robot}/tendons/{joint}" handlers::tendon, "A tendon with its trend and forecast";
    post "/api/v1/robots/{robot}/commands" handlers::command, "Tell the monitor something; the answer comes once it is stored";
    get "/api/v1/due" handlers::due, "Which tendons pass a limit when, those first that have";
    get "/api/v1/alarms" handlers::alarms, "Alarms that aren't normal, the most severe first";
    get "/api/v1/journal" handlers::journal, "What happened, the newest first";
    get "/api/v1/records" records::json, "Records of sessions, in the order of time";
    get "/api/v1/records.csv" records::csv, "The same as CSV";
    get "/api/v1/records.parquet" records::parquet, "The same as Parquet";
    get "/api/v1/robots/{robot}/sessions.csv" records::sessions, "Of each day and tendon the best record, as `sinew trend` reads it";
    get "/api/v1/events" events::events, "Server-sent events: fleet, change and robot, once a second";
    get "/api/v1/openapi.json" handlers::openapi, "This description";
    get "/metrics" metrics::metrics, "Metrics for Prometheus";
    get "/healthz" handlers::health, "Whether the monitor works: 200 or 503";
    post "/login" handlers::login, "Give the token, get a cookie";
    post "/logout" handlers::logout, "Give the cookie back";
};

/// Everything there is, behind the guard.
pub fn router(app: App) -> Router {
    let api = API.iter().fold(Router::new(), |router, endpoint| {
        router.route(endpoint.path, (endpoint.handler)())
    });
    let page = || get(assets::html);
    api.route("/app.js", get(assets::script))
        .route("/app.css", get(assets::style))
        .route("/icon.svg", get(assets::icon))
        .route("/favicon.ico", get(assets::icon))
        .route("/", page())
        .route("/r/{robot}", page())
        .route("/r/{robot}/{joint}", page())
        .route("/due", page())
        .route("/alarms", page())
        .route("/journal", page())
        .route("/journal/{robot}", page())
        .fallback(guard::not_found)
        .layer(DefaultBodyLimit::max(BODY_MOST))
        .layer(from_fn_with_state(app.guard.clone(), guard::guard))
        .with_state(app)
}
