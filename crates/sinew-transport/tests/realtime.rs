//! Allocations from the thread of a transport to a frame: none after warm-up, counted per message.
//!
//! In a separate binary, because the counting allocator applies to all tests of a binary. It counts per thread, so
//! that nothing else may run in the thread of a test.

// A global allocator is an unsafe trait; this one only counts and forwards to the system allocator.
#![allow(unsafe_code)]

use sinew_log::encode::{DynamicJointState, Header, InterfaceValue, JointState, Message as _};
use sinew_log::live::LiveOptions;
use sinew_transport::{Batch, BatchContent, FrameAssembler, Inbox, QueueLimits, Received};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

struct Counting;

thread_local! {
    static COUNT: Cell<u64> = const { Cell::new(0) };
}

fn count_one() {
    // Threads that are ending have no counter any more; it is not needed.
    let _ = COUNT.try_with(|c| c.set(c.get() + 1));
}

// SAFETY: every call is forwarded to the system allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count_one();
        // SAFETY: the caller's guarantee is forwarded.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        count_one();
        // SAFETY: as above.
        unsafe { System.dealloc(at, layout) }
    }

    unsafe fn realloc(&self, at: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count_one();
        // SAFETY: as above.
        unsafe { System.realloc(at, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

const START_NS: i64 = 1_700_000_000_000_000_000;
const JOINTS: [&str; 3] = ["shoulder", "elbow", "wrist"];

/// Motor and joint message of a step; the order of joints depends on the step.
fn messages(step: i64, cdr: &mut [Vec<u8>; 2]) {
    let mut names = JOINTS.map(str::to_owned);
    // Two publishers alternate, each with its own order of joints.
    if step % 2 == 1 {
        names.reverse();
    }
    let q = (1e-3 * step as f64).sin();
    let header = Header::at(START_NS + step * 1_000_000, "base").unwrap();
    let joint = JointState {
        header,
        name: &names,
        position: &[q; 3],
        velocity: &[0.1; 3],
        effort: &[],
    };
    joint.encode(&mut cdr[0]).unwrap();
    let values = [0, 1, 2].map(|_| InterfaceValue {
        interface_names: &["motor_position", "temperature"],
        values: &[1.1, 30.0],
    });
    let motor = DynamicJointState {
        header,
        joint_names: &names,
        interface_values: &values,
    };
    motor.encode(&mut cdr[1]).unwrap();
}

#[test]
fn message_path_to_frame_allocates_nothing() {
    let inbox = Inbox::new();
    let (robot, sender) = inbox.robot(QueueLimits::default());
    let joints = JOINTS.map(str::to_owned);
    let mut intake = FrameAssembler::new(&LiveOptions::of_joints(&joints)).unwrap();
    let topics = [
        sender.topic("/joint_states", "sensor_msgs/msg/JointState"),
        sender.topic(
            "/dynamic_joint_states",
            "control_msgs/msg/DynamicJointState",
        ),
    ];
    let mut batch = Batch::default();
    let (mut frames, mut allocated) = (0_u64, 0);
    let mut cdr = [Vec::new(), Vec::new()];
    for step in 0..10_000_i64 {
        messages(step, &mut cdr);
        let received = Received {
            monotonic_ns: START_NS + step * 1_000_000,
            utc_ns: START_NS,
        };
        let before = COUNT.with(Cell::get);
        for (topic, cdr) in topics.iter().zip(&cdr) {
            assert!(sender.message(*topic, received, received.utc_ns, cdr));
        }
        if step % 5 == 4 {
            inbox.take(robot, &mut batch);
            intake.feed(&batch, |taken| {
                let BatchContent::Frame { frame, .. } = taken else {
                    return;
                };
                assert_eq!((frame.theta[1], frame.temperature_c), (1.1, 30.0));
                frames += 1;
            });
        }
        // The first second fills buffers that are kept between messages.
        if step >= 1_000 {
            allocated += COUNT.with(Cell::get) - before;
        }
    }
    assert_eq!(allocated, 0);
    assert_eq!(frames, 9_750);
}

#[test]
fn restarted_robot_allocates_only_events() {
    let joints = JOINTS.map(str::to_owned);
    let mut live = sinew_log::live::Live::new(&LiveOptions::of_joints(&joints)).unwrap();
    let topic = live.topic("/joint_states", "sensor_msgs/msg/JointState");
    let mut cdr = [Vec::new(), Vec::new()];
    let mut allocated = 0;
    for turn in 0..400 {
        for step in 0..300 {
            messages(step, &mut cdr);
            let before = COUNT.with(Cell::get);
            live.push(topic.unwrap(), &cdr[0], START_NS);
            while live.frame().is_some() {}
            // After the 256 events that are kept as text.
            if turn >= 300 {
                allocated += COUNT.with(Cell::get) - before;
            }
        }
    }
    assert_eq!(live.health().clock_steps, 399);
    assert_eq!(allocated, 0);
}
