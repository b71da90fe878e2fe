//! The monitor of one robot: inputs, each with the [`Instant`] it came; outputs, when asked.
//!
//! ```text
//!  frame, dropped ─▶ ingest ─▶ block ─▶ online ─▶ Job … Done ─▶ online ─▶ snapshot (the offsets of now)
//!                                  └──▶ sessions ─▶ Job … Done ─▶ belief ─▶ records, trends, alarms
//!  tick, troubles, door, command ─────────────────▶ alarms ─▶ outbox ─▶ Transaction … committed
//! ```
//!
//! [`Monitor`] owns these parts and passes on what one of them says to the others; each has a file of its name.
//!
//! Reading order: `config`, `setup`, this file, `clock` and `health` (what to believe of frames), `ingest`, `session`,
//! `online`, `job`, `tendon`, `baseline`, `belief`, `history`, `trend`, `alarms`, `outbox`, `snapshot`.

mod alarms;
mod baseline;
mod belief;
mod clock;
mod config;
mod health;
mod history;
mod ingest;
mod job;
mod online;
mod outbox;
mod session;
mod setup;
mod snapshot;
mod tendon;
mod trend;

pub use config::{AlarmOptions, ClockChoice, MonitorConfig, MonitorError, Stored, Times};
pub use history::History;
pub use job::{Done, Job};
pub use trend::HORIZON_DAYS;

use crate::alarm::{AlarmCause, Condition, StoreFault, Trouble};
use crate::command::{Command, CommandError, What};
use crate::instant::Instant;
use crate::journal::{Event, SessionEnd};
use crate::record::Clock;
use crate::snapshot::RobotSnapshot;
use crate::transaction::Transaction;
use alarms::AlarmJudge;
use belief::{BeliefChain, Changes};
use clock::{ClockEvent, Clocks};
use ingest::Ingest;
use job::{Outcome, Work};
use online::Online;
use outbox::Outbox;
use session::{Sessions, StretchEnd};
use setup::Setup;
use sinew_log::Frame;
use sinew_model::offset::FeatureConfig;
use snapshot::View;
use std::sync::Arc;
use trend::Trends;

/// The monitor of one robot: a state machine without socket, clock or thread.
///
/// Inputs: [`frame`](Self::frame), [`dropped`](Self::dropped), [`troubles`](Self::troubles), [`door`](Self::door),
/// [`tick`](Self::tick), [`command`](Self::command), [`done`](Self::done), [`committed`](Self::committed),
/// [`refused`](Self::refused), [`shutdown`](Self::shutdown). Outputs: [`job`](Self::job),
/// [`transaction`](Self::transaction), [`snapshot`](Self::snapshot). After any input there may be outputs to take;
/// nothing waits for them.
///
/// | who | calls |
/// |---|---|
/// | the thread of frames | `frame` for each; `tick` ten times a second, also when nothing comes |
/// | workers | [`Job::run`], then `done` |
/// | the store | stores a transaction as a whole, then `committed` or `refused` |
///
/// # Realtime
/// [`Monitor::frame`] allocates nothing in steady motion: blocks that wait for their estimate are given room in
/// [`Monitor::tick`]. What happens seldom (a session that ends, an entry of the journal) may allocate.
#[derive(Debug)]
pub struct Monitor {
    setup: Setup,
    ingest: Ingest,
    sessions: Sessions,
    online: Online,
    chain: BeliefChain,
    trends: Trends,
    alarms: AlarmJudge,
    outbox: Outbox,
    /// Whether a job is under way.
    working: bool,
    /// When the last tick came.
    ticked: Instant,
}

impl Monitor {
    /// A monitor that goes on from what was stored.
    ///
    /// # Errors
    /// [`MonitorError`]: a configuration that can't be. What is stored never keeps a monitor from starting: a belief
    /// of another robot is left alone, and the journal says so.
    pub fn new(
        config: MonitorConfig,
        mut stored: Stored,
        now: Instant,
    ) -> Result<Self, MonitorError> {
        let setup = Setup::new(config)?;
        let restored = stored.belief.is_some();
        let (chain, left) = BeliefChain::new(&setup, stored.belief.take())?;
        let config = &setup.config;
        let block_s = FeatureConfig::default().block_s;
        let begun = chain.belief().sessions;
        let ingest = Ingest::new(&setup, now);
        let recorder = &ingest.recorder;
        let mut monitor = Self {
            sessions: Sessions::new(setup.joints(), block_s, begun, config.times),
            online: Online::new(&setup.robot, &config.estimate, chain.belief(), recorder)?,
            ingest,
            outbox: Outbox::new(&config.name, &mut stored),
            trends: Trends::new(setup.names.len(), stored.history),
            alarms: AlarmJudge::new(stored.alarms, now),
            working: false,
            ticked: now,
            chain,
            setup,
        };
        monitor.outbox.event(Event::Started { restored }, now);
        if let Some(why) = left {
            monitor.outbox.event(Event::BeliefLeft { why }, now);
        }
        monitor.judge_beliefs();
        monitor.tick(now);
        Ok(monitor)
    }

    /// Takes another configuration of the same robot while it runs; not a sample is lost. A baseline in it counts
    /// only where nothing was learned.
    ///
    /// # Errors
    /// [`MonitorError`]; everything is as before then.
    pub fn reload(&mut self, config: MonitorConfig, now: Instant) -> Result<(), MonitorError> {
        self.setup.reload(config)?;
        self.ingest.clocks.set_choice(self.setup.config.clock);
        self.sessions.set_times(self.setup.config.times);
        self.trends.all_changed();
        self.judge_beliefs();
        self.outbox.event(Event::Reloaded, now);
        self.tick(now);
        Ok(())
    }

    /// Takes a frame of the robot's joints, in the order of [`MonitorConfig::robot`].
    ///
    /// # Realtime
    /// No allocation in steady motion, lock or clock; see [`Monitor`].
    pub fn frame(&mut self, frame: &Frame, now: Instant) {
        self.watch_clock(now);
        if let Some(after_s) = self.ingest.data_came(now) {
            self.outbox.event(Event::Back { after_s }, now);
            if self.sessions.now().is_none() {
                self.sessions.back();
                self.online.forget();
            }
        }
        let arrived = self.ingest.frame(frame, now);
        if let Some(rate) = arrived.not_time {
            self.outbox.event(Event::StampsNotTime { rate }, now);
        }
        self.sessions.frames(1, u64::from(arrived.lost));
        if arrived.block {
            self.block(now);
        }
    }

    /// Messages were dropped before they became frames, by a full queue.
    pub fn dropped(&mut self, messages: u64, now: Instant) {
        self.outbox.dropped = self.outbox.dropped.saturating_add(messages);
        self.ingest.dropped(messages);
        self.sessions.frames(messages, messages);
        self.watch_clock(now);
    }

    /// Ends the session where the civil clock stepped against the one that never does.
    fn watch_clock(&mut self, now: Instant) {
        if let Some(ClockEvent::Step(by_s)) = self.ingest.clocks.now(now) {
            self.outbox.event(Event::ClockStep { by_s }, now);
            self.sessions.set_clock(Clock::Stepped);
            self.end_session(SessionEnd::ClockStep, now);
        }
    }

    fn block(&mut self, now: Instant) {
        let block = self.ingest.recorder.observer().block();
        let from = self.ingest.recorded_from.unwrap_or(now);
        let moved = (self.sessions).block(block, &mut self.ingest.clocks, from, now);
        let block_s = self.sessions.block_s;
        let recorded = self.ingest.recorder.recorded();
        (self.online).block(recorded, [from, now], moved == Some(true), block_s);
        let Some(moved) = moved else {
            // Nobody needs what a standing arm says again and again.
            self.ingest.forget_recorded();
            return;
        };
        if let Some(end) = self.sessions.is_over() {
            self.end_session(end, now);
            return;
        }
        if let Some(progress) = &mut self.chain.baseline {
            progress.block(block, moved, block_s);
            if progress.hand_over() {
                self.end_session(SessionEnd::Baseline, now);
                return;
            }
        }
        if self.sessions.is_stretch_over() {
            self.end_stretch(None);
        }
    }

    /// Ends the session under way, if there is one.
    fn end_session(&mut self, end: SessionEnd, now: Instant) {
        let Some(session) = self.sessions.now().copied() else {
            return;
        };
        if let Some(last) = self.ingest.last
            && Clocks::is_caught_up(session.motion_s, last.since_s(session.start))
        {
            self.sessions.set_clock(Clock::Stamp);
        }
        if session.motion_s > 0.0 {
            self.end_stretch(Some(end));
            let duration_s = session.motion_s;
            self.outbox.event(Event::Session { duration_s, end }, now);
        }
        self.sessions.end();
        self.ingest.forget_recorded();
    }

    fn end_stretch(&mut self, end: Option<SessionEnd>) {
        let how = StretchEnd {
            end,
            in_doubt: !self.online.is_settled(),
            motor_current: self.setup.config.estimate.motor_current,
            baseline_of: self.chain.baseline_of(),
        };
        self.outbox.behind_s += self.sessions.end_stretch(&mut self.ingest.recorder, how);
    }

    /// The next estimate to make; one at a time, for each begins where the last one ended.
    pub fn job(&mut self) -> Option<Job> {
        if self.working {
            return None;
        }
        while let Some(stretch) = self.sessions.next_stretch() {
            if self.chain.is_outdated(&stretch) {
                continue;
            }
            if stretch.worth_it && !stretch.recorded.blocks.is_empty() {
                self.working = true;
                return Some(self.chain.stretch_job(stretch, &self.setup));
            }
            let changes = (self.chain).without_motion(&stretch, &self.setup, &self.sessions);
            self.pass_on(changes, self.ticked);
        }
        if let Some(work) = self.online.work() {
            self.working = true;
            return Some(Job {
                robot: Arc::clone(&self.setup.robot),
                work: Work::Online(Box::new(work)),
            });
        }
        let (beliefs, tensionings) = (&self.chain.belief().tendons, self.chain.tensionings);
        let work = (self.trends).work(&self.setup, beliefs, tensionings, self.ticked)?;
        self.working = true;
        Some(Job {
            robot: Arc::clone(&self.setup.robot),
            work: Work::Trend(Box::new(work)),
        })
    }

    /// Takes what a [`Job`] gave.
    pub fn done(&mut self, done: Done, now: Instant) {
        self.working = false;
        match done.0 {
            Outcome::Online(made) => {
                if made.is_none() {
                    self.chain.refusal = Some("the estimator failed".into());
                    self.judge_data();
                }
                return self.online.made(made.map(|made| *made));
            }
            Outcome::Trend(made) => self.trends.set(made, self.chain.tensionings),
            Outcome::Stretch {
                stretch,
                learned,
                result,
            } => {
                let (setup, sessions) = (&self.setup, &self.sessions);
                let changes = (self.chain).done(&stretch, learned, result, setup, sessions);
                self.pass_on(changes, now);
            }
        }
        self.judge_beliefs();
        self.tick(now);
    }

    /// Passes on what an estimate changed.
    fn pass_on(&mut self, changes: Changes, now: Instant) {
        if let Some((successor, at_once)) = changes.successor {
            self.online.succeed(successor, at_once);
        }
        if let Some(event) = changes.event {
            self.outbox.event(event, now);
        }
        for (i, jump) in &changes.jumps {
            self.alarms.jumped(&self.setup.names[*i], jump, now);
        }
        for record in &changes.records {
            self.trends.record(record, &self.setup);
        }
        if changes.belief {
            self.outbox.learned(changes.records);
        }
    }

    fn judge_beliefs(&mut self) {
        (self.alarms).judge_tendons(&self.setup, &self.chain, &self.trends);
        self.judge_data();
    }

    fn judge_data(&mut self) {
        let refusal = self.chain.refusal.as_deref();
        (self.alarms).judge_data(&self.setup, &self.ingest.health, refusal);
    }

    /// What the doors can't receive as they should, now; an empty list: all is well.
    pub fn troubles(&mut self, troubles: &[Trouble], now: Instant) {
        let (health, refusal) = (&self.ingest.health, self.chain.refusal.as_deref());
        if (self.alarms).set_troubles(troubles, &self.setup, health, refusal) {
            self.tick(now);
        }
    }

    /// Whether the robot's door is shut, and why: `dds:0` and what the system said.
    pub fn door(&mut self, shut: Option<(&str, &str)>, now: Instant) {
        let cause = shut.map(|(door, why)| AlarmCause::Door {
            door: door.into(),
            why: why.into(),
        });
        self.alarms.set_robot(Condition::Door, cause);
        self.tick(now);
    }

    /// Does what somebody says. It is spoken of once it is stored.
    ///
    /// # Errors
    /// [`CommandError`]; nothing has changed then.
    pub fn command(&mut self, command: Command, now: Instant) -> Result<(), CommandError> {
        command.check(&self.setup.names)?;
        self.watch_clock(now);
        let tensioned = match &command.what {
            What::Tensioned { joints } => Some((joints.clone(), false)),
            What::Replaced { joints } => Some((joints.clone(), true)),
            _ => None,
        };
        if tensioned.is_some() {
            self.end_session(SessionEnd::Command, now);
        }
        self.alarms.alarms.command(&command, now)?;
        self.outbox.event(Event::Command { command }, now);
        if let Some((joints, replaced)) = tensioned {
            let (setup, sessions) = (&self.setup, &self.sessions);
            for i in (self.chain).tension(&joints, replaced, setup, sessions, now) {
                self.alarms.forget_joint(&setup.names[i]);
                self.trends.forget(i);
            }
            self.online.stop();
            self.outbox.learned(Vec::new());
        }
        self.tick(now);
        Ok(())
    }

    /// Takes note of time: staleness, delays, ends of shelves and sessions. Makes room for what comes.
    pub fn tick(&mut self, now: Instant) {
        self.ticked = now;
        self.time_passes(now);
        self.alarms.tick(&self.setup.config.alarms, now);
        self.sessions.make_room(&mut self.ingest.recorder);
        self.online.make_room(&self.ingest.recorder);
        let transitions = self.alarms.alarms.take_transitions();
        let alarms = || self.alarms.alarms.stored();
        (self.outbox).flush(self.chain.belief(), transitions, alarms, now);
    }

    /// Staleness, sessions that wait too long, what was dropped.
    fn time_passes(&mut self, now: Instant) {
        self.watch_clock(now);
        let (silent_s, times) = (self.ingest.silent_s(now), self.setup.config.times);
        if silent_s >= times.stale_after_s {
            if self.ingest.fall_silent() {
                let last = self.ingest.last;
                if last.is_some() {
                    self.outbox.event(Event::Silent, now);
                }
                let since_utc_s = last.map(Instant::utc_s);
                let cause = AlarmCause::Silence { since_utc_s };
                self.alarms.set_robot(Condition::NoData, Some(cause));
            }
            if silent_s >= times.session_pause_s {
                self.end_session(SessionEnd::Lost, now);
            }
        } else if self.ingest.last.is_some() {
            self.alarms.set_robot(Condition::NoData, None);
        }
        if self.ingest.health.verdict(&self.setup.names, now) {
            self.judge_data();
        }
        if let Some(for_s) = self.online.provisional_s() {
            let cause = AlarmCause::InDoubt { for_s };
            let cause = (for_s >= self.setup.config.alarms.doubt_s).then_some(cause);
            self.alarms.set_robot(Condition::Suspicion, cause);
        }
        self.outbox.tell_losses(now);
    }

    /// The monitor ends: the session does too. Jobs and transactions that are left are worth waiting for.
    pub fn shutdown(&mut self, now: Instant) {
        self.end_session(SessionEnd::Shutdown, now);
        self.tick(now);
    }

    /// The next transaction to store; one at a time.
    pub fn transaction(&mut self) -> Option<Transaction> {
        self.outbox.take()
    }

    /// A transaction is stored.
    pub fn committed(&mut self, id: u64, now: Instant) {
        if self.outbox.committed(id) {
            self.alarms.set_robot(Condition::Store, None);
            self.alarms.tick(&self.setup.config.alarms, now);
        }
    }

    /// A transaction could not be stored; it is handed out again with the next one.
    pub fn refused(&mut self, id: u64, fault: StoreFault, why: &str, now: Instant) {
        if self.outbox.refused(id) {
            let why = why.into();
            let cause = AlarmCause::Store { fault, why };
            self.alarms.set_robot(Condition::Store, Some(cause));
            self.alarms.tick(&self.setup.config.alarms, now);
        }
    }

    /// What is known now. Alarms and records are those that are stored; while the store fails, alarms are shown as
    /// they are.
    pub fn snapshot(&self, now: Instant) -> RobotSnapshot {
        View::new(self, now).robot()
    }
}
