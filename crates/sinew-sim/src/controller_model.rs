//! What controller and contact detector know of the ropes, drawn.

use super::error::SimulateError;
use super::scenario::{KnownOffset, Scenario, Stream, rng};
use sinew_model::Gaussian;
use sinew_model::correction::JointCorrection;
use sinew_model::robot::Robot;

/// Knowledge of every joint's transmission.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ControllerModel {
    offset: KnownOffset,
    /// With `delta_e` as stated, or its error alone where the offset follows the truth.
    joints: Vec<JointCorrection>,
}

impl ControllerModel {
    /// Draws what the scenario leaves open, from a stream of its own.
    pub(crate) fn new(robot: &Robot, scenario: &Scenario) -> Result<Self, SimulateError> {
        let c = &scenario.correction;
        if let Some(named) = &c.estimate {
            return Err(SimulateError::Estimate {
                file: named.clone(),
                why: "named by the scenario, but not read (Correction::read_estimate)".into(),
            });
        }
        let names = robot.joint_names();
        let n = names.len();
        let (one, zero) = (vec![1.0; n], vec![0.0; n]);
        let mut rng = rng(scenario.seed, Stream::Correction);
        let stated = c.offset_rad.sample(names, &zero, &mut rng);
        let error = c.offset_error_rad.sample(names, &zero, &mut rng);
        let deviation = c.offset_deviation_rad.sample(names, &zero, &mut rng);
        let stiffness = c.stiffness_factor.sample(names, &one, &mut rng);
        let stiffness_deviation = c.stiffness_deviation.sample(names, &zero, &mut rng);
        let cubic = c.spring_cubic_per_rad2.sample(names, &zero, &mut rng);
        let joints = (0..n)
            .map(|i| JointCorrection {
                delta_e_rad: Gaussian {
                    mean: match c.offset {
                        KnownOffset::Nothing => 0.0,
                        KnownOffset::True => error[i],
                        KnownOffset::Stated => stated[i] + error[i],
                    },
                    deviation: deviation[i],
                },
                stiffness_factor: Gaussian::new(stiffness[i], stiffness_deviation[i]),
                cubic_per_rad2: cubic[i],
            })
            .collect();
        Ok(Self {
            offset: c.offset,
            joints,
        })
    }

    /// Whether what is known moves with the true offset.
    pub(crate) fn follows_truth(&self) -> bool {
        self.offset == KnownOffset::True
    }

    /// What is known while the true offset is 0, or always.
    pub(crate) fn at_start(&self) -> &[JointCorrection] {
        &self.joints
    }

    /// What is known of joint `i` while its true offset is this, rad.
    pub(crate) fn of_joint(&self, i: usize, true_offset: f64) -> JointCorrection {
        let mut known = self.joints[i];
        if self.follows_truth() {
            known.delta_e_rad.mean += true_offset;
        }
        known
    }
}
