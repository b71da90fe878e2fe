//! The part of a URDF that the dynamics need, unchanged.

use super::UrdfError;
use alloc::borrow::Cow;
use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;
use roxmltree::{Document, Error, Node, ParsingOptions};
use sinew_files::Budget;

/// Content of a URDF file: links and joints in the file's order.
#[derive(Debug, Clone, PartialEq)]
pub struct UrdfRobot {
    /// Name of the robot.
    pub name: String,
    /// Links in the file's order.
    pub links: Vec<UrdfLink>,
    /// Joints in the file's order.
    pub joints: Vec<UrdfJoint>,
    /// Elements of xacro within ignored elements, such as a visual.
    pub ignored_xacro: Vec<XacroElement>,
}

/// Element of xacro, which was not expanded.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct XacroElement {
    /// Line, from 1.
    pub line: u32,
    /// Name of the tag, without its prefix.
    pub tag: String,
}

/// A link of a URDF.
#[derive(Debug, Clone, PartialEq)]
pub struct UrdfLink {
    /// Name of the link.
    pub name: String,
    /// Mass, kg; 0 without `<inertial>`.
    pub mass_kg: f64,
    /// `ixx ixy ixz iyy iyz izz`, kg·m².
    pub inertia: [f64; 6],
    /// Frame of the inertia, at the centre of mass, in the link's.
    pub origin: Origin,
}

/// Pose of an `<origin>` element.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Origin {
    /// Translation along x, y and z, m.
    pub xyz: [f64; 3],
    /// Roll, pitch, yaw, rad.
    pub rpy: [f64; 3],
}

/// Type of a `<joint>` element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointType {
    /// Turns between its limits.
    Revolute,
    /// Turns without end.
    Continuous,
    /// Translation along an axis.
    Prismatic,
    /// Fixed to its parent.
    Fixed,
    /// Free in six directions.
    Floating,
    /// Slides in a plane.
    Planar,
    /// Turns about three axes.
    Spherical,
}

impl JointType {
    const ALL: [(&'static str, Self); 7] = [
        ("revolute", Self::Revolute),
        ("continuous", Self::Continuous),
        ("prismatic", Self::Prismatic),
        ("fixed", Self::Fixed),
        ("floating", Self::Floating),
        ("planar", Self::Planar),
        ("spherical", Self::Spherical),
    ];

    /// The word of the file.
    pub fn name(self) -> &'static str {
        Self::ALL[self as usize].0
    }
}

/// A joint of a URDF.
#[derive(Debug, Clone, PartialEq)]
pub struct UrdfJoint {
    /// Name of the joint.
    pub name: String,
    /// Type of the joint.
    pub joint_type: JointType,
    /// Frame of the joint in the parent link's.
    pub origin: Origin,
    /// Link it hangs on.
    pub parent: String,
    /// Link it carries.
    pub child: String,
    /// Axis as written in the file.
    pub axis: [f64; 3],
    /// Values of `lower upper effort velocity`; 0 for missing values.
    pub limit: [f64; 4],
    /// Whether the file states both ends of the range.
    pub range_stated: bool,
    /// `<dynamics damping>`, N·m·s/rad.
    pub damping: f64,
    /// `<dynamics friction>`, N·m.
    pub friction: f64,
    /// The joint it follows.
    pub mimics: Option<String>,
}

/// Prefixes of vendors' tags that may be used without being declared.
const PREFIXES_MOST: usize = 32;

/// Reads the links and joints of a URDF text. Only the form of the file is checked.
///
/// # Errors
/// Returns [`UrdfError::Xml`] for invalid XML and [`UrdfError::Xacro`] for a xacro file.
pub fn read(text: &str) -> Result<UrdfRobot, UrdfError> {
    robot(&parsed(&declared(text)).map_err(|error| UrdfError::Xml {
        line: error.pos().row,
        problem: error.to_string(),
    })?)
}

/// The text with prefixes declared that it uses without; lines stay where they are.
pub(crate) fn declared(text: &str) -> Cow<'_, str> {
    let mut text = without_late_declaration(text);
    for _ in 0..PREFIXES_MOST {
        match undeclared(&text) {
            Some(declared) => text = declared.into(),
            None => break,
        }
    }
    text
}

/// The text without an XML declaration that empty lines or a byte order mark precede, which XML forbids and other
/// readers of URDF accept; lines stay where they are.
fn without_late_declaration(text: &str) -> Cow<'_, str> {
    let start = text.trim_start_matches(|c: char| c.is_whitespace() || c == '\u{feff}');
    let end = start.find("?>").filter(|_| start.starts_with("<?xml "));
    match end {
        Some(end) if start.len() < text.len() => {
            let (before, after) = (
                &text[..text.len() - start.len()],
                &start[end + "?>".len()..],
            );
            let lines = before
                .chars()
                .chain(start[..end].chars())
                .filter(|c| *c == '\n');
            Cow::from(lines.chain(after.chars()).collect::<String>())
        }
        _ => Cow::from(text.trim_start_matches('\u{feff}')),
    }
}

/// Parses XML within the budget of a description.
pub(crate) fn parsed(text: &str) -> Result<Document<'_>, Error> {
    let options = ParsingOptions {
        nodes_limit: u32::try_from(Budget::DESCRIPTION.records.value()).unwrap_or(u32::MAX),
        ..ParsingOptions::default()
    };
    Document::parse_with_options(text, options)
}

/// Adds declarations of undeclared prefixes: other readers of URDF ignore namespaces.
fn undeclared(text: &str) -> Option<String> {
    let Err(Error::UnknownNamespace(prefix, _)) = parsed(text) else {
        return None;
    };
    let at = text.find("<robot")? + "<robot".len();
    let (before, after) = text.split_at(at);
    Some(format!("{before} xmlns:{prefix}=\"{prefix}\"{after}"))
}

/// Elements of URDF whose content matters; every other one is ignored with all it contains.
const READ: [&str; 4] = ["robot", "link", "joint", "inertial"];

/// All elements of xacro.
fn xacro_elements<'a, 'i>(document: &'a Document<'i>) -> impl Iterator<Item = Node<'a, 'i>> {
    document.root().descendants().filter(|node| {
        let uri = node.tag_name().namespace();
        uri.is_some_and(|uri| uri.ends_with("xacro"))
    })
}

/// The first element of xacro outside elements with ignored tags.
pub(crate) fn xacro_element<'a, 'i>(
    document: &'a Document<'i>,
    is_ignored: impl Fn(&str) -> bool,
) -> Option<Node<'a, 'i>> {
    xacro_elements(document).find(|node| {
        let mut around = node.ancestors().skip(1).filter(Node::is_element);
        !around.any(|node| is_ignored(node.tag_name().name()))
    })
}

fn robot(document: &Document<'_>) -> Result<UrdfRobot, UrdfError> {
    let root = document.root_element();
    if let Some(node) = xacro_element(document, |tag| !READ.contains(&tag)) {
        let what = format!("<xacro:{}>", node.tag_name().name());
        return Err(xacro(node, what));
    }
    if root.tag_name().name() != "robot" {
        return Err(fault(root, "the outermost element must be <robot>"));
    }
    let version = Version::of(root);
    let all = |tag: &'static str| root.children().filter(move |node| is(*node, root, tag));
    Ok(UrdfRobot {
        name: root.attribute("name").unwrap_or_default().to_string(),
        links: all("link")
            .map(|node| link(node, version))
            .collect::<Result<_, _>>()?,
        joints: all("joint")
            .map(|node| joint(node, version))
            .collect::<Result<_, _>>()?,
        ignored_xacro: xacro_elements(document)
            .map(|node| XacroElement {
                line: line(node),
                tag: node.tag_name().name().to_string(),
            })
            .collect(),
    })
}

/// Changes with the version in `<robot version>`.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
struct Version(u32, u32);

impl Version {
    /// A missing or malformed version is 1.0, as other readers take it.
    fn of(robot: Node<'_, '_>) -> Self {
        let parts = robot
            .attribute("version")
            .and_then(|v| v.trim().split_once('.'));
        let number = parts.and_then(|(a, b)| Some(Self(a.parse().ok()?, b.parse().ok()?)));
        number.unwrap_or(Self(1, 0))
    }

    fn has_quaternions(self) -> bool {
        self >= Self(1, 1)
    }

    /// Whether unspecified limits mean no limit instead of zero.
    fn has_open_limits(self) -> bool {
        self >= Self(1, 2)
    }
}

fn link(node: Node<'_, '_>, version: Version) -> Result<UrdfLink, UrdfError> {
    let name = needed(node, "name")?;
    let Some(inertial) = child(node, "inertial") else {
        return Ok(UrdfLink {
            name,
            mass_kg: 0.0,
            inertia: [0.0; 6],
            origin: Origin::default(),
        });
    };
    let mass = needed_child(inertial, "mass")?;
    let inertia = needed_child(inertial, "inertia")?;
    let mut entries = [0.0; 6];
    let names = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"];
    for (entry, name) in entries.iter_mut().zip(names) {
        *entry = needed_number(inertia, name)?;
    }
    Ok(UrdfLink {
        name,
        mass_kg: needed_number(mass, "value")?,
        inertia: entries,
        origin: origin(inertial, version)?,
    })
}

fn joint(node: Node<'_, '_>, version: Version) -> Result<UrdfJoint, UrdfError> {
    let kind = needed(node, "type")?;
    let joint_type = JointType::ALL.iter().find(|(word, _)| *word == kind);
    let axis = child(node, "axis").map(|axis| vector(axis, "xyz"));
    let number = |tag, name| {
        let found = child(node, tag).map(|node| number(node, name)).transpose();
        found.map(|value| value.flatten().unwrap_or(0.0))
    };
    Ok(UrdfJoint {
        name: needed(node, "name")?,
        joint_type: joint_type
            .map(|(_, joint_type)| *joint_type)
            .ok_or_else(|| {
                let words = JointType::ALL.map(|(word, _)| word).join(", ");
                fault(node, &format!("type = \"{kind}\" must be one of {words}"))
            })?,
        origin: origin(node, version)?,
        parent: needed(needed_child(node, "parent")?, "link")?,
        child: needed(needed_child(node, "child")?, "link")?,
        axis: axis.transpose()?.flatten().unwrap_or([1.0, 0.0, 0.0]),
        limit: limit(node, version)?,
        range_stated: child(node, "limit").is_some_and(|limit| {
            limit.attribute("lower").is_some() && limit.attribute("upper").is_some()
        }),
        damping: number("dynamics", "damping")?,
        friction: number("dynamics", "friction")?,
        mimics: child(node, "mimic")
            .map(|mimic| needed(mimic, "joint"))
            .transpose()?,
    })
}

fn limit(joint: Node<'_, '_>, version: Version) -> Result<[f64; 4], UrdfError> {
    let Some(limit) = child(joint, "limit") else {
        return Ok([0.0; 4]);
    };
    let unstated = if version.has_open_limits() {
        [
            f64::NEG_INFINITY,
            f64::INFINITY,
            f64::INFINITY,
            f64::INFINITY,
        ]
    } else {
        [0.0; 4]
    };
    let mut out = unstated;
    for (slot, name) in out.iter_mut().zip(["lower", "upper", "effort", "velocity"]) {
        *slot = number(limit, name)?.unwrap_or(*slot);
    }
    if version.has_open_limits() && (out[1] < out[0] || out[2] < 0.0 || out[3] < 0.0) {
        return Err(fault(
            limit,
            "upper must not be below lower, effort and velocity not below 0",
        ));
    }
    Ok(out)
}

fn origin(node: Node<'_, '_>, version: Version) -> Result<Origin, UrdfError> {
    let Some(origin) = child(node, "origin") else {
        return Ok(Origin::default());
    };
    let mut rpy = vector(origin, "rpy")?;
    if version.has_quaternions()
        && let Some(quaternion) = numbers::<4>(origin, "quat_xyzw")?
    {
        if rpy.is_some() {
            return Err(fault(origin, "has both rpy and quat_xyzw; remove one"));
        }
        rpy = Some(rpy_of(quaternion));
    }
    Ok(Origin {
        xyz: vector(origin, "xyz")?.unwrap_or_default(),
        rpy: rpy.unwrap_or_default(),
    })
}

/// Roll, pitch and yaw of a quaternion (x, y, z, w), as urdfdom has them.
fn rpy_of(quaternion: [f64; 4]) -> [f64; 3] {
    use core::f64::consts::FRAC_PI_2;
    let norm = libm::sqrt(quaternion.iter().map(|x| x * x).sum());
    let [x, y, z, w] = if norm > 0.0 {
        quaternion.map(|v| v / norm)
    } else {
        [0.0, 0.0, 0.0, 1.0]
    };
    let sin_pitch = -2.0 * (x * z - w * y);
    if sin_pitch <= -0.999_99 {
        return [0.0, -FRAC_PI_2, 2.0 * libm::atan2(x, -y)];
    }
    if sin_pitch >= 0.999_99 {
        return [0.0, FRAC_PI_2, 2.0 * libm::atan2(-x, y)];
    }
    [
        libm::atan2(2.0 * (y * z + w * x), w * w - x * x - y * y + z * z),
        libm::asin(sin_pitch),
        libm::atan2(2.0 * (x * y + w * z), w * w + x * x - y * y - z * z),
    ]
}

fn child<'a, 'i>(node: Node<'a, 'i>, tag: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|child| is(*child, node, tag))
}

/// Whether a node is an element of URDF, which shares the namespace of the one around it, and no vendor's.
fn is(node: Node<'_, '_>, around: Node<'_, '_>, tag: &str) -> bool {
    let (own, around) = (node.tag_name(), around.tag_name());
    own.name() == tag && own.namespace() == around.namespace()
}

fn xacro(node: Node<'_, '_>, what: String) -> UrdfError {
    UrdfError::Xacro {
        line: line(node),
        what,
    }
}

/// Line of an element, from 1.
pub(crate) fn line(node: Node<'_, '_>) -> u32 {
    node.document().text_pos_at(node.range().start).row
}

fn needed_child<'a, 'i>(node: Node<'a, 'i>, tag: &str) -> Result<Node<'a, 'i>, UrdfError> {
    child(node, tag).ok_or_else(|| fault(node, &format!("has no <{tag}>")))
}

fn needed(node: Node<'_, '_>, name: &str) -> Result<String, UrdfError> {
    let text = node.attribute(name).map(ToString::to_string);
    text.ok_or_else(|| fault(node, &format!("has no {name}")))
}

fn needed_number(node: Node<'_, '_>, name: &str) -> Result<f64, UrdfError> {
    number(node, name)?.ok_or_else(|| fault(node, &format!("has no {name}")))
}

fn number(node: Node<'_, '_>, name: &str) -> Result<Option<f64>, UrdfError> {
    Ok(numbers::<1>(node, name)?.map(|[number]| number))
}

fn vector(node: Node<'_, '_>, name: &str) -> Result<Option<[f64; 3]>, UrdfError> {
    numbers(node, name)
}

fn numbers<const N: usize>(node: Node<'_, '_>, name: &str) -> Result<Option<[f64; N]>, UrdfError> {
    let Some(text) = node.attribute(name) else {
        return Ok(None);
    };
    if text.contains("${") || text.contains("$(") {
        return Err(xacro(node, format!("{name} = \"{text}\"")));
    }
    let words = text.split_whitespace().map(str::parse::<f64>);
    let found: Option<Vec<f64>> = words.map(Result::ok).collect();
    let found = found.and_then(|numbers| <[f64; N]>::try_from(numbers).ok());
    found.map(Some).ok_or_else(|| {
        let what = match N {
            1 => "a number".to_string(),
            _ => format!("{N} numbers"),
        };
        fault(node, &format!("{name} = \"{text}\" must be {what}"))
    })
}

/// A fault of an element, with what it belongs to.
fn fault(node: Node<'_, '_>, problem: &str) -> UrdfError {
    let named = node
        .ancestors()
        .find(|n| n.has_tag_name("link") || n.has_tag_name("joint"));
    let owner = named.map_or_else(String::new, |n| {
        let name = n.attribute("name").unwrap_or("?");
        format!("{} '{name}', ", n.tag_name().name())
    });
    UrdfError::Xml {
        line: line(node),
        problem: format!("{owner}<{}> {problem}", node.tag_name().name()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares a quaternion's rotation matrix in closed form with that of the angles it is converted to.
    #[test]
    fn quaternion_and_its_angles_give_same_rotation() {
        let half = 0.5 * core::f64::consts::FRAC_PI_2;
        let r = libm::sqrt(0.5);
        for q in [
            [0.0, 0.0, 0.0, 1.0],
            [0.18, -0.36, 0.54, 0.74],
            [-0.7, 0.1, 0.5, -0.5],
            // Pitch of a quarter turn either way, where yaw and roll turn about one axis.
            [
                r * libm::sin(half),
                r * libm::cos(half),
                -r * libm::sin(half),
                r * libm::cos(half),
            ],
            [
                -r * libm::sin(0.3),
                r * libm::cos(0.3),
                r * libm::sin(0.3),
                r * libm::cos(0.3),
            ],
            [
                -r * libm::sin(0.4),
                -r * libm::cos(0.4),
                -r * libm::sin(0.4),
                r * libm::cos(0.4),
            ],
        ] {
            let norm = libm::sqrt(q.iter().map(|v: &f64| v * v).sum());
            let [x, y, z, w] = q.map(|v| v / norm);
            let of_quaternion = [
                [
                    1.0 - 2.0 * (y * y + z * z),
                    2.0 * (x * y - z * w),
                    2.0 * (x * z + y * w),
                ],
                [
                    2.0 * (x * y + z * w),
                    1.0 - 2.0 * (x * x + z * z),
                    2.0 * (y * z - x * w),
                ],
                [
                    2.0 * (x * z - y * w),
                    2.0 * (y * z + x * w),
                    1.0 - 2.0 * (x * x + y * y),
                ],
            ];
            let [[sr, cr], [sp, cp], [sy, cy]] = rpy_of(q).map(|a| [libm::sin(a), libm::cos(a)]);
            let of_angles = [
                [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
                [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
                [-sp, cp * sr, cp * cr],
            ];
            for (a, b) in of_quaternion
                .iter()
                .flatten()
                .zip(of_angles.iter().flatten())
            {
                assert!(
                    (a - b).abs() < 1e-9,
                    "{q:?}: {of_quaternion:?} {of_angles:?}"
                );
            }
        }
        // Nothing to turn by.
        assert_eq!(rpy_of([0.0; 4]), [0.0; 3]);
    }
}
