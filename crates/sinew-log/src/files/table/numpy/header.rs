//! Header of an array: type of its values, shape and order.

use sinew_files::Budget;
use std::io::Read;

/// First bytes of an array.
pub(in crate::files) const MAGIC: &[u8] = b"\x93NUMPY";

/// Description of a structured type.
pub(super) const FIELDS: &str = "a structure with fields";

/// Type of the values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    Float,
    Signed,
    Unsigned,
    /// Date, with the power of ten from its unit to nanoseconds.
    Date(i32),
}

/// Type of the values with their size and byte order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ValueType {
    kind: Kind,
    pub(super) bytes: usize,
    is_big_endian: bool,
}

impl ValueType {
    /// Type of a description such as `<f8`; `None` if it is not a number.
    fn parse(description: &str) -> Option<Self> {
        let (order, rest) = description.split_at_checked(1)?;
        let is_big_endian = match order {
            "<" | "|" | "=" => false,
            ">" => true,
            _ => return None,
        };
        let (kind, size) = rest.split_at_checked(1)?;
        let (kind, bytes) = match (kind, size) {
            ("f", "4" | "8") => (Kind::Float, size.parse().ok()?),
            ("i", "1" | "2" | "4" | "8") => (Kind::Signed, size.parse().ok()?),
            ("u", "1" | "2" | "4" | "8") => (Kind::Unsigned, size.parse().ok()?),
            ("b", "1") => (Kind::Unsigned, 1),
            ("M", "8[ns]") => (Kind::Date(0), 8),
            ("M", "8[us]") => (Kind::Date(3), 8),
            ("M", "8[ms]") => (Kind::Date(6), 8),
            ("M", "8[s]") => (Kind::Date(9), 8),
            _ => return None,
        };
        Some(Self {
            kind,
            bytes,
            is_big_endian,
        })
    }

    /// Unit of dates.
    pub(super) fn time_unit(self) -> Option<&'static str> {
        match self.kind {
            Kind::Date(0) => Some("ns"),
            Kind::Date(3) => Some("us"),
            Kind::Date(6) => Some("ms"),
            Kind::Date(_) => Some("s"),
            _ => None,
        }
    }

    /// Bits of a value, the least significant first.
    fn bits(self, value: &[u8]) -> [u8; 8] {
        let mut bits = [0; 8];
        let count = value.len().min(bits.len());
        bits[..count].copy_from_slice(&value[..count]);
        if self.is_big_endian {
            bits[..count].reverse();
        }
        bits
    }

    /// Integer, unless the values are floats or it is the date that stands for none.
    pub(super) fn integer(self, value: &[u8]) -> Option<i128> {
        let unsigned = u64::from_le_bytes(self.bits(value));
        let unused_bits = 64 - 8 * self.bytes as u32;
        let signed = (unsigned << unused_bits).cast_signed() >> unused_bits;
        match self.kind {
            Kind::Float => None,
            Kind::Unsigned => Some(unsigned.into()),
            Kind::Signed => Some(signed.into()),
            Kind::Date(_) => (signed != i64::MIN).then_some(signed.into()),
        }
    }

    /// Value as a float; `None` where there is none.
    pub(super) fn float(self, value: &[u8]) -> Option<f64> {
        let bits = self.bits(value);
        match (self.kind, self.bytes) {
            (Kind::Float, 4) => {
                let [a, b, c, d, ..] = bits;
                Some(f32::from_le_bytes([a, b, c, d]).into())
            }
            (Kind::Float, _) => Some(f64::from_le_bytes(bits)),
            _ => self.integer(value).map(|integer| integer as f64),
        }
    }
}

/// Header of an array.
#[derive(Debug, PartialEq)]
pub(super) struct Header {
    /// Type of the values; otherwise its description, if it is not a number.
    pub(super) value_type: Result<ValueType, String>,
    /// Whether the first index advances fastest.
    pub(super) is_fortran: bool,
    pub(super) shape: Vec<u64>,
    /// Bytes before the values.
    pub(super) bytes: u64,
}

impl Header {
    /// Reads a header; the error is a description.
    pub(super) fn read(mut from: impl Read, budget: &Budget) -> Result<Self, String> {
        let io = |error: std::io::Error| format!("its header cannot be read: {error}");
        let mut start = [0; 8];
        from.read_exact(&mut start).map_err(io)?;
        if !start.starts_with(MAGIC) {
            return Err("it does not start as an array (93 4E 55 4D 50 59)".to_owned());
        }
        let is_short = start[6] == 1;
        let mut length = [0; 4];
        let size = if is_short { 2 } else { 4 };
        from.read_exact(&mut length[..size]).map_err(io)?;
        let length = u32::from_le_bytes(length) as usize;
        budget.text.check(length as u64)?;
        let mut text = vec![0; length];
        from.read_exact(&mut text).map_err(io)?;
        let text = String::from_utf8_lossy(&text);
        let parsed = Self::parse(&text, (start.len() + size + length) as u64);
        parsed.ok_or_else(|| {
            let found = sinew_files::names::shorten(text.trim(), 120);
            format!("its header is not that of an array: {found}")
        })
    }

    fn parse(text: &str, bytes: u64) -> Option<Self> {
        let value_of = |key: &str| Some(text.split_once(key)?.1.trim_start());
        let described = value_of("'descr':")?;
        let quoted = described.strip_prefix('\'');
        let description = match quoted {
            Some(rest) => rest.split_once('\'')?.0,
            None => FIELDS,
        };
        let order = value_of("'fortran_order':")?;
        let is_fortran = order.starts_with("True");
        if !is_fortran && !order.starts_with("False") {
            return None;
        }
        let shape = value_of("'shape':")?.strip_prefix('(')?;
        let sizes = shape.split_once(')')?.0.split(',').map(str::trim);
        let sizes = sizes.filter(|size| !size.is_empty());
        Some(Self {
            value_type: ValueType::parse(description).ok_or_else(|| description.to_owned()),
            is_fortran,
            shape: sizes.map(|size| size.parse().ok()).collect::<Option<_>>()?,
            bytes,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn header_has_type_shape_and_order() {
        let text = b"{'descr': '>f4', 'fortran_order': True, 'shape': (3, 2), }";
        let mut bytes = [MAGIC, &[1, 0, text.len() as u8, 0], text].concat();
        let header = Header::read(&bytes[..], &Budget::RECORDING).expect("a header");
        assert_eq!(header.shape, [3, 2]);
        assert_eq!(header.bytes, bytes.len() as u64);
        assert!(header.is_fortran);
        let value_type = header.value_type.expect("a number");
        assert_eq!(value_type.float(&1.5_f32.to_be_bytes()), Some(1.5));
        for (found, words) in [
            (&bytes[..20], "cannot be read"),
            (&b"\x93NUMPY\x02\x00\xff\xff\xff\x7f"[..], "at most 4194304"),
            (&b"\x93NUMPZ\x01\x00\x00\x00"[..], "93 4E"),
        ] {
            let error = Header::read(found, &Budget::RECORDING).unwrap_err();
            assert!(error.contains(words), "{error}");
        }
        bytes[30] = b'!';
        assert!(Header::read(&bytes[..], &Budget::RECORDING).is_err());
    }

    #[test]
    fn values_have_their_size_sign_and_byte_order() {
        let of = |description: &str| ValueType::parse(description).expect("a number");
        assert_eq!(of("<i2").integer(&(-2_i16).to_le_bytes()), Some(-2));
        assert_eq!(of(">i4").integer(&(-2_i32).to_be_bytes()), Some(-2));
        assert_eq!(of("|u1").integer(&[255]), Some(255));
        assert_eq!(of("|i1").float(&[255]), Some(-1.0));
        assert_eq!(
            of("<u8").integer(&u64::MAX.to_le_bytes()),
            Some(u64::MAX.into())
        );
        assert_eq!(of("<f8").float(&0.25_f64.to_le_bytes()), Some(0.25));
        assert_eq!(of("<M8[ns]").integer(&i64::MIN.to_le_bytes()), None);
        assert_eq!(of("<M8[us]").time_unit(), Some("us"));
        for other in ["<c16", "|O", "<U5", "f8", "", "<f2", "<M8[D]"] {
            assert_eq!(ValueType::parse(other), None, "{other}");
        }
    }
}
