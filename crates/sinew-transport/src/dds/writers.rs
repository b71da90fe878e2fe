//! Writers of the two kinds of published messages.

use super::qos;
use super::raw::Raw;
use crate::outbox::Sealed;
use crate::ros_names::{dds_topic, dds_type};
use rustdds::bytes::Bytes;
use rustdds::no_key::DataWriter;
use rustdds::{DomainParticipant, TopicKind};
use std::collections::BTreeMap;

/// Length of the encapsulation header, bytes; the library writes it.
const ENCAPSULATION: usize = 4;

/// Writers of a participant, created at their first use.
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
        let writer = self.all.get(&sealed.topic).ok_or("writer not found")?;
        let payload = Bytes::from(sealed.cdr).slice(ENCAPSULATION..);
        let written = writer.write(payload, None);
        written.map_err(|error| error.to_string())
    }
}
