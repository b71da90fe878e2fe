//! What was lost, repaired or suspicious in a recording, and why.

use serde::{Deserialize, Serialize};

use crate::frame::Quantity;

/// How many events are kept; later ones are only counted.
pub const EVENT_LIMIT: usize = 256;
/// So much of a stream that is missing is data lost (exit code 3 of the command line).
pub const MUCH_LOST: f64 = 0.05;
/// How many names of unknown joints are kept.
pub(crate) const UNKNOWN_LIMIT: usize = 64;

/// What kind of thing happened.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum EventKind {
    /// A pause longer than the gap limit.
    Gap,
    /// The recording's clock went back for good.
    ClockJump,
    /// Messages came too late to be sorted in and were dropped.
    Late,
    /// The file is damaged here.
    Damage,
    /// A message or row could not be decoded and was skipped.
    Undecodable,
    /// Something looks wrong with the data although it could be read.
    Suspicion,
}

/// Something that happened while reading.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Event {
    /// Time of the recording at which it happened, ns; 0 where unknown.
    pub time_ns: i64,
    /// What kind of event it is.
    pub kind: EventKind,
    /// What happened, with numbers and units.
    pub text: String,
}

/// A part of the file that could not be read.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Damage {
    /// Byte offset where the damage starts.
    pub offset: u64,
    /// How many bytes were lost.
    pub bytes: u64,
    /// Last time known good before the damage, ns.
    pub after_ns: Option<i64>,
    /// Why the bytes could not be used.
    pub reason: String,
}

/// Bad samples of one signal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SignalCount {
    /// The quantity.
    pub quantity: Quantity,
    /// The joint's name.
    pub joint: String,
    /// How many samples, or turns.
    pub count: u64,
}

/// What a stream of samples brings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum StreamRole {
    /// Both sides: rows of a table, or one topic.
    BothSides,
    /// Joint positions.
    JointSide,
    /// Motor positions.
    MotorSide,
    /// External torques.
    ExternalTorque,
}

/// When the samples of one stream came: a topic, or the rows of a table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StreamTiming {
    /// What it brings.
    pub role: StreamRole,
    /// Samples with a stamp of their own.
    pub samples: u64,
    /// Usual step from one to the next, s; `None` with too few.
    pub step_s: Option<f64>,
    /// How much shorter a step is than usual, one standard deviation, s.
    pub jitter_s: Option<f64>,
    /// Samples that the steps between the others leave out; `None` where steps are too uneven to tell.
    pub missing: Option<u64>,
    /// Samples dropped because another one with their stamp was there already, and said something else.
    pub repeated: u64,
}

impl StreamTiming {
    /// Part of all samples that are missing or were dropped, 0 to 1.
    pub fn lost_share(&self) -> f64 {
        let lost = self.missing.unwrap_or(0) + self.repeated;
        lost as f64 / (self.samples + lost).max(1) as f64
    }
}

/// What was read, what was lost and why. Complete after the last frame.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Health {
    /// Frames handed out.
    pub frames: u64,
    /// Messages (MCAP, of the topics used) or rows (tables) read.
    pub messages: u64,
    /// Messages dropped because they came later than the reorder window.
    pub late: u64,
    /// Messages dropped because their stamp had been seen already.
    pub duplicates: u64,
    /// Messages that came out of order and were sorted in.
    pub out_of_order: u64,
    /// When the samples came, stream by stream: the joint side's or the table's rows first.
    pub streams: Vec<StreamTiming>,
    /// Pauses longer than the gap limit.
    pub gaps: u64,
    /// The longest such pause, s.
    pub longest_gap_s: f64,
    /// How often the clock went back for good.
    pub clock_jumps: u64,
    /// Recorded samples that were NaN or infinite, per signal; they are NaN in the frames.
    pub non_finite: Vec<SignalCount>,
    /// Encoder wrap-arounds removed, per signal.
    pub unwrapped: Vec<SignalCount>,
    /// Frames in which no joint has a motor position.
    pub frames_without_motor_side: u64,
    /// Frames in which no joint has a joint position.
    pub frames_without_joint_side: u64,
    /// Joints found in messages but not at the start of the recording: ignored.
    pub unknown_joints: Vec<String>,
    /// Messages that could not be decoded.
    pub undecodable: u64,
    /// Messages with fewer values than names: the missing values are NaN.
    pub short_messages: u64,
    /// Rows with more or fewer cells than the header.
    pub ragged_rows: u64,
    /// Rows without a time: dropped.
    pub rows_without_time: u64,
    /// Bytes of the file that could not be used.
    pub bytes_lost: u64,
    /// Where and why bytes were lost.
    pub damage: Vec<Damage>,
    /// Signals that look wrong: degrees, constant, gear ratio, all NaN.
    pub suspicions: Vec<String>,
    /// What happened, in reading order, at most [`EVENT_LIMIT`].
    pub events: Vec<Event>,
    /// Events beyond the limit.
    pub events_dropped: u64,
}

impl Health {
    /// Whether a part of the file could not be read (exit code 3 of the command line).
    pub fn is_damaged(&self) -> bool {
        !self.damage.is_empty()
    }

    /// Whether anything at all was lost: damage, or messages dropped.
    pub fn is_lossy(&self) -> bool {
        self.is_damaged()
            || self.late > 0
            || self.undecodable > 0
            || self.rows_without_time > 0
            || self.has_lost_much()
    }

    /// Whether more than [`MUCH_LOST`] of a stream's samples are missing or were dropped.
    pub fn has_lost_much(&self) -> bool {
        self.streams.iter().any(|s| s.lost_share() > MUCH_LOST)
    }

    pub(crate) fn event(&mut self, time_ns: i64, kind: EventKind, text: impl FnOnce() -> String) {
        if self.events.len() < EVENT_LIMIT {
            self.events.push(Event {
                time_ns,
                kind,
                text: text(),
            });
        } else {
            self.events_dropped += 1;
        }
    }

    pub(crate) fn damaged(
        &mut self,
        offset: u64,
        bytes: u64,
        after_ns: Option<i64>,
        reason: String,
    ) {
        self.bytes_lost += bytes;
        self.event(after_ns.unwrap_or(0), EventKind::Damage, || {
            format!("byte {offset}: {reason} ({bytes} bytes lost)")
        });
        if self.damage.len() < EVENT_LIMIT {
            self.damage.push(Damage {
                offset,
                bytes,
                after_ns,
                reason,
            });
        }
    }

    pub(crate) fn undecodable(&mut self, time_ns: i64, text: impl FnOnce() -> String) {
        // The first few say why; a broken publisher would fill the list otherwise.
        const SHOWN: u64 = 16;
        self.undecodable += 1;
        if self.undecodable <= SHOWN {
            self.event(time_ns, EventKind::Undecodable, text);
        }
    }

    pub(crate) fn suspicion(&mut self, text: String) {
        self.event(0, EventKind::Suspicion, || text.clone());
        if self.suspicions.len() < EVENT_LIMIT {
            self.suspicions.push(text);
        }
    }
}
