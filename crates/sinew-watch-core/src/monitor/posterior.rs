//! Posterior of the tendons: a chain of estimates, each starting from the previous posterior.

use super::baseline::BaselineProgress;
use super::config::MonitorError;
use super::evidence::SuspectedChangeState;
use super::job::{BaselineTask, Estimated, JobKind, QueuedJob, SegmentJob};
use super::online::Successor;
use super::session::{Segment, Sessions};
use super::setup::Setup;
use super::tendon::{
    DatedChange, PendingTensioning, SessionResult, SuspectedChange, transmission_loss,
};
use crate::command::{Command, CommandKind};
use crate::incident::{CauseProbability, Evidence, Incident, IncidentCause, Incidents};
use crate::instant::Instant;
use crate::journal::{BaselineWaits, Event, Maintenance, STATE_OF_ANOTHER_ROBOT, SessionEnd};
use crate::record::{NoOffset, Record};
use crate::transaction::{BaselineAcquisition, MonitorState, PendingEvent, TendonState, Without};
use sinew_estimate::session::{self, SessionEstimate, Since, estimator};
use sinew_files::date::{DAY_S, utc_text};
use sinew_model::Gaussian;
use std::sync::Arc;

/// Relative stiffness, minus 1, of a session without an estimate.
const DEFAULT_STIFFNESS: Gaussian = Gaussian {
    mean: 0.0,
    std: 1.0,
};
/// Minimum duration of motion of a session for an offset, s.
const MIN_MOTION_S: f64 = 10.0;

/// Maximum number of records after an entry that can be withdrawn: four weeks of ten sessions a day of seven tendons.
pub(super) const MAX_RECORDS_SINCE: usize = 2000;
/// Maximum number of recorded re-tensionings and replacements of a robot; the oldest are discarded.
const MAX_MAINTENANCE: usize = 100;

/// Posterior of the tendons and estimates in progress.
///
/// After a recorded re-tensioning or replacement, a second chain continues without it. Every segment is estimated by both,
/// so that a withdrawn entry has no effect on the estimates that follow.
#[derive(Debug)]
pub(super) struct PosteriorChain {
    /// Number of the chain, which identifies its jobs.
    id: u32,
    /// Job in progress of a chain that a withdrawal replaced.
    replaced: Option<ReplacedJob>,
    /// Chain without the last entry; its state is that of [`Without`].
    without: Option<Box<PosteriorChain>>,
    /// Segment that the chain without the last entry has yet to estimate.
    forwarded: Option<Box<Segment>>,
    state: Arc<MonitorState>,
    /// Results of the present session so far.
    current: SessionProgress,
    /// Baseline acquisition in progress.
    pub(super) baseline: Option<BaselineProgress>,
    /// Number of tensionings since the monitor started.
    pub(super) tensionings: u32,
    /// Tensionings that await the result of the session before them.
    pending: Vec<PendingTensioning>,
    /// Whether a segment that does not belong to a baseline is being estimated.
    is_estimating: bool,
    /// Start of the session of which a segment is being estimated, s since 1970 UTC.
    pub(super) estimating_from_utc_s: Option<f64>,
    /// Error of the estimator in the last segment.
    pub(super) estimator_error: Option<String>,
}

/// Job of a chain that was replaced before the job was done.
#[derive(Debug, Clone, Copy)]
struct ReplacedJob {
    /// Number of the chain.
    id: u32,
    /// Number of the tensioning whose baseline the segment belongs to after the withdrawal, if any.
    baseline_of: Option<u32>,
}

/// Chain to which the result of a job belongs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ChainOf {
    /// The present chain.
    Present,
    /// The chain without the last entry.
    Without,
    /// A chain that was replaced by a withdrawal; the present one has yet to estimate the segment.
    Replaced,
    /// A chain that was discarded.
    Discarded,
}

/// Results of the segments of a session so far.
#[derive(Debug, Clone, Default)]
struct SessionProgress {
    /// Number of the session.
    session: u64,
    /// Last estimate of the session.
    estimate: Option<SessionEstimate>,
    /// Step changes of each tendon.
    changes: Vec<Vec<DatedChange>>,
}

/// Changes by an estimate, for the other parts of the monitor.
#[derive(Debug, Default)]
pub(super) struct Changes {
    pub(super) events: Vec<Event>,
    /// Successor of the online estimator, and whether it takes over immediately.
    pub(super) successor: Option<(Successor, bool)>,
    /// Changes found in the segment: tendon index and time, s since 1970 UTC.
    pub(super) found: Vec<(usize, f64)>,
    /// Confirmed step changes with their tendon index.
    pub(super) steps: Vec<(usize, PendingEvent)>,
    pub(super) records: Vec<Record>,
    /// Whether the state changed.
    pub(super) state: bool,
}

impl PosteriorChain {
    /// Creates a chain that resumes from the stored state; also returns the reason if that state is ignored.
    pub(super) fn new(
        setup: &Setup,
        stored: Option<MonitorState>,
    ) -> Result<(Self, Option<String>), MonitorError> {
        let (state, ignored) = begin(setup, stored)?;
        let without = state.without.as_ref().map(|without| {
            let state = Arc::clone(&without.state);
            Box::new(Self::of(1, state, setup))
        });
        let chain = Self {
            without,
            ..Self::of(0, Arc::new(state), setup)
        };
        Ok((chain, ignored))
    }

    /// Creates a chain that resumes from a state.
    fn of(id: u32, state: Arc<MonitorState>, setup: &Setup) -> Self {
        Self {
            id,
            replaced: None,
            without: None,
            forwarded: None,
            current: SessionProgress::default(),
            baseline: BaselineProgress::of(&state, setup.joints()),
            tensionings: 0,
            pending: Vec::new(),
            is_estimating: false,
            estimating_from_utc_s: None,
            estimator_error: None,
            state,
        }
    }

    /// Returns a copy that continues without the next entry.
    fn fork(&self, setup: &Setup) -> Self {
        let mut state = MonitorState::clone(&self.state);
        state.without = None;
        Self {
            current: self.current.clone(),
            pending: self.pending.clone(),
            tensionings: self.tensionings,
            ..Self::of(self.id.max(self.id_without()) + 1, Arc::new(state), setup)
        }
    }

    fn id_without(&self) -> u32 {
        self.without.as_ref().map_or(0, |chain| chain.id)
    }

    /// Returns the chain of a job.
    pub(super) fn chain_of(&self, id: u32) -> ChainOf {
        match id {
            id if id == self.id => ChainOf::Present,
            id if self.without.is_some() && id == self.id_without() => ChainOf::Without,
            id if self.replaced.is_some_and(|job| job.id == id) => ChainOf::Replaced,
            _ => ChainOf::Discarded,
        }
    }

    /// Forwards a segment to the chain without the last entry, if there is one.
    pub(super) fn forward(&mut self, mut segment: Segment) {
        if let Some(chain) = &self.without {
            segment.baseline_of = chain.baseline_of();
            self.forwarded = Some(Box::new(segment));
        }
    }

    /// Returns the next job of the chain without the last entry. A segment without motion needs no job.
    pub(super) fn job_without(&mut self, setup: &Setup, sessions: &Sessions) -> Option<QueuedJob> {
        let segment = *self.forwarded.take()?;
        let chain = self.without.as_mut()?;
        if segment.is_estimable() {
            return Some(chain.segment_job(segment, setup));
        }
        let changes = chain.without_motion(&segment, setup, sessions);
        self.keep(changes);
        None
    }

    /// Accepts an estimate of the chain without the last entry.
    pub(super) fn done_without(
        &mut self,
        segment: &Segment,
        is_baseline: bool,
        result: Result<Box<Estimated>, String>,
        setup: &Setup,
        sessions: &Sessions,
    ) {
        if let Some(chain) = &mut self.without {
            let changes = chain.done(segment, is_baseline, result, setup, sessions);
            self.keep(changes);
        }
    }

    /// Keeps the results of the chain without the last entry for a withdrawal.
    fn keep(&mut self, changes: Changes) {
        let Some(chain) = &self.without else { return };
        let state = Arc::make_mut(&mut self.state);
        if let Some(kept) = &mut state.without {
            kept.state = Arc::clone(&chain.state);
            kept.records.extend(changes.records);
            kept.steps.extend(changes.steps);
            if kept.records.len() > MAX_RECORDS_SINCE {
                (state.without, self.without) = (None, None);
            }
        }
    }

    /// Continues without the last entry. Returns what is to be replaced; `None`: its state is not available any more.
    pub(super) fn withdraw(
        &mut self,
        entry: u64,
        setup: &Setup,
        sessions: &mut Sessions,
    ) -> Option<Without> {
        self.state.without.as_ref().filter(|w| w.entry == entry)?;
        let mut chain = *self.without.take()?;
        let kept = *Arc::make_mut(&mut self.state).without.take()?;
        let state = Arc::make_mut(&mut chain.state);
        state.maintenance.clone_from(&self.state.maintenance);
        state.sessions = state.sessions.max(self.state.sessions);
        state.incidents.continue_numbers(&self.state.incidents);
        chain.baseline = BaselineProgress::of(state, setup.joints());
        chain.tensionings = chain.tensionings.max(self.tensionings) + 1;
        let baseline_of = chain.baseline_of();
        let id = match self.estimating_from_utc_s {
            Some(_) => Some(self.id),
            None => self.replaced.map(|job| job.id),
        };
        chain.replaced = id.map(|id| ReplacedJob { id, baseline_of });
        if let Some(segment) = self.forwarded.take() {
            sessions.give_back(*segment);
        }
        sessions.set_baseline(baseline_of);
        *self = chain;
        Some(kept)
    }

    /// Puts back the segment of a replaced chain, which the present one has yet to estimate.
    pub(super) fn return_segment(&mut self, mut segment: Segment, sessions: &mut Sessions) {
        segment.baseline_of = self.replaced.take().and_then(|job| job.baseline_of);
        sessions.give_back(segment);
    }

    /// Returns an entry that is not withdrawn.
    pub(super) fn entry(&self, number: u64) -> Option<&Maintenance> {
        let mut all = self.state.maintenance.iter();
        all.find(|entry| entry.number == number && !entry.is_withdrawn())
    }

    /// Replaces an entry by its correction.
    pub(super) fn correct(&mut self, entry: &Maintenance) {
        let state = Arc::make_mut(&mut self.state);
        for own in &mut state.maintenance {
            if own.number == entry.number {
                own.clone_from(entry);
            }
        }
    }

    /// Changes the date of an entry, s since 1970 UTC.
    pub(super) fn set_date(&mut self, entry: &Maintenance, time_utc_s: f64) {
        if let Some(chain) = &mut self.without {
            chain.set_date(entry, time_utc_s);
            self.keep(Changes::default());
        }
        let state = Arc::make_mut(&mut self.state);
        let of_entry = |tendon: &&mut TendonState| entry.joints.contains(&tendon.joint);
        let pending = self.pending.iter_mut();
        let waiting = pending.filter(|pending| pending.utc_s == entry.time_utc_s);
        waiting.for_each(|pending| pending.utc_s = time_utc_s);
        for tendon in state.tendons.iter_mut().filter(of_entry) {
            let dates = tendon.tensioned_utc_s.iter_mut();
            for date in dates.chain(&mut tendon.replaced_utc_s) {
                if *date == entry.time_utc_s {
                    *date = time_utc_s;
                }
            }
        }
    }

    pub(super) fn state(&self) -> &Arc<MonitorState> {
        &self.state
    }

    /// Returns the number of the tensioning whose baseline is being acquired, if any.
    pub(super) fn baseline_of(&self) -> Option<u32> {
        self.baseline.as_ref().map(|_| self.tensionings)
    }

    /// Whether a segment belongs to a baseline that a later re-tensioning made obsolete.
    pub(super) fn is_outdated(&self, segment: &Segment) -> bool {
        segment.baseline_of.is_some_and(|of| of != self.tensionings)
    }

    /// Whether a segment belongs to a baseline that is still being acquired.
    fn is_learning(&self, segment: &Segment) -> bool {
        segment.baseline_of.is_some() && self.state.learns.is_some()
    }

    fn baseline_waits(&mut self, reason: BaselineWaits, setup: &Setup) -> Event {
        // The acquisition restarts from the stored progress.
        self.baseline = BaselineProgress::of(&self.state, setup.joints());
        Event::BaselinePending { reason }
    }

    /// Adds a segment without sufficient motion, which only ends its session.
    pub(super) fn without_motion(
        &mut self,
        segment: &Segment,
        setup: &Setup,
        sessions: &Sessions,
    ) -> Changes {
        match self.is_learning(segment) {
            true => Changes {
                events: vec![self.baseline_waits(BaselineWaits::FewPoses, setup)],
                ..Changes::default()
            },
            false => self.add_segment(segment, Err("too short".into()), setup, sessions),
        }
    }

    /// Returns the estimation job of a segment.
    pub(super) fn segment_job(&mut self, segment: Segment, setup: &Setup) -> QueuedJob {
        self.is_estimating = segment.baseline_of.is_none();
        self.estimating_from_utc_s = Some(segment.session.start.utc_s());
        QueuedJob {
            robot: Arc::clone(&setup.robot),
            work: JobKind::Segment(Box::new(self.segment_inputs(segment, setup))),
        }
    }

    fn segment_inputs(&self, segment: Segment, setup: &Setup) -> SegmentJob {
        let continues =
            self.current.session == segment.session.number && self.current.estimate.is_some();
        let start_utc_s = segment.session.start.utc_s();
        let pause_s = self.state.end_utc_s.map(|end| start_utc_s - end);
        // A baseline from a file counts as one day old; so does one after a backward step of the clock.
        let days = pause_s.filter(|s| *s >= 0.0).map_or(1.0, |s| s / DAY_S);
        let date = utc_text(segment.session.start.utc_ns);
        let date = date.as_deref().unwrap_or("undated");
        let learns = self.state.learns.as_ref();
        let learns = learns.filter(|_| self.is_learning(&segment));
        SegmentJob {
            options: setup.config.estimate,
            baseline: self.state.baseline.clone(),
            since: match continues {
                true => Since::Now,
                false => Since::Days(days),
            },
            baseline_task: learns.map(|so_far| BaselineTask {
                tensioned: (setup.names.iter().zip(&setup.elastic))
                    .filter(|(name, _)| so_far.joints.contains(name))
                    .map(|(_, joint)| *joint)
                    .collect(),
                continues: so_far.duration_s > 0.0,
            }),
            name: format!("{}, {date}", setup.config.name),
            chain: self.id,
            segment,
        }
    }

    /// Accepts the estimate of a segment; `is_baseline`: acquired for a baseline.
    pub(super) fn done(
        &mut self,
        segment: &Segment,
        is_baseline: bool,
        result: Result<Box<Estimated>, String>,
        setup: &Setup,
        sessions: &Sessions,
    ) -> Changes {
        self.is_estimating = false;
        self.estimating_from_utc_s = None;
        match is_baseline {
            true if self.is_outdated(segment) => Changes::default(),
            true => self.add_baseline_segment(segment, result, setup, sessions),
            false => self.add_segment(segment, result, setup, sessions),
        }
    }

    /// Adds a segment after a re-tensioning to the baseline.
    fn add_baseline_segment(
        &mut self,
        segment: &Segment,
        result: Result<Box<Estimated>, String>,
        setup: &Setup,
        sessions: &Sessions,
    ) -> Changes {
        let mut changes = Changes::default();
        let estimated = match result {
            Ok(estimated) => estimated,
            Err(reason) => {
                self.estimator_error = Some(reason);
                let waits = self.baseline_waits(BaselineWaits::Rejected, setup);
                changes.events.push(waits);
                return changes;
            }
        };
        self.estimator_error = None;
        let so_far = BaselineProgress::of(&self.state, setup.joints());
        let so_far = so_far.map(|progress| progress.with(segment));
        let state = Arc::make_mut(&mut self.state);
        state.baseline = Some(estimated.next);
        state.end_utc_s = Some(end_utc_s(segment, setup));
        state.sessions = sessions.count();
        state.learns = so_far.as_ref().map(BaselineProgress::so_far);
        if let Some(ready) = so_far.filter(BaselineProgress::is_ready) {
            state.learns = None;
            self.baseline = None;
            changes.successor = estimated.successor.map(|next| (next, true));
            let poses = ready.poses();
            changes.events.push(Event::Baseline { poses });
        } else if segment.end.is_some() {
            let waits = self.baseline_waits(BaselineWaits::FewPoses, setup);
            changes.events.push(waits);
        }
        changes.state = true;
        changes
    }

    /// Adds the results of a segment; at the end of the session, makes the records.
    fn add_segment(
        &mut self,
        segment: &Segment,
        result: Result<Box<Estimated>, String>,
        setup: &Setup,
        sessions: &Sessions,
    ) -> Changes {
        let mut changes = Changes {
            state: true,
            ..Changes::default()
        };
        let number = segment.session.number;
        if self.current.session != number {
            self.current = SessionProgress {
                session: number,
                estimate: None,
                changes: vec![Vec::new(); setup.names.len()],
            };
        }
        let state = Arc::make_mut(&mut self.state);
        match result {
            Ok(estimated) => {
                let Estimated {
                    estimate,
                    next,
                    successor,
                } = *estimated;
                state.baseline = Some(next);
                state.end_utc_s = Some(end_utc_s(segment, setup));
                self.estimator_error = None;
                let joints = self.current.changes.iter_mut().zip(&estimate.joints);
                for (i, (dated, joint)) in joints.enumerate() {
                    let known = dated.len();
                    dated.extend(joint.changes.iter().map(|change| DatedChange {
                        time_utc_s: civil_utc_s(segment, change.time_s, setup),
                        change: change.clone(),
                    }));
                    // The robot runs on: the alarm does not wait for the end of the session.
                    let (before, found) = dated.split_at(known);
                    let probable = found.iter().filter(|dated| dated.is_probable());
                    changes
                        .found
                        .extend(probable.map(|dated| (i, dated.time_utc_s)));
                    let loss = |dated: &DatedChange| transmission_loss(dated, number);
                    if before.iter().find_map(loss).is_none() {
                        let lost = found.iter().find_map(loss);
                        if let Some((joint, loss)) = setup.names.get(i).zip(lost) {
                            let evidence = Evidence {
                                time_utc_s: loss.0.time_utc_s,
                                offset_rad: None,
                                stiffness_ratio: None,
                                probability: loss.1,
                            };
                            let causes = vec![
                                CauseProbability {
                                    cause: IncidentCause::TransmissionLost,
                                    probability: loss.1,
                                },
                                CauseProbability {
                                    cause: IncidentCause::NoChange,
                                    probability: 1.0 - loss.1,
                                },
                            ];
                            let utc_s = end_utc_s(segment, setup);
                            let incident = state.incidents.confirm(joint, evidence, causes, utc_s);
                            changes.events.push(entry(incident));
                            changes.steps.push((i, loss.0));
                            state.tendons[i].suspected = None;
                        }
                    }
                }
                self.current.estimate = Some(estimate);
                let immediate = segment.end == Some(SessionEnd::Lost);
                let successor = successor.filter(|_| state.learns.is_none());
                changes.successor = successor.map(|next| (next, immediate));
            }
            Err(reason) if segment.has_motion => self.estimator_error = Some(reason),
            Err(_) => {}
        }
        state.sessions = state.sessions.max(number);
        if segment.end.is_some() {
            self.end_session(segment, setup, sessions, &mut changes);
        }
        changes
    }

    /// Makes the records of a completed session and evaluates its step changes.
    fn end_session(
        &mut self,
        segment: &Segment,
        setup: &Setup,
        sessions: &Sessions,
        changes: &mut Changes,
    ) {
        let current = std::mem::take(&mut self.current);
        let state = Arc::make_mut(&mut self.state);
        if let Some(first) = self.pending.first() {
            // The session precedes the re-tensioning: its results come first.
            state.tendons.clone_from(&first.before);
        }
        for (i, tendon) in state.tendons.iter_mut().enumerate() {
            let joint = current.estimate.as_ref().and_then(|e| e.joints.get(i));
            let offset = match joint.map(|joint| joint.offset_rad) {
                _ if segment.session.motion_s < MIN_MOTION_S => Err(NoOffset::TooShort),
                None => Err(NoOffset::Rejected),
                Some(x) if session::Verdict::is_inconclusive(x) => Err(NoOffset::TooWide),
                Some(x) => Ok(x),
            };
            let stiffness = joint.map(|joint| joint.stiffness_change_ratio);
            let result = SessionResult {
                session: segment.session.number,
                start_utc_s: segment.session.start.utc_s(),
                end_utc_s: end_utc_s(segment, setup),
                offset_rad: offset.ok(),
                stiffness_ratio: stiffness.unwrap_or(DEFAULT_STIFFNESS),
            };
            let dated = current.changes.get(i).map_or(&[][..], Vec::as_slice);
            let suspected = tendon.update(&result, dated, setup.geometry(i));
            // A tendon that was repaired since has no incident of a session before.
            let is_repaired = self.pending.iter().any(|pending| pending.is_tensioned(i));
            let incident = state.incidents.open(&tendon.joint);
            let is_lost = incident.is_some_and(Incident::is_transmission_lost);
            if is_lost {
                tendon.suspected = None;
            }
            if let Some(suspected) = suspected.filter(|_| !is_repaired && !is_lost) {
                let incident = follow(&mut state.incidents, &tendon.joint, &suspected);
                changes.events.extend(incident);
                if suspected.state == SuspectedChangeState::Confirmed {
                    changes.steps.push((i, suspected.event));
                }
            }
            let record = record(segment, setup, (i, tendon), offset, stiffness);
            changes.records.push(record);
        }
        if let Some(first) = self.pending.first_mut() {
            first.before.clone_from(&state.tendons);
        }
        for pending in &self.pending {
            pending.apply(&mut state.tendons, setup);
            changes.steps.retain(|(i, _)| !pending.is_tensioned(*i));
        }
        if !sessions.has_waiting() {
            self.pending.clear();
        }
    }

    /// Executes an operator command on the incidents, after the alarms; `ended`: whether no alarm of a change remains at
    /// the joint of a reset alarm. Returns the journal entries.
    pub(super) fn command(&mut self, command: &Command, ended: bool, utc_s: f64) -> Vec<Event> {
        if let Some(chain) = &mut self.without {
            chain.command(command, ended, utc_s);
            self.keep(Changes::default());
        }
        let state = Arc::make_mut(&mut self.state);
        let (incidents, tendons) = (&mut state.incidents, &mut state.tendons);
        let repaired =
            |joint: &String, incidents: &mut Incidents| incidents.repair(joint, utc_s).map(entry);
        match &command.what {
            CommandKind::Acknowledge { alarm } => {
                let joint = alarm
                    .joint
                    .as_deref()
                    .filter(|_| alarm.condition.is_change());
                let incident = joint.and_then(|joint| incidents.acknowledge(joint));
                incident.map(entry).into_iter().collect()
            }
            CommandKind::Reset { alarm } => {
                let is_change = ended && alarm.condition.is_change();
                let joint = alarm.joint.as_deref().filter(|_| is_change);
                let incident = joint.and_then(|joint| incidents.reset(joint, &command.note, utc_s));
                incident.map(entry).into_iter().collect()
            }
            CommandKind::Tensioned { joints } | CommandKind::Replaced { joints } => {
                let events = joints.iter().filter_map(|joint| repaired(joint, incidents));
                events.collect()
            }
            CommandKind::Finding { joint, finding } => {
                // The inspection decides on the suspected change; later sessions add no evidence.
                if let Some(tendon) = tendons.iter_mut().find(|t| t.joint == *joint) {
                    tendon.suspected = None;
                }
                let incident = incidents.find(joint, *finding, &command.note, utc_s);
                incident.map(entry).into_iter().collect()
            }
            CommandKind::Shelve { .. }
            | CommandKind::Unshelve { .. }
            | CommandKind::Withdraw { .. }
            | CommandKind::Correct { .. }
            | CommandKind::Note => Vec::new(),
        }
    }

    /// Adds a recorded re-tensioning or replacement with the next number; its time is that of the entry.
    pub(super) fn record(
        &mut self,
        joints: &[String],
        replaced: bool,
        who: &str,
        utc_s: f64,
    ) -> Maintenance {
        let state = Arc::make_mut(&mut self.state);
        let entry = Maintenance {
            number: state.maintenance.last().map_or(1, |last| last.number + 1),
            joints: joints.to_vec(),
            replaced,
            time_utc_s: utc_s,
            recorded_utc_s: utc_s,
            after_utc_s: state.end_utc_s,
            who: who.into(),
            correction: None,
        };
        state.maintenance.push(entry.clone());
        let excess = state.maintenance.len().saturating_sub(MAX_MAINTENANCE);
        state.maintenance.drain(..excess);
        entry
    }

    /// Starts the next baseline after a re-tensioning or replacement. Another chain continues without the entry.
    ///
    /// * `kept`: what a withdrawal of the entry replaces; its tendons are those before the work.
    /// * `command`: command that repairs the tendons of the entry.
    ///
    /// Returns the journal entries.
    pub(super) fn tension(
        &mut self,
        entry: &Maintenance,
        mut kept: Without,
        (setup, sessions): (&Setup, &Sessions),
        (command, now): (&Command, Instant),
    ) -> Vec<Event> {
        let chain = Box::new(self.fork(setup));
        let events = self.command(command, false, now.utc_s());
        let name = utc_text((1e9 * entry.time_utc_s) as i64).unwrap_or_else(|| "undated".into());
        let is_named = |name: &String| entry.joints.contains(name);
        let pending = PendingTensioning {
            before: kept.tendons.clone(),
            tensioned: setup.names.iter().map(is_named).collect(),
            replaced: entry.replaced,
            precedes: entry.correction.is_some(),
            utc_s: entry.time_utc_s,
            name: format!("tensioned {name}"),
        };
        let state = Arc::make_mut(&mut self.state);
        pending.apply(&mut state.tendons, setup);
        // A re-tensioning during an acquisition restarts the baseline of all ropes concerned.
        let mut joints = state.learns.take().map_or_else(Vec::new, |l| l.joints);
        for name in setup.names.iter().filter(|name| is_named(name)) {
            if !joints.contains(name) {
                joints.push(name.clone());
            }
        }
        state.learns = Some(BaselineAcquisition {
            joints,
            ..BaselineAcquisition::default()
        });
        kept.state = Arc::clone(&chain.state);
        state.without = Some(Box::new(kept));
        self.tensionings += 1;
        self.baseline = BaselineProgress::of(state, setup.joints());
        // The new chain contains the last segment already.
        (self.without, self.forwarded) = (Some(chain), None);
        // Earlier motion is still being estimated or waiting: its final result on the tendons is pending. Segments of a
        // baseline and trends do not affect the tendons.
        let is_replaced = self.replaced.is_some_and(|job| job.baseline_of.is_none());
        if self.is_estimating || is_replaced || sessions.has_waiting() {
            self.pending.push(pending);
        }
        events
    }
}

/// Makes the record of a tendon at the end of a session.
fn record(
    segment: &Segment,
    setup: &Setup,
    (i, tendon): (usize, &TendonState),
    offset: Result<Gaussian, NoOffset>,
    stiffness: Option<Gaussian>,
) -> Record {
    let session = &segment.session;
    let elongation = setup.elongation(i, tendon.before_m, offset.ok());
    let (elongation, strain) = (elongation.map(|s| s.0), elongation.map(|s| s.1));
    let mean = |x: Option<Gaussian>| x.map(|x| x.mean);
    let std = |x: Option<Gaussian>| x.map(|x| x.std);
    Record {
        robot: setup.config.name.clone(),
        robot_type: setup.robot.name.clone(),
        joint: tendon.joint.clone(),
        time_utc_s: session.start.utc_s(),
        duration_s: session.motion_s,
        offset_rad: mean(offset.ok()),
        offset_std_rad: std(offset.ok()),
        elongation_m: mean(elongation),
        elongation_std_m: std(elongation),
        strain_ratio: mean(strain),
        strain_std_ratio: std(strain),
        temperature_c: session.temperature_c(),
        stiffness_ratio: mean(stiffness),
        stiffness_std_ratio: std(stiffness),
        baseline: tendon.since.clone(),
        source: setup.config.source.clone(),
        clock: session.clock,
        provisional: segment.provisional,
        reason: offset.err(),
        poses: session.poses as u64,
        frames: session.frames,
        frames_lost: session.frames_lost,
        sinew_version: env!("CARGO_PKG_VERSION").into(),
    }
}

/// Returns the initial state, and the reason if the stored state is ignored.
fn begin(
    setup: &Setup,
    stored: Option<MonitorState>,
) -> Result<(MonitorState, Option<String>), MonitorError> {
    let Setup {
        config,
        robot,
        names,
        ..
    } = setup;
    let prior = estimator(robot, &config.estimate);
    let prior = prior.prior();
    let first = config.baseline.as_ref();
    let since = first.and_then(|baseline| baseline.recordings.first().cloned());
    if let Some(baseline) = first {
        baseline.state_estimate(robot, prior, "the baseline of the configuration")?;
    }
    let fresh = MonitorState {
        version: MonitorState::VERSION,
        baseline: config.baseline.clone(),
        end_utc_s: None,
        learns: None,
        sessions: 0,
        tendons: (names.iter())
            .map(|name| TendonState::new(name, since.clone()))
            .collect(),
        incidents: Incidents::default(),
        maintenance: Vec::new(),
        without: None,
    };
    let Some(mut stored) = stored else {
        return Ok((fresh, None));
    };
    let same = stored.tendons.iter().map(|t| &t.joint).eq(names);
    if !(1..=MonitorState::VERSION).contains(&stored.version) || !same {
        return Ok((fresh, Some(STATE_OF_ANOTHER_ROBOT.into())));
    }
    stored.version = MonitorState::VERSION;
    let fits = stored.baseline.as_ref().map(|baseline| {
        let state_estimate = baseline.state_estimate(robot, prior, "the stored posterior");
        state_estimate.map(|_| ())
    });
    if let Some(Err(error)) = fits {
        // The dates of tensioning remain valid; the posterior of the robot does not.
        stored.baseline = fresh.baseline;
        stored.end_utc_s = None;
        stored.without = None;
        for tendon in &mut stored.tendons {
            tendon.since.clone_from(&since);
            tendon.discard_last();
        }
        return Ok((stored, Some(error.to_string())));
    }
    Ok((stored, None))
}

/// Returns the civil time of a time of the recording, s since 1970 UTC: start by the civil clock plus time stamps of the
/// blocks at the rate of the civil clock.
fn civil_utc_s(segment: &Segment, time_s: f64, setup: &Setup) -> f64 {
    segment.session.start.utc_s() + setup.config.clock.civil_rate() * time_s
}

/// Returns the end of a segment, s since 1970 UTC.
fn end_utc_s(segment: &Segment, setup: &Setup) -> f64 {
    let last_s = segment.recorded.blocks.last().map_or(0.0, |b| b.time_s);
    civil_utc_s(segment, last_s, setup)
}

/// Returns the journal entry of an incident.
fn entry(incident: &Incident) -> Event {
    Event::Incident {
        incident: incident.clone(),
    }
}

/// Adds a suspected change to the incident of its tendon; returns the journal entry of a new or changed phase.
fn follow(incidents: &mut Incidents, joint: &str, suspected: &SuspectedChange) -> Option<Event> {
    let SuspectedChange {
        event,
        posterior,
        evidence,
        state,
    } = *suspected;
    let (causes, utc_s) = (event.causes(posterior), evidence.time_utc_s);
    let was_open = incidents.open(joint).map(|incident| incident.number);
    match state {
        SuspectedChangeState::Open => {
            let incident = incidents.suspect(joint, evidence, causes, utc_s);
            (was_open != Some(incident.number)).then(|| entry(incident))
        }
        SuspectedChangeState::Confirmed => {
            Some(entry(incidents.confirm(joint, evidence, causes, utc_s)))
        }
        SuspectedChangeState::Refuted => {
            incidents.refute(joint, evidence, causes, utc_s).map(entry)
        }
    }
}
