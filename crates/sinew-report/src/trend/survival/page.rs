//! Rope lifetimes as figure and HTML report.

use super::messages::{
    format_age, format_law, format_misfit, format_quantile, format_wear, group_name, note_message,
    shown, wear,
};
use sinew_figure::plot::{Band, Colour, Dash, Figure, Line, Panel};
use sinew_figure::{Block, Columns, Headline, Level, Page, Table, rounded};
use sinew_trend::survival::{ReplacementVerdict, SurvivalGroup, SurvivalReport};

/// Plots the survival function (Kaplan-Meier) and the Weibull law with their 95 % bands.
pub fn figure(report: &SurvivalReport, group: &SurvivalGroup) -> Figure {
    let (unit, factor) = shown(report.age_unit);
    let percent = 100.0;
    // Survival function as steps: age, share, and its interval.
    let mut counted = vec![[0.0, percent, percent, percent]];
    counted.extend(group.curve.iter().map(|p| {
        let shares = [p.survival, p.interval_95.low, p.interval_95.high];
        let [share, low, high] = shares.map(|share| percent * share);
        [factor * p.age, share, low, high]
    }));
    let law = group.weibull.as_ref();
    let oldest = law.and_then(|l| l.curve.last()).map(|p| factor * p.age);
    if let (Some(end), Some(&[_, share, low, high])) = (oldest, counted.last()) {
        counted.push([end, share, low, high]);
    }
    let steps = counted.windows(2).flat_map(|pair| {
        let [_, share, low, high] = pair[0];
        [pair[0], [pair[1][0], share, low, high]]
    });
    let stairs: Vec<[f64; 4]> = steps.chain(counted.last().copied()).collect();
    let column = |of: &[[f64; 4]], i: usize| -> Vec<f64> { of.iter().map(|p| p[i]).collect() };
    let [age, low, high] = [0, 2, 3].map(|i| column(&stairs, i));
    let mut panel = Panel::new("", format!("age ({unit})"), "survival function (%)")
        .band(Band::new("Kaplan-Meier, 95 % interval", age, low, high).colour(Colour::Grey))
        .y_range(0.0, percent);
    if let Some(law) = law {
        let x: Vec<f64> = law.curve.iter().map(|p| factor * p.age).collect();
        let of = |f: &dyn Fn(usize) -> f64| (0..x.len()).map(|i| percent * f(i)).collect();
        let low = of(&|i| law.curve[i].interval_95.low);
        let high = of(&|i| law.curve[i].interval_95.high);
        let middle = Line::new("Weibull", x.clone(), of(&|i| law.curve[i].survival));
        panel = panel
            .band(Band::new("Weibull, 95 % interval", x, low, high).colour(Colour::Orange))
            .line(middle.colour(Colour::Orange).dash(Dash::Dashed));
    }
    let [age, share] = [0, 1].map(|i| column(&counted, i));
    panel = panel.line(Line::new("Kaplan-Meier", age, share).step());
    Figure::new(format!("Rope lifetime: {}", group_name(group)))
        .subtitle(format!("{} of {} failed", group.broke, group.ropes))
        .seen(seen(report, group))
        .size(820.0, 360.0)
        .panel(panel)
}

/// Describes the figure for screen readers.
fn seen(report: &SurvivalReport, group: &SurvivalGroup) -> String {
    let half = match group.median.age {
        Some(age) => format!("median lifetime {}", format_age(age, report.age_unit)),
        None => "more than half survived the observation".into(),
    };
    let end = group.curve.last().map_or(String::new(), |p| {
        let (percent, age) = (
            rounded(100.0 * p.survival, 2),
            format_age(p.age, report.age_unit),
        );
        format!("; {percent} % survive {age}")
    });
    let (name, ropes, broke) = (group_name(group), group.ropes, group.broke);
    let wear = wear(group, report.age_unit);
    format!("{name}: {broke} of {ropes} ropes failed; {half}{end}. {wear}")
}

/// Renders rope lifetimes as one HTML file.
pub fn html(report: &SurvivalReport) -> String {
    let mut page = Page::new("Rope lifetime");
    page.subtitle = report.source.clone();
    page.footer = format!("Sinew {}", report.sinew_version);
    let headlines = (report.groups.iter())
        .map(|g| {
            let level = level(g.replacement.verdict);
            Headline::new(level, format_wear(g, report.age_unit))
        })
        .collect();
    page = page.section("", vec![Block::Headlines(headlines)]);
    for group in &report.groups {
        page = page.section(group_name(group), blocks(report, group));
    }
    let mut how = vec![
        "A rope that was replaced before failure, or is still running, is right-censored at the end of its observation.".into(),
        "The survival function is the Kaplan-Meier estimate; its 95 % interval is Greenwood's on the scale ln(−ln S).".into(),
        "Intervals of the Weibull law are profile-likelihood intervals. A shape above 1 indicates wear.".into(),
        "Both assume ropes of one type and censoring independent of the state of the rope.".into(),
    ];
    how.extend(report.notes.iter().map(|n| note_message(n).to_string()));
    page.section("Notes", vec![Block::List(how)]).html()
}

fn level(verdict: ReplacementVerdict) -> Level {
    match verdict {
        ReplacementVerdict::Helps => Level::Watch,
        ReplacementVerdict::DoesNotHelp => Level::Alarm,
        ReplacementVerdict::Inconclusive => Level::Open,
    }
}

fn blocks(report: &SurvivalReport, group: &SurvivalGroup) -> Vec<Block> {
    let (unit, factor) = shown(report.age_unit);
    let mut blocks = vec![Block::Figure(
        Box::new(figure(report, group)),
        format!(
            "Total exposure {}",
            format_age(group.exposure_age, report.age_unit)
        ),
    )];
    let quantiles = (group.weibull.iter()).flat_map(|law| &law.broken_by);
    let mut rows = vec![vec![
        "50 %, Kaplan-Meier".to_string(),
        format_quantile(&group.median, factor),
    ]];
    rows.extend(quantiles.map(|q| {
        let share = rounded(100.0 * q.broken_ratio, 2);
        vec![format!("{share} %, Weibull"), format_quantile(q, factor)]
    }));
    blocks.push(Block::Table(Table::new(&["failed", unit], rows).captioned(
        format!(
            "Age by which a share of the ropes has failed ({unit}); 95 % intervals in brackets"
        ),
    )));
    let law = group.weibull.as_ref();
    let law = law.map(|law| format_law(law, report.age_unit));
    let facts: Vec<String> = law.into_iter().chain(format_misfit(group)).collect();
    if !facts.is_empty() {
        blocks.push(Block::List(facts));
    }
    let percent = |x: f64| rounded(100.0 * x, 3);
    let curve = Columns::of(&group.curve)
        .column(unit, |p| rounded(factor * p.age, 3))
        .column("at risk", |p| p.at_risk)
        .column("failed", |p| p.broke)
        .column("survival (%)", |p| percent(p.survival))
        .column("95 % interval (%)", |p| {
            let [low, high] = [p.interval_95.low, p.interval_95.high].map(percent);
            format!("{low} to {high}")
        });
    let curve = vec![curve.table().into()];
    blocks.push(Block::Folded("Survival function as table".into(), curve));
    blocks
}
