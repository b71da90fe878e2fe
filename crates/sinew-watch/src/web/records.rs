//! Records of sessions as JSON, CSV and Parquet.

use super::{App, ErrorResponse};
use crate::runtime::{recording_file, recordings_folder};
use crate::store::{
    Position, Reader, RecordQuery, StoreError, write_lives, write_records, write_sessions,
};
use crate::words::response;
use axum::body::Body;
use axum::extract::{Path as Named, Query, State};
use axum::http::header;
use axum::response::{IntoResponse as _, Response};
use bytes::Bytes;
use futures_util::stream;
use sinew_watch_core::Record;
use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use tokio::sync::OwnedSemaphorePermit;

/// Number of records in one JSON response: default and limit.
const RECORDS: [u64; 2] = [1000, 100_000];
/// Number of records that are read and sent at once, about 0.3 MB.
const PIECE_RECORDS: usize = 500;
/// Length of the pieces in which files are sent, bytes.
const PIECE: usize = 64 << 10;

/// File format of records.
struct Form {
    name: &'static str,
    kind: &'static str,
    write: fn(&Reader, &RecordQuery, &Path) -> Result<u64, StoreError>,
}

const CSV: Form = Form {
    name: "records.csv",
    kind: "text/csv; charset=utf-8",
    write: write_records,
};
const PARQUET: Form = Form {
    name: "records.parquet",
    kind: "application/vnd.apache.parquet",
    write: write_records,
};
const SESSIONS: Form = Form {
    name: "sessions.csv",
    kind: "text/csv; charset=utf-8",
    write: write_sessions,
};

const LIVES: Form = Form {
    name: "survival.csv",
    kind: "text/csv; charset=utf-8",
    write: write_lives,
};

/// Records that remain to be sent.
struct Sending {
    app: App,
    query: RecordQuery,
    /// Positions of the next and of the last record; `None`: all are sent.
    rest: Option<[Position; 2]>,
    /// Text that remains to be sent before the next records.
    head: String,
    has_ended: bool,
}

/// Sends records as JSON, read in pieces: a slow client blocks nothing, and the memory does not depend on their number.
pub(super) async fn json(
    State(app): State<App>,
    Query(mut query): Query<RecordQuery>,
) -> Result<Response, ErrorResponse> {
    let [usual, most] = RECORDS;
    query.most = Some(query.most.unwrap_or(usual).min(most));
    let requested = query.clone();
    let found = app.read(move |reader| {
        let exists = requested
            .before
            .map_or(Ok(true), |id| reader.has_record(id))?;
        Ok((exists, reader.span(&requested)?))
    });
    let (exists, span) = found.await?;
    if !exists {
        return Err(ErrorResponse::unprocessable(response::NO_CURSOR));
    }
    let span = span.filter(|_| query.most != Some(0));
    let older = span.filter(|span| span.has_older).map(|span| span.first.id);
    let older = older.map_or("null".into(), |id| id.to_string());
    let sending = Sending {
        app,
        query,
        rest: span.map(|span| [span.first, span.last]),
        head: format!(
            "{{\"schema\":\"{}\",\"older\":{older},\"records\":[",
            Record::SCHEMA
        ),
        has_ended: false,
    };
    let body = Body::from_stream(stream::try_unfold(sending, Sending::next));
    Ok(([(header::CONTENT_TYPE, "application/json")], body).into_response())
}

impl Sending {
    /// Returns the next piece of the response.
    async fn next(mut self) -> Result<Option<(Bytes, Self)>, std::io::Error> {
        if self.has_ended {
            return Ok(None);
        }
        let mut text = std::mem::take(&mut self.head).into_bytes();
        let Some([from, to]) = self.rest.take() else {
            self.has_ended = true;
            text.extend_from_slice(b"]}");
            return Ok(Some((Bytes::from(text), self)));
        };
        let query = self.query.clone();
        let read = self.app.read(move |reader| {
            let mut sent = Ok(());
            let next = reader.piece(&query, [from, to], PIECE_RECORDS, |record| {
                if sent.is_ok() {
                    sent = serde_json::to_writer(&mut text, &record);
                    text.push(b',');
                }
            })?;
            if next.is_none() && text.last() == Some(&b',') {
                text.pop();
            }
            Ok((next, sent.map(|()| text)))
        });
        // The response has begun: an error ends the connection, by which the client notices that it is incomplete.
        let (next, text) = read.await.map_err(|e| std::io::Error::other(e.1))?;
        self.rest = next.map(|next| [next, to]);
        Ok(Some((Bytes::from(text?), self)))
    }
}

pub(super) async fn csv(
    State(app): State<App>,
    Query(query): Query<RecordQuery>,
) -> Result<Response, ErrorResponse> {
    file(app, query, &CSV).await
}

/// Sends the session table for `sinew trend`.
pub(super) async fn sessions(
    State(app): State<App>,
    Named(robot): Named<String>,
) -> Result<Response, ErrorResponse> {
    if app.registry.get(&robot).is_none() {
        let reason = format!("robot '{robot}' not found");
        return Err(ErrorResponse::not_found(reason));
    }
    let of_robot = RecordQuery {
        robot: Some(robot),
        ..RecordQuery::default()
    };
    file(app, of_robot, &SESSIONS).await
}

/// Sends the table of lifetimes for `sinew trend survival`.
pub(super) async fn lives(State(app): State<App>) -> Result<Response, ErrorResponse> {
    file(app, RecordQuery::default(), &LIVES).await
}

pub(super) async fn parquet(
    State(app): State<App>,
    Query(query): Query<RecordQuery>,
) -> Result<Response, ErrorResponse> {
    file(app, query, &PARQUET).await
}

/// Sends a file of records: written completely first, so that a slow client blocks nothing.
async fn file(
    app: App,
    query: RecordQuery,
    form: &'static Form,
) -> Result<Response, ErrorResponse> {
    let busy = |_| ErrorResponse::unavailable(response::EXPORTS_BUSY);
    let permit = Arc::clone(&app.exports).try_acquire_owned().map_err(busy)?;
    let folder = app.temporary_folder();
    let written = app.read(move |reader| write(reader, &query, form, &folder));
    Ok(send(form.name, form.kind, (written.await?, permit)))
}

/// Sends the recording of an incident.
pub(super) async fn recording(
    State(app): State<App>,
    Named((robot, number)): Named<(String, u64)>,
) -> Result<Response, ErrorResponse> {
    let none = || ErrorResponse::not_found(response::no_recording(&robot, number));
    let store = app.readers.place.folder();
    let store = store.filter(|_| app.registry.get(&robot).is_some());
    let path = recording_file(&recordings_folder(store.ok_or_else(none)?, &robot), number);
    let busy = |_| ErrorResponse::unavailable(response::EXPORTS_BUSY);
    let permit = Arc::clone(&app.exports).try_acquire_owned().map_err(busy)?;
    let found = tokio::task::spawn_blocking(move || File::open(path)).await;
    let file = found.ok().and_then(Result::ok).ok_or_else(none)?;
    let name = format!("{robot}-incident-{number}.mcap");
    Ok(send(&name, "application/octet-stream", (file, permit)))
}

fn send(name: &str, kind: &str, file: SendingFile) -> Response {
    let named = format!("attachment; filename=\"{name}\"");
    let headers = [
        (header::CONTENT_TYPE, kind),
        (header::CONTENT_DISPOSITION, named.as_str()),
    ];
    let body = Body::from_stream(stream::try_unfold(file, piece));
    (headers, body).into_response()
}

type SendingFile = (File, OwnedSemaphorePermit);

async fn piece((mut file, permit): SendingFile) -> std::io::Result<Option<(Bytes, SendingFile)>> {
    let read = tokio::task::spawn_blocking(move || {
        let mut piece = vec![0; PIECE];
        let length = file.read(&mut piece)?;
        piece.truncate(length);
        Ok::<_, std::io::Error>((piece, file))
    });
    let (piece, file) = read.await.map_err(std::io::Error::other)??;
    Ok((!piece.is_empty()).then(|| (Bytes::from(piece), (file, permit))))
}

/// Writes an unnamed temporary file.
fn write(
    reader: &Reader,
    query: &RecordQuery,
    form: &Form,
    folder: &Path,
) -> Result<File, StoreError> {
    static NUMBER: AtomicU64 = AtomicU64::new(0);
    let number = NUMBER.fetch_add(1, Ordering::Relaxed);
    let name = format!("sinew-watch-{}-{number}-{}", std::process::id(), form.name);
    let path: PathBuf = folder.join(name);
    let error = |source| StoreError::Folder {
        folder: path.clone(),
        source,
    };
    (form.write)(reader, query, &path)?;
    let file = File::open(&path).map_err(error)?;
    std::fs::remove_file(&path).map_err(error)?;
    Ok(file)
}
