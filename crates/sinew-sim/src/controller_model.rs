//! Drawn corrections of controller and contact detector.

use super::error::SimulateError;
use super::sampled::Names;
use super::scenario::{Scenario, SpecifiedOffset, Stream, rng};
use sinew_model::Gaussian;
use sinew_model::correction::JointCorrection;
use sinew_model::robot::Robot;

/// Knowledge of the transmission on every axis.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ControllerModel {
    offset: SpecifiedOffset,
    /// Corrections with the specified `delta_e`, or only with its error if the offset follows the truth.
    joints: Vec<JointCorrection>,
}

impl ControllerModel {
    /// Draws the unspecified values of the scenario from a separate random stream.
    pub(crate) fn new(robot: &Robot, scenario: &Scenario) -> Result<Self, SimulateError> {
        let c = &scenario.correction;
        if let Some(named) = &c.estimate {
            return Err(SimulateError::Estimate {
                file: named.clone(),
                reason: "named by the scenario, but not read (Correction::read_estimate)".into(),
            });
        }
        let names = &Names::of(robot).tendons;
        let n = names.len();
        let (one, zero) = (vec![1.0; n], vec![0.0; n]);
        let mut rng = rng(scenario.seed, Stream::Correction);
        let stated = c.offset_rad.sample(names, &zero, &mut rng);
        let error = c.offset_error_rad.sample(names, &zero, &mut rng);
        let std = c.offset_std_rad.sample(names, &zero, &mut rng);
        let stiffness = c.stiffness_factor.sample(names, &one, &mut rng);
        let stiffness_std = c.stiffness_std.sample(names, &zero, &mut rng);
        let cubic = c.spring_cubic_per_rad2.sample(names, &zero, &mut rng);
        let joints = (0..n)
            .map(|i| JointCorrection {
                delta_e_rad: Gaussian {
                    mean: match c.offset {
                        SpecifiedOffset::Nothing => 0.0,
                        SpecifiedOffset::True => error[i],
                        SpecifiedOffset::Stated => stated[i] + error[i],
                    },
                    std: std[i],
                },
                stiffness_factor: Gaussian::new(stiffness[i], stiffness_std[i]),
                cubic_per_rad2: cubic[i],
            })
            .collect();
        Ok(Self {
            offset: c.offset,
            joints,
        })
    }

    /// Whether the correction changes with the true offset.
    pub(crate) fn follows_truth(&self) -> bool {
        self.offset == SpecifiedOffset::True
    }

    /// Correction at a true offset of 0, or at all times if it is constant.
    pub(crate) fn at_start(&self) -> &[JointCorrection] {
        &self.joints
    }

    /// Correction of the tendon on axis `i` at the true offset `true_offset`, rad.
    pub(crate) fn of_joint(&self, i: usize, true_offset: f64) -> JointCorrection {
        let mut correction = self.joints[i];
        if self.follows_truth() {
            correction.delta_e_rad.mean += true_offset;
        }
        correction
    }
}
