//! Assembly of frames from queues.

use crate::support::{MS, START_NS, STATE, state};
use sinew_log::live::LiveOptions;
use sinew_transport::{
    Batch, BatchContent, FrameAssembler, Inbox, QueueLimits, Received, TransportFault,
};

fn at(step: i64) -> Received {
    let ns = START_NS + step * MS;
    Received {
        monotonic_ns: ns,
        utc_ns: ns,
    }
}

#[test]
fn assembler_dropped_messages_begin_segment() {
    let inbox = Inbox::new();
    let limits = QueueLimits {
        messages: 1_000,
        ..QueueLimits::default()
    };
    let (robot, sender) = inbox.robot(limits);
    let mut intake = FrameAssembler::new(&LiveOptions::of_joints(&["a".to_owned()])).unwrap();
    let (joints, other) = (
        sender.topic("/joint_states", STATE),
        sender.topic("/x", "y"),
    );
    let (mut frames, mut dropped, mut batch) = (Vec::new(), 0, Batch::default());
    for step in 0..3_000 {
        sender.message(joints, at(step), 0, &state(START_NS + step * MS, 0.5));
        if step == 1_999 || step == 2_999 {
            sender.message(other, at(step), 0, &[1, 2, 3]);
            inbox.take(robot, &mut batch);
            intake.feed(&batch, |taken| match taken {
                BatchContent::Frame { frame, .. } => frames.push((frame.time_ns, frame.segment)),
                BatchContent::Dropped { messages } => dropped += messages,
                BatchContent::Fault { .. } => {}
            });
        }
    }
    intake.silence(at(3_000), |taken| {
        if let BatchContent::Frame { frame, .. } = taken {
            frames.push((frame.time_ns, frame.segment));
        }
    });
    // First 1000 of 2000 messages, then 1000 more.
    assert_eq!(frames.len(), 2_000);
    assert_eq!(dropped, 1_000 + 2);
    assert_eq!(intake.dropped(), dropped);
    let expected = |index: i64| match index < 1_000 {
        true => (START_NS + index * MS, 0),
        false => (START_NS + (index + 1_000) * MS, 1),
    };
    assert!(
        (0..)
            .zip(&frames)
            .all(|(index, frame)| *frame == expected(index))
    );
}

#[test]
fn assembler_faults_keep_order() {
    let inbox = Inbox::new();
    let (robot, sender) = inbox.robot(QueueLimits::default());
    let mut intake = FrameAssembler::new(&LiveOptions::of_joints(&["a".to_owned()])).unwrap();
    let fault = TransportFault::NextFile {
        file: "run_1.mcap".to_owned(),
    };
    sender.fault(at(7), fault.clone());
    let mut batch = Batch::default();
    inbox.take(robot, &mut batch);
    let mut seen = Vec::new();
    intake.feed(&batch, |taken| {
        if let BatchContent::Fault { received, fault } = taken {
            seen.push((received, fault.clone()));
        }
    });
    assert_eq!(seen, [(at(7), fault)]);
}
