//! Threads that make estimates, so that who takes frames needn't.

use super::health::{Health, lock};
use super::messages::{Control, Work};
use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Instant;

/// Starts so many threads.
///
/// # Errors
/// The system has no thread left.
pub(super) fn start(
    count: usize,
    health: &Arc<Health>,
) -> std::io::Result<(Sender<Work>, Vec<JoinHandle<()>>)> {
    let (sender, receiver) = channel::<Work>();
    let receiver = Arc::new(Mutex::new(receiver));
    let threads = (0..count).map(|i| {
        let (receiver, health) = (Arc::clone(&receiver), Arc::clone(health));
        std::thread::Builder::new()
            .name(format!("estimate-{i}"))
            .spawn(move || {
                while let Some(work) = next(&receiver) {
                    if work.job.may_be_left_out() && health.ends.load(Ordering::Relaxed) {
                        work.core.tell(Control::LeftOut { robot: work.robot });
                        continue;
                    }
                    let begun = Instant::now();
                    let done = work.job.run();
                    health.job(begun.elapsed());
                    work.core.tell(Control::Done {
                        robot: work.robot,
                        done: Box::new(done),
                    });
                }
            })
    });
    Ok((sender, threads.collect::<Result<_, _>>()?))
}

/// The next one; `None`: there will be none any more.
fn next(receiver: &Mutex<Receiver<Work>>) -> Option<Work> {
    lock(receiver).recv().ok()
}
