//! What many recordings say together.

use super::{FoundStep, Options, Plan, Recording, StepScore};
use serde::Serialize;
use sinew_model::statistics::quantile;
use std::collections::BTreeMap;

/// All scenarios of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Seed of the first recording of each scenario.
    pub first_seed: u64,
    /// Recordings asked for per scenario.
    pub n: u64,
    /// One entry per scenario.
    pub scenarios: Vec<ScenarioSummary>,
}

/// One scenario.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ScenarioSummary {
    /// Its name.
    pub scenario: String,
    /// Its robot.
    pub robot: String,
    /// What it is about, where that isn't the protocol's.
    pub about: Option<String>,
    /// Recordings.
    pub recordings: usize,
    /// Offset of B at its end, per elastic joint.
    pub joints: Vec<JointSummary>,
    /// Slips of session C, per joint that slips.
    pub steps: Vec<StepSummary>,
    /// Sudden changes reported where there was none, per hour.
    pub false_alarms_per_hour: f64,
    /// Mean of the probabilities stated of them.
    pub false_alarm_probability: Option<f64>,
    /// Hours they were looked for.
    pub watched_h: f64,
    /// Payload: root mean square error, kg.
    pub payload_rmse_kg: f64,
    /// Mean share of B left out as contact or disturbance.
    pub left_out_share: f64,
    /// Share of recordings in which each warning was given, by its text up to the first number.
    pub warnings: BTreeMap<String, f64>,
}

/// One joint's offset at the end of B. Errors are estimate less truth.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointSummary {
    /// Joint.
    pub name: String,
    /// Mean error, mrad.
    pub bias_mrad: f64,
    /// Root mean square error, mrad.
    pub rmse_mrad: f64,
    /// 95 % quantile of the size of the error, mrad.
    pub q95_error_mrad: f64,
    /// Share of truths inside the 95 % interval.
    pub coverage: f64,
    /// Where that share lies with 95 % confidence (Wilson).
    pub coverage_95: [f64; 2],
    /// Mean half-width of the 95 % interval, mrad.
    pub interval_95_mrad: f64,
    /// Mean of error over standard deviation claimed; 0 when unbiased.
    pub z_mean: f64,
    /// Standard deviation of error over standard deviation claimed; 1 when honest, below 1 when
    /// intervals are too wide.
    pub z_sd: f64,
    /// Share of recordings with the verdict "can't tell".
    pub cant_tell: f64,
    /// Root mean square of the Bayesian Cramér–Rao bounds, mrad.
    pub bound_mrad: Option<f64>,
    /// Root mean square error of the paper's mean over B, mrad.
    pub paper_rmse_mrad: Option<f64>,
    /// The same minus its mean over A.
    pub paper_minus_baseline_rmse_mrad: Option<f64>,
    /// With matched filters.
    pub matched_rmse_mrad: Option<f64>,
    /// The same minus its mean over A.
    pub matched_minus_baseline_rmse_mrad: Option<f64>,
}

/// Slips of one joint.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StepSummary {
    /// Joint.
    pub joint: String,
    /// Slips.
    pub slips: usize,
    /// Share found with 20 s of recording after them.
    pub found: f64,
    /// Root mean square error of the size, mrad; a slip not found counts in full.
    pub rmse_mrad: f64,
    /// The same of those found.
    pub found_rmse_mrad: Option<f64>,
    /// Mean probability stated of those found.
    pub probability: Option<f64>,
    /// Share of those found that happened within the 95 % interval of their moment.
    pub moment_coverage: Option<f64>,
    /// Mean half-width of that interval, s.
    pub moment_interval_95_s: Option<f64>,
    /// Root mean square error of the moment, s.
    pub moment_rmse_s: Option<f64>,
    /// Seconds of recording needed to find it: median of those found.
    pub delay_s: Option<f64>,
    /// The same, 90 % quantile.
    pub delay_90_s: Option<f64>,
}

impl Summary {
    pub(super) fn of(plans: &[Plan], recordings: &[Recording], options: &Options) -> Self {
        Self {
            first_seed: options.first_seed,
            n: options.n,
            scenarios: plans
                .iter()
                .map(|plan| {
                    let of: Vec<&Recording> = recordings
                        .iter()
                        .filter(|r| r.scenario == plan.name)
                        .collect();
                    scenario(plan, &of)
                })
                .collect(),
        }
    }
}

fn scenario(plan: &Plan, recordings: &[&Recording]) -> ScenarioSummary {
    let names: Vec<&String> = recordings
        .first()
        .map(|r| r.joints.iter().map(|j| &j.name).collect())
        .unwrap_or_default();
    let slipping: Vec<&String> = recordings
        .first()
        .map(|r| r.steps.iter().map(|s| &s.joint).collect())
        .unwrap_or_default();
    let watched_h: f64 = recordings.iter().map(|r| r.watched_s).sum::<f64>() / 3600.0;
    let alarms: Vec<f64> = (recordings.iter())
        .flat_map(|r| r.false_alarms.iter().copied())
        .collect();
    let payload: Vec<f64> = recordings.iter().map(|r| r.payload_error_kg).collect();
    let left_out: Vec<f64> = recordings.iter().map(|r| r.left_out_share).collect();
    ScenarioSummary {
        scenario: plan.name.clone(),
        robot: plan.robot.name.clone(),
        about: plan.about.clone(),
        recordings: recordings.len(),
        joints: names.iter().map(|name| joint(name, recordings)).collect(),
        steps: slipping
            .iter()
            .map(|name| steps(name, recordings))
            .collect(),
        false_alarms_per_hour: alarms.len() as f64 / watched_h,
        false_alarm_probability: (!alarms.is_empty()).then(|| mean(&alarms)),
        watched_h,
        payload_rmse_kg: rms(&payload),
        left_out_share: mean(&left_out),
        warnings: warnings(recordings),
    }
}

fn joint(name: &str, recordings: &[&Recording]) -> JointSummary {
    let scores: Vec<_> = recordings
        .iter()
        .filter_map(|r| r.joints.iter().find(|j| j.name == name))
        .collect();
    let errors: Vec<f64> = scores.iter().map(|j| j.error_mrad).collect();
    let intervals: Vec<f64> = scores.iter().map(|j| j.interval_95_mrad).collect();
    // An interval is 1.96 standard deviations.
    let z: Vec<f64> = scores
        .iter()
        .map(|j| 1.96 * j.error_mrad / j.interval_95_mrad)
        .collect();
    let inside = scores
        .iter()
        .filter(|j| j.error_mrad.abs() <= j.interval_95_mrad)
        .count();
    let cant_tell = scores.iter().filter(|j| j.verdict == "can't tell").count();
    let n = scores.len();
    let optional = |of: fn(&super::JointScore) -> Option<f64>| -> Option<f64> {
        let values: Vec<f64> = scores.iter().filter_map(|j| of(j)).collect();
        (!values.is_empty()).then(|| rms(&values))
    };
    let z_mean = mean(&z);
    JointSummary {
        name: name.into(),
        bias_mrad: mean(&errors),
        rmse_mrad: rms(&errors),
        q95_error_mrad: quantile_of(errors.iter().map(|e| e.abs()).collect(), 0.95),
        coverage: inside as f64 / n as f64,
        coverage_95: wilson(inside, n),
        interval_95_mrad: mean(&intervals),
        z_mean,
        z_sd: (rms(&z).powi(2) - z_mean * z_mean).max(0.0).sqrt(),
        cant_tell: cant_tell as f64 / n as f64,
        bound_mrad: optional(|j| j.bound_mrad),
        paper_rmse_mrad: optional(|j| j.paper_error_mrad),
        paper_minus_baseline_rmse_mrad: optional(|j| j.paper_minus_baseline_error_mrad),
        matched_rmse_mrad: optional(|j| j.matched_error_mrad),
        matched_minus_baseline_rmse_mrad: optional(|j| j.matched_minus_baseline_error_mrad),
    }
}

fn steps(name: &str, recordings: &[&Recording]) -> StepSummary {
    let slips: Vec<&StepScore> = recordings
        .iter()
        .flat_map(|r| &r.steps)
        .filter(|s| s.joint == name)
        .collect();
    let found: Vec<&&StepScore> = slips.iter().filter(|s| s.found.is_some()).collect();
    let errors: Vec<f64> = slips.iter().map(|s| s.error_mrad()).collect();
    let found_errors: Vec<f64> = found.iter().map(|s| s.error_mrad()).collect();
    let told: Vec<(&StepScore, FoundStep)> = (slips.iter())
        .filter_map(|s| Some((*s, s.found?)))
        .collect();
    let of_found = |f: &dyn Fn(&StepScore, FoundStep) -> f64| -> Vec<f64> {
        told.iter().map(|(s, found)| f(s, *found)).collect()
    };
    let probabilities = of_found(&|_, found| found.probability);
    let inside = of_found(&|s, _| f64::from(u8::from(s.is_moment_inside() == Some(true))));
    let half = of_found(&|_, found| 0.5 * (found.between_s[1] - found.between_s[0]));
    let off = of_found(&|s, found| found.time_s - s.at_s);
    let delays: Vec<f64> = slips.iter().filter_map(|s| s.delay_s).collect();
    let some = |values: &[f64], f: &dyn Fn(Vec<f64>) -> f64| {
        (!values.is_empty()).then(|| f(values.to_vec()))
    };
    StepSummary {
        joint: name.into(),
        slips: slips.len(),
        found: found.len() as f64 / slips.len() as f64,
        rmse_mrad: rms(&errors),
        found_rmse_mrad: some(&found_errors, &|v| rms(&v)),
        probability: some(&probabilities, &|v| mean(&v)),
        moment_coverage: some(&inside, &|v| mean(&v)),
        moment_interval_95_s: some(&half, &|v| mean(&v)),
        moment_rmse_s: some(&off, &|v| rms(&v)),
        delay_s: some(&delays, &|v| quantile_of(v, 0.5)),
        delay_90_s: some(&delays, &|v| quantile_of(v, 0.9)),
    }
}

/// Warnings by their text up to the first number, and the share of recordings with each.
fn warnings(recordings: &[&Recording]) -> BTreeMap<String, f64> {
    let mut counts = BTreeMap::new();
    for recording in recordings {
        let mut kinds: Vec<String> = recording.warnings.iter().map(|w| kind(w)).collect();
        kinds.sort();
        kinds.dedup();
        for kind in kinds {
            *counts.entry(kind).or_insert(0.0) += 1.0 / recordings.len() as f64;
        }
    }
    counts
}

/// A warning with its numbers taken out; digits of a name stay.
fn kind(warning: &str) -> String {
    let mut out = String::new();
    let mut in_name = false;
    for c in warning.chars() {
        in_name = c.is_alphabetic() || c == '_' || (in_name && c.is_ascii_digit());
        let numeric = !in_name && (c.is_ascii_digit() || (c == '.' && out.ends_with('#')));
        match (numeric, out.ends_with('#')) {
            (true, true) => {}
            (true, false) => out.push('#'),
            (false, _) => out.push(c),
        }
    }
    out
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
}

/// Quantile of numbers in any order.
fn quantile_of(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    quantile(&values, share)
}

/// Where a share lies with 95 % confidence.
///
/// # Source
/// E. B. Wilson, *Probable inference, the law of succession, and statistical inference*, 1927.
fn wilson(successes: usize, n: usize) -> [f64; 2] {
    const Z: f64 = 1.96;
    let (n, p) = (n as f64, successes as f64 / n as f64);
    let middle = p + Z * Z / (2.0 * n);
    let half = Z * (p * (1.0 - p) / n + Z * Z / (4.0 * n * n)).sqrt();
    let scale = 1.0 + Z * Z / n;
    [(middle - half) / scale, (middle + half) / scale]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_and_wilson_agree_with_hand_and_table() {
        assert_eq!(quantile_of(vec![3.0, 1.0, 2.0], 0.5), 2.0);
        assert_eq!(quantile_of(vec![0.0, 10.0], 0.95), 9.5);
        assert!(quantile_of(Vec::new(), 0.5).is_nan());
        // 95 of 100: 0.888 to 0.978 (Newcombe 1998 gives the score interval's closed form).
        let [low, high] = wilson(95, 100);
        assert!(
            (low - 0.8883).abs() < 1e-4 && (high - 0.9785).abs() < 1e-4,
            "{low} {high}"
        );
    }

    #[test]
    fn warnings_are_told_apart_by_their_words() {
        assert_eq!(kind("only 2 poses in 60.5 s."), "only # poses in # s.");
        assert_eq!(kind("wrist_1_joint: 3.5 mrad"), "wrist_1_joint: # mrad");
        assert_eq!(kind("lwr2: −12 ± 4 %"), "lwr2: −# ± # %");
    }
}
