//! Summary of many recordings.

use super::end;
use super::result::{ScenarioJoint, ScenarioReport, ScenarioSummary, SlipSummary};
use super::{FoundStep, JointScore, Options, Recording, RejectedRecording, Sessions, StepScore};
use crate::numbers::{finite, mean, quantile_of, rms};
use sinew_model::{Interval95, Z95};
use sinew_report::session_warning;
use sinew_sim::protocol::Plan;
use std::collections::BTreeMap;

/// Sums recordings up by scenario.
pub(super) fn summarise(
    plans: &[Plan],
    recordings: &[Recording],
    rejections: Vec<RejectedRecording>,
    options: &Options,
) -> ScenarioReport {
    let of = |plan: &Plan| -> Vec<&Recording> {
        let own = recordings.iter().filter(|r| r.scenario == plan.name);
        own.collect()
    };
    ScenarioReport {
        sinew_version: env!("CARGO_PKG_VERSION").into(),
        first_seed: options.first_seed,
        recordings: options.n,
        with_slips: options.sessions == Sessions::Slips,
        scenarios: plans.iter().map(|plan| scenario(plan, &of(plan))).collect(),
        rejections,
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
    let exposure_s = recordings.iter().map(|r| r.exposure_s).sum::<f64>();
    let alarms: Vec<f64> = (recordings.iter())
        .flat_map(|r| r.false_alarms.iter().copied())
        .collect();
    let payload: Vec<f64> = recordings.iter().map(|r| r.payload_error_kg.mean).collect();
    let rejected: Vec<f64> = recordings.iter().map(|r| r.rejected_share).collect();
    ScenarioSummary {
        scenario: plan.name.clone(),
        robot: plan.robot.name.clone(),
        about: plan.about.clone(),
        recordings: recordings.len(),
        ends: end::summarise(recordings),
        joints: names.iter().map(|name| joint(name, recordings)).collect(),
        slips: slipping
            .iter()
            .map(|name| slips(name, recordings))
            .collect(),
        false_alarms_per_hour: finite(alarms.len() as f64 / (exposure_s / 3600.0)),
        false_alarm_probability: (!alarms.is_empty()).then(|| mean(&alarms)),
        exposure_s,
        payload_rmse_kg: finite(rms(&payload)),
        rejected_share: finite(mean(&rejected)),
        warnings: warnings(recordings),
    }
}

fn joint(name: &str, recordings: &[&Recording]) -> ScenarioJoint {
    let scores: Vec<_> = recordings
        .iter()
        .filter_map(|r| r.joints.iter().find(|j| j.name == name))
        .collect();
    let errors: Vec<f64> = scores.iter().map(|j| j.error_rad.mean).collect();
    let stated: Vec<f64> = scores.iter().map(|j| j.error_rad.std).collect();
    let z: Vec<f64> = scores
        .iter()
        .map(|j| j.error_rad.mean / j.error_rad.std)
        .collect();
    let inside = scores
        .iter()
        .filter(|j| !j.error_rad.is_nonzero_95())
        .count();
    let inconclusive = scores.iter().filter(|j| !j.is_conclusive).count();
    let n = scores.len();
    let optional = |of: fn(&JointScore) -> Option<f64>| -> Option<f64> {
        let values: Vec<f64> = scores.iter().filter_map(|j| of(j)).collect();
        (!values.is_empty()).then(|| rms(&values))
    };
    let z_mean = mean(&z);
    ScenarioJoint {
        name: name.into(),
        bias_rad: mean(&errors),
        rmse_rad: rms(&errors),
        error_q95_rad: quantile_of(errors.iter().map(|e| e.abs()).collect(), 0.95),
        coverage_share: inside as f64 / n as f64,
        coverage_95: wilson(inside, n),
        reported_std_rad: mean(&stated),
        z_mean,
        z_std: (rms(&z).powi(2) - z_mean * z_mean).max(0.0).sqrt(),
        inconclusive_share: inconclusive as f64 / n as f64,
        bound_rad: optional(|j| j.bound_rad),
        paper_rmse_rad: optional(|j| j.paper_error_rad),
        paper_minus_baseline_rmse_rad: optional(|j| j.paper_minus_baseline_error_rad),
        matched_rmse_rad: optional(|j| j.matched_error_rad),
        matched_minus_baseline_rmse_rad: optional(|j| j.matched_minus_baseline_error_rad),
    }
}

fn slips(name: &str, recordings: &[&Recording]) -> SlipSummary {
    let slips: Vec<&StepScore> = recordings
        .iter()
        .flat_map(|r| &r.steps)
        .filter(|s| s.joint == name)
        .collect();
    let found: Vec<&&StepScore> = slips.iter().filter(|s| s.found.is_some()).collect();
    let errors: Vec<f64> = slips.iter().map(|s| s.error_rad()).collect();
    let found_errors: Vec<f64> = found.iter().map(|s| s.error_rad()).collect();
    let pairs: Vec<(&StepScore, FoundStep)> = (slips.iter())
        .filter_map(|s| Some((*s, s.found?)))
        .collect();
    let of_found = |f: &dyn Fn(&StepScore, FoundStep) -> f64| -> Vec<f64> {
        pairs.iter().map(|(s, found)| f(s, *found)).collect()
    };
    let probabilities = of_found(&|_, found| found.probability);
    let inside = of_found(&|s, _| f64::from(u8::from(s.is_time_inside() == Some(true))));
    let half = of_found(&|_, found| 0.5 * (found.interval_95_s.high - found.interval_95_s.low));
    let off = of_found(&|s, found| found.time_s - s.at_s);
    let delays: Vec<f64> = slips.iter().filter_map(|s| s.delay_s).collect();
    let some = |values: &[f64], f: &dyn Fn(Vec<f64>) -> f64| {
        (!values.is_empty()).then(|| f(values.to_vec()))
    };
    SlipSummary {
        joint: name.into(),
        slips: slips.len(),
        found_share: found.len() as f64 / slips.len() as f64,
        rmse_rad: rms(&errors),
        found_rmse_rad: some(&found_errors, &|v| rms(&v)),
        probability: some(&probabilities, &|v| mean(&v)),
        time_coverage_share: some(&inside, &|v| mean(&v)),
        time_half_width_95_s: some(&half, &|v| mean(&v)),
        time_rmse_s: some(&off, &|v| rms(&v)),
        delay_s: some(&delays, &|v| quantile_of(v, 0.5)),
        delay_90_s: some(&delays, &|v| quantile_of(v, 0.9)),
    }
}

/// Warnings by their text up to the first number, and the share of recordings with each.
fn warnings(recordings: &[&Recording]) -> BTreeMap<String, f64> {
    let mut counts = BTreeMap::new();
    for recording in recordings {
        let mut kinds: Vec<String> = recording
            .warnings
            .iter()
            .map(|w| kind(&session_warning(w)))
            .collect();
        kinds.sort();
        kinds.dedup();
        for kind in kinds {
            *counts.entry(kind).or_insert(0.0) += 1.0 / recordings.len() as f64;
        }
    }
    counts
}

/// Removes the numbers from a warning; digits of a name remain.
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

/// Returns the 95 % confidence interval of a share.
///
/// # Source
/// E. B. Wilson, *Probable inference, the law of succession, and statistical inference*, 1927.
fn wilson(successes: usize, n: usize) -> Interval95 {
    const Z: f64 = Z95;
    let (n, p) = (n as f64, successes as f64 / n as f64);
    let middle = p + Z * Z / (2.0 * n);
    let half = Z * (p * (1.0 - p) / n + Z * Z / (4.0 * n * n)).sqrt();
    let scale = 1.0 + Z * Z / n;
    Interval95::new((middle - half) / scale, (middle + half) / scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_and_wilson_match_reference_values() {
        assert_eq!(quantile_of(vec![3.0, 1.0, 2.0], 0.5), 2.0);
        assert_eq!(quantile_of(vec![0.0, 10.0], 0.95), 9.5);
        assert!(quantile_of(Vec::new(), 0.5).is_nan());
        // 95 of 100: 0.888 to 0.978 (Newcombe 1998 gives the score interval's closed form).
        let Interval95 { low, high } = wilson(95, 100);
        assert!(
            (low - 0.8883).abs() < 1e-4 && (high - 0.9785).abs() < 1e-4,
            "{low} {high}"
        );
    }

    #[test]
    fn warnings_are_grouped_by_text() {
        assert_eq!(kind("only 2 poses in 60.5 s."), "only # poses in # s.");
        assert_eq!(kind("wrist_1_joint: 3.5 mrad"), "wrist_1_joint: # mrad");
        assert_eq!(kind("lwr2: −12 ± 4 %"), "lwr2: −# ± # %");
    }
}
