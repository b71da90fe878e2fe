//! Reader of a topic: messages enter the queues as they arrive, in a thread of Zenoh.

use crate::error::TransportFault;
use crate::handle::lock;
use crate::network::Reader;
use crate::received::Clock;
use crate::route::Targets;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use zenoh::pubsub::Subscriber;
use zenoh::sample::{Sample, SampleKind};

/// Receiver of the messages of a topic.
pub(super) struct TopicReceiver {
    pub(super) clock: Clock,
    pub(super) topic: String,
    pub(super) max_message_bytes: usize,
    targets: Mutex<Arc<Targets>>,
    received_messages: AtomicUsize,
    unreadable: AtomicU64,
}

impl TopicReceiver {
    pub(super) fn new(clock: Clock, topic: &str, most: usize, targets: &Arc<Targets>) -> Arc<Self> {
        Arc::new(TopicReceiver {
            clock,
            topic: topic.to_owned(),
            max_message_bytes: most,
            targets: Mutex::new(Arc::clone(targets)),
            received_messages: AtomicUsize::new(0),
            unreadable: AtomicU64::new(0),
        })
    }

    /// Returns the number of messages since the last call.
    pub(super) fn count_received(&self) -> usize {
        self.received_messages.swap(0, Ordering::Relaxed)
    }

    pub(super) fn take(&self, sample: &Sample) {
        if sample.kind() != SampleKind::Put {
            return;
        }
        let received = self.clock.now();
        let targets = Arc::clone(&lock(&self.targets));
        self.received_messages.fetch_add(1, Ordering::Relaxed);
        let (bytes, most) = (sample.payload().len(), self.max_message_bytes);
        if bytes > most {
            let topic = self.topic.clone();
            let (bytes, most) = (bytes as u64, most as u64);
            let fault = TransportFault::TooLong { topic, bytes, most };
            return targets.fault(received, &fault);
        }
        let cdr = sample.payload().to_bytes();
        match *cdr {
            [0, 0 | 1, _, _, ..] => targets.message(received, received.monotonic_ns, &[&cdr]),
            _ => {
                let messages = self.unreadable.fetch_add(1, Ordering::Relaxed) + 1;
                // Reported at the first, then at every power of two: a stream of them is one fault.
                if messages.is_power_of_two() {
                    let head = &cdr[..cdr.len().min(2)];
                    let fault = TransportFault::Unreadable {
                        topic: self.topic.clone(),
                        messages,
                        reason: format!(
                            "data representation {head:02x?} is unsupported; expected plain CDR"
                        ),
                    };
                    targets.fault(received, &fault);
                }
            }
        }
    }
}

/// Subscription of one topic.
pub(super) struct ZenohReader {
    pub(super) receiver: Arc<TopicReceiver>,
    /// Subscriber with the lifetime of the reader.
    pub(super) _subscriber: Subscriber<()>,
}

impl Reader for ZenohReader {
    fn aim(&mut self, targets: &Arc<Targets>) {
        *lock(&self.receiver.targets) = Arc::clone(targets);
    }
}
