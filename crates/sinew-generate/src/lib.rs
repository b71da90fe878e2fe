//! Code generation for one robot: its momentum pass and offset observer without loops.
//!
//! The structure of the arm is fixed in the generated code, which therefore contains no loop, no addition of 0 and no
//! multiplication by 1. Constant expressions are evaluated beforehand. The results are those of
//! [`sinew_model::arm::Arm::momentum`] and
//! [`sinew_model::offset::OffsetObserver`] (observer as the source, matched comparison) to rounding.
//!
//! Reading order: `frames` (frames and masses that minimise the number of operations), `graph` (arithmetic as values),
//! `pass` (the momentum pass as a graph), `write` (a graph as text), `turn` (sines), `c`, `rust`, `precision`.

mod c;
mod frames;
mod graph;
mod pass;
mod precision;
mod rust;
mod turn;
mod write;

use pass::Pass;
use sinew_model::offset::{Comparison, OffsetConfig, OffsetConfigError, OffsetObserver};
use sinew_model::offset::{TorqueSource, VelocityFilter};
use sinew_model::robot::Robot;
use sinew_model::transmission::Friction;
use write::number;

/// The language code is written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Language {
    /// C99: a header and a source file that need only `math.h`.
    C,
    /// Rust without the standard library, with the crate `libm`.
    Rust,
}

/// How exact the numbers of the code are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Precision {
    /// 64 bits: values of the library to rounding.
    #[default]
    Double,
    /// 32 bits, for a chip whose hardware has no more. Offsets are those of the library to some microradians.
    Single,
}

/// A file of code.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct File {
    /// Name of the file.
    pub name: String,
    /// Content of the file.
    pub text: String,
}

/// Number of arithmetic operations of one momentum pass, without sines and cosines.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Operations {
    /// Sums and differences.
    pub sums: usize,
    /// Number of products.
    pub products: usize,
    /// Joints whose sine and cosine are taken.
    pub turns: usize,
}

/// Generated source files and their cost.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Generated {
    /// All generated files.
    pub files: Vec<File>,
    /// Cost of a momentum pass.
    pub operations: Operations,
}

/// Reason why no code was generated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GenerateError {
    /// The robot has no moving joint.
    #[error("robot '{0}' has no moving joint")]
    NoJoint(String),
    /// The observer's settings.
    #[error(transparent)]
    Config(#[from] OffsetConfigError),
    /// Observer configuration that code generation does not support.
    #[error(
        "unsupported observer configuration: code generation requires matched comparison and filtered velocities"
    )]
    Source,
    /// A tendon crosses several joints, or has a drive ratio.
    #[error(
        "tendon '{0}' crosses several joints or is driven with a ratio: code generation supports only joints with one tendon each"
    )]
    Routing(String),
}

/// A robot in the form that the code generator uses.
struct Subject<'a> {
    /// Name in code: lower case, digits and underscores.
    name: String,
    robot: &'a Robot,
    gain_per_s: f64,
    cutoff_rad_per_s: f64,
    pass: Pass,
    precision: Precision,
}

impl Subject<'_> {
    fn joints(&self) -> usize {
        self.robot.arm.dof()
    }

    /// Stiffness of an elastic joint, N·m/rad.
    fn stiffness(&self, joint: usize) -> Option<f64> {
        let transmission = self.robot.transmissions.get(joint)?.as_ref()?;
        Some(transmission.stiffness_nm_per_rad)
    }

    /// Returns ` - friction` at the velocity `dq`, or an empty text; `within_one` limits an expression to −1 to 1.
    fn friction_terms(&self, joint: usize, dq: &str, within_one: fn(&str) -> String) -> String {
        let transmission = self.robot.transmissions.get(joint);
        let transmission = transmission.and_then(Option::as_ref);
        let friction = transmission.map_or_else(Friction::default, |t| t.joint_friction);
        let mut out = String::new();
        if friction.coulomb_nm != 0.0 {
            let per_speed = number(1.0 / Friction::SMOOTHING_RAD_PER_S);
            let direction = within_one(&format!("{dq} * {per_speed}"));
            out += &format!(" - {} * {direction}", number(friction.coulomb_nm));
        }
        if friction.viscous_nm_s_per_rad != 0.0 {
            out += &format!(" - {} * {dq}", number(friction.viscous_nm_s_per_rad));
        }
        out
    }

    /// Time after which the start has faded, s.
    fn settling_s(&self) -> f64 {
        9.0 / self.cutoff_rad_per_s + 7.0 / self.gain_per_s
    }
}

/// Generates the code of a robot. `config` gives the gain and the filter of its observer. For single precision, the
/// text for double precision is rewritten.
///
/// # Errors
/// Returns a [`GenerateError`] if the robot or the configuration is unsupported.
pub fn generate(
    robot: &Robot,
    config: &OffsetConfig,
    language: Language,
    precision: Precision,
) -> Result<Generated, GenerateError> {
    if robot.arm.dof() == 0 {
        return Err(GenerateError::NoJoint(robot.name.clone()));
    }
    // Returns the error of an invalid observer configuration.
    OffsetObserver::new(&robot.arm, &robot.transmissions, *config)?;
    let mut transmissions = robot.transmissions.iter().flatten();
    if let Some(routing) = transmissions.find_map(|t| t.routing.as_ref()) {
        return Err(GenerateError::Routing(routing.tendon.clone()));
    }
    let (TorqueSource::Observer, Comparison::Matched) = (config.source, config.comparison) else {
        return Err(GenerateError::Source);
    };
    let VelocityFilter::StateVariable { cutoff_rad_per_s } = config.velocity else {
        return Err(GenerateError::Source);
    };
    let subject = Subject {
        name: identifier(&robot.name),
        robot,
        gain_per_s: config.gain_per_s,
        cutoff_rad_per_s,
        pass: Pass::of(&robot.arm),
        precision,
    };
    let mut files = match language {
        Language::C => c::files(&subject),
        Language::Rust => rust::files(&subject),
    };
    for file in &mut files {
        file.text = precision::written_in(&file.text, language, precision);
    }
    let checksum = checksum(files.iter().flat_map(|file| file.text.bytes()));
    for file in &mut files {
        file.text = (file.text).replace("@CHECKSUM@", &format!("0x{checksum:016x}"));
    }
    Ok(Generated {
        operations: write::operations(&subject.pass),
        files,
    })
}

/// FNV-1a hash of the code, 64 bits: equal for equal robots, settings and precisions.
fn checksum(code: impl Iterator<Item = u8>) -> u64 {
    // Offset basis and prime of the algorithm: http://www.isthe.com/chongo/tech/comp/fnv/.
    code.fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

/// A name as both languages take it.
fn identifier(name: &str) -> String {
    let letter = |c: char| match c {
        'a'..='z' | '0'..='9' => c,
        'A'..='Z' => c.to_ascii_lowercase(),
        _ => '_',
    };
    let name: String = name.chars().map(letter).collect();
    let name = name.trim_matches('_');
    match name.chars().next() {
        None => "robot".to_owned(),
        Some('0'..='9') => format!("robot_{name}"),
        Some(_) => name.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checksum_is_fnv_1a() {
        // Test vector of its authors.
        assert_eq!(checksum("foobar".bytes()), 0x8594_4171_f739_67e8);
    }

    #[test]
    fn names_are_identifiers() {
        for (name, code) in [
            ("biorob-like", "biorob_like"),
            ("UR5", "ur5"),
            ("7dof arm", "robot_7dof_arm"),
            ("–", "robot"),
        ] {
            assert_eq!(identifier(name), code);
        }
    }
}
