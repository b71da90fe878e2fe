//! The search for poses, by exchange.

use super::ExcitationError;
use super::proposal::{BaselineSource, Expected, Pose, Proposal};
use super::visit::{Sensors, Visit};
use crate::baseline::Baseline;
use crate::session;
use crate::session::{Payload, SessionEstimate, SessionOptions};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use sinew_model::Gaussian;
use sinew_model::arm::ArmWorkspace;
use sinew_model::robot::Robot;
use sinew_model::statistics::upper_median;

/// How to search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Poses in the list, at least 2.
    pub poses: usize,
    /// Rest at each, s.
    pub pause_s: f64,
    /// Poses tried in the place of each, per round.
    pub candidates: usize,
    /// Rounds.
    pub rounds: usize,
    /// Random lists to compare with; the best is where the search starts.
    pub random_lists: usize,
    /// Whether the gripper may hold something unknown.
    pub payload: bool,
    /// What the recording will be like.
    pub sensors: Sensors,
    /// Seed of all that is drawn.
    pub seed: u64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            poses: 6,
            pause_s: 1.0,
            candidates: 6,
            rounds: 2,
            random_lists: 8,
            payload: true,
            sensors: Sensors::default(),
            seed: 1,
        }
    }
}

/// Interval of simulated robots over that of the nominal one: those of scenario S6, which differ
/// from their description in stiffness, masses and friction, show 2.9 times the interval (seeds 700
/// to 711, 48 offsets; `tests/excitation.rs` holds 3 against others). Residuals and the baseline
/// are worse than on a robot that is as described.
const SEEN_OVER_NOMINAL: f64 = 3.0;
/// Share of the range at each end that poses stay away from.
const MARGIN: f64 = 0.1;
/// Share of the effort that holding a pose may take.
const EFFORT: f64 = 0.5;
/// A joint that turns without end is moved this far to each side, rad.
const CONTINUOUS_RAD: f64 = 1.5;
/// Poses of the baseline that is assumed where none is given.
const BASELINE_POSES: usize = 25;
/// An interval above this tells nothing, mrad (as in the estimate).
const USELESS_MRAD: f64 = 5.0;

/// Looks for poses that make the offsets of `robot` identifiable.
///
/// Greedy exchange: the best of a few random lists, then each pose in turn is replaced by the
/// candidate that makes the root mean square of the joints' intervals smallest. The same seed
/// gives the same list. `progress` is told lists done and lists in all.
///
/// With a baseline its uncertainty is used, about the nominal robot; without one, what 25 random
/// poses right after tensioning would teach.
///
/// # Errors
/// [`ExcitationError`].
pub fn propose(
    robot: &Robot,
    baseline: Option<(&Baseline, &str)>,
    options: &Options,
    progress: &mut dyn FnMut(usize, usize),
) -> Result<Proposal, ExcitationError> {
    if robot.transmissions.iter().all(Option::is_none) {
        return Err(ExcitationError::Rigid {
            robot: robot.name.clone(),
        });
    }
    let mut search = Search::new(robot, baseline, options)?;
    let count = options.poses.max(2);
    let lists = options.random_lists.max(1);
    let total = lists + options.rounds * count * options.candidates;
    let mut random = Vec::new();
    for done in 0..lists {
        progress(done, total);
        let poses = search.random_poses(count)?;
        let expected = search.expect(&poses)?;
        random.push((merit(&expected), poses, expected));
    }
    let medians = medians(&random.iter().map(|r| &r.2).collect::<Vec<_>>());
    random.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut best, mut poses, mut expected) = random.swap_remove(0);
    let mut done = lists;
    for _ in 0..options.rounds {
        for place in 0..count {
            for _ in 0..options.candidates {
                progress(done, total);
                done += 1;
                let mut tried = poses.clone();
                tried[place] = search.random_pose()?;
                let trial = search.expect(&tried)?;
                if merit(&trial) < best {
                    (best, poses, expected) = (merit(&trial), tried, trial);
                }
            }
        }
    }
    Ok(search.proposal(poses, &expected, &medians, done))
}

/// Root mean square of the joints' intervals, mrad.
fn merit(expected: &SessionEstimate) -> f64 {
    let sum: f64 = expected
        .joints
        .iter()
        .map(|j| (1e3 * j.offset_rad.half_width_95()).powi(2))
        .sum();
    (sum / expected.joints.len().max(1) as f64).sqrt()
}

/// Median standard deviation of each joint's offset, rad.
fn medians(of: &[&SessionEstimate]) -> Vec<f64> {
    let joints = of.first().map_or(0, |a| a.joints.len());
    (0..joints)
        .map(|i| {
            let mut values: Vec<f64> = of
                .iter()
                .map(|a| a.joints[i].offset_rad.deviation)
                .collect();
            upper_median(&mut values).unwrap_or(f64::NAN)
        })
        .collect()
}

struct Search<'r> {
    robot: &'r Robot,
    options: Options,
    ranges: Vec<(f64, f64)>,
    rng: ChaCha8Rng,
    ws: ArmWorkspace,
    baseline: Baseline,
    source: BaselineSource,
}

impl<'r> Search<'r> {
    fn new(
        robot: &'r Robot,
        given: Option<(&Baseline, &str)>,
        options: &Options,
    ) -> Result<Self, ExcitationError> {
        let ranges = robot
            .limits
            .iter()
            .map(|limit| {
                let width = limit.upper - limit.lower;
                if width.is_finite() && width > 0.0 {
                    (limit.lower + MARGIN * width, limit.upper - MARGIN * width)
                } else {
                    (-CONTINUOUS_RAD, CONTINUOUS_RAD)
                }
            })
            .collect();
        let mut search = Self {
            robot,
            options: *options,
            ranges,
            rng: ChaCha8Rng::seed_from_u64(options.seed),
            ws: ArmWorkspace::new(&robot.arm),
            // Replaced below: learning needs the rest of this.
            baseline: Baseline {
                format: String::new(),
                version: 0,
                robot: robot.name.clone(),
                joints: Vec::new(),
                stiffness_nm_per_rad: Vec::new(),
                inertial: Vec::new(),
                recordings: Vec::new(),
                end_time_ns: 0,
                temperature_c: None,
                temperature_deviation_k: 0.0,
                change_deviation_k: 0.0,
                anchors: Vec::new(),
                zero_time_ns: None,
                mean: Vec::new(),
                covariance_lower: Vec::new(),
                before: Vec::new(),
                noise_rad: Vec::new(),
                motor_noise_nm: Vec::new(),
            },
            source: BaselineSource::Assumed {
                poses: BASELINE_POSES,
                duration_s: 0.0,
            },
        };
        let poses = search.random_poses(BASELINE_POSES)?;
        let recorded = search.record(&poses)?;
        let (learned, _) = session::learn_recorded(
            robot,
            &recorded,
            "synthetic baseline",
            &session::Learning {
                temperature_c: Some(ROOM_C),
                ..session::Learning::default()
            },
        )
        .map_err(Box::new)?;
        match given {
            Some((given, file)) => {
                // Let the estimator say whether it belongs to this robot.
                let empty = session_options(false);
                session::estimate_recorded(robot, &recorded, file, Some((given, file)), &empty)
                    .map_err(Box::new)?;
                search.baseline = Baseline {
                    covariance_lower: given.covariance_lower.clone(),
                    ..learned
                };
                search.source = BaselineSource::Given {
                    file: file.into(),
                    recordings: given.recordings.clone(),
                };
            }
            None => {
                search.baseline = learned;
                search.source = BaselineSource::Assumed {
                    poses: BASELINE_POSES,
                    duration_s: recorded.duration_s,
                };
            }
        }
        Ok(search)
    }

    /// A pose within the ranges that takes no more than its share of the efforts to hold.
    fn random_pose(&mut self) -> Result<Vec<f64>, ExcitationError> {
        const TRIES: usize = 1000;
        let still = vec![0.0; self.ranges.len()];
        for _ in 0..TRIES {
            let q: Vec<f64> = self
                .ranges
                .iter()
                .map(|(lo, hi)| lo + (hi - lo) * self.rng.random::<f64>())
                // Whole milliradians are easier to write down.
                .map(|q| (1e3 * q).round() / 1e3)
                .collect();
            let torque = self
                .robot
                .arm
                .bias_torque(&mut self.ws, &q, &still)
                .map_err(|error| ExcitationError::Model {
                    robot: self.robot.name.clone(),
                    error,
                })?;
            let held = torque.iter().zip(&self.robot.limits).all(|(tau, limit)| {
                let known = limit.effort.is_finite() && limit.effort > 0.0;
                !known || tau.abs() <= EFFORT * limit.effort
            });
            if held {
                return Ok(q);
            }
        }
        Err(ExcitationError::TooHeavy {
            robot: self.robot.name.clone(),
            tried: TRIES,
            share: 100.0 * EFFORT,
        })
    }

    fn random_poses(&mut self, count: usize) -> Result<Vec<Vec<f64>>, ExcitationError> {
        (0..count).map(|_| self.random_pose()).collect()
    }

    fn record(&self, poses: &[Vec<f64>]) -> Result<session::Recorded, ExcitationError> {
        // The same noise for every list, so that lists differ by their poses alone.
        Visit::new(self.robot, poses.to_vec(), self.options.pause_s)
            .record(self.robot, self.options.sensors, self.options.seed)
            .map_err(|error| ExcitationError::Model {
                robot: self.robot.name.clone(),
                error,
            })
    }

    /// What the estimator says of a visit.
    fn expect(&self, poses: &[Vec<f64>]) -> Result<SessionEstimate, ExcitationError> {
        let recorded = self.record(poses)?;
        let baseline = Some((&self.baseline, "baseline"));
        session::estimate_recorded(
            self.robot,
            &recorded,
            "proposed poses",
            baseline,
            &session_options(self.options.payload),
        )
        .map(|(expected, _)| expected)
        .map_err(|e| Box::new(e).into())
    }

    fn proposal(
        self,
        poses: Vec<Vec<f64>>,
        expected: &SessionEstimate,
        random: &[f64],
        lists_tried: usize,
    ) -> Proposal {
        let visit = Visit::new(self.robot, poses, self.options.pause_s);
        Proposal {
            robot: self.robot.name.clone(),
            joints: self.robot.joint_names().to_vec(),
            duration_s: visit.duration_s(),
            poses: visit
                .poses
                .iter()
                .zip(&visit.move_s)
                .map(|(pose, move_s)| Pose {
                    pose_rad: pose.clone(),
                    move_s: *move_s,
                    pause_s: visit.pause_s,
                })
                .collect(),
            expected: expected
                .joints
                .iter()
                .zip(random)
                .map(|(joint, random)| Expected {
                    name: joint.name.clone(),
                    offset_deviation_rad: SEEN_OVER_NOMINAL * joint.offset_rad.deviation,
                    elongation_deviation_m: joint
                        .elongation_m
                        .map(|m| SEEN_OVER_NOMINAL * m.deviation),
                    random_offset_deviation_rad: SEEN_OVER_NOMINAL * random,
                    identifiable: SEEN_OVER_NOMINAL * 1e3 * joint.offset_rad.half_width_95()
                        <= USELESS_MRAD,
                })
                .collect(),
            baseline: self.source,
            payload: self.options.payload,
            joint_bits: self.options.sensors.joint_bits,
            lists_tried,
            inflation_factor: SEEN_OVER_NOMINAL,
        }
    }
}

/// Temperature of both recordings, °C: it is recorded, as a promise to keep.
const ROOM_C: Gaussian = Gaussian {
    mean: 20.0,
    deviation: 0.0,
};

/// How the session to come will be estimated.
fn session_options(payload: bool) -> SessionOptions {
    SessionOptions {
        payload: if payload {
            Payload::Unknown
        } else {
            Payload::Empty
        },
        temperature_c: Some(ROOM_C),
        ..SessionOptions::default()
    }
}
