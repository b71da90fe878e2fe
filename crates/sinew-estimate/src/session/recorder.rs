//! Conversion of a recording into blocks of features.

use crate::cable::{CableSample, CableSamples};
use crate::error::{EstimateError, SessionError};
use crate::feeder::{FeedOutcome, Feeder, FeederOptions, Injection, RejectionReason};
use crate::jumps::Jumps;
use crate::recording::Opened;
use crate::request::{Progress, Request};
use crate::touch::{Touch, TouchReading, mark_of};
use crate::warning::RecordingWarning;
use sinew_files::names;
use sinew_log::{Frame, Mapping};
use sinew_model::offset::{Block, FeatureConfig, FeatureObserver};
use sinew_model::robot::Robot;
use std::borrow::Cow;
use std::ops::ControlFlow;

/// Number of blocks of a part of a long recording: 20 min, which are ten segments. Memory: about 4 kB per block at seven
/// joints.
const PART_BLOCKS: usize = 6000;

/// Interval of a recording that is evaluated, s from its start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Start of the interval, s.
    pub from_s: f64,
    /// End of the interval, s; infinity for the end of the recording.
    pub to_s: f64,
}

impl Default for Window {
    fn default() -> Self {
        Self {
            from_s: 0.0,
            to_s: f64::INFINITY,
        }
    }
}

/// Recording, or part of one, as blocks of features.
#[derive(Debug, Clone, Default)]
pub struct Recorded {
    /// Blocks of features in the order of time.
    pub blocks: Vec<Block>,
    /// Duration of the evaluated interval, s.
    pub duration_s: f64,
    /// Start of the evaluated interval, ns on the clock of the recording.
    pub start_time_ns: i64,
    /// End of the evaluated interval, ns on the clock of the recording.
    pub end_time_ns: i64,
    /// Indices of the joints with an elastic transmission.
    pub elastic: Vec<usize>,
    /// Number of frames excluded because a position is missing.
    pub frames_missing: u64,
    /// Whether the file was damaged.
    pub damaged: bool,
    /// Whether the motor torques are motor currents times torque constants.
    pub motor_current: bool,
    /// Steps of the encoder readings between two samples.
    pub jumps: Jumps,
    /// Preallocated blocks for later use ([`Recorder::room`]).
    pub room: Vec<Block>,
    /// Joint and motor positions at the index marks that were passed.
    pub touches: Vec<TouchReading>,
    /// Indices of the joints treated as rigid, because their positions are not recorded.
    pub without_encoder: Vec<usize>,
    /// Joints whose tendons have friction along their path, with their samples; empty without a recording file.
    pub cables: Vec<(usize, CableSamples)>,
}

/// Correction of the positions of a joint from the time on at which its encoder slipped.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct EncoderCorrection {
    /// Index of the joint.
    pub(super) joint: usize,
    /// Time of the slip since the start of the recording, s.
    pub(super) from_s: f64,
    /// Step of the offset by the slip, rad: the joint encoder shows this much too little.
    pub(super) size_rad: f64,
}

/// Pending touches, and the previous frame.
#[derive(Debug, Clone, Default)]
struct Touches {
    ahead: Vec<(usize, Touch)>,
    /// Maximum time between two frames for interpolation, s.
    gap_s: f64,
    last: Option<(f64, Vec<f64>, Vec<f64>)>,
}

impl Touches {
    /// Processes the frame at `time_s`, and returns positions at touches since the previous frame by linear
    /// interpolation.
    fn push(&mut self, time_s: f64, q: &[f64], theta: &[f64]) -> Vec<TouchReading> {
        let mut out = Vec::new();
        if self.ahead.is_empty() {
            return out;
        }
        if let Some((before_s, q0, theta0)) = &self.last {
            self.ahead.retain(|(i, touch)| {
                let share = (touch.time_s - before_s) / (time_s - before_s);
                let between =
                    |a: &[f64], b: &[f64]| Some(a.get(*i)? + share * (b.get(*i)? - a.get(*i)?));
                if !(0.0..=1.0).contains(&share) || time_s - before_s > self.gap_s {
                    return true;
                }
                if let (Some(q), Some(theta_measured)) = (between(q0, q), between(theta0, theta)) {
                    out.push(TouchReading {
                        joint: touch.joint.clone(),
                        kind: touch.kind,
                        time_s: touch.time_s,
                        q,
                        theta_measured,
                    });
                }
                false
            });
        }
        self.last = Some((time_s, q.to_vec(), theta.to_vec()));
        out
    }
}

impl Recorded {
    fn make_room(&mut self, duration_s: f64, block_s: f64, like: &Block) {
        let blocks = (duration_s / block_s).ceil().max(0.0) as usize;
        self.blocks.reserve(blocks.max(self.room.len()));
        // Cleared blocks return to `room`.
        let missing = blocks.saturating_sub(self.room.len());
        self.room.reserve(missing + self.blocks.len());
        self.room
            .extend(std::iter::repeat_n(like, missing).cloned());
        self.jumps.reserve(duration_s);
    }

    /// Creates an empty recording of a robot.
    pub(crate) fn empty(robot: &Robot) -> Self {
        Self {
            elastic: (0..robot.axes())
                .filter(|&i| robot.transmissions[i].is_some())
                .collect(),
            jumps: Jumps::new(robot.axes()),
            ..Self::default()
        }
    }

    /// Discards all blocks, and keeps their allocation.
    pub fn clear(&mut self) {
        self.room.append(&mut self.blocks);
        self.jumps.clear();
        (self.frames_missing, self.duration_s) = (0, 0.0);
    }

    /// Appends the last block of `from` and the steps of the readings in it, with `by_s` added to their times.
    ///
    /// # Realtime
    /// No allocation if there is [room](Recorder::make_room_in); no lock, panic or clock.
    pub fn append_last(&mut self, from: &Self, by_s: f64) {
        let Some(last) = from.blocks.last() else {
            return;
        };
        let before_s = from.blocks.iter().rev().nth(1).map(|b| b.time_s);
        let since_s = before_s.unwrap_or(f64::NEG_INFINITY);
        self.jumps.append_since(&from.jumps, since_s, by_s);
        let mut block = match self.room.pop() {
            Some(mut block) => {
                block.copy_from(last);
                block
            }
            None => last.clone(),
        };
        block.time_s += by_s;
        self.blocks.push(block);
    }

    /// Single blocks in order, as an online recorder passes them on.
    pub fn parts(&self) -> impl Iterator<Item = Self> + '_ {
        let mut from_s = f64::NEG_INFINITY;
        let end_s = self.end_s();
        self.blocks.iter().map(move |block| {
            let jumps = self.jumps.between(from_s, block.time_s);
            from_s = block.time_s;
            let before_end_ns = ((end_s - block.time_s) * 1e9).round() as i64;
            Self {
                blocks: vec![block.clone()],
                elastic: self.elastic.clone(),
                jumps,
                start_time_ns: self.start_time_ns,
                end_time_ns: self.end_time_ns - before_end_ns,
                motor_current: self.motor_current,
                ..Self::default()
            }
        })
    }

    /// Appends the part of the same recording that follows this one.
    fn append(&mut self, mut next: Self) {
        self.blocks.append(&mut next.blocks);
        self.jumps.append(&next.jumps);
        self.touches.append(&mut next.touches);
        self.end_time_ns = next.end_time_ns;
        self.duration_s = (self.end_time_ns - self.start_time_ns) as f64 * 1e-9;
        self.frames_missing += next.frames_missing;
    }

    /// Time of the last block since the start of the recording, s.
    pub(crate) fn end_s(&self) -> f64 {
        self.blocks.last().map_or(0.0, |b| b.time_s)
    }
}

/// Converter of frames into blocks of features, from a file, a simulation or a live source.
#[derive(Debug, Clone)]
pub struct Recorder {
    feeder: Feeder<FeatureObserver>,
    block_s: f64,
    first_s: Option<f64>,
    touches: Touches,
    corrections: Vec<EncoderCorrection>,
    out: Recorded,
}

impl Recorder {
    /// Creates a recorder for `robot`. The filters are re-initialised after a gap of more than `gap_s`. A block
    /// contains all joints: a frame without the position of one joint is excluded.
    pub fn new(robot: &Robot, config: &FeatureConfig, gap_s: f64) -> Self {
        let features =
            FeatureObserver::new(&robot.arm, *config).with_transmissions(&robot.transmissions);
        let options = FeederOptions {
            gap_s,
            ..FeederOptions::default()
        };
        Self {
            feeder: Feeder::new(features, &robot.transmissions, options),
            block_s: config.block_s,
            first_s: None,
            touches: Touches {
                gap_s,
                ..Touches::default()
            },
            corrections: Vec::new(),
            out: Recorded::empty(robot),
        }
    }

    /// Excludes frames beyond the limits of the robot's joints, as a running robot needs it, on whose filters a wild sample would act
    /// for minutes. The estimate of a recording keeps such frames: they show a wrong unit, sign or zero.
    #[must_use]
    pub fn with_limits(mut self, robot: &Robot) -> Self {
        self.feeder = self.feeder.with_limits(robot);
        self
    }

    /// Adds offsets to the motor positions (`--inject`); injections at joints that are not in the robot are ignored.
    #[must_use]
    pub fn with_injections(mut self, robot: &Robot, injections: &[Injection]) -> Self {
        self.feeder = self.feeder.with_injections(robot, injections);
        self
    }

    /// Corrects the poses of the arm after slips of joint encoders. Motor and joint position are shifted equally, so that
    /// loads refer to the true pose and the offset still contains the slip.
    #[must_use]
    pub(super) fn with_corrections(mut self, corrections: &[EncoderCorrection]) -> Self {
        self.corrections = corrections.to_vec();
        self
    }

    /// Records joint and motor positions at index marks; touches of joints that are not in the robot are ignored.
    #[must_use]
    pub fn with_touches(mut self, robot: &Robot, touches: &[Touch]) -> Self {
        let indexed = |t: &Touch| Some((robot.tendon_index(&t.joint)?, t.clone()));
        self.touches.ahead = touches.iter().filter_map(indexed).collect();
        self
    }

    /// Processes the frame at `time_s` of the recording, and returns whether it was used and whether a block is
    /// complete.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock while there is [room](Recorder::room).
    pub fn push(&mut self, frame: &Frame, time_s: f64) -> FeedOutcome<bool> {
        let first_s = *self.first_s.get_or_insert_with(|| {
            self.out.start_time_ns = frame.time_ns;
            let since_start_ns = (time_s * 1e9).round() as i64;
            self.feeder.set_start(frame.time_ns - since_start_ns);
            time_s
        });
        self.out.end_time_ns = frame.time_ns;
        self.out.duration_s = time_s - first_s;
        let active = self.corrections.iter().filter(|c| time_s >= c.from_s);
        let active: Vec<EncoderCorrection> = active.copied().collect();
        let fed = match active.is_empty() {
            true => self.feeder.frame(frame),
            false => {
                let mut corrected = frame.clone();
                for c in &active {
                    corrected.q[c.joint] += c.size_rad;
                    corrected.theta[c.joint] += c.size_rad;
                }
                self.feeder.frame(&corrected)
            }
        };
        if let FeedOutcome::Rejected(
            RejectionReason::JointPosition | RejectionReason::MotorPosition,
        ) = fed
        {
            self.out.frames_missing += 1;
            return fed;
        }
        let mut uncorrected = Cow::Borrowed(self.feeder.theta());
        for c in &active {
            uncorrected.to_mut()[c.joint] -= c.size_rad;
        }
        self.out.jumps.push(time_s, &uncorrected, &frame.q);
        let touched = self.touches.push(time_s, &frame.q, &uncorrected);
        self.out.touches.extend(touched);
        if fed.output() == Some(true) {
            let latest = self.feeder.observer().block();
            let mut block = match self.out.room.pop() {
                Some(mut block) => {
                    block.copy_from(latest);
                    block
                }
                None => latest.clone(),
            };
            // Time on the clock of the recording, including gaps.
            block.time_s = time_s - 0.5 * self.block_s;
            self.out.blocks.push(block);
        }
        fed
    }

    /// Allocates memory for a further `duration_s`, so that recording it does not allocate.
    pub fn make_room(&mut self, duration_s: f64) {
        self.out
            .make_room(duration_s, self.block_s, self.feeder.observer().block());
    }

    /// Allocates memory for a further `duration_s` in another recording.
    pub fn make_room_in(&self, part: &mut Recorded, duration_s: f64) {
        part.make_room(duration_s, self.block_s, self.feeder.observer().block());
    }

    /// Creates an empty recording with memory for `duration_s`, to [exchange](Recorder::exchange). Allocates.
    pub fn room(&self, duration_s: f64) -> Recorded {
        let mut empty = Recorded {
            elastic: self.out.elastic.clone(),
            jumps: Jumps::new(self.feeder.theta().len()),
            ..Recorded::default()
        };
        empty.make_room(duration_s, self.block_s, self.feeder.observer().block());
        empty
    }

    /// Whether memory for the next block is [allocated](Recorder::make_room).
    pub(crate) fn has_room(&self) -> bool {
        !self.out.room.is_empty() && self.out.jumps.has_room()
    }

    /// Discards all blocks, and keeps their allocation. The filters continue.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn clear(&mut self) {
        self.first_s = None;
        self.out.clear();
    }

    /// Returns the recording since the start or the last call, and replaces it by an `empty` one. The
    /// filters continue, so that the next blocks continue the returned ones.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn exchange(&mut self, empty: Recorded) -> Recorded {
        self.first_s = None;
        let mut recorded = std::mem::replace(&mut self.out, empty);
        self.out.jumps.continue_from(&mut recorded.jumps);
        recorded
    }

    /// Returns the motor positions of the last frame in the coordinates of the joints, rad, length `n`.
    pub fn theta(&self) -> &[f64] {
        self.feeder.theta()
    }

    /// Recording since the start or the last [`Recorder::exchange`].
    pub fn recorded(&self) -> &Recorded {
        &self.out
    }

    /// Feature observer after the last frame; its [block](FeatureObserver::block) is the last complete one.
    pub fn observer(&self) -> &FeatureObserver {
        self.feeder.observer()
    }

    /// Re-initialises the filters with the next frame, as after a gap.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn restart(&mut self) {
        self.feeder.restart();
    }

    /// First index mark without positions: its time is in a gap, or outside this recording.
    pub fn missed_touch(&self) -> Option<&Touch> {
        self.touches.ahead.first().map(|(_, touch)| touch)
    }

    /// Returns the recording.
    pub fn finish(self) -> Recorded {
        self.out
    }
}

/// Error message for a joint without recorded positions.
fn without_positions(joint: &str, lacks: &str, warnings: &[RecordingWarning]) -> String {
    let unknown_joints = warnings.iter().find_map(|warning| match warning {
        RecordingWarning::UnknownJoints { joints } => Some(joints),
        _ => None,
    });
    let instead = unknown_joints.map_or(";".to_owned(), |joints| {
        let hint = names::hint(joint, joints);
        let recorded = names::list(joints);
        format!("{hint} recorded, but not in the robot description: {recorded};")
    });
    format!(
        "has no {lacks} of '{joint}', which the estimate requires for every joint with a tendon{instead} rename it with a mapping (--mapping); sinew log info lists the recorded joints"
    )
}

/// Reader of the blocks of an interval of a recording.
struct Blocks<'a> {
    request: &'a Request,
    robot: Robot,
    window: Window,
    recorder: Recorder,
    /// Last complete part: the next one is appended to it if the recording ends soon.
    complete: Option<Recorded>,
    /// Whether the recording is not divided.
    is_one_part: bool,
    without_encoder: Vec<usize>,
    start_ns: Option<i64>,
    frames: u64,
    cables: Vec<(usize, CableSamples)>,
    /// Number of frames without joint position and without motor position, per joint.
    missing: Vec<[u64; 2]>,
}

impl<'a> Blocks<'a> {
    /// Creates a reader before the first frame of an opened recording.
    fn new(
        request: &'a Request,
        window: Window,
        opened: &Opened,
        corrections: &[EncoderCorrection],
    ) -> Result<Self, EstimateError> {
        let robot = &opened.loaded.robot;
        let channels = &opened.recording.channels().joints;
        let motors = robot.motor_names();
        let axes = motors.iter().zip(&robot.transmissions).zip(channels);
        for (i, ((motor, transmission), channel)) in axes.enumerate() {
            let joint = robot.joint_names().get(i);
            let lacks = match transmission.is_some() || robot.cable(i).is_some() {
                _ if opened.without_encoder.contains(&i) => None,
                _ if joint.is_some() && !channel.q => Some("joint position"),
                true if !channel.theta && !robot.shares_motor(i) => Some("motor position"),
                _ => None,
            };
            if let Some(lacks) = lacks {
                let name = joint.filter(|_| !channel.q).unwrap_or(motor);
                return Err(mismatch(
                    request,
                    without_positions(name, lacks, &opened.warnings),
                ));
            }
        }
        Ok(Self {
            request,
            robot: robot.clone(),
            window,
            recorder: Recorder::new(robot, &FeatureConfig::default(), request.open.gap_s)
                .with_injections(robot, &request.injections)
                .with_touches(robot, &request.touches)
                .with_corrections(corrections),
            complete: None,
            is_one_part: !(robot.cables.is_empty()
                && request.touches.is_empty()
                && robot
                    .transmissions
                    .iter()
                    .flatten()
                    .all(|t| t.anchors.is_empty())),
            without_encoder: opened.without_encoder.clone(),
            start_ns: None,
            frames: 0,
            cables: (robot.cables.iter())
                .map(|cable| (cable.axis, CableSamples::default()))
                .collect(),
            missing: vec![[0; 2]; robot.axes()],
        })
    }

    /// Processes the next frame, and returns whether further frames may be in the interval.
    fn frame(&mut self, frame: &Frame) -> bool {
        let start: i64 = *self.start_ns.get_or_insert(frame.time_ns);
        let t = (frame.time_ns - start) as f64 * 1e-9;
        if t >= self.window.to_s {
            return false;
        }
        if t >= self.window.from_s {
            self.frames += 1;
            for ((count, q), theta) in self.missing.iter_mut().zip(&frame.q).zip(&frame.theta) {
                count[0] += u64::from(!q.is_finite());
                count[1] += u64::from(!theta.is_finite());
            }
            self.recorder.push(frame, t);
            self.push_cables(frame, t);
        }
        true
    }

    /// Adds a frame at `time_s` to the samples of the joints whose tendons have friction along their path.
    fn push_cables(&mut self, frame: &Frame, time_s: f64) {
        let robot = &self.robot;
        for (axis, samples) in &mut self.cables {
            let injected = self.request.injections.iter().filter(|injection| {
                robot.tendon_index(&injection.joint) == Some(*axis)
                    && injection.from_s.is_none_or(|from_s| time_s >= from_s)
            });
            let injected_rad: f64 = injected.map(|injection| injection.offset_rad).sum();
            samples.push(CableSample {
                time_s,
                theta_rad: frame.theta[*axis] + injected_rad,
                q_rad: frame.q[*axis],
                torque_nm: frame.tau_el.get(*axis).copied().unwrap_or(f64::NAN),
            });
        }
    }

    /// Message part that names the joint with most missing positions; empty if none is missing.
    fn most_missing(&self, robot: &Robot) -> String {
        let motors = robot.motor_names();
        let axes = motors.iter().zip(&robot.transmissions).zip(&self.missing);
        let sides = axes.enumerate().flat_map(|(i, (names, [q, theta]))| {
            let ((motor, transmission), joint) = (names, robot.axis_name(i));
            let has_own = transmission.is_some() && !robot.shares_motor(i);
            let theta = if has_own { *theta } else { 0 };
            [(*q, "joint", joint), (theta, "motor", motor.as_str())]
        });
        match sides.max_by_key(|(count, ..)| *count) {
            Some((count, side, name)) if count > 0 => format!(
                ": the {side} position of '{name}' is missing or non-finite in {count} of {} frames",
                self.frames
            ),
            _ => String::new(),
        }
    }

    /// Returns the next part of a long recording. A part is passed on after the one that follows it is complete, so that
    /// the last one is never short. A recording has one part if tendons have friction along their path, or if references
    /// may be touched, which correct the whole recording.
    ///
    /// # Errors
    /// Returns [`EstimateError::Touch`] for a touch in the part without a mark in robot.toml.
    fn part(&mut self) -> Result<Option<Recorded>, EstimateError> {
        if self.recorder.recorded().blocks.len() < PART_BLOCKS || self.is_one_part {
            return Ok(None);
        }
        let part = self.recorder.exchange(Recorded::empty(&self.robot));
        let Some(mut before) = self.complete.replace(part) else {
            return Ok(None);
        };
        self.describe(&mut before)?;
        Ok(Some(before))
    }

    /// Adds the properties of the recording file to a part, and checks its touches.
    fn describe(&self, part: &mut Recorded) -> Result<(), EstimateError> {
        let mapping = self.request.open.mapping.as_ref();
        part.without_encoder.clone_from(&self.without_encoder);
        part.motor_current = mapping.is_some_and(Mapping::reads_motor_current);
        for touch in &part.touches {
            mark_of(&self.robot, touch).map_err(|reason| {
                let at = format!(
                    "{}: --touch {}@{}",
                    self.request.name(),
                    touch.joint,
                    touch.time_s
                );
                EstimateError::Touch(format!("{at}: {reason}"))
            })?;
        }
        Ok(())
    }

    /// Returns the remaining parts after the last frame: one or two.
    fn finish(mut self, is_damaged: bool) -> Result<Vec<Recorded>, EstimateError> {
        let most_missing = self.most_missing(&self.robot);
        let (request, window) = (self.request, self.window);
        let config = FeatureConfig::default();
        let missed = self.recorder.missed_touch().cloned();
        let mut last = self.recorder.exchange(Recorded::empty(&self.robot));
        let mut parts = Vec::from_iter(self.complete.take());
        if last.blocks.len() < PART_BLOCKS / 2
            && let Some(mut before) = parts.pop()
        {
            before.append(last);
            last = before;
        }
        last.damaged = is_damaged;
        let mut cables = std::mem::take(&mut self.cables);
        cables.iter_mut().for_each(|(_, samples)| samples.finish());
        last.cables = cables;
        if last.blocks.is_empty() {
            return Err(mismatch(
                request,
                format!(
                    "has no {:.0} s of joint and motor positions without a gap after {} s{}, which the filters require to settle{most_missing}; {}, or check for gaps with sinew log info",
                    7.0 / config.gain_per_s + 9.0 / config.cutoff_rad_per_s + config.block_s,
                    window.from_s,
                    if window.to_s.is_finite() {
                        format!(" and before {} s", window.to_s)
                    } else {
                        String::new()
                    },
                    match last.damaged {
                        true => "the file is damaged and data is missing: copy it again",
                        false => "record longer",
                    }
                ),
            ));
        }
        if let Some(Touch { joint, time_s, .. }) = missed {
            let start_ns = self.start_ns.unwrap_or(last.start_time_ns);
            return Err(EstimateError::Touch(format!(
                "{}: joint '{joint}' has no positions at {time_s} s; the evaluated interval of {:.1} s starts at {} s, and gaps of more than {} s are not interpolated",
                request.name(),
                (last.end_time_ns - start_ns) as f64 * 1e-9 - window.from_s,
                window.from_s,
                request.open.gap_s
            )));
        }
        parts.push(last);
        for part in &mut parts {
            self.describe(part)?;
        }
        Ok(parts)
    }
}

fn mismatch(request: &Request, reason: String) -> EstimateError {
    EstimateError::Mismatch {
        file: request.name(),
        reason,
    }
}

/// Reads the blocks of an interval of a recording, with corrections for slips of joint encoders, and passes its parts to
/// `take` in order. Long recordings have several parts, so that the memory does not depend on their duration.
///
/// `also` processes every frame, and breaks if it requires no frames after the interval.
///
/// # Errors
/// Returns an error of the recording, of `also` or of `take`.
pub(super) fn read_parts(
    request: &Request,
    opened: &mut Opened,
    (window, corrections): (Window, &[EncoderCorrection]),
    progress: &mut dyn FnMut(Progress),
    also: &mut dyn FnMut(&Frame) -> Result<ControlFlow<()>, EstimateError>,
    take: &mut dyn FnMut(&Robot, &Recorded) -> Result<(), SessionError>,
) -> Result<(), SessionError> {
    let mut blocks = Blocks::new(request, window, opened, corrections)?;
    let robot = opened.loaded.robot.clone();
    let mut taken = Ok(());
    opened.each_frame(false, progress, |frame| {
        let also = also(frame)?;
        let is_within = blocks.frame(frame);
        if let Some(part) = blocks.part()? {
            taken = take(&robot, &part);
        }
        Ok(match taken {
            Ok(()) if is_within => ControlFlow::Continue(()),
            Ok(()) => also,
            Err(_) => ControlFlow::Break(()),
        })
    })?;
    taken?;
    let is_damaged = opened.recording.health().is_damaged();
    for part in blocks.finish(is_damaged)? {
        take(&robot, &part)?;
    }
    Ok(())
}
