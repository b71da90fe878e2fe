//! Demonstration (`sinew watch --demo`): simulated robots; no network connection except the page.
//!
//! A simulated motion, recorded by `sinew simulate`, is replayed repeatedly by the replay transport, through the real
//! queues, monitors and an in-memory store. The ropes creep by the creep law, one hour per second; a strand fails
//! after three minutes. All output is marked as a demonstration.

mod alter;
mod arms;
mod history;
#[cfg(test)]
mod tests;

use crate::config::{Address, RobotSettings, TransportSettings, WebSettings};
use crate::runtime::{ClockRate, Runtime, Start};
use crate::service::{Web, WebStart, run_until_stopped};
use crate::store::{Place, Store};
use alter::Crept;
use arms::arms;
use sinew_estimate::baseline::Baseline;
use sinew_estimate::session::{Learning, Payload, Recorder, learn_recorded};
use sinew_log::live::LiveOptions;
use sinew_log::{OpenOptions, Recording};
use sinew_model::offset::FeatureConfig;
use sinew_model::robot::{BIOROB_LIKE, Robot, RobotFile};
use sinew_rope::Catalogue;
use sinew_transport::Routes;
use sinew_transport::replay::{self, Played, ReplayOptions};
use sinew_watch_core::alarm::{Condition, Delays};
use sinew_watch_core::{ClockChoice, MonitorConfig};
use std::io::Cursor;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::channel;

/// Speed of the civil clock of the arms relative to real time.
const RATE: f64 = 3600.0;

/// Motion recorded by `demo/arm.toml`.
const MOTION: &[u8] = include_bytes!("../../demo/arm.mcap");
const ROBOT: &str = include_str!("../../demo/robot.toml");

/// Description of the demonstration on the page.
const DESCRIPTION: &str = "simulated robots, 1 s = 1 h. The ropes creep by the creep law at this rate, while the arms move in \
                           real time. A strand at the elbow of demo-1 fails after 3 min; it is suspected at the end of that day and \
                           confirmed on the next. No data are kept.";

fn words(error: impl std::fmt::Display) -> String {
    error.to_string()
}

/// Returns the robot of all arms.
fn robot() -> Result<Robot, String> {
    let file = RobotFile::parse(ROBOT, "robot.toml").map_err(words)?;
    file.build(BIOROB_LIKE.urdf).map_err(words)
}

/// Estimates the baseline of ropes without elongation from the motion.
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

/// Returns the configuration of an arm's monitor: a session ends with every repetition of the motion, which is the
/// work of one day.
fn monitor(name: &str, robot: &Arc<Robot>, catalogue: &Arc<Catalogue>) -> MonitorConfig {
    let mut config = MonitorConfig::new(name, "demo", Arc::clone(robot), Arc::clone(catalogue));
    config.estimate.payload = Payload::Empty;
    config.clock = ClockChoice::Fast { civil_rate: RATE };
    config.times.session_motion_s = 60.0;
    // The arm stands for 2 s between two repetitions, and for 0.6 s at most within one.
    config.times.session_pause_s = 1.3;
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

/// Running demonstration with its page.
pub struct Demo {
    /// Monitor of the arms.
    pub runtime: Runtime,
    /// Web page of the arms.
    pub web: Web,
}

impl Demo {
    /// Starts the demonstration.
    ///
    /// # Errors
    /// Returns the reason as text if a store, thread, transport or address is not available.
    pub fn start(
        web: WebSettings,
        signals: std::sync::mpsc::Sender<crate::service::Signal>,
    ) -> Result<Self, String> {
        let catalogue = Arc::new(Catalogue::shipped().map_err(words)?);
        let robot = Arc::new(robot()?);
        let baseline = baseline(&robot)?;
        let arms = arms(&robot, &catalogue);
        // Several demonstrations may run in one process.
        static STORES: AtomicU64 = AtomicU64::new(0);
        let place = Place::Memory(STORES.fetch_add(1, Ordering::Relaxed));
        let mut start = Start::at(place.clone());
        let begins = start.clock.now();
        let start_utc_s = begins.utc_ns as f64 * 1e-9;
        start.clock_rate = ClockRate::Accelerated {
            from: begins,
            rate: RATE,
        };
        // The in-memory store exists as long as a connection is open.
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
            let crept = Crept::new(arm.tendons.clone(), RATE, seed);
            let transport = replay::open(&options, &routes, runtime.clock(), Some(Box::new(crept)));
            let transport = transport.map_err(words)?;
            let address = settings(arm.name).transport.address;
            runtime.transports().adopt(address, transport, routes);
        }
        runtime.look();
        let (_receivers, receivers) = tokio::sync::watch::channel(Vec::new());
        let web = WebStart {
            settings: web,
            tokens: Vec::new(),
            demo: Some(DESCRIPTION.into()),
            place,
            receivers,
            mqtt: None,
            steps,
        };
        let web = Web::start(web, &runtime, signals)?;
        Ok(Self { runtime, web })
    }
}

/// Returns the settings of an arm as in a configuration.
fn settings(name: &str) -> RobotSettings {
    let transport = TransportSettings {
        address: Address::Mcap {
            path: PathBuf::from(name),
            from_start: true,
            look_every_ms: 1000,
        },
        namespace: String::new(),
    };
    RobotSettings::new(name, PathBuf::new(), transport)
}

/// Runs the demonstration until it is stopped.
///
/// # Errors
/// Returns the reason as text if the demonstration cannot be started.
pub fn run(web: WebSettings) -> Result<(), String> {
    let (sender, signals) = channel();
    let Demo { mut runtime, web } = Demo::start(web, sender)?;
    if let Some(address) = web.address {
        println!(
            "Demo: simulated robots, 1 s = 1 h. Open http://{address} in a browser; stop with Ctrl-C."
        );
    }
    run_until_stopped(&signals, &mut runtime, |_, _| {});
    runtime.end();
    web.end();
    Ok(())
}
