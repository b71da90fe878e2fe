//! Participant of a domain while the transport is connected.

use super::raw::{Forward, Forwarded, Raw};
use super::writers::Writers;
use super::{DdsOptions, qos};
use crate::error::{PublisherLoss, TransportFault};
use crate::found::PublisherFound;
use crate::handle::Shared;
use crate::network::{
    End, Listening, MAX_PUBLISHERS, POLL_INTERVAL, Reader, Subscription, Topics, is_description,
};
use crate::received::Received;
use crate::ros_names::{dds_topic, dds_type, schema_of, topic_of};
use crate::route::Targets;
use rustdds::no_key::SimpleDataReader;
use rustdds::{
    DomainParticipant, DomainParticipantBuilder, DomainParticipantStatusEvent,
    DomainParticipantStatusListener, EndpointDescription, GUID, LostReason, QosPolicies,
    StatusEvented as _, Subscriber, TopicKind,
};
use std::collections::HashMap;
use std::net::UdpSocket;
use std::sync::Arc;
use std::task::{Wake, Waker};
use std::thread::Thread;
use std::time::Duration;

/// Time over which messages are collected: waking the thread for each message would cost more than processing it.
const COLLECT_TIME: Duration = Duration::from_millis(1);
/// Step of the civil clock, ns, above which the participant is restarted: the library numbers samples by this clock
/// and would deliver nothing until the clock has caught up.
const MAX_CLOCK_STEP_NS: i64 = 50_000_000;
/// Maximum number of messages taken from a topic before the other topics are served.
const MAX_MESSAGES_PER_TURN: usize = 2_000;

/// Waker of the transport thread.
struct Unpark(Thread);

impl Wake for Unpark {
    fn wake(self: Arc<Self>) {
        self.0.unpark();
    }
}

/// Reader of one DDS topic.
pub(super) struct DdsReader {
    reader: SimpleDataReader<Forwarded, Raw>,
    unreadable: u64,
}

impl Reader for DdsReader {
    // The targets of a topic are looked up when the topic is read.
    fn aim(&mut self, _: &Arc<Targets>) {}
}

pub(crate) struct Participant<'a> {
    listening: &'a Listening,
    max_message_bytes: usize,
    shared: &'a Shared,
    participant: DomainParticipant,
    subscriber: Subscriber,
    events: DomainParticipantStatusListener,
    waker: Waker,
    topics: Topics<DdsReader>,
    /// Names of the participants by the first 12 bytes of their endpoints.
    names: HashMap<[u8; 12], String>,
    writers: Writers,
    last: Received,
}

impl<'a> Participant<'a> {
    pub(super) fn join(
        options: &DdsOptions,
        listening: &'a Listening,
        shared: &'a Shared,
    ) -> Result<Self, String> {
        let participant = join(options)?;
        let subscriber = participant
            .create_subscriber(&QosPolicies::default())
            .map_err(|e| e.to_string())?;
        Ok(Participant {
            listening,
            max_message_bytes: options.max_message_bytes,
            shared,
            events: participant.status_listener(),
            participant,
            subscriber,
            waker: Waker::from(Arc::new(Unpark(std::thread::current()))),
            topics: Topics::new(&listening.routes),
            names: HashMap::new(),
            writers: Writers::default(),
            last: listening.clock.now(),
        })
    }

    /// Receives until the transport is closed or the network must be joined again.
    pub(super) fn listen(mut self) -> End {
        loop {
            if self.shared.stops() {
                return End::Stopped;
            }
            let now = self.listening.clock.now();
            let by_ns = (now.monotonic_ns - self.last.monotonic_ns)
                .saturating_sub(now.utc_ns.saturating_sub(self.last.utc_ns));
            self.last = now;
            if by_ns > MAX_CLOCK_STEP_NS {
                let by_s = by_ns as f64 * 1e-9;
                return End::ClockWentBack { by_s };
            }
            self.topics.follow_routes(
                self.listening,
                &mut opener(&self.participant, &self.subscriber),
            );
            while let Some(event) = self.events.try_recv_status() {
                self.event(event);
            }
            while let Ok(sealed) = self.listening.outgoing.try_recv() {
                let written = self.writers.write(&self.participant, sealed);
                self.shared.set_not_published(written.err());
            }
            for subscription in self.topics.subscriptions() {
                let taken = take(subscription, &self.waker, now, self.max_message_bytes);
                self.shared.count(taken as u64);
                subscription.count_received(taken, now);
            }
            std::thread::park_timeout(POLL_INTERVAL);
            std::thread::sleep(COLLECT_TIME);
        }
    }

    fn event(&mut self, event: DomainParticipantStatusEvent) {
        match event {
            DomainParticipantStatusEvent::ParticipantDiscovered { dpd } => {
                if let Some(name) = dpd.entity_name.filter(|name| !name.is_empty())
                    && self.names.len() < MAX_PUBLISHERS
                {
                    self.names.insert(prefix(dpd.guid), name);
                }
            }
            DomainParticipantStatusEvent::WriterDetected { writer } => self.found(&writer),
            DomainParticipantStatusEvent::WriterLost { guid, reason } => {
                self.lost(&id(guid), &reason);
            }
            // A killed participant takes all its publishers with it, silently.
            DomainParticipantStatusEvent::ParticipantLost { id: gone, reason } => {
                let of_it = hex(gone.as_ref());
                let all = self
                    .topics
                    .ids()
                    .filter(|id| id.replace(':', "").starts_with(&of_it));
                for id in Vec::from_iter(all.map(str::to_owned)) {
                    self.lost(&id, &reason);
                }
            }
            DomainParticipantStatusEvent::RemoteWriterQosIncompatible {
                remote_writer,
                requested_qos,
                offered_qos,
                ..
            } => {
                let (offered, requested) = qos::conflict(&offered_qos, &requested_qos);
                let id = id(remote_writer);
                if let Some(writing) = self.topics.writing(&id) {
                    let fault = TransportFault::Incompatible {
                        topic: writing.topic.clone(),
                        publisher: self.name_of(&id),
                        offered,
                        requested,
                    };
                    let (topic, schema) = (&writing.topic, &writing.schema);
                    self.topics.report(topic, schema, self.listening, &fault);
                }
            }
            _ => {}
        }
    }

    /// Registers a discovered publisher.
    fn found(&mut self, writer: &EndpointDescription) {
        let topic = topic_of(&writer.topic_name);
        let (Some(topic), Some(schema)) = (topic, schema_of(&writer.type_name)) else {
            return;
        };
        if prefix(writer.guid) == prefix(self.participant_guid()) {
            return;
        }
        let publisher = PublisherFound {
            id: id(writer.guid),
            name: self.names.get(&prefix(writer.guid)).cloned(),
            reliability: qos::reliability(&writer.qos),
            durability: qos::durability(&writer.qos),
        };
        let named = self.name_of(&publisher.id);
        let mut open = opener(&self.participant, &self.subscriber);
        let what = (topic, schema);
        self.topics
            .found(self.listening, what, publisher, named, &mut open);
    }

    fn lost(&mut self, id: &str, reason: &LostReason) {
        let how = match reason {
            LostReason::Disposed => PublisherLoss::SignedOff,
            LostReason::Timeout { elapsed, .. } => PublisherLoss::Silent {
                for_s: elapsed.to_nanoseconds() as f64 * 1e-9,
            },
        };
        let named = self.name_of(id);
        self.topics.lost(self.listening, id, named, how);
    }

    fn participant_guid(&self) -> GUID {
        use rustdds::RTPSEntity as _;
        self.participant.guid()
    }

    /// Returns the display name of a publisher: its process or node, if announced, and its number.
    fn name_of(&self, id: &str) -> String {
        let bare = id.replace(':', "");
        let mut names = self.names.iter();
        match names.find(|(prefix, _)| bare.starts_with(&hex(&prefix[..]))) {
            Some((_, name)) => format!("{name} ({id})"),
            None => id.to_owned(),
        }
    }
}

/// Returns the function that subscribes to a topic on behalf of [`Topics`].
fn opener(
    participant: &DomainParticipant,
    subscriber: &Subscriber,
) -> impl FnMut(&str, &str, &Arc<Targets>) -> Result<DdsReader, String> {
    move |topic, schema, _| {
        let qos = qos::reader(is_description(schema));
        let (name, kind) = (dds_topic(topic), dds_type(schema));
        let reader = participant
            .create_topic(name, kind, &qos, TopicKind::NoKey)
            .and_then(|topic| {
                subscriber.create_simple_datareader_no_key::<Forwarded, Raw>(&topic, Some(qos))
            });
        Ok(DdsReader {
            reader: reader.map_err(|e| e.to_string())?,
            unreadable: 0,
        })
    }
}

/// Joins the network; nothing is received or published yet.
pub(super) fn join(options: &DdsOptions) -> Result<DomainParticipant, String> {
    let mut builder = DomainParticipantBuilder::new(options.domain);
    if !options.interfaces.is_empty() {
        for address in &options.interfaces {
            // The library accepts any address, and receives nothing at one of another host.
            UdpSocket::bind((*address, 0))
                .map_err(|e| format!("interface {address} cannot be used: {e}"))?;
        }
        builder = builder.with_only_networks(options.interfaces.iter().copied());
    }
    builder.build().map_err(|e| e.to_string())
}

/// Takes the messages of a topic; returns their number.
fn take(
    subscription: &mut Subscription<DdsReader>,
    waker: &Waker,
    received: Received,
    most: usize,
) -> usize {
    let DdsReader { reader, unreadable } = &mut subscription.reader;
    // Order matters: messages from here on wake the thread.
    reader.set_waker(Some(waker.clone()));
    reader.drain_read_notifications();
    let mut taken = 0;
    for _ in 0..MAX_MESSAGES_PER_TURN {
        let forward = Forward {
            targets: &subscription.targets,
            received,
            most,
        };
        match reader.try_take_one_with(forward) {
            Ok(None) => return taken,
            Ok(Some(change)) => {
                if let Forwarded::TooLong(bytes) = change.into_value() {
                    let topic = subscription.topic.clone();
                    let most = most as u64;
                    let fault = TransportFault::TooLong { topic, bytes, most };
                    subscription.targets.fault(received, &fault);
                }
                taken += 1;
            }
            Err(error) => {
                *unreadable += 1;
                // Reported at the first, then at every power of two: a stream of them is one fault.
                if unreadable.is_power_of_two() {
                    let fault = TransportFault::Unreadable {
                        topic: subscription.topic.clone(),
                        messages: *unreadable,
                        reason: error.to_string(),
                    };
                    subscription.targets.fault(received, &fault);
                }
            }
        }
    }
    // More messages wait: the thread does not sleep.
    waker.wake_by_ref();
    taken
}

fn prefix(guid: GUID) -> [u8; 12] {
    let mut prefix = [0; 12];
    prefix.copy_from_slice(&guid.to_bytes()[..12]);
    prefix
}

/// Formats a GUID as DDS tools do.
fn id(guid: GUID) -> String {
    let bytes = guid.to_bytes();
    let parts = [&bytes[..4], &bytes[4..8], &bytes[8..12], &bytes[12..]];
    parts.map(hex).join(":")
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|b| format!("{b:02x}")).collect()
}
