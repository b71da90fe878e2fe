//! Bounded queues from doors to the monitor: one for each robot, one place to wait for them all.
//!
//! ```text
//! door thread ── Sender::message ─▶ ┌ robot 0: bytes, items, dropped ┐ ── Inbox::take ─▶ core thread
//! door thread ── Sender::message ─▶ └ robot 1: …                     ┘    Inbox::wait: which one is ready
//! ```
//!
//! A queue is two flat buffers. The taker swaps them with its own, emptied ones: after warm-up a message
//! costs a copy and no allocation, and a lock is held for no longer than that.

use crate::handle::lock;
use crate::received::Received;
use crate::trouble::Trouble;
use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// How much a robot's queue holds before it drops.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct QueueLimits {
    /// Messages at most.
    pub messages: usize,
    /// Bytes of them.
    pub bytes: usize,
}

impl Default for QueueLimits {
    /// Four seconds of two topics at 500 Hz; eight descriptions of a robot.
    fn default() -> Self {
        QueueLimits {
            messages: 4_096,
            bytes: 8 << 20,
        }
    }
}

/// Announcements and troubles that wait, at most; they don't count as messages.
const NOTICES_MOST: usize = 1_024;
/// Buffers that a large message grew are given back beyond this, bytes.
const KEPT_BYTES: usize = 256 << 10;

/// A robot, in the order of [`Inbox::robot`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RobotId(pub(crate) u32);

impl RobotId {
    /// Its place in the order of [`Inbox::robot`].
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A topic of a robot's queue.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TopicKey(pub(crate) u32);

impl TopicKey {
    /// Its place in the order of announcements.
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
    Trouble {
        received: Received,
        trouble: Box<Trouble>,
    },
}

/// What one [`Inbox::take`] brought.
#[derive(Debug, Default)]
pub struct Batch {
    bytes: Vec<u8>,
    items: Vec<Stored>,
    messages: usize,
    dropped: u64,
}

/// What came, in its order.
#[derive(Debug)]
pub enum Item<'a> {
    /// A topic is announced, before its first message.
    Topic {
        /// What its messages are marked with.
        topic: TopicKey,
        /// The topic's name.
        name: &'a str,
        /// Its type, such as `sensor_msgs/msg/JointState`.
        schema: &'a str,
    },
    /// A message.
    Message {
        /// The topic's key, as it was announced.
        topic: TopicKey,
        /// When it was received.
        received: Received,
        /// What stands for a stamp of zero, ns: when it was sent or logged, where that is known.
        source_ns: i64,
        /// The message: CDR with its encapsulation header.
        cdr: &'a [u8],
    },
    /// Something is wrong, or is right again.
    Trouble {
        /// When it was received, by both clocks.
        received: Received,
        /// What is wrong, or is right again.
        trouble: &'a Trouble,
    },
}

impl Batch {
    /// What came, in its order.
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
            Stored::Trouble { received, trouble } => Item::Trouble {
                received: *received,
                trouble,
            },
        })
    }

    /// Messages in it.
    pub fn messages(&self) -> usize {
        self.messages
    }

    /// Messages that were dropped after those in it, since the queue was full.
    pub fn dropped(&self) -> u64 {
        self.dropped
    }

    /// Memory held for messages, bytes.
    pub fn capacity_bytes(&self) -> usize {
        self.bytes.capacity()
    }

    fn clear(&mut self) {
        self.bytes.clear();
        if self.bytes.capacity() > KEPT_BYTES {
            self.bytes.shrink_to(KEPT_BYTES);
        }
        self.items.clear();
        self.messages = 0;
        self.dropped = 0;
    }
}

/// A robot's queue while it fills.
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
    /// Whether it stands among the ready, once.
    is_ready: bool,
}

#[derive(Debug, Default)]
struct Shared {
    lanes: Mutex<Vec<Arc<Lane>>>,
    ready: Mutex<VecDeque<RobotId>>,
    wake: Condvar,
}

/// Where a thread of the monitor waits for the messages of its robots.
#[derive(Debug, Clone, Default)]
pub struct Inbox {
    shared: Arc<Shared>,
}

impl Inbox {
    /// No robot yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// A robot's queue; the sender goes to its doors.
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

    /// A robot that has something to take, the one that waits longest; `None` after `timeout`.
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

    /// Wakes a waiting thread, whether there is something or not: [`Self::wait`] may return `None` early.
    pub fn nudge(&self) {
        self.shared.wake.notify_all();
    }

    /// Takes everything that a robot's queue holds; `batch` is emptied first and its memory goes back.
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

/// A door's end of a robot's queue.
#[derive(Debug, Clone)]
pub struct Sender {
    lane: Arc<Lane>,
    shared: Arc<Shared>,
    robot: RobotId,
}

impl Sender {
    /// Whose queue it is.
    pub fn robot(&self) -> RobotId {
        self.robot
    }

    /// Announces a topic; the same name and type keep their key.
    pub fn topic(&self, name: &str, schema: &str) -> TopicKey {
        let mut state = lock(&self.lane.state);
        let topics = &mut state.topics;
        let known = topics.iter().position(|t| t.0 == name && t.1 == schema);
        if let Some(index) = known {
            return TopicKey(index as u32);
        }
        let key = TopicKey(topics.len() as u32);
        let described = Arc::new((name.to_owned(), schema.to_owned()));
        topics.push(Arc::clone(&described));
        state.batch.items.push(Stored::Topic(key, described));
        self.ready(state);
        key
    }

    /// Puts a message in; `false`: the queue is full, and it was dropped and counted.
    ///
    /// `source_ns` stands for a stamp of zero: when it was sent or logged, else when it was received.
    pub fn message(&self, topic: TopicKey, received: Received, source_ns: i64, cdr: &[u8]) -> bool {
        self.message_of_parts(topic, received, source_ns, &[cdr])
    }

    /// The same of a message that lies in several places.
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
            // From the first one dropped on, until it is emptied: one gap and no holes.
            batch.dropped += 1;
        }
        self.ready(state);
        has_room
    }

    /// Says that something is wrong, or is right again.
    pub fn trouble(&self, received: Received, trouble: Trouble) {
        let mut state = lock(&self.lane.state);
        if state.notices < NOTICES_MOST {
            state.notices += 1;
            let trouble = Box::new(trouble);
            state
                .batch
                .items
                .push(Stored::Trouble { received, trouble });
        }
        self.ready(state);
    }

    /// Whether a message of this length leaves the queue half empty, or finds it empty.
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
