//! `sinew watch --demo`: no robot and no network but the page.
//!
//! A recorded motion loops through the real queues, monitors and store, which is in memory. Its ropes creep by the
//! rope law, at an hour a second; a strand fails after three minutes. It says DEMO wherever it says
//! anything.

mod alter;
mod creep;
mod history;
mod script;

pub use creep::Creep;
pub use script::{Arm, Life, Sudden, arms};

use crate::config::{DoorSettings, RobotSettings, WebSettings};
use crate::runtime::{DoorKey, Pace, Runtime, Start};
use crate::service::{Web, WebStart, until_told};
use crate::store::{Place, Store};
use alter::Crept;
use sinew_door::Routes;
use sinew_door::replay::{self, Played, ReplayOptions};
use sinew_estimate::baseline::Baseline;
use sinew_estimate::session::{Learning, Payload, Recorder, learn_recorded};
use sinew_log::live::{Live, LiveOptions};
use sinew_model::offset::FeatureConfig;
use sinew_model::robot::{Robot, RobotFile};
use sinew_rope::Catalogue;
use sinew_watch_core::alarm::{Condition, Delays};
use sinew_watch_core::{ClockChoice, MonitorConfig};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::channel;

/// Seconds of the arms' civil clock in one.
pub const RATE: f64 = 3600.0;

/// Made by `demo/arm.toml`.
const MOTION: &[u8] = include_bytes!("../../demo/arm.mcap");
const ROBOT: &str = include_str!("../../demo/robot.toml");
const URDF: &str = include_str!("../../../../robots/biorob-like/biorob-like.urdf");

/// What the page says.
const SAYS: &str = "These arms are made up. One second is an hour of theirs: their ropes creep by the rope law at that \
                    pace, while the arms move at their own. A strand of demo-1's elbow fails after three minutes. \
                    Nothing is kept when it ends.";

/// The arms' robot.
///
/// # Errors
/// What comes along can't be read, in words.
pub fn robot() -> Result<Robot, String> {
    let file = RobotFile::parse(ROBOT, "robot.toml").map_err(|e| e.to_string())?;
    file.build(URDF).map_err(|e| e.to_string())
}

/// What the motion teaches of ropes that are not stretched.
///
/// # Errors
/// What comes along can't be read, in words.
pub fn baseline(robot: &Robot) -> Result<Baseline, String> {
    let words = |e: &dyn std::fmt::Display| e.to_string();
    let options = LiveOptions::of_joints(robot.joint_names());
    let mut live = Live::new(&options).map_err(|e| words(&e))?;
    let gap_s = sinew_log::OpenOptions::default().gap_s;
    let mut recorder = Recorder::new(robot, &FeatureConfig::default(), gap_s);
    let mut start_ns = None;
    let mut take = |live: &mut Live| {
        while let Some(frame) = live.frame() {
            let start_ns = *start_ns.get_or_insert(frame.time_ns);
            recorder.push(frame, (frame.time_ns - start_ns) as f64 * 1e-9);
        }
    };
    for message in mcap::MessageStream::new(MOTION).map_err(|e| words(&e))? {
        let message = message.map_err(|e| words(&e))?;
        let schema = message
            .channel
            .schema
            .as_ref()
            .map_or("", |s| s.name.as_str());
        if let Some(topic) = live.topic(&message.channel.topic, schema) {
            live.push(topic, &message.data, message.log_time as i64);
            take(&mut live);
        }
    }
    live.silence();
    take(&mut live);
    let learning = Learning::default();
    let learned = learn_recorded(robot, &recorder.finish(), "demo", &learning);
    Ok(learned.map_err(|e| words(&e))?.0)
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
    let limits = [
        Condition::ReplaceLimit,
        Condition::RetensionLimit,
        Condition::LimitNear,
    ];
    config.alarms.delays = limits
        .into_iter()
        .map(|condition| (condition, soon))
        .collect();
    config
}

/// The demonstration, running.
pub struct Demo {
    /// Its monitor.
    pub runtime: Runtime,
    /// Its page.
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
        let catalogue = Arc::new(Catalogue::shipped().map_err(|e| e.to_string())?);
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
        let mut store = Store::open(place.clone()).map_err(|e| e.to_string())?;
        for arm in &arms {
            let history = history::transactions(arm, &robot, &baseline, start_utc_s);
            store.commit(&history).map_err(|e| e.to_string())?;
        }
        let (mut runtime, steps) = Runtime::with_store(start, store).map_err(|e| e.to_string())?;
        for (seed, arm) in (1..).zip(&arms) {
            let live = LiveOptions::of_joints(robot.joint_names());
            runtime.watch(
                &settings(arm.name),
                monitor(arm.name, &robot, &catalogue),
                live,
            );
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
            let door = door.map_err(|e| e.to_string())?;
            runtime
                .doors()
                .adopt(DoorKey::of(&settings(arm.name).door), door, routes);
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
    let door = DoorSettings::Mcap {
        path: PathBuf::from(name),
        namespace: String::new(),
        from_start: true,
        look_every_s: 1.0,
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
