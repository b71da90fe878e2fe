//! Files of a figure: SVG, PNG and one self-contained HTML page.

use super::data::{PaperFigure, Written};
use super::sentence::{ClaimedBy, Sentence, Verdict};
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
        Err(PngError::NotBuilt) => None,
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
        .partition(|s| s.claimed_by == ClaimedBy::Paper);
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
        ("Statements of the paper, paraphrased", &paper),
        ("Statements added by Sinew", &sinew),
    ] {
        if !sentences.is_empty() {
            let assessed = sentences.iter().map(|s| assessed(s)).collect();
            page = page.section(heading, vec![Block::Sentences(assessed)]);
        }
    }
    let lists = [
        ("Not assessed", figure.not_assessed.clone()),
        ("Numbers given in the paper", figure.given.clone()),
        ("Assumptions", figure.assumptions.clone()),
    ];
    for (heading, lines) in lists {
        if !lines.is_empty() {
            page = page.section(heading, vec![Block::List(lines)]);
        }
    }
    page.section("Source", vec![Block::Paragraph(SOURCE.into())])
        .html()
}

/// Returns the number of statements that hold; none without statements.
fn answer(sentences: &[&Sentence], whose: &str) -> Option<Headline> {
    let of = |verdict| sentences.iter().filter(|s| s.verdict == verdict).count();
    let (holds, fails) = (of(Verdict::Holds), of(Verdict::Fails));
    let open = sentences.len() - holds - fails;
    let level = match (fails, open) {
        (0, 0) => Level::Good,
        (0, _) => Level::Open,
        _ => Level::Watch,
    };
    let mut text = format!("{holds} of {} statements {whose} hold", sentences.len());
    if fails > 0 {
        text += &format!(", {fails} do not");
    }
    if open > 0 {
        text += &format!(", {open} open");
    }
    (!sentences.is_empty()).then(|| Headline::new(level, text))
}

/// Returns the statements that hold, for the description of the figure.
fn seen(sentences: &[Sentence]) -> String {
    let holding = sentences.iter().filter(|s| s.verdict == Verdict::Holds);
    let texts: Vec<&str> = holding.map(|s| s.text.trim_end_matches('.')).collect();
    texts.join(". ")
}

/// Formats a statement with its value.
fn assessed(sentence: &Sentence) -> sinew_figure::Sentence {
    let (value, unit) = sentence.shown();
    sinew_figure::Sentence {
        text: sentence.text.clone(),
        criterion: format!("{}; basis: {}", sentence.criterion, sentence.basis.name()),
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
    fn page_separates_paper_and_sinew_sentences() {
        let sentence = |holds| Sentence::added("A < B", "by eye", 15.147_3, Unit::Rad, holds);
        let paper = Sentence::added("C < D", "", 15.147_3, Unit::Rad, true).of_paper();
        let page = html(&PaperFigure {
            about: vec!["how".into()],
            sentences: vec![paper, sentence(false)],
            not_assessed: vec!["E = F. A definition.".into()],
            given: vec!["a number".into()],
            assumptions: vec!["nothing".into()],
            ..PaperFigure::new(FigureName::Fig6, "a < b & \"c\"", Figure::new("f"))
        });
        for words in [
            "a &lt; b &amp; &quot;c&quot;",
            "1 of 1 statements of the paper hold",
            "0 of 1 statements that Sinew adds hold, 1 do not",
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
        let (paper, sinew) = (
            at("Statements of the paper"),
            at("Statements added by Sinew"),
        );
        let between = &page[paper..sinew];
        assert!(between.contains("C &lt; D") && !between.contains("A &lt; B"));
        assert!(page[sinew..].contains("A &lt; B"));
    }
}
