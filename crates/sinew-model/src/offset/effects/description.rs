//! Descriptions of effects: name, equation, and parameters with their priors before any recording.

use super::{JointParameter, PER_JOINT};
use crate::Gaussian;
use crate::offset::joint_prior::JointPrior;
use crate::tolerances::Tolerances;

/// Standard deviation of a parameter that is held fixed, in its own unit.
pub(crate) const FIXED: f64 = 1e-9;

/// Description of a physical effect.
#[derive(Debug, Clone, Copy)]
pub struct Description {
    /// Heading of the effect on the page of the book.
    pub title: &'static str,
    /// Physical explanation of the effect, in complete sentences.
    pub text: &'static str,
    /// Terms of the effect in the sums of a joint's equations, one a line.
    pub equation: &'static str,
    /// Parameters that the effect adds to the state.
    pub parameters: &'static [Parameter],
}

/// Description of one parameter of an effect.
#[derive(Debug, Clone, Copy)]
pub struct Parameter {
    /// Name of the parameter in results and on the page of the book.
    pub name: &'static str,
    /// Symbol of the parameter in the equation of its effect.
    pub symbol: &'static str,
    /// SI unit of the parameter; empty for a ratio.
    pub unit: &'static str,
    /// Prior of the parameter in words, with the keys of `robot.toml` that set it.
    pub prior_text: &'static str,
    /// Origin of the prior's numbers: a definition, a data sheet, or engineering judgement.
    pub source: &'static str,
    /// Period over which a value of the parameter is constant.
    pub lifetime: Lifetime,
    /// Kind of parameters that is correlated between robots of one type; `None` if the parameter does not belong to a
    /// robot.
    pub kind: Option<Kind>,
    /// Index among a joint's parameters.
    pub(crate) place: usize,
    pub(crate) term: Term,
    /// Prior of a joint's parameter; `None`: the joint does not have the effect.
    pub(crate) prior: fn(&PriorInputs<'_>) -> Option<Gaussian>,
}

impl Parameter {
    /// A parameter that is not a joint's: it moves the joint's torque in every row.
    pub(crate) const CARRIED: Self = Self {
        name: "",
        symbol: "",
        unit: "",
        prior_text: "",
        source: ASSUMED,
        lifetime: Lifetime::Recording,
        kind: None,
        place: 0,
        term: Term::Carried,
        prior: |_| None,
    };

    /// Prior of a joint's parameter, with at least the standard deviation of a fixed parameter; `None`: the joint does
    /// not have the effect.
    pub(crate) fn prior_of(&self, inputs: &PriorInputs<'_>) -> Option<Gaussian> {
        let is_there = match JointParameter::is_of_joint(self.place) {
            true => inputs.joint.has_joint,
            false => inputs.joint.has_tendon,
        };
        let prior = (self.prior)(inputs).filter(|_| is_there)?;
        Some(Gaussian::new(prior.mean, prior.std.max(FIXED)))
    }
}

/// Source of a default value without measurement.
pub(crate) const ASSUMED: &str = "engineering judgement";

/// Inputs of the prior of a joint's parameter.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PriorInputs<'a> {
    pub(crate) joint: &'a JointPrior,
    pub(crate) tolerances: &'a Tolerances,
    /// Standard deviation of the offset, rad.
    pub(crate) offset_rad: f64,
}

/// Period over which the value of a parameter is constant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lifetime {
    /// One recording only.
    Recording,
    /// Until the rope is tensioned again.
    Tensioning,
    /// For days: it changes by a tenth of its prior's standard deviation a day, as friction does.
    Days,
    /// For months: it changes by a hundredth of its prior's standard deviation a day.
    Months,
}

impl Lifetime {
    /// Part of the prior's standard deviation that it changes by in a day; `None`: a day more does not count.
    #[must_use]
    pub const fn daily_share(self) -> Option<f64> {
        match self {
            Self::Recording | Self::Tensioning => None,
            Self::Days => Some(0.1),
            Self::Months => Some(0.01),
        }
    }
}

/// Kinds of parameters with one common correlation between robots of a type.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Masses, first moments and inertias of the links.
    Bodies,
    /// Stiffness, stiffening, and change of the stiffness with temperature.
    Stiffness,
    /// Friction of joints.
    Friction,
    /// Friction of drives.
    DriveFriction,
    /// Scale and zero of the motor's torque.
    MotorTorque,
    /// Errors of encoders and gears.
    Encoders,
    /// Drift of the zero with temperature.
    Drift,
    /// Viscoelastic share of the deflection.
    Viscoelasticity,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::Bodies,
        Self::Stiffness,
        Self::Friction,
        Self::DriveFriction,
        Self::MotorTorque,
        Self::Encoders,
        Self::Drift,
        Self::Viscoelasticity,
    ];
}

/// The sum of a joint's equations that a parameter is in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Term {
    JointTorque,
    Compliance,
    Deflection,
    Stiffening,
    DriveTorque,
    MotorScale,
    MotorBias,
    /// The joint torque, in separate columns in addition to those of the joint's parameters.
    Carried,
}

impl Term {
    /// Whether the equation of the link side depends on it.
    pub(crate) const fn is_of_link(self) -> bool {
        matches!(
            self,
            Self::JointTorque | Self::Compliance | Self::Deflection | Self::Stiffening
        )
    }

    /// Whether the equation of the motor side depends on it.
    pub(crate) const fn is_of_motor(self) -> bool {
        matches!(
            self,
            Self::JointTorque | Self::DriveTorque | Self::MotorScale | Self::MotorBias
        )
    }
}

/// A Gaussian with mean zero.
pub(crate) const fn about_zero(std: f64) -> Gaussian {
    Gaussian::new(0.0, std)
}

/// The parameters of a joint, in their order in the state. Fails to compile where one belongs to no effect or to two.
pub(super) const fn in_state_order(effects: &[Description]) -> [Parameter; PER_JOINT] {
    let mut out = [Parameter::CARRIED; PER_JOINT];
    let (mut found, mut effect) = (0, 0);
    while effect < effects.len() {
        let parameters = effects[effect].parameters;
        let mut k = 0;
        while k < parameters.len() {
            let Parameter { place, term, .. } = parameters[k];
            if !matches!(term, Term::Carried) {
                let is_free = matches!(out[place].term, Term::Carried);
                assert!(is_free, "a parameter belongs to two effects");
                out[place] = parameters[k];
                found += 1;
            }
            k += 1;
        }
        effect += 1;
    }
    assert!(found == PER_JOINT, "a parameter belongs to no effect");
    out
}
