//! A page: sections of text, tables, figures and judged sentences, as one HTML file.

use crate::Table;
use crate::plot::{Figure, escape_xml, page_colours};
use minijinja::syntax::SyntaxConfig;
use minijinja::value::Serde;
use minijinja::{Environment, Value, context};
use serde::Serialize;
use sha2::{Digest, Sha256};
use std::sync::LazyLock;

const STYLE: &str = include_str!("page/page.css");
/// Values, zoom and legend of the figures.
const SCRIPT: &str = include_str!("page/page.js");
const TEMPLATES: [(&str, &str); 3] = [
    ("page.html", include_str!("page/page.html")),
    ("block.html", include_str!("page/block.html")),
    ("glance.html", include_str!("page/glance.html")),
];
/// Templates are part of the program, and a test fills each of them.
const TESTED: &str = "a template of the program";

/// One HTML file.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
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
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Section {
    /// Heading; may be empty.
    pub heading: String,
    /// What stands under it.
    pub blocks: Vec<Block>,
}

/// A piece of a section.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
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
    Figure(#[serde(serialize_with = "picture")] Box<Figure>, String),
    /// Sentences held against data.
    Sentences(Vec<Sentence>),
    /// What few want to read, under a line that opens it.
    Folded(String, Vec<Block>),
}

/// How much an answer asks of its reader: a colour and, beside it, a sign.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize)]
#[serde(rename_all = "snake_case")]
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

/// An answer in large letters. Its words say all that its colour does.
#[derive(Debug, Clone, PartialEq, Serialize)]
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

impl From<Table> for Block {
    fn from(table: Table) -> Self {
        Self::Table(table)
    }
}

/// A sentence of a source, judged from data by a stated criterion.
#[derive(Debug, Clone, PartialEq, Serialize)]
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
        let script = tight(SCRIPT);
        // A page lets no script run but this one.
        let digest = base64(&Sha256::digest(&script));
        let style = tight(STYLE) + &page_colours();
        let script = self.sections.iter().any(Section::moves).then_some(script);
        fill(
            "page.html",
            context! { page => Serde(self), digest, style, script },
        )
    }
}

impl Section {
    /// Whether something in it moves: a figure, or what is unfolded before it is printed.
    fn moves(&self) -> bool {
        let moves = |b: &Block| matches!(b, Block::Figure(..) | Block::Folded(..));
        self.blocks.iter().any(moves)
    }
}

impl Table {
    /// The table as a piece of HTML.
    pub fn html(&self) -> String {
        let block = context! { table => Serde(self) };
        fill("block.html", context! { block })
    }
}

/// A template filled in; whatever is not marked as safe in it is escaped.
pub(crate) fn fill(template: &str, values: Value) -> String {
    static ENVIRONMENT: LazyLock<Environment<'static>> = LazyLock::new(|| {
        let mut environment = Environment::new();
        let mut syntax = SyntaxConfig::builder();
        syntax.trim_blocks(true).lstrip_blocks(true);
        environment.set_syntax(syntax.build().expect(TESTED));
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
        environment.add_filter("one_line", |text: &str| text.replace('\n', ", "));
        environment.add_filter("unstopped", |text: &str| {
            text.trim_end_matches('.').to_owned()
        });
        environment.add_filter("rounded", |value: f64| crate::rounded(value, 3));
        for (name, text) in TEMPLATES {
            environment.add_template(name, text).expect(TESTED);
        }
        environment
    });
    let template = ENVIRONMENT.get_template(template).expect(TESTED);
    template.render(values).expect(TESTED)
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
fn prose(text: &str) -> Value {
    let words = text.split(' ').map(|word| match word.starts_with("--") {
        true => format!("<span class=\"whole\">{}</span>", escape_xml(word)),
        false => escape_xml(word),
    });
    Value::from_safe_string(words.collect::<Vec<_>>().join(" "))
}

/// A figure in a page is its picture.
fn picture<S: serde::Serializer>(figure: &Figure, out: S) -> Result<S::Ok, S::Error> {
    out.serialize_str(&figure.svg())
}
