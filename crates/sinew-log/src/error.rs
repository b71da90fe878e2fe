//! The one error type of the crate: what, where, which value, and what to do.

use std::fmt;

/// Why a recording, mapping or output was refused.
///
/// A damaged recording is *not* an error: it is read up to the damage and
/// described by [`Health`](crate::Health). Errors are for input that cannot be
/// understood at all, for a wrong request, and for the operating system.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// The operating system refused to open or read a file.
    #[error("{file}: cannot {action}: {source}")]
    Io {
        /// File as the user named it.
        file: String,
        /// What was tried: `open`, `read`.
        action: &'static str,
        /// The system's own reason.
        source: std::io::Error,
    },
    /// The file is not a recording Sinew can read.
    #[error("{file}: not a recording: {reason}")]
    NotARecording {
        /// File as the user named it.
        file: String,
        /// What was found, and what was expected.
        reason: String,
    },
    /// A cell or value at a known place cannot be used.
    #[error("{file}: {place}: {reason}")]
    Content {
        /// File as the user named it.
        file: String,
        /// Line, column, row or byte.
        place: Place,
        /// Value found, what was expected and what to do.
        reason: String,
    },
    /// A topic, joint, column or option asked for is not in the recording.
    #[error("{file}: {reason}")]
    Request {
        /// File as the user named it.
        file: String,
        /// What was asked for, what there is, and the nearest match.
        reason: String,
    },
    /// A mapping file is wrong.
    #[error("{file}: {}{reason}", line.map(|line| format!("line {line}: ")).unwrap_or_default())]
    Mapping {
        /// Mapping file as the user named it.
        file: String,
        /// One-based line, where known.
        line: Option<usize>,
        /// What is wrong and what would be right.
        reason: String,
    },
    /// The operating system refused to write a file.
    #[error(transparent)]
    Output(#[from] sinew_files::OutputError),
    /// A writer was used wrongly (frame of the wrong length, no joints).
    #[error("{file}: cannot write: {reason}")]
    Write {
        /// File as the user named it.
        file: String,
        /// Expected and found.
        reason: String,
    },
}

/// Where in a file something was found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Place {
    /// Line and column name of a text table, line counted from one.
    Cell {
        /// One-based line number.
        line: u64,
        /// Name of the column as in the header.
        column: String,
    },
    /// A line of a text file, counted from one.
    Line(u64),
    /// A row of a Parquet file, counted from zero, and its column.
    Row {
        /// Zero-based row.
        row: u64,
        /// Name of the column.
        column: String,
    },
    /// A byte offset.
    Byte(u64),
    /// The table's header.
    Header,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::Cell { line, column } => write!(f, "line {line}, column '{column}'"),
            Place::Line(line) => write!(f, "line {line}"),
            Place::Row { row, column } => write!(f, "row {row}, column '{column}'"),
            Place::Byte(byte) => write!(f, "byte {byte}"),
            Place::Header => write!(f, "header"),
        }
    }
}

/// A list of names for an error message, cut where it would flood the terminal.
pub(crate) fn name_list<S: AsRef<str>>(names: &[S]) -> String {
    const SHOWN: usize = 24;
    let mut text = names
        .iter()
        .take(SHOWN)
        .map(|name| format!("'{}'", shorten(name.as_ref(), 80)))
        .collect::<Vec<_>>()
        .join(", ");
    if names.len() > SHOWN {
        text.push_str(&format!(" and {} more", names.len() - SHOWN));
    }
    if text.is_empty() {
        text.push_str("none");
    }
    text
}

/// At most `limit` characters of a text that came from a file.
pub(crate) fn shorten(text: &str, limit: usize) -> String {
    if text.chars().count() <= limit {
        return text.to_owned();
    }
    let mut short: String = text.chars().take(limit).collect();
    short.push('…');
    short
}

/// What goes between a name that isn't there and those that are.
pub(crate) fn hint<S: AsRef<str>>(wanted: &str, known: &[S]) -> String {
    match nearest(wanted, known) {
        Some(name) => format!("; did you mean '{name}'?"),
        None => ";".to_owned(),
    }
}

/// The known name closest to `wanted`, when it is close enough to be a slip of the pen.
pub(crate) fn nearest<'a, S: AsRef<str>>(wanted: &str, known: &'a [S]) -> Option<&'a str> {
    let limit = (wanted.chars().count() / 3).max(2);
    known
        .iter()
        .take(1024)
        .map(|name| (edit_distance(wanted, name.as_ref()), name.as_ref()))
        .filter(|(distance, _)| *distance <= limit)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, name)| name)
}

fn edit_distance(a: &str, b: &str) -> usize {
    const LONGEST: usize = 128;
    let b: Vec<char> = b.chars().take(LONGEST).collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, ca) in a.chars().take(LONGEST).enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, cb) in b.iter().enumerate() {
            let substituted = diagonal + usize::from(ca != *cb);
            diagonal = row[j + 1];
            row[j + 1] = substituted.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_of_the_pen_finds_its_name_and_a_stranger_does_not() {
        let known = ["shoulder_pitch", "elbow", "wrist"];
        assert_eq!(nearest("elbwo", &known), Some("elbow"));
        assert_eq!(nearest("sholder_pitch", &known), Some("shoulder_pitch"));
        assert_eq!(nearest("gripper", &known), None);
    }
}
