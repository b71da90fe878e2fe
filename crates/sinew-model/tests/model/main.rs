//! The model against closed forms, identities, references and itself, in one binary.
//!
//! `realtime.rs` beside this folder is a binary of its own: it counts allocations, for which it brings a
//! global allocator.

mod answers;
mod closed_forms;
mod contact;
mod correction;
mod coupled_correction;
mod coverage;
mod effects;
mod identities;
mod known_observer;
mod known_offsets;
mod lost_stiffness;
mod made_up_arm;
mod observer;
mod offset;
mod offset_state;
mod pendulum;
mod random;
mod random_tree;
mod reference_values;
mod regressor;
mod robot;
mod routing;
#[path = "../../../sinew-creep/tests/support/score.rs"]
mod score;
#[path = "../../../sinew-files/tests/support/skipped.rs"]
mod skipped;
mod spring_arms;
mod tendons;
mod urdf;
#[cfg(feature = "wire")]
mod wire;
