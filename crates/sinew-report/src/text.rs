//! Layout of tables and paragraphs for a terminal of a given width, with optional colour.

use comfy_table::{
    CellAlignment, ColumnConstraint, ContentArrangement, LineStyle, TableStyle, Width,
};
use sinew_figure::Table;
use sinew_files::number::three_digits;
pub use sinew_files::plain;
use std::sync::OnceLock;

/// Default width of a terminal, columns.
pub const WIDTH: usize = 80;
/// Minimum width for which a table is laid out, columns.
const MIN_WIDTH: usize = 40;
/// Maximum line length of a paragraph, columns; longer lines are hard to read.
const MAX_LINE_LENGTH: usize = 100;

/// Properties of the terminal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Look {
    /// Width of a line, columns.
    pub columns: usize,
    /// Whether colour is used.
    pub colour: bool,
}

static LOOK: OnceLock<Look> = OnceLock::new();

/// Sets the properties of the terminal once, before any layout. The default is 80 columns without colour.
pub fn set_look(look: Look) {
    let columns = look.columns.max(MIN_WIDTH);
    // A second call has no effect, so that all text has the same width.
    let _ = LOOK.set(Look { columns, ..look });
}

fn look() -> Look {
    *LOOK.get().unwrap_or(&Look {
        columns: WIDTH,
        colour: false,
    })
}

/// Width for which text is laid out, columns.
pub(crate) fn columns() -> usize {
    look().columns
}

/// Style of a text; its words never depend on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tone {
    /// Heading of a table.
    Head,
    /// Error, or exceeded limit.
    Alarm,
    /// Style of warnings.
    Caution,
}

/// Colours a text line by line if the terminal uses colour.
pub fn toned(tone: Tone, text: &str) -> String {
    match look().colour {
        true => painted(tone, text),
        false => text.to_owned(),
    }
}

/// Colours a text line by line with escape sequences.
pub fn painted(tone: Tone, text: &str) -> String {
    let code = match tone {
        Tone::Head => "1",
        Tone::Alarm => "1;31",
        Tone::Caution => "33",
    };
    let paint = |line: &str| match line.trim_end_matches('\n') {
        "" => line.to_owned(),
        words => format!("\u{1b}[{code}m{words}\u{1b}[0m{}", &line[words.len()..]),
    };
    text.split_inclusive('\n').map(paint).collect()
}

/// Table style: a rule below the heading only.
const STYLE: TableStyle =
    TableStyle::new().header_separator(LineStyle::none().fill('─').junction('─'));

/// Lays out a table in the width of the terminal; the first `left` columns are aligned left, the others right.
pub fn table(head: &[&str], rows: Vec<Vec<String>>, left: usize) -> String {
    let Some((gap, least)) = least_widths(head, &rows, left) else {
        return records(head, &rows);
    };
    let mut table = comfy_table::Table::new();
    table
        .load_style(STYLE)
        .set_content_arrangement(ContentArrangement::Dynamic)
        .set_width(look().columns as u16)
        .set_header(head.iter().map(ToString::to_string).collect::<Vec<_>>())
        .add_rows(rows);
    let last = head.len().saturating_sub(1);
    for (i, column) in table.column_iter_mut().enumerate() {
        // The table adds one column between cells.
        let padding = if i == last { 0 } else { gap - 1 };
        column.set_padding((0, padding));
        if let Some(least) = least.get(i) {
            let width = Width::Fixed(*least as u16 + padding);
            column.set_constraint(ColumnConstraint::LowerBoundary(width));
        }
        if i >= left {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    let text = table.trim_fmt() + "\n";
    match text.find('─') {
        Some(rule) => toned(Tone::Head, &text[..rule]) + &text[rule..],
        None => text,
    }
}

/// Lays out a table of a document; its leading text columns are aligned left.
pub(crate) fn shown(table: Table) -> String {
    let head: Vec<&str> = table.head.iter().map(String::as_str).collect();
    let left = (0..head.len()).take_while(|i| table.worded.contains(i));
    self::table(&head, table.rows, left.count())
}

/// Lays out rows as records, for a terminal that is too narrow for a table with unbroken words: the first cell as a
/// heading, then one line per column.
fn records(head: &[&str], rows: &[Vec<String>]) -> String {
    const INDENT: usize = 2;
    let labels = head
        .iter()
        .map(|label| label.split_whitespace().collect::<Vec<_>>().join(" "));
    let labels: Vec<String> = labels.collect();
    let columns = look().columns.max(4 * INDENT);
    let longest = labels
        .iter()
        .skip(1)
        .map(|label| label.chars().count())
        .max();
    let label_width = longest.unwrap_or(0).min(columns / 2);
    let value_width = columns.saturating_sub(2 * INDENT + label_width).max(1);
    let mut out = String::new();
    for (i, row) in rows.iter().enumerate() {
        if i > 0 {
            out.push('\n');
        }
        for line in row.first().iter().flat_map(|cell| wrapped(cell, columns)) {
            out += &toned(Tone::Head, &line);
            out.push('\n');
        }
        for (label, cell) in labels.iter().zip(row).skip(1) {
            let (labels, values) = (wrapped(label, label_width), wrapped(cell, value_width));
            for k in 0..labels.len().max(values.len()) {
                let [label, value] =
                    [&labels, &values].map(|of| of.get(k).map_or("", String::as_str));
                let line = format!("{:INDENT$}{label:label_width$}{:INDENT$}{value}", "", "");
                out += line.trim_end();
                out.push('\n');
            }
        }
    }
    out
}

/// Breaks a text into lines of at most `width` characters, between words where possible.
fn wrapped(text: &str, width: usize) -> Vec<String> {
    let width = width.max(1);
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        let letters: Vec<char> = word.chars().collect();
        for part in letters.chunks(width) {
            let part: String = part.iter().collect();
            match lines.last_mut() {
                Some(line) if line.chars().count() + 1 + part.chars().count() <= width => {
                    line.push(' ');
                    *line += &part;
                }
                _ => lines.push(part),
            }
        }
    }
    lines
}

/// Returns the gap between columns and their minimum widths, or `None` if the terminal is too narrow.
///
/// Tries in this order what fits the terminal, each with a gap of three and of two: all lines unbroken; names broken
/// between words; headings broken as well. The last resort breaks numbers between words.
fn least_widths(head: &[&str], rows: &[Vec<String>], left: usize) -> Option<(u16, Vec<usize>)> {
    let count = |text: &str| text.chars().count();
    let length = |text: &str| text.lines().map(count).max().unwrap_or(0);
    let word = |text: &str| text.split_whitespace().map(count).max().unwrap_or(0);
    type Width<'a> = &'a dyn Fn(&str) -> usize;
    let widths = |heads: Width<'_>, names: Width<'_>, numbers: Width<'_>| -> Vec<usize> {
        (head.iter().enumerate())
            .map(|(i, head)| {
                let cells = rows.iter().filter_map(|row| row.get(i));
                let least = cells.map(|cell| match i >= left {
                    true => numbers(cell),
                    false => names(cell),
                });
                least.fold(heads(head), usize::max)
            })
            .collect()
    };
    let fits = |(gap, widths): &(u16, Vec<usize>)| {
        let gaps = usize::from(*gap) * head.len().saturating_sub(1);
        widths.iter().sum::<usize>() + gaps <= look().columns
    };
    let whole = widths(&length, &length, &length);
    let lines = widths(&length, &word, &length);
    let all = widths(&word, &word, &length);
    let words = widths(&word, &word, &word);
    [
        (3, whole.clone()),
        (2, whole),
        (3, lines.clone()),
        (2, lines),
        (3, all.clone()),
        (2, all),
        (2, words),
    ]
    .into_iter()
    .find(fits)
}

/// Wraps a paragraph; lines after the first are indented by `indent`.
pub fn paragraph(text: &str, indent: usize) -> String {
    indented(text, 0, indent)
}

/// Wraps a paragraph; the first line is indented by `first`, the others by `rest`.
pub fn indented(text: &str, first: usize, rest: usize) -> String {
    let width = look().columns.min(MAX_LINE_LENGTH);
    let mut out = " ".repeat(first);
    let mut column = first;
    let mut fresh = true;
    for word in text.split_whitespace() {
        let length = word.chars().count();
        if !fresh && column + 1 + length > width {
            out.push('\n');
            out.push_str(&" ".repeat(rest));
            column = rest;
        } else if !fresh {
            out.push(' ');
            column += 1;
        }
        out.push_str(word);
        column += length;
        fresh = false;
    }
    out.push('\n');
    out
}

/// Text for a terminal, built part by part; control characters are removed by [`plain`].
#[derive(Debug, Default)]
pub(crate) struct TerminalText(pub(crate) String);

impl TerminalText {
    /// Adds a paragraph.
    pub(crate) fn paragraph(&mut self, text: impl AsRef<str>) {
        self.0 += &paragraph(&plain(text.as_ref()), 2);
    }

    /// Adds an indented paragraph.
    pub(crate) fn item(&mut self, text: impl AsRef<str>) {
        self.0 += &indented(&plain(text.as_ref()), 2, 4);
    }

    /// Adds a paragraph without indentation.
    pub(crate) fn flat(&mut self, text: impl AsRef<str>) {
        self.0 += &paragraph(&plain(text.as_ref()), 0);
    }

    /// Adds a table.
    pub(crate) fn table(&mut self, table: Table) {
        self.0 += &shown(table);
    }

    /// Adds lines unchanged.
    pub(crate) fn add(&mut self, text: impl AsRef<str>) {
        self.0 += text.as_ref();
    }
}

/// Capitalises the first letter of a text.
pub(crate) fn capitalised(text: &str) -> String {
    let mut rest = text.chars();
    let first = rest.next().map(|c| c.to_ascii_uppercase());
    first.into_iter().chain(rest).collect()
}

/// Capitalises a text and adds a full stop.
pub(crate) fn sentence(text: &str) -> String {
    capitalised(text) + "."
}

/// Formats an optional value; a dash if it is missing.
pub(crate) fn or_dash<T>(value: Option<T>, text: impl FnOnce(T) -> String) -> String {
    value.map_or("–".to_owned(), text)
}

/// Formats a boolean as `yes` or `no`.
pub(crate) fn yes_no(yes: bool) -> &'static str {
    if yes { "yes" } else { "no" }
}

/// Formats a number with three significant digits; a dash if it is not finite.
pub(crate) fn short(value: f64) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    three_digits(value)
}

/// Applies [`plain`] line by line.
pub fn plain_lines(text: &str) -> String {
    let lines: Vec<String> = text.lines().map(plain).collect();
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paragraphs_and_tables_stay_within_80_columns() {
        let long = "a joint with_a_very_long_name_that_goes_on and on and on ".repeat(9);
        let head = ["joint", "offset, mrad", "what"];
        let rows = vec![vec![long.clone(), "1.0".into(), long.clone()]];
        for text in [
            paragraph(&long, 4),
            indented(&long, 7, 9),
            table(&head, rows, 1),
        ] {
            for line in text.lines() {
                assert!(line.chars().count() <= WIDTH, "{line}");
            }
        }
    }

    #[test]
    fn table_breaks_sentences_before_numbers_and_names() {
        let head = ["robot", "joint", "action", "limit mm", "now mm", "days"];
        let sentence = "re-tension, or inspect the pulleys of this joint first";
        let row = [
            "arm-0077",
            "shoulder_pitch",
            sentence,
            "0.50",
            "30.47 ± 0.05",
            "120 … > 365",
        ];
        let text = table(&head, vec![row.map(str::to_owned).into()], 3);
        for whole in ["shoulder_pitch", "30.47 ± 0.05", "120 … > 365"] {
            assert!(text.contains(whole), "{whole} is broken:\n{text}");
        }
        let widest = text.lines().map(|l| l.chars().count()).max();
        assert!(widest <= Some(WIDTH), "{text}");
        // A cell may contain several lines.
        let head = [
            "tendon",
            "offset",
            "elongation",
            "creep",
            "re-tension in days; on",
        ];
        let row = [
            "shoulder_pitch",
            "15.6 ± 0.98",
            "0.467 ± 0.029",
            "0.528 ± 0.44",
            "103 (2 to …)\n2026-09-30",
        ];
        let text = table(&head, vec![row.map(str::to_owned).into()], 1);
        assert!(text.contains("shoulder_pitch"), "{text}");
        assert!(text.contains("103 (2 to …)\n"), "{text}");
        // 79 columns with a gap of two.
        let head = ["robot", "joint", "rope", "µm/m", "times usual", "by chance"];
        let row = [
            "arm-0015",
            "shoulder_pitch",
            "liros-dc000-0701",
            "53245",
            "0.00 (0.00 … 0.00)",
            "< 0.0001",
        ];
        let text = table(&head, vec![row.map(str::to_owned).into()], 3);
        for whole in row {
            assert!(text.contains(whole), "{whole} is broken:\n{text}");
        }
        let widest = text.lines().map(|l| l.chars().count()).max();
        assert!(widest <= Some(WIDTH), "{text}");
    }

    #[test]
    fn table_of_estimate_has_headings_of_two_lines() {
        let head = [
            "joint",
            "offset\n(mrad)",
            "95 % CI\n(±)",
            "elongation\n(mm)",
            "95 % CI\n(±)",
            "strain\n(%)",
            "result",
        ];
        let row = [
            "shoulder_pitch",
            "−0.11",
            "0.61",
            "−0.002",
            "0.011",
            "−0.0002",
            "offset detected",
        ];
        let text = table(&head, vec![row.map(str::to_owned).into()], 1);
        let rule = text.lines().position(|line| line.starts_with('─'));
        assert_eq!(rule, Some(2), "{text}");
        assert_eq!(text.matches("95 % CI").count(), 2, "{text}");
        let widest = text.lines().map(|l| l.chars().count()).max();
        assert!(widest <= Some(WIDTH), "{text}");
    }

    #[test]
    fn table_too_wide_for_terminal_becomes_records() {
        let head = ["joint", "offset\n(mrad)", "result"];
        let long = "w".repeat(WIDTH - 20);
        let row = [
            "shoulder_pitch".to_owned(),
            "12.7".into(),
            format!("{long} {long}"),
        ];
        let text = table(&head, vec![row.to_vec(), row.to_vec()], 1);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(
            lines[..2],
            ["shoulder_pitch", "  offset (mrad)  12.7"],
            "{text}"
        );
        assert_eq!(text.matches(&long).count(), 4, "{text}");
        assert!(lines.iter().all(|l| l.chars().count() <= WIDTH), "{text}");
        assert!(lines.contains(&""), "{text}");
    }

    #[test]
    fn style_colours_every_line_separately() {
        let text = painted(Tone::Alarm, "one\n\ntwo");
        assert_eq!(text, "\u{1b}[1;31mone\u{1b}[0m\n\n\u{1b}[1;31mtwo\u{1b}[0m");
        assert_eq!(
            toned(Tone::Alarm, "one"),
            "one",
            "no colour unless asked for"
        );
    }

    #[test]
    fn escape_sequences_from_files_are_replaced() {
        assert_eq!(plain("\u{1b}[2Jelbow"), "\u{fffd}[2Jelbow");
        assert_eq!(
            plain_lines("a: no time\nb: \u{7}"),
            "a: no time\nb: \u{fffd}"
        );
    }
}
