//! A figure as files: SVG, PNG and one HTML page that opens offline.

use super::{PaperError, PaperFigure};
use sinew_figure::plot::PngError;
use sinew_figure::{Block, Page};
use sinew_files::write_file;
use std::path::{Path, PathBuf};

/// Files of one figure.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Written {
    /// The drawing, scalable.
    pub svg: PathBuf,
    /// The drawing, 2 px per CSS px; none in a build that draws no PNG.
    pub png: Option<PathBuf>,
    /// The page: drawing, sentences, assumptions.
    pub html: PathBuf,
}

/// Writes `NAME.svg`, `NAME.html` and, in a build that draws PNG, `NAME.png` into `folder`, which must exist.
///
/// # Errors
/// [`PaperError`]; each file is whole or not there.
pub fn write(figure: &PaperFigure, folder: &Path) -> Result<Written, PaperError> {
    let at = |ending: &str| folder.join(format!("{}.{ending}", figure.name));
    const SCALE: f64 = 2.0;
    let (svg, html_path) = (at("svg"), at("html"));
    write_file(&svg, figure.figure.svg().as_bytes())?;
    let png = match figure.figure.png(SCALE) {
        Ok(bytes) => Some((at("png"), bytes)),
        Err(PngError::LeftOut) => None,
        Err(error) => return Err(error.into()),
    };
    if let Some((path, bytes)) = &png {
        write_file(path, bytes)?;
    }
    write_file(&html_path, html(figure).as_bytes())?;
    Ok(Written {
        svg,
        png: png.map(|(path, _)| path),
        html: html_path,
    })
}

/// The page as text.
fn html(figure: &PaperFigure) -> String {
    let mut shown: Vec<Block> = figure.about.iter().cloned().map(Block::Paragraph).collect();
    shown.push(Block::Figure(
        Box::new(figure.figure.clone()),
        String::new(),
    ));
    shown.extend(figure.tables.iter().cloned().map(Block::Table));
    let mut page = Page {
        footer: format!("Made by Sinew {}.", env!("CARGO_PKG_VERSION")),
        ..Page::new(figure.title.as_str())
    }
    .section("", shown)
    .section(
        "What it should show",
        vec![Block::Sentences(figure.sentences.clone())],
    );
    if !figure.not_judged.is_empty() {
        let list = Block::List(figure.not_judged.clone());
        page = page.section("What is not judged", vec![list]);
    }
    page.section(
        "What is assumed",
        vec![Block::List(figure.assumptions.clone())],
    )
    .section("Source", vec![Block::Paragraph(SOURCE.into())])
    .html()
}

const SOURCE: &str = "After J. Kirchhoff and O. von Stryk, New Insights in Synthetic Fiber Rope \
    Elongation and its Detection for Ultra Lightweight Tendon Driven Series Elastic Robots, IROS \
    2018.";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paper::Sentence;
    use sinew_figure::plot::Figure;

    #[test]
    fn a_page_shows_sentences_and_what_is_not_judged() {
        let sentence = |holds| Sentence {
            text: "A < B".into(),
            criterion: "by eye".into(),
            value: 15.147_3,
            unit: "mrad".into(),
            holds,
        };
        let page = html(&PaperFigure {
            name: "fig0",
            title: "a < b & \"c\"".into(),
            about: vec!["how".into()],
            panels: Vec::new(),
            figure: Figure::new("f"),
            sentences: vec![sentence(true), sentence(false)],
            not_judged: vec!["who knows".into()],
            tables: Vec::new(),
            assumptions: vec!["nothing".into()],
        });
        for words in [
            "a &lt; b &amp; &quot;c&quot;",
            ">holds<",
            ">does not hold<",
            "Found: 15.1 mrad",
            "who knows",
            "IROS 2018",
        ] {
            assert!(page.contains(words), "{words}: {page}");
        }
    }
}
