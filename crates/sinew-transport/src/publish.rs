//! Published messages: two kinds, and no other.

use sinew_log::encode::{DiagnosticArray, DynamicJointState, EncodeError, Message as _, Schema};

/// Message that Sinew publishes. There is no third kind: nothing here commands a robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outgoing<'a> {
    /// `/diagnostics`: one status per tendon.
    Diagnostics(DiagnosticArray<'a>),
    /// `NAMESPACE/sinew/tendons`: state of the tendons, for plotting tools.
    Tendons {
        /// Namespace of the robot's topics: empty, or a name that begins with `/`.
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
    /// Returns an error if a string or sequence is too long for CDR.
    pub fn encode(&self, cdr: &mut Vec<u8>) -> Result<(), EncodeError> {
        match self {
            Outgoing::Diagnostics(array) => array.encode(cdr),
            Outgoing::Tendons { state, .. } => state.encode(cdr),
        }
    }
}

/// Selection of the published messages.
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
    /// Publishes nothing: no writer is announced either.
    pub const DISABLED: Self = Publishing {
        diagnostics: false,
        tendons: false,
    };

    /// Whether the message is selected for publication.
    pub fn allows(&self, message: &Outgoing<'_>) -> bool {
        match message {
            Outgoing::Diagnostics(_) => self.diagnostics,
            Outgoing::Tendons { .. } => self.tendons,
        }
    }
}

/// Error that prevents the publication of a message.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PublishError {
    /// The message cannot be serialised.
    #[error(transparent)]
    Encode(#[from] EncodeError),
    /// The network library rejected the message.
    #[error("{topic}: not published: {reason}")]
    Rejected {
        /// Name of the topic.
        topic: String,
        /// Reason given by the library.
        reason: String,
    },
    /// The transport is closed.
    #[error("{topic}: not published: the transport is closed")]
    Closed {
        /// Name of the topic.
        topic: String,
    },
}

/// Publishing side of a transport.
pub trait Publisher: Send {
    /// Publishes a message; one that is switched off is ignored without an error.
    ///
    /// # Errors
    /// Returns a [`PublishError`] if the message cannot be serialised or sent; the next message may succeed.
    fn publish(&mut self, message: &Outgoing<'_>) -> Result<(), PublishError>;
}
