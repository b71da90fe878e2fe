//! A prediction as a page.

use super::words::guessed;
use super::{bracketed, caution, life, notices, page, route_map, spoken};
use crate::text::{Told, capitalised};
use sinew_figure::plot::{Band, Figure, Line, Panel, Points};
use sinew_figure::{Block, Columns, Headline, Level, Page, Table, rounded};
use sinew_model::Bounded;
use sinew_rope::predict::{Prediction, Reading};

/// How far a rope will stretch; `curve`: its readings at more times, by [`super::series::curve_times`].
pub fn predicted(p: &Prediction, curve: &[Reading]) -> Page {
    let mut first = Vec::new();
    if let Some(last) = p.readings.last() {
        first.push(Block::Headlines(vec![Headline::from(format!(
            "{} after {}: {} mm longer than a minute after tensioning (95 % interval in brackets).{}",
            p.rope,
            spoken(last.time_s),
            bracketed(last.since_tensioned_m.scaled(1e3), 2),
            guessed(p.starting_guesses, p.parameters)
        ))]));
    }
    if let Some(time_s) = p.breaks_after_s {
        let breaks = format!(
            "{} breaks after some {}, of {}.{}",
            p.rope,
            spoken(time_s),
            life::cause(p.life.cause),
            guessed(p.starting_guesses, p.parameters)
        );
        let breaks = Headline::new(Level::Alarm, breaks);
        first.push(Block::Headlines(vec![breaks]));
    }
    if let (Some(text), None) = (broken(p), p.breaks_after_s) {
        let breaks = format!("{}. It {}.", capitalised(&text), life::lasts(&p.life));
        first.push(Block::Headlines(vec![Headline::new(Level::Watch, breaks)]));
    }
    first.extend(notices(&p.cautions));
    if p.readings.len() > 1 {
        first.push(Block::Figure(Box::new(course(p, curve)), String::new()));
    }
    let s = &p.summary;
    let celsius = [
        s.temperature_min_c,
        s.temperature_mean_c,
        s.temperature_max_c,
    ];
    let constant = s.tension_min_n == s.tension_max_n && celsius[0] == celsius[2];
    let cycle = match constant {
        true => "always the same".into(),
        false => spoken(s.duration_s),
    };
    let strength = p.strength_left_share.map_or_else(
        || "not asked for, or broken by then".into(),
        |i| format!("{} % of new", bracketed(i.scaled(100.0), 2)),
    );
    let basis = Table::facts([
        ("duty", p.duty.clone()),
        ("one cycle", cycle),
        (
            "tension",
            span([s.tension_min_n, s.tension_mean_n, s.tension_max_n], "N"),
        ),
        ("temperature", span(celsius, "°C")),
        ("strand", format!("{} mm", rounded(1e3 * p.length_m, 4))),
        ("read at", read_at(p)),
        ("parameters", format!("{}; {}", guesses(p), draws(p))),
        ("strength left after bending", strength),
    ]);
    let mut lasts = vec![Block::Paragraph(format!("It {}.", life::lasts(&p.life)))];
    if route_map::is_told(p) {
        let about = "The route, drawn as if its pulleys turned the rope to the left and to the right by turns. The wider the line, the more of that portion's life is used up.";
        lasts.push(Block::Figure(Box::new(route_map::figure(p)), about.into()));
    }
    if life::is_told(&p.life) {
        let about = "What is used up of each portion's life at the last time, or when it breaks; a star marks the weakest.";
        lasts.push(Block::Figure(Box::new(life::figure(&p.life)), about.into()));
        lasts.push(life::spots(&p.life).into());
    }
    page(format!("Elongation of {}", p.rope), p.duty.clone())
        .section("", first)
        .section("Readings", vec![readings(p, |v| bracketed(v, 2)).into()])
        .section("How long it lasts", lasts)
        .section("What it rests on", vec![basis.into()])
}

/// Elongation over time as a curve with its band, and the readings of the table as dots.
fn course(p: &Prediction, curve: &[Reading]) -> Figure {
    let of = |readings: &[Reading], f: fn(Bounded) -> f64| -> Vec<f64> {
        let all = readings.iter().map(|r| r.since_tensioned_m.scaled(1e3));
        all.map(f).collect()
    };
    let times = |of: &[Reading]| -> Vec<f64> { of.iter().map(|r| r.time_s.log10()).collect() };
    let most = of(curve, |i| i.high).into_iter().fold(0.0, f64::max);
    let x = times(curve);
    let (low, high) = (of(curve, |i| i.low), of(curve, |i| i.high));
    let dots = Points::new("readings", times(&p.readings), of(&p.readings, |i| i.value));
    let panel = Panel::new("", "time", "elongation since tensioned (mm)")
        .y_range(0.0, 1.06 * most)
        .band(Band::new("95 % of the draws", x.clone(), low, high))
        .line(Line::new("catalogue's values", x, of(curve, |i| i.value)))
        .points(dots)
        .x_times();
    let told = p.readings.iter().map(|r| {
        let mm = bracketed(r.since_tensioned_m.scaled(1e3), 2);
        format!("after {} {mm} mm", spoken(r.time_s))
    });
    Figure::new("")
        .size(820.0, 360.0)
        .seen(format!(
            "{} since tensioned, with 95 % intervals: {}",
            p.rope,
            told.collect::<Vec<_>>().join(", ")
        ))
        .panel(panel)
}

/// How far it stretches; strain and what stays are worded by `number`.
fn readings(p: &Prediction, number: fn(Bounded) -> String) -> Table {
    let mm = |length: Bounded| bracketed(length.scaled(1e3), 2);
    Columns::of(&p.readings)
        .words("after", |r| spoken(r.time_s))
        .column("since tensioned\nmm", |r| mm(r.since_tensioned_m))
        .column("from slack\nmm", |r| mm(r.elongation_m))
        .column("from slack\n%", |r| number(r.strain_ratio.scaled(100.0)))
        .column("stays, mm", |r| number(r.irreversible_m.scaled(1e3)))
        .table()
}

/// What it is read at.
fn read_at(p: &Prediction) -> String {
    let [newtons, celsius] = [p.read_at_n, p.read_at_c].map(|v| rounded(v, 3));
    format!("{newtons} N and {celsius} °C")
}

/// How many draws the intervals are from.
fn draws(p: &Prediction) -> String {
    format!("{} draws (seed {})", p.draws, p.seed)
}

/// How many of its parameters are guesses.
fn guesses(p: &Prediction) -> String {
    let (guesses, all) = (p.starting_guesses, p.parameters);
    format!("{guesses} of {all} parameters are starting guesses")
}

/// In how many draws the rope breaks, where it does in some.
fn broken(p: &Prediction) -> Option<String> {
    let last = p.readings.last()?;
    (last.broken_share > 0.0).then(|| {
        format!(
            "the rope breaks in {} % of the draws within {}, which are left out of the elongations",
            rounded(100.0 * last.broken_share, 2),
            spoken(last.time_s)
        )
    })
}

/// Least, mean and most; one number where they are the same.
fn span([least, mean, most]: [f64; 3], unit: &str) -> String {
    let same = least == most;
    let [least, mean, most] = [least, mean, most].map(|v| rounded(v, 3));
    match same {
        true => format!("{mean} {unit}"),
        false => format!("{least} to {most} {unit}, mean {mean} {unit}"),
    }
}

/// What is to be expected, as text for a terminal.
pub fn prediction_table(p: &Prediction) -> String {
    let mut out = Told::default();
    out.say(format!("{}: {}", p.rope, p.duty));
    let s = &p.summary;
    if s.tension_min_n != s.tension_max_n || s.temperature_min_c != s.temperature_max_c {
        let tensions = [s.tension_min_n, s.tension_max_n, s.tension_mean_n];
        let [least, most, mean] = tensions.map(|n| rounded(n, 3));
        let [cold, hot] = [s.temperature_min_c, s.temperature_max_c].map(|c| rounded(c, 3));
        let cycle = spoken(s.duration_s);
        out.say(format!(
            "one cycle of {cycle}: {least} to {most} N, mean {mean} N; {cold} to {hot} °C"
        ));
    }
    let length = rounded(1e3 * p.length_m, 4);
    out.say(format!("strand of {length} mm, read at {}", read_at(p)));
    out.add("\n");
    if p.readings.is_empty() {
        out.say("no reading: it breaks before the first");
    } else {
        out.table(readings(p, |v| rounded(v.value, 2)));
    }
    out.say(format!("it {}", life::lasts(&p.life)));
    if life::is_told(&p.life) {
        out.add("\nlife used up along the rope, from the drive\n");
        out.table(life::spots(&p.life));
    }
    if let Some(left) = p.strength_left_share {
        let [left, low, high] = [left.value, left.low, left.high].map(|v| rounded(100.0 * v, 2));
        out.say(format!(
            "strength left after bending: {left} % of new ({low} to {high} %)"
        ));
    }
    if let Some(text) = broken(p) {
        out.say(text);
    }
    out.add("\n");
    let (draws, guesses) = (draws(p), guesses(p));
    out.say(format!("95 % intervals from {draws}; {guesses}"));
    for what in &p.cautions {
        out.say(format!("warning: {}", caution(*what)));
    }
    out.0
}
