//! Webhooks: alarm transitions posted to configured addresses. Nothing waits for them; a slow receiver misses some.

use crate::config::{PostFormat, Webhook};
use crate::runtime::Health;
use crate::store::word;
use crate::words;
use http_body_util::Full;
use hyper::body::Bytes;
use hyper::header::{AUTHORIZATION, CONTENT_TYPE, HOST, USER_AGENT};
use hyper::{Request, client::conn::http1};
use hyper_util::rt::TokioIo;
use serde::Serialize;
use sinew_watch_core::alarm::{AlarmState, Condition, Level, TransitionReason};
use sinew_watch_core::journal::{Entry, Event};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;
use tokio::net::TcpStream;
use tokio::sync::{mpsc, watch};

/// Maximum number of waiting posts per address.
const MAX_WAITING_POSTS: usize = 100;
/// Maximum number of attempts; the pause doubles each time, starting at one second.
const MAX_ATTEMPTS: u32 = 6;
/// Maximum time to wait for a response.
const MAX_ANSWER_TIME: Duration = Duration::from_secs(5);
/// Maximum length of a token, characters.
const MAX_TOKEN_CHARS: usize = 4096;

/// Body of a webhook: `sinew-webhook/2`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Post {
    /// Name and version of the format.
    pub schema: &'static str,
    /// Name of the robot in the configuration.
    pub robot: String,
    /// Name of the joint; `null`: the robot as a whole.
    pub joint: Option<String>,
    /// Condition of the alarm.
    pub condition: Condition,
    /// Severity, 1 to 1000.
    pub severity: u16,
    /// State before the transition.
    pub from: AlarmState,
    /// State after the transition.
    pub to: AlarmState,
    /// Whether the alarm is active after the transition: a latched alarm is active until repair or reset.
    pub active: bool,
    /// Time of the transition, s since 1970 UTC.
    pub time_utc_s: f64,
    /// Reason of the transition.
    pub reason: TransitionReason,
    /// Description of the transition as text.
    pub text: String,
}

impl Post {
    /// Returns the body for an alarm transition; `None`: the entry is of another kind, or the alarm becomes latched, by
    /// which nothing changes for a receiver: it remains active.
    pub fn of(robot: &str, entry: &Entry) -> Option<Self> {
        let Event::Alarm { transition } = &entry.event else {
            return None;
        };
        let condition = transition.key.condition;
        let severity = match &transition.reason {
            TransitionReason::Condition { cause } => cause.severity(condition),
            _ => condition.severity(),
        };
        if transition.to == AlarmState::Latched && transition.from != AlarmState::Latched {
            return None;
        }
        Some(Self {
            schema: "sinew-webhook/2",
            robot: robot.into(),
            joint: transition.key.joint.clone(),
            condition,
            severity,
            from: transition.from,
            to: transition.to,
            active: transition.to.is_active(),
            time_utc_s: transition.time_utc_s,
            reason: transition.reason.clone(),
            text: format!("{robot}: {}", words::entry(&entry.event)),
        })
    }
}

/// Priority of an ntfy notification: 5 (maximum) for alarms of level ERROR, 3 (default) for other active alarms, and 2
/// (low) for alarms that end.
fn ntfy_priority(post: &Post) -> &'static str {
    match (post.active, post.condition.level()) {
        (true, Level::Error) => "5",
        (true, _) => "3",
        (false, _) => "2",
    }
}

/// Request body with its content type and the headers of its format.
#[derive(Debug, Clone)]
struct Message {
    kind: &'static str,
    headers: Vec<(&'static str, String)>,
    body: Bytes,
}

impl Message {
    /// Formats a notification for a receiver.
    fn of(post: &Post, format: PostFormat) -> Self {
        let json = |value: serde_json::Result<Vec<u8>>| Bytes::from(value.unwrap_or_default());
        match format {
            PostFormat::Sinew => Self {
                kind: "application/json",
                headers: Vec::new(),
                body: json(serde_json::to_vec(post)),
            },
            PostFormat::Ntfy => Self {
                kind: "text/plain; charset=utf-8",
                headers: vec![
                    ("title", format!("Sinew: {}", word(&post.condition))),
                    ("priority", ntfy_priority(post).into()),
                ],
                body: Bytes::from(post.text.clone()),
            },
            PostFormat::Slack => Self {
                kind: "application/json",
                headers: Vec::new(),
                body: json(serde_json::to_vec(
                    &serde_json::json!({ "text": escaped(&post.text) }),
                )),
            },
        }
    }

    /// Formats the test notification.
    fn test(format: PostFormat, time_utc_s: f64) -> Self {
        let text = words::response::TEST_NOTIFICATION;
        let json = |value: serde_json::Value| Bytes::from(value.to_string());
        let (kind, headers, body) = match format {
            PostFormat::Sinew => {
                let body = serde_json::json!({ "schema": "sinew-webhook-test/1", "time_utc_s": time_utc_s, "text": text });
                ("application/json", Vec::new(), json(body))
            }
            PostFormat::Ntfy => {
                let headers = vec![("title", "Sinew: test".into()), ("priority", "3".into())];
                ("text/plain; charset=utf-8", headers, Bytes::from(text))
            }
            PostFormat::Slack => {
                let body = json(serde_json::json!({ "text": text }));
                ("application/json", Vec::new(), body)
            }
        };
        Self {
            kind,
            headers,
            body,
        }
    }
}

/// Escapes the control characters of Slack's text format.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

/// Posts a test notification once to every receiver, and returns the result of each in the order of the configuration.
pub async fn test(hooks: &[Webhook], time_utc_s: f64) -> Vec<(String, Result<(), String>)> {
    let started: Vec<_> = (hooks.iter().cloned())
        .map(|hook| {
            let message = Message::test(hook.format, time_utc_s);
            let url = hook.url();
            (
                url,
                tokio::spawn(async move { post_in_time(&hook, message).await }),
            )
        })
        .collect();
    let mut results = Vec::new();
    for (url, posting) in started {
        let done = posting.await.unwrap_or_else(|e| Err(e.to_string()));
        results.push((url, done));
    }
    results
}

/// Posts once, within the maximum time to wait for a response.
async fn post_in_time(hook: &Webhook, message: Message) -> Result<(), String> {
    let posted = tokio::time::timeout(MAX_ANSWER_TIME, post(hook, message)).await;
    posted.unwrap_or_else(|_late| Err(format!("no answer within {MAX_ANSWER_TIME:?}")))
}

/// Posts alarm transitions as they occur, to the addresses of the present configuration.
pub async fn run(
    mut steps: mpsc::Receiver<(String, Entry)>,
    mut wanted: watch::Receiver<Vec<Webhook>>,
    health: Arc<Health>,
) {
    let mut hooks = open(&wanted.borrow_and_update(), &health);
    while let Some((robot, entry)) = steps.recv().await {
        if wanted.has_changed().unwrap_or(false) {
            // Removed receivers post what is waiting.
            hooks = open(&wanted.borrow_and_update(), &health);
        }
        let Some(post) = Post::of(&robot, &entry) else {
            continue;
        };
        for (hook, sender) in &hooks {
            let is_meant = post.severity >= hook.severity_min;
            if is_meant && sender.try_send(Message::of(&post, hook.format)).is_err() {
                health.counts.webhooks_lost.fetch_add(1, Ordering::Relaxed);
            }
        }
    }
}

fn open(wanted: &[Webhook], health: &Arc<Health>) -> Vec<(Webhook, mpsc::Sender<Message>)> {
    let of_hook = |hook: &Webhook| {
        let (sender, receiver) = mpsc::channel(MAX_WAITING_POSTS);
        tokio::spawn(deliver(hook.clone(), receiver, Arc::clone(health)));
        (hook.clone(), sender)
    };
    wanted.iter().map(of_hook).collect()
}

async fn deliver(hook: Webhook, mut posts: mpsc::Receiver<Message>, health: Arc<Health>) {
    while let Some(message) = posts.recv().await {
        let mut wait = Duration::from_secs(1);
        let mut done = Err(String::new());
        for attempt in 0..MAX_ATTEMPTS {
            if attempt > 0 {
                tokio::time::sleep(wait).await;
                wait *= 2;
            }
            done = post_in_time(&hook, message.clone()).await;
            if done.is_ok() {
                break;
            }
        }
        match done {
            Ok(()) => health.counts.webhooks.fetch_add(1, Ordering::Relaxed),
            Err(reason) => {
                health.log(&words::log::webhook_discarded(
                    &hook.url(),
                    MAX_ATTEMPTS,
                    &reason,
                ));
                health.counts.webhooks_lost.fetch_add(1, Ordering::Relaxed)
            }
        };
    }
}

async fn post(hook: &Webhook, posted: Message) -> Result<(), String> {
    let message = |e: &dyn std::fmt::Display| e.to_string();
    let host = hook.host.trim_start_matches('[').trim_end_matches(']');
    let stream = TcpStream::connect((host, hook.port))
        .await
        .map_err(|e| message(&e))?;
    let (mut sender, connection) = http1::handshake(TokioIo::new(stream))
        .await
        .map_err(|e| message(&e))?;
    let runs = tokio::spawn(connection);
    let mut request = Request::post(&hook.path)
        .header(HOST, format!("{}:{}", hook.host, hook.port))
        .header(CONTENT_TYPE, posted.kind)
        .header(
            USER_AGENT,
            concat!("sinew-watch/", env!("CARGO_PKG_VERSION")),
        );
    for (name, value) in posted.headers {
        request = request.header(name, value);
    }
    if let Some(path) = &hook.token_file {
        let token = token(path)?;
        request = request.header(AUTHORIZATION, format!("Bearer {token}"));
    }
    let request = request
        .body(Full::new(posted.body))
        .map_err(|e| message(&e))?;
    let answer = sender.send_request(request).await.map_err(|e| message(&e));
    runs.abort();
    match answer?.status() {
        status if status.is_success() => Ok(()),
        status => Err(format!("response {status}")),
    }
}

/// Reads the bearer token from its file.
///
/// # Errors
/// Returns the reason as text if the file cannot be read or the token is invalid.
pub fn token(path: &Path) -> Result<String, String> {
    let read = sinew_files::read_text(path, &sinew_files::Budget::SETTINGS);
    let text = read.map_err(|e| e.to_string())?;
    match text.trim() {
        "" => Err("the file is empty; write the token of the receiver into it".into()),
        token if token.len() > MAX_TOKEN_CHARS => Err(format!(
            "the token has {} characters, limit {MAX_TOKEN_CHARS}",
            token.len()
        )),
        token => Ok(token.to_owned()),
    }
}
