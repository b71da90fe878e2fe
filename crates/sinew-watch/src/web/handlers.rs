//! Handlers of single requests.

use super::api::{
    AlarmList, AlarmView, Done, DueQuery, Journal, JournalQuery, JournalView, Login, RobotNow,
    TendonNow, TestResult, TestResults,
};
use super::guard::{Client, Guard, TokenCheck};
use super::{App, ErrorResponse};
use crate::runtime::{Answer, Control, RobotState, Slot};
use crate::store::{JournalFilter, Reader, Series, SeriesQuery};
use crate::words::response;
use axum::body::Bytes;
use axum::extract::{Path, Query, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse as _, Response};
use axum::{Extension, Json};
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
/// Number of intervals of a series: default and limit.
const INTERVALS: [u32; 2] = [300, 2000];
/// Default horizon of the maintenance forecast, days: eight weeks.
const DUE_WITHIN_DAYS: f64 = 56.0;
/// Maximum time to wait for the result of a command: the store may be slow.
const ANSWER_WITHIN: Duration = Duration::from_secs(20);
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
    let view = entries.into_iter().map(|entry| {
        let slot = app.registry.get(&entry.robot);
        let robot = slot.and_then(|slot| slot.state().snapshot());
        JournalView::of(entry, robot.as_deref())
    });
    Ok(Json(Journal {
        entries: view.collect(),
    }))
}

pub(super) async fn series(
    State(app): State<App>,
    Path((robot, joint)): Path<(String, String)>,
    Query(query): Query<SeriesQuery>,
) -> Result<Json<Series>, ErrorResponse> {
    if app.registry.get(&robot).is_none() {
        return Err(ErrorResponse::not_found(response::no_robot(&robot)));
    }
    let [usual, most] = INTERVALS;
    let intervals = query.intervals.unwrap_or(usual).clamp(1, most);
    let read = move |reader: &Reader| reader.series(&robot, &joint, &query, intervals);
    app.read(read).await.map(Json)
}

pub(super) async fn calendar(
    State(app): State<App>,
    Query(query): Query<DueQuery>,
) -> Result<Response, ErrorResponse> {
    let list = due(State(app), Query(query)).await?.0;
    let headers = [
        (header::CONTENT_TYPE, "text/calendar; charset=utf-8"),
        (
            header::CONTENT_DISPOSITION,
            "attachment; filename=\"maintenance.ics\"",
        ),
    ];
    Ok((headers, super::calendar::text(&list)).into_response())
}

pub(super) async fn test_notifications(
    State(app): State<App>,
) -> Result<Json<TestResults>, ErrorResponse> {
    let receivers = app.receivers.borrow().clone();
    if receivers.is_empty() {
        return Err(ErrorResponse::conflict(response::NO_RECEIVER));
    }
    let results = crate::webhooks::test(&receivers).await;
    let results = results.into_iter().map(|(url, done)| TestResult {
        url,
        error: done.err(),
    });
    Ok(Json(TestResults {
        results: results.collect(),
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
    Extension(client): Extension<Client>,
    body: Bytes,
) -> Result<Response, ErrorResponse> {
    let login: Login = read_body(&body)?;
    let rejected = |status, reason| Err(ErrorResponse::new(status, reason));
    let token = match app.guard.check_token(&login.token, client).await {
        TokenCheck::Right(token) => token,
        TokenCheck::Wrong => return rejected(StatusCode::UNAUTHORIZED, response::INVALID_TOKEN),
        TokenCheck::Excluded => {
            return rejected(StatusCode::TOO_MANY_REQUESTS, response::TOO_MANY_TOKENS);
        }
    };
    let proto = headers
        .get("x-forwarded-proto")
        .and_then(|v| v.to_str().ok());
    let mut response = Json(Done { done: true }).into_response();
    let cookies = token.and_then(|token| app.guard.cookies(token, proto == Some("https")));
    for cookie in cookies.into_iter().flatten() {
        response.headers_mut().append(header::SET_COOKIE, cookie);
    }
    Ok(response)
}

pub(super) async fn logout(State(app): State<App>, headers: HeaderMap) -> Response {
    app.guard.log_out(&headers);
    let mut response = Json(Done { done: true }).into_response();
    for cookie in Guard::no_cookies() {
        response.headers_mut().append(header::SET_COOKIE, cookie);
    }
    response
}
