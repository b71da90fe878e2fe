//! Queues are bounded, ordered, and count dropped messages.

use crate::support::{Came, state};
use proptest::prelude::*;
use sinew_transport::{Batch, Clock, Inbox, Item, QueueLimits, Received, TransportFault};
use std::time::Duration;

const LIMITS: QueueLimits = QueueLimits {
    messages: 10,
    bytes: 1_000,
};

fn at(ns: i64) -> Received {
    Received {
        monotonic_ns: ns,
        utc_ns: ns,
    }
}

#[test]
fn inbox_full_queue_drops_and_counts_newest() {
    let inbox = Inbox::new();
    let (robot, sender) = inbox.robot(LIMITS);
    let topic = sender.topic("/t", "s");
    for index in 0..15 {
        assert_eq!(
            sender.message(topic, at(index), 0, &[index as u8]),
            index < 10
        );
    }
    let mut batch = Batch::default();
    inbox.take(robot, &mut batch);
    let kept: Vec<u8> = messages(&batch).iter().map(|cdr| cdr[0]).collect();
    assert_eq!(kept, Vec::from_iter(0..10));
    assert_eq!((batch.messages(), batch.dropped()), (10, 5));
    // After the gap no further gap follows once the queue is emptied.
    assert!(sender.message(topic, at(20), 0, &[20]));
    inbox.take(robot, &mut batch);
    assert_eq!((messages(&batch), batch.dropped()), (vec![vec![20]], 0));
    // Bytes count as well; an empty queue rejects a message that never fits.
    assert!(!sender.message(topic, at(21), 0, &[0; 1_001]));
    inbox.take(robot, &mut batch);
    assert_eq!(batch.dropped(), 1);
    inbox.take(robot, &mut batch);
    assert_eq!((batch.items().count(), batch.dropped()), (0, 0));
}

fn messages(batch: &Batch) -> Vec<Vec<u8>> {
    let messages = batch.items().filter_map(|item| match item {
        Item::Message { cdr, .. } => Some(cdr.to_vec()),
        _ => None,
    });
    messages.collect()
}

#[test]
fn inbox_wait_returns_robots_in_turn_once() {
    let inbox = Inbox::new();
    let (first, to_first) = inbox.robot(LIMITS);
    let (second, to_second) = inbox.robot(LIMITS);
    assert_eq!(inbox.wait(Duration::ZERO), None);
    let (one, two) = (to_first.topic("/t", "s"), to_second.topic("/t", "s"));
    to_second.message(two, at(1), 0, &[1]);
    to_first.message(one, at(2), 0, &[2]);
    assert_eq!(inbox.wait(Duration::ZERO), Some(first));
    assert_eq!(inbox.wait(Duration::ZERO), Some(second));
    assert_eq!(inbox.wait(Duration::ZERO), None);
    // A robot that was reported but not emptied is emptied by the next take.
    let mut batch = Batch::default();
    inbox.take(first, &mut batch);
    assert_eq!(messages(&batch), [[2]]);
    inbox.take(second, &mut batch);
    assert_eq!(messages(&batch), [[1]]);
    to_first.message(one, at(3), 0, &[3]);
    assert_eq!(inbox.wait(Duration::from_secs(1)), Some(first));
}

#[test]
fn inbox_topic_announced_once_before_messages() {
    let inbox = Inbox::new();
    let (robot, sender) = inbox.robot(LIMITS);
    let (a, b) = (sender.topic("/a", "s"), sender.topic("/b", "s"));
    assert_eq!(sender.clone().topic("/a", "s"), a);
    assert_ne!(sender.topic("/a", "another"), a);
    sender.message(b, at(0), 0, &state(1, 0.0));
    let fault = TransportFault::Connected {
        transport: "dds:0".to_owned(),
    };
    sender.fault(at(0), fault.clone());
    let (mut came, mut batch) = (Came::default(), Batch::default());
    inbox.take(robot, &mut batch);
    came.add(&batch);
    assert_eq!(came.topics, ["/a", "/b", "/a"]);
    assert_eq!(came.faults, [fault]);
    assert_eq!(sender.topic("/a", "s"), a);
    inbox.take(robot, &mut batch);
    assert_eq!(batch.items().count(), 0);
}

#[test]
fn inbox_large_message_releases_memory() {
    let inbox = Inbox::new();
    let (robot, sender) = inbox.robot(QueueLimits::default());
    let topic = sender.topic("/robot_description", "std_msgs/msg/String");
    assert!(sender.message(topic, at(0), 0, &vec![0; 4 << 20]));
    let mut batch = Batch::default();
    inbox.take(robot, &mut batch);
    assert!(batch.capacity_bytes() >= 4 << 20);
    sender.message(topic, at(0), 0, &[1]);
    inbox.take(robot, &mut batch);
    sender.message(topic, at(0), 0, &[1]);
    inbox.take(robot, &mut batch);
    assert!(
        batch.capacity_bytes() <= 256 << 10,
        "{}",
        batch.capacity_bytes()
    );
}

#[test]
fn inbox_faults_are_bounded() {
    let inbox = Inbox::new();
    let (robot, sender) = inbox.robot(LIMITS);
    for _ in 0..5_000 {
        let transport = "dds:0".to_owned();
        sender.fault(at(0), TransportFault::Connected { transport });
    }
    let mut batch = Batch::default();
    inbox.take(robot, &mut batch);
    assert_eq!(batch.items().count(), 1_024);
}

#[test]
fn inbox_concurrent_senders_keep_order_and_count() {
    const EACH: u64 = 20_000;
    let inbox = Inbox::new();
    let (robot, sender) = inbox.robot(QueueLimits::default());
    let clock = Clock::start();
    let mut sent = 0;
    let (mut taken, mut dropped) = (Vec::new(), 0);
    std::thread::scope(|scope| {
        let transports = (0..2_u64).map(|transport| {
            let sender = sender.clone();
            scope.spawn(move || {
                let topic = sender.topic(&format!("/{transport}"), "s");
                let message = |index: &u64| {
                    let bytes = (transport << 32 | index).to_le_bytes();
                    sender.message(topic, clock.now(), 0, &bytes)
                };
                (0..EACH).filter(message).count()
            })
        });
        let transports: Vec<_> = transports.collect();
        let mut batch = Batch::default();
        let mut is_done = false;
        loop {
            // Checked before the last take: nothing arrives after it.
            let was_done = is_done;
            is_done = transports.iter().all(|transport| transport.is_finished());
            if inbox.wait(Duration::from_millis(1)).is_none() && was_done {
                break;
            }
            inbox.take(robot, &mut batch);
            dropped += batch.dropped();
            for cdr in messages(&batch) {
                taken.push(u64::from_le_bytes(cdr.try_into().unwrap()));
            }
        }
        sent = transports
            .into_iter()
            .map(|transport| transport.join().unwrap())
            .sum();
    });
    assert_eq!(taken.len(), sent);
    assert_eq!(taken.len() as u64 + dropped, 2 * EACH);
    for transport in 0..2 {
        let of_transport: Vec<u64> = taken
            .iter()
            .copied()
            .filter(|t| t >> 32 == transport)
            .collect();
        assert!(of_transport.is_sorted_by(|a, b| a < b));
    }
}

proptest! {
    /// For any sequence of messages and takes: in order, complete, and counted.
    #[test]
    fn inbox_messages_are_delivered_or_counted(steps in prop::collection::vec((0_usize..400, any::<bool>()), 1..200)) {
        let inbox = Inbox::new();
        let (robot, sender) = inbox.robot(LIMITS);
        let topic = sender.topic("/t", "s");
        let mut batch = Batch::default();
        let (mut expected, mut came) = (Vec::new(), Vec::new());
        let (mut refused, mut dropped) = (0, 0);
        for (index, (length, takes)) in steps.iter().enumerate() {
            let message = vec![index as u8; *length];
            match sender.message(topic, at(index as i64), 0, &message) {
                true => expected.push(message),
                false => refused += 1,
            }
            if *takes {
                inbox.take(robot, &mut batch);
                prop_assert!(batch.messages() <= LIMITS.messages);
                came.append(&mut messages(&batch));
                dropped += batch.dropped();
            }
        }
        inbox.take(robot, &mut batch);
        came.append(&mut messages(&batch));
        dropped += batch.dropped();
        prop_assert_eq!(came, expected);
        prop_assert_eq!(dropped, refused);
    }
}
