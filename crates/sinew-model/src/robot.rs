//! A robot: its arm and the transmission of every joint, from `robot.toml` and URDF text.
//!
//! No file is opened here: the caller reads the two texts and passes them in.
//!
//! ```toml
//! urdf = "biorob-like.urdf"            # beside robot.toml; else the recording's own description
//! gravity_m_s2 = [0.0, 0.0, -9.81]     # optional
//! base_rpy_rad = [0.0, 0.0, 0.0]       # optional: how the base stands in the world
//! [joints.shoulder]
//! stiffness_nm_per_rad = 40.0
//! motor_inertia_kg_m2 = 0.12           # optional, reflected to the joint
//! joint_friction = { coulomb_nm = 0.08, viscous_nm_s_per_rad = 0.05 } # optional, else the URDF's
//! motor_friction = { coulomb_nm = 0.4, viscous_nm_s_per_rad = 0.1 }   # optional
//! [joints.shoulder.tendon]             # optional: without it no elongation in mm, no strain
//! length_mm = 700.0
//! joint_pulley_radius_mm = 25.0
//! antagonistic = true                  # optional: a second rope pulls the other way
//! [joints.gripper]
//! locked_at_rad = 0.0                  # welded: needs no column in a recording
//! [joints.track]
//! rigid = true                         # moves, but has no elastic transmission to estimate
//! [tolerances]                         # optional: how far the robot may be from this file
//! stiffness_percent = 12.0             # standard deviations; see [`Tolerances`]
//! ```

use crate::arm::urdf::{self, JointLimits, UrdfArm, UrdfError};
use crate::arm::{Arm, GRAVITY_M_S2};
use crate::tolerances::Tolerances;
use crate::transmission::{Friction, Guide, Tendon, Transmission};
use alloc::collections::BTreeMap;
use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;
use serde::Deserialize;
use toml::Spanned;

/// A robot, ready for an observer or a simulation.
#[derive(Debug, Clone, PartialEq)]
pub struct Robot {
    /// Its name in the URDF.
    pub name: String,
    /// The arm.
    pub arm: Arm,
    /// One entry per joint of the arm; `None` for a rigid joint.
    pub transmissions: Vec<Option<Transmission>>,
    /// One entry per joint, as the URDF states them.
    pub limits: Vec<JointLimits>,
    /// How far it may be from its description.
    pub tolerances: Tolerances,
    /// What was odd in the description, in sentences.
    pub warnings: Vec<String>,
}

impl Robot {
    /// Joint names in the order of `q`.
    pub fn joint_names(&self) -> &[String] {
        self.arm.joint_names()
    }
}

/// Why a robot description was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RobotError {
    /// Not TOML, an unknown key, or a value of the wrong type.
    #[error("{file}: {message}")]
    Toml {
        /// Name of the file.
        file: String,
        /// What the parser says, with line and column.
        message: String,
    },
    /// A value nobody can build.
    #[error("{file}, line {line}: {key} = {value}: {why}")]
    Value {
        /// Name of the file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Full key, with the unit in its name.
        key: String,
        /// Value found.
        value: f64,
        /// What it must be.
        why: &'static str,
    },
    /// Joint of the file that the URDF doesn't have.
    #[error("{file}, line {line}: joint '{joint}' is not in the URDF; it has {known}")]
    UnknownJoint {
        /// Name of the file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Name found.
        joint: String,
        /// Names there are.
        known: String,
    },
    /// Joint of the URDF that the file doesn't speak of.
    #[error(
        "{file}: joint '{joint}' of the URDF is missing; add [joints.{joint}] with stiffness_nm_per_rad, or rigid = true, or locked_at_rad"
    )]
    MissingJoint {
        /// Name of the file.
        file: String,
        /// Joint that is missing.
        joint: String,
    },
    /// A joint without a word on how it is driven, or with contradicting ones.
    #[error("{file}, line {line}: joint '{joint}': {why}")]
    Joint {
        /// Name of the file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Joint at fault.
        joint: String,
        /// What is wrong and what to do.
        why: &'static str,
    },
    /// The URDF was refused.
    #[error("{file}: {error}")]
    Urdf {
        /// Name of the URDF file.
        file: String,
        /// Why.
        error: UrdfError,
    },
}

/// `robot.toml`, parsed and checked as far as it can be without the URDF.
#[derive(Debug, Clone)]
pub struct RobotFile {
    file: String,
    text: String,
    raw: RawRobot,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawRobot {
    urdf: Option<String>,
    gravity_m_s2: Option<[Spanned<f64>; 3]>,
    base_rpy_rad: Option<[Spanned<f64>; 3]>,
    #[serde(default)]
    joints: BTreeMap<Spanned<String>, RawJoint>,
    #[serde(default)]
    tolerances: BTreeMap<Spanned<String>, Spanned<f64>>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawJoint {
    stiffness_nm_per_rad: Option<Spanned<f64>>,
    motor_inertia_kg_m2: Option<Spanned<f64>>,
    joint_friction: Option<RawFriction>,
    motor_friction: Option<RawFriction>,
    tendon: Option<RawTendon>,
    locked_at_rad: Option<Spanned<f64>>,
    #[serde(default)]
    rigid: bool,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawFriction {
    coulomb_nm: Option<Spanned<f64>>,
    viscous_nm_s_per_rad: Option<Spanned<f64>>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawTendon {
    rope: Option<String>,
    length_mm: Spanned<f64>,
    joint_pulley_radius_mm: Spanned<f64>,
    pretension_n: Option<Spanned<f64>>,
    #[serde(default)]
    antagonistic: bool,
    #[serde(default)]
    guides: Vec<RawGuide>,
    retension_at_mm: Option<Spanned<f64>>,
    replace_at_strain_percent: Option<Spanned<f64>>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawGuide {
    radius_mm: Spanned<f64>,
    wrap_deg: Spanned<f64>,
    #[serde(default)]
    friction: Option<Spanned<f64>>,
}

impl RobotFile {
    /// Parses `robot.toml`; `file` is its name for messages.
    ///
    /// # Errors
    /// [`RobotError`] with file, line, key, value and unit.
    pub fn parse(text: &str, file: &str) -> Result<Self, RobotError> {
        let raw: RawRobot = toml::from_str(text).map_err(|e| RobotError::Toml {
            file: file.to_string(),
            message: e.to_string().trim_end().to_string(),
        })?;
        Ok(Self {
            file: file.to_string(),
            text: text.to_string(),
            raw,
        })
    }

    /// Name of the URDF file, relative to `robot.toml`; `None` leaves it to the recording's own
    /// `/robot_description`.
    pub fn urdf(&self) -> Option<&str> {
        self.raw.urdf.as_deref()
    }

    /// Builds the robot with the text of its URDF.
    ///
    /// # Errors
    /// [`RobotError`]; nothing is half-built.
    pub fn build(&self, urdf_text: &str) -> Result<Robot, RobotError> {
        let check = Check {
            file: &self.file,
            text: &self.text,
        };
        let options = self.urdf_options(&check)?;
        let urdf_error = |error| RobotError::Urdf {
            file: self.urdf().unwrap_or("robot_description").to_string(),
            error,
        };
        // Once with every joint moving, to check the names of the file against.
        let all = urdf::UrdfOptions {
            locked: Vec::new(),
            ..options.clone()
        };
        let moving = urdf::parse(urdf_text, &all).map_err(urdf_error)?;
        for joint in self.raw.joints.keys() {
            if moving.arm.joint_index(joint.as_ref()).is_none() {
                return Err(RobotError::UnknownJoint {
                    file: self.file.clone(),
                    line: check.line(joint.span().start),
                    joint: joint.as_ref().clone(),
                    known: moving.arm.joint_names().join(", "),
                });
            }
        }
        let UrdfArm {
            name,
            arm,
            limits,
            coulomb_nm,
            viscous_nm_s_per_rad,
            warnings,
        } = urdf::parse(urdf_text, &options).map_err(urdf_error)?;
        let mut transmissions = Vec::with_capacity(arm.dof());
        for (i, joint) in arm.joint_names().iter().enumerate() {
            let from_urdf = Friction {
                coulomb_nm: coulomb_nm[i],
                viscous_nm_s_per_rad: viscous_nm_s_per_rad[i],
            };
            let entry = self
                .raw
                .joints
                .iter()
                .find(|(name, _)| name.as_ref() == joint);
            let Some((key, raw)) = entry else {
                return Err(RobotError::MissingJoint {
                    file: self.file.clone(),
                    joint: joint.clone(),
                });
            };
            transmissions.push(check.transmission(key, raw, from_urdf)?);
        }
        Ok(Robot {
            name,
            arm,
            transmissions,
            limits,
            tolerances: check.tolerances(&self.raw.tolerances)?,
            warnings,
        })
    }

    fn urdf_options(&self, check: &Check<'_>) -> Result<urdf::UrdfOptions, RobotError> {
        let three = |key: &str, value: &Option<[Spanned<f64>; 3]>, default: [f64; 3]| {
            let Some(value) = value else {
                return Ok(default);
            };
            let mut out = default;
            for (out, v) in out.iter_mut().zip(value) {
                *out = check.finite(key, v)?;
            }
            Ok::<_, RobotError>(out)
        };
        let mut locked = Vec::new();
        for (name, joint) in &self.raw.joints {
            if let Some(at) = &joint.locked_at_rad {
                let key = format!("joints.{}.locked_at_rad", name.as_ref());
                locked.push((name.as_ref().clone(), check.finite(&key, at)?));
            }
        }
        Ok(urdf::UrdfOptions {
            gravity_m_s2: three(
                "gravity_m_s2",
                &self.raw.gravity_m_s2,
                [0.0, 0.0, -GRAVITY_M_S2],
            )?,
            base_rpy_rad: three("base_rpy_rad", &self.raw.base_rpy_rad, [0.0; 3])?,
            locked,
        })
    }
}

/// Checks values and says where they stand.
struct Check<'a> {
    file: &'a str,
    text: &'a str,
}

impl Check<'_> {
    fn line(&self, byte: usize) -> usize {
        1 + self.text.bytes().take(byte).filter(|&b| b == b'\n').count()
    }

    fn number(
        &self,
        key: &str,
        value: &Spanned<f64>,
        good: impl Fn(f64) -> bool,
        why: &'static str,
    ) -> Result<f64, RobotError> {
        let v = *value.as_ref();
        if v.is_finite() && good(v) {
            return Ok(v);
        }
        Err(RobotError::Value {
            file: self.file.to_string(),
            line: self.line(value.span().start),
            key: key.to_string(),
            value: v,
            why,
        })
    }

    fn finite(&self, key: &str, value: &Spanned<f64>) -> Result<f64, RobotError> {
        self.number(key, value, |_| true, "must be a finite number")
    }

    fn positive(&self, key: &str, value: &Spanned<f64>) -> Result<f64, RobotError> {
        self.number(key, value, |v| v > 0.0, "must be above 0")
    }

    fn not_negative(&self, key: &str, value: &Spanned<f64>) -> Result<f64, RobotError> {
        self.number(key, value, |v| v >= 0.0, "must be at least 0")
    }

    fn optional(
        &self,
        key: &str,
        value: &Option<Spanned<f64>>,
        check: impl Fn(&Self, &str, &Spanned<f64>) -> Result<f64, RobotError>,
    ) -> Result<Option<f64>, RobotError> {
        value.as_ref().map(|v| check(self, key, v)).transpose()
    }

    fn tolerances(
        &self,
        raw: &BTreeMap<Spanned<String>, Spanned<f64>>,
    ) -> Result<Tolerances, RobotError> {
        let mut out = Tolerances::default();
        for (key, value) in raw {
            let full = format!("tolerances.{}", key.as_ref());
            let Some((slot, unit)) = out.slot(key.as_ref()) else {
                return Err(RobotError::Toml {
                    file: self.file.to_string(),
                    message: format!(
                        "line {}: unknown key {full}; there are {}",
                        self.line(key.span().start),
                        Tolerances::KEYS.join(", ")
                    ),
                });
            };
            *slot = unit * self.not_negative(&full, value)?;
        }
        Ok(out)
    }

    fn transmission(
        &self,
        name: &Spanned<String>,
        raw: &RawJoint,
        from_urdf: Friction,
    ) -> Result<Option<Transmission>, RobotError> {
        let joint = name.as_ref();
        let wrong = |why| {
            Err(RobotError::Joint {
                file: self.file.to_string(),
                line: self.line(name.span().start),
                joint: joint.clone(),
                why,
            })
        };
        let Some(stiffness) = &raw.stiffness_nm_per_rad else {
            if raw.rigid {
                if raw.tendon.is_some() {
                    return wrong(
                        "is rigid and has a tendon; give stiffness_nm_per_rad and drop rigid",
                    );
                }
                return Ok(None);
            }
            return wrong(
                "stiffness_nm_per_rad is missing; give it, or rigid = true, or locked_at_rad",
            );
        };
        if raw.rigid {
            return wrong("is rigid and has a stiffness; drop one of the two");
        }
        let key = |k: &str| format!("joints.{joint}.{k}");
        let joint_friction = match &raw.joint_friction {
            None => from_urdf,
            Some(f) => self.friction(&key("joint_friction"), f)?,
        };
        let motor_friction = match &raw.motor_friction {
            None => Friction::default(),
            Some(f) => self.friction(&key("motor_friction"), f)?,
        };
        Ok(Some(Transmission {
            stiffness_nm_per_rad: self.positive(&key("stiffness_nm_per_rad"), stiffness)?,
            motor_inertia_kg_m2: self.optional(
                &key("motor_inertia_kg_m2"),
                &raw.motor_inertia_kg_m2,
                Self::not_negative,
            )?,
            joint_friction,
            motor_friction,
            tendon: raw
                .tendon
                .as_ref()
                .map(|t| self.tendon(&key("tendon"), t))
                .transpose()?,
        }))
    }

    fn friction(&self, key: &str, raw: &RawFriction) -> Result<Friction, RobotError> {
        let get = |name: &str, value| {
            self.optional(&format!("{key}.{name}"), value, Self::not_negative)
                .map(|v| v.unwrap_or(0.0))
        };
        Ok(Friction {
            coulomb_nm: get("coulomb_nm", &raw.coulomb_nm)?,
            viscous_nm_s_per_rad: get("viscous_nm_s_per_rad", &raw.viscous_nm_s_per_rad)?,
        })
    }

    fn tendon(&self, key: &str, raw: &RawTendon) -> Result<Tendon, RobotError> {
        const M_PER_MM: f64 = 1e-3;
        let at = |k: &str| format!("{key}.{k}");
        let mut guides = Vec::with_capacity(raw.guides.len());
        for (i, guide) in raw.guides.iter().enumerate() {
            let at = |k: &str| format!("{key}.guides[{i}].{k}");
            guides.push(Guide {
                radius_m: M_PER_MM * self.positive(&at("radius_mm"), &guide.radius_mm)?,
                wrap_rad: self
                    .not_negative(&at("wrap_deg"), &guide.wrap_deg)?
                    .to_radians(),
                friction: self
                    .optional(&at("friction"), &guide.friction, Self::not_negative)?
                    .unwrap_or(0.0),
            });
        }
        Ok(Tendon {
            rope: raw.rope.clone(),
            length_m: M_PER_MM * self.positive(&at("length_mm"), &raw.length_mm)?,
            joint_pulley_radius_m: M_PER_MM
                * self.positive(&at("joint_pulley_radius_mm"), &raw.joint_pulley_radius_mm)?,
            pretension_n: self.optional(
                &at("pretension_n"),
                &raw.pretension_n,
                Self::not_negative,
            )?,
            antagonistic: raw.antagonistic,
            guides,
            retension_at_m: self
                .optional(&at("retension_at_mm"), &raw.retension_at_mm, Self::positive)?
                .map(|v| v * M_PER_MM),
            replace_at_strain: self
                .optional(
                    &at("replace_at_strain_percent"),
                    &raw.replace_at_strain_percent,
                    Self::positive,
                )?
                .map(|v| v / 100.0),
        })
    }
}
