//! From a robot's queue to frames.

use crate::inbox::{Batch, Item};
use crate::received::Received;
use crate::trouble::Trouble;
use sinew_log::live::{Live, LiveOptions, TopicId};
use sinew_log::{Frame, LogError};

/// Makes frames of what a robot's queue brings.
#[derive(Debug)]
pub struct Intake {
    live: Live,
    /// At the places of the queue's topics; `None`: not of use.
    topics: Vec<Option<TopicId>>,
    dropped: u64,
}

/// What a batch held.
#[derive(Debug)]
pub enum Taken<'a> {
    /// A frame that may leave, and when the message came that let it.
    Frame {
        /// When it was received, by both clocks.
        received: Received,
        /// The frame of all joints.
        frame: &'a Frame,
    },
    /// Something is wrong, or is right again.
    Trouble {
        /// When it was received, by both clocks.
        received: Received,
        /// What is wrong, or is right again.
        trouble: &'a Trouble,
    },
    /// The queue was full: so many messages are missing here, and a new segment begins.
    Dropped {
        /// Messages that are missing.
        messages: u64,
    },
}

impl Intake {
    /// Nothing came yet.
    ///
    /// # Errors
    /// As [`Live::new`].
    pub fn new(options: &LiveOptions) -> Result<Self, LogError> {
        Ok(Intake {
            live: Live::new(options)?,
            topics: Vec::new(),
            dropped: 0,
        })
    }

    /// Takes a batch in; `on` gets what comes of it, in its order.
    pub fn feed(&mut self, batch: &Batch, mut on: impl FnMut(Taken<'_>)) {
        let mut last = Received::default();
        for item in batch.items() {
            match item {
                Item::Topic {
                    topic,
                    name,
                    schema,
                } => {
                    let id = self.live.topic(name, schema);
                    let index = topic.index();
                    if self.topics.len() <= index {
                        self.topics.resize(index + 1, None);
                    }
                    self.topics[index] = id;
                }
                Item::Message {
                    topic,
                    received,
                    source_ns,
                    cdr,
                } => {
                    last = received;
                    let id = self.topics.get(topic.index()).copied().flatten();
                    if let Some(id) = id {
                        self.live.push(id, cdr, source_ns);
                    }
                    while let Some(frame) = self.live.frame() {
                        on(Taken::Frame { received, frame });
                    }
                }
                Item::Trouble { received, trouble } => on(Taken::Trouble { received, trouble }),
            }
        }
        if batch.dropped() > 0 {
            self.dropped += batch.dropped();
            self.silence(last, &mut on);
            on(Taken::Dropped {
                messages: batch.dropped(),
            });
        }
    }

    /// Nothing comes any more: what is held is handed out; what comes next begins a new segment.
    pub fn silence(&mut self, received: Received, mut on: impl FnMut(Taken<'_>)) {
        self.live.silence();
        while let Some(frame) = self.live.frame() {
            on(Taken::Frame { received, frame });
        }
    }

    /// What makes the frames: choice of topics, health, the robot's description.
    pub fn live(&self) -> &Live {
        &self.live
    }

    /// Messages dropped so far since the queue was full.
    pub fn dropped(&self) -> u64 {
        self.dropped
    }
}
