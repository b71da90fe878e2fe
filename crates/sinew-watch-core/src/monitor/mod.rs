//! The monitor of one robot: inputs, each with the [`Instant`] it came; outputs, when asked.
//!
//! ```text
//!  frame, dropped ─▶ recorder ─▶ block ─▶ recursive filter ─────────────────▶ snapshot (the number now)
//!                                  └────▶ session ─▶ stretch ─▶ Job … Done ─▶ records, belief, alarms
//!  tick, troubles, command ─────────────────────────────────▶ alarms, journal ─▶ Transaction … committed
//! ```
//!
//! Reading order: `config`, this file (inputs and outputs), `clock`, `health` (what to believe of them),
//! `session`, `job`, `learn` (what an estimate changes), `tendon`, `limits`, `judge` (alarms), `history`,
//! `trend`, `outbox`, `show`.

mod clock;
mod config;
mod health;
mod history;
mod job;
mod judge;
mod learn;
mod limits;
mod live;
mod obey;
mod outbox;
mod session;
mod show;
mod take;
mod tell;
mod tendon;
mod tendon_trend;
mod trend;

pub use config::{AlarmOptions, ClockChoice, MonitorConfig, MonitorError, Stored, Times};
pub use history::History;
pub use job::{Done, Job};
pub use tendon_trend::HORIZON_DAYS;

use crate::alarm::{Alarms, StoreFault, Trouble};
use crate::instant::Instant;
use crate::journal::{Entry, Event};
use crate::record::Record;
use crate::transaction::{Belief, Transaction};
use clock::Clocks;
use health::Health;
use job::Stretch;
use judge::Conditions;
use learn::{Heard, Learning};
use limits::Limits;
use live::Live;
use outbox::Outbox;
use session::Sessions;
use sinew_estimate::session::{Recorded, Recorder};
use sinew_model::offset::FeatureConfig;
use sinew_model::robot::Robot;
use std::collections::VecDeque;
use std::sync::Arc;
use tendon::Pending;
use trend::Trends;

/// The monitor of one robot: a state machine without socket, clock or thread.
///
/// Inputs: [`frame`](Self::frame), [`dropped`](Self::dropped), [`troubles`](Self::troubles), [`tick`](Self::tick),
/// [`command`](Self::command), [`done`](Self::done), [`committed`](Self::committed), [`refused`](Self::refused),
/// [`shutdown`](Self::shutdown). Outputs: [`job`](Self::job), [`transaction`](Self::transaction),
/// [`snapshot`](Self::snapshot). After any input there may be outputs to take; nothing waits for them.
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
    config: MonitorConfig,
    /// The robot with the limits its ropes' makers state.
    robot: Arc<Robot>,
    /// Joints with a tendon, and their names.
    elastic: Vec<usize>,
    names: Vec<String>,
    limits: Vec<Limits>,

    clocks: Clocks,
    health: Health,
    recorder: Recorder,
    sessions: Sessions,
    feed: Feed,
    live: Live,

    /// Stretches that wait for their estimate, the oldest first.
    waiting: VecDeque<Stretch>,
    /// What the next stretch is recorded into.
    empty: Option<Recorded>,
    /// Whether a job is under way.
    working: bool,
    /// Whether that is the estimate of motion from before the last tensioning, whose last word on the tendons is to come.
    hears: bool,

    belief: Arc<Belief>,
    /// What the session under way said so far, tendon by tendon.
    heard: Heard,
    /// A baseline on its way.
    learning: Option<Learning>,
    /// Tensionings since the monitor began.
    tensionings: u32,
    /// Tensionings whose tendons wait for the last word on what was before.
    pending: Vec<Pending>,

    alarms: Alarms,
    conditions: Conditions,
    doors: Vec<Trouble>,
    refusal: Option<String>,
    history: History,
    trends: Trends,

    journal: Vec<Entry>,
    /// What goes into the next transaction beside the journal.
    unstored: Unstored,
    outbox: Outbox,
    /// Whether the store refused the last transaction.
    store_fails: bool,
    /// When losses were last told.
    told_losses: Option<Instant>,
}

/// What goes into the next transaction.
#[derive(Debug, Default)]
struct Unstored {
    records: Vec<Record>,
    /// Whether the belief is another one.
    belief: bool,
}

/// What came, and when.
#[derive(Debug, Default)]
struct Feed {
    frames: u64,
    frames_lost: u64,
    dropped: u64,
    first: Option<Instant>,
    /// Of the last frame.
    last: Option<Instant>,
    silent: bool,
    started: Option<Instant>,
    /// The last tick.
    ticked: Option<Instant>,
    /// Stamp of the recording's zero, ns.
    zero_ns: Option<i64>,
    /// Stamp of the last frame, ns.
    stamp_ns: i64,
    /// When the first frame of what is recorded now came.
    recorded_from: Option<Instant>,
    /// Refused for their stamps, one after the other.
    backwards: u32,
    /// Blocks of the stretch under way that moved.
    moved_blocks: usize,
    blocks: usize,
    temperature_c: Option<f64>,
    /// Motion that was not estimated, s.
    behind_s: f64,
}

impl Monitor {
    /// A monitor that goes on from what was stored.
    ///
    /// # Errors
    /// [`MonitorError`]: a configuration that can't be. What is stored never keeps a monitor from starting: a belief
    /// of another robot is left alone, and the journal says so.
    pub fn new(config: MonitorConfig, stored: Stored, now: Instant) -> Result<Self, MonitorError> {
        config.check()?;
        let (robot, limits) = limits::with_limits(&config.robot, &config.catalogue)?;
        let robot = Arc::new(robot);
        let joints = robot.transmissions.iter().enumerate();
        let elastic: Vec<usize> = joints
            .filter(|(_, t)| t.is_some())
            .map(|(i, _)| i)
            .collect();
        if elastic.is_empty() {
            return Err(MonitorError::NoTendon);
        }
        let names: Vec<String> = (elastic.iter())
            .map(|&i| robot.joint_names()[i].clone())
            .collect();
        let limits = elastic.iter().map(|&i| limits[i]).collect();
        let features = FeatureConfig::default();
        let restored = stored.belief.is_some();
        let (belief, left) = learn::begin(&config, &robot, &names, stored.belief)?;
        let mut history = stored.history;
        let mut outbox = Outbox::new(&config.name, stored.last_id, stored.alarms.clone());
        outbox.last = history.take_last();
        let mut monitor = Self {
            clocks: Clocks::new(config.clock),
            health: Health::new(elastic.clone()),
            recorder: Recorder::new(&robot, &features, config.times.gap_s),
            sessions: Sessions::new(robot.arm.dof(), features.block_s, belief.sessions),
            feed: Feed {
                started: Some(now),
                ..Feed::default()
            },
            live: Live::new(&robot, &config.estimate, &belief)?,
            waiting: VecDeque::with_capacity(take::STRETCHES_WAITING + 1),
            empty: None,
            working: false,
            hears: false,
            heard: Heard::default(),
            tensionings: 0,
            learning: Learning::of(&belief, robot.arm.dof()),
            pending: Vec::new(),
            alarms: Alarms::restore(stored.alarms, now),
            conditions: Conditions::default(),
            doors: Vec::new(),
            refusal: None,
            trends: Trends::new(names.len()),
            history,
            journal: Vec::with_capacity(tell::JOURNAL_ROOM),
            unstored: Unstored::default(),
            store_fails: false,
            told_losses: None,
            outbox,
            belief: Arc::new(belief),
            config,
            robot,
            elastic,
            names,
            limits,
        };
        monitor.set_times();
        monitor.event(Event::Started { restored }, now);
        if let Some(why) = left {
            monitor.event(Event::BeliefLeft { why }, now);
        }
        monitor.judge_beliefs();
        monitor.tick(now);
        Ok(monitor)
    }

    fn set_times(&mut self) {
        let times = self.config.times;
        self.sessions
            .set_length(times.session_motion_s, times.session_pause_s);
    }

    /// Takes another configuration of the same robot while it runs; not a sample is lost. A baseline in it counts
    /// only where nothing was learned.
    ///
    /// # Errors
    /// [`MonitorError`]; everything is as before then.
    pub fn reload(&mut self, config: MonitorConfig, now: Instant) -> Result<(), MonitorError> {
        config.check()?;
        let same = config.name == self.config.name
            && config.robot.arm == self.config.robot.arm
            && learn::is_same_drive(&config.robot, &self.config.robot)
            && config.times.gap_s == self.config.times.gap_s;
        if !same {
            return Err(MonitorError::AnotherRobot);
        }
        let (robot, limits) = limits::with_limits(&config.robot, &config.catalogue)?;
        self.robot = Arc::new(robot);
        self.limits = self.elastic.iter().map(|&i| limits[i]).collect();
        self.clocks.set_choice(config.clock);
        self.config = config;
        self.set_times();
        self.trends.all_changed();
        self.judge_beliefs();
        self.event(Event::Reloaded, now);
        self.tick(now);
        Ok(())
    }

    /// Takes note of time: staleness, delays, ends of shelves and sessions. Makes room for what comes.
    pub fn tick(&mut self, now: Instant) {
        self.feed.ticked = Some(now);
        self.time_passes(now);
        self.judge(now);
        self.make_room();
        self.flush(now);
    }

    /// The monitor ends: the session does too. Jobs and transactions that are left are worth waiting for.
    pub fn shutdown(&mut self, now: Instant) {
        self.end_session(crate::journal::SessionEnd::Shutdown, now);
        self.tick(now);
    }

    /// The next transaction to store; one at a time.
    pub fn transaction(&mut self) -> Option<Transaction> {
        self.outbox.take()
    }

    /// A transaction is stored.
    pub fn committed(&mut self, id: u64, now: Instant) {
        if self.outbox.committed(id) {
            self.store_trouble(None, now);
        }
    }

    /// A transaction could not be stored; it is handed out again with the next one.
    pub fn refused(&mut self, id: u64, fault: StoreFault, why: &str, now: Instant) {
        if self.outbox.refused(id) {
            self.store_trouble(Some((fault, why)), now);
        }
    }
}
