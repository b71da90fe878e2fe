//! How the estimates are made, and what they can't be made from.

use crate::observer::GainError;

/// Where the elastic torque comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum TorqueSource {
    /// Link-side momentum observer: needs masses, no torque sensor.
    #[default]
    Observer,
    /// Measured joint torque `tau_el`.
    TorqueSensor,
    /// Motor-side momentum, eq. (2): needs `tau_m`, reflected inertia and motor friction. Never
    /// the default, because motor friction hides the elastic torque when the arm stands still.
    Motor,
}

/// Whether `theta − q` lags like the torque it is compared with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Comparison {
    /// `theta` and `q` go through the same filters as the observed torque: motion cancels.
    #[default]
    Matched,
    /// The paper's: `theta − q` as measured against the torque as the source has it. An observed torque lags, so that
    /// motion shows up; a measured one does not, and nothing is filtered.
    Paper,
}

/// Where joint velocities come from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum VelocityFilter {
    /// A [`StateVariableFilter`](crate::observer::StateVariableFilter) of this cut-off on every position (and torque) that enters.
    /// Not on a measured torque in the paper's comparison.
    StateVariable {
        /// `ω`, rad/s.
        cutoff_rad_per_s: f64,
    },
    /// Velocities of the recording, positions unfiltered.
    Recorded,
}

/// How offsets are estimated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OffsetConfig {
    /// Where `tau_el` comes from.
    pub source: TorqueSource,
    /// Lag treatment.
    pub comparison: Comparison,
    /// Observer gain `K_I`, 1/s.
    pub gain_per_s: f64,
    /// Where velocities come from.
    pub velocity: VelocityFilter,
}

impl Default for OffsetConfig {
    /// Observer, matched, `K_I` = 20 1/s, filter at 40 rad/s: the middle of what serves 12–14 bit
    /// encoders.
    fn default() -> Self {
        Self {
            source: TorqueSource::Observer,
            comparison: Comparison::Matched,
            gain_per_s: 20.0,
            velocity: VelocityFilter::StateVariable {
                cutoff_rad_per_s: 40.0,
            },
        }
    }
}

/// Why an estimator could not be built.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OffsetConfigError {
    /// One transmission per joint is needed.
    #[error("{found} transmissions for an arm of {expected} joints")]
    Length {
        /// Joints of the arm.
        expected: usize,
        /// Transmissions given.
        found: usize,
    },
    /// A gain nobody can use.
    #[error(transparent)]
    Gain(#[from] GainError),
    /// A cut-off nobody can use.
    #[error("velocity filter at {cutoff_rad_per_s} rad/s; it must be above 0 and at most 1e6")]
    VelocityFilter {
        /// Cut-off given, rad/s.
        cutoff_rad_per_s: f64,
    },
    /// A stiffness nobody can build.
    #[error(
        "stiffness of joint {joint} is {stiffness_nm_per_rad} N·m/rad; it must be finite and above 0"
    )]
    Stiffness {
        /// Index of the joint.
        joint: usize,
        /// Stiffness given, N·m/rad.
        stiffness_nm_per_rad: f64,
    },
    /// The motor source without a motor inertia.
    #[error("joint {joint} has no motor inertia, which the motor source needs")]
    MotorInertia {
        /// Index of the joint.
        joint: usize,
    },
    /// The motor source needs motor velocities, which only the filter gives.
    #[error(
        "the motor source needs the velocity filter: recorded velocities are the joint's, not the motor's"
    )]
    MotorVelocity,
}

/// How features are made.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct FeatureConfig {
    /// Pole of the matched low-pass, 1/s.
    pub gain_per_s: f64,
    /// Velocity filter, rad/s.
    pub cutoff_rad_per_s: f64,
    /// Regressors are computed at most this often, s: the filtered positions are smooth.
    pub regressor_step_s: f64,
    /// Length of a block, s.
    pub block_s: f64,
    /// Stroke over which joint friction builds up, rad (pre-sliding).
    pub presliding_rad: f64,
}

impl FeatureConfig {
    /// How much later than a step itself its features are half way, s: `ln 2 / K_I` of the low-pass, `2 / ω` of the
    /// velocity filter.
    pub fn delay_s(&self) -> f64 {
        core::f64::consts::LN_2 / self.gain_per_s + 2.0 / self.cutoff_rad_per_s
    }
}

impl Default for FeatureConfig {
    fn default() -> Self {
        Self {
            gain_per_s: 3.0,
            cutoff_rad_per_s: 60.0,
            regressor_step_s: 12e-3,
            block_s: 0.2,
            presliding_rad: 1e-3,
        }
    }
}
