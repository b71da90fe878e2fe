//! What a rope has to do, as far as somebody states it: what they don't is the tendon's own, or plain.

use super::duty::Duty;
use super::endurance::Ends;
use super::predict::{Guide, PredictError, Request, Route, TIMES_DEFAULT_S, YEAR_S};
use super::pretension::{self, HeldJoint, Mount, give_beside_rope};
use super::{CatalogueRope, Draws, draws};
use crate::law::{LoadError, RopeLoad};
use sinew_model::transmission::Tendon;

/// Temperature where none is stated, °C.
pub const TEMPERATURE_DEFAULT_C: f64 = 23.0;
/// Length of a strand where neither it nor a tendon is stated, m.
const LENGTH_DEFAULT_M: f64 = 1.0;
/// Draws of a plan where it isn't stated how many: each goes through two dozen procedures.
const PLAN_DRAWS_DEFAULT: usize = 200;
/// Tension at which a rope is tensioned again where none is stated, share of the working tension.
const LOWEST_SHARE: f64 = 0.8;

/// Why there is nothing to predict.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TaskError {
    /// Neither a duty nor a tension is stated, and the tendon states no pretension.
    #[error("what has the rope to do? state a tension, a duty or a recording")]
    NoDuty,
    /// Neither a working tension nor a pretension of the tendon is stated.
    #[error("the joint's tendon states no pretension_n; state a tension")]
    NoTension,
    /// It would be tensioned again before it is tensioned.
    #[error("the lowest tension, {lowest_n} N, must be below the working tension, {tension_n} N")]
    Lowest {
        /// Lowest tension, N.
        lowest_n: f64,
        /// Working tension, N.
        tension_n: f64,
    },
    /// One rope holds no torque.
    #[error("a torque needs a second rope that pulls the other way; state the joint's radius")]
    TorqueAlone,
    /// The rope can't bear it.
    #[error(transparent)]
    Predict(#[from] PredictError),
    /// The rope at its working tension.
    #[error(transparent)]
    Load(#[from] LoadError),
}

/// What a rope has to do, and where it lies.
#[derive(Debug, Clone, PartialEq)]
pub struct RopeTask {
    /// The duty; `None`: constant tension.
    pub duty: Option<Duty>,
    /// Constant tension, N; `None`: the tendon's pretension.
    pub tension_n: Option<f64>,
    /// Temperature of a constant tension, °C.
    pub temperature_c: f64,
    /// Length of the strand, m; `None`: the tendon's, else 1 m.
    pub length_m: Option<f64>,
    /// Guiding pulleys; none: the tendon's.
    pub guides: Vec<Guide>,
    /// How far the rope moves back and forth over its guides, m.
    pub stroke_m: f64,
    /// Strokes per hour; 0 where bending is not asked for.
    pub strokes_per_hour: f64,
    /// How its ends are held.
    pub ends: Ends,
    /// Factor by which abrasion speeds up the wear of bending.
    pub abrasion_factor: f64,
    /// Times to read at, s, in any order; none: an hour, a day, a month, a year.
    pub times_s: Vec<f64>,
    /// Draws for the intervals.
    pub draws: usize,
    /// Seed of the draws.
    pub seed: u64,
}

impl Default for RopeTask {
    fn default() -> Self {
        Self {
            duty: None,
            tension_n: None,
            temperature_c: TEMPERATURE_DEFAULT_C,
            length_m: None,
            guides: Vec::new(),
            stroke_m: 0.0,
            strokes_per_hour: 0.0,
            ends: Ends::NotStated,
            abrasion_factor: 1.0,
            times_s: Vec::new(),
            draws: draws::DRAWS_DEFAULT,
            seed: 1,
        }
    }
}

impl RopeTask {
    /// What is asked of a prediction, on a tendon where there is one.
    ///
    /// # Errors
    /// [`TaskError::NoDuty`].
    pub fn request(&self, tendon: Option<&Tendon>) -> Result<Request, TaskError> {
        let constant = self.tension_n.or(tendon.and_then(|t| t.pretension_n));
        let constant = constant.map(|tension_n| Duty::constant(tension_n, self.temperature_c));
        let mut times_s = match &self.times_s[..] {
            [] => TIMES_DEFAULT_S.to_vec(),
            stated => stated.to_vec(),
        };
        times_s.sort_unstable_by(f64::total_cmp);
        Ok(Request {
            duty: (self.duty.clone()).or(constant).ok_or(TaskError::NoDuty)?,
            route: Route {
                stroke_m: self.stroke_m,
                strokes_per_hour: self.strokes_per_hour,
                ends: self.ends,
                abrasion_factor: self.abrasion_factor,
                ..Route::straight(length_m(self.length_m, tendon))
                    .guided(&guides(&self.guides, tendon))
            },
            times_s,
            read_at: None,
            draws: self.draws,
            seed: self.seed,
        })
    }
}

/// What holds a joint: its drive's stiffness and its tendon.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    /// Stiffness of the joint, N·m/rad (N/m of one that slides).
    pub stiffness_nm_per_rad: f64,
    /// Its tendon.
    pub tendon: Tendon,
    /// Whether it slides.
    pub slides: bool,
}

/// What is asked of a plan to tension a rope.
#[derive(Debug, Clone, PartialEq)]
pub struct PretensionTask {
    /// Working tension, N; of two strands their mean. `None`: the tendon's pretension.
    pub tension_n: Option<f64>,
    /// Tension below which it is tensioned again, N; `None`: 80 % of the working tension.
    pub lowest_n: Option<f64>,
    /// Temperature, °C.
    pub temperature_c: f64,
    /// Length of the strand, m; `None`: the tendon's, else 1 m.
    pub length_m: Option<f64>,
    /// Guiding pulleys; none: the tendon's.
    pub guides: Vec<Guide>,
    /// What gives in series with each strand, m/N; `None`: what the joint's stiffness leaves beside the rope,
    /// else nothing.
    pub give_m_per_n: Option<f64>,
    /// Radius of the pulley over which a second, equal rope pulls the other way, m; `None`: the tendon's, where it
    /// is antagonistic.
    pub joint_radius_m: Option<f64>,
    /// Torque that the joint holds meanwhile, N·m, at least 0.
    pub torque_nm: f64,
    /// How long it must hold, s.
    pub horizon_s: f64,
    /// Share of the later elongation that the procedure must take away, 0 to 1.
    pub remove: f64,
    /// Draws for the intervals.
    pub draws: usize,
    /// Seed of the draws.
    pub seed: u64,
}

impl Default for PretensionTask {
    fn default() -> Self {
        Self {
            tension_n: None,
            lowest_n: None,
            temperature_c: TEMPERATURE_DEFAULT_C,
            length_m: None,
            guides: Vec::new(),
            give_m_per_n: None,
            joint_radius_m: None,
            torque_nm: 0.0,
            horizon_s: YEAR_S,
            remove: 0.8,
            draws: PLAN_DRAWS_DEFAULT,
            seed: 1,
        }
    }
}

impl PretensionTask {
    /// What is asked of a plan for `rope`; `drive`: what holds the joint, where there is one.
    ///
    /// # Errors
    /// [`TaskError`].
    pub fn request(
        &self,
        rope: &CatalogueRope,
        drive: Option<&Drive>,
    ) -> Result<pretension::Request, TaskError> {
        let tendon = drive.map(|d| &d.tendon);
        let stated = self.tension_n.or(tendon.and_then(|t| t.pretension_n));
        let tension_n = stated.ok_or(TaskError::NoTension)?;
        let lowest_n = self.lowest_n.unwrap_or(LOWEST_SHARE * tension_n);
        if lowest_n >= tension_n {
            return Err(TaskError::Lowest {
                lowest_n,
                tension_n,
            });
        }
        let length_m = length_m(self.length_m, tendon);
        let both = tendon.filter(|t| t.antagonistic);
        let radius_m = self.joint_radius_m;
        let radius_m = radius_m.or(both.map(|t| t.joint_pulley_radius_m));
        let joint = radius_m.map(|radius_m| HeldJoint {
            radius_m,
            torque_nm: self.torque_nm,
            slides: drive.is_some_and(|d| d.slides),
        });
        if self.torque_nm > 0.0 && joint.is_none() {
            return Err(TaskError::TorqueAlone);
        }
        let load = RopeLoad::celsius(tension_n, self.temperature_c);
        let give_m_per_n = match (self.give_m_per_n, drive) {
            (Some(stated), _) => stated,
            (None, Some(d)) => {
                let (stiffness, t) = (d.stiffness_nm_per_rad, &d.tendon);
                let law = Draws::new(rope, 0, 0).map_err(PredictError::from)?.nominal;
                let strands = if joint.is_some() { 2.0 } else { 1.0 };
                let radius_m = t.joint_pulley_radius_m;
                give_beside_rope(&law, load, length_m, radius_m, stiffness, strands)?
            }
            (None, None) => 0.0,
        };
        Ok(pretension::Request {
            tension_n,
            temperature_c: self.temperature_c,
            length_m,
            mount: Mount {
                give_m_per_n,
                pulleys: Route::straight(length_m)
                    .guided(&guides(&self.guides, tendon))
                    .pulleys,
                joint,
            },
            horizon_s: self.horizon_s,
            lowest_n,
            remove: self.remove,
            draws: self.draws,
            seed: self.seed,
        })
    }
}

/// Length as stated, else the tendon's.
fn length_m(stated: Option<f64>, tendon: Option<&Tendon>) -> f64 {
    let own = tendon.map(|t| t.length_m);
    stated.or(own).unwrap_or(LENGTH_DEFAULT_M)
}

/// Guides as stated, else the tendon's.
fn guides(stated: &[Guide], tendon: Option<&Tendon>) -> Vec<Guide> {
    let own = tendon.map_or(&[][..], |t| &t.guides);
    match stated {
        [] => own.iter().map(Guide::from).collect(),
        stated => stated.to_vec(),
    }
}
