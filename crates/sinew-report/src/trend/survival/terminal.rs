//! Rope lifetimes as text for a terminal.

use super::messages::{format_law, format_misfit, format_quantile, format_wear, group_name, shown};
use crate::text::{TerminalText, or_dash};
use sinew_figure::Columns;
use sinew_trend::survival::{SurvivalGroup, SurvivalReport};

/// Renders rope lifetimes as text of at most 80 columns.
pub fn render_table(report: &SurvivalReport) -> String {
    let (unit, factor) = shown(report.age_unit);
    let mut out = TerminalText::default();
    out.paragraph(format!(
        "{}: rope lifetimes; 95 % intervals in brackets",
        report.source
    ));
    let by = |group: &SurvivalGroup, share: f64| {
        let law = group.weibull.as_ref();
        let found = law.and_then(|law| law.broken_by.iter().find(|q| q.broken_ratio == share));
        or_dash(found, |q| format_quantile(q, factor))
    };
    out.table(
        Columns::of(&report.groups)
            .words("ropes", |g| group_name(g))
            .column("n", |g| g.ropes)
            .column("failed", |g| g.broke)
            .column(format!("median life\n({unit})"), |g| {
                format_quantile(&g.median, factor)
            })
            .column(format!("5 % failed by\n({unit})"), |g| by(g, 0.05))
            .column(format!("10 % failed by\n({unit})"), |g| by(g, 0.1))
            .table(),
    );
    out.add("\n");
    for group in &report.groups {
        out.paragraph(format_wear(group, report.age_unit));
        let law = group.weibull.as_ref();
        let law = law.map(|law| format_law(law, report.age_unit));
        for line in law.into_iter().chain(format_misfit(group)) {
            out.item(line);
        }
    }
    out.0
}
