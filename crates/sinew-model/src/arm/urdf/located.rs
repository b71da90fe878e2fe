//! Errors of a URDF with their location in the file.

use super::{EXPAND, UrdfError};
use crate::arm::ArmError;
use alloc::format;
use alloc::string::ToString;
use sinew_files::{Fault, Located};

impl UrdfError {
    /// The error with the file's name, and with the line of the element at fault in its `text`.
    pub fn located(&self, file: &str, text: &str) -> Located {
        let new = |fault| Located::new(file, fault, self.to_string());
        let at = |element: &str, located: Located| located.line(line_of(text, element));
        match self {
            Self::Xml { line, problem } => Located::new(
                file,
                Fault::Syntax,
                format!("not a readable URDF: {problem}"),
            )
            .line(u64::from(*line)),
            Self::Xacro { line, what } => {
                let problem = format!("{what} is xacro, not URDF yet");
                Located::new(file, Fault::Syntax, problem)
                    .line(u64::from(*line))
                    .cure(format!("expand it: {EXPAND}"))
            }
            Self::Tree(_) => new(Fault::Contradiction),
            Self::JointType { joint, .. } => {
                at(&format!("joint '{joint}'"), new(Fault::NotAllowed))
            }
            Self::UnknownLocked { .. } => new(Fault::UnknownName),
            Self::Arm(error) => match error {
                ArmError::NotFinite { place, what, value } => {
                    let problem = "must be a finite number";
                    let located = Located::new(file, Fault::NotAllowed, problem);
                    let element = format!("{place}, {what}");
                    at(place, located.element(element).value(value))
                }
                ArmError::NegativeMass { place, mass_kg } => {
                    let located = Located::new(file, Fault::NotAllowed, "must be at least 0 kg");
                    let element = format!("{place}, mass");
                    at(place, located.element(element).value(mass_kg).unit("kg"))
                }
                ArmError::Axis(joint) | ArmError::DuplicateJoint(joint) => {
                    at(&format!("joint '{joint}'"), new(Fault::NotAllowed))
                }
                ArmError::NoJoint | ArmError::Parent { .. } => new(Fault::Contradiction),
            },
        }
    }
}

/// Returns the line, from 1, of `joint 'NAME'` or `link 'NAME'`; 0 if it is not found.
pub fn line_of(text: &str, element: &str) -> u64 {
    let Some((tag, name)) = element.split_once(" '") else {
        return 0;
    };
    let name = name.trim_end_matches('\'');
    let names = [format!("name=\"{name}\""), format!("name='{name}'")];
    let start = format!("<{tag} ");
    let found = text.match_indices(&start).find(|(at, _)| {
        let opening = text[*at..].split('>').next().unwrap_or_default();
        names.iter().any(|name| opening.contains(name.as_str()))
    });
    found.map_or(0, |(at, _)| {
        1 + text[..at].bytes().filter(|b| *b == b'\n').count() as u64
    })
}
