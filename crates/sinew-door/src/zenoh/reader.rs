//! What reads a topic: messages go into the queues as they come, in a thread of Zenoh's.

use crate::handle::lock;
use crate::network::Reader;
use crate::received::Clock;
use crate::route::Targets;
use crate::trouble::Trouble;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use zenoh::pubsub::Subscriber;
use zenoh::sample::{Sample, SampleKind};

/// Takes the messages of a topic.
pub(super) struct Ear {
    pub(super) clock: Clock,
    pub(super) topic: String,
    pub(super) message_most_bytes: usize,
    targets: Mutex<Arc<Targets>>,
    heard: AtomicUsize,
    unreadable: AtomicU64,
}

impl Ear {
    pub(super) fn new(clock: Clock, topic: &str, most: usize, targets: &Arc<Targets>) -> Arc<Self> {
        Arc::new(Ear {
            clock,
            topic: topic.to_owned(),
            message_most_bytes: most,
            targets: Mutex::new(Arc::clone(targets)),
            heard: AtomicUsize::new(0),
            unreadable: AtomicU64::new(0),
        })
    }

    /// Messages since this was last asked.
    pub(super) fn heard(&self) -> usize {
        self.heard.swap(0, Ordering::Relaxed)
    }

    pub(super) fn take(&self, sample: &Sample) {
        if sample.kind() != SampleKind::Put {
            return;
        }
        let received = self.clock.now();
        let targets = Arc::clone(&lock(&self.targets));
        self.heard.fetch_add(1, Ordering::Relaxed);
        let (bytes, most) = (sample.payload().len(), self.message_most_bytes);
        if bytes > most {
            let topic = self.topic.clone();
            let (bytes, most) = (bytes as u64, most as u64);
            let trouble = Trouble::TooLong { topic, bytes, most };
            return targets.trouble(received, &trouble);
        }
        let cdr = sample.payload().to_bytes();
        match *cdr {
            [0, 0 | 1, _, _, ..] => targets.message(received, received.monotonic_ns, &[&cdr]),
            _ => {
                let messages = self.unreadable.fetch_add(1, Ordering::Relaxed) + 1;
                // The first, then ever more seldom: a stream of them is one trouble.
                if messages.is_power_of_two() {
                    let head = &cdr[..cdr.len().min(2)];
                    let trouble = Trouble::Unreadable {
                        topic: self.topic.clone(),
                        messages,
                        why: format!("data representation {head:02x?}; plain CDR is read"),
                    };
                    targets.trouble(received, &trouble);
                }
            }
        }
    }
}

/// A subscription.
pub(super) struct ZenohReader {
    pub(super) ear: Arc<Ear>,
    /// It lasts as long as the reader.
    pub(super) _subscriber: Subscriber<()>,
}

impl Reader for ZenohReader {
    fn aim(&mut self, targets: &Arc<Targets>) {
        *lock(&self.ear.targets) = Arc::clone(targets);
    }
}
