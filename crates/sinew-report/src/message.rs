//! Messages with the code under which the manual describes them.

use serde::Serialize;
use std::fmt;

/// A warning or note for the user.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Message {
    /// Value of `kind` in JSON, such as `few-poses`; heading of the message in the manual.
    pub code: String,
    /// Finding with value and unit, effect, and recommended action.
    pub text: String,
}

impl Message {
    /// Makes a message from a result's warning, whose `kind` becomes the code.
    pub(crate) fn of<T: Serialize>(warning: &T, text: String) -> Self {
        let code = sinew_files::json_kind(warning);
        Self { code, text }
    }
}

impl Message {
    /// Formats the message to follow the word `warning` or `note`: `[few-poses]: text`.
    pub fn tag(&self) -> String {
        match self.code.as_str() {
            "" => format!(": {}", self.text),
            code => format!("[{code}]: {}", self.text),
        }
    }
}

/// Writes `[few-poses] text`.
impl fmt::Display for Message {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.code.as_str() {
            "" => f.write_str(&self.text),
            code => write!(f, "[{code}] {}", self.text),
        }
    }
}
