//! Model of an estimate from blocks: the robot's prior and the properties of blocks.

use super::reduced_model::ReducedModel;
use crate::offset::block::Block;
use crate::offset::change::Appearance;
use crate::offset::config::FeatureConfig;
use crate::offset::external_force::ForceModel;
use crate::offset::prior::Prior;

/// Prior of a robot, and noise and lag of blocks made of its recordings.
#[derive(Debug, Clone)]
pub(crate) struct EstimationModel {
    pub(crate) prior: Prior,
    /// The parameters that blocks can identify.
    pub(crate) reduced: ReducedModel,
    /// Ratio of the variance of a block mean to that of independent noise: correlation time divided by block duration.
    pub(crate) inflation: f64,
    pub(crate) block_s: f64,
    /// Pole of the blocks' low-pass, 1/s.
    pub(crate) gain_per_s: f64,
    /// Lag of the blocks, s.
    pub(crate) delay_s: f64,
    /// No joint is trusted to better than this, rad.
    pub(crate) noise_floor_rad: f64,
    /// Whether a recorded motor torque is used.
    pub(crate) motor_torque: bool,
    /// External force that is searched for.
    pub(crate) force: Option<ForceModel>,
}

/// Joint travel that provides one independent measurement, rad: model errors depend on the pose.
const INDEPENDENT_TRAVEL_RAD: f64 = 0.3;
/// Time that provides one independent measurement, s: model errors also change slowly with time.
const INDEPENDENT_TIME_S: f64 = 10.0;

impl EstimationModel {
    pub(crate) fn new(prior: Prior, features: &FeatureConfig) -> Self {
        /// Duration for which the friction of a stroke is correlated, s.
        const STROKE_S: f64 = 0.3;
        // Two time constants of the low-pass of every signal, and a presliding stroke.
        let correlation_s = 2.0 / features.gain_per_s + STROKE_S;
        Self {
            reduced: ReducedModel::new(
                &prior,
                Appearance {
                    gain_per_s: features.gain_per_s,
                    delay_s: features.delay_s(),
                },
            ),
            prior,
            inflation: (correlation_s / features.block_s).max(1.0),
            block_s: features.block_s,
            gain_per_s: features.gain_per_s,
            delay_s: features.delay_s(),
            noise_floor_rad: 0.12e-3,
            motor_torque: true,
            force: None,
        }
    }

    /// Minimum noise of a motor equation, N·m: torque ripple and friction model error.
    pub(crate) fn motor_floor(&self, i: usize) -> f64 {
        const PART: f64 = 0.1;
        let joint = self.prior.joints.get(i).and_then(Option::as_ref);
        joint.map_or(1.0, |j| {
            (PART * j.drive_coulomb_nm()).max(1e-4 * j.stiffness_nm_per_rad)
        })
    }

    /// Minimum noise of an equation of a tension sensor, N·m: ripple of 0.1 % of the usual tendon force.
    pub(crate) fn tension_floor(&self, i: usize) -> f64 {
        let joint = self.prior.joints.get(i).and_then(Option::as_ref);
        joint.map_or(1.0, |j| 1e-3 * j.usual_torque_nm())
    }

    /// Returns the share of a block's information that is used: `max|q̇| t / 0.3 rad` of a block of the length `t`, at
    /// least `t / 10 s`, and at most the share left by correlated noise.
    ///
    /// Model errors depend on the pose. A slower motion on the same path provides no additional information.
    pub(crate) fn share(&self, block: &Block) -> f64 {
        let speeds = block.dq.iter().map(|v| v.abs());
        let travelled = speeds.fold(0.0, f64::max) * self.block_s / INDEPENDENT_TRAVEL_RAD;
        let passed = self.block_s / INDEPENDENT_TIME_S;
        travelled.max(passed).min(1.0 / self.inflation)
    }
}

#[cfg(test)]
mod tests {
    use crate::offset::block::Block;
    use crate::offset::fixtures::turntables;

    #[test]
    fn block_share_proportional_to_fastest_joint_travel() {
        let model = turntables(2, 0.0);
        let most = 1.0 / model.inflation;
        for (dq, share) in [
            ([0.15, -0.3], 0.2),
            ([-0.15, 0.0], 0.1),
            ([0.0, 0.0], 0.02),
            ([0.01, 0.02], 0.02),
            ([9.0, 0.0], most),
        ] {
            let mut block = Block::zero(2, 1);
            block.dq.copy_from_slice(&dq);
            assert!((model.share(&block) - share).abs() < 1e-12, "{dq:?}");
        }
    }
}
