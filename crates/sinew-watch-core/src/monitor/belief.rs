//! What is believed of the tendons: a chain of estimates, each from where the last one ended.

use super::baseline::BaselineProgress;
use super::config::MonitorError;
use super::job::{Estimated, Job, Learns, StretchWork, Work};
use super::online::Successor;
use super::session::{Sessions, Stretch};
use super::setup::Setup;
use super::tendon::{Found, Pending, Said};
use crate::instant::Instant;
use crate::journal::{BaselineWaits, Event, SessionEnd};
use crate::record::{NoOffset, Record};
use crate::transaction::{Belief, LearnsBaseline, Suspected, TendonBelief};
use sinew_estimate::session::{self, SessionEstimate, Since, estimator};
use sinew_files::date::{DAY_S, utc_text};
use sinew_model::Gaussian;
use std::sync::Arc;

/// What a session without an estimate says of a stiffness.
const UNKNOWN_STIFFNESS: Gaussian = Gaussian {
    mean: 0.0,
    deviation: 1.0,
};
/// A session with less motion says nothing, s.
const TOO_SHORT_S: f64 = 10.0;

/// What is believed of the tendons, and what is on its way to it.
#[derive(Debug)]
pub(super) struct BeliefChain {
    belief: Arc<Belief>,
    /// What the session under way said so far.
    heard: Heard,
    /// A baseline on its way.
    pub(super) baseline: Option<BaselineProgress>,
    /// Tensionings since the monitor began.
    pub(super) tensionings: u32,
    /// Tensionings whose tendons wait for the last word on what was before.
    pending: Vec<Pending>,
    /// Whether the estimate of a stretch is under way that isn't for a baseline.
    hears: bool,
    /// Why the estimator refused the last stretch.
    pub(super) refusal: Option<String>,
}

/// What the stretches of a session said so far.
#[derive(Debug, Default)]
struct Heard {
    /// Number of the session.
    session: u64,
    /// The last estimate.
    estimate: Option<SessionEstimate>,
    /// Sudden changes, tendon by tendon.
    changes: Vec<Vec<Found>>,
}

/// What an estimate changed, for the other parts of the monitor.
#[derive(Debug, Default)]
pub(super) struct Changes {
    pub(super) event: Option<Event>,
    /// An estimate of now that takes over, and whether at once.
    pub(super) successor: Option<(Successor, bool)>,
    /// Sudden changes that were confirmed, by tendon.
    pub(super) jumps: Vec<(usize, Suspected)>,
    pub(super) records: Vec<Record>,
    /// Whether the belief is another one.
    pub(super) belief: bool,
}

impl BeliefChain {
    /// A chain that goes on from what was stored; and why that is left alone, where it is.
    pub(super) fn new(
        setup: &Setup,
        stored: Option<Belief>,
    ) -> Result<(Self, Option<String>), MonitorError> {
        let (belief, left) = begin(setup, stored)?;
        let chain = Self {
            heard: Heard::default(),
            baseline: BaselineProgress::of(&belief, setup.joints()),
            tensionings: 0,
            pending: Vec::new(),
            hears: false,
            refusal: None,
            belief: Arc::new(belief),
        };
        Ok((chain, left))
    }

    pub(super) fn belief(&self) -> &Arc<Belief> {
        &self.belief
    }

    /// The number of the tensioning whose baseline motion of now is for, if it is for one.
    pub(super) fn baseline_of(&self) -> Option<u32> {
        self.baseline.as_ref().map(|_| self.tensionings)
    }

    /// Whether a stretch was for a baseline, and a rope was tensioned since: it is no part of the one after that.
    pub(super) fn is_outdated(&self, stretch: &Stretch) -> bool {
        stretch.baseline_of.is_some_and(|of| of != self.tensionings)
    }

    /// Whether a stretch is for a baseline that is to be learned still.
    fn is_learning(&self, stretch: &Stretch) -> bool {
        stretch.baseline_of.is_some() && self.belief.learns.is_some()
    }

    fn baseline_waits(&mut self, why: BaselineWaits, setup: &Setup) -> Option<Event> {
        // What it rests on is what was learned before.
        self.baseline = BaselineProgress::of(&self.belief, setup.joints());
        Some(Event::BaselineWaits { why })
    }

    /// Takes a stretch of which only the session's end is to be heard.
    pub(super) fn without_motion(
        &mut self,
        stretch: &Stretch,
        setup: &Setup,
        sessions: &Sessions,
    ) -> Changes {
        match self.is_learning(stretch) {
            true => Changes {
                event: self.baseline_waits(BaselineWaits::FewPoses, setup),
                ..Changes::default()
            },
            false => self.hear(stretch, Err("too short".into()), setup, sessions),
        }
    }

    /// The estimate to make of a stretch.
    pub(super) fn stretch_job(&mut self, stretch: Stretch, setup: &Setup) -> Job {
        self.hears = stretch.baseline_of.is_none();
        Job {
            robot: Arc::clone(&setup.robot),
            work: Work::Stretch(Box::new(self.stretch_work(stretch, setup))),
        }
    }

    fn stretch_work(&self, stretch: Stretch, setup: &Setup) -> StretchWork {
        let goes_on = self.heard.session == stretch.session.number && self.heard.estimate.is_some();
        let start_utc_s = stretch.session.start.utc_s();
        let pause_s = self.belief.end_utc_s.map(|end| start_utc_s - end);
        // A baseline from a file is of another day; so is what a clock says that stepped back.
        let days = pause_s.filter(|s| *s >= 0.0).map_or(1.0, |s| s / DAY_S);
        let date = utc_text(stretch.session.start.utc_ns);
        let date = date.as_deref().unwrap_or("undated");
        let learns = self.belief.learns.as_ref();
        let learns = learns.filter(|_| self.is_learning(&stretch));
        StretchWork {
            options: setup.config.estimate,
            baseline: self.belief.baseline.clone(),
            since: match goes_on {
                true => Since::Now,
                false => Since::Days(days),
            },
            learns: learns.map(|so_far| Learns {
                tensioned: (setup.names.iter().zip(&setup.elastic))
                    .filter(|(name, _)| so_far.joints.contains(name))
                    .map(|(_, joint)| *joint)
                    .collect(),
                continues: so_far.duration_s > 0.0,
            }),
            name: format!("{}, {date}", setup.config.name),
            stretch,
        }
    }

    /// Takes the estimate of a stretch, `learned` for a baseline.
    pub(super) fn done(
        &mut self,
        stretch: &Stretch,
        learned: bool,
        result: Result<Box<Estimated>, String>,
        setup: &Setup,
        sessions: &Sessions,
    ) -> Changes {
        self.hears = false;
        match learned {
            true if self.is_outdated(stretch) => Changes::default(),
            true => self.learn(stretch, result, setup, sessions),
            false => self.hear(stretch, result, setup, sessions),
        }
    }

    /// Takes a stretch of motion after tensioning: the baseline, or a part of it.
    fn learn(
        &mut self,
        stretch: &Stretch,
        result: Result<Box<Estimated>, String>,
        setup: &Setup,
        sessions: &Sessions,
    ) -> Changes {
        let mut changes = Changes::default();
        let estimated = match result {
            Ok(estimated) => estimated,
            Err(why) => {
                self.refusal = Some(why);
                changes.event = self.baseline_waits(BaselineWaits::Refused, setup);
                return changes;
            }
        };
        self.refusal = None;
        let so_far = BaselineProgress::of(&self.belief, setup.joints());
        let so_far = so_far.map(|progress| progress.with(stretch));
        let belief = Arc::make_mut(&mut self.belief);
        belief.baseline = Some(estimated.next);
        belief.end_utc_s = Some(end_utc_s(stretch));
        belief.sessions = sessions.count();
        belief.learns = so_far.as_ref().map(BaselineProgress::so_far);
        if let Some(ready) = so_far.filter(BaselineProgress::is_ready) {
            belief.learns = None;
            self.baseline = None;
            changes.successor = estimated.successor.map(|next| (next, true));
            let poses = ready.poses();
            changes.event = Some(Event::Baseline { poses });
        } else if stretch.end.is_some() {
            changes.event = self.baseline_waits(BaselineWaits::FewPoses, setup);
        }
        changes.belief = true;
        changes
    }

    /// Takes what a stretch said; at the end of its session that is recorded.
    fn hear(
        &mut self,
        stretch: &Stretch,
        result: Result<Box<Estimated>, String>,
        setup: &Setup,
        sessions: &Sessions,
    ) -> Changes {
        let mut changes = Changes {
            belief: true,
            ..Changes::default()
        };
        let number = stretch.session.number;
        if self.heard.session != number {
            self.heard = Heard {
                session: number,
                estimate: None,
                changes: vec![Vec::new(); setup.names.len()],
            };
        }
        let belief = Arc::make_mut(&mut self.belief);
        match result {
            Ok(estimated) => {
                let Estimated {
                    estimate,
                    next,
                    successor,
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
                let at_once = stretch.end == Some(SessionEnd::Lost);
                let successor = successor.filter(|_| belief.learns.is_none());
                changes.successor = successor.map(|next| (next, at_once));
            }
            Err(why) if stretch.worth_it => self.refusal = Some(why),
            Err(_) => {}
        }
        belief.sessions = belief.sessions.max(number);
        if stretch.end.is_some() {
            self.end_session(stretch, setup, sessions, &mut changes);
        }
        changes
    }

    /// Makes the records of a session that ended, and finds what they say of sudden changes.
    fn end_session(
        &mut self,
        stretch: &Stretch,
        setup: &Setup,
        sessions: &Sessions,
        changes: &mut Changes,
    ) {
        let heard = std::mem::take(&mut self.heard);
        let belief = Arc::make_mut(&mut self.belief);
        if let Some(first) = self.pending.first() {
            // The session was of before the tensioning: it is heard first.
            belief.tendons.clone_from(&first.before);
        }
        for (i, tendon) in belief.tendons.iter_mut().enumerate() {
            let joint = heard.estimate.as_ref().and_then(|e| e.joints.get(i));
            let offset = match joint.map(|joint| joint.offset_rad) {
                _ if stretch.session.motion_s < TOO_SHORT_S => Err(NoOffset::TooShort),
                None => Err(NoOffset::Refused),
                Some(x) if session::Verdict::of(x) == session::Verdict::CannotTell => {
                    Err(NoOffset::TooWide)
                }
                Some(x) => Ok(x),
            };
            let stiffness = joint.map(|joint| joint.stiffness_change_ratio);
            let said = Said {
                session: stretch.session.number,
                start_utc_s: stretch.session.start.utc_s(),
                end_utc_s: end_utc_s(stretch),
                offset_rad: offset.ok(),
                stiffness_ratio: stiffness.unwrap_or(UNKNOWN_STIFFNESS),
            };
            let found = heard.changes.get(i).map_or(&[][..], Vec::as_slice);
            let confirmed = tendon.judge(&said, found, setup.geometry(i));
            changes.jumps.extend(confirmed.map(|jump| (i, jump)));
            let record = record(stretch, setup, (i, tendon), offset, stiffness);
            changes.records.push(record);
        }
        if let Some(first) = self.pending.first_mut() {
            first.before.clone_from(&belief.tendons);
        }
        for pending in &self.pending {
            pending.apply(&mut belief.tendons, setup);
            changes.jumps.retain(|(i, _)| !pending.is_own(*i));
        }
        if !sessions.has_waiting() {
            self.pending.clear();
        }
    }

    /// Begins the next baseline: ropes were tensioned or replaced. Returns which tendons they are.
    pub(super) fn tension(
        &mut self,
        joints: &[String],
        replaced: bool,
        setup: &Setup,
        sessions: &Sessions,
        now: Instant,
    ) -> Vec<usize> {
        let name = utc_text(now.utc_ns).unwrap_or_else(|| "undated".into());
        let is_own = |name: &String| joints.is_empty() || joints.contains(name);
        let pending = Pending {
            before: self.belief.tendons.clone(),
            own: setup.names.iter().map(is_own).collect(),
            replaced,
            utc_s: now.utc_s(),
            name: format!("tensioned {name}"),
        };
        let own: Vec<usize> = (0..setup.names.len())
            .filter(|i| pending.is_own(*i))
            .collect();
        let belief = Arc::make_mut(&mut self.belief);
        pending.apply(&mut belief.tendons, setup);
        // Of ropes whose baseline isn't complete, one tensioned meanwhile begins it anew.
        let mut joints = belief.learns.take().map_or_else(Vec::new, |l| l.joints);
        for name in own.iter().map(|i| &setup.names[*i]) {
            if !joints.contains(name) {
                joints.push(name.clone());
            }
        }
        belief.learns = Some(LearnsBaseline {
            joints,
            ..LearnsBaseline::default()
        });
        self.tensionings += 1;
        self.baseline = BaselineProgress::of(belief, setup.joints());
        // Motion from before is estimated still, or waits for it: its last word on the tendons is to come. What was for a
        // baseline says nothing of them, and a trend doesn't either.
        if self.hears || sessions.has_waiting() {
            self.pending.push(pending);
        }
        own
    }
}

/// The record of a tendon at the end of a session.
fn record(
    stretch: &Stretch,
    setup: &Setup,
    (i, tendon): (usize, &TendonBelief),
    offset: Result<Gaussian, NoOffset>,
    stiffness: Option<Gaussian>,
) -> Record {
    let session = &stretch.session;
    let stretched = setup.stretch(i, tendon.before_m, offset.ok());
    let (elongation, strain) = (stretched.map(|s| s.0), stretched.map(|s| s.1));
    let mean = |x: Option<Gaussian>| x.map(|x| x.mean);
    let deviation = |x: Option<Gaussian>| x.map(|x| x.deviation);
    Record {
        robot: setup.config.name.clone(),
        robot_type: setup.robot.name.clone(),
        joint: tendon.joint.clone(),
        time_utc_s: session.start.utc_s(),
        duration_s: session.motion_s,
        offset_rad: mean(offset.ok()),
        offset_deviation_rad: deviation(offset.ok()),
        elongation_m: mean(elongation),
        elongation_deviation_m: deviation(elongation),
        strain_ratio: mean(strain),
        strain_deviation_ratio: deviation(strain),
        temperature_c: session.temperature_c(),
        stiffness_ratio: mean(stiffness),
        stiffness_deviation_ratio: deviation(stiffness),
        baseline: tendon.since.clone(),
        source: setup.config.source.clone(),
        clock: session.clock,
        in_doubt: stretch.in_doubt,
        reason: offset.err(),
        poses: session.poses as u64,
        frames: session.frames,
        frames_lost: session.frames_lost,
        sinew_version: env!("CARGO_PKG_VERSION").into(),
    }
}

/// What a monitor begins with, and why what was stored is left alone.
fn begin(setup: &Setup, stored: Option<Belief>) -> Result<(Belief, Option<String>), MonitorError> {
    let Setup {
        config,
        robot,
        names,
        ..
    } = setup;
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

/// When a stretch ended, s since 1970 UTC: its stamps give the time of the blocks, the civil clock its beginning.
fn end_utc_s(stretch: &Stretch) -> f64 {
    let last_s = stretch.recorded.blocks.last().map_or(0.0, |b| b.time_s);
    stretch.session.start.utc_s() + last_s
}
