//! Prediction of the elongation of a rope as text and HTML report.

use super::messages::assumed_note;
use super::{bracketed, caution_message, life, notices, page, route_map, share_of_draws, spoken};
use crate::text::{TerminalText, capitalised};
use sinew_figure::plot::{Band, Figure, Line, Panel, Points};
use sinew_figure::{Block, Columns, Headline, Level, Page, Table, rounded};
use sinew_model::Bounded;
use sinew_rope::predict::{PredictedElongation, Prediction};

/// Builds the report of a prediction.
///
/// * `curve`: values at the times of [`super::series::curve_times`].
pub fn predicted(p: &Prediction, curve: &[PredictedElongation]) -> Page {
    let mut first = Vec::new();
    if let Some(last) = p.readings.last() {
        first.push(Block::Headlines(vec![Headline::from(format!(
            "{} after {}: elongation {} mm after pretensioning (95 % interval in brackets).{}",
            p.rope,
            spoken(last.time_s),
            bracketed(last.since_tensioned_m.scaled(1e3), 2),
            assumed_note(p.assumed_parameters, p.parameters)
        ))]));
    }
    if let Some(time_s) = p.breaks_after_s {
        let failure = format!(
            "{}: failure predicted after about {} ({}).{}",
            p.rope,
            spoken(time_s),
            life::cause(p.lifetime.cause),
            assumed_note(p.assumed_parameters, p.parameters)
        );
        let failure = Headline::new(Level::Alarm, failure);
        first.push(Block::Headlines(vec![failure]));
    }
    if let (Some(text), None) = (broken(p), p.breaks_after_s) {
        let failure = format!(
            "{}. {}.",
            capitalised(&text),
            capitalised(&life::lifetime(&p.lifetime))
        );
        first.push(Block::Headlines(vec![Headline::new(Level::Watch, failure)]));
    }
    first.extend(notices(&p.cautions));
    if p.readings.len() > 1 {
        first.push(Block::Figure(Box::new(trajectory(p, curve)), String::new()));
    }
    let s = &p.summary;
    let celsius = [
        s.temperature_min_c,
        s.temperature_mean_c,
        s.temperature_max_c,
    ];
    let constant = s.tension_min_n == s.tension_max_n && celsius[0] == celsius[2];
    let cycle = match constant {
        true => "constant".into(),
        false => spoken(s.duration_s),
    };
    let strength = p.strength_left_share.map_or_else(
        || "not requested, or failed before".into(),
        |i| format!("{} % of new", bracketed(i.scaled(100.0), 2)),
    );
    let basis = Table::facts([
        ("duty", p.duty.clone()),
        ("cycle", cycle),
        (
            "tension",
            span([s.tension_min_n, s.tension_mean_n, s.tension_max_n], "N"),
        ),
        ("temperature", span(celsius, "°C")),
        ("strand", format!("{} mm", rounded(1e3 * p.length_m, 4))),
        ("reference conditions", read_at(p)),
        ("parameters", format!("{}; {}", assumed(p), draws(p))),
        ("residual strength after bending", strength),
    ]);
    let mut lasts = vec![Block::Paragraph(format!(
        "{}.",
        capitalised(&life::lifetime(&p.lifetime))
    ))];
    if route_map::is_drawn(p) {
        let about = "Schematic route with pulleys alternating left and right. Line width: share of the life used in each section.";
        lasts.push(Block::Figure(Box::new(route_map::figure(p)), about.into()));
    }
    if life::is_significant(&p.lifetime) {
        let about = "Life used in each section at the last time or at failure; * weakest section.";
        lasts.push(Block::Figure(
            Box::new(life::figure(&p.lifetime)),
            about.into(),
        ));
        lasts.push(life::spots(&p.lifetime).into());
    }
    page(format!("Elongation of {}", p.rope), p.duty.clone())
        .section("", first)
        .section(
            "Elongation",
            vec![elongations(p, |v| bracketed(v, 2)).into()],
        )
        .section("Lifetime", lasts)
        .section("Conditions and parameters", vec![basis.into()])
}

/// Plots the elongation over time with its band, and the values of the table as dots.
fn trajectory(p: &Prediction, curve: &[PredictedElongation]) -> Figure {
    let of = |readings: &[PredictedElongation], f: fn(Bounded) -> f64| -> Vec<f64> {
        let all = readings.iter().map(|r| r.since_tensioned_m.scaled(1e3));
        all.map(f).collect()
    };
    let times =
        |of: &[PredictedElongation]| -> Vec<f64> { of.iter().map(|r| r.time_s.log10()).collect() };
    let most = of(curve, |i| i.high).into_iter().fold(0.0, f64::max);
    let x = times(curve);
    let (low, high) = (of(curve, |i| i.low), of(curve, |i| i.high));
    let dots = Points::new(
        "table values",
        times(&p.readings),
        of(&p.readings, |i| i.value),
    );
    let panel = Panel::new("", "time", "elongation after pretensioning (mm)")
        .y_range(0.0, 1.06 * most)
        .band(Band::new("95 % interval", x.clone(), low, high))
        .line(Line::new("catalogue values", x, of(curve, |i| i.value)))
        .points(dots)
        .x_times();
    let values = p.readings.iter().map(|r| {
        let mm = bracketed(r.since_tensioned_m.scaled(1e3), 2);
        format!("after {} {mm} mm", spoken(r.time_s))
    });
    Figure::new("")
        .size(820.0, 360.0)
        .seen(format!(
            "{}: elongation after pretensioning with 95 % intervals: {}",
            p.rope,
            values.collect::<Vec<_>>().join(", ")
        ))
        .panel(panel)
}

/// Tabulates the elongation over time.
///
/// * `number`: format of total strain and permanent elongation.
fn elongations(p: &Prediction, number: fn(Bounded) -> String) -> Table {
    let mm = |length: Bounded| bracketed(length.scaled(1e3), 2);
    Columns::of(&p.readings)
        .words("after", |r| spoken(r.time_s))
        .column("after pretensioning\n(mm)", |r| mm(r.since_tensioned_m))
        .column("total\n(mm)", |r| mm(r.elongation_m))
        .column("total\n(%)", |r| number(r.strain_ratio.scaled(100.0)))
        .column("permanent\n(mm)", |r| number(r.irreversible_m.scaled(1e3)))
        .table()
}

/// Formats tension and temperature to which the elongations refer.
fn read_at(p: &Prediction) -> String {
    let [newtons, celsius] = [p.read_at_n, p.read_at_c].map(|v| rounded(v, 3));
    format!("{newtons} N and {celsius} °C")
}

/// Formats number and seed of the draws.
fn draws(p: &Prediction) -> String {
    format!("{} draws (seed {})", p.draws, p.seed)
}

/// States how many parameters are assumed.
fn assumed(p: &Prediction) -> String {
    let (assumed, all) = (p.assumed_parameters, p.parameters);
    format!("{assumed} of {all} parameters assumed")
}

/// States the share of draws in which the rope fails; `None` if in none.
fn broken(p: &Prediction) -> Option<String> {
    let last = p.readings.last()?;
    (last.broken_share > 0.0).then(|| {
        format!(
            "failure in {} of the draws within {}; the elongation of these draws is that at failure",
            share_of_draws(last.broken_share),
            spoken(last.time_s)
        )
    })
}

/// Formats minimum, maximum and mean; one number if they are equal.
fn span([least, mean, most]: [f64; 3], unit: &str) -> String {
    let same = least == most;
    let [least, mean, most] = [least, mean, most].map(|v| rounded(v, 3));
    match same {
        true => format!("{mean} {unit}"),
        false => format!("{least} to {most} {unit}, mean {mean} {unit}"),
    }
}

/// Renders a prediction for a terminal.
pub fn prediction_table(p: &Prediction) -> String {
    let mut out = TerminalText::default();
    out.paragraph(format!("{}: {}", p.rope, p.duty));
    let s = &p.summary;
    if s.tension_min_n != s.tension_max_n || s.temperature_min_c != s.temperature_max_c {
        let tensions = [s.tension_min_n, s.tension_max_n, s.tension_mean_n];
        let [least, most, mean] = tensions.map(|n| rounded(n, 3));
        let [cold, hot] = [s.temperature_min_c, s.temperature_max_c].map(|c| rounded(c, 3));
        let cycle = spoken(s.duration_s);
        out.paragraph(format!(
            "cycle of {cycle}: {least} to {most} N, mean {mean} N; {cold} to {hot} °C"
        ));
    }
    let length = rounded(1e3 * p.length_m, 4);
    out.paragraph(format!(
        "strand of {length} mm, elongation at {}",
        read_at(p)
    ));
    out.add("\n");
    if p.readings.is_empty() {
        out.paragraph("no elongation: failure before the first time");
    } else {
        out.table(elongations(p, |v| rounded(v.value, 2)));
    }
    out.paragraph(life::lifetime(&p.lifetime));
    if life::is_significant(&p.lifetime) {
        out.add("\nlife used along the rope, from the drive\n");
        out.table(life::spots(&p.lifetime));
    }
    if let Some(left) = p.strength_left_share {
        let [left, low, high] = [left.value, left.low, left.high].map(|v| rounded(100.0 * v, 2));
        out.paragraph(format!(
            "residual strength after bending: {left} % of new ({low} to {high} %)"
        ));
    }
    if let Some(text) = broken(p) {
        out.paragraph(text);
    }
    out.add("\n");
    let (draws, assumed) = (draws(p), assumed(p));
    out.paragraph(format!("95 % intervals from {draws}; {assumed}"));
    for what in &p.cautions {
        out.paragraph(format!("warning{}", caution_message(*what).tag()));
    }
    out.0
}
