//! Alarm conditions derived from state, trends and data.

use super::config::AlarmOptions;
use super::health::Health;
use super::posterior::PosteriorChain;
use super::setup::Setup;
use super::trend::Trends;
use crate::alarm::{
    Alarm, AlarmCause, AlarmKey, Alarms, AlarmsStored, Condition, DataFault, Delays, LimitOrigin,
    StepKind, TransitionReason,
};
use crate::command::Command;
use crate::incident::Finding;
use crate::instant::Instant;
use crate::transaction::PendingEvent;
use sinew_model::Gaussian;
use sinew_trend::{JointTrend, Limit, LimitState};
use std::collections::BTreeMap;

/// Hysteresis of [`Condition::LimitNear`]: the condition clears above this multiple of the warning time.
const NEAR_HYSTERESIS_RATIO: f64 = 1.5;
/// Minimum probability of a limit exceedance at which the alarm is raised; below the second value it may be cleared.
const RAISE_PROBABILITY: f64 = 0.95;
const CLEAR_PROBABILITY: f64 = 0.5;

/// Whether a condition is present (`None`: between the thresholds of raising and clearing), and its cause.
type ConditionState = (Option<bool>, AlarmCause);

/// Conditions of a robot and the alarms derived from them.
#[derive(Debug)]
pub(super) struct AlarmEvaluator {
    pub(super) alarms: Alarms,
    /// Present value of every condition.
    conditions: BTreeMap<AlarmKey, ConditionState>,
    /// Reception faults of the transports.
    transports: Vec<DataFault>,
}

impl AlarmEvaluator {
    pub(super) fn new(stored: AlarmsStored, now: Instant) -> Self {
        Self {
            alarms: Alarms::restore(stored, now),
            conditions: BTreeMap::new(),
            transports: Vec::new(),
        }
    }

    /// Sets the value of a condition; `None`: absent, if it was present.
    fn set(&mut self, joint: Option<&str>, condition: Condition, holds: Option<ConditionState>) {
        let key = AlarmKey {
            joint: joint.map(str::to_string),
            condition,
        };
        match holds {
            Some(holds) => {
                self.conditions.insert(key, holds);
            }
            None => {
                if let Some((holds, _)) = self.conditions.get_mut(&key) {
                    *holds = Some(false);
                } else if let Some(alarm) = self.alarms.get(&key) {
                    let cause = alarm.cause.clone();
                    self.conditions.insert(key, (Some(false), cause));
                }
            }
        }
    }

    /// Sets a condition of the whole robot with its cause; `None`: absent, if it was present.
    pub(super) fn set_robot(&mut self, condition: Condition, cause: Option<AlarmCause>) {
        self.set(None, condition, cause.map(|cause| (Some(true), cause)));
    }

    /// Discards the conditions of a joint whose rope was re-tensioned.
    pub(super) fn discard_joint(&mut self, joint: &str) {
        self.conditions
            .retain(|key, _| key.joint.as_deref() != Some(joint));
    }

    /// Evaluates states and trends of the tendons after an estimate, a command or the start.
    pub(super) fn evaluate_tendons(
        &mut self,
        setup: &Setup,
        chain: &PosteriorChain,
        trends: &Trends,
    ) {
        for i in 0..setup.names.len() {
            self.evaluate_limits(i, setup, chain);
            let joint = Some(setup.names[i].as_str());
            let suspected = &chain.state().tendons[i].suspected;
            let suspected = suspected.as_ref().map(|event| {
                let newest = event.updated(event.posterior());
                (Some(true), step_cause(&newest))
            });
            self.set(joint, Condition::SuspectedStep, suspected);
            if let Some(made) = trends.get(i) {
                // `None` if no limit is specified or all are exceeded.
                let exceeded = |limit: &Limit| self.is_exceeded(&setup.names[i], limit);
                let near = near(&made.trend, setup.config.alarms.near_s, exceeded);
                self.set(joint, Condition::LimitNear, near);
            }
        }
    }

    fn evaluate_limits(&mut self, i: usize, setup: &Setup, chain: &PosteriorChain) {
        let state = chain.state();
        let tendon = &state.tendons[i];
        // Without a baseline the elongation is not available.
        let has_baseline = tendon.since.is_some() && state.learns.is_none();
        let offset = tendon.last_rad.filter(|_| has_baseline);
        let Some((since, whole)) = setup.elongation(i, tendon.before_m, offset) else {
            return;
        };
        let limits = setup.limits[i];
        for (condition, limit, value) in [
            (Condition::RetensionLimit, limits.retension_m, since),
            (Condition::ReplaceLimit, limits.replace_ratio, whole),
        ] {
            // A limit that was removed from the configuration cannot be exceeded.
            let holds = limit.map(|limit| exceeded(value, limit, &setup.config.alarms));
            self.set(Some(&setup.names[i]), condition, holds);
        }
    }

    /// Whether a limit is exceeded by its condition or its alarm.
    fn is_exceeded(&self, joint: &str, limit: &Limit) -> bool {
        let condition = match limit {
            Limit::Retension { .. } => Condition::RetensionLimit,
            Limit::Replace { .. } => Condition::ReplaceLimit,
        };
        let key = AlarmKey {
            joint: Some(joint.into()),
            condition,
        };
        let condition = self.conditions.get(&key);
        condition.is_some_and(|(holds, _)| *holds == Some(true))
            || self.alarms.get(&key).is_some_and(Alarm::is_active)
    }

    /// Raises the alarm of a lost transmission, or of a step change confirmed by a second session.
    pub(super) fn confirm_step(&mut self, joint: &str, suspected: &PendingEvent, now: Instant) {
        let condition = match suspected.what {
            StepKind::TransmissionLost => Condition::TransmissionLost,
            StepKind::StrandFailure => Condition::StrandFailure,
            _ => Condition::StepChange,
        };
        let cause = step_cause(suspected);
        let key = AlarmKey {
            joint: Some(joint.into()),
            condition,
        };
        // Confirmation took a session already; a further delay would suppress the alarm.
        self.alarms
            .condition(&key, Some(true), &cause, Delays::NONE, now);
        let suspected = AlarmKey {
            condition: Condition::SuspectedStep,
            ..key.clone()
        };
        self.alarms.supersede(&suspected, &key, now);
        // The event is over; the alarm stays latched until it is handled.
        self.conditions.insert(key, (Some(false), cause));
    }

    /// Ends the alarms of a tendon that contradict a finding, which needs a repair; that of its cause remains, or is
    /// raised in their place.
    pub(super) fn find(&mut self, joint: &str, finding: Finding, command: &Command, now: Instant) {
        let (condition, what) = match finding {
            Finding::StrandFailure => (Condition::StrandFailure, StepKind::StrandFailure),
            Finding::Slip | Finding::ClampSlip => (Condition::StepChange, StepKind::Slip),
            Finding::EncoderMoved | Finding::Nothing | Finding::Other => return,
        };
        let of_joint = |alarm: &&Alarm| {
            alarm.key.joint.as_deref() == Some(joint) && alarm.key.condition.is_change()
        };
        let found = (self.alarms.iter()).filter(of_joint);
        let Some(worst) = found.max_by_key(|alarm| alarm.severity()).cloned() else {
            return;
        };
        let is_true = |key: &AlarmKey| {
            // A lost transmission is a consequence of either.
            key.condition == condition || key.condition == Condition::TransmissionLost
        };
        let reason = TransitionReason::Command {
            who: command.who.clone(),
            what: command.what.clone(),
            note: command.note.clone(),
        };
        let is_meant = |key: &AlarmKey| {
            key.joint.as_deref() == Some(joint) && key.condition.is_change() && !is_true(key)
        };
        self.alarms.end(is_meant, &reason, now);
        let key = AlarmKey {
            condition,
            ..worst.key.clone()
        };
        let mut cause = worst.cause;
        if let AlarmCause::StepChange {
            what: kind,
            cause: part,
            stiffness_ratio,
            ..
        } = &mut cause
            && !is_true(&worst.key)
        {
            (*kind, *part) = (what, None);
            if what == StepKind::Slip {
                *stiffness_ratio = None;
            }
            self.alarms
                .condition(&key, Some(true), &cause, Delays::NONE, now);
            self.conditions.insert(key, (Some(false), cause));
        }
    }

    /// Evaluates the faults of the data; priority: transports, then frames, then errors of the estimator.
    pub(super) fn evaluate_data(
        &mut self,
        setup: &Setup,
        health: &Health,
        estimator_error: Option<&str>,
    ) {
        let verdict = health.last();
        let robot = verdict.and_then(|verdict| verdict.robot.clone());
        let rejected = estimator_error.map(|reason| DataFault::Rejected {
            reason: reason.into(),
        });
        let fault = self.transports.first().cloned().or(robot).or(rejected);
        if fault.is_some() || verdict.is_some() {
            let cause = fault.map(|trouble| AlarmCause::Data { trouble });
            self.set_robot(Condition::Data, cause);
        }
        let tendons = verdict.map_or(&[][..], |verdict| &verdict.tendons);
        for (joint, fault) in setup.names.iter().zip(tendons) {
            let fault = fault.clone();
            let holds = fault.map(|trouble| (Some(true), AlarmCause::Data { trouble }));
            self.set(Some(joint), Condition::Data, holds);
        }
    }

    /// Sets the present reception faults of the transports; returns whether they changed.
    pub(super) fn set_transport_faults(
        &mut self,
        faults: &[DataFault],
        setup: &Setup,
        health: &Health,
        estimator_error: Option<&str>,
    ) -> bool {
        if self.transports == faults {
            return false;
        }
        self.transports = faults.to_vec();
        self.evaluate_data(setup, health, estimator_error);
        if self.transports.is_empty() && health.last().is_none() {
            self.set_robot(Condition::Data, None);
        }
        true
    }

    /// Updates the alarms from the conditions, after their delays.
    pub(super) fn tick(&mut self, options: &AlarmOptions, now: Instant) {
        for (key, (holds, cause)) in &self.conditions {
            let delays = options.delays(key.condition);
            self.alarms.condition(key, *holds, cause, delays, now);
        }
        self.alarms.tick(now);
    }
}

/// Evaluates a limit; returns whether it is exceeded, and the cause.
fn exceeded(
    value: Gaussian,
    (limit, origin): (f64, LimitOrigin),
    options: &AlarmOptions,
) -> ConditionState {
    let probability = value.probability_above(limit);
    let holds = if probability >= RAISE_PROBABILITY {
        Some(true)
    } else if probability < CLEAR_PROBABILITY && value.mean < options.clear_below * limit {
        Some(false)
    } else {
        None
    };
    let cause = AlarmCause::Limit {
        mean: value.mean,
        std: value.std,
        limit,
        probability,
        origin,
    };
    (holds, cause)
}

fn step_cause(suspected: &PendingEvent) -> AlarmCause {
    let Gaussian { mean, std } = suspected.size_rad;
    AlarmCause::StepChange {
        time_utc_s: suspected.time_utc_s,
        size_rad: mean,
        std_rad: std,
        what: suspected.what,
        cause: suspected.cause,
        stiffness_ratio: suspected.stiffness_ratio,
    }
}

/// Evaluates whether a limit may be exceeded soon according to the trend; of several limits, the first one that is not
/// `exceeded`.
fn near(
    trend: &JointTrend,
    near_s: f64,
    exceeded: impl Fn(&Limit) -> bool,
) -> Option<ConditionState> {
    let open = trend.limits.iter().filter(|l| {
        let is_exceeded = l.state == LimitState::Passed || exceeded(&l.limit);
        let is_predicted = l.state != LimitState::TooFewSessions;
        is_predicted
            && !is_exceeded
            && matches!(l.limit, Limit::Retension { .. } | Limit::Replace { .. })
    });
    let first = open.min_by(|a, b| {
        let low = |l: Option<f64>| l.unwrap_or(f64::INFINITY);
        low(a.after_low_s).total_cmp(&low(b.after_low_s))
    })?;
    let after_low_s = first.after_low_s.unwrap_or(f64::INFINITY);
    let holds = if after_low_s <= near_s {
        Some(true)
    } else if after_low_s > NEAR_HYSTERESIS_RATIO * near_s {
        Some(false)
    } else {
        None
    };
    let at = |after_s: Option<f64>| after_s.map(|s| trend.last_utc_s + s);
    let cause = AlarmCause::Soon {
        limit: Some(first.limit),
        at_low_utc_s: at(first.after_low_s),
        at_utc_s: at(first.after_s),
        at_high_utc_s: at(first.after_high_s),
    };
    Some((holds, cause))
}
