//! Content of a recording: the result of `sinew log info`.

use serde::{Deserialize, Serialize};

use crate::error::{Ambiguity, LogError};
use crate::files::{Format, Progress, Recording, open_parts};
use crate::health::Health;
use crate::live::JointInfo;
use crate::options::OpenOptions;
use crate::sources::{SignalSource, TopicInfo, TopicUse};
use std::path::PathBuf;

/// Content and condition of a recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RecordingInfo {
    /// File as the user named it.
    pub file: String,
    /// Format of the file.
    pub format: Format,
    /// Number of frames.
    pub frames: u64,
    /// Time of the first frame, ns since the epoch of the recording's clock.
    pub start_time_ns: Option<i64>,
    /// Duration from the first frame to the last, s.
    pub duration_s: Option<f64>,
    /// Frames per second within segments.
    pub mean_rate_hz: Option<f64>,
    /// Shortest step from frame to frame within a segment, s.
    pub shortest_step_s: Option<f64>,
    /// Longest step from frame to frame within a segment, s.
    pub longest_step_s: Option<f64>,
    /// Parts without a gap, clock jump or damage.
    pub segments: u32,
    /// Joints in the recording's order.
    pub joints: Vec<JointInfo>,
    /// Tendons with a recorded tension, in the order of the recording; omitted if there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tendons: Vec<String>,
    /// Topics in the order of their names; empty for a table.
    pub topics: Vec<TopicInfo>,
    /// Source of each quantity.
    pub sources: Vec<SignalSource>,
    /// Sides with several candidate topics; no joint is read until one is chosen.
    pub ambiguous: Vec<Ambiguity>,
    /// Columns of a table that are not used.
    pub unused_columns: Vec<String>,
    /// Whether a temperature is recorded.
    pub temperature: bool,
    /// Whether the recording holds the robot's URDF.
    pub robot_description: bool,
    /// Whether anything was lost.
    pub lossy: bool,
    /// Losses and repairs of the recording.
    pub health: Health,
}

impl sinew_files::JsonDocument for RecordingInfo {
    const SCHEMA: &'static str = "sinew/log-info/2";
}

impl RecordingInfo {
    /// Reads files that are one recording to their end. If several topics could be a side, the first is used,
    /// and the result reports it.
    ///
    /// # Errors
    /// As [`open_parts`]; also returns [`LogError`] if there is no frame.
    pub fn of_files(
        paths: &[PathBuf],
        options: &OpenOptions,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<Self, LogError> {
        let mut options = options.clone();
        let mut open = Vec::<Ambiguity>::new();
        let mut recording = loop {
            match open_parts(paths, &options) {
                Err(LogError::Ambiguous(side)) if open.iter().all(|o| o.side != side.side) => {
                    let first = side.candidates.first().cloned();
                    match side.side {
                        TopicUse::MotorSide => options.motor_topic = first,
                        _ => options.joint_state_topic = first,
                    }
                    open.push(side);
                }
                opened => break opened?,
            }
        };
        let names = paths.iter().map(|f| f.display().to_string());
        let name = Vec::from_iter(names).join(", ");
        Ok(Self::of(&mut recording, &name, progress)?.undecided(open))
    }

    /// Reads a recording to its end; `name` is its name.
    ///
    /// # Errors
    /// As [`Recording::next_frame`], and no frame at all.
    pub fn of(
        recording: &mut Recording,
        name: &str,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<Self, LogError> {
        /// Number of frames between two reports of the progress.
        const FRAMES: u64 = 8192;
        let mut counter = FrameCounter::default();
        while let Some(frame) = recording.next_frame()? {
            let (time_ns, segment) = (frame.time_ns, frame.segment);
            counter.frame(time_ns, segment);
            if counter.frames().is_multiple_of(FRAMES) {
                progress(recording.progress());
            }
        }
        match counter.frames() {
            0 => Err(nothing(recording)),
            _ => Ok(counter.info(recording, name)),
        }
    }

    /// Creates the information of a recording with ambiguous topics, of which arbitrary ones were read; their values
    /// are not reported.
    #[must_use]
    pub fn undecided(mut self, ambiguous: Vec<Ambiguity>) -> Self {
        if ambiguous.is_empty() {
            return self;
        }
        let is_open = |name: &String| ambiguous.iter().any(|a| a.candidates.contains(name));
        for topic in self.topics.iter_mut().filter(|topic| is_open(&topic.name)) {
            topic.role = None;
        }
        // The checks of signals are not valid for topics chosen arbitrarily.
        self.health.implausible_signals.clear();
        self.health.motor_ratios.clear();
        self.health.non_finite.clear();
        self.health.unwrapped.clear();
        self.health.signals.clear();
        self.health.late_starts.clear();
        self.joints.clear();
        self.sources.clear();
        self.temperature = false;
        self.ambiguous = ambiguous;
        self
    }
}

/// Error of a recording that could be read but has no frame.
fn nothing(recording: &Recording) -> LogError {
    let health = recording.health();
    let reason = match (health.rows_without_time, health.undecodable) {
        (0, 0) => "it has no row and no message".to_owned(),
        (0, messages) => format!("none of {messages} messages can be decoded"),
        (rows, _) => format!("none of {rows} rows has a time"),
    };
    LogError::not_a_recording(recording.name(), format!("it contains no frame: {reason}"))
}

/// Time stamps of a recording, counted frame by frame.
#[derive(Debug, Clone, Copy, Default)]
pub struct FrameCounter {
    frames: u64,
    first_ns: Option<i64>,
    last: Option<(i64, u32)>,
    steps: u64,
    within_ns: i64,
    shortest_ns: Option<i64>,
    longest_ns: Option<i64>,
}

impl FrameCounter {
    /// Counts the next frame.
    pub fn frame(&mut self, time_ns: i64, segment: u32) {
        self.frames += 1;
        self.first_ns.get_or_insert(time_ns);
        if let Some((last_ns, last_segment)) = self.last
            && last_segment == segment
        {
            let step = time_ns.saturating_sub(last_ns);
            self.steps += 1;
            self.within_ns = self.within_ns.saturating_add(step);
            self.shortest_ns = Some(self.shortest_ns.map_or(step, |s| s.min(step)));
            self.longest_ns = Some(self.longest_ns.map_or(step, |s| s.max(step)));
        }
        self.last = Some((time_ns, segment));
    }

    /// Number of frames counted.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// Frames per second within segments.
    pub fn rate_hz(&self) -> Option<f64> {
        let rate_hz = self.steps as f64 / (1e-9 * self.within_ns as f64);
        Some(rate_hz).filter(|rate| rate.is_finite())
    }

    /// Content of `recording`, which has been read to its end; `file` is its name.
    pub fn info(&self, recording: &Recording, file: &str) -> RecordingInfo {
        let channels = recording.channels();
        let joints = recording.axes().zip(&channels.joints);
        let seconds = |ns: i64| 1e-9 * ns as f64;
        let ends = self.first_ns.zip(self.last);
        RecordingInfo {
            file: file.to_owned(),
            format: recording.format(),
            frames: self.frames,
            start_time_ns: self.first_ns,
            duration_s: ends.map(|(first, (last, _))| seconds(last.saturating_sub(first))),
            mean_rate_hz: self.rate_hz(),
            shortest_step_s: self.shortest_ns.map(seconds),
            longest_step_s: self.longest_ns.map(seconds),
            segments: self.last.map_or(0, |(_, segment)| segment + 1),
            joints: joints
                .map(|(axis, has)| JointInfo {
                    name: axis.name().to_owned(),
                    channels: has.iter().collect(),
                })
                .collect(),
            tendons: recording.tendons().to_vec(),
            topics: recording.topics(),
            sources: recording.sources(),
            ambiguous: Vec::new(),
            unused_columns: recording.unused_columns(),
            temperature: channels.temperature,
            robot_description: recording.robot_description().is_some(),
            lossy: recording.health().is_lossy(),
            health: recording.health().clone(),
        }
    }
}
