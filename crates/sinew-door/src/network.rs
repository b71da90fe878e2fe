//! What doors to a network do alike: publishers come and go, and what some robot wants is read.

use crate::found::{DomainFound, PublisherFound};
use crate::handle::{Door, DoorError, Shared};
use crate::look::{Announced, Directory, Look};
use crate::outbox::{Outbox, Sealed};
use crate::publish::{Publisher, Publishing};
use crate::received::{Clock, Received};
use crate::route::{Routes, Targets};
use crate::trouble::{Lost, Trouble};
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;
use std::sync::mpsc::Receiver;
use std::time::{Duration, Instant};

/// Without a message a network's events are looked at so often.
pub(crate) const IDLE: Duration = Duration::from_millis(100);
/// A network that can't be used is tried again after so long, at first and at most.
const TRY_AGAIN: (Duration, Duration) = (Duration::from_secs(1), Duration::from_secs(30));
/// A publisher of which nothing comes for so long is quiet.
const QUIET: Duration = Duration::from_secs(5);
/// The type of a robot's description, which is published once.
const DESCRIPTION: &str = "std_msgs/msg/String";
/// Publishers remembered at most.
pub(crate) const PUBLISHERS_MOST: usize = 4_096;

/// Whether messages of a type are published once, for whoever comes later too.
pub(crate) fn is_description(schema: &str) -> bool {
    schema == DESCRIPTION
}

/// What a door's thread has, whatever its network.
pub(crate) struct Listening {
    pub(crate) routes: Routes,
    pub(crate) clock: Clock,
    pub(crate) outgoing: Receiver<Sealed>,
    pub(crate) directory: Directory,
}

/// Why a network is left.
pub(crate) enum End {
    /// The door is shut.
    Stopped,
    /// It can't be used any more.
    #[cfg(feature = "zenoh")]
    Broken(String),
    /// The civil clock went back.
    #[cfg(feature = "dds")]
    ClockWentBack {
        /// By so much, s.
        by_s: f64,
    },
}

/// Which network, and how it is joined.
pub(crate) trait Network: Clone + Send + 'static {
    /// The network while it is joined.
    type Joined<'a>;

    /// Such as `dds:0`.
    fn name(&self) -> String;

    /// What may be published.
    fn publishing(&mut self) -> &mut Publishing;

    /// Refuses options that can't be.
    fn refuse(&self) -> Result<(), DoorError> {
        Ok(())
    }

    fn join<'a>(
        &self,
        listening: &'a Listening,
        shared: &'a Shared,
    ) -> Result<Self::Joined<'a>, String>;

    /// Until the door is shut, or the network must be joined again.
    fn listen(joined: Self::Joined<'_>) -> End;
}

/// Opens a door to a network; its way out, and what the network announces.
///
/// # Errors
/// Options that can't be; no thread can be started.
pub(crate) fn open(
    network: &impl Network,
    routes: &Routes,
    clock: Clock,
) -> Result<(Door, Box<dyn Publisher>, Directory), DoorError> {
    network.refuse()?;
    let (mut network, directory) = (network.clone(), Directory::default());
    let (publisher, outgoing) = Outbox::new(*network.publishing());
    let listening = Listening {
        routes: routes.clone(),
        clock,
        outgoing,
        directory: directory.clone(),
    };
    let door = Door::run(Shared::new(network.name()), move |shared| {
        keep_open(&network, &listening, shared);
    })?;
    publisher.wakes(&door);
    Ok((door, Box::new(publisher), directory))
}

/// Listens to a network for a while and finds what there is. Publishes nothing.
///
/// # Errors
/// As [`open`].
pub(crate) fn discover(
    network: &impl Network,
    clock: Clock,
    length: Duration,
) -> Result<DomainFound, DoorError> {
    let (look, mut network) = (Look::new(), network.clone());
    *network.publishing() = Publishing::NOTHING;
    let (door, _publisher, directory) = open(&network, look.routes(), clock)?;
    Ok(look.listen(&door, &directory, length))
}

/// What a network refused.
pub(crate) fn refused(network: &impl Network, why: String) -> DoorError {
    DoorError::Refused {
        door: network.name(),
        why,
    }
}

/// Joins a network, listens, and joins again after it broke, until the door is shut.
fn keep_open<N: Network>(network: &N, listening: &Listening, shared: &Shared) {
    let mut wait = TRY_AGAIN.0;
    // `None`: it wasn't tried yet.
    let mut is_open = None;
    while !shared.stops() {
        let why = match network.join(listening, shared) {
            Ok(joined) => {
                wait = TRY_AGAIN.0;
                if is_open != Some(true) {
                    is_open = Some(true);
                    shared.set_shut(None);
                    let door = shared.name().to_owned();
                    let now = listening.clock.now();
                    listening.routes.tell_all(now, &Trouble::Open { door });
                }
                let ended = N::listen(joined);
                listening.directory.change(Vec::clear);
                match ended {
                    End::Stopped => break,
                    #[cfg(feature = "dds")]
                    End::ClockWentBack { by_s } => {
                        let trouble = Trouble::ClockWentBack { by_s };
                        let now = listening.clock.now();
                        listening.routes.tell_all(now, &trouble);
                        continue;
                    }
                    #[cfg(feature = "zenoh")]
                    End::Broken(why) => why,
                }
            }
            Err(why) => why,
        };
        shared.set_shut(Some(why.clone()));
        if is_open != Some(false) {
            is_open = Some(false);
            let door = shared.name().to_owned();
            let shut = Trouble::Shut { door, why };
            listening.routes.tell_all(listening.clock.now(), &shut);
        }
        let until = Instant::now() + wait;
        while !shared.stops() && Instant::now() < until {
            std::thread::park_timeout(IDLE);
        }
        wait = (2 * wait).min(TRY_AGAIN.1);
    }
}

/// Begins to read a topic of a name and a type.
pub(crate) type Open<'o, R> = dyn FnMut(&str, &str, &Arc<Targets>) -> Result<R, String> + 'o;

/// What reads a topic.
pub(crate) trait Reader: Sized {
    /// Where its messages go from now on.
    fn aim(&mut self, targets: &Arc<Targets>);
}

/// A topic that is read.
pub(crate) struct Reading<R> {
    pub(crate) reader: R,
    pub(crate) topic: String,
    pub(crate) targets: Arc<Targets>,
    schema: String,
    /// Since when somebody publishes it and nothing came; `None`: something did, or it was said.
    quiet_since: Option<Instant>,
}

impl<R> Reading<R> {
    /// So many messages came since the last time.
    pub(crate) fn heard(&mut self, messages: usize, now: Received) {
        let is_quiet = |since: &mut Instant| since.elapsed() > QUIET;
        if messages > 0 {
            self.quiet_since = None;
        } else if self.quiet_since.take_if(is_quiet).is_some() {
            let topic = self.topic.clone();
            let for_s = QUIET.as_secs_f64();
            let quiet = Trouble::Quiet { topic, for_s };
            self.targets.trouble(now, &quiet);
        }
    }
}

/// A publisher that was announced.
pub(crate) struct Writing {
    pub(crate) topic: String,
    pub(crate) schema: String,
}

/// Topics that are read, and who publishes.
pub(crate) struct Topics<R> {
    /// By name and type.
    readings: BTreeMap<(String, String), Reading<R>>,
    /// By the publisher's identity.
    writing: HashMap<String, Writing>,
    routes_version: u64,
}

impl<R: Reader> Topics<R> {
    pub(crate) fn new(routes: &Routes) -> Self {
        Topics {
            readings: BTreeMap::new(),
            writing: HashMap::new(),
            routes_version: routes.now().0,
        }
    }

    pub(crate) fn readings(&mut self) -> impl Iterator<Item = &mut Reading<R>> {
        self.readings.values_mut()
    }

    #[cfg(feature = "dds")]
    pub(crate) fn writing(&self, id: &str) -> Option<&Writing> {
        self.writing.get(id)
    }

    #[cfg(feature = "dds")]
    pub(crate) fn ids(&self) -> impl Iterator<Item = &str> {
        self.writing.keys().map(String::as_str)
    }

    /// Robots that were configured anew.
    pub(crate) fn follow_routes(&mut self, listening: &Listening, open: &mut Open<'_, R>) {
        let (version, routes) = listening.routes.now();
        if version == self.routes_version {
            return;
        }
        self.routes_version = version;
        self.readings.retain(|_, reading| {
            let targets = Targets::of(&routes, &reading.topic, &reading.schema);
            reading.targets = Arc::new(targets);
            reading.reader.aim(&reading.targets);
            !reading.targets.is_empty()
        });
        let known = self.writing.values();
        let known = known.map(|w| (w.topic.clone(), w.schema.clone()));
        for (topic, schema) in Vec::from_iter(known) {
            self.read(listening, &topic, &schema, open);
        }
    }

    /// A publisher is there, `named` in words. Its topic is read from now on, where some robot wants it.
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
        if is_new && self.writing.len() >= PUBLISHERS_MOST {
            return;
        }
        let writing = Writing {
            topic: topic.clone(),
            schema: schema.clone(),
        };
        self.writing.insert(id, writing);
        listening.directory.change(|all| {
            all.retain(|known| known.publisher.id != publisher.id);
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
        match self.readings.get_mut(&(topic.clone(), schema.clone())) {
            Some(reading) => {
                reading.quiet_since = (!is_description(&schema)).then(Instant::now);
                let publisher = named;
                let trouble = Trouble::PublisherFound { topic, publisher };
                reading.targets.trouble(now, &trouble);
            }
            None => {
                let routes = listening.routes.now().1;
                for route in routes.iter().filter(|route| route.expects(&topic)) {
                    let (topic, found) = (topic.clone(), schema.clone());
                    let trouble = Trouble::WrongType { topic, found };
                    route.sender().trouble(now, trouble);
                }
            }
        }
    }

    /// A publisher is gone.
    pub(crate) fn lost(&mut self, listening: &Listening, id: &str, named: String, how: Lost) {
        let Some(writing) = self.writing.remove(id) else {
            return;
        };
        listening
            .directory
            .change(|all| all.retain(|known| known.publisher.id != id));
        let trouble = Trouble::PublisherLost {
            topic: writing.topic.clone(),
            publisher: named,
            how,
        };
        self.tell(&writing.topic, &writing.schema, listening, &trouble);
    }

    /// Says something to the robots that read a topic.
    pub(crate) fn tell(&self, topic: &str, schema: &str, listening: &Listening, trouble: &Trouble) {
        let key = (topic.to_owned(), schema.to_owned());
        if let Some(reading) = self.readings.get(&key) {
            reading.targets.trouble(listening.clock.now(), trouble);
        }
    }

    fn read(&mut self, listening: &Listening, topic: &str, schema: &str, open: &mut Open<'_, R>) {
        let key = (topic.to_owned(), schema.to_owned());
        if self.readings.contains_key(&key) {
            return;
        }
        let targets = Arc::new(Targets::of(&listening.routes.now().1, topic, schema));
        if targets.is_empty() {
            return;
        }
        match open(topic, schema, &targets) {
            Ok(reader) => {
                let reading = Reading {
                    reader,
                    topic: topic.to_owned(),
                    schema: schema.to_owned(),
                    targets,
                    quiet_since: None,
                };
                self.readings.insert(key, reading);
            }
            Err(why) => {
                let trouble = Trouble::Unreadable {
                    topic: topic.to_owned(),
                    messages: 0,
                    why,
                };
                targets.trouble(listening.clock.now(), &trouble);
            }
        }
    }
}
