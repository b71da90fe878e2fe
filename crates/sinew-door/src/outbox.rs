//! Messages on their way out: made to bytes by whoever publishes, written by the door's thread.

use crate::handle::Door;
use crate::publish::{Outgoing, PublishError, Publisher, Publishing};
use std::sync::OnceLock;
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::thread::Thread;

/// Messages that wait for the door's thread, at most.
const WAITING_MOST: usize = 64;

/// A message on its way out.
pub(crate) struct Sealed {
    pub(crate) topic: String,
    pub(crate) schema: &'static str,
    /// With its encapsulation header of four bytes.
    pub(crate) cdr: Vec<u8>,
}

/// Hands messages to the door's thread.
pub(crate) struct Outbox {
    publishing: Publishing,
    outgoing: SyncSender<Sealed>,
    thread: OnceLock<Thread>,
}

impl Outbox {
    pub(crate) fn new(publishing: Publishing) -> (Self, Receiver<Sealed>) {
        let (outgoing, incoming) = sync_channel(WAITING_MOST);
        let outbox = Outbox {
            publishing,
            outgoing,
            thread: OnceLock::new(),
        };
        (outbox, incoming)
    }

    /// Wakes this door's thread for every message.
    pub(crate) fn wakes(&self, door: &Door) {
        if let Some(thread) = door.thread() {
            self.thread.get_or_init(|| thread.clone());
        }
    }
}

impl Publisher for Outbox {
    fn publish(&mut self, message: &Outgoing<'_>) -> Result<(), PublishError> {
        if !self.publishing.allows(message) {
            return Ok(());
        }
        let mut cdr = Vec::new();
        message.encode(&mut cdr)?;
        let topic = message.topic();
        let sealed = Sealed {
            schema: message.schema().name,
            cdr,
            topic: topic.clone(),
        };
        let sent = self.outgoing.try_send(sealed);
        if let Some(thread) = self.thread.get() {
            thread.unpark();
        }
        sent.map_err(|error| match error {
            TrySendError::Full(_) => PublishError::Refused {
                topic,
                why: format!("{WAITING_MOST} messages wait already"),
            },
            TrySendError::Disconnected(_) => PublishError::Shut { topic },
        })
    }
}
