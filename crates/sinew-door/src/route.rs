//! Which robot gets the messages of which topic.

use crate::inbox::{Sender, TopicKey};
use crate::received::Received;
use crate::trouble::Trouble;
use sinew_log::live::{Census, LiveOptions, OVERLOOKED_MOST, TopicFilter};
use std::collections::BTreeSet;
use std::sync::{Arc, Mutex, PoisonError};

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
        let mut known = self
            .overlooked
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        if known.len() < OVERLOOKED_MOST && known.insert(topic.to_owned()) {
            let _without_messages = self.sender.topic(topic, schema);
        }
    }

    /// Its queue.
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
    /// These robots.
    pub fn new(routes: Vec<Route>) -> Self {
        let all = Self::default();
        all.replace(routes);
        all
    }

    /// These robots from now on. Topics that none of them wants any more are left; no message of the others is lost.
    pub fn replace(&self, routes: Vec<Route>) {
        let mut shared = self.shared.lock().unwrap_or_else(PoisonError::into_inner);
        shared.0 += 1;
        shared.1 = routes.into();
    }

    /// The robots, and a number that changes with them.
    pub fn now(&self) -> (u64, Arc<[Route]>) {
        let shared = self.shared.lock().unwrap_or_else(PoisonError::into_inner);
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

    /// Whether a message of this length would not fill a queue: what is read from a file waits until it fits.
    pub(crate) fn have_room(&self, bytes: usize) -> bool {
        self.all.iter().all(|(sender, _)| sender.has_room(bytes))
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
