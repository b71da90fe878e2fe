//! A look at a network: everything that is announced, and what can be looked into.

use crate::found::{DomainFound, PublisherFound, TopicFound};
use crate::handle::{Door, lock};
use crate::inbox::{Batch, Inbox, Item, QueueLimits, RobotId};
use crate::route::{Route, Routes};
use crate::trouble::Trouble;
use sinew_log::TopicInfo;
use sinew_log::live::{Census, TopicId};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// A topic and one who publishes it, as a network announces them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Announced {
    pub(crate) topic: String,
    pub(crate) schema: String,
    pub(crate) publisher: PublisherFound,
}

/// What a network announces now; door threads keep it up to date.
#[derive(Debug, Clone, Default)]
pub(crate) struct Directory {
    shared: Arc<Mutex<Vec<Announced>>>,
}

impl Directory {
    pub(crate) fn change<R>(&self, change: impl FnOnce(&mut Vec<Announced>) -> R) -> R {
        change(&mut lock(&self.shared))
    }
}

/// A door of which everything is of interest, while it is looked at.
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

    /// Listens for a while.
    pub(crate) fn listen(
        &self,
        door: &Door,
        directory: &Directory,
        length: Duration,
    ) -> DomainFound {
        let mut census = Census::default();
        let mut topics: Vec<Option<TopicId>> = Vec::new();
        let mut troubles = Vec::new();
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
                    Item::Trouble { trouble, .. } => {
                        let is_coming = matches!(
                            trouble,
                            Trouble::PublisherFound { .. } | Trouble::Open { .. }
                        );
                        if !is_coming && !troubles.contains(trouble) {
                            troubles.push(trouble.clone());
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
            door: door.status().name,
            listened_s: begun.elapsed().as_secs_f64(),
            topics: census.topics().into_iter().map(found).collect(),
            robots: census.robots(),
            troubles,
        }
    }
}
