//! Effect of a tendon on a joint: kind of the tendon, moment arm, and the spring of the joint.
//!
//! [`crate::tendons`] has the equations.

use alloc::vec::Vec;

/// Way in which a tendon pulls.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub enum TendonKind {
    /// Closed loop of two pretensioned strands, which pulls both ways: `f = k x`.
    Loop,
    /// Single strand, which only pulls: `f = max(0, f0 + k x)`.
    Strand,
}

/// Passive spring of a joint, `tau_spring = k_s (q − q_rest)`.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct JointSpring {
    /// Stiffness `k_s`, N·m/rad, between 1e-9 and 1e12.
    pub stiffness_nm_per_rad: f64,
    /// Position `q_rest` without torque, rad.
    pub rest_rad: f64,
}

/// Moment arm `R_ij = ∂l_i/∂q_j` of a tendon at a joint; positive where tension drives the joint positively.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub enum MomentArm {
    /// Pulley: the same arm everywhere, per rad of the joint.
    Constant(f64),
    /// Path whose shortening is a table over the position of the joint.
    Table(ShorteningTable),
}

impl MomentArm {
    /// Shortening, moment arm and slope of the moment arm at the position `q`, rad.
    #[inline]
    pub(crate) fn evaluate(&self, q: f64) -> [f64; 3] {
        match self {
            Self::Constant(arm) => [arm * q, *arm, 0.0],
            Self::Table(table) => table.evaluate(q),
        }
    }

    /// Returns the moment arm in another coordinate, one unit of which equals `units` of the original.
    pub(crate) fn over(&self, units: f64) -> Self {
        match self {
            Self::Constant(arm) => Self::Constant(arm / units),
            Self::Table(table) => Self::Table(table.over(units)),
        }
    }
}

/// Reason why a table of shortenings is invalid.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// The two columns have different lengths, or the wrong number of rows.
    #[error(
        "a table needs between 4 and {max} rows with both values, found {positions} positions and {shortenings} shortenings",
        max = ShorteningTable::MAX_ROWS
    )]
    Rows {
        /// Number of positions.
        positions: usize,
        /// Number of shortenings.
        shortenings: usize,
    },
    /// A value is not finite, or its magnitude exceeds 1e6.
    #[error(
        "row {row} is ({q_rad} rad, {shortening}): both must be finite and at most 1e6 in size"
    )]
    Value {
        /// Row, counted from 0.
        row: usize,
        /// Position of the joint, rad.
        q_rad: f64,
        /// Shortening in the tendon's coordinate.
        shortening: f64,
    },
    /// A position does not exceed the position of the row before by at least 1e-6 rad.
    #[error(
        "row {row} has position {q_rad} rad: positions must increase by at least 1e-6 rad, sort the rows"
    )]
    Order {
        /// Row, counted from 0.
        row: usize,
        /// Position of the joint, rad.
        q_rad: f64,
    },
}

/// Shortening `l(q)` of a path over the position of one joint: a cubic spline with not-a-knot ends.
///
/// The moment arm is the derivative `dl/dq` of the spline, so that torque and energy agree. Outside the
/// table the shortening continues on a straight line, with a constant moment arm. The spline is shifted to `l(0) = 0`.
///
/// # Source
/// C. de Boor, *A Practical Guide to Splines*, chapter IV; second derivatives from a tridiagonal system.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct ShorteningTable {
    pieces: Vec<Piece>,
    end_rad: f64,
    /// Value of the spline at `q = 0` before the shift.
    reference: f64,
}

/// Cubic polynomial of one interval, in powers of `q − start_rad`.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
struct Piece {
    start_rad: f64,
    coefficients: [f64; 4],
}

impl ShorteningTable {
    /// Largest number of rows; a bound for the time to build a table.
    pub const MAX_ROWS: usize = 10_000;

    /// Interpolates a table.
    ///
    /// * `q_rad`: joint positions, rad, increasing; `shortening`: shortening at each of them, in the
    ///   tendon's coordinate (m or rad of the motor). Both have the same length, 4 to [`Self::MAX_ROWS`].
    ///
    /// # Errors
    /// Returns a [`TableError`] for lengths that differ or are out of range, values that are not finite, and
    /// positions that do not increase.
    pub fn new(q_rad: &[f64], shortening: &[f64]) -> Result<Self, TableError> {
        let n = q_rad.len();
        if shortening.len() != n || !(4..=Self::MAX_ROWS).contains(&n) {
            return Err(TableError::Rows {
                positions: n,
                shortenings: shortening.len(),
            });
        }
        for (row, (&q_rad, &shortening)) in q_rad.iter().zip(shortening).enumerate() {
            if !(q_rad.abs() <= 1e6 && shortening.abs() <= 1e6) {
                return Err(TableError::Value {
                    row,
                    q_rad,
                    shortening,
                });
            }
        }
        if let Some(before) = q_rad.windows(2).position(|q| !(q[1] - q[0] >= 1e-6)) {
            let row = before + 1;
            return Err(TableError::Order {
                row,
                q_rad: q_rad[row],
            });
        }
        let h: Vec<f64> = q_rad.windows(2).map(|q| q[1] - q[0]).collect();
        let slope: Vec<f64> = (shortening.windows(2).zip(&h))
            .map(|(l, h)| (l[1] - l[0]) / h)
            .collect();
        let c = second_derivatives(&h, &slope);
        let pieces = (0..n - 1)
            .map(|i| Piece {
                start_rad: q_rad[i],
                coefficients: [
                    shortening[i],
                    slope[i] - h[i] * (2.0 * c[i] + c[i + 1]) / 6.0,
                    c[i] / 2.0,
                    (c[i + 1] - c[i]) / (6.0 * h[i]),
                ],
            })
            .collect();
        let mut table = Self {
            pieces,
            end_rad: q_rad[n - 1],
            reference: 0.0,
        };
        table.reference = table.evaluate(0.0)[0];
        Ok(table)
    }

    /// Shortening `l`, moment arm `dl/dq` and its slope `d²l/dq²` at the position `q`, rad.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. One binary search over the rows.
    #[inline]
    pub fn evaluate(&self, q: f64) -> [f64; 3] {
        let start_rad = self.pieces.first().map_or(0.0, |piece| piece.start_rad);
        let inside = q.max(start_rad).min(self.end_rad);
        let after = self.pieces.partition_point(|p| p.start_rad <= inside);
        // A table has at least three pieces; the alternative only spares a panic.
        let Some(piece) = self.pieces.get(after.saturating_sub(1)) else {
            return [0.0; 3];
        };
        let (t, [a, b, c, d]) = (inside - piece.start_rad, piece.coefficients);
        let arm = b + t * (2.0 * c + t * 3.0 * d);
        let l = a + t * (b + t * (c + t * d)) - self.reference;
        if q == inside {
            [l, arm, 2.0 * c + 6.0 * d * t]
        } else {
            [l + arm * (q - inside), arm, 0.0]
        }
    }

    /// Returns the shortening in another coordinate, one unit of which equals `units` of the original.
    pub(crate) fn over(&self, units: f64) -> Self {
        let mut scaled = self.clone();
        scaled.reference /= units;
        let all = scaled.pieces.iter_mut();
        all.flat_map(|piece| &mut piece.coefficients)
            .for_each(|c| *c /= units);
        scaled
    }

    /// Whether the table covers the position `q`, rad, so that nothing is extrapolated.
    pub fn covers(&self, q: f64) -> bool {
        self.pieces.first().is_some_and(|p| q >= p.start_rad) && q <= self.end_rad
    }
}

/// Second derivatives at the knots: `h₋ M₋ + 2 (h₋ + h) M + h M₊ = 6 (slope − slope₋)` inside, and one cubic
/// over the first two intervals and over the last two (not-a-knot). Gaussian elimination without pivoting, since the
/// diagonal dominates.
fn second_derivatives(h: &[f64], slope: &[f64]) -> Vec<f64> {
    let n = h.len() + 1;
    let (mut diagonal, mut above, mut m) = (
        alloc::vec![0.0; n],
        alloc::vec![0.0; n],
        alloc::vec![0.0; n],
    );
    for i in 1..n - 1 {
        let (before, after) = (h[i - 1], h[i]);
        let (mut left, mut right) = (before, after);
        diagonal[i] = 2.0 * (before + after);
        // M₀ = (1 + h₀/h₁) M₁ − h₀/h₁ M₂, and the same at the other end.
        if i == 1 {
            diagonal[i] += before * (1.0 + before / after);
            right -= before * before / after;
            left = 0.0;
        }
        if i == n - 2 {
            diagonal[i] += after * (1.0 + after / before);
            left -= after * after / before;
            right = 0.0;
        }
        m[i] = 6.0 * (slope[i] - slope[i - 1]);
        if i > 1 {
            let factor = left / diagonal[i - 1];
            diagonal[i] -= factor * above[i - 1];
            m[i] -= factor * m[i - 1];
        }
        above[i] = right;
    }
    for i in (1..n - 1).rev() {
        m[i] = (m[i] - above[i] * m[i + 1]) / diagonal[i];
    }
    let (first, last) = (h[0] / h[1], h[n - 2] / h[n - 3]);
    m[0] = (1.0 + first) * m[1] - first * m[2];
    m[n - 1] = (1.0 + last) * m[n - 2] - last * m[n - 3];
    m
}
