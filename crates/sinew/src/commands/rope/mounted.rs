//! Options of the mounting of a rope: compliance, guides, antagonistic rope.

use super::values::guide;
use crate::args::positive;
use crate::quantity::{Length, Torque, above_zero, at_least_zero};
use crate::terminal::Failure;
use clap::Args;
use sinew_estimate::robot_dir;
use sinew_rope::predict::Guide;
use sinew_rope::task::{Drive, PretensionTask};
use std::path::PathBuf;

const M_PER_MM: f64 = 1e-3;

/// Mounting of a rope.
#[derive(Debug, Args)]
#[command(next_help_heading = "Mounting")]
pub(super) struct Mounted {
    /// Length of the strand, mm [default: of the tendon, else 1000]
    #[arg(long, value_name = "LENGTH", value_parser = above_zero::<Length>)]
    length: Option<Length>,
    /// Stiffness in series with each strand (frame, spring, mounts), N/mm [default: from the joint
    /// stiffness, else rigid]
    #[arg(long, value_name = "N/MM", value_parser = positive("N/mm"))]
    series_stiffness: Option<f64>,
    /// Guiding pulley `WRAP_DEG:RADIUS_MM[:FRICTION][@AT_MM]`, repeatable [default: of the tendon]
    #[arg(long, value_name = "GUIDE", value_parser = guide)]
    guide: Vec<Guide>,
    /// Pulley radius of a second, equal, antagonistic rope, mm [default: of an antagonistic tendon]
    #[arg(long, value_name = "LENGTH", value_parser = above_zero::<Length>)]
    joint_radius: Option<Length>,
    /// Torque of the joint, N·m (prismatic joint: N); requires a second rope
    #[arg(long, value_name = "TORQUE", default_value = "0", value_parser = at_least_zero::<Torque>)]
    torque: Torque,
    /// Robot folder; requires --joint
    #[arg(long, value_name = "DIR", requires = "joint")]
    robot: Option<PathBuf>,
    /// Joint of the tendon
    #[arg(long, value_name = "NAME", requires = "robot")]
    joint: Option<String>,
}

impl Mounted {
    /// Returns the drive of the specified joint.
    pub(super) fn drive(&self) -> Result<Option<Drive>, Failure> {
        let (Some(place), Some(joint)) = (&self.robot, &self.joint) else {
            return Ok(None);
        };
        Ok(Some(robot_dir::load(place, None)?.drive(joint)?))
    }

    /// Copies the specified mounting into a task.
    pub(super) fn apply(&self, task: &mut PretensionTask) {
        task.length_m = self.length.map(|length| length.0);
        task.guides.clone_from(&self.guide);
        let stiffness = self.series_stiffness;
        task.series_compliance_m_per_n = stiffness.map(|n_per_mm| M_PER_MM / n_per_mm);
        task.joint_radius_m = self.joint_radius.map(|radius| radius.0);
        task.torque_nm = self.torque.0;
    }
}
