//! Parsing of MCAP records whose lengths have been checked.
//!
//! The parser of the format allocates memory by the lengths in a record before it has the bytes: a length of 2³² − 1 in a
//! record of 20 bytes would end the process.

use mcap::records::{Record, op};

/// Part of a record's layout.
enum Part {
    /// Number of bytes of numbers.
    Fixed(usize),
    /// Bytes with a length of 32 bits before them.
    Text,
    /// Pairs of texts, with the length of all pairs in bytes before them.
    Pairs,
}

/// Returns the layout of a record up to its last length; empty for records without lengths.
fn layout(opcode: u8) -> &'static [Part] {
    use Part::{Fixed, Pairs, Text};
    match opcode {
        op::HEADER => &[Text, Text],
        op::SCHEMA => &[Fixed(2), Text, Text, Text],
        op::CHANNEL => &[Fixed(4), Text, Text, Pairs],
        op::CHUNK => &[Fixed(28), Text],
        op::MESSAGE_INDEX => &[Fixed(2), Text],
        op::CHUNK_INDEX => &[Fixed(32), Text, Fixed(8), Text],
        op::ATTACHMENT => &[Fixed(16), Text, Text],
        op::ATTACHMENT_INDEX => &[Fixed(40), Text, Text],
        op::STATISTICS => &[Fixed(42), Text],
        op::METADATA => &[Text, Pairs],
        op::METADATA_INDEX => &[Fixed(16), Text],
        _ => &[],
    }
}

/// Splits bytes with their length off.
fn text<'a>(body: &mut &'a [u8]) -> Option<&'a [u8]> {
    let (length, rest) = body.split_first_chunk::<4>()?;
    let length = usize::try_from(u32::from_le_bytes(*length)).ok()?;
    let (text, rest) = rest.split_at_checked(length)?;
    *body = rest;
    Some(text)
}

/// Whether every length in a record is that of bytes in the record.
fn lengths_fit(opcode: u8, mut body: &[u8]) -> bool {
    let mut follow = || {
        for part in layout(opcode) {
            match part {
                Part::Fixed(bytes) => body = body.get(*bytes..)?,
                Part::Text => drop(text(&mut body)?),
                Part::Pairs => {
                    let mut pairs = text(&mut body)?;
                    while !pairs.is_empty() {
                        text(&mut pairs)?;
                    }
                }
            }
        }
        Some(())
    };
    follow().is_some()
}

/// Parses the body of an MCAP record.
///
/// # Errors
/// Returns the reason if a length in the record exceeds the record, or if the record cannot be parsed.
pub fn parse_mcap_record(opcode: u8, body: &[u8]) -> Result<Record<'_>, String> {
    if !lengths_fit(opcode, body) {
        return Err("a length exceeds the record".into());
    }
    mcap::parse_record(opcode, body).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counted(text: &str) -> Vec<u8> {
        let length = u32::try_from(text.len()).unwrap_or(u32::MAX).to_le_bytes();
        [&length[..], text.as_bytes()].concat()
    }

    #[test]
    fn record_with_excessive_length_is_error() {
        let pairs = [counted("offered_qos_profiles"), counted("- depth: 1")].concat();
        let channel = |pairs_bytes: u32| {
            let head = [
                &[1, 0, 2, 0][..],
                &counted("/joint_states"),
                &counted("cdr"),
            ]
            .concat();
            [&head[..], &pairs_bytes.to_le_bytes(), &pairs].concat()
        };
        let whole = channel(u32::try_from(pairs.len()).unwrap());
        assert!(matches!(
            parse_mcap_record(op::CHANNEL, &whole),
            Ok(Record::Channel(channel)) if channel.topic == "/joint_states"
        ));
        assert!(parse_mcap_record(op::CHANNEL, &channel(u32::MAX)).is_err());
        // Every length in turn.
        for opcode in 1..=0x0f {
            for at in 0..whole.len() - 4 {
                let mut changed = whole.clone();
                changed[at..at + 4].fill(0xff);
                let _ = parse_mcap_record(opcode, &changed);
            }
        }
    }
}
