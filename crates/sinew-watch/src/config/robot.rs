//! Settings of one robot: description, transport and estimator.

use super::transport::{self, TransportSettings};
use super::{alarms, path};
use sinew_estimate::session::{Payload, SessionOptions};
use sinew_files::WORKS_AT_C;
use sinew_files::{Bound, Fault, Fields as _, Located, Section};
use sinew_log::{JointEffort, OpenOptions};
use sinew_model::Gaussian;
use sinew_watch_core::{AlarmOptions, Times};
use std::path::{Path, PathBuf};

/// Maximum length of the name of a robot, characters.
const MAX_NAME_CHARS: usize = 64;

/// Settings of one robot.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotSettings {
    /// Name of the robot on pages and in records, metrics and URLs.
    pub name: String,
    /// Folder of robot.toml.
    pub dir: PathBuf,
    /// Transport and namespace of its messages.
    pub transport: TransportSettings,
    /// Baseline file from `sinew baseline`; used if the store has none.
    pub baseline: Option<PathBuf>,
    /// Mapping file with other names, units and gear ratios of its messages.
    pub mapping: Option<PathBuf>,
    /// Options for reading messages, except the mapping.
    pub reading: OpenOptions,
    /// Whether time stamps follow real time; otherwise those of a simulation.
    pub stamps_are_real: bool,
    /// Options of the estimates of sessions.
    pub estimate: SessionOptions,
    /// Durations that delimit sessions and data gaps.
    pub times: Times,
    /// Delays and thresholds of its alarms.
    pub alarms: AlarmOptions,
}

impl RobotSettings {
    /// Returns the default settings of a robot with this transport.
    pub fn new(name: &str, dir: PathBuf, transport: TransportSettings) -> Self {
        Self {
            name: name.into(),
            dir,
            transport,
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
    let name = s.need_text("name", "set the name of the robot on pages and in records")?;
    if !(s.value("name").is_none() || is_name(&name)) {
        return Err(s.invalid(
            "name",
            "at most 64 letters, digits, -, _ and ., the first a letter or digit",
        ));
    }
    let dir = s.need_text(
        "dir",
        "set the folder of robot.toml; `sinew init` creates one",
    )?;
    Ok(RobotSettings {
        name,
        dir: folder.join(dir),
        transport: transport::read(s, folder)?,
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

/// Whether the text is a valid name, which is also part of URLs and file names.
fn is_name(name: &str) -> bool {
    let fits = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    let starts = name.starts_with(|c: char| c.is_ascii_alphanumeric());
    starts && name.len() <= MAX_NAME_CHARS && name.chars().all(fits)
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
    /// Uncertainty of a room thermometer, K.
    const ROOM_THERMOMETER_STD_K: f64 = 2.0;
    let temperature_c = s.number("temperature_c", WORKS_AT)?;
    let std_k = s.number("temperature_std_k", Bound::Positive)?;
    if std_k.is_some() && temperature_c.is_none() {
        return Err(s.here(
            Fault::Contradiction,
            "temperature_std_k requires temperature_c, which is missing",
        ));
    }
    let std_k = std_k.unwrap_or(ROOM_THERMOMETER_STD_K);
    Ok(SessionOptions {
        payload: match s.flag("empty_gripper")? {
            true => Payload::Empty,
            false => Payload::Unknown,
        },
        motor_torque: s.flag_or("motor_torque", true)?,
        temperature_c: temperature_c.map(|mean| Gaussian::new(mean, std_k)),
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
