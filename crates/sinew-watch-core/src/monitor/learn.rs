//! What an estimate changes: the chain, the tendons' beliefs, records.

use super::config::{MonitorConfig, MonitorError};
use super::job::{Estimated, Job, Learns, Outcome, Stretch, StretchWork, Work};
use super::tendon::{Found, Said, Verdict};
use super::{Done, Monitor};
use crate::instant::Instant;
use crate::journal::{BaselineWaits, Event, SessionEnd};
use crate::record::{NoOffset, Record};
use crate::transaction::{Belief, LearnsBaseline, TendonBelief};
use sinew_estimate::session::{self, Poses, SessionEstimate, Since, estimator};
use sinew_files::date::{DAY_S, utc_text};
use sinew_model::Gaussian;
use sinew_model::offset::Block;
use sinew_model::robot::Robot;
use std::sync::Arc;

/// Distinct poses a baseline needs: with four it spoils what is compared with it, and motion at work passes many.
const POSES_NEEDED: usize = 12;
/// Motion it needs, s.
const MOTION_NEEDED_S: f64 = 60.0;
/// What a session without an estimate says of a stiffness.
const UNKNOWN_STIFFNESS: Gaussian = Gaussian {
    mean: 0.0,
    deviation: 1.0,
};
/// A session with less motion says nothing, s.
const TOO_SHORT_S: f64 = 10.0;

/// A baseline on its way, block by block.
#[derive(Debug, Clone)]
pub(super) struct Learning {
    joints: Vec<String>,
    poses: Poses,
    motion_s: f64,
    /// Whether all it needs was handed over to be estimated.
    handed_over: bool,
}

impl Learning {
    /// The one that is to be learned, if one is.
    pub(super) fn of(belief: &Belief, joints: usize) -> Option<Self> {
        let so_far = belief.learns.as_ref()?;
        let mut poses = Poses::new(joints);
        for pose in so_far.poses_rad.chunks_exact(joints.max(1)) {
            poses.push(pose);
        }
        Some(Self {
            joints: so_far.joints.clone(),
            poses,
            motion_s: so_far.duration_s,
            handed_over: false,
        })
    }

    /// With a stretch.
    fn with(mut self, stretch: &Stretch) -> Self {
        for block in &stretch.recorded.blocks {
            self.poses.push(&block.q);
        }
        self.motion_s += stretch.motion_s;
        self
    }

    pub(super) fn block(&mut self, block: &Block, moved: bool, block_s: f64) {
        self.poses.push(&block.q);
        if moved {
            self.motion_s += block_s;
        }
    }

    /// Whether that is enough, said once.
    pub(super) fn hand_over(&mut self) -> bool {
        let now = self.is_ready() && !self.handed_over;
        self.handed_over |= now;
        now
    }

    /// Whether that is enough.
    fn is_ready(&self) -> bool {
        self.poses.count() >= POSES_NEEDED && self.motion_s >= MOTION_NEEDED_S
    }

    fn so_far(&self) -> LearnsBaseline {
        LearnsBaseline {
            joints: self.joints.clone(),
            duration_s: self.motion_s,
            poses_rad: self.poses.as_slice().to_vec(),
        }
    }

    /// For people.
    pub(super) fn shown(&self) -> crate::snapshot::Learning {
        crate::snapshot::Learning::Baseline {
            duration_s: self.motion_s,
            poses: self.poses.count() as u64,
            poses_needed: POSES_NEEDED as u64,
        }
    }
}

/// What the stretches of a session said so far.
#[derive(Debug, Default)]
pub(super) struct Heard {
    /// Number of the session.
    session: u64,
    /// The last estimate.
    estimate: Option<SessionEstimate>,
    /// Sudden changes, tendon by tendon.
    changes: Vec<Vec<Found>>,
}

/// What a monitor begins with, and why what was stored is left alone.
pub(super) fn begin(
    config: &MonitorConfig,
    robot: &Robot,
    names: &[String],
    stored: Option<Belief>,
) -> Result<(Belief, Option<String>), MonitorError> {
    let prior = estimator(robot, &config.estimate);
    let prior = prior.prior();
    let first = config.baseline.as_ref();
    let since = first.and_then(|baseline| baseline.recordings.first().cloned());
    if let Some(baseline) = first {
        baseline.belief(robot, prior, "the baseline of the configuration")?;
    }
    let fresh = Belief {
        version: Belief::VERSION,
        baseline: config.baseline.clone(),
        end_utc_s: None,
        learns: None,
        sessions: 0,
        tendons: (names.iter())
            .map(|name| TendonBelief::new(name, since.clone()))
            .collect(),
    };
    let Some(mut stored) = stored else {
        return Ok((fresh, None));
    };
    let same = stored.tendons.iter().map(|t| &t.joint).eq(names);
    if stored.version != Belief::VERSION || !same {
        let why = "it is of other tendons, or of another version of the program";
        return Ok((fresh, Some(why.into())));
    }
    let fits = stored.baseline.as_ref().map(|baseline| {
        let belief = baseline.belief(robot, prior, "what was learned");
        belief.map(|_| ())
    });
    if let Some(Err(error)) = fits {
        // What was tensioned when is still true; what was learned of the robot isn't.
        stored.baseline = fresh.baseline;
        stored.end_utc_s = None;
        for tendon in &mut stored.tendons {
            tendon.since.clone_from(&since);
            (tendon.last_rad, tendon.last_utc_s, tendon.suspected) = (None, None, None);
        }
        return Ok((stored, Some(error.to_string())));
    }
    Ok((stored, None))
}

/// Whether two descriptions have the same springs at the same joints.
pub(super) fn is_same_drive(a: &Robot, b: &Robot) -> bool {
    let springs = |robot: &Robot| -> Vec<Option<f64>> {
        let all = robot.transmissions.iter();
        all.map(|t| t.as_ref().map(|t| t.stiffness_nm_per_rad))
            .collect()
    };
    springs(a) == springs(b)
}

impl Monitor {
    /// The next estimate to make; one at a time, for each begins where the last one ended.
    pub fn job(&mut self) -> Option<Job> {
        if self.working {
            return None;
        }
        while let Some(stretch) = self.waiting.pop_front() {
            if stretch.baseline_of.is_some_and(|of| of != self.tensionings) {
                // A rope was tensioned since: it is no part of the baseline after that.
                continue;
            }
            if !stretch.worth_it || stretch.recorded.blocks.is_empty() {
                // Only the session's end is in it.
                let now = self.feed.ticked.unwrap_or(stretch.session.start);
                match self.is_learning(&stretch) {
                    true => self.baseline_waits(BaselineWaits::FewPoses, now),
                    false => self.hear(&stretch, Err("too short".into()), now),
                }
                continue;
            }
            (self.working, self.hears) = (true, stretch.baseline_of.is_none());
            return Some(Job {
                robot: Arc::clone(&self.robot),
                work: Work::Stretch(Box::new(self.stretch_work(stretch))),
            });
        }
        let work = self.trend_work()?;
        self.working = true;
        Some(Job {
            robot: Arc::clone(&self.robot),
            work: Work::Trend(Box::new(work)),
        })
    }

    /// Whether a stretch is for a baseline that is to be learned still.
    fn is_learning(&self, stretch: &Stretch) -> bool {
        stretch.baseline_of.is_some() && self.belief.learns.is_some()
    }

    fn baseline_waits(&mut self, why: BaselineWaits, now: Instant) {
        // What it rests on is what was learned before.
        self.learning = Learning::of(&self.belief, self.robot.arm.dof());
        self.event(Event::BaselineWaits { why }, now);
    }

    fn stretch_work(&self, stretch: Stretch) -> StretchWork {
        let goes_on = self.heard.session == stretch.session.number && self.heard.estimate.is_some();
        let start_utc_s = stretch.session.start.utc_s();
        let pause_s = self.belief.end_utc_s.map(|end| start_utc_s - end);
        // A baseline from a file is of another day; so is what a clock says that stepped back.
        let days = pause_s.filter(|s| *s >= 0.0).map_or(1.0, |s| s / DAY_S);
        let date = utc_text(stretch.session.start.utc_ns);
        let learning = self.is_learning(&stretch);
        let learns = self.belief.learns.as_ref().filter(|_| learning);
        StretchWork {
            options: self.config.estimate,
            baseline: self.belief.baseline.clone(),
            since: match goes_on {
                true => Since::Now,
                false => Since::Days(days),
            },
            learns: learns.map(|so_far| Learns {
                tensioned: (self.names.iter().zip(&self.elastic))
                    .filter(|(name, _)| so_far.joints.contains(name))
                    .map(|(_, joint)| *joint)
                    .collect(),
                continues: so_far.duration_s > 0.0,
            }),
            name: format!(
                "{}, {}",
                self.config.name,
                date.as_deref().unwrap_or("undated")
            ),
            stretch,
        }
    }

    /// Takes what a [`Job`] gave.
    pub fn done(&mut self, done: Done, now: Instant) {
        (self.working, self.hears) = (false, false);
        match done.0 {
            // A rope was tensioned since: what was to come of it isn't any more.
            Outcome::Trend { of, tendon, .. } if of != self.tensionings => {
                self.trends.changed(tendon);
            }
            Outcome::Trend { tendon, made, .. } => self.trends.set(tendon, made),
            Outcome::Stretch {
                stretch,
                learned: true,
                result,
            } => self.learned(*stretch, result, now),
            Outcome::Stretch {
                stretch, result, ..
            } => self.hear(&stretch, result, now),
        }
        self.judge_beliefs();
        self.tick(now);
    }

    /// A stretch of motion after tensioning: the baseline, or a part of it.
    fn learned(&mut self, stretch: Stretch, result: Result<Box<Estimated>, String>, now: Instant) {
        if stretch.baseline_of != Some(self.tensionings) {
            return;
        }
        let estimated = match result {
            Ok(estimated) => estimated,
            Err(why) => {
                self.refusal = Some(why);
                self.baseline_waits(BaselineWaits::Refused, now);
                return;
            }
        };
        self.refusal = None;
        let so_far = Learning::of(&self.belief, self.robot.arm.dof());
        let so_far = so_far.map(|learning| learning.with(&stretch));
        let belief = Arc::make_mut(&mut self.belief);
        belief.baseline = Some(estimated.next);
        belief.end_utc_s = Some(end_utc_s(&stretch));
        belief.sessions = self.sessions.count();
        belief.learns = so_far.as_ref().map(Learning::so_far);
        if let Some(ready) = so_far.filter(Learning::is_ready) {
            belief.learns = None;
            self.learning = None;
            if let Some(live) = estimated.live {
                self.live.succeed(live, true);
            }
            let poses = ready.poses.count() as u64;
            self.event(Event::Baseline { poses }, now);
        } else if stretch.end.is_some() {
            self.baseline_waits(BaselineWaits::FewPoses, now);
        }
        self.keep(Vec::new());
    }

    /// What a stretch said; at the end of its session that is recorded.
    fn hear(&mut self, stretch: &Stretch, result: Result<Box<Estimated>, String>, now: Instant) {
        let number = stretch.session.number;
        if self.heard.session != number {
            self.heard = Heard {
                session: number,
                estimate: None,
                changes: vec![Vec::new(); self.names.len()],
            };
        }
        let learns = self.belief.learns.is_some();
        let belief = Arc::make_mut(&mut self.belief);
        match result {
            Ok(estimated) => {
                let Estimated {
                    estimate,
                    next,
                    live,
                } = *estimated;
                belief.baseline = Some(next);
                belief.end_utc_s = Some(end_utc_s(stretch));
                self.refusal = None;
                let joints = self.heard.changes.iter_mut().zip(&estimate.joints);
                for (found, joint) in joints {
                    found.extend(joint.changes.iter().map(|change| Found {
                        time_utc_s: stretch.session.start.utc_s() + change.time_s,
                        change: change.clone(),
                    }));
                }
                self.heard.estimate = Some(estimate);
                if let Some(live) = live.filter(|_| !learns) {
                    let at_once = stretch.end == Some(SessionEnd::Lost);
                    self.live.succeed(live, at_once);
                }
            }
            Err(why) if stretch.worth_it => self.refusal = Some(why),
            Err(_) => {}
        }
        belief.sessions = belief.sessions.max(number);
        let records = match stretch.end {
            Some(_) => self.end_of(stretch, now),
            None => Vec::new(),
        };
        self.keep(records);
    }

    /// The records of a session that ended, and what they say of sudden changes.
    fn end_of(&mut self, stretch: &Stretch, now: Instant) -> Vec<Record> {
        let heard = std::mem::take(&mut self.heard);
        let belief = Arc::make_mut(&mut self.belief);
        if let Some(first) = self.pending.first() {
            // The session was of before the tensioning: it is heard first.
            belief.tendons.clone_from(&first.before);
        }
        let mut records = Vec::with_capacity(self.names.len());
        let mut confirmed = Vec::new();
        for (i, tendon) in belief.tendons.iter_mut().enumerate() {
            let transmission = self.robot.transmissions[self.elastic[i]].as_ref();
            let geometry = transmission.and_then(|t| t.tendon.as_ref());
            let joint = heard.estimate.as_ref().and_then(|e| e.joints.get(i));
            let told = match joint.map(|joint| joint.offset_rad) {
                _ if stretch.session.motion_s < TOO_SHORT_S => Err(NoOffset::TooShort),
                None => Err(NoOffset::Refused),
                Some(x) if session::Verdict::of(x) == session::Verdict::CannotTell => {
                    Err(NoOffset::TooWide)
                }
                Some(x) => Ok(x),
            };
            let said = Said {
                session: stretch.session.number,
                start_utc_s: stretch.session.start.utc_s(),
                end_utc_s: end_utc_s(stretch),
                offset_rad: told.ok(),
                stiffness_ratio: joint.map_or(UNKNOWN_STIFFNESS, |j| j.stiffness_change_ratio),
            };
            let changes = heard.changes.get(i).map_or(&[][..], Vec::as_slice);
            if let Verdict::Confirmed(suspected) = tendon.judge(&said, changes, geometry) {
                confirmed.push((i, suspected));
            }
            let elongation = geometry.zip(told.ok());
            let elongation = elongation.map(|(t, x)| x.scaled(t.joint_pulley_radius_m));
            let strain = geometry.zip(elongation).map(|(t, since)| {
                let whole = tendon.before_m.plus(since);
                whole.scaled(1.0 / t.length_m)
            });
            let stiffness = joint.map(|j| j.stiffness_change_ratio);
            let mean = |x: Option<Gaussian>| x.map(|x| x.mean);
            let deviation = |x: Option<Gaussian>| x.map(|x| x.deviation);
            records.push(Record {
                robot: self.config.name.clone(),
                robot_type: self.robot.name.clone(),
                joint: tendon.joint.clone(),
                time_utc_s: said.start_utc_s,
                duration_s: stretch.session.motion_s,
                offset_rad: mean(told.ok()),
                offset_deviation_rad: deviation(told.ok()),
                elongation_m: mean(elongation),
                elongation_deviation_m: deviation(elongation),
                strain_ratio: mean(strain),
                strain_deviation_ratio: deviation(strain),
                temperature_c: stretch.session.temperature_c(),
                stiffness_ratio: mean(stiffness),
                stiffness_deviation_ratio: deviation(stiffness),
                baseline: tendon.since.clone(),
                source: self.config.source.clone(),
                clock: stretch.session.clock,
                in_doubt: stretch.in_doubt,
                reason: told.err(),
                poses: stretch.session.poses as u64,
                frames: stretch.session.frames,
                frames_lost: stretch.session.frames_lost,
                sinew_version: env!("CARGO_PKG_VERSION").into(),
            });
        }
        if let Some(first) = self.pending.first_mut() {
            first.before.clone_from(&belief.tendons);
        }
        for pending in &self.pending {
            pending.apply(&mut belief.tendons, &self.robot, &self.elastic);
            confirmed.retain(|(i, _)| !pending.is_own(*i));
        }
        if self.waiting.iter().all(|s| s.baseline_of.is_some()) {
            self.pending.clear();
        }
        for (i, suspected) in confirmed {
            self.jumped(i, &suspected, now);
        }
        for record in &records {
            if self.history.push(record)
                && let Some(i) = self.names.iter().position(|name| *name == record.joint)
            {
                self.trends.changed(i);
            }
        }
        records
    }
}

fn end_utc_s(stretch: &Stretch) -> f64 {
    // Time of the blocks is that of the session: stamps give it, the civil clock its beginning.
    let last_s = stretch.recorded.blocks.last().map_or(0.0, |b| b.time_s);
    stretch.session.start.utc_s() + last_s
}
