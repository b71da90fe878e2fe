//! What an alarm is about.

use serde::{Deserialize, Serialize};

/// What an alarm is about. Names, severities and states are those of ISA-18.2 and OPC UA part 9.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Condition {
    /// The strain at which the owner wants the rope replaced is passed with 95 %.
    ReplaceLimit,
    /// A jump with stiffness lost was confirmed.
    StrandFailed,
    /// A jump was confirmed by a second session.
    Jump,
    /// The elongation at which to tension again is passed with 95 %.
    RetensionLimit,
    /// A limit may be passed within two weeks.
    LimitNear,
    /// A jump that isn't confirmed, or ten minutes of a provisional offset.
    Suspicion,
    /// The data can't be what they should: missing, swapped, degrees, lost.
    Data,
    /// What is learned can't be stored.
    Store,
    /// The door that its messages come through is shut: the monitor hears nothing, whatever the robot does.
    Door,
    /// Nothing is received.
    NoData,
}

impl Condition {
    /// All, the most severe first.
    pub const ALL: [Self; 10] = [
        Self::ReplaceLimit,
        Self::StrandFailed,
        Self::Jump,
        Self::Store,
        Self::Door,
        Self::RetensionLimit,
        Self::LimitNear,
        Self::Suspicion,
        Self::Data,
        Self::NoData,
    ];

    /// Severity, 1 to 1000.
    pub fn severity(self) -> u16 {
        match self {
            Self::ReplaceLimit => 900,
            Self::StrandFailed => 800,
            Self::Jump => 700,
            Self::Store => 650,
            Self::Door => 620,
            Self::RetensionLimit => 600,
            Self::LimitNear => 400,
            Self::Suspicion | Self::Data => 300,
            Self::NoData => 200,
        }
    }

    /// Whether it stays until somebody tensions, replaces or resets: what happened to a rope is not undone by itself.
    pub fn latches(self) -> bool {
        matches!(self, Self::ReplaceLimit | Self::StrandFailed | Self::Jump)
    }

    /// Whether somebody has to have seen it, once it is over. A robot that is switched off every night
    /// needs no look every morning, nor does a network that came up later than the monitor.
    pub fn needs_look(self) -> bool {
        !matches!(self, Self::NoData | Self::Door)
    }

    /// What `/diagnostics` shows.
    pub fn level(self) -> Level {
        match self {
            Self::NoData => Level::Stale,
            _ if self.latches() || matches!(self, Self::Store | Self::Door) => Level::Error,
            _ => Level::Warn,
        }
    }
}

/// How a tendon or a robot is, in the words and numbers of `diagnostic_msgs/DiagnosticStatus`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "UPPERCASE")]
pub enum Level {
    /// Nothing to do.
    #[default]
    Ok,
    /// Look at it.
    Warn,
    /// Something has to be done.
    Error,
    /// Nothing is known now.
    Stale,
}

impl Level {
    /// Number of the message.
    pub fn number(self) -> u8 {
        self as u8
    }

    /// The worst of several; all is well where there is none.
    pub fn worst(levels: impl IntoIterator<Item = Self>) -> Self {
        let levels = levels.into_iter();
        levels.max_by_key(|l| l.urgency()).unwrap_or_default()
    }

    /// For sorting, the worst first: an error before what is stale, that before a warning.
    pub fn urgency(self) -> u8 {
        match self {
            Self::Error => 3,
            Self::Stale => 2,
            Self::Warn => 1,
            Self::Ok => 0,
        }
    }
}

/// What tells an alarm of a robot from the others.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AlarmKey {
    /// Joint; `None`: the robot as a whole.
    pub joint: Option<String>,
    /// What it is about.
    pub condition: Condition,
}
