//! The arm stands when the recording ends: what friction may hide then, and what it can't.

use super::context::Context;
use sinew_model::offset::JointParameter;

/// A shorter stand at the end is usual, and no change is sought so late, s.
const LONG_S: f64 = 5.0;
/// What is read now is averaged over the last blocks, s.
const NOW_S: f64 = 5.0;
/// Standard deviations by which friction may be larger than it was found.
const LARGER: f64 = 2.0;

/// A joint in a stand at the end of a recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stand {
    /// Since when, s.
    pub(super) from_s: f64,
    /// The largest slip that friction may hold, rad.
    pub(super) hidden_rad: f64,
    /// What is read there over the offset, rad.
    pub(super) off_rad: f64,
}

impl Stand {
    /// A joint that slid, in a stand of five seconds or more at the end; `None` where there isn't one.
    ///
    /// Friction `F = F_c + μ K |y|` holds a joint on either side, so it moves the reading by up to `2 F/K`.
    pub(super) fn at_end(context: &Context<'_>, joint: usize) -> Option<Self> {
        let Context {
            estimator,
            robot,
            recorded,
            segments,
            ..
        } = *context;
        let last = recorded.blocks.last()?;
        // One that never slid is unknown anyway.
        if last.stood_s < LONG_S || last.z_unknown[joint] >= 0.5 {
            return None;
        }
        let largest = |p| {
            let found = segments.belief.entry(estimator.prior().place(joint, p));
            found.mean.abs() + LARGER * found.deviation
        };
        let stiffness = robot.transmissions[joint].as_ref()?.stiffness_nm_per_rad;
        let load = largest(JointParameter::LoadFriction) * last.y[joint].abs();
        let (from, map) = segments.estimates.last()?;
        let blocks = recorded.blocks.get(*from..)?;
        let now = blocks.partition_point(|block| last.time_s - block.time_s > NOW_S);
        let residuals = estimator.residuals(map, &blocks[now..]);
        let own = residuals.iter().skip(joint);
        let sum: f64 = own.step_by(estimator.prior().joints()).sum();
        let count = (blocks.len() - now) as f64;
        Some(Self {
            from_s: (recorded.end_s() - last.stood_s).max(0.0),
            hidden_rad: 2.0 * (largest(JointParameter::Coulomb) / stiffness + load),
            off_rad: sum / count,
        })
    }

    /// The largest slip that reads so, rad: friction may hold some of it.
    pub(super) fn largest_rad(&self) -> f64 {
        self.off_rad.abs() + self.hidden_rad
    }

    /// Whether what is read there is more than friction can hold: a slip, or a contact that lasts.
    pub(super) fn is_more_than_friction(&self) -> bool {
        self.off_rad.abs() > self.hidden_rad
    }
}
