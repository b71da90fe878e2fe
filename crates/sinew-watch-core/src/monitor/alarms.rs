//! From what is known to alarms.

use super::belief::BeliefChain;
use super::config::AlarmOptions;
use super::health::Health;
use super::setup::Setup;
use super::trend::Trends;
use crate::alarm::{
    AlarmCause, AlarmKey, Alarms, AlarmsStored, Condition, Delays, JumpKind, LimitOrigin, Trouble,
};
use crate::instant::Instant;
use crate::transaction::Suspected;
use sinew_model::Gaussian;
use sinew_trend::{JointTrend, Limit, LimitState};
use std::collections::BTreeMap;

/// A limit that was near is no longer where it may be passed later than this share of the time.
const NEAR_NO_MORE: f64 = 1.5;
/// A limit's alarm is raised from this probability on, and may be cleared below that one.
const RAISED: f64 = 0.95;
const CLEARED: f64 = 0.5;

/// Whether a condition holds, `None`: it is between raising and clearing; and what that rests on.
type Holds = (Option<bool>, AlarmCause);

/// The conditions of a robot, and the alarms that follow them.
#[derive(Debug)]
pub(super) struct AlarmJudge {
    pub(super) alarms: Alarms,
    /// What is known of every condition.
    known: BTreeMap<AlarmKey, Holds>,
    /// What the doors can't receive as they should.
    doors: Vec<Trouble>,
}

impl AlarmJudge {
    pub(super) fn new(stored: AlarmsStored, now: Instant) -> Self {
        Self {
            alarms: Alarms::restore(stored, now),
            known: BTreeMap::new(),
            doors: Vec::new(),
        }
    }

    /// Takes what is known of a condition; `None`: it is over, if it was there.
    fn set(&mut self, joint: Option<&str>, condition: Condition, holds: Option<Holds>) {
        let key = AlarmKey {
            joint: joint.map(str::to_string),
            condition,
        };
        match holds {
            Some(holds) => {
                self.known.insert(key, holds);
            }
            None => {
                if let Some((holds, _)) = self.known.get_mut(&key) {
                    *holds = Some(false);
                } else if let Some(alarm) = self.alarms.get(&key) {
                    let cause = alarm.cause.clone();
                    self.known.insert(key, (Some(false), cause));
                }
            }
        }
    }

    /// Takes a condition of the whole robot: what it rests on where it holds; `None`: it is over, if it was there.
    pub(super) fn set_robot(&mut self, condition: Condition, cause: Option<AlarmCause>) {
        self.set(None, condition, cause.map(|cause| (Some(true), cause)));
    }

    /// Forgets the conditions of a joint whose rope was tensioned.
    pub(super) fn forget_joint(&mut self, joint: &str) {
        self.known
            .retain(|key, _| key.joint.as_deref() != Some(joint));
    }

    /// Judges what the tendons' beliefs and trends say: after an estimate, a command, a start.
    pub(super) fn judge_tendons(&mut self, setup: &Setup, chain: &BeliefChain, trends: &Trends) {
        for i in 0..setup.names.len() {
            self.judge_limits(i, setup, chain);
            let joint = Some(setup.names[i].as_str());
            let suspected = &chain.belief().tendons[i].suspected;
            let suspected = suspected.as_ref().map(|s| (Some(true), jump_cause(s)));
            self.set(joint, Condition::Suspicion, suspected);
            if let Some(made) = trends.get(i) {
                // Where no limit is ahead, none is stated, or it is passed.
                let near = near(&made.trend, setup.config.alarms.near_s);
                self.set(joint, Condition::LimitNear, near);
            }
        }
    }

    fn judge_limits(&mut self, i: usize, setup: &Setup, chain: &BeliefChain) {
        let belief = chain.belief();
        let tendon = &belief.tendons[i];
        // Against the encoders' zero nobody can say how long a rope has become.
        let known = tendon.since.is_some() && belief.learns.is_none();
        let offset = tendon.last_rad.filter(|_| known);
        let Some((since, whole)) = setup.stretch(i, tendon.before_m, offset) else {
            return;
        };
        let limits = setup.limits[i];
        for (condition, limit, value) in [
            (Condition::RetensionLimit, limits.retension_m, since),
            (Condition::ReplaceLimit, limits.replace_ratio, whole),
        ] {
            // One that was taken out of the configuration can't be passed.
            let holds = limit.map(|limit| passed(value, limit, &setup.config.alarms));
            self.set(Some(&setup.names[i]), condition, holds);
        }
    }

    /// Raises the alarm of a sudden change that a second session confirmed.
    pub(super) fn jumped(&mut self, joint: &str, suspected: &Suspected, now: Instant) {
        let condition = match suspected.what {
            JumpKind::StrandFailure => Condition::StrandFailed,
            _ => Condition::Jump,
        };
        let cause = jump_cause(suspected);
        let key = AlarmKey {
            joint: Some(joint.into()),
            condition,
        };
        // It waited for a second session: no delay more, which would pass it over.
        self.alarms
            .condition(&key, Some(true), &cause, Delays::NONE, now);
        // It happened once: what remains is that nobody has looked.
        self.known.insert(key, (Some(false), cause));
    }

    /// Judges what is wrong with the data: what doors say comes first, then what frames show, then a refused estimate.
    pub(super) fn judge_data(&mut self, setup: &Setup, health: &Health, refusal: Option<&str>) {
        let verdict = health.last();
        let own = verdict.and_then(|verdict| verdict.robot.clone());
        let refused = refusal.map(|why| Trouble::Refused { why: why.into() });
        let trouble = self.doors.first().cloned().or(own).or(refused);
        if trouble.is_some() || verdict.is_some() {
            let cause = trouble.map(|trouble| AlarmCause::Data { trouble });
            self.set_robot(Condition::Data, cause);
        }
        let tendons = verdict.map_or(&[][..], |verdict| &verdict.tendons);
        for (joint, trouble) in setup.names.iter().zip(tendons) {
            let trouble = trouble.clone();
            let holds = trouble.map(|trouble| (Some(true), AlarmCause::Data { trouble }));
            self.set(Some(joint), Condition::Data, holds);
        }
    }

    /// Takes what the doors can't receive as they should now; whether that changed.
    pub(super) fn set_troubles(
        &mut self,
        troubles: &[Trouble],
        setup: &Setup,
        health: &Health,
        refusal: Option<&str>,
    ) -> bool {
        if self.doors == troubles {
            return false;
        }
        self.doors = troubles.to_vec();
        self.judge_data(setup, health, refusal);
        if self.doors.is_empty() && health.last().is_none() {
            self.set_robot(Condition::Data, None);
        }
        true
    }

    /// Lets alarms follow conditions, after their delays.
    pub(super) fn tick(&mut self, options: &AlarmOptions, now: Instant) {
        for (key, (holds, cause)) in &self.known {
            let delays = options.delays(key.condition);
            self.alarms.condition(key, *holds, cause, delays, now);
        }
        self.alarms.tick(now);
    }
}

/// Whether a limit is passed, and what that rests on.
fn passed(value: Gaussian, (limit, origin): (f64, LimitOrigin), options: &AlarmOptions) -> Holds {
    let probability = value.probability_above(limit);
    let holds = if probability >= RAISED {
        Some(true)
    } else if probability < CLEARED && value.mean < options.clear_below * limit {
        Some(false)
    } else {
        None
    };
    let cause = AlarmCause::Limit {
        mean: value.mean,
        deviation: value.deviation,
        limit,
        probability,
        origin,
    };
    (holds, cause)
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
fn near(trend: &JointTrend, near_s: f64) -> Option<Holds> {
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
