//! What became of a recording: it was judged, or the estimate refused it.

use super::{Recording, ScenarioError, Sessions, record};
use serde::{Deserialize, Serialize};
use sinew_sim::protocol::Plan;

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

/// A line of a study's file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub(super) enum Outcome {
    Judged(Box<Recording>),
    Refused(Refusal),
}

impl Outcome {
    /// Simulates and judges one. A refusal is an outcome: one recording must not end a study of thousands.
    ///
    /// # Errors
    /// [`ScenarioError`] of what is no recording's: the scenario, the robot, the simulator.
    pub(super) fn of(plan: &Plan, seed: u64, sessions: Sessions) -> Result<Self, ScenarioError> {
        match record(plan, seed, sessions) {
            Ok(recording) => Ok(Self::Judged(Box::new(recording))),
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
            Self::Judged(recording) => (&recording.scenario, recording.seed),
            Self::Refused(refusal) => (&refusal.scenario, refusal.seed),
        }
    }
}
