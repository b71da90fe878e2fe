//! One robot: what it is, where it is heard, and how it is estimated.

use super::alarms::{self, AlarmSettings};
use super::door::{self, DoorSettings};
use super::path;
use sinew_files::WORKS_AT_C;
use sinew_files::{Bound, Fault, Fields as _, Located, Section};
use sinew_log::JointEffort;
use sinew_model::Gaussian;
use std::path::{Path, PathBuf};

/// A robot's name is at most so long.
const NAME_MOST: usize = 64;

/// One robot.
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
    /// How its messages are read.
    pub reading: ReadingSettings,
    /// Whether its stamps run with time, or are a simulation's.
    pub stamps_are_real: bool,
    /// How sessions are estimated.
    pub estimate: EstimateSettings,
    /// When things begin and end; `None`: as usual.
    pub times: TimeSettings,
    /// When alarms are raised and cleared.
    pub alarms: AlarmSettings,
}

impl RobotSettings {
    /// One that is heard here, and everything else as usual.
    pub fn new(name: &str, dir: PathBuf, door: DoorSettings) -> Self {
        Self {
            name: name.into(),
            dir,
            door,
            baseline: None,
            reading: ReadingSettings::default(),
            stamps_are_real: true,
            estimate: EstimateSettings {
                motor_torque: true,
                empty_gripper: false,
                temperature_c: None,
            },
            times: TimeSettings::default(),
            alarms: AlarmSettings::default(),
        }
    }
}

/// How a robot's messages are read: as the options of a recording.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ReadingSettings {
    /// Other names, units and gear ratios.
    pub mapping: Option<PathBuf>,
    /// Joint-side topic.
    pub joint_topic: Option<String>,
    /// Motor-side topic.
    pub motor_topic: Option<String>,
    /// Interface that holds the motor position.
    pub motor_interface: Option<String>,
    /// What the joint side's effort is.
    pub joint_effort: JointEffort,
}

/// How sessions are estimated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EstimateSettings {
    /// Whether a motor torque is used.
    pub motor_torque: bool,
    /// Whether the gripper never holds anything.
    pub empty_gripper: bool,
    /// Temperature, °C, where it isn't measured.
    pub temperature_c: Option<Gaussian>,
}

/// When things begin and end, s; `None`: as usual.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TimeSettings {
    /// Without data for so long, nothing is known.
    pub stale_after_s: Option<f64>,
    /// A session ends after so much motion.
    pub session_motion_s: Option<f64>,
    /// A session ends after so long a stand.
    pub session_pause_s: Option<f64>,
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
        reading: reading(s, folder)?,
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

fn reading(s: &Section<'_>, folder: &Path) -> Result<ReadingSettings, Located> {
    let efforts = [
        ("tau-el", JointEffort::TauEl),
        ("tau-m", JointEffort::TauM),
        ("ignore", JointEffort::Ignore),
    ];
    Ok(ReadingSettings {
        mapping: path(s, "mapping", folder)?,
        joint_topic: s.text("joint_topic")?,
        motor_topic: s.text("motor_topic")?,
        motor_interface: s.text("motor_interface")?,
        joint_effort: s.one_of("joint_effort", &efforts)?.unwrap_or_default(),
    })
}

fn estimate(s: &Section<'_>) -> Result<EstimateSettings, Located> {
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
    Ok(EstimateSettings {
        motor_torque: s.flag_or("motor_torque", true)?,
        empty_gripper: s.flag("empty_gripper")?,
        temperature_c: temperature_c.map(|mean| Gaussian::new(mean, deviation_k)),
    })
}

fn times(s: &Section<'_>) -> Result<TimeSettings, Located> {
    Ok(TimeSettings {
        stale_after_s: s.number("stale_after_s", Bound::Within(1.0, 3600.0))?,
        session_motion_s: s.number("session_motion_s", Bound::Within(10.0, 86_400.0))?,
        session_pause_s: s.number("session_pause_s", Bound::Within(5.0, 3600.0))?,
    })
}
