//! Conversion of C pointers to references, and of messages to buffers.

use crate::status::Status;
use std::ffi::{CStr, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Runs a call and converts a panic to a status.
pub(crate) fn guarded(call: impl FnOnce() -> Result<(), Status>) -> Status {
    // A handle in an inconsistent state after a panic may only be freed.
    match catch_unwind(AssertUnwindSafe(call)) {
        Ok(Ok(())) => Status::Ok,
        Ok(Err(status)) => status,
        Err(_) => Status::Panic,
    }
}

/// Reads a text of the caller.
///
/// # Safety
/// `text` is null or ends with a zero byte, and does not change during the call.
pub(crate) unsafe fn text<'a>(text: *const c_char) -> Result<&'a str, Status> {
    if text.is_null() {
        return Err(Status::Null);
    }
    // SAFETY: not null, and guaranteed by the caller.
    unsafe { CStr::from_ptr(text) }
        .to_str()
        .map_err(|_| Status::Encoding)
}

/// Borrows a handle of the caller.
///
/// # Safety
/// `handle` is null or was created by a constructor and not freed.
pub(crate) unsafe fn shared<'a, T>(handle: *const T) -> Result<&'a T, Status> {
    // SAFETY: guaranteed by the caller; null becomes a status.
    unsafe { handle.as_ref() }.ok_or(Status::Null)
}

/// Borrows a handle of the caller mutably.
///
/// # Safety
/// As [`shared`], and the handle is not used concurrently.
pub(crate) unsafe fn unique<'a, T>(handle: *mut T) -> Result<&'a mut T, Status> {
    // SAFETY: guaranteed by the caller; null becomes a status.
    unsafe { handle.as_mut() }.ok_or(Status::Null)
}

/// Borrows an array of the caller.
///
/// # Safety
/// `values` is null or points to `length` numbers.
pub(crate) unsafe fn array<'a>(values: *const f64, length: usize) -> Result<&'a [f64], Status> {
    if values.is_null() {
        return Err(Status::Null);
    }
    // SAFETY: not null, and guaranteed by the caller.
    Ok(unsafe { std::slice::from_raw_parts(values, length) })
}

/// Borrows an optional array of the caller; null is an empty slice.
///
/// # Safety
/// As [`array`].
pub(crate) unsafe fn optional<'a>(values: *const f64, length: usize) -> &'a [f64] {
    // SAFETY: as the caller promises.
    unsafe { array(values, length) }.unwrap_or(&[])
}

/// Copies `from` into an array of the caller.
///
/// # Safety
/// `into` is null or has room for as many numbers as `from` has.
pub(crate) unsafe fn fill(into: *mut f64, from: &[f64]) -> Result<(), Status> {
    if into.is_null() {
        return Err(Status::Null);
    }
    // SAFETY: not null, and guaranteed by the caller; what a handle holds is not the caller's array.
    unsafe { std::ptr::copy_nonoverlapping(from.as_ptr(), into, from.len()) };
    Ok(())
}

/// Writes a value to a pointer of the caller, unless it is null.
///
/// # Safety
/// `place` is null or may be written.
pub(crate) unsafe fn put<T>(place: *mut T, value: T) {
    if !place.is_null() {
        // SAFETY: not null, and guaranteed by the caller; what was there is not dropped.
        unsafe { place.write(value) };
    }
}

/// Creates a handle and passes its ownership to the caller.
///
/// # Safety
/// `out` is null or may be written.
pub(crate) unsafe fn give<T>(
    out: *mut *mut T,
    make: impl FnOnce() -> Result<T, CallError>,
) -> Result<(), CallError> {
    if out.is_null() {
        return Err(Status::Null.into());
    }
    let handle = Box::into_raw(Box::new(make()?));
    // SAFETY: not null, and guaranteed by the caller.
    unsafe { out.write(handle) };
    Ok(())
}

/// Frees a handle; null has no effect.
///
/// # Safety
/// `handle` is null or was created by [`give`] and not freed before.
pub(crate) unsafe fn take<T>(handle: *mut T) {
    if !handle.is_null() {
        // SAFETY: made by `Box::into_raw`, and guaranteed by the caller. A drop that panics would be caught.
        let boxed = unsafe { Box::from_raw(handle) };
        let _ = catch_unwind(AssertUnwindSafe(move || drop(boxed)));
    }
}

/// Writes a text into a buffer of the caller, truncated to `room` bytes including the final zero.
///
/// # Safety
/// `into` is null or has room for `room` bytes.
pub(crate) unsafe fn write(into: *mut c_char, room: usize, text: &str) {
    if into.is_null() || room == 0 {
        return;
    }
    let mut end = text.len().min(room - 1);
    // A truncated text ends at a character boundary.
    while !text.is_char_boundary(end) {
        end -= 1;
    }
    // SAFETY: `end + 1` bytes at most `room`; guaranteed by the caller.
    unsafe {
        std::ptr::copy_nonoverlapping(text.as_ptr().cast(), into, end);
        into.add(end).write(0);
    }
}

/// Error of a constructor.
pub(crate) enum CallError {
    /// Error described by its status.
    Status(Status),
    /// Invalid input, with a message.
    Message(String),
}

impl From<Status> for CallError {
    fn from(status: Status) -> Self {
        Self::Status(status)
    }
}

impl<E: std::error::Error> From<E> for CallError {
    fn from(error: E) -> Self {
        Self::Message(error.to_string())
    }
}

/// Runs a call and writes its error message to `reason`, truncated to `why_len` bytes including the final zero.
///
/// # Safety
/// `reason` is null or has room for `why_len` bytes.
pub(crate) unsafe fn explained(
    reason: *mut c_char,
    why_len: usize,
    call: impl FnOnce() -> Result<(), CallError>,
) -> Status {
    let mut message = String::new();
    let status = guarded(|| {
        call().map_err(|error| match error {
            CallError::Status(status) => status,
            CallError::Message(text) => {
                message = text;
                Status::Invalid
            }
        })
    });
    // Every error has a message.
    if message.is_empty() && status != Status::Ok {
        message = status.text().to_string_lossy().into_owned();
    }
    // SAFETY: guaranteed by the caller.
    unsafe { write(reason, why_len, &message) };
    status
}

#[cfg(test)]
mod tests {
    use super::{explained, guarded};
    use crate::status::Status;

    #[test]
    fn panic_becomes_status() {
        assert_eq!(guarded(|| panic!("as if")), Status::Panic);
        // SAFETY: the length of the buffer is zero.
        let status = unsafe { explained(std::ptr::null_mut(), 0, || panic!("as if")) };
        assert_eq!(status, Status::Panic);
    }
}
