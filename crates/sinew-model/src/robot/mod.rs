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
//! friction_along_path = true           # optional: a cable in a shaft or sheath, or over several pulleys
//! [joints.shoulder.tendon]             # optional: without it no elongation in mm, no strain
//! length_mm = 700.0
//! joint_pulley_radius_mm = 25.0
//! antagonistic = true                  # optional: a second rope pulls the other way
//! frame_expansion_per_k = 23e-6        # optional, or once for all at the top: aluminium
//! [[joints.shoulder.anchors]]          # optional: reference positions of the joint
//! kind = "stop"                        # an end stop; or joint-mark, motor-mark
//! position_rad = 1.92
//! deviation_rad = 0.0003
//! [joints.gripper]
//! locked_at_rad = 0.0                  # welded: needs no column in a recording
//! [joints.wrist]                       # driven by a tendon below
//! joint_friction = { coulomb_nm = 0.02, viscous_nm_s_per_rad = 0.01 }
//! [motors.wrist]                       # motors of tendons, at the shaft whose position is recorded
//! inertia_kg_m2 = 0.02                 # optional
//! friction = { coulomb_nm = 0.08, viscous_nm_s_per_rad = 0.02 } # optional
//! [[tendons]]                          # a rope that runs over the shoulder on its way to the wrist
//! name = "wrist"
//! drums_mm = { wrist = 15.0 }          # rope per rad of the motor
//! moment_arms_mm = { shoulder = 6.0, wrist = 15.0 }
//! stiffness_n_per_mm = 35.0            # or, with motor and ratios, stiffness_nm_per_rad at the motor
//! [joints.track]
//! rigid = true                         # moves, but has no elastic transmission to estimate
//! [tolerances]                         # optional: tolerances of the values in this file
//! stiffness_percent = 12.0             # standard deviations; see [`Tolerances`]
//! ```

use crate::arm::urdf::{self, JointLimits, UrdfArm};
use crate::arm::{Arm, GRAVITY_M_S2};
use crate::routing::Routing;
use crate::tendons::{Coupling, JointSpring};
use crate::tolerances::Tolerances;
use crate::transmission::{Anchor, AnchorKind, Friction, Guide, Tendon, Transmission};
use alloc::borrow::ToOwned;
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;
use sinew_files::{Bound, Fault, Fields as _, Located, Section, TomlFile, names};
use tendons::{CoupledDrive, JointOfFile, MotorEntry, TendonEntry};

mod shipped;
mod tendons;

pub use shipped::{BIOROB_LIKE, SHIPPED_ROBOTS, ShippedRobot};

/// A robot, ready for an observer or a simulation.
#[derive(Debug, Clone, PartialEq)]
pub struct Robot {
    /// Name of the robot in the URDF.
    pub name: String,
    /// Arm of the robot.
    pub arm: Arm,
    /// One entry per axis: per joint of the arm, `None` for one without a tendon on its axis, then per tendon beyond these. Arrays of a
    /// sample, an estimate and a result have one entry per axis.
    pub transmissions: Vec<Option<Transmission>>,
    /// Joints, motors and tendons, where `robot.toml` has `[[tendons]]`.
    pub coupling: Option<Coupling>,
    /// Tendons with friction along their path, in the order of the joints. Their entries of `transmissions` are `None`: no
    /// equation of a spring holds for them.
    pub cables: Vec<Cable>,
    /// One entry per joint, as the URDF states them.
    pub limits: Vec<JointLimits>,
    /// Tolerances of the robot's description.
    pub tolerances: Tolerances,
    /// Warnings about implausible values of the description, in sentences.
    pub warnings: Vec<String>,
}

/// Tendon with friction along its path, which alone drives a joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Cable {
    /// Index of the joint.
    pub axis: usize,
    /// Spring, friction of the drive and tendon.
    pub transmission: Transmission,
}

impl Robot {
    /// Tendon with friction along its path that drives a joint.
    pub fn cable(&self, axis: usize) -> Option<&Transmission> {
        let cable = self.cables.iter().find(|cable| cable.axis == axis)?;
        Some(&cable.transmission)
    }

    /// Joint names in the order of `q`.
    pub fn joint_names(&self) -> &[String] {
        self.arm.joint_names()
    }

    /// Number of axes: the joints of the arm, and the tendons beyond these.
    pub fn axes(&self) -> usize {
        self.transmissions.len()
    }

    /// Name of the tendon on each axis, in the order of `q`: the joint's own where it has no other.
    pub fn tendon_names(&self) -> Vec<String> {
        self.named(|routing| &routing.tendon)
    }

    /// Name of the tendon on an axis, which results are named by; empty where there is no such axis.
    pub fn tendon_name(&self, axis: usize) -> &str {
        let transmission = self.transmissions.get(axis).and_then(Option::as_ref);
        let routing = transmission.and_then(|t| t.routing.as_ref());
        let own = || self.joint_names().get(axis).map_or("", String::as_str);
        routing.map_or_else(own, |routing| &routing.tendon)
    }

    /// Axis of the tendon of a name.
    pub fn tendon_index(&self, tendon: &str) -> Option<usize> {
        (0..self.axes()).find(|joint| self.tendon_name(*joint) == tendon)
    }

    /// Name of the motor that drives the tendon on each axis, in the order of `q`: the joint's own where it has no other.
    pub fn motor_names(&self) -> Vec<String> {
        self.named(|routing| &routing.motor)
    }

    /// Name of the joint of an axis, or of its tendon if the axis has no joint; empty if the axis does not exist.
    pub fn axis_name(&self, axis: usize) -> &str {
        let joint = self.joint_names().get(axis).map(String::as_str);
        joint.unwrap_or_else(|| self.tendon_name(axis))
    }

    /// Whether the motor of an axis is measured at an axis before it, as both share it.
    pub fn shares_motor(&self, axis: usize) -> bool {
        let motors = self.motors_at_shaft();
        let own = motors.get(axis).copied().flatten();
        own.is_some() && motors.iter().take(axis).any(|other| *other == own)
    }

    /// Tendon on an axis whose group has one equation per joint, in which a measured tension counts.
    pub fn pulling_tendon(&self, axis: usize) -> Option<&str> {
        let routing = self.transmissions.get(axis)?.as_ref()?.routing.as_ref()?;
        routing.pull.is_some().then_some(routing.tendon.as_str())
    }

    /// Whether a group of tendons has one equation per joint, so that only combinations of its tendons are observable.
    pub fn has_joint_equations(&self) -> bool {
        (0..self.axes()).any(|axis| self.pulling_tendon(axis).is_some())
    }

    /// Whether every axis is a joint and has its name, so that results are named by joints; `false` where tendons have names of their own.
    pub fn is_named_by_joints(&self) -> bool {
        self.tendon_names() == self.joint_names()
    }

    /// Motor of each axis at whose shaft position and torque are measured, in the order of `q`; `None`: the joint's own, reflected to it.
    pub fn motors_at_shaft(&self) -> Vec<Option<&str>> {
        let all = self.transmissions.iter();
        all.map(|t| Some(t.as_ref()?.routing.as_ref()?.motor.as_str()))
            .collect()
    }

    fn named(&self, name: impl Fn(&Routing) -> &String) -> Vec<String> {
        let axes = self.transmissions.iter().enumerate();
        axes.map(|(axis, transmission)| {
            let routing = transmission.as_ref().and_then(|t| t.routing.as_ref());
            let own = || self.joint_names().get(axis).cloned().unwrap_or_default();
            routing.map_or_else(own, |routing| name(routing).clone())
        })
        .collect()
    }
}

/// `robot.toml`, parsed and checked as far as it can be without the URDF.
#[derive(Debug, Clone)]
pub struct RobotFile {
    file: String,
    urdf: Option<String>,
    gravity_m_s2: Option<[f64; 3]>,
    base_rpy_rad: Option<[f64; 3]>,
    joints: Vec<JointEntry>,
    motors: Vec<MotorEntry>,
    tendons: Vec<TendonEntry>,
    frame_expansion_per_k: Option<f64>,
    tolerances: Tolerances,
}

/// Entry of a joint in the file.
#[derive(Debug, Clone)]
struct JointEntry {
    name: String,
    line: u64,
    locked_at_rad: Option<f64>,
    /// Passive spring of the joint.
    spring: Option<JointSpring>,
    /// Friction of the joint, where the file states it.
    friction: Option<Friction>,
    /// Drive of the joint; `None`: rigid. An error is reported only if the URDF has such a joint that is not locked.
    drive: Result<Option<Drive>, Located>,
}

#[derive(Debug, Clone)]
struct Drive {
    /// Without the joint's friction.
    transmission: Transmission,
    /// Else the URDF's.
    joint_friction: Option<Friction>,
    /// Line of the joint, if friction acts along the path of its tendon.
    cable_line: Option<u64>,
}

impl RobotFile {
    /// Parses `robot.toml`; `file` is its name for messages.
    ///
    /// # Errors
    /// With file, line, key, value and unit.
    pub fn parse(text: &str, file: &str) -> Result<Self, Located> {
        TomlFile::parse(text, file)?.root().whole(|root| {
            let joints = root.read("joints", |joints| {
                let entries = joints.entries().into_iter();
                let read = entries
                    .map(|(name, line, value)| value.section()?.whole(|s| joint(s, name, line)));
                read.collect::<Result<Vec<_>, Located>>()
            })?;
            Ok(Self {
                file: file.to_owned(),
                urdf: root.text("urdf")?,
                gravity_m_s2: root.vec3("gravity_m_s2")?,
                base_rpy_rad: root.vec3("base_rpy_rad")?,
                joints: joints.unwrap_or_default(),
                motors: root.read("motors", tendons::motors)?.unwrap_or_default(),
                tendons: root.each("tendons", tendons::tendon)?,
                frame_expansion_per_k: root.number("frame_expansion_per_k", EXPANSION)?,
                tolerances: root.read("tolerances", tolerances)?.unwrap_or_default(),
            })
        })
    }

    /// Name of the URDF file, relative to `robot.toml`; `None` leaves it to the recording's own
    /// `/robot_description`.
    pub fn urdf(&self) -> Option<&str> {
        self.urdf.as_deref()
    }

    /// Names of the files of moment arms that its tendons have, relative to `robot.toml`; [`with_table`](Self::with_table) takes each.
    pub fn tables(&self) -> Vec<&str> {
        tendons::tables(&self.tendons)
    }

    /// Takes a file of moment arms, with the columns `q_rad`, rad, and `shortening_mm`, mm.
    ///
    /// * `name`: as in `robot.toml`. `file`: for messages.
    ///
    /// # Errors
    /// With file, line, value and unit.
    pub fn with_table(mut self, name: &str, file: &str, text: &str) -> Result<Self, Located> {
        tendons::take_table(&mut self.tendons, name, (file, text))?;
        Ok(self)
    }

    /// Names of the joints it describes, or that its tendons cross, but for those it locks.
    pub fn moving_joints(&self) -> Vec<String> {
        let moving = self.joints.iter().filter(|j| j.locked_at_rad.is_none());
        let mut names: Vec<String> = moving.map(|j| j.name.clone()).collect();
        for joint in tendons::crossed(&self.tendons) {
            let is_described = self.joints.iter().any(|j| j.name == joint);
            if !(is_described || names.iter().any(|name| name == joint)) {
                names.push(joint.to_owned());
            }
        }
        names
    }

    /// Builds the robot with the text of its URDF.
    ///
    /// # Errors
    /// Returns a [`Located`] that names the faulty file, `robot.toml` or URDF.
    pub fn build(&self, urdf_text: &str) -> Result<Robot, Located> {
        let (robot, gaps) = self.draft(urdf_text)?;
        gaps.into_iter().next().map_or(Ok(robot), Err)
    }

    /// Builds the robot from an incomplete file, and lists the missing parts: joints missing in the URDF, joints
    /// missing in the file, and joints without a stiffness. All three kinds are treated as rigid.
    ///
    /// # Errors
    /// Returns a [`Located`] that names the faulty URDF.
    pub fn draft(&self, urdf_text: &str) -> Result<(Robot, Vec<Located>), Located> {
        let options = urdf::UrdfOptions {
            gravity_m_s2: self.gravity_m_s2.unwrap_or([0.0, 0.0, -GRAVITY_M_S2]),
            base_rpy_rad: self.base_rpy_rad.unwrap_or_default(),
            locked: Vec::new(),
        };
        let urdf_file = self.urdf().unwrap_or("robot_description");
        let located = |error: urdf::UrdfError| error.located(urdf_file, urdf_text);
        // Once with every joint moving, to check the names of the file against.
        let moving = urdf::parse(urdf_text, &options).map_err(located)?;
        let is_there = |joint: &&JointEntry| moving.arm.joint_index(&joint.name).is_some();
        let (there, strangers): (Vec<_>, Vec<_>) = self.joints.iter().partition(is_there);
        let strangers = strangers.into_iter();
        let mut gaps: Vec<Located> = strangers
            .map(|joint| self.unknown(joint, moving.arm.joint_names()))
            .collect();
        let locked = there.into_iter();
        let options = urdf::UrdfOptions {
            locked: locked
                .filter_map(|joint| Some((joint.name.clone(), joint.locked_at_rad?)))
                .collect(),
            ..options
        };
        let UrdfArm {
            name,
            arm,
            limits,
            coulomb_nm,
            viscous_nm_s_per_rad,
            warnings,
        } = urdf::parse(urdf_text, &options).map_err(located)?;
        let urdf_friction = |i: usize| Friction {
            coulomb_nm: coulomb_nm[i],
            viscous_nm_s_per_rad: viscous_nm_s_per_rad[i],
        };
        let mut transmissions = Vec::with_capacity(arm.dof());
        let mut joints = Vec::with_capacity(arm.dof());
        let mut cable_lines = Vec::new();
        for (i, name) in arm.joint_names().iter().enumerate() {
            let entry = self.joints.iter().find(|entry| entry.name == *name);
            // A joint that a tendon crosses, or a spring holds, needs no drive of its own.
            let is_held = tendons::crossed(&self.tendons).any(|joint| joint == name)
                || entry.is_some_and(|entry| entry.spring.is_some());
            let drive = match entry {
                Some(entry) => entry.drive.clone(),
                None => Err(self.missing(name)),
            };
            let is_rigid = matches!(drive, Ok(None));
            let drive = drive.unwrap_or_else(|gap| {
                if !(is_held && gap.fault == Fault::MissingKey) {
                    gaps.push(gap);
                }
                None
            });
            let own = drive.as_ref().map(|d| d.transmission.stiffness_nm_per_rad);
            let cable_line = drive.as_ref().and_then(|d| d.cable_line);
            cable_lines.extend(cable_line.map(|line| (i, line)));
            joints.push(JointOfFile {
                name,
                is_rigid: is_rigid || (own.is_none() && !is_held),
                own_stiffness_nm_per_rad: own,
                spring: entry.and_then(|entry| entry.spring),
                friction: entry
                    .and_then(|entry| entry.friction)
                    .unwrap_or_else(|| urdf_friction(i)),
            });
            transmissions.push(drive.map(|drive| {
                let mut transmission = drive.transmission;
                transmission.joint_friction =
                    drive.joint_friction.unwrap_or_else(|| urdf_friction(i));
                transmission
            }));
        }
        let lacking = gaps.len();
        gaps.extend(tendons::gaps(&self.tendons));
        let is_whole = gaps.len() == lacking;
        let is_coupled = !self.tendons.is_empty() || joints.iter().any(|j| j.spring.is_some());
        let locked: Vec<&str> = options.locked.iter().map(|l| l.0.as_str()).collect();
        let file = (self.motors.as_slice(), self.tendons.as_slice());
        let coupled =
            (is_coupled && is_whole).then(|| tendons::couple(&self.file, file, &joints, &locked));
        let mut coupling = None;
        match coupled {
            None => {}
            // A joint may lack a tendon for the reason that the tendon is wrong.
            Some(Err(gap)) => gaps.insert(0, gap),
            Some(Ok(coupled)) => {
                gaps.extend(coupled.gap);
                coupling = Some(coupled.coupling);
                let axes = coupled.drives.len().max(transmissions.len());
                transmissions.resize(axes, None);
                for (to, drive) in transmissions.iter_mut().zip(coupled.drives) {
                    match (drive, to) {
                        (CoupledDrive::Own, _) | (CoupledDrive::Crossed(_), None) => {}
                        (CoupledDrive::Crossed(routing), Some(own)) => own.routing = Some(routing),
                        (CoupledDrive::Tendon(tendon), to) => *to = Some(*tendon),
                    }
                }
            }
        }
        for transmission in transmissions.iter_mut().flatten() {
            if let Some(tendon) = &mut transmission.tendon {
                let own = tendon.frame_expansion_per_k;
                tendon.frame_expansion_per_k = own.or(self.frame_expansion_per_k);
            }
        }
        let mut cables = Vec::new();
        for (axis, line) in cable_lines {
            match transmissions[axis].take() {
                Some(transmission) if !is_coupled => {
                    cables.push(Cable { axis, transmission });
                }
                other => {
                    transmissions[axis] = other;
                    gaps.push(self.coupled_cable(&arm.joint_names()[axis], line));
                }
            }
        }
        let robot = Robot {
            name,
            arm,
            transmissions,
            coupling,
            cables,
            limits,
            tolerances: self.tolerances,
            warnings,
        };
        Ok((robot, gaps))
    }

    /// Returns the error for a joint of the file that is missing in the URDF.
    fn unknown(&self, joint: &JointEntry, joints: &[String]) -> Located {
        let name = &joint.name;
        let hint = names::hint(name, joints);
        let joints = joints.join(", ");
        let problem =
            format!("joint '{name}' is not in the URDF{hint} joints of the URDF: {joints}");
        Located::new(&self.file, Fault::UnknownName, problem).line(joint.line)
    }

    /// Returns the error for a tendon with friction along its path in a robot with coupled tendons.
    fn coupled_cable(&self, joint: &str, line: u64) -> Located {
        let problem = format!(
            "friction_along_path of joint '{joint}' conflicts with [[tendons]] and with springs of joints"
        );
        Located::new(&self.file, Fault::Contradiction, problem)
            .line(line)
            .cure("remove friction_along_path; it requires that each joint has a tendon of its own")
    }

    /// Returns the error for a joint of the URDF that is missing in the file.
    fn missing(&self, joint: &str) -> Located {
        let problem = format!("joint '{joint}' of the URDF is missing");
        Located::new(&self.file, Fault::MissingKey, problem).cure(format!(
            "add [joints.{joint}] with stiffness_nm_per_rad, or rigid = true, or locked_at_rad"
        ))
    }
}

fn tolerances(s: &Section<'_>) -> Result<Tolerances, Located> {
    let mut out = Tolerances::default();
    for (key, line, value) in s.entries() {
        let (slot, unit) = out
            .slot(key)
            .ok_or_else(|| s.unknown(key, line, &Tolerances::KEYS))?;
        *slot = unit * value.number(Bound::NotNegative)?;
    }
    Ok(out)
}

fn joint(s: &Section<'_>, name: &str, line: u64) -> Result<JointEntry, Located> {
    let stiffness = s.number("stiffness_nm_per_rad", Bound::Positive)?;
    let rigid = s.flag("rigid")?;
    let is_cable = s.flag("friction_along_path")?;
    let tendon = s.read("tendon", tendon)?;
    let joint_friction = s.read("joint_friction", friction)?;
    let motor_friction = s.read("motor_friction", friction)?.unwrap_or_default();
    let motor_inertia_kg_m2 = s.number("motor_inertia_kg_m2", Bound::NotNegative)?;
    let anchors = s.each("anchors", anchor)?;
    let wrong =
        |fault, problem: &str, cure: &str| Err(s.here(fault, problem).line(line).cure(cure));
    let drive = match (stiffness, rigid) {
        (None, true) if tendon.is_some() => wrong(
            Fault::Contradiction,
            "is rigid and has a tendon",
            "give stiffness_nm_per_rad and drop rigid",
        ),
        (None, true) if is_cable => wrong(
            Fault::Contradiction,
            "is rigid and has friction along the path of a tendon",
            "give stiffness_nm_per_rad and drop rigid",
        ),
        (None, true) => Ok(None),
        (None, false) => wrong(
            Fault::MissingKey,
            "stiffness_nm_per_rad is missing",
            "give it, or rigid = true, or locked_at_rad, or a tendon in [[tendons]] that crosses the joint",
        ),
        (Some(_), true) => wrong(
            Fault::Contradiction,
            "is rigid and has a stiffness",
            "drop one of the two",
        ),
        (Some(_), false) if is_cable && !(motor_friction.coulomb_nm > 0.0) => wrong(
            Fault::Contradiction,
            "friction_along_path requires the friction of the drive",
            "add motor_friction = { coulomb_nm = VALUE }, N·m at the joint that just turns the unloaded drive with its tendon",
        ),
        (Some(stiffness_nm_per_rad), false) => Ok(Some(Drive {
            transmission: Transmission {
                stiffness_nm_per_rad,
                motor_inertia_kg_m2,
                joint_friction: Friction::default(),
                motor_friction,
                tendon,
                temperature_effect: None,
                anchors,
                routing: None,
            },
            joint_friction,
            cable_line: is_cable.then_some(line),
        })),
    };
    Ok(JointEntry {
        name: name.to_owned(),
        line,
        spring: s.read("spring", tendons::spring)?,
        friction: joint_friction,
        locked_at_rad: s.number("locked_at_rad", Bound::Any)?,
        drive,
    })
}

fn friction(s: &Section<'_>) -> Result<Friction, Located> {
    Ok(Friction {
        coulomb_nm: s.number_or("coulomb_nm", Bound::NotNegative, 0.0)?,
        viscous_nm_s_per_rad: s.number_or("viscous_nm_s_per_rad", Bound::NotNegative, 0.0)?,
    })
}

const M_PER_MM: f64 = 1e-3;
/// Solids expand by 0 to 200 millionths per kelvin; carbon fibre may shrink a little.
const EXPANSION: Bound = Bound::Within(-1e-4, 1e-3);

fn tendon(s: &Section<'_>) -> Result<Tendon, Located> {
    let length = |key, reason| -> Result<f64, Located> {
        Ok(M_PER_MM * s.need(key, Bound::Positive, reason)?)
    };
    let retension_at_mm = s.number("retension_at_mm", Bound::Positive)?;
    let replace_at_percent = s.number("replace_at_strain_percent", Bound::Positive)?;
    Ok(Tendon {
        rope: s.text("rope")?,
        length_m: length("length_mm", "free rope between the pulleys")?,
        joint_pulley_radius_m: length(
            "joint_pulley_radius_mm",
            "radius of the pulley at the joint",
        )?,
        pretension_n: s.number("pretension_n", Bound::NotNegative)?,
        antagonistic: s.flag("antagonistic")?,
        guides: s.each("guides", guide)?,
        retension_at_m: retension_at_mm.map(|v| v * M_PER_MM),
        replace_at_strain: replace_at_percent.map(|v| v / 100.0),
        frame_expansion_per_k: s.number("frame_expansion_per_k", EXPANSION)?,
    })
}

fn anchor(s: &Section<'_>) -> Result<Anchor, Located> {
    const KINDS: [(&str, AnchorKind); 3] = [
        ("stop", AnchorKind::Stop),
        ("joint-mark", AnchorKind::JointMark),
        ("motor-mark", AnchorKind::MotorMark),
    ];
    Ok(Anchor {
        kind: s.one_of("kind", &KINDS)?.unwrap_or(AnchorKind::Stop),
        position_rad: s.need(
            "position_rad",
            Bound::Any,
            "position of the joint or motor at the reference",
        )?,
        std_rad: s.need("std_rad", Bound::Positive, "repeatability of the position")?,
    })
}

fn guide(s: &Section<'_>) -> Result<Guide, Located> {
    let wrap_deg = s.need("wrap_deg", Bound::NotNegative, "wrap angle of the rope")?;
    Ok(Guide {
        radius_m: M_PER_MM * s.need("radius_mm", Bound::Positive, "of the guiding pulley")?,
        wrap_rad: wrap_deg.to_radians(),
        friction: s.number_or("friction", Bound::NotNegative, 0.0)?,
    })
}
