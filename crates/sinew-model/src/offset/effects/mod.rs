//! The physical effects that the equations of a joint consist of, one file each.
//!
//! With every signal averaged over a block after the low-pass, the link side and the motor side of an elastic joint obey
//!
//! ```text
//! x + η x³ = (1 + Σ compliance) τ / K
//! u = (1 + Σ motor scale)(τ + J ddtheta + Σ drive torque) + Σ motor bias
//! x = theta_measured − q − Σ deflection,     τ = Σ joint torque,     η = Σ stiffening
//! ```
//!
//! An effect adds its terms to these sums, and their derivatives with respect to each of its parameters. The joint
//! torques of links, payload and external force have separate columns in addition to those of the joint's parameters.
//!
//! A new effect is a file with a type that implements `Effect`, its parameters in [`JointParameter`], and a line in the
//! list below. State, priors, ageing, rows of the equations and the page of the book follow from that.

pub(crate) mod bodies;
mod description;
mod drive_friction;
mod encoder;
mod encoder_zero;
#[cfg(test)]
mod example;
pub(crate) mod external_force;
mod gear;
pub(crate) mod initial_friction;
mod joint_friction;
pub(crate) mod joint_spring;
pub(crate) mod moment_arm;
mod motor_torque;
mod offset;
pub(crate) mod payload;
mod point;
mod slack;
mod spring;
mod stiffening;
pub(crate) mod tension_sensor;
pub(crate) mod thermal;
mod viscoelastic;

pub use description::{Description, Kind, Lifetime, Parameter};
pub(crate) use description::{FIXED, PriorInputs, Term, about_zero};
pub(crate) use external_force::FORCE;
pub(crate) use payload::PAYLOAD;
pub(crate) use point::{Drive, JointRow, Measured, Point, Sum, total};

/// Number of amplitudes of a joint's encoder error: sine and cosine of the first and second harmonic.
pub(crate) const ENCODER: usize = 4;

/// A joint's parameters, in their order in the state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(usize)]
pub enum JointParameter {
    /// Offset `delta_e`, rad.
    Offset,
    /// Compliance over nominal, less one.
    Compliance,
    /// Cubic stiffening `η`, 1/rad².
    Stiffening,
    /// Coulomb friction of the joint, N·m.
    Coulomb,
    /// Viscous friction of the joint, N·m·s/rad.
    Viscous,
    /// Torque-proportional friction of the joint.
    LoadFriction,
    /// Drift of the zero with temperature, rad/K.
    Drift,
    /// Compliance change with temperature, 1/K.
    Thermal,
    /// First of the sine and cosine amplitudes of the first and second harmonic of the encoder error, rad.
    Encoder,
    /// Scale error of the motor torque.
    MotorScale = Self::Encoder as usize + ENCODER,
    /// Offset of the motor torque, N·m.
    MotorBias,
    /// Coulomb friction of the drive, N·m.
    MotorCoulomb,
    /// Viscous friction of the drive, N·m·s/rad.
    MotorViscous,
    /// Torque-proportional friction of the drive.
    MotorLoadFriction,
    /// Half the dead zone of a slack antagonistic pair, rad.
    Slack,
    /// Friction of a joint at the start of the recording, −1 to 1 of its Coulomb friction.
    InitialFriction,
    /// Share of the deflection that follows with a memory of half a minute.
    Viscoelastic,
    /// Error of the gear ratio, relative.
    Gear,
    /// Value of `theta_measured − q` of an unloaded spring directly after tensioning, rad: the encoder zero offset.
    Zero,
}

impl JointParameter {
    /// Whether it belongs to the joint of an axis; otherwise to the tendon or its motor.
    pub(crate) const fn is_of_joint(place: usize) -> bool {
        place == Self::Coulomb as usize
            || place == Self::Viscous as usize
            || place == Self::LoadFriction as usize
            || place == Self::InitialFriction as usize
            || (place >= Self::Encoder as usize && place < Self::Encoder as usize + ENCODER)
    }
}

/// Entries per joint.
pub(crate) const PER_JOINT: usize = JointParameter::Zero as usize + 1;

/// A physical effect: its description, and its terms in the sums of a joint's equations at a state.
///
/// A term is zero unless the effect implements it. Every function adds to a [`Sum`] the term's value and its derivative
/// with respect to each parameter of the effect. Derivatives with respect to parameters of other effects are neglected.
///
/// # Realtime
/// No allocation, lock, panic or clock.
pub(crate) trait Effect {
    /// Name, equation and parameters of the effect.
    const DESCRIPTION: Description;

    /// Torque that bends the spring, N·m.
    #[inline]
    fn joint_torque(_: &Point<'_>, _: &mut Sum<'_>) {}

    /// Compliance relative to nominal, in addition to 1.
    #[inline]
    fn compliance(_: &Point<'_>, _: &mut Sum<'_>) {}

    /// Part of `theta_measured − q` that is no deflection of the spring, rad.
    ///
    /// * `linear_rad`: deflection of the spring without stiffening.
    #[inline]
    fn deflection(_: &Point<'_>, _linear_rad: f64, _: &mut Sum<'_>) {}

    /// Cubic stiffening, 1/rad².
    #[inline]
    fn stiffening(_: &Point<'_>, _: &mut Sum<'_>) {}

    /// Torque that the motor provides in addition to that of the spring and of its inertia, N·m.
    #[inline]
    fn drive_torque(_: &Point<'_>, _: &Drive, _: &mut Sum<'_>) {}

    /// Recorded motor torque relative to the true one, in addition to 1.
    #[inline]
    fn motor_scale(_: &Point<'_>, _: &mut Sum<'_>) {}

    /// Recorded motor torque where the true one is zero, N·m.
    #[inline]
    fn motor_bias(_: &Point<'_>, _: &mut Sum<'_>) {}

    /// Standard deviation of an unknown joint torque in addition to the noise, N·m.
    #[inline]
    fn unknown_torque(_: &Point<'_>) -> f64 {
        0.0
    }

    /// Standard deviation of an unknown drive torque in addition to the noise, N·m.
    #[inline]
    fn unknown_drive_torque(_: &Point<'_>, _: &Drive) -> f64 {
        0.0
    }
}

/// Makes of a list of effects their sum, which is an effect, too, and the table of all descriptions.
macro_rules! effects {
    ($($effect:ty),+ $(,)?) => {
        /// Every effect that the estimate models.
        pub const ALL: &[Description] = &[$(<$effect as Effect>::DESCRIPTION),+];

        /// The sum of all effects.
        pub(crate) struct AllEffects;

        impl Effect for AllEffects {
            const DESCRIPTION: Description = Description {
                title: "All effects",
                text: "",
                equation: "",
                parameters: &[],
            };

            #[inline]
            fn joint_torque(point: &Point<'_>, sum: &mut Sum<'_>) {
                $(<$effect>::joint_torque(point, sum);)+
            }

            #[inline]
            fn compliance(point: &Point<'_>, sum: &mut Sum<'_>) {
                $(<$effect>::compliance(point, sum);)+
            }

            #[inline]
            fn deflection(point: &Point<'_>, linear_rad: f64, sum: &mut Sum<'_>) {
                $(<$effect>::deflection(point, linear_rad, sum);)+
            }

            #[inline]
            fn stiffening(point: &Point<'_>, sum: &mut Sum<'_>) {
                $(<$effect>::stiffening(point, sum);)+
            }

            #[inline]
            fn drive_torque(point: &Point<'_>, drive: &Drive, sum: &mut Sum<'_>) {
                $(<$effect>::drive_torque(point, drive, sum);)+
            }

            #[inline]
            fn motor_scale(point: &Point<'_>, sum: &mut Sum<'_>) {
                $(<$effect>::motor_scale(point, sum);)+
            }

            #[inline]
            fn motor_bias(point: &Point<'_>, sum: &mut Sum<'_>) {
                $(<$effect>::motor_bias(point, sum);)+
            }

            #[inline]
            fn unknown_torque(point: &Point<'_>) -> f64 {
                0.0 $(+ <$effect>::unknown_torque(point))+
            }

            #[inline]
            fn unknown_drive_torque(point: &Point<'_>, drive: &Drive) -> f64 {
                0.0 $(+ <$effect>::unknown_drive_torque(point, drive))+
            }
        }
    };
}

// In the order of the page, which is that in which terms are added up.
effects![
    offset::Offset,
    encoder_zero::EncoderZero,
    spring::Spring,
    stiffening::Stiffening,
    viscoelastic::Viscoelastic,
    gear::Gear,
    thermal::Thermal,
    slack::Slack,
    encoder::Encoder,
    moment_arm::MomentArm,
    joint_spring::JointSpring,
    tension_sensor::TensionSensor,
    initial_friction::InitialFriction,
    joint_friction::JointFriction,
    bodies::Bodies,
    payload::HeldPayload,
    external_force::AppliedForce,
    motor_torque::MotorTorque,
    drive_friction::DriveFriction,
];

/// The parameters of a joint, in their order in the state.
pub(crate) const JOINT_PARAMETERS: [Parameter; PER_JOINT] = description::in_state_order(ALL);

/// The sum that each parameter of a joint is in.
const TERMS: [Term; PER_JOINT] = {
    let mut terms = [Term::Carried; PER_JOINT];
    let mut k = 0;
    while k < PER_JOINT {
        terms[k] = JOINT_PARAMETERS[k].term;
        k += 1;
    }
    terms
};

/// Indices and number of the joint parameters that enter exactly the selected equations: link equation, motor
/// equation, or both.
pub(crate) const fn entries(link: bool, motor: bool) -> ([usize; PER_JOINT], usize) {
    let (mut places, mut count, mut k) = ([0; PER_JOINT], 0, 0);
    while k < PER_JOINT {
        if TERMS[k].is_of_link() == link && TERMS[k].is_of_motor() == motor {
            places[count] = k;
            count += 1;
        }
        k += 1;
    }
    (places, count)
}

/// How the expected measurement of an equation moves with each of the sums.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Factors {
    pub(crate) joint_torque: f64,
    pub(crate) compliance: f64,
    pub(crate) deflection: f64,
    pub(crate) stiffening: f64,
    pub(crate) drive_torque: f64,
    pub(crate) motor_scale: f64,
    pub(crate) motor_bias: f64,
}

impl Factors {
    /// How it moves with a joint's parameters, from the derivatives of the sums.
    #[inline]
    pub(crate) fn row(&self, derivatives: &JointRow) -> JointRow {
        core::array::from_fn(|k| {
            let factor = match TERMS[k] {
                Term::JointTorque => self.joint_torque,
                Term::Compliance => self.compliance,
                Term::Deflection => self.deflection,
                Term::Stiffening => self.stiffening,
                Term::DriveTorque => self.drive_torque,
                Term::MotorScale => self.motor_scale,
                Term::MotorBias => self.motor_bias,
                Term::Carried => 0.0,
            };
            factor * derivatives[k]
        })
    }
}
