//! The protocol: named scenarios of three sessions, their variants, and the same for another robot.
//!
//! Reading order: [`Plan`] (a scenario: arm, motion, what is drawn), [`plan_named`], [`plan_adapted`].

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

/// Why there is no such plan.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// No scenario has that name.
    #[error("there is no scenario '{name}'; known are {known}")]
    Unknown {
        /// The name given.
        name: String,
        /// All names.
        known: String,
    },
    /// A scenario's text doesn't make a scenario.
    #[error("scenario {name}: {why}")]
    Text {
        /// The scenario.
        name: String,
        /// What is wrong.
        why: String,
    },
    /// The simulator refused.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
    /// The robot's description was refused.
    #[error(transparent)]
    Robot(#[from] Located),
}
