//! Thread with the monitors of some robots: processes the messages of transports, and passes on jobs and
//! transactions.
//!
//! It never waits for the disk, an estimate or a browser, only for messages and for the results of its requests.

use super::clock_rate::ClockRate;
use super::faults::TopicFaults;
use super::health::Health;
use super::messages::{
    Answer, Control, CoreHandle, MonitoredRobot, NotStored, Reply, Request, RobotJob,
};
use super::recorder::Recorder;
use super::slot::{RobotState, Slot};
use crate::words;
use sinew_transport::{Batch, BatchContent, Clock, Inbox, Received, RobotId};
use sinew_watch_core::command::Command;
use sinew_watch_core::journal::{Entry, Event};
use sinew_watch_core::snapshot::Freshness;
use sinew_watch_core::{Monitor, Transaction};
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, SyncSender};
use std::time::{Duration, Instant};
use tokio::sync::mpsc as tokio_mpsc;

/// Interval at which a monitor evaluates the time.
const TICK: Duration = Duration::from_secs(1);
/// Maximum duration of one loop of the thread.
const MAX_LOOP_TIME: Duration = Duration::from_millis(100);
/// Maximum number of batches before the thread handles other requests.
const MAX_BATCHES: usize = 64;

/// Outputs of a core thread.
#[derive(Clone)]
pub(super) struct Outlets {
    /// Transactions to store.
    pub store: Sender<Request>,
    /// Jobs to estimate.
    pub work: Sender<RobotJob>,
    /// Alarm transitions that have been stored; a slow receiver misses some.
    pub transitions: tokio_mpsc::Sender<(String, Entry)>,
}

struct Robot {
    monitored: MonitoredRobot,
    faults: TopicFaults,
    next_tick: Instant,
    /// Commands that wait to be stored.
    commands: Vec<(Command, Option<u64>, Reply)>,
    working: bool,
    storing: bool,
    /// Whether the robot is removed once all its data are stored.
    leaves: bool,
    /// Dropped with the robot, to wake a waiting thread.
    gone: Option<SyncSender<()>>,
}

/// Thread with the monitors of some robots.
pub(super) struct CoreThread {
    index: usize,
    handle: CoreHandle,
    controls: Receiver<Control>,
    outlets: Outlets,
    clock: Clock,
    clock_rate: ClockRate,
    health: Arc<Health>,
    robots: BTreeMap<usize, Robot>,
    batch: Batch,
    ends: Option<Instant>,
}

impl CoreThread {
    /// Creates a thread without robots.
    pub(super) fn new(
        index: usize,
        (handle, controls): (CoreHandle, Receiver<Control>),
        outlets: Outlets,
        (clock, clock_rate): (Clock, ClockRate),
        health: Arc<Health>,
    ) -> Self {
        Self {
            index,
            handle,
            controls,
            outlets,
            clock,
            clock_rate,
            health,
            robots: BTreeMap::new(),
            batch: Batch::default(),
            ends: None,
        }
    }

    /// Runs until it is stopped, and everything is stored or the time limit is reached.
    pub(super) fn run(mut self) {
        let inbox = self.handle.inbox().clone();
        loop {
            self.health.beat(self.index);
            let mut ready = inbox.wait(self.until_next());
            let mut batches = 0;
            while let Some(id) = ready {
                // A robot is added before its first message arrives: messages of an unknown robot wait.
                if batches == 0 || !self.robots.contains_key(&id.index()) {
                    self.handle_requests();
                }
                self.guarded(id.index(), |core| core.ingest(&inbox, id));
                batches += 1;
                ready = match batches < MAX_BATCHES {
                    true => inbox.wait(Duration::ZERO),
                    false => None,
                };
            }
            self.handle_requests();
            self.tick();
            if let Some(by) = self.ends
                && (self.robots.is_empty() || Instant::now() >= by)
            {
                for (_, robot) in std::mem::take(&mut self.robots) {
                    let name = robot.monitored.monitor.snapshot(self.now()).robot;
                    self.health.log(&words::log::last_data_lost(&name));
                }
                return;
            }
        }
    }

    fn now(&self) -> sinew_watch_core::Instant {
        self.clock_rate.instant(self.clock.now())
    }

    fn until_next(&self) -> Duration {
        let next = self.robots.values().map(|robot| robot.next_tick).min();
        next.map_or(MAX_LOOP_TIME, |next| {
            next.saturating_duration_since(Instant::now())
                .min(MAX_LOOP_TIME)
        })
    }

    /// Processes the queue of a robot.
    fn ingest(&mut self, inbox: &Inbox, id: RobotId) {
        inbox.take(id, &mut self.batch);
        let clock_rate = self.clock_rate;
        let now = self.clock.now();
        let Some(robot) = self.robots.get_mut(&id.index()) else {
            return;
        };
        let faults = &mut robot.faults;
        let health = &self.health;
        let MonitoredRobot {
            intake,
            monitor,
            recorder,
            slot,
            ..
        } = &mut robot.monitored;
        intake.feed(&self.batch, |content| {
            let to = (&mut *monitor, &mut *recorder);
            if let Some(line) = feed(to, slot, faults, content, (clock_rate, now)) {
                health.log_once(&line);
            }
        });
        self.pump(id.index());
    }

    /// Handles the requests to the thread.
    fn handle_requests(&mut self) {
        while let Ok(control) = self.controls.try_recv() {
            let robot = control.robot();
            self.guarded(robot, |core| core.control(control));
        }
    }

    fn control(&mut self, control: Control) {
        let now = self.now();
        match control {
            Control::Add(monitored) => self.add(*monitored),
            Control::Reload {
                robot,
                config,
                reply,
            } => {
                self.change(robot.index(), |robot| {
                    // Without a receiver nothing was changed, and there is no fault.
                    let _gone = reply.send(robot.monitored.monitor.reload(*config, now));
                });
            }
            Control::Remove { robot, gone } => {
                if let Some(robot) = self.robots.get_mut(&robot.index()) {
                    robot.gone = Some(gone);
                }
                self.leave(robot.index());
            }
            Control::Command {
                robot,
                command,
                reply,
            } => self.command(robot.index(), command, reply),
            Control::Stored {
                robot,
                transaction,
                result,
            } => self.stored(robot, *transaction, result),
            Control::Transport {
                robot,
                disconnected,
            } => {
                self.change(robot.index(), |robot| {
                    let reason = disconnected.as_ref();
                    let reason = reason.map(|lost| (lost.transport.as_str(), lost.reason.as_str()));
                    robot.monitored.monitor.transport(reason, now);
                });
            }
            Control::JobResult { robot, done } => self.change(robot, |robot| {
                robot.working = false;
                let MonitoredRobot {
                    monitor, recorder, ..
                } = &mut robot.monitored;
                monitor.done(*done, now);
                for (joint, time_utc_s) in monitor.take_changes() {
                    recorder.change(&joint, time_utc_s, now.utc_s());
                }
            }),
            Control::Skipped { robot } => self.change(robot, |robot| robot.working = false),
            Control::End { by } => {
                self.ends = Some(by);
                let all: Vec<usize> = self.robots.keys().copied().collect();
                for at in all {
                    self.guarded(at, |core| core.leave(at));
                }
            }
        }
    }

    /// Modifies a robot if it still exists.
    fn change(&mut self, at: usize, change: impl FnOnce(&mut Robot)) {
        if let Some(robot) = self.robots.get_mut(&at) {
            change(robot);
        }
        self.pump(at);
    }

    fn add(&mut self, monitored: MonitoredRobot) {
        let at = monitored.id.index();
        // Ticks of many robots are spread over one second.
        let share = TICK.mul_f64((at as f64 * 0.618_034).fract());
        let robot = Robot {
            monitored,
            faults: TopicFaults::default(),
            next_tick: Instant::now() + share,
            commands: Vec::new(),
            working: false,
            storing: false,
            leaves: false,
            gone: None,
        };
        self.robots.insert(at, robot);
        self.publish_snapshot(at);
        self.pump(at);
    }

    fn leave(&mut self, at: usize) {
        let (now, clock_rate, received) = (self.now(), self.clock_rate, self.clock.now());
        let Some(robot) = self.robots.get_mut(&at) else {
            return;
        };
        if !std::mem::replace(&mut robot.leaves, true) {
            let MonitoredRobot {
                intake,
                monitor,
                recorder,
                slot,
                ..
            } = &mut robot.monitored;
            let faults = &mut robot.faults;
            // Pending frames of a silent robot are discarded: they would be mistaken for present data.
            let is_fresh = monitor.snapshot(now).freshness == Freshness::Fresh;
            intake.silence(received, |content| {
                if is_fresh {
                    let to = (&mut *monitor, &mut *recorder);
                    let _logged = feed(to, slot, faults, content, (clock_rate, received));
                }
            });
            monitor.shutdown(now);
        }
        self.pump(at);
    }

    fn command(&mut self, at: usize, command: Command, reply: Reply) {
        let now = self.now();
        let Some(robot) = self.robots.get_mut(&at).filter(|robot| !robot.leaves) else {
            return reply(Answer::Gone);
        };
        match robot.monitored.monitor.command(command.clone(), now) {
            Err(error) => reply(Answer::Rejected(error)),
            Ok(()) => robot.commands.push((command, None, reply)),
        }
        self.pump(at);
    }

    fn stored(&mut self, at: usize, transaction: Transaction, result: Result<(), NotStored>) {
        let now = self.now();
        let Some(robot) = self.robots.get_mut(&at) else {
            return;
        };
        robot.storing = false;
        let id = transaction.id;
        let answer = match &result {
            Ok(()) => Answer::Stored,
            Err(not) => Answer::NotStored(not.reason.clone()),
        };
        let (answered, waiting) = std::mem::take(&mut robot.commands)
            .into_iter()
            .partition::<Vec<_>, _>(|(_, of, _)| *of == Some(id));
        robot.commands = waiting;
        let again = result.is_err();
        match result {
            Ok(()) => {
                robot.monitored.monitor.committed(id, now);
                for entry in transaction.journal {
                    if matches!(entry.event, Event::Alarm { .. }) {
                        // A slow notifier loses the transition; pages and journal have it in any case.
                        let _full = self
                            .outlets
                            .transitions
                            .try_send((transaction.robot.clone(), entry));
                    }
                }
                self.publish_snapshot(at);
            }
            Err(NotStored { fault, reason }) => robot
                .monitored
                .monitor
                .store_failed(id, fault, &reason, now),
        }
        // Clients that receive the answer find their command in the snapshot.
        for (_, _, reply) in answered {
            reply(answer.clone());
        }
        // Data that could not be stored are submitted again at the next tick.
        if !again {
            self.pump(at);
        }
    }

    /// Submits pending jobs and transactions of a robot.
    fn pump(&mut self, at: usize) {
        let now = self.now();
        let Some(robot) = self.robots.get_mut(&at) else {
            return;
        };
        let monitor = &mut robot.monitored.monitor;
        if !robot.working
            && let Some(job) = monitor
                .job()
                .filter(|job| !(robot.leaves && job.is_optional()))
        {
            let core = self.handle.clone();
            robot.working = self
                .outlets
                .work
                .send(RobotJob {
                    job,
                    robot: at,
                    core,
                })
                .is_ok();
        }
        if !robot.storing
            && let Some(transaction) = monitor.transaction()
        {
            let recorder = &mut robot.monitored.recorder;
            recorder.transaction(&transaction, now.utc_s());
            for (command, id, _) in &mut robot.commands {
                let is_this = |entry: &Entry| matches!(&entry.event, Event::Command { command: c } if c == command);
                if id.is_none() && transaction.journal.iter().any(is_this) {
                    *id = Some(transaction.id);
                }
            }
            let core = self.handle.clone();
            let request = Request::Store {
                transaction,
                robot: at,
                core,
            };
            robot.storing = self.outlets.store.send(request).is_ok();
        }
        if robot.leaves && !robot.working && !robot.storing {
            let waiting = monitor.snapshot(now).waiting_to_be_stored;
            if waiting == 0
                && let Some(mut robot) = self.robots.remove(&at)
            {
                robot.monitored.record(now.utc_s(), &self.health, true);
            }
        }
    }

    /// Passes the time to the monitors that are due, and publishes their snapshots.
    fn tick(&mut self) {
        let (begun, now) = (Instant::now(), self.now());
        let due: Vec<usize> = (self.robots.iter())
            .filter(|(_, robot)| robot.next_tick <= begun)
            .map(|(at, _)| *at)
            .collect();
        for at in due {
            self.guarded(at, |core| core.tick_robot(at, begun, now));
        }
    }

    fn tick_robot(&mut self, at: usize, begun: Instant, now: sinew_watch_core::Instant) {
        if let Some(robot) = self.robots.get_mut(&at) {
            robot.next_tick = (robot.next_tick + TICK).max(begun);
            let MonitoredRobot {
                intake, monitor, ..
            } = &mut robot.monitored;
            if let Some(changed) = robot.faults.changed(intake.live()) {
                monitor.transport_faults(changed, now);
            }
            monitor.tick(now);
            robot.monitored.record(now.utc_s(), &self.health, false);
        }
        self.publish_snapshot(at);
        self.pump(at);
    }

    /// Does work for one robot. A panic in it ends the monitoring of that robot only, until the runtime restarts it from
    /// its stored state.
    fn guarded(&mut self, at: usize, work: impl FnOnce(&mut Self)) {
        if catch_unwind(AssertUnwindSafe(|| work(self))).is_ok() {
            return;
        }
        let Some(robot) = self.robots.remove(&at) else {
            return;
        };
        let slot = &robot.monitored.slot;
        if let RobotState::Monitored(last) = slot.state() {
            let line = words::log::robot_fault(&last.robot, &words::has_failed());
            self.health.log_once(&line);
        }
        slot.put(RobotState::NotMonitored(words::has_failed()));
    }

    fn publish_snapshot(&mut self, at: usize) {
        let now = self.now();
        if let Some(robot) = self.robots.get(&at) {
            let snapshot = robot.monitored.monitor.snapshot(now);
            robot
                .monitored
                .slot
                .put(RobotState::Monitored(Arc::new(snapshot)));
        }
    }
}

/// Passes a batch item to a monitor; returns a log line where appropriate.
fn feed(
    (monitor, recorder): (&mut Monitor, &mut Recorder),
    slot: &Slot,
    faults: &mut TopicFaults,
    content: BatchContent<'_>,
    (clock_rate, now): (ClockRate, Received),
) -> Option<String> {
    match content {
        BatchContent::Frame { received, frame } => {
            let now = clock_rate.instant(received);
            recorder.frame(frame, now.utc_s());
            monitor.frame(frame, now);
            let live = |tendon| monitor.live(tendon, frame, now);
            slot.live.add(live, now.monotonic_ns);
        }
        BatchContent::Fault { fault, .. } => return faults.ingest(fault),
        BatchContent::Dropped { messages } => {
            slot.count_dropped(messages);
            monitor.dropped(messages, clock_rate.instant(now));
        }
    }
    None
}
