//! HTTP connections with limits on number and duration.

use axum::Router;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use std::sync::Arc;
use std::time::Duration;
use tokio::net::TcpListener;
use tokio::sync::{Semaphore, watch};

/// Maximum number of simultaneous connections.
const CONNECTIONS: usize = 1024;
/// Maximum time until a request header is complete; then the connection is closed.
const HEADERS_WITHIN: Duration = Duration::from_secs(10);
/// Send buffer of a connection, bytes: no more is produced for a browser that does not read.
const BUFFER: usize = 64 << 10;
/// Pause after a failed accept, for example without free file descriptors.
const PAUSE: Duration = Duration::from_millis(100);

/// Serves requests until `ends` is true.
pub async fn serve(listener: TcpListener, router: Router, mut ends: watch::Receiver<bool>) {
    let room = Arc::new(Semaphore::new(CONNECTIONS));
    loop {
        let accepted = tokio::select! {
            accepted = listener.accept() => accepted,
            _ = ends.wait_for(|ends| *ends) => return,
        };
        let Ok((stream, _)) = accepted else {
            tokio::time::sleep(PAUSE).await;
            continue;
        };
        // Further connections are closed immediately.
        let Ok(permit) = Arc::clone(&room).try_acquire_owned() else {
            continue;
        };
        // Sends small events immediately; otherwise the connection is slower.
        let _slower = stream.set_nodelay(true);
        let service = TowerToHyperService::new(router.clone());
        let connection = http1::Builder::new()
            .timer(TokioTimer::new())
            .header_read_timeout(HEADERS_WITHIN)
            .max_buf_size(BUFFER)
            .serve_connection(TokioIo::new(stream), service);
        let mut ends = ends.clone();
        tokio::spawn(async move {
            tokio::select! {
                // The client disconnected or did not speak HTTP.
                _done = connection => {}
                _ = ends.wait_for(|ends| *ends) => {}
            }
            drop(permit);
        });
    }
}
