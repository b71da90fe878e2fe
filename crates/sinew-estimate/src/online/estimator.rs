//! The online estimate beside a control loop: samples in, answers out; nothing is allocated, locked or waited for in a step.
//!
//! The loop's side turns samples into blocks and hands them over by a ring; a worker holds the [`Window`] and hands answers back by a
//! triple buffer. The worker is a thread of its own ([`OnlineEstimator::start_worker`]), or the caller's, which calls
//! [`OnlineEstimator::work`] outside its loop.

use super::answer::OnlineAnswer;
use super::window::Window;
use crate::baseline::Baseline;
use crate::error::SessionError;
use crate::estimator::SessionOptions;
use crate::feeder::{Fed, FeederOptions, Refusal};
use crate::session::{Recorded, Recorder, SessionEstimate};
use sinew_log::Frame;
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

/// The result of the last solution, for readers that may wait.
#[derive(Debug)]
struct Latest {
    estimate: SessionEstimate,
    next: Baseline,
}

type SharedLatest = Arc<Mutex<Option<Arc<Latest>>>>;

/// The worker's side.
#[derive(Debug)]
struct Worker {
    window: Window,
    ready: rtrb::Consumer<Recorded>,
    empty: rtrb::Producer<Recorded>,
    answers: triple_buffer::Input<OnlineAnswer>,
    latest: SharedLatest,
}

impl Worker {
    /// Takes all blocks that are ready, and solves the window where that is due.
    fn work(&mut self) {
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

    fn solve(&mut self) {
        if !self.window.is_due() {
            return;
        }
        self.window.solve();
        let latest = self.window.estimate().zip(self.window.next());
        let latest = latest.map(|(estimate, next)| {
            Arc::new(Latest {
                estimate: estimate.clone(),
                next: next.clone(),
            })
        });
        *self.latest.lock().unwrap_or_else(PoisonError::into_inner) = latest;
    }
}

/// A worker's thread.
#[derive(Debug)]
struct Thread {
    ends: Arc<AtomicBool>,
    handle: Option<JoinHandle<Worker>>,
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
    robot: Robot,
    recorder: Recorder,
    frame: Frame,
    started: bool,
    ready: rtrb::Producer<Recorded>,
    empty: rtrb::Consumer<Recorded>,
    answers: triple_buffer::Output<OnlineAnswer>,
    latest: SharedLatest,
    blocks_dropped: u64,
    /// Its own, until a thread has taken it.
    worker: Option<Box<Worker>>,
    thread: Option<Thread>,
}

impl OnlineEstimator {
    /// For `robot` since `baseline` (with the name of its file), or against the zero of the encoders. `name`: of the session. The loop's
    /// memory is allocated here.
    ///
    /// # Errors
    /// [`SessionError`] when the baseline is of another robot.
    pub fn new(
        robot: Robot,
        baseline: Option<(Baseline, String)>,
        options: &SessionOptions,
        name: &str,
    ) -> Result<Self, SessionError> {
        if let Some((baseline, file)) = &baseline {
            let estimator = crate::estimator::estimator(&robot, options);
            baseline.belief(&robot, estimator.prior(), file)?;
        }
        let gap_s = FeederOptions::default().gap_s;
        let mut recorder = Recorder::new(&robot, &FeatureConfig::default(), gap_s);
        recorder.make_room(ROOM_S);
        let (ready, take) = rtrb::RingBuffer::new(PARTS);
        let (mut give, empty) = rtrb::RingBuffer::new(PARTS);
        while give.push(recorder.room(ROOM_S)).is_ok() {}
        let window = Window::new(robot.clone(), baseline, options, name);
        let (input, answers) = triple_buffer::triple_buffer(window.answer());
        let latest = SharedLatest::default();
        Ok(Self {
            frame: Frame::new(robot.arm.dof()),
            robot,
            recorder,
            started: false,
            ready,
            empty,
            answers,
            latest: Arc::clone(&latest),
            blocks_dropped: 0,
            worker: Some(Box::new(Worker {
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
        const NS_PER_S: f64 = 1e9;
        let n = self.frame.q.len();
        let torque_fits = tau_m.is_empty() || tau_m.len() == n;
        if q.len() != n || theta.len() != n || !torque_fits {
            return Err(StepError::Length);
        }
        if self.started {
            if !(dt_s > 0.0 && dt_s <= NS_PER_S) {
                return Err(StepError::TimeStep);
            }
            let step_ns = ((dt_s * NS_PER_S).round() as i64).max(1);
            self.frame.time_ns = self.frame.time_ns.saturating_add(step_ns);
        }
        self.started = true;
        self.frame.q.copy_from_slice(q);
        self.frame.theta.copy_from_slice(theta);
        match tau_m {
            [] => self.frame.tau_m.fill(f64::NAN),
            stated => self.frame.tau_m.copy_from_slice(stated),
        }
        self.frame.temperature_c = temperature_c;
        let time_s = self.frame.time_ns as f64 / NS_PER_S;
        if !self.recorder.has_room() {
            // The worker is later than there is room for: what waits is lost, and counted.
            let waiting = self.recorder.recorded().blocks.len();
            self.blocks_dropped = self.blocks_dropped.saturating_add(waiting as u64);
            self.recorder.clear();
        }
        let fed = self.recorder.push(&self.frame, time_s);
        if fed.output() == Some(true) {
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
        self.recorder.restart();
    }

    /// Starts a thread that takes blocks and solves windows; [`OnlineEstimator::work`] does nothing from then on.
    ///
    /// # Errors
    /// The system's, when it has no thread to give.
    pub fn start_worker(&mut self) -> std::io::Result<()> {
        let Some(worker) = self.worker.take() else {
            return Ok(());
        };
        let ends = Arc::new(AtomicBool::new(false));
        let seen = Arc::clone(&ends);
        let thread = std::thread::Builder::new().name("sinew-online".into());
        let handle = thread.spawn(move || {
            let mut worker = *worker;
            while !seen.load(Ordering::Acquire) {
                worker.work();
                std::thread::sleep(LOOKS_EVERY);
            }
            worker
        })?;
        let handle = Some(handle);
        self.thread = Some(Thread { ends, handle });
        Ok(())
    }

    /// Takes the blocks that are ready, and solves the window where that is due: some hundredths of a second every 2 s. Not for a
    /// control loop.
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

    fn latest(&self) -> Option<Arc<Latest>> {
        let latest = self.latest.lock().unwrap_or_else(PoisonError::into_inner);
        latest.clone()
    }

    /// What [`crate::session::estimate`] gives for the window's blocks, as of the last solution: the same value that
    /// `sinew estimate` prints for a recording that ends there. `None` until a window has been solved. It may wait.
    pub fn estimate(&self) -> Option<SessionEstimate> {
        self.latest().map(|latest| latest.estimate.clone())
    }

    /// The next baseline of the chain: `recording` names this session, which ended at `end_time_ns`. It may wait.
    ///
    /// # Errors
    /// [`SessionError::Provisional`] while an offset is provisional.
    pub fn save(&mut self, recording: &str, end_time_ns: i64) -> Result<Baseline, SessionError> {
        let provisional = self.answer().is_provisional();
        let latest = self.latest().filter(|_| !provisional);
        let latest = latest.ok_or_else(|| SessionError::Provisional {
            recording: recording.into(),
        })?;
        let mut next = latest.next.clone();
        if let Some(last) = next.recordings.last_mut() {
            recording.clone_into(last);
        }
        next.end_time_ns = end_time_ns;
        Ok(next)
    }
}
