//! Daily sessions through the whole chain: simulated recording, baseline, absolute estimate.
//!
//! A session is a minute of the work session of `examples/scenarios/work-session.toml`: random poses, an
//! unknown payload, contacts a tenth of the time. The robot is the same every day (masses, stiffness,
//! friction, encoders); temperature drifts its zero by 0.1 mrad/K and softens it by 0.1 to 0.3 %/K.

use super::surrogate::Failure;
use crate::absolute::{self, Absolute, AbsoluteError, Baseline, WatchOptions, Window};
use crate::estimate::Request;
use crate::simulate::scenario::{Bound, Draw, Offset, OffsetKind, PerJoint, Shape};
use crate::simulate::{self, Scenario, SimulateError, SimulateOptions};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use sinew_model::robot::Robot;
use std::path::{Path, PathBuf};

const WORK: &str = include_str!("../../../../../examples/scenarios/work-session.toml");

/// Why a session failed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ChainError {
    /// The simulation.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
    /// The estimate.
    #[error(transparent)]
    Absolute(#[from] AbsoluteError),
}

/// A robot whose sessions are simulated.
#[derive(Debug)]
pub struct Chain<'a> {
    robot: &'a Robot,
    place: PathBuf,
    folder: &'a Path,
    seed: u64,
    scenario: Scenario,
    baseline: Baseline,
}

/// A day of a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Day {
    /// Which one; 0 is the day of the baseline.
    pub day: usize,
    /// True offset per joint named, rad.
    pub offsets_rad: Vec<(String, f64)>,
    /// Temperature, °C.
    pub temperature_c: f64,
    /// A strand that has failed by now, and its joint.
    pub failed: Option<(String, Failure)>,
}

impl<'a> Chain<'a> {
    /// Draws a robot and learns its baseline; recordings are written to `folder`, one at a time.
    ///
    /// # Errors
    /// [`ChainError`].
    pub fn new(
        robot: &'a Robot,
        place: &Path,
        folder: &'a Path,
        seed: u64,
        temperature_c: f64,
    ) -> Result<Self, ChainError> {
        let mut scenario = Scenario::from_toml(WORK, "work-session.toml")?;
        scenario.duration_s = Some(60.0);
        scenario.robot_seed = Some(seed);
        scenario.offsets.clear();
        scenario.sessions.clear();
        // Drawn here, so that a failed strand can take its share.
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let names = robot.joint_names();
        scenario.truth.stiffness_factor.by_joint = names
            .iter()
            .map(|n| (n.clone(), 0, Draw::Fixed(rng.random_range(0.8..1.2))))
            .collect();
        scenario.temperature.reference_c = temperature_c;
        scenario.temperature.zero_drift_rad_per_k = PerJoint {
            all: Some(Draw::Normal {
                mean: 0.0,
                std: 1e-4,
                bound: Bound::Any,
            }),
            by_joint: Vec::new(),
        };
        scenario.temperature.stiffness_per_k = PerJoint {
            all: Some(Draw::Uniform {
                min: -0.003,
                max: -0.001,
            }),
            by_joint: Vec::new(),
        };
        scenario.temperature.reading_error_k = Draw::Normal {
            mean: 0.0,
            std: 0.5,
            bound: Bound::Any,
        };
        let mut first = scenario.clone();
        first.payloads.clear();
        first.random_contacts = None;
        first.seed = seed;
        let log = folder.join("session.mcap");
        simulate::run(robot, &first, &SimulateOptions::new(&log), &mut |_| {})?;
        let (baseline, _) =
            absolute::learn(&Self::request(place, &log), Window::default(), &mut |_| {})?;
        Ok(Self {
            robot,
            place: place.to_path_buf(),
            folder,
            seed,
            scenario,
            baseline,
        })
    }

    fn request(place: &Path, log: &Path) -> Request {
        let mut request = Request::new(log.to_path_buf());
        request.robot = Some(place.to_path_buf());
        request
    }

    /// One day's session, estimated since the baseline.
    ///
    /// # Errors
    /// [`ChainError`].
    pub fn session(&self, day: &Day) -> Result<Absolute, ChainError> {
        let mut scenario = self.scenario.clone();
        scenario.seed = self
            .seed
            .wrapping_mul(1_000_003)
            .wrapping_add(day.day as u64);
        for payload in &mut scenario.payloads {
            payload.attach_s = 0.0;
        }
        if let Some(contacts) = &mut scenario.random_contacts {
            contacts.from_to_s.0 = 0.0;
        }
        scenario.temperature.profile_c = Some(vec![(0.0, day.temperature_c)]);
        let mut offsets = day.offsets_rad.clone();
        if let Some((joint, failure)) = &day.failed {
            offsets.push((joint.clone(), 1e-3 * failure.size_mrad));
            for (name, _, draw) in &mut scenario.truth.stiffness_factor.by_joint {
                if let (true, Draw::Fixed(factor)) = (name == joint, draw) {
                    *factor *= 1.0 - 0.01 * failure.stiffness_percent;
                }
            }
        }
        scenario.offsets = offsets
            .into_iter()
            .map(|(joint, rad)| Offset {
                joint,
                line: 0,
                kind: OffsetKind::Physical,
                size_rad: Draw::Fixed(rad),
                shape: Shape::Constant,
                later_s: Draw::Fixed(0.0),
            })
            .collect();
        let log = self.folder.join("session.mcap");
        simulate::run(
            self.robot,
            &scenario,
            &SimulateOptions::new(&log),
            &mut |_| {},
        )?;
        let (said, _) = absolute::watch(
            &Self::request(&self.place, &log),
            Window::default(),
            Some((&self.baseline, "baseline")),
            &WatchOptions::default(),
            &mut |_| {},
        )?;
        Ok(said)
    }
}
