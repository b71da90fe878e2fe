//! Content of a scenario file (TOML): the events of a simulated recording.
//!
//! Reading order: the types here, `read` (keys of the file), `draw` (fixed or drawn numbers, their notation, and
//! their random streams), `profile` (a value over time).

mod correction;
mod draw;
mod events;
mod names;
mod profile;
mod read;

pub use correction::{ContactDetection, Correction, SetPointKind, SpecifiedOffset};
pub use draw::{Draw, PerJoint};
pub use names::Owner;
pub use profile::Shape;
pub use sinew_files::Bound;

pub use draw::normal;
pub use draw::{Stream, rng};
pub use profile::interpolate;

/// A scenario. [`Scenario::from_toml`] reads one; [`Scenario::default`] is a robot without model
/// error and with perfect sensors that hangs at zero for 10 s.
///
/// Each kind of random value has a separate random stream of `seed`, so that two runs are bitwise identical, and a
/// change of the sensors does not change the motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Scenario {
    /// Name of the file, for messages.
    pub file: String,
    /// Name of the scenario, for the truth file.
    pub name: String,
    /// Folder of the robot, relative to the scenario file; the caller may name another.
    pub robot: Option<String>,
    /// Length of the recording, s; `None`: as long as the motion.
    pub duration_s: Option<f64>,
    /// Simulated time before the recording starts, at the first pose, s.
    pub settle_s: f64,
    /// Seed of all random streams.
    pub seed: u64,
    /// Seed of the random errors of the robot; `None`: `seed`. The same robot on another day
    /// has the same `robot_seed` and another `seed`.
    pub robot_seed: Option<u64>,
    /// Sample rate, frames per second.
    pub sample_rate_hz: f64,
    /// Step of the integrator, s; control and sample periods must be multiples of it.
    pub integration_step_s: f64,
    /// Rate of the controller, Hz.
    pub control_rate_hz: f64,
    /// Time stamp of the first frame, ns since 1970.
    pub start_time_ns: i64,
    /// Gains of the controller.
    pub controller: Controller,
    /// Correction used by controller and contact detector.
    pub correction: Correction,
    /// Settings of the contact detection.
    pub contact_detection: ContactDetection,
    /// Commanded motion of the arm.
    pub motion: Motion,
    /// Co-contraction of antagonistic strands.
    pub co_contraction: Option<CoContraction>,
    /// Deviations of the robot from its description.
    pub truth: Truth,
    /// Friction at the joints; `None`: as described, without pre-sliding guesswork.
    pub joint_friction: FrictionSpec,
    /// Friction of the drives, reflected to the joint.
    pub motor_friction: FrictionSpec,
    /// Joint and motor encoders.
    pub encoder: Encoder,
    /// Recorded motor torque.
    pub motor_torque: TorqueChannel,
    /// Recorded elastic torque.
    pub torque_sensor: TorqueChannel,
    /// Channel of the recorded tension.
    pub tension_sensor: TensionChannel,
    /// Noise of a recorded joint velocity, rad/s.
    pub velocity_noise_rad_per_s: f64,
    /// Temperature and its effects.
    pub temperature: Temperature,
    /// Bodies held for a time, unknown to the controller.
    pub payloads: Vec<Payload>,
    /// Contacts by the clock.
    pub contacts: Vec<Contact>,
    /// Contacts by chance.
    pub random_contacts: Option<RandomContacts>,
    /// Tendon offsets; several of one tendon add up.
    pub offsets: Vec<Offset>,
    /// Joints that stick.
    pub jams: Vec<Jam>,
    /// End stops of joints.
    pub stops: Vec<Stop>,
    /// Sessions, for the truth file only.
    pub sessions: Vec<Session>,
    /// Channels of the recording.
    pub record: Record,
    /// Transmission faults between robot and file.
    pub faults: Faults,
}

/// Motor PD gains; by default `1.25 K` and `2.2 √(K_P I_m)` (damping ratio 1.1 of the motor against a held joint).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Controller {
    /// Proportional gains, N·m/rad.
    pub stiffness_nm_per_rad: PerJoint,
    /// Derivative gains, N·m·s/rad.
    pub damping_nm_s_per_rad: PerJoint,
}

/// Tension that strands keep while they pull against each other, for robots with unidirectional tendons.
///
/// In every group of strands that can pull against each other without turning a joint, the required tension of the
/// least loaded strand is `tension + varies (1 − cos(2π t/period))/2`. The variation makes the elongation
/// identifiable that all strands share and that turns no joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoContraction {
    /// Least tension of a strand, N.
    pub tension_n: f64,
    /// Amplitude of the periodic variation, N.
    pub varies_n: f64,
    /// Period of that, s.
    pub period_s: f64,
}

impl CoContraction {
    /// Least tension at `t`, s, N; before the recording that of its start.
    pub fn at(&self, t: f64) -> f64 {
        let angle = std::f64::consts::TAU * t.max(0.0) / self.period_s;
        self.tension_n + self.varies_n * (0.5 - 0.5 * libm::cos(angle))
    }
}

/// Commanded motion of the arm, as minimum-jerk moves.
#[derive(Debug, Clone, PartialEq)]
pub enum Motion {
    /// Holds one pose.
    Hold {
        /// Joint positions, rad; default 0.
        pose_rad: PerJoint,
    },
    /// Pose after pose.
    Waypoints {
        /// Initial pose, rad.
        start_rad: PerJoint,
        /// Poses in order.
        waypoints: Vec<Waypoint>,
        /// Start over after the last.
        repeat: bool,
    },
    /// Poses drawn within limits.
    Random {
        /// Range of each joint, rad; default 80 % of its URDF limits.
        range_rad: PerJoint,
        /// Length of a move, s, drawn each time.
        move_s: Draw,
        /// Rest after it, s, drawn each time.
        pause_s: Draw,
    },
    /// One joint from one angle to another in equal steps, as the paper's shoulder.
    Staircase {
        /// Name of the moving joint.
        joint: String,
        /// Line in the file.
        line: u64,
        /// First angle, rad.
        from_rad: f64,
        /// Last angle, rad.
        to_rad: f64,
        /// Number of moves.
        steps: usize,
        /// Length of a move, s, drawn each time.
        move_s: Draw,
        /// Rest after each move, s, drawn for each move; the rest before the first move has the minimum duration.
        pause_s: Draw,
        /// Positions of the other joints, rad.
        pose_rad: PerJoint,
        /// Comes back down again.
        there_and_back: bool,
        /// Start over after the last.
        repeat: bool,
    },
}

/// One move of the motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Waypoint {
    /// Target of each joint, rad; default: unchanged.
    pub pose_rad: PerJoint,
    /// Length of the move, s, drawn each time.
    pub move_s: Draw,
    /// Rest after it, s, drawn each time.
    pub pause_s: Draw,
}

/// Deviations of the robot from its description. Factors default to 1, shifts to 0.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Truth {
    /// Factor on the stiffness.
    pub stiffness_factor: PerJoint,
    /// Further factor on the stiffness from a time on, as when strands fail; 0 for a torn tendon.
    pub stiffness_later_factor: PerJoint,
    /// Time of the stiffness change, s.
    pub stiffness_later_from_s: f64,
    /// Factor on the mass (and thus first moment and inertia) of the body each joint carries.
    pub mass_factor: PerJoint,
    /// Factor on the distance of the body's centre of mass from its joint.
    pub com_factor: PerJoint,
    /// Shift of the centre of mass across that line, as a fraction of that distance.
    pub com_across_fraction: PerJoint,
    /// Factor on the inertia about the centre of mass.
    pub inertia_factor: PerJoint,
    /// Factor on the motor inertia.
    pub motor_inertia_factor: PerJoint,
    /// Factor on the pretension of strands.
    pub pretension_factor: PerJoint,
    /// Stiffening `tau_el = K x (1 + c x²)`, rad⁻².
    pub spring_cubic_per_rad2: PerJoint,
    /// Delayed elasticity: further deflection that follows a load, as a fraction of the first.
    pub viscoelastic_fraction: PerJoint,
    /// Time constant of the viscoelastic element, s.
    pub viscoelastic_time_s: PerJoint,
}

/// Friction of joints or drives: `(F_c + μ |tau_el|) z + F_v dq`, `z` the pre-sliding state.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FrictionSpec {
    /// Coulomb friction torque `F_c`, N·m; default: the robot description.
    pub coulomb_nm: PerJoint,
    /// Load-dependent friction coefficient `μ`; default 0.
    pub torque_fraction: PerJoint,
    /// Viscous friction coefficient `F_v`, N·m·s/rad; default: the robot description.
    pub viscous_nm_s_per_rad: PerJoint,
    /// Travel over which friction builds up (to 63 %), rad; default 1 mrad.
    pub presliding_rad: PerJoint,
}

/// Encoders. All zero: perfect ones.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Encoder {
    /// Bits of a turn of the joint encoder; `None`: not quantised.
    pub joint_bits: Option<u32>,
    /// Amplitude of its once-per-turn error, rad; its phase is drawn.
    pub once_per_turn_rad: PerJoint,
    /// Amplitude of the second harmonic of the encoder error, rad; the phase is random.
    pub twice_per_turn_rad: PerJoint,
    /// White noise, rad.
    pub joint_noise_rad: f64,
    /// Step of the recorded motor position, rad; 0: not quantised. That is reflected to the joint, or of a tendon with motors of
    /// its own at the shaft of the motor.
    pub motor_resolution_rad: f64,
    /// White noise, rad.
    pub motor_noise_rad: f64,
    /// Error of the motor position's scale, as of a wrong gear ratio.
    pub motor_scale_error: PerJoint,
    /// The recorded motor position is so much older than the joint's, s.
    pub motor_delay_s: f64,
}

/// A recorded torque: `(1 + scale) tau + offset + ripple sin(k theta + φ) + noise`, of a motor with a name of its own at its shaft.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TorqueChannel {
    /// Error of the scale.
    pub scale_error: PerJoint,
    /// Offset of the measured torque, N·m.
    pub offset_nm: PerJoint,
    /// Amplitude of a ripple with the motor angle, N·m.
    pub ripple_nm: PerJoint,
    /// Ripples per rad at the joint.
    pub ripple_per_rad: f64,
    /// White noise, N·m.
    pub noise_nm: f64,
}

/// A recorded tension: `(1 + scale) f + offset + noise`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TensionChannel {
    /// Error of the scale.
    pub scale_error: PerJoint,
    /// Offset of the measured tension, N.
    pub offset_n: PerJoint,
    /// White noise, N.
    pub noise_n: f64,
}

/// Temperature and its effects on the transmission.
#[derive(Debug, Clone, PartialEq)]
pub struct Temperature {
    /// At which stiffness and zero are as they are, °C.
    pub reference_c: f64,
    /// Time and temperature, s and °C, straight lines between; `None`: the reference.
    pub profile_c: Option<Vec<(f64, f64)>>,
    /// Drawn change on top, K.
    pub change_k: Draw,
    /// Start and end of that change, s.
    pub change_from_to_s: (f64, f64),
    /// Error of the temperature sensor, K.
    pub reading_error_k: Draw,
    /// Time until which the sensor has no error, s: the error affects a change, not the level.
    pub reading_error_from_s: f64,
    /// Stiffness change, 1/K.
    pub stiffness_per_k: PerJoint,
    /// Drift of the motor position's zero, rad/K.
    pub zero_drift_rad_per_k: PerJoint,
}

/// Body carried for a time.
#[derive(Debug, Clone, PartialEq)]
pub struct Payload {
    /// Link that carries the load.
    pub link: String,
    /// Line in the file.
    pub line: u64,
    /// Mass of the load, kg.
    pub mass_kg: Draw,
    /// Centre of mass in the link's frame, m.
    pub com_m: [f64; 3],
    /// Drawn evenly within ± this about `com_m`, m.
    pub com_spread_m: [f64; 3],
    /// Held from, s.
    pub attach_s: f64,
    /// Held until, s.
    pub release_s: f64,
}

/// External force on a link for a time.
#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    /// Start of the contact, s.
    pub start_s: f64,
    /// Duration of the contact, s.
    pub duration_s: f64,
    /// Name of the link.
    pub link: String,
    /// Line in the file.
    pub line: u64,
    /// Contact point on the link, link frame, m.
    pub point_m: [f64; 3],
    /// Force in the base frame, N.
    pub force_n: [f64; 3],
    /// Rises and falls over this time (half a cosine), s.
    pub rise_s: f64,
}

/// Contacts at random times and in random directions.
#[derive(Debug, Clone, PartialEq)]
pub struct RandomContacts {
    /// Share of the time.
    pub fraction: f64,
    /// Name of the link.
    pub link: String,
    /// Line in the file.
    pub line: u64,
    /// Contact point on the link, link frame, m.
    pub point_m: [f64; 3],
    /// Size, N, drawn each time; any direction.
    pub force_n: Draw,
    /// Length, s, drawn each time.
    pub duration_s: Draw,
    /// Rises and falls over this time, s.
    pub rise_s: f64,
    /// Between these times, s.
    pub from_to_s: (f64, f64),
}

/// Place where an offset acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OffsetKind {
    /// Injection as in the paper: added to the recorded motor position if that is larger than the offset, nothing
    /// added elsewhere. The offset has no effect on the robot.
    Injected,
    /// The rope is longer: `tau_el = K (theta_measured − delta_e − q)`.
    Physical,
    /// The motor's encoder has slipped: its reading is so much larger, for the controller too.
    MotorEncoder,
    /// The joint's encoder has slipped: its reading is so much smaller.
    JointEncoder,
}

/// Tendon offset with its time profile.
#[derive(Debug, Clone, PartialEq)]
pub struct Offset {
    /// Name of the tendon, which is that of its joint unless `robot.toml` names it; of a joint's encoder name of the joint.
    pub joint: String,
    /// Line in the file.
    pub line: u64,
    /// Place where the offset acts.
    pub kind: OffsetKind,
    /// Size of the offset, rad of the joint that the tendon is paired with; factor of a table's values.
    pub size_rad: Draw,
    /// Time profile of the offset.
    pub shape: Shape,
    /// Delay of a step relative to its profile, s.
    pub later_s: Draw,
}

/// End stop of a joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Stop {
    /// Name of the joint.
    pub joint: String,
    /// Line in the file.
    pub line: u64,
    /// Position at which the stop begins, rad.
    pub at_rad: f64,
    /// Whether the stop limits the joint from above.
    pub is_upper: bool,
    /// Contact stiffness of the stop, N·m/rad; `None`: 1000 times the joint's spring.
    pub stiffness_nm_per_rad: Option<f64>,
}

/// Joint seized by excessive friction.
#[derive(Debug, Clone, PartialEq)]
pub struct Jam {
    /// Name of the joint.
    pub joint: String,
    /// Line in the file.
    pub line: u64,
    /// Coulomb friction on top of the joint's own, N·m.
    pub torque_nm: f64,
    /// Start of the interval, s.
    pub from_s: f64,
    /// End of the interval, s.
    pub to_s: f64,
}

/// Named session of the recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Session {
    /// Name of the session.
    pub name: String,
    /// Start of the session, s.
    pub from_s: f64,
    /// End of the session, s.
    pub to_s: f64,
}

/// Optional channels of a recording besides joint and motor position.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Record {
    /// Whether the joint velocity is recorded.
    pub dq: bool,
    /// Elastic torque of a sensor.
    pub tau_el: bool,
    /// Whether the motor torque is recorded.
    pub tau_m: bool,
    /// External torque of the contacts (without payload), as if they were known.
    pub tau_ext: bool,
    /// Tension of the tendons.
    pub tension: bool,
    /// Temperature of the ropes.
    pub temperature: bool,
}

/// Transmission faults between robot and file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Faults {
    /// Share of frames lost.
    pub dropout_fraction: f64,
    /// Share of frames written twice.
    pub duplicate_fraction: f64,
    /// Share of frames written after their successor.
    pub late_fraction: f64,
    /// Nothing is written from … for …, s.
    pub gaps_s: Vec<(f64, f64)>,
}

impl Default for Scenario {
    fn default() -> Self {
        Self {
            file: "scenario".into(),
            name: "scenario".into(),
            robot: None,
            duration_s: Some(10.0),
            settle_s: 2.0,
            seed: 1,
            robot_seed: None,
            sample_rate_hz: 1000.0,
            integration_step_s: 5e-4,
            control_rate_hz: 1000.0,
            // 2026-01-01 00:00:00 UTC: recordings made at different times stay bitwise the same.
            start_time_ns: 1_767_225_600_000_000_000,
            controller: Controller::default(),
            correction: Correction::default(),
            contact_detection: ContactDetection::default(),
            motion: Motion::Hold {
                pose_rad: PerJoint::default(),
            },
            co_contraction: None,
            truth: Truth::default(),
            joint_friction: FrictionSpec::default(),
            motor_friction: FrictionSpec::default(),
            encoder: Encoder::default(),
            motor_torque: TorqueChannel::default(),
            torque_sensor: TorqueChannel::default(),
            tension_sensor: TensionChannel::default(),
            velocity_noise_rad_per_s: 0.0,
            temperature: Temperature::default(),
            payloads: Vec::new(),
            contacts: Vec::new(),
            random_contacts: None,
            offsets: Vec::new(),
            jams: Vec::new(),
            stops: Vec::new(),
            sessions: Vec::new(),
            record: Record::default(),
            faults: Faults::default(),
        }
    }
}

impl Default for Temperature {
    fn default() -> Self {
        Self {
            reference_c: 22.0,
            profile_c: None,
            change_k: Draw::Fixed(0.0),
            change_from_to_s: (0.0, 0.0),
            reading_error_k: Draw::Fixed(0.0),
            reading_error_from_s: 0.0,
            stiffness_per_k: PerJoint::default(),
            zero_drift_rad_per_k: PerJoint::default(),
        }
    }
}

impl FrictionSpec {
    /// Returns zero friction.
    pub fn none() -> Self {
        Self {
            coulomb_nm: PerJoint::fixed(0.0),
            torque_fraction: PerJoint::fixed(0.0),
            viscous_nm_s_per_rad: PerJoint::fixed(0.0),
            presliding_rad: PerJoint::default(),
        }
    }
}
