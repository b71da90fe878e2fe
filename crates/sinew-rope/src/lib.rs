//! Selection of a rope: the catalogue, the response of a rope to a duty, the choice of a rope, its
//! preconditioning.
//!
//! Every result has a 95 % interval from seeded draws of the rope's parameters ([`draws`]); where those are
//! assumed, the interval is wide, and the result reports it.
//!
//! Reading order: [`law`] (strain of a rope under tension), [`catalogue`], [`draws`], [`duty`], [`history`],
//! [`predict`], [`endurance`], [`life`], [`select`], [`pretension`], [`thermal`], [`survival`] (ages at which
//! ropes broke); [`task`] builds requests from the specified values.

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
mod predict_error;
mod prediction;
pub mod pretension;
mod procedure;
mod route;
mod schedule;
pub mod select;
pub mod stored;
mod strand;
pub mod survival;
pub mod task;
pub mod thermal;
mod times;
pub mod work;

pub use catalogue::{Catalogue, CatalogueError, CatalogueRope, Namesake, UnreadableRope};
pub use caution::Caution;
pub use describe::{CatalogueValue, Published, RopeDescription, RopeList, RopeSummary};
pub use draws::Draws;
pub use duty::{Duty, Stretch};
pub use endurance::RopeTermination;
pub use life::{BreakCause, DamageSite, Place, RopeLifetime};
