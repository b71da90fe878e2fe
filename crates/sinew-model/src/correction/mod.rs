//! What a controller and a collision detector need once the ropes have stretched.
//!
//! ```text
//! theta     = theta_measured − delta_e                        motor position without the stretch
//! tau_el    = K x (1 + c x²),   x = theta − q                 torque the spring really carries
//! theta_set = q_d + x(tau_d) + delta_e                        motor position that puts the joint at q_d
//! tau_ext   ← momentum observer driven by tau_el              what touches the robot
//! ```
//!
//! With tendons that cross several joints the first three hold in the coordinate of each tendon: see [`Correction`] and [`SetPoint`].
//!
//! Uncorrected, a stretch of `delta_e` leaves the joint `delta_e` short of where it should be and
//! shows as a contact of `−K delta_e` that isn't there. Sinew never commands a robot: these are
//! numbers for a controller that does.
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
