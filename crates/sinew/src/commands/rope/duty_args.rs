//! Options of the duty and the route of a rope.

use super::values::guide;
use crate::args::{Choice, choice, not_negative, positive};
use crate::quantity::{
    Force, Length, Temperature, Time, above_zero, at_least_zero, duration, rope_temperature,
};
use crate::terminal::{Bar, Failure, Word, complain};
use clap::Args;
use sinew_estimate::strand_duty::{self, Strand};
use sinew_estimate::{Progress, robot_dir};
use sinew_model::transmission::Tendon;
use sinew_rope::RopeTermination;
use sinew_rope::duty::Duty;
use sinew_rope::predict::{Guide, Request};
use sinew_rope::task::{RopeTask, TaskError};
use std::path::PathBuf;

/// Strands of a joint in a recording.
const STRANDS: [Choice<Strand>; 2] = [
    (
        "positive",
        "Strand that is loaded by positive torque",
        Strand::Positive,
    ),
    (
        "negative",
        "Strand that is loaded by negative torque",
        Strand::Negative,
    ),
];

/// Terminations of a rope.
const TERMINATIONS: [Choice<RopeTermination>; 2] = [
    ("splice", "Spliced", RopeTermination::Spliced),
    ("knot", "Knotted", RopeTermination::Knotted),
];

/// Duty and route of a rope.
#[derive(Debug, Args)]
pub(crate) struct DutyArgs {
    /// Constant tension, N
    #[arg(long, value_name = "FORCE", value_parser = at_least_zero::<Force>, help_heading = "Duty")]
    tension: Option<Force>,
    /// Temperature, °C (also for a recording)
    #[arg(long, value_name = "TEMPERATURE", default_value = "23°C", value_parser = rope_temperature, allow_hyphen_values = true, help_heading = "Duty")]
    temperature: Temperature,
    /// Block table, TOML or CSV, repeated as a cycle: duration_s|min|h|d, tension_n, tension_to_n,
    /// temperature_c, temperature_to_c
    #[arg(long, value_name = "FILE", conflicts_with_all = ["tension", "recording"], help_heading = "Duty")]
    duty: Option<PathBuf>,
    /// Recording whose torques define the tension, repeated as a cycle; requires --joint
    #[arg(
        long,
        value_name = "LOG",
        requires = "joint",
        conflicts_with = "tension",
        help_heading = "Duty"
    )]
    recording: Option<PathBuf>,
    /// Selected strand of the joint
    #[arg(long, value_parser = choice(&STRANDS), default_value = "positive", help_heading = "Duty")]
    strand: Strand,
    /// Robot folder with length, guides and pretension of the tendon
    #[arg(long, value_name = "DIR", requires = "joint", help_heading = "Route")]
    robot: Option<PathBuf>,
    /// Joint of the tendon
    #[arg(long, value_name = "NAME", help_heading = "Route")]
    joint: Option<String>,
    /// Length of the strand, mm [default: of the tendon, else 1000]
    #[arg(long, value_name = "LENGTH", value_parser = above_zero::<Length>, help_heading = "Route")]
    length: Option<Length>,
    /// Guiding pulley `WRAP_DEG:RADIUS_MM[:FRICTION][@AT_MM]`, repeatable; evenly spaced without
    /// AT_MM
    #[arg(long, value_name = "GUIDE", value_parser = guide, help_heading = "Route")]
    guide: Vec<Guide>,
    /// Stroke of the rope over its guides, mm
    #[arg(long, value_name = "LENGTH", default_value = "0mm", value_parser = at_least_zero::<Length>, help_heading = "Route")]
    stroke: Length,
    /// Strokes per hour, for bending fatigue
    #[arg(long, value_name = "1/H", default_value = "0", value_parser = not_negative("1/h"), help_heading = "Route")]
    strokes_per_hour: f64,
    /// Termination [default: as strong as the rope]
    #[arg(long, value_parser = choice(&TERMINATIONS), help_heading = "Route")]
    termination: Option<RopeTermination>,
    /// Factor by which abrasion accelerates bending fatigue
    #[arg(long, value_name = "FACTOR", default_value = "1", value_parser = positive("(a factor)"), help_heading = "Route")]
    abrasion: f64,
    /// Times of the results, s, e.g. 8h,30d,1year [default: 1h,1d,1month,1year]
    #[arg(long, value_name = "TIMES", value_delimiter = ',', value_parser = duration)]
    at: Vec<Time>,
    /// Number of parameter draws for the intervals [default: 400; for a creep plan 24]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(20..=100_000))]
    draws: Option<u32>,
    /// Seed of the draws
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
}

/// Request that results from the options, and the rope of the tendon.
pub(crate) struct Resolved {
    pub(crate) request: Request,
    pub(crate) rope: Option<String>,
}

impl DutyArgs {
    /// Specified number of draws.
    pub(crate) fn draws(&self) -> Option<usize> {
        self.draws.map(|draws| draws as usize)
    }

    pub(crate) fn resolve(&self) -> Result<Resolved, Failure> {
        let tendon = self.tendon()?;
        let task = RopeTask {
            duty: self.resolve_duty(tendon.as_ref())?,
            tension_n: self.tension.map(|force| force.0),
            temperature_c: self.temperature(),
            length_m: self.length.map(|length| length.0),
            guides: self.guide.clone(),
            stroke_m: self.stroke.0,
            strokes_per_hour: self.strokes_per_hour,
            termination: self.termination.unwrap_or_default(),
            abrasion_factor: self.abrasion,
            times_s: self.at.iter().map(|time| time.0).collect(),
            draws: self.draws().unwrap_or(sinew_rope::draws::DRAWS_DEFAULT),
            seed: self.seed,
        };
        let request = task.request(tendon.as_ref()).map_err(|error| match error {
            TaskError::NoDuty => Failure::Error(
                "no load specified; set --tension N, --duty FILE or --recording LOG".into(),
            ),
            other => other.into(),
        })?;
        Ok(Resolved {
            request,
            rope: tendon.and_then(|t| t.rope),
        })
    }

    fn tendon(&self) -> Result<Option<Tendon>, Failure> {
        let Some(joint) = &self.joint else {
            return Ok(None);
        };
        let place = match (&self.robot, &self.recording) {
            (Some(place), _) => place.clone(),
            (None, Some(log)) => robot_dir::find(log)?,
            (None, None) => {
                return Err(Failure::Error("--joint requires --robot DIR".into()));
            }
        };
        let loaded = robot_dir::load(&place, None)?;
        Ok(Some(loaded.tendon(joint)?.clone()))
    }

    /// Returns the duty of a table or a recording.
    fn resolve_duty(&self, tendon: Option<&Tendon>) -> Result<Option<Duty>, Failure> {
        match (&self.duty, &self.recording, tendon) {
            (Some(file), ..) => Ok(Some(Duty::open(file)?)),
            (None, Some(log), Some(tendon)) => self.recorded(log.clone(), tendon).map(Some),
            (None, Some(_), None) => {
                Err(Failure::Error("--recording requires --joint NAME".into()))
            }
            (None, None, _) => Ok(None),
        }
    }

    fn recorded(&self, log: PathBuf, tendon: &Tendon) -> Result<Duty, Failure> {
        let mut request = sinew_estimate::Request::new(log);
        request.robot.clone_from(&self.robot);
        if tendon.pretension_n.is_none() {
            let text = "pretension_n missing for the tendon: 0 N assumed; set it in robot.toml";
            complain(Word::Warning, text);
        }
        let joint = self.joint.as_deref().unwrap_or_default();
        let bar = Bar::new("torques");
        let mut progress = |p: Progress| bar.set(p.bytes_done as f64, p.bytes_total as f64);
        let (celsius, strand) = (self.temperature(), self.strand);
        let duty = strand_duty::recorded(&request, joint, tendon, celsius, strand, &mut progress)?;
        Ok(duty)
    }

    /// Temperature, °C.
    pub(super) fn temperature(&self) -> f64 {
        self.temperature.0
    }
}
