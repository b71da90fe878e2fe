//! From messages to samples in the joiner: one decoder for files and for what comes live.

use super::names::Names;
use crate::assemble::{Conditioner, Joiner, Signal};
use crate::decode::{Entry, Layout, MessageKind, parse, stamp_ns};
use crate::frame::{Channels, DrivenJoint, Quantity};
use crate::health::{Health, UNKNOWN_LIMIT};
use crate::mapping::{JointEffort, JointMap, Mapping, Wrap};
use crate::options::{OpenOptions, to_ns};
use crate::sources::TopicUse;
use std::collections::HashMap;

/// Layouts remembered per topic: publishers that take turns on one topic.
const LAYOUTS_KEPT: usize = 4;
/// Places of the joiner's side streams.
const MOTOR: usize = 0;
const EXTERNAL: usize = 1;

/// Place of a side among the joiner's side streams; `None`: it sets the instants.
fn place(side: TopicUse) -> Option<usize> {
    match side {
        TopicUse::MotorSide => Some(MOTOR),
        TopicUse::ExternalTorque => Some(EXTERNAL),
        TopicUse::JointSide | TopicUse::RobotDescription => None,
    }
}

/// One topic while its messages are read.
#[derive(Debug)]
struct Stream {
    topic: String,
    side: TopicUse,
    kind: MessageKind,
    /// Most recently used first.
    layouts: Vec<Layout>,
}

/// The joints handed out: where a recorded name goes on each side.
#[derive(Debug, Default)]
struct Selection {
    n: usize,
    joint_side: HashMap<Vec<u8>, usize>,
    motor_side: HashMap<Vec<u8>, usize>,
}

/// Takes messages apart, and puts their values into the joiner's streams.
///
/// # Realtime
/// [`Self::push`] allocates nothing where a message is laid out as one of the last four of its topic.
#[derive(Debug)]
pub(crate) struct Samples {
    names: Names,
    mapping: Vec<JointMap>,
    /// Recorded names of all joints known, for telling the unknown ones.
    known: Vec<Vec<u8>>,
    streams: Vec<Option<Stream>>,
    selection: Selection,
    joint_blocks: Vec<Quantity>,
    motor_blocks: Vec<Quantity>,
    /// What came so far of each joint selected.
    came: Channels,
}

impl Samples {
    pub(crate) fn new(names: Names, mapping: &Mapping, known: Vec<Vec<u8>>) -> Self {
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
            known,
            streams: Vec::new(),
            selection: Selection::default(),
            joint_blocks,
            motor_blocks,
            came: Channels::default(),
        }
    }

    pub(crate) fn names(&self) -> &Names {
        &self.names
    }

    /// Quantities that messages held so far of each joint selected.
    pub(crate) fn came(&self) -> &Channels {
        &self.came
    }

    /// Recorded names that are nothing new.
    pub(crate) fn set_known(&mut self, known: Vec<Vec<u8>>) {
        self.known = known;
    }

    /// The joints of the samples from now on. Streams are announced anew afterwards.
    pub(crate) fn select(&mut self, joints: &[DrivenJoint]) {
        let mut selection = Selection {
            n: joints.len(),
            ..Selection::default()
        };
        for (index, joint) in joints.iter().enumerate() {
            let (recorded, _) = self.recorded_names(&joint.joint);
            let (_, motor) = self.recorded_names(&joint.motor);
            let name = |name: &str| name.as_bytes().to_vec();
            selection.joint_side.insert(name(recorded), index);
            selection.motor_side.insert(name(motor), index);
        }
        self.came = Channels {
            joints: vec![Default::default(); joints.len()],
            temperature: false,
        };
        self.selection = selection;
        self.streams.clear();
    }

    /// The names of a joint in messages of the joint side and of the motor side.
    pub(crate) fn recorded_names<'a>(&'a self, joint: &'a str) -> (&'a str, &'a str) {
        let mapped = self.mapping.iter().find(|mapped| mapped.name == joint);
        (
            mapped.map_or(joint, JointMap::recorded_name),
            mapped.map_or(joint, JointMap::motor_recorded_name),
        )
    }

    /// Topics have these roles from now on. Streams are announced anew afterwards.
    pub(crate) fn rename(&mut self, names: Names, joiner: &mut Joiner) {
        self.names = names;
        self.streams.clear();
        self.expect(joiner);
    }

    fn expect(&self, joiner: &mut Joiner) {
        joiner.expect(MOTOR, self.names.motor_topic.is_some());
        joiner.expect(EXTERNAL, self.names.external_topic.is_some());
    }

    /// From now on messages of the stream are read, if its topic has a role.
    pub(crate) fn stream(&mut self, id: u16, topic: &str, kind: MessageKind) {
        let Some(side) = self.names.taken_for(topic) else {
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
            });
        }
    }

    /// Whether messages of the stream are read.
    #[inline]
    pub(crate) fn reads(&self, id: u16) -> bool {
        let stream = self.streams.get(usize::from(id));
        stream.is_some_and(Option::is_some)
    }

    /// A joiner for the samples of the joints selected, which are `joints`.
    pub(crate) fn joiner(&self, joints: &[DrivenJoint], options: &OpenOptions) -> Joiner {
        let mut signals = Vec::with_capacity(6 * joints.len());
        for quantity in Quantity::PER_JOINT {
            for joint in joints {
                let source = self
                    .mapping
                    .iter()
                    .find(|mapped| mapped.name == joint.recorded(quantity))
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
        let mut joiner = Joiner::new(
            joints.len(),
            &self.joint_blocks,
            // At MOTOR and EXTERNAL.
            &[&self.motor_blocks, &[Quantity::TauExt]],
            to_ns(options.reorder_s),
            to_ns(options.interpolate_s),
            conditioner,
        );
        self.expect(&mut joiner);
        joiner
    }

    /// A message of a stream that [is read](Self::reads), received at `received_ns` where its stamp is zero.
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
        let fitting = stream.layouts.iter().position(|layout| layout.fits(data));
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
        let layout = &stream.layouts[0];
        health.short_messages += u64::from(layout.short);
        if !layout.is_empty() {
            // A zero stamp is what a node without a clock writes.
            let stamp = stamp_ns(data).unwrap_or(0);
            let time_ns = if stamp == 0 { received_ns } else { stamp };
            let fill = |row: &mut [f64]| layout.copy(data, row);
            match place(stream.side) {
                None => joiner.primary.insert(time_ns, fill),
                Some(side) => joiner.sides[side].sorter.insert(time_ns, fill),
            }
        }
        if !layout.is_cacheable() {
            stream.layouts.remove(0);
        }
    }

    /// Learns how a message is laid out; `false`: it can't be decoded.
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
                note_unknown(&parsed.names, &self.known, health);
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
        if let Some(side) = place(side).and_then(|place| joiner.sides.get_mut(place)) {
            layout.columns().for_each(|column| side.note_column(column));
        }
        stream.layouts.truncate(LAYOUTS_KEPT - 1);
        stream.layouts.insert(0, layout);
        true
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
