//! What stands between a motor and its joint: spring, reflected inertia, friction, tendon.

use crate::Gaussian;
use crate::routing::Routing;
use alloc::string::String;
use alloc::vec::Vec;

/// Coulomb and viscous friction, `tau_friction = coulomb · sat(dq/dq_s) + viscous · dq`.
///
/// `sat` rises linearly to ±1 at the speed `dq_s` = [`Friction::SMOOTHING_RAD_PER_S`], because a
/// sign function of a measured speed would chatter between ±coulomb in every pause.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Friction {
    /// Coulomb friction, N·m (N), at least 0.
    pub coulomb_nm: f64,
    /// Viscous friction, N·m·s/rad (N·s/m), at least 0.
    pub viscous_nm_s_per_rad: f64,
}

impl Friction {
    /// Speed at which Coulomb friction is fully there, rad/s: well above the speed noise of a
    /// filtered 13-bit encoder (about 0.005 rad/s), well below working speeds.
    pub const SMOOTHING_RAD_PER_S: f64 = 0.02;

    /// Coulomb friction of a joint over its stiffness where none is stated, rad: that of the BioRob-like
    /// arm, a starting guess that may be wrong by all of itself.
    pub const GUESSED_OF_JOINT_RAD: f64 = 2e-3;
    /// The same of a drive, seen from the joint.
    pub const GUESSED_OF_DRIVE_RAD: f64 = 1e-2;

    /// What is stated, or where nothing is a guess: Coulomb friction by the stiffness, and 0.6 of it at a
    /// rad per second.
    #[must_use]
    pub fn or_guessed(self, stiffness_nm_per_rad: f64, over_stiffness_rad: f64) -> Self {
        const VISCOUS_S_PER_RAD: f64 = 0.6;
        if self.is_stated() {
            return self;
        }
        let coulomb_nm = over_stiffness_rad * stiffness_nm_per_rad;
        Self {
            coulomb_nm,
            viscous_nm_s_per_rad: VISCOUS_S_PER_RAD * coulomb_nm,
        }
    }

    /// Whether there is any: no joint is without, so that none means that nobody said.
    pub fn is_stated(&self) -> bool {
        self.coulomb_nm > 0.0 || self.viscous_nm_s_per_rad > 0.0
    }

    /// Friction torque at speed `dq`, N·m, positive when it brakes positive motion.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    #[inline]
    pub fn torque(&self, dq: f64) -> f64 {
        self.coulomb_nm * (dq / Self::SMOOTHING_RAD_PER_S).clamp(-1.0, 1.0)
            + self.viscous_nm_s_per_rad * dq
    }
}

/// A guiding pulley the rope runs over.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Guide {
    /// Radius, m.
    pub radius_m: f64,
    /// Wrap angle, rad.
    pub wrap_rad: f64,
    /// Coefficient of friction of the capstan law.
    pub friction: f64,
}

/// The rope that moves a joint.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Tendon {
    /// Catalogue name of the rope, where it is known.
    pub rope: Option<String>,
    /// Free length `L`, m.
    pub length_m: f64,
    /// Radius `r` of the pulley at the joint, m.
    pub joint_pulley_radius_m: f64,
    /// Pretension, N.
    pub pretension_n: Option<f64>,
    /// Whether a second rope pulls the other way: stretched ropes are a dead zone then.
    pub antagonistic: bool,
    /// Guiding pulleys from motor to joint.
    pub guides: Vec<Guide>,
    /// Elongation at which the owner wants to tension again, m.
    pub retension_at_m: Option<f64>,
    /// Strain at which the owner wants to replace the rope, as a fraction.
    pub replace_at_strain: Option<f64>,
    /// Thermal expansion of the frame along the rope's path, 1/K, where it is stated.
    pub frame_expansion_per_k: Option<f64>,
}

/// What warmth does to the offset of a tendon, by its rope, its frame and its routing.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct TendonWarmth {
    /// `α_T`: offset per kelvin, rad/K: `(α_rope − α_frame) L/r`.
    pub drift_rad_per_k: Gaussian,
    /// By how much the rope's full heat retraction shortens the offset, rad; 0 without one.
    pub retraction_rad: Gaussian,
}

impl Tendon {
    /// Elongation `ΔL = r · delta_e`, m.
    pub fn elongation_m(&self, delta_e: f64) -> f64 {
        self.joint_pulley_radius_m * delta_e
    }

    /// Strain `ε = ΔL / L` as a fraction.
    pub fn strain(&self, delta_e: f64) -> f64 {
        self.elongation_m(delta_e) / self.length_m
    }
}

/// Elastic transmission of one joint: `tau_el = K (theta − q)`.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Transmission {
    /// Stiffness `K`, N·m/rad (N/m), above 0.
    pub stiffness_nm_per_rad: f64,
    /// Motor inertia reflected to the joint, kg·m² (kg); `None` where the file gives none.
    pub motor_inertia_kg_m2: Option<f64>,
    /// Friction at the joint.
    pub joint_friction: Friction,
    /// Friction of motor and gear, reflected to the joint.
    pub motor_friction: Friction,
    /// The rope, where the file describes it.
    pub tendon: Option<Tendon>,
    /// What warmth does to the offset, where somebody has looked it up; `None`: 0 ± the tolerance.
    pub warmth: Option<TendonWarmth>,
    /// Where joint or motor is known to stand: end stops and marks.
    pub anchors: Vec<Anchor>,
    /// Routing of the tendon where it crosses other joints, has a name of its own, or is driven with a ratio. `None`: the tendon has
    /// the name of its joint, crosses no other one, and `theta` is reflected to it.
    pub routing: Option<Routing>,
}

/// What an anchor is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum AnchorKind {
    /// An end stop that the joint is pushed against.
    Stop,
    /// A mark that the joint passes.
    JointMark,
    /// A mark that the motor passes.
    MotorMark,
}

impl AnchorKind {
    /// Whether it is passed when its owner says so; stops are found by themselves.
    pub fn is_mark(self) -> bool {
        matches!(self, Self::JointMark | Self::MotorMark)
    }
}

/// A place where a joint or its motor is known to stand.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Anchor {
    /// What it is.
    pub kind: AnchorKind,
    /// Where it is: joint position, or motor position as seen from the joint, rad (m).
    pub position_rad: f64,
    /// How well it comes back there, one standard deviation, rad (m).
    pub deviation_rad: f64,
}

impl Transmission {
    /// A bare spring.
    pub fn spring(stiffness_nm_per_rad: f64) -> Self {
        Self {
            stiffness_nm_per_rad,
            motor_inertia_kg_m2: None,
            joint_friction: Friction::default(),
            motor_friction: Friction::default(),
            tendon: None,
            warmth: None,
            anchors: Vec::new(),
            routing: None,
        }
    }
}
