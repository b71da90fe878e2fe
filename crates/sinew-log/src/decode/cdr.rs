//! Bounds-checked cursor over CDR (OMG CDR, plain XCDR1), to find the offsets of values.
//!
//! `cdr-encoding` serialises the messages that Sinew writes, and is the reference in the tests. It
//! is not used to read messages: through serde it returns values without their offsets, and a `JointState` requires
//! one `Vec` of names and three of values per message. Measured on seven joints (`benches/read.rs`, a shared x86
//! machine):
//! 0.9 µs per joint state through serde, compared with 0.10 to 0.15 µs per message for all work of the reader after
//! decompression, including the assembly of frames and the signal checks.

/// Bytes of the encapsulation header: representation and options.
pub(crate) const ENCAPSULATION: usize = 4;

/// Error of decoding a payload.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum DecodeError {
    /// Neither plain big-endian nor plain little-endian CDR.
    #[error("unsupported CDR representation {0:#04x}; plain CDR (0 or 1) is supported")]
    Representation(u8),
    /// Payload that ends before the value.
    #[error("payload truncated at byte {at}: {wanted} more bytes expected")]
    Short {
        /// Length of the payload, bytes.
        at: usize,
        /// Bytes announced beyond the end.
        wanted: u64,
    },
}

/// A place in a payload. Alignment counts from the end of the encapsulation header.
#[derive(Clone)]
pub(crate) struct Cdr<'a> {
    data: &'a [u8],
    at: usize,
    big_endian: bool,
}

impl<'a> Cdr<'a> {
    pub(crate) fn new(data: &'a [u8]) -> Result<Self, DecodeError> {
        let Some(head) = data.first_chunk::<ENCAPSULATION>() else {
            return Err(DecodeError::Short {
                at: data.len(),
                wanted: ENCAPSULATION as u64,
            });
        };
        let big_endian = match (head[0], head[1]) {
            (0, 0) => true,
            (0, 1) => false,
            (0, kind) => return Err(DecodeError::Representation(kind)),
            (kind, _) => return Err(DecodeError::Representation(kind)),
        };
        Ok(Cdr {
            data,
            at: ENCAPSULATION,
            big_endian,
        })
    }

    pub(crate) fn is_big_endian(&self) -> bool {
        self.big_endian
    }

    pub(crate) fn at(&self) -> usize {
        self.at
    }

    fn take(&mut self, bytes: u64) -> Result<&'a [u8], DecodeError> {
        let rest = &self.data[self.at..];
        let wanted = usize::try_from(bytes).ok().filter(|n| *n <= rest.len());
        match wanted {
            Some(wanted) => {
                self.at += wanted;
                Ok(&rest[..wanted])
            }
            None => Err(DecodeError::Short {
                at: self.data.len(),
                wanted: bytes - rest.len() as u64,
            }),
        }
    }

    fn align(&mut self, to: usize) -> Result<(), DecodeError> {
        let past = (self.at - ENCAPSULATION) % to;
        if past != 0 {
            self.take((to - past) as u64)?;
        }
        Ok(())
    }

    pub(crate) fn u32(&mut self) -> Result<u32, DecodeError> {
        self.align(4)?;
        let bytes = self.take(4)?;
        Ok(read_u32(bytes, self.big_endian))
    }

    /// A string without its closing zero, as bytes.
    pub(crate) fn string(&mut self) -> Result<&'a [u8], DecodeError> {
        let length = self.u32()?;
        let bytes = self.take(u64::from(length))?;
        Ok(bytes.strip_suffix(&[0]).unwrap_or(bytes))
    }

    /// Offset and count of a sequence of doubles; the cursor is after them.
    pub(crate) fn doubles(&mut self) -> Result<(usize, usize), DecodeError> {
        let count = self.u32()?;
        if count > 0 {
            self.align(8)?;
        }
        let at = self.at;
        self.take(u64::from(count) * 8)?;
        Ok((at, count as usize))
    }
}

#[inline]
fn read_u32(bytes: &[u8], big_endian: bool) -> u32 {
    match bytes.first_chunk::<4>() {
        Some(bytes) if big_endian => u32::from_be_bytes(*bytes),
        Some(bytes) => u32::from_le_bytes(*bytes),
        None => 0,
    }
}

/// Reads the stamp of a `std_msgs/Header` at the start of a payload, ns.
///
/// `None`: not plain CDR, or too short. Seconds are signed in ROS 2.
#[inline]
pub fn stamp_ns(data: &[u8]) -> Option<i64> {
    let head = data.first_chunk::<12>()?;
    let seconds = [head[4], head[5], head[6], head[7]];
    let nanos = [head[8], head[9], head[10], head[11]];
    let (seconds, nanos) = match (head[0], head[1]) {
        (0, 1) => (i32::from_le_bytes(seconds), u32::from_le_bytes(nanos)),
        (0, 0) => (i32::from_be_bytes(seconds), u32::from_be_bytes(nanos)),
        _ => return None,
    };
    Some(i64::from(seconds) * 1_000_000_000 + i64::from(nanos))
}

/// Writes the stamp of a `std_msgs/Header` at the start of a payload, ns; `false`: not plain CDR, too short,
/// or a time outside the range of a stamp. Nothing is changed then.
pub fn set_stamp_ns(data: &mut [u8], time_ns: i64) -> bool {
    let Ok(seconds) = i32::try_from(time_ns.div_euclid(1_000_000_000)) else {
        return false;
    };
    let nanos = time_ns.rem_euclid(1_000_000_000) as u32;
    let Some(head) = data.first_chunk_mut::<12>() else {
        return false;
    };
    let (seconds, nanos) = match (head[0], head[1]) {
        (0, 1) => (seconds.to_le_bytes(), nanos.to_le_bytes()),
        (0, 0) => (seconds.to_be_bytes(), nanos.to_be_bytes()),
        _ => return false,
    };
    head[4..8].copy_from_slice(&seconds);
    head[8..].copy_from_slice(&nanos);
    true
}
