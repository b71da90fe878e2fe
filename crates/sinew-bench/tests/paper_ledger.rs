//! The paper, sentence by sentence.

use crate::paper_figures::{fig1, fig2, fig4, fig5, fig6, fig7, table1};
use sinew_bench::paper::{Claim, FigureName, Ledger, LedgerStatus, SaidBy};

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
    let ledger = Ledger::of("biorob-like", &judged);
    for row in &ledger.rows {
        println!("{:?} {:?} {}", row.status, row.claim, row.found);
        // A reason stands where nothing judges it, and only there. What elongation spoils is judged by `control`, which
        // takes minutes.
        let control = matches!(row.claim, Claim::SpoilsPosition | Claim::SpoilsTorque);
        let judged = row.status != LedgerStatus::NotJudged || control;
        assert_eq!(judged, row.claim.not_judged().is_none(), "{:?}", row.claim);
        assert_ne!(row.figure, Some(FigureName::Control));
    }
    let contradicted = ledger
        .rows
        .iter()
        .filter(|r| r.status == LedgerStatus::Contradicted);
    let claims: Vec<Claim> = contradicted.map(|r| r.claim).collect();
    assert_eq!(claims, [Claim::ExternalForces]);
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
