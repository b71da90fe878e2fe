//! What people tell the monitor.

use super::Monitor;
use super::learn::Learning;
use super::tendon::Pending;
use crate::command::{Command, CommandError, What};
use crate::instant::Instant;
use crate::journal::{Event, SessionEnd};
use crate::transaction::LearnsBaseline;
use sinew_files::date::utc_text;
use std::sync::Arc;

/// Bytes of a name, and of a note, at most.
const NAME_MOST: usize = 200;
const NOTE_MOST: usize = 4000;

impl Monitor {
    /// Does what somebody says. It is spoken of once it is stored.
    ///
    /// # Errors
    /// [`CommandError`]; nothing has changed then.
    pub fn command(&mut self, command: Command, now: Instant) -> Result<(), CommandError> {
        self.check(&command)?;
        self.watch_clock(now);
        let tensioned = match &command.what {
            What::Tensioned { joints } => Some((joints.clone(), false)),
            What::Replaced { joints } => Some((joints.clone(), true)),
            _ => None,
        };
        if tensioned.is_some() {
            self.end_session(SessionEnd::Command, now);
        }
        self.alarms.command(&command, now)?;
        self.event(Event::Command { command }, now);
        if let Some((joints, replaced)) = tensioned {
            self.tensioned(&joints, replaced, now);
        }
        self.tick(now);
        Ok(())
    }

    fn check(&self, command: &Command) -> Result<(), CommandError> {
        let Command { who, note, what } = command;
        if who.trim().is_empty() {
            return Err(CommandError::NoName);
        }
        for (field, text, most) in [("who", who, NAME_MOST), ("note", note, NOTE_MOST)] {
            if text.len() > most {
                let length = text.len();
                return Err(CommandError::TooLong {
                    field,
                    length,
                    most,
                });
            }
        }
        if *what == What::Note && note.trim().is_empty() {
            return Err(CommandError::NoNote);
        }
        if let What::Tensioned { joints } | What::Replaced { joints } = what
            && let Some(joint) = joints.iter().find(|joint| !self.names.contains(joint))
        {
            return Err(CommandError::Joint {
                joint: joint.clone(),
                known: self.names.join(", "),
            });
        }
        Ok(())
    }

    /// The next baseline begins.
    fn tensioned(&mut self, joints: &[String], replaced: bool, now: Instant) {
        let is_own = |name: &String| joints.is_empty() || joints.contains(name);
        let name = utc_text(now.utc_ns).unwrap_or_else(|| "undated".into());
        let pending = Pending {
            before: self.belief.tendons.clone(),
            own: self.names.iter().map(is_own).collect(),
            replaced,
            utc_s: now.utc_s(),
            name: format!("tensioned {name}"),
        };
        let belief = Arc::make_mut(&mut self.belief);
        pending.apply(&mut belief.tendons, &self.robot, &self.elastic);
        // Of ropes whose baseline isn't complete, one tensioned meanwhile begins it anew.
        let mut joints = belief.learns.take().map_or_else(Vec::new, |l| l.joints);
        let more = self.names.iter().filter(|name| is_own(name));
        joints.extend(
            more.filter(|name| !joints.contains(name))
                .cloned()
                .collect::<Vec<_>>(),
        );
        belief.learns = Some(LearnsBaseline {
            joints,
            ..LearnsBaseline::default()
        });
        self.tensionings += 1;
        self.learning = Learning::of(belief, self.robot.arm.dof());
        for (i, name) in self.names.iter().enumerate() {
            if pending.own[i] {
                self.conditions.forget_joint(name);
                self.trends.forget(i);
            }
        }
        // Motion from before is estimated still, or waits for it: its last word on the tendons is to come. What was for a
        // baseline says nothing of them, and a trend doesn't either.
        if self.hears || self.waiting.iter().any(|s| s.baseline_of.is_none()) {
            self.pending.push(pending);
        }
        self.live.stop();
        self.keep(Vec::new());
    }
}
