//! Options that say how a rope is mounted: what gives beside it, and what pulls the other way.

use super::values::guide;
use crate::args::{not_negative, positive};
use crate::terminal::Failure;
use clap::Args;
use sinew_estimate::robot_dir;
use sinew_model::arm::JointKind;
use sinew_model::rope::RopeLoad;
use sinew_model::transmission::Tendon;
use sinew_rope::predict::{Guide, PredictError, Route};
use sinew_rope::pretension::{HeldJoint, Mount, give_beside_rope};
use sinew_rope::{CatalogueRope, Draws};
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

/// What holds a joint.
pub(super) struct Drive {
    /// Stiffness of the joint, N·m/rad (N/m).
    pub(super) stiffness_nm_per_rad: f64,
    /// Its tendon.
    pub(super) tendon: Tendon,
    /// Whether it slides.
    pub(super) slides: bool,
}

impl Mounted {
    /// The drive of the joint that was named.
    pub(super) fn drive(&self) -> Result<Option<Drive>, Failure> {
        let (Some(place), Some(joint)) = (&self.robot, &self.joint) else {
            return Ok(None);
        };
        let loaded = robot_dir::load(place, None)?;
        let (transmission, tendon) = loaded.tendon_drive(joint)?;
        let arm = &loaded.robot.arm;
        let kind = arm.joint_index(joint).and_then(|i| arm.joint_kind(i));
        Ok(Some(Drive {
            stiffness_nm_per_rad: transmission.stiffness_nm_per_rad,
            tendon: tendon.clone(),
            slides: kind == Some(JointKind::Prismatic),
        }))
    }

    /// Length of the strand, m, and how the rope is mounted.
    pub(super) fn resolve(
        &self,
        rope: &CatalogueRope,
        load: RopeLoad,
        drive: Option<&Drive>,
    ) -> Result<(f64, Mount), Failure> {
        let own = drive.map(|d| &d.tendon);
        let length_m = self.length.map(|mm| M_PER_MM * mm);
        let length_m = length_m.or(own.map(|t| t.length_m)).unwrap_or(1.0);
        let guides = match (self.guide.as_slice(), own) {
            ([], Some(t)) => t.guides.iter().map(Guide::from).collect(),
            (stated, _) => stated.to_vec(),
        };
        let both = own.filter(|t| t.antagonistic);
        let radius_m = self.joint_radius.map(|mm| M_PER_MM * mm);
        let radius_m = radius_m.or(both.map(|t| t.joint_pulley_radius_m));
        let joint = radius_m.map(|radius_m| HeldJoint {
            radius_m,
            torque_nm: self.torque,
            slides: drive.is_some_and(|d| d.slides),
        });
        if self.torque > 0.0 && joint.is_none() {
            let why =
                "--torque needs a second rope that pulls the other way; say --joint-radius MM";
            return Err(Failure::Refused(why.into()));
        }
        let give_m_per_n = match (self.series_stiffness, drive) {
            (Some(n_per_mm), _) => M_PER_MM / n_per_mm,
            (None, Some(d)) => {
                let (stiffness, t) = (d.stiffness_nm_per_rad, &d.tendon);
                let law = Draws::new(rope, 0, 0).map_err(PredictError::from)?.nominal;
                let strands = if joint.is_some() { 2.0 } else { 1.0 };
                let radius_m = t.joint_pulley_radius_m;
                give_beside_rope(&law, load, length_m, radius_m, stiffness, strands)
                    .map_err(|e| Failure::Refused(e.to_string()))?
            }
            (None, None) => 0.0,
        };
        let mount = Mount {
            give_m_per_n,
            pulleys: Route::straight(length_m).guided(&guides).pulleys,
            joint,
        };
        Ok((length_m, mount))
    }
}
