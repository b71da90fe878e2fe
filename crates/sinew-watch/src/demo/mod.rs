//! `sinew watch --demo`: no robot and no network but the page.
//!
//! A simulated motion, recorded by `sinew simulate`, is played over and over by the replay door, through the real queues,
//! monitors and store, which is in memory. On the way its ropes creep by the rope law, at an hour a second; a strand
//! fails after three minutes. It says DEMO wherever it says anything.

mod alter;
mod arms;
mod history;
#[cfg(test)]
mod tests;

use crate::config::{Address, DoorSettings, RobotSettings, WebSettings};
use crate::runtime::{Pace, Runtime, Start};
use crate::service::{Web, WebStart, until_told};
use crate::store::{Place, Store};
use alter::Crept;
use arms::arms;
use sinew_door::Routes;
use sinew_door::replay::{self, Played, ReplayOptions};
use sinew_estimate::baseline::Baseline;
use sinew_estimate::session::{Learning, Payload, Recorder, learn_recorded};
use sinew_log::live::LiveOptions;
use sinew_log::{OpenOptions, Recording};
use sinew_model::offset::FeatureConfig;
use sinew_model::robot::{Robot, RobotFile};
use sinew_rope::Catalogue;
use sinew_watch_core::alarm::{Condition, Delays};
use sinew_watch_core::{ClockChoice, MonitorConfig};
use std::io::Cursor;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::channel;

/// Seconds of the arms' civil clock in one.
const RATE: f64 = 3600.0;

/// Made by `demo/arm.toml`.
const MOTION: &[u8] = include_bytes!("../../demo/arm.mcap");
const ROBOT: &str = include_str!("../../demo/robot.toml");
const URDF: &str = include_str!("../../../../robots/biorob-like/biorob-like.urdf");

/// What the page says.
const SAYS: &str = "These arms are made up. One second is an hour of theirs: their ropes creep by the rope law at that \
                    pace, while the arms move at their own. A strand of demo-1's elbow fails after three minutes. \
                    Nothing is kept when it ends.";

fn words(error: impl std::fmt::Display) -> String {
    error.to_string()
}

/// The arms' robot.
fn robot() -> Result<Robot, String> {
    let file = RobotFile::parse(ROBOT, "robot.toml").map_err(words)?;
    file.build(URDF).map_err(words)
}

/// What the motion teaches of ropes that are not stretched.
fn baseline(robot: &Robot) -> Result<Baseline, String> {
    let options = OpenOptions::default();
    let reader = Box::new(Cursor::new(MOTION));
    let mut motion = Recording::from_reader(reader, "arm.mcap", &options).map_err(words)?;
    let joints: Vec<&str> = robot.joint_names().iter().map(String::as_str).collect();
    motion.select(&joints).map_err(words)?;
    let mut recorder = Recorder::new(robot, &FeatureConfig::default(), options.gap_s);
    let mut start_ns = None;
    while let Some(frame) = motion.next_frame().map_err(words)? {
        let start_ns = *start_ns.get_or_insert(frame.time_ns);
        recorder.push(frame, (frame.time_ns - start_ns) as f64 * 1e-9);
    }
    let learned = learn_recorded(robot, &recorder.finish(), "demo", &Learning::default());
    Ok(learned.map_err(words)?.0)
}

/// What an arm's monitor is told: a session ends with every turn of the motion, which is a day's work.
fn monitor(name: &str, robot: &Arc<Robot>, catalogue: &Arc<Catalogue>) -> MonitorConfig {
    let mut config = MonitorConfig::new(name, "demo", Arc::clone(robot), Arc::clone(catalogue));
    config.estimate.payload = Payload::Empty;
    config.clock = ClockChoice::Fast { civil_rate: RATE };
    config.times.session_motion_s = 60.0;
    config.times.session_pause_s = 2.0;
    // Ten minutes would be weeks.
    let soon = Delays {
        raise_after_s: 1.0,
        clear_after_s: 1.0,
    };
    config.alarms.delays = [
        (Condition::ReplaceLimit, soon),
        (Condition::RetensionLimit, soon),
        (Condition::LimitNear, soon),
    ]
    .into();
    config
}

/// The demonstration, running.
pub struct Demo {
    /// The monitor of its arms.
    pub runtime: Runtime,
    /// The page that shows them.
    pub web: Web,
}

impl Demo {
    /// Starts it.
    ///
    /// # Errors
    /// Why it can't be started, in words.
    pub fn start(
        web: WebSettings,
        signals: std::sync::mpsc::Sender<crate::service::Signal>,
    ) -> Result<Self, String> {
        let catalogue = Arc::new(Catalogue::shipped().map_err(words)?);
        let robot = Arc::new(robot()?);
        let baseline = baseline(&robot)?;
        let arms = arms(&robot, &catalogue);
        // Several may run in one process.
        static STORES: AtomicU64 = AtomicU64::new(0);
        let place = Place::Memory(STORES.fetch_add(1, Ordering::Relaxed));
        let mut start = Start::at(place.clone());
        let begins = start.clock.now();
        let start_utc_s = begins.utc_ns as f64 * 1e-9;
        start.pace = Pace::Fast {
            from: begins,
            rate: RATE,
        };
        // What is in memory lives as long as somebody has it open.
        let mut store = Store::open(place.clone()).map_err(words)?;
        for arm in &arms {
            let history = history::transactions(arm, &robot, &baseline, start_utc_s);
            store.commit(&history).map_err(words)?;
        }
        let (mut runtime, steps) = Runtime::with_store(start, store).map_err(words)?;
        for (seed, arm) in (1..).zip(&arms) {
            let live = LiveOptions::of_joints(robot.joint_names());
            let config = monitor(arm.name, &robot, &catalogue);
            runtime.watch(&settings(arm.name), config, live);
            let Some(route) = runtime.route(arm.name).filter(|_| arm.on) else {
                continue;
            };
            let routes = Routes::new(vec![route]);
            let options = ReplayOptions {
                recording: Played::Bytes(Arc::from(MOTION)),
                name: format!("demo:{}", arm.name),
                speed: 1.0,
                is_looped: true,
                is_restamped: true,
                pause_s: 0.0,
            };
            let crept = Crept::new(arm.lives.clone(), RATE, seed);
            let door = replay::open(&options, &routes, runtime.clock(), Some(Box::new(crept)));
            let door = door.map_err(words)?;
            let address = settings(arm.name).door.address;
            runtime.doors().adopt(address, door, routes);
        }
        runtime.look();
        let (_hooks, webhooks) = tokio::sync::watch::channel(Vec::new());
        let web = WebStart {
            settings: web,
            token: None,
            demo: Some(SAYS.into()),
            place,
            webhooks,
            steps,
        };
        let web = Web::start(web, &runtime, signals)?;
        Ok(Self { runtime, web })
    }
}

/// An arm as a configuration would have it.
fn settings(name: &str) -> RobotSettings {
    let door = DoorSettings {
        address: Address::Mcap {
            path: PathBuf::from(name),
            from_start: true,
            look_every_ms: 1000,
        },
        namespace: String::new(),
    };
    RobotSettings::new(name, PathBuf::new(), door)
}

/// Runs it until it is told to end.
///
/// # Errors
/// Why it can't be started, in words.
pub fn run(web: WebSettings) -> Result<(), String> {
    let (signals, told) = channel();
    let Demo { mut runtime, web } = Demo::start(web, signals)?;
    if let Some(address) = web.address {
        println!(
            "DEMO: made-up arms, one second is an hour. Open http://{address} in a browser; Ctrl-C ends it."
        );
    }
    until_told(&told, &mut runtime, |_, _| {});
    runtime.end();
    web.end();
    Ok(())
}
