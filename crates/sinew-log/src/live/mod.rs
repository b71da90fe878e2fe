//! From messages to frames as they come: names, types and raw CDR in, frames out. No file, socket, clock or thread.
//!
//! A recording goes the same way: its reader is a container and what is here, so that a recording pushed
//! message by message gives the frames that reading it gives, bit for bit.
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
//! // The last quarter of a second waits for what may come late.
//! assert_eq!(frames, 750);
//! live.silence();
//! while live.frame().is_some() {
//!     frames += 1;
//! }
//! assert_eq!(frames, 1_000);
//! # Ok::<(), sinew_log::encode::EncodeError>(())
//! ```
//!
//! # What is taken for what
//!
//! By the rule of a recording, among the topics announced so far: the topic named in the options; else the usual
//! name in the namespace; else the only one. While several could be a side, it has none, and
//! [`Live::choice`] says so. A topic that appears later joins in; the choice depends on the topics
//! announced, not on their order. A new joint side begins a new segment.
//!
//! # What happens with what comes
//!
//! As in a recording (see the [crate](crate#what-happens-with-bad-input)), and:
//!
//! | what comes | decision |
//! |---|---|
//! | a publisher that names other joints, or the same in another order | values are found by name in every message |
//! | several publishers on one topic | each may hold a part of the joints; four layouts are remembered |
//! | joint that is not watched | ignored, and named in [`Health::unknown_joints`] |
//! | motor side that isn't there yet, or vanished | frames without it (NaN), up to a second late after it vanished |
//! | robot started anew: stamps go back | eight samples in a row behind the window: new segment |
//! | simulated time that stands still | the first message of a stamp is kept; the others are counted |
//! | stamp of zero | the instant of receipt stands for it |
//! | silence ([`Live::silence`]) | what is held is handed out; a new segment begins |
//! | robot description | the text is kept; a new one replaces it |
//! | more topics than 1024 | the others are refused; counted |

pub(crate) mod choose;
pub(crate) mod joints;
pub(crate) mod names;
pub(crate) mod samples;
pub(crate) mod seen;
pub(crate) mod survey;

mod census;
mod filter;

pub use census::{Census, JointInfo, RobotFound};
pub use filter::TopicFilter;

use crate::assemble::Joiner;
use crate::decode::MessageKind;
use crate::error::{Ambiguity, LogError};
use crate::frame::{Channels, DrivenJoint, Frame};
use crate::health::Health;
use crate::mapping::Mapping;
use crate::options::{OpenOptions, check_options};
use crate::sources::{SignalSource, TopicInfo, TopicUse};
use choose::{check_mapping, choose_so_far};
use samples::Samples;
use seen::{Announced, Seen, topics_of};
use sinew_files::names::{hint, list};
use survey::{Survey, description};

/// Most topics that are looked at: whoever may announce topics may announce many.
pub const TOPICS_MOST: usize = 1024;

/// What is made of messages.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LiveOptions {
    /// Joints of the frames, in this order: the robot's own.
    pub joints: Vec<String>,
    /// Motor of each joint at whose shaft position and torque are measured; `None`: one of the joint's name, reflected to it. Empty: all are.
    pub motors: Vec<Option<String>>,
    /// What the robot's topics lie in, such as `/arm7`; empty: anywhere.
    pub namespace: String,
    /// Topics, interfaces, mapping and times, as for a recording. A name without a leading `/` lies in the
    /// namespace; `chunk_limit_bytes` is of no use here.
    pub open: OpenOptions,
}

impl LiveOptions {
    /// These joints, and everything else as it comes.
    pub fn of_joints(joints: &[String]) -> Self {
        LiveOptions {
            joints: joints.to_vec(),
            ..LiveOptions::default()
        }
    }
}

/// A topic that was announced, see [`Live::topic`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TopicId(u16);

/// Which topics are taken for what, among those announced so far.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Choice<'a> {
    /// The joint side: it sets the instants, so without one there is no frame.
    pub joint_side: Option<&'a str>,
    /// The motor side.
    pub motor_side: Option<&'a str>,
    /// The known external torque.
    pub external_torque: Option<&'a str>,
    /// Sides that several topics could be; name one in the options.
    pub ambiguous: &'a [Ambiguity],
}

/// A side that is asked for by name, and isn't there.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Missed {
    /// Which side.
    pub side: TopicUse,
    /// The name asked for.
    pub wanted: String,
    /// Topics with joint states that are there, and are no other side.
    pub others: Vec<String>,
}

/// Topics with joint states that aren't asked for and are remembered, at most.
pub const OVERLOOKED_MOST: usize = 16;

/// Makes frames of messages as they come.
///
/// # Realtime
/// [`Live::push`] and [`Live::frame`] allocate nothing once every topic has brought a few seconds of messages
/// laid out alike (`crates/sinew-door/tests/realtime.rs`, counting allocator); they never block or read a clock.
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
    topics_refused: u64,
    /// Topics with joint states that aren't asked for.
    overlooked: Vec<String>,
}

impl Live {
    /// Nothing announced, nothing held.
    ///
    /// # Errors
    /// No joint, a joint twice, a joint that the mapping doesn't name; times that can't be; a mapping of columns.
    pub fn new(options: &LiveOptions) -> Result<Self, LogError> {
        let request = |reason: String| Err(LogError::request("live", reason));
        check_options(&options.open, "live")?;
        let empty = Mapping::default();
        let mapping = options.open.mapping.as_ref().unwrap_or(&empty);
        check_mapping(mapping)?;
        let joints = &options.joints;
        if joints.is_empty() {
            return request("no joint is watched".to_owned());
        }
        for (place, joint) in joints.iter().enumerate() {
            if joints[..place].contains(joint) {
                return request(format!("joint '{joint}' is watched twice"));
            }
            let mapped = Vec::from_iter(mapping.joint_names());
            if !mapped.is_empty() && !mapped.contains(&joint.as_str()) {
                let hint = hint(joint, &mapped);
                return request(format!(
                    "joint '{joint}' is watched, and the mapping {} doesn't name it{hint} joints are {}",
                    mapping.file,
                    list(&mapped)
                ));
            }
        }
        let motors = &options.motors;
        if !(motors.is_empty() || motors.len() == joints.len()) {
            let (motors, joints) = (motors.len(), joints.len());
            return request(format!("{motors} motors for {joints} joints"));
        }
        let motor = |i: usize| motors.get(i).and_then(Option::as_deref);
        let driven = joints.iter().enumerate();
        let driven = driven.map(|(i, joint)| DrivenJoint::new(joint, motor(i)));
        let driven: Vec<DrivenJoint> = driven.collect();
        let filter = TopicFilter::new(options);
        let (names, ambiguous) = choose_so_far(&Survey::default(), filter.wishes());
        let mut samples = Samples::new(names, mapping, Vec::new());
        let mut known = Vec::new();
        for joint in &driven {
            let (recorded, _) = samples.recorded_names(&joint.joint);
            let (_, motor) = samples.recorded_names(&joint.motor);
            known.extend([recorded, motor].map(|name| name.as_bytes().to_vec()));
        }
        samples.set_known(known);
        samples.select(&driven);
        let joiner = samples.joiner(&driven, &options.open);
        Ok(Live {
            filter,
            joints: joints.clone(),
            announced: Announced::default(),
            samples,
            joiner,
            health: Health::default(),
            ambiguous,
            robot_description: None,
            descriptions: 0,
            topics_refused: 0,
            overlooked: Vec::new(),
        })
    }

    /// Announces a topic: its name, such as `/arm7/joint_states`, and its type, such as
    /// `sensor_msgs/msg/JointState`. `None`: nothing of it is of use. The same topic may be announced again.
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
            self.topics_refused += 1;
            return None;
        };
        if is_new {
            self.choose();
        }
        Some(id)
    }

    /// Chooses anew among the topics there are.
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

    /// A message: CDR with its encapsulation header, and when it was received, ns.
    ///
    /// The time of receipt stands for stamps that are zero, so it should be of a clock that doesn't step.
    /// Take the frames there are ([`Self::frame`]) after every message.
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

    /// A robot description; the one beside the other topics wins over those further down.
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

    /// The next frame that may leave; `None`: more has to come. The frame is lent until the next call.
    pub fn frame(&mut self) -> Option<&Frame> {
        match self.joiner.is_ready() {
            true => Some(self.joiner.compose(&mut self.health)),
            false => None,
        }
    }

    /// Nothing comes any more, or something was lost: what is held may leave, and what comes next begins a new segment.
    pub fn silence(&mut self) {
        self.joiner.release();
    }

    /// Joints of the frames.
    pub fn joints(&self) -> &[String] {
        &self.joints
    }

    /// What was lost, repaired or looks wrong since the beginning, as of a recording. Allocates: ask once a second, not
    /// once a message.
    pub fn health(&self) -> Health {
        let mut health = self.health.clone();
        self.joiner.finish(&mut health);
        health
    }

    /// Which topics are taken for what.
    pub fn choice(&self) -> Choice<'_> {
        let names = self.samples.names();
        Choice {
            joint_side: names.joint_topic.as_deref(),
            motor_side: names.motor_topic.as_deref(),
            external_torque: names.external_topic.as_deref(),
            ambiguous: &self.ambiguous,
        }
    }

    /// Sides that are asked for by name while no topic of that name came, and others that carry joint states did: a
    /// name that is written wrong, or a robot that isn't on beside one that is.
    pub fn missed(&self) -> Vec<Missed> {
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
            (!others.is_empty()).then_some(Missed {
                side,
                wanted,
                others,
            })
        });
        missed.collect()
    }

    /// The topics announced, with what each brought and is taken for.
    pub fn topics(&self) -> Vec<TopicInfo> {
        topics_of(&self.announced.seen, self.samples.names())
    }

    /// Topics that were refused, since there are [`TOPICS_MOST`] already.
    pub fn topics_refused(&self) -> u64 {
        self.topics_refused
    }

    /// Which quantities came so far of each joint.
    pub fn channels(&self) -> &Channels {
        self.samples.came()
    }

    /// Where each quantity that came is read from.
    pub fn sources(&self) -> Vec<SignalSource> {
        self.samples.names().sources(self.samples.came())
    }

    /// The robot's URDF, where it was published.
    pub fn robot_description(&self) -> Option<&str> {
        self.robot_description.as_deref()
    }

    /// How many robot descriptions came that differ from the one before.
    pub fn descriptions(&self) -> u64 {
        self.descriptions
    }
}
