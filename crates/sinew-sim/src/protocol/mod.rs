//! The protocol: named scenarios of three sessions, their variants, and the same for another robot.
//!
//! Reading order: [`Plan`] (a scenario: arm, motion, random parameters), [`plan_named`], [`plan_adapted`].

mod adapted;
mod catalogue;
mod plan;
mod texts;
mod variants;

pub use catalogue::{DEFAULT, STANDARD, UNMODELLED, plan_adapted, plan_named};
pub use plan::Plan;
pub use texts::everything;
pub use variants::variants;

use crate::SimulateError;
use sinew_files::Located;

/// Errors of a plan.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// Unknown name of a scenario.
    #[error("unknown scenario '{name}'; available: {available}")]
    Unknown {
        /// The name given.
        name: String,
        /// Available names, separated by commas.
        available: String,
    },
    /// The text of the scenario is invalid.
    #[error("scenario {name}: {reason}")]
    Text {
        /// Name of the scenario.
        name: String,
        /// Reason of the error.
        reason: String,
    },
    /// The simulator returned an error.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
    /// The robot description is invalid.
    #[error(transparent)]
    Robot(#[from] Located),
}
