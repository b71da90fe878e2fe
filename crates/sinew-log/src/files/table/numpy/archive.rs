//! Entries of a zip archive, as `numpy.savez` and `numpy.savez_compressed` write it.

use crate::files::read_seek::ReadSeek;
use sinew_files::Budget;
use std::io::{Read, SeekFrom};

/// First bytes of an archive.
pub(in crate::files) const MAGIC: &[u8] = b"PK\x03\x04";
/// Bytes of the record at the end of an archive, without its comment.
const END_BYTES: usize = 22;
/// Bytes of the pointer to the 64-bit record at the end, and of the record that is read.
const END64_POINTER_BYTES: usize = 20;
const END64_BYTES: usize = 56;
/// Bytes of an entry of the directory, and of the header before its content, without names.
const ENTRY_BYTES: usize = 46;
const LOCAL_BYTES: u64 = 30;

/// Entry of an archive.
#[derive(Debug, PartialEq)]
pub(super) struct Entry {
    pub(super) name: String,
    pub(super) is_deflated: bool,
    /// Checksum of the content (CRC-32).
    pub(super) checksum: u32,
    /// Place of the content in the archive, and its size there.
    pub(super) start: u64,
    pub(super) packed_bytes: u64,
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u64> {
    let bytes = bytes.get(at..at + 2)?;
    Some(u16::from_le_bytes(bytes.try_into().ok()?).into())
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u64> {
    let bytes = bytes.get(at..at + 4)?;
    Some(u32::from_le_bytes(bytes.try_into().ok()?).into())
}

fn u64_at(bytes: &[u8], at: usize) -> Option<u64> {
    Some(u64::from_le_bytes(bytes.get(at..at + 8)?.try_into().ok()?))
}

fn read_at(reader: &mut dyn ReadSeek, at: u64, bytes: u64) -> std::io::Result<Vec<u8>> {
    reader.seek(SeekFrom::Start(at))?;
    let mut read = Vec::new();
    reader.take(bytes).read_to_end(&mut read)?;
    Ok(read)
}

/// Reads the directory of an archive; the error is a description.
pub(super) fn entries(reader: &mut dyn ReadSeek, budget: &Budget) -> Result<Vec<Entry>, String> {
    let damaged =
        || "its zip directory is damaged, missing or encrypted; the file may be cut off".to_owned();
    let io = |error: std::io::Error| format!("its zip directory cannot be read: {error}");
    let length = reader.seek(SeekFrom::End(0)).map_err(io)?;
    // The comment behind the record has 65535 bytes at most.
    let tail_bytes = length.min((END64_POINTER_BYTES + END_BYTES) as u64 + u64::from(u16::MAX));
    let tail = read_at(reader, length - tail_bytes, tail_bytes).map_err(io)?;
    let is_end = |window: &[u8]| window == b"PK\x05\x06";
    let at = tail.windows(4).rposition(is_end).ok_or_else(damaged)?;
    let end = &tail[at..];
    let of_end = || Some((u16_at(end, 10)?, u32_at(end, 12)?, u32_at(end, 16)?));
    let (mut count, mut bytes, mut start) = of_end().ok_or_else(damaged)?;
    let pointer = at.checked_sub(END64_POINTER_BYTES).map(|at| &tail[at..]);
    if let Some(pointer) = pointer.filter(|pointer| pointer.starts_with(b"PK\x06\x07")) {
        let at = u64_at(pointer, 8).ok_or_else(damaged)?;
        let end = read_at(reader, at, END64_BYTES as u64).map_err(io)?;
        let of_end = || Some((u64_at(&end, 32)?, u64_at(&end, 40)?, u64_at(&end, 48)?));
        (count, bytes, start) = of_end().ok_or_else(damaged)?;
    }
    budget.columns.check(count)?;
    if bytes > budget.text.value().saturating_mul(8) || start.saturating_add(bytes) > length {
        return Err(damaged());
    }
    let directory = read_at(reader, start, bytes).map_err(io)?;
    let mut rest = &directory[..];
    let mut found = Vec::new();
    for _ in 0..count {
        let (mut entry, size) = entry(rest).ok_or_else(damaged)?;
        rest = rest.get(size..).ok_or_else(damaged)?;
        let local = read_at(reader, entry.start, LOCAL_BYTES).map_err(io)?;
        let before = || {
            let is_local = local.starts_with(MAGIC);
            let names = u16_at(&local, 26)? + u16_at(&local, 28)?;
            is_local.then_some(LOCAL_BYTES + names)
        };
        entry.start = entry.start.saturating_add(before().ok_or_else(damaged)?);
        if entry.start.saturating_add(entry.packed_bytes) > length {
            return Err(damaged());
        }
        found.push(entry);
    }
    Ok(found)
}

/// Entry at the start of a directory, with its size there; its `start` is that of its header.
fn entry(directory: &[u8]) -> Option<(Entry, usize)> {
    const IS_ENCRYPTED: u64 = 1;
    const STORED: u64 = 0;
    const DEFLATED: u64 = 8;
    /// Value of a 32-bit field whose value is among the additional fields.
    const IN_ADDITION: u64 = u32::MAX as u64;
    let method = u16_at(directory, 10)?;
    let is_readable = u16_at(directory, 8)? & IS_ENCRYPTED == 0
        && [STORED, DEFLATED].contains(&method)
        && directory.starts_with(b"PK\x01\x02");
    let [name, additional, comment] = [28, 30, 32].map(|at| u16_at(directory, at));
    let (name, additional, comment) = (name? as usize, additional? as usize, comment? as usize);
    let mut sizes = [24, 20, 42].map(|at| u32_at(directory, at));
    let mut fields = directory.get(ENTRY_BYTES + name..ENTRY_BYTES + name + additional)?;
    while let (Some(kind), Some(size)) = (u16_at(fields, 0), u16_at(fields, 2)) {
        let field = fields.get(4..4 + size as usize)?;
        if kind == 1 {
            // The sizes that do not fit, in this order.
            let wide = sizes.iter_mut().filter(|size| **size == Some(IN_ADDITION));
            for (index, size) in wide.enumerate() {
                *size = u64_at(field, 8 * index);
            }
        }
        fields = &fields[4 + size as usize..];
    }
    let [_, packed_bytes, start] = sizes;
    let name = directory.get(ENTRY_BYTES..ENTRY_BYTES + name)?;
    let entry = Entry {
        name: String::from_utf8_lossy(name).into_owned(),
        is_deflated: method == DEFLATED,
        checksum: u32_at(directory, 16)? as u32,
        start: start?,
        packed_bytes: packed_bytes?,
    };
    let size = ENTRY_BYTES + name.len() + additional + comment;
    is_readable.then_some((entry, size))
}
