//! Recordings created message by message, and emptied queues.

use mcap::records::MessageHeader;
use sinew_log::Frame;
use sinew_log::encode::{Header, JointState, Message as _};
use sinew_transport::{Batch, BatchContent, FrameAssembler, Inbox, Item, RobotId, TransportFault};
use std::collections::BTreeMap;
use std::io::{Cursor, Seek, Write};
use std::time::{Duration, Instant};

pub(crate) const START_NS: i64 = 1_700_000_000_000_000_000;
pub(crate) const MS: i64 = 1_000_000;
pub(crate) const STATE: &str = "sensor_msgs/msg/JointState";
/// Maximum time to wait for an expected event.
pub(crate) const PATIENCE: Duration = Duration::from_secs(20);

/// Joint state of joint `a`.
pub(crate) fn state(time_ns: i64, q: f64) -> Vec<u8> {
    let mut cdr = Vec::new();
    JointState {
        header: Header::at(time_ns, "").unwrap(),
        name: &["a".to_owned()],
        position: &[q],
        velocity: &[],
        effort: &[],
    }
    .encode(&mut cdr)
    .unwrap();
    cdr
}

/// MCAP with one topic of joint states, written into `to`.
pub(crate) struct Bag<W: Write + Seek> {
    pub(crate) writer: mcap::Writer<W>,
    channel: u16,
}

impl<W: Write + Seek> Bag<W> {
    pub(crate) fn new(to: W, options: mcap::WriteOptions) -> Self {
        let mut writer = options.profile("ros2").create(to).unwrap();
        let schema = writer.add_schema(STATE, "ros2msg", b"text").unwrap();
        let channel = writer
            .add_channel(schema, "/joint_states", "cdr", &BTreeMap::new())
            .unwrap();
        Bag { writer, channel }
    }

    pub(crate) fn state(&mut self, step: i64) {
        let time_ns = START_NS + step * MS;
        let header = MessageHeader {
            channel_id: self.channel,
            sequence: 0,
            log_time: time_ns as u64,
            publish_time: time_ns as u64,
        };
        let cdr = state(time_ns, 1e-3 * step as f64);
        self.writer.write_to_known_channel(&header, &cdr).unwrap();
    }
}

/// Bytes of a recording of `steps`, in ms.
pub(crate) fn recording(steps: std::ops::Range<i64>) -> Vec<u8> {
    let options = mcap::WriteOptions::new().chunk_size(Some(4_096));
    let mut bag = Bag::new(Cursor::new(Vec::new()), options);
    for step in steps {
        bag.state(step);
    }
    bag.writer.finish().unwrap();
    bag.writer.into_inner().into_inner()
}

/// Content of a queue.
#[derive(Debug, Default)]
pub(crate) struct Came {
    pub(crate) stamps: Vec<i64>,
    pub(crate) topics: Vec<String>,
    pub(crate) faults: Vec<TransportFault>,
    pub(crate) dropped: u64,
}

impl Came {
    /// Takes batches until `enough`; panics after a timeout.
    #[track_caller]
    pub(crate) fn until(&mut self, inbox: &Inbox, robot: RobotId, enough: impl Fn(&Self) -> bool) {
        let mut batch = Batch::default();
        let begun = Instant::now();
        while !enough(self) {
            assert!(begun.elapsed() < PATIENCE, "timeout: {self:?}");
            if inbox.wait(Duration::from_millis(10)).is_none() {
                continue;
            }
            inbox.take(robot, &mut batch);
            self.add(&batch);
        }
    }

    pub(crate) fn add(&mut self, batch: &Batch) {
        for item in batch.items() {
            match item {
                Item::Topic { name, .. } => self.topics.push(name.to_owned()),
                Item::Message { cdr, .. } => {
                    self.stamps.push(sinew_log::decode::stamp_ns(cdr).unwrap());
                }
                Item::Fault { fault, .. } => self.faults.push(fault.clone()),
            }
        }
        self.dropped += batch.dropped();
    }
}

/// Frames of a queue, until `enough` of them have arrived.
#[track_caller]
pub(crate) fn frames(
    inbox: &Inbox,
    robot: RobotId,
    intake: &mut FrameAssembler,
    enough: impl Fn(&[Frame]) -> bool,
) -> Vec<Frame> {
    let mut frames = Vec::new();
    let mut batch = Batch::default();
    let begun = Instant::now();
    while !enough(&frames) {
        assert!(
            begun.elapsed() < PATIENCE,
            "timeout after {} frames",
            frames.len()
        );
        if inbox.wait(Duration::from_millis(10)).is_some() {
            inbox.take(robot, &mut batch);
            intake.feed(&batch, |taken| {
                if let BatchContent::Frame { frame, .. } = taken {
                    frames.push(frame.clone());
                }
            });
        }
    }
    frames
}
