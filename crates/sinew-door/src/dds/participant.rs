//! A participant of a domain while the door stands open.

use super::raw::{Forward, Forwarded, Raw};
use super::writers::{Sealed, Writers};
use super::{DdsOptions, qos};
use crate::found::PublisherFound;
use crate::handle::Shared;
use crate::look::{Announced, Directory};
use crate::received::{Clock, Received};
use crate::ros_names::{dds_topic, dds_type, schema_of, topic_of};
use crate::route::{Routes, Targets};
use crate::trouble::{Lost, Trouble};
use rustdds::no_key::SimpleDataReader;
use rustdds::{
    DomainParticipant, DomainParticipantBuilder, DomainParticipantStatusEvent,
    DomainParticipantStatusListener, EndpointDescription, GUID, LostReason, QosPolicies,
    StatusEvented as _, Subscriber, TopicKind,
};
use std::collections::{BTreeMap, HashMap};
use std::net::UdpSocket;
use std::sync::Arc;
use std::sync::mpsc::Receiver;
use std::task::{Wake, Waker};
use std::thread::Thread;
use std::time::{Duration, Instant};

/// Messages of so long are taken together: a thread that is woken for each costs more than what it does.
const TOGETHER: Duration = Duration::from_millis(1);
/// Without a message the network's events are looked at so often.
const IDLE: Duration = Duration::from_millis(100);
/// A network that can't be used is tried again after so long, at first and at most.
const TRY_AGAIN: (Duration, Duration) = (Duration::from_secs(1), Duration::from_secs(30));
/// The civil clock went back by more than this: the library, which numbers samples by it, would hand out nothing
/// until it has caught up.
const CLOCK_BACK_NS: i64 = 50_000_000;
/// Messages taken of a topic before the others get their turn.
const TURN: usize = 2_000;
/// A publisher of which nothing comes for so long is quiet.
const QUIET: Duration = Duration::from_secs(5);
/// The type of a robot's description, which is published once.
const DESCRIPTION: &str = "std_msgs/msg/String";
/// Publishers remembered at most.
const PUBLISHERS_MOST: usize = 4_096;

/// What a door's thread has.
pub(super) struct Listening {
    pub(super) options: DdsOptions,
    pub(super) routes: Routes,
    pub(super) clock: Clock,
    pub(super) outgoing: Receiver<Sealed>,
    pub(super) directory: Directory,
}

/// Wakes the door's thread.
struct Unpark(Thread);

impl Wake for Unpark {
    fn wake(self: Arc<Self>) {
        self.0.unpark();
    }
}

/// Why a participant is given up.
enum End {
    Stopped,
    ClockWentBack { by_s: f64 },
}

impl Listening {
    pub(super) fn run(self, shared: &Shared) {
        let mut wait = TRY_AGAIN.0;
        let mut was_shut = true;
        while !shared.stops() {
            let ended = match Participant::new(&self, shared) {
                Ok(mut participant) => {
                    wait = TRY_AGAIN.0;
                    if std::mem::take(&mut was_shut) {
                        shared.set_shut(None);
                        let door = shared.name().to_owned();
                        let open = Trouble::Open { door };
                        self.routes.tell_all(self.clock.now(), &open);
                    }
                    participant.listen()
                }
                Err(why) => {
                    if !std::mem::replace(&mut was_shut, true) || wait == TRY_AGAIN.0 {
                        shared.set_shut(Some(why.clone()));
                        let door = shared.name().to_owned();
                        let shut = Trouble::Shut { door, why };
                        self.routes.tell_all(self.clock.now(), &shut);
                    }
                    let until = Instant::now() + wait;
                    while !shared.stops() && Instant::now() < until {
                        std::thread::park_timeout(IDLE);
                    }
                    wait = (2 * wait).min(TRY_AGAIN.1);
                    continue;
                }
            };
            self.directory.change(Vec::clear);
            match ended {
                End::Stopped => break,
                End::ClockWentBack { by_s } => {
                    let trouble = Trouble::ClockWentBack { by_s };
                    self.routes.tell_all(self.clock.now(), &trouble);
                }
            }
        }
    }
}

/// A topic that is read.
struct Reading {
    reader: SimpleDataReader<Forwarded, Raw>,
    topic: String,
    schema: String,
    targets: Targets,
    unreadable: u64,
    /// Since when somebody publishes it and nothing came; `None`: something did, or it was said.
    quiet_since: Option<Instant>,
}

/// A publisher that was announced.
struct Writing {
    topic: String,
    schema: String,
}

struct Participant<'a> {
    listening: &'a Listening,
    shared: &'a Shared,
    participant: DomainParticipant,
    subscriber: Subscriber,
    events: DomainParticipantStatusListener,
    waker: Waker,
    /// By name and type.
    readings: BTreeMap<(String, String), Reading>,
    writing: HashMap<GUID, Writing>,
    /// Names of participants by the first bytes of their endpoints.
    names: HashMap<[u8; 12], String>,
    writers: Writers,
    routes_version: u64,
    last: Received,
}

impl<'a> Participant<'a> {
    fn new(listening: &'a Listening, shared: &'a Shared) -> Result<Self, String> {
        let participant = join(&listening.options)?;
        let subscriber = participant
            .create_subscriber(&QosPolicies::default())
            .map_err(|e| e.to_string())?;
        Ok(Participant {
            listening,
            shared,
            events: participant.status_listener(),
            participant,
            subscriber,
            waker: Waker::from(Arc::new(Unpark(std::thread::current()))),
            readings: BTreeMap::new(),
            writing: HashMap::new(),
            names: HashMap::new(),
            writers: Writers::default(),
            routes_version: listening.routes.now().0,
            last: listening.clock.now(),
        })
    }

    /// Until the door is shut.
    fn listen(&mut self) -> End {
        loop {
            if self.shared.stops() {
                return End::Stopped;
            }
            let now = self.listening.clock.now();
            let by_ns = (now.monotonic_ns - self.last.monotonic_ns)
                .saturating_sub(now.utc_ns.saturating_sub(self.last.utc_ns));
            self.last = now;
            if by_ns > CLOCK_BACK_NS {
                let by_s = by_ns as f64 * 1e-9;
                return End::ClockWentBack { by_s };
            }
            self.follow_routes();
            while let Some(event) = self.events.try_recv_status() {
                self.event(event, now);
            }
            while let Ok(sealed) = self.listening.outgoing.try_recv() {
                let written = self.writers.write(&self.participant, sealed);
                self.shared.set_not_published(written.err());
            }
            let most = self.listening.options.message_most_bytes;
            for reading in self.readings.values_mut() {
                let taken = take(reading, &self.waker, now, most);
                self.shared.count(taken as u64);
                let is_quiet = |since: &mut Instant| since.elapsed() > QUIET;
                if taken > 0 {
                    reading.quiet_since = None;
                } else if reading.quiet_since.take_if(is_quiet).is_some() {
                    let topic = reading.topic.clone();
                    let for_s = QUIET.as_secs_f64();
                    reading
                        .targets
                        .trouble(now, &Trouble::Quiet { topic, for_s });
                }
            }
            std::thread::park_timeout(IDLE);
            std::thread::sleep(TOGETHER);
        }
    }

    /// Robots that were configured anew.
    fn follow_routes(&mut self) {
        let (version, routes) = self.listening.routes.now();
        if version == self.routes_version {
            return;
        }
        self.routes_version = version;
        self.readings.retain(|_, reading| {
            reading.targets = Targets::of(&routes, &reading.topic, &reading.schema);
            !reading.targets.is_empty()
        });
        let known = self.writing.values();
        let known = known.map(|w| (w.topic.clone(), w.schema.clone()));
        for (topic, schema) in Vec::from_iter(known) {
            self.read(&topic, &schema);
        }
    }

    fn event(&mut self, event: DomainParticipantStatusEvent, now: Received) {
        match event {
            DomainParticipantStatusEvent::ParticipantDiscovered { dpd } => {
                if let Some(name) = dpd.entity_name.filter(|name| !name.is_empty())
                    && self.names.len() < PUBLISHERS_MOST
                {
                    self.names.insert(prefix(dpd.guid), name);
                }
            }
            DomainParticipantStatusEvent::WriterDetected { writer } => self.found(&writer, now),
            DomainParticipantStatusEvent::WriterLost { guid, reason } => {
                self.lost(guid, &reason, now);
            }
            // Whoever was killed takes all its publishers with it, without a word.
            DomainParticipantStatusEvent::ParticipantLost { id, reason } => {
                let of_it = |guid: &&GUID| guid.to_bytes().starts_with(id.as_ref());
                let gone: Vec<GUID> = self.writing.keys().filter(of_it).copied().collect();
                for guid in gone {
                    self.lost(guid, &reason, now);
                }
            }
            DomainParticipantStatusEvent::RemoteWriterQosIncompatible {
                remote_writer,
                requested_qos,
                offered_qos,
                ..
            } => {
                let (offered, requested) = qos::conflict(&offered_qos, &requested_qos);
                if let Some(writing) = self.writing.get(&remote_writer) {
                    let topic = writing.topic.clone();
                    let publisher = self.name_of(remote_writer);
                    let key = (topic.clone(), writing.schema.clone());
                    let trouble = Trouble::Incompatible {
                        topic,
                        publisher,
                        offered,
                        requested,
                    };
                    if let Some(reading) = self.readings.get(&key) {
                        reading.targets.trouble(now, &trouble);
                    }
                }
            }
            _ => {}
        }
    }

    /// A publisher is there.
    fn found(&mut self, writer: &EndpointDescription, now: Received) {
        let Some(topic) = topic_of(&writer.topic_name) else {
            return;
        };
        let is_own = prefix(writer.guid) == prefix(self.participant_guid());
        let Some(schema) = schema_of(&writer.type_name) else {
            return;
        };
        if is_own || self.writing.len() >= PUBLISHERS_MOST {
            return;
        }
        let is_new = !self.writing.contains_key(&writer.guid);
        let (guid, named) = (writer.guid, self.name_of(writer.guid));
        self.writing.insert(
            guid,
            Writing {
                topic: topic.clone(),
                schema: schema.clone(),
            },
        );
        let publisher = PublisherFound {
            id: id(guid),
            name: self.names.get(&prefix(guid)).cloned(),
            reliability: qos::reliability(&writer.qos),
            durability: qos::durability(&writer.qos),
        };
        self.listening.directory.change(|all| {
            all.retain(|known| known.publisher.id != publisher.id);
            all.push(Announced {
                topic: topic.clone(),
                schema: schema.clone(),
                publisher,
            });
        });
        self.read(&topic, &schema);
        if !is_new {
            return;
        }
        match self.readings.get_mut(&(topic.clone(), schema.clone())) {
            Some(reading) => {
                let is_continuous = schema != DESCRIPTION;
                reading.quiet_since = is_continuous.then(Instant::now);
                let publisher = named;
                let trouble = Trouble::PublisherFound { topic, publisher };
                reading.targets.trouble(now, &trouble);
            }
            None => {
                let routes = self.listening.routes.now().1;
                for route in routes.iter().filter(|route| route.expects(&topic)) {
                    let (topic, found) = (topic.clone(), schema.clone());
                    route
                        .sender()
                        .trouble(now, Trouble::WrongType { topic, found });
                }
            }
        }
    }

    fn lost(&mut self, guid: GUID, reason: &LostReason, now: Received) {
        let Some(writing) = self.writing.remove(&guid) else {
            return;
        };
        let (gone, publisher) = (id(guid), self.name_of(guid));
        self.listening
            .directory
            .change(|all| all.retain(|known| known.publisher.id != gone));
        let how = match reason {
            LostReason::Disposed => Lost::Left,
            LostReason::Timeout { elapsed, .. } => Lost::Silent {
                for_s: elapsed.to_nanoseconds() as f64 * 1e-9,
            },
        };
        let key = (writing.topic.clone(), writing.schema);
        if let Some(reading) = self.readings.get(&key) {
            let trouble = Trouble::PublisherLost {
                topic: writing.topic,
                publisher,
                how,
            };
            reading.targets.trouble(now, &trouble);
        }
    }

    /// Reads a topic from now on, where some robot wants it.
    fn read(&mut self, topic: &str, schema: &str) {
        let key = (topic.to_owned(), schema.to_owned());
        if self.readings.contains_key(&key) {
            return;
        }
        let targets = Targets::of(&self.listening.routes.now().1, topic, schema);
        if targets.is_empty() {
            return;
        }
        let qos = qos::reader(schema == DESCRIPTION);
        let (name, kind) = (dds_topic(topic), dds_type(schema));
        let made = self
            .participant
            .create_topic(name, kind, &qos, TopicKind::NoKey)
            .and_then(|topic| {
                self.subscriber
                    .create_simple_datareader_no_key::<Forwarded, Raw>(&topic, Some(qos))
            });
        match made {
            Ok(reader) => {
                let reading = Reading {
                    reader,
                    topic: topic.to_owned(),
                    schema: schema.to_owned(),
                    targets,
                    unreadable: 0,
                    quiet_since: None,
                };
                self.readings.insert(key, reading);
            }
            Err(error) => {
                let trouble = Trouble::Unreadable {
                    topic: topic.to_owned(),
                    messages: 0,
                    why: error.to_string(),
                };
                targets.trouble(self.listening.clock.now(), &trouble);
            }
        }
    }

    fn participant_guid(&self) -> GUID {
        use rustdds::RTPSEntity as _;
        self.participant.guid()
    }

    /// A publisher in words: its process or node where it says one, and its number.
    fn name_of(&self, guid: GUID) -> String {
        match self.names.get(&prefix(guid)) {
            Some(name) => format!("{name} ({})", id(guid)),
            None => id(guid),
        }
    }
}

/// Joins the network; nothing is read or published yet.
pub(super) fn join(options: &DdsOptions) -> Result<DomainParticipant, String> {
    let mut builder = DomainParticipantBuilder::new(options.domain);
    if !options.interfaces.is_empty() {
        for address in &options.interfaces {
            // The library takes any address, and hears nothing at one of another computer.
            UdpSocket::bind((*address, 0))
                .map_err(|e| format!("interface {address} can't be used: {e}"))?;
        }
        builder = builder.with_only_networks(options.interfaces.iter().copied());
    }
    builder.build().map_err(|e| e.to_string())
}

/// Takes what a topic brought; how many messages.
fn take(reading: &mut Reading, waker: &Waker, received: Received, most: usize) -> usize {
    // In this order: what comes from here on wakes the thread.
    reading.reader.set_waker(Some(waker.clone()));
    reading.reader.drain_read_notifications();
    let mut taken = 0;
    for _ in 0..TURN {
        let forward = Forward {
            targets: &reading.targets,
            received,
            most,
        };
        match reading.reader.try_take_one_with(forward) {
            Ok(None) => return taken,
            Ok(Some(change)) => {
                if let Forwarded::TooLong(bytes) = change.into_value() {
                    let topic = reading.topic.clone();
                    let most = most as u64;
                    let trouble = Trouble::TooLong { topic, bytes, most };
                    reading.targets.trouble(received, &trouble);
                }
                taken += 1;
            }
            Err(error) => {
                reading.unreadable += 1;
                // The first, then ever more seldom: a stream of them is one trouble.
                if reading.unreadable.is_power_of_two() {
                    let trouble = Trouble::Unreadable {
                        topic: reading.topic.clone(),
                        messages: reading.unreadable,
                        why: error.to_string(),
                    };
                    reading.targets.trouble(received, &trouble);
                }
            }
        }
    }
    // More waits: the thread doesn't rest.
    waker.wake_by_ref();
    taken
}

fn prefix(guid: GUID) -> [u8; 12] {
    let mut prefix = [0; 12];
    prefix.copy_from_slice(&guid.to_bytes()[..12]);
    prefix
}

/// A GUID as DDS tools write it.
fn id(guid: GUID) -> String {
    let hex = |bytes: &[u8]| -> String { bytes.iter().map(|b| format!("{b:02x}")).collect() };
    let bytes = guid.to_bytes();
    let parts = [&bytes[..4], &bytes[4..8], &bytes[8..12], &bytes[12..]];
    parts.map(hex).join(":")
}
