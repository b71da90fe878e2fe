//! Alarms: raised and cleared by conditions, acknowledged, shelved and reset by people.
//!
//! ```text
//!             raised                acknowledged             condition over
//!   normal ───────────▶ active ────────────────▶ acknowledged ─────────────▶ normal
//!     ▲                   │ condition over              │ condition over, if it latches
//!     │ acknowledged      ▼                             ▼
//!     └──────────── cleared                         latched ── tensioned, replaced, reset ─▶ normal
//!                   latched, if it latches
//! ```
//!
//! Which conditions latch: [`Condition::latches`]. What needs nobody's look ([`Condition::needs_look`]) goes from active to normal.

mod list;

pub use crate::condition::{AlarmKey, Condition, Level};
pub use list::{Alarms, AlarmsStored, Delays};

use crate::command::What;
use serde::{Deserialize, Serialize};
use sinew_estimate::Cause;

/// Where an alarm stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum AlarmState {
    /// It holds, and nobody has seen it.
    Active,
    /// It holds, and somebody has seen it.
    Acknowledged,
    /// It is over, and nobody has seen it.
    Cleared,
    /// It is over, and stays until somebody tensions, replaces or resets.
    Latched,
    /// It is over, or was never.
    Normal,
}

/// An alarm that isn't normal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Alarm {
    /// The alarm's joint and condition.
    pub key: AlarmKey,
    /// Where it stands.
    pub state: AlarmState,
    /// Whether somebody has seen it.
    pub acknowledged: bool,
    /// When it was raised, s since 1970 UTC.
    pub raised_utc_s: f64,
    /// What raised it.
    pub cause: AlarmCause,
    /// Shelved until then, s since 1970 UTC.
    pub shelved_until_utc_s: Option<f64>,
    /// How long a shelf it was, s: a civil clock that steps back doesn't lengthen it.
    pub shelved_for_s: Option<f64>,
}

impl Alarm {
    /// What it shows: a shelf hides all but an error.
    pub fn level(&self) -> Level {
        let level = self.key.condition.level();
        match self.shelved_until_utc_s {
            Some(_) if level != Level::Error => Level::Ok,
            _ if self.state == AlarmState::Cleared => Level::Ok,
            _ => level,
        }
    }
}

/// What raised an alarm, as data: words are made where it is shown.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum AlarmCause {
    /// A limit is passed.
    Limit {
        /// What was measured: elongation (m) or strain (a fraction).
        mean: f64,
        /// Its standard deviation.
        deviation: f64,
        /// The limit, in the same unit.
        limit: f64,
        /// Probability that it is passed.
        probability: f64,
        /// Where the limit comes from.
        origin: LimitOrigin,
    },
    /// A limit may be passed soon.
    Soon {
        /// 2.5 % quantile of the time until then, s.
        after_low_s: f64,
        /// Median, s; `None`: beyond the forecast.
        after_s: Option<f64>,
    },
    /// A tendon changed suddenly.
    Jump {
        /// When, s since 1970 UTC.
        time_utc_s: f64,
        /// By how much, rad.
        size_rad: f64,
        /// Its standard deviation, rad.
        deviation_rad: f64,
        /// What may have happened.
        what: JumpKind,
        /// What slipped, where the readings tell.
        cause: Option<Cause>,
        /// Change of the stiffness with it, as a fraction; `None`: none was seen.
        stiffness_ratio: Option<f64>,
    },
    /// An offset has been provisional for so long.
    InDoubt {
        /// For so long, s.
        for_s: f64,
    },
    /// The data are wrong.
    Data {
        /// What is wrong with them.
        trouble: Trouble,
    },
    /// What is learned could not be stored.
    Store {
        /// What kind of failure.
        #[serde(default)]
        fault: StoreFault,
        /// What the system said.
        why: String,
    },
    /// A door is shut, and is tried again.
    Door {
        /// Which, such as `dds:0` or `mcap:run.mcap`.
        door: String,
        /// What the system said.
        why: String,
    },
    /// Nothing was received.
    Silence {
        /// Since then, s since 1970 UTC; `None`: since the start.
        since_utc_s: Option<f64>,
    },
}

/// Why nothing can be stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum StoreFault {
    /// The disk has no room.
    Full,
    /// The folder or its disk can't be written.
    ReadOnly,
    /// The disk fails.
    Disk,
    /// The database is damaged.
    Damaged,
    /// Something else, which the log names.
    #[default]
    Other,
}

/// What a sudden change may be.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum JumpKind {
    /// Offset without stiffness: rope, clamp or encoder slipped.
    Slip,
    /// Stiffness went with it: a strand failed.
    StrandFailure,
    /// Neither alone is sure.
    SlipOrStrandFailure,
    /// It changed while nobody watched: rope, clamp or an encoder homed anew.
    WhileOff,
    /// The offset went: somebody tensioned the tendon, and didn't say so.
    Retensioned,
}

/// Where a limit comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum LimitOrigin {
    /// The robot's robot.toml.
    RobotToml,
    /// The rope's entry in the catalogue.
    Catalogue,
}

/// What is wrong with the data.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "trouble", rename_all = "kebab-case")]
pub enum Trouble {
    /// Positions that aren't numbers.
    NotFinite {
        /// Share of the frames.
        share: f64,
    },
    /// Many frames were lost.
    Lost {
        /// Share of the frames.
        share: f64,
    },
    /// A position never changes while others do.
    Dead {
        /// Whether it is the motor's; else the joint's.
        motor: bool,
    },
    /// Motor and joint position are one signal: the spring never gives while the joint moves.
    OneSignal,
    /// Joint and motor positions are so far apart as degrees or a missing gear ratio make them.
    FarApart {
        /// Mean distance, rad.
        apart_rad: f64,
    },
    /// The motor position follows another joint: two channels are swapped.
    Swapped {
        /// The joint it follows.
        with: String,
    },
    /// Stamps that don't rise: nothing can be estimated.
    StampsStand {
        /// Share of the frames.
        share: f64,
    },
    /// A publisher's quality of service can't be received.
    Qos {
        /// The topic's name.
        topic: String,
        /// What it offers.
        offered: String,
        /// What is asked for.
        requested: String,
    },
    /// A topic's data can't be decoded.
    Decode {
        /// The topic's name.
        topic: String,
        /// What is wrong.
        why: String,
    },
    /// What is received doesn't fit robot.toml: joints or channels are missing.
    Missing {
        /// Name of the joint.
        joint: String,
        /// Whether it is the motor's side; else the joint's.
        motor: bool,
    },
    /// The estimator refused a stretch.
    Refused {
        /// What it said.
        why: String,
    },
}

/// One step of an alarm, for the journal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Transition {
    /// The alarm's joint and condition.
    pub key: AlarmKey,
    /// The state before.
    pub from: AlarmState,
    /// The state after.
    pub to: AlarmState,
    /// When, s since 1970 UTC.
    pub time_utc_s: f64,
    /// The reason.
    pub why: TransitionWhy,
}

/// Why an alarm took a step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "by", rename_all = "kebab-case")]
pub enum TransitionWhy {
    /// Its condition came to hold, or was over.
    Condition {
        /// What of it.
        cause: AlarmCause,
    },
    /// Somebody asked for it.
    Command {
        /// Name of who says it.
        who: String,
        /// What they did.
        what: What,
        /// What they add, in their words.
        note: String,
    },
    /// The end of its shelf.
    ShelfEnded,
}
