//! From pointers of C to references, and from sentences to buffers.

use crate::status::Status;
use std::ffi::{CStr, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Runs a call; a panic becomes a status.
pub(crate) fn guarded(call: impl FnOnce() -> Result<(), Status>) -> Status {
    // What a panic left half done is only freed afterwards.
    match catch_unwind(AssertUnwindSafe(call)) {
        Ok(Ok(())) => Status::Ok,
        Ok(Err(status)) => status,
        Err(_) => Status::Panic,
    }
}

/// A text of the caller.
///
/// # Safety
/// `text` is null or ends with a zero byte, and stays as it is during the call.
pub(crate) unsafe fn text<'a>(text: *const c_char) -> Result<&'a str, Status> {
    if text.is_null() {
        return Err(Status::Null);
    }
    // SAFETY: not null, and the caller's promise.
    unsafe { CStr::from_ptr(text) }
        .to_str()
        .map_err(|_| Status::Encoding)
}

/// A handle of the caller.
///
/// # Safety
/// `handle` is null or was given out by a constructor and not freed.
pub(crate) unsafe fn shared<'a, T>(handle: *const T) -> Result<&'a T, Status> {
    // SAFETY: the caller's promise; null becomes a status.
    unsafe { handle.as_ref() }.ok_or(Status::Null)
}

/// A handle of the caller that is changed.
///
/// # Safety
/// As [`shared`], and nobody else uses it during the call.
pub(crate) unsafe fn unique<'a, T>(handle: *mut T) -> Result<&'a mut T, Status> {
    // SAFETY: the caller's promise; null becomes a status.
    unsafe { handle.as_mut() }.ok_or(Status::Null)
}

/// An array of the caller.
///
/// # Safety
/// `values` is null or points to `length` numbers.
pub(crate) unsafe fn array<'a>(values: *const f64, length: usize) -> Result<&'a [f64], Status> {
    if values.is_null() {
        return Err(Status::Null);
    }
    // SAFETY: not null, and the caller's promise.
    Ok(unsafe { std::slice::from_raw_parts(values, length) })
}

/// An array of the caller that may be left out.
///
/// # Safety
/// As [`array`].
pub(crate) unsafe fn optional<'a>(values: *const f64, length: usize) -> &'a [f64] {
    // SAFETY: as the caller promises.
    unsafe { array(values, length) }.unwrap_or(&[])
}

/// An array of the caller that is filled with `from`.
///
/// # Safety
/// `into` is null or has room for as many numbers as `from` has.
pub(crate) unsafe fn fill(into: *mut f64, from: &[f64]) -> Result<(), Status> {
    if into.is_null() {
        return Err(Status::Null);
    }
    // SAFETY: not null, and the caller's promise; what a handle holds is not the caller's array.
    unsafe { std::ptr::copy_nonoverlapping(from.as_ptr(), into, from.len()) };
    Ok(())
}

/// A place of the caller that gets a value, unless it is null.
///
/// # Safety
/// `place` is null or may be written.
pub(crate) unsafe fn put<T>(place: *mut T, value: T) {
    if !place.is_null() {
        // SAFETY: not null, and the caller's promise; what was there is not dropped.
        unsafe { place.write(value) };
    }
}

/// Gives a handle out.
///
/// # Safety
/// `out` is null or may be written.
pub(crate) unsafe fn give<T>(
    out: *mut *mut T,
    make: impl FnOnce() -> Result<T, Refusal>,
) -> Result<(), Refusal> {
    if out.is_null() {
        return Err(Status::Null.into());
    }
    let handle = Box::into_raw(Box::new(make()?));
    // SAFETY: not null, and the caller's promise.
    unsafe { out.write(handle) };
    Ok(())
}

/// Takes a handle back; null is nothing.
///
/// # Safety
/// `handle` is null or was given out by [`give`] and not taken back before.
pub(crate) unsafe fn take<T>(handle: *mut T) {
    if !handle.is_null() {
        // SAFETY: made by `Box::into_raw`, and the caller's promise. A drop that panics would be caught.
        let boxed = unsafe { Box::from_raw(handle) };
        let _ = catch_unwind(AssertUnwindSafe(move || drop(boxed)));
    }
}

/// Writes a text into a buffer of the caller, cut at `room` bytes with its zero.
///
/// # Safety
/// `into` is null or has room for `room` bytes.
pub(crate) unsafe fn write(into: *mut c_char, room: usize, text: &str) {
    if into.is_null() || room == 0 {
        return;
    }
    let mut end = text.len().min(room - 1);
    // Never half a letter.
    while !text.is_char_boundary(end) {
        end -= 1;
    }
    // SAFETY: `end + 1` bytes at most `room`; the caller's promise.
    unsafe {
        std::ptr::copy_nonoverlapping(text.as_ptr().cast(), into, end);
        into.add(end).write(0);
    }
}

/// Why a constructor refused.
pub(crate) enum Refusal {
    /// By a status alone.
    Status(Status),
    /// With a sentence.
    Sentence(String),
}

impl From<Status> for Refusal {
    fn from(status: Status) -> Self {
        Self::Status(status)
    }
}

impl<E: std::error::Error> From<E> for Refusal {
    fn from(error: E) -> Self {
        Self::Sentence(error.to_string())
    }
}

/// Runs a call that may refuse with a sentence, which goes to `why`, cut at `why_len` bytes with its zero.
///
/// # Safety
/// `why` is null or has room for `why_len` bytes.
pub(crate) unsafe fn explained(
    why: *mut c_char,
    why_len: usize,
    call: impl FnOnce() -> Result<(), Refusal>,
) -> Status {
    let mut sentence = String::new();
    let status = guarded(|| {
        call().map_err(|refusal| match refusal {
            Refusal::Status(status) => status,
            Refusal::Sentence(words) => {
                sentence = words;
                Status::Invalid
            }
        })
    });
    // Never without a sentence.
    if sentence.is_empty() && status != Status::Ok {
        sentence = status.text().to_string_lossy().into_owned();
    }
    // SAFETY: the caller's promise.
    unsafe { write(why, why_len, &sentence) };
    status
}

#[cfg(test)]
mod tests {
    use super::{explained, guarded};
    use crate::status::Status;

    #[test]
    fn a_panic_is_a_status() {
        assert_eq!(guarded(|| panic!("as if")), Status::Panic);
        // SAFETY: no room is stated.
        let status = unsafe { explained(std::ptr::null_mut(), 0, || panic!("as if")) };
        assert_eq!(status, Status::Panic);
    }
}
