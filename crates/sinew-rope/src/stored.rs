//! Stored state of a rope: versioned, separate from the type of the model.

use crate::law::State;
use serde::{Deserialize, Serialize};

/// Version of the file format.
const VERSION: u32 = 1;

/// Stored state of a rope, to continue later.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredState {
    /// Version of this record.
    pub version: u32,
    /// Bedding-in `b`, %.
    pub bedding_percent: f64,
    /// Delayed elasticity, %, for 10, 10² … 10⁵ s.
    pub delayed_percent: [f64; 5],
    /// Fibre flow, %.
    pub flow_percent: f64,
    /// Recoverable heat retraction, %.
    pub retraction_percent: f64,
    /// Permanent heat retraction, %.
    #[serde(default)]
    pub retraction_kept_percent: f64,
    /// Bending damage, 1 when spent.
    pub bending_damage: f64,
}

/// Error of a stored state.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StoredStateError {
    /// Written by a later program.
    #[error("the rope state has version {0}; this program reads version 1")]
    Version(u32),
    /// Numbers no rope can have.
    #[error("the rope state holds a number below 0 or not finite")]
    Impossible,
}

impl From<&State> for StoredState {
    fn from(s: &State) -> Self {
        Self {
            version: VERSION,
            bedding_percent: s.bedding_percent,
            delayed_percent: s.delayed_percent,
            flow_percent: s.flow_percent,
            retraction_percent: s.retraction_percent,
            retraction_kept_percent: s.retraction_kept_percent,
            bending_damage: s.bending_damage,
        }
    }
}

impl TryFrom<StoredState> for State {
    type Error = StoredStateError;

    fn try_from(s: StoredState) -> Result<Self, StoredStateError> {
        if s.version != VERSION {
            return Err(StoredStateError::Version(s.version));
        }
        let state = State {
            bedding_percent: s.bedding_percent,
            delayed_percent: s.delayed_percent,
            flow_percent: s.flow_percent,
            retraction_percent: s.retraction_percent,
            retraction_kept_percent: s.retraction_kept_percent,
            bending_damage: s.bending_damage,
        };
        if state.is_possible() {
            Ok(state)
        } else {
            Err(StoredStateError::Impossible)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stored_state_round_trip_is_exact() {
        let state = State {
            bedding_percent: 0.1 + 0.2,
            delayed_percent: [1e-300, 0.1, 1.0 / 3.0, 0.0, 2.5],
            flow_percent: 1e-12,
            retraction_percent: 0.0,
            retraction_kept_percent: 0.25,
            bending_damage: 0.4,
        };
        let text = serde_json::to_string(&StoredState::from(&state)).expect("json");
        let stored: StoredState = serde_json::from_str(&text).expect("json");
        assert_eq!(State::try_from(stored), Ok(state));
        let later = StoredState {
            version: 2,
            ..stored
        };
        assert_eq!(State::try_from(later), Err(StoredStateError::Version(2)));
        let odd = StoredState {
            bedding_percent: -1.0,
            ..stored
        };
        assert_eq!(State::try_from(odd), Err(StoredStateError::Impossible));
    }
}
