//! A page: sections of text, tables, figures and judged sentences, as one HTML file.

use crate::plot::{Figure, escape_xml};
use std::fmt::Write as _;

const STYLE: &str = include_str!("page.css");

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
    /// Text in large letters: what the page is about.
    Headlines(Vec<String>),
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
        let mut out = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n\
             <header>\n<h1>{title}</h1>\n"
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
        out.push_str("</main>\n</body>\n</html>\n");
        out
    }
}

fn write_block(out: &mut String, block: &Block) {
    let _ = match block {
        Block::Paragraph(text) => writeln!(out, "<p>{}</p>", escape_xml(text)),
        Block::Notice(text) => writeln!(out, "<p class=\"notice\">{}</p>", escape_xml(text)),
        Block::Headlines(lines) => write_list(out, lines, " class=\"headlines\""),
        Block::List(lines) => write_list(out, lines, ""),
        Block::Table(table) => write_table(out, table),
        Block::Figure(figure, caption) => writeln!(
            out,
            "<figure><div class=\"scroll\">{}</div><figcaption>{}</figcaption></figure>",
            figure.svg(),
            escape_xml(caption)
        ),
        Block::Sentences(sentences) => write_sentences(out, sentences),
    };
}

fn write_list(out: &mut String, lines: &[String], class: &str) -> std::fmt::Result {
    writeln!(out, "<ul{class}>")?;
    for line in lines {
        writeln!(out, "<li>{}</li>", escape_xml(line))?;
    }
    writeln!(out, "</ul>")
}

fn write_table(out: &mut String, table: &Table) -> std::fmt::Result {
    let facts = table.head.is_empty();
    writeln!(
        out,
        "<table{}>",
        if facts { " class=\"facts\"" } else { "" }
    )?;
    if !table.caption.is_empty() {
        writeln!(out, "<caption>{}</caption>", escape_xml(&table.caption))?;
    }
    if !facts {
        out.push_str("<thead><tr>");
        for cell in &table.head {
            write!(out, "<th scope=\"col\">{}</th>", escape_xml(cell))?;
        }
        out.push_str("</tr></thead>\n");
    }
    out.push_str("<tbody>\n");
    for row in &table.rows {
        out.push_str("<tr>");
        for (i, cell) in row.iter().enumerate() {
            let cell = escape_xml(cell);
            match (i, table.head.get(i)) {
                (0, _) => write!(out, "<th scope=\"row\">{cell}</th>")?,
                // On a narrow screen every cell stands alone with its column's name.
                (_, Some(head)) => {
                    write!(out, "<td data-label=\"{}\">{cell}</td>", escape_xml(head))?;
                }
                (_, None) => write!(out, "<td>{cell}</td>")?,
            }
        }
        out.push_str("</tr>\n");
    }
    writeln!(out, "</tbody></table>")
}

fn write_sentences(out: &mut String, sentences: &[Sentence]) -> std::fmt::Result {
    out.push_str("<ul class=\"sentences\">\n");
    for sentence in sentences {
        let (class, verdict) = match sentence.holds {
            Some(true) => ("holds", "holds"),
            Some(false) => ("fails", "does not hold"),
            None => ("open", "open"),
        };
        writeln!(
            out,
            "<li class=\"{class}\"><span class=\"verdict\">{verdict}</span> <q>{}</q>\
             <br><span class=\"criterion\">Criterion: {}. Found: {} {}</span></li>",
            escape_xml(&sentence.text),
            escape_xml(sentence.criterion.trim_end_matches('.')),
            crate::rounded(sentence.value, 3),
            escape_xml(&sentence.unit)
        )?;
    }
    writeln!(out, "</ul>")
}
