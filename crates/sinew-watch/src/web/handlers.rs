//! Answers to single questions.

use super::api::{
    AlarmList, AlarmSaid, Done, DueAsked, Journal, JournalAsked, JournalSaid, Login, RobotNow,
    TendonNow,
};
use super::guard::Guard;
use super::{App, Refused};
use crate::runtime::{Answer, Control, Seen, Slot};
use crate::store::JournalQuery;
use crate::words;
use axum::Json;
use axum::body::Bytes;
use axum::extract::{Path, Query, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse as _, Response};
use serde::de::DeserializeOwned;
use sinew_files::date::DAY_S;
use sinew_watch_core::command::Command;
use sinew_watch_core::due::DueList;
use sinew_watch_core::{HORIZON_DAYS, RobotSnapshot};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::oneshot;

/// Entries of the journal in one answer: as usual, and at most.
const ENTRIES: [u64; 2] = [100, 1000];
/// What is due is said within so many days: eight weeks.
const DUE_WITHIN_DAYS: f64 = 56.0;
/// So long an answer to a command is waited for: the store may be slow.
const ANSWER_WITHIN: Duration = Duration::from_secs(20);
/// A wrong token is answered so late.
const WRONG_TOKEN: Duration = Duration::from_millis(500);
/// A core thread that is silent for longer hangs.
const HANGS_AFTER: Duration = Duration::from_secs(10);

pub(super) async fn fleet(State(app): State<App>) -> Response {
    let fleet = app.ticks.borrow().fleet.clone();
    ([(header::CONTENT_TYPE, "application/json")], fleet).into_response()
}

/// A robot that is watched, or the refusal.
fn watched(app: &App, robot: &str) -> Result<(Arc<Slot>, Arc<RobotSnapshot>), Refused> {
    let slot = app.board.get(robot);
    match slot.map(|slot| (slot.seen(), slot)) {
        Some((Seen::Watched(snapshot), slot)) => Ok((slot, snapshot)),
        Some((Seen::NotWatched(why), _)) => {
            Err(Refused::conflict(format!("{robot} isn't watched: {why}")))
        }
        Some((Seen::Nothing, _)) => Err(Refused::unavailable("it is being started")),
        None => Err(Refused::not_found(format!("there is no robot '{robot}'"))),
    }
}

pub(super) async fn robot(
    State(app): State<App>,
    Path(robot): Path<String>,
) -> Result<Json<RobotNow>, Refused> {
    let (slot, snapshot) = watched(&app, &robot)?;
    Ok(Json(RobotNow::of(snapshot, &slot)))
}

pub(super) async fn tendon(
    State(app): State<App>,
    Path((robot, joint)): Path<(String, String)>,
) -> Result<Json<TendonNow>, Refused> {
    let (_, snapshot) = watched(&app, &robot)?;
    TendonNow::of(&snapshot, &joint).map(Json).ok_or_else(|| {
        let joints: Vec<&str> = snapshot.tendons.iter().map(|t| t.joint.as_str()).collect();
        let joints = joints.join(", ");
        let why = format!("{robot} has no tendon at '{joint}'; it has {joints}");
        Refused::not_found(why)
    })
}

pub(super) async fn due(
    State(app): State<App>,
    Query(asked): Query<DueAsked>,
) -> Result<Json<DueList>, Refused> {
    let within_days = asked.within_days.unwrap_or(DUE_WITHIN_DAYS);
    if !(within_days > 0.0 && within_days <= HORIZON_DAYS) {
        let why = format!("within_days is more than 0, and {HORIZON_DAYS} at most");
        return Err(Refused::unprocessable(why));
    }
    let robots = app.board.all().into_iter();
    let robots: Vec<Arc<RobotSnapshot>> = robots
        .filter_map(|(_, slot)| slot.seen().watched())
        .collect();
    let robots = robots.iter().map(Arc::as_ref);
    let time_utc_s = app.ticks.borrow().time_utc_s;
    Ok(Json(DueList::of(robots, time_utc_s, DAY_S * within_days)))
}

pub(super) async fn alarms(State(app): State<App>) -> Json<AlarmList> {
    let mut alarms: Vec<AlarmSaid> = Vec::new();
    for (name, slot) in app.board.all() {
        if let Seen::Watched(robot) = slot.seen() {
            alarms.extend(robot.alarms.iter().map(|alarm| AlarmSaid::of(&name, alarm)));
        }
    }
    alarms.sort_by_key(|said| std::cmp::Reverse(said.severity));
    Json(AlarmList { alarms })
}

pub(super) async fn journal(
    State(app): State<App>,
    Query(asked): Query<JournalAsked>,
) -> Result<Json<Journal>, Refused> {
    let [usual, most] = ENTRIES;
    let query = JournalQuery {
        robot: asked.robot,
        event: asked.event,
        before: asked.before,
        most: asked.most.unwrap_or(usual).min(most),
    };
    let entries = app.read(move |reader| reader.journal(&query)).await?;
    let said = entries.into_iter().map(|entry| JournalSaid {
        text: words::entry(&entry.entry.event),
        entry,
    });
    Ok(Json(Journal {
        entries: said.collect(),
    }))
}

/// A body as JSON; refused with what is wrong in it.
fn read_body<T: DeserializeOwned>(body: &[u8]) -> Result<T, Refused> {
    serde_json::from_slice(body).map_err(|e| Refused::unprocessable(format!("not understood: {e}")))
}

pub(super) async fn command(
    State(app): State<App>,
    Path(robot): Path<String>,
    body: Bytes,
) -> Result<Json<Done>, Refused> {
    let command: Command = read_body(&body)?;
    watched(&app, &robot)?;
    let gone = || Refused::conflict("it isn't watched any more");
    let (core, id) = app.board.address(&robot).ok_or_else(gone)?;
    let (sender, answer) = oneshot::channel();
    core.tell(Control::Command {
        robot: id,
        command,
        reply: Box::new(move |answer| {
            // Who asked may have gone.
            let _gone = sender.send(answer);
        }),
    });
    let answer = tokio::time::timeout(ANSWER_WITHIN, answer).await;
    let Ok(answer) = answer else {
        return Err(Refused::new(
            StatusCode::GATEWAY_TIMEOUT,
            "no answer yet: look into the journal whether it was stored",
        ));
    };
    match answer {
        Ok(Answer::Stored) => Ok(Json(Done { done: true })),
        Ok(Answer::Refused(error)) => Err(Refused::unprocessable(error.to_string())),
        Ok(Answer::NotStored(why)) => Err(Refused::new(
            StatusCode::INSUFFICIENT_STORAGE,
            format!(
                "taken, but not stored yet: {why}. It is lost if the monitor stops before the store works again"
            ),
        )),
        Ok(Answer::Gone) | Err(_) => Err(gone()),
    }
}

pub(super) async fn health(State(app): State<App>) -> (StatusCode, &'static str) {
    match app.health.silent_for() < HANGS_AFTER {
        true => (StatusCode::OK, "works\n"),
        false => (StatusCode::SERVICE_UNAVAILABLE, "hangs\n"),
    }
}

pub(super) async fn openapi() -> Response {
    let text = include_str!("../../openapi.json");
    ([(header::CONTENT_TYPE, "application/json")], text).into_response()
}

pub(super) async fn login(
    State(app): State<App>,
    headers: HeaderMap,
    body: Bytes,
) -> Result<Response, Refused> {
    let login: Login = read_body(&body)?;
    if !app.guard.is_token(&login.token) {
        tokio::time::sleep(WRONG_TOKEN).await;
        return Err(Refused::new(
            StatusCode::UNAUTHORIZED,
            "this isn't the token",
        ));
    }
    let proto = headers
        .get("x-forwarded-proto")
        .and_then(|v| v.to_str().ok());
    let mut response = Json(Done { done: true }).into_response();
    if let Some(cookie) = app.guard.cookie(proto == Some("https")) {
        response.headers_mut().insert(header::SET_COOKIE, cookie);
    }
    Ok(response)
}

pub(super) async fn logout() -> Response {
    let mut response = Json(Done { done: true }).into_response();
    let headers = response.headers_mut();
    headers.insert(header::SET_COOKIE, Guard::no_cookie());
    response
}
