//! One robot: what it is, where it is heard, and how it is estimated.

use super::door::{self, DoorSettings};
use super::{alarms, path};
use sinew_estimate::session::{Payload, SessionOptions};
use sinew_files::WORKS_AT_C;
use sinew_files::{Bound, Fault, Fields as _, Located, Section};
use sinew_log::{JointEffort, OpenOptions};
use sinew_model::Gaussian;
use sinew_watch_core::{AlarmOptions, Times};
use std::path::{Path, PathBuf};

/// A robot's name is at most so long.
const NAME_MOST: usize = 64;

/// The settings of one robot.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotSettings {
    /// Its name: on pages, in records, metrics and addresses.
    pub name: String,
    /// Folder of its robot.toml.
    pub dir: PathBuf,
    /// Where it is heard.
    pub door: DoorSettings,
    /// What `sinew baseline` wrote; used where nothing is stored yet.
    pub baseline: Option<PathBuf>,
    /// Other names, units and gear ratios of its messages.
    pub mapping: Option<PathBuf>,
    /// How its messages are read, but for the mapping.
    pub reading: OpenOptions,
    /// Whether its stamps run with time, or are a simulation's.
    pub stamps_are_real: bool,
    /// How sessions are estimated.
    pub estimate: SessionOptions,
    /// When things begin and end.
    pub times: Times,
    /// When alarms are raised and cleared.
    pub alarms: AlarmOptions,
}

impl RobotSettings {
    /// One that is heard here, and everything else as usual.
    pub fn new(name: &str, dir: PathBuf, door: DoorSettings) -> Self {
        Self {
            name: name.into(),
            dir,
            door,
            baseline: None,
            mapping: None,
            reading: OpenOptions::default(),
            stamps_are_real: true,
            estimate: SessionOptions::default(),
            times: Times::default(),
            alarms: AlarmOptions::default(),
        }
    }
}

pub(super) fn read(s: &Section<'_>, folder: &Path) -> Result<RobotSettings, Located> {
    let name = s.need_text("name", "what the robot is called on pages and in records")?;
    if !(s.value("name").is_none() || is_name(&name)) {
        return Err(s.refuse(
            "name",
            "at most 64 letters, digits, -, _ and ., the first a letter or digit",
        ));
    }
    let dir = s.need_text(
        "dir",
        "the folder with its robot.toml; sinew init writes a first one",
    )?;
    Ok(RobotSettings {
        name,
        dir: folder.join(dir),
        door: door::read(s, folder)?,
        baseline: path(s, "baseline", folder)?,
        mapping: path(s, "mapping", folder)?,
        reading: reading(s)?,
        stamps_are_real: s
            .one_of("stamps", &[("real", true), ("simulated", false)])?
            .unwrap_or(true),
        estimate: estimate(s)?,
        times: s.read("times", times)?.unwrap_or_default(),
        alarms: s.read("alarm", alarms::read)?.unwrap_or_default(),
    })
}

/// It stands in addresses and file names, too.
fn is_name(name: &str) -> bool {
    let fits = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    let starts = name.starts_with(|c: char| c.is_ascii_alphanumeric());
    starts && name.len() <= NAME_MOST && name.chars().all(fits)
}

fn reading(s: &Section<'_>) -> Result<OpenOptions, Located> {
    let usual = OpenOptions::default();
    let efforts = [
        ("tau-el", JointEffort::TauEl),
        ("tau-m", JointEffort::TauM),
        ("ignore", JointEffort::Ignore),
    ];
    Ok(OpenOptions {
        joint_state_topic: s.text("joint_topic")?,
        motor_topic: s.text("motor_topic")?,
        motor_interface: s.text("motor_interface")?.unwrap_or(usual.motor_interface),
        joint_effort: s.one_of("joint_effort", &efforts)?.unwrap_or_default(),
        ..OpenOptions::default()
    })
}

fn estimate(s: &Section<'_>) -> Result<SessionOptions, Located> {
    const WORKS_AT: Bound = Bound::Within(WORKS_AT_C[0], WORKS_AT_C[1]);
    /// As a room thermometer tells it, K.
    const THERMOMETER_K: f64 = 2.0;
    let temperature_c = s.number("temperature_c", WORKS_AT)?;
    let deviation_k = s.number("temperature_deviation_k", Bound::Positive)?;
    if deviation_k.is_some() && temperature_c.is_none() {
        return Err(s.here(
            Fault::Contradiction,
            "temperature_deviation_k says how sure temperature_c is, which is missing",
        ));
    }
    let deviation_k = deviation_k.unwrap_or(THERMOMETER_K);
    Ok(SessionOptions {
        payload: match s.flag("empty_gripper")? {
            true => Payload::Empty,
            false => Payload::Unknown,
        },
        motor_torque: s.flag_or("motor_torque", true)?,
        temperature_c: temperature_c.map(|mean| Gaussian::new(mean, deviation_k)),
        ..SessionOptions::default()
    })
}

fn times(s: &Section<'_>) -> Result<Times, Located> {
    let usual = Times::default();
    let time = |key, low, high, usual| s.number_or(key, Bound::Within(low, high), usual);
    Ok(Times {
        stale_after_s: time("stale_after_s", 1.0, 3600.0, usual.stale_after_s)?,
        session_motion_s: time("session_motion_s", 10.0, 86_400.0, usual.session_motion_s)?,
        session_pause_s: time("session_pause_s", 5.0, 3600.0, usual.session_pause_s)?,
        ..usual
    })
}
