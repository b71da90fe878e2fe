//! Bounded queues from transports to the monitor: one per robot, with one place to wait for all of them.
//!
//! ```text
//! transport thread ── Sender::message ─▶ ┌ robot 0: bytes, items, dropped ┐ ── Inbox::take ─▶ core thread
//! transport thread ── Sender::message ─▶ └ robot 1: …                     ┘    Inbox::wait: which one is ready
//! ```
//!
//! A queue consists of two flat buffers. The receiver swaps them with its own, emptied ones: after warm-up a message
//! costs one copy and no allocation, and the lock is taken for the swap only.

use crate::error::TransportFault;
use crate::handle::lock;
use crate::received::Received;
use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Capacity of the queue of a robot; messages beyond it are dropped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct QueueLimits {
    /// Maximum number of messages.
    pub messages: usize,
    /// Maximum length of all messages, bytes.
    pub bytes: usize,
}

impl Default for QueueLimits {
    /// Four seconds of two topics at 500 Hz; eight robot descriptions.
    fn default() -> Self {
        QueueLimits {
            messages: 4_096,
            bytes: 8 << 20,
        }
    }
}

/// Maximum number of waiting announcements and faults; they do not count as messages.
const MAX_NOTICES: usize = 1_024;
/// Buffer capacity that is kept after a large message, bytes.
const MAX_IDLE_CAPACITY_BYTES: usize = 256 << 10;

/// Robot, numbered in the order of [`Inbox::robot`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RobotId(pub(crate) u32);

impl RobotId {
    /// Returns the index in the order of [`Inbox::robot`].
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// Topic of the queue of a robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TopicKey(pub(crate) u32);

impl TopicKey {
    /// Returns the index in the order of announcements.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

#[derive(Debug)]
enum Stored {
    /// Name and type.
    Topic(TopicKey, Arc<(String, String)>),
    Message {
        topic: TopicKey,
        received: Received,
        source_ns: i64,
        end: usize,
    },
    Fault {
        received: Received,
        fault: Box<TransportFault>,
    },
}

/// Content of one [`Inbox::take`].
#[derive(Debug, Default)]
pub struct Batch {
    bytes: Vec<u8>,
    items: Vec<Stored>,
    messages: usize,
    dropped: u64,
}

/// Item of a batch, in the order of arrival.
#[derive(Debug)]
pub enum Item<'a> {
    /// Announcement of a topic, before its first message.
    Topic {
        /// Key that marks the messages of the topic.
        topic: TopicKey,
        /// Name of the topic.
        name: &'a str,
        /// Type of the topic, such as `sensor_msgs/msg/JointState`.
        schema: &'a str,
    },
    /// Message of an announced topic.
    Message {
        /// Key of the topic, as announced.
        topic: TopicKey,
        /// Time of reception, by both clocks.
        received: Received,
        /// Substitute for a zero time stamp, ns: time of sending or logging, if available.
        source_ns: i64,
        /// CDR of the message with its encapsulation header.
        cdr: &'a [u8],
    },
    /// Fault of a transport, or its end.
    Fault {
        /// Time of reception, by both clocks.
        received: Received,
        /// Fault, or its end.
        fault: &'a TransportFault,
    },
}

impl Batch {
    /// Returns the items in the order of arrival.
    pub fn items(&self) -> impl Iterator<Item = Item<'_>> {
        let mut start = 0;
        self.items.iter().map(move |stored| match stored {
            Stored::Topic(topic, described) => Item::Topic {
                topic: *topic,
                name: &described.0,
                schema: &described.1,
            },
            Stored::Message {
                topic,
                received,
                source_ns,
                end,
            } => {
                let cdr = &self.bytes[start..*end];
                start = *end;
                Item::Message {
                    topic: *topic,
                    received: *received,
                    source_ns: *source_ns,
                    cdr,
                }
            }
            Stored::Fault { received, fault } => Item::Fault {
                received: *received,
                fault,
            },
        })
    }

    /// Returns the number of messages.
    pub fn messages(&self) -> usize {
        self.messages
    }

    /// Returns the number of messages dropped after those of the batch, because the queue was full.
    pub fn dropped(&self) -> u64 {
        self.dropped
    }

    /// Returns the memory reserved for messages, bytes.
    pub fn capacity_bytes(&self) -> usize {
        self.bytes.capacity()
    }

    fn clear(&mut self) {
        self.bytes.clear();
        if self.bytes.capacity() > MAX_IDLE_CAPACITY_BYTES {
            self.bytes.shrink_to(MAX_IDLE_CAPACITY_BYTES);
        }
        self.items.clear();
        self.messages = 0;
        self.dropped = 0;
    }
}

/// Queue of a robot.
#[derive(Debug)]
struct Lane {
    limits: QueueLimits,
    state: Mutex<Filling>,
}

#[derive(Debug, Default)]
struct Filling {
    batch: Batch,
    /// Names and types of the topics announced so far.
    topics: Vec<Arc<(String, String)>>,
    notices: usize,
    /// Whether the queue is in the list of ready queues, at most once.
    is_ready: bool,
}

#[derive(Debug, Default)]
struct Shared {
    lanes: Mutex<Vec<Arc<Lane>>>,
    ready: Mutex<VecDeque<RobotId>>,
    wake: Condvar,
}

/// Queues of all robots, on which one thread of the monitor waits.
#[derive(Debug, Clone, Default)]
pub struct Inbox {
    shared: Arc<Shared>,
}

impl Inbox {
    /// Creates an inbox without robots.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds the queue of a robot; the sender goes to its transports.
    pub fn robot(&self, limits: QueueLimits) -> (RobotId, Sender) {
        let lane = Arc::new(Lane {
            limits,
            state: Mutex::default(),
        });
        let mut lanes = lock(&self.shared.lanes);
        let robot = RobotId(lanes.len() as u32);
        lanes.push(Arc::clone(&lane));
        let shared = Arc::clone(&self.shared);
        (
            robot,
            Sender {
                lane,
                shared,
                robot,
            },
        )
    }

    /// Waits for a robot with items to take and returns the one that has waited longest; `None` after `timeout`.
    pub fn wait(&self, timeout: Duration) -> Option<RobotId> {
        let until = Instant::now().checked_add(timeout);
        let mut ready = lock(&self.shared.ready);
        loop {
            if let Some(robot) = ready.pop_front() {
                drop(ready);
                if let Some(lane) = self.lane(robot) {
                    lock(&lane.state).is_ready = false;
                }
                return Some(robot);
            }
            let left = until.map_or(timeout, |until| {
                until.saturating_duration_since(Instant::now())
            });
            if left.is_zero() {
                return None;
            }
            let woken = self.shared.wake.wait_timeout(ready, left);
            ready = woken.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    /// Wakes a waiting thread even if no item is present: [`Self::wait`] may return `None` early.
    pub fn nudge(&self) {
        self.shared.wake.notify_all();
    }

    /// Takes all items of the queue of a robot; `batch` is emptied first and its memory is reused.
    pub fn take(&self, robot: RobotId, batch: &mut Batch) {
        batch.clear();
        if let Some(lane) = self.lane(robot) {
            let mut state = lock(&lane.state);
            std::mem::swap(&mut state.batch, batch);
            state.notices = 0;
        }
    }

    fn lane(&self, robot: RobotId) -> Option<Arc<Lane>> {
        lock(&self.shared.lanes).get(robot.index()).cloned()
    }
}

/// Sending side of the queue of a robot.
#[derive(Debug, Clone)]
pub struct Sender {
    lane: Arc<Lane>,
    shared: Arc<Shared>,
    robot: RobotId,
}

impl Sender {
    /// Returns the robot of the queue.
    pub fn robot(&self) -> RobotId {
        self.robot
    }

    /// Announces a topic; the same name and type keep their key.
    pub fn topic(&self, name: &str, schema: &str) -> TopicKey {
        let mut state = lock(&self.lane.state);
        let topics = &mut state.topics;
        let existing = topics.iter().position(|t| t.0 == name && t.1 == schema);
        if let Some(index) = existing {
            return TopicKey(index as u32);
        }
        let key = TopicKey(topics.len() as u32);
        let described = Arc::new((name.to_owned(), schema.to_owned()));
        topics.push(Arc::clone(&described));
        state.batch.items.push(Stored::Topic(key, described));
        self.ready(state);
        key
    }

    /// Appends a message; returns `false` if the queue is full, and the message was dropped and counted.
    ///
    /// `source_ns` replaces a zero time stamp: time of sending or logging, else of reception.
    pub fn message(&self, topic: TopicKey, received: Received, source_ns: i64, cdr: &[u8]) -> bool {
        self.message_of_parts(topic, received, source_ns, &[cdr])
    }

    /// Appends a message that consists of several slices; see [`Self::message`].
    pub fn message_of_parts(
        &self,
        topic: TopicKey,
        received: Received,
        source_ns: i64,
        parts: &[&[u8]],
    ) -> bool {
        let mut state = lock(&self.lane.state);
        let batch = &mut state.batch;
        let length: usize = parts.iter().map(|part| part.len()).sum();
        let limits = &self.lane.limits;
        let has_room = batch.dropped == 0
            && batch.messages < limits.messages
            && batch.bytes.len().saturating_add(length) <= limits.bytes;
        if has_room {
            for part in parts {
                batch.bytes.extend_from_slice(part);
            }
            batch.items.push(Stored::Message {
                topic,
                received,
                source_ns,
                end: batch.bytes.len(),
            });
            batch.messages += 1;
        } else {
            // From the first dropped message until the queue is emptied all are dropped: one gap instead of many.
            batch.dropped += 1;
        }
        self.ready(state);
        has_room
    }

    /// Reports a fault of a transport, or its end.
    pub fn fault(&self, received: Received, fault: TransportFault) {
        let mut state = lock(&self.lane.state);
        if state.notices < MAX_NOTICES {
            state.notices += 1;
            let fault = Box::new(fault);
            state.batch.items.push(Stored::Fault { received, fault });
        }
        self.ready(state);
    }

    /// Whether a message of this length leaves the queue at most half full, or finds it empty.
    pub fn has_room(&self, bytes: usize) -> bool {
        let (state, limits) = (lock(&self.lane.state), &self.lane.limits);
        let batch = &state.batch;
        let is_half_empty = batch.messages < limits.messages / 2
            && batch.bytes.len().saturating_add(bytes) <= limits.bytes / 2;
        batch.dropped == 0 && (is_half_empty || batch.messages == 0)
    }

    fn ready(&self, mut state: MutexGuard<'_, Filling>) {
        if !std::mem::replace(&mut state.is_ready, true) {
            drop(state);
            lock(&self.shared.ready).push_back(self.robot);
            self.shared.wake.notify_one();
        }
    }
}
