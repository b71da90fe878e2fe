//! What is shown: only what is stored, and the number of now.

use super::Monitor;
use crate::alarm::{Alarm, Level};
use crate::instant::Instant;
use crate::record::NoOffset;
use crate::snapshot::{Freshness, Learning, NotNow, RobotSnapshot, SessionNow, TendonSnapshot};
use sinew_estimate::session::Verdict;
use sinew_model::Gaussian;
use std::sync::Arc;

/// The parts of a monitor, looked at together.
pub(super) struct View<'a> {
    monitor: &'a Monitor,
    now: Instant,
    freshness: Freshness,
    /// The most severe first.
    alarms: Vec<Alarm>,
}

impl<'a> View<'a> {
    pub(super) fn new(monitor: &'a Monitor, now: Instant) -> Self {
        // While the store fails, alarms are shown as they are: one that nobody sees is worse than one that a crash forgets.
        let mut alarms: Vec<Alarm> = match monitor.outbox.fails {
            true => monitor.alarms.alarms.iter().cloned().collect(),
            false => monitor.outbox.alarms.clone(),
        };
        alarms.sort_by(|a, b| {
            let severity = |alarm: &Alarm| std::cmp::Reverse(alarm.key.condition.severity());
            (severity(a), &a.key).cmp(&(severity(b), &b.key))
        });
        let stale_after_s = monitor.setup.config.times.stale_after_s;
        Self {
            monitor,
            now,
            freshness: monitor.ingest.freshness(stale_after_s, now),
            alarms,
        }
    }

    fn is_fresh(&self) -> bool {
        self.freshness == Freshness::Fresh
    }

    /// The worst of the alarms of a joint, or of the robot as a whole; stale where nothing is known now.
    fn level(&self, joint: Option<&str>, known: bool) -> Level {
        let own = self.alarms.iter();
        let own = own.filter(|alarm| alarm.key.joint.as_deref() == joint);
        let stale = if known { Level::Ok } else { Level::Stale };
        Level::worst(own.map(Alarm::level).chain([stale]))
    }

    pub(super) fn robot(self) -> RobotSnapshot {
        let Monitor {
            setup,
            ingest,
            sessions,
            online,
            chain,
            outbox,
            ..
        } = self.monitor;
        let fresh = self.is_fresh();
        let tendons: Vec<TendonSnapshot> = (0..setup.names.len()).map(|i| self.tendon(i)).collect();
        let of_tendons = tendons.iter().map(|t| t.level);
        RobotSnapshot {
            robot: setup.config.name.clone(),
            robot_type: setup.robot.name.clone(),
            source: setup.config.source.clone(),
            time_utc_s: self.now.utc_s(),
            level: Level::worst(of_tendons.chain([self.level(None, fresh)])),
            freshness: self.freshness,
            rate_hz: ingest.health.rate_hz(),
            frames: ingest.frames,
            frames_lost: ingest.frames_lost,
            learning: match &chain.baseline {
                Some(progress) => progress.shown(),
                None if chain.belief().tendons.iter().any(|t| t.since.is_some()) => {
                    Learning::Following
                }
                None => Learning::NoBaseline,
            },
            session: sessions.now().map(|session| SessionNow {
                start_utc_s: session.start.utc_s(),
                duration_s: session.motion_s,
            }),
            clock: ingest.clocks.clock(self.now),
            temperature_c: ingest.temperature_c.filter(|_| fresh),
            external_force: online.external_force().filter(|_| fresh),
            tendons,
            waiting_to_be_stored: outbox.len(),
            alarms: self.alarms,
        }
    }

    fn tendon(&self, i: usize) -> TendonSnapshot {
        let Monitor {
            setup,
            online,
            chain,
            trends,
            outbox,
            ..
        } = self.monitor;
        let (name, belief) = (&setup.names[i], &chain.belief().tendons[i]);
        let offset = self.offset_now(i);
        let known = offset.ok();
        let own = online.joint(setup.elastic[i]).filter(|_| known.is_some());
        let stretched = setup.stretch(i, belief.before_m, known);
        let made = trends.get(i);
        let follows = self.is_fresh() && (online.is_known() || chain.baseline.is_some());
        TendonSnapshot {
            joint: name.clone(),
            level: self.level(Some(name), follows),
            offset_rad: known,
            unknown_temperature_rad: (own.map(|(own, _)| own.unknown_temperature_rad))
                .filter(|added_rad| *added_rad > 0.0),
            provisional: own.and_then(|(_, why)| why),
            elongation_m: stretched.map(|s| s.0),
            strain_ratio: stretched.map(|s| s.1),
            reason: offset.err(),
            tensioned_utc_s: belief.last_tensioned_utc_s(),
            last: outbox.last.get(name).cloned(),
            limits: setup.limits[i].shown(),
            rope: setup.geometry(i).and_then(|t| t.rope.clone()),
            trend: made.map(|made| Arc::clone(&made.trend)),
            passages: made.map_or_else(Arc::default, |made| Arc::clone(&made.passages)),
        }
    }

    /// The offset of now, or why there is none.
    fn offset_now(&self, i: usize) -> Result<Gaussian, NotNow> {
        let Monitor { online, chain, .. } = self.monitor;
        if !self.is_fresh() {
            return Err(NotNow::NoData);
        }
        if chain.baseline.is_some() {
            return Err(NotNow::LearnsBaseline);
        }
        let own = online.joint(self.monitor.setup.elastic[i]);
        let offset = own.map(|(own, _)| own.offset_rad).ok_or(NotNow::Starting)?;
        match Verdict::of(offset) {
            Verdict::CannotTell => Err(NotNow::CannotTell {
                why: NoOffset::TooWide,
            }),
            _ => Ok(offset),
        }
    }
}
