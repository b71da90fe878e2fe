//! MCAP as ROS 2 writes it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use byteorder::LittleEndian;
use mcap::records::MessageHeader;
use serde::Serialize;
use sinew_files::{AtomicFile, OutputError};

use super::FrameWriter;
use super::csv_write::check_lengths;
use super::message_text;
use crate::error::LogError;
use crate::frame::{Frame, Quantities};

/// Plain little-endian CDR.
const ENCAPSULATION: [u8; 4] = [0, 1, 0, 0];
/// Quality of service rosbag2 notes for a latched topic, so that players latch it again.
const LATCHED: &str = "- history: 1\n  depth: 1\n  reliability: 1\n  durability: 1\n  deadline:\n    sec: 9223372036\n    nsec: 854775807\n  lifespan:\n    sec: 9223372036\n    nsec: 854775807\n  liveliness: 1\n  liveliness_lease_duration:\n    sec: 9223372036\n    nsec: 854775807\n  avoid_ros_namespace_conventions: false";

/// Compression of the chunks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Compression {
    /// Not compressed.
    None,
    /// Zstandard, the default of ROS 2 recorders.
    #[default]
    Zstd,
    /// LZ4 frames: larger, faster.
    Lz4,
}

/// What an MCAP recording shall hold.
#[derive(Debug, Clone)]
pub struct McapOptions {
    /// Joint names, in the order of the frames.
    pub joints: Vec<String>,
    /// Quantities written; a frame's NaN is written as NaN.
    pub quantities: Quantities,
    /// URDF for `/robot_description`.
    pub robot_description: Option<String>,
    /// Compression of the chunks.
    pub compression: Compression,
    /// Size of a chunk before compression, bytes.
    pub chunk_size: u64,
    /// Whether records are put into chunks at all.
    pub chunked: bool,
    /// Whether index and summary are written.
    pub indexed: bool,
    /// Frame id of the headers.
    pub frame_id: String,
    /// Joint-side topic.
    pub joint_state_topic: String,
    /// Motor-side topic.
    pub motor_topic: String,
    /// Interface of the motor position.
    pub motor_interface: String,
    /// Interface of the motor torque.
    pub motor_effort_interface: String,
    /// External-torque topic.
    pub external_torque_topic: String,
}

impl Default for McapOptions {
    fn default() -> Self {
        McapOptions {
            joints: Vec::new(),
            quantities: Quantities::positions(),
            robot_description: None,
            compression: Compression::default(),
            chunk_size: 768 << 10,
            chunked: true,
            indexed: true,
            frame_id: String::new(),
            joint_state_topic: "/joint_states".to_owned(),
            motor_topic: "/dynamic_joint_states".to_owned(),
            motor_interface: "motor_position".to_owned(),
            motor_effort_interface: "motor_effort".to_owned(),
            external_torque_topic: "/external_joint_torques".to_owned(),
        }
    }
}

#[derive(Serialize)]
struct Stamp {
    sec: i32,
    nanosec: u32,
}

#[derive(Serialize)]
struct Header<'a> {
    stamp: Stamp,
    frame_id: &'a str,
}

#[derive(Serialize)]
struct JointState<'a> {
    header: Header<'a>,
    name: &'a [String],
    position: &'a [f64],
    velocity: &'a [f64],
    effort: &'a [f64],
}

#[derive(Serialize)]
struct InterfaceValue<'a> {
    interface_names: &'a [&'a str],
    values: &'a [f64],
}

#[derive(Serialize)]
struct DynamicJointState<'a> {
    header: Header<'a>,
    joint_names: &'a [String],
    interface_values: &'a [InterfaceValue<'a>],
}

/// Writes frames as the topics a ROS 2 robot publishes.
///
/// * joint side: `sensor_msgs/msg/JointState`, `position` = q, `velocity` = dq, `effort` = tau_el;
/// * motor side: `control_msgs/msg/DynamicJointState`, interfaces for theta, tau_m and temperature;
/// * external torque: `JointState` with `effort` = tau_ext;
/// * `/robot_description`: `std_msgs/msg/String`, first message.
///
/// Log, publish and header time are the frame's. The same frames give the same bytes.
pub struct McapWriter {
    out: mcap::Writer<AtomicFile>,
    path: PathBuf,
    options: McapOptions,
    joint_channel: u16,
    motor_channel: Option<u16>,
    external_channel: Option<u16>,
    description_channel: Option<u16>,
    sequence: u32,
    payload: Vec<u8>,
    motor_values: Vec<f64>,
}

impl McapWriter {
    /// Creates the file.
    ///
    /// # Errors
    /// No joints, two of one name, or the system refuses.
    pub fn create(path: &Path, options: &McapOptions) -> Result<Self, LogError> {
        let refuse = |reason: String| LogError::Write {
            file: path.display().to_string(),
            reason,
        };
        if options.joints.is_empty() {
            return Err(refuse("a recording needs at least one joint".to_owned()));
        }
        for (place, joint) in options.joints.iter().enumerate() {
            if joint.is_empty() || options.joints[..place].contains(joint) {
                return Err(refuse(format!(
                    "joint name '{joint}' is empty or there twice"
                )));
            }
        }
        let file = AtomicFile::create(path)?;
        let fail = |error| to_error(path, error);
        let mut out = mcap::WriteOptions::new()
            .profile("ros2")
            .library("sinew")
            .compression(match options.compression {
                Compression::None => None,
                Compression::Zstd => Some(mcap::Compression::Zstd),
                Compression::Lz4 => Some(mcap::Compression::Lz4),
            })
            // One thread: the split between threads would show in the bytes.
            .compression_threads(0)
            .chunk_size(Some(options.chunk_size.max(1)))
            .use_chunks(options.chunked)
            .emit_summary_records(options.indexed)
            .emit_summary_offsets(options.indexed)
            .emit_message_indexes(options.indexed && options.chunked)
            .create(file)
            .map_err(fail)?;
        let plain = BTreeMap::new();
        let mut channel = |topic: &str, (name, text): (&str, &str), metadata: &BTreeMap<_, _>| {
            let schema = out.add_schema(name, "ros2msg", text.as_bytes())?;
            out.add_channel(schema, topic, "cdr", metadata)
        };
        let q = options.quantities;
        let description_channel = match &options.robot_description {
            None => None,
            Some(_) => {
                let latched =
                    BTreeMap::from([("offered_qos_profiles".to_owned(), LATCHED.to_owned())]);
                let id = channel("/robot_description", message_text::STRING, &latched);
                Some(id.map_err(fail)?)
            }
        };
        // The joint side sets the instants, so it is always there.
        let joint_channel = channel(
            &options.joint_state_topic,
            message_text::JOINT_STATE,
            &plain,
        )
        .map_err(fail)?;
        let motor_channel = (q.theta || q.tau_m || q.temperature)
            .then(|| {
                channel(
                    &options.motor_topic,
                    message_text::DYNAMIC_JOINT_STATE,
                    &plain,
                )
            })
            .transpose()
            .map_err(fail)?;
        let external_channel = q
            .tau_ext
            .then(|| {
                channel(
                    &options.external_torque_topic,
                    message_text::JOINT_STATE,
                    &plain,
                )
            })
            .transpose()
            .map_err(fail)?;
        Ok(McapWriter {
            out,
            path: path.to_path_buf(),
            options: options.clone(),
            joint_channel,
            motor_channel,
            external_channel,
            description_channel,
            sequence: 0,
            payload: Vec::new(),
            motor_values: Vec::new(),
        })
    }

    /// Stamp and message header of a frame.
    fn times(&mut self, channel: u16, time_ns: i64) -> Result<(Stamp, MessageHeader), LogError> {
        let seconds = time_ns.div_euclid(1_000_000_000);
        let sec = i32::try_from(seconds).map_err(|_| LogError::Write {
            file: self.path.display().to_string(),
            reason: format!("time {time_ns} ns does not fit a ROS 2 stamp (1901 to 2038)"),
        })?;
        // Before 1970 only the stamp tells the time: log times have no sign.
        let log_time = u64::try_from(time_ns).unwrap_or(0);
        let nanosec = time_ns.rem_euclid(1_000_000_000) as u32;
        Ok((
            Stamp { sec, nanosec },
            MessageHeader {
                channel_id: channel,
                sequence: self.sequence,
                log_time,
                publish_time: log_time,
            },
        ))
    }

    /// Writes the message that lies in `payload`.
    fn send(&mut self, header: &MessageHeader) -> Result<(), LogError> {
        self.out
            .write_to_known_channel(header, &self.payload)
            .map_err(|error| to_error(&self.path, error))
    }

    fn write_description(&mut self, time_ns: i64) -> Result<(), LogError> {
        let (Some(channel), Some(text)) = (
            self.description_channel.take(),
            self.options.robot_description.take(),
        ) else {
            return Ok(());
        };
        let (_, header) = self.times(channel, time_ns)?;
        encode(&mut self.payload, &text, &self.path)?;
        self.send(&header)
    }

    fn write_joint_side(&mut self, frame: &Frame) -> Result<(), LogError> {
        let q = self.options.quantities;
        let (stamp, header) = self.times(self.joint_channel, frame.time_ns)?;
        let message = JointState {
            header: Header {
                stamp,
                frame_id: &self.options.frame_id,
            },
            name: &self.options.joints,
            position: if q.q { &frame.q } else { &[] },
            velocity: if q.dq { &frame.dq } else { &[] },
            effort: if q.tau_el { &frame.tau_el } else { &[] },
        };
        encode(&mut self.payload, &message, &self.path)?;
        self.send(&header)
    }

    fn write_motor_side(&mut self, frame: &Frame) -> Result<(), LogError> {
        let Some(channel) = self.motor_channel else {
            return Ok(());
        };
        let q = self.options.quantities;
        let (stamp, header) = self.times(channel, frame.time_ns)?;
        let mut names = [""; 3];
        let mut width = 0;
        for (wanted, name) in [
            (q.theta, self.options.motor_interface.as_str()),
            (q.tau_m, self.options.motor_effort_interface.as_str()),
            (q.temperature, "temperature"),
        ] {
            if wanted {
                names[width] = name;
                width += 1;
            }
        }
        self.motor_values.clear();
        for joint in 0..self.options.joints.len() {
            for (wanted, value) in [
                (q.theta, frame.theta[joint]),
                (q.tau_m, frame.tau_m[joint]),
                (q.temperature, frame.temperature_c),
            ] {
                if wanted {
                    self.motor_values.push(value);
                }
            }
        }
        let interface_values: Vec<InterfaceValue<'_>> = self
            .motor_values
            .chunks_exact(width)
            .map(|values| InterfaceValue {
                interface_names: &names[..width],
                values,
            })
            .collect();
        let message = DynamicJointState {
            header: Header {
                stamp,
                frame_id: &self.options.frame_id,
            },
            joint_names: &self.options.joints,
            interface_values: &interface_values,
        };
        encode(&mut self.payload, &message, &self.path)?;
        self.send(&header)
    }

    fn write_external(&mut self, frame: &Frame) -> Result<(), LogError> {
        let Some(channel) = self.external_channel else {
            return Ok(());
        };
        let (stamp, header) = self.times(channel, frame.time_ns)?;
        let message = JointState {
            header: Header {
                stamp,
                frame_id: &self.options.frame_id,
            },
            name: &self.options.joints,
            position: &[],
            velocity: &[],
            effort: &frame.tau_ext,
        };
        encode(&mut self.payload, &message, &self.path)?;
        self.send(&header)
    }
}

impl FrameWriter for McapWriter {
    fn write(&mut self, frame: &Frame) -> Result<(), LogError> {
        check_lengths(frame, self.options.joints.len(), &self.path)?;
        self.write_description(frame.time_ns)?;
        self.write_joint_side(frame)?;
        self.write_motor_side(frame)?;
        self.write_external(frame)?;
        self.sequence = self.sequence.wrapping_add(1);
        Ok(())
    }

    fn finish(mut self: Box<Self>) -> Result<(), LogError> {
        // A recording without frames still describes its robot.
        self.write_description(0)?;
        self.out
            .finish()
            .map_err(|error| to_error(&self.path, error))?;
        Ok(self.out.into_inner().finish()?)
    }
}

/// Encodes a message as little-endian CDR with its encapsulation header.
fn encode<T: Serialize>(payload: &mut Vec<u8>, message: &T, path: &Path) -> Result<(), LogError> {
    payload.clear();
    payload.extend_from_slice(&ENCAPSULATION);
    cdr_encoding::to_writer::<_, LittleEndian, _>(payload, message).map_err(|error| {
        LogError::Write {
            file: path.display().to_string(),
            reason: format!("CDR: {error}"),
        }
    })
}

fn to_error(path: &Path, error: mcap::McapError) -> LogError {
    match error {
        mcap::McapError::Io(source) => OutputError {
            path: path.to_path_buf(),
            source,
        }
        .into(),
        other => LogError::Write {
            file: path.display().to_string(),
            reason: other.to_string(),
        },
    }
}
