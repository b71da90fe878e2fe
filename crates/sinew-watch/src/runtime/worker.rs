//! Threads that compute estimates, so that core threads need not wait.

use super::health::{Health, lock};
use super::messages::{Control, RobotJob};
use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Instant;

/// Starts the worker threads.
///
/// # Errors
/// Returns the error of the system if a thread cannot be started.
pub(super) fn start(
    count: usize,
    health: &Arc<Health>,
) -> std::io::Result<(Sender<RobotJob>, Vec<JoinHandle<()>>)> {
    let (sender, receiver) = channel::<RobotJob>();
    let receiver = Arc::new(Mutex::new(receiver));
    let threads = (0..count).map(|i| {
        let (receiver, health) = (Arc::clone(&receiver), Arc::clone(health));
        std::thread::Builder::new()
            .name(format!("estimate-{i}"))
            .spawn(move || {
                while let Some(work) = next(&receiver) {
                    if work.job.is_optional() && health.ends.load(Ordering::Relaxed) {
                        work.core.send(Control::Skipped { robot: work.robot });
                        continue;
                    }
                    let begun = Instant::now();
                    let done = work.job.run();
                    health.job(begun.elapsed());
                    work.core.send(Control::JobResult {
                        robot: work.robot,
                        done: Box::new(done),
                    });
                }
            })
    });
    Ok((sender, threads.collect::<Result<_, _>>()?))
}

/// Returns the next job; `None`: no further jobs will arrive.
fn next(receiver: &Mutex<Receiver<RobotJob>>) -> Option<RobotJob> {
    lock(receiver).recv().ok()
}
