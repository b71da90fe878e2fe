//! Every sentence of the paper: judged, not judged and why, contradicted, and what decides it.

use super::claim::{Claim, Place};
use super::control::spoiled;
use super::data::{FigureName, PaperFigure};
use super::decider::Decider;
use super::sentence::{Sentence, Verdict};
use super::{PaperError, Unit, creep, fig4, fig5, fig6, fig7, table1};
use serde::Serialize;
use sinew_files::JsonDocument;
use sinew_model::robot::Robot;
use sinew_rope::Catalogue;
use std::path::PathBuf;

/// The paper, sentence by sentence.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Ledger {
    /// Robot that the sentences on arms were judged on.
    pub robot: String,
    /// In the order of the paper.
    pub rows: Vec<LedgerRow>,
    /// The page, where one was written.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub html: Option<PathBuf>,
}

impl JsonDocument for Ledger {
    const SCHEMA: &'static str = "sinew/paper-ledger/1";
}

/// One sentence of the paper.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LedgerRow {
    /// Which.
    pub claim: Claim,
    /// Where it stands.
    pub place: Place,
    /// What it says, in our words.
    pub text: String,
    /// What became of it.
    pub status: LedgerStatus,
    /// The figure that judges it; none where nothing does.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub figure: Option<FigureName>,
    /// What must be so for it to hold; where it isn't judged, why not.
    pub criterion: String,
    /// What the data gave, in `unit`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
    /// Unit of the value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<Unit>,
    /// The value for people, with its unit.
    #[serde(skip)]
    pub found: String,
    /// What decides it, the most important first.
    pub decided_by: Vec<Decider>,
}

/// What became of a sentence.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum LedgerStatus {
    /// The data say so too.
    Holds,
    /// It holds in some draws of what the catalogue leaves open, and in others not.
    Open,
    /// The data say otherwise.
    Contradicted,
    /// No data of ours judge it.
    NotJudged,
}

impl LedgerStatus {
    /// For people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Open => "open",
            Self::Contradicted => "contradicted",
            Self::NotJudged => "not judged",
        }
    }
}

impl Ledger {
    /// From sentences and the figures that judged them.
    pub fn of(robot: &str, judged: &[(FigureName, Sentence)]) -> Self {
        let row = |claim: Claim| {
            let found = judged.iter().find(|(_, s)| s.claim == Some(claim));
            found.map_or_else(
                || LedgerRow::not_judged(claim),
                |(figure, sentence)| LedgerRow::judged(*figure, claim, sentence),
            )
        };
        Self {
            robot: robot.into(),
            rows: Claim::ALL.into_iter().map(row).collect(),
            html: None,
        }
    }

    /// How many rows are so.
    pub fn count(&self, status: LedgerStatus) -> usize {
        self.rows.iter().filter(|r| r.status == status).count()
    }
}

impl LedgerRow {
    fn judged(figure: FigureName, claim: Claim, sentence: &Sentence) -> Self {
        let (value, unit) = sentence.shown();
        Self {
            claim,
            place: claim.place(),
            text: sentence.text.clone(),
            status: match sentence.verdict {
                Verdict::Holds => LedgerStatus::Holds,
                Verdict::Open => LedgerStatus::Open,
                Verdict::Fails => LedgerStatus::Contradicted,
            },
            figure: Some(figure),
            criterion: sentence.criterion.clone(),
            value: Some(sentence.value),
            unit: Some(sentence.unit),
            found: format!("{} {unit}", sinew_figure::rounded(value, 3)),
            decided_by: sentence.decided_by.clone(),
        }
    }

    fn not_judged(claim: Claim) -> Self {
        Self {
            claim,
            place: claim.place(),
            text: claim.text().into(),
            status: LedgerStatus::NotJudged,
            figure: None,
            criterion: claim.not_judged().unwrap_or_default().into(),
            value: None,
            unit: None,
            found: String::new(),
            decided_by: Vec::new(),
        }
    }
}

/// Judges every sentence of the paper on `robot` and the ropes of `catalogue`.
///
/// # Errors
/// [`PaperError`].
pub fn ledger(robot: &Robot, catalogue: &Catalogue) -> Result<Ledger, PaperError> {
    let figures = [
        table1(catalogue)?,
        creep::fig1(catalogue)?,
        creep::fig2(catalogue)?,
        fig4(catalogue)?,
        fig5(catalogue)?,
        fig6(robot)?,
        fig7(robot)?,
    ];
    let of = |figure: &PaperFigure| {
        let name = figure.name;
        let sentences = figure.sentences.iter();
        sentences
            .map(move |s| (name, s.clone()))
            .collect::<Vec<_>>()
    };
    let mut judged: Vec<(FigureName, Sentence)> = figures.iter().flat_map(of).collect();
    judged.extend(spoiled(robot)?.map(|s| (FigureName::Control, s)));
    Ok(Ledger::of(&robot.name, &judged))
}
