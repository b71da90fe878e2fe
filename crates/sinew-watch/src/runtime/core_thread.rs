//! A thread with the monitors of some robots: takes what doors bring, and gives work and transactions away.
//!
//! It never waits for the disk, an estimate or a browser: it waits for messages, and for answers to what it gave away.

use super::health::Health;
use super::messages::{Answer, Control, CoreHandle, NotStored, Reply, Request, Watched, Work};
use super::pace::Pace;
use super::slot::{Seen, Slot};
use super::troubles::Troubles;
use sinew_door::{Batch, Clock, Inbox, Received, RobotId, Taken};
use sinew_watch_core::command::Command;
use sinew_watch_core::journal::{Entry, Event};
use sinew_watch_core::snapshot::Freshness;
use sinew_watch_core::{Monitor, Transaction};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, SyncSender};
use std::time::{Duration, Instant};
use tokio::sync::mpsc as tokio_mpsc;

/// A robot's monitor looks at the time so often.
const TICK: Duration = Duration::from_secs(1);
/// A thread looks round at least so often.
const ROUND: Duration = Duration::from_millis(100);
/// Batches that are taken before the thread looks at what else there is.
const BATCHES: usize = 64;

/// What a core thread gives away.
#[derive(Clone)]
pub(super) struct Outlets {
    /// What is to be stored.
    pub store: Sender<Request>,
    /// What is to be estimated.
    pub work: Sender<Work>,
    /// Alarms that took a step, once that is stored; who is slow misses some.
    pub told: tokio_mpsc::Sender<(String, Entry)>,
}

struct Robot {
    watched: Watched,
    troubles: Troubles,
    next_tick: Instant,
    /// Commands that wait to be stored.
    commands: Vec<(Command, Option<u64>, Reply)>,
    working: bool,
    storing: bool,
    /// Watched no more: it goes when all is stored.
    leaves: bool,
    /// Dropped with it: somebody waits for that.
    gone: Option<SyncSender<()>>,
}

/// A core thread.
pub(super) struct CoreThread {
    index: usize,
    handle: CoreHandle,
    controls: Receiver<Control>,
    outlets: Outlets,
    clock: Clock,
    pace: Pace,
    health: Arc<Health>,
    robots: BTreeMap<usize, Robot>,
    batch: Batch,
    ends: Option<Instant>,
}

impl CoreThread {
    /// One that watches nothing yet.
    pub(super) fn new(
        index: usize,
        (handle, controls): (CoreHandle, Receiver<Control>),
        outlets: Outlets,
        (clock, pace): (Clock, Pace),
        health: Arc<Health>,
    ) -> Self {
        Self {
            index,
            handle,
            controls,
            outlets,
            clock,
            pace,
            health,
            robots: BTreeMap::new(),
            batch: Batch::default(),
            ends: None,
        }
    }

    /// Runs until it is told to end, and all is stored or the time for that is over.
    pub(super) fn run(mut self) {
        let inbox = self.handle.inbox().clone();
        loop {
            self.health.beat(self.index);
            let mut ready = inbox.wait(self.until_next());
            let mut batches = 0;
            while let Some(id) = ready {
                // A robot is added before its first message comes: whoever isn't known waits there.
                if batches == 0 || !self.robots.contains_key(&id.index()) {
                    self.listen();
                }
                self.take(&inbox, id);
                batches += 1;
                ready = match batches < BATCHES {
                    true => inbox.wait(Duration::ZERO),
                    false => None,
                };
            }
            self.listen();
            self.tick();
            if let Some(by) = self.ends
                && (self.robots.is_empty() || Instant::now() >= by)
            {
                for (_, robot) in std::mem::take(&mut self.robots) {
                    let name = robot.watched.monitor.snapshot(self.now()).robot;
                    self.health.say(&format!(
                        "{name}: the last of it could not be stored in time"
                    ));
                }
                return;
            }
        }
    }

    fn now(&self) -> sinew_watch_core::Instant {
        self.pace.instant(self.clock.now())
    }

    fn until_next(&self) -> Duration {
        let next = self.robots.values().map(|robot| robot.next_tick).min();
        next.map_or(ROUND, |next| {
            next.saturating_duration_since(Instant::now()).min(ROUND)
        })
    }

    /// Takes what a robot's queue holds.
    fn take(&mut self, inbox: &Inbox, id: RobotId) {
        inbox.take(id, &mut self.batch);
        let pace = self.pace;
        let now = self.clock.now();
        let Some(robot) = self.robots.get_mut(&id.index()) else {
            return;
        };
        let troubles = &mut robot.troubles;
        let health = &self.health;
        let Watched {
            intake,
            monitor,
            slot,
            ..
        } = &mut robot.watched;
        intake.feed(&self.batch, |taken| {
            if let Some(line) = feed(monitor, slot, troubles, taken, (pace, now)) {
                health.say_once(&line);
            }
        });
        self.pump(id.index());
    }

    /// Does what it is told.
    fn listen(&mut self) {
        while let Ok(control) = self.controls.try_recv() {
            self.control(control);
        }
    }

    fn control(&mut self, control: Control) {
        let now = self.now();
        match control {
            Control::Add(watched) => self.add(*watched),
            Control::Reload {
                robot,
                config,
                reply,
            } => {
                self.change(robot.index(), |robot| {
                    // Without an answer nothing was changed, and nothing is wrong.
                    let _gone = reply.send(robot.watched.monitor.reload(*config, now));
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
            Control::Door { robot, shut } => {
                self.change(robot.index(), |robot| {
                    let shut = shut.as_ref();
                    let shut = shut.map(|shut| (shut.door.as_str(), shut.why.as_str()));
                    robot.watched.monitor.door(shut, now);
                });
            }
            Control::Done { robot, done } => self.change(robot, |robot| {
                robot.working = false;
                robot.watched.monitor.done(*done, now);
            }),
            Control::LeftOut { robot } => self.change(robot, |robot| robot.working = false),
            Control::End { by } => {
                self.ends = Some(by);
                let all: Vec<usize> = self.robots.keys().copied().collect();
                for at in all {
                    self.leave(at);
                }
            }
        }
    }

    /// Changes something of a robot, if it is still here.
    fn change(&mut self, at: usize, change: impl FnOnce(&mut Robot)) {
        if let Some(robot) = self.robots.get_mut(&at) {
            change(robot);
        }
        self.pump(at);
    }

    fn add(&mut self, watched: Watched) {
        let at = watched.id.index();
        // Ticks of many robots are spread over the second.
        let share = TICK.mul_f64((at as f64 * 0.618_034).fract());
        let robot = Robot {
            watched,
            troubles: Troubles::default(),
            next_tick: Instant::now() + share,
            commands: Vec::new(),
            working: false,
            storing: false,
            leaves: false,
            gone: None,
        };
        self.robots.insert(at, robot);
        self.show(at);
        self.pump(at);
    }

    fn leave(&mut self, at: usize) {
        let (now, pace, received) = (self.now(), self.pace, self.clock.now());
        let Some(robot) = self.robots.get_mut(&at) else {
            return;
        };
        if !std::mem::replace(&mut robot.leaves, true) {
            let Watched {
                intake,
                monitor,
                slot,
                ..
            } = &mut robot.watched;
            let troubles = &mut robot.troubles;
            // Of a robot that fell silent, what is held isn't news: it would be taken for data of now.
            let is_fresh = monitor.snapshot(now).freshness == Freshness::Fresh;
            intake.silence(received, |taken| {
                if is_fresh {
                    let _logged = feed(monitor, slot, troubles, taken, (pace, received));
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
        match robot.watched.monitor.command(command.clone(), now) {
            Err(error) => reply(Answer::Refused(error)),
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
            Err(not) => Answer::NotStored(not.why.clone()),
        };
        let (answered, waiting) = std::mem::take(&mut robot.commands)
            .into_iter()
            .partition::<Vec<_>, _>(|(_, of, _)| *of == Some(id));
        robot.commands = waiting;
        let again = result.is_err();
        match result {
            Ok(()) => {
                robot.watched.monitor.committed(id, now);
                for entry in transaction.journal {
                    if matches!(entry.event, Event::Alarm { .. }) {
                        // Who tells others is slow: the pages and the journal have it in any case.
                        let _full = self
                            .outlets
                            .told
                            .try_send((transaction.robot.clone(), entry));
                    }
                }
                self.show(at);
            }
            Err(NotStored { fault, why }) => robot.watched.monitor.refused(id, fault, &why, now),
        }
        // Who has his answer finds on the page what he said.
        for (_, _, reply) in answered {
            reply(answer.clone());
        }
        // What could not be stored is tried again at the next tick.
        if !again {
            self.pump(at);
        }
    }

    /// Gives away what there is to estimate and to store.
    fn pump(&mut self, at: usize) {
        let Some(robot) = self.robots.get_mut(&at) else {
            return;
        };
        let monitor = &mut robot.watched.monitor;
        if !robot.working
            && let Some(job) = monitor
                .job()
                .filter(|job| !(robot.leaves && job.may_be_left_out()))
        {
            let core = self.handle.clone();
            robot.working = self
                .outlets
                .work
                .send(Work {
                    job,
                    robot: at,
                    core,
                })
                .is_ok();
        }
        if !robot.storing
            && let Some(transaction) = monitor.transaction()
        {
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
            let left = monitor
                .snapshot(self.pace.instant(self.clock.now()))
                .waiting_to_be_stored;
            if left == 0 {
                self.robots.remove(&at);
            }
        }
    }

    /// Tells monitors whose turn it is the time, and shows them.
    fn tick(&mut self) {
        let (begun, now) = (Instant::now(), self.now());
        let due: Vec<usize> = (self.robots.iter())
            .filter(|(_, robot)| robot.next_tick <= begun)
            .map(|(at, _)| *at)
            .collect();
        for at in due {
            if let Some(robot) = self.robots.get_mut(&at) {
                robot.next_tick = (robot.next_tick + TICK).max(begun);
                let Watched {
                    intake, monitor, ..
                } = &mut robot.watched;
                if let Some(changed) = robot.troubles.changed(intake.live()) {
                    monitor.troubles(changed, now);
                }
                monitor.tick(now);
            }
            self.show(at);
            self.pump(at);
        }
    }

    fn show(&mut self, at: usize) {
        let now = self.now();
        if let Some(robot) = self.robots.get(&at) {
            let snapshot = robot.watched.monitor.snapshot(now);
            robot.watched.slot.put(Seen::Watched(Arc::new(snapshot)));
        }
    }
}

/// Gives a monitor what came; a line for the log, where there is one.
fn feed(
    monitor: &mut Monitor,
    slot: &Slot,
    troubles: &mut Troubles,
    taken: Taken<'_>,
    (pace, now): (Pace, Received),
) -> Option<String> {
    match taken {
        Taken::Frame { received, frame } => monitor.frame(frame, pace.instant(received)),
        Taken::Trouble { trouble, .. } => return troubles.take(trouble),
        Taken::Dropped { messages } => {
            slot.count_dropped(messages);
            monitor.dropped(messages, pace.instant(now));
        }
    }
    None
}
