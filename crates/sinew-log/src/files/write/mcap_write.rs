//! Recordings as MCAP, as ROS 2 writes it.

use super::FrameWriter;
use super::refuse;
use super::row_write::check_lengths;
use super::topic_write::{Compression, Packing, Topic, TopicWriter};
use crate::encode::{DynamicJointState, Header, InterfaceValue, JointState, Text};
use crate::error::LogError;
use crate::frame::{Frame, Quantities, Quantity};
use std::path::{Path, PathBuf};

/// What an MCAP recording shall hold.
#[derive(Debug, Clone)]
pub struct McapOptions {
    /// Joint names, in the order of the frames.
    pub joints: Vec<String>,
    /// Motor that stands beside each joint, whose names the motor-side topic has; empty where they are the joints'.
    pub motors: Vec<String>,
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
        let packing = Packing::default();
        McapOptions {
            joints: Vec::new(),
            motors: Vec::new(),
            quantities: Quantities::positions(),
            robot_description: None,
            compression: packing.compression,
            chunk_size: packing.chunk_size,
            chunked: packing.chunked,
            indexed: packing.indexed,
            frame_id: String::new(),
            joint_state_topic: "/joint_states".to_owned(),
            motor_topic: "/dynamic_joint_states".to_owned(),
            motor_interface: "motor_position".to_owned(),
            motor_effort_interface: "motor_effort".to_owned(),
            external_torque_topic: "/external_joint_torques".to_owned(),
        }
    }
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
    out: TopicWriter,
    path: PathBuf,
    options: McapOptions,
    joint_side: Topic,
    motor_side: Option<Topic>,
    external: Option<Topic>,
    description: Option<Topic>,
    sequence: u32,
}

impl McapWriter {
    /// Creates the file.
    ///
    /// # Errors
    /// No joints, two of one name, or the system refuses.
    pub fn create(path: &Path, options: &McapOptions) -> Result<Self, LogError> {
        if options.joints.is_empty() {
            let why = "a recording needs at least one joint";
            return Err(refuse(path, why.to_owned()));
        }
        for (what, names) in [("joint", &options.joints), ("motor", &options.motors)] {
            for (place, name) in names.iter().enumerate() {
                if name.is_empty() || names[..place].contains(name) {
                    let why = format!("{what} name '{name}' is empty or there twice");
                    return Err(refuse(path, why));
                }
            }
        }
        let (joints, motors) = (options.joints.len(), options.motors.len());
        if motors != 0 && motors != joints {
            let why = format!("{joints} joints have {motors} motors: each has one");
            return Err(refuse(path, why));
        }
        let packing = Packing {
            compression: options.compression,
            chunk_size: options.chunk_size,
            chunked: options.chunked,
            indexed: options.indexed,
        };
        let mut out = TopicWriter::create(path, packing)?;
        let q = options.quantities;
        let description = match &options.robot_description {
            None => None,
            Some(_) => Some(out.latched::<Text<'_>>("/robot_description")?),
        };
        // The joint side sets the instants, so it is always there.
        let joint_side = out.topic::<JointState<'_>>(&options.joint_state_topic)?;
        let motor_side = (q.theta || q.tau_m || q.temperature)
            .then(|| out.topic::<DynamicJointState<'_>>(&options.motor_topic))
            .transpose()?;
        let external = (q.tau_ext)
            .then(|| out.topic::<JointState<'_>>(&options.external_torque_topic))
            .transpose()?;
        Ok(McapWriter {
            out,
            path: path.to_path_buf(),
            options: options.clone(),
            joint_side,
            motor_side,
            external,
            description,
            sequence: 0,
        })
    }

    fn write_description(&mut self, time_ns: i64) -> Result<(), LogError> {
        let (Some(topic), Some(text)) = (
            self.description.take(),
            self.options.robot_description.take(),
        ) else {
            return Ok(());
        };
        let message = Text { data: &text };
        self.out.send(topic, time_ns, self.sequence, &message)
    }
}

impl FrameWriter for McapWriter {
    fn write(&mut self, frame: &Frame) -> Result<(), LogError> {
        check_lengths(frame, self.options.joints.len(), &self.path)?;
        self.write_description(frame.time_ns)?;
        let McapOptions {
            joints,
            motors,
            quantities: q,
            frame_id,
            ..
        } = &self.options;
        let header = Header {
            stamp: self.out.stamp(frame.time_ns)?,
            frame_id,
        };
        let joint_state = |values: [(bool, Quantity); 3]| {
            let [position, velocity, effort] = values.map(|(wanted, quantity)| match wanted {
                true => frame.get(quantity),
                false => &[],
            });
            JointState {
                header,
                name: joints,
                position,
                velocity,
                effort,
            }
        };
        let own = [
            (q.q, Quantity::Q),
            (q.dq, Quantity::Dq),
            (q.tau_el, Quantity::TauEl),
        ];
        let (time_ns, sequence) = (frame.time_ns, self.sequence);
        (self.out).send(self.joint_side, time_ns, sequence, &joint_state(own))?;
        if let Some(topic) = self.motor_side {
            let interfaces = [
                (
                    q.theta,
                    self.options.motor_interface.as_str(),
                    &frame.theta[..],
                ),
                (q.tau_m, &self.options.motor_effort_interface, &frame.tau_m),
                (q.temperature, "temperature", &[]),
            ];
            let wanted = || interfaces.iter().filter(|(wanted, ..)| *wanted);
            let names: Vec<&str> = wanted().map(|(_, name, _)| *name).collect();
            // A temperature is no joint's own.
            let of = |joint| {
                wanted().map(move |(.., values)| *values.get(joint).unwrap_or(&frame.temperature_c))
            };
            let values: Vec<f64> = (0..joints.len()).flat_map(of).collect();
            let of_joint = |values| InterfaceValue {
                interface_names: &names,
                values,
            };
            let message = DynamicJointState {
                header,
                joint_names: if motors.is_empty() { joints } else { motors },
                interface_values: &Vec::from_iter(values.chunks_exact(names.len()).map(of_joint)),
            };
            self.out.send(topic, time_ns, sequence, &message)?;
        }
        if let Some(topic) = self.external {
            let (none, known) = ((false, Quantity::Q), (true, Quantity::TauExt));
            (self.out).send(topic, time_ns, sequence, &joint_state([none, none, known]))?;
        }
        self.sequence = self.sequence.wrapping_add(1);
        Ok(())
    }

    fn finish(mut self: Box<Self>) -> Result<(), LogError> {
        // A recording without frames still describes its robot.
        self.write_description(0)?;
        self.out.finish()
    }
}
