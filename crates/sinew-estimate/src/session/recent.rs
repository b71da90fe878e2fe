//! Last seconds of a recording: distinction of a contact that has not ended from a permanent step.
//!
//! The search for change points has no hypothesis of a contact that has not ended, so it accepts no change within the
//! last five seconds. The predictive check has both hypotheses. Its posterior is that of the blocks before the last
//! seconds, which a step or a contact there does not influence.

use super::detector::SuspectedStep;
use super::late_step::{LASTING_S, LateStep};
use super::predictive::{NEGLIGIBLE, PredictiveCheck};
use super::recorder::Recorded;
use super::segments::{Segments, visited};
use sinew_model::offset::{
    Block, ChangeKind, ChangePoint, MapError, MapEstimate, MapEstimator, Payload, SearchScope,
};

use sinew_model::robot::Robot;

/// Inputs of the check of the last seconds.
pub(super) struct RecentCheck<'a> {
    pub(super) robot: &'a Robot,
    pub(super) estimator: &'a MapEstimator,
    pub(super) recorded: &'a Recorded,
    /// Number of visits of the motion in each block; empty if not counted.
    pub(super) visits: &'a [f64],
    pub(super) payload: Payload,
    pub(super) scope: SearchScope,
}

impl RecentCheck<'_> {
    /// Checks the last seconds of `segments`, and returns the check for later blocks. If it finds a step that is not a
    /// contact, the last segment is estimated again with a change point there; [`Segments::step`] is the step.
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
        // A change that the search found near its limit is searched again too, because it may be later than the limit.
        let scope = SearchScope {
            onset: Some(step.onset()),
            ..self.scope
        };
        segments.estimate_last(
            (self.robot, self.estimator),
            self.recorded,
            self.visits,
            self.payload,
            scope,
        )?;
        self.check(segments)
    }

    /// Checks the last seconds against the estimate of the whole last segment.
    fn check(&self, segments: &Segments) -> Result<PredictiveCheck, MapError> {
        let (from, map) = segments.estimates.last().ok_or(MapError::NoData)?;
        Ok(self.check_against(map, &self.recorded.blocks[*from..]))
    }

    /// Checks the last seconds of `blocks` against `map`, the posterior of the first of them.
    fn check_against(&self, map: &MapEstimate, blocks: &[Block]) -> PredictiveCheck {
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

    /// Number of blocks before the last seconds.
    fn before(&self, blocks: &[Block]) -> usize {
        let end_s = self.recorded.end_s();
        blocks.partition_point(|b| end_s - b.time_s > LASTING_S)
    }

    /// Returns the most probable step by the posterior of the blocks before; `None` if none is probable, or if there
    /// are too few blocks.
    fn step(
        &self,
        segments: &Segments,
        check: &PredictiveCheck,
    ) -> Result<Option<LateStep>, MapError> {
        /// Minimum duration of the blocks before, s: shorter ones do not determine the noise of a joint.
        const MIN_DURATION_S: f64 = 5.0;
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
        if last_s - blocks[0].time_s < MIN_DURATION_S
            || !(found || check.most_suspected().is_some_and(is_suspected))
        {
            return Ok(None);
        }
        let earlier = map.changes.iter().filter(|c| !is_late(c));
        let earlier: Vec<ChangePoint> = earlier.copied().collect();
        let start = segments.before_last(self.estimator.prior());
        let own = visited(&blocks[..before], self.visits.get(*from..*from + before));
        let map = self.estimator.solve(&start, &earlier, self.payload, &own)?;
        let found = self.check_against(&map, blocks).most_suspected();
        Ok(found.map(|(k, step)| LateStep {
            joint: self.recorded.elastic[k],
            since_s: step.since_s,
            probability: step.probability,
        }))
    }
}
