//! Queues are bounded, in order, and say what they drop.

use crate::support::{Came, state};
use proptest::prelude::*;
use sinew_door::{Batch, Clock, Inbox, Item, QueueLimits, Received, Trouble};
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
fn a_full_queue_drops_the_newest_counts_them_and_goes_on() {
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
    // From one gap on, nothing but a gap until it is emptied.
    assert!(sender.message(topic, at(20), 0, &[20]));
    inbox.take(robot, &mut batch);
    assert_eq!((messages(&batch), batch.dropped()), (vec![vec![20]], 0));
    // Bytes count as well, and an empty queue refuses what never fits.
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
fn robots_are_woken_for_in_turn_and_once() {
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
    // Whoever was woken for and not emptied is emptied by the next take.
    let mut batch = Batch::default();
    inbox.take(first, &mut batch);
    assert_eq!(messages(&batch), [[2]]);
    inbox.take(second, &mut batch);
    assert_eq!(messages(&batch), [[1]]);
    to_first.message(one, at(3), 0, &[3]);
    assert_eq!(inbox.wait(Duration::from_secs(1)), Some(first));
}

#[test]
fn a_topic_is_announced_once_and_before_its_messages() {
    let inbox = Inbox::new();
    let (robot, sender) = inbox.robot(LIMITS);
    let (a, b) = (sender.topic("/a", "s"), sender.topic("/b", "s"));
    assert_eq!(sender.clone().topic("/a", "s"), a);
    assert_ne!(sender.topic("/a", "another"), a);
    sender.message(b, at(0), 0, &state(1, 0.0));
    let trouble = Trouble::Open {
        door: "dds:0".to_owned(),
    };
    sender.trouble(at(0), trouble.clone());
    let (mut came, mut batch) = (Came::default(), Batch::default());
    inbox.take(robot, &mut batch);
    came.add(&batch);
    assert_eq!(came.topics, ["/a", "/b", "/a"]);
    assert_eq!(came.troubles, [trouble]);
    assert_eq!(sender.topic("/a", "s"), a);
    inbox.take(robot, &mut batch);
    assert_eq!(batch.items().count(), 0);
}

#[test]
fn a_large_message_gives_its_memory_back() {
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
fn troubles_without_end_are_bounded() {
    let inbox = Inbox::new();
    let (robot, sender) = inbox.robot(LIMITS);
    for _ in 0..5_000 {
        let door = "dds:0".to_owned();
        sender.trouble(at(0), Trouble::Open { door });
    }
    let mut batch = Batch::default();
    inbox.take(robot, &mut batch);
    assert_eq!(batch.items().count(), 1_024);
}

#[test]
fn threads_lose_and_reorder_nothing() {
    const EACH: u64 = 20_000;
    let inbox = Inbox::new();
    let (robot, sender) = inbox.robot(QueueLimits::default());
    let clock = Clock::start();
    let mut sent = 0;
    let (mut taken, mut dropped) = (Vec::new(), 0);
    std::thread::scope(|scope| {
        let doors = (0..2_u64).map(|door| {
            let sender = sender.clone();
            scope.spawn(move || {
                let topic = sender.topic(&format!("/{door}"), "s");
                let message = |index: &u64| {
                    let bytes = (door << 32 | index).to_le_bytes();
                    sender.message(topic, clock.now(), 0, &bytes)
                };
                (0..EACH).filter(message).count()
            })
        });
        let doors: Vec<_> = doors.collect();
        let mut batch = Batch::default();
        let mut is_done = false;
        loop {
            // Looked at before the last take: nothing comes after it.
            let was_done = is_done;
            is_done = doors.iter().all(|door| door.is_finished());
            if inbox.wait(Duration::from_millis(1)).is_none() && was_done {
                break;
            }
            inbox.take(robot, &mut batch);
            dropped += batch.dropped();
            for cdr in messages(&batch) {
                taken.push(u64::from_le_bytes(cdr.try_into().unwrap()));
            }
        }
        sent = doors.into_iter().map(|door| door.join().unwrap()).sum();
    });
    assert_eq!(taken.len(), sent);
    assert_eq!(taken.len() as u64 + dropped, 2 * EACH);
    for door in 0..2 {
        let of_door: Vec<u64> = taken.iter().copied().filter(|t| t >> 32 == door).collect();
        assert!(of_door.is_sorted_by(|a, b| a < b));
    }
}

proptest! {
    /// Whatever is put in and taken out, and when: in order, whole, and counted.
    #[test]
    fn what_goes_in_comes_out_or_is_counted(steps in prop::collection::vec((0_usize..400, any::<bool>()), 1..200)) {
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
