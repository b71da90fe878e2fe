//! The last seconds of a recording: a contact that has not ended, or a step that lasts.
//!
//! The search for change points knows nothing of contacts that have not ended, so it accepts no change within the last five seconds.
//! The predictive check knows both hypotheses. Its posterior is that of the blocks before the last seconds: what a step or a contact did
//! to the estimate is not in it.

use super::detector::SuspectedStep;
use super::late_step::{LASTING_S, LateStep};
use super::predictive::{NEGLIGIBLE, PredictiveCheck};
use super::recorder::Recorded;
use super::segments::{Segments, visited};
use sinew_model::offset::{
    Block, ChangeKind, ChangePoint, MapError, MapEstimate, MapEstimator, Payload, SearchScope,
};

/// What the last seconds are estimated with.
pub(super) struct Given<'a> {
    pub(super) estimator: &'a MapEstimator,
    pub(super) recorded: &'a Recorded,
    /// How often the arm came by as in each block; empty where that isn't counted.
    pub(super) visits: &'a [f64],
    pub(super) payload: Payload,
    pub(super) scope: SearchScope,
}

impl Given<'_> {
    /// The check of the last seconds of `segments`, for blocks that come after them. Where they show a step that is no contact, the last
    /// segment is estimated again with a change point there; [`Segments::step`] is the step.
    pub(super) fn check_recent(
        &self,
        segments: &mut Segments,
    ) -> Result<PredictiveCheck, MapError> {
        let check = self.check(segments)?;
        segments.step = self.step(segments, &check)?;
        let lasts = |step: &LateStep| 1.0 - step.probability < NEGLIGIBLE;
        let Some(step) = segments.step.filter(lasts) else {
            return Ok(check);
        };
        // A change that the search has found near its edge is sought again, too: it may have come later than the edge.
        let scope = SearchScope {
            onset: Some(step.onset()),
            ..self.scope
        };
        segments.estimate_last(
            self.estimator,
            self.recorded,
            self.visits,
            self.payload,
            scope,
        )?;
        self.check(segments)
    }

    /// The check of the last seconds against the estimate of all.
    fn check(&self, segments: &Segments) -> Result<PredictiveCheck, MapError> {
        let (from, map) = segments.estimates.last().ok_or(MapError::NoData)?;
        Ok(self.checked(map, &self.recorded.blocks[*from..]))
    }

    /// The check of the last seconds of `blocks` against the posterior of the first of them.
    fn checked(&self, map: &MapEstimate, blocks: &[Block]) -> PredictiveCheck {
        let Self {
            estimator,
            recorded,
            ..
        } = *self;
        let own = &blocks[..map.weights.len()];
        let mut check = PredictiveCheck::new(estimator, map, own, &recorded.elastic);
        check.take(estimator, blocks, blocks.len() - self.before(blocks));
        check
    }

    /// Blocks before the last seconds.
    fn before(&self, blocks: &[Block]) -> usize {
        let end_s = self.recorded.end_s();
        blocks.partition_point(|b| end_s - b.time_s > LASTING_S)
    }

    /// The most probable step, by the posterior of the blocks before; `None`: nothing speaks for one, or there are too few of them.
    fn step(
        &self,
        segments: &Segments,
        check: &PredictiveCheck,
    ) -> Result<Option<LateStep>, MapError> {
        /// As many seconds of blocks tell one joint's noise from what happens.
        const LEAST_S: f64 = 5.0;
        let Some((from, map)) = segments.estimates.last() else {
            return Ok(None);
        };
        let blocks = &self.recorded.blocks[*from..];
        let before = self.before(blocks);
        let Some(last_s) = before.checked_sub(1).map(|last| blocks[last].time_s) else {
            return Ok(None);
        };
        let is_late = |c: &&ChangePoint| c.at_s > last_s && !matches!(c.kind, ChangeKind::Creep(_));
        let is_tendons =
            |c: &ChangePoint| matches!(c.kind, ChangeKind::Offset(_) | ChangeKind::Compliance(_));
        let found = map.changes.iter().filter(is_late).any(is_tendons);
        let is_suspected = |(_, step): (usize, SuspectedStep)| step.probability > NEGLIGIBLE;
        if last_s - blocks[0].time_s < LEAST_S
            || !(found || check.most_suspected().is_some_and(is_suspected))
        {
            return Ok(None);
        }
        let known = map.changes.iter().filter(|c| !is_late(c));
        let known: Vec<ChangePoint> = known.copied().collect();
        let start = segments.before_last(self.estimator.prior());
        let own = visited(&blocks[..before], self.visits.get(*from..*from + before));
        let map = self.estimator.solve(&start, &known, self.payload, &own)?;
        let found = self.checked(&map, blocks).most_suspected();
        Ok(found.map(|(k, step)| LateStep {
            joint: self.recorded.elastic[k],
            since_s: step.since_s,
            probability: step.probability,
        }))
    }
}
