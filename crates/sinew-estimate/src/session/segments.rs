//! Estimation of a recording in segments; the posterior of each segment is the prior of the next.

use super::encoder_slips::encoder_slips;
use super::late_step::LateStep;
use super::recorder::Recorded;
use crate::anchored::{self, ReferenceMeasurement};
use crate::error::SessionError;
use sinew_model::offset::excess_residual::tempered;
use sinew_model::offset::{
    Block, ChangeKind, MapError, MapEstimate, MapEstimator, ModelError, Payload, Prior,
    SearchScope, SharedError, StateEstimate, shared_errors,
};
use sinew_model::robot::Robot;
use std::borrow::Cow;

/// Length of the segments of a long recording, s.
const SEGMENT_S: f64 = 120.0;

/// Blocks with their number of visits; a copy if any motion is repeated.
pub(super) fn visited<'a>(blocks: &'a [Block], visits: Option<&[f64]>) -> Cow<'a, [Block]> {
    let Some(visits) = visits.filter(|visits| visits.iter().any(|v| *v > 1.0)) else {
        return Cow::Borrowed(blocks);
    };
    let counted = blocks.iter().zip(visits).map(|(block, visits)| Block {
        visits: *visits,
        ..block.clone()
    });
    Cow::Owned(counted.collect())
}

/// Estimates of the segments of a recording.
pub(super) struct Segments {
    /// Prior of the recording.
    pub(super) before: StateEstimate,
    /// Prior of the first of these segments: that of the recording, or the posterior of its part before.
    start: StateEstimate,
    /// Posterior of the last segment.
    pub(super) state_estimate: StateEstimate,
    /// Estimate of each segment, with the index of its first block.
    pub(super) estimates: Vec<(usize, MapEstimate)>,
    /// Most probable step change in the last seconds; `None` if they were not checked, or no step is probable.
    pub(super) step: Option<LateStep>,
}

/// State of the estimate of a recording after one of its parts.
#[derive(Debug, Clone)]
pub(super) struct Chained {
    /// Prior of the first part.
    origin: StateEstimate,
    /// Posterior of the last part.
    pub(super) state_estimate: StateEstimate,
    /// Largest noise of the link equation of every joint, rad.
    noise_rad: Vec<f64>,
    /// Reference measurements so far.
    pub(super) touched: Vec<ReferenceMeasurement>,
}

impl Chained {
    /// Posterior after the recording, tempered by the excess residual.
    pub(super) fn learned(&self, prior: &Prior) -> StateEstimate {
        let after = self.state_estimate.clone();
        tempered(prior, &self.origin, after, &self.noise_rad)
    }
}

impl Segments {
    /// Estimates all segments in order. `visits` is the number of visits of the motion in each block; empty if not
    /// counted.
    pub(super) fn estimate(
        (robot, estimator): (&Robot, &MapEstimator),
        start: StateEstimate,
        recorded: &Recorded,
        visits: &[f64],
        payload: Payload,
        scope: SearchScope,
        name: &str,
    ) -> Result<Self, SessionError> {
        let failed = |error: MapError| SessionError::Map {
            file: name.into(),
            error,
        };
        let blocks = &recorded.blocks;
        let mut state_estimate = start.clone();
        let mut estimates = Vec::new();
        let mut from = 0;
        while from < blocks.len() {
            // The last segment is never short: a remainder is joined to the previous one.
            let end_s = blocks[from].time_s + SEGMENT_S;
            let mut to = from + blocks[from..].partition_point(|b| b.time_s < end_s);
            if blocks
                .last()
                .is_some_and(|b| b.time_s < end_s + 0.5 * SEGMENT_S)
            {
                to = blocks.len();
            }
            let scope = SearchScope {
                continues: scope.continues || from > 0,
                ..scope
            };
            let mut map = estimator
                .search(
                    &state_estimate,
                    &visited(&blocks[from..to], visits.get(from..to)),
                    payload,
                    scope,
                )
                .map_err(failed)?;
            map.encoder_slips = encoder_slips(robot, estimator.prior(), recorded, &map);
            state_estimate = map.state_estimate(estimator.prior());
            estimates.push((from, map));
            from = to;
        }
        if estimates.is_empty() {
            return Err(failed(MapError::NoData));
        }
        Ok(Self {
            before: start.clone(),
            start,
            state_estimate,
            estimates,
            step: None,
        })
    }

    /// Estimates the last segment again, with another `scope`.
    pub(super) fn estimate_last(
        &mut self,
        (robot, estimator): (&Robot, &MapEstimator),
        recorded: &Recorded,
        visits: &[f64],
        payload: Payload,
        scope: SearchScope,
    ) -> Result<(), MapError> {
        let start = self.before_last(estimator.prior());
        let Some((from, last)) = self.estimates.last_mut() else {
            return Ok(());
        };
        let scope = SearchScope {
            continues: scope.continues || *from > 0,
            ..scope
        };
        let blocks = visited(&recorded.blocks[*from..], visits.get(*from..));
        *last = estimator.search(&start, &blocks, payload, scope)?;
        last.encoder_slips = encoder_slips(robot, estimator.prior(), recorded, last);
        self.state_estimate = last.state_estimate(estimator.prior());
        Ok(())
    }

    /// Whether an encoder of a joint slipped.
    pub(super) fn has_encoder_slip(&self, joint: usize) -> bool {
        let mut slips = self
            .estimates
            .iter()
            .flat_map(|(_, map)| &map.encoder_slips);
        slips.any(|slip| slip.kind == ChangeKind::Offset(joint))
    }

    /// Prior of the last segment.
    pub(super) fn before_last(&self, prior: &Prior) -> StateEstimate {
        let before = self.estimates.iter().rev().nth(1);
        before.map_or_else(|| self.start.clone(), |(_, map)| map.state_estimate(prior))
    }

    /// Residuals of the link equations of all blocks, rad; one per joint and block, grouped by block.
    pub(super) fn residuals(&self, estimator: &MapEstimator, blocks: &[Block]) -> Vec<f64> {
        let of = |(from, map): &(usize, MapEstimate)| {
            let own = blocks.get(*from..*from + map.weights.len());
            estimator.residuals(map, own.unwrap_or_default())
        };
        self.estimates.iter().flat_map(of).collect()
    }

    /// Systematic error of each joint that originates from `baseline`, the state estimate before its offset variances
    /// were reset.
    pub(super) fn shared_errors(
        &self,
        prior: &Prior,
        baseline: &StateEstimate,
        continues: bool,
        name: &str,
    ) -> Result<Vec<SharedError>, SessionError> {
        shared_errors(
            prior,
            baseline,
            &self.before,
            &self.state_estimate,
            continues,
        )
        .map_err(|error| SessionError::Map {
            file: name.into(),
            error,
        })
    }

    /// State of the chain after these segments, which follow those of `before` in the same recording; `touched`:
    /// reference measurements in these segments.
    pub(super) fn chained(
        &self,
        before: Option<&Chained>,
        mut touched: Vec<ReferenceMeasurement>,
    ) -> Chained {
        let mut noise_rad = before.map_or_else(Vec::new, |before| before.noise_rad.clone());
        for (_, map) in &self.estimates {
            noise_rad.resize(map.noise_rad.len(), 0.0);
            let pairs = noise_rad.iter_mut().zip(&map.noise_rad);
            pairs.for_each(|(most, own)| *most = most.max(*own));
        }
        if let Some(before) = before {
            anchored::keep(&mut touched, &before.touched);
        }
        Chained {
            origin: self.before.clone(),
            state_estimate: self.state_estimate.clone(),
            noise_rad,
            touched,
        }
    }

    /// Model error of all segments, for the evidence about causes in later recordings.
    pub(super) fn model_error(
        &self,
        estimator: &MapEstimator,
        blocks: &[Block],
    ) -> Result<Option<ModelError>, MapError> {
        let Some((_, last)) = self.estimates.last() else {
            return Ok(None);
        };
        let weights = (self.estimates.iter()).flat_map(|(_, map)| map.weights.iter().copied());
        let whole = MapEstimate {
            weights: weights.collect(),
            ..last.clone()
        };
        estimator
            .model_error(&self.before, &whole, blocks)
            .map(Some)
    }

    /// Refers the results to the prior of the recording, of which `before` is the state after the part before.
    pub(super) fn follow(&mut self, before: &Chained) {
        self.before.clone_from(&before.origin);
    }

    /// Noise of the link (rad) and motor (N·m) equations in the last segment, per joint.
    pub(super) fn noise(&self) -> [Vec<f64>; 2] {
        let last = self.estimates.last();
        last.map_or_else(Default::default, |(_, map)| {
            [map.noise_rad.clone(), map.motor_noise_nm.clone()]
        })
    }
}
