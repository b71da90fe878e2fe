//! Access control, and the security headers of responses.
//!
//! A page of another site that a browser has open must neither read nor write here. Therefore the Host header must
//! name this host (no DNS rebinding), no CORS header is ever sent, writing requires a custom header and JSON, cookies
//! are HttpOnly and SameSite=Strict, and a policy lets the page load only its own parts.

use crate::config::WebSettings;
use crate::hex::hex;
use crate::words::response;
use axum::extract::{Request, State};
use axum::http::{HeaderMap, HeaderName, HeaderValue, Method, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse as _, Response};
use sha2::{Digest as _, Sha256};
use std::net::IpAddr;
use std::sync::Arc;

/// Header that every writing request requires.
pub const WRITES: HeaderName = HeaderName::from_static("x-sinew");
/// Name of the cookie.
const COOKIE: &str = "sinew_watch";
/// Duration of a login, s.
const LOGIN_S: u64 = 30 * 86_400;

const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; \
                      form-action 'self'; base-uri 'none'; frame-ancestors 'none'";

/// Access control of the page and the API.
#[derive(Debug, Clone)]
pub struct Guard {
    host_names: Arc<[String]>,
    /// Access token, where one is required.
    token: Option<Arc<str>>,
}

impl Guard {
    /// Creates the access control from the settings; `token` where one is required.
    pub fn new(settings: &WebSettings, token: Option<String>) -> Self {
        Self {
            host_names: settings.host_names.clone().into(),
            token: token.map(Arc::from),
        }
    }

    /// Whether a token is required.
    pub fn needs_token(&self) -> bool {
        self.token.is_some()
    }

    /// Whether this is the token; takes as long for a wrong token as for the right one.
    pub fn is_token(&self, candidate: &str) -> bool {
        self.token
            .as_deref()
            .is_none_or(|token| is_same(token, candidate))
    }

    /// Returns the cookie of a successful login.
    pub fn cookie(&self, over_tls: bool) -> Option<HeaderValue> {
        let value = login_of(self.token.as_deref()?);
        let secure = if over_tls { "; Secure" } else { "" };
        let text = format!(
            "{COOKIE}={value}; HttpOnly; SameSite=Strict; Path=/; Max-Age={LOGIN_S}{secure}"
        );
        HeaderValue::from_str(&text).ok()
    }

    /// Returns the cookie that ends a login.
    pub fn no_cookie() -> HeaderValue {
        HeaderValue::from_static("sinew_watch=; HttpOnly; SameSite=Strict; Path=/; Max-Age=0")
    }

    fn may(&self, headers: &HeaderMap) -> bool {
        let Some(token) = self.token.as_deref() else {
            return true;
        };
        let text = |name| {
            headers
                .get(name)
                .and_then(|value: &HeaderValue| value.to_str().ok())
        };
        let bearer = text(header::AUTHORIZATION).and_then(|text| text.strip_prefix("Bearer "));
        if bearer.is_some_and(|candidate| is_same(token, candidate)) {
            return true;
        }
        let login = login_of(token);
        let cookies = text(header::COOKIE).unwrap_or("").split(';');
        let mut own = cookies.filter_map(|c| c.trim().strip_prefix(COOKIE)?.strip_prefix('='));
        own.any(|value| is_same(&login, value))
    }

    /// Whether a Host header names this host. An address cannot be rebound; a name can.
    fn is_own_host(&self, host: &str) -> bool {
        let name = match host.rsplit_once(':') {
            Some((name, port)) if port.bytes().all(|b| b.is_ascii_digit()) => name,
            _ => host,
        };
        let bare = name.trim_start_matches('[').trim_end_matches(']');
        bare.parse::<IpAddr>().is_ok()
            || name.eq_ignore_ascii_case("localhost")
            || self
                .host_names
                .iter()
                .any(|own| name.eq_ignore_ascii_case(own))
    }
}

/// Compares hashes, so that the duration reveals nothing of the secret.
fn is_same(secret: &str, candidate: &str) -> bool {
    Sha256::digest(secret) == Sha256::digest(candidate)
}

/// Returns the content of the cookie: it reveals nothing of the token, and expires with it.
fn login_of(token: &str) -> String {
    hex(&Sha256::digest(format!("sinew-watch login\n{token}")))
}

/// Whether a path is accessible without a token: the page itself, which contains no data, and the login.
fn is_open(path: &str) -> bool {
    let is_data = path.starts_with("/api/") || path == "/metrics";
    !is_data
}

/// Rejects requests without access, and adds the security headers to responses.
pub async fn guard(State(guard): State<Guard>, request: Request, next: Next) -> Response {
    let mut response = match rejection(&guard, &request) {
        Some((status, reason)) => super::ErrorResponse::new(status, reason).into_response(),
        None => next.run(request).await,
    };
    let headers = response.headers_mut();
    let security_headers = [
        (header::CONTENT_SECURITY_POLICY, POLICY),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::X_FRAME_OPTIONS, "DENY"),
        (header::REFERRER_POLICY, "no-referrer"),
        (
            HeaderName::from_static("cross-origin-resource-policy"),
            "same-origin",
        ),
    ];
    for (name, value) in security_headers {
        headers.insert(name, HeaderValue::from_static(value));
    }
    headers
        .entry(header::CACHE_CONTROL)
        .or_insert(HeaderValue::from_static("no-store"));
    response
}

fn rejection(guard: &Guard, request: &Request) -> Option<(StatusCode, &'static str)> {
    let headers = request.headers();
    let text = |name: HeaderName| headers.get(name).and_then(|value| value.to_str().ok());
    let Some(host) = text(header::HOST).filter(|host| guard.is_own_host(host)) else {
        return Some((StatusCode::MISDIRECTED_REQUEST, response::UNKNOWN_HOST));
    };
    let path = request.uri().path();
    if !is_open(path) && !guard.may(headers) {
        return Some((StatusCode::UNAUTHORIZED, response::TOKEN_REQUIRED));
    }
    if *request.method() == Method::GET || *request.method() == Method::HEAD {
        return None;
    }
    if headers.get(WRITES).is_none() {
        return Some((StatusCode::FORBIDDEN, response::HEADER_REQUIRED));
    }
    let is_json = text(header::CONTENT_TYPE).is_some_and(|t| t.starts_with("application/json"));
    if !is_json {
        return Some((StatusCode::UNSUPPORTED_MEDIA_TYPE, response::JSON_REQUIRED));
    }
    let of_site = text(HeaderName::from_static("sec-fetch-site"));
    let from = text(header::ORIGIN).and_then(|origin| origin.split_once("://"));
    let is_foreign = of_site.is_some_and(|site| !["same-origin", "none"].contains(&site))
        || from.is_some_and(|(_, from)| !from.eq_ignore_ascii_case(host));
    is_foreign.then_some((StatusCode::FORBIDDEN, response::CROSS_SITE))
}

/// Returns "not found", as JSON or as the page.
pub async fn not_found(request: Request) -> Response {
    let uri = request.uri().clone();
    if is_open(uri.path()) {
        let page = super::assets::file(uri, HeaderMap::new()).await;
        return (StatusCode::NOT_FOUND, page).into_response();
    }
    super::ErrorResponse::not_found(response::NOT_FOUND).into_response()
}
