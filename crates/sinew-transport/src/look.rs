//! Discovery of a network: all announced topics, with the content of those that can be decoded.

use crate::error::TransportFault;
use crate::found::{DomainFound, PublisherFound, TopicFound};
use crate::handle::{Transport, lock};
use crate::inbox::{Batch, Inbox, Item, QueueLimits, RobotId};
use crate::route::{Route, Routes};
use sinew_log::TopicInfo;
use sinew_log::live::{TopicDiscovery, TopicId};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Topic with one of its publishers, as announced by a network.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Announced {
    pub(crate) topic: String,
    pub(crate) schema: String,
    pub(crate) publisher: PublisherFound,
}

/// Present announcements of a network, kept up to date by the transport threads.
#[derive(Debug, Clone, Default)]
pub(crate) struct Directory {
    shared: Arc<Mutex<Vec<Announced>>>,
}

impl Directory {
    pub(crate) fn change<R>(&self, change: impl FnOnce(&mut Vec<Announced>) -> R) -> R {
        change(&mut lock(&self.shared))
    }
}

/// Discovery on a transport: receives every topic that can be decoded.
pub(crate) struct Look {
    inbox: Inbox,
    robot: RobotId,
    routes: Routes,
}

impl Look {
    pub(crate) fn new() -> Self {
        let inbox = Inbox::new();
        let limits = QueueLimits {
            messages: 16_384,
            bytes: 32 << 20,
        };
        let (robot, sender) = inbox.robot(limits);
        let routes = Routes::new(vec![Route::of_everything(sender)]);
        Look {
            inbox,
            robot,
            routes,
        }
    }

    pub(crate) fn routes(&self) -> &Routes {
        &self.routes
    }

    /// Listens for a while and returns the result.
    pub(crate) fn listen(
        &self,
        transport: &Transport,
        directory: &Directory,
        length: Duration,
    ) -> DomainFound {
        let mut census = TopicDiscovery::default();
        let mut topics: Vec<Option<TopicId>> = Vec::new();
        let mut faults = Vec::new();
        let mut batch = Batch::default();
        let begun = Instant::now();
        while begun.elapsed() < length {
            let left = length.saturating_sub(begun.elapsed());
            if self
                .inbox
                .wait(left.min(Duration::from_millis(100)))
                .is_none()
            {
                continue;
            }
            self.inbox.take(self.robot, &mut batch);
            for item in batch.items() {
                match item {
                    Item::Topic {
                        topic,
                        name,
                        schema,
                    } => {
                        topics.resize(topics.len().max(topic.index() + 1), None);
                        topics[topic.index()] = census.topic(name, schema);
                    }
                    Item::Message {
                        topic,
                        received,
                        cdr,
                        ..
                    } => {
                        let id = topics.get(topic.index()).copied().flatten();
                        if let Some(id) = id {
                            census.push(id, cdr, received.monotonic_ns);
                        }
                    }
                    Item::Fault { fault, .. } => {
                        let is_coming = matches!(
                            fault,
                            TransportFault::PublisherFound { .. }
                                | TransportFault::Connected { .. }
                        );
                        if !is_coming && !faults.contains(fault) {
                            faults.push(fault.clone());
                        }
                    }
                }
            }
        }
        let announced = directory.change(|all| all.clone());
        for one in &announced {
            census.topic(&one.topic, &one.schema);
        }
        let found = |topic: TopicInfo| {
            let of_topic = announced
                .iter()
                .filter(|a| a.topic == topic.name && a.schema == topic.kind);
            TopicFound {
                publishers: of_topic.map(|a| a.publisher.clone()).collect(),
                topic,
            }
        };
        DomainFound {
            transport: transport.status().name,
            listened_s: begun.elapsed().as_secs_f64(),
            topics: census.topics().into_iter().map(found).collect(),
            robots: census.robots(),
            faults,
        }
    }
}
