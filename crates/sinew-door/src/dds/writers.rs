//! What goes out: two kinds of messages, made to bytes here and written by the door's thread.

use super::qos;
use super::raw::Raw;
use crate::handle::Door;
use crate::publish::{Outgoing, PublishError, Publisher, Publishing};
use crate::ros_names::{dds_topic, dds_type};
use rustdds::bytes::Bytes;
use rustdds::no_key::DataWriter;
use rustdds::{DomainParticipant, TopicKind};
use std::collections::BTreeMap;
use std::sync::OnceLock;
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::thread::Thread;

/// Messages that wait for the door's thread, at most.
const WAITING_MOST: usize = 64;
/// Bytes of the encapsulation header, which the library writes itself.
const ENCAPSULATION: usize = 4;

/// A message on its way out.
pub(super) struct Sealed {
    topic: String,
    schema: &'static str,
    payload: Bytes,
}

/// Hands messages to the door's thread.
pub(super) struct DdsPublisher {
    publishing: Publishing,
    outgoing: SyncSender<Sealed>,
    thread: OnceLock<Thread>,
    cdr: Vec<u8>,
}

impl DdsPublisher {
    pub(super) fn new(publishing: Publishing) -> (Self, Receiver<Sealed>) {
        let (outgoing, incoming) = sync_channel(WAITING_MOST);
        let publisher = DdsPublisher {
            publishing,
            outgoing,
            thread: OnceLock::new(),
            cdr: Vec::new(),
        };
        (publisher, incoming)
    }

    pub(super) fn wakes(&self, door: &Door) {
        if let Some(thread) = door.thread() {
            self.thread.get_or_init(|| thread.clone());
        }
    }
}

impl Publisher for DdsPublisher {
    fn publish(&mut self, message: &Outgoing<'_>) -> Result<(), PublishError> {
        if !self.publishing.allows(message) {
            return Ok(());
        }
        message.encode(&mut self.cdr)?;
        let topic = message.topic();
        let sealed = Sealed {
            schema: message.schema().name,
            payload: Bytes::copy_from_slice(&self.cdr[ENCAPSULATION..]),
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

/// Writers of a participant, made when they are first used.
#[derive(Default)]
pub(super) struct Writers {
    all: BTreeMap<String, DataWriter<Bytes, Raw>>,
    publisher: Option<rustdds::Publisher>,
}

impl Writers {
    pub(super) fn write(
        &mut self,
        participant: &DomainParticipant,
        sealed: Sealed,
    ) -> Result<(), String> {
        let qos = qos::writer();
        if !self.all.contains_key(&sealed.topic) {
            let publisher = match &self.publisher {
                Some(publisher) => publisher,
                None => {
                    let made = participant.create_publisher(&qos);
                    self.publisher.insert(made.map_err(|e| e.to_string())?)
                }
            };
            let (name, kind) = (dds_topic(&sealed.topic), dds_type(sealed.schema));
            let topic = participant
                .create_topic(name, kind, &qos, TopicKind::NoKey)
                .map_err(|e| e.to_string())?;
            let writer = publisher.create_datawriter_no_key::<Bytes, Raw>(&topic, Some(qos));
            let writer = writer.map_err(|e| e.to_string())?;
            self.all.insert(sealed.topic.clone(), writer);
        }
        let writer = self.all.get(&sealed.topic).ok_or("no writer")?;
        let written = writer.write(sealed.payload, None);
        written.map_err(|error| error.to_string())
    }
}
