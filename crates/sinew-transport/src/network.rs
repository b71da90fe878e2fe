//! Common part of network transports: tracks publishers and reads the topics that robots require.

use crate::error::{PublisherLoss, TransportFault};
use crate::found::{DomainFound, PublisherFound};
use crate::handle::{Shared, Transport, TransportError};
use crate::look::{Announced, Directory, Look};
use crate::outbox::{Outbox, Sealed};
use crate::publish::{Publisher, Publishing};
use crate::received::{Clock, Received};
use crate::route::{Routes, Targets};
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;
use std::sync::mpsc::Receiver;
use std::time::{Duration, Instant};

/// Interval at which the events of a network are polled without messages.
pub(crate) const POLL_INTERVAL: Duration = Duration::from_millis(100);
/// Waiting time before a network is joined again, initially and at most.
const RETRY_INTERVAL: (Duration, Duration) = (Duration::from_secs(1), Duration::from_secs(30));
/// Time without messages after which a publisher counts as quiet.
const QUIET_TIME: Duration = Duration::from_secs(5);
/// Type of a robot description, which is published once.
const DESCRIPTION: &str = "std_msgs/msg/String";
/// Maximum number of tracked publishers.
pub(crate) const MAX_PUBLISHERS: usize = 4_096;

/// Whether messages of a type are published once, also for late subscribers.
pub(crate) fn is_description(schema: &str) -> bool {
    schema == DESCRIPTION
}

/// Context of a transport thread, independent of the network.
pub(crate) struct Listening {
    pub(crate) routes: Routes,
    pub(crate) clock: Clock,
    pub(crate) outgoing: Receiver<Sealed>,
    pub(crate) directory: Directory,
}

/// Reason for leaving a network.
pub(crate) enum End {
    /// The transport was closed.
    Stopped,
    /// The network cannot be used any more.
    #[cfg(feature = "zenoh")]
    Broken(String),
    /// The civil clock stepped back.
    #[cfg(feature = "dds")]
    ClockWentBack {
        /// Size of the step, s.
        by_s: f64,
    },
}

/// Network and the way to join it.
pub(crate) trait Network: Clone + Send + 'static {
    /// Network that has been joined.
    type Joined<'a>;

    /// Returns the name of the transport, such as `dds:0`.
    fn name(&self) -> String;

    /// Returns the messages that may be published.
    fn publishing(&mut self) -> &mut Publishing;

    /// Rejects invalid options.
    fn check_options(&self) -> Result<(), TransportError> {
        Ok(())
    }

    fn join<'a>(
        &self,
        listening: &'a Listening,
        shared: &'a Shared,
    ) -> Result<Self::Joined<'a>, String>;

    /// Receives until the transport is closed or the network must be joined again.
    fn listen(joined: Self::Joined<'_>) -> End;
}

/// Opens a transport to a network; returns also its publisher and the directory of announcements.
///
/// # Errors
/// Returns an error if an option is invalid or no thread can be started.
pub(crate) fn open(
    network: &impl Network,
    routes: &Routes,
    clock: Clock,
) -> Result<(Transport, Box<dyn Publisher>, Directory), TransportError> {
    network.check_options()?;
    let (mut network, directory) = (network.clone(), Directory::default());
    let (publisher, outgoing) = Outbox::new(*network.publishing());
    let listening = Listening {
        routes: routes.clone(),
        clock,
        outgoing,
        directory: directory.clone(),
    };
    let transport = Transport::run(Shared::new(network.name()), move |shared| {
        keep_open(&network, &listening, shared);
    })?;
    publisher.wakes(&transport);
    Ok((transport, Box::new(publisher), directory))
}

/// Listens to a network for a while and returns the topics and robots found. Publishes nothing.
///
/// # Errors
/// Same as [`open`].
pub(crate) fn discover(
    network: &impl Network,
    clock: Clock,
    length: Duration,
) -> Result<DomainFound, TransportError> {
    let (look, mut network) = (Look::new(), network.clone());
    *network.publishing() = Publishing::DISABLED;
    let (transport, _publisher, directory) = open(&network, look.routes(), clock)?;
    Ok(look.listen(&transport, &directory, length))
}

/// Returns the error of a connection that the network rejected.
pub(crate) fn rejected(network: &impl Network, reason: String) -> TransportError {
    TransportError::Rejected {
        transport: network.name(),
        reason,
    }
}

/// Joins a network, receives, and joins again after a failure, until the transport is closed.
fn keep_open<N: Network>(network: &N, listening: &Listening, shared: &Shared) {
    let mut wait = RETRY_INTERVAL.0;
    // `None`: not tried yet.
    let mut is_open = None;
    while !shared.stops() {
        let reason = match network.join(listening, shared) {
            Ok(joined) => {
                wait = RETRY_INTERVAL.0;
                if is_open != Some(true) {
                    is_open = Some(true);
                    shared.set_disconnected(None);
                    let transport = shared.name().to_owned();
                    let now = listening.clock.now();
                    listening
                        .routes
                        .report_all(now, &TransportFault::Connected { transport });
                }
                let ended = N::listen(joined);
                listening.directory.change(Vec::clear);
                match ended {
                    End::Stopped => break,
                    #[cfg(feature = "dds")]
                    End::ClockWentBack { by_s } => {
                        let fault = TransportFault::ClockWentBack { by_s };
                        let now = listening.clock.now();
                        listening.routes.report_all(now, &fault);
                        continue;
                    }
                    #[cfg(feature = "zenoh")]
                    End::Broken(reason) => reason,
                }
            }
            Err(reason) => reason,
        };
        shared.set_disconnected(Some(reason.clone()));
        if is_open != Some(false) {
            is_open = Some(false);
            let transport = shared.name().to_owned();
            let fault = TransportFault::Disconnected { transport, reason };
            listening.routes.report_all(listening.clock.now(), &fault);
        }
        let until = Instant::now() + wait;
        while !shared.stops() && Instant::now() < until {
            std::thread::park_timeout(POLL_INTERVAL);
        }
        wait = (2 * wait).min(RETRY_INTERVAL.1);
    }
}

/// Function that subscribes to a topic of a name and a type.
pub(crate) type Open<'o, R> = dyn FnMut(&str, &str, &Arc<Targets>) -> Result<R, String> + 'o;

/// Reader of one topic.
pub(crate) trait Reader: Sized {
    /// Sets the queues that receive its messages from now on.
    fn aim(&mut self, targets: &Arc<Targets>);
}

/// Subscribed topic with its reader.
pub(crate) struct Subscription<R> {
    pub(crate) reader: R,
    pub(crate) topic: String,
    pub(crate) targets: Arc<Targets>,
    schema: String,
    /// Time since which a publisher exists without a message; `None`: a message arrived, or the fault was reported.
    quiet_since: Option<Instant>,
}

impl<R> Subscription<R> {
    /// Registers the number of messages since the last call.
    pub(crate) fn count_received(&mut self, messages: usize, now: Received) {
        let is_quiet = |since: &mut Instant| since.elapsed() > QUIET_TIME;
        if messages > 0 {
            self.quiet_since = None;
        } else if self.quiet_since.take_if(is_quiet).is_some() {
            let topic = self.topic.clone();
            let for_s = QUIET_TIME.as_secs_f64();
            let quiet = TransportFault::Quiet { topic, for_s };
            self.targets.fault(now, &quiet);
        }
    }
}

/// Publisher that was announced.
pub(crate) struct Writing {
    pub(crate) topic: String,
    pub(crate) schema: String,
}

/// Subscribed topics and known publishers.
pub(crate) struct Topics<R> {
    /// Subscriptions by name and type.
    subscriptions: BTreeMap<(String, String), Subscription<R>>,
    /// Publishers by identity.
    writing: HashMap<String, Writing>,
    routes_version: u64,
}

impl<R: Reader> Topics<R> {
    pub(crate) fn new(routes: &Routes) -> Self {
        Topics {
            subscriptions: BTreeMap::new(),
            writing: HashMap::new(),
            routes_version: routes.now().0,
        }
    }

    pub(crate) fn subscriptions(&mut self) -> impl Iterator<Item = &mut Subscription<R>> {
        self.subscriptions.values_mut()
    }

    #[cfg(feature = "dds")]
    pub(crate) fn writing(&self, id: &str) -> Option<&Writing> {
        self.writing.get(id)
    }

    #[cfg(feature = "dds")]
    pub(crate) fn ids(&self) -> impl Iterator<Item = &str> {
        self.writing.keys().map(String::as_str)
    }

    /// Applies a changed configuration of robots.
    pub(crate) fn follow_routes(&mut self, listening: &Listening, open: &mut Open<'_, R>) {
        let (version, routes) = listening.routes.now();
        if version == self.routes_version {
            return;
        }
        self.routes_version = version;
        self.subscriptions.retain(|_, subscription| {
            let targets = Targets::of(&routes, &subscription.topic, &subscription.schema);
            subscription.targets = Arc::new(targets);
            subscription.reader.aim(&subscription.targets);
            !subscription.targets.is_empty()
        });
        let existing = self.writing.values();
        let existing = existing.map(|w| (w.topic.clone(), w.schema.clone()));
        for (topic, schema) in Vec::from_iter(existing) {
            self.read(listening, &topic, &schema, open);
        }
    }

    /// Registers a publisher with the display name `named`. Its topic is subscribed to if a robot requires it.
    pub(crate) fn found(
        &mut self,
        listening: &Listening,
        (topic, schema): (String, String),
        publisher: PublisherFound,
        named: String,
        open: &mut Open<'_, R>,
    ) {
        let id = publisher.id.clone();
        let is_new = !self.writing.contains_key(&id);
        if is_new && self.writing.len() >= MAX_PUBLISHERS {
            return;
        }
        let writing = Writing {
            topic: topic.clone(),
            schema: schema.clone(),
        };
        self.writing.insert(id, writing);
        listening.directory.change(|all| {
            all.retain(|entry| entry.publisher.id != publisher.id);
            all.push(Announced {
                topic: topic.clone(),
                schema: schema.clone(),
                publisher,
            });
        });
        self.read(listening, &topic, &schema, open);
        if !is_new {
            return;
        }
        let now = listening.clock.now();
        match self.subscriptions.get_mut(&(topic.clone(), schema.clone())) {
            Some(subscription) => {
                subscription.quiet_since = (!is_description(&schema)).then(Instant::now);
                let publisher = named;
                let fault = TransportFault::PublisherFound { topic, publisher };
                subscription.targets.fault(now, &fault);
            }
            None => {
                let routes = listening.routes.now().1;
                for route in routes.iter().filter(|route| route.expects(&topic)) {
                    let (topic, found) = (topic.clone(), schema.clone());
                    let fault = TransportFault::WrongType { topic, found };
                    route.sender().fault(now, fault);
                }
            }
        }
    }

    /// Removes a publisher.
    pub(crate) fn lost(
        &mut self,
        listening: &Listening,
        id: &str,
        named: String,
        how: PublisherLoss,
    ) {
        let Some(writing) = self.writing.remove(id) else {
            return;
        };
        listening
            .directory
            .change(|all| all.retain(|entry| entry.publisher.id != id));
        let fault = TransportFault::PublisherLost {
            topic: writing.topic.clone(),
            publisher: named,
            how,
        };
        self.report(&writing.topic, &writing.schema, listening, &fault);
    }

    /// Reports a fault to the robots that read a topic.
    pub(crate) fn report(
        &self,
        topic: &str,
        schema: &str,
        listening: &Listening,
        fault: &TransportFault,
    ) {
        let key = (topic.to_owned(), schema.to_owned());
        if let Some(subscription) = self.subscriptions.get(&key) {
            subscription.targets.fault(listening.clock.now(), fault);
        }
    }

    fn read(&mut self, listening: &Listening, topic: &str, schema: &str, open: &mut Open<'_, R>) {
        let key = (topic.to_owned(), schema.to_owned());
        if self.subscriptions.contains_key(&key) {
            return;
        }
        let targets = Arc::new(Targets::of(&listening.routes.now().1, topic, schema));
        if targets.is_empty() {
            return;
        }
        match open(topic, schema, &targets) {
            Ok(reader) => {
                let subscription = Subscription {
                    reader,
                    topic: topic.to_owned(),
                    schema: schema.to_owned(),
                    targets,
                    quiet_since: None,
                };
                self.subscriptions.insert(key, subscription);
            }
            Err(reason) => {
                let fault = TransportFault::Unreadable {
                    topic: topic.to_owned(),
                    messages: 0,
                    reason,
                };
                targets.fault(listening.clock.now(), &fault);
            }
        }
    }
}
