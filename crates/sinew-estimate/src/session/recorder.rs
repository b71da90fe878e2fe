//! A recording as blocks of features.

use crate::error::EstimateError;
use crate::feeder::{Fed, Feeder, FeederOptions, Injection, Refusal};
use crate::jumps::Jumps;
use crate::recording::Opened;
use crate::request::{Progress, Request};
use crate::robot_dir::LoadedRobot;
use crate::touch::{Touch, TouchReading, mark_of};
use crate::warning::RecordingWarning;
use sinew_files::names;
use sinew_log::{Frame, Mapping};
use sinew_model::offset::{Block, FeatureConfig, FeatureObserver};
use sinew_model::robot::Robot;
use std::ops::ControlFlow;

/// Which part of a recording is used, s from its start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// From here.
    pub from_s: f64,
    /// Up to here.
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

/// A recording, or a part of it, as features.
#[derive(Debug, Clone, Default)]
pub struct Recorded {
    /// Blocks in the order of time.
    pub blocks: Vec<Block>,
    /// Length of the part used, s.
    pub duration_s: f64,
    /// When the part used began, ns on the recording's clock.
    pub start_time_ns: i64,
    /// When it ended.
    pub end_time_ns: i64,
    /// Joints with an elastic transmission.
    pub elastic: Vec<usize>,
    /// Frames left out because a position was missing.
    pub frames_missing: u64,
    /// Whether the file was damaged.
    pub damaged: bool,
    /// Whether motor torques are currents times torque constants.
    pub motor_current: bool,
    /// What jumped between two samples.
    pub jumps: Jumps,
    /// Room for further blocks ([`Recorder::room`]).
    pub room: Vec<Block>,
    /// Where joint and motor stood when marks were passed.
    pub touches: Vec<TouchReading>,
    /// Joints that are taken as rigid, as their positions are not recorded.
    pub without_encoder: Vec<usize>,
}

/// Touches that are still to come, and the frame before.
#[derive(Debug, Clone, Default)]
struct Touches {
    ahead: Vec<(usize, Touch)>,
    /// Nothing is read across a longer pause, s.
    gap_s: f64,
    last: Option<(f64, Vec<f64>, Vec<f64>)>,
}

impl Touches {
    /// Takes the frame at `time_s`: readings between it and the one before, on a straight line.
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
        // What is cleared goes back here.
        let missing = blocks.saturating_sub(self.room.len());
        self.room.reserve(missing + self.blocks.len());
        self.room
            .extend(std::iter::repeat_n(like, missing).cloned());
        self.jumps.reserve(duration_s);
    }

    /// Nothing yet, of a robot.
    pub(crate) fn empty(robot: &Robot) -> Self {
        Self {
            elastic: (0..robot.arm.dof())
                .filter(|&i| robot.transmissions[i].is_some())
                .collect(),
            jumps: Jumps::new(robot.arm.dof()),
            ..Self::default()
        }
    }

    /// Forgets what was recorded, and keeps the room.
    pub fn clear(&mut self) {
        self.room.append(&mut self.blocks);
        self.jumps.clear();
        (self.frames_missing, self.duration_s) = (0, 0.0);
    }

    /// Appends the last block of what `from` has recorded, and the jumps of readings in it, `by_s` later on another clock.
    ///
    /// # Realtime
    /// No allocation where there is [room](Recorder::make_room_in), lock, panic or clock.
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

    /// Block by block, in order: what a recorder would have handed over as it came.
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

    /// Time of the last block, s of the recording.
    pub(crate) fn end_s(&self) -> f64 {
        self.blocks.last().map_or(0.0, |b| b.time_s)
    }
}

/// Turns frames into blocks of features, from a file, a simulation or a live source.
#[derive(Debug, Clone)]
pub struct Recorder {
    feeder: Feeder<FeatureObserver>,
    block_s: f64,
    first_s: Option<f64>,
    touches: Touches,
    out: Recorded,
}

impl Recorder {
    /// A recorder for `robot`; a pause of more than `gap_s` starts the filters anew. A block joins
    /// all joints: a frame that lacks one's position is left out.
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
            out: Recorded::empty(robot),
        }
    }

    /// Adds offsets to the motor positions on the way, as `--inject` asks; those of joints the robot
    /// doesn't have are left out.
    #[must_use]
    pub fn with_injections(mut self, robot: &Robot, injections: &[Injection]) -> Self {
        self.feeder = self.feeder.with_injections(robot, injections);
        self
    }

    /// Reads joint and motor where marks are passed; those of joints the robot doesn't have are left out.
    #[must_use]
    pub fn with_touches(mut self, robot: &Robot, touches: &[Touch]) -> Self {
        let place = |t: &Touch| Some((robot.tendon_index(&t.joint)?, t.clone()));
        self.touches.ahead = touches.iter().filter_map(place).collect();
        self
    }

    /// Takes the frame at `time_s` of the recording; what became of it, and whether a block is complete.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock as long as there is [room](Recorder::room).
    pub fn push(&mut self, frame: &Frame, time_s: f64) -> Fed<bool> {
        let first_s = *self.first_s.get_or_insert_with(|| {
            self.out.start_time_ns = frame.time_ns;
            let since_start_ns = (time_s * 1e9).round() as i64;
            self.feeder.set_start(frame.time_ns - since_start_ns);
            time_s
        });
        self.out.end_time_ns = frame.time_ns;
        self.out.duration_s = time_s - first_s;
        let fed = self.feeder.frame(frame);
        if let Fed::Refused(Refusal::JointPosition | Refusal::MotorPosition) = fed {
            self.out.frames_missing += 1;
            return fed;
        }
        self.out.jumps.push(time_s, self.feeder.theta(), &frame.q);
        let touched = self.touches.push(time_s, &frame.q, self.feeder.theta());
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
            // On the recording's clock, gaps and all.
            block.time_s = time_s - 0.5 * self.block_s;
            self.out.blocks.push(block);
        }
        fed
    }

    /// Makes room for `duration_s` more, so that recording it allocates nothing. Allocates.
    pub fn make_room(&mut self, duration_s: f64) {
        self.out
            .make_room(duration_s, self.block_s, self.feeder.observer().block());
    }

    /// Makes room for `duration_s` more in another recording. Allocates.
    pub fn make_room_in(&self, part: &mut Recorded, duration_s: f64) {
        part.make_room(duration_s, self.block_s, self.feeder.observer().block());
    }

    /// An empty recording with room for `duration_s`, to [exchange](Recorder::exchange). Allocates.
    pub fn room(&self, duration_s: f64) -> Recorded {
        let mut empty = Recorded {
            elastic: self.out.elastic.clone(),
            jumps: Jumps::new(self.feeder.theta().len()),
            ..Recorded::default()
        };
        empty.make_room(duration_s, self.block_s, self.feeder.observer().block());
        empty
    }

    /// Whether the next block has [room](Recorder::make_room).
    pub(crate) fn has_room(&self) -> bool {
        !self.out.room.is_empty() && self.out.jumps.has_room()
    }

    /// Forgets what was recorded, and keeps the room. The filters go on.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn clear(&mut self) {
        self.first_s = None;
        self.out.clear();
    }

    /// What was recorded since the beginning or the last call, for an empty recording that takes its place. The
    /// filters go on: what comes next goes on with it.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn exchange(&mut self, empty: Recorded) -> Recorded {
        self.first_s = None;
        let mut recorded = std::mem::replace(&mut self.out, empty);
        self.out.jumps.go_on_from(&mut recorded.jumps);
        recorded
    }

    /// What was recorded since the beginning or the last [`Recorder::exchange`].
    pub fn recorded(&self) -> &Recorded {
        &self.out
    }

    /// The observer, after the last frame it took: its [block](FeatureObserver::block) is the last complete one.
    pub fn observer(&self) -> &FeatureObserver {
        self.feeder.observer()
    }

    /// The next frame is a start, as after a gap.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn restart(&mut self) {
        self.feeder.restart();
    }

    /// The first mark that was to be passed and wasn't: its time is in a pause, or not of this recording.
    pub fn missed_touch(&self) -> Option<&Touch> {
        self.touches.ahead.first().map(|(_, touch)| touch)
    }

    /// What was recorded.
    pub fn finish(self) -> Recorded {
        self.out
    }
}

/// That a joint's positions are missing, and what to do.
fn without_positions(joint: &str, lacks: &str, warnings: &[RecordingWarning]) -> String {
    let strangers = warnings.iter().find_map(|warning| match warning {
        RecordingWarning::UnknownJoints { joints } => Some(joints),
        _ => None,
    });
    let instead = strangers.map_or(";".to_owned(), |joints| {
        let hint = names::hint(joint, joints);
        let recorded = names::list(joints);
        format!("{hint} recorded, but not in the robot: {recorded};")
    });
    format!(
        "has no {lacks} of '{joint}', which the estimate needs of every joint with a tendon{instead} rename it with a mapping (--mapping); sinew log info lists what there is"
    )
}

/// The blocks of a part of a recording under way.
pub(super) struct Blocks<'a> {
    request: &'a Request,
    window: Window,
    recorder: Recorder,
    start_ns: Option<i64>,
    frames: u64,
    /// Of each joint how many frames have no joint position, and no motor position.
    missing: Vec<[u64; 2]>,
}

impl<'a> Blocks<'a> {
    /// Before the first frame of what was opened.
    pub(super) fn new(
        request: &'a Request,
        window: Window,
        opened: &Opened,
    ) -> Result<Self, EstimateError> {
        let robot = &opened.loaded.robot;
        let channels = &opened.recording.channels().joints;
        let names = robot.joint_names().iter().zip(robot.motor_names());
        let joints = names.zip(&robot.transmissions);
        for (i, (((joint, motor), transmission), channel)) in joints.zip(channels).enumerate() {
            let lacks = match transmission.is_some() {
                _ if opened.without_encoder.contains(&i) => None,
                _ if !channel.q => Some("joint position"),
                true if !channel.theta => Some("motor position"),
                _ => None,
            };
            if let Some(lacks) = lacks {
                let name = if channel.q { &motor } else { joint };
                return Err(mismatch(
                    request,
                    without_positions(name, lacks, &opened.warnings),
                ));
            }
        }
        Ok(Self {
            request,
            window,
            recorder: Recorder::new(robot, &FeatureConfig::default(), request.open.gap_s)
                .with_injections(robot, &request.injections)
                .with_touches(robot, &request.touches),
            start_ns: None,
            frames: 0,
            missing: vec![[0; 2]; robot.joint_names().len()],
        })
    }

    /// Takes the next frame; whether there may be more to take.
    pub(super) fn frame(&mut self, frame: &Frame) -> bool {
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
        }
        true
    }

    /// Which joint's positions are missing most, in words; empty where none is.
    fn most_missing(&self, robot: &Robot) -> String {
        let (joints, motors) = (robot.joint_names(), robot.motor_names());
        let names = joints.iter().zip(&motors).zip(&robot.transmissions);
        let sides = names.zip(&self.missing).flat_map(|(names, [q, theta])| {
            let ((joint, motor), transmission) = names;
            let theta = if transmission.is_some() { *theta } else { 0 };
            [(*q, "joint", joint), (theta, "motor", motor)]
        });
        match sides.max_by_key(|(count, ..)| *count) {
            Some((count, side, name)) if count > 0 => format!(
                ": the {side} position of '{name}' is missing or not a number in {count} of {} frames",
                self.frames
            ),
            _ => String::new(),
        }
    }

    /// All of them.
    pub(super) fn finish(self, opened: &Opened) -> Result<Recorded, EstimateError> {
        let most_missing = self.most_missing(&opened.loaded.robot);
        let Self {
            request, window, ..
        } = self;
        let config = FeatureConfig::default();
        let missed = self.recorder.missed_touch().cloned();
        let mut out = self.recorder.finish();
        out.damaged = opened.recording.health().is_damaged();
        let mapping = request.open.mapping.as_ref();
        out.without_encoder.clone_from(&opened.without_encoder);
        out.motor_current = mapping.is_some_and(Mapping::reads_motor_current);
        if out.blocks.is_empty() {
            return Err(mismatch(
                request,
                format!(
                    "has no {:.0} s of joint and motor positions in a row from {} s on{}, which the filters need to settle{most_missing}; {}, or look for gaps with sinew log info",
                    7.0 / config.gain_per_s + 9.0 / config.cutoff_rad_per_s + config.block_s,
                    window.from_s,
                    if window.to_s.is_finite() {
                        format!(" up to {} s", window.to_s)
                    } else {
                        String::new()
                    },
                    match out.damaged {
                        true =>
                            "the file is damaged, and what it lost is missing here: copy it again",
                        false => "record longer",
                    }
                ),
            ));
        }
        if let Some(Touch { joint, time_s, .. }) = missed {
            return Err(EstimateError::Touch(format!(
                "{}: joint '{joint}' has no positions at {time_s} s; what was read lasts {:.1} s, from {} s on, and a pause of more than {} s is no place to read",
                request.name(),
                out.duration_s,
                window.from_s,
                request.open.gap_s
            )));
        }
        for touch in &out.touches {
            mark_of(&opened.loaded.robot, touch).map_err(|why| {
                let at = format!(
                    "{}: --touch {}@{}",
                    request.name(),
                    touch.joint,
                    touch.time_s
                );
                EstimateError::Touch(format!("{at}: {why}"))
            })?;
        }
        Ok(out)
    }
}

fn mismatch(request: &Request, why: String) -> EstimateError {
    EstimateError::Mismatch {
        file: request.name(),
        why,
    }
}

/// Reads the blocks of a recording.
pub(super) fn read(
    request: &Request,
    window: Window,
    progress: &mut dyn FnMut(Progress),
) -> Result<(LoadedRobot, Recorded), EstimateError> {
    let mut opened = Opened::new(request)?;
    let mut blocks = Blocks::new(request, window, &opened)?;
    opened.each_frame(false, progress, |frame| {
        Ok(match blocks.frame(frame) {
            true => ControlFlow::Continue(()),
            false => ControlFlow::Break(()),
        })
    })?;
    let recorded = blocks.finish(&opened)?;
    Ok((opened.loaded, recorded))
}
