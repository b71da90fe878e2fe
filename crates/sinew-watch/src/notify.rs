//! Notification of systemd: ready, alive, stopping. Sends a datagram to `$NOTIFY_SOCKET`; does nothing without it.

use std::time::Duration;

/// Notifies systemd of a state, such as `READY=1`.
pub fn notify(what: &str) {
    if let Some(socket) = std::env::var_os("NOTIFY_SOCKET") {
        // Without the message systemd eventually stops the process and logs the reason.
        let _unheard = send(&socket, what.as_bytes());
    }
}

#[cfg(target_os = "linux")]
fn send(socket: &std::ffi::OsStr, what: &[u8]) -> std::io::Result<()> {
    use std::os::linux::net::SocketAddrExt as _;
    use std::os::unix::ffi::OsStrExt as _;
    use std::os::unix::net::{SocketAddr, UnixDatagram};

    let address = match socket.as_bytes().strip_prefix(b"@") {
        Some(name) => SocketAddr::from_abstract_name(name)?,
        None => SocketAddr::from_pathname(socket)?,
    };
    UnixDatagram::unbound()?.send_to_addr(what, &address)?;
    Ok(())
}

#[cfg(not(target_os = "linux"))]
fn send(_socket: &std::ffi::OsStr, _what: &[u8]) -> std::io::Result<()> {
    Ok(())
}

/// Returns the interval of the notifications that systemd expects; `None`: none expected.
pub fn watchdog() -> Option<Duration> {
    let own = std::env::var("WATCHDOG_PID").ok();
    if own.is_some_and(|pid| pid != std::process::id().to_string()) {
        return None;
    }
    let us: u64 = std::env::var("WATCHDOG_USEC").ok()?.parse().ok()?;
    (us > 0).then(|| Duration::from_micros(us) / 2)
}
