//! Outcome of a recording: assessed, or rejected by the estimator.

use super::ScenarioError;
use serde::{Deserialize, Serialize};

/// Recording rejected by the estimator and excluded from all figures.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RejectedRecording {
    /// Name of the scenario.
    pub scenario: String,
    /// Seed of all random draws.
    pub seed: u64,
    /// Reason, as text.
    pub reason: String,
}

/// Assessment of one recording.
pub(super) trait Assessment {
    /// Returns the scenario and the seed.
    fn key(&self) -> (&str, u64);
}

/// Line of a study's file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub(super) enum Outcome<T> {
    Assessed(Box<T>),
    Rejected(RejectedRecording),
}

impl<T: Assessment> Outcome<T> {
    /// Converts a result to an outcome. A rejected recording is an outcome, because it must not end a study of
    /// thousands.
    ///
    /// # Errors
    /// Returns a [`ScenarioError`] that does not concern a single recording: scenario, robot, simulator.
    pub(super) fn of(assessed: Result<T, ScenarioError>) -> Result<Self, ScenarioError> {
        match assessed {
            Ok(assessed) => Ok(Self::Assessed(Box::new(assessed))),
            Err(ScenarioError::Session {
                scenario,
                seed,
                error,
            }) => Ok(Self::Rejected(RejectedRecording {
                scenario,
                seed,
                reason: error.to_string(),
            })),
            Err(error) => Err(error),
        }
    }

    /// Returns the scenario and the seed.
    pub(super) fn key(&self) -> (&str, u64) {
        match self {
            Self::Assessed(assessed) => assessed.key(),
            Self::Rejected(rejected) => (&rejected.scenario, rejected.seed),
        }
    }
}
