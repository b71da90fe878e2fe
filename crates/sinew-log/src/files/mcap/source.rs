//! Buffered reader of a file with its position; the buffer grows only with the bytes read.

use std::io::{Read, Seek, SeekFrom};

use crate::files::read_seek::ReadSeek;

/// Size of one read of the operating system, bytes.
const READ_BYTES: usize = 256 << 10;

/// A window over the file: `unread` bytes start at file offset `position`.
pub(super) struct Source {
    reader: Box<dyn ReadSeek>,
    buffer: Vec<u8>,
    start: usize,
    end: usize,
    position: u64,
    length: u64,
}

impl Source {
    pub(super) fn new(mut reader: Box<dyn ReadSeek>) -> std::io::Result<Self> {
        let length = reader.seek(SeekFrom::End(0))?;
        reader.seek(SeekFrom::Start(0))?;
        Ok(Source {
            reader,
            buffer: Vec::new(),
            start: 0,
            end: 0,
            position: 0,
            length,
        })
    }

    /// Length of the file.
    pub(super) fn length(&self) -> u64 {
        self.length
    }

    /// File offset of the first byte not consumed.
    pub(super) fn position(&self) -> u64 {
        self.position
    }

    /// Continues at another offset of the file.
    pub(super) fn seek(&mut self, position: u64) -> std::io::Result<()> {
        self.reader.seek(SeekFrom::Start(position))?;
        self.position = position;
        self.start = 0;
        self.end = 0;
        Ok(())
    }

    pub(super) fn unread(&self) -> &[u8] {
        &self.buffer[self.start..self.end]
    }

    pub(super) fn consume(&mut self, bytes: usize) {
        let bytes = bytes.min(self.end - self.start);
        self.start += bytes;
        self.position += bytes as u64;
    }

    /// Has `bytes` bytes ready in [`Self::unread`], or as many as the file still has.
    ///
    /// The caller has checked `bytes` against its limit; memory grows with the bytes read.
    pub(super) fn fill(&mut self, bytes: usize) -> std::io::Result<usize> {
        while self.end - self.start < bytes {
            if self.start > 0 && (self.start == self.end || self.buffer.len() - self.start < bytes)
            {
                self.buffer.copy_within(self.start..self.end, 0);
                self.end -= self.start;
                self.start = 0;
            }
            if self.buffer.len() - self.end < READ_BYTES {
                // Doubling keeps copies linear; at most the requested bytes plus one read.
                let wanted = (self.buffer.len() * 2)
                    .clamp(READ_BYTES, bytes + READ_BYTES)
                    .max(self.end + READ_BYTES);
                self.buffer.resize(wanted, 0);
            }
            match self.reader.read(&mut self.buffer[self.end..]) {
                Ok(0) => break,
                Ok(read) => self.end += read,
                Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Ok((self.end - self.start).min(bytes))
    }

    /// Moves past `bytes` bytes without keeping them; how many there were.
    pub(super) fn skip(&mut self, bytes: u64) -> std::io::Result<u64> {
        let ready = (self.end - self.start) as u64;
        if bytes <= ready {
            self.consume(bytes as usize);
            return Ok(bytes);
        }
        let there = bytes.min(self.length.saturating_sub(self.position));
        self.seek(self.position + there)?;
        Ok(there)
    }
}
