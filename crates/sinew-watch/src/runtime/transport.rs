//! State of a transport.

use serde::Serialize;

/// Disconnection of a transport.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Disconnected {
    /// Name of the transport, such as `dds:0`.
    pub transport: String,
    /// Reason of the disconnection.
    pub reason: String,
}

/// State of a transport.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TransportView {
    /// Name of the transport, such as `dds:0` or `mcap:run.mcap`.
    pub transport: String,
    /// Reason of the disconnection; `None`: connected.
    #[serde(rename = "shut")]
    pub disconnected: Option<String>,
    /// Number of messages received so far on topics that a robot requires.
    #[serde(skip)]
    pub messages: u64,
}
