//! UTF-16 as a stream of UTF-8, for files too large for memory.

use std::io::{Read, Result};

/// Buffer size, bytes.
const BUFFER_BYTES: usize = 64 << 10;

/// Reader that converts UTF-16 to UTF-8; an unpaired surrogate becomes U+FFFD.
#[derive(Debug)]
pub struct Utf16Reader<R> {
    inner: R,
    big_endian: bool,
    raw: Vec<u8>,
    /// First half of a surrogate pair.
    high: Option<u16>,
    text: Vec<u8>,
    at: usize,
}

impl<R: Read> Utf16Reader<R> {
    /// Creates a reader positioned after the byte order mark.
    pub fn new(inner: R, big_endian: bool) -> Self {
        Self {
            inner,
            big_endian,
            raw: Vec::new(),
            high: None,
            text: Vec::new(),
            at: 0,
        }
    }

    /// Decodes the next piece; an empty one is the end.
    fn fill(&mut self) -> Result<()> {
        self.text.clear();
        self.at = 0;
        while self.text.is_empty() {
            let kept = self.raw.len();
            self.raw.resize(BUFFER_BYTES, 0);
            let read = self.inner.read(&mut self.raw[kept..])?;
            self.raw.truncate(kept + read);
            if read == 0 {
                if self.high.take().is_some() || kept > 0 {
                    self.push(char::REPLACEMENT_CHARACTER);
                }
                self.raw.clear();
                return Ok(());
            }
            let raw = std::mem::take(&mut self.raw);
            for pair in raw.chunks_exact(2) {
                let pair = [pair[0], pair[1]];
                self.unit(match self.big_endian {
                    true => u16::from_be_bytes(pair),
                    false => u16::from_le_bytes(pair),
                });
            }
            self.raw = raw[raw.len() & !1..].to_vec();
        }
        Ok(())
    }

    fn unit(&mut self, unit: u16) {
        let units = [self.high.take(), Some(unit)];
        if (0xd800..0xdc00).contains(&unit) && units[0].is_none() {
            self.high = Some(unit);
            return;
        }
        for c in char::decode_utf16(units.into_iter().flatten()) {
            self.push(c.unwrap_or(char::REPLACEMENT_CHARACTER));
        }
    }

    fn push(&mut self, c: char) {
        let mut bytes = [0; 4];
        self.text.extend(c.encode_utf8(&mut bytes).as_bytes());
    }
}

impl<R: Read> Read for Utf16Reader<R> {
    fn read(&mut self, into: &mut [u8]) -> Result<usize> {
        if self.at == self.text.len() {
            self.fill()?;
        }
        let n = into.len().min(self.text.len() - self.at);
        into[..n].copy_from_slice(&self.text[self.at..self.at + n]);
        self.at += n;
        Ok(n)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Hands out a few bytes at a time, an odd number of them.
    struct Drops<'b>(&'b [u8]);

    impl Read for Drops<'_> {
        fn read(&mut self, into: &mut [u8]) -> Result<usize> {
            let n = self.0.len().min(into.len()).min(3);
            into[..n].copy_from_slice(&self.0[..n]);
            self.0 = &self.0[n..];
            Ok(n)
        }
    }

    #[test]
    fn any_cut_gives_the_same_text() {
        let words = "time_s;Prüfzeit 𝄞\n0,5;1\n";
        for big_endian in [false, true] {
            let bytes = words.encode_utf16().flat_map(|unit| match big_endian {
                true => unit.to_be_bytes(),
                false => unit.to_le_bytes(),
            });
            let bytes: Vec<u8> = bytes.collect();
            let mut text = String::new();
            let mut reader = Utf16Reader::new(Drops(&bytes), big_endian);
            reader.read_to_string(&mut text).unwrap();
            assert_eq!(text, words);
        }
        let mut text = String::new();
        let mut reader = Utf16Reader::new(&b"a\0\x00\xd8b"[..], false);
        reader.read_to_string(&mut text).unwrap();
        assert_eq!(text, "a\u{fffd}");
    }
}
