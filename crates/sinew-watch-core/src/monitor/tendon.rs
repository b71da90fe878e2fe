//! State of a tendon between sessions: reference of its offset, and step changes.

use super::evidence::{ChangePosterior, SuspectedChangeState};
use super::setup::Setup;
use crate::alarm::StepKind;
use crate::incident::Evidence;
use crate::transaction::{LevelSums, PendingEvent, TendonState};
use sinew_estimate::Cause;
use sinew_estimate::session::{TendonChange, TendonChangeKind};
use sinew_model::transmission::Tendon;
use sinew_model::{Gaussian, Z95};

/// Minimum size of a reported step change, rad; smaller steps occur in rope creep.
const MIN_STEP_RAD: f64 = 1e-3;
/// Minimum probability of a change within a session that is put up for confirmation.
const MIN_CHANGE_PROBABILITY: f64 = 0.5;
/// Minimum difference of two sessions that counts as a step change, in standard deviations of the difference.
const MIN_STEP_STDS: f64 = 4.0;
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
    /// Whether the states in `before` of the re-tensioned tendons are final: the work precedes the pending session.
    pub(super) precedes: bool,
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
                if let Some(before) = self.before.get(i).filter(|_| self.precedes) {
                    tendon.clone_from(before);
                }
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
            last_from_utc_s: None,
            last_stiffness_ratio: None,
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
        self.discard_last();
    }

    /// Discards the last offset and the suspected change, because the reference of the offset changed.
    pub(super) fn discard_last(&mut self) {
        (self.last_rad, self.last_utc_s, self.suspected) = (None, None, None);
        (self.last_from_utc_s, self.last_stiffness_ratio) = (None, None);
    }

    /// Returns the time of the last tensioning, s since 1970 UTC.
    pub(super) fn last_tensioned_utc_s(&self) -> Option<f64> {
        self.tensioned_utc_s.last().copied()
    }

    /// Updates the state with the result of a session. Returns the new or changed suspected change, if any.
    pub(super) fn update(
        &mut self,
        result: &SessionResult,
        changes: &[DatedChange],
        tendon: Option<&Tendon>,
    ) -> Option<SuspectedChange> {
        let was = self.suspected;
        let decided = match was {
            Some(suspected) if suspected.session != result.session => {
                self.decide(suspected, result, tendon)
            }
            _ => None,
        };
        let mut new = None;
        if self.suspected.is_none() {
            // A stiffness loss before the session is that of the change just decided.
            let is_new =
                |dated: &&DatedChange| decided.is_none() || dated.change.size_rad.is_some();
            let within = self.within(changes.iter().filter(is_new), result, tendon);
            // A refuted change is not a change in the opposite direction.
            let between = was.is_none().then(|| self.between(result, tendon));
            self.suspected = within.or(between.flatten());
            new = self
                .suspected
                .map(|event| SuspectedChange::new(event, result));
        }
        if let Some(offset) = result.offset_rad {
            self.last_rad = Some(offset);
            self.last_utc_s = Some(result.end_utc_s);
            self.last_from_utc_s = Some(result.start_utc_s);
            self.last_stiffness_ratio = Some(result.stiffness_ratio);
        }
        decided.or(new)
    }

    /// Adds the evidence of a session to a suspected change, and ends it if it is confirmed or refuted.
    fn decide(
        &mut self,
        mut suspected: PendingEvent,
        result: &SessionResult,
        tendon: Option<&Tendon>,
    ) -> Option<SuspectedChange> {
        let creep = self.creep(
            suspected.time_utc_s,
            result.end_utc_s,
            suspected.before_rad,
            tendon,
        );
        let (offset_rad, stiffness) = (result.offset_rad, result.stiffness_ratio);
        suspected.add_session(offset_rad, creep.std_rad.max(creep.linear_rad), stiffness);
        let decided = SuspectedChange::new(suspected, result);
        let is_open = decided.state == SuspectedChangeState::Open;
        self.suspected = is_open.then_some(suspected);
        Some(decided)
    }

    /// Returns a change since the last session that creep does not explain.
    fn between(&self, result: &SessionResult, tendon: Option<&Tendon>) -> Option<PendingEvent> {
        let (now, last) = (result.offset_rad?, self.last_rad?);
        // Each of the offsets may hold for any time in its session.
        let from_utc_s = self.last_from_utc_s.or(self.last_utc_s)?;
        let creep = self.creep(from_utc_s, result.end_utc_s, last, tendon);
        let size = now.plus(last.scaled(-1.0));
        let (excess_rad, usual_rad) = match size.mean > 0.0 {
            true => (size.mean - creep.linear_rad, size.std.hypot(creep.std_rad)),
            false => (-size.mean, size.std),
        };
        if !(excess_rad > MIN_STEP_STDS * usual_rad && excess_rad >= MIN_STEP_RAD) {
            return None;
        }
        // Ropes do not shorten: a reportable decrease of the offset is an unrecorded re-tensioning.
        const MIN_RETENSION_SHARE: f64 = 0.5;
        let is_retensioned =
            last.mean > last.half_width_95() && -size.mean > MIN_RETENSION_SHARE * last.mean;
        Some(PendingEvent {
            time_utc_s: result.start_utc_s,
            size_rad: size,
            what: match is_retensioned {
                true => StepKind::Retensioned,
                false => StepKind::WhileOff,
            },
            ..self.event(last, result)
        })
    }

    /// Returns an event without a change, before which the offset was `before_rad`.
    fn event(&self, before_rad: Gaussian, result: &SessionResult) -> PendingEvent {
        let stiffness = self.last_stiffness_ratio.unwrap_or(result.stiffness_ratio);
        PendingEvent {
            time_utc_s: result.start_utc_s,
            before_rad,
            size_rad: Gaussian::new(0.0, 0.0),
            what: StepKind::Slip,
            cause: None,
            stiffness_ratio: None,
            stiffness_std_ratio: 0.0,
            stiffness_before_ratio: stiffness.mean,
            stiffness_before_std_ratio: stiffness.std,
            session: result.session,
            later_rad: LevelSums::default(),
            later_stiffness: LevelSums::default(),
        }
    }

    /// Returns the largest reportable change of a session that creep within the session does not explain.
    fn within<'a>(
        &self,
        changes: impl Iterator<Item = &'a DatedChange>,
        result: &SessionResult,
        tendon: Option<&Tendon>,
    ) -> Option<PendingEvent> {
        let candidates = changes.filter_map(|dated| {
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
            let before = |now: Gaussian| Gaussian::new(now.mean - size.mean, now.std);
            let before_rad = result.offset_rad.map(before).or(self.last_rad)?;
            let creep = self.creep(result.start_utc_s, result.end_utc_s, before_rad, tendon);
            // Creep only lengthens; a step between two samples of an encoder is none.
            let is_encoder = change.cause.is_some_and(Cause::is_encoder);
            let crept_rad = match size.mean > 0.0 && !is_encoder {
                true => creep.linear_rad.max(Z95 * creep.std_rad),
                false => 0.0,
            };
            let is_step = size.mean.abs() - crept_rad >= MIN_STEP_RAD;
            let is_reportable = is_step || what == StepKind::StrandFailure;
            let lost = change.stiffness_change_ratio;
            let mut event = PendingEvent {
                time_utc_s: dated.time_utc_s,
                size_rad: size,
                what,
                cause: change.cause,
                stiffness_ratio: lost.map(|ratio| ratio.mean),
                stiffness_std_ratio: lost.map_or(0.0, |ratio| ratio.std),
                ..self.event(before_rad, result)
            };
            if self.last_stiffness_ratio.is_none() {
                event.stiffness_before_ratio -= event.stiffness_ratio.unwrap_or(0.0);
            }
            (dated.is_probable() && is_reportable).then_some(event)
        });
        candidates.max_by(|a, b| {
            let size = |s: &PendingEvent| s.size_rad.mean.abs();
            size(a).total_cmp(&size(b))
        })
    }

    /// Returns the expected creep between two times of a tendon with offset `from_rad` at the first.
    fn creep(
        &self,
        from_utc_s: f64,
        to_utc_s: f64,
        from_rad: Gaussian,
        tendon: Option<&Tendon>,
    ) -> Creep {
        let year_rad = tendon.map_or(FIRST_YEAR_CREEP_RAD, |t| {
            FIRST_YEAR_CREEP_STRAIN * t.length_m / t.joint_pulley_radius_m
        });
        let since = self.last_tensioned_utc_s();
        let began = since.unwrap_or(from_utc_s - DEFAULT_TENSIONING_AGE_S);
        let age = |utc_s: f64| (utc_s - began).max(0.0) + CREEP_ONSET_S;
        let ages = age(to_utc_s) / age(from_utc_s);
        let crept_rad = since.map_or(0.0, |_| from_rad.mean.max(0.0));
        Creep {
            std_rad: year_rad / YEAR_E_FOLDS * ages.ln().max(0.0),
            linear_rad: crept_rad * (ages - 1.0).max(0.0),
        }
    }
}

/// Creep between two times.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Creep {
    /// Standard deviation of the creep by the prior of the rope, logarithmic in time, rad.
    std_rad: f64,
    /// Largest continuation of the offset since tensioning, rad: creep decelerates, and is at most linear in time.
    linear_rad: f64,
}

/// Suspected change after a session.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SuspectedChange {
    /// Change with kind and size by all evidence.
    pub(super) event: PendingEvent,
    pub(super) posterior: ChangePosterior,
    pub(super) state: SuspectedChangeState,
    pub(super) evidence: Evidence,
}

impl SuspectedChange {
    fn new(event: PendingEvent, result: &SessionResult) -> Self {
        let posterior = event.posterior();
        let stiffness = result.stiffness_ratio;
        Self {
            event: event.updated(posterior),
            posterior,
            state: posterior.state(),
            evidence: Evidence {
                time_utc_s: result.end_utc_s,
                offset_rad: result.offset_rad,
                stiffness_ratio: (stiffness.std < 1.0).then_some(stiffness),
                probability: posterior.probability,
            },
        }
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

impl DatedChange {
    /// Whether the change is put up for confirmation.
    pub(super) fn is_probable(&self) -> bool {
        let probability = self.change.probability;
        probability.is_none_or(|p| p >= MIN_CHANGE_PROBABILITY)
    }
}

/// Returns the loss of the transmission in the changes of a session, if any, with its probability.
pub(super) fn transmission_loss(dated: &DatedChange, session: u64) -> Option<(PendingEvent, f64)> {
    /// Minimum probability of a loss that raises an alarm without confirmation.
    const MIN_PROBABILITY: f64 = 0.95;
    let change = &dated.change;
    let probability = change.probability.filter(|p| *p >= MIN_PROBABILITY)?;
    let none = Gaussian::new(0.0, 0.0);
    let event = PendingEvent {
        time_utc_s: dated.time_utc_s,
        before_rad: none,
        size_rad: none,
        what: StepKind::TransmissionLost,
        cause: None,
        stiffness_ratio: None,
        stiffness_std_ratio: 0.0,
        stiffness_before_ratio: 0.0,
        stiffness_before_std_ratio: 0.0,
        session,
        later_rad: LevelSums::default(),
        later_stiffness: LevelSums::default(),
    };
    (change.kind == TendonChangeKind::TransmissionLost).then_some((event, probability))
}

#[cfg(test)]
mod tests {
    use super::*;

    const DAY_S: f64 = 86_400.0;

    /// Tendon of a wrist, tensioned 60 days ago, that crept by 19.4 mrad since.
    fn wrist() -> (TendonState, Tendon) {
        let mut state = TendonState::new("wrist", Some("tensioned".into()));
        state.tensioned_utc_s = vec![0.0];
        state.last_rad = Some(Gaussian::new(19.4e-3, 0.15e-3));
        state.last_from_utc_s = Some(60.0 * DAY_S);
        state.last_utc_s = Some(61.0 * DAY_S);
        state.last_stiffness_ratio = Some(Gaussian::new(0.0, 0.02));
        let tendon = Tendon {
            rope: None,
            length_m: 0.95,
            joint_pulley_radius_m: 0.018,
            pretension_n: None,
            antagonistic: false,
            guides: Vec::new(),
            retension_at_m: None,
            replace_at_strain: None,
            frame_expansion_per_k: None,
        };
        (state, tendon)
    }

    fn result(offset_mrad: f64) -> SessionResult {
        SessionResult {
            session: 2,
            start_utc_s: 61.0 * DAY_S,
            end_utc_s: 65.0 * DAY_S,
            offset_rad: Some(Gaussian::new(1e-3 * offset_mrad, 0.15e-3)),
            stiffness_ratio: Gaussian::new(0.0, 0.02),
        }
    }

    /// A session of four days, at the mean rate of 19.4 mrad in 60 days: 1.6 mrad since the start of the last session.
    #[test]
    fn creep_within_session_of_days_is_no_step() {
        let (mut state, tendon) = wrist();
        assert_eq!(state.update(&result(21.0), &[], Some(&tendon)), None);
        let (mut state, tendon) = wrist();
        let step = state.update(&result(28.0), &[], Some(&tendon)).unwrap();
        assert_eq!(step.event.what, StepKind::WhileOff);
    }

    /// The estimator explains the creep of four days by a slip within the session.
    #[test]
    fn change_within_session_that_creep_explains_is_not_suspected() {
        let slip = |size_mrad: f64| DatedChange {
            time_utc_s: 63.0 * DAY_S,
            change: TendonChange {
                kind: TendonChangeKind::Slip,
                time_s: 40.0,
                interval_s: None,
                probability: Some(0.99),
                size_rad: Some(Gaussian::new(1e-3 * size_mrad, 0.2e-3)),
                stiffness_change_ratio: None,
                cause: Some(Cause::Unknown(sinew_estimate::UnknownCause::Noise)),
            },
        };
        for (size_mrad, is_suspected) in [(1.4, false), (6.0, true)] {
            let (mut state, tendon) = wrist();
            state.last_rad = Some(Gaussian::new(1e-3 * (19.4 - size_mrad), 0.15e-3));
            let changes = [slip(size_mrad)];
            let suspected = state.update(&result(19.4 + 1.0), &changes, Some(&tendon));
            assert_eq!(suspected.is_some(), is_suspected, "{suspected:?}");
        }
    }

    /// Undecided sessions never end a suspected change.
    #[test]
    fn suspected_change_remains_without_evidence() {
        let (mut state, tendon) = wrist();
        state.update(&result(28.0), &[], Some(&tendon));
        for k in 0..10 {
            let wide = SessionResult {
                session: 3 + k,
                offset_rad: Some(Gaussian::new(23.0e-3, 10e-3)),
                stiffness_ratio: Gaussian::new(0.0, 1.0),
                start_utc_s: (66.0 + k as f64) * DAY_S,
                end_utc_s: (66.5 + k as f64) * DAY_S,
            };
            let suspected = state.update(&wide, &[], Some(&tendon)).unwrap();
            assert_eq!(suspected.state, SuspectedChangeState::Open, "{suspected:?}");
        }
        assert!(state.suspected.is_some());
    }
}
