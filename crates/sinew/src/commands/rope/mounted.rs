//! Options that say how a rope is mounted: what gives beside it, and what pulls the other way.

use super::values::guide;
use crate::args::{not_negative, positive};
use crate::terminal::Failure;
use clap::Args;
use sinew_estimate::robot_dir;
use sinew_rope::predict::Guide;
use sinew_rope::task::{Drive, PretensionTask};
use std::path::PathBuf;

const M_PER_MM: f64 = 1e-3;

/// How a rope is mounted.
#[derive(Debug, Args)]
#[command(next_help_heading = "Mounting")]
pub(super) struct Mounted {
    /// Length of the strand, mm [default: the tendon's, else 1000]
    #[arg(long, value_name = "MM", value_parser = positive("mm"))]
    length: Option<f64>,
    /// What gives in series with each strand: frame, spring, mounts, N/mm [default: what the joint's
    /// stiffness leaves beside the rope, else nothing gives]
    #[arg(long, value_name = "N/MM", value_parser = positive("N/mm"))]
    series_stiffness: Option<f64>,
    /// Guiding pulley `WRAP_DEG:RADIUS_MM[:FRICTION][@AT_MM]`; as often as there are [default: the
    /// tendon's]
    #[arg(long, value_name = "GUIDE", value_parser = guide)]
    guide: Vec<Guide>,
    /// A second, equal rope pulls the joint the other way, over a pulley of this radius, mm
    /// [default: the tendon's, where it is antagonistic]
    #[arg(long, value_name = "MM", value_parser = positive("mm"))]
    joint_radius: Option<f64>,
    /// Torque that the joint holds meanwhile, N·m, of a joint that slides N; needs a second rope
    #[arg(long, value_name = "N·M", default_value = "0", value_parser = not_negative("N·m"))]
    torque: f64,
    /// Robot's folder; needs --joint
    #[arg(long, value_name = "DIR", requires = "joint")]
    robot: Option<PathBuf>,
    /// Joint whose tendon it is
    #[arg(long, value_name = "NAME", requires = "robot")]
    joint: Option<String>,
}

impl Mounted {
    /// The drive of the joint that was named.
    pub(super) fn drive(&self) -> Result<Option<Drive>, Failure> {
        let (Some(place), Some(joint)) = (&self.robot, &self.joint) else {
            return Ok(None);
        };
        Ok(Some(robot_dir::load(place, None)?.drive(joint)?))
    }

    /// Puts what is stated of the mounting into a task.
    pub(super) fn state(&self, task: &mut PretensionTask) {
        task.length_m = self.length.map(|mm| M_PER_MM * mm);
        task.guides.clone_from(&self.guide);
        let give = self.series_stiffness;
        task.give_m_per_n = give.map(|n_per_mm| M_PER_MM / n_per_mm);
        task.joint_radius_m = self.joint_radius.map(|mm| M_PER_MM * mm);
        task.torque_nm = self.torque;
    }
}
