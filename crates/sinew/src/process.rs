//! What the process was started with.

#[cfg(unix)]
mod unix {
    use std::sync::atomic::{AtomicBool, Ordering};

    static STDOUT_WAS_CLOSED: AtomicBool = AtomicBool::new(false);

    ctor::declarative::ctor! {
        /// Before `main`, where the standard library opens /dev/null in the place of a closed stdout:
        /// one call of the system, nothing of `std`.
        #[ctor(unsafe)]
        fn look_at_stdout() {
            let closed = rustix::io::fcntl_getfd(rustix::stdio::stdout()).is_err();
            STDOUT_WAS_CLOSED.store(closed, Ordering::Relaxed);
        }
    }

    pub(super) fn stdout_was_closed() -> bool {
        STDOUT_WAS_CLOSED.load(Ordering::Relaxed)
    }
}

/// Whether the process was started without a stdout (`sinew … >&-`).
pub(crate) fn stdout_was_closed() -> bool {
    #[cfg(unix)]
    return unix::stdout_was_closed();
    #[cfg(not(unix))]
    return false;
}
