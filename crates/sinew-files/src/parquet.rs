//! Parquet files whose stated sizes are checked before the parser of the format allocates memory for them.
//!
//! The parser allocates by the sizes in the footer and in the headers of pages: a page of 60 bytes that states 2 GiB, a
//! dictionary of 2³¹ values or a group of 2³¹ columns would end the process. Both are Thrift's compact protocol, which is
//! walked here first.

use std::io::{Error as IoError, Read, Result as IoResult, copy, sink};

use bytes::Bytes;
use parquet::errors::{ParquetError, Result};
use parquet::file::reader::{ChunkReader, Length};

use crate::budget::Budget;

/// Length of the end of a file: the footer's length and the magic bytes.
const TAIL_BYTES: u64 = 8;
/// Assumed memory of an element of the footer, bytes: a column of a row group has 250.
const ELEMENT_BYTES: u64 = 256;
/// Maximum memory of a value of a dictionary, bytes.
const VALUE_BYTES: u64 = 32;

/// Types of fields in Thrift's compact protocol.
const BINARY: u8 = 8;
const LIST: u8 = 9;
const STRUCTURE: u8 = 12;

/// Parquet file within a budget.
#[derive(Debug, Clone)]
pub struct BoundedParquet<R> {
    inner: R,
    budget: Budget,
}

impl<R: ChunkReader> BoundedParquet<R> {
    /// A file within a budget.
    pub fn new(inner: R, budget: &Budget) -> Self {
        Self {
            inner,
            budget: *budget,
        }
    }
}

impl<R: ChunkReader> Length for BoundedParquet<R> {
    fn len(&self) -> u64 {
        self.inner.len()
    }
}

/// Reader from the start of a page, whose header is checked before its first byte is returned.
///
/// Of a list, the parser reads the header of the next page ahead. It then also opens a reader at the content of that page,
/// which remains unread.
#[derive(Debug)]
pub struct CheckedPage<T> {
    inner: T,
    /// Second reader of the header, until the header is checked.
    header: Option<T>,
    budget: Budget,
}

impl<T: Read> Read for CheckedPage<T> {
    fn read(&mut self, into: &mut [u8]) -> IoResult<usize> {
        if let Some(mut header) = self.header.take() {
            check_page(&mut header, &self.budget).map_err(IoError::other)?;
        }
        self.inner.read(into)
    }
}

impl<R: ChunkReader> ChunkReader for BoundedParquet<R> {
    type T = CheckedPage<R::T>;

    fn get_read(&self, start: u64) -> Result<Self::T> {
        let is_tail = start.saturating_add(TAIL_BYTES) == self.len();
        let header = match is_tail {
            true => None,
            false => Some(self.inner.get_read(start)?),
        };
        Ok(CheckedPage {
            inner: self.inner.get_read(start)?,
            header,
            budget: self.budget,
        })
    }

    fn get_bytes(&self, start: u64, length: usize) -> Result<Bytes> {
        let remaining = self.len().saturating_sub(start);
        if length as u64 > remaining {
            let problem = format!("{length} bytes at byte {start}, but only {remaining} follow");
            return Err(ParquetError::EOF(problem));
        }
        let memory = self.budget.memory;
        memory.check(length as u64).map_err(ParquetError::General)?;
        let bytes = self.inner.get_bytes(start, length)?;
        if remaining == (length as u64).saturating_add(TAIL_BYTES) {
            check_footer(&mut &bytes[..], &self.budget).map_err(ParquetError::General)?;
        }
        Ok(bytes)
    }
}

/// Checks the sizes in the header of a page.
fn check_page(header: &mut dyn Read, budget: &Budget) -> Checked {
    /// Encodings of texts by differences, whose counts are inside the page.
    const UNCHECKED: [i64; 2] = [6, 7];
    let (size, values) = (budget.memory, budget.memory.value() / VALUE_BYTES);
    let mut visit = |path: &[i64], event: Event| match (path, event) {
        (path, Event::Field(kind)) if !is_page_field(path, kind) => Err(damaged()),
        // Size after decompression.
        ([2], Event::Number(bytes)) => size.check(unsigned(bytes)?),
        // Values of a dictionary.
        ([7, 1], Event::Number(count)) if unsigned(count)? > values => Err(format!(
            "a dictionary of {count} values; at most {values} are supported"
        )),
        ([5, 2] | [8, 4], Event::Number(encoding)) if UNCHECKED.contains(&encoding) => {
            Err("its texts are encoded by their differences, which is not supported".to_owned())
        }
        _ => Ok(()),
    };
    Walk::new(header, budget, &mut visit).structure()
}

/// Checks the sizes and the nesting of the schema in the footer.
fn check_footer(footer: &mut dyn Read, budget: &Budget) -> Checked {
    let depth = budget.depth;
    let most = budget.memory.value() / ELEMENT_BYTES;
    // Children of the present element of the schema, and those that the groups above it still lack.
    let (mut children, mut open) = (0, Vec::new());
    let mut visit = |path: &[i64], event: Event| match (path, event) {
        (path, Event::Field(kind)) if !is_footer_field(path, kind) => Err(damaged()),
        ([2, 5], Event::Number(count)) => {
            children = unsigned(count)?;
            match children > most {
                true => Err(format!("a group of {children} columns")),
                false => Ok(()),
            }
        }
        ([2], Event::End) => {
            if let Some(left) = open.last_mut() {
                *left -= 1;
            }
            match std::mem::take(&mut children) {
                0 => while open.pop_if(|left| *left == 0).is_some() {},
                group => open.push(group),
            }
            depth.check(open.len() as u64)
        }
        _ => Ok(()),
    };
    Walk::new(footer, budget, &mut visit).structure()
}

/// Whether a field in the header of a page has its type. The parser does not compare the types, so that other bytes would be
/// its sizes than those that are checked here.
fn is_page_field(path: &[i64], kind: u8) -> bool {
    match path {
        [1..=4] | [5, 1..=4] | [7, 1..=2] | [8, 1..=6] => is_integer(kind),
        [5..=8] | [5, 5] | [8, 8] => kind == STRUCTURE,
        [7, 3] | [8, 7] => matches!(kind, 1 | 2),
        _ => true,
    }
}

/// Whether a field of the footer or of its schema has its type; see [`is_page_field`].
fn is_footer_field(path: &[i64], kind: u8) -> bool {
    match path {
        [1 | 3] | [2, 1..=3 | 5..=9] => is_integer(kind),
        [2 | 4 | 5 | 7] => kind == LIST,
        [6] | [2, 4] => kind == BINARY,
        [2, 10] => kind == STRUCTURE,
        _ => true,
    }
}

fn is_integer(kind: u8) -> bool {
    matches!(kind, 4..=6)
}

fn unsigned(number: i64) -> std::result::Result<u64, String> {
    u64::try_from(number).map_err(|_| format!("a size of {number}"))
}

/// The error is a message.
type Checked = std::result::Result<(), String>;

enum Event {
    /// The type of a field, before its value.
    Field(u8),
    /// An integer of any width.
    Number(i64),
    /// The end of a structure.
    End,
}

/// Walk over a structure in Thrift's compact protocol.
struct Walk<'w> {
    from: &'w mut dyn Read,
    /// Numbers of the fields that contain the present one.
    path: Vec<i64>,
    /// Nested structures and lists that are still permitted, and elements of lists.
    depth: u64,
    elements: u64,
    visit: &'w mut dyn FnMut(&[i64], Event) -> Checked,
}

fn damaged() -> String {
    "its metadata are damaged".to_owned()
}

impl<'w> Walk<'w> {
    fn new(
        from: &'w mut dyn Read,
        budget: &Budget,
        visit: &'w mut dyn FnMut(&[i64], Event) -> Checked,
    ) -> Self {
        Self {
            from,
            path: Vec::new(),
            depth: budget.depth.value(),
            elements: budget.memory.value() / ELEMENT_BYTES,
            visit,
        }
    }

    fn byte(&mut self) -> std::result::Result<u8, String> {
        let mut byte = 0;
        let read: IoResult<()> = self.from.read_exact(std::slice::from_mut(&mut byte));
        read.map_err(|_| damaged())?;
        Ok(byte)
    }

    fn unsigned(&mut self) -> std::result::Result<u64, String> {
        let mut number = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            number |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Ok(number);
            }
        }
        Err(damaged())
    }

    /// Number whose sign is its last bit.
    fn signed(&mut self) -> std::result::Result<i64, String> {
        let number = self.unsigned()?;
        Ok((number >> 1) as i64 ^ -((number & 1) as i64))
    }

    fn skip(&mut self, bytes: u64) -> Checked {
        let skipped = copy(&mut (&mut *self.from).take(bytes), &mut sink());
        match skipped.is_ok_and(|skipped| skipped == bytes) {
            true => Ok(()),
            false => Err(damaged()),
        }
    }

    fn structure(&mut self) -> Checked {
        let mut field = 0;
        loop {
            let head = self.byte()?;
            if head == 0 {
                return (self.visit)(&self.path, Event::End);
            }
            field = match head >> 4 {
                0 => self.signed()?,
                step => i64::wrapping_add(field, i64::from(step)),
            };
            // Numbers of fields have 16 bits; a parser cuts off the others.
            if i16::try_from(field).is_err() {
                return Err(damaged());
            }
            self.path.push(field);
            let kind = head & 0x0f;
            (self.visit)(&self.path, Event::Field(kind))?;
            self.value(kind, false)?;
            self.path.pop();
        }
    }

    fn value(&mut self, kind: u8, is_element: bool) -> Checked {
        match kind {
            // A field's type is the value of a truth; an element has a byte.
            1 | 2 => self.skip(u64::from(is_element)),
            3 => self.skip(1),
            4..=6 => {
                let number = self.signed()?;
                (self.visit)(&self.path, Event::Number(number))
            }
            7 => self.skip(8),
            BINARY => {
                let bytes = self.unsigned()?;
                self.skip(bytes)
            }
            LIST..=STRUCTURE => self.nested(kind),
            13 => self.skip(16),
            _ => Err(damaged()),
        }
    }

    /// List, set, map or structure.
    fn nested(&mut self, kind: u8) -> Checked {
        let left = self.depth.checked_sub(1);
        let left = left.ok_or("its metadata are nested too deeply")?;
        let depth = std::mem::replace(&mut self.depth, left);
        if kind == STRUCTURE {
            self.structure()?;
        } else {
            let (count, kinds) = match kind {
                11 => {
                    let count = self.unsigned()?;
                    let kinds = if count == 0 { 0 } else { self.byte()? };
                    (count.saturating_mul(2), [kinds >> 4, kinds & 0x0f])
                }
                _ => {
                    let head = self.byte()?;
                    let count = match head >> 4 {
                        15 => self.unsigned()?,
                        short => u64::from(short),
                    };
                    (count, [head & 0x0f; 2])
                }
            };
            let left = self.elements.checked_sub(count);
            self.elements = left.ok_or("its metadata have too many elements")?;
            for (_, kind) in (0..count).zip(kinds.into_iter().cycle()) {
                self.value(kind, true)?;
            }
        }
        self.depth = depth;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn page(bytes: &[u8]) -> Checked {
        check_page(&mut &bytes[..], &Budget::RECORDING)
    }

    /// The footer of a schema whose elements have these numbers of children.
    fn schema(children: &[u8]) -> Checked {
        let count = u8::try_from(children.len()).unwrap_or(u8::MAX);
        let mut footer = vec![0x29, 0xfc];
        footer.extend([count & 0x7f | 0x80, count >> 7]);
        for children in children {
            footer.extend([0x55, children << 1, 0]);
        }
        footer.push(0);
        check_footer(&mut &footer[..], &Budget::RECORDING)
    }

    #[test]
    fn page_that_states_too_much_is_rejected_before_it_is_read() {
        // Type 0, size 10, packed size 8; data of 3 values, plain.
        let plain = [0x15, 0, 0x15, 20, 0x15, 16, 0x2c, 0x15, 6, 0x15, 0, 0, 0];
        assert_eq!(page(&plain), Ok(()));
        let mut large = plain.to_vec();
        large.splice(3..4, [0xfe, 0xff, 0xff, 0xff, 0x0f]);
        assert!(page(&large).is_err_and(|e| e.contains("at most 268435456 bytes")));
        // The last of two statements counts.
        let mut twice = plain.to_vec();
        twice.splice(6..6, [0x05, 4, 0xfe, 0xff, 0xff, 0xff, 0x0f]);
        assert!(page(&twice).is_err_and(|e| e.contains("at most 268435456 bytes")));
        // The parser would read a byte as an integer, and field 65538 as the second.
        let mut of_type = plain.to_vec();
        of_type[2] = 0x13;
        assert_eq!(page(&of_type), Err(damaged()));
        let mut of_number = plain.to_vec();
        of_number.splice(6..6, [0x05, 0x84, 0x80, 0x08, 20]);
        assert_eq!(page(&of_number), Err(damaged()));
        let mut dictionary = [0x15, 4, 0x15, 20, 0x15, 16, 0x4c, 0x15].to_vec();
        dictionary.extend([0xfe, 0xff, 0xff, 0xff, 0x0f, 0, 0]);
        assert!(page(&dictionary).is_err_and(|e| e.contains("dictionary of 2147483647")));
        for length in 0..plain.len() {
            assert!(page(&plain[..length]).is_err(), "{length}");
        }
    }

    #[test]
    fn schema_is_bounded_in_depth_and_width() {
        assert_eq!(schema(&[2, 0, 1, 0]), Ok(()));
        assert_eq!(schema(&[1; 120]), Ok(()));
        assert!(schema(&[1; 200]).is_err_and(|e| e.contains("at most 128 levels")));
        // Lists side by side are not nested.
        let lists: Vec<u8> = std::iter::once(63).chain([1, 0].repeat(63)).collect();
        assert_eq!(schema(&lists), Ok(()));
        let group = [0x29, 0x1c, 0x55, 0xfe, 0xff, 0xff, 0xff, 0x0f, 0, 0];
        let wide = check_footer(&mut &group[..], &Budget::RECORDING);
        assert!(wide.is_err_and(|e| e.contains("2147483647 columns")));
        let mut nested = [0x19].repeat(1000);
        // The second field.
        nested[0] = 0x29;
        let nested = check_footer(&mut &nested[..], &Budget::RECORDING);
        assert!(nested.is_err_and(|e| e.contains("too deeply")));
    }
}
