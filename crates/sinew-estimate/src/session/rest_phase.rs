//! Rest phase at the end of a recording: the slip that stiction can hide, and offsets beyond it.

use super::context::Context;
use sinew_model::offset::JointParameter;

/// Minimum duration of a rest phase to be reported, s: shorter ones are usual, and no change point is searched so late.
const MIN_DURATION_S: f64 = 5.0;
/// Duration over which the final residual is averaged, s.
const AVERAGING_S: f64 = 5.0;
/// Number of standard deviations added to the estimated friction for an upper bound.
const FRICTION_STDS: f64 = 2.0;

/// State of a joint in the rest phase at the end of a recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RestPhase {
    /// Start of the rest phase, s since the start of the recording.
    pub(super) from_s: f64,
    /// Largest slip that stiction can hide, rad.
    pub(super) stiction_bound_rad: f64,
    /// Mean residual in the rest phase relative to the estimated offset, rad.
    pub(super) inconsistency_rad: f64,
}

impl RestPhase {
    /// Evaluates the final rest phase of a joint; `None` if it lasts less than five seconds or the joint never slid
    /// before.
    ///
    /// Friction `F = F_c + μ K |y|` holds a joint on either side, so it shifts the measured offset by up to `2 F/K`.
    pub(super) fn at_end(context: &Context<'_>, joint: usize) -> Option<Self> {
        let Context {
            estimator,
            robot,
            recorded,
            segments,
            ..
        } = *context;
        let last = recorded.blocks.last()?;
        // The friction of a joint that never slid is unknown anyway.
        if last.stood_s < MIN_DURATION_S || last.z_unknown[joint] >= 0.5 {
            return None;
        }
        let largest = |p| {
            let found = segments
                .state_estimate
                .entry(estimator.prior().place(joint, p));
            found.mean.abs() + FRICTION_STDS * found.std
        };
        let stiffness = robot.transmissions[joint].as_ref()?.stiffness_nm_per_rad;
        let load = largest(JointParameter::LoadFriction) * last.y[joint].abs();
        let (from, map) = segments.estimates.last()?;
        let blocks = recorded.blocks.get(*from..)?;
        let now = blocks.partition_point(|block| last.time_s - block.time_s > AVERAGING_S);
        let residuals = estimator.residuals(map, &blocks[now..]);
        let own = residuals.iter().skip(joint);
        let sum: f64 = own.step_by(estimator.prior().joints()).sum();
        let count = (blocks.len() - now) as f64;
        Some(Self {
            from_s: (recorded.end_s() - last.stood_s).max(0.0),
            stiction_bound_rad: 2.0 * (largest(JointParameter::Coulomb) / stiffness + load),
            inconsistency_rad: sum / count,
        })
    }

    /// Largest slip consistent with the measured residual, rad: stiction can hide part of it.
    pub(super) fn largest_rad(&self) -> f64 {
        self.inconsistency_rad.abs() + self.stiction_bound_rad
    }

    /// Whether the residual exceeds what stiction explains, so that it is a slip or a lasting contact.
    pub(super) fn exceeds_stiction(&self) -> bool {
        self.inconsistency_rad.abs() > self.stiction_bound_rad
    }
}
