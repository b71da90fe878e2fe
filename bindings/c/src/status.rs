//! Status codes, and the version of the interface.

use std::ffi::{CStr, c_char, c_int};

/// Version of this interface, incremented by changes that are incompatible with programs compiled against an older header.
pub const SINEW_ABI_VERSION: u32 = 2;

/// Status of a call.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// Call completed without error.
    Ok = 0,
    /// A required pointer is null.
    Null = 1,
    /// The length of an array differs from the number of joints, or a joint index is out of range.
    Length = 2,
    /// An input is NaN or infinite. Nothing has changed.
    NotFinite = 3,
    /// Invalid time step. Nothing has changed.
    TimeStep = 4,
    /// Unusable sample; the step result names the reason. Nothing has changed.
    Rejected = 5,
    /// Invalid text or value; the message states the reason.
    Invalid = 6,
    /// A text is not UTF-8.
    Encoding = 7,
    /// Buffer too short; the required length is returned.
    Short = 8,
    /// An offset is provisional: the offsets cannot be saved now.
    Provisional = 9,
    /// Internal error of Sinew. The handle may only be freed.
    Panic = 10,
    /// The worker was started or taken before. Nothing has changed.
    WorkerTaken = 11,
    /// The system could not create a thread.
    Thread = 12,
}

/// Version of the interface that the library was built with: compare with `SINEW_ABI_VERSION`.
///
/// Realtime: yes.
///
/// Threads: any number at once.
#[unsafe(no_mangle)]
pub extern "C" fn sinew_abi_version() -> u32 {
    SINEW_ABI_VERSION
}

/// Version of Sinew, such as `0.1.0`; never null, never freed.
///
/// Realtime: yes.
///
/// Threads: any number at once.
#[unsafe(no_mangle)]
pub extern "C" fn sinew_version() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}

/// Text of a status; never null, never freed. An invalid number also has a text.
///
/// Realtime: yes.
///
/// Threads: any number at once.
#[unsafe(no_mangle)]
pub extern "C" fn sinew_status_text(status: c_int) -> *const c_char {
    let status = Status::ALL.iter().find(|s| **s as c_int == status);
    status
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
        Self::Rejected,
        Self::Invalid,
        Self::Encoding,
        Self::Short,
        Self::Provisional,
        Self::Panic,
        Self::WorkerTaken,
        Self::Thread,
    ];

    /// Text of the status in English.
    pub fn text(self) -> &'static CStr {
        match self {
            Self::Ok => c"done",
            Self::Null => c"a required pointer is null",
            Self::Length => {
                c"an array length differs from the number of joints, or a joint is not found"
            }
            Self::NotFinite => c"an input is NaN or infinite",
            Self::TimeStep => c"the time step must be 1e-9 s to 1e9 s",
            Self::Rejected => c"the sample cannot be used",
            Self::Invalid => c"invalid text or value",
            Self::Encoding => c"a text is not UTF-8",
            Self::Short => c"the buffer is too short",
            Self::Provisional => c"an offset is provisional: the offsets cannot be saved now",
            Self::WorkerTaken => c"the worker was started or taken before",
            Self::Thread => c"the system could not create a thread",
            Self::Panic => c"internal error of Sinew; the handle may only be freed",
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
