//! Once a second, what is known goes to the robots' networks: `/diagnostics` and `/sinew/tendons`.

use super::board::Board;
use super::lock;
use super::slot::Seen;
use crate::config::Address;
use crate::words;
use sinew_door::{Outgoing, Publisher};
use sinew_log::encode::{
    DiagnosticArray, DiagnosticStatus, DynamicJointState, Header, InterfaceValue, KeyValue,
};
use sinew_model::Gaussian;
use sinew_watch_core::RobotSnapshot;
use sinew_watch_core::alarm::{Alarm, Level};
use sinew_watch_core::snapshot::{Freshness, TendonSnapshot};
use std::collections::BTreeMap;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Time from one message to the next.
const EVERY: Duration = Duration::from_secs(1);

/// Values of a tendon on `/sinew/tendons`.
const INTERFACES: [&str; 5] = [
    "offset",
    "offset_interval_95",
    "elongation",
    "strain",
    "alarm_level",
];

/// Which robots are told of behind which door: name and namespace.
pub(super) type Behind = BTreeMap<Address, Vec<(String, String)>>;

/// What the thread publishes.
#[derive(Default)]
struct Told {
    publishers: BTreeMap<Address, Box<dyn Publisher>>,
    behind: Behind,
}

/// How the thread is reached; it ends when this is dropped.
pub struct TellHandle {
    told: Arc<Mutex<Told>>,
    _ends: Sender<()>,
}

impl TellHandle {
    /// Publishes through a door from now on.
    pub fn add(&self, address: Address, publisher: Box<dyn Publisher>) {
        lock(&self.told).publishers.insert(address, publisher);
    }

    /// Publishes no more through a door, which is shut.
    pub fn remove(&self, address: &Address) {
        lock(&self.told).publishers.remove(address);
    }

    /// Sets which robots are behind which door.
    pub fn set(&self, behind: Behind) {
        lock(&self.told).behind = behind;
    }
}

/// Starts the thread.
///
/// # Errors
/// The system has no thread left.
pub(super) fn start(board: Arc<Board>) -> std::io::Result<(TellHandle, JoinHandle<()>)> {
    let (_ends, ended) = channel();
    let told = Arc::new(Mutex::new(Told::default()));
    let thread = std::thread::Builder::new().name("tell".into());
    let own = Arc::clone(&told);
    let thread = thread.spawn(move || run(&ended, &own, &board))?;
    Ok((TellHandle { told, _ends }, thread))
}

fn run(ended: &Receiver<()>, told: &Mutex<Told>, board: &Board) {
    let mut next = Instant::now() + EVERY;
    let wait = |next: Instant| next.saturating_duration_since(Instant::now());
    while ended.recv_timeout(wait(next)) == Err(RecvTimeoutError::Timeout) {
        next = (next + EVERY).max(Instant::now());
        let Told { publishers, behind } = &mut *lock(told);
        for (address, publisher) in publishers {
            let robots = behind.get(address).map_or(&[][..], Vec::as_slice);
            publish(publisher.as_mut(), robots, board);
        }
    }
}

fn publish(publisher: &mut dyn Publisher, robots: &[(String, String)], board: &Board) {
    for (name, namespace) in robots {
        let Some(Seen::Watched(robot)) = board.get(name).map(|slot| slot.seen()) else {
            continue;
        };
        let Some(header) = Header::at((robot.time_utc_s * 1e9) as i64, "") else {
            continue;
        };
        // A network that can't be reached may be back a second later; the door says so where it lasts.
        let _unsent = publisher.publish(&Outgoing::Diagnostics(DiagnosticArray {
            header,
            status: &statuses(&robot),
        }));
        let joints: Vec<String> = robot.tendons.iter().map(|t| t.joint.clone()).collect();
        let values: Vec<[f64; INTERFACES.len()]> = robot.tendons.iter().map(values).collect();
        let values: Vec<InterfaceValue<'_>> = (values.iter())
            .map(|values| InterfaceValue {
                interface_names: &INTERFACES,
                values,
            })
            .collect();
        let _unsent = publisher.publish(&Outgoing::Tendons {
            namespace,
            state: DynamicJointState {
                header,
                joint_names: &joints,
                interface_values: &values,
            },
        });
    }
}

/// The statuses of `/diagnostics`: one for each tendon, and one of the robot.
fn statuses(robot: &RobotSnapshot) -> Vec<DiagnosticStatus> {
    let name = &robot.robot;
    let status = |of: String, level, message, values: Vec<(&str, String)>| DiagnosticStatus {
        level: encoded(level),
        name: format!("sinew: {of}"),
        message,
        hardware_id: of,
        values: (values.into_iter())
            .map(|(key, value)| KeyValue {
                key: key.into(),
                value,
            })
            .collect(),
    };
    let tendons = robot.tendons.iter().map(|tendon| {
        let both = |names: [&'static str; 2], value: Option<Gaussian>| {
            let of = |x: Gaussian| [x.mean, x.half_width_95()].map(|x| x.to_string());
            value.map(|x| names.into_iter().zip(of(x)))
        };
        let [offset, elongation, strain] = [
            (["offset_rad", "offset_interval_95_rad"], tendon.offset_rad),
            (
                ["elongation_m", "elongation_interval_95_m"],
                tendon.elongation_m,
            ),
            (
                ["strain_ratio", "strain_interval_95_ratio"],
                tendon.strain_ratio,
            ),
        ]
        .map(|(names, value)| both(names, value));
        let numbers = [offset, elongation, strain].into_iter().flatten().flatten();
        let last = tendon.last.as_ref();
        let last = last.map(|last| ("last_record_utc_s", last.time_utc_s.to_string()));
        status(
            format!("{name}/{}", tendon.joint),
            tendon.level,
            words::tendon(tendon, &robot.alarms),
            numbers.chain(last).collect(),
        )
    });
    let of_robot = robot.alarms.iter().filter(|a| a.key.joint.is_none());
    let stale = match robot.freshness {
        Freshness::Fresh => Level::Ok,
        _ => Level::Stale,
    };
    let whole = status(
        name.clone(),
        Level::worst(of_robot.map(Alarm::level).chain([stale])),
        words::robot(robot),
        vec![
            ("rate_hz", robot.rate_hz.to_string()),
            ("frames", robot.frames.to_string()),
            ("frames_lost", robot.frames_lost.to_string()),
        ],
    );
    tendons.chain([whole]).collect()
}

fn encoded(level: Level) -> sinew_log::encode::Level {
    match level {
        Level::Ok => sinew_log::encode::Level::Ok,
        Level::Warn => sinew_log::encode::Level::Warn,
        Level::Error => sinew_log::encode::Level::Error,
        Level::Stale => sinew_log::encode::Level::Stale,
    }
}

/// A tendon's values for [`INTERFACES`]; NaN where nothing is known now.
fn values(tendon: &TendonSnapshot) -> [f64; INTERFACES.len()] {
    let mean = |of: Option<Gaussian>| of.map_or(f64::NAN, |x| x.mean);
    [
        mean(tendon.offset_rad),
        tendon.offset_rad.map_or(f64::NAN, Gaussian::half_width_95),
        mean(tendon.elongation_m),
        mean(tendon.strain_ratio),
        f64::from(tendon.level.number()),
    ]
}
