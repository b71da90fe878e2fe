//! Task of a rope as specified; unspecified values come from the tendon or are defaults.

use super::duty::Duty;
use super::endurance::RopeTermination;
use super::predict::{Guide, PredictError, Request, Route, TIMES_DEFAULT_S, YEAR_S};
use super::pretension::{self, HeldJoint, Mount, series_compliance_m_per_n};
use super::{CatalogueRope, Draws, draws};
use crate::law::{LoadError, RopeLoad};
use sinew_model::transmission::Tendon;

/// Default temperature, °C.
pub const TEMPERATURE_DEFAULT_C: f64 = 23.0;
/// Default length of a strand without a tendon, m.
const LENGTH_DEFAULT_M: f64 = 1.0;
/// Default number of draws of a plan: each goes through two dozen procedures.
const PLAN_DRAWS_DEFAULT: usize = 200;
/// Default tension of a re-tensioning, as a share of the working tension.
const LOWEST_SHARE: f64 = 0.8;

/// Error of an incomplete or impossible task.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TaskError {
    /// Neither duty nor tension nor a pretension of the tendon specified.
    #[error("no load specified; specify a tension, a duty or a recording")]
    NoDuty,
    /// Neither a working tension nor a pretension of the tendon specified.
    #[error("the joint's tendon has no pretension_n; specify a tension")]
    NoTension,
    /// Lowest tension not below the working tension.
    #[error("the lowest tension, {lowest_n} N, must be below the working tension, {tension_n} N")]
    Lowest {
        /// Lowest tension, N.
        lowest_n: f64,
        /// Working tension, N.
        tension_n: f64,
    },
    /// Torque without a second rope.
    #[error("a torque needs a second rope that pulls the other way; specify the joint's radius")]
    TorqueAlone,
    /// Prediction that is not possible.
    #[error(transparent)]
    Predict(#[from] PredictError),
    /// Invalid load at the working tension.
    #[error(transparent)]
    Load(#[from] LoadError),
}

/// Task of a rope: its load and its routing.
#[derive(Debug, Clone, PartialEq)]
pub struct RopeTask {
    /// Tension and temperature over time; `None`: constant tension.
    pub duty: Option<Duty>,
    /// Constant tension, N; `None`: the pretension of the tendon.
    pub tension_n: Option<f64>,
    /// Temperature of a constant tension, °C.
    pub temperature_c: f64,
    /// Length of the strand, m; `None`: that of the tendon, otherwise 1 m.
    pub length_m: Option<f64>,
    /// Guiding pulleys; if empty, those of the tendon.
    pub guides: Vec<Guide>,
    /// Stroke of the rope over its guides, m.
    pub stroke_m: f64,
    /// Strokes per hour; 0 if bending is not considered.
    pub strokes_per_hour: f64,
    /// Termination of the rope.
    pub termination: RopeTermination,
    /// Factor by which abrasion accelerates bending fatigue.
    pub abrasion_factor: f64,
    /// Times of the predicted elongations, s, in any order; if empty, an hour, a day, a month and a year.
    pub times_s: Vec<f64>,
    /// Number of draws for the intervals.
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
            termination: RopeTermination::NotSpecified,
            abrasion_factor: 1.0,
            times_s: Vec::new(),
            draws: draws::DRAWS_DEFAULT,
            seed: 1,
        }
    }
}

impl RopeTask {
    /// Builds the request of a prediction, with the defaults of a tendon if there is one.
    ///
    /// # Errors
    /// Returns [`TaskError::NoDuty`] if no load is specified.
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
                termination: self.termination,
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

/// Drive of a joint: its stiffness and its tendon.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    /// Stiffness of the joint, N·m/rad (N/m if prismatic).
    pub stiffness_nm_per_rad: f64,
    /// Tendon of the joint.
    pub tendon: Tendon,
    /// Whether the joint is prismatic.
    pub slides: bool,
}

/// Task of a tensioning plan.
#[derive(Debug, Clone, PartialEq)]
pub struct PretensionTask {
    /// Working tension, N; of two strands their mean. `None`: the pretension of the tendon.
    pub tension_n: Option<f64>,
    /// Tension below which the rope is re-tensioned, N; `None`: 80 % of the working tension.
    pub lowest_n: Option<f64>,
    /// Temperature of the rope, °C.
    pub temperature_c: f64,
    /// Length of the strand, m; `None`: that of the tendon, otherwise 1 m.
    pub length_m: Option<f64>,
    /// Guiding pulleys; if empty, those of the tendon.
    pub guides: Vec<Guide>,
    /// Series compliance of each strand, m/N; `None`: from the stiffness of the joint, otherwise 0.
    pub series_compliance_m_per_n: Option<f64>,
    /// Radius of the pulley with a second, equal rope in the opposite direction, m; `None`: that of an
    /// antagonistic tendon.
    pub joint_radius_m: Option<f64>,
    /// Torque of the joint meanwhile, N·m, at least 0.
    pub torque_nm: f64,
    /// Horizon of the plan, s.
    pub horizon_s: f64,
    /// Share of the later elongation that the procedure must remove, 0 to 1.
    pub remove: f64,
    /// Number of draws for the intervals.
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
            series_compliance_m_per_n: None,
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
    /// Builds the request of a plan for `rope`; `drive`: stiffness and tendon of the joint, if there is one.
    ///
    /// # Errors
    /// Returns [`TaskError`] if the tension is missing or inconsistent, or the rope cannot carry it.
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
        let series_compliance_m_per_n = match (self.series_compliance_m_per_n, drive) {
            (Some(stated), _) => stated,
            (None, Some(d)) => {
                let (stiffness, t) = (d.stiffness_nm_per_rad, &d.tendon);
                let law = Draws::new(rope, 0, 0).map_err(PredictError::from)?.nominal;
                let strands = if joint.is_some() { 2.0 } else { 1.0 };
                let radius_m = t.joint_pulley_radius_m;
                series_compliance_m_per_n(&law, load, length_m, radius_m, stiffness, strands)?
            }
            (None, None) => 0.0,
        };
        Ok(pretension::Request {
            tension_n,
            temperature_c: self.temperature_c,
            length_m,
            mount: Mount {
                series_compliance_m_per_n,
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

/// Specified length, otherwise that of the tendon.
fn length_m(stated: Option<f64>, tendon: Option<&Tendon>) -> f64 {
    let own = tendon.map(|t| t.length_m);
    stated.or(own).unwrap_or(LENGTH_DEFAULT_M)
}

/// Specified guides, otherwise those of the tendon.
fn guides(stated: &[Guide], tendon: Option<&Tendon>) -> Vec<Guide> {
    let own = tendon.map_or(&[][..], |t| &t.guides);
    match stated {
        [] => own.iter().map(Guide::from).collect(),
        stated => stated.to_vec(),
    }
}
