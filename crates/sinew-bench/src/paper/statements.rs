//! Statements of the paper in one table, with the basis of each verdict.

use super::PaperError;
use super::assessment::{claimed, laws};
use super::bending::ROPE;
use super::data::{FigureName, PaperFigure};
use super::sentence::{Basis, ClaimedBy, Sentence, Unit, Verdict};
use sinew_figure::rounded;
use sinew_model::QUANTILE_975;
use sinew_rope::Catalogue;
use sinew_rope::bench::routings::Geometry;
use sinew_rope::law::Parameter;
use std::fmt::Write as _;

/// Tension of each strand without friction, N.
const STRAND_N: f64 = 100.0;

/// Tension that friction takes from a strand behind its wraps, N: `F − F/cosh(μ φ)` with `F` = 100 N.
///
/// The carriage is pulled with `2 F`. One strand runs towards the drive and the other away from it. Behind equal wraps
/// `φ` both have the tension `T` of the joint pulley, and before them `T exp(±μ φ)`, with the sum `2 F`.
pub fn tension_lost_n(friction: f64, wrap_deg: f64) -> f64 {
    STRAND_N - STRAND_N / (friction * wrap_deg.to_radians()).cosh()
}

/// Assesses the paper's explanation of Fig. 4: friction, forces and passes over guiding pulleys.
///
/// # Errors
/// Returns a [`PaperError`] when the catalogue lacks the rope or its law.
pub fn bending(catalogue: &Catalogue) -> Result<Vec<Sentence>, PaperError> {
    let entry = &catalogue.find(ROPE)?.entry;
    let friction = entry.law.get(&Parameter::Friction);
    let friction = friction.ok_or_else(|| PaperError::Rope(ROPE.into()))?;
    let (mu, highest_mu) = (friction.value, friction.at(QUANTILE_975));
    let [small_deg, large_deg] = [0, 1].map(|i| Geometry::AS_READ.wraps_deg[i].iter().sum::<f64>());
    let (small, large) = (tension_lost_n(mu, small_deg), tension_lost_n(mu, large_deg));
    let laws = laws(catalogue, ROPE)?;
    let bedding = |i: usize, passes: f64| laws[i].passed_by(passes).bedding_percent();
    Ok(vec![
        Sentence::added(
            "Friction lowers the tension behind large wraps.",
            format!("closed form {STRAND_N} N (1 − 1/cosh(μ φ)) with μ = {mu} and φ = {large_deg}°, both strands guided: at least 1 N"),
            large,
            Unit::N,
            large >= 1.0,
        )
        .of_paper(),
        Sentence::added(
            "Small wraps keep the forces almost unchanged.",
            format!("the same with φ = {small_deg}°: at most 1 N, also at the upper limit of μ, {highest_mu:.2}"),
            small,
            Unit::N,
            tension_lost_n(highest_mu, small_deg) <= 1.0,
        )
        .of_paper(),
        claimed(
            "More passes over pulleys cause more elongation.",
            "full bedding-in B (1 + g_N N^q) of a section rises from N = 0 to 1 and on to 3 passes, because g_N and q are positive",
            |i| bedding(i, 1.0) > bedding(i, 0.0) && bedding(i, 3.0) > bedding(i, 1.0),
        )
        .based_on(Basis::Construction),
    ])
}

impl FigureName {
    /// Returns the place in the paper.
    fn place(self) -> &'static str {
        match self {
            Self::Fig1 => "Fig. 1",
            Self::Fig2 => "Fig. 2",
            Self::Fig3 => "Fig. 3",
            Self::Fig4 => "Fig. 4",
            Self::Fig5 => "Fig. 5",
            Self::Fig6 => "Fig. 6",
            Self::Fig7 => "Fig. 7",
            Self::Table1 => "Table I",
            Self::Control => "text",
        }
    }
}

/// Returns the statements of the paper as a Markdown table: those of the figures, and further ones by their figure.
pub fn statements_table(
    figures: &[&PaperFigure],
    further: &[(FigureName, Vec<Sentence>)],
) -> String {
    let assessed = figures.iter().map(|f| (f.name, &f.sentences[..]));
    let further = further.iter().map(|(name, more)| (*name, &more[..]));
    let mut groups: Vec<(FigureName, &[Sentence])> = assessed.chain(further).collect();
    groups.sort_by_key(|(name, _)| *name as usize);
    let mut out =
        String::from("| place | statement | verdict | found | basis |\n|---|---|---|---|---|\n");
    for (name, sentences) in groups {
        let of_paper = |s: &&Sentence| s.claimed_by == ClaimedBy::Paper;
        for sentence in sentences.iter().filter(of_paper) {
            out += &row(name, sentence);
        }
    }
    out
}

/// Returns the statements of the paper without an assessment as a Markdown table.
pub fn not_assessed_table(figures: &[&PaperFigure]) -> String {
    let mut out = String::from("| place | statement or procedure, and reason |\n|---|---|\n");
    for figure in figures {
        for text in &figure.not_assessed {
            // Writing into a string cannot fail.
            let _ = writeln!(out, "| {} | {text} |", figure.name.place());
        }
    }
    out
}

fn row(name: FigureName, sentence: &Sentence) -> String {
    let verdict = match sentence.verdict {
        Verdict::Holds => "holds",
        Verdict::Open => "open",
        Verdict::Fails => "contradicted",
    };
    format!(
        "| {} | {} | {verdict} | {} | {} |\n",
        name.place(),
        sentence.text,
        found(sentence),
        sentence.basis.name()
    )
}

/// Returns the value with two digits; a share of draws is neither 0 nor 100 %, and rounding errors are below a bound.
fn found(sentence: &Sentence) -> String {
    let (value, unit) = sentence.shown();
    match (sentence.unit, sentence.basis) {
        (_, Basis::Construction) => "–".into(),
        (Unit::ShareOfDraws, _) => match value {
            v if v > 99.0 => "> 99 %".into(),
            v if v < 1.0 => "< 1 %".into(),
            v => format!("{v:.0} %"),
        },
        (Unit::Ropes, _) => format!("{value:.0} {unit}"),
        _ if value.abs() < 1e-3 => format!("< 0.001 {unit}"),
        _ => format!("{} {unit}", rounded(value, 2)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn certain_share_is_not_printed_as_100_percent() {
        let share = |percent| {
            let sentence = Sentence::added("", "", percent, Unit::ShareOfDraws, true);
            found(&sentence)
        };
        assert_eq!(share(100.0), "> 99 %");
        assert_eq!(share(0.0), "< 1 %");
        assert_eq!(share(49.75), "50 %");
        let built = Sentence::added("", "", 100.0, Unit::ShareOfDraws, true);
        assert_eq!(found(&built.based_on(Basis::Construction)), "–");
        let rounding = Sentence::added("", "", 1e-12, Unit::Rad, true);
        assert_eq!(found(&rounding), "< 0.001 mrad");
    }
}
