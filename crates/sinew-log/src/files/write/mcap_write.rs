//! Recordings as MCAP, as ROS 2 writes it.

use super::FrameWriter;
use super::row_write::check_lengths;
use super::topic_write::{Compression, Packing, Topic, TopicWriter};
use super::write_error;
use crate::encode::{DynamicJointState, Header, InterfaceValue, JointState, Text};
use crate::error::LogError;
use crate::frame::{Frame, Quantities, Quantity};
use std::path::{Path, PathBuf};

/// Content of an MCAP recording.
#[derive(Debug, Clone)]
pub struct McapOptions {
    /// Joint names, in the order of the frames.
    pub joints: Vec<String>,
    /// Motor of each joint, which names its values in the motor-side topic; empty if the motors have the
    /// names of the joints. Further entries belong to axes without a joint.
    pub motors: Vec<String>,
    /// Name of the tendon of each axis in the topic of the tensions; empty if no axis has a tendon.
    pub tendons: Vec<Option<String>>,
    /// Quantities written; a frame's NaN is written as NaN.
    pub quantities: Quantities,
    /// URDF for `/robot_description`.
    pub robot_description: Option<String>,
    /// Compression of the chunks.
    pub compression: Compression,
    /// Size of a chunk before compression, bytes.
    pub chunk_size: u64,
    /// Whether records are written in chunks.
    pub chunked: bool,
    /// Whether index and summary are written.
    pub indexed: bool,
    /// Frame id of the headers.
    pub frame_id: String,
    /// Name of the joint-side topic.
    pub joint_state_topic: String,
    /// Name of the motor-side topic.
    pub motor_topic: String,
    /// Interface of the motor position.
    pub motor_interface: String,
    /// Interface of the motor torque.
    pub motor_effort_interface: String,
    /// Name of the external-torque topic.
    pub external_torque_topic: String,
    /// Topic of the tensions, to be named as `mcap.tension_topic` in a mapping.
    pub tension_topic: String,
}

impl McapOptions {
    /// Entries of a frame's arrays.
    fn axes(&self) -> usize {
        self.joints.len().max(self.motors.len())
    }
}

impl Default for McapOptions {
    fn default() -> Self {
        let packing = Packing::default();
        McapOptions {
            joints: Vec::new(),
            motors: Vec::new(),
            tendons: Vec::new(),
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
            tension_topic: "/tendon_states".to_owned(),
        }
    }
}

/// Writes frames as the topics a ROS 2 robot publishes.
///
/// * joint side: `sensor_msgs/msg/JointState`, `position` = q, `velocity` = dq, `effort` = tau_el;
/// * motor side: `control_msgs/msg/DynamicJointState`, interfaces for theta, tau_m and temperature;
/// * external torque: `JointState` with `effort` = tau_ext;
/// * tensions: `JointState` with the names of the tendons and `effort` = tension, N;
/// * `/robot_description`: `std_msgs/msg/String`, first message.
///
/// Log, publish and header time are those of the frame. Equal frames give equal bytes.
pub struct McapWriter {
    out: TopicWriter,
    path: PathBuf,
    options: McapOptions,
    joint_side: Topic,
    motor_side: Option<Topic>,
    external: Option<Topic>,
    tensions: Option<Topic>,
    /// Axes that have a tendon.
    pulled: Vec<usize>,
    /// Tendons of the axes.
    tendons: Vec<String>,
    description: Option<Topic>,
    sequence: u32,
}

impl McapWriter {
    /// Creates the file.
    ///
    /// # Errors
    /// Returns [`LogError`] for no joints, duplicate names, or an error of the system.
    pub fn create(path: &Path, options: &McapOptions) -> Result<Self, LogError> {
        if options.joints.is_empty() {
            let reason = "a recording needs at least one joint";
            return Err(write_error(path, reason.to_owned()));
        }
        let pulled = options.tendons.iter().enumerate();
        let pulled = pulled.filter_map(|(axis, tendon)| Some((axis, tendon.clone()?)));
        let (pulled, tendons): (Vec<usize>, Vec<String>) = pulled.unzip();
        for (what, names) in [
            ("joint", &options.joints),
            ("motor", &options.motors),
            ("tendon", &tendons),
        ] {
            for (place, name) in names.iter().enumerate() {
                if name.is_empty() || names[..place].contains(name) {
                    let reason = format!("{what} name '{name}' is empty or a duplicate");
                    return Err(write_error(path, reason));
                }
            }
        }
        let (joints, motors) = (options.joints.len(), options.motors.len());
        if motors != 0 && motors < joints {
            let reason = format!("{joints} joints and {motors} motors: each joint needs one motor");
            return Err(write_error(path, reason));
        }
        let (axes, found) = (options.axes(), options.tendons.len());
        if found != 0 && found != axes {
            let reason = format!("{axes} axes and {found} tendons: specify one per axis, or none");
            return Err(write_error(path, reason));
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
        let tensions = (q.tension && !tendons.is_empty())
            .then(|| out.topic::<JointState<'_>>(&options.tension_topic))
            .transpose()?;
        Ok(McapWriter {
            out,
            path: path.to_path_buf(),
            options: options.clone(),
            joint_side,
            motor_side,
            external,
            tensions,
            pulled,
            tendons,
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
        let axes = self.options.axes();
        check_lengths(frame, axes, &self.path)?;
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
                true => &frame.get(quantity)[..joints.len()],
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
            let values: Vec<f64> = (0..axes).flat_map(of).collect();
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
        if let Some(topic) = self.tensions {
            let tension = |axis: &usize| frame.tension.get(*axis).copied().unwrap_or(f64::NAN);
            let message = JointState {
                header,
                name: &self.tendons,
                position: &[],
                velocity: &[],
                effort: &Vec::from_iter(self.pulled.iter().map(tension)),
            };
            self.out.send(topic, time_ns, sequence, &message)?;
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
