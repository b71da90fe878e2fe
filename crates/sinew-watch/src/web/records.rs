//! Records of sessions as JSON, CSV and Parquet.

use super::api::Records;
use super::{App, ErrorResponse};
use crate::store::{Reader, RecordQuery, StoreError, write_records, write_sessions};
use crate::words::response;
use axum::Json;
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

pub(super) async fn json(
    State(app): State<App>,
    Query(mut query): Query<RecordQuery>,
) -> Result<Json<Records>, ErrorResponse> {
    let [usual, most] = RECORDS;
    query.most = Some(query.most.unwrap_or(usual).min(most));
    let records = app.read(move |reader| reader.records(&query)).await?;
    Ok(Json(Records {
        schema: Record::SCHEMA,
        records,
    }))
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
    let file = app.read(move |reader| write(reader, &query, form)).await?;
    let named = format!("attachment; filename=\"{}\"", form.name);
    let headers = [
        (header::CONTENT_TYPE, form.kind),
        (header::CONTENT_DISPOSITION, named.as_str()),
    ];
    let body = Body::from_stream(stream::try_unfold((file, permit), piece));
    Ok((headers, body).into_response())
}

type Sending = (File, OwnedSemaphorePermit);

async fn piece((mut file, permit): Sending) -> std::io::Result<Option<(Bytes, Sending)>> {
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
fn write(reader: &Reader, query: &RecordQuery, form: &Form) -> Result<File, StoreError> {
    static NUMBER: AtomicU64 = AtomicU64::new(0);
    let number = NUMBER.fetch_add(1, Ordering::Relaxed);
    let name = format!("sinew-watch-{}-{number}-{}", std::process::id(), form.name);
    let path: PathBuf = std::env::temp_dir().join(name);
    let error = |source| StoreError::Folder {
        folder: path.clone(),
        source,
    };
    (form.write)(reader, query, &path)?;
    let file = File::open(&path).map_err(error)?;
    std::fs::remove_file(&path).map_err(error)?;
    Ok(file)
}
