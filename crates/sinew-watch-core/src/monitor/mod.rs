//! Monitor of one robot: inputs with the [`Instant`] of their arrival, and outputs that the caller queries.
//!
//! ```text
//!  frame, dropped ─▶ ingest ─▶ block ─▶ online ─▶ QueuedJob … JobResult ─▶ online ─▶ snapshot (present offsets)
//!                                  └──▶ sessions ─▶ QueuedJob … JobResult ─▶ posterior ─▶ records, trends, alarms
//!  tick, transport_faults, transport, command ──────────▶ alarms ─▶ outbox ─▶ Transaction … committed
//! ```
//!
//! [`Monitor`] owns these parts and passes their results on; each part has a file of its name.
//!
//! Reading order: `config`, `setup`, this file, `clock` and `health` (checks of the frames), `ingest`, `session`,
//! `online`, `job`, `evidence`, `tendon`, `baseline`, `posterior`, `trend`, `alarms`, `outbox`, `snapshot`.

mod alarms;
mod baseline;
mod clock;
mod config;
mod evidence;
mod health;
mod ingest;
mod job;
mod online;
mod outbox;
mod posterior;
mod session;
mod setup;
mod snapshot;
mod tendon;
mod trend;

pub use config::{AlarmOptions, ClockChoice, MonitorConfig, MonitorError, Stored, Times};
pub use job::{JobResult, QueuedJob};
pub use trend::HORIZON_DAYS;

use crate::alarm::{Alarm, AlarmCause, Condition, DataFault, StoreFault};
use crate::command::{Command, CommandError, CommandKind};
use crate::instant::Instant;
use crate::journal::{Correction, Event, Maintenance, SessionEnd};
use crate::record::Clock;
use crate::snapshot::RobotSnapshot;
use crate::transaction::{TendonState, Transaction, Without};
use alarms::AlarmEvaluator;
use clock::{ClockEvent, Clocks};
use ingest::Ingest;
use job::{JobKind, Outcome};
use online::Online;
use outbox::Outbox;
use posterior::{ChainOf, Changes, MAX_RECORDS_SINCE, PosteriorChain};
use session::{SegmentEnd, Sessions};
use setup::Setup;
use sinew_log::Frame;
use sinew_model::offset::FeatureConfig;
use snapshot::View;
use std::sync::Arc;
use trend::Trends;

/// Monitor of one robot: a state machine without socket, clock or thread.
///
/// Inputs: [`frame`](Self::frame), [`dropped`](Self::dropped), [`transport_faults`](Self::transport_faults),
/// [`transport`](Self::transport), [`tick`](Self::tick), [`command`](Self::command), [`done`](Self::done),
/// [`committed`](Self::committed), [`store_failed`](Self::store_failed), [`shutdown`](Self::shutdown). Outputs:
/// [`job`](Self::job), [`transaction`](Self::transaction), [`snapshot`](Self::snapshot). After any input there may be
/// outputs to take; no input waits for them.
///
/// | caller | calls |
/// |---|---|
/// | frame thread | `frame` for each; `tick` ten times per second, also without data |
/// | workers | [`QueuedJob::run`], then `done` |
/// | store | stores a transaction as a whole, then `committed` or `store_failed` |
///
/// # Realtime
/// [`Monitor::frame`] does not allocate in steady motion: memory for blocks that wait for their estimate is reserved in
/// [`Monitor::tick`]. Rare events (end of a session, journal entry) may allocate.
#[derive(Debug)]
pub struct Monitor {
    setup: Setup,
    ingest: Ingest,
    sessions: Sessions,
    online: Online,
    chain: PosteriorChain,
    trends: Trends,
    alarms: AlarmEvaluator,
    outbox: Outbox,
    /// Changes found since the last [`Monitor::take_changes`].
    found: Vec<(String, f64)>,
    /// Time since which the offset of each tendon has not been valid; `None`: valid.
    not_valid_since: Vec<Option<Instant>>,
    /// Whether a job is running.
    working: bool,
    /// Time of the last tick.
    ticked: Instant,
}

impl Monitor {
    /// Creates a monitor that resumes from its stored state.
    ///
    /// # Errors
    /// Returns a [`MonitorError`] if the configuration is invalid. Stored data never prevent the start: a state of
    /// another robot is ignored and noted in the journal.
    pub fn new(
        config: MonitorConfig,
        mut stored: Stored,
        now: Instant,
    ) -> Result<Self, MonitorError> {
        let setup = Setup::new(config)?;
        let restored = stored.state.is_some();
        let (chain, left) = PosteriorChain::new(&setup, stored.state.take())?;
        let config = &setup.config;
        let block_s = FeatureConfig::default().block_s;
        let begun = chain.state().sessions;
        let ingest = Ingest::new(&setup, now);
        let recorder = &ingest.recorder;
        let mut monitor = Self {
            sessions: Sessions::new(setup.joints(), block_s, begun, config.times),
            online: Online::new(&setup.robot, &config.estimate, chain.state(), recorder)?,
            ingest,
            outbox: Outbox::new(&config.name, &mut stored),
            trends: Trends::new(setup.names.len(), stored.history),
            alarms: AlarmEvaluator::new(stored.alarms, now),
            found: Vec::new(),
            not_valid_since: vec![Some(now); setup.names.len()],
            working: false,
            ticked: now,
            chain,
            setup,
        };
        monitor.outbox.event(Event::Started { restored }, now);
        if let Some(reason) = left {
            monitor
                .outbox
                .event(Event::StoredStateIgnored { reason }, now);
        }
        monitor.evaluate_state();
        monitor.tick(now);
        Ok(monitor)
    }

    /// Replaces the configuration of the same robot at run time without loss of samples. A baseline in it is used only
    /// if there is no posterior yet.
    ///
    /// # Errors
    /// Returns a [`MonitorError`] if the configuration is invalid or belongs to another robot; nothing has changed
    /// then.
    pub fn reload(&mut self, config: MonitorConfig, now: Instant) -> Result<(), MonitorError> {
        self.setup.reload(config)?;
        self.ingest.clocks.set_choice(self.setup.config.clock);
        self.sessions.set_times(self.setup.config.times);
        self.trends.all_changed();
        self.evaluate_state();
        self.outbox.event(Event::Reloaded, now);
        self.tick(now);
        Ok(())
    }

    /// Ingests a frame of the robot's joints, in the order of [`MonitorConfig::robot`].
    ///
    /// # Realtime
    /// No allocation in steady motion, no lock and no clock access; see [`Monitor`].
    pub fn frame(&mut self, frame: &Frame, now: Instant) {
        self.watch_clock(now);
        if let Some(after_s) = self.ingest.data_arrived(now) {
            self.outbox.event(Event::Back { after_s }, now);
            if self.sessions.now().is_none() {
                self.sessions.back();
                self.online.discard_answer();
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

    /// Notes messages that a full queue dropped before they became frames.
    pub fn dropped(&mut self, messages: u64, now: Instant) {
        self.outbox.dropped = self.outbox.dropped.saturating_add(messages);
        self.ingest.dropped(messages);
        self.sessions.frames(messages, messages);
        self.watch_clock(now);
    }

    /// Ends the session if the civil clock stepped relative to the monotonic clock.
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
            // Repeated blocks of an arm at rest carry no information.
            self.ingest.discard_recording();
            return;
        };
        if let Some(end) = self.sessions.is_over() {
            self.end_session(end, now);
            return;
        }
        if let Some(progress) = &mut self.chain.baseline {
            progress.block(block, moved, block_s);
            if progress.take_ready() {
                self.end_session(SessionEnd::Baseline, now);
                return;
            }
        }
        if self.sessions.is_segment_over() {
            self.end_segment(None);
        }
    }

    /// Ends the present session, if there is one.
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
            self.end_segment(Some(end));
            let duration_s = session.motion_s;
            self.outbox.event(Event::Session { duration_s, end }, now);
        }
        self.sessions.end();
        self.ingest.discard_recording();
    }

    fn end_segment(&mut self, end: Option<SessionEnd>) {
        let how = SegmentEnd {
            end,
            provisional: !self.online.is_settled(),
            motor_current: self.setup.config.estimate.motor_current,
            baseline_of: self.chain.baseline_of(),
        };
        self.outbox.behind_s += self.sessions.end_segment(&mut self.ingest.recorder, how);
    }

    /// Returns the next job; one at a time, because each estimate starts from the previous posterior.
    pub fn job(&mut self) -> Option<QueuedJob> {
        if self.working {
            return None;
        }
        loop {
            if let Some(job) = self.chain.job_without(&self.setup, &self.sessions) {
                self.working = true;
                return Some(job);
            }
            let Some(segment) = self.sessions.next_segment() else {
                break;
            };
            if !self.chain.is_outdated(&segment) {
                if segment.is_estimable() {
                    self.working = true;
                    return Some(self.chain.segment_job(segment, &self.setup));
                }
                let changes = (self.chain).without_motion(&segment, &self.setup, &self.sessions);
                self.pass_on(changes, self.ticked);
            }
            self.chain.forward(segment);
        }
        if let Some(work) = self.online.next_job() {
            self.working = true;
            return Some(QueuedJob {
                robot: Arc::clone(&self.setup.robot),
                work: JobKind::Online(Box::new(work)),
            });
        }
        let (states, tensionings) = (&self.chain.state().tendons, self.chain.tensionings);
        let work = (self.trends).next_job(&self.setup, states, tensionings, self.ticked)?;
        self.working = true;
        Some(QueuedJob {
            robot: Arc::clone(&self.setup.robot),
            work: JobKind::Trend(Box::new(work)),
        })
    }

    /// Accepts the result of a [`QueuedJob`].
    pub fn done(&mut self, done: JobResult, now: Instant) {
        self.working = false;
        match done.0 {
            Outcome::Online(made) => {
                if made.is_none() {
                    self.chain.estimator_error = Some("estimator failed: internal error".into());
                    self.evaluate_data();
                }
                self.online.made(made.map(|made| *made));
                return self.update_validity(now);
            }
            Outcome::Trend(made) => self.trends.set(made, self.chain.tensionings),
            Outcome::Segment {
                segment,
                is_baseline,
                chain,
                result,
            } => {
                let (setup, sessions) = (&self.setup, &self.sessions);
                match self.chain.chain_of(chain) {
                    ChainOf::Present => {
                        let changes =
                            (self.chain).done(&segment, is_baseline, result, setup, sessions);
                        self.pass_on(changes, now);
                        self.chain.forward(*segment);
                    }
                    ChainOf::Without => {
                        (self.chain).done_without(&segment, is_baseline, result, setup, sessions);
                        self.outbox.add_results(Vec::new());
                    }
                    ChainOf::Replaced => self.chain.return_segment(*segment, &mut self.sessions),
                    ChainOf::Discarded => {}
                }
            }
        }
        self.evaluate_state();
        self.tick(now);
    }

    /// Returns the changes found in the segments that were estimated since the last call: joint and time, s since 1970 UTC.
    /// The session decides later whether one is suspected.
    pub fn take_changes(&mut self) -> Vec<(String, f64)> {
        std::mem::take(&mut self.found)
    }

    /// Passes the results of an estimate to the other parts.
    fn pass_on(&mut self, changes: Changes, now: Instant) {
        if let Some((successor, at_once)) = changes.successor {
            self.online.succeed(successor, at_once);
        }
        for event in changes.events {
            self.outbox.event(event, now);
        }
        for (i, time_utc_s) in changes.found {
            self.found.push((self.setup.names[i].clone(), time_utc_s));
        }
        for (i, step) in &changes.steps {
            self.alarms.confirm_step(&self.setup.names[*i], step, now);
        }
        for record in &changes.records {
            self.trends.record(record, &self.setup);
        }
        if changes.state {
            self.outbox.add_results(changes.records);
        }
    }

    fn evaluate_state(&mut self) {
        (self.alarms).evaluate_tendons(&self.setup, &self.chain, &self.trends);
        self.evaluate_data();
    }

    fn evaluate_data(&mut self) {
        let estimator_error = self.chain.estimator_error.as_deref();
        (self.alarms).evaluate_data(&self.setup, &self.ingest.health, estimator_error);
    }

    /// Sets the present reception faults of the transports; empty: no fault.
    pub fn transport_faults(&mut self, faults: &[DataFault], now: Instant) {
        let (health, estimator_error) =
            (&self.ingest.health, self.chain.estimator_error.as_deref());
        if (self.alarms).set_transport_faults(faults, &self.setup, health, estimator_error) {
            self.tick(now);
        }
    }

    /// Sets the state of the robot's transport; if disconnected, its name (`dds:0`) and the error message.
    pub fn transport(&mut self, disconnected: Option<(&str, &str)>, now: Instant) {
        let cause = disconnected.map(|(transport, reason)| AlarmCause::Transport {
            transport: transport.into(),
            reason: reason.into(),
        });
        self.alarms.set_robot(Condition::Transport, cause);
        self.tick(now);
    }

    /// Executes an operator command. The result is published once it is stored.
    ///
    /// # Errors
    /// Returns a [`CommandError`] if the command is invalid or cannot be applied to the alarm; nothing has changed
    /// then.
    pub fn command(&mut self, command: Command, now: Instant) -> Result<(), CommandError> {
        command.check(&self.setup.names)?;
        if let CommandKind::Finding { joint, .. } = &command.what
            && self.chain.state().incidents.open(joint).is_none()
        {
            let joint = joint.clone();
            return Err(CommandError::NoIncident { joint });
        }
        self.watch_clock(now);
        let events = match &command.what {
            CommandKind::Tensioned { joints } | CommandKind::Replaced { joints } => {
                self.end_session(SessionEnd::Command, now);
                let replaced = matches!(command.what, CommandKind::Replaced { .. });
                let who = &command.who;
                let entry = self.chain.record(joints, replaced, who, now.utc_s());
                let kept = self.without(&entry);
                self.tension(&entry, kept, &command, now)
            }
            CommandKind::Withdraw { entry } => self.correct(*entry, None, &command, now)?,
            CommandKind::Correct {
                entry,
                joints,
                time_utc_s,
            } => self.correct(*entry, Some((joints, *time_utc_s)), &command, now)?,
            _ => {
                self.alarms.alarms.command(&command, now)?;
                if let CommandKind::Finding { joint, finding } = &command.what {
                    self.alarms.find(joint, *finding, &command, now);
                }
                self.command_incidents(&command, now)
            }
        };
        self.outbox.event(Event::Command { command }, now);
        for event in events {
            self.outbox.event(event, now);
        }
        self.tick(now);
        Ok(())
    }

    /// Returns what a withdrawal of a new entry replaces.
    fn without(&self, entry: &Maintenance) -> Without {
        // Both chains make the records of a session that is not estimated yet.
        let begun_utc_s = [
            self.chain.estimating_from_utc_s,
            self.sessions.waiting_from_utc_s(),
        ];
        let begun_utc_s = begun_utc_s.into_iter().flatten();
        let since_utc_s = begun_utc_s.fold(entry.recorded_utc_s, f64::min);
        Without {
            entry: entry.number,
            since_utc_s,
            state: Arc::clone(self.chain.state()),
            tendons: self.chain.state().tendons.clone(),
            alarms: Vec::new(),
            steps: Vec::new(),
            day: self.trends.since_day(since_utc_s),
            records: Vec::new(),
        }
    }

    /// Starts the baseline after a re-tensioning or replacement; `command` is its command. Returns the journal entries.
    fn tension(
        &mut self,
        entry: &Maintenance,
        mut kept: Without,
        command: &Command,
        now: Instant,
    ) -> Vec<Event> {
        let before = self.alarms.alarms.stored().alarms;
        // Commands of this kind are not rejected.
        let _never = self.alarms.alarms.command(command, now);
        let ended = |alarm: &Alarm| self.alarms.alarms.get(&alarm.key).is_none();
        kept.alarms.extend(before.into_iter().filter(ended));
        let (setup, sessions) = (&self.setup, &self.sessions);
        let events = (self.chain).tension(entry, kept, (setup, sessions), (command, now));
        for (i, name) in setup.names.iter().enumerate() {
            if entry.joints.contains(name) {
                self.alarms.discard_joint(name);
                self.trends.discard(i);
            }
        }
        self.online.stop();
        self.outbox.add_results(Vec::new());
        events
    }

    /// Corrects joints and date of an entry, or withdraws it. Returns the journal entries.
    fn correct(
        &mut self,
        number: u64,
        corrected: Option<(&Vec<String>, f64)>,
        command: &Command,
        now: Instant,
    ) -> Result<Vec<Event>, CommandError> {
        let entry = self.chain.entry(number);
        let was = entry
            .ok_or(CommandError::NoEntry { entry: number })?
            .clone();
        let mut entry = Maintenance {
            correction: Some(Correction {
                who: command.who.clone(),
                time_utc_s: now.utc_s(),
                withdrawn: corrected.is_none(),
            }),
            ..was.clone()
        };
        if let Some((joints, time_utc_s)) = corrected {
            let (after_utc_s, recorded_utc_s) =
                (was.after_utc_s.unwrap_or(0.0), was.recorded_utc_s);
            if !(after_utc_s..=recorded_utc_s).contains(&time_utc_s) {
                return Err(CommandError::Date {
                    time_utc_s,
                    after_utc_s,
                    recorded_utc_s,
                });
            }
            (entry.joints, entry.time_utc_s) = (joints.clone(), time_utc_s);
        }
        // The order and repetitions of names do not matter.
        let contains =
            |a: &Maintenance, b: &Maintenance| b.joints.iter().all(|j| a.joints.contains(j));
        let is_dated = contains(&entry, &was) && contains(&was, &entry);
        let mut events = Vec::new();
        if corrected.is_some() && is_dated {
            self.chain.set_date(&was, entry.time_utc_s);
            self.chain.correct(&entry);
            self.trends.all_changed();
            self.outbox.add_results(Vec::new());
        } else {
            if self.chain.state().without.as_ref().map(|w| w.entry) != Some(number) {
                return Err(CommandError::TooLate {
                    entry: number,
                    most: MAX_RECORDS_SINCE,
                });
            }
            self.end_session(SessionEnd::Command, now);
            if let Some(mut kept) = self.withdraw(&was, now) {
                self.chain.correct(&entry);
                if corrected.is_some() {
                    // Sessions since the work refer to a baseline before it.
                    kept.tendons = self.tendons_before(&entry, kept.tendons);
                    kept.alarms.clear();
                    let what = match entry.replaced {
                        true => CommandKind::Replaced {
                            joints: entry.joints.clone(),
                        },
                        false => CommandKind::Tensioned {
                            joints: entry.joints.clone(),
                        },
                    };
                    let command = Command {
                        what,
                        ..command.clone()
                    };
                    events = self.tension(&entry, kept, &command, now);
                }
            }
            self.evaluate_state();
        }
        events.push(Event::Maintenance { maintenance: entry });
        Ok(events)
    }

    /// Returns the states of the tendons, those of an entry as before the work.
    fn tendons_before(&self, entry: &Maintenance, before: Vec<TendonState>) -> Vec<TendonState> {
        let now = self.chain.state().tendons.iter().cloned();
        let both = now.zip(before);
        both.map(|(now, before)| match entry.joints.contains(&now.joint) {
            true => before,
            false => now,
        })
        .collect()
    }

    /// Continues as if an entry had not been recorded.
    fn withdraw(&mut self, entry: &Maintenance, now: Instant) -> Option<Without> {
        let kept = (self.chain).withdraw(entry.number, &self.setup, &mut self.sessions)?;
        self.trends.withdraw(&kept);
        let (robot, options) = (&self.setup.robot, &self.setup.config.estimate);
        self.online.restart(robot, options, self.chain.state());
        for joint in &entry.joints {
            self.alarms.discard_joint(joint);
        }
        for alarm in &kept.alarms {
            self.alarms.alarms.put_back(alarm, now);
        }
        for (i, step) in &kept.steps {
            let joint = self.setup.names.get(*i);
            // A finding or a reset may have closed the incident since.
            let is_open = |joint: &&String| self.chain.state().incidents.open(joint).is_some();
            if let Some(joint) = joint.filter(is_open) {
                self.alarms.confirm_step(joint, step, now);
            }
        }
        (self.outbox).replace_results(kept.since_utc_s, kept.records.clone());
        Some(kept)
    }

    /// Executes a command on the incidents, after the alarms. Returns the journal entries.
    fn command_incidents(&mut self, command: &Command, now: Instant) -> Vec<Event> {
        let ended = match &command.what {
            CommandKind::Reset { alarm } => {
                let joint = alarm.joint.as_deref();
                let tendon = joint.and_then(|joint| self.setup.tendon_of(joint));
                let state = tendon.and_then(|i| self.chain.state().tendons.get(i));
                state.is_some_and(|tendon| tendon.suspected.is_none())
                    && !self.alarms.alarms.iter().any(|other| {
                        let key = &other.key;
                        key.joint == alarm.joint && key.condition.is_change() && other.is_active()
                    })
            }
            _ => false,
        };
        let events = self.chain.command(command, ended, now.utc_s());
        if !events.is_empty() {
            self.outbox.add_results(Vec::new());
            self.evaluate_state();
        }
        events
    }

    /// Advances time: staleness, delays, ends of shelving and sessions. Reserves memory for coming blocks.
    pub fn tick(&mut self, now: Instant) {
        self.ticked = now;
        self.time_passes(now);
        self.update_validity(now);
        self.alarms.tick(&self.setup.config.alarms, now);
        self.sessions.make_room(&mut self.ingest.recorder);
        self.online.make_room(&self.ingest.recorder);
        let transitions = self.alarms.alarms.take_transitions();
        let changed = self.alarms.alarms.take_changed() || !transitions.is_empty();
        let alarms = changed.then(|| self.alarms.alarms.stored());
        (self.outbox).flush(self.chain.state(), transitions, alarms, now);
    }

    /// Updates staleness, session timeouts and loss reports.
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
            self.evaluate_data();
        }
        if let Some(for_s) = self.online.provisional_s() {
            let cause = AlarmCause::Provisional { for_s };
            let cause = (for_s >= self.setup.config.alarms.provisional_s).then_some(cause);
            self.alarms.set_robot(Condition::SuspectedStep, cause);
        }
        self.outbox.report_losses(now);
    }

    /// Ends the session because the monitor stops. Remaining jobs and transactions should be completed.
    pub fn shutdown(&mut self, now: Instant) {
        self.end_session(SessionEnd::Shutdown, now);
        self.tick(now);
    }

    /// Returns the next transaction to store; one at a time.
    pub fn transaction(&mut self) -> Option<Transaction> {
        self.outbox.take()
    }

    /// Notes that a transaction was stored.
    pub fn committed(&mut self, id: u64, now: Instant) {
        if self.outbox.committed(id) {
            self.alarms.set_robot(Condition::Store, None);
            self.alarms.tick(&self.setup.config.alarms, now);
        }
    }

    /// Notes that a transaction could not be stored; it is returned again with the next one.
    pub fn store_failed(&mut self, id: u64, fault: StoreFault, reason: &str, now: Instant) {
        if self.outbox.store_failed(id) {
            let reason = reason.into();
            let cause = AlarmCause::Store { fault, reason };
            self.alarms.set_robot(Condition::Store, Some(cause));
            self.alarms.tick(&self.setup.config.alarms, now);
        }
    }

    /// Returns the present state. Alarms and records are the stored ones; while the store fails, unstored alarms are
    /// included.
    pub fn snapshot(&self, now: Instant) -> RobotSnapshot {
        View::new(self, now).robot()
    }
}
