//! Request of a tensioning plan, and procedures to precondition a rope.

use crate::law::routing::{self, Pulley, RoutingError};
use crate::law::strung::{Piece, Strand};
use crate::law::{Law, LoadError, RopeLoad, State, damage};
use serde::{Deserialize, Serialize};
use sinew_model::Bounded;

/// Mounting of a rope, apart from its length.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mount {
    /// Series compliance of each strand (frame, spring, mounts), m/N.
    pub series_compliance_m_per_n: f64,
    /// Guiding pulleys that the rope lies on, at rest.
    pub pulleys: Vec<Pulley>,
    /// Joint with a second, equal rope in the opposite direction; `None`: one rope between two terminations.
    pub joint: Option<HeldJoint>,
}

/// Joint with its motor held while its two ropes relax.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HeldJoint {
    /// Radius of the joint pulley, m.
    pub radius_m: f64,
    /// Torque of the joint meanwhile, N·m, at least 0.
    pub torque_nm: f64,
    /// Whether the joint is prismatic: its torque is then a force, N, and the pulley radius the rope travel
    /// per metre.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub slides: bool,
}

/// Series compliance apart from the rope, for a joint of stiffness `K` with `strands` taut strands:
/// `c = n r²/K − (dℓ/dT of the rope)`, m/N, at least 0.
///
/// # Errors
/// Returns [`LoadError`] if the load is invalid.
pub fn series_compliance_m_per_n(
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
    /// Additional tension of the loaded strand relative to the other, N.
    pub(super) fn extra_n(&self) -> f64 {
        self.joint.map_or(0.0, |j| j.torque_nm / j.radius_m)
    }

    /// Pieces of a strand of a new rope of diameter `rope_m`, m, at `tension_n`, N.
    pub(super) fn pieces(
        &self,
        law: &Law,
        length_m: f64,
        rope_m: Option<f64>,
        tension_n: f64,
    ) -> Result<Vec<Piece>, RoutingError> {
        let pulleys = &self.pulleys;
        let portions = routing::portions(length_m, 0.0, pulleys)?;
        let piece = |p: routing::RopeSection| Piece {
            law: law.passed_by(damage::passes(law, &p, pulleys, 0.0, rope_m, tension_n)),
            length_m: p.length_m,
            state: State::default(),
        };
        Ok(portions.into_iter().map(piece).collect())
    }

    /// Strands of equal ropes, with the loaded one first.
    pub(super) fn strands(&self, pieces: Vec<Piece>) -> Vec<Strand> {
        let first = Strand {
            pieces,
            series_compliance_m_per_n: self.series_compliance_m_per_n,
            extra_n: self.extra_n(),
        };
        let partner = self.joint.map(|_| Strand {
            extra_n: 0.0,
            ..first.clone()
        });
        [Some(first), partner].into_iter().flatten().collect()
    }
}

/// Request of a tensioning plan.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// Working tension, N; with a partner, the mean of both.
    pub tension_n: f64,
    /// Temperature of the rope, °C.
    pub temperature_c: f64,
    /// Length of the strand, m.
    pub length_m: f64,
    /// Mounting of the rope.
    pub mount: Mount,
    /// Horizon of the plan, s.
    pub horizon_s: f64,
    /// Tension below which the rope is re-tensioned, N.
    pub lowest_n: f64,
    /// Share of the later elongation that the procedure must remove, 0 to 1.
    pub remove: f64,
    /// Number of draws for the intervals.
    pub draws: usize,
    /// Seed of the draws.
    pub seed: u64,
}

/// Preconditioning procedure and its effect.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Procedure {
    /// Tension of the procedure, N.
    pub tension_n: f64,
    /// Duration of the procedure, s.
    pub duration_s: f64,
    /// Largest remaining elongation at working tension, m, counted from one minute after the return to
    /// working tension.
    pub remaining_m: Bounded,
    /// Share of the elongation without procedure that it removes.
    pub removed_share: Bounded,
}
