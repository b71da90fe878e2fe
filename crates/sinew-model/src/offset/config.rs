//! Configuration of the estimates, and errors of invalid configurations.

use crate::observer::GainError;

/// Source of the elastic torque.
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
    /// Motor-side momentum, eq. (2): needs `tau_m`, reflected inertia and motor friction. Not the default, because
    /// motor friction masks the elastic torque while the arm is at rest.
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
    /// The paper's: `theta − q` as measured against the torque of the source. An observed torque is delayed, so that
    /// motion causes errors; a measured one is not, and no signal is filtered.
    Paper,
}

/// Source of joint velocities.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum VelocityFilter {
    /// A [`StateVariableFilter`](crate::observer::StateVariableFilter) of this cut-off on every position (and torque) that enters.
    /// Not on a measured torque in the paper's comparison.
    StateVariable {
        /// Cut-off frequency `ω`, rad/s.
        cutoff_rad_per_s: f64,
    },
    /// Velocities of the recording, positions unfiltered.
    Recorded,
}

/// How offsets are estimated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OffsetConfig {
    /// Source of `tau_el`.
    pub source: TorqueSource,
    /// Treatment of the observer's lag.
    pub comparison: Comparison,
    /// Observer gain `K_I`, 1/s.
    pub gain_per_s: f64,
    /// Source of joint velocities.
    pub velocity: VelocityFilter,
}

impl Default for OffsetConfig {
    /// Observer, matched, `K_I` = 20 1/s, filter at 40 rad/s: suitable for encoders of 12 to 14 bits.
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

/// Reason why an estimator could not be created.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OffsetConfigError {
    /// One transmission per joint is needed.
    #[error("{found} transmissions for an arm of {expected} joints")]
    Length {
        /// Joints of the arm.
        expected: usize,
        /// Number of transmissions passed.
        found: usize,
    },
    /// Observer gain outside the permitted range.
    #[error(transparent)]
    Gain(#[from] GainError),
    /// Filter cut-off outside the permitted range.
    #[error("velocity filter at {cutoff_rad_per_s} rad/s; it must be above 0 and at most 1e6")]
    VelocityFilter {
        /// Cut-off given, rad/s.
        cutoff_rad_per_s: f64,
    },
    /// Stiffness outside the permitted range.
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
    /// Delay at which the features reach half of a step, s: `ln 2 / K_I` of the low-pass, `2 / ω` of the
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
