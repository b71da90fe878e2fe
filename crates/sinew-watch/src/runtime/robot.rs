//! From a robot's settings to its monitor.

use crate::config::{EstimateSettings, RobotSettings};
use sinew_estimate::baseline::Baseline;
use sinew_estimate::robot_dir::{self, RobotDirError};
use sinew_estimate::session::{Payload, SessionOptions};
use sinew_log::live::LiveOptions;
use sinew_log::{Mapping, OpenOptions};
use sinew_model::robot::{Robot, RobotFile};
use sinew_rope::Catalogue;
use sinew_watch_core::{AlarmOptions, ClockChoice, MonitorConfig, Times};
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

/// What is read of robots' files, so that a thousand of one type are read once.
#[derive(Debug)]
pub(super) struct Files {
    catalogue: Arc<Catalogue>,
    robots: HashMap<PathBuf, Arc<Robot>>,
}

/// Why a robot isn't watched.
#[derive(Debug, Clone)]
pub(super) enum NotYet {
    /// Its files are wrong.
    Fault(String),
    /// Its description comes with its messages; these are the options to wait with.
    WaitsForUrdf(Box<LiveOptions>),
}

impl Files {
    /// Nothing read yet.
    ///
    /// # Errors
    /// The ropes that come along can't be read.
    pub(super) fn new() -> Result<Self, String> {
        Ok(Self {
            catalogue: Arc::new(Catalogue::shipped().map_err(|e| e.to_string())?),
            robots: HashMap::new(),
        })
    }

    /// Reads robots' files anew from now on.
    pub(super) fn forget(&mut self) {
        self.robots.clear();
    }

    /// What a robot's monitor and its messages' reader are told; `description` is the URDF that came with them.
    ///
    /// # Errors
    /// [`NotYet`].
    pub(super) fn load(
        &mut self,
        settings: &RobotSettings,
        description: Option<&str>,
    ) -> Result<(MonitorConfig, LiveOptions), NotYet> {
        let open = open_options(settings)?;
        let robot = match self
            .robots
            .get(&settings.dir)
            .filter(|_| description.is_none())
        {
            Some(robot) => Arc::clone(robot),
            None => match robot_dir::load(&settings.dir, description) {
                Ok(loaded) => {
                    let robot = Arc::new(loaded.robot);
                    if description.is_none() {
                        self.robots.insert(settings.dir.clone(), Arc::clone(&robot));
                    }
                    robot
                }
                Err(RobotDirError::NoUrdf { .. }) => {
                    let joints = joints_of_file(settings)?;
                    return Err(NotYet::WaitsForUrdf(Box::new(live_options(
                        settings, joints, open,
                    ))));
                }
                Err(error) => return Err(fault(error)),
            },
        };
        let mut config = MonitorConfig::new(
            &settings.name,
            &settings.door.source(),
            Arc::clone(&robot),
            Arc::clone(&self.catalogue),
        );
        if let Some(path) = &settings.baseline {
            config.baseline = Some(Baseline::read(path).map_err(fault)?);
        }
        let reads_current = open
            .mapping
            .as_ref()
            .is_some_and(Mapping::reads_motor_current);
        config.estimate = estimate(settings.estimate, reads_current);
        config.clock = match settings.stamps_are_real {
            true => ClockChoice::Real,
            false => ClockChoice::Stamp,
        };
        config.times = times(settings);
        config.alarms = alarms(settings);
        let live = live_options(settings, robot.joint_names().to_vec(), open);
        Ok((config, live))
    }
}

fn fault(error: impl std::fmt::Display) -> NotYet {
    NotYet::Fault(error.to_string())
}

/// Joints that robot.toml names.
fn joints_of_file(settings: &RobotSettings) -> Result<Vec<String>, NotYet> {
    let file = match settings.dir.is_dir() {
        true => settings.dir.join("robot.toml"),
        false => settings.dir.clone(),
    };
    let text = sinew_files::read_text(&file, &sinew_files::limits::DESCRIPTION).map_err(fault)?;
    let parsed = RobotFile::parse(&text, &file.display().to_string()).map_err(fault)?;
    Ok(parsed.moving_joints())
}

fn open_options(settings: &RobotSettings) -> Result<OpenOptions, NotYet> {
    let reading = &settings.reading;
    let mapping = reading.mapping.as_deref().map(Mapping::read);
    let usual = OpenOptions::default();
    Ok(OpenOptions {
        mapping: mapping.transpose().map_err(fault)?,
        joint_state_topic: reading.joint_topic.clone(),
        motor_topic: reading.motor_topic.clone(),
        motor_interface: reading
            .motor_interface
            .clone()
            .unwrap_or(usual.motor_interface.clone()),
        joint_effort: reading.joint_effort,
        ..usual
    })
}

fn live_options(settings: &RobotSettings, joints: Vec<String>, open: OpenOptions) -> LiveOptions {
    LiveOptions {
        joints,
        namespace: settings.door.namespace().to_owned(),
        open,
    }
}

fn estimate(settings: EstimateSettings, reads_current: bool) -> SessionOptions {
    SessionOptions {
        payload: match settings.empty_gripper {
            true => Payload::Empty,
            false => Payload::Unknown,
        },
        motor_torque: settings.motor_torque,
        motor_current: reads_current,
        temperature_c: settings.temperature_c,
        external_force_n: None,
    }
}

fn times(settings: &RobotSettings) -> Times {
    let usual = Times::default();
    let own = settings.times;
    Times {
        stale_after_s: own.stale_after_s.unwrap_or(usual.stale_after_s),
        session_motion_s: own.session_motion_s.unwrap_or(usual.session_motion_s),
        session_pause_s: own.session_pause_s.unwrap_or(usual.session_pause_s),
        ..usual
    }
}

fn alarms(settings: &RobotSettings) -> AlarmOptions {
    let (usual, own) = (AlarmOptions::default(), &settings.alarms);
    let delays = own.delays.keys().map(|condition| {
        let delays = own.delays(*condition, usual.delays(*condition));
        (*condition, delays)
    });
    AlarmOptions {
        delays: delays.collect(),
        clear_below: own.clear_below.unwrap_or(usual.clear_below),
        near_s: own.near_s.unwrap_or(usual.near_s),
        doubt_s: own.doubt_s.unwrap_or(usual.doubt_s),
    }
}
