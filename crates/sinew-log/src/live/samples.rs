//! Conversion of messages to samples in the joiner: one decoder for files and for online input.

use super::names::Names;
use super::survey::Survey;
use crate::assemble::{Conditioner, Joiner, Signal};
use crate::decode::{Entry, Layout, MessageKind, parse, stamp_ns};
use crate::frame::{AxisNames, Channels, Quantity, blocks};
use crate::health::{Health, UNKNOWN_LIMIT};
use crate::mapping::{JointEffort, JointMap, Mapping, TendonMap, Wrap};
use crate::options::{OpenOptions, to_ns};
use crate::sources::TopicUse;
use std::collections::HashMap;

/// Number of layouts per topic: several publishers may alternate on one topic.
const LAYOUTS_KEPT: usize = 4;
/// Time before which a message without a time stamp has the stamp of zero of a simulated clock, ns.
const SIMULATION_STARTS_NS: i64 = 250_000_000;
/// Places of the joiner's side streams.
const MOTOR: usize = 0;
const EXTERNAL: usize = 1;
const REST: usize = 2;
const TENSION: usize = 3;

/// Place of a side among the joiner's side streams; `None`: it sets the instants.
fn place(side: TopicUse) -> Option<usize> {
    match side {
        TopicUse::MotorSide => Some(MOTOR),
        TopicUse::ExternalTorque => Some(EXTERNAL),
        TopicUse::Tension => Some(TENSION),
        TopicUse::JointSide | TopicUse::RobotDescription => None,
    }
}

/// Topic whose messages are read.
#[derive(Debug)]
struct Stream {
    topic: String,
    side: TopicUse,
    kind: MessageKind,
    /// Layouts of the messages, and whether they lack the reference joint; most recently used first.
    layouts: Vec<(Layout, bool)>,
    /// Last time stamp minus the time of its receipt, ns; `None`: no message of the topic has a time stamp.
    stamp_lag_ns: Option<i64>,
}

impl Stream {
    /// Time of a message, ns: its time stamp. A message without one has the time of its receipt, on the clock of
    /// the time stamps if the topic has any.
    #[inline]
    fn time_ns(&mut self, stamp_ns: i64, received_ns: i64, health: &mut Health) -> i64 {
        if stamp_ns != 0 {
            self.stamp_lag_ns = Some(stamp_ns.saturating_sub(received_ns));
            return stamp_ns;
        }
        let Some(lag_ns) = self.stamp_lag_ns else {
            return received_ns;
        };
        let time_ns = received_ns.saturating_add(lag_ns);
        if time_ns <= SIMULATION_STARTS_NS {
            return 0;
        }
        health.unstamped += 1;
        time_ns
    }
}

/// Selected axes: the destination of each recorded name on each side.
#[derive(Debug, Default)]
struct Selection {
    n: usize,
    joint_side: HashMap<Vec<u8>, usize>,
    motor_side: HashMap<Vec<u8>, usize>,
    tendons: HashMap<Vec<u8>, usize>,
    /// Axis whose messages on the joint side set the instants; `None`: all do.
    reference: Option<usize>,
}

/// Takes messages apart, and puts their values into the joiner's streams.
///
/// # Realtime
/// [`Self::push`] does not allocate for a message with one of the last four layouts of its topic.
#[derive(Debug)]
pub(crate) struct Samples {
    names: Names,
    mapping: Vec<JointMap>,
    tendons: Vec<TendonMap>,
    /// Recorded names of all joints, to detect unknown ones.
    recorded: Vec<Vec<u8>>,
    streams: Vec<Option<Stream>>,
    selection: Selection,
    joint_blocks: Vec<Quantity>,
    motor_blocks: Vec<Quantity>,
    /// Quantities received so far of each selected axis.
    came: Channels,
    /// Topics whose messages have time stamps: time stamp minus the time of its receipt, ns.
    stamped: HashMap<String, i64>,
    /// Recorded name of each joint of the joint side, and the number of its messages.
    frequent: Vec<(String, u64)>,
}

impl Samples {
    pub(crate) fn new(names: Names, mapping: &Mapping, recorded: Vec<Vec<u8>>) -> Self {
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
        Samples {
            names,
            mapping: mapping.joints.clone(),
            tendons: mapping.tendons.clone(),
            recorded,
            streams: Vec::new(),
            selection: Selection::default(),
            joint_blocks,
            motor_blocks,
            came: Channels::default(),
            stamped: HashMap::new(),
            frequent: Vec::new(),
        }
    }

    /// Sets which topics have time stamps, and which joints have the most messages, by the first messages of a
    /// recording.
    pub(crate) fn set_surveyed(&mut self, survey: &Survey) {
        let topics = survey.topics.values();
        let lags = topics.clone();
        let lags = lags.filter_map(|topic| Some((topic.name.clone(), topic.stamp_lag_ns?)));
        self.stamped = lags.collect();
        let own = topics.filter(|topic| Some(&topic.name) == self.names.joint_topic.as_ref());
        let joints = own.flat_map(|topic| &topic.joints);
        let counts = joints.map(|(name, fields)| (name.clone(), fields.messages));
        self.frequent = counts.collect();
    }

    /// The axis whose joint has the most messages: those of other publishers are evaluated at its time stamps.
    fn reference(&self, joint_side: &HashMap<Vec<u8>, usize>) -> Option<usize> {
        let counts = self.frequent.iter().rev().filter(|(_, count)| *count > 0);
        let own = counts.filter_map(|(name, n)| Some((*joint_side.get(name.as_bytes())?, *n)));
        own.max_by_key(|(_, count)| *count).map(|(axis, _)| axis)
    }

    pub(crate) fn names(&self) -> &Names {
        &self.names
    }

    /// Quantities of each selected axis that messages have contained so far.
    pub(crate) fn came(&self) -> &Channels {
        &self.came
    }

    /// Sets the recorded names of all joints.
    pub(crate) fn set_recorded(&mut self, recorded: Vec<Vec<u8>>) {
        self.recorded = recorded;
    }

    /// Sets the axes of the samples from now on. Streams are announced again afterwards.
    pub(crate) fn select(&mut self, axes: &[AxisNames]) {
        let mut selection = Selection {
            n: axes.len(),
            ..Selection::default()
        };
        for (index, axis) in axes.iter().enumerate() {
            let [joint, motor, tendon] = self.recorded_of(axis);
            let sides = [
                (joint, &mut selection.joint_side),
                (motor, &mut selection.motor_side),
                (tendon, &mut selection.tendons),
            ];
            for (name, side) in sides {
                if let Some(name) = name {
                    side.insert(name.as_bytes().to_vec(), index);
                }
            }
        }
        selection.reference = self.reference(&selection.joint_side);
        self.came = Channels {
            joints: vec![Default::default(); axes.len()],
            temperature: false,
        };
        self.selection = selection;
        self.streams.clear();
    }

    /// The names of joint, motor and tendon of an axis in messages.
    pub(crate) fn recorded_of<'a>(&'a self, axis: &'a AxisNames) -> [Option<&'a str>; 3] {
        let joint = axis.joint.as_deref();
        let motor = axis.motor.as_deref();
        [
            joint.map(|joint| self.recorded_names(joint).0),
            motor.map(|motor| self.recorded_names(motor).1),
            axis.tendon.as_deref().map(|tendon| {
                let mapped = self.tendons.iter().find(|mapped| mapped.name == tendon);
                mapped.map_or(tendon, TendonMap::recorded_name)
            }),
        ]
    }

    /// The names of a joint in messages of the joint side and of the motor side.
    fn recorded_names<'a>(&'a self, joint: &'a str) -> (&'a str, &'a str) {
        let mapped = self.mapping.iter().find(|mapped| mapped.name == joint);
        (
            mapped.map_or(joint, JointMap::recorded_name),
            mapped.map_or(joint, JointMap::motor_recorded_name),
        )
    }

    /// Sets the roles of the topics from now on. Streams are announced again afterwards.
    pub(crate) fn rename(&mut self, names: Names, joiner: &mut Joiner) {
        self.names = names;
        self.streams.clear();
        self.expect(joiner);
    }

    fn expect(&self, joiner: &mut Joiner) {
        joiner.expect(MOTOR, self.names.motor_topic.is_some());
        joiner.expect(EXTERNAL, self.names.external_topic.is_some());
        // From the first such message on.
        joiner.expect(REST, false);
        joiner.expect(TENSION, self.names.tension_topic.is_some());
    }

    /// Announces a stream; its messages are read if its topic has a role.
    pub(crate) fn stream(&mut self, id: u16, topic: &str, kind: MessageKind) {
        let Some(side) = self.names.role(topic) else {
            return;
        };
        let id = usize::from(id);
        if self.streams.len() <= id {
            self.streams.resize_with(id + 1, || None);
        }
        // The definition is repeated in every chunk by some recorders: keep the layouts.
        if self.streams[id].is_none() {
            self.streams[id] = Some(Stream {
                topic: topic.to_owned(),
                side,
                kind,
                layouts: Vec::new(),
                stamp_lag_ns: self.stamped.get(topic).copied(),
            });
        }
    }

    /// Whether messages of the stream are used.
    #[inline]
    pub(crate) fn reads(&self, id: u16) -> bool {
        let stream = self.streams.get(usize::from(id));
        stream.is_some_and(Option::is_some)
    }

    /// A joiner for the samples of the axes selected, which are `axes`.
    pub(crate) fn joiner(&self, axes: &[AxisNames], options: &OpenOptions) -> Joiner {
        let signal = |axis: &AxisNames, quantity: Quantity| {
            let name = axis.recorded(quantity).unwrap_or_default();
            let source = if quantity == Quantity::Tension {
                let mut mapped = self.tendons.iter();
                let mapped = mapped.find(|mapped| mapped.name == name);
                mapped.and_then(|mapped| mapped.tension.as_ref())
            } else {
                let mut mapped = self.mapping.iter();
                let mapped = mapped.find(|mapped| mapped.name == name);
                mapped.and_then(|mapped| mapped.sources.get(quantity.index())?.as_ref())
            };
            match source {
                None => Signal::si(quantity),
                Some(source) => Signal {
                    scale: source.terms.first().map_or(1.0, |term| term.scale),
                    offset: source.terms.first().map_or(0.0, |term| term.offset),
                    period: match source.wrap {
                        Wrap::Never => None,
                        Wrap::Period(period) => Some(period),
                    },
                },
            }
        };
        // At MOTOR, EXTERNAL, REST and TENSION.
        let mut sides: Vec<&[Quantity]> =
            vec![&self.motor_blocks, &[Quantity::TauExt], &self.joint_blocks];
        if blocks(axes).contains(&Quantity::Tension) {
            sides.push(&[Quantity::Tension]);
        }
        let mut joiner = Joiner::new(
            axes.len(),
            &self.joint_blocks,
            &sides,
            to_ns(options.reorder_s),
            to_ns(options.interpolate_s),
            Conditioner::new(axes, to_ns(options.gap_s), signal),
        );
        self.expect(&mut joiner);
        joiner
    }

    /// Adds a message of a stream that [is read](Self::reads); `received_ns` is the time of its receipt.
    #[inline]
    pub(crate) fn push(
        &mut self,
        id: u16,
        data: &[u8],
        received_ns: i64,
        joiner: &mut Joiner,
        health: &mut Health,
    ) {
        health.messages += 1;
        let Some(Some(stream)) = self.streams.get_mut(usize::from(id)) else {
            return;
        };
        let mut layouts = stream.layouts.iter();
        let fitting = layouts.position(|(layout, _)| layout.fits(data));
        match fitting {
            Some(0) => {}
            Some(index) => stream.layouts.swap(0, index),
            None => {
                if !self.lay_out(id, data, received_ns, joiner, health) {
                    return;
                }
            }
        }
        let Some(Some(stream)) = self.streams.get_mut(usize::from(id)) else {
            return;
        };
        // A zero stamp is what a node without a clock writes.
        let stamp = stamp_ns(data).unwrap_or(0);
        let time_ns = stream.time_ns(stamp, received_ns, health);
        let (layout, is_rest) = &stream.layouts[0];
        health.short_messages += u64::from(layout.short);
        if !layout.is_empty() {
            let fill = |row: &mut [f64]| layout.copy(data, row);
            let side = place(stream.side).or(is_rest.then_some(REST));
            match side {
                None => joiner.primary.insert_received(time_ns, received_ns, fill),
                Some(side) => {
                    if let Some(side) = joiner.sides.get_mut(side) {
                        side.sorter.insert_received(time_ns, received_ns, fill);
                    }
                }
            }
        }
        if !layout.is_cacheable() {
            stream.layouts.remove(0);
        }
    }

    /// Determines the layout of a message; `false`: it cannot be decoded.
    #[cold]
    fn lay_out(
        &mut self,
        id: u16,
        data: &[u8],
        received_ns: i64,
        joiner: &mut Joiner,
        health: &mut Health,
    ) -> bool {
        let Some(Some(stream)) = self.streams.get_mut(usize::from(id)) else {
            return false;
        };
        let (blocks, joints) = match place(stream.side) {
            None => (self.joint_blocks.as_slice(), &self.selection.joint_side),
            Some(MOTOR) => (self.motor_blocks.as_slice(), &self.selection.motor_side),
            Some(TENSION) => ([Quantity::Tension].as_slice(), &self.selection.tendons),
            Some(_) => ([Quantity::TauExt].as_slice(), &self.selection.joint_side),
        };
        let n = self.selection.n;
        let (names, side) = (&self.names, stream.side);
        let column = |entry: &Entry<'_>| {
            let joint = *joints.get(entry.joint)?;
            let quantity = names.quantity(side, entry.field)?;
            let block = blocks.iter().position(|block| *block == quantity)?;
            Some(block * n + joint)
        };
        let layout = match parse(stream.kind, data) {
            Ok(parsed) => {
                // Tendons are unknown unless they are requested.
                if side != TopicUse::Tension || !self.selection.tendons.is_empty() {
                    note_unknown(&parsed.names, &self.recorded, health);
                }
                Layout::new(data, &parsed, blocks.len() * n, column)
            }
            Err(error) => {
                health.undecodable(received_ns, || {
                    format!("message of {}: {error}", stream.topic)
                });
                return false;
            }
        };
        for column in layout.columns() {
            let quantity = blocks[column / n];
            self.came.joints[column % n].insert(quantity);
            self.came.temperature |= quantity == Quantity::Temperature;
        }
        let is_joint_side = place(side).is_none() && !layout.is_empty();
        let lacks = |axis: usize| !layout.columns().any(|column| column % n == axis);
        let is_rest = is_joint_side && self.selection.reference.is_some_and(lacks);
        if is_rest {
            joiner.expect(REST, true);
        }
        let place = place(side).or(is_rest.then_some(REST));
        if let Some(side) = place.and_then(|place| joiner.sides.get_mut(place)) {
            layout.columns().for_each(|column| side.note_column(column));
        }
        stream.layouts.truncate(LAYOUTS_KEPT - 1);
        stream.layouts.insert(0, (layout, is_rest));
        true
    }
}

fn note_unknown(names: &[&[u8]], recorded: &[Vec<u8>], health: &mut Health) {
    for name in names {
        if health.unknown_joints.len() >= UNKNOWN_LIMIT {
            return;
        }
        if !recorded.iter().any(|recorded| recorded == name) {
            let name = sinew_files::names::shorten(&String::from_utf8_lossy(name), 80);
            if !health.unknown_joints.contains(&name) {
                health.unknown_joints.push(name);
            }
        }
    }
}
