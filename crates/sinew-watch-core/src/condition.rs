//! Alarm conditions, severities and levels.

use serde::{Deserialize, Serialize};

/// Condition that an alarm reports. Names, severities and states follow ISA-18.2 and OPC UA part 9.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Condition {
    /// A tendon transmits no torque: torn, off its pulley, or detached from its motor.
    TransmissionLost,
    /// The strain exceeds the replacement limit with a probability of at least 0.95.
    ReplaceLimit,
    /// A step change with stiffness loss was confirmed.
    #[serde(alias = "strand-failed")]
    StrandFailure,
    /// A step change was confirmed by a second session.
    #[serde(alias = "jump")]
    StepChange,
    /// The elongation exceeds the re-tensioning limit with a probability of at least 0.95.
    RetensionLimit,
    /// A limit may be exceeded within the warning time (default: 14 days).
    LimitNear,
    /// A step change is suspected, or an offset has been provisional for too long (default: 10 min of motion).
    #[serde(alias = "suspicion")]
    SuspectedStep,
    /// The data are invalid, e.g. channels missing, swapped or in degrees, or frames lost.
    Data,
    /// Results cannot be stored.
    Store,
    /// The transport of the robot's messages is disconnected: the monitor receives nothing, whatever the robot does.
    #[serde(alias = "door")]
    Transport,
    /// No data are received.
    NoData,
}

/// Severity of a suspected strand failure: above a re-tensioning limit.
pub(crate) const SUSPECTED_FAILURE_SEVERITY: u16 = 610;

impl Condition {
    /// All conditions, in descending order of severity.
    pub const ALL: [Self; 11] = [
        Self::TransmissionLost,
        Self::ReplaceLimit,
        Self::StrandFailure,
        Self::StepChange,
        Self::Store,
        Self::Transport,
        Self::RetensionLimit,
        Self::LimitNear,
        Self::SuspectedStep,
        Self::Data,
        Self::NoData,
    ];

    /// Severity of the condition, 1 to 1000.
    pub fn severity(self) -> u16 {
        match self {
            Self::TransmissionLost => 950,
            Self::ReplaceLimit => 900,
            Self::StrandFailure => 800,
            Self::StepChange => 700,
            Self::Store => 650,
            Self::Transport => 620,
            Self::RetensionLimit => 600,
            Self::LimitNear => 400,
            Self::SuspectedStep | Self::Data => 300,
            Self::NoData => 200,
        }
    }

    /// Highest severity of an alarm with this condition over all causes, 1 to 1000.
    pub fn max_severity(self) -> u16 {
        match self {
            Self::SuspectedStep => SUSPECTED_FAILURE_SEVERITY,
            other => other.severity(),
        }
    }

    /// Whether the condition is a sudden change of a tendon, which belongs to its incident.
    pub fn is_change(self) -> bool {
        matches!(
            self,
            Self::TransmissionLost | Self::StrandFailure | Self::StepChange | Self::SuspectedStep
        )
    }

    /// Whether the alarm latches until the tendon is re-tensioned or replaced, or the alarm is reset: damage to a rope
    /// does not clear automatically.
    pub fn latches(self) -> bool {
        matches!(
            self,
            Self::TransmissionLost | Self::ReplaceLimit | Self::StrandFailure | Self::StepChange
        )
    }

    /// Whether an operator has to acknowledge the alarm after it has cleared. A robot that is switched off every night
    /// needs no acknowledgement every morning, nor does a network that started later than the monitor.
    pub fn needs_acknowledgement(self) -> bool {
        !matches!(self, Self::NoData | Self::Transport)
    }

    /// Level that `/diagnostics` reports for this condition.
    pub fn level(self) -> Level {
        match self {
            Self::NoData => Level::Stale,
            _ if self.latches() || matches!(self, Self::Store | Self::Transport) => Level::Error,
            _ => Level::Warn,
        }
    }
}

/// State of a tendon or a robot, with the names and numbers of `diagnostic_msgs/DiagnosticStatus`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "UPPERCASE")]
pub enum Level {
    /// Normal state: no action is required.
    #[default]
    Ok,
    /// Warning: inspection recommended.
    Warn,
    /// Error: action is required.
    Error,
    /// Stale: no current data.
    Stale,
}

impl Level {
    /// Value of the `level` field in `DiagnosticStatus`.
    pub fn number(self) -> u8 {
        self as u8
    }

    /// Returns the most urgent of several levels; [`Level::Ok`] if there are none.
    pub fn worst(levels: impl IntoIterator<Item = Self>) -> Self {
        let levels = levels.into_iter();
        levels.max_by_key(|l| l.urgency()).unwrap_or_default()
    }

    /// Rank for sorting by urgency: an error precedes a stale state, which precedes a warning.
    pub fn urgency(self) -> u8 {
        match self {
            Self::Error => 3,
            Self::Stale => 2,
            Self::Warn => 1,
            Self::Ok => 0,
        }
    }
}

/// Key that identifies an alarm of a robot.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AlarmKey {
    /// Name of the joint; `None`: the robot as a whole.
    pub joint: Option<String>,
    /// Condition of the alarm.
    pub condition: Condition,
}
