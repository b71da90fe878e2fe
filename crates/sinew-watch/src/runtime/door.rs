//! How a door is.

use serde::Serialize;

/// Why a door is shut.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Shut {
    /// Which, such as `dds:0`.
    pub door: String,
    /// What the system said.
    pub why: String,
}

/// How a door is.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DoorNow {
    /// Its name, such as `dds:0` or `mcap:run.mcap`.
    pub door: String,
    /// Why nothing can come through it; `None`: it is open.
    pub shut: Option<String>,
    /// Messages received so far of topics that some robot wants.
    #[serde(skip)]
    pub messages: u64,
}
