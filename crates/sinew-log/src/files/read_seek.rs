//! Where the bytes of a recording come from.

use std::io::{Read, Seek};

/// Something to read a recording from: a file, or bytes in memory.
pub trait ReadSeek: Read + Seek + Send {}
impl<T: Read + Seek + Send> ReadSeek for T {}
