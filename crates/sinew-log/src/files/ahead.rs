//! Read-ahead on another thread while frames are processed.

use super::reader::Progress;
use super::recording::Recording;
use crate::error::LogError;
use crate::frame::Frame;
use std::ops::ControlFlow;
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};

/// Number of frames per batch: short waits on both sides at negligible cost per frame.
const FRAMES: usize = 256;
/// Number of batches in flight.
const BATCHES: usize = 4;

/// Consecutive frames, with the progress in the file.
struct Batch {
    frames: Vec<Frame>,
    /// Number of valid frames, from the first; the others are spare capacity.
    count: usize,
    progress: Progress,
}

impl Batch {
    fn keep(&mut self, frame: &Frame) {
        match self.frames.get_mut(self.count) {
            Some(room) => room.clone_from(frame),
            None => self.frames.push(frame.clone()),
        }
        self.count += 1;
    }
}

impl Recording {
    /// Passes every frame to `take` in order, with the progress in the file, until it breaks or the recording
    /// ends; returns the break value. Another thread reads up to 1024 frames ahead.
    ///
    /// [`Recording::health`] is complete when the recording has ended; after a break it may include frames
    /// that were not passed to `take`.
    ///
    /// # Errors
    /// As [`Recording::next_frame`], after the preceding frames have been passed.
    pub fn each_frame<B>(
        &mut self,
        mut take: impl FnMut(&Frame, Progress) -> ControlFlow<B>,
    ) -> Result<Option<B>, LogError> {
        let (to_use, read) = sync_channel(BATCHES);
        let (to_fill, used) = channel();
        for _ in 0..BATCHES {
            let batch = Batch {
                frames: Vec::new(),
                count: 0,
                progress: self.progress(),
            };
            // The other end is at hand.
            let _ = to_fill.send(batch);
        }
        std::thread::scope(|scope| {
            scope.spawn(|| self.read_into(used, to_use));
            use_from(read, to_fill, &mut take)
        })
    }

    /// Fills batches until the recording ends or the receiver stops.
    fn read_into(&mut self, empty: Receiver<Batch>, full: SyncSender<Result<Batch, LogError>>) {
        while let Ok(mut batch) = empty.recv() {
            batch.count = 0;
            let end = loop {
                if batch.count == FRAMES {
                    break None;
                }
                match self.next_frame() {
                    Ok(Some(frame)) => batch.keep(frame),
                    Ok(None) => break Some(Ok(())),
                    Err(error) => break Some(Err(error)),
                }
            };
            batch.progress = self.progress();
            if full.send(Ok(batch)).is_err() {
                return;
            }
            if let Some(end) = end {
                if let Err(error) = end {
                    // The receiver may have stopped.
                    let _ = full.send(Err(error));
                }
                return;
            }
        }
    }
}

/// Passes the frames of received batches to `take` and returns the batches to be filled again.
fn use_from<B>(
    full: Receiver<Result<Batch, LogError>>,
    empty: Sender<Batch>,
    take: &mut impl FnMut(&Frame, Progress) -> ControlFlow<B>,
) -> Result<Option<B>, LogError> {
    for batch in full {
        let batch = batch?;
        for frame in &batch.frames[..batch.count] {
            if let ControlFlow::Break(answer) = take(frame, batch.progress) {
                return Ok(Some(answer));
            }
        }
        // At the end the batch is not filled again.
        let _ = empty.send(batch);
    }
    Ok(None)
}
