//! How long ropes last, as a figure and as a page.

use super::words::{
    format_age, format_law, format_misfit, format_note, format_quantile, format_wear, group_name,
    shown,
};
use sinew_figure::plot::{Band, Colour, Dash, Figure, Line, Panel};
use sinew_figure::{Block, Headline, Level, Page, Table, rounded};
use sinew_trend::survival::{SurvivalGroup, SurvivalReport, Wear};

/// Share of ropes that last longer than an age: the curve with its band, the law with its.
pub fn figure(report: &SurvivalReport, group: &SurvivalGroup) -> Figure {
    let (unit, factor) = shown(report.age_unit);
    let percent = 100.0;
    // From the first day on, and level until the next break.
    let mut ages = vec![0.0];
    let (mut share, mut low, mut high) = (vec![percent], vec![percent], vec![percent]);
    for p in &group.curve {
        ages.push(factor * p.age);
        share.push(percent * p.survival);
        low.push(percent * p.interval_95.low);
        high.push(percent * p.interval_95.high);
    }
    let law = group.weibull.as_ref();
    let oldest = law.and_then(|l| l.curve.last()).map(|p| factor * p.age);
    if let (Some(end), Some(&last)) = (oldest, share.last()) {
        let (l, h) = (low[low.len() - 1], high[high.len() - 1]);
        ages.push(end);
        share.push(last);
        low.push(l);
        high.push(h);
    }
    let (stairs, low) = stairs(&ages, &low);
    let (_, high) = self::stairs(&ages, &high);
    let mut panel = Panel::new("", format!("age ({unit})"), "ropes that last longer (%)")
        .band(Band::new("as counted, 95 %", stairs, low, high).colour(Colour::Grey))
        .y_range(0.0, percent);
    if let Some(law) = law {
        let x: Vec<f64> = law.curve.iter().map(|p| factor * p.age).collect();
        let of = |f: &dyn Fn(usize) -> f64| (0..x.len()).map(|i| percent * f(i)).collect();
        let low = of(&|i| law.curve[i].interval_95.low);
        let high = of(&|i| law.curve[i].interval_95.high);
        let middle = of(&|i| law.curve[i].survival);
        panel = panel
            .band(Band::new("law, 95 %", x.clone(), low, high).colour(Colour::Orange))
            .line(
                Line::new("Weibull law", x, middle)
                    .colour(Colour::Orange)
                    .dash(Dash::Dashed),
            );
    }
    panel = panel.line(Line::new("as counted", ages, share).step());
    Figure::new(format!("How long ropes last: {}", group_name(group)))
        .subtitle(format!("{} of {} broke", group.broke, group.ropes))
        .seen(seen(report, group))
        .size(820.0, 360.0)
        .panel(panel)
}

/// A level curve as the corners of its stairs.
fn stairs(x: &[f64], y: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let (mut out_x, mut out_y) = (Vec::new(), Vec::new());
    for i in 0..x.len() {
        if i > 0 {
            out_x.push(x[i]);
            out_y.push(y[i - 1]);
        }
        out_x.push(x[i]);
        out_y.push(y[i]);
    }
    (out_x, out_y)
}

/// What the figure shows.
fn seen(report: &SurvivalReport, group: &SurvivalGroup) -> String {
    let half = match group.median.age {
        Some(age) => format!("half outlast {}", format_age(age, report.age_unit)),
        None => "more than half outlasted the watch".into(),
    };
    let end = group.curve.last().map_or(String::new(), |p| {
        format!(
            "; {} % outlast {}",
            rounded(100.0 * p.survival, 2),
            format_age(p.age, report.age_unit)
        )
    });
    format!(
        "{}: of {} ropes {} broke; {half}{end}. {}",
        group_name(group),
        group.ropes,
        group.broke,
        format_wear(group, report.age_unit)
    )
}

/// The page.
pub fn html(report: &SurvivalReport) -> String {
    let mut page = Page::new("How long ropes last");
    page.subtitle = report.source.clone();
    page.footer = format!("Sinew {}", report.sinew_version);
    let headlines = (report.groups.iter())
        .map(|g| {
            let said = format!("{}: {}", group_name(g), format_wear(g, report.age_unit));
            Headline::new(level(g.wear), said)
        })
        .collect();
    page = page.section("", vec![Block::Headlines(headlines)]);
    for group in &report.groups {
        page = page.section(group_name(group), blocks(report, group));
    }
    let mut how = vec![
        "A rope that was replaced in time, or runs still, counts as long as it was watched.".into(),
        "The curve supposes nothing of how ropes age; its band is Greenwood's on the scale of ln(−ln S).".into(),
        "The law's intervals are by profile likelihood. A shape above 1 means wear.".into(),
        "Both suppose that ropes are of one kind, and that what ended a watch says nothing of the rope.".into(),
    ];
    how.extend(report.notes.iter().map(format_note));
    page.section("How to read this", vec![Block::List(how)])
        .html()
}

fn level(wear: Wear) -> Level {
    match wear {
        Wear::WearsOut => Level::Watch,
        Wear::BreaksEarly => Level::Alarm,
        Wear::AgeSaysNothing | Wear::CannotTell => Level::Open,
    }
}

fn blocks(report: &SurvivalReport, group: &SurvivalGroup) -> Vec<Block> {
    let (unit, factor) = shown(report.age_unit);
    let mut blocks = vec![Block::Figure(
        Box::new(figure(report, group)),
        format!(
            "Watched for {} in all",
            format_age(group.watched_age, report.age_unit)
        ),
    )];
    let quantiles = (group.weibull.iter()).flat_map(|law| &law.broken_by);
    let mut rows = vec![vec![
        "50 %, as counted".to_string(),
        format_quantile(&group.median, factor),
    ]];
    rows.extend(quantiles.map(|q| {
        let share = rounded(100.0 * q.broken_ratio, 2);
        vec![format!("{share} %, by the law"), format_quantile(q, factor)]
    }));
    blocks.push(Block::Table(Table::new(&["broken", unit], rows).captioned(
        format!("Ages by which ropes have broken, {unit}; brackets are 95 %"),
    )));
    let mut facts = Vec::new();
    facts.extend(
        group
            .weibull
            .as_ref()
            .map(|law| format_law(law, report.age_unit)),
    );
    facts.extend(format_misfit(group));
    if !facts.is_empty() {
        blocks.push(Block::List(facts));
    }
    let points = (group.curve.iter()).map(|p| {
        let percent = |x: f64| rounded(100.0 * x, 3);
        vec![
            rounded(factor * p.age, 3),
            p.at_risk.to_string(),
            p.broke.to_string(),
            percent(p.survival),
            format!(
                "{} to {}",
                percent(p.interval_95.low),
                percent(p.interval_95.high)
            ),
        ]
    });
    let head = [unit, "had reached it", "broke", "last longer, %", "95 %"];
    blocks.push(Block::Folded(
        "The curve as a table".into(),
        vec![Block::Table(Table::new(&head, points))],
    ));
    blocks
}
