//! The online estimate beside a control loop: samples in, answers out; nothing is allocated, locked or waited for in a step.
//!
//! The loop's side turns samples into blocks and hands them over by a ring; a worker holds the [`Window`] and hands answers back by a
//! triple buffer. The worker is a thread of its own ([`OnlineEstimator::start_worker`]), or the caller's, which calls
//! [`OnlineWorker::work`] outside its loop.

use super::answer::OnlineAnswer;
use super::window::Window;
use crate::baseline::Baseline;
use crate::error::SessionError;
use crate::estimator::SessionOptions;
use crate::executor::Alone;
use crate::feeder::{Fed, FeederOptions, Refusal};
use crate::sample::SampleFrame;
use crate::session::{Recorded, Recorder, SessionEstimate};
use sinew_model::StepError;
use sinew_model::offset::FeatureConfig;
use sinew_model::robot::Robot;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

/// What became of a sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StepOutcome {
    /// The sample was taken.
    Taken,
    /// The sample was taken as the first one: at the start, or after a pause.
    Restarted,
    /// The sample was taken and completed a block of some 0.2 s, which the worker may take.
    Block,
    /// The sample was not taken, and changed nothing. Its time has passed all the same: the next `dt_s` counts from it.
    Refused(Refusal),
}

/// Parts that are under way between loop and worker at most.
const PARTS: usize = 8;
/// Room for blocks in each of them, s: what a worker may be late by before blocks are dropped.
const ROOM_S: f64 = 10.0;
/// How often a worker's thread looks for blocks.
const LOOKS_EVERY: Duration = Duration::from_millis(20);

/// The last solution that worked, and why the last one did not, for readers that may wait.
#[derive(Debug, Clone, Default)]
struct Latest {
    solved: Option<Arc<(SessionEstimate, Baseline)>>,
    error: Option<Arc<SessionError>>,
}

type SharedLatest = Arc<Mutex<Latest>>;

/// The worker's side of an [`OnlineEstimator`]: it holds the window and solves it.
#[derive(Debug)]
pub struct OnlineWorker {
    window: Window,
    ready: rtrb::Consumer<Recorded>,
    empty: rtrb::Producer<Recorded>,
    answers: triple_buffer::Input<OnlineAnswer>,
    latest: SharedLatest,
}

impl OnlineWorker {
    /// Takes all blocks that are ready, and solves the window where that is due: some hundredths of a second every 2 s. Not for a
    /// control loop.
    pub fn work(&mut self) {
        let mut is_new = false;
        while let Ok(mut part) = self.ready.pop() {
            self.window.push(&part);
            part.clear();
            // There are no more parts than it has room for.
            let _always_fits = self.empty.push(part);
            is_new = true;
            // In the order of blocks, so that a replay gives the same.
            self.solve();
        }
        if is_new {
            self.answers
                .input_buffer_mut()
                .clone_from(self.window.answer());
            self.answers.publish();
        }
    }

    /// The window.
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

/// A worker's thread.
#[derive(Debug)]
struct Thread {
    ends: Arc<AtomicBool>,
    handle: Option<JoinHandle<()>>,
}

impl Drop for Thread {
    fn drop(&mut self) {
        self.ends.store(true, Ordering::Release);
        if let Some(handle) = self.handle.take() {
            // A worker that panicked has nothing to say any more.
            let _ended = handle.join();
        }
    }
}

/// Absolute offsets of a robot's tendons since a baseline, sample by sample.
///
/// # Realtime
/// [`OnlineEstimator::step`], [`OnlineEstimator::interrupt`] and [`OnlineEstimator::answer`]: no allocation, lock, panic, wait or clock.
#[derive(Debug)]
pub struct OnlineEstimator {
    robot: Arc<Robot>,
    recorder: Recorder,
    sample: SampleFrame,
    ready: rtrb::Producer<Recorded>,
    empty: rtrb::Consumer<Recorded>,
    answers: triple_buffer::Output<OnlineAnswer>,
    latest: SharedLatest,
    /// Blocks completed.
    blocks: u64,
    blocks_dropped: u64,
    /// Its own, until a thread has taken it.
    worker: Option<Box<OnlineWorker>>,
    thread: Option<Thread>,
}

impl OnlineEstimator {
    /// For `robot` since `baseline` (with the name of its file), or against the zero of the encoders. `name`: of the session. The loop's
    /// memory is allocated here.
    ///
    /// # Errors
    /// [`SessionError`] when the baseline is of another robot.
    pub fn new(
        robot: impl Into<Arc<Robot>>,
        baseline: Option<(Baseline, String)>,
        options: &SessionOptions,
        name: &str,
    ) -> Result<Self, SessionError> {
        let robot = robot.into();
        let window = Window::new(Arc::clone(&robot), baseline, options, name)?;
        let gap_s = FeederOptions::default().gap_s;
        let mut recorder = Recorder::new(&robot, &FeatureConfig::default(), gap_s);
        recorder.make_room(ROOM_S);
        let (ready, take) = rtrb::RingBuffer::new(PARTS);
        let (mut give, empty) = rtrb::RingBuffer::new(PARTS);
        while give.push(recorder.room(ROOM_S)).is_ok() {}
        let (input, answers) = triple_buffer::triple_buffer(window.answer());
        let latest = SharedLatest::default();
        Ok(Self {
            sample: SampleFrame::new(robot.arm.dof()),
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

    /// The robot.
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// Takes a sample, `dt_s` after the one before; of the first that does not matter.
    ///
    /// * `q`, `theta`: `n` each, joint and motor positions, rad. The motor position of a rigid joint does not matter.
    /// * `tau_m`: `n` or empty, motor torque, N·m; NaN where it is not known.
    /// * `temperature_c`: °C; NaN where it is not known.
    ///
    /// # Errors
    /// [`StepError::Length`], [`StepError::TimeStep`]; the state is then unchanged.
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
            // The worker is later than there is room for: what waits is lost, and counted.
            let waiting = self.recorder.recorded().blocks.len();
            self.blocks_dropped = self.blocks_dropped.saturating_add(waiting as u64);
            self.recorder.clear();
        }
        let fed = self.recorder.push(frame, time_s);
        if fed.output() == Some(true) {
            self.blocks = self.blocks.saturating_add(1);
            self.hand_over();
        }
        Ok(match fed {
            Fed::Refused(why) => StepOutcome::Refused(why),
            Fed::Taken(true) => StepOutcome::Block,
            Fed::Taken(false) => StepOutcome::Taken,
            Fed::Restarted(_) => StepOutcome::Restarted,
        })
    }

    /// Hands over what was recorded, where there is an empty part to go on with.
    fn hand_over(&mut self) {
        if let Ok(empty) = self.empty.pop() {
            let part = self.recorder.exchange(empty);
            // There are no more parts than it has room for.
            let _always_fits = self.ready.push(part);
        }
    }

    /// Samples that follow do not go on where the last one was: the filters start anew, what is known stays.
    pub fn interrupt(&mut self) {
        self.sample.interrupt();
    }

    /// Starts a thread that takes blocks and solves windows, on one processor.
    ///
    /// # Errors
    /// The system's, when it has no thread to give.
    pub fn start_worker(&mut self) -> std::io::Result<()> {
        if self.worker.is_none() {
            return Ok(());
        }
        let ends = Arc::new(AtomicBool::new(false));
        let seen = Arc::clone(&ends);
        let (give, take) = std::sync::mpsc::channel::<Box<OnlineWorker>>();
        let thread = std::thread::Builder::new().name("sinew-online".into());
        // The worker follows once there is a thread: one that can't be started loses nothing.
        let handle = thread.spawn(move || {
            let Ok(mut worker) = take.recv() else { return };
            // The other processors are the loop's.
            let _alone = Alone::new();
            while !seen.load(Ordering::Acquire) {
                worker.work();
                std::thread::sleep(LOOKS_EVERY);
            }
        })?;
        let given = self.take_worker().map(|worker| give.send(worker));
        debug_assert!(matches!(given, Some(Ok(()))), "the thread waits for it");
        let handle = Some(handle);
        self.thread = Some(Thread { ends, handle });
        Ok(())
    }

    /// The worker, for a thread of the caller's own that calls [`OnlineWorker::work`]; `None`: it has been taken.
    pub fn take_worker(&mut self) -> Option<Box<OnlineWorker>> {
        self.worker.take()
    }

    /// [`OnlineWorker::work`] of a worker that has not been taken, in this thread; nothing otherwise.
    pub fn work(&mut self) {
        if let Some(worker) = &mut self.worker {
            worker.work();
        }
    }

    /// The latest answer.
    ///
    /// # Realtime
    /// No allocation, lock, panic, wait or clock.
    pub fn answer(&mut self) -> &OnlineAnswer {
        self.answers.read()
    }

    /// Blocks that were dropped because the worker was late by more than ten seconds.
    pub fn blocks_dropped(&self) -> u64 {
        self.blocks_dropped
    }

    /// Blocks that the loop has completed and that are neither dropped nor in the latest answer. It stays at one or two where the worker keeps up; where
    /// it grows, the answer is old, whatever its state.
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

    /// Why the window could not be solved last time; `None`: it was. It may wait.
    pub fn error(&self) -> Option<Arc<SessionError>> {
        self.latest().error
    }

    /// What [`crate::session::estimate`] gives for the window's blocks, as of the last solution: the same value that
    /// `sinew estimate` prints for a recording that ends there. `None` until a window has been solved. It may wait.
    pub fn estimate(&self) -> Option<SessionEstimate> {
        self.latest().solved.map(|solved| solved.0.clone())
    }

    /// The next baseline of the chain: `recording` names this session, which ended at `end_time_ns`. It may wait.
    ///
    /// # Errors
    /// [`SessionError::Provisional`] while an offset is provisional.
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
