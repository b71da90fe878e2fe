//! Online assembly of frames from messages: names, types and raw CDR in, frames out. No file, socket, clock
//! or thread.
//!
//! A recording is processed in the same way: its reader is a container and this module, so that a recording
//! pushed message by message gives frames that are bitwise identical to those of a reader. Only the time of frames
//! after a step of the clock differs: it is their time stamp here, and continues the recording in a reader.
//!
//! ```
//! use sinew_log::encode::{DynamicJointState, Header, InterfaceValue, JointState, Message as _};
//! use sinew_log::live::{Live, LiveOptions};
//!
//! let names = ["elbow".to_owned()];
//! let mut live = Live::new(&LiveOptions::of_joints(&names)).expect("options as they come");
//! let joint_side = live.topic("/joint_states", "sensor_msgs/msg/JointState").expect("of interest");
//! let motor_side = live
//!     .topic("/dynamic_joint_states", "control_msgs/msg/DynamicJointState")
//!     .expect("of interest");
//! assert!(live.topic("/tf", "tf2_msgs/msg/TFMessage").is_none());
//!
//! let mut cdr = Vec::new();
//! let mut frames = 0;
//! for step in 0..1_000_i64 {
//!     let time_ns = 1_700_000_000_000_000_000 + step * 1_000_000;
//!     let header = Header::at(time_ns, "").expect("before 2038");
//!     let values = [InterfaceValue { interface_names: &["motor_position"], values: &[0.31] }];
//!     let motor = DynamicJointState { header, joint_names: &names, interface_values: &values };
//!     motor.encode(&mut cdr)?;
//!     live.push(motor_side, &cdr, time_ns);
//!     let joint = JointState { header, name: &names, position: &[0.3], velocity: &[], effort: &[] };
//!     joint.encode(&mut cdr)?;
//!     live.push(joint_side, &cdr, time_ns);
//!     while let Some(frame) = live.frame() {
//!         assert_eq!((frame.q[0], frame.theta[0]), (0.3, 0.31));
//!         frames += 1;
//!     }
//! }
//! // The last quarter of a second waits for late messages.
//! assert_eq!(frames, 750);
//! live.silence();
//! while live.frame().is_some() {
//!     frames += 1;
//! }
//! assert_eq!(frames, 1_000);
//! # Ok::<(), sinew_log::encode::EncodeError>(())
//! ```
//!
//! # Roles of the topics
//!
//! By the rule of a recording, among the topics announced so far: the topic named in the options; otherwise
//! the default name in the namespace; otherwise the only one. While several could be a side, it has none, and
//! [`Live::choice`] reports it. A topic that appears later is used from then on; the choice depends on the
//! topics announced, not on their order. A new joint side begins a new segment.
//!
//! # Handling of irregular input
//!
//! As in a recording (see the [crate](crate#what-happens-with-bad-input)), and:
//!
//! | input | decision |
//! |---|---|
//! | a publisher that names other joints, or the same in another order | values are found by name in every message |
//! | several publishers on one topic | each may hold a part of the joints; four layouts are remembered |
//! | joint that is not monitored | ignored, and named in [`Health::unknown_joints`] |
//! | motor side or tensions that are missing | frames without it (NaN), up to a second late after the last sample |
//! | restarted robot: time stamps step back | eight samples in a row behind the window: new segment |
//! | paused simulated time | the first message of a stamp is kept; the others are counted |
//! | stamp of zero | replaced by the time of receipt, on the clock of earlier stamps of the topic |
//! | silence ([`Live::silence`]) | the remaining samples are returned; a new segment begins |
//! | robot description | the text is kept; a new one replaces it |
//! | more topics than 1024 | the others are rejected and counted |

pub(crate) mod choose;
pub(crate) mod joints;
pub(crate) mod names;
pub(crate) mod samples;
pub(crate) mod seen;
pub(crate) mod survey;

mod census;
mod filter;

pub use census::{JointInfo, RobotFound, TopicDiscovery};
pub use filter::TopicFilter;

use crate::assemble::Joiner;
use crate::decode::MessageKind;
use crate::error::{Ambiguity, LogError};
use crate::frame::{Axis, AxisNames, Channels, Frame, OwnedAxis};
use crate::health::Health;
use crate::mapping::Mapping;
use crate::options::{OpenOptions, check_options};
use crate::sources::{SignalSource, TopicInfo, TopicUse};
use choose::{check_mapping, choose_so_far};
use samples::Samples;
use seen::{Announced, Seen, topics_of};
use sinew_files::names::{hint, list};
use survey::{Survey, description};

/// Maximum number of topics: any publisher may announce many.
pub const TOPICS_MOST: usize = 1024;

/// Options of the online assembly of frames.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LiveOptions {
    /// Axes of the frames, in this order: the joints of the robot, then further axes. At least one has a
    /// joint.
    pub axes: Vec<OwnedAxis>,
    /// Namespace of the robot's topics, such as `/arm7`; empty: any.
    pub namespace: String,
    /// Topics, interfaces, mapping and times, as for a recording. A name without a leading `/` is in the
    /// namespace; `budget` is not used.
    pub open: OpenOptions,
}

impl LiveOptions {
    /// Options for these joints, with defaults for everything else.
    pub fn of_joints(joints: &[String]) -> Self {
        LiveOptions {
            axes: (joints.iter())
                .map(|joint| Axis::of_joint(joint).into())
                .collect(),
            ..LiveOptions::default()
        }
    }
}

/// A topic that was announced, see [`Live::topic`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TopicId(u16);

/// Roles of the topics announced so far.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Choice<'a> {
    /// Topic of the joint side: it sets the time stamps, so there is no frame without one.
    pub joint_side: Option<&'a str>,
    /// The motor side.
    pub motor_side: Option<&'a str>,
    /// The known external torque.
    pub external_torque: Option<&'a str>,
    /// Sides that several topics could be; name one in the options.
    pub ambiguous: &'a [Ambiguity],
}

/// Side that is requested by name and is missing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MissingTopic {
    /// Side of the robot.
    pub side: TopicUse,
    /// Requested name of the topic.
    pub wanted: String,
    /// Existing topics with joint states that are no other side.
    pub others: Vec<String>,
}

/// Maximum number of topics with joint states that are remembered without a request.
pub const OVERLOOKED_MOST: usize = 16;

/// Assembles frames from messages online.
///
/// # Realtime
/// [`Live::push`] and [`Live::frame`] do not allocate once every topic has had a few seconds of messages of
/// the same layout (`crates/sinew-transport/tests/realtime.rs`, counting allocator); they never block or read
/// a clock.
#[derive(Debug)]
pub struct Live {
    filter: TopicFilter,
    joints: Vec<String>,
    announced: Announced,
    samples: Samples,
    joiner: Joiner,
    health: Health,
    ambiguous: Vec<Ambiguity>,
    robot_description: Option<String>,
    descriptions: u64,
    topics_rejected: u64,
    /// Topics with joint states that are not requested.
    overlooked: Vec<String>,
}

impl Live {
    /// Online assembly without any topic.
    ///
    /// # Errors
    /// Returns [`LogError`] for no joint, a duplicate joint, motor or tendon, an axis without a name, a joint
    /// that is missing in the mapping, invalid times, or a mapping of columns.
    pub fn new(options: &LiveOptions) -> Result<Self, LogError> {
        let request = |reason: String| Err(LogError::request("live", reason));
        check_options(&options.open, "live")?;
        let empty = Mapping::default();
        let mapping = options.open.mapping.as_ref().unwrap_or(&empty);
        check_mapping(mapping)?;
        let axes = Vec::from_iter(options.axes.iter().map(OwnedAxis::axis));
        let joints = Vec::from_iter(axes.iter().filter_map(|axis| axis.joint));
        if joints.is_empty() {
            return request("no joint is monitored".to_owned());
        }
        for (place, axis) in axes.iter().enumerate() {
            if let Some((what, name)) = axis.taken(&axes[..place]) {
                return request(format!("{what} '{name}' is monitored twice"));
            }
            if axis.is_nameless() {
                return request(format!(
                    "axis {place} has no name: specify a joint, a motor or a tendon"
                ));
            }
            let mapped = Vec::from_iter(mapping.joint_names());
            let is_mapped = |joint: &&str| mapped.is_empty() || mapped.contains(joint);
            if let Some(joint) = axis.joint.filter(|joint| !is_mapped(joint)) {
                let hint = hint(joint, &mapped);
                return request(format!(
                    "joint '{joint}' is monitored, but the mapping {} does not name it{hint} joints are {}",
                    mapping.file,
                    list(&mapped)
                ));
            }
        }
        let joints = joints.into_iter().map(str::to_owned).collect();
        let axes = Vec::from_iter(axes.into_iter().map(AxisNames::new));
        let filter = TopicFilter::new(options);
        let (names, ambiguous) = choose_so_far(&Survey::default(), filter.wishes());
        let mut samples = Samples::new(names, mapping, Vec::new());
        let mut all = Vec::new();
        for axis in &axes {
            let recorded = samples.recorded_of(axis).into_iter().flatten();
            all.extend(recorded.map(|name| name.as_bytes().to_vec()));
        }
        samples.set_recorded(all);
        samples.select(&axes);
        let mut joiner = samples.joiner(&axes, &options.open);
        // The monitor compares them with its own clock.
        joiner.keep_stamps();
        Ok(Live {
            filter,
            joints,
            announced: Announced::default(),
            samples,
            joiner,
            health: Health::default(),
            ambiguous,
            robot_description: None,
            descriptions: 0,
            topics_rejected: 0,
            overlooked: Vec::new(),
        })
    }

    /// Announces a topic: its name, such as `/arm7/joint_states`, and its type, such as
    /// `sensor_msgs/msg/JointState`. `None` if the topic is not used. The same topic may be announced again.
    pub fn topic(&mut self, name: &str, schema: &str) -> Option<TopicId> {
        if !self.filter.wants(name, schema) {
            let is_new = || !self.overlooked.iter().any(|known| known == name);
            let has_room = self.overlooked.len() < OVERLOOKED_MOST;
            if has_room && MessageKind::of_schema(schema).is_some() && is_new() {
                self.overlooked.push(name.to_owned());
            }
            return None;
        }
        let Some((id, is_new)) = self.announced.topic(name, schema) else {
            self.topics_rejected += 1;
            return None;
        };
        if is_new {
            self.choose();
        }
        Some(id)
    }

    /// Chooses again among the topics.
    fn choose(&mut self) {
        let (names, ambiguous) = choose_so_far(&self.announced.survey, self.filter.wishes());
        self.ambiguous = ambiguous;
        let before = self.samples.names();
        if before.sides() == names.sides() {
            return;
        }
        if before.joint_topic != names.joint_topic {
            self.joiner.release();
        }
        self.samples.rename(names, &mut self.joiner);
        for (id, topic) in &self.announced.survey.topics {
            if let Some(kind) = MessageKind::of_schema(&topic.schema) {
                self.samples.stream(*id, &topic.name, kind);
            }
        }
    }

    /// Adds a message: CDR with its encapsulation header, and its time of receipt, ns.
    ///
    /// The time of receipt replaces a stamp of zero (see the [module](self#handling-of-irregular-input)), so its clock should be monotonic.
    /// Call [`Self::frame`] for the available frames after every message.
    pub fn push(&mut self, topic: TopicId, cdr: &[u8], received_ns: i64) {
        let Some(seen) = self.announced.message(topic, cdr, received_ns) else {
            return;
        };
        if seen.is_description() {
            return self.describe(topic, cdr);
        }
        if self.samples.reads(topic.0) {
            let (joiner, health) = (&mut self.joiner, &mut self.health);
            self.samples.push(topic.0, cdr, received_ns, joiner, health);
        }
    }

    /// Reads a robot description; that in the namespace of the topics takes precedence over those below it.
    fn describe(&mut self, topic: TopicId, cdr: &[u8]) {
        let own = format!("{}/robot_description", self.filter.namespace());
        let is_own = |seen: &Seen| seen.topic == own && seen.messages() > 0;
        let is_other = self.announced.seen[usize::from(topic.0)].topic != own;
        if is_other && self.announced.seen.iter().any(is_own) {
            return;
        }
        let text = description(cdr);
        if text.is_some() && text != self.robot_description {
            self.robot_description = text;
            self.descriptions += 1;
        }
    }

    /// Returns the next released frame; `None`: further messages are needed. The frame is valid until the
    /// next call.
    pub fn frame(&mut self) -> Option<&Frame> {
        match self.joiner.is_ready() {
            true => Some(self.joiner.compose(&mut self.health)),
            false => None,
        }
    }

    /// Ends a segment, because no data arrive or data were lost: the remaining samples are returned, and the
    /// next sample begins a new segment.
    pub fn silence(&mut self) {
        self.joiner.release();
    }

    /// Joints of the frames, without axes that have none.
    pub fn joints(&self) -> &[String] {
        &self.joints
    }

    /// Losses, repairs and implausible signals since the start, as of a recording. It allocates: call it once
    /// per second, not once per message.
    pub fn health(&self) -> Health {
        let mut health = self.health.clone();
        self.joiner.finish(&mut health);
        health
    }

    /// Roles of the topics.
    pub fn choice(&self) -> Choice<'_> {
        let names = self.samples.names();
        Choice {
            joint_side: names.joint_topic.as_deref(),
            motor_side: names.motor_topic.as_deref(),
            external_torque: names.external_topic.as_deref(),
            ambiguous: &self.ambiguous,
        }
    }

    /// Sides that are requested by name and have no topic, although other topics carry joint states: a
    /// misspelt name, or a robot that is not connected while another one is.
    pub fn missed(&self) -> Vec<MissingTopic> {
        let choice = self.choice();
        let wishes = self.filter.wishes();
        let sides = [
            (
                TopicUse::JointSide,
                wishes.joint.as_ref(),
                choice.joint_side,
            ),
            (
                TopicUse::MotorSide,
                wishes.motor.as_ref(),
                choice.motor_side,
            ),
        ];
        let others = || {
            let announced = self.announced.survey.topics.values();
            let states = announced.filter(|t| MessageKind::of_schema(&t.schema).is_some());
            let names = states.map(|topic| topic.name.clone());
            let free = names.filter(|name| {
                let taken = [choice.joint_side, choice.motor_side];
                !taken.contains(&Some(name.as_str()))
            });
            Vec::from_iter(free.chain(self.overlooked.iter().cloned()))
        };
        let missed = sides.into_iter().filter_map(|(side, wanted, found)| {
            let wanted = wanted.filter(|_| found.is_none())?.clone();
            let others = others();
            (!others.is_empty()).then_some(MissingTopic {
                side,
                wanted,
                others,
            })
        });
        missed.collect()
    }

    /// Announced topics, with their content and roles.
    pub fn topics(&self) -> Vec<TopicInfo> {
        topics_of(&self.announced.seen, self.samples.names())
    }

    /// Number of topics that were rejected, because there are [`TOPICS_MOST`] already.
    pub fn topics_rejected(&self) -> u64 {
        self.topics_rejected
    }

    /// Quantities of each axis that have been received so far.
    pub fn channels(&self) -> &Channels {
        self.samples.came()
    }

    /// Source of each received quantity.
    pub fn sources(&self) -> Vec<SignalSource> {
        self.samples.names().sources(self.samples.came())
    }

    /// Published robot description (URDF), if there is one.
    pub fn robot_description(&self) -> Option<&str> {
        self.robot_description.as_deref()
    }

    /// Number of robot descriptions that differ from the preceding one.
    pub fn descriptions(&self) -> u64 {
        self.descriptions
    }
}
