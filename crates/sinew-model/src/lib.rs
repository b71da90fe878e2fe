//! Arm, transmission, momentum observer and tendon offset: the physics of a tendon-driven series-elastic robot,
//! without files, clocks or threads.
//!
//! ```text
//! M(q) ddq + C(q,dq) dq + g(q) + tau_friction_joint = tau_el + tau_ext
//! tau_el = K (theta − q),     theta_measured = theta + delta_e
//! ```
//!
//! An elongated tendon causes an offset `delta_e`; [`offset`] estimates it from encoders alone through the
//! momentum observer of [`observer`], for the arms of [`mod@arm`].
//!
//! Modules in reading order: [`mod@arm`], [`transmission`], [`observer`], [`offset`], [`feeder`] (samples in the order
//! of arrival), [`correction`] (compensation in a controller), [`tendons`] (several joints, motors and tendons
//! coupled), [`robot`],
//! [`transmission_map`] (couplings that other software describes).
//!
//! ```
//! # #[cfg(feature = "urdf")] fn main() -> Result<(), Box<dyn std::error::Error>> {
//! use sinew_model::offset::{OffsetConfig, OffsetObserver, Sample};
//! use sinew_model::robot::{BIOROB_LIKE, RobotFile};
//!
//! let robot = RobotFile::parse(BIOROB_LIKE.robot_toml, "robot.toml")?.build(BIOROB_LIKE.urdf)?;
//! let mut observer = OffsetObserver::new(&robot.arm, &robot.transmissions, OffsetConfig::default())?;
//!
//! // The arm hangs still; the elbow's rope has an offset of 10 mrad.
//! let (q, theta) = ([0.0; 4], [0.0, 0.0, 0.010, 0.0]);
//! for _ in 0..1000 {
//!     let sample = Sample { q: &q, theta_measured: &theta, ..Default::default() };
//!     observer.step(1e-3, &sample)?; // no allocation, lock or panic
//! }
//! assert!(observer.is_settled());
//! assert!((observer.delta_e()[2] - 0.010).abs() < 1e-12);
//! let tendon = robot.transmissions[2].as_ref().and_then(|t| t.tendon.as_ref()).unwrap();
//! assert!((tendon.elongation_m(observer.delta_e()[2]) - 0.25e-3).abs() < 1e-12);
//! # Ok(()) }
//! # #[cfg(not(feature = "urdf"))] fn main() {}
//! ```
//!
//! # Features
//! * `std`: links the standard library for `std::error::Error`; no other function depends on it.
//! * `urdf` (default, implies `std`): arms from URDF text, robots from `robot.toml` text.
//! * `wire`: blocks and robots as bytes, for a microcontroller and its host.
//! * `serde`: results as data; `schema`: their JSON Schema.
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
pub mod cholesky;
pub mod correction;
mod eigen;
pub mod feeder;
mod friction;
mod moment_arm;
pub mod observer;
pub mod offset;
#[cfg(feature = "urdf")]
pub mod robot;
pub mod sines;
pub mod statistics;
pub mod tendons;
pub mod tolerances;
pub mod transmission;
#[cfg(feature = "urdf")]
pub mod transmission_map;
pub mod vec3;
#[cfg(feature = "wire")]
pub mod wire;

mod error;
mod gaussian;
mod routing;
mod routings;
mod tile;
pub use error::StepError;
pub use gaussian::{Bounded, Gaussian, Interval95, QUANTILE_975, Z95};
