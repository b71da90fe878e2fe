//! Online estimate in a control loop: samples in, answers out; a step does not allocate, lock or wait.
//!
//! The loop converts samples to blocks and passes them through a ring buffer to a worker; the worker owns the
//! [`Window`] and returns answers through a triple buffer. The worker runs in a separate thread
//! ([`OnlineEstimator::start_worker`]), or in a thread of the caller, which calls [`OnlineWorker::work`] outside its
//! loop.

use super::answer::OnlineAnswer;
use super::window::Window;
use crate::baseline::Baseline;
use crate::error::SessionError;
use crate::estimator::SessionOptions;
use crate::executor::Alone;
use crate::feeder::{FeedOutcome, FeederOptions, RejectionReason};
use crate::sample::SampleFrame;
use crate::session::{Recorded, Recorder, SessionEstimate};
use sinew_model::StepError;
use sinew_model::offset::FeatureConfig;
use sinew_model::robot::Robot;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

/// Outcome of a sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StepOutcome {
    /// The sample was used.
    Accepted,
    /// The sample was used as the first one: at the start, or after a gap.
    Restarted,
    /// The sample was used and completed a block of 0.2 s for the worker.
    Block,
    /// The sample was rejected and changed nothing except the time: the next `dt_s` refers to this sample.
    Rejected(RejectionReason),
}

/// Maximum number of parts between loop and worker.
const MAX_PARTS: usize = 8;
/// Capacity of each part, s: maximum delay of the worker before blocks are dropped.
const ROOM_S: f64 = 10.0;
/// Period at which the worker thread polls for blocks.
const POLL_PERIOD: Duration = Duration::from_millis(20);

/// Latest successful solution, and the error of the latest attempt, for readers that may wait.
#[derive(Debug, Clone, Default)]
struct Latest {
    solved: Option<Arc<(SessionEstimate, Baseline)>>,
    error: Option<Arc<SessionError>>,
}

type SharedLatest = Arc<Mutex<Latest>>;

/// Worker of an [`OnlineEstimator`], which owns and solves the window.
#[derive(Debug)]
pub struct OnlineWorker {
    window: Window,
    ready: rtrb::Consumer<Recorded>,
    empty: rtrb::Producer<Recorded>,
    answers: triple_buffer::Input<OnlineAnswer>,
    latest: SharedLatest,
}

impl OnlineWorker {
    /// Processes all available blocks, and solves the window when due, which takes some hundredths of a second every 2
    /// s. Not real-time capable.
    pub fn work(&mut self) {
        let mut is_new = false;
        while let Ok(mut part) = self.ready.pop() {
            self.window.push(&part);
            part.clear();
            // The buffer has capacity for all parts.
            let _always_fits = self.empty.push(part);
            is_new = true;
            // After each part, so that a replay gives the same result.
            self.solve();
        }
        if is_new {
            self.answers
                .input_buffer_mut()
                .clone_from(self.window.answer());
            self.answers.publish();
        }
    }

    /// Returns the window of blocks.
    pub fn window(&self) -> &Window {
        &self.window
    }

    fn solve(&mut self) {
        if !self.window.is_due() {
            return;
        }
        self.window.solve();
        let solved = self.window.estimate().zip(self.window.next());
        let solved = solved.map(|(estimate, next)| Arc::new((estimate.clone(), next.clone())));
        let error = self.window.error().cloned();
        *self.latest.lock().unwrap_or_else(PoisonError::into_inner) = Latest { solved, error };
    }
}

/// Thread of a worker.
#[derive(Debug)]
struct Thread {
    ends: Arc<AtomicBool>,
    handle: Option<JoinHandle<()>>,
}

impl Drop for Thread {
    fn drop(&mut self) {
        self.ends.store(true, Ordering::Release);
        if let Some(handle) = self.handle.take() {
            // The result of a worker that panicked is ignored.
            let _ended = handle.join();
        }
    }
}

/// Online estimator of the absolute offsets of a robot's tendons since a baseline, updated per sample.
///
/// # Realtime
/// [`OnlineEstimator::step`], [`OnlineEstimator::interrupt`] and [`OnlineEstimator::answer`]: no allocation, lock,
/// panic, wait or clock.
#[derive(Debug)]
pub struct OnlineEstimator {
    robot: Arc<Robot>,
    recorder: Recorder,
    sample: SampleFrame,
    ready: rtrb::Producer<Recorded>,
    empty: rtrb::Consumer<Recorded>,
    answers: triple_buffer::Output<OnlineAnswer>,
    latest: SharedLatest,
    /// Number of completed blocks.
    blocks: u64,
    blocks_dropped: u64,
    /// Worker until it has been passed to a thread.
    worker: Option<Box<OnlineWorker>>,
    thread: Option<Thread>,
}

impl OnlineEstimator {
    /// Creates an estimator of `robot` since `baseline` (with the name of its file), or relative to the encoder zero.
    /// `name` is the name of the session. Allocates the memory of the loop.
    ///
    /// # Errors
    /// Returns [`SessionError`] if the baseline belongs to another robot.
    pub fn new(
        robot: impl Into<Arc<Robot>>,
        baseline: Option<(Baseline, String)>,
        options: &SessionOptions,
        name: &str,
    ) -> Result<Self, SessionError> {
        let robot = robot.into();
        let window = Window::new(Arc::clone(&robot), baseline, options, name)?;
        let gap_s = FeederOptions::default().gap_s;
        let recorder = Recorder::new(&robot, &FeatureConfig::default(), gap_s);
        let mut recorder = recorder.with_limits(&robot);
        recorder.make_room(ROOM_S);
        let (ready, take) = rtrb::RingBuffer::new(MAX_PARTS);
        let (mut give, empty) = rtrb::RingBuffer::new(MAX_PARTS);
        while give.push(recorder.room(ROOM_S)).is_ok() {}
        let (input, answers) = triple_buffer::triple_buffer(window.answer());
        let latest = SharedLatest::default();
        Ok(Self {
            sample: SampleFrame::new(robot.axes()),
            robot,
            recorder,
            ready,
            empty,
            answers,
            latest: Arc::clone(&latest),
            blocks: 0,
            blocks_dropped: 0,
            worker: Some(Box::new(OnlineWorker {
                window,
                ready: take,
                empty: give,
                answers: input,
                latest,
            })),
            thread: None,
        })
    }

    /// Returns the robot model.
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// Processes a sample. `dt_s`: time since the previous sample, s; ignored for the first sample.
    ///
    /// * `q`, `theta`: `n` each, joint and motor positions, rad. The motor position of a rigid joint is ignored.
    /// * `tau_m`: `n` or empty, motor torque, N·m; NaN if unknown.
    /// * `temperature_c`: temperature, °C; NaN if unknown.
    ///
    /// # Errors
    /// Returns [`StepError::Length`] for a slice of wrong length and [`StepError::TimeStep`] for an invalid `dt_s`; the
    /// state is then unchanged.
    ///
    /// # Realtime
    /// No allocation, lock, panic, wait or clock.
    pub fn step(
        &mut self,
        dt_s: f64,
        q: &[f64],
        theta: &[f64],
        tau_m: &[f64],
        temperature_c: f64,
    ) -> Result<StepOutcome, StepError> {
        let frame = self.sample.fill(dt_s, [q, theta, tau_m], temperature_c)?;
        let time_s = frame.time_ns as f64 * 1e-9;
        if !self.recorder.has_room() {
            // The delay of the worker exceeds the capacity: waiting blocks are dropped and counted.
            let waiting = self.recorder.recorded().blocks.len();
            self.blocks_dropped = self.blocks_dropped.saturating_add(waiting as u64);
            self.recorder.clear();
        }
        let fed = self.recorder.push(frame, time_s);
        if fed.output() == Some(true) {
            self.blocks = self.blocks.saturating_add(1);
            self.send_part();
        }
        Ok(match fed {
            FeedOutcome::Rejected(reason) => StepOutcome::Rejected(reason),
            FeedOutcome::Accepted(true) => StepOutcome::Block,
            FeedOutcome::Accepted(false) => StepOutcome::Accepted,
            FeedOutcome::Restarted(_) => StepOutcome::Restarted,
        })
    }

    /// Sends the recorded blocks to the worker if an empty part is available.
    fn send_part(&mut self) {
        if let Ok(empty) = self.empty.pop() {
            let part = self.recorder.exchange(empty);
            // The buffer has capacity for all parts.
            let _always_fits = self.ready.push(part);
        }
    }

    /// Starts a new segment: the filters are re-initialised at the next sample; the state estimate is kept.
    pub fn interrupt(&mut self) {
        self.sample.interrupt();
    }

    /// Starts a thread that processes blocks and solves windows, on one processor.
    ///
    /// # Errors
    /// Returns the error of the operating system if it cannot start a thread.
    pub fn start_worker(&mut self) -> std::io::Result<()> {
        if self.worker.is_none() {
            return Ok(());
        }
        let ends = Arc::new(AtomicBool::new(false));
        let seen = Arc::clone(&ends);
        let (give, take) = std::sync::mpsc::channel::<Box<OnlineWorker>>();
        let thread = std::thread::Builder::new().name("sinew-online".into());
        // The worker is sent once the thread runs, so that it is kept if the thread cannot be started.
        let handle = thread.spawn(move || {
            let Ok(mut worker) = take.recv() else { return };
            // The other processors stay free for the loop.
            let _alone = Alone::new();
            while !seen.load(Ordering::Acquire) {
                worker.work();
                std::thread::sleep(POLL_PERIOD);
            }
        })?;
        let sent = self.take_worker().map(|worker| give.send(worker));
        debug_assert!(matches!(sent, Some(Ok(()))), "the thread waits for it");
        let handle = Some(handle);
        self.thread = Some(Thread { ends, handle });
        Ok(())
    }

    /// Returns the worker for a thread of the caller that calls [`OnlineWorker::work`]; `None` if it has already been
    /// returned.
    pub fn take_worker(&mut self) -> Option<Box<OnlineWorker>> {
        self.worker.take()
    }

    /// Calls [`OnlineWorker::work`] in this thread, unless the worker has been passed to another thread.
    pub fn work(&mut self) {
        if let Some(worker) = &mut self.worker {
            worker.work();
        }
    }

    /// Returns the latest answer.
    ///
    /// # Realtime
    /// No allocation, lock, panic, wait or clock.
    pub fn answer(&mut self) -> &OnlineAnswer {
        self.answers.read()
    }

    /// Returns the number of blocks dropped because the worker was delayed by more than ten seconds.
    pub fn blocks_dropped(&self) -> u64 {
        self.blocks_dropped
    }

    /// Returns the number of completed blocks that are neither dropped nor in the latest answer. It is one or two if
    /// the worker keeps up; if it grows, the answer is outdated, independent of its state.
    ///
    /// # Realtime
    /// No allocation, lock, panic, wait or clock.
    pub fn blocks_behind(&mut self) -> u64 {
        let answered = self.answers.read().blocks;
        self.blocks
            .saturating_sub(answered.saturating_add(self.blocks_dropped))
    }

    fn latest(&self) -> Latest {
        let latest = self.latest.lock().unwrap_or_else(PoisonError::into_inner);
        latest.clone()
    }

    /// Returns the error of the latest attempt to solve the window; `None` if it was solved. May wait.
    pub fn error(&self) -> Option<Arc<SessionError>> {
        self.latest().error
    }

    /// Returns the estimate of the window's blocks as of the latest solution: the same value as from
    /// [`crate::session::estimate`] for a recording that ends there. `None` until a window has been solved. May wait.
    pub fn estimate(&self) -> Option<SessionEstimate> {
        self.latest().solved.map(|solved| solved.0.clone())
    }

    /// Returns the next baseline of the chain. `recording` is the name of this session, which ended at `end_time_ns`.
    /// May wait.
    ///
    /// # Errors
    /// Returns [`SessionError::Provisional`] while an offset is provisional.
    pub fn save(&mut self, recording: &str, end_time_ns: i64) -> Result<Baseline, SessionError> {
        let provisional = self.answer().is_provisional();
        let solved = self.latest().solved.filter(|_| !provisional);
        let solved = solved.ok_or_else(|| SessionError::Provisional {
            recording: recording.into(),
        })?;
        let mut next = solved.1.clone();
        if let Some(last) = next.recordings.last_mut() {
            recording.clone_into(last);
        }
        next.end_time_ns = end_time_ns;
        Ok(next)
    }
}
