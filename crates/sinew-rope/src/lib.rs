//! Choosing a rope: the catalogue, what a duty does to a rope, which rope to take, how to bed it
//! in.
//!
//! Every answer comes with a 95 % interval from seeded draws of the rope's parameters
//! ([`draws`]); where those are starting guesses the interval is wide, and the result says so.
//!
//! Reading order: [`law`] (strain of a rope under tension), [`catalogue`], [`draws`], [`duty`], [`history`], [`predict`],
//! [`endurance`], [`life`], [`select`], [`pretension`], [`warmth`], [`survival`] (ages at which ropes broke); [`task`] puts requests together from what is stated.

pub mod bench;
mod blocks;
pub mod catalogue;
mod caution;
mod describe;
mod drawn;
pub mod draws;
pub mod duty;
pub mod endurance;
pub mod history;
pub mod law;
pub mod life;
mod limits;
pub mod predict;
mod prediction;
pub mod pretension;
mod procedure;
mod refusal;
mod route;
mod schedule;
pub mod select;
pub mod stored;
mod strand;
pub mod survival;
pub mod task;
mod times;
pub mod warmth;
pub mod work;

pub use catalogue::{Catalogue, CatalogueError, CatalogueRope, Namesake};
pub use caution::Caution;
pub use describe::{CatalogueValue, Published, RopeDescription, RopeList, RopeSummary};
pub use draws::Draws;
pub use duty::{Duty, Stretch};
pub use endurance::Ends;
pub use life::{BreakCause, Life, Place, Spot};
