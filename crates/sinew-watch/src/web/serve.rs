//! HTTP connections with limits on number and duration.
//!
//! A client that sends nothing, or its body byte by byte, holds a connection only while there is room: where connections
//! run out, the oldest one without a complete request is closed. Where all have one, such as pages that receive events, a
//! reserve of connections answers the health check only.

use super::ErrorResponse;
use super::guard::Client;
use crate::words::response;
use axum::Router;
use axum::body::{Body, to_bytes};
use axum::extract::Request;
use axum::http::StatusCode;
use axum::middleware::Next;
use axum::response::{IntoResponse as _, Response};
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper::service::{Service as _, service_fn};
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use std::net::IpAddr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Weak};
use std::time::Duration;
use tokio::net::TcpListener;
use tokio::sync::{Notify, watch};

/// Maximum numbers of simultaneous connections.
#[derive(Debug, Clone, Copy)]
struct Most {
    connections: usize,
    of_address: usize,
    reserve: usize,
}

/// A process has 1,024 file descriptors by default; a quarter is left to robots and store. One address holds half.
const MAX_CONNECTIONS: Most = Most {
    connections: 768,
    of_address: 384,
    reserve: 16,
};
/// Maximum time until a request header is complete; then the connection is closed.
const HEADERS_WITHIN: Duration = Duration::from_secs(10);
/// Maximum length of a request body, bytes.
const MAX_BODY_BYTES: usize = 64 << 10;
/// Maximum time until a request body is complete.
const BODY_WITHIN: Duration = Duration::from_secs(10);
/// Send buffer of a connection, bytes: no more is produced for a browser that does not read.
const BUFFER: usize = 64 << 10;
/// Pause after a failed accept, for example without free file descriptors.
const PAUSE: Duration = Duration::from_millis(100);

/// Connection of a client.
struct Connection {
    address: IpAddr,
    /// Whether it answers the health check only, once.
    is_reserve: bool,
    /// Whether a complete request has arrived.
    is_served: AtomicBool,
    /// Closes the connection.
    close: Notify,
}

/// Open connections, the oldest first.
struct Connections {
    open: Vec<Weak<Connection>>,
    most: Most,
}

impl Connections {
    /// Adds a connection; closes the oldest one without a complete request if there are too many. If there is none such, the
    /// connection is of the reserve; `None` if that is used up.
    fn add(&mut self, address: IpAddr) -> Option<Arc<Connection>> {
        self.open.retain(|c| c.strong_count() > 0);
        let is_own = |c: &Connection| c.address == address;
        let open: Vec<Arc<Connection>> = self.open.iter().filter_map(Weak::upgrade).collect();
        let is_of_address_full = open.iter().filter(|c| is_own(c)).count() >= self.most.of_address;
        let mut is_reserve = false;
        if is_of_address_full || open.len() >= self.most.connections {
            let is_silent = |c: &&Arc<Connection>| {
                !c.is_served.load(Ordering::Relaxed) && (!is_of_address_full || is_own(c))
            };
            if let Some(oldest) = open.iter().find(is_silent) {
                is_reserve = oldest.is_reserve;
                oldest.close.notify_one();
                self.open
                    .retain(|c| !std::ptr::eq(c.as_ptr(), Arc::as_ptr(oldest)));
            } else {
                is_reserve = true;
                let used = open.iter().filter(|c| c.is_reserve).count();
                if used >= self.most.reserve {
                    return None;
                }
            }
        }
        let connection = Arc::new(Connection {
            address,
            is_reserve,
            is_served: AtomicBool::new(false),
            close: Notify::new(),
        });
        self.open.push(Arc::downgrade(&connection));
        Some(connection)
    }
}

/// Serves requests until `ends` is true.
pub async fn serve(listener: TcpListener, router: Router, ends: watch::Receiver<bool>) {
    serve_at_most(MAX_CONNECTIONS, listener, router, ends).await;
}

/// Serves requests as [`serve`], with other maximum numbers of connections.
async fn serve_at_most(
    most: Most,
    listener: TcpListener,
    router: Router,
    mut ends: watch::Receiver<bool>,
) {
    let mut connections = Connections {
        open: Vec::new(),
        most,
    };
    loop {
        let accepted = tokio::select! {
            accepted = listener.accept() => accepted,
            _ = ends.wait_for(|ends| *ends) => return,
        };
        let Ok((stream, client)) = accepted else {
            tokio::time::sleep(PAUSE).await;
            continue;
        };
        let Some(connection) = connections.add(client.ip()) else {
            continue;
        };
        // Sends small events immediately; otherwise the connection is slower.
        let _slower = stream.set_nodelay(true);
        let router = TowerToHyperService::new(router.clone());
        let own = Arc::clone(&connection);
        let service = service_fn(move |mut request: hyper::Request<Incoming>| {
            request.extensions_mut().insert(Arc::clone(&own));
            request.extensions_mut().insert(Client(own.address));
            let is_answered = !own.is_reserve || request.uri().path() == "/healthz";
            let answer = router.call(request);
            async move {
                match is_answered {
                    true => answer.await,
                    false => {
                        Ok(ErrorResponse::unavailable(response::TOO_MANY_PAGES).into_response())
                    }
                }
            }
        });
        let served = http1::Builder::new()
            .keep_alive(!connection.is_reserve)
            .timer(TokioTimer::new())
            .header_read_timeout(HEADERS_WITHIN)
            .max_buf_size(BUFFER)
            .serve_connection(TokioIo::new(stream), service);
        let mut ends = ends.clone();
        tokio::spawn(async move {
            tokio::select! {
                // The client disconnected or did not speak HTTP.
                _done = served => {}
                () = connection.close.notified() => {}
                _ = ends.wait_for(|ends| *ends) => {}
            }
        });
    }
}

/// Reads the body of a request before it is handled, within a deadline.
pub(super) async fn complete(request: Request, next: Next) -> Response {
    let (parts, body) = request.into_parts();
    let read = tokio::time::timeout(BODY_WITHIN, to_bytes(body, MAX_BODY_BYTES)).await;
    let rejection = |status, reason| ErrorResponse::new(status, reason).into_response();
    match read {
        Ok(Ok(body)) => {
            if let Some(connection) = parts.extensions.get::<Arc<Connection>>() {
                connection.is_served.store(true, Ordering::Relaxed);
            }
            next.run(Request::from_parts(parts, Body::from(body))).await
        }
        Ok(Err(_too_long)) => rejection(StatusCode::PAYLOAD_TOO_LARGE, response::BODY_TOO_LONG),
        Err(_elapsed) => rejection(StatusCode::REQUEST_TIMEOUT, response::BODY_TOO_SLOW),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::middleware::from_fn;
    use axum::routing::{get, post};
    use std::io::{Read as _, Write as _};
    use std::net::{SocketAddr, TcpStream};

    const TEST_CONNECTIONS: Most = Most {
        connections: 8,
        of_address: 6,
        reserve: 2,
    };

    /// Serves `/healthz` and `/login` with few connections, until the sender is dropped.
    fn server() -> (SocketAddr, watch::Sender<bool>) {
        let (ending, ends) = watch::channel(false);
        let (sender, address) = std::sync::mpsc::channel();
        std::thread::spawn(move || {
            let runtime = tokio::runtime::Builder::new_current_thread()
                .enable_all()
                .build()
                .expect("a runtime");
            runtime.block_on(async {
                let listener = TcpListener::bind("127.0.0.1:0").await.expect("a port");
                sender
                    .send(listener.local_addr().expect("an address"))
                    .expect("a receiver");
                let router = Router::new()
                    .route("/healthz", get(|| async { "works" }))
                    .route("/login", post(|body: String| async { body }))
                    .layer(from_fn(complete));
                serve_at_most(TEST_CONNECTIONS, listener, router, ends).await;
            });
        });
        (address.recv().expect("an address"), ending)
    }

    fn health(at: SocketAddr) -> String {
        let mut stream = TcpStream::connect(at).expect("a connection");
        let request = b"GET /healthz HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n";
        stream.write_all(request).expect("sent");
        let mut answer = String::new();
        stream.read_to_string(&mut answer).expect("an answer");
        answer
    }

    #[test]
    fn clients_without_complete_request_do_not_lock_out_others() {
        let (at, _ending) = server();
        let slow = b"POST /login HTTP/1.1\r\nHost: localhost\r\nContent-Length: 9\r\n\r\n{";
        let clients: Vec<TcpStream> = (0..40)
            .map(|k| {
                let mut client = TcpStream::connect(at).expect("a connection");
                if k % 2 == 0 {
                    client.write_all(slow).expect("sent");
                }
                client
            })
            .collect();
        for _ in 0..3 {
            let answer = health(at);
            assert!(answer.ends_with("works"), "{answer}");
        }
        drop(clients);
    }

    /// Answer to a request on a connection that stays open.
    fn kept(at: SocketAddr, path: &str) -> (TcpStream, String) {
        let mut stream = TcpStream::connect(at).expect("a connection");
        let request = format!("GET {path} HTTP/1.1\r\nHost: localhost\r\n\r\n");
        stream.write_all(request.as_bytes()).expect("sent");
        let mut answer = [0; 400];
        let read = stream.read(&mut answer).expect("an answer");
        let answer = String::from_utf8_lossy(&answer[..read]).into_owned();
        (stream, answer)
    }

    #[test]
    fn health_is_answered_while_served_clients_hold_all() {
        let (at, _ending) = server();
        let holders: Vec<_> = (0..6).map(|_| kept(at, "/healthz")).collect();
        assert!(holders.iter().all(|(_, answer)| answer.contains("200 OK")));
        for _ in 0..20 {
            let begun = std::time::Instant::now();
            let answer = health(at);
            assert!(answer.ends_with("works"), "{answer}");
            assert!(begun.elapsed() < Duration::from_secs(5));
        }
        let (_closed, other) = kept(at, "/other");
        assert!(other.contains("503"), "{other}");
        // Silent clients do not use up the reserve.
        let silent: Vec<_> = (0..10).map(|_| TcpStream::connect(at)).collect();
        assert!(health(at).ends_with("works"));
        drop((holders, silent));
    }

    #[test]
    fn served_connections_are_not_closed_for_new_ones() {
        let mut connections = Connections {
            open: Vec::new(),
            most: TEST_CONNECTIONS,
        };
        let [one, other] = [[10, 0, 0, 1], [10, 0, 0, 2]].map(IpAddr::from);
        let held: Vec<_> = (0..6).filter_map(|_| connections.add(one)).collect();
        for connection in &held {
            connection.is_served.store(true, Ordering::Relaxed);
        }
        let is_reserve = |added: Option<Arc<Connection>>| added.map(|added| added.is_reserve);
        assert_eq!(
            is_reserve(connections.add(one)),
            Some(true),
            "the address is full"
        );
        let others: Vec<_> = (0..2).filter_map(|_| connections.add(other)).collect();
        assert_eq!(others.len(), 2);
        let silent = connections.add(other);
        assert_eq!(is_reserve(silent), Some(false), "a silent one is closed");
        drop(held);
        assert_eq!(
            is_reserve(connections.add(one)),
            Some(false),
            "closed ones make room"
        );
    }
}
