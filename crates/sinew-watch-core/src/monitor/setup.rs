//! Setup of a monitor: configuration, robot with its limits, and tendons.

use super::config::{MonitorConfig, MonitorError};
use crate::alarm::LimitOrigin;
use crate::snapshot::LimitNow;
use sinew_model::Gaussian;
use sinew_model::robot::Robot;
use sinew_model::transmission::Tendon;
use sinew_rope::{Catalogue, CatalogueError};
use std::sync::Arc;

/// Setup of a monitor. Tendons are indexed in the order of the robot's elastic joints.
#[derive(Debug)]
pub(super) struct Setup {
    pub(super) config: MonitorConfig,
    /// Robot including the limits specified by the rope manufacturers.
    pub(super) robot: Arc<Robot>,
    /// Joint index of each tendon.
    pub(super) elastic: Vec<usize>,
    /// Joint name of each tendon.
    pub(super) names: Vec<String>,
    /// Limits of each tendon.
    pub(super) limits: Vec<Limits>,
}

impl Setup {
    /// Checks a configuration and reads the limits of its ropes.
    pub(super) fn new(config: MonitorConfig) -> Result<Self, MonitorError> {
        config.check()?;
        let mut robot = Robot::clone(&config.robot);
        let (mut elastic, mut names, mut limits) = (Vec::new(), Vec::new(), Vec::new());
        let tendons = config.robot.tendon_names();
        let tendons = tendons.iter().enumerate();
        for ((i, name), transmission) in tendons.zip(&mut robot.transmissions) {
            let Some(transmission) = transmission else {
                continue;
            };
            elastic.push(i);
            names.push(name.clone());
            limits.push(match &mut transmission.tendon {
                Some(tendon) => {
                    let limits = Limits::of(tendon, &config.catalogue)?;
                    tendon.replace_at_strain = limits.replace_ratio.map(|(ratio, _)| ratio);
                    limits
                }
                None => Limits::default(),
            });
        }
        if elastic.is_empty() {
            return Err(MonitorError::NoTendon);
        }
        Ok(Self {
            robot: Arc::new(robot),
            elastic,
            names,
            limits,
            config,
        })
    }

    /// Replaces the configuration of the same robot.
    pub(super) fn reload(&mut self, config: MonitorConfig) -> Result<(), MonitorError> {
        config.check()?;
        let springs = |robot: &Robot| -> Vec<Option<f64>> {
            let all = robot.transmissions.iter();
            all.map(|t| t.as_ref().map(|t| t.stiffness_nm_per_rad))
                .collect()
        };
        let same = config.name == self.config.name
            && config.robot.arm == self.config.robot.arm
            && springs(&config.robot) == springs(&self.config.robot)
            && config.times.gap_s == self.config.times.gap_s;
        if !same {
            return Err(MonitorError::AnotherRobot);
        }
        *self = Self::new(config)?;
        Ok(())
    }

    /// Returns the number of axes: joints, then additional tendons.
    pub(super) fn joints(&self) -> usize {
        self.robot.axes()
    }

    /// Returns the index of the tendon of a joint.
    pub(super) fn tendon_of(&self, joint: &str) -> Option<usize> {
        self.names.iter().position(|name| name == joint)
    }

    /// Returns the geometry of a tendon, if robot.toml specifies it.
    pub(super) fn geometry(&self, tendon: usize) -> Option<&Tendon> {
        let joint = *self.elastic.get(tendon)?;
        self.robot
            .transmissions
            .get(joint)?
            .as_ref()?
            .tendon
            .as_ref()
    }

    /// Returns the elongation since the last tensioning, m, and the total strain since the rope was new, ratio, for an
    /// offset, rad, and an earlier elongation `before_m`, m.
    pub(super) fn elongation(
        &self,
        tendon: usize,
        before_m: Gaussian,
        offset_rad: Option<Gaussian>,
    ) -> Option<(Gaussian, Gaussian)> {
        let geometry = self.geometry(tendon)?;
        let since_m = offset_rad?.scaled(geometry.joint_pulley_radius_m);
        let whole_m = before_m.plus(since_m);
        Some((since_m, whole_m.scaled(1.0 / geometry.length_m)))
    }
}

/// Limits of a tendon with their origin.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Limits {
    /// Limit of the elongation since the last tensioning, m.
    pub(super) retension_m: Option<(f64, LimitOrigin)>,
    /// Limit of the total strain since the rope was new, ratio.
    pub(super) replace_ratio: Option<(f64, LimitOrigin)>,
}

impl Limits {
    /// Returns the limits of robot.toml, otherwise those of the manufacturer in the catalogue.
    fn of(tendon: &Tendon, catalogue: &Catalogue) -> Result<Self, CatalogueError> {
        let toml = |limit: f64| (limit, LimitOrigin::RobotToml);
        let rope = tendon.rope.as_deref().map(|name| catalogue.find(name));
        let discard_strain = rope
            .transpose()?
            .and_then(|rope| rope.entry.discard_strain());
        let manufacturer = discard_strain.map(|ratio| (ratio, LimitOrigin::Catalogue));
        Ok(Self {
            retension_m: tendon.retension_at_m.map(toml),
            replace_ratio: tendon.replace_at_strain.map(toml).or(manufacturer),
        })
    }

    /// Returns the limits as snapshot in a snapshot.
    pub(super) fn snapshot(self) -> Vec<LimitNow> {
        let retension = (self.retension_m).map(|(elongation_m, origin)| LimitNow::Retension {
            elongation_m,
            origin,
        });
        let replace = (self.replace_ratio).map(|(strain_ratio, origin)| LimitNow::Replace {
            strain_ratio,
            origin,
        });
        retension.into_iter().chain(replace).collect()
    }
}
