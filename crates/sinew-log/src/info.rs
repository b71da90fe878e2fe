//! What a recording holds: the answer of `sinew log info`.

use serde::{Deserialize, Serialize};

use crate::error::{Ambiguity, LogError};
use crate::files::{Format, Progress, Recording, open_parts};
use crate::health::Health;
use crate::live::JointInfo;
use crate::options::OpenOptions;
use crate::sources::{SignalSource, TopicInfo, TopicUse};
use std::path::PathBuf;

/// What a recording holds, and how well it could be read.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RecordingInfo {
    /// File as the user named it.
    pub file: String,
    /// Its format.
    pub format: Format,
    /// Number of frames.
    pub frames: u64,
    /// Time of the first frame, ns since the epoch of the recording's clock.
    pub start_time_ns: Option<i64>,
    /// From the first frame to the last, s.
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
    /// Topics in the order of their names; none of a table.
    pub topics: Vec<TopicInfo>,
    /// Where each quantity is read from.
    pub sources: Vec<SignalSource>,
    /// Sides that several topics could be; nothing is read of joints until one is chosen.
    pub ambiguous: Vec<Ambiguity>,
    /// Columns of a table that nothing is read from.
    pub unused_columns: Vec<String>,
    /// Whether a temperature is recorded.
    pub temperature: bool,
    /// Whether the recording holds the robot's URDF.
    pub robot_description: bool,
    /// Whether anything was lost.
    pub lossy: bool,
    /// What was lost or repaired.
    pub health: Health,
}

impl sinew_files::JsonDocument for RecordingInfo {
    const SCHEMA: &'static str = "sinew/log-info/1";
}

impl RecordingInfo {
    /// Reads files that are one recording to their end. Where several topics could be a side, the first is
    /// taken to look into the file, and the answer says so.
    ///
    /// # Errors
    /// As [`open_parts`], and no frame at all.
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

    /// Reads a recording to its end; `name` is what it is called.
    ///
    /// # Errors
    /// As [`Recording::next_frame`], and no frame at all.
    pub fn of(
        recording: &mut Recording,
        name: &str,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<Self, LogError> {
        /// So often is told how far it is.
        const FRAMES: u64 = 8192;
        let mut pace = Pace::default();
        while let Some(frame) = recording.next_frame()? {
            let (time_ns, segment) = (frame.time_ns, frame.segment);
            pace.frame(time_ns, segment);
            if pace.frames().is_multiple_of(FRAMES) {
                progress(recording.progress());
            }
        }
        match pace.frames() {
            0 => Err(nothing(recording)),
            _ => Ok(pace.info(recording, name)),
        }
    }

    /// The same of a recording in which topics had to be taken at will to look into it: what was read by
    /// them is not shown.
    #[must_use]
    pub fn undecided(mut self, ambiguous: Vec<Ambiguity>) -> Self {
        if ambiguous.is_empty() {
            return self;
        }
        let is_open = |name: &String| ambiguous.iter().any(|a| a.candidates.contains(name));
        for topic in self.topics.iter_mut().filter(|topic| is_open(&topic.name)) {
            topic.taken_for = None;
        }
        // What is odd in signals is odd in those taken at will.
        self.health.suspicions.clear();
        self.health.non_finite.clear();
        self.health.unwrapped.clear();
        self.joints.clear();
        self.sources.clear();
        self.temperature = false;
        self.ambiguous = ambiguous;
        self
    }
}

/// Why a recording that could be opened has no frame.
fn nothing(recording: &Recording) -> LogError {
    let health = recording.health();
    let why = match (health.rows_without_time, health.undecodable) {
        (0, 0) => "it has no row and no message".to_owned(),
        (0, messages) => format!("none of {messages} messages can be decoded"),
        (rows, _) => format!("none of {rows} rows has a time"),
    };
    LogError::refused(recording.name(), format!("it holds no frame: {why}"))
}

/// Time stamps of a recording, counted frame by frame.
#[derive(Debug, Clone, Copy, Default)]
pub struct Pace {
    frames: u64,
    first_ns: Option<i64>,
    last: Option<(i64, u32)>,
    steps: u64,
    within_ns: i64,
    shortest_ns: Option<i64>,
    longest_ns: Option<i64>,
}

impl Pace {
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

    /// Frames counted.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// Frames per second within segments.
    pub fn rate_hz(&self) -> Option<f64> {
        let rate_hz = self.steps as f64 / (1e-9 * self.within_ns as f64);
        Some(rate_hz).filter(|rate| rate.is_finite())
    }

    /// What `recording`, read to its end, holds; `file` is its name.
    pub fn info(&self, recording: &Recording, file: &str) -> RecordingInfo {
        let channels = recording.channels();
        let joints = recording.joints().iter().zip(&channels.joints);
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
                .map(|(name, has)| JointInfo {
                    name: name.clone(),
                    channels: has.iter().collect(),
                })
                .collect(),
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
