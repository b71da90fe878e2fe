//! Bytes as text, in the encodings instruments and spreadsheets write.

use crate::located::{Fault, Located};
use std::borrow::Cow;
use std::path::Path;

/// How a text is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Encoding {
    /// UTF-8, with or without a byte order mark.
    Utf8,
    /// UTF-16, little endian, with its mark: "Unicode text" of Windows programs.
    Utf16Le,
    /// UTF-16, big endian, with its mark.
    Utf16Be,
    /// Windows code page 1252: whatever is neither.
    Cp1252,
}

impl Encoding {
    /// Encoding of a text that starts so, and the bytes of its mark.
    ///
    /// A start may end within a character.
    pub fn of(start: &[u8]) -> (Self, usize) {
        match start {
            [0xff, 0xfe, ..] => (Self::Utf16Le, 2),
            [0xfe, 0xff, ..] => (Self::Utf16Be, 2),
            _ => {
                let mark = if start.starts_with(b"\xef\xbb\xbf") {
                    3
                } else {
                    0
                };
                match std::str::from_utf8(start) {
                    Err(error) if error.error_len().is_some() => (Self::Cp1252, mark),
                    _ => (Self::Utf8, mark),
                }
            }
        }
    }

    /// Text of bytes behind the mark; what is no character becomes U+FFFD.
    pub fn decode(self, bytes: &[u8]) -> Cow<'_, str> {
        let utf16 = |unit: fn([u8; 2]) -> u16| {
            let pairs = bytes.chunks_exact(2);
            let units: Vec<u16> = pairs.map(|pair| unit([pair[0], pair[1]])).collect();
            Cow::Owned(String::from_utf16_lossy(&units))
        };
        match self {
            Self::Utf8 => String::from_utf8_lossy(bytes),
            Self::Utf16Le => utf16(u16::from_le_bytes),
            Self::Utf16Be => utf16(u16::from_be_bytes),
            Self::Cp1252 => bytes.iter().map(|byte| cp1252(*byte)).collect(),
        }
    }
}

/// Text of a whole file, without its byte order mark.
///
/// # Errors
/// [`Fault::Syntax`] for bytes with zeros in them that are not UTF-16 with its mark: no text.
pub fn decode<'b>(bytes: &'b [u8], file: &str) -> Result<(Cow<'b, str>, Encoding), Located> {
    let (encoding, mark) = Encoding::of(bytes);
    let wide = matches!(encoding, Encoding::Utf16Le | Encoding::Utf16Be);
    if !wide && bytes.contains(&0) {
        let problem = "it holds zero bytes, so it is not text";
        return Err(Located::new(file, Fault::Syntax, problem));
    }
    Ok((encoding.decode(&bytes[mark..]), encoding))
}

/// Text of a file of at most `most` bytes, in whatever encoding.
///
/// # Errors
/// [`Fault::Unreadable`], [`Fault::TooLarge`]; [`Fault::Syntax`] when it is no text.
pub fn read_text(path: &Path, most: u64) -> Result<String, Located> {
    let file = path.display().to_string();
    let unreadable = |error: std::io::Error| {
        Located::new(&file, Fault::Unreadable, format!("can't read: {error}"))
    };
    let bytes = std::fs::metadata(path).map_err(unreadable)?.len();
    if bytes > most {
        let problem = format!("{bytes} bytes; such a file has at most {most}");
        return Err(Located::new(&file, Fault::TooLarge, problem));
    }
    let bytes = std::fs::read(path).map_err(unreadable)?;
    decode(&bytes, &file).map(|(text, _)| text.into_owned())
}

/// A byte of code page 1252; the five it leaves open stay control characters.
fn cp1252(byte: u8) -> char {
    const FROM_80: [char; 32] = [
        '€', '\u{81}', '‚', 'ƒ', '„', '…', '†', '‡', 'ˆ', '‰', 'Š', '‹', 'Œ', '\u{8d}', 'Ž',
        '\u{8f}', '\u{90}', '‘', '’', '“', '”', '•', '–', '—', '˜', '™', 'š', '›', 'œ', '\u{9d}',
        'ž', 'Ÿ',
    ];
    match byte {
        0x80..=0x9f => FROM_80[usize::from(byte - 0x80)],
        _ => char::from(byte),
    }
}

/// A text as a cell of CSV: in quotes where it holds a comma, a quote or a line end (RFC 4180).
pub fn csv_cell(text: &str) -> Cow<'_, str> {
    if text.contains([',', '"', '\n', '\r']) {
        Cow::Owned(format!("\"{}\"", text.replace('"', "\"\"")))
    } else {
        Cow::Borrowed(text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_quoted_where_csv_needs_it() {
        assert_eq!(csv_cell("elbow"), "elbow");
        assert_eq!(csv_cell("a,b"), "\"a,b\"");
        assert_eq!(csv_cell("say \"no\""), "\"say \"\"no\"\"\"");
        assert_eq!(csv_cell("two\nlines"), "\"two\nlines\"");
    }

    #[test]
    fn the_same_words_in_every_encoding() {
        let words = "Prüfzeit;µm;°C\n1,5;2;3\n";
        let wide = |unit: fn(u16) -> [u8; 2]| -> Vec<u8> {
            let text = format!("\u{feff}{words}");
            text.encode_utf16().flat_map(unit).collect()
        };
        let latin: Vec<u8> = words.chars().map(|c| c as u8).collect();
        for (bytes, encoding) in [
            (words.as_bytes().to_vec(), Encoding::Utf8),
            (format!("\u{feff}{words}").into_bytes(), Encoding::Utf8),
            (wide(u16::to_le_bytes), Encoding::Utf16Le),
            (wide(u16::to_be_bytes), Encoding::Utf16Be),
            (latin, Encoding::Cp1252),
        ] {
            assert_eq!(decode(&bytes, "f").unwrap(), (words.into(), encoding));
        }
        assert_eq!(decode(b"\x80 5", "f").unwrap().0, "€ 5");
        assert!(decode(b"a\0b", "f").is_err());
        // Cut within a character: still UTF-8.
        assert_eq!(
            Encoding::of("Prü".as_bytes().split_last().unwrap().1).0,
            Encoding::Utf8
        );
    }
}
