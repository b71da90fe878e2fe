//! Schedules of Gauss–Newton steps: scales of the redescending weight, and blocks that count.

/// A Gauss–Newton step.
pub(super) struct Step {
    /// Scale of the redescending weight, in standard deviations.
    pub(super) scale: f64,
    /// Blocks the gradient is taken from.
    pub(super) gradient: Sampling,
    /// Blocks the information is taken from.
    pub(super) information: Sampling,
}

/// A block whose weight is less, three standard deviations off in the mean, is an outlier.
pub(super) const OUTLIER_WEIGHT: f64 = 0.25;

impl Step {
    /// Whether it starts from so far away that every block may be right.
    pub(super) fn is_wide(&self) -> bool {
        self.scale > 4.0
    }
}

/// Blocks that a step uses.
#[derive(Clone, Copy)]
pub(super) enum Sampling {
    All,
    /// One in [`THIN`].
    Thinned,
}

/// Stride over correlated neighbours: the noise is correlated over half a second.
pub(super) const THIN: usize = 3;

impl Sampling {
    /// Returns the stride through `blocks` blocks.
    pub(super) fn every(self, blocks: usize) -> usize {
        /// Number of blocks below which all are used.
        const MAX_DENSE_BLOCKS: usize = 90;
        match self {
            Self::Thinned if blocks >= MAX_DENSE_BLOCKS => THIN,
            _ => 1,
        }
    }
}

/// Creates a step of coarse accuracy.
const fn near(scale: f64) -> Step {
    Step {
        scale,
        gradient: Sampling::Thinned,
        information: Sampling::Thinned,
    }
}

/// A step in the right direction, about as far as it should.
const fn towards(scale: f64) -> Step {
    Step {
        scale,
        gradient: Sampling::All,
        information: Sampling::Thinned,
    }
}

/// The last step.
const fn onto(scale: f64) -> Step {
    Step {
        scale,
        gradient: Sampling::All,
        information: Sampling::All,
    }
}

/// From the prior. The equations are so nearly linear that one step per scale is within 1 % of many.
pub(super) const COLD_START: &[Step] = &[
    near(40.0),
    near(40.0),
    near(20.0),
    near(10.0),
    near(6.0),
    near(4.0),
    towards(3.5),
    towards(3.0),
    towards(3.0),
    onto(3.0),
];
/// From a start that is about right.
pub(super) const ROUGH_START: &[Step] =
    &[near(12.0), near(6.0), towards(3.5), towards(3.0), onto(3.0)];
/// Enough to see whether a candidate deserves [`COARSE`], by one block in three.
pub(super) const SCREENING: &[Step] = &[near(3.0)];
/// Schedule that suffices to estimate the decrease of the cost of these blocks by a candidate.
pub(super) const COARSE: &[Step] = &[near(12.0), near(6.0), near(3.0)];
/// From there to the end.
pub(super) const REFINE: &[Step] = &[towards(3.5), towards(3.0), onto(3.0)];
/// From the solution of nearly the same problem.
pub(super) const WARM_START: &[Step] = &[towards(3.0), onto(3.0)];
