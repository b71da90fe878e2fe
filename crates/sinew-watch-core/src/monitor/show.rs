//! What is shown: only what is stored, and the number of now.

use super::Monitor;
use super::limits::Limits;
use crate::alarm::{Alarm, Level};
use crate::instant::Instant;
use crate::record::NoOffset;
use crate::snapshot::{Freshness, Learning, NotNow, RobotSnapshot, SessionNow, TendonSnapshot};
use sinew_estimate::session::Verdict;
use sinew_model::Gaussian;
use std::sync::Arc;

impl Monitor {
    /// What is known now. Alarms and records are those that are stored; while the store fails, alarms are shown as
    /// they are, for one that nobody sees is worse than one that a crash forgets.
    pub fn snapshot(&self, now: Instant) -> RobotSnapshot {
        let freshness = self.freshness(now);
        let mut alarms: Vec<Alarm> = match self.store_fails {
            true => self.alarms.iter().cloned().collect(),
            false => self.outbox.alarms.clone(),
        };
        alarms.sort_by(|a, b| {
            let severity = |alarm: &Alarm| std::cmp::Reverse(alarm.key.condition.severity());
            (severity(a), &a.key).cmp(&(severity(b), &b.key))
        });
        let fresh = freshness == Freshness::Fresh;
        let tendons: Vec<TendonSnapshot> = (0..self.names.len())
            .map(|i| self.tendon(i, &alarms, fresh))
            .collect();
        let of_robot = alarms.iter().filter(|alarm| alarm.key.joint.is_none());
        let stale = if fresh { Level::Ok } else { Level::Stale };
        let levels = (tendons.iter().map(|t| t.level))
            .chain(of_robot.map(Alarm::level))
            .chain([stale]);
        RobotSnapshot {
            robot: self.config.name.clone(),
            robot_type: self.robot.name.clone(),
            source: self.config.source.clone(),
            time_utc_s: now.utc_s(),
            level: levels.max_by_key(|l| l.urgency()).unwrap_or_default(),
            freshness,
            rate_hz: self.health.rate_hz(),
            frames: self.feed.frames,
            frames_lost: self.feed.frames_lost,
            learning: match &self.learning {
                Some(learning) => learning.shown(),
                None if self.belief.tendons.iter().any(|t| t.since.is_some()) => {
                    Learning::Following
                }
                None => Learning::NoBaseline,
            },
            session: self.sessions.now().map(|session| SessionNow {
                start_utc_s: session.start.utc_s(),
                duration_s: session.motion_s,
            }),
            clock: self.clocks.clock(now),
            temperature_c: self.feed.temperature_c.filter(|_| fresh),
            external_force: self.live.external_force().filter(|_| fresh),
            tendons,
            alarms,
            waiting_to_be_stored: self.outbox.len(),
        }
    }

    fn freshness(&self, now: Instant) -> Freshness {
        let Some(last) = self.feed.last else {
            return Freshness::Never;
        };
        let for_s = now.since_s(last);
        match for_s < self.config.times.stale_after_s {
            true => Freshness::Fresh,
            false => Freshness::Stale { for_s },
        }
    }

    fn tendon(&self, i: usize, alarms: &[Alarm], fresh: bool) -> TendonSnapshot {
        let belief = &self.belief.tendons[i];
        let joint = self.elastic[i];
        let transmission = self.robot.transmissions[joint].as_ref();
        let geometry = transmission.and_then(|t| t.tendon.as_ref());
        let offset = self.offset_now(i, fresh);
        let known = offset.ok();
        let elongation = geometry.zip(known);
        let elongation_m = elongation.map(|(t, x)| x.scaled(t.joint_pulley_radius_m));
        let strain_ratio = geometry.zip(elongation_m).map(|(t, since)| {
            let whole = belief.before_m.plus(since);
            whole.scaled(1.0 / t.length_m)
        });
        let own = alarms
            .iter()
            .filter(|alarm| alarm.key.joint.as_deref() == Some(&*self.names[i]));
        let made = self.trends.get(i);
        let stale = match fresh && (self.live.is_known() || self.learning.is_some()) {
            true => Level::Ok,
            false => Level::Stale,
        };
        let levels = own.map(Alarm::level).chain([stale]);
        TendonSnapshot {
            joint: self.names[i].clone(),
            level: levels.max_by_key(|l| l.urgency()).unwrap_or_default(),
            offset_rad: known,
            unknown_temperature_rad: known.and(self.live.unknown_temperature_rad(joint)),
            elongation_m,
            strain_ratio,
            reason: offset.err(),
            tensioned_utc_s: belief.last_tensioned_utc_s(),
            last: self.outbox.last.get(&self.names[i]).cloned(),
            limits: Limits::now(&self.limits[i]),
            rope: geometry.and_then(|t| t.rope.clone()),
            trend: made.map(|made| Arc::clone(&made.trend)),
            passages: made.map_or_else(Arc::default, |made| Arc::clone(&made.passages)),
        }
    }

    /// The number of now, or why there is none.
    fn offset_now(&self, i: usize, fresh: bool) -> Result<Gaussian, NotNow> {
        if !fresh {
            return Err(NotNow::NoData);
        }
        if self.learning.is_some() {
            return Err(NotNow::LearnsBaseline);
        }
        let own = self
            .live
            .offset(self.elastic[i])
            .filter(|_| self.live.is_sure());
        let offset = own.ok_or(NotNow::InDoubt)?;
        match Verdict::of(offset) {
            Verdict::CannotTell => Err(NotNow::CannotTell {
                why: NoOffset::TooWide,
            }),
            _ => Ok(offset),
        }
    }
}
