//! Arm, transmission, momentum observer and tendon offset: what is true of a tendon-driven
//! series-elastic robot, without files, clocks or threads.
//!
//! ```text
//! M(q) ddq + C(q,dq) dq + g(q) + tau_friction_joint = tau_el + tau_ext
//! tau_el = K (theta − q),     theta_measured = theta + delta_e
//! ```
//!
//! A stretched tendon shows as `delta_e`; [`offset`] recovers it from encoders alone through the
//! momentum observer of [`observer`], for the arms of [`mod@arm`].
//!
//! Modules in reading order: [`mod@arm`], [`transmission`], [`observer`], [`offset`], [`robot`].
//!
//! # Features
//! * `std`: nothing but `std::error::Error` being where std users look for it.
//! * `urdf` (default, implies `std`): arms from URDF text, robots from `robot.toml` text.
//!
//! Without features the crate is `no_std` with `alloc`. Storage is sized at construction; no
//! step allocates, locks, logs, reads a clock or panics.
//!
//! # Source
//! J. Kirchhoff and O. von Stryk, *New Insights in Synthetic Fiber Rope Elongation and its
//! Detection for Ultra Lightweight Tendon Driven Series Elastic Robots*, IROS 2018 ("the paper").

#![cfg_attr(not(feature = "std"), no_std)]

extern crate alloc;

pub mod arm;
pub mod observer;
pub mod offset;
#[cfg(feature = "urdf")]
pub mod robot;
pub mod transmission;
pub mod vec3;

mod error;
pub use error::StepError;
