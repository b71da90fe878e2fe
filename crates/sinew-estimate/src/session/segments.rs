//! A recording estimated segment by segment, each from what the last one left.

use super::late_step::LateStep;
use super::recorder::Recorded;
use crate::error::SessionError;
use sinew_model::offset::misfit::tempered;
use sinew_model::offset::{
    Belief, Block, MapError, MapEstimate, MapEstimator, Payload, Prior, SearchScope, SharedError,
    shared_errors,
};
use std::borrow::Cow;

/// Long recordings are estimated in segments of this length, s.
const SEGMENT_S: f64 = 120.0;

/// Blocks with their visits counted: a copy of a segment, where anything came again.
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

/// A recording estimated segment by segment.
pub(super) struct Segments {
    /// Before the first segment.
    pub(super) before: Belief,
    /// After the last.
    pub(super) belief: Belief,
    /// Estimate of every segment, with the index of its first block.
    pub(super) estimates: Vec<(usize, MapEstimate)>,
    /// The most probable step in the last seconds; `None`: they were not checked, or nothing speaks for one.
    pub(super) step: Option<LateStep>,
}

impl Segments {
    /// Estimates segment by segment. `visits`: how often the arm came by as in each block; empty where that isn't counted.
    pub(super) fn estimate(
        estimator: &MapEstimator,
        start: Belief,
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
        let mut belief = start.clone();
        let mut estimates = Vec::new();
        let mut from = 0;
        while from < blocks.len() {
            // The last segment is never a short one: what is left over joins the one before.
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
            let map = estimator
                .search(
                    &belief,
                    &visited(&blocks[from..to], visits.get(from..to)),
                    payload,
                    scope,
                )
                .map_err(failed)?;
            belief = map.belief(estimator.prior());
            estimates.push((from, map));
            from = to;
        }
        if estimates.is_empty() {
            return Err(failed(MapError::NoData));
        }
        Ok(Self {
            before: start,
            belief,
            estimates,
            step: None,
        })
    }

    /// Estimates the last segment again, with another `scope`.
    pub(super) fn estimate_last(
        &mut self,
        estimator: &MapEstimator,
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
        self.belief = last.belief(estimator.prior());
        Ok(())
    }

    /// Before the last segment.
    pub(super) fn before_last(&self, prior: &Prior) -> Belief {
        let before = self.estimates.iter().rev().nth(1);
        before.map_or_else(|| self.before.clone(), |(_, map)| map.belief(prior))
    }

    /// What the link equations of all blocks leave, as many a block as the arm has joints, rad.
    pub(super) fn residuals(&self, estimator: &MapEstimator, blocks: &[Block]) -> Vec<f64> {
        let of = |(from, map): &(usize, MapEstimate)| {
            let own = blocks.get(*from..*from + map.weights.len());
            estimator.residuals(map, own.unwrap_or_default())
        };
        self.estimates.iter().flat_map(of).collect()
    }

    /// What of every joint's error comes with `baseline`, as it was before its offsets were opened.
    pub(super) fn shared_errors(
        &self,
        prior: &Prior,
        baseline: &Belief,
        continues: bool,
        name: &str,
    ) -> Result<Vec<SharedError>, SessionError> {
        shared_errors(prior, baseline, &self.before, &self.belief, continues).map_err(|error| {
            SessionError::Map {
                file: name.into(),
                error,
            }
        })
    }

    /// What the recording taught, as far as it was understood.
    pub(super) fn learned(&self, prior: &Prior) -> Belief {
        let noise: Vec<f64> = (self.estimates.iter())
            .flat_map(|(_, map)| map.noise_rad.iter().copied())
            .collect();
        tempered(prior, &self.before, self.belief.clone(), &noise)
    }

    /// Noise of the last segment's link (rad) and motor (N·m) equations, per joint.
    pub(super) fn noise(&self) -> [Vec<f64>; 2] {
        let last = self.estimates.last();
        last.map_or_else(Default::default, |(_, map)| {
            [map.noise_rad.clone(), map.motor_noise_nm.clone()]
        })
    }
}
