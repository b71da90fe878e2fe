//! The sentences of the paper, and which of them the figures judge.

use crate::paper_figures::{fig1, fig2, fig4, fig5, fig6, fig7, table1};
use sinew_bench::paper::{Claim, SaidBy, Verdict};

#[test]
fn every_sentence_is_judged_or_has_a_reason() {
    let figures = [table1(), fig1(), fig2(), fig4(), fig5(), fig6(), fig7()];
    let judged: Vec<_> = figures
        .iter()
        .flat_map(|f| f.sentences.iter().map(|s| (f.name, s.clone())))
        .collect();
    // What Sinew adds is no sentence of the paper, and the other way round.
    for (name, sentence) in &judged {
        let paper = sentence.said_by == SaidBy::Paper;
        assert_eq!(paper, sentence.claim.is_some(), "{name}: {}", sentence.text);
        let text = sentence.claim.map(Claim::text);
        assert!(text.is_none_or(|text| text == sentence.text), "{name}");
    }
    // What does not hold, and nothing else: the paper's sentence on unknown forces is right for loads that hang.
    let failing: Vec<Option<Claim>> = judged
        .iter()
        .filter(|(_, sentence)| sentence.claim.is_some() && sentence.verdict == Verdict::Fails)
        .map(|(_, sentence)| sentence.claim)
        .collect();
    assert_eq!(failing, [Some(Claim::ExternalForces)]);
    // A reason stands where nothing judges a sentence, and only there. What elongation spoils is judged by `control`, which
    // takes minutes.
    for claim in Claim::ALL {
        let control = matches!(claim, Claim::SpoilsPosition | Claim::SpoilsTorque);
        let is_judged = judged.iter().any(|(_, s)| s.claim == Some(claim)) || control;
        assert_eq!(is_judged, claim.not_judged().is_none(), "{claim:?}");
    }
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
