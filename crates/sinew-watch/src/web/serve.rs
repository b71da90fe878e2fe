//! Connections: so many at most, and none that never says what it wants.

use axum::Router;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use std::sync::Arc;
use std::time::Duration;
use tokio::net::TcpListener;
use tokio::sync::{Semaphore, watch};

/// Connections at one time, at most.
const CONNECTIONS: usize = 1024;
/// Who doesn't say within this time what is wanted is cut off.
const HEADERS_WITHIN: Duration = Duration::from_secs(10);
/// Kept for a connection before it is sent, bytes: for a browser that doesn't read no more is made.
const BUFFER: usize = 64 << 10;
/// After a refused connection, such as for lack of file numbers.
const PAUSE: Duration = Duration::from_millis(100);

/// Answers until `ends` says so.
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
        // More are closed at once.
        let Ok(permit) = Arc::clone(&room).try_acquire_owned() else {
            continue;
        };
        // Small events at once; a connection that can't is slower.
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
                // Whoever asked has gone, or didn't speak HTTP.
                _done = connection => {}
                _ = ends.wait_for(|ends| *ends) => {}
            }
            drop(permit);
        });
    }
}
