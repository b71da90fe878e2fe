//! Evidence of later sessions for or against a suspected change of a tendon.
//!
//! Each later session measures offset and stiffness. With the level `a` of a quantity since the suspected change, its
//! measurements are `y = a + c·g + e` ([`LevelSums`]): `c·g` is creep, `e` the error of the session. Without a change `a`
//! is the level before, `N(b, σ_b²)`; with a change of size `N(s, σ_s²)` it is `N(b + s, σ_b² + σ_s²)`. Both hypotheses
//! have the same creep and errors, so that the generalised least-squares level `â` with variance `1/Λ`,
//! `Λ = 1ᵀS⁻¹1`, `S = diag(1/w) + ggᵀ`, is sufficient, and the log Bayes factor of all sessions is
//! `ln N(â; b + s, σ_b² + σ_s² + 1/Λ) − ln N(â; b, σ_b² + 1/Λ)`. That of a stiffness loss is multiplied by
//! `P(s < 0 | â)/P(s < 0)`, because ropes lose stiffness only.
//!
//! Hypotheses: no change (prior probability ½), and a change of the offset, of the stiffness, or of both. Errors of
//! offset and stiffness count as independent. Source: Bayes factors of nested Gaussian models, Kass and Raftery (1995),
//! doi:10.1080/01621459.1995.10476572.

use crate::alarm::StepKind;
use crate::incident::{CauseProbability, IncidentCause};
use crate::transaction::{LevelSums, PendingEvent};
use sinew_estimate::Cause;
use sinew_model::Gaussian;

/// Probability of a change at which it is confirmed; below its complement it is refuted.
const CONFIRM_PROBABILITY: f64 = 0.95;
/// Relative standard deviation of a size found within one session, in addition to its own: offset and stiffness are
/// confounded over the few poses after the change (assumption).
const RELATIVE_SIZE_STD: f64 = 0.3;
/// Standard deviation of a stiffness loss that was not measured (assumption: one strand of about ten, up to two or three).
const STIFFNESS_LOSS_STD: f64 = 0.1;
/// Standard deviation of the drift of the relative stiffness between sessions, as in the estimator.
const STIFFNESS_DRIFT: f64 = 0.02;
/// Minimum standard deviation of a measured level: a numerical bound.
const MIN_LEVEL_STD: f64 = 1e-9;

impl LevelSums {
    /// Adds a measurement with the creep expected until then.
    fn add(&mut self, value: Gaussian, creep: f64) {
        let weight = value.std.max(MIN_LEVEL_STD).powi(-2);
        self.weight += weight;
        self.weight_creep += weight * creep;
        self.weight_creep2 += weight * creep * creep;
        self.weight_value += weight * value.mean;
        self.weight_creep_value += weight * creep * value.mean;
    }

    /// Returns the generalised least-squares level; `None` without measurements.
    fn level(&self) -> Option<Gaussian> {
        let shrunk = self.weight_creep / (1.0 + self.weight_creep2);
        let precision = self.weight - shrunk * self.weight_creep;
        let value = self.weight_value - shrunk * self.weight_creep_value;
        (precision > 0.0).then(|| Gaussian::new(value / precision, precision.recip().sqrt()))
    }
}

/// Natural logarithm of a normal density without the factor `1/√(2π)`.
fn ln_density(x: f64, mean: f64, variance: f64) -> f64 {
    -0.5 * ((x - mean).powi(2) / variance + variance.ln())
}

/// Log Bayes factor of a change of size `size` from `before`, given the level since.
fn ln_bayes(level: Gaussian, before: Gaussian, size: Gaussian) -> f64 {
    let without = before.std.powi(2) + level.std.powi(2);
    ln_density(
        level.mean,
        before.mean + size.mean,
        without + size.std.powi(2),
    ) - ln_density(level.mean, before.mean, without)
}

/// Size of a change from its prior and the level since.
fn refined(level: Gaussian, before: Gaussian, size: Gaussian) -> Gaussian {
    let measured = level.plus(before.scaled(-1.0));
    let [prior, data] = [size.std.powi(-2), measured.std.powi(-2)];
    let mean = (prior * size.mean + data * measured.mean) / (prior + data);
    Gaussian::new(mean, (prior + data).recip().sqrt())
}

/// Probability of a suspected change and of its kinds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ChangePosterior {
    /// Probability that the change happened and lasts, 0…1.
    pub(super) probability: f64,
    /// Probability of a stiffness loss, 0…1; at most `probability`.
    pub(super) stiffness_loss: f64,
}

/// Result of the evidence for a suspected change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum SuspectedChangeState {
    Open,
    Confirmed,
    Refuted,
}

impl ChangePosterior {
    pub(super) fn state(self) -> SuspectedChangeState {
        match self.probability {
            p if p >= CONFIRM_PROBABILITY => SuspectedChangeState::Confirmed,
            p if p <= 1.0 - CONFIRM_PROBABILITY => SuspectedChangeState::Refuted,
            _ => SuspectedChangeState::Open,
        }
    }
}

impl PendingEvent {
    /// Whether the size of the step of the offset is measured.
    fn has_size(&self) -> bool {
        self.size_rad.mean != 0.0
    }

    /// Prior size of the step of the offset, rad.
    fn prior_size_rad(&self) -> Gaussian {
        let Gaussian { mean, std } = self.size_rad;
        Gaussian::new(mean, std.hypot(RELATIVE_SIZE_STD * mean))
    }

    /// Relative stiffness, minus 1, before the change.
    fn stiffness_before(&self) -> Gaussian {
        let std = self.stiffness_before_std_ratio.hypot(STIFFNESS_DRIFT);
        Gaussian::new(self.stiffness_before_ratio, std)
    }

    /// Prior change of the stiffness relative to nominal.
    fn prior_stiffness(&self) -> Gaussian {
        match self.stiffness_ratio {
            Some(ratio) => {
                let std = self.stiffness_std_ratio.hypot(RELATIVE_SIZE_STD * ratio);
                Gaussian::new(ratio, std).scaled(1.0 + self.stiffness_before_ratio)
            }
            None => Gaussian::new(0.0, STIFFNESS_LOSS_STD),
        }
    }

    /// Adds a later session, with the creep expected since the change, rad.
    pub(super) fn add_session(
        &mut self,
        offset_rad: Option<Gaussian>,
        creep_rad: f64,
        stiffness_ratio: Gaussian,
    ) {
        if let Some(offset) = offset_rad {
            self.later_rad.add(offset, creep_rad);
        }
        self.later_stiffness.add(stiffness_ratio, 0.0);
    }

    /// Log Bayes factor of the step of the offset.
    fn ln_bayes_offset(&self) -> f64 {
        let level = self.later_rad.level();
        level.map_or(0.0, |level| {
            ln_bayes(level, self.before_rad, self.prior_size_rad())
        })
    }

    /// Log Bayes factor of the stiffness loss.
    fn ln_bayes_stiffness(&self) -> f64 {
        let (before, size) = (self.stiffness_before(), self.prior_stiffness());
        let level = self.later_stiffness.level();
        level.map_or(0.0, |level| {
            let loss = |change: Gaussian| 1.0 - change.probability_above(0.0);
            let truncated = loss(refined(level, before, size)) / loss(size);
            ln_bayes(level, before, size) + truncated.max(f64::MIN_POSITIVE).ln()
        })
    }

    /// Prior probabilities, given a change, of a change of the offset alone, of the stiffness alone, and of both. If the
    /// 95 % interval of the loss excludes zero, the offset alone has the 2.5 % beyond it; otherwise the hypotheses that
    /// the estimate admits are equally probable.
    fn priors(&self) -> [f64; 3] {
        const NOT_SIGNIFICANT: f64 = 0.025;
        match self.what {
            _ if !self.has_size() => [0.0, 1.0, 0.0],
            StepKind::Retensioned | StepKind::TransmissionLost => [1.0, 0.0, 0.0],
            StepKind::Slip | StepKind::WhileOff => [0.5, 0.0, 0.5],
            StepKind::SlipOrStrandFailure => [1.0 / 3.0; 3],
            StepKind::StrandFailure => {
                let significant = 0.5 * (1.0 - NOT_SIGNIFICANT);
                [NOT_SIGNIFICANT, significant, significant]
            }
        }
    }

    /// Probability of the change by all later sessions.
    pub(super) fn posterior(&self) -> ChangePosterior {
        let (offset, stiffness) = (self.ln_bayes_offset(), self.ln_bayes_stiffness());
        let [alone, soft, both] = self.priors();
        // Relative to the largest exponent, against overflow.
        let exponents = [0.0, offset, stiffness, offset + stiffness];
        let most = exponents.into_iter().fold(0.0, f64::max);
        let [none, slip, softer, slip_softer] = exponents.map(|x| (x - most).exp());
        let loss = soft * softer + both * slip_softer;
        let change = alone * slip + loss;
        ChangePosterior {
            probability: change / (none + change),
            stiffness_loss: loss / (none + change),
        }
    }

    /// Returns the event with kind and sizes by all later sessions.
    pub(super) fn updated(&self, posterior: ChangePosterior) -> Self {
        if self.later_stiffness == LevelSums::default() {
            return *self;
        }
        let loss = posterior.stiffness_loss / posterior.probability.max(f64::MIN_POSITIVE);
        let mut event = *self;
        event.what = match self.what {
            StepKind::Retensioned | StepKind::TransmissionLost => self.what,
            _ if loss >= CONFIRM_PROBABILITY => StepKind::StrandFailure,
            StepKind::Slip | StepKind::WhileOff => self.what,
            _ if loss <= 1.0 - CONFIRM_PROBABILITY => StepKind::Slip,
            _ => StepKind::SlipOrStrandFailure,
        };
        if event.what == StepKind::StrandFailure {
            // No encoder loses stiffness.
            event.cause = None;
            if let Some(level) = self.later_stiffness.level() {
                let size = refined(level, self.stiffness_before(), self.prior_stiffness());
                let ratio = size.scaled((1.0 + self.stiffness_before_ratio).recip());
                (event.stiffness_ratio, event.stiffness_std_ratio) = (Some(ratio.mean), ratio.std);
            }
        }
        if let Some(level) = self.later_rad.level().filter(|_| self.has_size()) {
            let size = refined(level, self.before_rad, self.prior_size_rad());
            let apart = size.plus(self.size_rad.scaled(-1.0));
            // The first size remains where the later sessions agree with it.
            if apart.is_nonzero_95() {
                event.size_rad = size;
            }
        }
        event
    }

    /// Probabilities of the causes, the most probable first.
    pub(super) fn causes(&self, posterior: ChangePosterior) -> Vec<CauseProbability> {
        let slip = match (self.what, self.cause) {
            (StepKind::TransmissionLost, _) => IncidentCause::TransmissionLost,
            (StepKind::Retensioned, _) => IncidentCause::Retensioned,
            (_, Some(Cause::MotorEncoder | Cause::JointEncoder)) => IncidentCause::Encoder,
            (_, Some(Cause::Rope)) => IncidentCause::Slip,
            _ => IncidentCause::SlipOrEncoder,
        };
        let ChangePosterior {
            probability,
            stiffness_loss,
        } = posterior;
        let mut causes: Vec<CauseProbability> = [
            (IncidentCause::StrandFailure, stiffness_loss),
            (slip, probability - stiffness_loss),
            (IncidentCause::NoChange, 1.0 - probability),
        ]
        .map(|(cause, probability)| CauseProbability { cause, probability })
        .into();
        causes.retain(|one| one.probability > 0.0);
        causes.sort_by(|a, b| b.probability.total_cmp(&a.probability));
        causes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slip() -> PendingEvent {
        PendingEvent {
            time_utc_s: 0.0,
            before_rad: Gaussian::new(8.0e-3, 0.3e-3),
            size_rad: Gaussian::new(5.1e-3, 1.1e-3),
            what: StepKind::Slip,
            cause: None,
            stiffness_ratio: None,
            stiffness_std_ratio: 0.0,
            stiffness_before_ratio: -0.01,
            stiffness_before_std_ratio: 0.018,
            session: 1,
            later_rad: LevelSums::default(),
            later_stiffness: LevelSums::default(),
        }
    }

    /// Joint densities of the three sessions; the stiffness loss is integrated over its prior. In Python, with
    /// `mn = scipy.stats.multivariate_normal.logpdf` and `R = diag(s²) + g gᵀ` in mrad:
    ///
    /// ```python
    /// mn(y, [13.1]*3, R + .3**2 + 1.1**2 + (.3*5.1)**2) - mn(y, [8]*3, R + .3**2)           # 32.1902
    /// vb = .018**2 + .02**2; n = mn(k, [-.01]*3, diag(sk**2) + vb)
    /// f = lambda t: exp(mn(k, [-.01 + t]*3, diag(sk**2) + vb) - n) * 2 * norm.pdf(t, 0, .1)
    /// log(quad(f, -1, 0)[0])                                                                # 6.68718
    /// ```
    #[test]
    fn log_bayes_factors_match_joint_densities() {
        let mut event = slip();
        let offsets = [(11.9, 0.4, 0.2), (12.2, 0.3, 0.4), (12.1, 0.35, 0.5)];
        let stiffness = [(-0.12, 0.016), (-0.125, 0.015), (-0.122, 0.015)];
        for ((mean, std, creep), (ratio, ratio_std)) in offsets.into_iter().zip(stiffness) {
            let offset = Gaussian::new(mean, std).scaled(1e-3);
            event.add_session(Some(offset), 1e-3 * creep, Gaussian::new(ratio, ratio_std));
        }
        const OFFSET: f64 = 32.190_201;
        const STIFFNESS: f64 = 6.687_175;
        assert!(
            (event.ln_bayes_offset() - OFFSET).abs() < 1e-5,
            "{}",
            event.ln_bayes_offset()
        );
        assert!(
            (event.ln_bayes_stiffness() - STIFFNESS).abs() < 1e-5,
            "{}",
            event.ln_bayes_stiffness()
        );
        // Odds of offset alone and of both: (½ e^O + ½ e^(O + S)) to 1.
        let odds = 0.5 * (OFFSET.exp() + (OFFSET + STIFFNESS).exp());
        let posterior = event.posterior();
        assert!((posterior.probability - odds / (1.0 + odds)).abs() < 1e-9);
        let loss = STIFFNESS.exp() / (1.0 + STIFFNESS.exp());
        assert!(
            (posterior.stiffness_loss - loss).abs() < 1e-6,
            "{posterior:?}"
        );
        let updated = event.updated(posterior);
        assert_eq!(updated.what, StepKind::StrandFailure);
    }

    /// A poor first size, as of a slip that is fitted to a strand failure, does not refute the change.
    #[test]
    fn poor_first_size_is_confirmed_and_refined() {
        let mut event = PendingEvent {
            before_rad: Gaussian::new(8.2e-3, 0.25e-3),
            size_rad: Gaussian::new(12.5e-3, 0.35e-3),
            ..slip()
        };
        event.add_session(
            Some(Gaussian::new(12.1e-3, 0.4e-3)),
            0.2e-3,
            Gaussian::new(-0.127, 0.016),
        );
        let posterior = event.posterior();
        assert_eq!(posterior.state(), SuspectedChangeState::Confirmed);
        let updated = event.updated(posterior);
        assert_eq!(updated.what, StepKind::StrandFailure);
        assert!((updated.size_rad.mean - 3.9e-3).abs() < 1e-3, "{updated:?}");
        assert!(
            updated
                .stiffness_ratio
                .is_some_and(|ratio| (ratio + 0.11).abs() < 0.03)
        );
        assert_eq!(
            event.causes(posterior)[0].cause,
            IncidentCause::StrandFailure
        );
    }

    #[test]
    fn absent_change_is_refuted_and_wide_sessions_leave_it_open() {
        let mut event = slip();
        for _ in 0..20 {
            let wide = Gaussian::new(10e-3, 6e-3);
            event.add_session(Some(wide), 5e-3, Gaussian::new(0.0, 1.0));
        }
        assert_eq!(event.posterior().state(), SuspectedChangeState::Open);
        event.add_session(
            Some(Gaussian::new(8.0e-3, 0.3e-3)),
            0.1e-3,
            Gaussian::new(-0.01, 0.015),
        );
        assert_eq!(event.posterior().state(), SuspectedChangeState::Refuted);
        let of_stiffness = PendingEvent {
            size_rad: Gaussian::new(0.0, 0.0),
            what: StepKind::StrandFailure,
            stiffness_ratio: Some(-0.12),
            stiffness_std_ratio: 0.02,
            ..slip()
        };
        for (ratio, state) in [
            (-0.01, SuspectedChangeState::Refuted),
            (-0.13, SuspectedChangeState::Confirmed),
        ] {
            let mut event = of_stiffness;
            for _ in 0..3 {
                event.add_session(None, 0.0, Gaussian::new(ratio, 0.015));
            }
            assert_eq!(event.posterior().state(), state, "{:?}", event.posterior());
        }
    }
}
