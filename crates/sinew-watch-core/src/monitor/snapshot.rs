//! Snapshots: stored results only, and the present offsets.

use super::Monitor;
use crate::alarm::{Alarm, Level};
use crate::instant::Instant;
use crate::record::NoOffset;
use crate::snapshot::{
    Freshness, Learning, LiveTendon, NoEstimateReason, RobotSnapshot, SessionNow, TendonSnapshot,
    Validity,
};
use sinew_estimate::session::Verdict;
use sinew_log::Frame;
use sinew_model::Gaussian;
use std::sync::Arc;

/// Monitor at one instant, for making a snapshot.
pub(super) struct View<'a> {
    monitor: &'a Monitor,
    now: Instant,
    freshness: Freshness,
    /// Alarms in descending order of severity.
    alarms: Vec<Alarm>,
}

impl<'a> View<'a> {
    pub(super) fn new(monitor: &'a Monitor, now: Instant) -> Self {
        // While the store fails, unstored alarms are snapshot: a hidden alarm is worse than one lost in a crash.
        let mut alarms: Vec<Alarm> = match monitor.outbox.fails {
            true => monitor.alarms.alarms.iter().cloned().collect(),
            false => monitor.outbox.alarms.clone(),
        };
        alarms.sort_by(|a, b| {
            let severity = |alarm: &Alarm| std::cmp::Reverse(alarm.severity());
            (severity(a), &a.key).cmp(&(severity(b), &b.key))
        });
        Self {
            monitor,
            now,
            freshness: monitor.freshness(now),
            alarms,
        }
    }

    fn is_fresh(&self) -> bool {
        self.freshness == Freshness::Fresh
    }

    /// Returns the most urgent level of the alarms of a joint, or of the robot as a whole; stale without current data.
    fn level(&self, joint: Option<&str>, is_current: bool) -> Level {
        let alarms = self.alarms.iter();
        let alarms = alarms.filter(|alarm| alarm.key.joint.as_deref() == joint);
        let stale = if is_current { Level::Ok } else { Level::Stale };
        Level::worst(alarms.map(Alarm::level).chain([stale]))
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
                Some(progress) => progress.snapshot(),
                None if chain.state().tendons.iter().any(|t| t.since.is_some()) => {
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
            incidents: chain.state().incidents.iter().cloned().collect(),
            maintenance: chain.state().maintenance.clone(),
            withdrawable: chain.state().without.as_ref().map(|w| w.entry),
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
        let (name, state) = (&setup.names[i], &chain.state().tendons[i]);
        let offset = self.monitor.offset_now(i, self.now);
        let offset_rad = offset.ok();
        let estimate = online
            .joint(setup.elastic[i])
            .filter(|_| offset_rad.is_some());
        let elongation = setup.elongation(i, state.before_m, offset_rad);
        let computed = trends.get(i);
        let is_current = self.is_fresh() && (online.has_answer() || chain.baseline.is_some());
        TendonSnapshot {
            joint: name.clone(),
            level: self.level(Some(name), is_current),
            offset_rad,
            validity: self.monitor.validity(i, self.now),
            unknown_temperature_rad: (estimate.map(|(joint, _)| joint.unknown_temperature_rad))
                .filter(|added_rad| *added_rad > 0.0),
            provisional: estimate.and_then(|(_, reason)| reason),
            elongation_m: elongation.map(|s| s.0),
            strain_ratio: elongation.map(|s| s.1),
            reason: offset.err(),
            tensioned_utc_s: state.last_tensioned_utc_s(),
            last: outbox.last.get(name).cloned(),
            limits: setup.limits[i].snapshot(),
            rope: setup.geometry(i).and_then(|t| t.rope.clone()),
            trend: computed.map(|computed| Arc::clone(&computed.trend)),
            passages: computed.map_or_else(Arc::default, |computed| Arc::clone(&computed.passages)),
        }
    }
}

impl Monitor {
    fn freshness(&self, now: Instant) -> Freshness {
        let stale_after_s = self.setup.config.times.stale_after_s;
        self.ingest.freshness(stale_after_s, now)
    }

    /// Returns the present offset, rad, or the reason for which there is none.
    fn offset_now(&self, i: usize, now: Instant) -> Result<Gaussian, NoEstimateReason> {
        if self.freshness(now) != Freshness::Fresh {
            return Err(NoEstimateReason::NoData);
        }
        if self.chain.baseline.is_some() {
            return Err(NoEstimateReason::BaselineAcquisition);
        }
        let estimate = self.online.joint(self.setup.elastic[i]);
        let offset = estimate
            .map(|(joint, _)| joint.offset_rad)
            .ok_or(NoEstimateReason::Starting)?;
        match Verdict::is_inconclusive(offset) {
            true => Err(NoEstimateReason::Inconclusive {
                reason: NoOffset::TooWide,
            }),
            false => Ok(offset),
        }
    }

    /// Whether the present offset of a tendon is available and not provisional.
    fn is_valid(&self, i: usize, now: Instant) -> bool {
        let estimate = self.online.joint(self.setup.elastic[i]);
        let is_settled = estimate.is_some_and(|(_, provisional)| provisional.is_none());
        is_settled && self.offset_now(i, now).is_ok()
    }

    /// Updates the times since which offsets have not been valid.
    pub(super) fn update_validity(&mut self, now: Instant) {
        for i in 0..self.not_valid_since.len() {
            let is_valid = self.is_valid(i, now);
            let since = &mut self.not_valid_since[i];
            *since = (!is_valid).then(|| since.unwrap_or(now));
        }
    }

    fn validity(&self, i: usize, now: Instant) -> Validity {
        if self.is_valid(i, now) {
            return Validity::Valid;
        }
        let since = self.not_valid_since[i].unwrap_or(now);
        Validity::NotValid {
            for_s: now.since_s(since),
        }
    }

    /// Returns the present values of a tendon, by its index in the snapshot; `frame` is the last one ingested. `None`: the
    /// frame was rejected.
    pub fn live(&self, tendon: usize, frame: &Frame, now: Instant) -> Option<LiveTendon> {
        let axis = *self.setup.elastic.get(tendon)?;
        Some(LiveTendon {
            motor_minus_joint_rad: self.ingest.motor_minus_joint_rad(axis, frame)?,
            offset_rad: self.offset_now(tendon, now).ok(),
            valid: self.is_valid(tendon, now),
        })
    }
}
