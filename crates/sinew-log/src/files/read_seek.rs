//! Source of the bytes of a recording.

use std::io::{Read, Seek};

/// Byte source of a recording: a file, or bytes in memory.
pub trait ReadSeek: Read + Seek + Send {}
impl<T: Read + Seek + Send> ReadSeek for T {}
