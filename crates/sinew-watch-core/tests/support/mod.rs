//! Test harness: a monitor with frames, clock, worker and store.

// Each test file uses a part of this module.
#![allow(dead_code)]

use sinew_estimate::baseline::Baseline;
use sinew_estimate::robot_dir;
use sinew_estimate::session::{self, Learning, Recorded, Recorder};
use sinew_log::Frame;
use sinew_model::offset::FeatureConfig;
use sinew_model::robot::Robot;
use sinew_rope::Catalogue;
use sinew_sim::{Scenario, Simulation};
use sinew_watch_core::alarm::{AlarmKey, AlarmState, Condition, StoreFault};
use sinew_watch_core::command::{Command, CommandError, CommandKind};
use sinew_watch_core::journal::{Entry, Event};
use sinew_watch_core::{
    History, Instant, Monitor, MonitorConfig, MonitorState, Record, RobotSnapshot, Stored,
    Transaction,
};
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

/// Root folder of the repository.
pub(crate) fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Shipped robot `biorob-like`.
pub(crate) fn biorob_like() -> Arc<Robot> {
    let folder = repository().join("robots/biorob-like");
    Arc::new(robot_dir::load(&folder, None).unwrap().robot)
}

/// Default configuration of a robot.
pub(crate) fn config(robot: &Arc<Robot>) -> MonitorConfig {
    let catalogue = Arc::new(Catalogue::shipped().unwrap());
    MonitorConfig::new("arm-7", "test", Arc::clone(robot), catalogue)
}

/// Frames of a work session with the scenario modified by `edit`, 250 Hz.
pub(crate) fn frames(
    robot: &Robot,
    seed: u64,
    duration_s: f64,
    edit: impl Fn(String) -> String,
) -> Vec<Frame> {
    let place = repository().join("examples/scenarios/work-session.toml");
    let text = std::fs::read_to_string(place).unwrap();
    let text = text.replace(
        "duration_s = 180.0",
        &format!("duration_s = {duration_s:?}"),
    );
    let mut scenario = Scenario::from_toml(&edit(text), "work-session.toml").unwrap();
    scenario.seed = seed;
    let mut simulation = Simulation::new(robot, &scenario).unwrap();
    let mut frames = Vec::new();
    while let Some(frame) = simulation.next_frame().unwrap() {
        frames.push(frame.clone());
    }
    frames
}

/// Four minutes of work without payload, contacts and offsets.
pub(crate) fn plain() -> &'static [Frame] {
    static PLAIN: OnceLock<Vec<Frame>> = OnceLock::new();
    PLAIN.get_or_init(|| frames(&biorob_like(), 51, 240.0, without_events))
}

/// Scenario with all events moved beyond its end.
pub(crate) fn without_events(text: String) -> String {
    text.replace("= 60.0", "= 400.0")
        .replace("= 120.0", "= 450.0")
        .replace("= 130.0", "= 460.0")
        .replace("= 150.0", "= 470.0")
        .replace("= 180.0", "= 480.0")
        .replace("shoulder_yaw = 400.0", "shoulder_yaw = 60.0")
}

/// Frame rate of [`plain`], Hz.
pub(crate) const HZ: usize = 250;

/// Section of [`plain`], s.
pub(crate) fn seconds(from_s: usize, to_s: usize) -> &'static [Frame] {
    &plain()[from_s * HZ..to_s * HZ]
}

/// Frames with the motor position of a joint increased by `by_rad`: its rope is elongated.
pub(crate) fn longer(frames: &[Frame], joint: usize, by_rad: f64) -> Vec<Frame> {
    let mut frames = frames.to_vec();
    for frame in &mut frames {
        frame.theta[joint] += by_rad;
    }
    frames
}

/// Frames with time stamps delayed by `by_s`.
pub(crate) fn later(frames: &[Frame], by_s: f64) -> Vec<Frame> {
    let mut frames = frames.to_vec();
    for frame in &mut frames {
        frame.time_ns += (by_s * 1e9) as i64;
    }
    frames
}

/// Baseline of the first minute of [`plain`].
pub(crate) fn baseline() -> &'static Baseline {
    static BASELINE: OnceLock<Baseline> = OnceLock::new();
    BASELINE.get_or_init(|| {
        let robot = biorob_like();
        let recorded = recorded(&robot, seconds(0, 60));
        let learning = Learning::default();
        session::learn_recorded(&robot, &recorded, "first minute", &learning)
            .unwrap()
            .0
    })
}

/// Blocks of a recording, as read by `sinew estimate`.
pub(crate) fn recorded(robot: &Robot, frames: &[Frame]) -> Recorded {
    let mut recorder = Recorder::new(robot, &FeatureConfig::default(), 0.5);
    for frame in frames {
        let time_s = (frame.time_ns - frames[0].time_ns) as f64 * 1e-9;
        recorder.push(frame, time_s);
    }
    recorder.finish()
}

/// Default configuration with [`baseline`].
pub(crate) fn tensioned() -> MonitorConfig {
    MonitorConfig {
        baseline: Some(baseline().clone()),
        ..config(&biorob_like())
    }
}

/// 2026-11-02 08:00 UTC, ns.
pub(crate) const MONDAY_NS: i64 = 1_793_606_400_000_000_000;

/// Store in memory.
#[derive(Debug, Clone, Default)]
pub(crate) struct Store {
    pub(crate) stored: Stored,
    pub(crate) records: Vec<Record>,
    pub(crate) journal: Vec<Entry>,
    pub(crate) transactions: u64,
    pub(crate) fails: bool,
}

impl Store {
    fn keep(&mut self, transaction: Transaction) {
        assert!(
            transaction.id > self.stored.last_id,
            "transaction numbers increase"
        );
        self.stored.last_id = transaction.id;
        if let Some(from_utc_s) = transaction.replaced_from_utc_s {
            self.records.retain(|record| record.time_utc_s < from_utc_s);
            self.stored.history = History::default();
            self.records.iter().for_each(|record| {
                self.stored.history.push(record);
            });
        }
        for record in &transaction.records {
            self.stored.history.push(record);
        }
        self.records.extend(transaction.records);
        self.journal.extend(transaction.journal);
        if let Some(state) = transaction.state {
            self.stored.state = Some(MonitorState::clone(&state));
        }
        if let Some(alarms) = transaction.alarms {
            self.stored.alarms = alarms;
        }
        self.transactions += 1;
    }

    /// Journal events selected by `pick`.
    pub(crate) fn events<T>(&self, pick: impl Fn(&Event) -> Option<T>) -> Vec<T> {
        self.journal.iter().filter_map(|e| pick(&e.event)).collect()
    }
}

/// Monitor with a clock, an immediate worker and an immediate store.
pub(crate) struct Harness {
    pub(crate) monitor: Monitor,
    pub(crate) now: Instant,
    pub(crate) store: Store,
    pub(crate) config: MonitorConfig,
    ticked_ns: i64,
}

/// Time between two ticks, ns.
const TICK_NS: i64 = 100_000_000;

impl Harness {
    pub(crate) fn new(config: MonitorConfig) -> Self {
        let now = Instant {
            monotonic_ns: 5_000_000_000,
            utc_ns: MONDAY_NS,
        };
        Self::restored(config, Store::default(), now)
    }

    pub(crate) fn restored(config: MonitorConfig, store: Store, now: Instant) -> Self {
        let monitor = Monitor::new(config.clone(), store.stored.clone(), now).unwrap();
        let mut harness = Self {
            monitor,
            now,
            store,
            config,
            ticked_ns: now.monotonic_ns,
        };
        harness.settle();
        harness
    }

    /// Switches off and on again `off_s` later; data that are not stored are lost.
    pub(crate) fn restart(self, off_s: f64) -> Self {
        let mut now = self.now.after_s(off_s);
        // The monotonic clock restarts at boot.
        now.monotonic_ns = 1_000_000_000;
        Self::restored(self.config, self.store, now)
    }

    /// Runs all jobs and stores all transactions.
    pub(crate) fn settle(&mut self) {
        loop {
            let job = self.monitor.job();
            let worked = job.is_some();
            if let Some(job) = job {
                self.monitor.done(job.run(), self.now);
            }
            if !self.store() && !worked {
                return;
            }
        }
    }

    /// Stores all transactions; returns whether there were any.
    pub(crate) fn store(&mut self) -> bool {
        let mut any = false;
        while let Some(transaction) = self.monitor.transaction() {
            let id = transaction.id;
            if self.store.fails {
                self.monitor
                    .store_failed(id, StoreFault::Full, "disk full", self.now);
                return false;
            }
            self.store.keep(transaction);
            self.monitor.committed(id, self.now);
            any = true;
        }
        any
    }

    /// Plays frames, followed by 70 s without data.
    pub(crate) fn session(&mut self, frames: &[Frame]) {
        self.play(frames);
        self.pass(70.0);
    }

    /// Gives an operator command.
    pub(crate) fn command(&mut self, what: CommandKind, note: &str) -> Result<(), CommandError> {
        let command = Command {
            who: "ada".into(),
            note: note.into(),
            what,
        };
        let result = self.monitor.command(command, self.now);
        self.settle();
        result
    }

    /// State of an alarm as shown in the snapshot.
    pub(crate) fn alarm(&self, joint: Option<&str>, condition: Condition) -> Option<AlarmState> {
        let key = AlarmKey {
            joint: joint.map(str::to_string),
            condition,
        };
        let alarms = self.snapshot().alarms;
        alarms.into_iter().find(|a| a.key == key).map(|a| a.state)
    }

    /// Last record of a joint.
    pub(crate) fn last(&self, joint: &str) -> &Record {
        let mut records = self.store.records.iter().rev();
        records.find(|r| r.joint == joint).unwrap()
    }

    /// Advances time by `s` seconds, with a tick every 0.1 s.
    pub(crate) fn pass(&mut self, s: f64) {
        let end = self.now.after_s(s);
        while self.now.monotonic_ns < end.monotonic_ns {
            self.now = self.now.after_s(0.1);
            self.tick();
        }
        self.now = end;
    }

    pub(crate) fn tick(&mut self) {
        self.ticked_ns = self.now.monotonic_ns;
        self.monitor.tick(self.now);
        self.settle();
    }

    /// Plays frames at their time stamps, relative to the first.
    pub(crate) fn play(&mut self, frames: &[Frame]) {
        let Some(first) = frames.first() else { return };
        let (from, zero_ns) = (self.now, first.time_ns);
        for frame in frames {
            let passed = frame.time_ns - zero_ns;
            self.now = Instant {
                monotonic_ns: from.monotonic_ns + passed,
                utc_ns: from.utc_ns + passed,
            };
            self.frame(frame);
        }
    }

    /// Ingests a frame now.
    pub(crate) fn frame(&mut self, frame: &Frame) {
        self.monitor.frame(frame, self.now);
        if self.now.monotonic_ns - self.ticked_ns >= TICK_NS {
            self.tick();
        }
    }

    pub(crate) fn snapshot(&self) -> RobotSnapshot {
        self.monitor.snapshot(self.now)
    }
}
