//! The alarms of one robot.

use super::{Alarm, AlarmCause, AlarmKey, AlarmState, Condition, Transition, TransitionWhy};
use crate::command::{Command, CommandError, LONGEST_SHELF_S, What};
use crate::instant::Instant;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// How long a condition has to hold, or not to, before its alarm follows; by the clock that never steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Delays {
    /// Before it is raised, s.
    pub raise_after_s: f64,
    /// Before it is cleared, s.
    pub clear_after_s: f64,
}

impl Delays {
    /// Without a delay.
    pub const NONE: Self = Self {
        raise_after_s: 0.0,
        clear_after_s: 0.0,
    };

    /// As usual for a condition.
    pub fn of(condition: Condition) -> Self {
        let (raise_after_s, clear_after_s) = match condition {
            Condition::ReplaceLimit | Condition::RetensionLimit | Condition::LimitNear => {
                (600.0, 600.0)
            }
            Condition::Data => (15.0, 60.0),
            Condition::Store => (5.0, 60.0),
            Condition::Door => (5.0, 1.0),
            Condition::StrandFailed
            | Condition::Jump
            | Condition::Suspicion
            | Condition::NoData => (0.0, 0.0),
        };
        Self {
            raise_after_s,
            clear_after_s,
        }
    }
}

/// The alarms of a robot, and how each got where it is.
#[derive(Debug, Clone, Default)]
pub struct Alarms {
    list: BTreeMap<AlarmKey, Entry>,
    /// Since the last [`Alarms::take_transitions`].
    transitions: Vec<Transition>,
}

/// The alarms that aren't normal, as they are stored.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct AlarmsStored {
    /// The alarms.
    pub alarms: Vec<Alarm>,
}

#[derive(Debug, Clone, Default)]
struct Entry {
    alarm: Option<Alarm>,
    /// Whether the condition held last time.
    holds: bool,
    /// Since when it does, or doesn't.
    since: Option<Instant>,
    shelved_at: Option<Instant>,
}

impl Entry {
    fn state(&self) -> AlarmState {
        (self.alarm.as_ref()).map_or(AlarmState::Normal, |alarm| alarm.state)
    }
}

impl Alarms {
    /// Goes on from what was stored. A shelf longer than it was made ends: the civil clock has stepped.
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

    /// As they are stored.
    pub fn stored(&self) -> AlarmsStored {
        AlarmsStored {
            alarms: self.iter().cloned().collect(),
        }
    }

    /// Those that aren't normal.
    pub fn iter(&self) -> impl Iterator<Item = &Alarm> {
        self.list.values().filter_map(|entry| entry.alarm.as_ref())
    }

    /// An alarm that isn't normal.
    pub fn get(&self, key: &AlarmKey) -> Option<&Alarm> {
        self.list.get(key)?.alarm.as_ref()
    }

    fn alarm_mut(&mut self, key: &AlarmKey) -> Result<&mut Alarm, CommandError> {
        let entry = self.list.get_mut(key);
        let alarm = entry.and_then(|entry| entry.alarm.as_mut());
        alarm.ok_or(CommandError::NoAlarm)
    }

    /// What happened since the last call.
    pub fn take_transitions(&mut self) -> Vec<Transition> {
        std::mem::take(&mut self.transitions)
    }

    /// Says that a condition holds, `Some(true)`; is over, `Some(false)`; or is neither: between raising and
    /// clearing nothing changes.
    pub fn condition(
        &mut self,
        key: &AlarmKey,
        holds: Option<bool>,
        cause: &AlarmCause,
        delays: Delays,
        now: Instant,
    ) {
        let Some(holds) = holds else {
            // What was about to be raised or cleared begins to wait anew.
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
                    AlarmState::Active if key.condition.needs_look() => AlarmState::Cleared,
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
            // What comes again has to be seen again.
            alarm.acknowledged = false;
            alarm.raised_utc_s = now.utc_s();
            alarm.cause = cause.clone();
        }
        let why = TransitionWhy::Condition {
            cause: cause.clone(),
        };
        self.step(key, to, why, now);
    }

    /// Ends the shelves whose time is over.
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
            self.unshelve(&key, TransitionWhy::ShelfEnded, now);
        }
    }

    /// Does what somebody asks of an alarm; `tensioned` and `replaced` clear those of their joints.
    ///
    /// # Errors
    /// [`CommandError`]; nothing has changed then.
    pub fn command(&mut self, command: &Command, now: Instant) -> Result<(), CommandError> {
        let why = || TransitionWhy::Command {
            who: command.who.clone(),
            what: command.what.clone(),
            note: command.note.clone(),
        };
        match &command.what {
            What::Acknowledge { alarm: key } => {
                let alarm = self.alarm_mut(key)?;
                alarm.acknowledged = true;
                let to = match alarm.state {
                    AlarmState::Active => AlarmState::Acknowledged,
                    AlarmState::Cleared => AlarmState::Normal,
                    same => same,
                };
                self.step(key, to, why(), now);
            }
            What::Shelve { alarm: key, for_s } => {
                let for_s = *for_s;
                if !(for_s > 0.0 && for_s <= LONGEST_SHELF_S) {
                    return Err(CommandError::Shelf { for_s });
                }
                let alarm = self.alarm_mut(key)?;
                alarm.shelved_until_utc_s = Some(now.utc_s() + for_s);
                alarm.shelved_for_s = Some(for_s);
                let to = alarm.state;
                if let Some(entry) = self.list.get_mut(key) {
                    entry.shelved_at = Some(now);
                }
                self.step(key, to, why(), now);
            }
            What::Unshelve { alarm: key } => {
                let alarm = self.get(key).ok_or(CommandError::NoAlarm)?;
                if alarm.shelved_until_utc_s.is_some() {
                    self.unshelve(key, why(), now);
                }
            }
            What::Reset { alarm: key } => {
                if command.note.trim().is_empty() {
                    return Err(CommandError::NoNote);
                }
                match self.get(key).ok_or(CommandError::NoAlarm)?.state {
                    AlarmState::Active | AlarmState::Acknowledged => {
                        return Err(CommandError::StillActive);
                    }
                    _ => self.step(key, AlarmState::Normal, why(), now),
                }
            }
            What::Tensioned { joints } | What::Replaced { joints } => {
                let of_rope = |key: &AlarmKey| match key.condition {
                    Condition::ReplaceLimit => matches!(command.what, What::Replaced { .. }),
                    Condition::Data | Condition::Store | Condition::NoData => false,
                    _ => true,
                };
                let is_meant = |key: &AlarmKey| {
                    let named = |joint: &String| joints.is_empty() || joints.contains(joint);
                    key.joint.as_ref().is_some_and(named) && of_rope(key)
                };
                let meant: Vec<AlarmKey> =
                    self.list.keys().filter(|k| is_meant(k)).cloned().collect();
                for key in meant {
                    if let Some(entry) = self.list.get_mut(&key) {
                        entry.holds = false;
                        entry.since = Some(now);
                    }
                    self.step(&key, AlarmState::Normal, why(), now);
                }
            }
            What::Note => {}
        }
        Ok(())
    }

    fn unshelve(&mut self, key: &AlarmKey, why: TransitionWhy, now: Instant) {
        let Some(entry) = self.list.get_mut(key) else {
            return;
        };
        if let Some(alarm) = &mut entry.alarm {
            (alarm.shelved_until_utc_s, alarm.shelved_for_s) = (None, None);
        }
        entry.shelved_at = None;
        let to = entry.state();
        self.step(key, to, why, now);
    }

    fn step(&mut self, key: &AlarmKey, to: AlarmState, why: TransitionWhy, now: Instant) {
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
            why,
        });
    }
}
