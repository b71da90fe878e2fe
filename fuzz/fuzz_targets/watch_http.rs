//! Any request to the monitor's API: no panic, no fault of the server's; what is refused is refused with words.
//!
//! The first byte picks the address, the second the headers; then come a line, which is the path's parameters and the
//! query, and the body.
#![no_main]

use axum::body::{Body, to_bytes};
use axum::http::{Request, StatusCode};
use libfuzzer_sys::fuzz_target;
use sinew_watch::config::WebSettings;
use sinew_watch::runtime::{Health, RobotRegistry, RobotState};
use sinew_watch::store::{Place, Store};
use sinew_watch::web::guard::Guard;
use sinew_watch::web::routes::{API, router};
use sinew_watch::web::{App, Ticker};
use std::sync::{Arc, OnceLock};
use tokio::runtime::Runtime;
use tower::ServiceExt as _;

/// Longest answer looked at, bytes.
const ANSWER_MOST: usize = 1 << 20;

struct Monitor {
    tokio: Runtime,
    app: App,
}

/// Monitor without a token, with an empty store and a robot that is not monitored.
fn monitor() -> &'static Monitor {
    static MONITOR: OnceLock<Monitor> = OnceLock::new();
    MONITOR.get_or_init(|| {
        let place = Place::Memory(0);
        // An in-memory store exists as long as a handle to it.
        std::mem::forget(Store::open(place.clone()).expect("memory"));
        let (registry, health) = (Arc::new(RobotRegistry::default()), Arc::new(Health::new(1)));
        registry
            .slot("arm")
            .put(RobotState::NotMonitored("fuzzed".into()));
        let mut ticker = Ticker::new(Arc::clone(&registry), Arc::clone(&health), None);
        let (_tell, ticks) = tokio::sync::watch::channel(Arc::new(ticker.tick(0.0)));
        let guard = Guard::new(
            &WebSettings::default(),
            Vec::new(),
            &place,
            Arc::clone(&health),
        );
        let (_hooks, webhooks) = tokio::sync::watch::channel(Vec::new());
        let tokio = tokio::runtime::Builder::new_current_thread();
        Monitor {
            tokio: { tokio }.enable_all().build().expect("a runtime"),
            app: App::new((registry, health), guard, ticks, webhooks, place),
        }
    })
}

/// `/api/v1/robots/{robot}` with what is in braces replaced by parts of the line; what is left is the query.
fn address(path: &str, line: &str) -> String {
    let mut parts = line.split('/');
    let mut out = String::new();
    for piece in path.split_inclusive('}') {
        match piece.split_once('{') {
            Some((before, _)) => {
                out.push_str(before);
                out.push_str(parts.next().unwrap_or("arm"));
            }
            None => out.push_str(piece),
        }
    }
    if let Some(query) = parts.next() {
        out.push('?');
        out.push_str(query);
    }
    out
}

fuzz_target!(|bytes: &[u8]| {
    let Some(([at, how], rest)) = bytes.split_first_chunk::<2>() else {
        return;
    };
    let end = rest.iter().position(|b| *b == b'\n').unwrap_or(rest.len());
    let (line, body) = rest.split_at(end);
    let body = body.get(1..).unwrap_or_default();
    let endpoint = &API[usize::from(*at) % API.len()];
    let line = String::from_utf8_lossy(line);
    let mut request = Request::builder()
        .method(endpoint.method.to_uppercase().as_str())
        .uri(address(endpoint.path, &line));
    for (bit, name, value) in [
        (0, "host", "127.0.0.1:8642"),
        (1, "x-sinew", "1"),
        (2, "content-type", "application/json"),
        (3, "accept-encoding", "gzip"),
        (4, "last-event-id", "7"),
        (5, "authorization", "Bearer 7"),
        (6, "cookie", "sinew_watch=7"),
    ] {
        if how & (1 << bit) == 0 {
            request = request.header(name, value);
        }
    }
    // What is no address never comes so far.
    let Ok(request) = request.body(Body::from(body.to_vec())) else {
        return;
    };
    let monitor = monitor();
    monitor.tokio.block_on(async {
        let answer = router(monitor.app.clone()).oneshot(request).await;
        let answer = answer.expect("a router always answers");
        let status = answer.status();
        assert!(
            status != StatusCode::INTERNAL_SERVER_ERROR,
            "{}",
            endpoint.path
        );
        // The event stream does not end.
        if endpoint.path.ends_with("events") {
            return;
        }
        let said = to_bytes(answer.into_body(), ANSWER_MOST).await;
        let said = said.expect("a short answer");
        if status.is_client_error() {
            assert!(
                !said.is_empty(),
                "{}: {status} without a word",
                endpoint.path
            );
        }
    });
});
