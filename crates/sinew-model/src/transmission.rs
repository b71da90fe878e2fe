//! Transmission between a motor and its joint: spring, reflected inertia, friction, tendon.

use crate::Gaussian;
pub use crate::friction::Friction;
use crate::routing::Routing;
use alloc::string::String;
use alloc::vec::Vec;

/// A guiding pulley the rope runs over.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Guide {
    /// Radius of the pulley, m.
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
    /// Catalogue name of the rope, if it is specified.
    pub rope: Option<String>,
    /// Free length `L`, m.
    pub length_m: f64,
    /// Radius `r` of the pulley at the joint, m.
    pub joint_pulley_radius_m: f64,
    /// Pretension of the rope, N.
    pub pretension_n: Option<f64>,
    /// Whether a second rope pulls in the opposite direction: elongated ropes then cause a dead zone.
    pub antagonistic: bool,
    /// Guiding pulleys from motor to joint.
    pub guides: Vec<Guide>,
    /// Elongation limit for re-tensioning, m.
    pub retension_at_m: Option<f64>,
    /// Strain limit for replacing the rope, as a ratio.
    pub replace_at_strain: Option<f64>,
    /// Thermal expansion of the frame along the rope's path, 1/K, where it is stated.
    pub frame_expansion_per_k: Option<f64>,
}

/// Temperature effect on the offset of a tendon, by its rope, its frame and its routing.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct TendonThermal {
    /// `α_T`: offset per kelvin, rad/K: `(α_rope − α_frame) L/r`.
    pub drift_rad_per_k: Gaussian,
    /// Decrease of the offset by the full heat retraction of the rope, rad; 0 without retraction.
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
    /// Temperature effect on the offset, if it was looked up in the rope catalogue; `None`: 0 ± the tolerance.
    pub temperature_effect: Option<TendonThermal>,
    /// Reference positions of joint or motor: end stops and index marks.
    pub anchors: Vec<Anchor>,
    /// Routing of the tendon where it crosses other joints, has a name of its own, or is driven with a ratio. `None`: the tendon has
    /// the name of its joint, crosses no other one, and `theta` is reflected to it.
    pub routing: Option<Routing>,
}

/// Kind of a reference position.
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
    /// Whether the reference is an index mark, whose passage must be reported; stops are detected automatically.
    pub fn is_mark(self) -> bool {
        matches!(self, Self::JointMark | Self::MotorMark)
    }
}

/// Reference position of a joint or its motor.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Anchor {
    /// Kind of the reference position.
    pub kind: AnchorKind,
    /// Position: of the joint, or of the motor as seen from the joint, rad (m).
    pub position_rad: f64,
    /// Repeatability of the position, one standard deviation, rad (m).
    #[cfg_attr(feature = "wire", serde(alias = "deviation_rad"))]
    pub std_rad: f64,
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
            temperature_effect: None,
            anchors: Vec::new(),
            routing: None,
        }
    }
}
