//! Steps of alarms, posted to addresses of the owner's. Nothing waits for them: who doesn't answer misses some.

use crate::config::Webhook;
use crate::runtime::Health;
use crate::words;
use http_body_util::Full;
use hyper::body::Bytes;
use hyper::header::{AUTHORIZATION, CONTENT_TYPE, HOST, USER_AGENT};
use hyper::{Request, client::conn::http1};
use hyper_util::rt::TokioIo;
use serde::Serialize;
use sinew_watch_core::alarm::{AlarmState, Condition, TransitionWhy};
use sinew_watch_core::journal::{Entry, Event};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;
use tokio::net::TcpStream;
use tokio::sync::{mpsc, watch};

/// Posts that wait for one address, at most.
const WAITING: usize = 100;
/// So often one is tried; each time it is waited for twice as long, from a second on.
const TRIES: u32 = 6;
/// An answer is waited for so long.
const WITHIN: Duration = Duration::from_secs(5);
/// A token is no longer.
const TOKEN_MOST: usize = 4096;

/// What is posted: `sinew-webhook/1`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Post {
    /// Name and version of this form.
    pub schema: &'static str,
    /// Name of the robot in the configuration.
    pub robot: String,
    /// Joint; `None`: the robot as a whole.
    pub joint: Option<String>,
    /// What the alarm is about.
    pub condition: Condition,
    /// Severity, 1 to 1000.
    pub severity: u16,
    /// From this state.
    pub from: AlarmState,
    /// To this one.
    pub to: AlarmState,
    /// When, s since 1970 UTC.
    pub time_utc_s: f64,
    /// The reason.
    pub why: TransitionWhy,
    /// What happened, in words.
    pub text: String,
}

impl Post {
    /// Of a step of an alarm; `None`: the entry is of something else.
    pub fn of(robot: &str, entry: &Entry) -> Option<Self> {
        let Event::Alarm { transition } = &entry.event else {
            return None;
        };
        Some(Self {
            schema: "sinew-webhook/1",
            robot: robot.into(),
            joint: transition.key.joint.clone(),
            condition: transition.key.condition,
            severity: transition.key.condition.severity(),
            from: transition.from,
            to: transition.to,
            time_utc_s: transition.time_utc_s,
            why: transition.why.clone(),
            text: format!("{robot}: {}", words::entry(&entry.event)),
        })
    }
}

/// Posts steps of alarms as they come, to the addresses that are wanted at the time.
pub async fn run(
    mut steps: mpsc::Receiver<(String, Entry)>,
    mut wanted: watch::Receiver<Vec<Webhook>>,
    health: Arc<Health>,
) {
    let mut hooks = open(&wanted.borrow_and_update(), &health);
    while let Some((robot, entry)) = steps.recv().await {
        if wanted.has_changed().unwrap_or(false) {
            // Those that go post what they have.
            hooks = open(&wanted.borrow_and_update(), &health);
        }
        let Some(post) = Post::of(&robot, &entry) else {
            continue;
        };
        let body = Bytes::from(serde_json::to_vec(&post).unwrap_or_default());
        for (hook, sender) in &hooks {
            let is_meant = post.severity >= hook.severity_min;
            if is_meant && sender.try_send(body.clone()).is_err() {
                health.counts.webhooks_lost.fetch_add(1, Ordering::Relaxed);
            }
        }
    }
}

fn open(wanted: &[Webhook], health: &Arc<Health>) -> Vec<(Webhook, mpsc::Sender<Bytes>)> {
    let of_hook = |hook: &Webhook| {
        let (sender, receiver) = mpsc::channel(WAITING);
        tokio::spawn(deliver(hook.clone(), receiver, Arc::clone(health)));
        (hook.clone(), sender)
    };
    wanted.iter().map(of_hook).collect()
}

async fn deliver(hook: Webhook, mut posts: mpsc::Receiver<Bytes>, health: Arc<Health>) {
    while let Some(body) = posts.recv().await {
        let mut wait = Duration::from_secs(1);
        let mut done = Err(String::new());
        for attempt in 0..TRIES {
            if attempt > 0 {
                tokio::time::sleep(wait).await;
                wait *= 2;
            }
            let posted = tokio::time::timeout(WITHIN, post(&hook, body.clone())).await;
            done = posted.unwrap_or_else(|_late| Err(format!("no answer within {WITHIN:?}")));
            if done.is_ok() {
                break;
            }
        }
        match done {
            Ok(()) => health.counts.webhooks.fetch_add(1, Ordering::Relaxed),
            Err(why) => {
                health.say(&format!("webhook {}: given up: {why}", hook.url()));
                health.counts.webhooks_lost.fetch_add(1, Ordering::Relaxed)
            }
        };
    }
}

async fn post(hook: &Webhook, body: Bytes) -> Result<(), String> {
    let said = |e: &dyn std::fmt::Display| e.to_string();
    let host = hook.host.trim_start_matches('[').trim_end_matches(']');
    let stream = TcpStream::connect((host, hook.port))
        .await
        .map_err(|e| said(&e))?;
    let (mut sender, connection) = http1::handshake(TokioIo::new(stream))
        .await
        .map_err(|e| said(&e))?;
    let runs = tokio::spawn(connection);
    let mut request = Request::post(&hook.path)
        .header(HOST, format!("{}:{}", hook.host, hook.port))
        .header(CONTENT_TYPE, "application/json")
        .header(
            USER_AGENT,
            concat!("sinew-watch/", env!("CARGO_PKG_VERSION")),
        );
    if let Some(path) = &hook.token_file {
        let token = token(path)?;
        request = request.header(AUTHORIZATION, format!("Bearer {token}"));
    }
    let request = request.body(Full::new(body)).map_err(|e| said(&e))?;
    let answer = sender.send_request(request).await.map_err(|e| said(&e));
    runs.abort();
    match answer?.status() {
        status if status.is_success() => Ok(()),
        status => Err(format!("it answered {status}")),
    }
}

/// The token that goes along, from its file.
///
/// # Errors
/// What is wrong with it, in words.
pub fn token(path: &Path) -> Result<String, String> {
    let read = sinew_files::read_text(path, &sinew_files::limits::SETTINGS);
    let text = read.map_err(|e| e.to_string())?;
    match text.trim() {
        "" => Err("it is empty; write the receiver's token into it".into()),
        token if token.len() > TOKEN_MOST => Err(format!(
            "the token has {} characters; {TOKEN_MOST} at most",
            token.len()
        )),
        token => Ok(token.to_owned()),
    }
}
