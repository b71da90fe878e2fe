//! Code for one robot: its momentum pass and offset observer, written out.
//!
//! The arm's structure is known when the code is written. So there is no loop, no zero is added, no one multiplied
//! with, and what is constant is a number. The results are those of [`sinew_model::arm::Arm::momentum`] and
//! [`sinew_model::offset::OffsetObserver`] (observer as the source, matched comparison) to rounding.
//!
//! Reading order: `frames` (which frames and masses leave least to compute), `graph` (arithmetic as values),
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

/// The language code is written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Language {
    /// C99 with `math.h` alone: a header and a source.
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
    /// Its name.
    pub name: String,
    /// Its text.
    pub text: String,
}

/// Arithmetic of one momentum pass, sines and cosines left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Operations {
    /// Sums and differences.
    pub sums: usize,
    /// Number of products.
    pub products: usize,
    /// Joints whose sine and cosine are taken.
    pub turns: usize,
}

/// What was written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Generated {
    /// The files.
    pub files: Vec<File>,
    /// What a momentum pass costs.
    pub operations: Operations,
}

/// Why no code was written.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GenerateError {
    /// Nothing moves.
    #[error("robot '{0}' has no moving joint")]
    NoJoint(String),
    /// The observer's settings.
    #[error(transparent)]
    Config(#[from] OffsetConfigError),
    /// Code is written for the observer alone.
    #[error(
        "code is written for the observer with matched comparison and filtered velocities alone"
    )]
    Source,
    /// A tendon crosses several joints, or has a drive ratio.
    #[error(
        "tendon '{0}' crosses several joints or is driven with a ratio: code is written for joints with tendons of their own alone"
    )]
    Routing(String),
}

/// A robot as code is written for it.
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

    fn friction(&self, joint: usize) -> Friction {
        let transmission = self.robot.transmissions.get(joint);
        let transmission = transmission.and_then(Option::as_ref);
        transmission.map_or_else(Friction::default, |t| t.joint_friction)
    }

    /// Time after which the start has faded, s.
    fn settling_s(&self) -> f64 {
        9.0 / self.cutoff_rad_per_s + 7.0 / self.gain_per_s
    }
}

/// Writes the code of a robot; `config` says gain and filter of its observer, which is a text for double precision written anew
/// for single precision where that is asked for.
///
/// # Errors
/// [`GenerateError`].
pub fn generate(
    robot: &Robot,
    config: &OffsetConfig,
    language: Language,
    precision: Precision,
) -> Result<Generated, GenerateError> {
    if robot.arm.dof() == 0 {
        return Err(GenerateError::NoJoint(robot.name.clone()));
    }
    // Refuses what can't be an observer.
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
    Ok(Generated {
        operations: write::operations(&subject.pass),
        files,
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
