//! Arms from URDF text.
//!
//! Treatment of each joint type:
//!
//! | URDF | treatment |
//! |---|---|
//! | `revolute`, `continuous` | revolute (limits are stored, the dynamics do not use them) |
//! | `prismatic` | prismatic |
//! | `fixed`, or named in [`UrdfOptions::locked`] | welded: its child's mass joins the parent's body |
//! | any of these with `<mimic>` | an independent joint, with a warning: the recording contains its position |
//! | `floating`, `planar`, `spherical` | error: lock it, or cut the description at the arm's base |
//!
//! Visuals, collisions, sensors, transmissions and tags of vendors are ignored, with a warning for an element of xacro
//! in them. Xacro files are rejected with an error that names xacro. Empty lines before the XML declaration are
//! accepted.
//!
//! Treatment of implausible values: a negative mass, NaN or infinity is an error; an inertia that is impossible
//! for a rigid body (identified models contain such values), a joint that carries no mass and a negative
//! friction are accepted with a warning. A negative friction is replaced by 0.

mod links;
mod located;
pub(crate) mod xml;

use super::{Arm, ArmBuilder, ArmError, BodyInertia, BodySpec, GRAVITY_M_S2, JointKind, Pose};
use crate::vec3::{Vec3, norm};
use alloc::collections::BTreeMap;
use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;
use links::{ImplausibleValues, joint_limits, urdf_pose};
use sinew_files::Budget;

pub use links::{is_positive_semidefinite, obeys_triangle};
pub use located::line_of;
pub use xml::{JointType, Origin, UrdfJoint, UrdfLink, UrdfRobot, XacroElement, read as outline};

/// How to read a URDF.
#[derive(Debug, Clone, PartialEq)]
pub struct UrdfOptions {
    /// Gravitational acceleration in the world frame, m/s².
    pub gravity_m_s2: Vec3,
    /// Orientation of the base in the world, roll, pitch, yaw, rad.
    pub base_rpy_rad: Vec3,
    /// Joints held at a position (rad or m), which makes them fixed ones.
    pub locked: Vec<(String, f64)>,
}

impl Default for UrdfOptions {
    fn default() -> Self {
        Self {
            gravity_m_s2: [0.0, 0.0, -GRAVITY_M_S2],
            base_rpy_rad: [0.0; 3],
            locked: Vec::new(),
        }
    }
}

/// Limits of a joint as the URDF states them; 0 where it states none.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointLimits {
    /// Lower end, rad or m; −∞ for continuous joints.
    pub lower: f64,
    /// Upper end, rad or m; +∞ for continuous joints.
    pub upper: f64,
    /// Largest torque, N·m (N).
    pub effort: f64,
    /// Largest speed, rad/s (m/s).
    pub velocity: f64,
}

/// An arm and the joint properties of its URDF.
#[derive(Debug, Clone, PartialEq)]
pub struct UrdfArm {
    /// Name of the robot.
    pub name: String,
    /// The arm; joints depth-first in the file's order.
    pub arm: Arm,
    /// One entry per joint.
    pub limits: Vec<JointLimits>,
    /// Coulomb friction of each joint (`<dynamics friction>`), N·m, never negative.
    pub coulomb_nm: Vec<f64>,
    /// Viscous friction of each joint (`<dynamics damping>`), N·m·s/rad, never negative.
    pub viscous_nm_s_per_rad: Vec<f64>,
    /// Warnings about implausible values, in sentences.
    pub warnings: Vec<String>,
}

/// Command that converts a xacro file to URDF.
pub(crate) const EXPAND: &str = "xacro FILE > robot.urdf";

/// Error of reading a URDF.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum UrdfError {
    /// Text that is not URDF, or invalid XML.
    #[error("not a readable URDF: line {line}: {problem}")]
    Xml {
        /// Line, from 1.
        line: u32,
        /// Description of the problem.
        problem: String,
    },
    /// Xacro, from which URDF is made.
    #[error("line {line}: {what} is xacro, not URDF yet; expand it: {EXPAND}")]
    Xacro {
        /// Line, from 1.
        line: u32,
        /// Text that identifies the file as xacro.
        what: String,
    },
    /// The links and joints do not form a tree.
    #[error("{0}")]
    Tree(String),
    /// A joint type no estimate can be made with.
    #[error(
        "joint '{joint}' is {kind}: only revolute, continuous, prismatic and fixed joints are supported; lock it, or cut the description at the arm's base"
    )]
    JointType {
        /// Joint at fault.
        joint: String,
        /// Type of the joint in the file.
        kind: &'static str,
    },
    /// A locked joint does not exist.
    #[error(
        "cannot lock joint '{joint}': no moving joint of that name in the URDF; moving joints: {available}"
    )]
    UnknownLocked {
        /// Requested joint name.
        joint: String,
        /// Names of the moving joints.
        available: String,
    },
    /// Invalid numbers of the arm.
    #[error(transparent)]
    Arm(#[from] ArmError),
}

/// Reads a URDF.
///
/// # Errors
/// Returns a [`UrdfError`] for an invalid description.
pub fn parse(text: &str, options: &UrdfOptions) -> Result<UrdfArm, UrdfError> {
    if text.trim().is_empty() {
        return Err(UrdfError::Xml {
            line: 1,
            problem: "the text is empty".to_string(),
        });
    }
    Reader::new(&outline(text)?, options)?.read()
}

/// A branch still to be entered: a link, the URDF joint that leads to it, and where that starts.
struct Branch {
    link: usize,
    via: Option<usize>,
    /// Moving joint that carries the parent link.
    carrier: Option<usize>,
    /// Parent link's frame in the carrier's joint frame.
    pose: Pose,
}

/// Motion of the child relative to its parent.
enum Motion {
    /// Fixed, or locked at this displacement.
    Welded(Pose),
    Moves(JointKind),
}

struct Reader<'a> {
    robot: &'a xml::UrdfRobot,
    options: &'a UrdfOptions,
    link_index: BTreeMap<&'a str, usize>,
    /// Joints that start at each link, in the file's order.
    children: Vec<Vec<usize>>,
    root: usize,
    warnings: Vec<String>,
    implausible: ImplausibleValues,
}

impl<'a> Reader<'a> {
    fn new(robot: &'a xml::UrdfRobot, options: &'a UrdfOptions) -> Result<Self, UrdfError> {
        let tree = |text: String| Err(UrdfError::Tree(text));
        if robot.links.is_empty() {
            return tree("the URDF has no link".to_string());
        }
        let mut link_index = BTreeMap::new();
        for (i, link) in robot.links.iter().enumerate() {
            if link_index.insert(link.name.as_str(), i).is_some() {
                return tree(format!("link '{}' is defined twice", link.name));
            }
        }
        let mut children = alloc::vec![Vec::new(); robot.links.len()];
        let mut carried_by: Vec<Option<&str>> = alloc::vec![None; robot.links.len()];
        let find = |joint: &xml::UrdfJoint, link: &str| {
            link_index.get(link).copied().ok_or_else(|| {
                UrdfError::Tree(format!(
                    "joint '{}' refers to link '{link}', which is missing in the URDF",
                    joint.name
                ))
            })
        };
        for (j, joint) in robot.joints.iter().enumerate() {
            let parent = find(joint, &joint.parent)?;
            let child = find(joint, &joint.child)?;
            if let Some(other) = carried_by[child] {
                return tree(format!(
                    "link '{}' has two parent joints, '{other}' and '{}'; closed chains are not supported",
                    joint.child, joint.name
                ));
            }
            carried_by[child] = Some(&joint.name);
            children[parent].push(j);
        }
        let roots: Vec<usize> = (0..robot.links.len())
            .filter(|&l| carried_by[l].is_none())
            .collect();
        let [root] = roots[..] else {
            return tree(if roots.is_empty() {
                "the joints form a closed loop: no link is the base".to_string()
            } else {
                let names: Vec<&str> = roots
                    .iter()
                    .take(4)
                    .map(|&l| robot.links[l].name.as_str())
                    .collect();
                format!(
                    "{} links have no parent joint ('{}'{}); a robot has one base",
                    roots.len(),
                    names.join("', '"),
                    if roots.len() > names.len() {
                        ", …"
                    } else {
                        ""
                    }
                )
            });
        };
        let moving = |j: &&xml::UrdfJoint| j.joint_type != xml::JointType::Fixed;
        let moving = robot.joints.iter().filter(moving).map(|j| j.name.as_str());
        let moving: Vec<&str> = moving.collect();
        if let Err(problem) = Budget::DESCRIPTION.columns.check(moving.len() as u64) {
            return tree(problem);
        }
        for (name, _) in &options.locked {
            if !moving.contains(&name.as_str()) {
                return Err(UrdfError::UnknownLocked {
                    joint: name.clone(),
                    available: moving.join(", "),
                });
            }
        }
        Ok(Self {
            robot,
            options,
            link_index,
            children,
            root,
            warnings: Vec::new(),
            implausible: ImplausibleValues::default(),
        })
    }

    fn read(mut self) -> Result<UrdfArm, UrdfError> {
        let mut specs: Vec<BodySpec> = Vec::new();
        let mut sources: Vec<usize> = Vec::new();
        let mut builder = ArmBuilder::new()
            .gravity(self.options.gravity_m_s2)
            .base_orientation_rpy(self.options.base_rpy_rad);
        let mut entered = 0;
        let mut stack = alloc::vec![Branch {
            link: self.root,
            via: None,
            carrier: None,
            pose: Pose::IDENTITY,
        }];
        while let Some(branch) = stack.pop() {
            entered += 1;
            let (mut carrier, mut pose) = (branch.carrier, branch.pose);
            if let Some(j) = branch.via {
                let joint = &self.robot.joints[j];
                let placement = pose.then(&urdf_pose(&joint.origin));
                match self.motion(joint)? {
                    Motion::Welded(displacement) => pose = placement.then(&displacement),
                    Motion::Moves(kind) => {
                        specs.push(BodySpec {
                            name: joint.name.clone(),
                            kind,
                            parent: carrier,
                            placement,
                            axis: joint.axis,
                            body: BodyInertia::ZERO,
                        });
                        sources.push(j);
                        carrier = Some(specs.len() - 1);
                        pose = Pose::IDENTITY;
                    }
                }
            }
            let link = &self.robot.links[branch.link];
            let body = self.link_body(link)?;
            if let Some(c) = carrier {
                specs[c].body = specs[c].body.plus(&body.seen_from(&pose));
            }
            builder = builder.link(link.name.clone(), carrier, pose);
            // The stack turns the order round: last child first.
            for &j in self.children[branch.link].iter().rev() {
                let child = self.robot.joints[j].child.as_str();
                stack.push(Branch {
                    link: self.link_index[child],
                    via: Some(j),
                    carrier,
                    pose,
                });
            }
        }
        if entered != self.robot.links.len() {
            return Err(UrdfError::Tree(
                "some joints form a closed loop that is not connected to the base".to_string(),
            ));
        }
        for spec in specs {
            builder = builder.body(spec);
        }
        let arm = builder.build()?;
        for (i, name) in arm.names.iter().enumerate() {
            if arm.joints[i].subtree_mass == 0.0 {
                self.warnings.push(format!(
                    "joint '{name}' carries no mass (0 kg): its torque is not observable, and its offset equals theta − q"
                ));
            }
        }
        let joint_of = |i: usize| &self.robot.joints[sources[i]];
        let limits = (0..arm.dof()).map(|i| joint_limits(joint_of(i))).collect();
        let mut coulomb_nm = Vec::with_capacity(arm.dof());
        let mut viscous_nm_s_per_rad = Vec::with_capacity(arm.dof());
        for i in 0..arm.dof() {
            let joint = joint_of(i);
            coulomb_nm.push(self.friction(&joint.name, "friction", joint.friction, "N·m")?);
            viscous_nm_s_per_rad.push(self.friction(
                &joint.name,
                "damping",
                joint.damping,
                "N·m·s/rad",
            )?);
        }
        let remnants = self.robot.ignored_xacro.iter();
        self.warnings.extend(remnants.map(|element| {
            let XacroElement { line, tag } = element;
            format!("line {line}: <xacro:{tag}> was not expanded; ignored, because its element is not read")
        }));
        self.warnings.extend(self.implausible.sentences());
        Ok(UrdfArm {
            name: self.robot.name.clone(),
            arm,
            limits,
            coulomb_nm,
            viscous_nm_s_per_rad,
            warnings: self.warnings,
        })
    }

    fn motion(&mut self, joint: &xml::UrdfJoint) -> Result<Motion, UrdfError> {
        let unsupported = |kind| {
            Err(UrdfError::JointType {
                joint: joint.name.clone(),
                kind,
            })
        };
        let kind = match joint.joint_type {
            JointType::Fixed => return Ok(Motion::Welded(Pose::IDENTITY)),
            JointType::Revolute | JointType::Continuous => JointKind::Revolute,
            JointType::Prismatic => JointKind::Prismatic,
            JointType::Floating => return unsupported("floating"),
            JointType::Planar => return unsupported("planar"),
            JointType::Spherical => return unsupported("spherical"),
        };
        if let Some((_, at)) = self.options.locked.iter().find(|(n, _)| *n == joint.name) {
            return self.locked(joint, kind, *at).map(Motion::Welded);
        }
        if let Some(other) = &joint.mimics {
            self.warnings.push(format!(
                "joint '{}' mimics '{}' in the URDF; treated as an independent joint with its own position in the recording (lock it otherwise)",
                joint.name, other
            ));
        }
        Ok(Motion::Moves(kind))
    }

    /// Displacement of a joint held at `at`.
    fn locked(&self, joint: &xml::UrdfJoint, kind: JointKind, at: f64) -> Result<Pose, UrdfError> {
        let axis = joint.axis;
        let length = norm(axis);
        if !(length.is_finite() && length > 0.0) {
            return Err(ArmError::Axis(joint.name.clone()).into());
        }
        if !at.is_finite() {
            return Err(ArmError::NotFinite {
                place: joint.name.clone(),
                what: "locked position (rad or m)",
                value: at,
            }
            .into());
        }
        let axis = axis.map(|x| x / length);
        Ok(match kind {
            JointKind::Revolute => Pose {
                rotation: crate::vec3::rotation_about(axis, at),
                translation: [0.0; 3],
            },
            JointKind::Prismatic => Pose {
                rotation: crate::vec3::IDENTITY,
                translation: axis.map(|x| x * at),
            },
        })
    }
}
