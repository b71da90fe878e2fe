//! Creation of a robot's monitor from its settings.

use crate::config::RobotSettings;
use sinew_estimate::baseline::Baseline;
use sinew_estimate::robot_dir::{self, RobotDirError};
use sinew_log::live::LiveOptions;
use sinew_log::{Mapping, OpenOptions};
use sinew_model::robot::{Robot, RobotFile};
use sinew_rope::Catalogue;
use sinew_watch_core::{ClockChoice, MonitorConfig};
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

/// Cache of the files of robots, so that a thousand robots of one type are read once.
#[derive(Debug)]
pub(super) struct Files {
    catalogue: Arc<Catalogue>,
    robots: HashMap<PathBuf, Arc<Robot>>,
}

/// Reason why a robot is not monitored.
#[derive(Debug, Clone)]
pub(super) enum NotYet {
    /// The files of the robot are invalid.
    Fault(String),
    /// The description is received later; the options to wait for it.
    WaitsForUrdf(Box<LiveOptions>),
}

impl Files {
    /// Creates an empty cache.
    ///
    /// # Errors
    /// Returns the reason if the built-in rope catalogue is invalid.
    pub(super) fn new() -> Result<Self, String> {
        Ok(Self {
            catalogue: Arc::new(Catalogue::shipped().map_err(|e| e.to_string())?),
            robots: HashMap::new(),
        })
    }

    /// Clears the cache, so that files are read again.
    pub(super) fn forget(&mut self) {
        self.robots.clear();
    }

    /// Loads configuration and message options of a robot; `description` is the URDF received with its messages.
    ///
    /// # Errors
    /// Returns [`NotYet`] if a file is invalid or the URDF is missing.
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
                        settings, &joints, open,
                    ))));
                }
                Err(error) => return Err(fault(error)),
            },
        };
        let mut config = MonitorConfig::new(
            &settings.name,
            &settings.transport.source(),
            Arc::clone(&robot),
            Arc::clone(&self.catalogue),
        );
        if let Some(path) = &settings.baseline {
            config.baseline = Some(Baseline::read(path).map_err(fault)?);
        }
        let mapping = open.mapping.as_ref();
        config.estimate = settings.estimate;
        config.estimate.motor_current = mapping.is_some_and(Mapping::reads_motor_current);
        config.clock = match settings.stamps_are_real {
            true => ClockChoice::Real,
            false => ClockChoice::Stamp,
        };
        config.times = settings.times;
        config.alarms = settings.alarms.clone();
        let live = LiveOptions {
            axes: sinew_estimate::axes(&robot)
                .into_iter()
                .map(Into::into)
                .collect(),
            ..live_options(settings, robot.joint_names(), open)
        };
        Ok((config, live))
    }
}

fn fault(error: impl std::fmt::Display) -> NotYet {
    NotYet::Fault(error.to_string())
}

/// Returns the joints named in robot.toml.
fn joints_of_file(settings: &RobotSettings) -> Result<Vec<String>, NotYet> {
    let file = match settings.dir.is_dir() {
        true => settings.dir.join("robot.toml"),
        false => settings.dir.clone(),
    };
    let text = sinew_files::read_text(&file, &sinew_files::Budget::DESCRIPTION).map_err(fault)?;
    let parsed = RobotFile::parse(&text, &file.display().to_string()).map_err(fault)?;
    Ok(parsed.moving_joints())
}

fn open_options(settings: &RobotSettings) -> Result<OpenOptions, NotYet> {
    let mapping = settings.mapping.as_deref().map(Mapping::read);
    Ok(OpenOptions {
        mapping: mapping.transpose().map_err(fault)?,
        ..settings.reading.clone()
    })
}

fn live_options(settings: &RobotSettings, joints: &[String], open: OpenOptions) -> LiveOptions {
    LiveOptions {
        namespace: settings.transport.namespace.clone(),
        open,
        ..LiveOptions::of_joints(joints)
    }
}
