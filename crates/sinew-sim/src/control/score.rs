//! Numbers out of a run.

use serde::Serialize;
use sinew_model::statistics::quantile;

/// Time at rest after which a position counts as "at rest", s: about one oscillation period on the springs.
pub(super) const SETTLED_S: f64 = 0.7;
/// Time after which a contact has no more effect on position and torque, s.
pub(super) const AFTERMATH_S: f64 = 1.0;
/// Time by which an alarm may outlast its contact, s: three time constants of the default filters.
const RELEASE_S: f64 = 0.3;
/// Gap below which contacts are merged, s: an alarm does not end between them.
const ONE_CONTACT_S: f64 = 0.5;

/// Joint position and contacts of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Score {
    /// One entry per joint.
    pub joints: Vec<JointScore>,
    /// Contacts, by the detector as the scenario has it.
    pub contacts: ContactScore,
}

/// Control error of a joint, contacts excluded.
///
/// A value without samples is NaN (null in JSON): `rest_*` if the arm was never at rest without contact.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JointScore {
    /// Name of the joint.
    pub name: String,
    /// RMS of `q − q_d` at rest, rad.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub rest_rms_rad: f64,
    /// Mean of `q − q_d` at rest, rad.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub rest_mean_rad: f64,
    /// RMS of `q − q_d` over the whole recording, rad.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub rms_rad: f64,
    /// Largest absolute value of `q − q_d` over the whole recording, rad.
    pub peak_rad: f64,
    /// Mean of the estimated external torque without contact, N·m.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub false_torque_nm: f64,
    /// RMS error of the external torque without contact, N·m.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub torque_error_rms_nm: f64,
    /// Mean threshold, N·m.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub threshold_nm: f64,
}

/// Comparison of detected and true contacts.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ContactScore {
    /// Number of true contacts (those less than 0.5 s apart count as one).
    pub contacts: usize,
    /// Number of contacts not detected, or hidden by an earlier alarm.
    pub missed: usize,
    /// Delays from the beginning of a contact to its alarm, s; one per detected contact.
    pub delays_s: Vec<f64>,
    /// Number of alarms without a contact.
    pub false_alarms: usize,
    /// Time without contact, s.
    pub free_s: f64,
    /// Time of false alarms, s.
    pub false_s: f64,
}

impl ContactScore {
    /// Compares alarms with contacts (both as start and end, in order) between `from_s` and
    /// `to_s`.
    pub(super) fn of(
        alarms: &[(f64, f64)],
        contacts: &[(f64, f64)],
        from_s: f64,
        to_s: f64,
    ) -> Self {
        let contacts = joined(contacts, from_s, to_s);
        let mut score = Self {
            contacts: contacts.len(),
            missed: 0,
            delays_s: Vec::new(),
            false_alarms: 0,
            free_s: to_s - from_s,
            false_s: 0.0,
        };
        for &(from, to) in &contacts {
            score.free_s -= (to + RELEASE_S).min(to_s) - from;
            // Only an alarm that continues because of the contact counts as a detection.
            let seen = alarms
                .iter()
                .find(|a| (from..to + RELEASE_S).contains(&a.0));
            match seen {
                Some(alarm) => score.delays_s.push(alarm.0 - from),
                None => score.missed += 1,
            }
        }
        for &(on, off) in alarms {
            let mut free = off - on;
            let mut touched = false;
            for &(from, to) in &contacts {
                let overlap = off.min(to + RELEASE_S) - on.max(from);
                if overlap > 0.0 {
                    free -= overlap;
                    touched |= on >= from;
                }
            }
            score.false_s += free.max(0.0);
            score.false_alarms += usize::from(!touched);
        }
        score
    }

    /// Adds the contacts of another run.
    pub fn add(&mut self, other: &Self) {
        self.contacts += other.contacts;
        self.missed += other.missed;
        self.delays_s.extend(&other.delays_s);
        self.false_alarms += other.false_alarms;
        self.free_s += other.free_s;
        self.false_s += other.false_s;
    }

    /// Share of the contacts missed; NaN without contacts.
    pub fn missed_share(&self) -> f64 {
        self.missed as f64 / self.contacts as f64
    }

    /// Share of the time without contact with a false alarm.
    pub fn false_share(&self) -> f64 {
        self.false_s / self.free_s
    }

    /// False alarms per minute without contact.
    pub fn false_per_minute(&self) -> f64 {
        60.0 * self.false_alarms as f64 / self.free_s
    }

    /// Median delay, s; NaN when nothing was detected.
    pub fn delay_median_s(&self) -> f64 {
        let mut delays_s = self.delays_s.clone();
        delays_s.sort_unstable_by(f64::total_cmp);
        quantile(&delays_s, 0.5)
    }
}

/// Returns the contacts within the evaluated time, with adjacent ones merged.
fn joined(contacts: &[(f64, f64)], from_s: f64, to_s: f64) -> Vec<(f64, f64)> {
    let mut out: Vec<(f64, f64)> = Vec::new();
    for &(from, to) in contacts {
        let to = to.min(to_s);
        if from < from_s || from >= to {
            continue;
        }
        match out.last_mut() {
            Some(last) if from - last.1 < ONE_CONTACT_S => last.1 = last.1.max(to),
            _ => out.push((from, to)),
        }
    }
    out
}

/// Sums of one joint on the way to a [`JointScore`].
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct JointTally {
    rest: Sum,
    all: Sum,
    torque: Sum,
    torque_error: Sum,
    threshold: Sum,
}

#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    count: f64,
    sum: f64,
    squares: f64,
    peak: f64,
}

impl Sum {
    fn add(&mut self, x: f64) {
        self.count += 1.0;
        self.sum += x;
        self.squares += x * x;
        self.peak = self.peak.max(x.abs());
    }

    fn mean(&self) -> f64 {
        self.sum / self.count
    }

    fn rms(&self) -> f64 {
        (self.squares / self.count).sqrt()
    }
}

impl JointTally {
    pub(super) fn position(&mut self, error_rad: f64, at_rest: bool) {
        self.all.add(error_rad);
        if at_rest {
            self.rest.add(error_rad);
        }
    }

    pub(super) fn torque(&mut self, seen: f64, truth: f64, threshold: f64) {
        if seen.is_finite() {
            self.torque.add(seen);
            self.torque_error.add(seen - truth);
            self.threshold.add(threshold);
        }
    }

    pub(super) fn score(&self, name: &str) -> JointScore {
        JointScore {
            name: name.into(),
            rest_rms_rad: self.rest.rms(),
            rest_mean_rad: self.rest.mean(),
            rms_rad: self.all.rms(),
            peak_rad: self.all.peak,
            false_torque_nm: self.torque.mean(),
            torque_error_rms_nm: self.torque_error.rms(),
            threshold_nm: self.threshold.mean(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn score_counts_detected_missed_hidden_false_contacts() {
        // Two contacts 0.2 s apart are one; one at 5 s is missed; one at 8 s falls into an alarm
        // that was on before; an alarm at 12 s is false.
        let contacts = [(1.0, 2.0), (2.2, 3.0), (5.0, 6.0), (8.0, 9.0)];
        let alarms = [(1.1, 3.2), (7.0, 8.5), (12.0, 12.5)];
        let score = ContactScore::of(&alarms, &contacts, 0.0, 20.0);
        assert_eq!((score.contacts, score.missed), (3, 2));
        assert_eq!(score.false_alarms, 2);
        assert!((score.delays_s[0] - 0.1).abs() < 1e-12 && score.delays_s.len() == 1);
        // 20 s minus (2 + 1 + 1) s and 0.3 s after each of three.
        assert!((score.free_s - 15.1).abs() < 1e-12, "{}", score.free_s);
        // One second before the hidden contact, half a second later on.
        assert!((score.false_s - 1.5).abs() < 1e-12, "{}", score.false_s);
        assert!((100.0 * score.missed_share() - 200.0 / 3.0).abs() < 1e-12);
    }

    #[test]
    fn score_endless_alarm_detects_nothing() {
        let score = ContactScore::of(&[(0.0, 10.0)], &[(2.0, 3.0)], 0.0, 10.0);
        assert_eq!(
            (score.contacts, score.missed, score.false_alarms),
            (1, 1, 1)
        );
        assert!((100.0 * score.false_share() - 100.0).abs() < 1e-9);
        assert!(score.delay_median_s().is_nan());
    }
}
