//! What is believed of a tendon between sessions: what its offset counts from, and sudden changes.

use super::setup::Setup;
use crate::alarm::JumpKind;
use crate::transaction::{Suspected, TendonBelief};
use sinew_estimate::session::{TendonChange, TendonChangeKind};
use sinew_model::Gaussian;
use sinew_model::transmission::Tendon;

/// Less than this is taken in without a word: ropes creep by steps, rad.
const WORD_RAD: f64 = 1e-3;
/// A change within a session that is likelier than this waits for another session.
const LIKELY: f64 = 0.5;
/// Two sessions differ from so many standard deviations of their difference on.
const CLEAR: f64 = 4.0;
/// One-sided 95 %.
const Z_ONE_SIDED: f64 = 1.645;
/// Sessions that can't say whether a change lasts, after which it is let go.
const UNDECIDED_MOST: u32 = 5;
/// A rope's creep in a first year that surprises nobody: strain, as the trend's prior has it.
const CREEP_STRAIN: f64 = 1e-3;
/// The same without tendon geometry, rad.
const CREEP_RAD: f64 = 30e-3;
/// Creep goes by the logarithm of time from an hour on, s; a year is so many e-folds later.
const CREEP_FROM_S: f64 = 3600.0;
const YEAR_E_FOLDS: f64 = 9.1;
/// A tendon of which nobody said when it was tensioned has been for so long, s.
const LONG_AGO_S: f64 = 30.0 * 86_400.0;

/// A tensioning: what is believed after it hangs on what the session before says in the end.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pending {
    /// Tendons before it.
    pub(super) before: Vec<TendonBelief>,
    /// Which of them were tensioned.
    pub(super) own: Vec<bool>,
    pub(super) replaced: bool,
    pub(super) utc_s: f64,
    /// Name of what their offsets count from then.
    pub(super) name: String,
}

impl Pending {
    pub(super) fn is_own(&self, i: usize) -> bool {
        self.own.get(i).copied().unwrap_or(false)
    }

    /// Makes of tendons before it those after it.
    pub(super) fn apply(&self, tendons: &mut [TendonBelief], setup: &Setup) {
        for (i, tendon) in tendons.iter_mut().enumerate() {
            if self.is_own(i) {
                tendon.tension(self, setup.geometry(i));
            }
        }
    }
}

/// What a session said of a tendon, since it was last tensioned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Said {
    /// Number of the session.
    pub(super) session: u64,
    /// Its start, s since 1970 UTC.
    pub(super) start_utc_s: f64,
    /// Its end, s since 1970 UTC.
    pub(super) end_utc_s: f64,
    /// Offset at the end, rad; `None`: it couldn't tell.
    pub(super) offset_rad: Option<Gaussian>,
    /// Stiffness over nominal less 1.
    pub(super) stiffness_ratio: Gaussian,
}

impl TendonBelief {
    /// Nothing is known but the joint.
    pub(super) fn new(joint: &str, since: Option<String>) -> Self {
        let zero = Gaussian::new(0.0, 0.0);
        Self {
            joint: joint.into(),
            since,
            tensioned_utc_s: Vec::new(),
            replaced_utc_s: None,
            before_m: zero,
            last_rad: None,
            last_utc_s: None,
            suspected: None,
        }
    }

    /// Offset before what may have been an unstated tensioning, or the last one.
    fn offset_before_tensioning(&self) -> Option<Gaussian> {
        let shorter = self.suspected.filter(|s| s.size_rad.mean < 0.0);
        shorter.map(|s| s.before_rad).or(self.last_rad)
    }

    /// It was tensioned or replaced.
    fn tension(&mut self, pending: &Pending, tendon: Option<&Tendon>) {
        /// Tensionings of a rope that are kept.
        const KEPT: usize = 100;
        let zero = Gaussian::new(0.0, 0.0);
        if pending.replaced {
            self.before_m = zero;
            self.replaced_utc_s = Some(pending.utc_s);
            self.tensioned_utc_s.clear();
        } else if let (Some(offset), Some(tendon)) = (self.offset_before_tensioning(), tendon) {
            let more = offset.scaled(tendon.joint_pulley_radius_m);
            self.before_m = self.before_m.plus(more);
        }
        self.tensioned_utc_s.push(pending.utc_s);
        let excess = self.tensioned_utc_s.len().saturating_sub(KEPT);
        self.tensioned_utc_s.drain(..excess);
        self.since = Some(pending.name.clone());
        (self.last_rad, self.last_utc_s, self.suspected) = (None, None, None);
    }

    /// When it was last tensioned.
    pub(super) fn last_tensioned_utc_s(&self) -> Option<f64> {
        self.tensioned_utc_s.last().copied()
    }

    /// Takes what a session said. Returns the change that it confirms, if any.
    pub(super) fn judge(
        &mut self,
        said: &Said,
        changes: &[Found],
        tendon: Option<&Tendon>,
    ) -> Option<Suspected> {
        let was = self.suspected;
        let confirmed = match (was, said.offset_rad) {
            (Some(suspected), Some(offset)) if suspected.session != said.session => {
                self.decide(suspected, offset, said, tendon)
            }
            _ => None,
        };
        if self.suspected.is_none() {
            let within = within(changes, said, self.last_rad);
            // A change that is gone again is no change the other way.
            let between = was.is_none().then(|| self.between(said, tendon));
            self.suspected = within.or(between.flatten());
        }
        if let Some(offset) = said.offset_rad {
            self.last_rad = Some(offset);
            self.last_utc_s = Some(said.end_utc_s);
        }
        confirmed
    }

    /// Decides whether a suspected change lasts. Returns it where it does.
    fn decide(
        &mut self,
        suspected: Suspected,
        offset: Gaussian,
        said: &Said,
        tendon: Option<&Tendon>,
    ) -> Option<Suspected> {
        let lasts = if suspected.size_rad.mean.abs() >= WORD_RAD {
            let creep = self.creep_deviation_rad(suspected.time_utc_s, said.end_utc_s, tendon);
            lasts(suspected.size_rad, suspected.before_rad, offset, creep)
        } else {
            // Stiffness alone: it is believed until a session sees it come back.
            suspected.stiffness_ratio.and_then(|lost| {
                let before = Gaussian::new(suspected.stiffness_before_ratio, 0.0);
                lasts(Gaussian::new(lost, 0.0), before, said.stiffness_ratio, 0.0)
            })
        };
        let undecided = suspected.undecided + 1;
        let waits = lasts.is_none() && undecided < UNDECIDED_MOST;
        self.suspected = waits.then_some(Suspected {
            undecided,
            ..suspected
        });
        (lasts == Some(true)).then_some(suspected)
    }

    /// A change since the last session that creep doesn't explain.
    fn between(&self, said: &Said, tendon: Option<&Tendon>) -> Option<Suspected> {
        let (now, last, at_s) = (said.offset_rad?, self.last_rad?, self.last_utc_s?);
        let creep = self.creep_deviation_rad(at_s, said.end_utc_s, tendon);
        let size = now.plus(last.scaled(-1.0));
        let usual = match size.mean > 0.0 {
            true => size.deviation.hypot(creep),
            false => size.deviation,
        };
        if !(size.mean.abs() > CLEAR * usual && size.mean.abs() >= WORD_RAD) {
            return None;
        }
        // Ropes don't shorten: much of the offset gone is a tensioning nobody spoke of.
        const MUCH: f64 = 0.5;
        let tensioned = last.mean > last.half_width_95() && -size.mean > MUCH * last.mean;
        Some(Suspected {
            time_utc_s: said.start_utc_s,
            before_rad: last,
            size_rad: size,
            what: match tensioned {
                true => JumpKind::Retensioned,
                false => JumpKind::WhileOff,
            },
            cause: None,
            stiffness_ratio: None,
            stiffness_before_ratio: said.stiffness_ratio.mean,
            session: said.session,
            undecided: 0,
        })
    }

    /// Creep between two times that surprises nobody, rad.
    fn creep_deviation_rad(&self, from_utc_s: f64, to_utc_s: f64, tendon: Option<&Tendon>) -> f64 {
        let year_rad = tendon.map_or(CREEP_RAD, |t| {
            CREEP_STRAIN * t.length_m / t.joint_pulley_radius_m
        });
        let since = self.last_tensioned_utc_s();
        let began = since.unwrap_or(from_utc_s - LONG_AGO_S);
        let age = |utc_s: f64| (utc_s - began).max(0.0) + CREEP_FROM_S;
        year_rad / YEAR_E_FOLDS * (age(to_utc_s) / age(from_utc_s)).ln().max(0.0)
    }
}

/// Whether a change of `size` from `before` is still there at `now`; `None`: it can't be told.
fn lasts(size: Gaussian, before: Gaussian, now: Gaussian, creep_rad: f64) -> Option<bool> {
    let share = (now.mean - before.mean) / size.mean;
    let deviation = now.deviation.hypot(before.deviation).hypot(creep_rad) / size.mean.abs();
    if share - Z_ONE_SIDED * deviation > 0.5 {
        Some(true)
    } else if share + Z_ONE_SIDED * deviation < 0.5 {
        Some(false)
    } else {
        None
    }
}

/// A change within a session, dated.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Found {
    /// When, s since 1970 UTC.
    pub(super) time_utc_s: f64,
    /// What the estimate says.
    pub(super) change: TendonChange,
}

/// The change of a session that is worth a word, if any: the largest one.
///
/// * `last`: offset of the session before, rad, where this one could not tell its own.
fn within(changes: &[Found], said: &Said, last: Option<Gaussian>) -> Option<Suspected> {
    let words = changes.iter().filter_map(|found| {
        let change = &found.change;
        let size = change.size_rad.unwrap_or(Gaussian::new(0.0, 0.0));
        let what = match change.kind {
            TendonChangeKind::Slip => JumpKind::Slip,
            TendonChangeKind::StrandFailure | TendonChangeKind::SofterSinceBefore => {
                JumpKind::StrandFailure
            }
            TendonChangeKind::SlipOrStrandFailure => JumpKind::SlipOrStrandFailure,
            TendonChangeKind::Retensioned => JumpKind::Retensioned,
            TendonChangeKind::Stiffer | TendonChangeKind::StifferSinceBefore => return None,
        };
        let lost = change.stiffness_change_ratio.map(|ratio| ratio.mean);
        let likely = change.probability.is_none_or(|p| p >= LIKELY);
        let large = size.mean.abs() >= WORD_RAD || what == JumpKind::StrandFailure;
        let before = |now: Gaussian| Gaussian::new(now.mean - size.mean, now.deviation);
        let before_rad = said.offset_rad.map(before).or(last)?;
        (likely && large).then_some(Suspected {
            time_utc_s: found.time_utc_s,
            before_rad,
            size_rad: size,
            what,
            cause: change.cause,
            stiffness_ratio: lost,
            stiffness_before_ratio: said.stiffness_ratio.mean - lost.unwrap_or(0.0),
            session: said.session,
            undecided: 0,
        })
    });
    words.max_by(|a, b| {
        let size = |s: &Suspected| s.size_rad.mean.abs();
        size(a).total_cmp(&size(b))
    })
}
