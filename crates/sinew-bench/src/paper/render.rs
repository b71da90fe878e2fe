//! Text output of a figure's statements.

use super::control::table as table_of;
use super::data::PaperFigure;
use super::sentence::{ClaimedBy, Sentence, Verdict};
use sinew_figure::rounded;
use sinew_report::text::{indented, paragraph, table};

/// Formats the table, if the figure has one, the assessed statements, and the names of the written files.
pub fn render(figure: &PaperFigure) -> String {
    let mut out = String::new();
    if !figure.rows.is_empty() {
        let (head, cells) = table_of(&figure.rows);
        out = table(&head, cells, 2) + "\n";
    }
    out.push_str(&paragraph(&figure.title, 0));
    for (heading, whose) in [
        ("statements of the paper", ClaimedBy::Paper),
        ("Sinew adds", ClaimedBy::Sinew),
    ] {
        let mut sentences = figure.sentences.iter().filter(|s| s.claimed_by == whose);
        if let Some(first) = sentences.next() {
            out.push_str(&format!("\n{heading}\n"));
            std::iter::once(first)
                .chain(sentences)
                .for_each(|s| out.push_str(&assessed(s)));
        }
    }
    for text in &figure.not_assessed {
        out.push('\n');
        out.push_str(&paragraph(&format!("not assessed: {text}"), 7));
    }
    for text in &figure.given {
        out.push('\n');
        out.push_str(&paragraph(&format!("given: {text}"), 7));
    }
    out.push('\n');
    if let Some(files) = &figure.files {
        for path in [&files.html, &files.svg].into_iter().chain(&files.png) {
            out.push_str(&format!("{}\n", path.display()));
        }
    }
    out
}

fn assessed(sentence: &Sentence) -> String {
    let verdict = match sentence.verdict {
        Verdict::Holds => "holds:",
        Verdict::Open => "open: ",
        Verdict::Fails => "FAILS:",
    };
    let mut out = "\n".to_owned() + &paragraph(&format!("{verdict} {}", sentence.text), 7);
    let (value, unit) = sentence.shown();
    let at = match (sentence.verdict, sentence.holds) {
        (Verdict::Open, true) => "holds at the catalogue's values; ",
        (Verdict::Open, false) => "does not hold at the catalogue's values; ",
        _ => "",
    };
    let found = format!(
        "{at}found {} {unit}; {}; basis: {}",
        rounded(value, 3),
        sentence.criterion,
        sentence.basis.name()
    );
    out.push_str(&indented(&found, 7, 7));
    out
}
