//! Cells separated by blanks, in the form that the CSV parser reads.

use std::io::Read;

/// Separator of the cells that [`Blanks`] returns.
pub(super) const SEPARATOR: u8 = b'\t';
/// Size of one read, bytes.
const BUFFER_BYTES: usize = 64 << 10;

/// Text in which a run of spaces and tabs between two cells is filled with spaces up to one [`SEPARATOR`]; blanks at
/// either end of a line become spaces. The number of bytes stays, so that places are those of the file.
pub(super) struct Blanks<R> {
    reader: R,
    bytes: Vec<u8>,
    /// Number of bytes of `bytes` that are returned already.
    returned: usize,
    /// Whether the last byte read is a blank, which waits for the byte after it.
    is_waiting: bool,
    /// Whether the line has a cell so far.
    has_cell: bool,
    is_quoted: bool,
}

impl<R: Read> Blanks<R> {
    pub(super) fn new(reader: R) -> Self {
        Self {
            reader,
            bytes: Vec::new(),
            returned: 0,
            is_waiting: false,
            has_cell: false,
            is_quoted: false,
        }
    }

    /// Reads and converts the next bytes; leaves none at the end of the text.
    fn fill(&mut self) -> std::io::Result<()> {
        let mut read = Vec::new();
        let count = (&mut self.reader)
            .take(BUFFER_BYTES as u64)
            .read_to_end(&mut read)?;
        self.bytes.clear();
        self.returned = 0;
        for byte in read {
            self.convert(byte);
        }
        if count == 0 && std::mem::take(&mut self.is_waiting) {
            self.bytes.push(b' ');
        }
        Ok(())
    }

    fn convert(&mut self, byte: u8) {
        let is_end = matches!(byte, b'\n' | b'\r');
        let is_blank = matches!(byte, b' ' | b'\t') && !self.is_quoted;
        if std::mem::replace(&mut self.is_waiting, is_blank) {
            let is_between = !is_blank && !is_end && self.has_cell;
            self.bytes.push(if is_between { SEPARATOR } else { b' ' });
        }
        self.is_quoted = !is_end && (self.is_quoted != (byte == b'"'));
        self.has_cell = !is_end && (self.has_cell || !is_blank);
        if !is_blank {
            self.bytes.push(byte);
        }
    }
}

impl<R: Read> Read for Blanks<R> {
    fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
        // A piece of one blank converts to nothing yet.
        while self.returned == self.bytes.len() {
            self.fill()?;
            if self.bytes.is_empty() && !self.is_waiting {
                return Ok(0);
            }
        }
        let count = into.len().min(self.bytes.len() - self.returned);
        into[..count].copy_from_slice(&self.bytes[self.returned..self.returned + count]);
        self.returned += count;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blanks_between_cells_become_one_separator() {
        for (text, converted) in [
            ("1 2\t3\n", "1\t2\t3\n"),
            ("  1 \t 2  \r\n\t3", "  1  \t2  \r\n 3"),
            ("a \"b c\" d", "a\t\"b c\"\td"),
            ("1 ", "1 "),
            (" ", " "),
            ("", ""),
        ] {
            let mut read = String::new();
            Blanks::new(text.as_bytes())
                .read_to_string(&mut read)
                .expect("read");
            assert_eq!(read, converted);
        }
    }
}
