//! Couplings between motors and joints as other software describes them.
//!
//! | source | position map | becomes |
//! |---|---|---|
//! | ros_control, ros2_control `SimpleTransmission` | `θ = n (q − q₀)` | one tendon with ratios |
//! | `DifferentialTransmission` | `θ₁ = n_a1 (n_j1 q₁ + n_j2 q₂)`, `θ₂ = n_a2 (n_j1 q₁ − n_j2 q₂)` | two |
//! | `FourBarLinkageTransmission` | `θ₁ = n_j1 n_a1 q₁`, `θ₂ = n_a2 (q₁ + n_j2 q₂)` | two |
//! | MuJoCo `<fixed>` | `length = Σ coef q` | moment arms `−1000 coef`, mm/rad |
//! | table: joints in the header, a motor in each row | `θ = Σ ratio q` | one tendon with ratios a row |
//!
//! Only positions are read. Torques follow by virtual work, `τ_q = Rᵀ τ_θ` with the matrix `R` of ratios, independent
//! of an effort map of the source. For a prismatic joint, rad is m.

mod mjcf;
mod ros;
mod table;

use crate::arm::urdf::EXPAND;
use crate::arm::urdf::xml::{declared, line, parsed, xacro_element};
use roxmltree::Node;
use sinew_files::{Budget, Fault, Located, names};
use std::collections::BTreeSet;

/// Tendons that a file of other software describes.
#[derive(Debug, Clone, PartialEq)]
pub struct TransmissionMap {
    /// One entry per tendon, in the file's order.
    pub tendons: Vec<MappedTendon>,
}

/// A tendon of a [`TransmissionMap`].
#[derive(Debug, Clone, PartialEq)]
pub struct MappedTendon {
    /// Name, unique in the map: the tendon's, or its motor's where the source names no tendons.
    pub name: String,
    /// Line of the file, from 1.
    pub line: u64,
    /// Relation of the positions of motors and joints.
    pub relation: Relation,
}

/// Relation of the positions of a tendon's motors and joints at zero elongation.
#[derive(Debug, Clone, PartialEq)]
pub enum Relation {
    /// One motor: `θ = Σ_j ratio_j q_j + θ₀`.
    Ratios {
        /// Name of the motor.
        motor: String,
        /// Joint and ratio, rad of the motor per rad of the joint; finite and never 0.
        ratios: Vec<(String, f64)>,
        /// Motor angle `θ₀` where every joint is at zero, rad.
        motor_at_zero_rad: f64,
    },
    /// Rope lengths: the joints shorten the tendon's path by `l = Σ_j R_j q_j`.
    MomentArms {
        /// Motors that pull the tendon; empty where the source names none.
        motors: Vec<MappedMotor>,
        /// Joint and moment arm `R_j`, mm/rad; finite and never 0.
        moment_arms_mm: Vec<(String, f64)>,
    },
}

/// A motor that pulls a tendon whose rope lengths are described.
#[derive(Debug, Clone, PartialEq)]
pub struct MappedMotor {
    /// Name of the motor.
    pub name: String,
    /// MuJoCo's gear, `θ = gear · length`, where the element states one; above 0, `θ` lengthens the tendon.
    pub gear: Option<f64>,
}

impl MappedTendon {
    /// Joints that the tendon crosses, with ratio or moment arm in the unit of [`Relation`].
    pub fn joints(&self) -> &[(String, f64)] {
        match &self.relation {
            Relation::Ratios { ratios, .. } => ratios,
            Relation::MomentArms { moment_arms_mm, .. } => moment_arms_mm,
        }
    }

    /// Names of the motors that pull the tendon.
    pub fn motors(&self) -> Vec<&str> {
        match &self.relation {
            Relation::Ratios { motor, .. } => vec![motor],
            Relation::MomentArms { motors, .. } => motors.iter().map(|m| m.name.as_str()).collect(),
        }
    }
}

impl TransmissionMap {
    /// Reads a URDF with `<transmission>`, a MuJoCo model with `<tendon>`, or a table. `file` is its name for messages.
    ///
    /// # Errors
    /// Returns a [`Located`] with the line: text of another format, a transmission type or a tendon that is not supported, a
    /// missing or duplicate name, a number that is not finite, a ratio of 0, more tendons than [`Budget::DESCRIPTION`] permits.
    pub fn parse(text: &str, file: &str) -> Result<Self, Located> {
        let text = text.trim_start_matches('\u{feff}');
        let tendons = match text.trim_start().starts_with('<') {
            true => read_xml(text, file)?,
            false => table::read(text, file)?,
        };
        check(&tendons, file)?;
        Ok(Self { tendons })
    }
}

fn read_xml(text: &str, file: &str) -> Result<Vec<MappedTendon>, Located> {
    let text = declared(text);
    let document = parsed(&text).map_err(|error| {
        let located = Located::new(file, Fault::Syntax, format!("invalid XML: {error}"));
        located.line(u64::from(error.pos().row))
    })?;
    let source = Source { file };
    let is_shape = |tag: &str| matches!(tag, "visual" | "collision");
    if let Some(node) = xacro_element(&document, is_shape) {
        return Err(source.xacro(node));
    }
    let root = document.root_element();
    match root.tag_name().name() {
        "robot" | "ros2_control" => ros::read(root, &source),
        "mujoco" | "mujocoinclude" => mjcf::read(root, &source),
        other => Err(source.fault(
            root,
            Fault::Syntax,
            format!("expected <robot>, <ros2_control> or <mujoco>, found <{other}>"),
        )),
    }
}

/// Checks the conditions that apply to every source.
fn check(tendons: &[MappedTendon], file: &str) -> Result<(), Located> {
    let mut tendon_names = BTreeSet::new();
    let mut motor_names = BTreeSet::new();
    if let Err(problem) = Budget::DESCRIPTION.columns.check(tendons.len() as u64) {
        return Err(Located::new(file, Fault::TooLarge, problem));
    }
    for tendon in tendons {
        let name = &tendon.name;
        let fault = |fault, problem: String| {
            let located = Located::new(file, fault, problem).line(tendon.line);
            located.element(format!("tendon '{name}'"))
        };
        if !tendon_names.insert(name) {
            let fault = fault(Fault::Contradiction, "duplicate name".into());
            return Err(fault.cure("describe each tendon or motor once"));
        }
        for motor in tendon.motors() {
            if !motor_names.insert(motor.to_owned()) {
                let problem = format!("motor '{motor}' drives another tendon already");
                return Err(fault(Fault::Contradiction, problem).cure(
                    "describe each motor's position once, with every joint that changes it",
                ));
            }
        }
        let mut joint_names = BTreeSet::new();
        if tendon.joints().is_empty() {
            let problem = "crosses no joint: every coefficient is 0".into();
            return Err(fault(Fault::NotAllowed, problem));
        }
        for (joint, value) in tendon.joints() {
            if !joint_names.insert(joint) {
                let problem = format!("duplicate joint '{joint}'");
                return Err(fault(Fault::Contradiction, problem));
            }
            if !value.is_finite() || *value == 0.0 {
                let problem =
                    format!("the coefficient of joint '{joint}' must be finite and not 0");
                return Err(fault(Fault::NotAllowed, problem).value(value));
            }
        }
        if let Relation::Ratios {
            motor_at_zero_rad, ..
        } = &tendon.relation
            && !motor_at_zero_rad.is_finite()
        {
            let problem = "the offset must be finite".into();
            return Err(fault(Fault::NotAllowed, problem).value(motor_at_zero_rad));
        }
    }
    Ok(())
}

/// Number of tendons after which a source is read no further, so that [`check`] rejects it: a line number takes a pass over
/// the text.
fn most_read() -> usize {
    Budget::DESCRIPTION.columns.length().saturating_add(1)
}

/// Name of the file that contains the elements, for messages.
struct Source<'a> {
    file: &'a str,
}

impl Source<'_> {
    /// A fault of an element.
    fn fault(&self, node: Node<'_, '_>, fault: Fault, problem: impl Into<String>) -> Located {
        let tag = node.tag_name().name();
        let element = match node.attribute("name") {
            Some(name) => format!("{tag} '{}'", names::shorten(name, 60)),
            None => format!("<{tag}>"),
        };
        let located = Located::new(self.file, fault, problem);
        located.line(u64::from(line(node))).element(element)
    }

    fn xacro(&self, node: Node<'_, '_>) -> Located {
        self.fault(node, Fault::Syntax, "is xacro, not URDF")
            .cure(format!("expand it: {EXPAND}"))
    }

    /// An attribute that the element needs.
    fn attribute<'a>(&self, node: Node<'a, '_>, name: &str) -> Result<&'a str, Located> {
        match node.attribute(name).map(str::trim) {
            Some(text) if text.contains("${") || text.contains("$(") => Err(self.xacro(node)),
            Some(text) if !text.is_empty() => Ok(text),
            _ => Err(self.fault(node, Fault::MissingKey, format!("missing attribute {name}"))),
        }
    }

    /// The finite number that `text` of an element states.
    fn number(&self, node: Node<'_, '_>, text: &str) -> Result<f64, Located> {
        if text.contains("${") || text.contains("$(") {
            return Err(self.xacro(node));
        }
        let number = text.trim().parse().ok().filter(|v: &f64| v.is_finite());
        number.ok_or_else(|| {
            let text = format!("'{}'", names::shorten(text.trim(), 60));
            self.fault(node, Fault::WrongType, "expected a finite number")
                .value(text)
        })
    }
}

/// Elements of a name inside another, in any namespace.
fn children<'a, 'i>(node: Node<'a, 'i>, tag: &'static str) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children()
        .filter(move |child| child.tag_name().name() == tag)
}

#[cfg(test)]
mod tests;
