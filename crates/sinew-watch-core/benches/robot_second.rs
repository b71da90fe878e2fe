//! Cost of a robot's monitor, relative to the assembly of frames from its messages:
//!
//! `cargo bench -p sinew-watch-core --bench robot_second`
//!
//! Arms with 4 and 7 joints at 250 and 1000 Hz, with separate messages of joint side and motor side. One run assembles
//! frames from the messages (`sinew_log::live`); the next one passes them to a monitor with a baseline. Runs alternate;
//! results are medians of the ratios. Processor time covers all threads. Memory is the allocation of the monitor, at
//! the start and at its maximum.

// A global allocator is an unsafe trait; this one only counts and forwards to the system allocator.
#![allow(unsafe_code)]

use cpu_time::ProcessTime;
use sinew_estimate::robot_dir;
use sinew_estimate::session::{Learning, Recorder, learn_recorded};
use sinew_log::Frame;
use sinew_log::encode::{DynamicJointState, Header, InterfaceValue, JointState, Message as _};
use sinew_log::live::{Live, LiveOptions, TopicId};
use sinew_model::arm::ArmWorkspace;
use sinew_model::offset::FeatureConfig;
use sinew_model::robot::{Robot, RobotFile};
use sinew_rope::Catalogue;
use sinew_watch_core::{Instant, Monitor, MonitorConfig, Stored};
use std::alloc::{GlobalAlloc, Layout, System};
use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

struct Counting;

static HELD: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call is forwarded to the system allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        HELD.fetch_add(layout.size(), Ordering::Relaxed);
        // SAFETY: the contract of the caller applies unchanged.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        HELD.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: as above.
        unsafe { System.dealloc(at, layout) }
    }

    unsafe fn realloc(&self, at: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        HELD.fetch_add(size, Ordering::Relaxed);
        HELD.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: as above.
        unsafe { System.realloc(at, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Duration of the motion, s; the first minute is the baseline.
const DURATION_S: f64 = 180.0;
const BASELINE_S: f64 = 60.0;
const START_NS: i64 = 1_793_606_400_000_000_000;

/// Motion of a robot, as messages and as frames.
struct Motion {
    robot: Arc<Robot>,
    frames: Vec<Frame>,
    /// Alternating messages of joint side and motor side.
    messages: Vec<[Vec<u8>; 2]>,
    hz: f64,
}

/// Processor time of a run, s per second of robot time, and memory, bytes.
struct Cost {
    frames_s: f64,
    jobs_s: f64,
    held: usize,
    most: usize,
}

fn main() {
    let turns = if std::env::args().any(|a| a == "--test") {
        1
    } else {
        7
    };
    println!(
        "| joints | Hz | making frames | frames and ticks | estimates | together | held | at most |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for robot in [four_joints(), seven_joints()] {
        for hz in [250.0, 1000.0] {
            let motion = Motion::new(Arc::clone(&robot), hz);
            let (mut assembling, mut ratios) = (Vec::new(), [const { Vec::new() }; 3]);
            let mut memory = [0, 0];
            for _ in 0..turns {
                let making_s = motion.assemble();
                let cost = motion.watch();
                assembling.push(1e3 * making_s);
                let parts = [cost.frames_s, cost.jobs_s, cost.frames_s + cost.jobs_s];
                for (ratios, part) in ratios.iter_mut().zip(parts) {
                    ratios.push(part / making_s);
                }
                memory = [cost.held, cost.most];
            }
            let [frames, jobs, both] = ratios.map(median);
            let [held, most] = memory.map(|bytes| bytes as f64 * 1e-6);
            println!(
                "| {} | {hz} | 1 ({:.2} ms a robot-second) | {frames:.1} | {jobs:.1} | {both:.1} | {held:.1} MB | {most:.1} MB |",
                robot.arm.dof(),
                median(assembling)
            );
        }
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn four_joints() -> Arc<Robot> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../robots/biorob-like");
    Arc::new(robot_dir::load(&folder, None).expect("robot").robot)
}

/// Arm with seven joints, axes alternating between z and y.
fn seven_joints() -> Arc<Robot> {
    let mut urdf = String::from("<robot name=\"seven\"><link name=\"l0\"/>");
    let mut toml = String::new();
    for i in 1..=7 {
        let (axis, mass) = (["0 0 1", "0 1 0"][(i + 1) % 2], 2.6 - 0.3 * i as f64);
        write!(
            urdf,
            "<link name=\"l{i}\"><inertial><origin xyz=\"0.01 0.02 0.1\"/><mass value=\"{mass}\"/>\
             <inertia ixx=\"0.02\" iyy=\"0.02\" izz=\"0.005\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>\
             <joint name=\"j{i}\" type=\"revolute\"><parent link=\"l{}\"/><child link=\"l{i}\"/>\
             <origin xyz=\"0 0 0.2\"/><axis xyz=\"{axis}\"/><limit lower=\"-3\" upper=\"3\"/></joint>",
            i - 1
        )
        .expect("a string");
        writeln!(
            toml,
            "[joints.j{i}]\nstiffness_nm_per_rad = {}\nmotor_inertia_kg_m2 = 0.1\n\
             joint_friction = {{ coulomb_nm = 0.05 }}\nmotor_friction = {{ coulomb_nm = 0.2 }}\n\
             [joints.j{i}.tendon]\nlength_mm = 500.0\njoint_pulley_radius_mm = 25.0\nretension_at_mm = 0.5",
            60.0 - 7.0 * i as f64
        )
        .expect("a string");
    }
    urdf.push_str("</robot>");
    let file = RobotFile::parse(&toml, "robot.toml").expect("robot.toml");
    Arc::new(file.build(&urdf).expect("robot"))
}

impl Motion {
    fn new(robot: Arc<Robot>, hz: f64) -> Self {
        let n = robot.arm.dof();
        let mut ws = ArmWorkspace::new(&robot.arm);
        let (mut frames, mut messages) = (Vec::new(), Vec::new());
        let (mut q, mut dq, mut ddq) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        for k in 0..(DURATION_S * hz) as i64 {
            let time_ns = START_NS + (k as f64 / hz * 1e9) as i64;
            let t = k as f64 / hz;
            for i in 0..n {
                // Two frequencies per joint, so that all poses differ.
                let tones = [(0.5, 0.9 + 0.13 * i as f64), (0.3, 0.37 + 0.07 * i as f64)];
                let sum = |f: &dyn Fn(f64, f64) -> f64| tones.iter().map(|(a, w)| f(*a, *w)).sum();
                q[i] = sum(&|a, w| a * (w * t).sin());
                dq[i] = sum(&|a, w| a * w * (w * t).cos());
                ddq[i] = sum(&|a, w| -a * w * w * (w * t).sin());
            }
            let torque = robot
                .arm
                .inverse_dynamics(&mut ws, &q, &dq, &ddq)
                .expect("dynamics");
            let stiffness = |i: usize| {
                robot.transmissions[i]
                    .as_ref()
                    .expect("elastic")
                    .stiffness_nm_per_rad
            };
            let theta: Vec<f64> = (0..n).map(|i| q[i] + torque[i] / stiffness(i)).collect();
            messages.push(encode(robot.joint_names(), time_ns, &q, &theta));
            let mut frame = Frame::new(n);
            (frame.time_ns, frame.q, frame.theta) = (time_ns, q.clone(), theta);
            frames.push(frame);
        }
        Self {
            robot,
            frames,
            messages,
            hz,
        }
    }

    /// Assembles frames from the messages; returns processor time, s per second of robot time.
    fn assemble(&self) -> f64 {
        let mut live =
            Live::new(&LiveOptions::of_joints(self.robot.joint_names())).expect("options");
        let topic =
            |live: &mut Live, name: &str, kind: &str| live.topic(name, kind).expect("a topic");
        let sides: [TopicId; 2] = [
            topic(&mut live, "/joint_states", "sensor_msgs/msg/JointState"),
            topic(
                &mut live,
                "/dynamic_joint_states",
                "control_msgs/msg/DynamicJointState",
            ),
        ];
        let began = ProcessTime::now();
        let mut made = 0;
        for (message, frame) in self.messages.iter().zip(&self.frames) {
            for (topic, cdr) in sides.iter().zip(message) {
                live.push(*topic, cdr, frame.time_ns);
            }
            while let Some(frame) = live.frame() {
                made += std::hint::black_box(frame).q.len();
            }
        }
        assert!(made > 0);
        began.elapsed().as_secs_f64() / DURATION_S
    }

    /// Passes the frames to a monitor.
    fn watch(&self) -> Cost {
        let robot = &self.robot;
        let mut recorder = Recorder::new(robot, &FeatureConfig::default(), 0.5);
        let (first, rest) = self.frames.split_at((BASELINE_S * self.hz) as usize);
        for frame in first {
            recorder.push(frame, (frame.time_ns - START_NS) as f64 * 1e-9);
        }
        let (baseline, _) =
            learn_recorded(robot, &recorder.finish(), "A", &Learning::default()).expect("baseline");
        let catalogue = Arc::new(Catalogue::shipped().expect("catalogue"));
        let mut config = MonitorConfig::new("arm", "bench", Arc::clone(robot), catalogue);
        config.baseline = Some(baseline);
        let mut now = Instant {
            monotonic_ns: 0,
            utc_ns: START_NS,
        };
        let before = HELD.load(Ordering::Relaxed);
        let mut monitor = Monitor::new(config, Stored::default(), now).expect("monitor");
        let held = HELD.load(Ordering::Relaxed) - before;
        let (mut most, mut frames_s, mut jobs_s) = (held, 0.0, 0.0);
        for tenth in rest.chunks((0.1 * self.hz) as usize) {
            let began = ProcessTime::now();
            for frame in tenth {
                now = now.after_s(1.0 / self.hz);
                monitor.frame(frame, now);
            }
            monitor.tick(now);
            frames_s += began.elapsed().as_secs_f64();
            let began = ProcessTime::now();
            while let Some(job) = monitor.job() {
                let done = job.run();
                most = most.max(HELD.load(Ordering::Relaxed) - before);
                monitor.done(done, now);
            }
            while let Some(transaction) = monitor.transaction() {
                monitor.committed(transaction.id, now);
            }
            jobs_s += began.elapsed().as_secs_f64();
            most = most.max(HELD.load(Ordering::Relaxed) - before);
        }
        let robot_s = DURATION_S - BASELINE_S;
        Cost {
            frames_s: frames_s / robot_s,
            jobs_s: jobs_s / robot_s,
            held,
            most,
        }
    }
}

/// Message of one side.
fn encode(names: &[String], time_ns: i64, q: &[f64], theta: &[f64]) -> [Vec<u8>; 2] {
    let header = || Header::at(time_ns, "").expect("a stamp");
    let mut out = [Vec::new(), Vec::new()];
    let joint = JointState {
        header: header(),
        name: names,
        position: q,
        velocity: &[],
        effort: &[],
    };
    joint.encode(&mut out[0]).expect("a message");
    let values: Vec<[f64; 1]> = theta.iter().map(|x| [*x]).collect();
    let values: Vec<InterfaceValue<'_>> = (values.iter())
        .map(|values| InterfaceValue {
            interface_names: &["motor_position"],
            values,
        })
        .collect();
    let motor = DynamicJointState {
        header: header(),
        joint_names: names,
        interface_values: &values,
    };
    motor.encode(&mut out[1]).expect("a message");
    out
}
