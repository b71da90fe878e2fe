//! Which robot gets the messages of which topic.

use crate::handle::{Shared, lock};
use crate::inbox::{Sender, TopicKey};
use crate::received::Received;
use crate::records::Recorded;
use crate::trouble::Trouble;
use sinew_log::live::{Census, LiveOptions, OVERLOOKED_MOST, TopicFilter};
use std::collections::{BTreeSet, HashMap};
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// A robot behind a door.
#[derive(Debug, Clone)]
pub struct Route {
    sender: Sender,
    /// `None`: whatever can be looked into.
    filter: Option<TopicFilter>,
    /// Topics announced that it doesn't want.
    overlooked: Arc<Mutex<BTreeSet<String>>>,
}

impl Route {
    /// Messages that are of use with these options go to this queue.
    pub fn new(sender: Sender, options: &LiveOptions) -> Self {
        Route {
            sender,
            filter: Some(TopicFilter::new(options)),
            overlooked: Arc::default(),
        }
    }

    /// Everything that can be looked into.
    #[cfg(any(feature = "dds", feature = "zenoh"))]
    pub(crate) fn of_everything(sender: Sender) -> Self {
        Route {
            sender,
            filter: None,
            overlooked: Arc::default(),
        }
    }

    /// Announces a topic with joint states that no robot wants: a name that is asked for may be written wrong.
    fn overlook(&self, topic: &str, schema: &str) {
        let mut known = lock(&self.overlooked);
        if known.len() < OVERLOOKED_MOST && known.insert(topic.to_owned()) {
            let _without_messages = self.sender.topic(topic, schema);
        }
    }

    /// Returns the sender of its queue.
    pub fn sender(&self) -> &Sender {
        &self.sender
    }

    /// Whether messages of a topic may be of use to the robot.
    pub fn wants(&self, topic: &str, schema: &str) -> bool {
        match &self.filter {
            Some(filter) => filter.wants(topic, schema),
            None => Census::reads(topic, schema),
        }
    }

    /// Whether a topic has a name that is looked for, whatever its type.
    pub fn expects(&self, topic: &str) -> bool {
        self.filter.as_ref().is_some_and(|f| f.expects(topic))
    }
}

/// The robots behind a door; a configuration that is read again replaces them while it stands open.
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

    /// These robots from now on. Topics that none of them wants any more are left; no message of the others is lost.
    pub fn replace(&self, routes: Vec<Route>) {
        let mut shared = lock(&self.shared);
        shared.0 += 1;
        shared.1 = routes.into();
    }

    /// The robots, and a number that changes with them.
    pub fn now(&self) -> (u64, Arc<[Route]>) {
        let shared = lock(&self.shared);
        (shared.0, Arc::clone(&shared.1))
    }

    /// Says something to every robot.
    pub(crate) fn tell_all(&self, received: Received, trouble: &Trouble) {
        for route in self.now().1.iter() {
            route.sender().trouble(received, trouble.clone());
        }
    }
}

/// Queues that get the messages of one topic, and its keys there.
#[derive(Debug, Clone, Default)]
pub(crate) struct Targets {
    all: Vec<(Sender, TopicKey)>,
}

impl Targets {
    /// The robots that want the topic; it is announced to them.
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

    /// Waits until a message of this length would not fill a queue: nothing is lost of a file. Returns `false` where the
    /// door shall be shut first.
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
    pub(crate) fn trouble(&self, received: Received, trouble: &Trouble) {
        for (sender, _) in &self.all {
            sender.trouble(received, trouble.clone());
        }
    }
}

/// The queues that the channels of a recording go to, found anew whenever the routes change.
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

    /// The queues of a message's channel.
    pub(crate) fn of(&mut self, recorded: &Recorded<'_>) -> &Targets {
        let (version, routes) = self.routes.now();
        if version != self.version {
            self.version = version;
            self.forget();
        }
        let found = || Targets::of(&routes, recorded.topic, recorded.schema);
        self.targets.entry(recorded.channel).or_insert_with(found)
    }

    /// Forgets the channels: each file numbers its own.
    pub(crate) fn forget(&mut self) {
        self.targets.clear();
    }

    /// Says something to every robot.
    pub(crate) fn tell_all(&self, received: Received, trouble: &Trouble) {
        self.routes.tell_all(received, trouble);
    }
}
