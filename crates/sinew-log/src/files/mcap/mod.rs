//! MCAP as ROS 2 writes it: joint side, motor side and external torque as samples.

mod chunk;
mod container;
mod given;
mod lengths;
pub(in crate::files) mod messages;
mod ros1;
mod scan;
mod source;

use std::collections::BTreeMap;

use crate::assemble::Joiner;
use crate::decode::MessageKind;
use crate::error::LogError;
use crate::files::read_seek::ReadSeek;
use crate::files::reader::{Format, Progress, Reader};
use crate::frame::{AxisNames, Channels};
use crate::health::Health;
use crate::live::choose::{check_mapping, choose};
use crate::live::joints::{Joints, joints_of};
use crate::live::samples::Samples;
use crate::live::seen::{Seen, topics_of};
use crate::mapping::Mapping;
use crate::options::OpenOptions;
use crate::sources::{SignalSource, TopicInfo};
use container::Container;
pub use given::GivenMessages;
pub(in crate::files) use given::GivenReader;
pub use lengths::parse_mcap_record;
use messages::{Item, Messages};
use scan::topic_of;
use source::Source;

/// Reader of a container of messages, with their conversion to samples.
pub(in crate::files) struct BagReader<M> {
    file: String,
    container: M,
    samples: Samples,
    joints: Vec<String>,
    tendons: Vec<String>,
    channels: Channels,
    robot_description: Option<String>,
    schemas: BTreeMap<u16, String>,
    /// Channels by their numbers.
    seen: Vec<Seen>,
    /// Channels known from the start: a damaged chunk may hold their definition.
    announced: Vec<(u16, String, MessageKind)>,
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
        let container = Container::new(source, &options.budget);
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
        let survey = scan::scan(&mut container).map_err(io)?;
        let names = choose(&survey, options, file)?;
        let empty = Mapping::default();
        let mapping = options.mapping.as_ref().unwrap_or(&empty);
        check_mapping(mapping)?;
        let Joints {
            joints,
            channels,
            tendons,
            recorded,
        } = joints_of(&survey, &names, mapping, file)?;
        let announced = survey.topics.iter().filter_map(|(id, topic)| {
            let kind = MessageKind::of_schema(&topic.schema)?;
            Some((*id, topic.name.clone(), kind))
        });
        let mut samples = Samples::new(names, mapping, recorded);
        samples.set_surveyed(&survey);
        let mut reader = BagReader {
            file: file.to_owned(),
            container,
            samples,
            announced: announced.collect(),
            joints,
            tendons,
            channels,
            schemas: BTreeMap::new(),
            seen: Vec::new(),
            ended: false,
            starts_ns: survey.starts_ns,
            robot_description: survey.robot_description,
        };
        for (id, topic) in &survey.topics {
            reader.saw(*id).describe(topic);
        }
        let all = reader.joints.clone();
        reader.select(&AxisNames::of_joints(&all));
        Ok(reader)
    }

    /// Statistics of a channel.
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
            self.samples.stream(channel.id, &channel.topic, kind);
        }
    }
}

impl<M: Messages> Reader for BagReader<M> {
    fn format(&self) -> Format {
        M::FORMAT
    }

    fn layout(&self) -> String {
        self.samples.names().layout()
    }

    fn starts_ns(&mut self) -> Result<Option<i64>, LogError> {
        Ok(self.starts_ns)
    }

    fn found(&self) -> (Vec<String>, Channels) {
        (self.joints.clone(), self.channels.clone())
    }

    fn tendons(&self) -> &[String] {
        &self.tendons
    }

    fn select(&mut self, axes: &[AxisNames]) {
        self.samples.select(axes);
        for (id, topic, kind) in &self.announced {
            self.samples.stream(*id, topic, *kind);
        }
    }

    fn joiner(&self, axes: &[AxisNames], options: &OpenOptions) -> Joiner {
        let mut joiner = self.samples.joiner(axes, options);
        joiner.exclude_second_publishers();
        joiner
    }

    fn progress(&self) -> Progress {
        self.container.progress()
    }

    fn sources(&self) -> Vec<SignalSource> {
        self.samples.names().sources(&self.channels)
    }

    fn topics(&self) -> Vec<TopicInfo> {
        topics_of(&self.seen, self.samples.names())
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
                    if self.samples.reads(channel) {
                        // A time beyond 2262 is as good as none.
                        let received_ns = i64::try_from(log_time_ns).unwrap_or(i64::MAX);
                        let data = self.container.payload();
                        self.samples
                            .push(channel, data, received_ns, joiner, health);
                        return Ok(true);
                    }
                }
            }
        }
        Ok(false)
    }
}
