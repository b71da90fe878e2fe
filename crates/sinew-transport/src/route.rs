//! Routing of topics to the queues of robots.

use crate::error::TransportFault;
use crate::handle::{Shared, lock};
use crate::inbox::{Sender, TopicKey};
use crate::received::Received;
use crate::records::Recorded;
use sinew_log::live::{LiveOptions, OVERLOOKED_MOST, TopicDiscovery, TopicFilter};
use std::collections::{BTreeSet, HashMap};
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// Robot that receives messages from a transport.
#[derive(Debug, Clone)]
pub struct Route {
    sender: Sender,
    /// Filter of the topics; `None`: every topic that can be decoded.
    filter: Option<TopicFilter>,
    /// Announced topics that the robot does not require.
    overlooked: Arc<Mutex<BTreeSet<String>>>,
}

impl Route {
    /// Creates a route for the messages that these options require.
    pub fn new(sender: Sender, options: &LiveOptions) -> Self {
        Route {
            sender,
            filter: Some(TopicFilter::new(options)),
            overlooked: Arc::default(),
        }
    }

    /// Creates a route for every topic that can be decoded.
    #[cfg(any(feature = "dds", feature = "zenoh"))]
    pub(crate) fn of_everything(sender: Sender) -> Self {
        Route {
            sender,
            filter: None,
            overlooked: Arc::default(),
        }
    }

    /// Announces a topic with joint states that no robot requires: a configured name may be misspelt.
    fn overlook(&self, topic: &str, schema: &str) {
        let mut existing = lock(&self.overlooked);
        if existing.len() < OVERLOOKED_MOST && existing.insert(topic.to_owned()) {
            let _without_messages = self.sender.topic(topic, schema);
        }
    }

    /// Returns the sender of its queue.
    pub fn sender(&self) -> &Sender {
        &self.sender
    }

    /// Whether messages of a topic may be required by the robot.
    pub fn wants(&self, topic: &str, schema: &str) -> bool {
        match &self.filter {
            Some(filter) => filter.wants(topic, schema),
            None => TopicDiscovery::reads(topic, schema),
        }
    }

    /// Whether the name of a topic is expected, independent of its type.
    pub fn expects(&self, topic: &str) -> bool {
        self.filter.as_ref().is_some_and(|f| f.expects(topic))
    }
}

/// Robots behind a transport; reloading the configuration replaces them without closing the transport.
#[derive(Debug, Clone, Default)]
pub struct Routes {
    shared: Arc<Mutex<(u64, Arc<[Route]>)>>,
}

impl Routes {
    /// Makes the routes to these robots.
    pub fn new(routes: Vec<Route>) -> Self {
        let all = Self::default();
        all.replace(routes);
        all
    }

    /// Replaces the robots. Topics that no robot requires any more are unsubscribed; no message of the others is
    /// lost.
    pub fn replace(&self, routes: Vec<Route>) {
        let mut shared = lock(&self.shared);
        shared.0 += 1;
        shared.1 = routes.into();
    }

    /// Returns the robots with a version number that changes with them.
    pub fn now(&self) -> (u64, Arc<[Route]>) {
        let shared = lock(&self.shared);
        (shared.0, Arc::clone(&shared.1))
    }

    /// Reports a fault to every robot.
    pub(crate) fn report_all(&self, received: Received, fault: &TransportFault) {
        for route in self.now().1.iter() {
            route.sender().fault(received, fault.clone());
        }
    }
}

/// Queues that receive the messages of one topic, with its keys there.
#[derive(Debug, Clone, Default)]
pub(crate) struct Targets {
    all: Vec<(Sender, TopicKey)>,
}

impl Targets {
    /// Selects the robots that require the topic and announces it to them.
    pub(crate) fn of(routes: &[Route], topic: &str, schema: &str) -> Self {
        let wanting = routes.iter().filter(|route| route.wants(topic, schema));
        let announced = wanting.map(|route| {
            let sender = route.sender().clone();
            let key = sender.topic(topic, schema);
            (sender, key)
        });
        let all = Vec::from_iter(announced);
        if all.is_empty() && TopicFilter::is_of_joints(schema) {
            for route in routes {
                route.overlook(topic, schema);
            }
        }
        Targets { all }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Waits until a message of this length does not fill a queue, so that no message of a file is lost. Returns
    /// `false` if the transport shall be closed first.
    pub(crate) fn wait_for_room(&self, bytes: usize, shared: &Shared) -> bool {
        while !self.all.iter().all(|(sender, _)| sender.has_room(bytes)) {
            if shared.stops() {
                return false;
            }
            std::thread::sleep(Duration::from_micros(200));
        }
        !shared.stops()
    }

    pub(crate) fn message(&self, received: Received, source_ns: i64, parts: &[&[u8]]) {
        for (sender, key) in &self.all {
            sender.message_of_parts(*key, received, source_ns, parts);
        }
    }

    #[cfg(any(feature = "dds", feature = "zenoh"))]
    pub(crate) fn fault(&self, received: Received, fault: &TransportFault) {
        for (sender, _) in &self.all {
            sender.fault(received, fault.clone());
        }
    }
}

/// Queues of the channels of a recording, determined again whenever the routes change.
pub(crate) struct Channels {
    routes: Routes,
    version: u64,
    targets: HashMap<u16, Targets>,
}

impl Channels {
    pub(crate) fn new(routes: &Routes) -> Self {
        Channels {
            routes: routes.clone(),
            version: 0,
            targets: HashMap::new(),
        }
    }

    /// Returns the queues of the channel of a message.
    pub(crate) fn of(&mut self, recorded: &Recorded<'_>) -> &Targets {
        let (version, routes) = self.routes.now();
        if version != self.version {
            self.version = version;
            self.forget();
        }
        let found = || Targets::of(&routes, recorded.topic, recorded.schema);
        self.targets.entry(recorded.channel).or_insert_with(found)
    }

    /// Clears the channels: each file has its own channel numbers.
    pub(crate) fn forget(&mut self) {
        self.targets.clear();
    }

    /// Reports a fault to every robot.
    pub(crate) fn report_all(&self, received: Received, fault: &TransportFault) {
        self.routes.report_all(received, fault);
    }
}
