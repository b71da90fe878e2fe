//! HTML page with sections of text, tables, figures and evaluated statements.

use crate::Table;
use crate::plot::{Figure, escape_xml, page_colours};
use minijinja::syntax::SyntaxConfig;
use minijinja::value::Serde;
use minijinja::{Environment, Value, context};
use serde::Serialize;
use sha2::{Digest, Sha256};
use std::sync::LazyLock;

const STYLE: &str = include_str!("page/page.css");
/// Script for cursor values, zoom and legend of the figures.
const SCRIPT: &str = include_str!("page/page.js");
const TEMPLATES: [(&str, &str); 3] = [
    ("page.html", include_str!("page/page.html")),
    ("block.html", include_str!("page/block.html")),
    ("glance.html", include_str!("page/glance.html")),
];
/// Message for template errors; templates are part of the program, and a test renders each of them.
const TEMPLATE_ERROR: &str = "a template of the program";

/// HTML page in one file.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Page {
    /// Title of the window and first heading.
    pub title: String,
    /// Line under the heading; may be empty.
    pub subtitle: String,
    /// Sections of the page in order.
    pub sections: Vec<Section>,
    /// Last line, such as the version; may be empty.
    pub footer: String,
}

/// Section of a page: a heading and its blocks.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Section {
    /// Heading; may be empty.
    pub heading: String,
    /// Blocks under the heading.
    pub blocks: Vec<Block>,
}

/// Block of a section.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Block {
    /// Paragraph of text.
    Paragraph(String),
    /// Results in large letters.
    Headlines(Vec<Headline>),
    /// Highlighted text in a frame.
    Notice(String),
    /// Bulleted list of texts.
    List(Vec<String>),
    /// Table with rows and columns.
    Table(Table),
    /// Figure with a caption, which may be empty.
    Figure(#[serde(serialize_with = "pictures")] Box<Figure>, String),
    /// Statements compared with data.
    Sentences(Vec<Sentence>),
    /// Collapsed details under a summary line.
    Folded(String, Vec<Block>),
}

/// Urgency of a result, shown as a colour and an icon.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Level {
    /// Information without an assessment.
    #[default]
    Plain,
    /// Result within limits; no action required.
    Good,
    /// The result is inconclusive.
    Open,
    /// Change that should be observed.
    Watch,
    /// The result requires action.
    Alarm,
}

/// Result in large letters. The text contains all information that the colour shows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Headline {
    /// Urgency of the result.
    pub level: Level,
    /// Text of the result.
    pub text: String,
}

impl Headline {
    /// Creates a result with a level and a text.
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

impl From<Table> for Block {
    fn from(table: Table) -> Self {
        Self::Table(table)
    }
}

/// Statement of a source, evaluated from data by a specified criterion.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sentence {
    /// Statement of the source.
    pub text: String,
    /// Criterion for the statement, with threshold and unit.
    pub criterion: String,
    /// Value from the data, in `unit`.
    pub value: f64,
    /// Unit of the value.
    pub unit: String,
    /// Whether the criterion is met; `None`: inconclusive.
    pub holds: Option<bool>,
}

impl Page {
    /// Creates an empty page.
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

    /// Renders the page as HTML text.
    pub fn html(&self) -> String {
        let script = tight(SCRIPT);
        // The content security policy permits only this script.
        let digest = base64(&Sha256::digest(&script));
        let style = tight(STYLE) + &page_colours();
        let script = self
            .sections
            .iter()
            .any(Section::needs_script)
            .then_some(script);
        fill(
            "page.html",
            context! { page => Serde(self), digest, style, script },
        )
    }
}

impl Section {
    /// Whether the section needs the script: a figure, or details that are expanded for printing.
    fn needs_script(&self) -> bool {
        let needs_script = |b: &Block| matches!(b, Block::Figure(..) | Block::Folded(..));
        self.blocks.iter().any(needs_script)
    }
}

impl Table {
    /// Renders the table as an HTML fragment.
    pub fn html(&self) -> String {
        let block = context! { table => Serde(self) };
        fill("block.html", context! { block })
    }
}

/// Renders a template; values not marked as safe are escaped.
pub(crate) fn fill(template: &str, values: Value) -> String {
    static ENVIRONMENT: LazyLock<Environment<'static>> = LazyLock::new(|| {
        let mut environment = Environment::new();
        let mut syntax = SyntaxConfig::builder();
        syntax.trim_blocks(true).lstrip_blocks(true);
        environment.set_syntax(syntax.build().expect(TEMPLATE_ERROR));
        environment.set_formatter(|out, _, value| {
            let text = value.to_string();
            let text = if value.is_safe() {
                text
            } else {
                escape_xml(&text)
            };
            Ok(out.write_str(&text)?)
        });
        environment.add_filter("prose", prose);
        environment.add_filter("one_line", |text: &str| {
            // A unit in brackets follows its quantity without a comma.
            text.replace("\n(", " (").replace('\n', ", ")
        });
        environment.add_filter("unstopped", |text: &str| {
            text.trim_end_matches('.').to_owned()
        });
        environment.add_filter("rounded", |value: f64| crate::rounded(value, 3));
        for (name, text) in TEMPLATES {
            environment.add_template(name, text).expect(TEMPLATE_ERROR);
        }
        environment
    });
    let template = ENVIRONMENT.get_template(template).expect(TEMPLATE_ERROR);
    template.render(values).expect(TEMPLATE_ERROR)
}

/// Encodes bytes in base 64 (RFC 4648).
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

/// Removes comment lines and indentation, because every page contains the code.
fn tight(code: &str) -> String {
    let lines = code.lines().map(str::trim_start);
    lines
        .filter(|line| !line.is_empty() && !line.starts_with("//"))
        .fold(String::new(), |text, line| text + line + "\n")
}

/// Formats a text so that command options are not broken across lines.
fn prose(text: &str) -> Value {
    let words = text.split(' ').map(|word| match word.starts_with("--") {
        true => format!("<span class=\"whole\">{}</span>", escape_xml(word)),
        false => escape_xml(word),
    });
    Value::from_safe_string(words.collect::<Vec<_>>().join(" "))
}

/// Serialises a figure as two SVGs, for wide and for narrow windows.
fn pictures<S: serde::Serializer>(figure: &Figure, out: S) -> Result<S::Ok, S::Error> {
    figure.wide_and_narrow().serialize(out)
}
