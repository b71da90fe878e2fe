//! Tendons between several motors and several joints: coupled arms, differentials, antagonists, fingers.
//!
//! For `n` joints `q`, `m` motors `theta` and `T` tendons:
//!
//! ```text
//! l_i(q) = Σ_j l_ij(q_j)                     shortening of the path, 0 at q = 0;   R_ij = ∂l_i/∂q_j   moment arm
//! x = S theta − delta − l(q)                 extension;   S_ik   rope that one rad of motor k takes in
//! f = k x (loop),  f = max(0, f0 + k x) (strand)
//! tau_el = R(q)ᵀ f,  tau_motor = Sᵀ f
//! M ddq + C dq + g + tau_friction = tau_el − tau_spring + tau_ext,   tau_spring = k_s (q − q_rest)
//! ```
//!
//! `delta_i > 0`: the tendon is longer. `R_ij > 0`: tension drives joint `j` positively. Moment arms and drums follow from one elastic
//! energy `V`: `tau_el = −∂V/∂q`, `tau_motor = ∂V/∂theta`. Matrices are row-major; `R` is `T × n`, `S` is `T × m`.
//!
//! A [`CouplingDescription`] becomes a [`Coupling`], which never changes; a [`CouplingState`] owns everything that depends on
//! positions. [`Coupling::evaluate`], [`Coupling::jacobian`] and [`Coupling::joint_stiffness`] neither allocate nor panic.
//!
//! Assumes that the moment arm of a tendon at one joint does not depend on other joints, that stiffness is constant while a tendon is
//! taut, and that ropes run without friction.
//!
//! ```
//! use sinew_model::tendons::*;
//!
//! // The elbow's rope runs over a pulley of the shoulder.
//! let joint = |name: &str| JointDescription { name: name.into(), ..Default::default() };
//! let tendon = |name: &str, k: f64, arms: &[(&str, f64)]| TendonDescription {
//!     name: name.into(),
//!     kind: TendonKind::Loop,
//!     coordinate: Coordinate::Metres,
//!     drums: vec![(name.into(), 0.020)],
//!     moment_arms: arms.iter().map(|(j, r)| (j.to_string(), MomentArm::Constant(*r))).collect(),
//!     stiffness: k,
//!     pretension: None,
//! };
//! let coupling = Coupling::new(CouplingDescription {
//!     joints: vec![joint("shoulder"), joint("elbow")],
//!     motors: vec!["shoulder".into(), "elbow".into()],
//!     tendons: vec![
//!         tendon("shoulder", 64e3, &[("shoulder", 0.020)]),
//!         tendon("elbow", 50e3, &[("shoulder", 0.010), ("elbow", 0.020)]),
//!     ],
//! })?;
//! let mut state = CouplingState::new(&coupling);
//! // The elbow's rope is 0.4 mm longer: the elbow stays 20 mrad behind its motor.
//! coupling.evaluate(&mut state, &[0.0, 0.020], &[0.0, 0.0], &[0.0, 0.4e-3])?;
//! assert!(state.tau_el().iter().all(|tau| tau.abs() < 1e-12));
//! let group = &coupling.groups()[0];
//! let offset = coupling.joint_offset(&state, group, &[0.0, 0.4e-3])?;
//! assert!(offset[0].abs() < 1e-12 && (offset[1] - 0.020).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Source
//! Virtual work, `tau_elᵀ dq = fᵀ dl`: R. M. Murray, Z. Li and S. S. Sastry, *A Mathematical Introduction to Robotic
//! Manipulation*, section 6.4.

mod analysis;
mod coupling;
mod description;
mod error;
mod pairing;
mod state;

pub use crate::moment_arm::{JointSpring, MomentArm, ShorteningTable, TableError, TendonKind};
pub use crate::routing::{Pull, PulledJoint, Routing};
pub use crate::routings::{PulledAxis, PulledGroup, Routings};
pub use analysis::{Equations, Group, JointEquationsReason, MAX_CONDITION, Observability, Sensors};
pub use coupling::Coupling;
pub use description::{Coordinate, CouplingDescription, JointDescription, TendonDescription};
pub use error::{CouplingError, EvaluationError};
pub use pairing::{PairedTendon, PairingError};
pub use state::{CouplingState, Input, Output, TendonStatus};
