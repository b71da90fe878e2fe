//! Gauss–Newton steps from a start to the end.

/// A Gauss–Newton step.
pub(super) struct Step {
    /// Scale of the redescending weight, in standard deviations.
    pub(super) scale: f64,
    /// Blocks that pull at the state.
    pub(super) pull: See,
    /// Blocks the information is taken from.
    pub(super) inform: See,
}

/// A block whose weight is less, three standard deviations off in the mean, is no noise.
pub(super) const OFF: f64 = 0.25;

impl Step {
    /// Whether it starts from so far away that every block may be right.
    pub(super) fn is_wide(&self) -> bool {
        self.scale > 4.0
    }
}

/// Blocks that are looked at.
#[derive(Clone, Copy)]
pub(super) enum See {
    All,
    /// One in [`THIN`].
    Some,
}

/// Neighbours say much the same: their noise is correlated over half a second.
pub(super) const THIN: usize = 3;

impl See {
    /// Of so many blocks one is looked at.
    pub(super) fn every(self, blocks: usize) -> usize {
        /// Fewer blocks than this are all looked at.
        const MANY: usize = 90;
        match self {
            Self::Some if blocks >= MANY => THIN,
            _ => 1,
        }
    }
}

/// A step that only has to come near.
const fn near(scale: f64) -> Step {
    Step {
        scale,
        pull: See::Some,
        inform: See::Some,
    }
}

/// A step in the right direction, about as far as it should.
const fn towards(scale: f64) -> Step {
    Step {
        scale,
        pull: See::All,
        inform: See::Some,
    }
}

/// The last step.
const fn onto(scale: f64) -> Step {
    Step {
        scale,
        pull: See::All,
        inform: See::All,
    }
}

/// The equations are so nearly linear that one step per scale is within 1 % of many.
pub(super) const COLD: &[Step] = &[
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
/// From a start that is nearly right.
pub(super) const WARM: &[Step] = &[near(12.0), near(6.0), towards(3.5), towards(3.0), onto(3.0)];
/// For what is only looked at: enough to see whether a change is worth more, by one block in three.
pub(super) const GLANCE: &[Step] = &[near(3.0)];
/// Enough to see what it takes off the cost of these.
pub(super) const LOOK: &[Step] = &[near(12.0), near(6.0), near(3.0)];
/// From there on.
pub(super) const ON: &[Step] = &[towards(3.5), towards(3.0), onto(3.0)];
/// From the solution of nearly the same problem.
pub(super) const NEARLY: &[Step] = &[towards(3.0), onto(3.0)];
