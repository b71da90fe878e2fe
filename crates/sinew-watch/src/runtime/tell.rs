//! Once a second, what is known goes to the robots' networks: `/diagnostics` and `/sinew/tendons`.

use super::board::Board;
use super::door::DoorKey;
use super::slot::Seen;
use crate::words;
use sinew_door::{Outgoing, Publisher};
use sinew_log::encode::{
    DiagnosticArray, DiagnosticStatus, DynamicJointState, Header, InterfaceValue, KeyValue,
};
use sinew_model::Gaussian;
use sinew_watch_core::RobotSnapshot;
use sinew_watch_core::alarm::Level;
use std::collections::BTreeMap;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// So often.
const EVERY: Duration = Duration::from_secs(1);

/// Values of a tendon on `/sinew/tendons`.
pub const INTERFACES: [&str; 5] = [
    "offset",
    "offset_interval_95",
    "elongation",
    "strain",
    "alarm_level",
];

enum Told {
    Add(DoorKey, Box<dyn Publisher>),
    Remove(DoorKey),
    End,
}

/// Which robots are told of behind which door: name and namespace.
pub(super) type Behind = BTreeMap<DoorKey, Vec<(String, String)>>;

/// How the thread is reached.
#[derive(Clone)]
pub struct TellHandle {
    sender: Sender<Told>,
    behind: Arc<Mutex<Behind>>,
}

impl TellHandle {
    /// A door's way out.
    pub fn add(&self, key: DoorKey, publisher: Box<dyn Publisher>) {
        let _ended = self.sender.send(Told::Add(key, publisher));
    }

    /// A door is shut.
    pub fn remove(&self, key: &DoorKey) {
        let _ended = self.sender.send(Told::Remove(key.clone()));
    }

    /// Which robots are behind which door.
    pub fn set(&self, behind: Behind) {
        *self.behind.lock().unwrap_or_else(PoisonError::into_inner) = behind;
    }

    /// It ends.
    pub fn end(&self) {
        let _ended = self.sender.send(Told::End);
    }
}

/// Starts the thread.
///
/// # Errors
/// The system has no thread left.
pub(super) fn start(board: Arc<Board>) -> std::io::Result<(TellHandle, JoinHandle<()>)> {
    let (sender, receiver) = channel();
    let behind = Arc::new(Mutex::new(Behind::new()));
    let handle = TellHandle {
        sender,
        behind: Arc::clone(&behind),
    };
    let thread = std::thread::Builder::new()
        .name("tell".into())
        .spawn(move || run(&receiver, &behind, &board))?;
    Ok((handle, thread))
}

fn run(told: &Receiver<Told>, behind: &Mutex<Behind>, board: &Board) {
    let mut publishers: BTreeMap<DoorKey, Box<dyn Publisher>> = BTreeMap::new();
    let mut next = Instant::now() + EVERY;
    loop {
        match told.recv_timeout(next.saturating_duration_since(Instant::now())) {
            Ok(Told::Add(key, publisher)) => {
                publishers.insert(key, publisher);
            }
            Ok(Told::Remove(key)) => {
                publishers.remove(&key);
            }
            Ok(Told::End) | Err(RecvTimeoutError::Disconnected) => return,
            Err(RecvTimeoutError::Timeout) => {
                next = (next + EVERY).max(Instant::now());
                let behind = behind
                    .lock()
                    .unwrap_or_else(PoisonError::into_inner)
                    .clone();
                for (key, publisher) in &mut publishers {
                    let robots = behind.get(key).map_or(&[][..], Vec::as_slice);
                    publish(publisher.as_mut(), robots, board);
                }
            }
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
        let statuses = Statuses::of(&robot);
        // A network that can't be reached may be back a second later; the door says so where it lasts.
        let _unsent = publisher.publish(&Outgoing::Diagnostics(DiagnosticArray {
            header,
            status: &statuses.messages(),
        }));
        let tendons = Tendons::of(&robot);
        let values = tendons.interfaces();
        let _unsent = publisher.publish(&Outgoing::Tendons {
            namespace,
            state: DynamicJointState {
                header,
                joint_names: &tendons.joints,
                interface_values: &values,
            },
        });
    }
}

/// Texts of `/diagnostics`: one status per tendon, one of the robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Statuses {
    all: Vec<Status>,
}

#[derive(Debug, Clone, PartialEq)]
struct Status {
    level: Level,
    name: String,
    message: String,
    hardware: String,
    values: Vec<(&'static str, String)>,
}

fn number(value: f64) -> String {
    format!("{value}")
}

fn with_half(
    values: &mut Vec<(&'static str, String)>,
    names: [&'static str; 2],
    value: Option<Gaussian>,
) {
    if let Some(value) = value {
        values.push((names[0], number(value.mean)));
        values.push((names[1], number(value.half_width_95())));
    }
}

fn level(level: Level) -> sinew_log::encode::Level {
    match level {
        Level::Ok => sinew_log::encode::Level::Ok,
        Level::Warn => sinew_log::encode::Level::Warn,
        Level::Error => sinew_log::encode::Level::Error,
        Level::Stale => sinew_log::encode::Level::Stale,
    }
}

impl Statuses {
    /// Of a robot.
    pub fn of(robot: &RobotSnapshot) -> Self {
        let hardware = &robot.robot;
        let tendons = robot.tendons.iter().map(|tendon| {
            let mut values = Vec::new();
            with_half(
                &mut values,
                ["offset_rad", "offset_interval_95_rad"],
                tendon.offset_rad,
            );
            with_half(
                &mut values,
                ["elongation_m", "elongation_interval_95_m"],
                tendon.elongation_m,
            );
            with_half(
                &mut values,
                ["strain_ratio", "strain_interval_95_ratio"],
                tendon.strain_ratio,
            );
            if let Some(last) = &tendon.last {
                values.push(("last_record_utc_s", number(last.time_utc_s)));
            }
            Status {
                level: tendon.level,
                name: format!("sinew: {hardware}/{}", tendon.joint),
                message: words::tendon(tendon, &robot.alarms),
                hardware: format!("{hardware}/{}", tendon.joint),
                values,
            }
        });
        let whole = Status {
            level: robot
                .alarms
                .iter()
                .filter(|a| a.key.joint.is_none())
                .map(|a| a.level())
                .chain([match robot.freshness {
                    sinew_watch_core::snapshot::Freshness::Fresh => Level::Ok,
                    _ => Level::Stale,
                }])
                .max_by_key(|level| level.urgency())
                .unwrap_or_default(),
            name: format!("sinew: {hardware}"),
            message: words::robot(robot),
            hardware: hardware.clone(),
            values: vec![
                ("rate_hz", number(robot.rate_hz)),
                ("frames", robot.frames.to_string()),
                ("frames_lost", robot.frames_lost.to_string()),
            ],
        };
        Self {
            all: tendons.chain([whole]).collect(),
        }
    }

    /// As messages.
    pub fn messages(&self) -> Vec<DiagnosticStatus> {
        self.all
            .iter()
            .map(|status| DiagnosticStatus {
                level: level(status.level),
                name: status.name.clone(),
                message: status.message.clone(),
                hardware_id: status.hardware.clone(),
                values: (status.values.iter())
                    .map(|(key, value)| KeyValue {
                        key: (*key).into(),
                        value: value.clone(),
                    })
                    .collect(),
            })
            .collect()
    }
}

/// Values of `/sinew/tendons`; NaN where nothing is known now.
#[derive(Debug, Clone, PartialEq)]
pub struct Tendons {
    /// Joints.
    pub joints: Vec<String>,
    /// A value for each of [`INTERFACES`].
    pub values: Vec<[f64; INTERFACES.len()]>,
}

impl Tendons {
    /// Of a robot.
    pub fn of(robot: &RobotSnapshot) -> Self {
        let values = robot.tendons.iter().map(|tendon| {
            let mean = |of: Option<Gaussian>| of.map_or(f64::NAN, |x| x.mean);
            [
                mean(tendon.offset_rad),
                tendon.offset_rad.map_or(f64::NAN, Gaussian::half_width_95),
                mean(tendon.elongation_m),
                mean(tendon.strain_ratio),
                f64::from(tendon.level.number()),
            ]
        });
        Self {
            joints: robot.tendons.iter().map(|t| t.joint.clone()).collect(),
            values: values.collect(),
        }
    }

    fn interfaces(&self) -> Vec<InterfaceValue<'_>> {
        let interface_names = &INTERFACES[..];
        self.values
            .iter()
            .map(|values| InterfaceValue {
                interface_names,
                values,
            })
            .collect()
    }
}
