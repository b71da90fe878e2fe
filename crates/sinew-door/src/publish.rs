//! What may be published: two messages, and nothing else.

use sinew_log::encode::{DiagnosticArray, DynamicJointState, EncodeError, Message as _, Schema};

/// What Sinew says to others. There is no third kind: nothing here commands a robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outgoing<'a> {
    /// `/diagnostics`: one status for each tendon.
    Diagnostics(DiagnosticArray<'a>),
    /// `NAMESPACE/sinew/tendons`: the tendons' state, for whoever plots it.
    Tendons {
        /// What the robot's topics lie in: empty, or a name that begins with `/`.
        namespace: &'a str,
        /// Joints with their interfaces.
        state: DynamicJointState<'a>,
    },
}

impl Outgoing<'_> {
    /// Returns the name of the topic.
    pub fn topic(&self) -> String {
        match self {
            Outgoing::Diagnostics(_) => "/diagnostics".to_owned(),
            Outgoing::Tendons { namespace, .. } => {
                let namespace = namespace.trim_matches('/');
                let slash = if namespace.is_empty() { "" } else { "/" };
                format!("{slash}{namespace}/sinew/tendons")
            }
        }
    }

    /// Returns the type of the message.
    pub fn schema(&self) -> Schema {
        match self {
            Outgoing::Diagnostics(_) => DiagnosticArray::SCHEMA,
            Outgoing::Tendons { .. } => DynamicJointState::SCHEMA,
        }
    }

    /// Replaces `cdr` by the message.
    ///
    /// # Errors
    /// A string or sequence too long for CDR.
    pub fn encode(&self, cdr: &mut Vec<u8>) -> Result<(), EncodeError> {
        match self {
            Outgoing::Diagnostics(array) => array.encode(cdr),
            Outgoing::Tendons { state, .. } => state.encode(cdr),
        }
    }
}

/// Which of the two are published.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Publishing {
    /// Whether `/diagnostics` is published.
    pub diagnostics: bool,
    /// Whether `NAMESPACE/sinew/tendons` is published.
    pub tendons: bool,
}

impl Default for Publishing {
    fn default() -> Self {
        Publishing {
            diagnostics: true,
            tendons: true,
        }
    }
}

impl Publishing {
    /// Nothing is published: not even a writer is announced.
    pub const NOTHING: Self = Publishing {
        diagnostics: false,
        tendons: false,
    };

    /// Whether a message is.
    pub fn allows(&self, message: &Outgoing<'_>) -> bool {
        match message {
            Outgoing::Diagnostics(_) => self.diagnostics,
            Outgoing::Tendons { .. } => self.tendons,
        }
    }
}

/// Why a message wasn't published.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PublishError {
    /// It has no bytes.
    #[error(transparent)]
    Encode(#[from] EncodeError),
    /// The network's library refused it.
    #[error("{topic}: not published: {why}")]
    Refused {
        /// The topic's name.
        topic: String,
        /// The reason.
        why: String,
    },
    /// The door is shut.
    #[error("{topic}: not published: the door is shut")]
    Shut {
        /// The topic's name.
        topic: String,
    },
}

/// A door's way out.
pub trait Publisher: Send {
    /// Publishes a message; one that is switched off is none, and no error.
    ///
    /// # Errors
    /// [`PublishError`]; the next message may go through again.
    fn publish(&mut self, message: &Outgoing<'_>) -> Result<(), PublishError>;
}
