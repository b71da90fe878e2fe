//! Time profile of a value.

/// Time profile of a value whose size is specified separately.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// Constant from the start.
    Constant,
    /// Step from 0 to the full size.
    Step {
        /// Time of the step, s.
        at_s: f64,
    },
    /// Grows along a straight line.
    Ramp {
        /// Start of the ramp, s.
        from_s: f64,
        /// End of the ramp, s.
        to_s: f64,
    },
    /// Saturating growth `1 − exp(−(t − from)/T)`, as every rope of the paper's Fig. 1 does.
    Exponential {
        /// Start of the rise, s.
        from_s: f64,
        /// Time constant `T`, s.
        time_constant_s: f64,
    },
    /// Linear interpolation between these times and values, constant outside. A rope that is relaxed and re-tensioned
    /// is a table that increases and then decreases.
    Table(Vec<(f64, f64)>),
}

impl Shape {
    /// Value at time `t`, s, for a size of 1.
    pub fn at(&self, t: f64) -> f64 {
        match self {
            Self::Constant => 1.0,
            Self::Step { at_s } => {
                if t >= *at_s {
                    1.0
                } else {
                    0.0
                }
            }
            Self::Ramp { from_s, to_s } => {
                if t <= *from_s {
                    0.0
                } else if t >= *to_s {
                    1.0
                } else {
                    (t - from_s) / (to_s - from_s)
                }
            }
            Self::Exponential {
                from_s,
                time_constant_s,
            } => {
                if t <= *from_s {
                    0.0
                } else {
                    1.0 - libm::exp(-(t - from_s) / time_constant_s)
                }
            }
            Self::Table(points) => interpolate(points, t),
        }
    }

    /// Returns the same profile with a step delayed by `later_s`, s.
    pub fn later(&self, later_s: f64) -> Self {
        match self {
            Self::Step { at_s } => Self::Step {
                at_s: at_s + later_s,
            },
            other => other.clone(),
        }
    }

    /// Times at which the profile has a corner or a step, s.
    pub fn corners(&self) -> Vec<f64> {
        match self {
            Self::Constant => Vec::new(),
            Self::Step { at_s } => vec![*at_s],
            Self::Ramp { from_s, to_s } => vec![*from_s, *to_s],
            Self::Exponential { from_s, .. } => vec![*from_s],
            Self::Table(points) => points.iter().map(|&(t, _)| t).collect(),
        }
    }

    /// Times of the steps of the value, s.
    pub fn step_s(&self) -> Option<f64> {
        match self {
            Self::Step { at_s } => Some(*at_s),
            _ => None,
        }
    }
}

/// Straight lines between points sorted by time; the ends hold. 0 without points.
pub fn interpolate(points: &[(f64, f64)], t: f64) -> f64 {
    let after = points.partition_point(|&(time, _)| time <= t);
    match (
        after.checked_sub(1).and_then(|i| points.get(i)),
        points.get(after),
    ) {
        (Some(&(t0, v0)), Some(&(t1, v1))) => v0 + (v1 - v0) * (t - t0) / (t1 - t0),
        (Some(&(_, v)), None) | (None, Some(&(_, v))) => v,
        (None, None) => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_start_and_end_as_specified() {
        let table = Shape::Table(vec![(1.0, 0.0), (2.0, 4.0), (3.0, 1.0)]);
        assert_eq!(
            [0.0, 1.5, 2.0, 2.5, 9.0].map(|t| table.at(t)),
            [0.0, 2.0, 4.0, 2.5, 1.0]
        );
        let ramp = Shape::Ramp {
            from_s: 1.0,
            to_s: 3.0,
        };
        assert_eq!(
            [0.0, 1.0, 2.0, 3.0, 4.0].map(|t| ramp.at(t)),
            [0.0, 0.0, 0.5, 1.0, 1.0]
        );
        let step = Shape::Step { at_s: 2.0 };
        assert_eq!([1.999, 2.0].map(|t| step.at(t)), [0.0, 1.0]);
        let growth = Shape::Exponential {
            from_s: 1.0,
            time_constant_s: 2.0,
        };
        assert_eq!(growth.at(1.0), 0.0);
        assert!((growth.at(3.0) - (1.0 - (-1f64).exp())).abs() < 1e-15);
    }
}
