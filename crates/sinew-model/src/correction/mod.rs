//! Corrections for a controller and a collision detector after the ropes have elongated.
//!
//! ```text
//! theta     = theta_measured − delta_e                        motor position without the offset tau_el    = K x (1 + c
//! x²),   x = theta − q                 actual torque of the spring theta_set = q_d + x(tau_d) + delta_e
//! motor position for the joint position q_d tau_ext   ← momentum observer driven by tau_el              external
//! torque on the robot
//! ```
//!
//! With tendons that cross several joints the first three hold in the coordinate of each tendon: see [`Correction`] and [`SetPoint`].
//!
//! Without correction, an offset of `delta_e` causes a joint position error of `delta_e` and appears as a false contact
//! of `−K delta_e`. Sinew never commands a robot: it provides these numbers to a controller.
//!
//! Reading order: [`Spring`], [`Correction`] (motor position and torque), [`SetPoint`],
//! [`ExternalTorqueObserver`] and its [`ContactTolerances`], [`ContactDetector`].

mod contact;
mod error;
mod external;
mod set_point;
mod spring;
mod tolerances;
mod transmission;

pub use contact::{ContactConfig, ContactDetector};
pub use error::CorrectionError;
pub use external::{ExternalTorqueConfig, ExternalTorqueObserver};
pub use set_point::SetPoint;
pub use spring::Spring;
pub use tolerances::ContactTolerances;
pub use transmission::{Correction, JointCorrection};
