//! State of a tendon between sessions: reference of its offset, and step changes.

use super::setup::Setup;
use crate::alarm::StepKind;
use crate::transaction::{PendingEvent, TendonState};
use sinew_estimate::session::{TendonChange, TendonChangeKind};
use sinew_model::Gaussian;
use sinew_model::transmission::Tendon;

/// Minimum size of a reported step change, rad; smaller steps occur in rope creep.
const MIN_STEP_RAD: f64 = 1e-3;
/// Minimum probability of a change within a session that is put up for confirmation.
const MIN_CHANGE_PROBABILITY: f64 = 0.5;
/// Minimum difference of two sessions that counts as a step change, in standard deviations of the difference.
const MIN_STEP_STDS: f64 = 4.0;
/// Quantile of the standard normal distribution, one-sided 95 %.
const Z_ONE_SIDED: f64 = 1.645;
/// Maximum number of inconclusive sessions, after which a suspected change is withdrawn.
const MAX_UNDECIDED_SESSIONS: u32 = 5;
/// Expected creep strain of a rope in its first year (standard deviation), as in the prior of the trend.
const FIRST_YEAR_CREEP_STRAIN: f64 = 1e-3;
/// Expected creep in the first year without tendon geometry, rad.
const FIRST_YEAR_CREEP_RAD: f64 = 30e-3;
/// Start of logarithmic creep after tensioning, s.
const CREEP_ONSET_S: f64 = 3600.0;
/// Logarithm of one year over [`CREEP_ONSET_S`].
const YEAR_E_FOLDS: f64 = 9.1;
/// Assumed age of a tensioning whose date is not recorded, s.
const DEFAULT_TENSIONING_AGE_S: f64 = 30.0 * 86_400.0;

/// Re-tensioning whose effect depends on the pending result of the session before.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PendingTensioning {
    /// States of the tendons before the re-tensioning.
    pub(super) before: Vec<TendonState>,
    /// Whether each tendon was re-tensioned.
    pub(super) tensioned: Vec<bool>,
    pub(super) replaced: bool,
    pub(super) utc_s: f64,
    /// Name of the new reference of the offsets.
    pub(super) name: String,
}

impl PendingTensioning {
    pub(super) fn is_tensioned(&self, i: usize) -> bool {
        self.tensioned.get(i).copied().unwrap_or(false)
    }

    /// Applies the re-tensioning to the states of the tendons.
    pub(super) fn apply(&self, tendons: &mut [TendonState], setup: &Setup) {
        for (i, tendon) in tendons.iter_mut().enumerate() {
            if self.is_tensioned(i) {
                tendon.tension(self, setup.geometry(i));
            }
        }
    }
}

/// Result of a session for a tendon, relative to the last tensioning.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SessionResult {
    /// Number of the session.
    pub(super) session: u64,
    /// Start of the session, s since 1970 UTC.
    pub(super) start_utc_s: f64,
    /// End of the session, s since 1970 UTC.
    pub(super) end_utc_s: f64,
    /// Offset at the end, rad; `None`: inconclusive.
    pub(super) offset_rad: Option<Gaussian>,
    /// Stiffness relative to nominal, minus 1.
    pub(super) stiffness_ratio: Gaussian,
}

impl TendonState {
    /// Creates the initial state of a tendon.
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

    /// Returns the offset before a possible unrecorded re-tensioning, otherwise the last one, rad.
    fn offset_before_tensioning(&self) -> Option<Gaussian> {
        let shorter = self.suspected.filter(|s| s.size_rad.mean < 0.0);
        shorter.map(|s| s.before_rad).or(self.last_rad)
    }

    /// Records a re-tensioning or a replacement.
    fn tension(&mut self, pending: &PendingTensioning, tendon: Option<&Tendon>) {
        /// Maximum number of stored tensionings per rope.
        const MAX_TENSIONINGS: usize = 100;
        let zero = Gaussian::new(0.0, 0.0);
        if pending.replaced {
            self.before_m = zero;
            self.replaced_utc_s = Some(pending.utc_s);
            self.tensioned_utc_s.clear();
        } else if let (Some(offset), Some(tendon)) = (self.offset_before_tensioning(), tendon) {
            let before_m = offset.scaled(tendon.joint_pulley_radius_m);
            self.before_m = self.before_m.plus(before_m);
        }
        self.tensioned_utc_s.push(pending.utc_s);
        let excess = self.tensioned_utc_s.len().saturating_sub(MAX_TENSIONINGS);
        self.tensioned_utc_s.drain(..excess);
        self.since = Some(pending.name.clone());
        (self.last_rad, self.last_utc_s, self.suspected) = (None, None, None);
    }

    /// Returns the time of the last tensioning, s since 1970 UTC.
    pub(super) fn last_tensioned_utc_s(&self) -> Option<f64> {
        self.tensioned_utc_s.last().copied()
    }

    /// Updates the state with the result of a session. Returns the step change that it confirms, if any.
    pub(super) fn update(
        &mut self,
        result: &SessionResult,
        changes: &[DatedChange],
        tendon: Option<&Tendon>,
    ) -> Option<PendingEvent> {
        let was = self.suspected;
        let confirmed = match (was, result.offset_rad) {
            (Some(suspected), Some(offset)) if suspected.session != result.session => {
                self.decide(suspected, offset, result, tendon)
            }
            _ => None,
        };
        if self.suspected.is_none() {
            let within = within(changes, result, self.last_rad);
            // A withdrawn change is not a change in the opposite direction.
            let between = was.is_none().then(|| self.between(result, tendon));
            self.suspected = within.or(between.flatten());
        }
        if let Some(offset) = result.offset_rad {
            self.last_rad = Some(offset);
            self.last_utc_s = Some(result.end_utc_s);
        }
        confirmed
    }

    /// Confirms or withdraws a suspected change. Returns it if confirmed.
    fn decide(
        &mut self,
        suspected: PendingEvent,
        offset: Gaussian,
        result: &SessionResult,
        tendon: Option<&Tendon>,
    ) -> Option<PendingEvent> {
        let lasts = if suspected.size_rad.mean.abs() >= MIN_STEP_RAD {
            let creep = self.creep_std_rad(suspected.time_utc_s, result.end_utc_s, tendon);
            lasts(suspected.size_rad, suspected.before_rad, offset, creep)
        } else {
            // Stiffness loss alone counts as permanent until a session contradicts it.
            suspected.stiffness_ratio.and_then(|lost| {
                let before = Gaussian::new(suspected.stiffness_before_ratio, 0.0);
                lasts(
                    Gaussian::new(lost, 0.0),
                    before,
                    result.stiffness_ratio,
                    0.0,
                )
            })
        };
        let undecided = suspected.undecided + 1;
        let waits = lasts.is_none() && undecided < MAX_UNDECIDED_SESSIONS;
        self.suspected = waits.then_some(PendingEvent {
            undecided,
            ..suspected
        });
        (lasts == Some(true)).then_some(suspected)
    }

    /// Returns a change since the last session that creep does not explain.
    fn between(&self, result: &SessionResult, tendon: Option<&Tendon>) -> Option<PendingEvent> {
        let (now, last, at_s) = (result.offset_rad?, self.last_rad?, self.last_utc_s?);
        let creep = self.creep_std_rad(at_s, result.end_utc_s, tendon);
        let size = now.plus(last.scaled(-1.0));
        let usual = match size.mean > 0.0 {
            true => size.std.hypot(creep),
            false => size.std,
        };
        if !(size.mean.abs() > MIN_STEP_STDS * usual && size.mean.abs() >= MIN_STEP_RAD) {
            return None;
        }
        // Ropes do not shorten: a is_reportable decrease of the offset is an unrecorded re-tensioning.
        const MIN_RETENSION_SHARE: f64 = 0.5;
        let is_retensioned =
            last.mean > last.half_width_95() && -size.mean > MIN_RETENSION_SHARE * last.mean;
        Some(PendingEvent {
            time_utc_s: result.start_utc_s,
            before_rad: last,
            size_rad: size,
            what: match is_retensioned {
                true => StepKind::Retensioned,
                false => StepKind::WhileOff,
            },
            cause: None,
            stiffness_ratio: None,
            stiffness_before_ratio: result.stiffness_ratio.mean,
            session: result.session,
            undecided: 0,
        })
    }

    /// Returns the expected creep between two times (standard deviation), rad.
    fn creep_std_rad(&self, from_utc_s: f64, to_utc_s: f64, tendon: Option<&Tendon>) -> f64 {
        let year_rad = tendon.map_or(FIRST_YEAR_CREEP_RAD, |t| {
            FIRST_YEAR_CREEP_STRAIN * t.length_m / t.joint_pulley_radius_m
        });
        let since = self.last_tensioned_utc_s();
        let began = since.unwrap_or(from_utc_s - DEFAULT_TENSIONING_AGE_S);
        let age = |utc_s: f64| (utc_s - began).max(0.0) + CREEP_ONSET_S;
        year_rad / YEAR_E_FOLDS * (age(to_utc_s) / age(from_utc_s)).ln().max(0.0)
    }
}

/// Whether a change of `size` from `before` is still present at `now`; `None`: inconclusive.
fn lasts(size: Gaussian, before: Gaussian, now: Gaussian, creep_rad: f64) -> Option<bool> {
    let share = (now.mean - before.mean) / size.mean;
    let std = now.std.hypot(before.std).hypot(creep_rad) / size.mean.abs();
    if share - Z_ONE_SIDED * std > 0.5 {
        Some(true)
    } else if share + Z_ONE_SIDED * std < 0.5 {
        Some(false)
    } else {
        None
    }
}

/// Change within a session, with its date.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct DatedChange {
    /// Time of the change, s since 1970 UTC.
    pub(super) time_utc_s: f64,
    /// Change as estimated.
    pub(super) change: TendonChange,
}

/// Returns the loss of the transmission in the changes of a session, if any, with its time.
pub(super) fn transmission_loss(dated: &DatedChange, session: u64) -> Option<PendingEvent> {
    /// Minimum probability of a loss that raises an alarm without confirmation.
    const MIN_PROBABILITY: f64 = 0.95;
    let change = &dated.change;
    let is_lost = change.kind == TendonChangeKind::TransmissionLost
        && change.probability.is_some_and(|p| p >= MIN_PROBABILITY);
    let none = Gaussian::new(0.0, 0.0);
    is_lost.then_some(PendingEvent {
        time_utc_s: dated.time_utc_s,
        before_rad: none,
        size_rad: none,
        what: StepKind::TransmissionLost,
        cause: None,
        stiffness_ratio: None,
        stiffness_before_ratio: 0.0,
        session,
        undecided: 0,
    })
}

/// Returns the largest reportable change of a session, if any.
///
/// * `last`: offset of the session before, rad, used where this session is inconclusive.
fn within(
    changes: &[DatedChange],
    result: &SessionResult,
    last: Option<Gaussian>,
) -> Option<PendingEvent> {
    let candidates = changes.iter().filter_map(|dated| {
        let change = &dated.change;
        let size = change.size_rad.unwrap_or(Gaussian::new(0.0, 0.0));
        let what = match change.kind {
            TendonChangeKind::Slip => StepKind::Slip,
            TendonChangeKind::StrandFailure | TendonChangeKind::StiffnessLoss => {
                StepKind::StrandFailure
            }
            TendonChangeKind::SlipOrStrandFailure => StepKind::SlipOrStrandFailure,
            // Needs no confirmation.
            TendonChangeKind::TransmissionLost => return None,
            TendonChangeKind::Retensioned => StepKind::Retensioned,
            TendonChangeKind::Stiffer | TendonChangeKind::StiffnessIncrease => return None,
        };
        let lost = change.stiffness_change_ratio.map(|ratio| ratio.mean);
        let is_probable = change
            .probability
            .is_none_or(|p| p >= MIN_CHANGE_PROBABILITY);
        let is_reportable = size.mean.abs() >= MIN_STEP_RAD || what == StepKind::StrandFailure;
        let before = |now: Gaussian| Gaussian::new(now.mean - size.mean, now.std);
        let before_rad = result.offset_rad.map(before).or(last)?;
        (is_probable && is_reportable).then_some(PendingEvent {
            time_utc_s: dated.time_utc_s,
            before_rad,
            size_rad: size,
            what,
            cause: change.cause,
            stiffness_ratio: lost,
            stiffness_before_ratio: result.stiffness_ratio.mean - lost.unwrap_or(0.0),
            session: result.session,
            undecided: 0,
        })
    });
    candidates.max_by(|a, b| {
        let size = |s: &PendingEvent| s.size_rad.mean.abs();
        size(a).total_cmp(&size(b))
    })
}
