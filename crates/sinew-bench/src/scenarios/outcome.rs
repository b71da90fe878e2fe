//! What became of a recording: it was judged, or the estimate refused it.

use super::ScenarioError;
use serde::{Deserialize, Serialize};

/// A recording that the estimate refused: it is in none of the figures.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Refusal {
    /// Scenario.
    pub scenario: String,
    /// Seed of everything drawn.
    pub seed: u64,
    /// Why, in words.
    pub reason: String,
}

/// What was judged of one recording.
pub(super) trait Judged {
    /// Of which scenario, drawn with which seed.
    fn key(&self) -> (&str, u64);
}

/// A line of a study's file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub(super) enum Outcome<T> {
    Judged(Box<T>),
    Refused(Refusal),
}

impl<T: Judged> Outcome<T> {
    /// What came of one. A refusal is an outcome: one recording must not end a study of thousands.
    ///
    /// # Errors
    /// [`ScenarioError`] of what is no recording's: the scenario, the robot, the simulator.
    pub(super) fn of(judged: Result<T, ScenarioError>) -> Result<Self, ScenarioError> {
        match judged {
            Ok(judged) => Ok(Self::Judged(Box::new(judged))),
            Err(ScenarioError::Session {
                scenario,
                seed,
                error,
            }) => Ok(Self::Refused(Refusal {
                scenario,
                seed,
                reason: error.to_string(),
            })),
            Err(error) => Err(error),
        }
    }

    /// Of which scenario, drawn with which seed.
    pub(super) fn key(&self) -> (&str, u64) {
        match self {
            Self::Judged(judged) => judged.key(),
            Self::Refused(refusal) => (&refusal.scenario, refusal.seed),
        }
    }
}
