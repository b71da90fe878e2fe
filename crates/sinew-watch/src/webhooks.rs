//! Notifications: alarm transitions posted to configured addresses and sent as mail. Nothing waits for them; a slow
//! receiver misses some.

use crate::config::{PostFormat, Receiver, Webhook};
use crate::mail::{self, MailText};
use crate::runtime::Health;
use crate::store::word;
use crate::stream::{connect, secure};
use crate::token::secret;
use crate::words;
use http_body_util::{BodyExt as _, Full, Limited};
use hyper::body::Bytes;
use hyper::header::{AUTHORIZATION, CONTENT_TYPE, HOST, USER_AGENT};
use hyper::{Request, StatusCode, client::conn::http1};
use hyper_util::rt::TokioIo;
use serde::Serialize;
use sinew_watch_core::alarm::{AlarmState, Condition, Level, Transition, TransitionReason};
use sinew_watch_core::journal::{Entry, Event};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, SystemTime, UNIX_EPOCH};
use tokio::sync::{mpsc, watch};

/// Maximum number of waiting posts per address.
const MAX_WAITING_POSTS: usize = 100;
/// Maximum number of attempts; the pause doubles each time, starting at one second.
const MAX_ATTEMPTS: u32 = 6;
/// Maximum time to wait for a response.
const MAX_ANSWER_TIME: Duration = Duration::from_secs(5);
/// Maximum time of the dialogue with a mail server, which may delay its greeting against unsolicited mail.
const MAX_MAIL_TIME: Duration = Duration::from_secs(30);
/// Maximum length of a response, bytes.
const MAX_RESPONSE_BYTES: usize = 64 * 1024;

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
        if transition.to == AlarmState::Latched && transition.from != AlarmState::Latched {
            return None;
        }
        Some(Self {
            schema: "sinew-webhook/2",
            robot: robot.into(),
            joint: transition.key.joint.clone(),
            condition,
            severity: severity(transition),
            from: transition.from,
            to: transition.to,
            active: transition.to.is_active(),
            time_utc_s: transition.time_utc_s,
            reason: transition.reason.clone(),
            text: format!("{robot}: {}", words::entry(&entry.event)),
        })
    }
}

/// Returns the severity of the alarm of a transition, 1 to 1000.
fn severity(transition: &Transition) -> u16 {
    let condition = transition.key.condition;
    match &transition.reason {
        TransitionReason::Condition { cause } => cause.severity(condition),
        _ => condition.severity(),
    }
}

/// Returns the severity by which the receivers of a transition are selected: a receiver of the beginning of an alarm
/// also receives its end and its acknowledgement, which do not contain its cause.
fn highest_severity(post: &Post) -> u16 {
    match (&post.reason, post.active) {
        (TransitionReason::Condition { .. }, true) => post.severity,
        _ => post.condition.max_severity(),
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
pub(crate) struct Message {
    pub(crate) kind: &'static str,
    pub(crate) headers: Vec<(&'static str, String)>,
    pub(crate) body: Bytes,
}

/// Notification in the format of a receiver.
#[derive(Debug, Clone)]
enum Notification {
    Post(Message),
    Mail(MailText),
}

impl Notification {
    fn of(post: &Post, transition: &Transition, receiver: &Receiver) -> Self {
        match receiver {
            Receiver::Webhook(hook) => Self::Post(Message::of(post, hook.format)),
            Receiver::Mail(mail) => {
                let [subject, body] = words::mail(&post.robot, transition, mail.page.as_deref());
                Self::Mail(MailText { subject, body })
            }
        }
    }

    fn test(receiver: &Receiver) -> Self {
        match receiver {
            Receiver::Webhook(hook) => Self::Post(Message::test(hook.format, now_utc_s())),
            Receiver::Mail(_) => Self::Mail(MailText {
                subject: "Sinew: test".into(),
                body: format!("{}\n", words::response::TEST_NOTIFICATION),
            }),
        }
    }
}

/// Returns the time, s since 1970 UTC.
fn now_utc_s() -> f64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.map_or(0.0, |since| since.as_secs_f64())
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

/// Sends a test notification once to every receiver, and returns the result of each in the order of the configuration.
pub async fn test(receivers: &[Receiver]) -> Vec<(String, Result<(), String>)> {
    let started: Vec<_> = (receivers.iter().cloned())
        .map(|mut receiver| {
            let name = receiver.name();
            let notification = Notification::test(&receiver);
            let sending = async move { send_in_time(&mut receiver, notification).await };
            (name, tokio::spawn(sending))
        })
        .collect();
    let mut results = Vec::new();
    for (name, sending) in started {
        let done = sending.await.unwrap_or_else(|e| Err(e.to_string()));
        results.push((name, done));
    }
    results
}

/// Sends once, within the maximum time to wait for a response; a mail receiver keeps the addresses that remain.
async fn send_in_time(receiver: &mut Receiver, notification: Notification) -> Result<(), String> {
    let (limit, sent) = match (receiver, notification) {
        (Receiver::Webhook(hook), Notification::Post(message)) => {
            let sent = tokio::time::timeout(MAX_ANSWER_TIME, post(hook, message));
            (MAX_ANSWER_TIME, sent.await)
        }
        (Receiver::Mail(to), Notification::Mail(text)) => {
            let sent = tokio::time::timeout(MAX_MAIL_TIME, mail::send(to, &text, now_utc_s()));
            (MAX_MAIL_TIME, sent.await)
        }
        _ => return Err("notification in the format of another receiver".into()),
    };
    sent.unwrap_or_else(|_late| Err(format!("no answer within {limit:?}")))
}

/// Sends alarm transitions as they occur, to the receivers of the present configuration.
pub async fn run(
    mut steps: mpsc::Receiver<(String, Entry)>,
    mut wanted: watch::Receiver<Vec<Receiver>>,
    health: Arc<Health>,
) {
    let mut receivers = open(&wanted.borrow_and_update(), &health);
    while let Some((robot, entry)) = steps.recv().await {
        if wanted.has_changed().unwrap_or(false) {
            // Removed receivers send what is waiting.
            receivers = open(&wanted.borrow_and_update(), &health);
        }
        let (Some(post), Event::Alarm { transition }) = (Post::of(&robot, &entry), &entry.event)
        else {
            continue;
        };
        for (receiver, sender) in &receivers {
            let is_meant = highest_severity(&post) >= receiver.severity_min();
            let notification = || Notification::of(&post, transition, receiver);
            if is_meant && sender.try_send(notification()).is_err() {
                health.counts.webhooks_lost.fetch_add(1, Ordering::Relaxed);
            }
        }
    }
}

fn open(wanted: &[Receiver], health: &Arc<Health>) -> Vec<(Receiver, mpsc::Sender<Notification>)> {
    let of_receiver = |to: &Receiver| {
        let (sender, waiting) = mpsc::channel(MAX_WAITING_POSTS);
        tokio::spawn(deliver(to.clone(), waiting, Arc::clone(health)));
        (to.clone(), sender)
    };
    wanted.iter().map(of_receiver).collect()
}

async fn deliver(
    to: Receiver,
    mut notifications: mpsc::Receiver<Notification>,
    health: Arc<Health>,
) {
    while let Some(notification) = notifications.recv().await {
        let mut to = to.clone();
        let mut wait = Duration::from_secs(1);
        let mut done = Err(String::new());
        for attempt in 0..MAX_ATTEMPTS {
            if attempt > 0 {
                tokio::time::sleep(wait).await;
                wait *= 2;
            }
            done = send_in_time(&mut to, notification.clone()).await;
            if done.is_ok() {
                break;
            }
        }
        match done {
            Ok(()) => health.counts.webhooks.fetch_add(1, Ordering::Relaxed),
            Err(reason) => {
                health.log(&words::log::notification_discarded(
                    &to.name(),
                    MAX_ATTEMPTS,
                    &reason,
                ));
                health.counts.webhooks_lost.fetch_add(1, Ordering::Relaxed)
            }
        };
    }
}

/// Posts once; a response other than success is an error.
async fn post(hook: &Webhook, posted: Message) -> Result<(), String> {
    match exchange(hook, posted).await?.0 {
        status if status.is_success() => Ok(()),
        status => Err(format!("response {status}")),
    }
}

/// Posts once; returns status and body of the response.
pub(crate) async fn exchange(
    hook: &Webhook,
    posted: Message,
) -> Result<(StatusCode, Bytes), String> {
    let message = |e: &dyn std::fmt::Display| e.to_string();
    let mut stream = connect(&hook.host, hook.port).await?;
    if hook.tls {
        stream = secure(stream, &hook.host, hook.ca_file.as_deref()).await?;
    }
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
        let token = secret(path)?;
        request = request.header(AUTHORIZATION, format!("Bearer {token}"));
    }
    let request = request
        .body(Full::new(posted.body))
        .map_err(|e| message(&e))?;
    let answer = sender.send_request(request).await.map_err(|e| message(&e));
    let (head, body) = match answer {
        Ok(answer) => answer.into_parts(),
        Err(reason) => {
            runs.abort();
            return Err(reason);
        }
    };
    // The status is the answer; a body that is too long or breaks off changes nothing.
    let body = Limited::new(body, MAX_RESPONSE_BYTES).collect().await;
    runs.abort();
    Ok((head.status, body.map(|b| b.to_bytes()).unwrap_or_default()))
}
