//! Bytes as text, in the encodings instruments and spreadsheets write.

use crate::budget::Budget;
use crate::located::{Fault, Located};
use std::borrow::Cow;
use std::io::Read as _;
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
    /// Windows code page 1252, used if the text is neither of these.
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

    /// Decodes the bytes after the byte order mark; an invalid character becomes U+FFFD.
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
/// Returns [`Fault::Syntax`] for bytes with zeros in them that are not UTF-16 with its mark: no text.
pub fn decode<'b>(bytes: &'b [u8], file: &str) -> Result<(Cow<'b, str>, Encoding), Located> {
    let (encoding, mark) = Encoding::of(bytes);
    let wide = matches!(encoding, Encoding::Utf16Le | Encoding::Utf16Be);
    if !wide && bytes.contains(&0) {
        let problem = "not a text file: contains zero bytes";
        return Err(Located::new(file, Fault::Syntax, problem));
    }
    Ok((encoding.decode(&bytes[mark..]), encoding))
}

/// Reads the text of a file within its budget, in any of the encodings.
///
/// # Errors
/// Returns the errors of [`read_bytes`]; [`Fault::Syntax`] when it is no text.
pub fn read_text(path: &Path, budget: &Budget) -> Result<String, Located> {
    let bytes = read_bytes(path, budget)?;
    let (text, _) = decode(&bytes, &path.display().to_string())?;
    Ok(text.into_owned())
}

/// Reads a complete file or pipe within its budget.
///
/// # Errors
/// Returns [`Fault::Unreadable`], also for a device, which may never end; [`Fault::TooLarge`].
pub fn read_bytes(path: &Path, budget: &Budget) -> Result<Vec<u8>, Located> {
    let limit = budget.memory;
    let file = path.display().to_string();
    let wrong = |fault, problem: String| Located::new(&file, fault, problem);
    let unreadable = |error| wrong(Fault::Unreadable, format!("cannot read: {error}"));
    crate::atomic::note_input(path);
    let handle = std::fs::File::open(path).map_err(unreadable)?;
    let about = handle.metadata().map_err(unreadable)?;
    if about.is_dir() {
        return Err(wrong(Fault::Unreadable, "is a folder; name a file".into()));
    }
    if is_device(&about) {
        return Err(wrong(Fault::Unreadable, "is a device; name a file".into()));
    }
    let too_large = |problem| wrong(Fault::TooLarge, problem);
    limit.check(about.len()).map_err(too_large)?;
    let mut bytes = Vec::with_capacity(about.len() as usize);
    // A pipe has no length, and a file may grow.
    let mut bounded = handle.take(limit.value().saturating_add(1));
    bounded.read_to_end(&mut bytes).map_err(unreadable)?;
    match bytes.len() as u64 > limit.value() {
        true => Err(too_large(format!("file exceeds the limit; {limit}"))),
        false => Ok(bytes),
    }
}

#[cfg(unix)]
fn is_device(about: &std::fs::Metadata) -> bool {
    use std::os::unix::fs::FileTypeExt as _;
    let kind = about.file_type();
    kind.is_char_device() || kind.is_block_device()
}

#[cfg(not(unix))]
fn is_device(_about: &std::fs::Metadata) -> bool {
    false
}

/// Decodes a byte of code page 1252; its five undefined bytes become control characters.
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

/// Formats a text as a CSV cell: in quotes if it contains a comma, a quote or a line end (RFC
/// 4180).
pub fn csv_cell(text: &str) -> Cow<'_, str> {
    if text.contains([',', '"', '\n', '\r']) {
        Cow::Owned(format!("\"{}\"", text.replace('"', "\"\"")))
    } else {
        Cow::Borrowed(text)
    }
}

/// Text from a file without the characters a terminal would obey; of a number with more than 40 digits the first 40.
pub fn plain(text: &str) -> String {
    const MAX_DIGITS: usize = 40;
    let mut digits = 0;
    let shown = text.chars().filter_map(|c| {
        digits = if c.is_ascii_digit() { digits + 1 } else { 0 };
        match digits {
            0 if c.is_control() => Some('\u{fffd}'),
            0..=MAX_DIGITS => Some(c),
            _ => (digits == MAX_DIGITS + 1).then_some('…'),
        }
    });
    shown.collect()
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
    fn plain_text_has_no_control_characters_and_no_long_numbers() {
        assert_eq!(plain("a\u{1b}[31m\u{9b}b"), "a\u{fffd}[31m\u{fffd}b");
        let number = "1234567890".repeat(4);
        assert_eq!(plain(&number), number);
        assert_eq!(plain(&format!("{number}1.5 N")), format!("{number}….5 N"));
    }

    #[test]
    fn endless_input_is_not_read() {
        const MAX_4_BYTES: Budget = Budget::SETTINGS.with_memory(4);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        for (text, fault) in [("four", None), ("five!", Some(Fault::TooLarge)), ("", None)] {
            std::fs::write(&path, text).unwrap();
            assert_eq!(read_text(&path, &MAX_4_BYTES).err().map(|e| e.fault), fault);
        }
        assert!(read_text(folder.path(), &MAX_4_BYTES).is_err());
        #[cfg(unix)]
        for endless in ["/dev/zero", "/dev/null", "/proc/self/status"] {
            let error = read_text(Path::new(endless), &MAX_4_BYTES).unwrap_err();
            let is_device = endless.starts_with("/dev");
            assert_eq!(error.problem.contains("is a device"), is_device, "{error}");
        }
    }

    #[test]
    fn text_identical_in_every_encoding() {
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
