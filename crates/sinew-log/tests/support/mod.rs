//! Recordings built message by message, so that each can be wrong in its own way.

use std::collections::BTreeMap;
use std::io::Cursor;

use byteorder::{BigEndian, LittleEndian};
use mcap::records::MessageHeader;
use serde::Serialize;
use sinew_log::{Frame, Health, LogError, OpenOptions, Recording};

/// Start of the recordings, ns.
pub(crate) const START_NS: i64 = 1_700_000_000_000_000_000;
pub(crate) const MS: i64 = 1_000_000;

#[derive(Serialize, Clone)]
pub(crate) struct Header {
    pub(crate) sec: i32,
    pub(crate) nanosec: u32,
    pub(crate) frame_id: String,
}

#[derive(Serialize, Clone)]
pub(crate) struct JointState {
    pub(crate) header: Header,
    pub(crate) name: Vec<String>,
    pub(crate) position: Vec<f64>,
    pub(crate) velocity: Vec<f64>,
    pub(crate) effort: Vec<f64>,
}

#[derive(Serialize, Clone)]
pub(crate) struct InterfaceValue {
    pub(crate) interface_names: Vec<String>,
    pub(crate) values: Vec<f64>,
}

#[derive(Serialize, Clone)]
pub(crate) struct DynamicJointState {
    pub(crate) header: Header,
    pub(crate) joint_names: Vec<String>,
    pub(crate) interface_values: Vec<InterfaceValue>,
}

pub(crate) fn header(time_ns: i64) -> Header {
    Header {
        sec: time_ns.div_euclid(1_000_000_000) as i32,
        nanosec: time_ns.rem_euclid(1_000_000_000) as u32,
        frame_id: "base".to_owned(),
    }
}

pub(crate) fn joint_state(time_ns: i64, joints: &[(&str, f64)]) -> JointState {
    JointState {
        header: header(time_ns),
        name: joints.iter().map(|(name, _)| (*name).to_owned()).collect(),
        position: joints.iter().map(|(_, position)| *position).collect(),
        velocity: Vec::new(),
        effort: Vec::new(),
    }
}

pub(crate) fn motor_state(time_ns: i64, joints: &[(&str, f64)]) -> DynamicJointState {
    DynamicJointState {
        header: header(time_ns),
        joint_names: joints.iter().map(|(name, _)| (*name).to_owned()).collect(),
        interface_values: joints
            .iter()
            .map(|(_, position)| InterfaceValue {
                interface_names: vec!["motor_position".to_owned()],
                values: vec![*position],
            })
            .collect(),
    }
}

pub(crate) fn little<T: Serialize>(message: &T) -> Vec<u8> {
    let mut bytes = vec![0, 1, 0, 0];
    bytes.extend(cdr_encoding::to_vec::<_, LittleEndian>(message).unwrap());
    bytes
}

pub(crate) fn big<T: Serialize>(message: &T) -> Vec<u8> {
    let mut bytes = vec![0, 0, 0, 0];
    bytes.extend(cdr_encoding::to_vec::<_, BigEndian>(message).unwrap());
    bytes
}

pub(crate) const JOINT: &str = "/joint_states";
pub(crate) const MOTOR: &str = "/dynamic_joint_states";

/// Collects messages and makes an MCAP of them.
pub(crate) struct Bag {
    writer: mcap::Writer<Cursor<Vec<u8>>>,
    channels: BTreeMap<String, u16>,
    log_time: u64,
}

impl Bag {
    pub(crate) fn new() -> Self {
        Self::with(mcap::WriteOptions::new().compression(None))
    }

    pub(crate) fn with(options: mcap::WriteOptions) -> Self {
        let writer = options
            .profile("ros2")
            .create(Cursor::new(Vec::new()))
            .unwrap();
        Bag {
            writer,
            channels: BTreeMap::new(),
            log_time: START_NS as u64,
        }
    }

    /// The recorder's clock from now on, ns.
    pub(crate) fn log_at(&mut self, time_ns: u64) -> &mut Self {
        self.log_time = time_ns;
        self
    }

    pub(crate) fn channel(&mut self, topic: &str, schema: &str, encoding: &str) -> u16 {
        let schema = self.writer.add_schema(schema, "ros2msg", b"text").unwrap();
        let id = self
            .writer
            .add_channel(schema, topic, encoding, &BTreeMap::new())
            .unwrap();
        self.channels.insert(topic.to_owned(), id);
        id
    }

    /// A raw payload on a topic; the schema follows from the topic unless declared before.
    pub(crate) fn raw(&mut self, topic: &str, payload: &[u8]) -> &mut Self {
        let id = match self.channels.get(topic) {
            Some(id) => *id,
            None => {
                let schema = if topic == MOTOR {
                    "control_msgs/msg/DynamicJointState"
                } else {
                    "sensor_msgs/msg/JointState"
                };
                self.channel(topic, schema, "cdr")
            }
        };
        self.log_time += 1;
        self.writer
            .write_to_known_channel(
                &MessageHeader {
                    channel_id: id,
                    sequence: 0,
                    log_time: self.log_time,
                    publish_time: self.log_time,
                },
                payload,
            )
            .unwrap();
        self
    }

    pub(crate) fn joint(&mut self, time_ns: i64, joints: &[(&str, f64)]) -> &mut Self {
        let payload = little(&joint_state(time_ns, joints));
        self.raw(JOINT, &payload)
    }

    pub(crate) fn motor(&mut self, time_ns: i64, joints: &[(&str, f64)]) -> &mut Self {
        let payload = little(&motor_state(time_ns, joints));
        self.raw(MOTOR, &payload)
    }

    pub(crate) fn bytes(mut self) -> Vec<u8> {
        self.writer.finish().unwrap();
        self.writer.into_inner().into_inner()
    }
}

pub(crate) fn open_bytes(
    bytes: &[u8],
    name: &str,
    options: &OpenOptions,
) -> Result<Recording, LogError> {
    Recording::from_reader(Box::new(Cursor::new(bytes.to_vec())), name, options)
}

/// All frames and the health after them.
pub(crate) fn read_all(mut recording: Recording) -> (Vec<Frame>, Health) {
    let mut frames = Vec::new();
    while let Some(frame) = recording.next_frame().unwrap() {
        frames.push(frame.clone());
    }
    assert!(recording.next_frame().unwrap().is_none());
    (frames, recording.health().clone())
}

pub(crate) fn read_bytes(bytes: &[u8], name: &str) -> (Vec<Frame>, Health) {
    read_all(open_bytes(bytes, name, &OpenOptions::default()).unwrap())
}

/// The message of the error that opening or reading gives.
pub(crate) fn error_of(bytes: &[u8], name: &str, options: &OpenOptions) -> String {
    let mut recording = match open_bytes(bytes, name, options) {
        Err(error) => return error.to_string(),
        Ok(recording) => recording,
    };
    loop {
        match recording.next_frame() {
            Err(error) => return error.to_string(),
            Ok(None) => panic!("no error: {:?}", recording.health()),
            Ok(Some(_)) => {}
        }
    }
}
