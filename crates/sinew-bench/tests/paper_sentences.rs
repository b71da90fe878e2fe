//! The sentences of the paper, and which of them the figures judge.

use crate::paper_figures::{fig1, fig2, fig4, fig5, fig6, fig7, table1};
use sinew_bench::paper::{SaidBy, Sentence, Verdict};

/// What does not hold: it is right for loads that hang, and a force that pushes the joint on is underestimated.
pub(crate) const EXTERNAL_FORCES: &str =
    "If the external forces are not known, the position offset is overestimated.";

#[test]
fn every_sentence_is_judged_or_has_a_reason() {
    // Sentences of the paper that are judged, and those that have a reason not to be. What elongation spoils, two
    // sentences more, is judged by `control`, which takes minutes.
    let figures = [
        (table1(), 1, 0),
        (fig1(), 5, 1),
        (fig2(), 4, 0),
        (fig4(), 2, 3),
        (fig5(), 3, 0),
        (fig6(), 7, 3),
        (fig7(), 5, 0),
    ];
    let mut texts = std::collections::HashSet::new();
    let mut failing = Vec::new();
    for (figure, judged, not_judged) in figures {
        let of_paper = |s: &&Sentence| s.said_by == SaidBy::Paper;
        let sentences: Vec<&Sentence> = figure.sentences.iter().filter(of_paper).collect();
        assert_eq!(sentences.len(), judged, "{}", figure.name);
        assert_eq!(figure.not_judged.len(), not_judged, "{}", figure.name);
        for sentence in sentences {
            assert!(texts.insert(&sentence.text), "twice: {}", sentence.text);
            if sentence.verdict == Verdict::Fails {
                failing.push(sentence.text.as_str());
            }
        }
    }
    // What does not hold, and nothing else.
    assert_eq!(failing, [EXTERNAL_FORCES]);
}

#[test]
fn every_page_says_that_there_are_no_curves_to_compare_with() {
    for figure in [table1(), fig1(), fig2(), fig4(), fig5(), fig6(), fig7()] {
        assert!(
            figure.given[0].contains("not available as data"),
            "{}",
            figure.name
        );
        assert!(figure.given.len() > 1, "{}", figure.name);
    }
}
