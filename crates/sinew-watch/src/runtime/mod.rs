//! The monitor while it runs.
//!
//! ```text
//! door threads ─▶ a bounded queue for each robot ─▶ core threads ─▶ store thread ─▶ committed
//!                                                    │   ▲ done                       │
//!                                                    ▼   │                            ▼
//!                                               estimate threads                board: what is shown
//! ```
//!
//! Nothing waits for the store, an estimate, or a browser.

mod board;
mod core_thread;
mod door;
mod doors;
mod health;
mod messages;
mod pace;
mod robot;
mod slot;
mod store_thread;
mod tell;
mod troubles;
mod worker;

pub use board::Board;
pub use door::{DoorNow, Shut};
pub use doors::{Doors, check as check_door};
pub use health::Health;
pub(crate) use health::lock;
pub use messages::{Answer, Control, CoreHandle, NotStored, Reply, Request};
pub use pace::Pace;
pub use slot::{Seen, Slot};

use crate::config::{Address, Config, RobotSettings};
use crate::store::{Place, Reader, Store, StoreError};
use core_thread::{CoreThread, Outlets};
use messages::Watched;
use robot::{Files, NotYet};
use sinew_door::{
    Batch, Clock, Inbox, Intake, Publishing, QueueLimits, RobotId, Route, Sender as Queue,
};
use sinew_log::live::LiveOptions;
use sinew_watch_core::journal::Entry;
use sinew_watch_core::{Monitor, MonitorConfig};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{RecvTimeoutError, Sender, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use tokio::sync::mpsc::{Receiver, channel};

/// Steps of alarms that wait for who tells others of them.
const TOLD_WAITING: usize = 1000;
/// What is left is stored within this time when the monitor ends.
const END_WITHIN: Duration = Duration::from_secs(20);

/// Why a robot isn't watched yet.
const WAITS_FOR_URDF: &str =
    "waits for its URDF: robot.toml names none, so /robot_description has to come";

/// How a monitor is started.
#[derive(Debug, Clone)]
pub struct Start {
    /// Where the store is.
    pub place: Place,
    /// Threads that take frames.
    pub cores: usize,
    /// Threads that make estimates.
    pub workers: usize,
    /// The monotonic and the civil clock.
    pub clock: Clock,
    /// How fast the civil one runs.
    pub pace: Pace,
}

impl Start {
    /// With the store in this place, and as many threads as there are processors.
    pub fn at(place: Place) -> Self {
        let processors = std::thread::available_parallelism().map_or(1, usize::from);
        Self {
            place,
            cores: processors.div_ceil(2).min(8),
            workers: processors.min(8),
            clock: Clock::start(),
            pace: Pace::Real,
        }
    }
}

/// Why the monitor didn't start.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StartError {
    /// The store can't be opened.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The system has no thread left.
    #[error("no thread can be started: {0}")]
    Thread(#[from] std::io::Error),
    /// The ropes that come along.
    #[error("{0}")]
    Ropes(String),
}

/// A robot of the configuration.
struct Known {
    settings: RobotSettings,
    state: State,
    /// What it was told of its door; `None`: nothing yet.
    door: Option<Option<Shut>>,
}

enum State {
    /// Its monitor runs.
    Watched { core: usize, queue: Queued },
    /// Its URDF is to come with its messages.
    WaitsForUrdf { queue: Queued, intake: Box<Intake> },
    /// Its files are wrong.
    Fault,
}

/// A robot's queue, and what its messages are read with.
struct Queued {
    id: RobotId,
    sender: Queue,
    live: LiveOptions,
}

impl Known {
    fn queue(&self) -> Option<&Queued> {
        match &self.state {
            State::Watched { queue, .. } | State::WaitsForUrdf { queue, .. } => Some(queue),
            State::Fault => None,
        }
    }
}

/// The monitor while it runs.
pub struct Runtime {
    start: Start,
    board: Arc<Board>,
    health: Arc<Health>,
    cores: Vec<(CoreHandle, JoinHandle<()>)>,
    workers: Vec<JoinHandle<()>>,
    store: (Sender<Request>, JoinHandle<()>),
    tell: (tell::TellHandle, JoinHandle<()>),
    reader: Reader,
    files: Files,
    doors: Doors,
    publish: Publishing,
    /// Queues of robots that wait for their URDF.
    waiting: Inbox,
    robots: BTreeMap<String, Known>,
}

impl Runtime {
    /// Starts the threads; no robot is watched yet. Steps of alarms come out of the receiver.
    ///
    /// # Errors
    /// [`StartError`].
    pub fn new(start: Start) -> Result<(Self, Receiver<(String, Entry)>), StartError> {
        let store = Store::open(start.place.clone())?;
        Self::with_store(start, store)
    }

    /// The same with a store that is open already.
    ///
    /// # Errors
    /// [`StartError`].
    pub fn with_store(
        start: Start,
        store: Store,
    ) -> Result<(Self, Receiver<(String, Entry)>), StartError> {
        let reader = store.reader()?;
        let health = Arc::new(Health::new(start.cores));
        let board = Arc::new(Board::default());
        let store = store_thread::start(store, Arc::clone(&health))?;
        let (work, workers) = worker::start(start.workers.max(1), &health)?;
        let (told, steps) = channel(TOLD_WAITING);
        let outlets = Outlets {
            store: store.0.clone(),
            work,
            told,
        };
        let cores = (0..start.cores.max(1)).map(|index| {
            let connected = CoreHandle::new(Inbox::new());
            let handle = connected.0.clone();
            let clocks = (start.clock, start.pace);
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
            tell: tell::start(Arc::clone(&board))?,
            files: Files::new().map_err(StartError::Ropes)?,
            doors: Doors::default(),
            publish: Publishing::default(),
            waiting: Inbox::new(),
            robots: BTreeMap::new(),
            start,
            board,
            health,
            workers,
            store,
            reader,
        };
        Ok((runtime, steps))
    }

    /// What is known of every robot now.
    pub fn board(&self) -> &Arc<Board> {
        &self.board
    }

    /// How the monitor itself is.
    pub fn health(&self) -> &Arc<Health> {
        &self.health
    }

    /// The monotonic and the civil clock.
    pub fn clock(&self) -> Clock {
        self.start.clock
    }

    /// How fast the civil clock of monitors runs.
    pub fn pace(&self) -> Pace {
        self.start.pace
    }

    /// Doors, and what they say of themselves.
    pub fn doors(&mut self) -> &mut Doors {
        &mut self.doors
    }

    /// What the store's thread is asked through.
    pub fn store(&self) -> Sender<Request> {
        self.store.0.clone()
    }

    /// The queue of a robot, for a door that is opened elsewhere.
    pub fn route(&self, robot: &str) -> Option<Route> {
        let queue = self.robots.get(robot)?.queue()?;
        Some(Route::new(queue.sender.clone(), &queue.live))
    }

    /// Watches what the configuration asks for from now on. What stays as it was loses no sample. Robots that can't
    /// be watched are shown with why.
    pub fn configure(&mut self, config: &Config) {
        self.files.forget();
        let names: Vec<&str> = config.robots.iter().map(|r| r.name.as_str()).collect();
        let gone = self
            .robots
            .keys()
            .filter(|name| !names.contains(&name.as_str()));
        for name in gone.cloned().collect::<Vec<_>>() {
            self.forget(&name);
            self.board.remove(&name);
        }
        for settings in &config.robots {
            self.configure_robot(settings);
        }
        self.publish = config.publish;
        self.open_doors();
    }

    fn configure_robot(&mut self, settings: &RobotSettings) {
        let name = &settings.name;
        match self.files.load(settings, None) {
            Ok((monitor, live)) => self.watch(settings, monitor, live),
            Err(NotYet::Fault(why)) => {
                self.health.say(&format!("{name}: {why}"));
                // One that is watched goes on as it was.
                if self
                    .robots
                    .get(name)
                    .is_none_or(|known| known.queue().is_none())
                {
                    self.not_watched(settings, why);
                }
            }
            Err(NotYet::WaitsForUrdf(live)) => self.wait_for_urdf(settings, *live),
        }
    }

    /// The core with the fewest robots.
    fn core(&self) -> usize {
        let mut counts = vec![0_usize; self.cores.len()];
        for known in self.robots.values() {
            if let State::Watched { core, .. } = known.state {
                counts[core] += 1;
            }
        }
        let fewest = counts.iter().enumerate().min_by_key(|(_, count)| **count);
        fewest.map_or(0, |(core, _)| core)
    }

    /// Watches a robot: one that is watched takes the new configuration, and loses nothing where it may.
    pub(crate) fn watch(
        &mut self,
        settings: &RobotSettings,
        config: MonitorConfig,
        live: LiveOptions,
    ) {
        let name = &settings.name;
        if let Some(known) = self.robots.get_mut(name)
            && let State::Watched { core, queue } = &known.state
            && queue.live == live
        {
            known.settings = settings.clone();
            let (reply, answer) = sync_channel(1);
            let control = Control::Reload {
                robot: queue.id,
                config: Box::new(config.clone()),
                reply,
            };
            self.cores[*core].0.tell(control);
            match answer.recv() {
                Ok(Err(error)) => self.health.say(&format!("{name}: begins anew: {error}")),
                Ok(Ok(())) | Err(_) => return,
            }
        }
        if !self.forget(name) {
            let why = "the session before is still being stored; read the configuration again";
            return self.not_watched(settings, why.into());
        }
        let now = self.start.pace.instant(self.start.clock.now());
        let made = self.reader.stored(name).map_err(|e| e.to_string());
        let made =
            made.and_then(|stored| Monitor::new(config, stored, now).map_err(|e| e.to_string()));
        let made =
            made.and_then(|monitor| Ok((monitor, Intake::new(&live).map_err(|e| e.to_string())?)));
        let (monitor, intake) = match made {
            Ok(made) => made,
            Err(why) => return self.not_watched(settings, why),
        };
        let core = self.core();
        let handle = self.cores[core].0.clone();
        let (id, sender) = handle.inbox().robot(QueueLimits::default());
        let slot = self.board.slot(name);
        let address = Some((handle.clone(), id));
        self.board.set_address(name, address);
        handle.tell(Control::Add(Box::new(Watched {
            id,
            intake,
            monitor,
            slot,
        })));
        let queue = Queued { id, sender, live };
        self.put(settings, State::Watched { core, queue });
    }

    fn put(&mut self, settings: &RobotSettings, state: State) {
        let settings = settings.clone();
        let known = Known {
            settings,
            state,
            door: None,
        };
        self.robots.insert(known.settings.name.clone(), known);
    }

    fn not_watched(&mut self, settings: &RobotSettings, why: String) {
        self.board.slot(&settings.name).put(Seen::NotWatched(why));
        self.put(settings, State::Fault);
    }

    /// Its messages are received for the description alone.
    fn wait_for_urdf(&mut self, settings: &RobotSettings, live: LiveOptions) {
        let name = &settings.name;
        match self.robots.get_mut(name) {
            // The description came already, and holds.
            Some(known) if matches!(known.state, State::Watched { .. }) => return,
            Some(known) if known.queue().is_some_and(|q| q.live == live) => return,
            _ => {}
        }
        let intake = match Intake::new(&live) {
            Ok(intake) => Box::new(intake),
            Err(error) => return self.not_watched(settings, error.to_string()),
        };
        let slot = self.board.slot(name);
        slot.put(Seen::NotWatched(WAITS_FOR_URDF.into()));
        let (id, sender) = self.waiting.robot(QueueLimits::default());
        let queue = Queued { id, sender, live };
        self.put(settings, State::WaitsForUrdf { queue, intake });
    }

    /// Looks at the doors, and whether URDFs came that robots wait for.
    pub fn look(&mut self) {
        self.look_at_doors();
        let mut came = Vec::new();
        let mut batch = Batch::default();
        while let Some(id) = self.waiting.wait(Duration::ZERO) {
            self.waiting.take(id, &mut batch);
            for known in self.robots.values_mut() {
                let State::WaitsForUrdf { queue, intake } = &mut known.state else {
                    continue;
                };
                if queue.id != id {
                    continue;
                }
                intake.feed(&batch, |_| {});
                if let Some(text) = intake.live().robot_description() {
                    came.push((known.settings.clone(), text.to_owned()));
                }
            }
        }
        let any = !came.is_empty();
        for (settings, text) in came {
            match self.files.load(&settings, Some(&text)) {
                Ok((config, live)) => self.watch(&settings, config, live),
                Err(NotYet::Fault(why)) => self.not_watched(&settings, why),
                Err(NotYet::WaitsForUrdf(_)) => {}
            }
        }
        if any {
            self.open_doors();
        }
    }

    /// Watches a robot no more; whether all of it is stored. What begins anew goes on from what is stored, so it waits.
    fn forget(&mut self, name: &str) -> bool {
        let known = self.robots.remove(name);
        let Some(State::Watched { core, queue }) = known.map(|known| known.state) else {
            return true;
        };
        let (gone, ended) = sync_channel(0);
        let robot = queue.id;
        self.cores[core].0.tell(Control::Remove { robot, gone });
        self.board.set_address(name, None);
        ended.recv_timeout(END_WITHIN) != Err(RecvTimeoutError::Timeout)
    }

    fn open_doors(&mut self) {
        let mut wanted: BTreeMap<Address, Vec<Route>> = BTreeMap::new();
        let mut behind = tell::Behind::new();
        for (name, known) in &self.robots {
            let Some(queue) = known.queue() else { continue };
            let key = known.settings.door.address.clone();
            wanted
                .entry(key.clone())
                .or_default()
                .push(Route::new(queue.sender.clone(), &queue.live));
            let namespace = known.settings.door.namespace.clone();
            behind
                .entry(key)
                .or_default()
                .push((name.clone(), namespace));
        }
        self.tell.0.set(behind);
        let with = (self.start.clock, &self.tell.0);
        self.doors.set(wanted, self.publish, with);
        self.look_at_doors();
    }

    /// Tells robots whose door became shut or open.
    fn look_at_doors(&mut self) {
        self.doors
            .look((self.start.clock, &self.tell.0), &self.health);
        let doors = self.doors.now();
        for known in self.robots.values_mut() {
            let door = doors.get(&known.settings.door.address);
            let shut = door.and_then(|door| {
                let (door, why) = (door.door.clone(), door.shut.clone()?);
                Some(Shut { door, why })
            });
            if known.door.as_ref() == Some(&shut) {
                continue;
            }
            match &known.state {
                State::Watched { core, queue } => self.cores[*core].0.tell(Control::Door {
                    robot: queue.id,
                    shut: shut.clone(),
                }),
                State::WaitsForUrdf { .. } => {
                    let why = match &shut {
                        Some(Shut { door, why }) => format!("{door} is shut: {why}"),
                        None => WAITS_FOR_URDF.into(),
                    };
                    let slot = self.board.slot(&known.settings.name);
                    slot.put(Seen::NotWatched(why));
                }
                State::Fault => {}
            }
            known.door = Some(shut);
        }
    }

    /// Ends: no message is taken any more, sessions end and are stored.
    pub fn end(mut self) {
        self.doors.shut();
        self.health.ends.store(true, Ordering::Relaxed);
        let by = Instant::now() + END_WITHIN;
        for (core, _) in &self.cores {
            core.tell(Control::End { by });
        }
        for (_, thread) in self.cores.drain(..) {
            let _panicked = thread.join();
        }
        let (tell, thread) = self.tell;
        drop(tell);
        let _panicked = thread.join();
        for worker in self.workers.drain(..) {
            let _panicked = worker.join();
        }
        let _ended = self.store.0.send(Request::End);
        let _panicked = self.store.1.join();
    }
}
