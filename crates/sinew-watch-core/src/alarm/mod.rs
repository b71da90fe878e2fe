//! Alarms: raised and cleared by conditions; acknowledged, shelved and reset by operators.
//!
//! ```text
//!             raised                acknowledged             cleared
//!   normal ───────────▶ active ────────────────▶ acknowledged ─────────────▶ normal
//!     ▲                   │ cleared                     │ cleared, if it latches
//!     │ acknowledged      ▼                             ▼
//!     └──────────── cleared                         latched ── tensioned, replaced, reset ─▶ normal
//!                   latched, if it latches
//! ```
//!
//! [`Condition::latches`] defines which conditions latch. A condition that needs no acknowledgement
//! ([`Condition::needs_acknowledgement`]) goes from active to normal.

mod list;

pub use crate::condition::{AlarmKey, Condition, Level};
pub use list::{Alarms, AlarmsStored, Delays};

use crate::command::CommandKind;
use crate::condition::SUSPECTED_FAILURE_SEVERITY;
use serde::{Deserialize, Serialize};
use sinew_estimate::Cause;
use sinew_trend::Limit;

/// State of an alarm.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum AlarmState {
    /// The condition is present and not acknowledged.
    Active,
    /// The condition is present and acknowledged.
    Acknowledged,
    /// The condition has cleared and was not acknowledged.
    Cleared,
    /// The condition has cleared; the alarm remains until the tendon is re-tensioned or replaced, or the alarm is
    /// reset.
    Latched,
    /// The condition is absent and needs no acknowledgement.
    Normal,
}

impl AlarmState {
    /// Whether an alarm in this state is active: its condition is present, or it is latched until it is reset.
    pub fn is_active(self) -> bool {
        match self {
            Self::Active | Self::Acknowledged | Self::Latched => true,
            Self::Cleared | Self::Normal => false,
        }
    }
}

/// Alarm that is not in the normal state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Alarm {
    /// Joint and condition of the alarm.
    pub key: AlarmKey,
    /// State of the alarm.
    pub state: AlarmState,
    /// Whether an operator has acknowledged the alarm.
    pub acknowledged: bool,
    /// Time at which the alarm was raised, s since 1970 UTC.
    pub raised_utc_s: f64,
    /// Newest cause of the alarm; the journal has the cause at the raising.
    pub cause: AlarmCause,
    /// End of the shelving, s since 1970 UTC; `None`: not shelved.
    pub shelved_until_utc_s: Option<f64>,
    /// Duration of the shelving, s; a backward step of the civil clock does not extend it.
    pub shelved_for_s: Option<f64>,
}

impl Alarm {
    /// Whether the alarm is active: its condition is present, or the alarm is latched until it is reset by a repair or
    /// an operator. Shelving and acknowledgement do not end it.
    pub fn is_active(&self) -> bool {
        self.state.is_active()
    }

    /// Returns the severity, 1 to 1000, by condition and cause.
    pub fn severity(&self) -> u16 {
        self.cause.severity(self.key.condition)
    }

    /// Returns the displayed level; shelving hides everything except errors.
    pub fn level(&self) -> Level {
        let level = self.key.condition.level();
        match self.shelved_until_utc_s {
            Some(_) if level != Level::Error => Level::Ok,
            _ if self.state == AlarmState::Cleared => Level::Ok,
            _ => level,
        }
    }
}

/// Cause of an alarm in machine-readable form; messages are formatted where they are displayed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum AlarmCause {
    /// A limit is exceeded.
    Limit {
        /// Estimated elongation, m, or strain, ratio.
        mean: f64,
        /// Standard deviation of the estimate, in the same unit.
        #[serde(alias = "deviation")]
        std: f64,
        /// Configured limit, in the same unit.
        limit: f64,
        /// Probability that the limit is exceeded, 0…1.
        probability: f64,
        /// Origin of the limit.
        origin: LimitOrigin,
    },
    /// A limit may be exceeded soon.
    Soon {
        /// Limit that is exceeded first; `None`: raised by an earlier version, until the next trend.
        #[serde(default)]
        limit: Option<Limit>,
        /// 2.5 % quantile of the time at which the limit is exceeded, s since 1970 UTC.
        #[serde(default)]
        at_low_utc_s: Option<f64>,
        /// Median of that time, s since 1970 UTC; `None`: beyond the forecast horizon.
        #[serde(default)]
        at_utc_s: Option<f64>,
        /// 97.5 % quantile of that time, s since 1970 UTC; `None`: beyond the forecast horizon.
        #[serde(default)]
        at_high_utc_s: Option<f64>,
    },
    /// A tendon has a step change.
    #[serde(alias = "jump")]
    StepChange {
        /// Time of the step change, s since 1970 UTC.
        time_utc_s: f64,
        /// Size of the step change, rad; positive: tendon longer.
        size_rad: f64,
        /// Standard deviation of the size, rad.
        #[serde(alias = "deviation_rad")]
        std_rad: f64,
        /// Probable kind of the step change.
        what: StepKind,
        /// Part that slipped, if the data identify it.
        cause: Option<Cause>,
        /// Simultaneous relative change of stiffness; `None`: none detected.
        stiffness_ratio: Option<f64>,
    },
    /// An offset has been provisional for too long.
    #[serde(alias = "in-doubt")]
    Provisional {
        /// Duration of motion for which the offset has been provisional, s.
        for_s: f64,
    },
    /// The data are invalid.
    Data {
        /// Fault of the data.
        trouble: DataFault,
    },
    /// Results could not be stored.
    Store {
        /// Kind of storage failure.
        #[serde(default)]
        fault: StoreFault,
        /// Error message of the operating system or database.
        #[serde(alias = "why")]
        reason: String,
    },
    /// A transport is disconnected; the monitor reconnects.
    #[serde(alias = "door")]
    Transport {
        /// Name of the transport, such as `dds:0` or `mcap:run.mcap`.
        #[serde(alias = "door")]
        transport: String,
        /// Error message of the transport.
        #[serde(alias = "why")]
        reason: String,
    },
    /// No data were received.
    Silence {
        /// Time of the last data, s since 1970 UTC; `None`: none since the start.
        since_utc_s: Option<f64>,
    },
}

impl AlarmCause {
    /// Whether the cause replaces `other` as the newest cause of an alarm. Durations and shares that change with every
    /// frame, and errors that repeat, do not.
    fn supersedes(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Data { trouble }, Self::Data { trouble: before }) => {
                std::mem::discriminant(trouble) != std::mem::discriminant(before)
                    || (!trouble.is_graded() && trouble != before)
            }
            (Self::Provisional { .. }, Self::Provisional { .. })
            | (Self::Silence { .. }, Self::Silence { .. })
            | (Self::Store { .. }, Self::Store { .. }) => false,
            _ => self != other,
        }
    }
}

impl DataFault {
    /// Whether the fault has a magnitude that changes with the frames.
    fn is_graded(&self) -> bool {
        matches!(
            self,
            Self::NotFinite { .. }
                | Self::Lost { .. }
                | Self::FarApart { .. }
                | Self::NonMonotonicTime { .. }
        )
    }
}

impl AlarmCause {
    /// Returns the severity of an alarm with this cause, 1 to 1000: that of the condition, except for a suspected step
    /// change, which precedes a limit that is near, and as a suspected strand failure a re-tensioning limit.
    pub fn severity(&self, condition: Condition) -> u16 {
        match (self, condition) {
            (Self::StepChange { what, .. }, Condition::SuspectedStep) => match what {
                StepKind::StrandFailure | StepKind::SlipOrStrandFailure => {
                    SUSPECTED_FAILURE_SEVERITY
                }
                _ => 450,
            },
            (_, condition) => condition.severity(),
        }
    }
}

/// Reason for a storage failure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum StoreFault {
    /// The disk is full.
    Full,
    /// The folder or its disk is read-only.
    ReadOnly,
    /// The disk reports an error.
    Disk,
    /// The database is corrupt.
    Damaged,
    /// Other failure, described in the log.
    #[default]
    Other,
}

/// Probable kind of a step change.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum StepKind {
    /// Change of offset without stiffness loss: rope, clamp or encoder slipped.
    Slip,
    /// No torque is transmitted: the tendon is torn or off its pulley, or its motor side is detached.
    TransmissionLost,
    /// Stiffness loss: a strand failed.
    StrandFailure,
    /// Slip and strand failure are not distinguishable.
    SlipOrStrandFailure,
    /// Change between two sessions: rope, clamp, or a re-homed encoder.
    WhileOff,
    /// Decrease of the offset: probable unrecorded re-tensioning.
    Retensioned,
}

/// Origin of a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum LimitOrigin {
    /// The limit is specified in robot.toml.
    RobotToml,
    /// The limit comes from the rope catalogue.
    Catalogue,
}

/// Fault of the received data.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "trouble", rename_all = "kebab-case")]
pub enum DataFault {
    /// Positions are NaN or infinite.
    NotFinite {
        /// Share of affected frames, 0…1.
        share: f64,
    },
    /// Many frames were lost.
    Lost {
        /// Share of affected frames, 0…1.
        share: f64,
    },
    /// A position is constant while the other side moves.
    Dead {
        /// Whether the motor position is affected; otherwise the joint position.
        motor: bool,
    },
    /// Motor and joint position are identical: the spring never deflects while the joint moves.
    OneSignal,
    /// The difference of joint and motor position is implausible: unit is degrees, or the gear ratio is missing.
    FarApart {
        /// Mean absolute difference, rad.
        apart_rad: f64,
    },
    /// The motor position follows another joint: two channels are swapped.
    Swapped {
        /// Name of the joint that the motor position follows.
        with: String,
    },
    /// Time stamps are not increasing; nothing can be estimated.
    #[serde(alias = "stamps-stand")]
    NonMonotonicTime {
        /// Share of affected frames, 0…1.
        share: f64,
    },
    /// The quality of service of a publisher is incompatible.
    Qos {
        /// Name of the topic.
        topic: String,
        /// Quality of service offered by the publisher.
        offered: String,
        /// Quality of service requested by the monitor.
        requested: String,
    },
    /// The messages of a topic cannot be decoded.
    Decode {
        /// Name of the topic.
        topic: String,
        /// Error message of the decoder.
        #[serde(alias = "why")]
        reason: String,
    },
    /// Joints or channels of robot.toml are missing in the received data.
    Missing {
        /// Name of the joint.
        joint: String,
        /// Whether the motor side is missing; otherwise the joint side.
        motor: bool,
    },
    /// The estimator rejected a segment.
    #[serde(alias = "refused")]
    Rejected {
        /// Error message of the estimator.
        #[serde(alias = "why")]
        reason: String,
    },
}

/// State transition of an alarm, for the journal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Transition {
    /// Joint and condition of the alarm.
    pub key: AlarmKey,
    /// State before the transition.
    pub from: AlarmState,
    /// State after the transition.
    pub to: AlarmState,
    /// Time of the transition, s since 1970 UTC.
    pub time_utc_s: f64,
    /// Reason for the transition.
    #[serde(alias = "why")]
    pub reason: TransitionReason,
}

/// Reason for the transition of an alarm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "by", rename_all = "kebab-case")]
pub enum TransitionReason {
    /// The condition became present or cleared.
    Condition {
        /// Cause of the alarm at the transition.
        cause: AlarmCause,
    },
    /// An operator commanded it.
    Command {
        /// Name of the operator.
        who: String,
        /// Command of the operator.
        what: CommandKind,
        /// Free text of the operator.
        note: String,
    },
    /// Another alarm of the same incident supersedes it.
    Superseded {
        /// Alarm that supersedes it.
        alarm: AlarmKey,
    },
    /// The recorded re-tensioning or replacement that ended the alarm was withdrawn.
    Withdrawn,
    /// The shelving expired.
    ShelfEnded,
}
