//! Publisher thread: publishes the state of robots on `/diagnostics` and `/sinew/tendons` once a second.

use super::lock;
use super::registry::RobotRegistry;
use super::slot::RobotState;
use crate::config::Address;
use crate::words;
use sinew_log::encode::{
    DiagnosticArray, DiagnosticStatus, DynamicJointState, Header, InterfaceValue, KeyValue,
};
use sinew_model::Gaussian;
use sinew_transport::{Outgoing, Publisher};
use sinew_watch_core::RobotSnapshot;
use sinew_watch_core::alarm::{Alarm, Level};
use sinew_watch_core::snapshot::{Freshness, TendonSnapshot, Validity};
use std::collections::BTreeMap;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Interval of the messages.
const INTERVAL: Duration = Duration::from_secs(1);

/// Beginning of the name of every status on `/diagnostics`; the name of the robot and `/` with the joint follow.
pub const STATUS_PREFIX: &str = "sinew: ";

/// Interface names of a tendon on `/sinew/tendons`.
/// `valid` is 1 or 0: a controller uses the offset only while it is 1.
const INTERFACES: [&str; 6] = [
    "offset",
    "offset_std",
    "valid",
    "elongation",
    "strain",
    "alarm_level",
];

/// Robots behind each transport, with name and namespace.
pub(super) type RobotsByTransport = BTreeMap<Address, Vec<(String, String)>>;

/// State shared with the thread.
#[derive(Default)]
struct PublishState {
    publishers: BTreeMap<Address, Box<dyn Publisher>>,
    robots: RobotsByTransport,
}

/// Handle to the thread, which ends when the handle is dropped.
pub struct PublishHandle {
    state: Arc<Mutex<PublishState>>,
    _ends: Sender<()>,
}

impl PublishHandle {
    /// Publishes through a transport from now on.
    pub fn add(&self, address: Address, publisher: Box<dyn Publisher>) {
        lock(&self.state).publishers.insert(address, publisher);
    }

    /// Stops publishing through a closed transport.
    pub fn remove(&self, address: &Address) {
        lock(&self.state).publishers.remove(address);
    }

    /// Sets the robots behind each transport.
    pub fn set(&self, robots: RobotsByTransport) {
        lock(&self.state).robots = robots;
    }
}

/// Starts the thread.
///
/// # Errors
/// Returns the error of the system if the thread cannot be started.
pub(super) fn start(
    registry: Arc<RobotRegistry>,
) -> std::io::Result<(PublishHandle, JoinHandle<()>)> {
    let (_ends, ended) = channel();
    let state = Arc::new(Mutex::new(PublishState::default()));
    let thread = std::thread::Builder::new().name("publish".into());
    let shared = Arc::clone(&state);
    let thread = thread.spawn(move || run(&ended, &shared, &registry))?;
    Ok((PublishHandle { state, _ends }, thread))
}

fn run(ended: &Receiver<()>, state: &Mutex<PublishState>, registry: &RobotRegistry) {
    let mut next = Instant::now() + INTERVAL;
    let wait = |next: Instant| next.saturating_duration_since(Instant::now());
    while ended.recv_timeout(wait(next)) == Err(RecvTimeoutError::Timeout) {
        next = (next + INTERVAL).max(Instant::now());
        let PublishState { publishers, robots } = &mut *lock(state);
        for (address, publisher) in publishers {
            let robots = robots.get(address).map_or(&[][..], Vec::as_slice);
            publish(publisher.as_mut(), robots, registry);
        }
    }
}

fn publish(publisher: &mut dyn Publisher, robots: &[(String, String)], registry: &RobotRegistry) {
    for (name, namespace) in robots {
        let Some(RobotState::Monitored(robot)) = registry.get(name).map(|slot| slot.state()) else {
            continue;
        };
        let Some(header) = Header::at((robot.time_utc_s * 1e9) as i64, "") else {
            continue;
        };
        // An unreachable network may return a second later; the transport reports a lasting failure.
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

/// Returns the statuses of `/diagnostics`: one per tendon and one of the robot.
fn statuses(robot: &RobotSnapshot) -> Vec<DiagnosticStatus> {
    let name = &robot.robot;
    let status = |of: String, level, message, values: Vec<(&str, String)>| DiagnosticStatus {
        level: encoded(level),
        name: format!("{STATUS_PREFIX}{of}"),
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
            let of = |x: Gaussian| [x.mean, x.std].map(|x| x.to_string());
            value.map(|x| names.into_iter().zip(of(x)))
        };
        let [offset, elongation, strain] = [
            (["offset_rad", "offset_std_rad"], tendon.offset_rad),
            (["elongation_m", "elongation_std_m"], tendon.elongation_m),
            (["strain_ratio", "strain_std_ratio"], tendon.strain_ratio),
        ]
        .map(|(names, value)| both(names, value));
        let numbers = [offset, elongation, strain].into_iter().flatten().flatten();
        let valid = ("valid", (tendon.validity == Validity::Valid).to_string());
        let last = tendon.last.as_ref();
        let last = last.map(|last| ("last_record_utc_s", last.time_utc_s.to_string()));
        status(
            format!("{name}/{}", tendon.joint),
            tendon.level,
            words::tendon(tendon, &robot.alarms),
            numbers.chain([valid]).chain(last).collect(),
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

/// Returns the values of a tendon for [`INTERFACES`]; NaN where no value is available.
fn values(tendon: &TendonSnapshot) -> [f64; INTERFACES.len()] {
    let mean = |of: Option<Gaussian>| of.map_or(f64::NAN, |x| x.mean);
    [
        mean(tendon.offset_rad),
        tendon.offset_rad.map_or(f64::NAN, |offset| offset.std),
        f64::from(tendon.validity == Validity::Valid),
        mean(tendon.elongation_m),
        mean(tendon.strain_ratio),
        f64::from(tendon.level.number()),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn valid_is_one_only_for_valid_offset() {
        let value = |validity: serde_json::Value| {
            let tendon: TendonSnapshot = serde_json::from_value(json!({
                "joint": "elbow", "level": "OK", "offset_rad": { "mean": 8e-3, "std": 1e-3 }, "validity": validity,
                "elongation_m": null, "strain_ratio": null, "reason": null, "tensioned_utc_s": null, "last": null,
                "limits": [], "rope": null,
            }))
            .unwrap();
            let values = values(&tendon);
            assert_eq!(values[0], 8e-3);
            let at = INTERFACES.iter().position(|name| *name == "valid");
            values[at.unwrap()]
        };
        assert_eq!(value(json!({ "kind": "valid" })), 1.0);
        // After a slip the offset is present, but a controller must not use it.
        assert_eq!(value(json!({ "kind": "not-valid", "for_s": 1.5 })), 0.0);
    }
}
