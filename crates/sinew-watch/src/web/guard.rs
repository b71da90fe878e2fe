//! Who may ask, and what browsers may do with the answers.
//!
//! A page of another site that a browser has open must neither read nor write here. So: the Host header is one of
//! this computer's (no DNS rebinding), no CORS header is ever sent, writing needs a header of its own and
//! JSON, cookies are HttpOnly and SameSite=Strict, and a policy lets the page load nothing but its own parts.

use crate::config::WebSettings;
use crate::hex::hex;
use axum::extract::{Request, State};
use axum::http::{HeaderMap, HeaderName, HeaderValue, Method, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse as _, Response};
use sha2::{Digest as _, Sha256};
use std::net::IpAddr;
use std::sync::Arc;

/// Header without which nothing is written.
pub const WRITES: HeaderName = HeaderName::from_static("x-sinew");
/// Name of the cookie.
const COOKIE: &str = "sinew_watch";
/// A login lasts so long, s.
const LOGIN_S: u64 = 30 * 86_400;

const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; \
                      form-action 'self'; base-uri 'none'; frame-ancestors 'none'";

/// Who may ask.
#[derive(Debug, Clone)]
pub struct Guard {
    host_names: Arc<[String]>,
    /// The token, where one is needed.
    token: Option<Arc<str>>,
}

impl Guard {
    /// As the settings say; `token` where one is needed.
    pub fn new(settings: &WebSettings, token: Option<String>) -> Self {
        Self {
            host_names: settings.host_names.clone().into(),
            token: token.map(Arc::from),
        }
    }

    /// Whether a token is needed.
    pub fn needs_token(&self) -> bool {
        self.token.is_some()
    }

    /// Whether this is the token; as long for a wrong one as for the right one.
    pub fn is_token(&self, given: &str) -> bool {
        self.token
            .as_deref()
            .is_none_or(|token| is_same(token, given))
    }

    /// The cookie of somebody who gave the token.
    pub fn cookie(&self, over_tls: bool) -> Option<HeaderValue> {
        let value = login_of(self.token.as_deref()?);
        let secure = if over_tls { "; Secure" } else { "" };
        let text = format!(
            "{COOKIE}={value}; HttpOnly; SameSite=Strict; Path=/; Max-Age={LOGIN_S}{secure}"
        );
        HeaderValue::from_str(&text).ok()
    }

    /// The cookie that ends a login.
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
        if bearer.is_some_and(|given| is_same(token, given)) {
            return true;
        }
        let login = login_of(token);
        let cookies = text(header::COOKIE).unwrap_or("").split(';');
        let mut own = cookies.filter_map(|c| c.trim().strip_prefix(COOKIE)?.strip_prefix('='));
        own.any(|value| is_same(&login, value))
    }

    /// Whether a browser that says this host means this computer. An address can't be rebound; a name can.
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

/// Compared as hashes, so that the time taken tells nothing of the secret.
fn is_same(secret: &str, given: &str) -> bool {
    Sha256::digest(secret) == Sha256::digest(given)
}

/// What a cookie holds: it tells nothing of the token, and ends with it.
fn login_of(token: &str) -> String {
    hex(&Sha256::digest(format!("sinew-watch login\n{token}")))
}

/// What may be asked without a token: the page itself, which holds nothing, and the login.
fn is_open(path: &str) -> bool {
    let is_data = path.starts_with("/api/") || path == "/metrics";
    !is_data
}

/// Refuses who may not ask, and says to browsers what they may do with the answer.
pub async fn guard(State(guard): State<Guard>, request: Request, next: Next) -> Response {
    let mut response = match refusal(&guard, &request) {
        Some((status, why)) => super::Refused::new(status, why).into_response(),
        None => next.run(request).await,
    };
    let headers = response.headers_mut();
    let say = [
        (header::CONTENT_SECURITY_POLICY, POLICY),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::X_FRAME_OPTIONS, "DENY"),
        (header::REFERRER_POLICY, "no-referrer"),
        (
            HeaderName::from_static("cross-origin-resource-policy"),
            "same-origin",
        ),
    ];
    for (name, value) in say {
        headers.insert(name, HeaderValue::from_static(value));
    }
    headers
        .entry(header::CACHE_CONTROL)
        .or_insert(HeaderValue::from_static("no-store"));
    response
}

fn refusal(guard: &Guard, request: &Request) -> Option<(StatusCode, &'static str)> {
    let headers = request.headers();
    let text = |name: HeaderName| headers.get(name).and_then(|value| value.to_str().ok());
    let Some(host) = text(header::HOST).filter(|host| guard.is_own_host(host)) else {
        let why = "this computer isn't known by that name; add it to [web] host_names";
        return Some((StatusCode::MISDIRECTED_REQUEST, why));
    };
    let path = request.uri().path();
    if !is_open(path) && !guard.may(headers) {
        return Some((StatusCode::UNAUTHORIZED, "the token is needed"));
    }
    if *request.method() == Method::GET || *request.method() == Method::HEAD {
        return None;
    }
    if headers.get(WRITES).is_none() {
        return Some((StatusCode::FORBIDDEN, "writing needs the header x-sinew: 1"));
    }
    let is_json = text(header::CONTENT_TYPE).is_some_and(|t| t.starts_with("application/json"));
    if !is_json {
        return Some((
            StatusCode::UNSUPPORTED_MEDIA_TYPE,
            "what is written is application/json",
        ));
    }
    let of_site = text(HeaderName::from_static("sec-fetch-site"));
    let from = text(header::ORIGIN).and_then(|origin| origin.split_once("://"));
    let is_foreign = of_site.is_some_and(|site| !["same-origin", "none"].contains(&site))
        || from.is_some_and(|(_, from)| !from.eq_ignore_ascii_case(host));
    is_foreign.then_some((StatusCode::FORBIDDEN, "this comes from another site"))
}

/// Not found: as JSON, or on the page.
pub async fn not_found(request: Request) -> Response {
    let uri = request.uri().clone();
    if is_open(uri.path()) {
        let page = super::assets::file(uri, HeaderMap::new()).await;
        return (StatusCode::NOT_FOUND, page).into_response();
    }
    super::Refused::not_found("there is nothing here").into_response()
}
