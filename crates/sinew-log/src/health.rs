//! Losses, repairs and implausible signals of a recording, with their reasons.

use serde::{Deserialize, Serialize};

use crate::frame::Quantity;
use crate::motor_ratio::MotorRatio;

/// Maximum number of events kept; later ones are only counted.
pub const EVENT_LIMIT: usize = 256;
/// Share of missing samples of a stream above which data count as lost (exit code 3 of the command line).
pub const MUCH_LOST: f64 = 0.05;
/// Maximum number of names of unknown joints.
pub(crate) const UNKNOWN_LIMIT: usize = 64;

/// Kind of an event during reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum EventKind {
    /// Gap longer than the gap limit.
    Gap,
    /// Clock of the time stamps that stepped back or ahead.
    ClockStep,
    /// Messages that were discarded, because they were later than the reorder window.
    Late,
    /// Damage of the file.
    Damage,
    /// Message or row that could not be decoded and was skipped.
    Undecodable,
    /// Implausible signal that could be read.
    ImplausibleSignal,
}

/// Event during reading.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Event {
    /// Time of the event in the recording, ns; 0 if unknown.
    pub time_ns: i64,
    /// Kind of the event.
    pub kind: EventKind,
    /// Description of the event, with numbers and units.
    pub text: String,
}

/// Part of the file that could not be read.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Damage {
    /// Byte offset of the start of the damage.
    pub offset: u64,
    /// Number of bytes lost.
    pub bytes: u64,
    /// Time stamp of the last valid sample before the damage, ns.
    pub after_ns: Option<i64>,
    /// Reason why the bytes could not be used.
    pub reason: String,
}

/// Number of affected samples of one signal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SignalCount {
    /// Quantity of the signal.
    pub quantity: Quantity,
    /// Name of the joint, motor or tendon.
    pub joint: String,
    /// Number of samples, or of turns.
    pub count: u64,
}

/// Role of a stream of samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum StreamRole {
    /// Both sides: rows of a table, or one topic.
    BothSides,
    /// Positions of the joints.
    JointSide,
    /// Positions of the motors.
    MotorSide,
    /// External torques of the joints.
    ExternalTorque,
    /// Tensions of the tendons.
    Tension,
}

/// Timing of one stream of samples: a topic, or the rows of a table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StreamTiming {
    /// Role of the stream.
    pub role: StreamRole,
    /// Number of samples with distinct time stamps.
    pub samples: u64,
    /// Typical interval of the samples, s; `None` with too few samples.
    pub step_s: Option<f64>,
    /// Standard deviation of the shorter intervals from the typical one, s.
    pub jitter_s: Option<f64>,
    /// Number of missing samples; `None` if the intervals are too irregular.
    pub missing: Option<u64>,
    /// Number of samples that were discarded, because their time stamp was a duplicate with other values.
    pub repeated: u64,
}

/// Coverage of a recording by the position of a joint or motor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SignalCoverage {
    /// Quantity of the signal.
    pub quantity: Quantity,
    /// Name of the joint or motor.
    pub joint: String,
    /// Share of the frames with a value, 0 to 1.
    pub share: f64,
    /// Longest interval without a value, including those before the first and after the last one, s.
    pub longest_interval_s: f64,
    /// Share of the values that equal the one before, 0 to 1.
    pub repeated_share: f64,
    /// Number of encoder wrap-arounds that were corrected.
    pub unwrapped: u64,
}

/// Position that is recorded from a later time on than the recording starts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LateStart {
    /// Quantity of the signal.
    pub quantity: Quantity,
    /// Name of the joint or motor.
    pub joint: String,
    /// Time of its first sample since the start of the recording, s.
    pub after_s: f64,
}

/// Samples of a second publisher on the topic of a stream.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SecondPublisher {
    /// Role of the stream.
    pub stream: StreamRole,
    /// Number of samples that were excluded.
    pub samples: u64,
}

impl StreamTiming {
    /// Adds further samples of the stream, which have other time stamps.
    pub(crate) fn add(&mut self, further: &StreamTiming) {
        self.samples += further.samples;
        self.repeated += further.repeated;
        self.missing = self.missing.map(|n| n + further.missing.unwrap_or(0));
    }

    /// Share of all samples that are missing or were discarded, 0 to 1.
    pub fn lost_share(&self) -> f64 {
        let lost = self.missing.unwrap_or(0) + self.repeated;
        lost as f64 / (self.samples + lost).max(1) as f64
    }
}

/// Content, losses and repairs of a recording, with their reasons. Complete after the last frame.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Health {
    /// Number of frames returned.
    pub frames: u64,
    /// Number of messages (MCAP, of the topics used) or rows (tables) read.
    pub messages: u64,
    /// Number of messages discarded, because they were later than the reorder window.
    pub late: u64,
    /// Number of messages discarded, because their time stamp was a duplicate.
    pub duplicates: u64,
    /// Number of messages reordered by time stamp.
    pub out_of_order: u64,
    /// Timing of each stream: that of the joint side or of the table's rows first.
    pub streams: Vec<StreamTiming>,
    /// Samples of second publishers, such as a node that repeats a fixed pose; excluded.
    #[serde(default)]
    pub second_publishers: Vec<SecondPublisher>,
    /// Number of gaps longer than the gap limit.
    pub gaps: u64,
    /// Duration of the longest gap, s.
    pub longest_gap_s: f64,
    /// Number of steps of the clock of the time stamps: back, or ahead while the recorder's clock continued.
    pub clock_steps: u64,
    /// Number of NaN or infinite samples per signal; they are NaN in the frames.
    pub non_finite: Vec<SignalCount>,
    /// Number of encoder wrap-arounds that were corrected, per signal.
    pub unwrapped: Vec<SignalCount>,
    /// Coverage of the recording by each position, joint by joint.
    #[serde(default)]
    pub signals: Vec<SignalCoverage>,
    /// Positions that are recorded from a later time on than the recording starts.
    #[serde(default)]
    pub late_starts: Vec<LateStart>,
    /// Number of frames in which no joint has a motor position.
    pub frames_without_motor_side: u64,
    /// Number of frames in which no joint has a joint position.
    pub frames_without_joint_side: u64,
    /// Joints in messages that were not there at the start of the recording; ignored.
    pub unknown_joints: Vec<String>,
    /// Number of messages that could not be decoded.
    pub undecodable: u64,
    /// Number of messages without a time stamp in a topic with time stamps; their time follows from that of
    /// their receipt.
    #[serde(default)]
    pub unstamped: u64,
    /// Number of messages with fewer values than names; the missing values are NaN.
    pub short_messages: u64,
    /// Number of rows with more or fewer cells than the header.
    pub ragged_rows: u64,
    /// Number of rows without a time; discarded.
    pub rows_without_time: u64,
    /// Number of bytes of the file that could not be used.
    pub bytes_lost: u64,
    /// Damaged parts of the file, with the reasons.
    pub damage: Vec<Damage>,
    /// Motors whose position is a constant multiple of the joint position that is not near one.
    #[serde(default)]
    pub motor_ratios: Vec<MotorRatio>,
    /// Implausible signals: degrees, constant, gear ratio, all NaN.
    pub implausible_signals: Vec<String>,
    /// Events in reading order, at most [`EVENT_LIMIT`].
    pub events: Vec<Event>,
    /// Number of events beyond the limit.
    pub events_dropped: u64,
}

impl Health {
    /// Whether a part of the file could not be read (exit code 3 of the command line).
    pub fn is_damaged(&self) -> bool {
        !self.damage.is_empty()
    }

    /// Whether anything was lost: damage, or discarded messages.
    pub fn is_lossy(&self) -> bool {
        self.is_damaged()
            || self.late > 0
            || self.undecodable > 0
            || self.rows_without_time > 0
            || self.has_lost_much()
    }

    /// Whether more than [`MUCH_LOST`] of a stream's samples are missing or were discarded.
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
        // Only the first few are described, because a broken publisher would fill the list otherwise.
        const MAX_DESCRIBED: u64 = 16;
        self.undecodable += 1;
        if self.undecodable <= MAX_DESCRIBED {
            self.event(time_ns, EventKind::Undecodable, text);
        }
    }

    pub(crate) fn implausible_signal(&mut self, text: String) {
        self.event(0, EventKind::ImplausibleSignal, || text.clone());
        if self.implausible_signals.len() < EVENT_LIMIT {
            self.implausible_signals.push(text);
        }
    }
}
