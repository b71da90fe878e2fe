//! Interruption of a computation at the request of its caller.
//!
//! A caller that starts a computation on its own threads calls [`watch`] in each of them. Long loops call [`check`], which
//! unwinds the computation once the caller has requested it, with [`Interrupted`] as payload.

use std::cell::RefCell;
use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Payload of the unwinding of an interrupted computation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Interrupted;

thread_local! {
    static REQUEST: RefCell<Option<Arc<AtomicBool>>> = const { RefCell::new(None) };
}

/// Ends computations of the calling thread at their next [`check`] after `request` has become true.
pub fn watch(request: Arc<AtomicBool>) {
    REQUEST.with_borrow_mut(|own| *own = Some(request));
}

/// Unwinds the computation if its interruption is requested. Costs a load of an atomic flag; without [`watch`] it has no effect.
pub fn check() {
    let is_requested = REQUEST.with_borrow(|request| {
        let request = request.as_ref();
        request.is_some_and(|request| request.load(Ordering::Relaxed))
    });
    if is_requested {
        // Bypasses the panic hook, because an interruption is not an error.
        resume_unwind(Box::new(Interrupted));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::panic::catch_unwind;

    #[test]
    fn check_unwinds_only_the_registered_thread_after_request() {
        let request = Arc::new(AtomicBool::new(false));
        let of_thread = request.clone();
        let thread = std::thread::spawn(move || {
            watch(of_thread.clone());
            check();
            of_thread.store(true, Ordering::Relaxed);
            catch_unwind(check).is_err_and(|payload| payload.is::<Interrupted>())
        });
        assert!(thread.join().unwrap());
        check();
    }
}
