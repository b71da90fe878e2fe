//! A prediction as a page.

use super::words::guessed;
use super::{bracketed, caution, life, notices, page, route_map, spoken};
use crate::text::{self, Told};
use sinew_figure::plot::{Band, Figure, Line, Panel, Points};
use sinew_figure::{Block, Headline, Level, Page, Table, rounded};
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
        let breaks = format!("{}. It {}.", text::capitalised(&text), life::lasts(&p.life));
        first.push(Block::Headlines(vec![Headline::new(Level::Watch, breaks)]));
    }
    first.extend(notices(&p.cautions));
    if p.readings.len() > 1 {
        first.push(Block::Figure(Box::new(course(p, curve)), String::new()));
    }
    let rows = p.readings.iter().map(|r| {
        vec![
            spoken(r.time_s),
            bracketed(r.since_tensioned_m.scaled(1e3), 2),
            bracketed(r.elongation_m.scaled(1e3), 2),
            bracketed(r.strain_ratio.scaled(100.0), 2),
            bracketed(r.irreversible_m.scaled(1e3), 2),
        ]
    });
    let head = [
        "after",
        "since tensioned, mm",
        "from new and slack, mm",
        "from new and slack, %",
        "of that unloading leaves, mm",
    ];
    let s = &p.summary;
    let celsius = [
        s.temperature_min_c,
        s.temperature_mean_c,
        s.temperature_max_c,
    ];
    let constant = s.tension_min_n == s.tension_max_n && celsius[0] == celsius[2];
    let basis = vec![Block::from(Table::facts([
        ("duty", p.duty.clone()),
        (
            "one cycle",
            if constant {
                "always the same".into()
            } else {
                spoken(s.duration_s)
            },
        ),
        (
            "tension",
            span([s.tension_min_n, s.tension_mean_n, s.tension_max_n], "N"),
        ),
        ("temperature", span(celsius, "°C")),
        ("strand", format!("{} mm", rounded(1e3 * p.length_m, 4))),
        (
            "read at",
            format!(
                "{} N, {} °C",
                rounded(p.read_at_n, 3),
                rounded(p.read_at_c, 3)
            ),
        ),
        (
            "parameters",
            format!(
                "{} of {} are starting guesses; {} draws (seed {})",
                p.starting_guesses, p.parameters, p.draws, p.seed
            ),
        ),
        (
            "strength left after bending",
            p.strength_left_share.map_or_else(
                || "not asked for, or broken by then".into(),
                |i| format!("{} % of new", bracketed(i.scaled(100.0), 2)),
            ),
        ),
    ]))];
    let mut lasts = vec![Block::Paragraph(format!("It {}.", life::lasts(&p.life)))];
    if route_map::is_told(p) {
        let about = "The route, drawn as if its pulleys turned the rope to the left and to the right by turns. The wider the line, the more of that portion's life is used up.";
        lasts.push(Block::Figure(Box::new(route_map::figure(p)), about.into()));
    }
    if life::is_told(&p.life) {
        let about = "What is used up of each portion's life at the last time, or when it breaks; a star marks the weakest.";
        lasts.push(Block::Figure(Box::new(life::figure(&p.life)), about.into()));
        lasts.push(Table::new(&life::HEAD, life::rows(&p.life)).into());
    }
    page(format!("Elongation of {}", p.rope), p.duty.clone())
        .section("", first)
        .section("Readings", vec![Table::new(&head, rows).into()])
        .section("How long it lasts", lasts)
        .section("What it rests on", basis)
}

/// Elongation over time as a curve with its band, and the readings of the table as dots.
fn course(p: &Prediction, curve: &[Reading]) -> Figure {
    let of = |readings: &[Reading], f: fn(Bounded) -> f64| -> Vec<f64> {
        let all = readings.iter().map(|r| r.since_tensioned_m.scaled(1e3));
        all.map(f).collect()
    };
    let times = |readings: &[Reading]| {
        readings
            .iter()
            .map(|r| r.time_s.log10())
            .collect::<Vec<_>>()
    };
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
    if least == most {
        return format!("{} {unit}", rounded(mean, 3));
    }
    format!(
        "{} to {} {unit}, mean {} {unit}",
        rounded(least, 3),
        rounded(most, 3),
        rounded(mean, 3)
    )
}

/// What is to be expected, as text for a terminal.
pub fn prediction_table(p: &Prediction) -> String {
    let mut out = Told::default();
    out.say(format!("{}: {}", p.rope, p.duty));
    let s = &p.summary;
    if s.tension_min_n != s.tension_max_n || s.temperature_min_c != s.temperature_max_c {
        out.say(format!(
            "one cycle of {}: {} to {} N, mean {} N; {} to {} °C",
            spoken(s.duration_s),
            rounded(s.tension_min_n, 3),
            rounded(s.tension_max_n, 3),
            rounded(s.tension_mean_n, 3),
            rounded(s.temperature_min_c, 3),
            rounded(s.temperature_max_c, 3)
        ));
    }
    out.say(format!(
        "strand of {} mm, read at {} N and {} °C",
        rounded(1e3 * p.length_m, 4),
        rounded(p.read_at_n, 3),
        rounded(p.read_at_c, 3)
    ));
    out.add("\n");
    let head = [
        "after",
        "since tensioned\nmm",
        "from slack\nmm",
        "from slack\n%",
        "stays, mm",
    ];
    let rows = p
        .readings
        .iter()
        .map(|r| {
            vec![
                spoken(r.time_s),
                bracketed(r.since_tensioned_m.scaled(1e3), 2),
                bracketed(r.elongation_m.scaled(1e3), 2),
                rounded(100.0 * r.strain_ratio.value, 2),
                rounded(1e3 * r.irreversible_m.value, 2),
            ]
        })
        .collect();
    if p.readings.is_empty() {
        out.say("no reading: it breaks before the first");
    } else {
        out.add(text::table(&head, rows, 1));
    }
    out.say(format!("it {}", life::lasts(&p.life)));
    if life::is_told(&p.life) {
        out.add("\nlife used up along the rope, from the drive\n");
        out.add(text::table(&life::HEAD, life::rows(&p.life), 1));
    }
    if let Some(left) = p.strength_left_share {
        out.say(format!(
            "strength left after bending: {} % of new ({} to {} %)",
            rounded(100.0 * left.value, 2),
            rounded(100.0 * left.low, 2),
            rounded(100.0 * left.high, 2)
        ));
    }
    if let Some(text) = broken(p) {
        out.say(text);
    }
    out.add("\n");
    out.say(format!(
        "95 % intervals from {} draws (seed {}); {} of {} parameters are starting guesses",
        p.draws, p.seed, p.starting_guesses, p.parameters
    ));
    for what in &p.cautions {
        out.say(format!("warning: {}", caution(*what)));
    }
    out.0
}
