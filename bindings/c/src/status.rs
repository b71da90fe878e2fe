//! What a call returns, and the version of the interface.

use std::ffi::{CStr, c_char, c_int};

/// Version of this interface: raised when a program compiled against an older header may no longer be right.
pub const SINEW_ABI_VERSION: u32 = 2;

/// What a call returns.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// It was done.
    Ok = 0,
    /// A pointer that must not be null is.
    Null = 1,
    /// An array has another length than the robot has joints, or there is no such joint.
    Length = 2,
    /// An input is NaN or infinite. Nothing has changed.
    NotFinite = 3,
    /// The time step is none. Nothing has changed.
    TimeStep = 4,
    /// A sample cannot be used; what it lacks stands beside. Nothing has changed.
    Refused = 5,
    /// A text or a value was refused; the sentence says why.
    Invalid = 6,
    /// A text is not UTF-8.
    Encoding = 7,
    /// The buffer is too short; the length needed stands beside.
    Short = 8,
    /// An offset is provisional: the offsets cannot be saved now.
    Provisional = 9,
    /// Sinew has a fault of its own. The handle must only be freed.
    Panic = 10,
    /// The worker was started or taken before. Nothing has changed.
    WorkerTaken = 11,
    /// The system has no thread to give.
    Thread = 12,
}

/// Version of the interface that the library was built with: compare with `SINEW_ABI_VERSION`.
///
/// Realtime: yes.
#[unsafe(no_mangle)]
pub extern "C" fn sinew_abi_version() -> u32 {
    SINEW_ABI_VERSION
}

/// Version of Sinew, such as `0.1.0`; never null, never freed.
///
/// Realtime: yes.
#[unsafe(no_mangle)]
pub extern "C" fn sinew_version() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}

/// A status in words; never null, never freed. Of a number that is none: that.
///
/// Realtime: yes.
#[unsafe(no_mangle)]
pub extern "C" fn sinew_status_text(status: c_int) -> *const c_char {
    let known = Status::ALL.iter().find(|s| **s as c_int == status);
    known
        .map_or(c"no status of this version", |s| s.text())
        .as_ptr()
}

impl Status {
    const ALL: [Self; 13] = [
        Self::Ok,
        Self::Null,
        Self::Length,
        Self::NotFinite,
        Self::TimeStep,
        Self::Refused,
        Self::Invalid,
        Self::Encoding,
        Self::Short,
        Self::Provisional,
        Self::Panic,
        Self::WorkerTaken,
        Self::Thread,
    ];

    /// In words.
    pub fn text(self) -> &'static CStr {
        match self {
            Self::Ok => c"done",
            Self::Null => c"a pointer that must not be null is null",
            Self::Length => {
                c"an array is not as long as the robot has joints, or there is no such joint"
            }
            Self::NotFinite => c"an input is NaN or infinite",
            Self::TimeStep => c"the time step must be 1e-9 s to 1e9 s",
            Self::Refused => c"the sample cannot be used",
            Self::Invalid => c"a text or a value was refused",
            Self::Encoding => c"a text is not UTF-8",
            Self::Short => c"the buffer is too short",
            Self::Provisional => c"an offset is provisional: the offsets cannot be saved now",
            Self::WorkerTaken => c"the worker was started or taken before",
            Self::Thread => c"the system has no thread to give",
            Self::Panic => c"Sinew has a fault of its own; the handle can only be freed",
        }
    }
}

impl From<sinew_model::StepError> for Status {
    fn from(error: sinew_model::StepError) -> Self {
        match error {
            sinew_model::StepError::Length => Self::Length,
            sinew_model::StepError::TimeStep => Self::TimeStep,
            _ => Self::NotFinite,
        }
    }
}
