//! Access control, and the security headers of responses.
//!
//! A page of another site that a browser has open must neither read nor write here. Therefore the Host header must
//! name this host (no DNS rebinding), no CORS header is ever sent, writing requires a custom header and JSON, cookies
//! are HttpOnly and SameSite=Strict, and a policy lets the page load only its own parts.

use super::logins::{LOGIN_S, Logins};
use crate::config::{Role, WebSettings};
use crate::runtime::Health;
use crate::store::Place;
use crate::token::Token;
use crate::words::response;
use axum::extract::{Request, State};
use axum::http::request::Parts;
use axum::http::{Extensions, HeaderMap, HeaderName, HeaderValue, Method, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse as _, Response};
use sha2::{Digest as _, Sha256};
use std::net::IpAddr;
use std::sync::Arc;
use std::time::Duration;

/// Header that every writing request requires.
pub const WRITES: HeaderName = HeaderName::from_static("x-sinew");
/// Name of the cookie.
const COOKIE: &str = "sinew_watch";
/// Duration of the response to a wrong token.
const WRONG_TOKEN: Duration = Duration::from_millis(500);

const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; \
                      form-action 'self'; base-uri 'none'; frame-ancestors 'none'";

/// Access control of the page and the API.
#[derive(Clone)]
pub struct Guard {
    host_names: Arc<[String]>,
    /// Access tokens; empty: none is required.
    tokens: Arc<[Token]>,
    logins: Arc<Logins>,
}

/// Address from which a request came.
#[derive(Debug, Clone, Copy)]
pub(super) struct Client(pub(super) IpAddr);

/// Result of comparing a token.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TokenCheck<'a> {
    /// `None`: no token is required, and everything is permitted.
    Right(Option<&'a Token>),
    Wrong,
    /// The address has sent too many wrong tokens; this one was not compared.
    Excluded,
}

impl Guard {
    /// Creates the access control from the settings; `tokens` are empty where none is required. Logins are stored in the
    /// folder of the database.
    pub fn new(
        settings: &WebSettings,
        tokens: Vec<Token>,
        place: &Place,
        health: Arc<Health>,
    ) -> Self {
        let file = place.folder().map(|folder| folder.join("web-logins"));
        let file = file.filter(|_| !tokens.is_empty());
        Self {
            host_names: settings.host_names.clone().into(),
            logins: Arc::new(Logins::new(file, health)),
            tokens: tokens.into(),
        }
    }

    /// Whether a token is required.
    pub fn needs_token(&self) -> bool {
        !self.tokens.is_empty()
    }

    /// Compares a token. A wrong one costs time, is logged, and counts against its address.
    pub(super) async fn check_token(&self, candidate: &str, client: Client) -> TokenCheck<'_> {
        if self.tokens.is_empty() {
            return TokenCheck::Right(None);
        }
        if self.logins.is_excluded(client.0) {
            return TokenCheck::Excluded;
        }
        if let Some(token) = self.same(candidate) {
            return TokenCheck::Right(Some(token));
        }
        self.logins.count_wrong(client.0);
        tokio::time::sleep(WRONG_TOKEN).await;
        TokenCheck::Wrong
    }

    /// Returns the token with this text.
    fn same(&self, candidate: &str) -> Option<&Token> {
        self.tokens
            .iter()
            .find(|token| is_same(&token.secret, candidate))
    }

    /// Returns the token of the login that a request has.
    fn logged_in(&self, headers: &HeaderMap) -> Option<&Token> {
        let has = |token: &&Token| cookies(headers).any(|c| self.logins.has(&token.secret, c));
        self.tokens.iter().find(has)
    }

    /// Returns the cookies of a successful login: its secret, which scripts cannot read, and the role for the page.
    pub fn cookies(&self, token: &Token, over_tls: bool) -> Option<[HeaderValue; 2]> {
        let value = self.logins.add(&token.secret)?;
        let secure = if over_tls { "; Secure" } else { "" };
        let rest = format!("SameSite=Strict; Path=/; Max-Age={LOGIN_S}{secure}");
        let secret = format!("{COOKIE}={value}; HttpOnly; {rest}");
        let mark = format!("{COOKIE}_open={}; {rest}", token.role.name());
        Some([
            HeaderValue::from_str(&secret).ok()?,
            HeaderValue::from_str(&mark).ok()?,
        ])
    }

    /// Ends the logins of the cookies of a request.
    pub fn log_out(&self, headers: &HeaderMap) {
        for token in self.tokens.iter() {
            for value in cookies(headers) {
                self.logins.remove(&token.secret, value);
            }
        }
    }

    /// Returns the cookies that end a login in the browser.
    pub fn no_cookies() -> [HeaderValue; 2] {
        [
            HeaderValue::from_static("sinew_watch=; HttpOnly; SameSite=Strict; Path=/; Max-Age=0"),
            HeaderValue::from_static("sinew_watch_open=; SameSite=Strict; Path=/; Max-Age=0"),
        ]
    }

    /// Checks token and login of a request.
    async fn may(&self, headers: &HeaderMap, client: Client) -> TokenCheck<'_> {
        if self.tokens.is_empty() {
            return TokenCheck::Right(None);
        }
        if let Some(token) = self.logged_in(headers) {
            return TokenCheck::Right(Some(token));
        }
        match bearer(headers) {
            Some(candidate) => self.check_token(candidate, client).await,
            None => TokenCheck::Wrong,
        }
    }

    /// Whether the token or login of a request that was admitted is still valid.
    pub(super) fn remains(&self, headers: &HeaderMap) -> bool {
        self.tokens.is_empty()
            || self.logged_in(headers).is_some()
            || bearer(headers).is_some_and(|candidate| self.same(candidate).is_some())
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

/// Returns the token in the Authorization header.
fn bearer(headers: &HeaderMap) -> Option<&str> {
    let value = headers.get(header::AUTHORIZATION)?;
    value.to_str().ok()?.strip_prefix("Bearer ")
}

/// Returns the contents of the cookies of this page.
fn cookies(headers: &HeaderMap) -> impl Iterator<Item = &str> {
    let all = headers.get(header::COOKIE);
    let all = all.and_then(|value| value.to_str().ok()).unwrap_or("");
    all.split(';')
        .filter_map(|cookie| cookie.trim().strip_prefix(COOKIE)?.strip_prefix('='))
}

/// Whether a path is accessible without a token: the page itself, which contains no data, and the login.
fn is_open(path: &str) -> bool {
    let is_data = path.starts_with("/api/") || path == "/metrics";
    !is_data
}

/// Rejects requests without access, and adds the security headers to responses.
pub async fn guard(State(guard): State<Guard>, request: Request, next: Next) -> Response {
    let (parts, body) = request.into_parts();
    let mut response = match rejection(&guard, &parts).await {
        Some((status, reason)) => super::ErrorResponse::new(status, reason).into_response(),
        None => next.run(Request::from_parts(parts, body)).await,
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

/// Returns the address from which a request came.
pub(super) fn client(extensions: &Extensions) -> Client {
    let client = extensions.get::<Client>().copied();
    client.unwrap_or(Client(IpAddr::from([0, 0, 0, 0])))
}

async fn rejection(guard: &Guard, request: &Parts) -> Option<(StatusCode, &'static str)> {
    let headers = &request.headers;
    let text = |name: HeaderName| headers.get(name).and_then(|value| value.to_str().ok());
    let Some(host) = text(header::HOST).filter(|host| guard.is_own_host(host)) else {
        return Some((StatusCode::MISDIRECTED_REQUEST, response::UNKNOWN_HOST));
    };
    let path = request.uri.path();
    let writes = request.method != Method::GET && request.method != Method::HEAD;
    if !is_open(path) {
        match guard.may(headers, client(&request.extensions)).await {
            TokenCheck::Right(Some(token)) if writes && token.role == Role::Read => {
                return Some((StatusCode::FORBIDDEN, response::READ_ONLY));
            }
            TokenCheck::Right(_) => {}
            TokenCheck::Wrong => {
                return Some((StatusCode::UNAUTHORIZED, response::TOKEN_REQUIRED));
            }
            TokenCheck::Excluded => {
                return Some((StatusCode::TOO_MANY_REQUESTS, response::TOO_MANY_TOKENS));
            }
        }
    }
    if !writes {
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
