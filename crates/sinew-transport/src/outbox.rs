//! Outgoing messages: serialised by the caller, sent by the transport thread.

use crate::handle::Transport;
use crate::publish::{Outgoing, PublishError, Publisher, Publishing};
use std::sync::OnceLock;
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::thread::Thread;

/// Maximum number of messages that wait for the transport thread.
const MAX_WAITING_MESSAGES: usize = 64;

/// Serialised outgoing message.
pub(crate) struct Sealed {
    pub(crate) topic: String,
    pub(crate) schema: &'static str,
    /// CDR with its encapsulation header of four bytes.
    pub(crate) cdr: Vec<u8>,
}

/// Queue of outgoing messages to the transport thread.
pub(crate) struct Outbox {
    publishing: Publishing,
    outgoing: SyncSender<Sealed>,
    thread: OnceLock<Thread>,
}

impl Outbox {
    pub(crate) fn new(publishing: Publishing) -> (Self, Receiver<Sealed>) {
        let (outgoing, incoming) = sync_channel(MAX_WAITING_MESSAGES);
        let outbox = Outbox {
            publishing,
            outgoing,
            thread: OnceLock::new(),
        };
        (outbox, incoming)
    }

    /// Wakes the thread of this transport for every message.
    pub(crate) fn wakes(&self, transport: &Transport) {
        if let Some(thread) = transport.thread() {
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
            TrySendError::Full(_) => PublishError::Rejected {
                topic,
                reason: format!("{MAX_WAITING_MESSAGES} messages are waiting already"),
            },
            TrySendError::Disconnected(_) => PublishError::Closed { topic },
        })
    }
}
