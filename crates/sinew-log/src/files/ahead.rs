//! Reading on while what has been read is used.

use super::reader::Progress;
use super::recording::Recording;
use crate::error::LogError;
use crate::frame::Frame;
use std::ops::ControlFlow;
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};

/// Frames handed over at once: often enough that neither side waits long, seldom enough that handing
/// over costs nothing.
const FRAMES: usize = 256;
/// Batches under way.
const BATCHES: usize = 4;

/// Frames in a row, and how far the file had been read with them.
struct Batch {
    frames: Vec<Frame>,
    /// So many of them, from the first, are read; the others are room.
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
    /// Hands every frame to `take` in order, with how far the file has been read, until it breaks or
    /// the recording ends; the answer is what it broke with. Another thread reads ahead meanwhile, by
    /// 1024 frames at most.
    ///
    /// [`Recording::health`] is complete when the recording has ended; after a break it may know
    /// of frames that `take` wasn't given.
    ///
    /// # Errors
    /// As [`Recording::next_frame`], once the frames before have been handed over.
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

    /// Fills batches until the recording or the interest in it ends.
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
                    // Whoever has gone by now has no use for it.
                    let _ = full.send(Err(error));
                }
                return;
            }
        }
    }
}

/// Hands out what was read, and what held it back to be filled.
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
        // At the end nobody fills it any more.
        let _ = empty.send(batch);
    }
    Ok(None)
}
