//! What is asked of a plan, and a way to bed a rope in.

use crate::law::routing::{self, Pulley, RoutingError};
use crate::law::strung::{Piece, Strand};
use crate::law::{Law, LoadError, RopeLoad, State, damage};
use serde::{Deserialize, Serialize};
use sinew_model::Bounded;

/// How a rope is mounted, besides its length.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mount {
    /// What gives in series with each strand (frame, spring, mounts), m/N.
    pub give_m_per_n: f64,
    /// Guiding pulleys it lies on, at rest.
    pub pulleys: Vec<Pulley>,
    /// The joint that a second, equal rope pulls the other way; `None`: one rope between two ends.
    pub joint: Option<HeldJoint>,
}

/// A joint whose motor is held while its two ropes relax.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HeldJoint {
    /// Radius of the pulley at the joint, m.
    pub radius_m: f64,
    /// Torque that the joint holds, N·m, at least 0.
    pub torque_nm: f64,
    /// Whether it slides: its torque is a force then, N, and its pulley's radius the rope's travel per metre.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub slides: bool,
}

/// What gives beside the rope where a joint of stiffness `K` hangs on `strands` taut strands:
/// `c = n r²/K − (dℓ/dT of the rope)`, m/N, at least 0.
///
/// # Errors
/// [`LoadError`].
pub fn give_beside_rope(
    law: &Law,
    load: RopeLoad,
    length_m: f64,
    radius_m: f64,
    stiffness_nm_per_rad: f64,
    strands: f64,
) -> Result<f64, LoadError> {
    let all = strands * radius_m * radius_m / stiffness_nm_per_rad;
    let rope = 0.01 * length_m * law.compliance_percent_per_n(load)?;
    Ok((all - rope).max(0.0))
}

impl Mount {
    /// What the strand that holds the load pulls beyond the other, N.
    pub(super) fn extra_n(&self) -> f64 {
        self.joint.map_or(0.0, |j| j.torque_nm / j.radius_m)
    }

    /// A strand of a new rope of diameter `rope_m`, piece by piece.
    pub(super) fn pieces(
        &self,
        law: &Law,
        length_m: f64,
        rope_m: Option<f64>,
    ) -> Result<Vec<Piece>, RoutingError> {
        let portions = routing::portions(length_m, 0.0, &self.pulleys)?;
        let piece = |p: routing::Portion| Piece {
            law: law.passed_by(damage::passes(&p, &self.pulleys, 0.0, rope_m)),
            length_m: p.length_m,
            state: State::default(),
        };
        Ok(portions.into_iter().map(piece).collect())
    }

    /// The strands of equal ropes, the one that holds the load first.
    pub(super) fn strands(&self, pieces: Vec<Piece>) -> Vec<Strand> {
        let first = Strand {
            pieces,
            give_m_per_n: self.give_m_per_n,
            extra_n: self.extra_n(),
        };
        let partner = self.joint.map(|_| Strand {
            extra_n: 0.0,
            ..first.clone()
        });
        [Some(first), partner].into_iter().flatten().collect()
    }
}

/// What is asked.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// Working tension, N; with a partner, the mean of both.
    pub tension_n: f64,
    /// Temperature, °C.
    pub temperature_c: f64,
    /// Strand length, m.
    pub length_m: f64,
    /// How it is mounted.
    pub mount: Mount,
    /// How long it must hold, s.
    pub horizon_s: f64,
    /// Tension below which the rope is tensioned again, N.
    pub lowest_n: f64,
    /// Share of the later elongation that the procedure must take away, 0 to 1.
    pub remove: f64,
    /// Draws for the intervals.
    pub draws: usize,
    /// Seed of the draws.
    pub seed: u64,
}

/// A bedding-in procedure and what it does.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Procedure {
    /// Held at this tension, N.
    pub tension_n: f64,
    /// For this long, s.
    pub duration_s: f64,
    /// Largest elongation at working tension that is still to come, m, counted from a minute
    /// after the rope is back at working tension.
    pub still_to_come_m: Bounded,
    /// Share of the elongation without procedure that it takes away.
    pub removed_share: Bounded,
}
