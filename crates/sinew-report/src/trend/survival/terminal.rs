//! How long ropes last, as a terminal shows it.

use super::words::{format_law, format_misfit, format_quantile, format_wear, group_name, shown};
use crate::text::{Told, or_dash};
use sinew_figure::Columns;
use sinew_trend::survival::{SurvivalGroup, SurvivalReport};

/// The report as text of at most 80 columns.
pub fn render_table(report: &SurvivalReport) -> String {
    let (unit, factor) = shown(report.age_unit);
    let mut out = Told::default();
    out.say(format!(
        "{}: how long ropes last; brackets are 95 %",
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
            .column("lives", |g| g.ropes)
            .column("broke", |g| g.broke)
            .column(format!("half outlast\n{unit}"), |g| {
                format_quantile(&g.median, factor)
            })
            .column(format!("5 % broken by\n{unit}"), |g| by(g, 0.05))
            .column(format!("10 % broken by\n{unit}"), |g| by(g, 0.1))
            .table(),
    );
    out.add("\n");
    for group in &report.groups {
        out.say(format_wear(group, report.age_unit));
        let law = group.weibull.as_ref();
        let law = law.map(|law| format_law(law, report.age_unit));
        for line in law.into_iter().chain(format_misfit(group)) {
            out.item(line);
        }
    }
    out.0
}
