//! The ends of sessions B and C over many recordings: shares inside their intervals, and outside unsaid.

use super::result::{EndSummary, ScenarioReport, ScenarioSummary};
use super::table::render_rejected;
use super::{End, EndScore, Form, Recording};
use crate::numbers::{mean, rms, weighted_mean};
use sinew_model::{Gaussian, Z95};
use sinew_report::text::{paragraph, plain, table};

/// Summarises the assessed ends; an end that no recording has is omitted.
pub(super) fn summarise(recordings: &[&Recording]) -> Vec<EndSummary> {
    let all = Form::ALL.map(|form| [End::B, End::Chain].map(|end| (end, form)));
    (all.iter().flatten())
        .filter_map(|&(end, form)| {
            let scores = recordings.iter().flat_map(|r| &r.ends);
            let own = scores.filter(|e| (e.end, e.form) == (end, form));
            one((end, form), &own.collect::<Vec<_>>())
        })
        .collect()
}

fn one((end, form): (End, Form), scores: &[&EndScore]) -> Option<EndSummary> {
    let errors: Vec<Gaussian> = scores.iter().flat_map(|s| s.errors_rad.clone()).collect();
    if errors.is_empty() {
        return None;
    }
    let count = errors.len() as f64;
    let sum = |of: fn(&EndScore) -> usize| scores.iter().map(|s| of(s)).sum::<usize>() as f64;
    let warned = scores.iter().filter(|s| s.is_warned).count();
    let halves: Vec<f64> = errors.iter().map(|e| Z95 * e.std).collect();
    Some(EndSummary {
        end,
        form,
        offsets: errors.len(),
        coverage_share: 1.0 - sum(EndScore::outside) / count,
        rmse_rad: rms(&errors.iter().map(|e| e.mean).collect::<Vec<_>>()),
        half_width_95_rad: mean(&halves),
        warned_share: warned as f64 / scores.len() as f64,
        silent_share: sum(EndScore::silent) / count,
        far_share: sum(EndScore::far) / count,
    })
}

/// One line per scenario and end, as text of at most 80 columns; the last lines are all together. A second table is of the online
/// estimate.
pub fn render_ends(report: &ScenarioReport) -> String {
    let mut text = ends_of(report, Form::Batch, "warned\n%");
    text.push('\n');
    text.push_str(&paragraph(
        "B: with A's baseline; chain: C with the posterior of B as prior; ±: mean half-width of the 95 % interval; \
         warned: recordings whose session has a warning; silent: offsets outside their interval although \
         their session has no warning; far: those more than three standard deviations from the truth (0.27 % expected by chance)",
        0,
    ));
    text.push_str("\nOnline estimate\n");
    text.push_str(&ends_of(report, Form::Online, "warned\n%"));
    text.push('\n');
    text.push_str(&paragraph(
        "chain: B and C without a break; warned: recordings at whose end the estimate is provisional or has a \
         warning; silent: offsets outside their interval without either",
        0,
    ));
    for s in &report.scenarios {
        if let Some(about) = &s.about {
            text.push_str(&paragraph(&format!("{}: {about}", plain(&s.scenario)), 2));
        }
    }
    text.push_str(&render_rejected(report));
    text
}

fn ends_of(report: &ScenarioReport, form: Form, warned: &str) -> String {
    let mut rows = Vec::new();
    for s in &report.scenarios {
        for (k, end) in s.ends.iter().filter(|e| e.form == form).enumerate() {
            let name = if k == 0 {
                plain(&s.scenario)
            } else {
                String::new()
            };
            rows.push(row(name, end));
        }
    }
    for end in [End::B, End::Chain] {
        if let Some(all) = together((end, form), &report.scenarios) {
            rows.push(row("all".into(), &all));
        }
    }
    let head = [
        "",
        "end of",
        "offsets",
        "inside\n%",
        "RMSE\nmrad",
        "±\nmrad",
        warned,
        "silent\n%",
        "far\n%",
    ];
    table(&head, rows, 2)
}

fn row(name: String, end: &EndSummary) -> Vec<String> {
    let of = match end.end {
        End::B => "B",
        End::Chain => "chain",
    };
    vec![
        name,
        of.into(),
        end.offsets.to_string(),
        format!("{:.1}", 100.0 * end.coverage_share),
        format!("{:.2}", 1e3 * end.rmse_rad),
        format!("{:.2}", 1e3 * end.half_width_95_rad),
        format!("{:.0}", 100.0 * end.warned_share),
        format!("{:.1}", 100.0 * end.silent_share),
        format!("{:.2}", 100.0 * end.far_share),
    ]
}

/// Pools all scenarios, with equal weight of each offset and each recording.
fn together((end, form): (End, Form), scenarios: &[ScenarioSummary]) -> Option<EndSummary> {
    let of_end: Vec<(&EndSummary, f64)> = (scenarios.iter())
        .flat_map(|s| s.ends.iter().map(|e| (e, s.recordings as f64)))
        .filter(|(e, _)| (e.end, e.form) == (end, form))
        .collect();
    let offsets: usize = of_end.iter().map(|(e, _)| e.offsets).sum();
    if offsets == 0 {
        return None;
    }
    let each = |of: fn(&EndSummary) -> f64| {
        let pairs = of_end.iter().map(|(e, _)| (e.offsets as f64, of(e)));
        weighted_mean(&pairs.collect::<Vec<_>>())
    };
    let warned: Vec<(f64, f64)> = of_end.iter().map(|(e, n)| (*n, e.warned_share)).collect();
    Some(EndSummary {
        end,
        form,
        offsets,
        coverage_share: each(|e| e.coverage_share),
        rmse_rad: each(|e| e.rmse_rad.powi(2)).sqrt(),
        half_width_95_rad: each(|e| e.half_width_95_rad),
        warned_share: weighted_mean(&warned),
        silent_share: each(|e| e.silent_share),
        far_share: each(|e| e.far_share),
    })
}
