//! How long ropes last, as a terminal shows it.

use super::words::{format_law, format_misfit, format_quantile, format_wear, group_name, shown};
use crate::text::{indented, paragraph, plain, table};
use sinew_trend::survival::{SurvivalGroup, SurvivalReport};

/// The report as text of at most 80 columns.
pub fn render_table(report: &SurvivalReport) -> String {
    let (unit, factor) = shown(report.age_unit);
    let heading = format!("{}: how long ropes last; brackets are 95 %", report.source);
    let mut out = paragraph(&plain(&heading), 2);
    let by = |share: u32| format!("{share} % broken by\n{unit}");
    let half = format!("half outlast\n{unit}");
    let (five, ten) = (by(5), by(10));
    let head = ["ropes", "lives", "broke", &half, &five, &ten];
    let rows = (report.groups.iter()).map(|g| row(g, factor)).collect();
    out.push_str(&table(&head, rows, 1));
    out.push('\n');
    for group in &report.groups {
        let headline = format!(
            "{}: {}",
            group_name(group),
            format_wear(group, report.age_unit)
        );
        out.push_str(&paragraph(&plain(&headline), 2));
        if let Some(law) = &group.weibull {
            out.push_str(&indented(&plain(&format_law(law, report.age_unit)), 2, 4));
        }
        if let Some(misfit) = format_misfit(group) {
            out.push_str(&indented(&plain(&misfit), 2, 4));
        }
    }
    out
}

fn row(group: &SurvivalGroup, factor: f64) -> Vec<String> {
    let by = |share: f64| {
        let law = group.weibull.as_ref();
        let found = law.and_then(|law| law.broken_by.iter().find(|q| q.broken_ratio == share));
        found.map_or("–".into(), |q| format_quantile(q, factor))
    };
    vec![
        plain(group_name(group)),
        group.ropes.to_string(),
        group.broke.to_string(),
        format_quantile(&group.median, factor),
        by(0.05),
        by(0.1),
    ]
}
