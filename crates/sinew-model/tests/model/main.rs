//! The model against closed forms, identities, references and itself, in one binary.
//!
//! `realtime.rs` next to this folder is a separate binary: it counts allocations and therefore has a
//! global allocator.

mod answers;
mod closed_forms;
mod contact;
mod correction;
mod coupled_correction;
mod coverage;
mod effects;
mod golden_observer;
mod golden_offsets;
mod identities;
mod lost_stiffness;
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
mod strands;
mod synthetic_arm;
mod tendons;
mod urdf;
#[cfg(feature = "wire")]
mod wire;
