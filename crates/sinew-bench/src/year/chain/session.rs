//! One robot's sessions: simulated, and estimated since the first day's baseline.

use super::ChainError;
use super::motion::{SessionKind, scenario};
use crate::year::simulated_year::SimulatedYear;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};
use serde::{Deserialize, Serialize};
use sinew_estimate::baseline::Baseline;
use sinew_estimate::session::{
    Learning, Payload, Recorded, Recorder, SessionEstimate, SessionOptions, Verdict,
    estimate_recorded, learn_recorded,
};
use sinew_model::Gaussian;
use sinew_model::offset::{FeatureConfig, SharedError};
use sinew_model::robot::Robot;
use sinew_sim::scenario::{Draw, Offset, OffsetKind, Shape};
use sinew_sim::{Scenario, Simulation};

const DAY_NS: i64 = 86_400_000_000_000;
/// Heaviest payload of work, kg.
const PAYLOAD_KG: f64 = 0.5;
/// Error of the thermometer, K.
const THERMOMETER_K: f64 = 0.5;

/// Estimate of a session for a joint, and the truth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SessionJoint {
    /// Name of the joint.
    pub name: String,
    /// True offset since the baseline, rad.
    pub truth_rad: f64,
    /// Estimated offset; `None` if inconclusive.
    pub offset_rad: Option<Gaussian>,
    /// Reported part of its error that is common to several sessions.
    pub systematic_error: Option<SharedError>,
    /// Ratio of true to nominal stiffness minus 1, at the baseline's temperature.
    pub true_stiffness_ratio: f64,
    /// Estimated ratio of stiffness minus 1.
    pub stiffness_ratio: Gaussian,
    /// Sudden changes reported within the session; there were none.
    pub steps: usize,
}

/// One simulated session.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Session {
    /// Seed of the robot.
    pub seed: u64,
    /// Days since the baseline.
    pub day: usize,
    /// True temperature, °C.
    pub true_temperature_c: f64,
    /// Measured temperature, °C.
    pub temperature_c: f64,
    /// Payload mass, kg.
    pub payload_kg: f64,
    /// Share of the session rejected as contact or disturbance.
    pub rejected_share: f64,
    /// One per elastic joint.
    pub joints: Vec<SessionJoint>,
}

/// Robot whose sessions are simulated, with its constant draws.
pub(super) struct ChainRobot<'a> {
    robot: &'a Robot,
    life: &'a SimulatedYear,
    kind: SessionKind,
    scenario: Scenario,
    /// Stiffness over nominal per joint.
    stiffness: Vec<f64>,
}

/// Conditions that vary from day to day.
struct Conditions {
    reading_error_k: f64,
    payload_kg: f64,
}

impl<'a> ChainRobot<'a> {
    pub(super) fn new(
        robot: &'a Robot,
        life: &'a SimulatedYear,
        kind: SessionKind,
    ) -> Result<Self, ChainError> {
        let mut scenario = scenario(robot, kind)?;
        scenario.robot_seed = Some(life.seed);
        scenario.temperature.reference_c = life.temperature_c[0];
        // Drawn here, so that a failed strand can take its share.
        let mut rng = ChaCha8Rng::seed_from_u64(life.seed);
        let stiffness = robot
            .joint_names()
            .iter()
            .map(|_| rng.random_range(0.8..1.2))
            .collect();
        Ok(Self {
            robot,
            life,
            kind,
            scenario,
            stiffness,
        })
    }

    /// Returns the baseline of the tensioning day, with an empty gripper and without contact.
    pub(super) fn baseline(&self) -> Result<Baseline, ChainError> {
        let (recorded, _) = self.record(0)?;
        Ok(learn_recorded(self.robot, &recorded, "day 0", &Learning::default())?.0)
    }

    /// Simulates a day's session and estimates it with `baseline`; the second result is the next baseline of the
    /// chain.
    pub(super) fn session(
        &self,
        day: usize,
        baseline: &Baseline,
    ) -> Result<(Session, Baseline), ChainError> {
        let (recorded, conditions) = self.record(day)?;
        let options = SessionOptions {
            payload: match self.kind {
                SessionKind::Check => Payload::Empty,
                SessionKind::Work => Payload::Unknown,
            },
            ..SessionOptions::default()
        };
        let name = format!("day {day}");
        let since = Some((baseline, "baseline"));
        let (estimate, next) = estimate_recorded(self.robot, &recorded, &name, since, &options)?;
        let true_temperature_c = self.life.temperature_c[day];
        let session = Session {
            seed: self.life.seed,
            day,
            true_temperature_c,
            temperature_c: true_temperature_c + conditions.reading_error_k,
            payload_kg: conditions.payload_kg,
            rejected_share: estimate.rejected_share,
            joints: self.assessed(day, &estimate),
        };
        Ok((session, next))
    }

    fn assessed(&self, day: usize, estimate: &SessionEstimate) -> Vec<SessionJoint> {
        let names = self.robot.joint_names();
        estimate
            .joints
            .iter()
            .map(|joint| {
                let place = names.iter().position(|n| *n == joint.name);
                let stiffness = place.map_or(1.0, |i| self.stiffness_on(i, day));
                let is_conclusive = joint.verdict != Verdict::Inconclusive;
                SessionJoint {
                    name: joint.name.clone(),
                    truth_rad: self.life.offset_rad(&joint.name, day),
                    offset_rad: is_conclusive.then_some(joint.offset_rad),
                    systematic_error: joint.systematic_error.filter(|_| is_conclusive),
                    true_stiffness_ratio: stiffness - 1.0,
                    stiffness_ratio: joint.stiffness_change_ratio,
                    steps: joint.changes.len(),
                }
            })
            .collect()
    }

    /// Stiffness of joint `i` over nominal on a day: a failed strand is missing.
    fn stiffness_on(&self, i: usize, day: usize) -> f64 {
        let failure = self.life.failure_of(&self.robot.joint_names()[i]);
        let lost = failure
            .filter(|f| day >= f.day)
            .map_or(0.0, |f| f.stiffness_ratio);
        self.stiffness[i] * (1.0 - lost)
    }

    /// Simulates a day's session; day 0 is the baseline's.
    fn record(&self, day: usize) -> Result<(Recorded, Conditions), ChainError> {
        let mut scenario = self.scenario.clone();
        scenario.seed = (self.life.seed.wrapping_mul(1_000_003)).wrapping_add(day as u64);
        scenario.start_time_ns += day as i64 * DAY_NS;
        let mut rng = ChaCha8Rng::seed_from_u64(scenario.seed);
        let normal: f64 = StandardNormal.sample(&mut rng);
        let mut conditions = Conditions {
            reading_error_k: THERMOMETER_K * normal,
            payload_kg: rng.random_range(0.0..PAYLOAD_KG),
        };
        if day == 0 {
            scenario.random_contacts = None;
        }
        if day == 0 || scenario.payloads.is_empty() {
            conditions.payload_kg = 0.0;
        }
        // Drawn here: the simulation would give a robot the same ones every day.
        for payload in &mut scenario.payloads {
            payload.mass_kg = Draw::Fixed(conditions.payload_kg);
        }
        scenario.temperature.reading_error_k = Draw::Fixed(conditions.reading_error_k);
        scenario.temperature.profile_c = Some(vec![(0.0, self.life.temperature_c[day])]);
        let names = self.robot.joint_names();
        scenario.truth.stiffness_factor.by_joint = (0..names.len())
            .map(|i| (names[i].clone(), 0, Draw::Fixed(self.stiffness_on(i, day))))
            .collect();
        scenario.offsets = names
            .iter()
            .map(|joint| Offset {
                joint: joint.clone(),
                line: 0,
                kind: OffsetKind::Physical,
                size_rad: Draw::Fixed(self.life.offset_rad(joint, day)),
                shape: Shape::Constant,
                later_s: Draw::Fixed(0.0),
            })
            .collect();
        let gap_s = sinew_log::OpenOptions::default().gap_s;
        let mut recorder = Recorder::new(self.robot, &FeatureConfig::default(), gap_s);
        let mut simulation = Simulation::new(self.robot, &scenario)?;
        while let Some(frame) = simulation.next_frame()? {
            let time_s = (frame.time_ns - scenario.start_time_ns) as f64 * 1e-9;
            recorder.push(frame, time_s);
        }
        Ok((recorder.finish(), conditions))
    }
}
