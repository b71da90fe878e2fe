//! Text output of a run's report.

use super::RejectedRecording;
use super::result::{ScenarioReport, ScenarioSummary};
use sinew_model::Z95;
use sinew_report::text::{paragraph, plain, table};
use std::collections::BTreeSet;

/// Results as text of at most 80 columns.
pub fn render_table(report: &ScenarioReport) -> String {
    let summaries = report.scenarios.as_slice();
    let robots: BTreeSet<String> = summaries.iter().map(|s| plain(&s.robot)).collect();
    let robots = Vec::from_iter(robots).join(", ");
    let mut text =
        format!("{robots}: offset at the end of session B, mrad; estimate minus truth\n");
    let mut rows = Vec::new();
    for s in summaries {
        let mut head = vec![format!("{}, n = {}", s.scenario, s.recordings)];
        head.resize(9, String::new());
        rows.push(head);
        for j in &s.joints {
            rows.push(vec![
                plain(&j.name),
                short(1e3 * j.bias_rad),
                short(1e3 * j.rmse_rad),
                short(1e3 * j.error_q95_rad),
                short(1e3 * Z95 * j.reported_std_rad),
                short(100.0 * j.coverage_share),
                optional(j.bound_rad, 1e3),
                optional(j.paper_rmse_rad, 1e3),
                optional(j.paper_minus_baseline_rmse_rad, 1e3),
            ]);
        }
    }
    let head = [
        "joint", "bias", "RMSE", "95 %", "±", "cov., %", "bound", "paper", "−A",
    ];
    text.push_str(&table(&head, rows, 1));
    text.push('\n');
    text.push_str(&paragraph(
        "95 %: quantile of the absolute error; ±: mean half-width of the 95 % interval; \
         cov.: coverage of that interval; bound: Bayesian Cramér–Rao; paper: RMSE of the paper's mean, −A: minus its own \
         of session A",
        0,
    ));
    for s in summaries {
        if let Some(about) = &s.about {
            text.push_str(&paragraph(&format!("{}: {about}", s.scenario), 2));
        }
    }
    if report.with_slips {
        text.push_str("\nSlips in session C, with 20 s of recording after them\n");
        text.push_str(&slips(summaries));
    }
    text.push_str(&warned(summaries));
    text.push_str(&render_rejected(report));
    text
}

/// Formats the recordings rejected by the estimator, if any.
pub(super) fn render_rejected(report: &ScenarioReport) -> String {
    let of = |r: &RejectedRecording| {
        let name = plain(&r.scenario);
        paragraph(&format!("{name}, seed {}: {}", r.seed, plain(&r.reason)), 2)
    };
    let lines: String = report.rejections.iter().map(of).collect();
    match report.rejections.len() {
        0 => lines,
        n => format!("\nRejected by the estimator and excluded from all figures: {n}\n{lines}"),
    }
}

/// Three digits or so, in five characters.
fn short(v: f64) -> String {
    let decimals = match v.abs() {
        x if x < 9.995 => 2,
        x if x < 99.95 => 1,
        _ => 0,
    };
    format!("{v:.decimals$}").replace('-', "−")
}

/// Formats a value multiplied by `factor`, or a dash if it is missing.
fn optional(v: Option<f64>, factor: f64) -> String {
    v.map_or("–".into(), |v| short(factor * v))
}

fn slips(summaries: &[ScenarioSummary]) -> String {
    let mut rows = Vec::new();
    for s in summaries {
        for (k, step) in s.slips.iter().enumerate() {
            let first = |text: String| if k == 0 { text } else { String::new() };
            rows.push(vec![
                first(s.scenario.clone()),
                plain(&step.joint),
                short(100.0 * step.found_share),
                optional(step.found_rmse_rad, 1e3),
                optional(step.time_half_width_95_s, 1.0),
                optional(step.time_coverage_share, 100.0),
                optional(step.delay_s, 1.0),
                optional(step.delay_90_s, 1.0),
                first(optional(s.false_alarms_per_hour, 1.0)),
            ]);
        }
    }
    let head = [
        "",
        "joint",
        "found\n%",
        "RMSE\nmrad",
        "time\n± s",
        "cov.\n%",
        "delay\ns",
        "90 %\ns",
        "false\n1/h",
    ];
    table(&head, rows, 2)
}

/// Formats how often each warning occurred.
fn warned(summaries: &[ScenarioSummary]) -> String {
    let mut text = String::new();
    for s in summaries {
        for (warning, share) in &s.warnings {
            text.push_str(&paragraph(
                &format!("{}, {:.0} %: {}", s.scenario, 100.0 * share, plain(warning)),
                2,
            ));
        }
    }
    if text.is_empty() {
        text
    } else {
        format!("\nWarnings, with their share of the recordings\n{text}")
    }
}
