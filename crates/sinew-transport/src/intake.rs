//! Assembly of frames from the queue of a robot.

use crate::error::TransportFault;
use crate::inbox::{Batch, Item};
use crate::received::Received;
use sinew_log::live::{Live, LiveOptions, TopicId};
use sinew_log::{Frame, LogError};

/// Assembles frames from the messages of the queue of a robot.
#[derive(Debug)]
pub struct FrameAssembler {
    live: Live,
    /// Topic of the assembler by index of the queue's topic; `None`: not used.
    topics: Vec<Option<TopicId>>,
    dropped: u64,
}

/// Content of a batch.
#[derive(Debug)]
pub enum BatchContent<'a> {
    /// Completed frame, with the time of reception of the message that completed it.
    Frame {
        /// Time of reception, by both clocks.
        received: Received,
        /// Frame of all joints.
        frame: &'a Frame,
    },
    /// Fault of a transport, or its end.
    Fault {
        /// Time of reception, by both clocks.
        received: Received,
        /// Fault, or its end.
        fault: &'a TransportFault,
    },
    /// Messages dropped because the queue was full; a new segment begins.
    Dropped {
        /// Number of missing messages.
        messages: u64,
    },
}

impl FrameAssembler {
    /// Creates an assembler without messages.
    ///
    /// # Errors
    /// Same as [`Live::new`].
    pub fn new(options: &LiveOptions) -> Result<Self, LogError> {
        Ok(FrameAssembler {
            live: Live::new(options)?,
            topics: Vec::new(),
            dropped: 0,
        })
    }

    /// Processes a batch; `on` receives its contents in their order.
    pub fn feed(&mut self, batch: &Batch, mut on: impl FnMut(BatchContent<'_>)) {
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
                        on(BatchContent::Frame { received, frame });
                    }
                }
                Item::Fault { received, fault } => on(BatchContent::Fault { received, fault }),
            }
        }
        if batch.dropped() > 0 {
            self.dropped += batch.dropped();
            self.silence(last, &mut on);
            on(BatchContent::Dropped {
                messages: batch.dropped(),
            });
        }
    }

    /// Completes the pending frames when no further message arrives; the next message begins a new segment.
    pub fn silence(&mut self, received: Received, mut on: impl FnMut(BatchContent<'_>)) {
        self.live.silence();
        while let Some(frame) = self.live.frame() {
            on(BatchContent::Frame { received, frame });
        }
    }

    /// Returns the estimator input: selection of topics, health, robot description.
    pub fn live(&self) -> &Live {
        &self.live
    }

    /// Returns the number of messages dropped so far because of a full queue.
    pub fn dropped(&self) -> u64 {
        self.dropped
    }
}
