//! Alarms of one robot and their transitions.

use super::{Alarm, AlarmCause, AlarmKey, AlarmState, Condition, Transition, TransitionReason};
use crate::command::{Command, CommandError, CommandKind, MAX_SHELF_S};
use crate::instant::Instant;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Time for which a condition must be present or absent before its alarm follows, by the monotonic clock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Delays {
    /// Delay before the alarm is raised, s.
    pub raise_after_s: f64,
    /// Delay before the alarm is cleared, s.
    pub clear_after_s: f64,
}

impl Delays {
    /// No delay in either direction.
    pub const NONE: Self = Self {
        raise_after_s: 0.0,
        clear_after_s: 0.0,
    };

    /// Returns the default delays of a condition.
    pub fn of(condition: Condition) -> Self {
        let (raise_after_s, clear_after_s) = match condition {
            Condition::ReplaceLimit | Condition::RetensionLimit | Condition::LimitNear => {
                (600.0, 600.0)
            }
            Condition::Data => (15.0, 60.0),
            Condition::Store => (5.0, 60.0),
            Condition::Transport => (5.0, 1.0),
            Condition::TransmissionLost
            | Condition::StrandFailure
            | Condition::StepChange
            | Condition::SuspectedStep
            | Condition::NoData => (0.0, 0.0),
        };
        Self {
            raise_after_s,
            clear_after_s,
        }
    }
}

/// Alarms of a robot and their pending transitions.
#[derive(Debug, Clone, Default)]
pub struct Alarms {
    list: BTreeMap<AlarmKey, Entry>,
    /// Transitions since the last [`Alarms::take_transitions`].
    transitions: Vec<Transition>,
    /// Whether the cause of an alarm changed since the last [`Alarms::take_changed`].
    changed: bool,
}

/// Alarms that are not in the normal state, in their stored form.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct AlarmsStored {
    /// Alarms that are not normal.
    pub alarms: Vec<Alarm>,
}

#[derive(Debug, Clone, Default)]
struct Entry {
    alarm: Option<Alarm>,
    /// Whether the condition was present at the last update.
    holds: bool,
    /// Start of the present value of `holds`.
    since: Option<Instant>,
    shelved_at: Option<Instant>,
}

impl Entry {
    fn state(&self) -> AlarmState {
        (self.alarm.as_ref()).map_or(AlarmState::Normal, |alarm| alarm.state)
    }
}

impl Alarms {
    /// Restores stored alarms. A remaining shelving time longer than the original one is ended: the civil clock has
    /// stepped.
    pub fn restore(stored: AlarmsStored, now: Instant) -> Self {
        let mut alarms = Self::default();
        for mut alarm in stored.alarms {
            let mut shelved_at = None;
            if let (Some(until), Some(for_s)) = (alarm.shelved_until_utc_s, alarm.shelved_for_s) {
                let left_s = until - now.utc_s();
                match left_s > 0.0 && left_s <= for_s {
                    true => shelved_at = Some(now.after_s(left_s - for_s)),
                    false => (alarm.shelved_until_utc_s, alarm.shelved_for_s) = (None, None),
                }
            }
            let entry = Entry {
                holds: matches!(alarm.state, AlarmState::Active | AlarmState::Acknowledged),
                since: Some(now),
                shelved_at,
                alarm: Some(alarm.clone()),
            };
            alarms.list.insert(alarm.key, entry);
        }
        alarms
    }

    /// Returns the alarms in their stored form.
    pub fn stored(&self) -> AlarmsStored {
        AlarmsStored {
            alarms: self.iter().cloned().collect(),
        }
    }

    /// Iterates over the alarms that are not normal.
    pub fn iter(&self) -> impl Iterator<Item = &Alarm> {
        self.list.values().filter_map(|entry| entry.alarm.as_ref())
    }

    /// Returns an alarm that is not normal.
    pub fn get(&self, key: &AlarmKey) -> Option<&Alarm> {
        self.list.get(key)?.alarm.as_ref()
    }

    fn alarm_mut(&mut self, key: &AlarmKey) -> Result<&mut Alarm, CommandError> {
        let entry = self.list.get_mut(key);
        let alarm = entry.and_then(|entry| entry.alarm.as_mut());
        alarm.ok_or(CommandError::NoAlarm)
    }

    /// Returns the transitions since the last call.
    pub fn take_transitions(&mut self) -> Vec<Transition> {
        std::mem::take(&mut self.transitions)
    }

    /// Returns whether the cause of an alarm changed since the last call.
    pub fn take_changed(&mut self) -> bool {
        std::mem::take(&mut self.changed)
    }

    /// Updates a condition: present, `Some(true)`; absent, `Some(false)`; or between the thresholds of raising and
    /// clearing, `None`. While the alarm is on, its cause follows the newest one; the journal keeps that of the raising.
    pub fn condition(
        &mut self,
        key: &AlarmKey,
        holds: Option<bool>,
        cause: &AlarmCause,
        delays: Delays,
        now: Instant,
    ) {
        self.refresh(key, holds, cause);
        let Some(holds) = holds else {
            // A pending delay restarts.
            if let Some(entry) = self.list.get_mut(key) {
                entry.since = None;
            }
            return;
        };
        if !holds && !self.list.contains_key(key) {
            return;
        }
        let entry = self.list.entry(key.clone()).or_default();
        if entry.holds != holds || entry.since.is_none() {
            entry.holds = holds;
            entry.since = Some(now);
        }
        let waited_s = entry.since.map_or(0.0, |since| now.since_s(since));
        let from = entry.state();
        let to = match (from, holds) {
            (AlarmState::Normal | AlarmState::Cleared | AlarmState::Latched, true)
                if waited_s >= delays.raise_after_s =>
            {
                AlarmState::Active
            }
            (AlarmState::Active | AlarmState::Acknowledged, false)
                if waited_s >= delays.clear_after_s =>
            {
                match from {
                    _ if key.condition.latches() => AlarmState::Latched,
                    AlarmState::Active if key.condition.needs_acknowledgement() => {
                        AlarmState::Cleared
                    }
                    _ => AlarmState::Normal,
                }
            }
            _ => return,
        };
        if to == AlarmState::Active && entry.alarm.is_none() {
            entry.alarm = Some(Alarm {
                key: key.clone(),
                state: AlarmState::Normal,
                acknowledged: false,
                raised_utc_s: now.utc_s(),
                cause: cause.clone(),
                shelved_until_utc_s: None,
                shelved_for_s: None,
            });
        }
        if let (AlarmState::Active, Some(alarm)) = (to, &mut entry.alarm) {
            // A recurring condition has to be acknowledged again.
            alarm.acknowledged = false;
            alarm.raised_utc_s = now.utc_s();
            alarm.cause = cause.clone();
        }
        let reason = TransitionReason::Condition {
            cause: cause.clone(),
        };
        self.step(key, to, reason, now);
    }

    /// Replaces the cause of an alarm whose condition is not absent by the newest one.
    fn refresh(&mut self, key: &AlarmKey, holds: Option<bool>, cause: &AlarmCause) {
        let entry = self.list.get_mut(key);
        if let Some(alarm) = entry.and_then(|entry| entry.alarm.as_mut())
            && holds != Some(false)
            && matches!(alarm.state, AlarmState::Active | AlarmState::Acknowledged)
            && cause.supersedes(&alarm.cause)
        {
            alarm.cause = cause.clone();
            self.changed = true;
        }
    }

    /// Ends the shelving of alarms whose time has expired.
    pub fn tick(&mut self, now: Instant) {
        let ended: Vec<AlarmKey> = (self.list.iter())
            .filter_map(|(key, entry)| {
                let alarm = entry.alarm.as_ref()?;
                let (until, for_s) = (alarm.shelved_until_utc_s?, alarm.shelved_for_s?);
                let shelved_s = entry.shelved_at.map_or(f64::INFINITY, |at| now.since_s(at));
                (now.utc_s() >= until || shelved_s >= for_s).then(|| key.clone())
            })
            .collect();
        for key in ended {
            self.unshelve(&key, TransitionReason::ShelfEnded, now);
        }
    }

    /// Executes an operator command on the alarms; `tensioned` and `replaced` clear those of their joints.
    ///
    /// # Errors
    /// Returns a [`CommandError`] if the alarm does not exist, the duration is out of range, the note is missing or the
    /// condition is still active; nothing has changed then.
    pub fn command(&mut self, command: &Command, now: Instant) -> Result<(), CommandError> {
        let reason = || TransitionReason::Command {
            who: command.who.clone(),
            what: command.what.clone(),
            note: command.note.clone(),
        };
        match &command.what {
            CommandKind::Acknowledge { alarm: key } => {
                let alarm = self.alarm_mut(key)?;
                alarm.acknowledged = true;
                let to = match alarm.state {
                    AlarmState::Active => AlarmState::Acknowledged,
                    AlarmState::Cleared => AlarmState::Normal,
                    same => same,
                };
                self.step(key, to, reason(), now);
            }
            CommandKind::Shelve { alarm: key, for_s } => {
                let for_s = *for_s;
                if !(for_s > 0.0 && for_s <= MAX_SHELF_S) {
                    return Err(CommandError::Shelf { for_s });
                }
                let alarm = self.alarm_mut(key)?;
                alarm.shelved_until_utc_s = Some(now.utc_s() + for_s);
                alarm.shelved_for_s = Some(for_s);
                let to = alarm.state;
                if let Some(entry) = self.list.get_mut(key) {
                    entry.shelved_at = Some(now);
                }
                self.step(key, to, reason(), now);
            }
            CommandKind::Unshelve { alarm: key } => {
                let alarm = self.get(key).ok_or(CommandError::NoAlarm)?;
                if alarm.shelved_until_utc_s.is_some() {
                    self.unshelve(key, reason(), now);
                }
            }
            CommandKind::Reset { alarm: key } => {
                if command.note.trim().is_empty() {
                    return Err(CommandError::NoNote);
                }
                match self.get(key).ok_or(CommandError::NoAlarm)?.state {
                    AlarmState::Active | AlarmState::Acknowledged => {
                        return Err(CommandError::StillActive);
                    }
                    _ => self.step(key, AlarmState::Normal, reason(), now),
                }
            }
            CommandKind::Tensioned { joints } | CommandKind::Replaced { joints } => {
                let of_rope = |key: &AlarmKey| match key.condition {
                    Condition::ReplaceLimit => matches!(command.what, CommandKind::Replaced { .. }),
                    Condition::Data | Condition::Store | Condition::NoData => false,
                    _ => true,
                };
                let is_meant = |key: &AlarmKey| {
                    let named = |joint: &String| joints.contains(joint);
                    key.joint.as_ref().is_some_and(named) && of_rope(key)
                };
                self.end(is_meant, &reason(), now);
            }
            CommandKind::Finding { joint, finding } => {
                let is_meant =
                    |key: &AlarmKey| key.joint.as_ref() == Some(joint) && key.condition.is_change();
                if !finding.needs_repair() {
                    self.end(is_meant, &reason(), now);
                }
            }
            CommandKind::Withdraw { .. } | CommandKind::Correct { .. } | CommandKind::Note => {}
        }
        Ok(())
    }

    /// Returns alarms to the normal state by a command.
    pub(crate) fn end(
        &mut self,
        is_meant: impl Fn(&AlarmKey) -> bool,
        reason: &TransitionReason,
        now: Instant,
    ) {
        let keys = self.list.keys().filter(|key| is_meant(key));
        let meant: Vec<AlarmKey> = keys.cloned().collect();
        for key in meant {
            if let Some(entry) = self.list.get_mut(&key) {
                entry.holds = false;
                entry.since = Some(now);
            }
            self.step(&key, AlarmState::Normal, reason.clone(), now);
        }
    }

    /// Returns an alarm to the normal state because another one of the same incident supersedes it.
    pub(crate) fn supersede(&mut self, key: &AlarmKey, by: &AlarmKey, now: Instant) {
        let reason = TransitionReason::Superseded { alarm: by.clone() };
        self.end(|other| other == key, &reason, now);
    }

    /// Restores an alarm that a withdrawn entry ended, unless it was raised again.
    pub(crate) fn put_back(&mut self, alarm: &Alarm, now: Instant) {
        let entry = self.list.entry(alarm.key.clone()).or_default();
        if entry.alarm.is_some() {
            return;
        }
        *entry = Entry {
            holds: matches!(alarm.state, AlarmState::Active | AlarmState::Acknowledged),
            since: Some(now),
            shelved_at: None,
            alarm: Some(Alarm {
                state: AlarmState::Normal,
                shelved_until_utc_s: None,
                shelved_for_s: None,
                ..alarm.clone()
            }),
        };
        self.step(&alarm.key, alarm.state, TransitionReason::Withdrawn, now);
    }

    fn unshelve(&mut self, key: &AlarmKey, reason: TransitionReason, now: Instant) {
        let Some(entry) = self.list.get_mut(key) else {
            return;
        };
        if let Some(alarm) = &mut entry.alarm {
            (alarm.shelved_until_utc_s, alarm.shelved_for_s) = (None, None);
        }
        entry.shelved_at = None;
        let to = entry.state();
        self.step(key, to, reason, now);
    }

    fn step(&mut self, key: &AlarmKey, to: AlarmState, reason: TransitionReason, now: Instant) {
        let Some(entry) = self.list.get_mut(key) else {
            return;
        };
        let Some(alarm) = &mut entry.alarm else {
            return;
        };
        let from = std::mem::replace(&mut alarm.state, to);
        if to == AlarmState::Normal {
            (entry.alarm, entry.shelved_at) = (None, None);
        }
        self.transitions.push(Transition {
            key: key.clone(),
            from,
            to,
            time_utc_s: now.utc_s(),
            reason,
        });
    }
}
