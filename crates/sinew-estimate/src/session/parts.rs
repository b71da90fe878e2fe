//! Result of a long recording from those of its parts.
//!
//! Every part of a session starts at its baseline, and its offsets refer to it. The parts of a baseline start from the
//! posterior of the part before. What refers to the time of a part alone is joined here.

use super::poses::{MIN_BASELINE_POSES, MIN_POSES, Poses};
use super::recorder::Recorded;
use super::result::{
    BlockEstimate, SessionEstimate, TendonChange, TendonChangeKind, TendonCreep, TendonEstimate,
};
use super::warning::Warning;
use crate::decimated::Decimated;
use sinew_model::Gaussian;

/// Maximum number of rejected intervals in a result.
const MAX_REJECTED: usize = 20;

/// Results of the parts of a recording so far.
#[derive(Debug, Default)]
pub(super) struct Parts {
    whole: Option<SessionEstimate>,
    poses: Option<Poses>,
    /// Estimates of the blocks, fewer than one per block in a recording of many hours.
    blocks: Decimated<BlockEstimate>,
    /// Number of blocks.
    count: usize,
    /// Temperature times number of blocks, °C.
    temperature_sum_c: f64,
}

impl Parts {
    /// Adds the result of the next part, except for the estimates of its blocks, which are moved.
    pub(super) fn add(&mut self, recorded: &Recorded, part: &mut SessionEstimate) {
        let count = recorded.blocks.len();
        for block in std::mem::take(&mut part.blocks) {
            self.blocks.push(block);
        }
        let axes = recorded.blocks.first().map_or(0, |block| block.q.len());
        let poses = self.poses.get_or_insert_with(|| Poses::new(axes));
        recorded
            .blocks
            .iter()
            .for_each(|block| poses.push(&block.q));
        self.temperature_sum_c += part.temperature_c.unwrap_or(f64::NAN) * count as f64;
        let all = self.count + count;
        let mut part = part.clone();
        if let Some(before) = self.whole.take() {
            let temperature_c = self.temperature_sum_c / all.max(1) as f64;
            part.temperature_c = temperature_c.is_finite().then_some(temperature_c);
            let weights = [self.count, count].map(|n| n as f64 / all.max(1) as f64);
            join(before, &mut part, weights, poses.count());
        }
        self.count = all;
        self.whole = Some(part);
    }

    /// Returns the result of the whole recording; `None` if it has no part.
    pub(super) fn finish(self) -> Option<SessionEstimate> {
        let blocks = self.blocks.into_vec();
        self.whole.map(|whole| SessionEstimate { blocks, ..whole })
    }
}

/// Joins the result of `part` with that of the recording `before` it. `weights`: shares of both in the number of blocks.
fn join(before: SessionEstimate, part: &mut SessionEstimate, weights: [f64; 2], poses: usize) {
    part.start_time_utc_s = before.start_time_utc_s;
    part.duration_s += before.duration_s;
    let duration_s = part.duration_s;
    for joint in &mut part.joints {
        if let Some(earlier) = before.joints.iter().find(|own| own.name == joint.name) {
            join_tendon(earlier, joint, duration_s, weights);
        }
    }
    part.segments.splice(..0, before.segments);
    part.payload_changes.splice(..0, before.payload_changes);
    part.external_force = [before.external_force, part.external_force.take()]
        .into_iter()
        .flatten()
        .max_by(|a, b| a.probability.total_cmp(&b.probability));
    part.tension_used |= before.tension_used;
    part.rejected_share = weights[0] * before.rejected_share + weights[1] * part.rejected_share;
    let rejected = &mut part.rejected_intervals;
    rejected.extend(before.rejected_intervals);
    rejected.sort_by(|a, b| (b.to_s - b.from_s).total_cmp(&(a.to_s - a.from_s)));
    rejected.truncate(MAX_REJECTED);
    part.poses = poses;
    part.damaged |= before.damaged;
    join_warnings(before.warnings, &mut part.warnings, poses);
}

/// Joins the result of a tendon with that of the earlier parts.
fn join_tendon(
    before: &TendonEstimate,
    part: &mut TendonEstimate,
    duration_s: f64,
    weights: [f64; 2],
) {
    let lost = |change: &TendonChange| change.kind == TendonChangeKind::TransmissionLost;
    let was_lost = before.changes.iter().any(lost);
    part.changes.retain(|change| !(was_lost && lost(change)));
    // A difference of the stiffness from that of the baseline is the one that an earlier part has already reported.
    let is_of_stiffness = |change: &TendonChange| {
        matches!(
            change.kind,
            TendonChangeKind::StiffnessLoss | TendonChangeKind::StiffnessIncrease
        )
    };
    let was_changed = before
        .changes
        .iter()
        .any(|change| is_of_stiffness(change) || change.stiffness_change_ratio.is_some());
    part.changes
        .retain(|change| !(was_changed && is_of_stiffness(change)));
    part.changes.splice(..0, before.changes.iter().cloned());
    part.creep = match (before.creep, part.creep) {
        (None, None) => None,
        (a, b) => {
            let none = Gaussian::new(0.0, 0.0);
            let drift = |creep: Option<TendonCreep>| creep.map_or(none, |creep| creep.drift_rad);
            let probabilities = [a, b].into_iter().flatten().map(|creep| creep.probability);
            let drift_rad = drift(a).plus(drift(b));
            Some(TendonCreep {
                probability: probabilities.fold(0.0, f64::max),
                drift_rad,
                rate_rad_per_s: drift_rad.scaled(1.0 / duration_s),
            })
        }
    };
    part.torque_nm.min = part.torque_nm.min.min(before.torque_nm.min);
    part.torque_nm.max = part.torque_nm.max.max(before.torque_nm.max);
    part.noise_rad = part.noise_rad.max(before.noise_rad);
    part.slack_share = match (before.slack_share, part.slack_share) {
        (None, None) => None,
        (a, b) => Some(weights[0] * a.unwrap_or(0.0) + weights[1] * b.unwrap_or(0.0)),
    };
}

/// Joins the warnings of a part with those of the earlier parts.
fn join_warnings(before: Vec<Warning>, part: &mut Vec<Warning>, poses: usize) {
    /// Part of a recording to which a warning refers.
    enum Extent {
        /// End of the recording.
        End,
        /// Whole recording: every part has the warning.
        Whole,
        /// Any part of the recording.
        Any,
    }
    let extent = |warning: &Warning| match warning {
        Warning::ChangeNearEnd { .. }
        | Warning::AtRestAtEnd { .. }
        | Warning::RestPhaseInconsistent { .. }
        | Warning::ReferenceInconsistent { .. }
        | Warning::TemperatureUnknown { .. }
        | Warning::ThermalEffect { .. }
        | Warning::FarFromPrior { .. }
        | Warning::StiffnessChanged { .. }
        | Warning::NegativePayload { .. }
        | Warning::EncoderDelay { .. } => Extent::End,
        Warning::FewPoses { .. }
        | Warning::FewPosesOfBaseline { .. }
        | Warning::TorqueRangeSmall { .. } => Extent::Whole,
        _ => Extent::Any,
    };
    let is_same = |a: &Warning, b: &Warning| {
        std::mem::discriminant(a) == std::mem::discriminant(b) && a.joint() == b.joint()
    };
    part.retain(|own| match extent(own) {
        Extent::Whole => before.iter().any(|earlier| is_same(own, earlier)),
        Extent::End | Extent::Any => true,
    });
    for earlier in before {
        let is_present = part.iter().any(|own| is_same(own, &earlier));
        if matches!(extent(&earlier), Extent::Any) && !is_present {
            part.push(earlier);
        }
    }
    part.retain_mut(|warning| match warning {
        Warning::FewPoses { poses: own } => {
            *own = poses;
            poses < MIN_POSES
        }
        Warning::FewPosesOfBaseline { poses: own } => {
            *own = poses;
            poses < MIN_BASELINE_POSES
        }
        _ => true,
    });
}
