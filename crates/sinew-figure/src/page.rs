//! A page: sections of text, tables, figures and judged sentences, as one HTML file.

use crate::plot::{Figure, escape_xml, page_colours};
use sha2::{Digest, Sha256};
use std::fmt::Write as _;

const STYLE: &str = include_str!("page.css");
/// Values, zoom and legend of the figures.
const SCRIPT: &str = include_str!("page.js");

/// One HTML file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Page {
    /// Title of the window and first heading.
    pub title: String,
    /// Line under the heading; may be empty.
    pub subtitle: String,
    /// The content.
    pub sections: Vec<Section>,
    /// Last line, such as the version; may be empty.
    pub footer: String,
}

/// A heading and what stands under it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Section {
    /// Heading; may be empty.
    pub heading: String,
    /// What stands under it.
    pub blocks: Vec<Block>,
}

/// A piece of a section.
#[derive(Debug, Clone, PartialEq)]
pub enum Block {
    /// Text.
    Paragraph(String),
    /// Sentences in large letters: the answers.
    Headlines(Vec<Headline>),
    /// Text in a frame: what a reader must not miss.
    Notice(String),
    /// Points.
    List(Vec<String>),
    /// Rows and columns.
    Table(Table),
    /// A figure with a line under it (may be empty).
    Figure(Box<Figure>, String),
    /// Sentences held against data.
    Sentences(Vec<Sentence>),
    /// What few want to read, under a line that opens it.
    Folded(String, Vec<Block>),
}

/// How much an answer asks of its reader: a colour and, beside it, a sign.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub enum Level {
    /// Nothing: a fact.
    #[default]
    Plain,
    /// All is well.
    Good,
    /// The data can't tell.
    Open,
    /// It has changed.
    Watch,
    /// Something is to be done.
    Alarm,
}

impl Level {
    /// Name of the style.
    fn class(self) -> &'static str {
        match self {
            Self::Plain => "plain",
            Self::Good => "good",
            Self::Open => "open",
            Self::Watch => "watch",
            Self::Alarm => "alarm",
        }
    }

    /// A shape that needs no colour: tick, question mark, triangle, octagon.
    fn sign(self) -> String {
        let shape = match self {
            Self::Plain => return String::new(),
            Self::Good => "M2 8.5 6 12.5 14 3.5",
            Self::Open => "M4.5 5a3.5 3.5 0 1 1 5 3.2c-1 .6-1.5 1-1.5 2.3M8 14v.1",
            Self::Watch => "M8 2 15 14H1zM8 6.5v3.5M8 12v.1",
            Self::Alarm => "M5 1h6l4 4v6l-4 4H5l-4-4V5zM8 4.5v4M8 11.5v.1",
        };
        format!(
            "<svg class=\"sign\" viewBox=\"0 0 16 16\" aria-hidden=\"true\"><path d=\"{shape}\"/></svg>"
        )
    }
}

/// An answer in large letters. Its words say all that its colour does.
#[derive(Debug, Clone, PartialEq)]
pub struct Headline {
    /// What it asks of the reader.
    pub level: Level,
    /// The answer.
    pub text: String,
}

impl Headline {
    /// An answer.
    pub fn new(level: Level, text: impl Into<String>) -> Self {
        let text = text.into();
        Self { level, text }
    }
}

impl From<String> for Headline {
    fn from(text: String) -> Self {
        Self::new(Level::Plain, text)
    }
}

/// Rows and columns.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// Line above; may be empty.
    pub caption: String,
    /// Heading of every column. Empty: a table of names and values.
    pub head: Vec<String>,
    /// Cells, one per column. The first of a row names it; the others are numbers to the right
    /// when the table has a head.
    pub rows: Vec<Vec<String>>,
    /// Numbers of the columns of words: they stand to the left and are broken into lines.
    pub worded: Vec<usize>,
}

impl Table {
    /// A table under a heading of every column.
    pub fn new(head: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> Self {
        Self {
            head: head.iter().map(ToString::to_string).collect(),
            rows: rows.into_iter().collect(),
            ..Self::default()
        }
    }

    /// A table of names and values.
    pub fn facts<'a>(rows: impl IntoIterator<Item = (&'a str, String)>) -> Self {
        let rows = rows
            .into_iter()
            .map(|(name, value)| vec![name.to_owned(), value]);
        Self::new(&[], rows)
    }

    /// The table as a piece of HTML.
    pub fn html(&self) -> String {
        let mut out = String::new();
        // Text takes everything.
        let _ = write_table(&mut out, self);
        out
    }

    /// Columns of these headings hold words: they stand to the left and are broken into lines. A heading that isn't there is none.
    #[must_use]
    pub fn worded(mut self, headings: &[&str]) -> Self {
        let worded = |name: &String| headings.contains(&name.as_str());
        self.worded = (0..self.head.len())
            .filter(|i| worded(&self.head[*i]))
            .collect();
        self
    }

    /// Puts a line above.
    #[must_use]
    pub fn captioned(mut self, text: impl Into<String>) -> Self {
        self.caption = text.into();
        self
    }
}

impl From<Table> for Block {
    fn from(table: Table) -> Self {
        Self::Table(table)
    }
}

/// A sentence of a source, judged from data by a stated criterion.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Sentence {
    /// What the source says.
    pub text: String,
    /// What must be so for it to hold, with the threshold and its unit.
    pub criterion: String,
    /// What the data gave.
    pub value: f64,
    /// Unit of the value.
    pub unit: String,
    /// Whether the criterion is met; `None`: the data leave it open.
    pub holds: Option<bool>,
}

impl Page {
    /// An empty page.
    pub fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            ..Self::default()
        }
    }

    /// Adds a section.
    #[must_use]
    pub fn section(mut self, heading: impl Into<String>, blocks: Vec<Block>) -> Self {
        self.sections.push(Section {
            heading: heading.into(),
            blocks,
        });
        self
    }

    /// The file's text.
    pub fn html(&self) -> String {
        let title = escape_xml(&self.title);
        let script = tight(SCRIPT);
        let mut out = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; \
             style-src 'unsafe-inline'; script-src 'sha256-{}'\">\n\
             <title>{title}</title>\n<style>\n{}{}</style>\n</head>\n<body>\n<main>\n\
             <header>\n<h1>{title}</h1>\n",
            // A page lets no script run but this one.
            base64(&Sha256::digest(&script)),
            tight(STYLE),
            page_colours()
        );
        if !self.subtitle.is_empty() {
            let _ = writeln!(
                out,
                "<p class=\"subtitle\">{}</p>",
                escape_xml(&self.subtitle)
            );
        }
        out.push_str("</header>\n");
        for section in &self.sections {
            out.push_str("<section>\n");
            if !section.heading.is_empty() {
                let _ = writeln!(out, "<h2>{}</h2>", escape_xml(&section.heading));
            }
            for block in &section.blocks {
                write_block(&mut out, block);
            }
            out.push_str("</section>\n");
        }
        if !self.footer.is_empty() {
            let _ = writeln!(out, "<footer>{}</footer>", escape_xml(&self.footer));
        }
        out.push_str("</main>\n");
        if self.sections.iter().any(|s| needs_script(&s.blocks)) {
            let _ = writeln!(out, "<script>{script}</script>");
        }
        out.push_str("</body>\n</html>\n");
        out
    }
}

/// Whether something on the page moves: a figure, or what is unfolded before it is printed.
fn needs_script(blocks: &[Block]) -> bool {
    blocks
        .iter()
        .any(|b| matches!(b, Block::Figure(..) | Block::Folded(..)))
}

/// Bytes as text (RFC 4648).
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::new();
    for three in bytes.chunks(3) {
        let all = (0..3).fold(0, |all, i| {
            all << 8 | three.get(i).map_or(0, |b| usize::from(*b))
        });
        for i in 0..4 {
            let letter = LETTERS[all >> (18 - 6 * i) & 63];
            out.push(if i <= three.len() {
                char::from(letter)
            } else {
                '='
            });
        }
    }
    out
}

/// Code without comment lines and indentation: every page carries it.
fn tight(code: &str) -> String {
    let lines = code.lines().map(str::trim_start);
    lines
        .filter(|line| !line.is_empty() && !line.starts_with("//"))
        .fold(String::new(), |text, line| text + line + "\n")
}

/// Text of the page: an option of the command stays in one line.
fn prose(text: &str) -> String {
    let words = text.split(' ').map(|word| match word.starts_with("--") {
        true => format!("<span class=\"whole\">{}</span>", escape_xml(word)),
        false => escape_xml(word),
    });
    words.collect::<Vec<_>>().join(" ")
}

fn write_block(out: &mut String, block: &Block) {
    let _ = match block {
        Block::Paragraph(text) => writeln!(out, "<p>{}</p>", prose(text)),
        Block::Notice(text) => writeln!(out, "<p class=\"notice\">{}</p>", prose(text)),
        Block::Headlines(lines) => write_headlines(out, lines),
        Block::List(lines) => write_list(out, lines),
        Block::Table(table) => write_table(out, table),
        Block::Figure(figure, caption) => writeln!(
            out,
            "<figure><div class=\"scroll\">{}</div><figcaption>{}</figcaption></figure>",
            figure.svg(),
            escape_xml(caption)
        ),
        Block::Sentences(sentences) => write_sentences(out, sentences),
        Block::Folded(line, blocks) => {
            let _ = writeln!(out, "<details>\n<summary>{}</summary>", escape_xml(line));
            for block in blocks {
                write_block(out, block);
            }
            writeln!(out, "</details>")
        }
    };
}

fn write_headlines(out: &mut String, lines: &[Headline]) -> std::fmt::Result {
    writeln!(out, "<ul class=\"headlines\">")?;
    for Headline { level, text } in lines {
        let (class, sign) = (level.class(), level.sign());
        writeln!(out, "<li class=\"{class}\">{sign}{}</li>", prose(text))?;
    }
    writeln!(out, "</ul>")
}

fn write_list(out: &mut String, lines: &[String]) -> std::fmt::Result {
    writeln!(out, "<ul>")?;
    for line in lines {
        writeln!(out, "<li>{}</li>", prose(line))?;
    }
    writeln!(out, "</ul>")
}

fn write_table(out: &mut String, table: &Table) -> std::fmt::Result {
    let facts = table.head.is_empty();
    // Names and values wrap; columns scroll inside their box on a narrow screen.
    let caption = escape_xml(&table.caption);
    let name = match caption.is_empty() {
        true => String::new(),
        false => format!(" aria-label=\"{caption}\""),
    };
    // Beside the box that scrolls, so that it stays in sight.
    if !caption.is_empty() {
        writeln!(out, "<p class=\"caption\">{caption}</p>")?;
    }
    match facts {
        true => writeln!(out, "<table class=\"facts\"{name}>")?,
        false => writeln!(out, "<div class=\"scroll\"><table{name}>")?,
    }
    if !facts {
        out.push_str("<thead><tr>");
        for (i, cell) in table.head.iter().enumerate() {
            let class = class(table, i);
            write!(out, "<th scope=\"col\"{class}>{}</th>", escape_xml(cell))?;
        }
        out.push_str("</tr></thead>\n");
    }
    out.push_str("<tbody>\n");
    for row in &table.rows {
        out.push_str("<tr>");
        for (i, cell) in row.iter().enumerate() {
            let cell = escape_xml(cell);
            match i {
                0 => write!(out, "<th scope=\"row\">{cell}</th>")?,
                _ => write!(out, "<td{}>{cell}</td>", class(table, i))?,
            }
        }
        out.push_str("</tr>\n");
    }
    let closing = if facts { "" } else { "</div>" };
    writeln!(out, "</tbody></table>{closing}")
}

/// What a cell of a column is styled as.
fn class(table: &Table, column: usize) -> &'static str {
    match table.worded.contains(&column) {
        true => " class=\"words\"",
        false => "",
    }
}

fn write_sentences(out: &mut String, sentences: &[Sentence]) -> std::fmt::Result {
    out.push_str("<ul class=\"sentences\">\n");
    for sentence in sentences {
        let (level, verdict) = match sentence.holds {
            Some(true) => (Level::Good, "holds"),
            Some(false) => (Level::Watch, "does not hold"),
            None => (Level::Open, "open"),
        };
        let (class, sign) = (level.class(), level.sign());
        writeln!(
            out,
            "<li class=\"{class}\">{sign} <span class=\"verdict\">{verdict}</span> <q>{}</q>\
             <br><span class=\"criterion\">Criterion: {}. Found: {} {}</span></li>",
            escape_xml(&sentence.text),
            escape_xml(sentence.criterion.trim_end_matches('.')),
            crate::rounded(sentence.value, 3),
            escape_xml(&sentence.unit)
        )?;
    }
    writeln!(out, "</ul>")
}
