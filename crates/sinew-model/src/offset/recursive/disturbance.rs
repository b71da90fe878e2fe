//! What is done when blocks no longer fit: a slip, a load, a failed strand, a contact that lasts.

use super::checkpoints::Checkpoints;
use super::filter::Filter;
use super::workspace::dimension;
use super::{RecursiveOffsets, SEGMENT, Stage};
use crate::offset::belief::Belief;
use crate::offset::mixture::LOST_STIFFNESS;
use crate::offset::parameter::{JointParameter, PAYLOAD};

/// How far an offset may jump, rad, a standard deviation: a starting guess. Slips of 5 mrad were tried.
const JUMP_RAD: f64 = 10e-3;
/// Every so many attempts the challenger begins from before the first block.
const FROM_THE_START: usize = 3;
/// What doesn't jump can't move further from what was known, standard deviations.
const FAR: f64 = 5.0;
/// For so many blocks after something was settled what goes in is held against its mean, a minute. With contacts about, it is off by as much
/// now and then: so not for ever.
const WATCHED: usize = 300;

impl RecursiveOffsets {
    /// Whether the incumbent no longer agrees with the blocks, or only because it has moved what doesn't jump.
    pub(super) fn is_disturbed(&self) -> bool {
        let before = (self.checkpoints.older().belief(), 0.0);
        self.incumbent.is_inconsistent()
            || (self.is_watched() && self.incumbent.is_biased())
            || self.contradicts(&self.incumbent, before)
    }

    /// Whether the incumbent agrees with most blocks of late.
    pub(super) fn agrees(&self) -> bool {
        self.incumbent.is_consistent() && (!self.is_watched() || self.incumbent.is_unbiased())
    }

    /// Whether something was settled within the last minute: offsets, stiffness and payload are open since then, and what comes next
    /// would go in as any of these.
    pub(super) fn is_watched(&self) -> bool {
        self.ring.taken() < self.watched
    }

    /// What is known now explains what disturbed what was known before.
    pub(super) fn settle(&mut self) {
        self.watched = self.ring.taken() + WATCHED;
    }

    /// Whether the challenger doesn't agree with its blocks, or only because it has moved what doesn't jump.
    pub(super) fn challenger_fails(&self) -> bool {
        self.challenger.is_inconsistent()
            || self.challenger.is_biased()
            || self.contradicts(&self.challenger, self.basis())
    }

    /// Whether the challenger agrees with its blocks, and has moved nothing that doesn't jump.
    pub(super) fn challenger_fits(&self) -> bool {
        self.challenger.is_consistent()
            && self.challenger.is_unbiased()
            && !self.contradicts(&self.challenger, self.basis())
    }

    /// Whether stiffness or how fast ropes creep has moved further from what was known `before` than it can have: a filter that takes in
    /// what it can't explain moves these. One that isn't finite any more contradicts all.
    ///
    /// * `softer`: what compliances were opened by since, a standard deviation.
    fn contradicts(&self, filter: &Filter, (before, softer): (&Belief, f64)) -> bool {
        let layout = self.model.reduced.layout;
        let elastic = || (0..layout.joints).filter(|&i| self.model.reduced.is_elastic(i));
        let compliances = elastic().map(|i| layout.place(i, JointParameter::Compliance));
        let rates = dimension(&self.model, 0)..before.mean.len();
        let compliances = compliances.map(|place| (place, softer));
        let moved = compliances
            .chain(rates.map(|place| (place, 0.0)))
            .any(|(place, opened)| {
                let (now, before) = (filter.belief().entry(place), before.entry(place));
                (now.mean - before.mean).abs() > FAR * libm::hypot(before.deviation, opened)
            });
        let mut offsets = elastic().map(|i| filter.entry(layout.place(i, JointParameter::Offset)));
        moved || offsets.any(|offset| !(offset.mean + offset.deviation).is_finite())
    }

    /// The incumbent was disturbed: what went in of late may be wrong, and nothing more goes in until that is settled. O(d²).
    pub(super) fn go_back(&mut self) {
        (self.checkpoints).go_back(&mut self.incumbent, self.ring.taken());
        self.incumbent.hold(true);
        self.attempts = 0;
    }

    /// What the incumbent knows is kept, for when it is disturbed. O(d²).
    pub(super) fn keep(&mut self) {
        self.checkpoints.keep(&self.incumbent, self.ring.taken());
    }

    /// Whether what is known is to be kept after this block.
    pub(super) fn is_to_be_kept(&self) -> bool {
        self.opened && Checkpoints::is_due(self.ring.taken()) && self.agrees()
    }

    /// Whatever was amiss is settled.
    pub(super) fn rest(&mut self) {
        self.stage = Stage::Idle;
        for filter in [&mut self.incumbent, &mut self.challenger] {
            filter.hold(false);
        }
    }

    /// The challenger will begin when there are enough blocks from after the disturbance.
    pub(super) fn await_segment(&mut self) {
        /// Blocks from after it.
        const AFTER: usize = 20;
        self.seen = self.ring.taken();
        self.stage = Stage::Waiting {
            until: self.ring.taken() + AFTER,
        };
    }

    /// The challenger begins with the last blocks. O(d²).
    pub(super) fn begin_replay(&mut self) {
        let taken = self.ring.taken();
        let last = taken.checked_sub(1);
        let last = last.and_then(|number| self.ring.get(number));
        let at_s = last.map_or(f64::NAN, |(_, kept)| kept.block.time_s);
        self.attempts += 1;
        self.from = taken.saturating_sub(SEGMENT);
        (self.challenger).restart(&self.start, &self.start_noise, at_s);
        if self.goes_on() {
            // None from before what was seen.
            self.from = self.from.max(self.seen);
            self.challenger.know_as(self.checkpoints.older());
            self.challenger.refer_to(at_s);
        }
        self.begin_pass();
        self.stage = Stage::Replaying {
            pass: 0,
            to: taken,
            at: self.from,
        };
    }

    /// A pass of the challenger begins. O(d²).
    pub(super) fn begin_pass(&mut self) {
        if self.goes_on() {
            let before = self.checkpoints.older().belief();
            self.challenger.begin_pass(before);
            let payload = self.model.reduced.layout.payload_place();
            let payload = payload..payload + PAYLOAD;
            let softer = (self.stiffness.compliances(), LOST_STIFFNESS.deviation);
            (self.challenger).open((&self.start, payload), JUMP_RAD, softer);
        } else {
            self.challenger.begin_pass(&self.start);
        }
    }

    /// Whether the challenger goes on from what was known before the disturbance, with offsets, stiffness and payload opened; else it
    /// begins from what was known before the first block.
    pub(super) fn goes_on(&self) -> bool {
        self.opened && !self.attempts.is_multiple_of(FROM_THE_START)
    }

    /// What the challenger's blocks are added to, and what compliances are opened by there.
    fn basis(&self) -> (&Belief, f64) {
        match self.goes_on() {
            true => (self.checkpoints.older().belief(), LOST_STIFFNESS.deviation),
            false => (&self.start, 0.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::belief::{Payload, UNKNOWN_OFFSET_RAD};
    use crate::offset::external_force::ExternalForce;
    use crate::offset::fixtures::{pushable, pushed};

    #[test]
    fn a_state_that_is_not_finite_is_in_doubt_and_what_was_known_before_is_taken_up() {
        let model = pushable(ExternalForce::possible(2.0).unwrap());
        let belief = model.prior.belief(Payload::Empty, UNKNOWN_OFFSET_RAD);
        let mut filter = RecursiveOffsets::of(model.clone(), belief).unwrap();
        let mut blocks = pushed(&model, [0.0; 3], 1);
        for seed in [101, 201] {
            let later_s = blocks.len() as f64;
            blocks.extend(pushed(&model, [0.0; 3], seed).into_iter().map(|mut block| {
                block.time_s += later_s;
                block
            }));
        }
        let (first, then) = blocks.split_at(blocks.len() * 2 / 3);
        for block in first {
            filter.step(block).unwrap();
        }
        assert!(!filter.is_provisional());
        let before = filter.offset(0);
        filter.incumbent.belief_mut().covariance.fill(f64::NAN);
        for (k, block) in then.iter().enumerate() {
            filter.step(block).unwrap();
            let told = filter.offset(0);
            let is_finite = (told.mean + told.deviation).is_finite();
            assert!(is_finite || filter.is_provisional(), "block {k}: {told:?}");
        }
        let after = filter.offset(0);
        assert!(!filter.is_provisional());
        assert!(
            (after.mean - before.mean).abs() < 4.0 * before.deviation,
            "{before:?} {after:?}"
        );
    }
}
