//! A figure as files: SVG, PNG and one HTML page that opens offline.

use super::data::{PaperFigure, Written};
use super::sentence::{SaidBy, Sentence, Verdict};
use super::{PaperError, control};
use sinew_figure::plot::PngError;
use sinew_figure::{Block, Headline, Level, Page};
use sinew_files::write_file;
use std::path::{Path, PathBuf};

/// Writes `NAME.svg`, `NAME.html`, in a build that draws PNG `NAME.png`, and `NAME.csv` where the
/// figure has rows, into `folder`, which must exist; the figure then names them.
///
/// # Errors
/// [`PaperError`]; each file is whole or not there.
pub fn write(figure: &mut PaperFigure, folder: &Path) -> Result<(), PaperError> {
    const SCALE: f64 = 2.0;
    let put = |ending: &str, bytes: &[u8]| -> Result<PathBuf, PaperError> {
        let path = folder.join(format!("{}.{ending}", figure.name));
        write_file(&path, bytes)?;
        Ok(path)
    };
    let png = match figure.figure.png(SCALE) {
        Err(PngError::LeftOut) => None,
        drawn => Some(put("png", &drawn?)?),
    };
    let csv = match &figure.rows[..] {
        [] => None,
        rows => Some(put("csv", control::csv(rows).as_bytes())?),
    };
    figure.files = Some(Written {
        html: put("html", html(figure).as_bytes())?,
        svg: put("svg", figure.figure.svg().as_bytes())?,
        png,
        csv,
    });
    Ok(())
}

/// The page as text.
fn html(figure: &PaperFigure) -> String {
    let (paper, sinew): (Vec<&Sentence>, Vec<&Sentence>) = figure
        .sentences
        .iter()
        .partition(|s| s.said_by == SaidBy::Paper);
    let answers = [
        answer(&paper, "of the paper"),
        answer(&sinew, "that Sinew adds"),
    ];
    let mut shown = vec![Block::Headlines(answers.into_iter().flatten().collect())];
    shown.extend(figure.about.iter().cloned().map(Block::Paragraph));
    let drawn = figure.figure.clone().seen(seen(&figure.sentences));
    shown.push(Block::Figure(Box::new(drawn), String::new()));
    shown.extend(figure.tables.iter().cloned().map(Block::Table));
    let mut page = Page {
        footer: format!("Made by Sinew {}.", env!("CARGO_PKG_VERSION")),
        ..Page::new(figure.title.as_str())
    }
    .section("", shown);
    for (heading, sentences) in [
        ("What the paper says, in our words", &paper),
        ("What Sinew adds", &sinew),
    ] {
        if !sentences.is_empty() {
            let judged = sentences.iter().map(|s| judged(s)).collect();
            page = page.section(heading, vec![Block::Sentences(judged)]);
        }
    }
    let lists = [
        ("What is not judged", figure.not_judged.clone()),
        ("What the paper gives", figure.given.clone()),
        ("What is assumed", figure.assumptions.clone()),
    ];
    for (heading, lines) in lists {
        if !lines.is_empty() {
            page = page.section(heading, vec![Block::List(lines)]);
        }
    }
    page.section("Source", vec![Block::Paragraph(SOURCE.into())])
        .html()
}

/// How many sentences hold; none where there are none.
fn answer(sentences: &[&Sentence], whose: &str) -> Option<Headline> {
    let of = |verdict| sentences.iter().filter(|s| s.verdict == verdict).count();
    let (holds, fails) = (of(Verdict::Holds), of(Verdict::Fails));
    let open = sentences.len() - holds - fails;
    let level = match (fails, open) {
        (0, 0) => Level::Good,
        (0, _) => Level::Open,
        _ => Level::Watch,
    };
    let mut text = format!("{holds} of {} sentences {whose} hold", sentences.len());
    if fails > 0 {
        text += &format!(", {fails} not");
    }
    if open > 0 {
        text += &format!(", {open} the data leave open");
    }
    (!sentences.is_empty()).then(|| Headline::new(level, text))
}

/// What the figure shows: the sentences that hold on it.
fn seen(sentences: &[Sentence]) -> String {
    let holding = sentences.iter().filter(|s| s.verdict == Verdict::Holds);
    let texts: Vec<&str> = holding.map(|s| s.text.trim_end_matches('.')).collect();
    texts.join(". ")
}

/// A sentence with its value as people read it.
fn judged(sentence: &Sentence) -> sinew_figure::Sentence {
    let (value, unit) = sentence.shown();
    sinew_figure::Sentence {
        text: sentence.text.clone(),
        criterion: sentence.criterion.clone(),
        value,
        unit: unit.into(),
        holds: match sentence.verdict {
            Verdict::Holds => Some(true),
            Verdict::Open => None,
            Verdict::Fails => Some(false),
        },
    }
}

pub(super) const SOURCE: &str = "After J. Kirchhoff and O. von Stryk, New Insights in Synthetic Fiber Rope \
    Elongation and its Detection for Ultra Lightweight Tendon Driven Series Elastic Robots, IROS \
    2018.";

#[cfg(test)]
mod tests {
    use super::super::{FigureName, Unit};
    use super::*;
    use sinew_figure::plot::Figure;

    #[test]
    fn a_page_tells_what_the_paper_says_from_what_sinew_adds() {
        let sentence = |holds| Sentence::added("A < B", "by eye", 15.147_3, Unit::Rad, holds);
        let paper = Sentence::added("C < D", "", 15.147_3, Unit::Rad, true).of_paper();
        let page = html(&PaperFigure {
            about: vec!["how".into()],
            sentences: vec![paper, sentence(false)],
            not_judged: vec!["E = F. A definition.".into()],
            given: vec!["a number".into()],
            assumptions: vec!["nothing".into()],
            ..PaperFigure::new(FigureName::Fig6, "a < b & \"c\"", Figure::new("f"))
        });
        for words in [
            "a &lt; b &amp; &quot;c&quot;",
            "1 of 1 sentences of the paper hold",
            "0 of 1 sentences that Sinew adds hold, 1 not",
            ">holds<",
            ">does not hold<",
            "Found: 15.1 mrad",
            "a number",
            "E = F. A definition.",
            "IROS 2018",
        ] {
            assert!(page.contains(words), "{words}: {page}");
        }
        let at = |words: &str| page.find(words).unwrap_or_else(|| panic!("{words}"));
        let (paper, sinew) = (at("What the paper says"), at("What Sinew adds"));
        let between = &page[paper..sinew];
        assert!(between.contains("C &lt; D") && !between.contains("A &lt; B"));
        assert!(page[sinew..].contains("A &lt; B"));
    }
}
