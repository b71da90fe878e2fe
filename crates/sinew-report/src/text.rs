//! Tables and paragraphs for a terminal: as wide as it is, in colour where it shows colour.

use comfy_table::{
    CellAlignment, ColumnConstraint, ContentArrangement, LineStyle, TableStyle, Width,
};
use sinew_figure::Table;
use sinew_files::number::three_digits;
pub use sinew_files::plain;
use std::sync::OnceLock;

/// Columns of a terminal that everybody has.
pub const WIDTH: usize = 80;
/// Fewest columns that a table is laid out for.
const NARROWEST: usize = 40;
/// Longest line of a paragraph: longer ones are hard to read.
const LONGEST_LINE: usize = 100;

/// What the terminal is like.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Look {
    /// Columns of a line.
    pub columns: usize,
    /// Whether it shows colour.
    pub colour: bool,
}

static LOOK: OnceLock<Look> = OnceLock::new();

/// Says what the terminal is like, once, before anything is laid out. Without it, text is for 80
/// columns and has no colour.
pub fn set_look(look: Look) {
    let columns = look.columns.max(NARROWEST);
    // A second call changes nothing: half a text in another width would help nobody.
    let _ = LOOK.set(Look { columns, ..look });
}

fn look() -> Look {
    *LOOK.get().unwrap_or(&Look {
        columns: WIDTH,
        colour: false,
    })
}

/// Columns that a text is laid out for.
pub(crate) fn columns() -> usize {
    look().columns
}

/// How a text is meant; words always say it too.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tone {
    /// Head of a table.
    Head,
    /// A limit is passed, or nothing could be done.
    Alarm,
    /// Worth a look.
    Caution,
}

/// The text in its tone, line by line, where the terminal shows colour.
pub fn toned(tone: Tone, text: &str) -> String {
    match look().colour {
        true => painted(tone, text),
        false => text.to_owned(),
    }
}

/// The text in the terminal's colours; what follows is as before.
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

/// A line under the head and nothing else.
const STYLE: TableStyle =
    TableStyle::new().header_separator(LineStyle::none().fill('─').junction('─'));

/// A table: names to the left, numbers to the right; wrapped to the terminal.
pub fn table(head: &[&str], rows: Vec<Vec<String>>, left: usize) -> String {
    let (gap, least) = least_widths(head, &rows, left);
    let mut table = comfy_table::Table::new();
    table
        .load_style(STYLE)
        .set_content_arrangement(ContentArrangement::Dynamic)
        .set_width(look().columns as u16)
        .set_header(head.iter().map(ToString::to_string).collect::<Vec<_>>())
        .add_rows(rows);
    let last = head.len().saturating_sub(1);
    for (i, column) in table.column_iter_mut().enumerate() {
        // Between columns there is one more.
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

/// A table of the document as a terminal shows it: its leading columns of words to the left.
pub(crate) fn shown(table: Table) -> String {
    let head: Vec<&str> = table.head.iter().map(String::as_str).collect();
    let left = (0..head.len()).take_while(|i| table.worded.contains(i));
    self::table(&head, table.rows, left.count())
}

/// Columns between columns, and widths at which nothing is broken that should be whole: numbers and words, with two columns
/// between where three are too many; of numbers only the words, where that doesn't fit; then numbers only; else anything.
fn least_widths(head: &[&str], rows: &[Vec<String>], left: usize) -> (u16, Vec<usize>) {
    let count = |text: &str| text.chars().count();
    let length = |text: &str| text.lines().map(count).max().unwrap_or(0);
    let word = |text: &str| text.split_whitespace().map(count).max().unwrap_or(0);
    let widths = |names: &dyn Fn(&str) -> usize, numbers: &dyn Fn(&str) -> usize| -> Vec<usize> {
        (head.iter().enumerate())
            .map(|(i, head)| {
                let cells = rows.iter().filter_map(|row| row.get(i));
                let least = cells.map(|cell| match i >= left {
                    true => numbers(cell),
                    false => names(cell),
                });
                least.fold(word(head), usize::max)
            })
            .collect()
    };
    let fits = |(gap, widths): &(u16, Vec<usize>)| {
        let gaps = usize::from(*gap) * head.len().saturating_sub(1);
        widths.iter().sum::<usize>() + gaps <= look().columns
    };
    let all = widths(&word, &length);
    [
        (3, all.clone()),
        (2, all),
        (2, widths(&word, &word)),
        (3, widths(&|_| 0, &length)),
    ]
    .into_iter()
    .find(fits)
    .unwrap_or((3, Vec::new()))
}

/// A paragraph, wrapped; following lines are indented by `indent`.
pub fn paragraph(text: &str, indent: usize) -> String {
    indented(text, 0, indent)
}

/// A paragraph whose first line begins at column `first`, and the others at `rest`.
pub fn indented(text: &str, first: usize, rest: usize) -> String {
    let width = look().columns.min(LONGEST_LINE);
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

/// Text for a terminal, part after part. What comes from a file is made [`plain`].
#[derive(Debug, Default)]
pub(crate) struct Told(pub(crate) String);

impl Told {
    /// A paragraph.
    pub(crate) fn say(&mut self, text: impl AsRef<str>) {
        self.0 += &paragraph(&plain(text.as_ref()), 2);
    }

    /// A paragraph, indented.
    pub(crate) fn item(&mut self, text: impl AsRef<str>) {
        self.0 += &indented(&plain(text.as_ref()), 2, 4);
    }

    /// A paragraph whose lines all begin at the left.
    pub(crate) fn flat(&mut self, text: impl AsRef<str>) {
        self.0 += &paragraph(&plain(text.as_ref()), 0);
    }

    /// A table.
    pub(crate) fn table(&mut self, table: Table) {
        self.0 += &shown(table);
    }

    /// Lines as they are.
    pub(crate) fn add(&mut self, text: impl AsRef<str>) {
        self.0 += text.as_ref();
    }
}

/// With a capital, to begin a sentence.
pub(crate) fn capitalised(text: &str) -> String {
    let mut rest = text.chars();
    let first = rest.next().map(|c| c.to_ascii_uppercase());
    first.into_iter().chain(rest).collect()
}

/// With a capital and a full stop.
pub(crate) fn sentence(text: &str) -> String {
    capitalised(text) + "."
}

/// What isn't there is a dash in a table.
pub(crate) fn or_dash<T>(value: Option<T>, text: impl FnOnce(T) -> String) -> String {
    value.map_or("–".to_owned(), text)
}

/// Yes or no.
pub(crate) fn yes_no(yes: bool) -> &'static str {
    if yes { "yes" } else { "no" }
}

/// A number to three digits.
pub(crate) fn short(value: f64) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    three_digits(value)
}

/// [`plain`], line by line: several messages stay several lines.
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
    fn numbers_and_names_stay_whole_where_sentences_give_way() {
        let head = ["robot", "joint", "to do", "limit mm", "now mm", "days"];
        let sentence = "tension it again, or have a look at its pulleys first";
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
        // A cell may have lines of its own.
        let head = [
            "tendon",
            "offset",
            "stretch",
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
        // 79 columns where two are between.
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
    fn a_tone_colours_every_line_and_ends_with_it() {
        let text = painted(Tone::Alarm, "one\n\ntwo");
        assert_eq!(text, "\u{1b}[1;31mone\u{1b}[0m\n\n\u{1b}[1;31mtwo\u{1b}[0m");
        assert_eq!(
            toned(Tone::Alarm, "one"),
            "one",
            "no colour unless asked for"
        );
    }

    #[test]
    fn escape_sequences_from_files_are_not_obeyed() {
        assert_eq!(plain("\u{1b}[2Jelbow"), "\u{fffd}[2Jelbow");
        assert_eq!(
            plain_lines("a: no time\nb: \u{7}"),
            "a: no time\nb: \u{fffd}"
        );
    }
}
