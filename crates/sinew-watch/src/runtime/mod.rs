//! Running monitor: threads and queues.
//!
//! ```text
//! transport threads ─▶ a bounded queue for each robot ─▶ core threads ─▶ store thread ─▶ committed
//!                                                    │   ▲ done                       │
//!                                                    ▼   │                            ▼
//!                                               estimate threads             registry: state to show
//! ```
//!
//! No thread waits for the store, an estimate or a browser.

mod clock_rate;
mod core_thread;
mod faults;
mod health;
mod live;
mod messages;
mod publish;
mod recorder;
mod registry;
mod robot;
mod slot;
mod store_thread;
mod transport;
mod transports;
mod worker;

pub use clock_rate::ClockRate;
pub use health::Health;
pub(crate) use health::lock;
pub use live::{LiveBoard, LiveSample, LiveSeries};
pub use messages::{Answer, Control, CoreHandle, NotStored, Reply, Request};
pub use publish::STATUS_PREFIX;
pub(crate) use recorder::{file as recording_file, folder as recordings_folder};
pub use registry::RobotRegistry;
pub use slot::{RobotState, Slot};
pub use transport::{Disconnected, TransportView};
pub use transports::{Transports, check as check_transport};

use crate::config::{Address, Config, RecordingSettings, RobotSettings};
use crate::store::{Place, Reader, Store, StoreError};
use crate::words;
use core_thread::{CoreThread, Outlets};
use messages::MonitoredRobot;
use recorder::Recorder;
use robot::{Files, NotYet};
use sinew_log::live::LiveOptions;
use sinew_transport::{
    Batch, Clock, FrameAssembler, Inbox, Publishing, QueueLimits, RobotId, Route, Sender as Queue,
};
use sinew_watch_core::journal::Entry;
use sinew_watch_core::{Monitor, MonitorConfig};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{RecvTimeoutError, Sender, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use tokio::sync::mpsc::{Receiver, channel};

/// Name in the place of a transport, of a robot that is paused after a failure.
const MONITOR: &str = "sinew-watch";
/// Capacity of the channel of alarm transitions to the notifiers.
const MAX_WAITING_TRANSITIONS: usize = 1000;
/// Time limit for storing the remaining data when the monitor stops.
const MAX_SHUTDOWN_TIME: Duration = Duration::from_secs(20);

/// Parameters for starting a monitor.
#[derive(Debug, Clone)]
pub struct Start {
    /// Location of the store.
    pub place: Place,
    /// Number of threads that process frames.
    pub cores: usize,
    /// Number of threads that compute estimates.
    pub workers: usize,
    /// Monotonic and civil clock.
    pub clock: Clock,
    /// Speed of the civil clock.
    pub clock_rate: ClockRate,
}

impl Start {
    /// Returns the default parameters for a store: as many threads as processors.
    pub fn at(place: Place) -> Self {
        let processors = std::thread::available_parallelism().map_or(1, usize::from);
        Self {
            place,
            cores: processors.div_ceil(2).min(8),
            workers: processors.min(8),
            clock: Clock::start(),
            clock_rate: ClockRate::Real,
        }
    }
}

/// Error that prevents the start of the monitor.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StartError {
    /// The store cannot be opened.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The system cannot start a thread.
    #[error("cannot start a thread: {0}")]
    Thread(#[from] std::io::Error),
    /// The built-in rope catalogue is invalid.
    #[error("{0}")]
    Ropes(String),
}

/// Robot of the configuration.
struct ConfiguredRobot {
    settings: RobotSettings,
    state: State,
    /// Last connection state reported to its monitor; `None`: none yet.
    transport: Option<Option<Disconnected>>,
    failures: Failures,
}

/// Failures of the program in the processing of a robot's data.
#[derive(Debug, Clone, Copy, Default)]
struct Failures {
    count: u32,
    /// The robot receives no data until then.
    paused_until: Option<Instant>,
}

impl Failures {
    /// Pause after the first failure, doubled with each further one within [`Self::FORGOTTEN_AFTER`]: longer than the 5 s
    /// after which it is an alarm.
    const PAUSE: Duration = Duration::from_secs(10);
    const MAX_DOUBLINGS: u32 = 5;
    const FORGOTTEN_AFTER: Duration = Duration::from_secs(3600);

    /// Adds a failure; returns the pause.
    fn add(self, now: Instant) -> (Self, Duration) {
        let is_old = |last: Instant| now.saturating_duration_since(last) > Self::FORGOTTEN_AFTER;
        let count = match self.paused_until.is_some_and(is_old) {
            true => 0,
            false => self.count,
        };
        let pause = Self::PAUSE * (1 << count.min(Self::MAX_DOUBLINGS));
        let added = Self {
            count: count + 1,
            paused_until: Some(now + pause),
        };
        (added, pause)
    }

    /// Returns the remaining pause; `None`: the robot receives data.
    fn pause(self) -> Option<Duration> {
        let until = self.paused_until?;
        Some(until.saturating_duration_since(Instant::now())).filter(|pause| !pause.is_zero())
    }
}

enum State {
    /// The robot is monitored.
    Monitored { core: usize, queue: RobotQueue },
    /// The robot waits for its URDF.
    WaitsForUrdf {
        queue: RobotQueue,
        intake: Box<FrameAssembler>,
    },
    /// The files of the robot are invalid.
    Fault,
}

/// Queue of a robot with the options for reading its messages.
struct RobotQueue {
    id: RobotId,
    sender: Queue,
    live: LiveOptions,
}

impl ConfiguredRobot {
    fn queue(&self) -> Option<&RobotQueue> {
        match &self.state {
            State::Monitored { queue, .. } | State::WaitsForUrdf { queue, .. } => Some(queue),
            State::Fault => None,
        }
    }
}

/// Whether a connection state is that of a robot that is paused after a failure.
fn is_of_pause(state: &Disconnected) -> bool {
    state.transport == MONITOR
}

/// Running monitor with its threads.
pub struct Runtime {
    start: Start,
    registry: Arc<RobotRegistry>,
    health: Arc<Health>,
    cores: Vec<(CoreHandle, JoinHandle<()>)>,
    workers: Vec<JoinHandle<()>>,
    store: (Sender<Request>, JoinHandle<()>),
    publisher: (publish::PublishHandle, JoinHandle<()>),
    reader: Reader,
    files: Files,
    transports: Transports,
    publish: Publishing,
    recording: RecordingSettings,
    /// Queues of robots that wait for their URDF.
    waiting: Inbox,
    robots: BTreeMap<String, ConfiguredRobot>,
}

impl Runtime {
    /// Starts the threads without robots. Alarm transitions are sent to the receiver.
    ///
    /// # Errors
    /// Returns a [`StartError`] if the store cannot be opened or a thread cannot be started.
    pub fn new(start: Start) -> Result<(Self, Receiver<(String, Entry)>), StartError> {
        let store = Store::open(start.place.clone())?;
        Self::with_store(start, store)
    }

    /// Starts the threads with an open store; see [`Runtime::new`].
    ///
    /// # Errors
    /// Returns a [`StartError`] if a thread cannot be started.
    pub fn with_store(
        start: Start,
        store: Store,
    ) -> Result<(Self, Receiver<(String, Entry)>), StartError> {
        let reader = store.reader()?;
        let health = Arc::new(Health::new(start.cores));
        let registry = Arc::new(RobotRegistry::default());
        let store = store_thread::start(store, Arc::clone(&health))?;
        let (work, workers) = worker::start(start.workers.max(1), &health)?;
        let (transitions, steps) = channel(MAX_WAITING_TRANSITIONS);
        let outlets = Outlets {
            store: store.0.clone(),
            work,
            transitions,
        };
        let cores = (0..start.cores.max(1)).map(|index| {
            let connected = CoreHandle::new(Inbox::new());
            let handle = connected.0.clone();
            let clocks = (start.clock, start.clock_rate);
            let core = CoreThread::new(
                index,
                connected,
                outlets.clone(),
                clocks,
                Arc::clone(&health),
            );
            let thread = std::thread::Builder::new().name(format!("core-{index}"));
            Ok((handle, thread.spawn(move || core.run())?))
        });
        let runtime = Self {
            cores: cores.collect::<std::io::Result<_>>()?,
            publisher: publish::start(Arc::clone(&registry))?,
            files: Files::new().map_err(StartError::Ropes)?,
            transports: Transports::default(),
            publish: Publishing::default(),
            recording: RecordingSettings::default(),
            waiting: Inbox::new(),
            robots: BTreeMap::new(),
            start,
            registry,
            health,
            workers,
            store,
            reader,
        };
        Ok((runtime, steps))
    }

    /// Returns the registry of all robots.
    pub fn registry(&self) -> &Arc<RobotRegistry> {
        &self.registry
    }

    /// Returns the health of the monitor.
    pub fn health(&self) -> &Arc<Health> {
        &self.health
    }

    /// Returns the monotonic and civil clock.
    pub fn clock(&self) -> Clock {
        self.start.clock
    }

    /// Returns the speed of the civil clock.
    pub fn clock_rate(&self) -> ClockRate {
        self.start.clock_rate
    }

    /// Returns the transports with their state.
    pub fn transports(&mut self) -> &mut Transports {
        &mut self.transports
    }

    /// Returns the sender of requests to the store thread.
    pub fn store(&self) -> Sender<Request> {
        self.store.0.clone()
    }

    /// Returns the route to a robot's queue, for a transport created elsewhere.
    pub fn route(&self, robot: &str) -> Option<Route> {
        let queue = self.robots.get(robot)?.queue()?;
        Some(Route::new(queue.sender.clone(), &queue.live))
    }

    /// Applies a configuration. Unchanged robots lose no sample. Robots that cannot be monitored are shown with the
    /// reason.
    pub fn configure(&mut self, config: &Config) {
        self.files.forget();
        let names: Vec<&str> = config.robots.iter().map(|r| r.name.as_str()).collect();
        let gone = self
            .robots
            .keys()
            .filter(|name| !names.contains(&name.as_str()));
        for name in gone.cloned().collect::<Vec<_>>() {
            self.forget(&name);
            self.registry.remove(&name);
        }
        self.recording = config.recording;
        words::set_time_zone(config.time_zone.clone());
        for settings in &config.robots {
            self.configure_robot(settings);
        }
        self.publish = config.publish;
        self.open_transports();
    }

    fn configure_robot(&mut self, settings: &RobotSettings) {
        let name = &settings.name;
        match self.files.load(settings, None) {
            Ok((monitor, live)) => self.watch(settings, monitor, live),
            Err(NotYet::Fault(reason)) => {
                self.health.log(&words::log::robot_fault(name, &reason));
                // A monitored robot continues unchanged.
                if self
                    .robots
                    .get(name)
                    .is_none_or(|robot_entry| robot_entry.queue().is_none())
                {
                    self.set_not_monitored(settings, reason);
                }
            }
            Err(NotYet::WaitsForUrdf(live)) => self.wait_for_urdf(settings, *live),
        }
    }

    /// Returns the core thread with the fewest robots.
    fn core(&self) -> usize {
        let mut counts = vec![0_usize; self.cores.len()];
        for robot_entry in self.robots.values() {
            if let State::Monitored { core, .. } = robot_entry.state {
                counts[core] += 1;
            }
        }
        let fewest = counts.iter().enumerate().min_by_key(|(_, count)| **count);
        fewest.map_or(0, |(core, _)| core)
    }

    /// Monitors a robot; one that is already monitored receives the new configuration without loss of data where
    /// possible.
    pub(crate) fn watch(
        &mut self,
        settings: &RobotSettings,
        config: MonitorConfig,
        live: LiveOptions,
    ) {
        let name = &settings.name;
        if let Some(robot_entry) = self.robots.get_mut(name)
            && let State::Monitored { core, queue } = &robot_entry.state
            && queue.live == live
        {
            robot_entry.settings = settings.clone();
            let (reply, answer) = sync_channel(1);
            let control = Control::Reload {
                robot: queue.id,
                config: Box::new(config.clone()),
                reply,
            };
            self.cores[*core].0.send(control);
            match answer.recv() {
                Ok(Err(error)) => {
                    self.health.log(&words::log::robot_restarted(name, error));
                }
                Ok(Ok(())) | Err(_) => return,
            }
        }
        if !self.forget(name) {
            return self.set_not_monitored(settings, words::is_being_stored());
        }
        let now = self.start.clock_rate.instant(self.start.clock.now());
        let made = self.reader.stored(name).map_err(|e| e.to_string());
        let made =
            made.and_then(|stored| Monitor::new(config, stored, now).map_err(|e| e.to_string()));
        let made = made.and_then(|monitor| {
            Ok((
                monitor,
                FrameAssembler::new(&live).map_err(|e| e.to_string())?,
            ))
        });
        let (monitor, intake) = match made {
            Ok(made) => made,
            Err(reason) => return self.set_not_monitored(settings, reason),
        };
        let core = self.core();
        let handle = self.cores[core].0.clone();
        let (id, sender) = handle.inbox().robot(QueueLimits::default());
        let slot = self.registry.slot(name);
        slot.put(RobotState::Starting);
        let recorder = Recorder::new(self.recording, self.start.place.folder(), name, &live);
        slot.set_recordings(recorder.recordings());
        let address = Some((handle.clone(), id));
        self.registry.set_address(name, address);
        handle.send(Control::Add(Box::new(MonitoredRobot {
            id,
            intake,
            monitor,
            recorder,
            slot,
        })));
        let queue = RobotQueue { id, sender, live };
        self.put(settings, State::Monitored { core, queue });
    }

    fn put(&mut self, settings: &RobotSettings, state: State) {
        let settings = settings.clone();
        let robot_entry = ConfiguredRobot {
            settings,
            state,
            transport: None,
            failures: Failures::default(),
        };
        self.robots
            .insert(robot_entry.settings.name.clone(), robot_entry);
    }

    fn set_not_monitored(&mut self, settings: &RobotSettings, reason: String) {
        self.registry
            .slot(&settings.name)
            .put(RobotState::NotMonitored(reason));
        self.put(settings, State::Fault);
    }

    /// Routes the messages of the robot for its description only.
    fn wait_for_urdf(&mut self, settings: &RobotSettings, live: LiveOptions) {
        let name = &settings.name;
        match self.robots.get_mut(name) {
            // The description has been received and is valid.
            Some(robot_entry) if matches!(robot_entry.state, State::Monitored { .. }) => return,
            Some(robot_entry) if robot_entry.queue().is_some_and(|q| q.live == live) => return,
            _ => {}
        }
        let intake = match FrameAssembler::new(&live) {
            Ok(intake) => Box::new(intake),
            Err(error) => return self.set_not_monitored(settings, error.to_string()),
        };
        let slot = self.registry.slot(name);
        slot.put(RobotState::NotMonitored(words::waits_for_urdf()));
        let (id, sender) = self.waiting.robot(QueueLimits::default());
        let queue = RobotQueue { id, sender, live };
        self.put(settings, State::WaitsForUrdf { queue, intake });
    }

    /// Restarts the robots whose data caused an error of the program. Their data are received again after a pause.
    fn restart_failed(&mut self) {
        let mut changes = false;
        let mut failed = Vec::new();
        for (name, robot_entry) in &mut self.robots {
            let state = self.registry.get(name).map(|slot| slot.state());
            let is_monitored = matches!(robot_entry.state, State::Monitored { .. });
            if is_monitored && matches!(state, Some(RobotState::NotMonitored(_))) {
                failed.push((robot_entry.settings.clone(), robot_entry.failures));
            } else if robot_entry.transport.iter().flatten().any(is_of_pause)
                && robot_entry.failures.pause().is_none()
            {
                robot_entry.transport = None;
                changes = true;
            }
        }
        for (settings, failures) in failed {
            let name = &settings.name;
            let (failures, pause) = failures.add(Instant::now());
            self.forget(name);
            self.configure_robot(&settings);
            if let Some(robot_entry) = self.robots.get_mut(name) {
                robot_entry.failures = failures;
            }
            let line = words::log::robot_fault(name, &words::resumes(pause));
            self.health.log(&line);
            changes = true;
        }
        if changes {
            self.open_transports();
        }
    }

    /// Checks the transports, the robots whose data caused an error, and those that wait for their URDF.
    pub fn look(&mut self) {
        self.restart_failed();
        self.look_at_transports();
        let mut came = Vec::new();
        let mut batch = Batch::default();
        while let Some(id) = self.waiting.wait(Duration::ZERO) {
            self.waiting.take(id, &mut batch);
            for robot_entry in self.robots.values_mut() {
                let State::WaitsForUrdf { queue, intake } = &mut robot_entry.state else {
                    continue;
                };
                if queue.id != id {
                    continue;
                }
                intake.feed(&batch, |_| {});
                if let Some(text) = intake.live().robot_description() {
                    came.push((robot_entry.settings.clone(), text.to_owned()));
                }
            }
        }
        let any = !came.is_empty();
        for (settings, text) in came {
            match self.files.load(&settings, Some(&text)) {
                Ok((config, live)) => self.watch(&settings, config, live),
                Err(NotYet::Fault(reason)) => self.set_not_monitored(&settings, reason),
                Err(NotYet::WaitsForUrdf(_)) => {}
            }
        }
        if any {
            self.open_transports();
        }
    }

    /// Stops monitoring a robot; returns whether all its data are stored. A restarted robot continues from the stored
    /// state.
    fn forget(&mut self, name: &str) -> bool {
        let robot_entry = self.robots.remove(name);
        let Some(State::Monitored { core, queue }) =
            robot_entry.map(|robot_entry| robot_entry.state)
        else {
            return true;
        };
        let (gone, ended) = sync_channel(0);
        let robot = queue.id;
        self.cores[core].0.send(Control::Remove { robot, gone });
        self.registry.set_address(name, None);
        ended.recv_timeout(MAX_SHUTDOWN_TIME) != Err(RecvTimeoutError::Timeout)
    }

    fn open_transports(&mut self) {
        let mut wanted: BTreeMap<Address, Vec<Route>> = BTreeMap::new();
        let mut behind = publish::RobotsByTransport::new();
        for (name, robot_entry) in &self.robots {
            let Some(queue) = robot_entry.queue() else {
                continue;
            };
            if robot_entry.failures.pause().is_some() {
                continue;
            }
            let key = robot_entry.settings.transport.address.clone();
            wanted
                .entry(key.clone())
                .or_default()
                .push(Route::new(queue.sender.clone(), &queue.live));
            let namespace = robot_entry.settings.transport.namespace.clone();
            behind
                .entry(key)
                .or_default()
                .push((name.clone(), namespace));
        }
        self.publisher.0.set(behind);
        let with = (self.start.clock, &self.publisher.0);
        self.transports.set(wanted, self.publish, with);
        self.look_at_transports();
    }

    /// Reports changed connection states of transports to the robots.
    fn look_at_transports(&mut self) {
        self.transports
            .look((self.start.clock, &self.publisher.0), &self.health);
        let transports = self.transports.now();
        for robot_entry in self.robots.values_mut() {
            let transport = transports.get(&robot_entry.settings.transport.address);
            let disconnected = transport.and_then(|transport| {
                let (transport, reason) =
                    (transport.transport.clone(), transport.disconnected.clone()?);
                Some(Disconnected { transport, reason })
            });
            let disconnected = match robot_entry.failures.pause() {
                Some(_) if robot_entry.transport.iter().flatten().any(is_of_pause) => continue,
                Some(pause) => Some(Disconnected {
                    transport: MONITOR.into(),
                    reason: words::resumes(pause),
                }),
                None => disconnected,
            };
            if robot_entry.transport.as_ref() == Some(&disconnected) {
                continue;
            }
            match &robot_entry.state {
                State::Monitored { core, queue } => self.cores[*core].0.send(Control::Transport {
                    robot: queue.id,
                    disconnected: disconnected.clone(),
                }),
                State::WaitsForUrdf { .. } => {
                    let reason = match &disconnected {
                        Some(Disconnected { transport, reason }) => {
                            words::disconnected(transport, reason)
                        }
                        None => words::waits_for_urdf(),
                    };
                    let slot = self.registry.slot(&robot_entry.settings.name);
                    slot.put(RobotState::NotMonitored(reason));
                }
                State::Fault => {}
            }
            robot_entry.transport = Some(disconnected);
        }
    }

    /// Stops the monitor: no message is received any more, sessions end and are stored.
    pub fn end(mut self) {
        self.transports.close();
        self.health.ends.store(true, Ordering::Relaxed);
        let by = Instant::now() + MAX_SHUTDOWN_TIME;
        for (core, _) in &self.cores {
            core.send(Control::End { by });
        }
        for (_, thread) in self.cores.drain(..) {
            let _panicked = thread.join();
        }
        let (handle, thread) = self.publisher;
        drop(handle);
        let _panicked = thread.join();
        for worker in self.workers.drain(..) {
            let _panicked = worker.join();
        }
        let _ended = self.store.0.send(Request::End);
        let _panicked = self.store.1.join();
    }
}
