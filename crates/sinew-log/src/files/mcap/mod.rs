//! MCAP as ROS 2 writes it: joint side, motor side and external torque as samples.

mod chunk;
mod container;
pub(in crate::files) mod messages;
mod scan;
mod source;
mod topics;

use std::collections::{BTreeMap, HashMap};

use crate::assemble::{Conditioner, Joiner, Signal};
use crate::decode::{Entry, Layout, MessageKind, parse, stamp_ns};
use crate::error::LogError;
use crate::files::read_seek::ReadSeek;
use crate::files::reader::{Format, Progress, Reader};
use crate::frame::{Channels, Quantity};
use crate::health::{Health, UNKNOWN_LIMIT};
use crate::mapping::{JointEffort, JointMap, Mapping, Wrap};
use crate::options::OpenOptions;
use crate::options::to_ns;
use crate::sources::{SignalSource, TopicInfo, TopicUse};
use container::Container;
use messages::{Item, Messages, Topic};
use scan::{is_description, topic_of};
use source::Source;
use topics::{Names, Role, check_mapping, choose, joints_of};

/// Layouts remembered per topic: publishers that take turns on one topic.
const LAYOUTS_KEPT: usize = 4;
/// One topic while its messages are read.
#[derive(Debug)]
struct Stream {
    role: Role,
    kind: MessageKind,
    /// Most recently used first.
    layouts: Vec<Layout>,
}

/// A channel, and how often it was met.
#[derive(Debug, Default)]
struct Seen {
    topic: String,
    schema: String,
    interfaces: Vec<String>,
    is_description: bool,
    messages: u64,
    first_ns: u64,
    last_ns: u64,
}

impl Seen {
    fn describe(&mut self, topic: &Topic) {
        self.topic.clone_from(&topic.name);
        self.schema.clone_from(&topic.schema);
        self.interfaces = topic.interfaces();
        self.is_description = is_description(topic);
    }

    fn message(&mut self, log_time_ns: u64) {
        if self.messages == 0 {
            self.first_ns = log_time_ns;
        }
        self.first_ns = self.first_ns.min(log_time_ns);
        self.last_ns = self.last_ns.max(log_time_ns);
        self.messages += 1;
    }
}

/// The joints handed out: where a recorded name goes on each side.
#[derive(Debug, Default)]
struct Selection {
    n: usize,
    joint_side: HashMap<Vec<u8>, usize>,
    motor_side: HashMap<Vec<u8>, usize>,
}

pub(in crate::files) struct BagReader<M> {
    file: String,
    container: M,
    names: Names,
    mapping: Vec<JointMap>,
    joints: Vec<String>,
    channels: Channels,
    robot_description: Option<String>,
    /// Recorded names of all joints known, for telling the unknown ones.
    known: Vec<Vec<u8>>,
    schemas: BTreeMap<u16, String>,
    streams: Vec<Option<Stream>>,
    /// Every channel, at its number.
    seen: Vec<Seen>,
    /// Channels known from the start: a damaged chunk may hold their definition.
    announced: Vec<(u16, String, MessageKind)>,
    selection: Selection,
    joint_blocks: Vec<Quantity>,
    motor_blocks: Vec<Quantity>,
    ended: bool,
    starts_ns: Option<i64>,
}

/// MCAP as a recording.
pub(in crate::files) type McapReader = BagReader<Container>;

impl McapReader {
    pub(crate) fn open(
        reader: Box<dyn ReadSeek>,
        file: &str,
        options: &OpenOptions,
    ) -> Result<Self, LogError> {
        let source = Source::new(reader).map_err(|e| LogError::io(file, "read", e))?;
        let container = Container::new(source, options.chunk_limit_bytes);
        BagReader::of(container, file, options)
    }
}

impl<M: Messages> BagReader<M> {
    pub(in crate::files) fn of(
        mut container: M,
        file: &str,
        options: &OpenOptions,
    ) -> Result<Self, LogError> {
        let io = |source| LogError::io(file, "read", source);
        let contents = scan::scan(&mut container).map_err(io)?;
        let names = choose(&contents, options, file)?;
        let empty = Mapping::default();
        let mapping = options.mapping.as_ref().unwrap_or(&empty);
        check_mapping(mapping)?;
        let (joints, channels, known) = joints_of(&contents, &names, mapping, file)?;
        let effort = match names.joint_effort {
            JointEffort::TauEl => Some(Quantity::TauEl),
            JointEffort::TauM => Some(Quantity::TauM),
            JointEffort::Ignore => None,
        };
        let mut joint_blocks = vec![Quantity::Q, Quantity::Dq];
        joint_blocks.extend(effort);
        // A quantity has one source; the joint side's wins.
        let motor_blocks = [Quantity::Theta, Quantity::TauM, Quantity::Temperature]
            .into_iter()
            .filter(|quantity| !joint_blocks.contains(quantity))
            .collect();
        let mut reader = BagReader {
            file: file.to_owned(),
            container,
            names,
            mapping: mapping.joints.clone(),
            joints,
            channels,
            robot_description: contents.robot_description,
            known,
            schemas: BTreeMap::new(),
            streams: Vec::new(),
            seen: Vec::new(),
            announced: contents
                .topics
                .iter()
                .filter_map(|(id, topic)| {
                    Some((
                        *id,
                        topic.name.clone(),
                        MessageKind::of_schema(&topic.schema)?,
                    ))
                })
                .collect(),
            selection: Selection::default(),
            joint_blocks,
            motor_blocks,
            ended: false,
            starts_ns: contents.starts_ns,
        };
        for (id, topic) in &contents.topics {
            reader.saw(*id).describe(topic);
        }
        let all = reader.joints.clone();
        reader.select(&all);
        Ok(reader)
    }

    /// What is noted of a channel.
    fn saw(&mut self, id: u16) -> &mut Seen {
        let id = usize::from(id);
        if self.seen.len() <= id {
            self.seen.resize_with(id + 1, Seen::default);
        }
        &mut self.seen[id]
    }

    fn channel(&mut self, channel: &mcap::records::Channel) {
        if self.saw(channel.id).topic.is_empty() {
            let topic = topic_of(channel, &self.schemas);
            self.saw(channel.id).describe(&topic);
        }
        let kind = self
            .schemas
            .get(&channel.schema_id)
            .and_then(|schema| MessageKind::of_schema(schema));
        if let Some(kind) = kind {
            self.stream(channel.id, &channel.topic, kind);
        }
    }

    /// From now on messages of the channel are read, if its topic has a role.
    fn stream(&mut self, id: u16, topic: &str, kind: MessageKind) {
        let Some(role) = self.names.role(topic) else {
            return;
        };
        let id = usize::from(id);
        if self.streams.len() <= id {
            self.streams.resize_with(id + 1, || None);
        }
        // The definition is repeated in every chunk by some recorders: keep the layouts.
        if self.streams[id].is_none() {
            self.streams[id] = Some(Stream {
                role,
                kind,
                layouts: Vec::new(),
            });
        }
    }

    #[inline]
    fn message(
        &mut self,
        channel: u16,
        log_time_ns: u64,
        joiner: &mut Joiner,
        health: &mut Health,
    ) {
        health.messages += 1;
        let data = self.container.payload();
        let Some(Some(stream)) = self.streams.get_mut(usize::from(channel)) else {
            return;
        };
        let fitting = stream.layouts.iter().position(|layout| layout.fits(data));
        match fitting {
            Some(0) => {}
            Some(index) => stream.layouts.swap(0, index),
            None => {
                let (blocks, joints) = match stream.role {
                    Role::Joint => (self.joint_blocks.as_slice(), &self.selection.joint_side),
                    Role::Motor => (self.motor_blocks.as_slice(), &self.selection.motor_side),
                    Role::External => ([Quantity::TauExt].as_slice(), &self.selection.joint_side),
                };
                let n = self.selection.n;
                let (names, role) = (&self.names, stream.role);
                let column = |entry: &Entry<'_>| {
                    let joint = *joints.get(entry.joint)?;
                    let quantity = names.quantity(role, entry.field)?;
                    let block = blocks.iter().position(|block| *block == quantity)?;
                    Some(block * n + joint)
                };
                let layout = match parse(stream.kind, data) {
                    Ok(parsed) => {
                        note_unknown(&parsed.names, &self.known, health);
                        Layout::new(data, &parsed, blocks.len() * n, column)
                    }
                    Err(error) => {
                        health.undecodable(log_time_ns as i64, || {
                            format!("message of channel {channel}: {error}")
                        });
                        return;
                    }
                };
                let side = match stream.role {
                    Role::Joint => None,
                    Role::Motor => joiner.sides.first_mut(),
                    Role::External => joiner.sides.last_mut(),
                };
                if let Some(side) = side {
                    layout.columns().for_each(|column| side.note_column(column));
                }
                stream.layouts.truncate(LAYOUTS_KEPT - 1);
                stream.layouts.insert(0, layout);
            }
        }
        let layout = &stream.layouts[0];
        health.short_messages += u64::from(layout.short);
        if !layout.is_empty() {
            // A zero stamp is what a node without a clock writes.
            let stamp = stamp_ns(data).unwrap_or(0);
            let time_ns = if stamp == 0 {
                i64::try_from(log_time_ns).unwrap_or(i64::MAX)
            } else {
                stamp
            };
            let fill = |row: &mut [f64]| layout.copy(data, row);
            match stream.role {
                Role::Joint => joiner.primary.insert(time_ns, fill),
                Role::Motor => {
                    if let Some(side) = joiner.sides.first_mut() {
                        side.sorter.insert(time_ns, fill);
                    }
                }
                Role::External => {
                    if let Some(side) = joiner.sides.last_mut() {
                        side.sorter.insert(time_ns, fill);
                    }
                }
            }
        }
        if !layout.is_cacheable() {
            stream.layouts.remove(0);
        }
    }
}

impl<M: Messages> Reader for BagReader<M> {
    fn format(&self) -> Format {
        M::FORMAT
    }

    fn layout(&self) -> String {
        self.names.layout()
    }

    fn starts_ns(&mut self) -> Result<Option<i64>, LogError> {
        Ok(self.starts_ns)
    }

    fn found(&self) -> (Vec<String>, Channels) {
        (self.joints.clone(), self.channels.clone())
    }

    fn select(&mut self, joints: &[String]) {
        let mut selection = Selection {
            n: joints.len(),
            ..Selection::default()
        };
        for (index, joint) in joints.iter().enumerate() {
            let mapped = self.mapping.iter().find(|mapped| mapped.name == *joint);
            let recorded = mapped.map_or(joint.as_str(), JointMap::recorded_name);
            let motor = mapped.map_or(joint.as_str(), JointMap::motor_recorded_name);
            selection
                .joint_side
                .insert(recorded.as_bytes().to_vec(), index);
            selection
                .motor_side
                .insert(motor.as_bytes().to_vec(), index);
        }
        self.selection = selection;
        self.streams.clear();
        for (id, topic, kind) in self.announced.clone() {
            self.stream(id, &topic, kind);
        }
    }

    fn joiner(&self, joints: &[String], options: &OpenOptions) -> Joiner {
        let mut signals = Vec::with_capacity(6 * joints.len());
        for quantity in Quantity::PER_JOINT {
            for joint in joints {
                let source = self
                    .mapping
                    .iter()
                    .find(|mapped| mapped.name == *joint)
                    .and_then(|mapped| mapped.sources[quantity.index()].as_ref());
                signals.push(match source {
                    None => Signal::si(quantity),
                    Some(source) => Signal {
                        scale: source.terms.first().map_or(1.0, |term| term.scale),
                        offset: source.terms.first().map_or(0.0, |term| term.offset),
                        period: match source.wrap {
                            Wrap::Never => None,
                            Wrap::Period(period) => Some(period),
                        },
                    },
                });
            }
        }
        let conditioner = Conditioner::new(joints, signals, to_ns(options.gap_s));
        let mut sides: Vec<&[Quantity]> = Vec::new();
        if self.names.motor_topic.is_some() {
            sides.push(&self.motor_blocks);
        }
        if self.names.external_topic.is_some() {
            sides.push(&[Quantity::TauExt]);
        }
        Joiner::new(
            joints.len(),
            &self.joint_blocks,
            &sides,
            to_ns(options.reorder_s),
            to_ns(options.interpolate_s),
            conditioner,
        )
    }

    fn progress(&self) -> Progress {
        self.container.progress()
    }

    fn sources(&self) -> Vec<SignalSource> {
        self.names.sources(&self.channels)
    }

    fn topics(&self) -> Vec<TopicInfo> {
        let mut topics: BTreeMap<&str, Seen> = BTreeMap::new();
        for seen in self.seen.iter().filter(|seen| !seen.topic.is_empty()) {
            let all = topics.entry(&seen.topic).or_default();
            if seen.messages > 0 {
                all.message(seen.first_ns);
                all.message(seen.last_ns);
                all.messages = all.messages + seen.messages - 2;
            }
            all.schema.clone_from(&seen.schema);
            all.is_description = seen.is_description;
            all.interfaces.extend_from_slice(&seen.interfaces);
        }
        let info = |(name, all): (&str, Seen)| TopicInfo {
            name: name.to_owned(),
            kind: all.schema,
            messages: all.messages,
            rate_hz: (all.messages > 1 && all.last_ns > all.first_ns)
                .then(|| (all.messages - 1) as f64 * 1e9 / (all.last_ns - all.first_ns) as f64),
            interfaces: all.interfaces,
            taken_for: match self.names.role(name) {
                Some(Role::Joint) => Some(TopicUse::JointSide),
                Some(Role::Motor) => Some(TopicUse::MotorSide),
                Some(Role::External) => Some(TopicUse::ExternalTorque),
                None => all.is_description.then_some(TopicUse::RobotDescription),
            },
        };
        topics.into_iter().map(info).collect()
    }

    fn robot_description(&self) -> Option<&str> {
        self.robot_description.as_deref()
    }

    fn pull(&mut self, joiner: &mut Joiner, health: &mut Health) -> Result<bool, LogError> {
        while !self.ended {
            let item = self
                .container
                .next(health)
                .map_err(|source| LogError::io(&self.file, "read", source))?;
            match item {
                Item::End => self.ended = true,
                Item::Damage => joiner.mark_damage(),
                Item::Schema { id, name } => {
                    self.schemas.insert(id, name);
                }
                Item::Channel(channel) => self.channel(&channel),
                Item::Message {
                    channel,
                    log_time_ns,
                } => {
                    self.saw(channel).message(log_time_ns);
                    let known = self.streams.get(usize::from(channel));
                    if known.is_some_and(Option::is_some) {
                        self.message(channel, log_time_ns, joiner, health);
                        return Ok(true);
                    }
                }
            }
        }
        Ok(false)
    }
}

fn note_unknown(names: &[&[u8]], known: &[Vec<u8>], health: &mut Health) {
    for name in names {
        if health.unknown_joints.len() >= UNKNOWN_LIMIT {
            return;
        }
        if !known.iter().any(|known| known == name) {
            let name = sinew_files::names::shorten(&String::from_utf8_lossy(name), 80);
            if !health.unknown_joints.contains(&name) {
                health.unknown_joints.push(name);
            }
        }
    }
}
