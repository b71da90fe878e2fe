//! Handlers of single requests.

use super::api::{
    AlarmList, AlarmView, Done, DueQuery, Journal, JournalQuery, JournalView, Login, RobotNow,
    TendonNow,
};
use super::guard::Guard;
use super::{App, ErrorResponse};
use crate::runtime::{Answer, Control, RobotState, Slot};
use crate::store::JournalFilter;
use crate::words::{self, response};
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

/// Number of journal entries in one response: default and limit.
const ENTRIES: [u64; 2] = [100, 1000];
/// Default horizon of the maintenance forecast, days: eight weeks.
const DUE_WITHIN_DAYS: f64 = 56.0;
/// Maximum time to wait for the result of a command: the store may be slow.
const ANSWER_WITHIN: Duration = Duration::from_secs(20);
/// Delay of the response to a wrong token.
const WRONG_TOKEN: Duration = Duration::from_millis(500);
/// Time without a loop after which a core thread counts as hanging.
const HANGS_AFTER: Duration = Duration::from_secs(10);

pub(super) async fn fleet(State(app): State<App>) -> Response {
    let fleet = app.ticks.borrow().fleet.clone();
    ([(header::CONTENT_TYPE, "application/json")], fleet).into_response()
}

/// Returns the snapshot of a monitored robot, or an error response.
fn monitored(app: &App, robot: &str) -> Result<(Arc<Slot>, Arc<RobotSnapshot>), ErrorResponse> {
    let slot = app.registry.get(robot);
    match slot.map(|slot| (slot.state(), slot)) {
        Some((RobotState::Monitored(snapshot), slot)) => Ok((slot, snapshot)),
        Some((RobotState::NotMonitored(reason), _)) => Err(ErrorResponse::conflict(
            response::not_monitored(robot, &reason),
        )),
        Some((RobotState::Starting, _)) => Err(ErrorResponse::unavailable(response::IS_STARTING)),
        None => Err(ErrorResponse::not_found(response::no_robot(robot))),
    }
}

pub(super) async fn robot(
    State(app): State<App>,
    Path(robot): Path<String>,
) -> Result<Json<RobotNow>, ErrorResponse> {
    let (slot, snapshot) = monitored(&app, &robot)?;
    Ok(Json(RobotNow::of(snapshot, &slot)))
}

pub(super) async fn tendon(
    State(app): State<App>,
    Path((robot, joint)): Path<(String, String)>,
) -> Result<Json<TendonNow>, ErrorResponse> {
    let (_, snapshot) = monitored(&app, &robot)?;
    TendonNow::of(&snapshot, &joint).map(Json).ok_or_else(|| {
        let joints: Vec<&str> = snapshot.tendons.iter().map(|t| t.joint.as_str()).collect();
        let joints = joints.join(", ");
        ErrorResponse::not_found(response::no_tendon(&robot, &joint, &joints))
    })
}

pub(super) async fn due(
    State(app): State<App>,
    Query(query): Query<DueQuery>,
) -> Result<Json<DueList>, ErrorResponse> {
    let within_days = query.within_days.unwrap_or(DUE_WITHIN_DAYS);
    if !(within_days > 0.0 && within_days <= HORIZON_DAYS) {
        let reason = response::invalid_period(HORIZON_DAYS);
        return Err(ErrorResponse::unprocessable(reason));
    }
    let robots = app.registry.all().into_iter();
    let robots: Vec<Arc<RobotSnapshot>> = robots
        .filter_map(|(_, slot)| slot.state().snapshot())
        .collect();
    let robots = robots.iter().map(Arc::as_ref);
    let time_utc_s = app.ticks.borrow().time_utc_s;
    Ok(Json(DueList::of(robots, time_utc_s, DAY_S * within_days)))
}

pub(super) async fn alarms(State(app): State<App>) -> Json<AlarmList> {
    let mut alarms: Vec<AlarmView> = Vec::new();
    for (name, slot) in app.registry.all() {
        if let RobotState::Monitored(robot) = slot.state() {
            alarms.extend(robot.alarms.iter().map(|alarm| AlarmView::of(&name, alarm)));
        }
    }
    alarms.sort_by_key(|view| std::cmp::Reverse(view.severity));
    Json(AlarmList { alarms })
}

pub(super) async fn journal(
    State(app): State<App>,
    Query(query): Query<JournalQuery>,
) -> Result<Json<Journal>, ErrorResponse> {
    let [usual, most] = ENTRIES;
    let query = JournalFilter {
        robot: query.robot,
        event: query.event,
        before: query.before,
        most: query.most.unwrap_or(usual).min(most),
    };
    let entries = app.read(move |reader| reader.journal(&query)).await?;
    let view = entries.into_iter().map(|entry| JournalView {
        text: words::entry(&entry.entry.event),
        entry,
    });
    Ok(Json(Journal {
        entries: view.collect(),
    }))
}

/// Parses a JSON body; returns the reason if it is invalid.
fn read_body<T: DeserializeOwned>(body: &[u8]) -> Result<T, ErrorResponse> {
    serde_json::from_slice(body)
        .map_err(|e| ErrorResponse::unprocessable(response::invalid_body(e)))
}

pub(super) async fn command(
    State(app): State<App>,
    Path(robot): Path<String>,
    body: Bytes,
) -> Result<Json<Done>, ErrorResponse> {
    let command: Command = read_body(&body)?;
    monitored(&app, &robot)?;
    let gone = || ErrorResponse::conflict(response::IS_GONE);
    let (core, id) = app.registry.address(&robot).ok_or_else(gone)?;
    let (sender, answer) = oneshot::channel();
    core.send(Control::Command {
        robot: id,
        command,
        reply: Box::new(move |answer| {
            // The client may have disconnected.
            let _gone = sender.send(answer);
        }),
    });
    let answer = tokio::time::timeout(ANSWER_WITHIN, answer).await;
    let Ok(answer) = answer else {
        return Err(ErrorResponse::new(
            StatusCode::GATEWAY_TIMEOUT,
            response::NO_RESULT,
        ));
    };
    match answer {
        Ok(Answer::Stored) => Ok(Json(Done { done: true })),
        Ok(Answer::Rejected(error)) => Err(ErrorResponse::unprocessable(error.to_string())),
        Ok(Answer::NotStored(reason)) => Err(ErrorResponse::new(
            StatusCode::INSUFFICIENT_STORAGE,
            response::not_stored(&reason),
        )),
        Ok(Answer::Gone) | Err(_) => Err(gone()),
    }
}

pub(super) async fn health(State(app): State<App>) -> (StatusCode, &'static str) {
    match app.health.silent_for() < HANGS_AFTER {
        true => (StatusCode::OK, response::WORKS),
        false => (StatusCode::SERVICE_UNAVAILABLE, response::HANGS),
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
) -> Result<Response, ErrorResponse> {
    let login: Login = read_body(&body)?;
    if !app.guard.is_token(&login.token) {
        tokio::time::sleep(WRONG_TOKEN).await;
        return Err(ErrorResponse::new(
            StatusCode::UNAUTHORIZED,
            response::INVALID_TOKEN,
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
