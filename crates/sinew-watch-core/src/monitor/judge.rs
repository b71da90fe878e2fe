//! From what is known to alarms.

use super::Monitor;
use super::limits;
use crate::alarm::{AlarmCause, AlarmKey, Condition, Delays, JumpKind, StoreFault, Trouble};
use crate::instant::Instant;
use crate::journal::Event;
use crate::journal::SessionEnd;
use crate::transaction::Suspected;
use sinew_model::Gaussian;
use sinew_trend::{JointTrend, Limit, LimitState};
use std::collections::BTreeMap;

/// A limit that was near is no longer where it may be passed later than this share of the time.
const NEAR_NO_MORE: f64 = 1.5;

/// What is known of every condition: it holds, it doesn't, or is between raising and clearing.
#[derive(Debug, Default)]
pub(super) struct Conditions {
    known: BTreeMap<AlarmKey, (Option<bool>, AlarmCause)>,
}

impl Conditions {
    fn set(
        &mut self,
        joint: Option<&str>,
        condition: Condition,
        holds: Option<bool>,
        cause: AlarmCause,
    ) {
        let key = AlarmKey {
            joint: joint.map(str::to_string),
            condition,
        };
        self.known.insert(key, (holds, cause));
    }

    /// Nothing is known of a joint's conditions.
    pub(super) fn forget_joint(&mut self, joint: &str) {
        self.known
            .retain(|key, _| key.joint.as_deref() != Some(joint));
    }
}

impl Monitor {
    /// What the tendons' beliefs and trends say: after an estimate, a command, a start.
    pub(super) fn judge_beliefs(&mut self) {
        for i in 0..self.names.len() {
            self.judge_tendon(i);
        }
        self.judge_data();
    }

    fn judge_tendon(&mut self, i: usize) {
        let tendon = &self.belief.tendons[i];
        let joint = self.names[i].as_str();
        let transmission = self.robot.transmissions[self.elastic[i]].as_ref();
        let geometry = transmission.and_then(|t| t.tendon.as_ref());
        let clear_below = self.config.alarms.clear_below;
        let mut over = Vec::new();
        // Against the encoders' zero nobody can say how long a rope has become.
        let known = tendon.since.is_some() && self.belief.learns.is_none();
        if let (Some(geometry), Some(offset), true) = (geometry, tendon.last_rad, known) {
            let since = offset.scaled(geometry.joint_pulley_radius_m);
            let whole = tendon.before_m.plus(since).scaled(1.0 / geometry.length_m);
            let limits = self.limits[i];
            let both = [
                (Condition::RetensionLimit, limits.retension_m, since),
                (Condition::ReplaceLimit, limits.replace_ratio, whole),
            ];
            for (condition, limit, value) in both {
                match limit {
                    Some(limit) => {
                        let (holds, cause) = limits::passed(value, limit, clear_below);
                        self.conditions.set(Some(joint), condition, holds, cause);
                    }
                    // Taken out of the configuration: it can't be passed.
                    None => over.push(condition),
                }
            }
        }
        if let Some(suspected) = &tendon.suspected {
            let cause = jump_cause(suspected);
            self.conditions
                .set(Some(joint), Condition::Suspicion, Some(true), cause);
        } else {
            over.push(Condition::Suspicion);
        }
        let near_s = self.config.alarms.near_s;
        match self.trends.get(i).map(|made| near(&made.trend, near_s)) {
            Some(Some((holds, cause))) => {
                let joint = self.names[i].as_str();
                self.conditions
                    .set(Some(joint), Condition::LimitNear, holds, cause);
            }
            // No limit is ahead: none is stated, or it is passed.
            Some(None) => over.push(Condition::LimitNear),
            None => {}
        }
        for condition in over {
            self.over(i, condition);
        }
    }

    /// A condition of a tendon is over, if it was there.
    fn over(&mut self, tendon: usize, condition: Condition) {
        self.over_of(Some(self.names[tendon].clone()), condition);
    }

    /// A condition is over, if it was there.
    fn over_of(&mut self, joint: Option<String>, condition: Condition) {
        let key = AlarmKey { joint, condition };
        if let Some((holds, _)) = self.conditions.known.get_mut(&key) {
            *holds = Some(false);
        } else if let Some(alarm) = self.alarms.get(&key) {
            let cause = alarm.cause.clone();
            self.conditions.known.insert(key, (Some(false), cause));
        }
    }

    /// A sudden change was confirmed by a second session.
    pub(super) fn jumped(&mut self, i: usize, suspected: &Suspected, now: Instant) {
        let condition = match suspected.what {
            JumpKind::StrandFailure => Condition::StrandFailed,
            _ => Condition::Jump,
        };
        let cause = jump_cause(suspected);
        let key = AlarmKey {
            joint: Some(self.names[i].clone()),
            condition,
        };
        // It waited for a second session: no delay more, which would pass it over.
        self.alarms
            .condition(&key, Some(true), &cause, Delays::NONE, now);
        // It happened once: what remains is that nobody has looked.
        self.conditions.known.insert(key, (Some(false), cause));
    }

    /// What is wrong with the data: what doors say comes first, then what frames show, then a refused estimate.
    pub(super) fn judge_data(&mut self) {
        let own = self.health.last().and_then(|verdict| verdict.robot.clone());
        let refused = self.refusal.clone().map(|why| Trouble::Refused { why });
        let trouble = self.doors.first().cloned().or(own).or(refused);
        match trouble {
            Some(trouble) => {
                let cause = AlarmCause::Data { trouble };
                self.conditions
                    .set(None, Condition::Data, Some(true), cause);
            }
            None if self.health.last().is_some() => self.over_of(None, Condition::Data),
            None => {}
        }
        let Some(verdict) = self.health.last() else {
            return;
        };
        for (i, trouble) in verdict.tendons.clone().into_iter().enumerate() {
            let joint = self.names[i].clone();
            match trouble {
                Some(trouble) => {
                    let cause = AlarmCause::Data { trouble };
                    self.conditions
                        .set(Some(&joint), Condition::Data, Some(true), cause);
                }
                None => self.over_of(Some(joint), Condition::Data),
            }
        }
    }

    /// What the doors can't receive as they should, now; an empty list: all is well.
    pub fn troubles(&mut self, troubles: &[Trouble], now: Instant) {
        if self.doors != troubles {
            self.doors = troubles.to_vec();
            self.judge_data();
            if self.doors.is_empty() && self.health.last().is_none() {
                self.over_of(None, Condition::Data);
            }
            self.tick(now);
        }
    }

    /// Whether the robot's door is shut, and why: `dds:0` and what the system said.
    pub fn door(&mut self, shut: Option<(&str, &str)>, now: Instant) {
        match shut {
            Some((door, why)) => {
                let (door, why) = (door.into(), why.into());
                let cause = AlarmCause::Door { door, why };
                self.conditions
                    .set(None, Condition::Door, Some(true), cause);
            }
            None => self.over_of(None, Condition::Door),
        }
        self.tick(now);
    }

    /// Whether what is learned can be stored.
    pub(super) fn store_trouble(&mut self, why: Option<(StoreFault, &str)>, now: Instant) {
        self.store_fails = why.is_some();
        match why {
            Some((fault, why)) => {
                let why = why.into();
                let cause = AlarmCause::Store { fault, why };
                self.conditions
                    .set(None, Condition::Store, Some(true), cause);
            }
            None => self.over_of(None, Condition::Store),
        }
        self.judge(now);
    }

    /// Time passes: staleness, sessions that wait too long, what was dropped.
    pub(super) fn time_passes(&mut self, now: Instant) {
        self.watch_clock(now);
        let since = self.feed.last.or(self.feed.started).unwrap_or(now);
        let silent_s = now.since_s(since);
        let times = self.config.times;
        if silent_s >= times.stale_after_s {
            if !self.feed.silent {
                self.feed.silent = true;
                self.health.silent();
                if self.feed.last.is_some() {
                    self.event(Event::Silent, now);
                }
                let since_utc_s = self.feed.last.map(|last| last.utc_s());
                let cause = AlarmCause::Silence { since_utc_s };
                self.conditions
                    .set(None, Condition::NoData, Some(true), cause);
            }
            if silent_s >= times.session_pause_s {
                self.end_session(SessionEnd::Lost, now);
            }
        } else if self.feed.last.is_some() {
            self.over_of(None, Condition::NoData);
        }
        if self.health.verdict(&self.names, now) {
            self.judge_data();
        }
        if let Some(doubt_s) = self.live.doubt_s() {
            let holds = doubt_s >= self.config.alarms.doubt_s;
            match holds {
                true => {
                    let cause = AlarmCause::InDoubt { for_s: doubt_s };
                    self.conditions
                        .set(None, Condition::Suspicion, Some(true), cause);
                }
                false => self.over_of(None, Condition::Suspicion),
            }
        }
        self.tell_losses(now);
    }

    /// Losses, told together: once a minute at most.
    fn tell_losses(&mut self, now: Instant) {
        const BETWEEN_S: f64 = 60.0;
        let told = self.told_losses;
        if told.is_some_and(|told| now.since_s(told) < BETWEEN_S) {
            return;
        }
        let messages = std::mem::take(&mut self.feed.dropped);
        let motion_s = std::mem::take(&mut self.feed.behind_s);
        if messages > 0 {
            self.event(Event::Dropped { messages }, now);
        }
        if motion_s > 0.0 {
            self.event(Event::Behind { motion_s }, now);
        }
        if messages > 0 || motion_s > 0.0 {
            self.told_losses = Some(now);
        }
    }

    /// Alarms follow conditions, after their delays.
    pub(super) fn judge(&mut self, now: Instant) {
        for (key, (holds, cause)) in &self.conditions.known {
            let delays = self.config.alarms.delays(key.condition);
            self.alarms.condition(key, *holds, cause, delays, now);
        }
        self.alarms.tick(now);
    }
}

fn jump_cause(suspected: &Suspected) -> AlarmCause {
    let Gaussian { mean, deviation } = suspected.size_rad;
    AlarmCause::Jump {
        time_utc_s: suspected.time_utc_s,
        size_rad: mean,
        deviation_rad: deviation,
        what: suspected.what,
        cause: suspected.cause,
        stiffness_ratio: suspected.stiffness_ratio,
    }
}

/// Whether a limit may be passed soon, by the trend; of several, the one that comes first.
fn near(trend: &JointTrend, near_s: f64) -> Option<(Option<bool>, AlarmCause)> {
    let open = trend.limits.iter().filter(|l| {
        let passed = l.state == LimitState::Passed;
        let known = l.state != LimitState::TooFewSessions;
        known && !passed && matches!(l.limit, Limit::Retension { .. } | Limit::Replace { .. })
    });
    let first = open.min_by(|a, b| {
        let low = |l: Option<f64>| l.unwrap_or(f64::INFINITY);
        low(a.after_low_s).total_cmp(&low(b.after_low_s))
    })?;
    let after_low_s = first.after_low_s.unwrap_or(f64::INFINITY);
    let holds = if after_low_s <= near_s {
        Some(true)
    } else if after_low_s > NEAR_NO_MORE * near_s {
        Some(false)
    } else {
        None
    };
    let cause = AlarmCause::Soon {
        after_low_s,
        after_s: first.after_s,
    };
    Some((holds, cause))
}
